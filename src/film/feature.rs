//! What a denoiser is told of a pixel: twelve bytes, the mean of the pixel's samples.

use crate::color::{Albedo, Radiance, Rgb9e5, mean_q32};
use crate::geom::{Dir, Octahedral};
use crate::num::{Share, isqrt, neg_log2, recip};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// One pixel for a denoiser.
///
/// | byte | what |
/// |--:|---|
/// | 0..4 | [`Rgb9e5`], little-endian |
/// | 4..7 | albedo: red, green, blue, each √ in 255ths ([`albedo_code`]) |
/// | 7 | distance, sixteenths of an octave ([`depth_code`]) |
/// | 8..10 | normal ([`Octahedral`]) |
/// | 10..12 | number of what is seen, little-endian |
///
/// All of it is about the first thing on the way that is no mirror or smooth glass. What shines there, and what is
/// infinitely far away, has an albedo of 1 and its radiance as irradiance.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct Feature {
    /// Light that arrived, in the sense that times [`Self::albedo`] it is the pixel's: the samples' mean radiance over
    /// their mean albedo (1/32 at least each). So an edge of albedo alone leaves no trace in it, and one of light no wrong
    /// product.
    pub irradiance: Rgb9e5,
    /// The samples' mean, 1/32 at least, as [`albedo_code`] has it.
    pub albedo: [u8; 3],
    /// The samples' mean of [`depth_code`]s, where what is seen looks to be: behind flat mirrors and flat glass, at the length
    /// of the way; on curved ones.
    pub depth: u8,
    /// The samples' mean, made a unit vector: the shading normal on the eye's side; towards the eye where nothing is.
    pub normal: Octahedral,
    /// [`first_id`] of most of the samples where more than half agree, else of one of them.
    pub id: u16,
}

const _: () = assert!(size_of::<Feature>() == 12 && align_of::<Feature>() == 4);

/// [`Feature::id`] of what is infinitely far away.
pub const ID_NOTHING: u16 = 0xffff;

/// [`Feature::depth`] of what is infinitely far away.
pub const DEPTH_NOTHING: u8 = 255;

/// The least that radiance is divided by.
pub const ALBEDO_FLOOR: Share = Share::from_bits(1 << 10);

/// √a in 255ths, to nearest: 0 and 1 are exact.
///
/// Decoded again ([`albedo_share`]) the error is 0.0040 at most, and 2.3 % of the share from 1/32 on.
#[inline]
pub fn albedo_code(share: Share) -> u8 {
    // 2·255·√(a/2^15) = √(a · 260100/2^15), one to round by. raw: a ≤ 2^15 → under 2^18 in Q0, so Q13 fits.
    let bits = (share.to_bits() as u32).min(1 << 15);
    ((isqrt((bits * 65_025) >> 13) + 1) >> 1) as u8
}

/// The share that a code stands for: (c/255)², right to a step of 2^-15; both ends are exact.
#[inline]
pub const fn albedo_share(code: u8) -> Share {
    // 2^31/65025 = 33025.5; c² · 33026 < 2^31.01, and 255² gives 2^15 exactly.
    let c = code as u32;
    Share::from_bits(((c * c * 33_026 + (1 << 15)) >> 16) as u16)
}

/// Octaves of distance: sixteenths of one, from 2^11 units (0) to 2^26.9 (254), nearer and farther ones as these;
/// [`DEPTH_NOTHING`] stands apart. In 256ths of a code.
///
/// Error: 2 of these 256ths.
#[inline]
pub fn depth_code_q8(distance: i32) -> u16 {
    // log2 in Q12: 16 codes an octave, 256ths of each.
    let log = (32 << 12) - ((neg_log2(distance.max(1) as u32) + (1 << 13)) >> 14) as i32;
    (log - (11 << 12)).clamp(0, 254 << 8) as u16
}

/// [`depth_code_q8`] to the nearest code.
#[inline]
pub fn depth_code(distance: i32) -> u8 {
    ((depth_code_q8(distance) + 128) >> 8) as u8
}

/// The distance that a code stands for, units: 2^(11 + code/16), to a relative 2^-15; that of 254 for [`DEPTH_NOTHING`].
#[inline]
pub fn depth_distance(code: u8) -> i32 {
    /// 2^(i/16), Q16.
    static ROOTS: [u32; 16] = [
        65_536, 68_438, 71_468, 74_632, 77_936, 81_386, 84_990, 88_752, 92_682, 96_785, 101_070, 105_545,
        110_218, 115_098, 120_194, 125_515,
    ];
    let code = code.min(254) as usize;
    // raw: under 1.92 · 2^16 · 2^15 < 2^32
    ((ROOTS[code % 16] << (code / 16)) >> 5) as i32
}

/// What is seen by way of `bounces` mirrors and glasses gets another number than what is seen itself.
#[inline]
pub const fn first_id(id: u16, bounces: u16) -> u16 {
    id.wrapping_add(bounces.wrapping_mul(0x9e37))
}

/// Most mirrors and glasses by way of which a number is still known for [`ID_NOTHING`]'s.
const BOUNCES: u16 = 15;

/// Whether what has this number is infinitely far, by whatever way it is seen.
#[inline]
const fn is_of_nothing(id: u16) -> bool {
    /// Times 0x9e37 it is 1.
    const INVERSE: u16 = 0x7787;
    const _: () = assert!(INVERSE.wrapping_mul(0x9e37) == 1);
    id.wrapping_sub(ID_NOTHING).wrapping_mul(INVERSE) <= BOUNCES
}

/// What one sample says of its pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    pub radiance: Radiance,
    /// What the first surface gives back, times what mirrors and glass on the way there let through.
    pub albedo: Albedo,
    pub normal: Dir,
    /// Units; `None` for what looks infinitely far away.
    pub distance: Option<i32>,
    pub id: u16,
}

/// Sums over a pixel's samples, at most 65536.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    radiance: [u64; 3],
    albedo: [u32; 3],
    normal: [i32; 3],
    depth: u32,
    /// A candidate, and how many more spoke for it than against (Boyer and Moore, 1981).
    id: (u16, u32),
    count: u32,
}

impl Sum {
    #[inline]
    pub fn add(&mut self, sample: &Sample) {
        let a = floored(sample.albedo);
        for (sum, light) in self.radiance.iter_mut().zip(sample.radiance.to_q32()) {
            *sum = sum.saturating_add(light);
        }
        for (sum, share) in self.albedo.iter_mut().zip(a.0) {
            *sum = sum.saturating_add(share.to_bits() as u32);
        }
        for (sum, part) in self.normal.iter_mut().zip(sample.normal.0) {
            *sum = sum.saturating_add(part >> 2);
        }
        let depth = match sample.distance {
            Some(distance) => depth_code_q8(distance) as u32,
            None => (DEPTH_NOTHING as u32) << 8,
        };
        self.depth = self.depth.saturating_add(depth);
        self.id = match self.id {
            (_, 0) => (sample.id, 1),
            (id, lead) if id == sample.id => (id, lead + 1),
            (id, lead) => (id, lead - 1),
        };
        self.count = self.count.saturating_add(1);
    }

    /// The pixel; black, of albedo 1 and infinitely far away where there was no sample.
    pub fn mean(&self) -> Feature {
        if self.count == 0 {
            return Feature {
                albedo: [255; 3],
                depth: DEPTH_NOTHING,
                id: ID_NOTHING,
                ..Feature::default()
            };
        }
        let r = recip(self.count);
        let mean = |sum: u32| {
            if self.count == 1 {
                return sum;
            }
            // raw: sums under 2^32, so the mean with half a step is what the product's high word holds.
            let bits = sum as u64 * r.mantissa as u64;
            ((bits + (1u64 << (r.shift - 1))) >> r.shift) as u32
        };
        let albedo = self
            .albedo
            .map(|sum| albedo_code(Share::from_bits(mean(sum).min(1 << 15) as u16)));
        let radiance = mean_q32(self.radiance, self.count);
        // By what it will be multiplied with, so that the code's rounding cancels.
        let by = Albedo(albedo.map(albedo_share));
        Feature {
            irradiance: Rgb9e5::encode(demodulate(radiance, by)),
            albedo,
            depth: ((mean(self.depth) + 128) >> 8).min(255) as u8,
            normal: Octahedral::encode(Dir::new(self.normal).unwrap_or(Dir::Z)),
            id: self.id.0,
        }
    }
}

/// What radiance is divided by, and irradiance multiplied by: 1/32 at least, 1 at most.
#[inline]
fn floored(albedo: Albedo) -> Albedo {
    Albedo(albedo.0.map(|share| share.clamp(ALBEDO_FLOOR, Share::ONE)))
}

/// Radiance over an albedo within 1/32 ..= 1: error half a step of 2^-15 of the largest channel of either.
#[inline]
fn demodulate(radiance: Radiance, by: Albedo) -> Radiance {
    if radiance.is_black() {
        return radiance;
    }
    let (m, exponent) = radiance.to_parts();
    let part = |i: usize| {
        let by = (by.0[i].to_bits() as u32).max(1 << 10);
        // raw: under 2^31, and 2^15 more
        ((m[i] as u32) << 15).wrapping_add(by / 2) / by
    };
    Radiance::from_bits([part(0), part(1), part(2)], exponent as i32 - 15)
}

impl Feature {
    /// The albedo as shares.
    #[inline]
    pub const fn albedo(&self) -> Albedo {
        let [r, g, b] = self.albedo;
        Albedo([albedo_share(r), albedo_share(g), albedo_share(b)])
    }

    /// Whether it shows what is infinitely far, in a curved mirror, too, which has its own distance. (A thing whose number is
    /// [`first_id`] of [`ID_NOTHING`] is taken for that.)
    #[inline]
    pub const fn shows_nothing(&self) -> bool {
        self.depth == DEPTH_NOTHING || is_of_nothing(self.id)
    }

    /// The pixel's light: irradiance times albedo.
    #[inline]
    pub const fn radiance(&self) -> Radiance {
        self.irradiance.times(self.albedo())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(light: Radiance) -> [f64; 3] {
        let (m, e) = light.to_parts();
        m.map(|m| f64::from(m) * f64::from(i32::from(e) - 15).exp2())
    }

    fn random(state: &mut u32) -> u32 {
        *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        *state ^ (*state >> 15)
    }

    #[test]
    fn albedos_come_back_within_a_half_step_of_the_root() {
        let (mut worst, mut relative) = (0f64, 0f64);
        for bits in 0..=1u16 << 15 {
            let code = albedo_code(Share::from_bits(bits));
            let exact = f64::from(bits) / 32768.0;
            assert!(
                (f64::from(code) - 255.0 * exact.sqrt()).abs() <= 0.51,
                "{bits} {code}"
            );
            let off = (f64::from(albedo_share(code).to_bits()) / 32768.0 - exact).abs();
            worst = worst.max(off);
            if bits >= 1 << 10 {
                relative = relative.max(off / exact);
            }
        }
        assert!((0.0038..0.0040).contains(&worst), "{worst}");
        assert!((0.021..0.023).contains(&relative), "{relative}");
        for code in 0..=255 {
            let exact = (f64::from(code) / 255.0).powi(2) * 32768.0;
            assert!(
                (f64::from(albedo_share(code).to_bits()) - exact).abs() <= 0.96,
                "{code}"
            );
            assert_eq!(albedo_code(albedo_share(code)), code);
        }
        assert_eq!(albedo_share(255), Share::ONE);
    }

    #[test]
    fn distances_are_logarithms() {
        let mut distance = 1i32;
        while distance < i32::MAX / 2 {
            let exact = (16.0 * (f64::from(distance).log2() - 11.0)).clamp(0.0, 254.0);
            let got = f64::from(depth_code_q8(distance)) / 256.0;
            assert!((got - exact).abs() <= 2.0 / 256.0, "{distance} {got} {exact}");
            distance += distance / 37 + 1;
        }
        for code in 0..=254 {
            let exact = (11.0 + f64::from(code) / 16.0).exp2();
            let got = f64::from(depth_distance(code));
            assert!(
                (got - exact).abs() <= exact / 32768.0 + 1.0,
                "{code} {got} {exact}"
            );
            assert_eq!(depth_code(depth_distance(code)), code);
        }
        assert_eq!(depth_code(i32::MAX), 254);
        assert_eq!(depth_code(-5), 0);
    }

    #[test]
    fn nothing_is_known_by_its_number_by_any_way() {
        let shows_nothing = |id| {
            Feature {
                id,
                ..Feature::default()
            }
            .shows_nothing()
        };
        assert!((0..=8).all(|bounces| shows_nothing(first_id(ID_NOTHING, bounces))));
        assert!(!(0..200).any(shows_nothing));
        assert!(!(1..=8).any(|bounces| (0..200).any(|id| shows_nothing(first_id(id, bounces)))));
    }

    fn sample(bits: [u32; 3], albedo: [u16; 3], id: u16) -> Sample {
        Sample {
            radiance: Radiance::from_bits(bits, -15),
            albedo: Albedo::from_bits(albedo),
            normal: Dir::Y,
            distance: Some(1 << 20),
            id,
        }
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_samples() {
        // A white and a half grey surface under light of 1: irradiance 1 in both, but for
        // what the albedo's byte is off, and no trace of the edge in it.
        let mut sum = Sum::default();
        sum.add(&sample([1 << 15; 3], [1 << 15; 3], 7));
        sum.add(&sample([1 << 14; 3], [1 << 14; 3], 9));
        sum.add(&sample([1 << 14; 3], [1 << 14; 3], 9));
        let pixel = sum.mean();
        assert!(
            value(pixel.irradiance.decode())
                .iter()
                .all(|c| (c - 1.0).abs() < 0.005)
        );
        assert_eq!((pixel.id, pixel.depth), (9, 144));
        let exact = 2.0 / 3.0;
        assert!(value(pixel.radiance()).iter().all(|c| (c - exact).abs() < 0.002));
        assert_eq!(pixel.normal.decode(), Dir::Y);
        // A half grey surface before a black nothing: the pixel's light is the samples' mean.
        let mut sum = Sum::default();
        sum.add(&sample([0; 3], [1 << 15; 3], 7));
        sum.add(&sample([1 << 14; 3], [1 << 14; 3], 9));
        assert!(
            value(sum.mean().radiance())
                .iter()
                .all(|c| (c - 0.25).abs() < 0.001)
        );
        // 0.0405, of which the albedo's byte makes 0.0400.
        let mut sum = Sum::default();
        sum.add(&sample([1327; 3], [1327; 3], 7));
        assert!(
            value(sum.mean().radiance())
                .iter()
                .all(|c| (c - 0.0405).abs() < 0.0001)
        );
        // Black stays black, and is not divided by.
        let mut sum = Sum::default();
        sum.add(&sample([0; 3], [0; 3], 1));
        assert_eq!(sum.mean().radiance(), Radiance::BLACK);
        assert_eq!(sum.mean().albedo, [45; 3]);
        assert_eq!(Sum::default().mean().id, ID_NOTHING);
    }

    #[test]
    fn as_many_samples_as_there_may_be_fit() {
        let mut sum = Sum::default();
        for _ in 0..1 << 16 {
            sum.add(&Sample {
                radiance: Radiance::from_bits([u32::MAX; 3], 100),
                albedo: Albedo::WHITE,
                normal: -Dir::X,
                distance: None,
                id: ID_NOTHING,
            });
        }
        let pixel = sum.mean();
        assert_eq!(pixel.irradiance.0, u32::MAX);
        assert_eq!((pixel.albedo, pixel.depth), ([255; 3], DEPTH_NOTHING));
        assert_eq!(pixel.normal.decode(), -Dir::X);
    }

    #[test]
    fn light_over_albedo_is_a_quotient() {
        let mut state = 9;
        for _ in 0..100_000 {
            let light = Radiance::from_bits([0; 3].map(|_| random(&mut state) >> 8), -20);
            let albedo = floored(Albedo::from_bits(
                [0; 3].map(|_| (random(&mut state) >> 17) as u16),
            ));
            let (exact, got) = (value(light), value(demodulate(light, albedo)));
            let quotient = [0, 1, 2].map(|i| exact[i] * 32768.0 / f64::from(albedo.0[i].to_bits()));
            let largest = quotient.iter().fold(0f64, |m, c| m.max(*c));
            for i in 0..3 {
                assert!(
                    (got[i] - quotient[i]).abs() <= largest / 32768.0,
                    "{quotient:?} {got:?}"
                );
            }
        }
    }
}
