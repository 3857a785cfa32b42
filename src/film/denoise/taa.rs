//! Temporal antialiasing: each pixel half of what is shown now, half of what was shown in its place before.
//!
//! What changes from frame to frame and should not, outlines that each frame's samples place anew and what the filter left of
//! the noise, is so worth a half, a quarter, and so on. What was before is held within the least and the most that the
//! 3 × 3 of now have, by channel, so that nothing lingers (Karis, "High-Quality Temporal Supersampling", 2014).

use super::outline::{Row, Seen, tone};
use super::weight::Mean;
use super::{Reproject, Size};
use crate::color::Rgb9e5;

/// The picture that was shown before.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a, M> {
    pub size: Size,
    /// A pixel each.
    pub lights: &'a [Rgb9e5],
    /// Between pictures of this size.
    pub motion: &'a M,
}

impl<M: Reproject> Shown<'_, M> {
    /// What was shown where the middle of pixel (x, y) was, a straight line between middles; `None` beside the picture.
    fn before(&self, x: u16, y: u16, depth: u8) -> Option<Rgb9e5> {
        let place = self.motion.before(x, y, depth)?.place;
        let size = [self.size.width, self.size.height].map(i32::from);
        if (0..2).any(|i| !(0..16 * size[i]).contains(&place[i])) {
            return None;
        }
        let corner = place.map(|c| c - 8);
        let part = corner.map(|c| (c & 15) as u32);
        let at = |dx: i32, dy: i32| {
            let [x, y] =
                [(0, dx), (1, dy)].map(|(i, d)| ((corner[i] >> 4) + d).clamp(0, size[i] - 1) as usize);
            self.lights.get(y * size[0] as usize + x).copied()
        };
        let taps = [at(0, 0)?, at(1, 0)?, at(0, 1)?, at(1, 1)?];
        let [[left, right], [up, down]] = part.map(|part| [16 - part, part]);
        let shares = [left * up, right * up, left * down, right * down];
        Some(mixed(taps.into_iter().zip(shares)))
    }
}

impl Row<'_> {
    /// As [`Self::lights`], each half of what was `shown` in its place; `y` is the row's number.
    ///
    /// They are the picture that was shown before when the next one comes.
    pub fn steadied<M: Reproject>(&self, y: u16, shown: &Shown<M>) -> impl Iterator<Item = Rgb9e5> {
        (0..self.len()).map(move |x| {
            let near = self.near(x);
            let own = self.light(x, &near);
            let nearest = near.iter().flatten().map(|seen| seen.depth()).min();
            match nearest.and_then(|depth| shown.before(x as u16, y, depth)) {
                Some(was) => {
                    let was = held(was, &near);
                    mixed([own, was].into_iter().map(|light| (light, tone(light))))
                }
                None => own,
            }
        })
    }
}

/// A weighted mean, of weights that add up to 256 at most.
fn mixed(lights: impl Iterator<Item = (Rgb9e5, u32)> + Clone) -> Rgb9e5 {
    let mut mean = Mean::new();
    for (light, weight) in lights.clone() {
        if weight > 0 {
            mean.see(light);
        }
    }
    for (light, weight) in lights {
        if weight > 0 {
            mean.add(light, weight);
        }
    }
    mean.light()
}

/// `was`, its channels between the least and the most of the others'; as it was, to the last bit, where it is.
fn held(was: Rgb9e5, near: &[[&Seen; 3]; 3]) -> Rgb9e5 {
    let others = || near.iter().flatten().map(|seen| seen.light());
    let top = others().fold(was.to_parts().1, |top, light| top.max(light.to_parts().1));
    // Under 2^31, in 2^22ths of the largest unit.
    let wide = |light: Rgb9e5| {
        let (m, exponent) = light.to_parts();
        m.map(|m| (m << 22) >> (top - exponent))
    };
    let bits = wide(was);
    let (mut least, mut most) = ([u32::MAX; 3], [0; 3]);
    for light in others().map(wide) {
        for i in 0..3 {
            least[i] = light[i].min(least[i]);
            most[i] = light[i].max(most[i]);
        }
    }
    let within = [0, 1, 2].map(|i| bits[i].clamp(least[i], most[i]));
    if (0..3).all(|i| within[i] == bits[i]) {
        was
    } else {
        Rgb9e5::from_bits(within, top - 22)
    }
}
