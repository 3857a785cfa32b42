use super::length::length;
use super::line::FINE;
use super::march::{Field, chord};
use super::{Blob, Place, Solid, upper_length};
use crate::geom::{Dir, Offset, Point};
use crate::num::{Recip, mul_q16, recip};

/// All points within `radius` of the segment from a to b.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capsule {
    pub a: Point,
    pub b: Point,
    /// Units.
    pub radius: i32,
}

impl Capsule {
    pub const fn new(a: Point, b: Point, radius: i32) -> Capsule {
        Capsule { a, b, radius }
    }
}

impl Solid for Capsule {
    type Field = Segment;

    #[inline]
    fn place(&self) -> Place {
        let [a, b] = [self.a.0, self.b.0];
        let center = Point([0, 1, 2].map(|i| a[i].wrapping_add(b[i]) >> 1));
        // The centre is rounded by ½ unit in each.
        let half = upper_length(center.to(self.b).0).saturating_add(1);
        Place {
            center,
            reach: half.saturating_add(self.radius),
            axes: None,
        }
    }

    #[inline]
    fn field(&self, place: &Place, _: &[Blob]) -> Segment {
        Segment::new(&Blob::from(*self), place)
    }
}

/// A capsule, or a ball where both ends are the same, in a solid's frame.
#[derive(Clone, Copy)]
pub(crate) struct Segment {
    a: [i32; 3],
    /// From a to b.
    along: [i32; 3],
    dir: Dir,
    /// Its length; 0 for a ball.
    length: i32,
    inverse: Recip,
    pub(super) radius: i32,
}

impl Segment {
    pub const NOTHING: Segment = Segment {
        a: [0; 3],
        along: [0; 3],
        dir: Dir::X,
        length: 0,
        inverse: Recip {
            mantissa: 1 << 31,
            shift: 63,
        },
        radius: 0,
    };

    pub fn new(blob: &Blob, place: &Place) -> Segment {
        let up = place.up();
        let a = place.center.to(blob.a).0.map(|c| c << up);
        let along = blob.a.to(blob.b).0.map(|c| c << up);
        let dir = Offset(along).normalize().map_or(Dir::X, |(dir, _)| dir);
        let length = length(along);
        Segment {
            a,
            along,
            dir,
            length,
            inverse: recip(length as u32),
            radius: blob.radius << up,
        }
    }

    /// From the nearest point of the segment to `p`, and whether that point is none of the ends.
    ///
    /// The nearest point is an end exactly, or on the segment within 2^-16 + 5e-5 of its length of where it should be,
    /// which changes the distance in second order only.
    #[inline]
    fn off_nearest(&self, p: [i32; 3]) -> ([i32; 3], bool) {
        let v = [0, 1, 2].map(|i| p[i] - self.a[i]);
        let at = if self.length == 0 {
            0
        } else {
            Offset(v).dot(self.dir)
        };
        if at <= 0 {
            return (v, false);
        }
        if at >= self.length {
            return ([0, 1, 2].map(|i| v[i] - self.along[i]), false);
        }
        let share = self.inverse.times(at, 16);
        ([0, 1, 2].map(|i| v[i] - mul_q16(self.along[i], share)), true)
    }

    #[inline]
    pub fn distance(&self, p: [i32; 3]) -> i32 {
        length(self.off_nearest(p).0) - self.radius
    }

    /// Outwards, and the height.
    pub fn slope(&self, p: [i32; 3]) -> ([i32; 3], i32) {
        let (mut v, between) = self.off_nearest(p);
        if between {
            // At right angles to the segment, whatever the nearest point's error along it.
            let along = self.dir.times(Offset(v).dot(self.dir));
            v = Offset(v).minus(along).0;
        }
        (v, length(v) - self.radius)
    }
}

impl Field for Segment {
    const CONVEX: bool = true;

    #[inline]
    fn distance(&self, p: [i32; 3]) -> i32 {
        Segment::distance(self, p)
    }

    fn slope(&self, p: [i32; 3]) -> ([i32; 3], i32) {
        Segment::slope(self, p)
    }

    #[inline]
    fn step(&self) -> i32 {
        chord(self.radius >> FINE)
    }
}
