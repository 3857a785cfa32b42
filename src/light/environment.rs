//! What lies behind everything: the same light from all around, a sky, or a picture of one.

use super::{Map, Sky};
use crate::color::Radiance;
use crate::geom::Dir;
use crate::num::{Uniform, Wide};

/// Radiance from infinitely far away, W·sr⁻¹·m⁻².
///
/// [`Self::sample`] and [`Self::pdf`] belong together, and the density is above 0 wherever there is radiance.
#[derive(Clone, Copy, Debug, Default)]
pub enum Environment<'a> {
    /// Black.
    #[default]
    None,
    /// The same from all around: found by directions drawn from the BSDF alone, which for it are the better ones.
    Constant(Radiance),
    /// A gradient, with or without a sun.
    Sky(&'a Sky),
    /// A picture.
    Map(Map<'a>),
}

/// A direction towards the environment.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentSample {
    pub wi: Dir,
    /// What arrives along `wi` if nothing stands in the way.
    pub radiance: Radiance,
    /// Per solid angle.
    pub pdf: Wide,
}

impl Environment<'_> {
    /// What is seen along a direction.
    #[inline]
    pub fn radiance(&self, dir: Dir) -> Radiance {
        match self {
            Self::None => Radiance::BLACK,
            Self::Constant(radiance) => *radiance,
            Self::Sky(sky) => sky.radiance(dir),
            Self::Map(map) => map.radiance(dir),
        }
    }

    /// A direction with a density that follows the radiance; `None` if there is nothing to draw.
    #[inline]
    pub fn sample(&self, u: [Uniform; 2]) -> Option<EnvironmentSample> {
        match self {
            Self::None | Self::Constant(_) => None,
            Self::Sky(sky) => sky.sample(u),
            Self::Map(map) => map.sample(u),
        }
    }

    /// The density with which [`Self::sample`] draws a direction, per solid angle; 0 if it draws none.
    #[inline]
    pub fn pdf(&self, dir: Dir) -> Wide {
        match self {
            Self::None | Self::Constant(_) => Wide::ZERO,
            Self::Sky(sky) => sky.pdf(dir),
            Self::Map(map) => map.pdf(dir),
        }
    }

    /// Whether directions towards it are drawn: it is one of the lights to choose from.
    #[inline]
    pub const fn is_sampled(&self) -> bool {
        matches!(self, Self::Sky(_) | Self::Map(_))
    }

    /// Whether there is no light anywhere in it.
    pub fn is_black(&self) -> bool {
        match self {
            Self::None => true,
            Self::Constant(radiance) => radiance.is_black(),
            Self::Sky(_) | Self::Map(_) => self.flux().is_zero(),
        }
    }

    /// Luminance over all directions, W·m⁻²: 4π times the mean.
    pub fn flux(&self) -> Wide {
        match self {
            Self::None => Wide::ZERO,
            Self::Constant(radiance) => radiance.luminance() * Wide::PI.shl(2),
            Self::Sky(sky) => sky.flux(),
            Self::Map(map) => map.flux(),
        }
    }
}
