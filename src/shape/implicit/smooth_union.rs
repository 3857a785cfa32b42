use super::capsule::Segment;
use super::line::FINE;
use super::march::{Field, chord};
use super::{Blob, MAX_BLOBS, Place, Solid, around};
use crate::geom::{Dir, Offset, Point};
use crate::num::{Recip, mul_q16, recip};

/// Balls and capsules with filled creases: f = s(… s(f₀, f₁) …, fₙ) in the order of the list, where
/// s(a, b) = min(a, b) − max(k − |a − b|, 0)² / (4k) (Quilez, "Smooth minimum", the quadratic polynomial).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SmoothUnion {
    /// Of the scene's blobs, the first and how many.
    pub first: u16,
    pub count: u16,
    /// Surfaces closer than about this melt, units.
    pub k: i32,
    /// A ball that holds it all.
    center: Point,
    reach: i32,
}

impl SmoothUnion {
    /// Of `count` of the scene's blobs, from `first` on.
    pub fn new(blobs: &[Blob], first: u16, count: u16, k: i32) -> SmoothUnion {
        let parts = super::chosen(blobs, first, count);
        let fill = fill(count, k);
        let (center, reach) = around(parts, |blob| blob.radius.saturating_add(fill));
        SmoothUnion {
            first,
            count,
            k,
            center,
            reach,
        }
    }

    pub(super) fn fill(&self) -> i32 {
        fill(self.count, self.k)
    }
}

/// How far out of its parts a union of `count` reaches, units: k/4 a blend.
fn fill(count: u16, k: i32) -> i32 {
    let blends = i32::from(count).saturating_sub(1);
    (k >> 2).saturating_add(1).saturating_mul(blends)
}

impl Solid for SmoothUnion {
    type Field = UnionField;

    #[inline]
    fn place(&self) -> Place {
        Place {
            center: self.center,
            reach: self.reach,
            axes: None,
        }
    }

    fn field(&self, place: &Place, blobs: &[Blob]) -> UnionField {
        let mut field = UnionField {
            parts: [Segment::NOTHING; MAX_BLOBS],
            count: 0,
            k: self.k << place.up(),
            inverse: recip((self.k << place.up()) as u32),
            step: i32::MAX,
        };
        for (part, blob) in field
            .parts
            .iter_mut()
            .zip(super::chosen(blobs, self.first, self.count))
        {
            *part = Segment::new(blob, place);
            field.count += 1;
            field.step = field.step.min(chord(part.radius >> FINE));
        }
        field
    }
}

pub(crate) struct UnionField {
    parts: [Segment; MAX_BLOBS],
    count: usize,
    k: i32,
    inverse: Recip,
    step: i32,
}

impl UnionField {
    fn parts(&self) -> &[Segment] {
        self.parts.get(..self.count).unwrap_or(&[])
    }

    /// s(a, b), and the share of the farther one's gradient in it, Q16: 0 ..= ½.
    #[inline]
    fn blend(&self, a: i32, b: i32) -> (i32, i32) {
        let near = self.k - (a - b).abs();
        if near <= 0 {
            return (a.min(b), 0);
        }
        let share = self.inverse.times(near, 16);
        (a.min(b) - ((mul_q16(near, share) + 2) >> 2), share >> 1)
    }
}

impl Field for UnionField {
    #[inline]
    fn distance(&self, p: [i32; 3]) -> i32 {
        let mut parts = self.parts().iter();
        let first = parts.next().map_or(1 << 24, |part| part.distance(p));
        parts.fold(first, |a, part| self.blend(a, part.distance(p)).0)
    }

    fn slope(&self, p: [i32; 3]) -> ([i32; 3], i32) {
        let slope = |part: &Segment| {
            let (outwards, height) = part.slope(p);
            let unit = Offset(outwards).normalize().map_or(Dir::Z, |(dir, _)| dir);
            (unit.0, height)
        };
        let mut parts = self.parts().iter();
        let first = parts.next().map_or((Dir::Z.0, 0), slope);
        let (gradient, value) = parts.fold(first, |(g, a), part| {
            let (h, b) = slope(part);
            let (value, share) = self.blend(a, b);
            let (nearer, farther) = if a <= b { (g, h) } else { (h, g) };
            let mix = |i: usize| nearer[i] + mul_q16(farther[i] - nearer[i], share);
            ([mix(0), mix(1), mix(2)], value)
        });
        // |∇f| is under 1 in a blend: the way to the surface is longer than f. Where it vanishes there is no surface.
        let steep = super::length::length(gradient).max(1 << 12);
        (gradient, recip(steep as u32).times(value, 16))
    }

    #[inline]
    fn step(&self) -> i32 {
        self.step
    }
}
