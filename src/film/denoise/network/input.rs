use super::Row;
use crate::color::Rgb9e5;
use crate::film::Feature;
use crate::film::denoise::weight::{luma_code, words};
use crate::film::feature::DEPTH_NOTHING;
use crate::geom::Octahedral;
use crate::num::leading_zeros;

/// Numbers that the network sees of a pixel.
pub const INPUTS: usize = 11;
/// The first of them: its light, which is seen of its neighbours, too.
pub const LIGHTS: usize = 3;
/// The others, which are seen of the pixel alone.
pub(super) const OWN: usize = INPUTS - LIGHTS;

/// What the network sees of a pixel, 6 bits each: the logarithm of its irradiance, albedo, normal, depth, samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input(pub(super) [u8; INPUTS]);

impl Input {
    /// Of a pixel's feature, how many samples are in its mean (0 counts as 1), and the frame's [`exposure`].
    pub fn new(feature: &Feature, samples: u32, exposure: i32) -> Input {
        let [i0, i1, i2, depth] = bright(feature, exposure.clamp(-8, 8)).to_le_bytes();
        let [a0, a1, a2] = feature.albedo.map(|a| a >> 2);
        let [n0, n1, n2, _] = direction(feature.normal);
        Input([i0, i1, i2, a0, a1, a2, n0, n1, n2, depth, counted(samples) as u8])
    }

    /// Of the numbers themselves; those over 63 count as 63.
    pub fn from_bits(bits: [u8; INPUTS]) -> Input {
        Input(bits.map(|b| b.min(63)))
    }

    pub fn to_bits(self) -> [u8; INPUTS] {
        self.0
    }

    /// As [`beside`] has them.
    pub(super) fn own(self) -> [u32; 2] {
        let [_, _, _, a0, a1, a2, n0, n1, n2, depth, s] = self.0;
        if s == 0 {
            return [0; 2];
        }
        [[a0, a1, a2, n0], [n1, n2, depth, s]].map(u32::from_le_bytes)
    }

    /// As [`Row::fill`] takes it.
    pub(super) fn words(self) -> [u32; 3] {
        let [i0, i1, i2, a0, a1, a2, n0, n1, n2, depth, s] = self.0;
        [[i0, i1, i2, depth], [a0, a1, a2, n0], [n1, n2, s, 0]].map(u32::from_le_bytes)
    }
}

/// A row of [`Input`]s of the `frame` from its first pixel on, and of no samples where there is none; `samples` are in the mean
/// of the row's pixel number i.
pub(super) fn see(frame: &[Feature], samples: impl Fn(usize) -> u32, exposure: i32, row: Row) {
    // Of no pixel.
    let mut before = [u32::MAX; 3];
    let mut facing = 0;
    row.fill(|x| {
        let Some(pixel) = frame.get(x) else {
            let [bright, still @ ..] = Input::new(&Feature::default(), 0, exposure).words();
            return (bright, Some(still));
        };
        // Pixels side by side often look the same way, and are of one thing.
        let [albedo, normal] = words(pixel).map(u32::from_le);
        let own = [albedo & 0xfc_fcfc, normal & 0xffff, samples(x)];
        let [matt, turned, counts] = core::array::from_fn(|i| own[i] ^ before[i]);
        before = own;
        let bright = bright(pixel, exposure);
        if matt | turned | counts == 0 {
            return (bright, None);
        }
        if turned != 0 {
            facing = u32::from_le_bytes(direction(pixel.normal));
        }
        let still = [own[0] >> 2 | facing << 24, facing >> 8 | counted(own[2]) << 16];
        (bright, Some(still))
    });
}

/// A pixel of the finest size as its head is made of: four activations, then its own inputs.
pub(super) type Wide = [u32; 3];

/// The own inputs of a row of the `frame` from its first pixel on, beside its activations; of no pixel, and of one whose light is
/// of one sample, they are 0. `samples` are in the mean of the row's pixel number i.
pub(super) fn beside(frame: &[Feature], samples: impl Fn(usize) -> u32, row: &mut [Wide]) {
    let mut before = [u32::MAX; 2];
    let (mut facing, mut count) = (0, 0);
    for (x, [_, own @ ..]) in row.iter_mut().enumerate() {
        let samples = samples(x);
        let Some(pixel) = frame.get(x).filter(|_| samples > 1) else {
            *own = [0; 2];
            continue;
        };
        let [albedo, normal] = words(pixel).map(u32::from_le);
        let now = [normal & 0xffff, samples];
        if now != before {
            facing = u32::from_le_bytes(direction(pixel.normal));
            count = counted(samples);
            before = now;
        }
        *own = [
            albedo >> 2 & 0x3f_3f3f | facing << 24,
            facing >> 8 | u32::from(depth(pixel) >> 2) << 16 | count << 24,
        ];
    }
}

/// Bytes: the logarithm of irradiance, depth.
#[inline(always)]
fn bright(feature: &Feature, exposure: i32) -> u32 {
    let light = feature.irradiance;
    let logarithms = if light.0 << 5 == 0 {
        0
    } else {
        logarithms(light, exposure)
    };
    logarithms | u32::from(depth(feature) >> 2) << 24
}

/// A sky is one, wherever it is seen.
#[inline(always)]
fn depth(feature: &Feature) -> u8 {
    if feature.shows_nothing() {
        DEPTH_NOTHING
    } else {
        feature.depth
    }
}

/// Bytes: the logarithm of irradiance. A core of few registers has them for it.
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline(always))]
fn logarithms(irradiance: Rgb9e5, exposure: i32) -> u32 {
    // Within seven octaves.
    let [r, g, b] = scaled(irradiance, exposure).map(|c| logarithm((1 << 12) + (c << 3), 12));
    r | g << 8 | b << 16
}

/// The logarithm of how many samples there are.
fn counted(samples: u32) -> u32 {
    logarithm(samples.max(1), 0).min(63)
}

/// [−1, 1] onto 0 ..= 63, rounded; and 0.
#[inline(never)]
fn direction(normal: Octahedral) -> [u8; 4] {
    let parts = normal.decode().0;
    let [x, y, z] = parts.map(|c| ((c.clamp(-(1 << 16), 1 << 16) * 63 + (64 << 16)) >> 17) as u8);
    [x, y, z, 0]
}

/// A pixel's irradiance as the filter takes it: Q12, at most 16.
pub fn irradiance(feature: &Feature) -> [u16; 3] {
    scaled(feature.irradiance, 0).map(|c| c as u16)
}

/// By how many octaves the network sees a frame brighter than it is, so that what is seen in it has a luminance of about
/// 1 (geometric mean; what is black or infinitely far away does not count). −8 ..= 8.
pub fn exposure(frame: &[Feature]) -> i32 {
    let (mut sum, mut count) = (0u64, 0u64);
    // raw: codes have 8 bits.
    for pixels in frame.chunks(1 << 16) {
        let (mut part, mut lit) = (0u32, 0u32);
        for pixel in pixels.iter().filter(|pixel| !pixel.shows_nothing()) {
            let code = luminance(pixel.irradiance);
            part += u32::from(code);
            lit += u32::from(code > 0);
        }
        sum += u64::from(part);
        count += u64::from(lit);
    }
    // Eighths of an octave, 1 for 2^-15; whole octaves, to nearest.
    match sum.checked_div(count) {
        Some(mean) => ((15 * 8 + 5 - mean as i32) >> 3).clamp(-8, 8),
        None => 0,
    }
}

/// [`luma_code`]. A core of few registers has them for it.
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline(always))]
fn luminance(light: Rgb9e5) -> u8 {
    luma_code(light)
}

/// `exposure` octaves brighter, of −8 ..= 8, Q12, at most 16.
#[inline(always)]
fn scaled(irradiance: Rgb9e5, exposure: i32) -> [u32; 3] {
    let (mantissas, exponent) = irradiance.to_parts();
    let shift = exponent + 12 + exposure;
    mantissas.map(|m| {
        // raw: mantissas have 9 bits.
        if shift >= 0 {
            (m << shift.min(16)).min(0xffff)
        } else {
            (((m << 1) >> shift.unsigned_abs().min(31)) + 1) >> 1
        }
    })
}

/// 9 · log2(x / 2^`one`) of an x that is not under 2^`one`, rounded down; between powers of two a straight line (0.086 of an
/// octave off at most).
#[inline(always)]
fn logarithm(x: u32, one: u32) -> u32 {
    let zeros = leading_zeros(x >> one);
    // Q16: an octave, and how far to the next; then whole octaves.
    let fraction = (x << (zeros - one)) >> 15;
    ((fraction + (30 << 16) - (zeros << 16)) * 9) >> 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Radiance;
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
    fn what_is_beside_activations_is_an_inputs_own() {
        let mut state = 5u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            state ^ (state >> 15)
        };
        // Side by side often alike but for one thing.
        let mut frame = [Feature::default(); 400];
        let mut samples = [0; 400];
        for at in 1..frame.len() {
            (frame[at], samples[at]) = (frame[at - 1], samples[at - 1]);
            let [a, b, c, d] = random().to_le_bytes();
            match random() % 6 {
                0 => frame[at].albedo = [a, b, c],
                1 => frame[at].normal = Octahedral([a as i8, b as i8]),
                2 => frame[at].depth = [a, DEPTH_NOTHING][usize::from(b & 1)],
                3 => frame[at].id = [u16::from(a), ID_NOTHING, first_id(ID_NOTHING, 1)][usize::from(d % 3)],
                4 => samples[at] = u32::from(d % 5),
                _ => {}
            }
        }
        let mut row = [[7; 3]; 402];
        beside(&frame, |x| samples.get(x).copied().unwrap_or(9), &mut row);
        for (at, [first, own @ ..]) in row.into_iter().enumerate() {
            let wanted = frame.get(at).map(|pixel| Input::new(pixel, samples[at], 0).own());
            assert_eq!((first, own), (7, wanted.unwrap_or([0; 2])), "{at}");
        }
        let counts = [0, 1, 2].map(|samples| Input::new(&frame[399], samples, 0).own() == [0; 2]);
        assert_eq!(counts, [true, true, false]);
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
