//! What the documentation of `num`, `geom` and `color` says about errors, held both ways against f64.

mod color;
mod figures;
mod geom;
mod num;
