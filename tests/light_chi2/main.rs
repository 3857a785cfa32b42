//! Every sampled light and every warp draws as its density says: χ² tests, and the density adds up to 1.

mod chi2;
mod light;
mod warp;
