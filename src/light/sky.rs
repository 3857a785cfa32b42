use super::{EnvironmentSample, chance_by, choose_by};
use crate::color::Radiance;
use crate::geom::{Dir, Frame};
use crate::num::{ONE_Q16, Turn, Uniform, Wide, isqrt, mul_q16, sin_cos};
use crate::sampler::warp::{self, Cone};

/// A sky: three colours, linear in the sine of the elevation, and a sun.
///
/// Overhead `zenith`, at the horizon `horizon`, straight down `ground`; W·sr⁻¹·m⁻². A direction is drawn from the sun's
/// cone, evenly, or from the gradient, in proportion to its luminance: by how much light the two send, yet either at
/// least one time in eight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    up: Dir,
    zenith: Radiance,
    horizon: Radiance,
    ground: Radiance,
    sun: Option<Sun>,
    /// Where the numbers for the sun end and those for the gradient begin; none if there is no choice.
    sun_bound: Option<u32>,
    /// The same for what is below the horizon, and above.
    ground_bound: Option<u32>,
    /// Luminance of the three.
    luminance: [Wide; 3],
}

/// A disk in the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Towards it.
    pub direction: Dir,
    pub radiance: Radiance,
    /// As it was given.
    pub diameter: Turn,
    /// What it fills.
    pub cone: Cone,
}

impl Sky {
    /// A gradient; `up` points to the zenith.
    #[inline(never)]
    pub fn new(up: Dir, zenith: Radiance, horizon: Radiance, ground: Radiance) -> Sky {
        let luminance = [zenith, horizon, ground].map(Radiance::luminance);
        let [above, at, below] = luminance;
        let (upper, lower) = (above + at, at + below);
        Sky {
            up,
            zenith,
            horizon,
            ground,
            sun: None,
            sun_bound: None,
            ground_bound: bound(lower, upper, 0),
            luminance,
        }
    }

    /// With a sun `towards` a direction, this wide, of this radiance. Widths from 0.02° to 180°; others are brought into
    /// that range.
    ///
    /// Irradiance E on a surface that faces it makes a radiance of E / (π sin²(`angular_diameter`/2)).
    #[inline(never)]
    pub fn with_sun(self, towards: Dir, angular_diameter: Turn, radiance: Radiance) -> Sky {
        if radiance.is_black() {
            return Sky {
                sun: None,
                sun_bound: None,
                ..self
            };
        }
        let sun = Sun {
            direction: towards,
            radiance,
            diameter: angular_diameter,
            cone: Cone::new(angular_diameter.to_bits() / 2),
        };
        let disk = radiance.luminance() * sun.cone.solid_angle();
        Sky {
            sun: Some(sun),
            sun_bound: bound(disk, self.gradient_flux(), 1 << 29),
            ..self
        }
    }

    /// Up, as it was given.
    pub fn up(&self) -> Dir {
        self.up
    }

    /// The colours at zenith, horizon and nadir.
    pub fn colors(&self) -> [Radiance; 3] {
        [self.zenith, self.horizon, self.ground]
    }

    /// The sun, if there is one.
    pub fn sun(&self) -> Option<&Sun> {
        self.sun.as_ref()
    }

    /// Up and the way to the sun: unit vectors, or the border refuses them.
    pub(crate) fn directions(&self) -> [Dir; 2] {
        [self.up, self.sun.map_or(self.up, |sun| sun.direction)]
    }

    /// What is seen along a direction.
    pub fn radiance(&self, dir: Dir) -> Radiance {
        let gradient = self.gradient(dir);
        match self.sun {
            Some(sun) if sun.cone.holds(sun.direction, dir) => gradient.add(sun.radiance),
            _ => gradient,
        }
    }

    /// A direction towards sun or sky; `None` if both are black.
    pub fn sample(&self, u: [Uniform; 2]) -> Option<EnvironmentSample> {
        let (kind, rest) = choose_by(u[0], self.sun_bound.as_slice());
        let u = [rest, u[1]];
        if let (Some(sun), 0) = (self.sun, kind) {
            let wi = Frame::about(sun.direction).to_world(sun.cone.sample(u));
            // Of the sun, wherever rounding put it.
            return Some(EnvironmentSample {
                wi,
                radiance: sun.radiance.add(self.gradient(wi)),
                pdf: self.pdf_of(wi, true),
            });
        }
        let wi = self.sample_gradient(u)?;
        let in_sun = self.sun.is_some_and(|sun| sun.cone.holds(sun.direction, wi));
        let gradient = self.gradient(wi);
        let radiance = match self.sun {
            Some(sun) if in_sun => gradient.add(sun.radiance),
            _ => gradient,
        };
        Some(EnvironmentSample {
            wi,
            radiance,
            pdf: self.pdf_of(wi, in_sun),
        })
    }

    /// The density of [`Self::sample`] at a direction.
    pub fn pdf(&self, dir: Dir) -> Wide {
        let in_sun = self.sun.is_some_and(|sun| sun.cone.holds(sun.direction, dir));
        self.pdf_of(dir, in_sun)
    }

    fn pdf_of(&self, dir: Dir, in_sun: bool) -> Wide {
        let bound = self.sun_bound.as_slice();
        let Some(sun) = self.sun else {
            return self.pdf_gradient(dir);
        };
        let disk = if in_sun { sun.cone.pdf() } else { Wide::ZERO };
        if bound.is_empty() {
            return disk;
        }
        chance_by(0, bound) * disk + chance_by(1, bound) * self.pdf_gradient(dir)
    }

    pub(super) fn flux(&self) -> Wide {
        let disk = match self.sun {
            Some(sun) => sun.radiance.luminance() * sun.cone.solid_angle(),
            None => Wide::ZERO,
        };
        self.gradient_flux() + disk
    }

    /// ∫ of the luminance over both halves, in each of which it is linear in a coordinate in which area is even.
    fn gradient_flux(&self) -> Wide {
        let [above, at, below] = self.luminance;
        Wide::PI * (above + at + at + below)
    }

    fn gradient(&self, dir: Dir) -> Radiance {
        let (share, end) = self.place(dir, self.zenith, self.ground);
        self.horizon.scale_q16(ONE_Q16 - share).add(end.scale_q16(share))
    }

    /// How far from the horizon, Q16, and to which end.
    fn place<T>(&self, dir: Dir, above: T, below: T) -> (i32, T) {
        let sine = dir.dot(self.up).clamp(-ONE_Q16, ONE_Q16);
        (sine.abs(), if sine < 0 { below } else { above })
    }

    fn pdf_gradient(&self, dir: Dir) -> Wide {
        let [above, at, below] = self.luminance;
        let (share, end) = self.place(dir, above, below);
        let here = at * Wide::from_q16(ONE_Q16 - share) + end * Wide::from_q16(share);
        let flux = self.gradient_flux();
        if flux.is_zero() { Wide::ZERO } else { here / flux }
    }

    fn sample_gradient(&self, u: [Uniform; 2]) -> Option<Dir> {
        let [above, at, below] = self.luminance;
        let (half, rest) = choose_by(u[0], self.ground_bound.as_slice());
        let is_ground = match self.ground_bound {
            Some(_) => half == 0,
            None => above.is_zero() && at.is_zero(),
        };
        let end = if is_ground { below } else { above };
        if end.is_zero() && at.is_zero() {
            return None;
        }
        let sine = warp::sample_linear(rest, at, end);
        let cos_elevation = isqrt(!(mul_square(sine))) as i32;
        let (sin_phi, cos_phi) = sin_cos(Turn::from_bits(u[1].to_bits()));
        let local = Dir([
            mul_q16(cos_elevation, cos_phi),
            mul_q16(cos_elevation, sin_phi),
            if is_ground { -sine } else { sine },
        ]);
        Some(Frame::about(self.up).to_world(local))
    }
}

/// x² of a Q16 number in 0 ..= 1, Q32; the largest below 1 for 1.
fn mul_square(x: i32) -> u32 {
    let x = x.unsigned_abs().min(0xffff);
    x * x
}

/// Where a choice between two weights falls, neither with fewer numbers than `least`; none if one weighs nothing.
fn bound(first: Wide, second: Wide, least: u32) -> Option<u32> {
    if first.is_zero() || second.is_zero() {
        return None;
    }
    let share = (first / (first + second)).to_fixed(32);
    let least = least.max(1 << 16);
    Some(share.clamp(least, u32::MAX - least))
}
