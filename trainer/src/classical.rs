//! The filters that stood for denoising before networks (`host_sim::classical`), tuned on the validation scenes.

pub use host_sim::classical::{Guides, Kind};

use rayon::prelude::*;

use crate::nn::Light;
use crate::picture::{self, Picture};
use host_sim::classical::{self, Guided};

/// Irradiance, filtered.
pub fn filter(picture: &Picture, kind: Kind, guides: &Guides) -> Vec<Light> {
    let guided = Guided {
        width: picture.width,
        height: picture.height,
        irradiance: picture.irradiance.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        albedo: picture.albedo.clone(),
        normal: picture.normal.clone(),
        depth: picture.depth.clone(),
    };
    let light = classical::filter(&guided, kind, guides);
    light.into_iter().map(|[r, g, b]| [r, g, b, 0.0]).collect()
}

/// The guides with the least squared tone-mapped error (in dB, the mean of scenes) over `pictures`, one guide after the
/// other, twice; and that error.
pub fn tune(pictures: &[Picture], kind: Kind) -> (f64, Guides) {
    let error = |guides: &Guides| -> f64 {
        let each = pictures
            .par_iter()
            .map(|p| picture::squared(p, &filter(p, kind, guides)).log10());
        each.collect::<Vec<_>>().iter().sum()
    };
    let mut best: Guides = [2.0, 4.0, 4.0, 0.25];
    let mut least = error(&best);
    for by in [4.0, 2.0, 2.0, 1.5] {
        for guide in 0..4 {
            for by in [by, 1.0 / by] {
                loop {
                    let mut tried = best;
                    tried[guide] *= by;
                    let value = error(&tried);
                    if value >= least {
                        break;
                    }
                    (best, least) = (tried, value);
                }
            }
        }
    }
    (least, best)
}
