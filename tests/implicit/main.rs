//! Solids given by a function: what is met, where, and with which normal.

mod closed;
mod exact;
mod hits;
mod surfaces;
