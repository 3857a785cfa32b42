//! What every BSDF must obey: samples follow the density, weights are value over density, light comes back no more than
//! it went in, and the same both ways; Oren–Nayar's formulas against tables of them in f64.

mod chi2;
mod formulas;
mod laws;
mod oren_nayar;
mod rig;
