use crate::film::Feature;
use crate::film::denoise::weight::luma_code;
use crate::film::feature::DEPTH_NOTHING;
use crate::geom::Octahedral;
use crate::num::leading_zeros;

/// Numbers that the network sees of a pixel.
pub const INPUTS: usize = 11;

/// What the network sees of a pixel, 6 bits each: the logarithm of its irradiance, albedo, normal, depth, samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input(pub(super) [u8; INPUTS]);

impl Input {
    /// Of a pixel's feature, how many samples are in its mean (0 counts as 1), and the frame's [`exposure`].
    pub fn new(feature: &Feature, samples: u32, exposure: i32) -> Input {
        Input::beside(feature, samples, exposure, None)
    }

    /// The same, where another pixel's is known, which often looks the same way.
    #[inline(always)]
    pub(super) fn beside(
        feature: &Feature,
        samples: u32,
        exposure: i32,
        other: Option<(Feature, Input)>,
    ) -> Input {
        let i = scaled(feature, exposure).map(|c| logarithm((1 << 12) + (u32::from(c) << 3), 12, 9));
        let a = feature.albedo.map(|c| c >> 2);
        let n = match other {
            Some((other, Input([.., x, y, z, _, _]))) if other.normal == feature.normal => [x, y, z],
            _ => direction(feature.normal),
        };
        let s = logarithm(samples.max(1), 0, 9);
        // A sky is one, wherever it is seen.
        let depth = if feature.shows_nothing() {
            DEPTH_NOTHING
        } else {
            feature.depth
        };
        Input([
            i[0],
            i[1],
            i[2],
            a[0],
            a[1],
            a[2],
            n[0],
            n[1],
            n[2],
            depth >> 2,
            s,
        ])
    }

    /// Of the numbers themselves; those over 63 count as 63.
    pub fn from_bits(bits: [u8; INPUTS]) -> Input {
        Input(bits.map(|b| b.min(63)))
    }

    pub fn to_bits(self) -> [u8; INPUTS] {
        self.0
    }
}

/// [−1, 1] onto 0 ..= 63, rounded.
#[inline(never)]
fn direction(normal: Octahedral) -> [u8; 3] {
    let parts = normal.decode().0;
    parts.map(|c| ((c.clamp(-(1 << 16), 1 << 16) * 63 + (64 << 16)) >> 17) as u8)
}

/// A pixel's irradiance as the filter takes it: Q12, at most 16.
pub fn irradiance(feature: &Feature) -> [u16; 3] {
    scaled(feature, 0)
}

/// By how many octaves the network sees a frame brighter than it is, so that what is seen in it has a luminance of about
/// 1 (geometric mean; what is black or infinitely far away does not count). −8 ..= 8.
pub fn exposure(frame: &[Feature]) -> i32 {
    let (mut sum, mut count) = (0u64, 0u64);
    for pixel in frame.iter().filter(|pixel| !pixel.shows_nothing()) {
        let code = luma_code(pixel.irradiance);
        sum += u64::from(code);
        count += u64::from(code > 0);
    }
    // Eighths of an octave, 1 for 2^-15; whole octaves, to nearest.
    match sum.checked_div(count) {
        Some(mean) => ((15 * 8 + 5 - mean as i32) >> 3).clamp(-8, 8),
        None => 0,
    }
}

/// `exposure` octaves brighter, Q12, at most 16.
fn scaled(feature: &Feature, exposure: i32) -> [u16; 3] {
    let (mantissas, exponent) = feature.irradiance.to_parts();
    let shift = exponent + 12 + exposure.clamp(-8, 8);
    mantissas.map(|m| {
        // raw: mantissas have 9 bits.
        if shift >= 0 {
            (m << shift.min(16)).min(0xffff) as u16
        } else {
            ((((m << 1) >> shift.unsigned_abs().min(31)) + 1) >> 1) as u16
        }
    })
}

/// `steps` · log2(x / 2^`one`), rounded down, within 0 ..= 63; between powers of two a straight line (0.086 of an octave
/// off at most).
fn logarithm(x: u32, one: u32, steps: u32) -> u8 {
    if x <= 1 << one {
        return 0;
    }
    let zeros = leading_zeros(x);
    // Q16: whole octaves, and how far to the next.
    let fraction = (x << zeros << 1) >> 16;
    let log = ((31 - zeros - one) << 16) + fraction;
    ((log * steps) >> 16).min(63) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::{Radiance, Rgb9e5};
    use crate::film::feature::{ID_NOTHING, first_id};
    use crate::geom::{Dir, Octahedral};

    #[test]
    fn what_is_seen_of_a_pixel() {
        let grey = Feature {
            irradiance: Rgb9e5::encode(Radiance::WHITE),
            albedo: [128; 3],
            depth: 80,
            normal: Octahedral::encode(Dir::Y),
            id: 7,
        };
        // log2(1 + 8) = 3.17; a straight line from 8 to 16 says 3.125: 28 of 9 steps each.
        assert_eq!(
            Input::new(&grey, 4, 0).0,
            [28, 28, 28, 32, 32, 32, 32, 63, 32, 20, 18]
        );
        assert_eq!(irradiance(&grey), [4096; 3]);
        // Darker by three octaves and shown by three more: the same.
        let dark = Feature {
            irradiance: Rgb9e5::encode(Radiance::from_bits([1 << 12; 3], -15)),
            ..grey
        };
        assert_eq!(Input::new(&dark, 4, 3), Input::new(&grey, 4, 0));
        assert_eq!(exposure(&[grey; 5]), 0);
        assert_eq!(exposure(&[dark, Feature::default(), dark]), 3);
        let sky = Feature {
            depth: DEPTH_NOTHING,
            ..grey
        };
        assert_eq!(exposure(&[dark, sky]), 3);
        // The same in a curved mirror, which has a distance.
        let mirrored = Feature {
            depth: 80,
            id: first_id(ID_NOTHING, 1),
            ..grey
        };
        assert_eq!(exposure(&[dark, mirrored]), 3);
        assert_eq!(Input::new(&mirrored, 4, 0), Input::new(&sky, 4, 0));
        assert_eq!(exposure(&[sky, Feature::default()]), 0);
        assert_eq!(exposure(&[]), 0);
        let most = Feature {
            irradiance: Rgb9e5(u32::MAX),
            albedo: [255; 3],
            depth: 255,
            ..grey
        };
        assert_eq!(irradiance(&most), [u16::MAX; 3]);
        assert_eq!(
            Input::new(&most, u32::MAX, 0).0,
            [63, 63, 63, 63, 63, 63, 32, 63, 32, 63, 63]
        );
        assert_eq!(irradiance(&Feature::default()), [0; 3]);
        assert_eq!(
            Input::new(&Feature::default(), 0, 0).0,
            [0, 0, 0, 0, 0, 0, 32, 32, 63, 0, 0]
        );
    }

    #[test]
    fn irradiance_is_the_nearest_step() {
        for bits in [1u32, 3, 7, 100, 255, 511] {
            for e in 0..32u32 {
                let feature = Feature {
                    irradiance: Rgb9e5(bits | e << 27),
                    ..Feature::default()
                };
                let exact = f64::from(bits) * (f64::from(e) - 12.0).exp2();
                let got = f64::from(irradiance(&feature)[0]);
                assert!((got - exact.min(65535.0)).abs() <= 0.5, "{bits} {e} {got}");
            }
        }
    }
}
