use super::length::length;
use super::line::FINE;
use super::march::{Field, chord};
use super::{Blob, Place, Solid, upper_length};
use crate::geom::{Dir, Point};
use crate::num::{ONE_Q16, mul_q16};

/// A box rolled around by a ball: with dᵢ = |qᵢ| − (halfᵢ − radius),
/// f = |max(d, 0)| + min(max(d₀, d₁, d₂), 0) − radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoundedBox {
    pub center: Point,
    /// Directions of two of its edges, at right angles; the third is x × y.
    pub x: Dir,
    pub y: Dir,
    /// Half its extent along each, rounding included, units.
    pub half: [i32; 3],
    /// Of edges and corners, units; at most the least of `half`.
    pub radius: i32,
}

impl RoundedBox {
    /// `None` where x and y are (nearly) parallel. y is turned within their plane until it is at right angles to x.
    pub fn new(center: Point, x: Dir, y: Dir, half: [i32; 3], radius: i32) -> Option<RoundedBox> {
        let y = square(x, y)?;
        Some(RoundedBox {
            center,
            x,
            y,
            half,
            radius,
        })
    }

    /// Half the extent along each of the scene's axes, units.
    pub(super) fn extent(&self) -> [i32; 3] {
        let inner = self.half.map(|h| h.saturating_sub(self.radius));
        turned_extent(self.x, self.y, inner).map(|c| c.saturating_add(self.radius))
    }
}

/// y turned in the plane of both until it is at right angles to x.
pub(super) fn square(x: Dir, y: Dir) -> Option<Dir> {
    x.cross(y)?.cross(x)
}

/// Half the extent along the scene's axes of a box along others.
pub(super) fn turned_extent(x: Dir, y: Dir, half: [i32; 3]) -> [i32; 3] {
    let [x, y] = [x, y].map(|d| Dir(d.0.map(|c| c.clamp(-ONE_Q16, ONE_Q16))));
    let z = x.cross(y).unwrap_or(Dir::Z);
    let along = |h: i32, c: i32| mul_q16(h, c.abs()).saturating_add(1);
    [0, 1, 2].map(|i| {
        along(half[0], x.0[i])
            .saturating_add(along(half[1], y.0[i]))
            .saturating_add(along(half[2], z.0[i]))
    })
}

impl Solid for RoundedBox {
    type Field = BoxField;

    #[inline]
    fn place(&self) -> Place {
        Place {
            center: self.center,
            reach: upper_length(self.half),
            axes: Some([self.x, self.y]),
        }
    }

    #[inline]
    fn field(&self, place: &Place, _: &[Blob]) -> BoxField {
        let up = place.up();
        BoxField {
            inner: self.half.map(|h| (h - self.radius) << up),
            radius: self.radius << up,
        }
    }
}

pub(crate) struct BoxField {
    inner: [i32; 3],
    radius: i32,
}

impl BoxField {
    /// Beyond the inner box along each axis, and the largest of the three.
    #[inline]
    fn beyond(&self, p: [i32; 3]) -> ([i32; 3], i32) {
        let d = [0, 1, 2].map(|i| p[i].abs() - self.inner[i]);
        (d, d[0].max(d[1]).max(d[2]))
    }
}

impl Field for BoxField {
    const CONVEX: bool = true;

    #[inline]
    fn distance(&self, p: [i32; 3]) -> i32 {
        let (d, most) = self.beyond(p);
        let outside = d.map(|c| c.max(0));
        // Most points lie over a face, and need no root.
        let away = match outside {
            [_, 0, 0] | [0, _, 0] | [0, 0, _] => most,
            _ => length(outside),
        };
        away - self.radius
    }

    fn slope(&self, p: [i32; 3]) -> ([i32; 3], i32) {
        let (d, most) = self.beyond(p);
        let outwards = |i: usize| {
            // Over an edge of the inner box away from it, within the box towards its nearest face.
            let size = if most > 0 {
                d[i].max(0)
            } else {
                (d[i] == most) as i32
            };
            if p[i] < 0 { -size } else { size }
        };
        ([outwards(0), outwards(1), outwards(2)], self.distance(p))
    }

    #[inline]
    fn step(&self) -> i32 {
        chord(self.radius >> FINE)
    }
}
