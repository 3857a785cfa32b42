use super::Size;
use super::outline::{MIDDLE, Seen};
use super::weight::{Channels, FALL, FAR, Mean, Turns, shines, words};
use crate::color::{Radiance, Rgb9e5};
use crate::film::Feature;
use crate::geom::Octahedral;
#[cfg(upsamples)]
use crate::num::RECIPS;
#[cfg(upsamples)]
use zerocopy::{transmute_mut, transmute_ref};

#[cfg(upsamples)]
const _: () = assert!(MIDDLE == microlux_asm::MIDDLE);

/// Half-lives, in eighths, that tell neighbours apart: for another number, for a turn by a cosine of 1 − 1/127, for a code
/// of distance, for another albedo. Several samples that met two things have the mean albedo of both, and light of neither.
const UNLIKE: [u32; 4] = [32, 2, 4, 16];

/// From here on nothing is less alike: [`FALL`]'s last that is not 0.
const LEAST: u32 = 48;

/// The light of pixel (x, y) of a picture twice as wide and high, before its albedo.
///
/// Joint bilateral upsampling (Kopf et al., 2007): the four pixels about it, by where they are (9 : 3 : 3 : 1) and how
/// like `guide` they are. Where none of them is of the same thing, those of it among the twelve about them speak; where
/// there is none either, the least unlike of the four speaks most. Black where there is no picture.
pub fn upsample(
    size: Size,
    frame: &[Feature],
    light: &[Rgb9e5],
    [x, y]: [u16; 2],
    guide: &Feature,
) -> Radiance {
    let coarse = Coarse { size, frame, light };
    coarse
        .lines(y)
        .four(x.div_ceil(2))
        .light(coarse, [x, y], guide, &mut Turns::default())
        .radiance()
}

/// The same of a picture three times as wide and high: the four count 4 : 2 : 2 : 1 by where they are; in line with two, these
/// count 6 : 3, and in the middle of one, this alone.
pub fn upsample_3x(
    size: Size,
    frame: &[Feature],
    light: &[Rgb9e5],
    [x, y]: [u16; 2],
    guide: &Feature,
) -> Radiance {
    let coarse = Coarse { size, frame, light };
    let Third { second, .. } = Third::of(x);
    coarse
        .lines_3x(y)
        .four(second)
        .third(coarse, [x, y], guide, &mut Turns::default())
        .radiance()
}

/// Where one of three fine pixels lies, across or down.
struct Third {
    /// Of both coarse pixels about it the second; it itself, where it lies in that one's middle.
    second: u16,
    /// Whether that is the nearer one.
    is_second: bool,
    /// What the nearer and the farther one count.
    shares: [u32; 2],
}

impl Third {
    fn of(c: u16) -> Third {
        let is_left = c % 3 == 2;
        Third {
            second: c / 3 + u16::from(is_left),
            is_second: !is_left,
            shares: if c % 3 == 1 { [3, 0] } else { [2, 1] },
        }
    }
}

/// What is made twice as wide and high.
#[derive(Clone, Copy)]
pub(super) struct Coarse<'a> {
    pub size: Size,
    pub frame: &'a [Feature],
    pub light: &'a [Rgb9e5],
}

impl<'a> Coarse<'a> {
    /// The two rows about fine row y, the one it lies in first.
    pub fn lines(self, y: u16) -> Lines<'a> {
        let far = if y.is_multiple_of(2) {
            (y / 2).saturating_sub(1)
        } else {
            y / 2 + 1
        };
        self.both(y / 2, far)
    }

    /// [`Self::lines`] of three times the height.
    pub fn lines_3x(self, y: u16) -> Lines<'a> {
        let far = match y % 3 {
            0 => (y / 3).saturating_sub(1),
            remainder => y / 3 + remainder - 1,
        };
        self.both(y / 3, far)
    }

    #[inline(always)]
    fn both(self, near: u16, far: u16) -> Lines<'a> {
        let width = self.size.width as usize;
        let last = self.size.height.saturating_sub(1);
        let row = |y: u16| {
            let from = y.min(last) as usize * width;
            let row = from..from + width;
            let (frame, light) = (self.frame.get(row.clone()), self.light.get(row));
            (frame.unwrap_or(&[]), light.unwrap_or(&[]))
        };
        let rows = [row(near), row(far)];
        Lines {
            rows,
            #[cfg(upsamples)]
            routine: microlux_asm::Upsample::new(
                rows.map(|(pixels, _)| transmute_ref!(pixels)),
                rows.map(|(_, light)| transmute_ref!(light)),
                &FALL,
                &RECIPS,
            ),
        }
    }
}

/// Two rows.
pub(super) struct Lines<'a> {
    rows: [(&'a [Feature], &'a [Rgb9e5]); 2],
    #[cfg(upsamples)]
    routine: microlux_asm::Upsample<'a>,
}

impl<'a> Lines<'a> {
    /// Shows fine pixels (2 `k` − 1, y) and (2 `k`, y), whose own first hits are `guides`.
    #[inline(always)]
    pub fn pair(
        &self,
        coarse: Coarse,
        [k, y]: [u16; 2],
        guides: &[Feature; 2],
        turns: &mut Turns,
        shown: &mut [Seen; 2],
    ) {
        #[cfg(upsamples)]
        {
            let left = usize::from(k) - 1;
            let done =
                (self.routine).between(left, transmute_ref!(guides), transmute_mut!(shown), turns.known());
            if done != 3 {
                self.rest(coarse, [k, y], guides, turns, shown, done);
            }
        }
        #[cfg(not(upsamples))]
        {
            let four = self.four(k);
            for ((x, guide), shown) in (2 * k - 1..).zip(guides).zip(shown) {
                *shown = four.shown(coarse, [x, y], guide, turns);
            }
        }
    }

    /// What of [`Self::pair`] is not done: the first but for 1, the second but for 2.
    #[cfg(upsamples)]
    fn rest(
        &self,
        coarse: Coarse,
        [k, y]: [u16; 2],
        guides: &[Feature; 2],
        turns: &mut Turns,
        shown: &mut [Seen; 2],
        done: u32,
    ) {
        for (i, (guide, shown)) in (0..).zip(guides.iter().zip(shown)) {
            if done >> i & 1 == 0 {
                *shown = self.single(coarse, [2 * k - 1 + i, y], guide, turns);
            }
        }
    }

    /// What fine pixel (x, y) shows, by itself.
    #[inline(never)]
    pub fn single(&self, coarse: Coarse, [x, y]: [u16; 2], guide: &Feature, turns: &mut Turns) -> Seen {
        self.four(x.div_ceil(2)).shown(coarse, [x, y], guide, turns)
    }

    /// Shows fine row `y` of three times the size; `guide` answers each pixel's own first hit.
    pub fn thirds(
        &self,
        coarse: Coarse,
        y: u16,
        mut guide: impl FnMut(u16) -> Feature,
        turns: &mut Turns,
        row: &mut [Seen],
    ) {
        // Of the same four: one that is right of the left ones' middle, and two from the right ones' left side to their middle.
        let (first, others) = row.split_at_mut(row.len().min(2));
        let threes = core::iter::once(first).chain(others.chunks_mut(3));
        for (k, three) in (0..).zip(threes) {
            let four = self.four(k);
            let left = (3 * k).saturating_sub(1);
            for (x, shown) in (left..).zip(three) {
                let guide = guide(x);
                let light = four.third(coarse, [x, y], &guide, turns);
                *shown = Seen::new(light.shaded(guide.albedo()), &guide, MIDDLE);
            }
        }
    }

    /// The two pixels of each row about fine columns 2 `k` − 1 and 2 `k`; black where there are none.
    #[inline(always)]
    pub fn four(&self, k: u16) -> Four<'a> {
        let last = self.rows[0].0.len().saturating_sub(1);
        let [left, right] = [k.saturating_sub(1), k].map(|x| (x as usize).min(last));
        let [(near, near_light), (far, far_light)] = self.rows;
        let pixel = |row: &'a [Feature], x: usize| row.get(x).unwrap_or(&NOTHING);
        let light = |row: &[Rgb9e5], x: usize| row.get(x).copied().unwrap_or_default();
        let pixels = [
            pixel(near, left),
            pixel(far, left),
            pixel(near, right),
            pixel(far, right),
        ];
        let lights = [
            light(near_light, left),
            light(far_light, left),
            light(near_light, right),
            light(far_light, right),
        ];
        let mut mean = Mean::new();
        lights.iter().for_each(|light| mean.see(*light));
        let [a, b, c, d] = pixels.map(words);
        let seen = (a[0] ^ b[0]) | (a[0] ^ c[0]) | (a[0] ^ d[0]);
        let is_painted_alike = u32::from_le(seen) << 8 == 0;
        let is_one = (a[1] ^ b[1]) | (a[1] ^ c[1]) | (a[1] ^ d[1]) == 0
            && !(shines(a[0]) || shines(b[0]) || shines(c[0]) || shines(d[0]));
        let is_even = is_one && seen == 0;
        let mut down = [[0; 3]; 2];
        if is_even {
            for (down, [near, far]) in down
                .iter_mut()
                .zip([[lights[0], lights[1]], [lights[2], lights[3]]])
            {
                *down = three_to_one(mean.parts(near), mean.parts(far));
            }
        }
        Four {
            pixels,
            lights,
            mean,
            down,
            is_one,
            is_painted_alike,
            is_even,
        }
    }
}

/// Sums by 3 : 1.
#[inline(always)]
fn three_to_one(near: [u32; 3], far: [u32; 3]) -> [u32; 3] {
    [0, 1, 2].map(|i| 3 * near[i] + far[i])
}

/// What stands where there is no pixel.
static NOTHING: Feature = Feature {
    irradiance: Rgb9e5::BLACK,
    albedo: [0; 3],
    depth: 0,
    normal: Octahedral([0; 2]),
    id: 0,
};

/// Four pixels, the left ones and the right ones, of each the one of the row that the fine pixels lie in first.
pub(super) struct Four<'a> {
    pixels: [&'a Feature; 4],
    lights: [Rgb9e5; 4],
    /// Of nothing yet; has seen them.
    mean: Mean,
    /// Sums of the left and of the right lights by 3 : 1, if all pixels are alike.
    down: [[u32; 3]; 2],
    /// Whether all have one number and look the same way, and none shines.
    is_one: bool,
    /// Whether all have one albedo, which then tells none apart.
    is_painted_alike: bool,
    /// Whether all are alike but for their light.
    is_even: bool,
}

impl Four<'_> {
    /// What fine pixel (x, y) shows, one of the two they are about.
    #[inline(always)]
    pub fn shown(&self, coarse: Coarse, place: [u16; 2], guide: &Feature, turns: &mut Turns) -> Seen {
        let light = self.light(coarse, place, guide, turns).shaded(guide.albedo());
        Seen::new(light, guide, MIDDLE)
    }

    /// The light of fine pixel (x, y), one of the two they are about.
    #[inline(always)]
    pub fn light(&self, coarse: Coarse, [x, y]: [u16; 2], guide: &Feature, turns: &mut Turns) -> Channels {
        let right = usize::from(x.is_multiple_of(2));
        let [seen, looks] = words(guide);
        let first = self.pixels[0];
        if self.is_even
            && looks == words(first)[1]
            && guide.depth == first.depth
            && !shines(seen)
            && let Some(light) = (self.mean).sixteenths(three_to_one(self.down[right], self.down[1 - right]))
        {
            return light;
        }
        let first = [x, y].map(|c| c.div_ceil(2).into());
        self.weighed(coarse, first, right, [9, 3, 3, 1], guide, turns)
    }

    /// The same of three times the size.
    #[inline(always)]
    pub fn third(&self, coarse: Coarse, place: [u16; 2], guide: &Feature, turns: &mut Turns) -> Channels {
        let [across, down] = place.map(Third::of);
        let ([a, b], [near, far]) = (across.shares, down.shares);
        let shares = [a * near, b * near, a * far, b * far];
        let second = [across.second, down.second].map(i32::from);
        self.weighed(coarse, second, across.is_second.into(), shares, guide, turns)
    }

    /// The mean of the four by these shares, the nearest one's first, then that of the other one in its row; and by how like
    /// `guide` they are. `second` is the lower right one's place.
    #[inline(always)]
    fn weighed(
        &self,
        coarse: Coarse,
        second: [i32; 2],
        right: usize,
        shares: [u32; 4],
        guide: &Feature,
        turns: &mut Turns,
    ) -> Channels {
        let [seen, looks] = words(guide);
        let near = 2 * right;
        let order = [near, 2 - near, near + 1, 3 - near];
        let pixels = order.map(|i| self.pixels[i]);
        let lights = order.map(|i| self.lights[i]);
        let [a, b, c, d] = pixels;
        let mut apart = [apart(a, guide), apart(b, guide), apart(c, guide), apart(d, guide)];
        if !self.is_painted_alike {
            for (apart, pixel) in apart.iter_mut().zip(pixels) {
                *apart += repainted(pixel, guide);
            }
        }
        let is_one = self.is_one
            && looks == words(a)[1]
            && !shines(seen)
            && (apart[0] | apart[1] | apart[2] | apart[3]) < UNLIKE[0];
        let weights = if is_one {
            // Each is under 32.
            apart.map(|unlike| FALL[unlike as usize & 31])
        } else {
            let unlike = [
                unlike(a, guide, turns),
                unlike(b, guide, turns),
                unlike(c, guide, turns),
                unlike(d, guide, turns),
            ];
            let is_other = |(&unlike, &share): (&u32, &u32)| unlike >= UNLIKE[0] || share == 0;
            if unlike.iter().zip(&shares).all(is_other)
                && let Some(light) = about(coarse, second, guide, turns)
            {
                return light;
            }
            // Never nothing.
            unlike.map(|unlike| FALL[unlike.min(LEAST) as usize])
        };
        let mut mean = self.mean.anew();
        for ((light, share), weight) in lights.into_iter().zip(shares).zip(weights) {
            mean.add(light, share * u32::from(weight));
        }
        mean.channels()
    }
}

/// Of the sixteen about four whose lower right one is `second`, those that are of the guide's thing.
#[cold]
fn about(coarse: Coarse, second: [i32; 2], guide: &Feature, turns: &mut Turns) -> Option<Channels> {
    let first = second.map(|c| c - 2);
    let mut mean = Mean::new();
    alike(coarse, first, guide, turns, |light, _| mean.see(light));
    alike(coarse, first, guide, turns, |light, weight| {
        mean.add(light, weight)
    });
    (mean.weight() > 0).then(|| mean.channels())
}

/// Light and weight of those of 4 × 4 pixels that are of the guide's thing.
fn alike(
    coarse: Coarse,
    [left, top]: [i32; 2],
    guide: &Feature,
    turns: &mut Turns,
    mut each: impl FnMut(Rgb9e5, u32),
) {
    let Coarse { size, frame, light } = coarse;
    let rows = top.max(0)..(top + 4).min(size.height.into());
    let columns = left.max(0)..(left + 4).min(size.width.into());
    for place in rows.flat_map(|y| {
        columns
            .clone()
            .map(move |x| (y * i32::from(size.width) + x) as usize)
    }) {
        if let (Some(pixel), Some(light)) = (frame.get(place), light.get(place)) {
            let unlike = unlike(pixel, guide, turns);
            if unlike < UNLIKE[0] {
                each(*light, FALL[unlike as usize].into());
            }
        }
    }
}

/// Eighths of a half-life; from [`LEAST`] on, as many at least.
#[inline]
fn unlike(pixel: &Feature, guide: &Feature, turns: &mut Turns) -> u32 {
    let ([tap_seen, tap_looks], [seen, looks]) = (words(pixel), words(guide));
    if shines(tap_seen) != shines(seen) {
        return FAR;
    }
    let differs = u32::from_le(tap_looks ^ looks);
    let id = if differs >> 16 == 0 { 0 } else { UNLIKE[0] };
    let unlike = apart(pixel, guide) + repainted(pixel, guide) + id;
    // To look another way makes no difference any more, or most look the same way, to the last bit.
    if unlike >= LEAST {
        unlike
    } else {
        unlike + turns.of(pixel, guide) * UNLIKE[1]
    }
}

/// [`unlike`] by distance alone.
#[inline(always)]
fn apart(pixel: &Feature, guide: &Feature) -> u32 {
    u32::from(pixel.depth.abs_diff(guide.depth)) * UNLIKE[2]
}

/// [`unlike`] by albedo alone.
#[inline(always)]
fn repainted(pixel: &Feature, guide: &Feature) -> u32 {
    let differs = u32::from_le(words(pixel)[0] ^ words(guide)[0]) << 8;
    if differs == 0 { 0 } else { UNLIKE[3] }
}
