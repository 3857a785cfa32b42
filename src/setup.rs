//! Scenes from `f32` metres and degrees, on the device (feature `micromath`).
//!
//! For firmware that reads its numbers from a user or a sensor. It runs while a scene is made; nothing after that has
//! a float in it. Where numbers are known beforehand, [`q!`](crate::q) costs nothing and needs no feature.
//!
//! ```
//! use microlux::camera::Camera;
//! use microlux::geom::Unit;
//! use microlux::setup;
//! use microlux::shape::Sphere;
//!
//! let unit = Unit::DEFAULT;
//! let ball = Sphere::new(setup::point(unit, [0.0, 1.0, -3.0]), setup::length(unit, 0.75));
//! let eye = setup::point(unit, [0.0, 1.0, 2.0]);
//! let camera = Camera::look_at(eye, ball.center, [0, 1, 0], setup::tan_half(40.0));
//! assert!(camera.is_some());
//! ```
//!
//! micromath brings the rounding that `core` lacks. Tangents and the lengths of vectors are left to the core's own
//! integers, [`Camera::tan_half`] and [`Dir::new`]: up to 120° they are right to 5e-5 and 4.6e-5, where micromath's
//! `tan` is off by 1e-3 and more, and its `sqrt` by some per cent.

#![allow(
    clippy::disallowed_types,
    clippy::float_arithmetic,
    clippy::float_cmp,
    clippy::float_cmp_const,
    reason = "set-up from f32 is what this module is for; no module that renders may use it"
)]

use crate::camera::Camera;
use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, Point, REACH, Unit};
use crate::num::{Share, Turn};
use fixed::types::I12F20;
use micromath::F32Ext;

/// A length in units, rounded to nearest, held within ±2·[`REACH`] as [`Unit::length`] does.
///
/// Error ½ unit. What is not a number counts as 0.
pub fn length(unit: Unit, metres: f32) -> i32 {
    let units = F32Ext::round(metres * power_of_two(unit.fraction_bits()));
    (units as i32).clamp(-2 * REACH, 2 * REACH)
}

/// A point from metres: [`length`] of each coordinate.
pub fn point(unit: Unit, metres: [f32; 3]) -> Point {
    Point(metres.map(|m| length(unit, m)))
}

/// The way a vector of any length points; `None` for nothing, and for what is not finite.
///
/// As exact as [`Dir::new`]: right to 1.3e-5 rad.
pub fn dir(v: [f32; 3]) -> Option<Dir> {
    let largest = v.iter().fold(0.0, |a: f32, c| a.max(c.abs()));
    if !v.iter().all(|c| c.is_finite()) || largest == 0.0 {
        return None;
    }
    // The largest component becomes 2^29 ..< 2^30; vectors shorter than 2^-96 lose bits, then vanish.
    let scale = power_of_two(29 - exponent(largest).max(-96));
    Dir::new(v.map(|c| (c * scale) as i32))
}

/// An angle in turns, wrapping: −90° is ¾ turn.
///
/// Error 2^-24 of the angle and 2^-25 of a turn, for angles under 2^22 turns. What is not a number counts as 0.
pub fn turn(degrees: f32) -> Turn {
    let turns = degrees / 360.0;
    let part = turns - F32Ext::floor(turns);
    // A tiny negative angle rounds to a whole turn, which is none.
    Turn::from_bits((part * power_of_two(32)) as u64 as u32)
}

/// What [`Camera`] asks for: the tangent of half the horizontal field of view, from degrees in 0 ..< 180.
///
/// Error, of a half-width of 1.73 and less (120°): 5e-5 at most; beyond, see [`Camera::tan_half`].
pub fn tan_half(degrees: f32) -> I12F20 {
    Camera::tan_half(turn(degrees.clamp(0.0, 179.0)))
}

/// A colour of shares, rounded to nearest (2^-16), brought into 0 ..= 1.
pub fn albedo(rgb: [f32; 3]) -> Albedo {
    let share = |c: f32| Share::from_bits(F32Ext::round(c.clamp(0.0, 1.0) * power_of_two(15)) as u16);
    Albedo(rgb.map(share))
}

/// Light, linear sRGB; negative channels and what is not a number count as 0, infinity as the largest `f32`.
///
/// Rounded to nearest: error 2^-16 of the largest channel.
pub fn radiance(rgb: [f32; 3]) -> Radiance {
    let rgb = rgb.map(|c| c.clamp(0.0, f32::MAX));
    let largest = rgb[0].max(rgb[1]).max(rgb[2]);
    // The largest channel becomes 2^23 ..< 2^24, all its bits.
    let exponent = exponent(largest).max(-96) - 23;
    Radiance::from_bits(rgb.map(|c| (c * power_of_two(-exponent)) as u32), exponent)
}

/// 2^n; n in −126 ..= 127.
fn power_of_two(n: i32) -> f32 {
    f32::from_bits(((127 + n) as u32) << 23)
}

/// ⌊log2 x⌋ of a positive number; −127 for the smallest.
fn exponent(x: f32) -> i32 {
    (x.to_bits() >> 23) as i32 - 127
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::Wide;
    use std::vec::Vec;

    fn some_numbers(from: f64, to: f64, count: usize) -> impl Iterator<Item = f32> {
        (0..=count).map(move |i| (from + (to - from) * i as f64 / count as f64) as f32)
    }

    #[test]
    fn lengths_are_rounded_to_nearest() {
        for bits in [-3, 0, 10, 16, 20] {
            let unit = Unit::new(bits);
            let scale = f64::from(bits).exp2();
            let reach = f64::from(REACH) / scale;
            for metres in some_numbers(-reach, reach, 10_007) {
                let exact = f64::from(metres) * scale;
                let error = f64::from(length(unit, metres)) - exact;
                assert!(error.abs() <= 0.500_001, "{metres} m, {bits}: {error}");
            }
        }
        assert_eq!(length(Unit::DEFAULT, 1e30), 2 * REACH);
        assert_eq!(length(Unit::DEFAULT, f32::NEG_INFINITY), -2 * REACH);
        assert_eq!(length(Unit::DEFAULT, f32::NAN), 0);
        assert_eq!(
            point(Unit::new(4), [0.5, -0.25, 2.0]),
            Point([8, -4, 32]),
            "axes in order"
        );
    }

    #[test]
    fn directions_point_where_the_vector_does() {
        let mut worst = 0.0f64;
        for (i, a) in some_numbers(-3.0, 3.0, 101).enumerate() {
            for size in [1e-20f32, 1.0, 1e20] {
                let v = [a * size, (1.0 - a * a) * size, (i as f32 * 0.37 - 9.0) * size];
                let [x, y, z] = v.map(f64::from);
                let [a, b, c] = dir(v).unwrap().0.map(f64::from);
                // The sine of the angle between them.
                let cross = [y * c - z * b, z * a - x * c, x * b - y * a];
                let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
                worst = worst.max(length(cross) / (length([x, y, z]) * length([a, b, c])));
            }
        }
        assert!((1e-5..1.31e-5).contains(&worst), "{worst}");
        let down = dir([0.0, -1e-28, 0.0]).unwrap();
        assert!(down.dot(-Dir::Y) >= 65535);
        for nowhere in [[0.0; 3], [f32::NAN, 1.0, 0.0], [f32::INFINITY, 0.0, 0.0]] {
            assert_eq!(dir(nowhere), None);
        }
    }

    #[test]
    fn angles_wrap() {
        for (degrees, sixteenths) in [
            (0.0, 0),
            (90.0, 4),
            (-90.0, 12),
            (360.0, 0),
            (765.0, 2),
            (-1e-9, 0),
        ] {
            assert_eq!(turn(degrees).to_bits(), sixteenths << 28, "{degrees}");
        }
        for degrees in some_numbers(-720.0, 720.0, 9973) {
            let exact = (f64::from(degrees) / 360.0).rem_euclid(1.0);
            let error = f64::from(turn(degrees).to_bits()) / 32f64.exp2() - exact;
            let error = error - error.round();
            assert!(
                error.abs() <= 2f64.powi(-25) + 2f64.powi(-23),
                "{degrees}: {error}"
            );
        }
        assert_eq!(turn(f32::NAN), Turn::ZERO);
    }

    #[test]
    fn fields_of_view_are_right_to_four_digits() {
        let mut ours = 0.0f64;
        let mut theirs = 0.0f64;
        for degrees in some_numbers(0.0, 120.0, 4001) {
            let exact = (f64::from(degrees).to_radians() / 2.0).tan();
            ours = ours.max((tan_half(degrees).to_num::<f64>() - exact).abs());
            theirs = theirs.max((f64::from(F32Ext::tan(degrees.to_radians() / 2.0)) - exact).abs());
        }
        assert!((1e-5..5e-5).contains(&ours), "{ours}");
        // What the module's doc says of the other way; where it is not so any more, there is one way too many.
        assert!((1e-3..1e-1).contains(&theirs), "{theirs}");
        assert!((tan_half(90.0).to_bits() - (1 << 20)).abs() <= 1);
    }

    #[test]
    fn colours_are_rounded_to_nearest() {
        for c in some_numbers(0.0, 1.0, 9001) {
            let share = albedo([c; 3]).0[1].to_bits();
            assert!((f64::from(share) / 32768.0 - f64::from(c)).abs() <= 2f64.powi(-16));
        }
        assert_eq!(albedo([-1.0, 2.0, 0.5]).0.map(|c| c.to_bits()), [0, 32768, 16384]);
        for largest in [1e-9f32, 0.7, 3.0, 4e5] {
            let rgb = [largest, 0.31 * largest, 0.002 * largest];
            let (mantissa, exponent) = radiance(rgb).to_parts();
            let back: Vec<f64> = mantissa
                .iter()
                .map(|m| f64::from(*m) * f64::from(exponent - 15).exp2())
                .collect();
            for (c, b) in rgb.iter().zip(back) {
                assert!((b - f64::from(*c)).abs() <= f64::from(largest) * 2f64.powi(-16));
            }
        }
        assert_eq!(radiance([0.0, -1.0, f32::NAN]), Radiance::BLACK);
        assert_eq!(radiance([1.0; 3]), Radiance::WHITE);
        assert_eq!(
            radiance([f32::INFINITY, 0.0, 0.0]).max_channel(),
            Wide::new(1, 128)
        );
    }
}
