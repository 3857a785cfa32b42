//! Half of what is shown, half of what was: against f64, and at the ends of the range.

use crate::{Random, Shift, value};
use microlux::color::{Radiance, Rgb9e5};
use microlux::film::Feature;
use microlux::film::denoise::{Clean, Seen, Shown, Size};
use microlux::geom::{Dir, Octahedral};

const SIZE: Size = Size {
    width: 20,
    height: 12,
};

fn light(levels: [f64; 3]) -> Rgb9e5 {
    Rgb9e5::encode(Radiance::from_bits(
        levels.map(|level| (level * 65536.0) as u32),
        -16,
    ))
}

/// A picture of one thing, so that no outline is mixed; its albedo is 1.
fn frame(lights: &[Rgb9e5]) -> Vec<Feature> {
    let pixel = |&irradiance: &Rgb9e5| Feature {
        irradiance,
        albedo: [255; 3],
        depth: 90,
        normal: Octahedral::encode(Dir::Z),
        id: 1,
    };
    lights.iter().map(pixel).collect()
}

/// What is shown now after `before`, everything having been `motion` to the right and down, sixteenths.
fn steadied(now: &[Rgb9e5], before: &[Rgb9e5], motion: [i32; 2]) -> Vec<Rgb9e5> {
    steadied_frame(&frame(now), now, before, motion)
}

fn steadied_frame(frame: &[Feature], now: &[Rgb9e5], before: &[Rgb9e5], motion: [i32; 2]) -> Vec<Rgb9e5> {
    let lengths = vec![1; now.len()];
    let clean = Clean {
        size: SIZE,
        frame,
        light: now,
        lengths: &lengths,
        spp: 1,
        whole: 1,
    };
    let shown = Shown {
        size: SIZE,
        lights: before,
        motion: &Shift(motion),
    };
    let mut ring = [Seen::default(); 3 * SIZE.width as usize];
    let mut out = Vec::new();
    clean.rows(0..SIZE.height, &mut ring, |y, row| {
        out.extend(row.steadied(y, &shown))
    });
    out
}

/// Lights of up to `most`, by octaves.
fn noise(random: &mut Random, most: f64) -> Vec<Rgb9e5> {
    let mut level = || most * f64::from(random.below(1 << 16)) / 65536.0;
    (0..SIZE.pixels())
        .map(|_| light([level(), level(), level()]))
        .collect()
}

fn at(picture: &[Rgb9e5], x: i32, y: i32) -> [f64; 3] {
    let [width, height] = [SIZE.width, SIZE.height].map(i32::from);
    value(picture[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize].decode())
}

fn tone(light: [f64; 3]) -> f64 {
    1.0 / (1.0 + (54.0 * light[0] + 183.0 * light[1] + 19.0 * light[2]) / 256.0)
}

/// The same in f64, and the step from what is to what was; `None` where that lay beside the picture.
fn real(now: &[Rgb9e5], before: &[Rgb9e5], motion: [i32; 2], x: i32, y: i32) -> Option<[[f64; 3]; 2]> {
    let [width, height] = [SIZE.width, SIZE.height].map(i32::from);
    let place = [16 * x + 8 + motion[0], 16 * y + 8 + motion[1]];
    if !(0..16 * width).contains(&place[0]) || !(0..16 * height).contains(&place[1]) {
        return None;
    }
    let [px, py] = place.map(|c| f64::from(c) / 16.0 - 0.5);
    let mut was = [0.0; 3];
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let (tx, ty) = (px.floor() as i32 + dx, py.floor() as i32 + dy);
        let share = (1.0 - (px - f64::from(tx)).abs()) * (1.0 - (py - f64::from(ty)).abs());
        let tap = at(before, tx, ty);
        was = [0, 1, 2].map(|i| was[i] + share * tap[i]);
    }
    let near = || (0..9).map(|i| at(now, x + i % 3 - 1, y + i / 3 - 1));
    let held = [0, 1, 2].map(|i| {
        let least = near().map(|light| light[i]).fold(f64::INFINITY, f64::min);
        let most = near().map(|light| light[i]).fold(0.0, f64::max);
        was[i].clamp(least, most)
    });
    let own = at(now, x, y);
    let (a, b) = (tone(own), tone(held));
    let mean = [0, 1, 2].map(|i| (a * own[i] + b * held[i]) / (a + b));
    Some([mean, [0, 1, 2].map(|i| (held[i] - own[i]).abs())])
}

#[test]
fn it_is_the_same_in_real_numbers() {
    let mut random = Random(5);
    for most in [1.0 / 64.0, 1.0, 8.0] {
        let (now, before) = (noise(&mut random, most), noise(&mut random, most));
        for motion in [[0, 0], [3, -5], [-16, 40], [-21, 7], [200, 100]] {
            let made = steadied(&now, &before, motion);
            for (i, made) in (0..).zip(made) {
                let (x, y) = (i % i32::from(SIZE.width), i / i32::from(SIZE.width));
                let Some([meant, step]) = real(&now, &before, motion, x, y) else {
                    assert_eq!(made, now[i as usize], "{motion:?} {x} {y}");
                    continue;
                };
                let made = value(made.decode());
                let largest = meant.iter().copied().fold(0.0, f64::max);
                for c in 0..3 {
                    // Nine bits of the largest; shares of lights whose luminance is told to an eighth of an octave.
                    let bound = largest / 128.0 + 0.06 * step[c];
                    assert!(
                        (made[c] - meant[c]).abs() <= bound,
                        "{motion:?} {x} {y}: {made:?} {meant:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn what_does_not_change_stays_to_the_last_bit() {
    let mut random = Random(6);
    for most in [1.0 / 4096.0, 1.0, 60_000.0] {
        let picture = noise(&mut random, most);
        assert_eq!(steadied(&picture, &picture, [0, 0]), picture);
    }
}

#[test]
fn nothing_lingers() {
    let mut random = Random(7);
    let (dark, bright) = (
        noise(&mut random, 1.0 / 16.0),
        vec![light([9.0, 0.0, 3.0]); SIZE.pixels()],
    );
    for (i, made) in (0..).zip(steadied(&dark, &bright, [9, 2])) {
        let (x, y) = (i % i32::from(SIZE.width), i / i32::from(SIZE.width));
        let made = value(made.decode());
        for (c, made) in made.into_iter().enumerate() {
            let near = (0..9).map(|i| at(&dark, x + i % 3 - 1, y + i / 3 - 1)[c]);
            // A step of the largest channel's nine bits more.
            assert!(made <= near.fold(0.0, f64::max) + 1.0 / 4096.0, "{x} {y} {c}");
        }
    }
}

/// No picture that long: nothing is mixed, and nothing fails.
#[test]
fn a_picture_that_is_too_short_is_none() {
    let now = noise(&mut Random(8), 1.0);
    assert_eq!(steadied(&now, &[], [0, 0]), now);
}
