//! What changes from frame to frame that should not.

use crate::animate::between;
use crate::picture::{compressed, srgb};

/// sRGB signals of x / (1 + x), a pixel each.
pub type Signals = Vec<[f64; 3]>;

/// Where each pixel was in the frame before; `None` where it was not to be seen.
pub type Befores = Vec<Option<[f64; 2]>>;

pub fn signals(light: &[[f32; 3]]) -> Signals {
    let one = |rgb: &[f32; 3]| compressed(*rgb).map(|c| srgb(f64::from(c)));
    light.iter().map(one).collect()
}

/// The change of each pixel since it was where `before` says.
fn changes(
    size: [usize; 2],
    [then, now]: [&Signals; 2],
    before: &Befores,
) -> impl Iterator<Item = Option<[f64; 3]>> {
    now.iter().zip(before).map(move |(now, before)| {
        let was = between(size, (*before)?, |i| then[i]);
        Some([0, 1, 2].map(|c| now[c] - was[c]))
    })
}

/// Root of the mean of (Δ − Δa)(Δ − Δb): how much the error changes along the motion.
///
/// Δ is the change of a pixel's signal since the frame before, followed to where it was; Δa and Δb are the same of two
/// references with noise of their own, which their product has not in the mean. `befores` has one entry less than there
/// are frames.
pub fn flicker(
    [width, height]: [usize; 2],
    frames: &[Signals],
    halves: &[[Signals; 2]],
    befores: &[Befores],
) -> f64 {
    let (mut sum, mut count) = (0.0, 0usize);
    for (number, before) in befores.iter().enumerate() {
        let size = [width, height];
        let own = changes(size, [&frames[number], &frames[number + 1]], before);
        let [then, now] = [&halves[number], &halves[number + 1]];
        let first = changes(size, [&then[0], &now[0]], before);
        let second = changes(size, [&then[1], &now[1]], before);
        for ((own, first), second) in own.zip(first).zip(second) {
            let (Some(own), Some(first), Some(second)) = (own, first, second) else {
                continue;
            };
            sum += (0..3)
                .map(|c| (own[c] - first[c]) * (own[c] - second[c]))
                .sum::<f64>();
            count += 3;
        }
    }
    (sum / count.max(1) as f64).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [16, 8];

    fn picture(shift: f64, noise: impl Fn(usize) -> f64) -> Signals {
        let value = |i: usize| 0.5 + 0.02 * ((i % SIZE[0]) as f64 + shift) + noise(i);
        (0..SIZE[0] * SIZE[1]).map(|i| [value(i); 3]).collect()
    }

    /// Each pixel was one to the right of where it is; nothing was where the picture ends.
    fn moved() -> Befores {
        let place = |i: usize| {
            let (x, y) = (i % SIZE[0], i / SIZE[0]);
            (x + 1 < SIZE[0]).then_some([x as f64 + 1.5, y as f64 + 0.5])
        };
        (0..SIZE[0] * SIZE[1]).map(place).collect()
    }

    fn random(seed: u32) -> impl Fn(usize) -> f64 {
        move |i| {
            let state = (i as u32 + seed * 977)
                .wrapping_mul(747_796_405)
                .wrapping_add(12345);
            let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
            f64::from(word >> 8) / f64::from(1 << 24) - 0.5
        }
    }

    #[test]
    fn what_moves_does_not_flicker_and_what_changes_does() {
        let still = |_: usize| 0.0;
        let truth = [0.0, 1.0].map(|shift| [picture(shift, still), picture(shift, still)]);
        let of = |frames: [Signals; 2], befores: Befores| flicker(SIZE, &frames, &truth, &[befores]);
        assert!(of([picture(0.0, still), picture(1.0, still)], moved()) < 1e-12);
        // A frame that is brighter by 0.1 than it should be, and one that always is.
        assert!((of([picture(0.0, still), picture(1.0, |_| 0.1)], moved()) - 0.1).abs() < 1e-12);
        assert!(of([picture(0.0, |_| 0.1), picture(1.0, |_| 0.1)], moved()) < 1e-12);
        // Light that stays where it was on the screen lags behind what moves.
        assert!((of([picture(0.0, still), picture(0.0, still)], moved()) - 0.02).abs() < 1e-12);
    }

    #[test]
    fn the_references_noise_is_not_counted() {
        let noisy = |frame: u32, half: u32| {
            let random = random(2 * frame + half + 1);
            picture(f64::from(frame), move |i| 0.4 * random(i))
        };
        let truth = [0, 1].map(|frame| [noisy(frame, 0), noisy(frame, 1)]);
        let frames = [picture(0.0, |_| 0.0), picture(1.0, |_| 0.1)];
        let found = flicker(SIZE, &frames, &truth, &[moved()]);
        assert!((found - 0.1).abs() < 0.03, "{found}");
        let one = [
            [truth[0][0].clone(), truth[0][0].clone()],
            [truth[1][0].clone(), truth[1][0].clone()],
        ];
        assert!(
            flicker(SIZE, &frames, &one, &[moved()]) > 0.15,
            "the same half twice has its noise"
        );
    }
}
