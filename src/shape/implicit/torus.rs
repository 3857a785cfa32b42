use super::length::length;
use super::line::FINE;
use super::march::{Field, chord};
use super::{Place, Solid};
use crate::geom::{Dir, Offset, Point};
use crate::num::{ONE_Q16, mul_q16};

/// A ring of circular cross-section: f = √((ρ − major)² + h²) − minor, with h along the axis and ρ from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Torus {
    pub center: Point,
    pub axis: Dir,
    /// A direction at right angles to the axis.
    pub side: Dir,
    /// Radius of the circle in the middle of the tube, units.
    pub major: i32,
    /// Radius of the tube, units; under `major`.
    pub minor: i32,
}

impl Torus {
    pub fn new(center: Point, axis: Dir, major: i32, minor: i32) -> Torus {
        Torus {
            center,
            axis,
            side: across(axis),
            major,
            minor,
        }
    }

    /// Half the extent along each of the scene's axes, units.
    pub(super) fn extent(&self) -> [i32; 3] {
        let [x, y, z] = self.axis.0.map(|c| c.clamp(-ONE_Q16, ONE_Q16));
        let sine = [[y, z], [z, x], [x, y]].map(length);
        sine.map(|sine| {
            mul_q16(self.major, sine)
                .saturating_add(self.minor)
                .saturating_add(1)
        })
    }
}

/// A direction at right angles to another: across the axis that it is farthest from.
pub(super) fn across(dir: Dir) -> Dir {
    let size = dir.0.map(i32::unsigned_abs);
    let other = if size[0] <= size[1] && size[0] <= size[2] {
        Dir::X
    } else if size[1] <= size[2] {
        Dir::Y
    } else {
        Dir::Z
    };
    dir.cross(other).unwrap_or(Dir::X)
}

impl Solid for Torus {
    type Field = TorusField;

    #[inline]
    fn place(&self) -> Place {
        Place {
            center: self.center,
            reach: self.major.saturating_add(self.minor),
            axes: Some([self.axis, self.side]),
        }
    }

    #[inline]
    fn field(&self, place: &Place, _: &[super::Blob]) -> TorusField {
        let up = place.up();
        TorusField {
            major: self.major << up,
            minor: self.minor << up,
        }
    }
}

/// Its axis is x.
pub(crate) struct TorusField {
    major: i32,
    minor: i32,
}

impl Field for TorusField {
    #[inline]
    fn distance(&self, [h, y, z]: [i32; 3]) -> i32 {
        length([length([y, z]) - self.major, h]) - self.minor
    }

    fn slope(&self, [h, y, z]: [i32; 3]) -> ([i32; 3], i32) {
        let aside = length([y, z]) - self.major;
        let [_, y, z] = match Offset([0, y, z]).normalize() {
            Some((radial, _)) => radial.0,
            None => Dir::Y.0,
        };
        let outwards = [h, mul_q16(aside, y), mul_q16(aside, z)];
        (outwards, length([aside, h]) - self.minor)
    }

    #[inline]
    fn step(&self) -> i32 {
        chord(self.minor >> FINE)
    }
}
