use super::length::length;
use super::line::FINE;
use super::march::Field;
use super::rounded_box::{square, turned_extent};
use super::{Blob, Place, Solid, upper_length};
use crate::geom::{Dir, Point};
use crate::num::{Turn, mul_q16, mul_shift, recip, sin_cos};

/// A wall along Schoen's gyroid, cut by a bound: with Xᵢ = 2π qᵢ / cell and
/// g = sin X₀ cos X₁ + sin X₁ cos X₂ + sin X₂ cos X₀, f = max(cell/(3π) |g| − thickness/2, bound).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gyroid {
    pub center: Point,
    /// Directions of two of its axes, at right angles; the third is x × y.
    pub x: Dir,
    pub y: Dir,
    /// Period along each axis, units.
    pub cell: i32,
    /// Units; at most 0.3 of `cell`.
    pub thickness: i32,
    pub bound: Bound,
}

/// What a gyroid is cut to, about its centre: maxᵢ(|qᵢ| − halfᵢ), or |q| − radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bound {
    /// A ball's radius, 0, 0, or a block's half extents.
    half: [i32; 3],
}

impl Bound {
    /// Units, above 0.
    pub const fn ball(radius: i32) -> Bound {
        Bound { half: [radius, 0, 0] }
    }

    /// Half its extent along each of the gyroid's axes, units, above 0.
    pub const fn block(half: [i32; 3]) -> Bound {
        Bound { half }
    }

    /// The ball's radius, if it is one.
    pub const fn radius(&self) -> Option<i32> {
        match self.half {
            [radius, 0, 0] => Some(radius),
            _ => None,
        }
    }

    /// Half extents of the box around it.
    pub const fn half(&self) -> [i32; 3] {
        match self.half {
            [radius, 0, 0] => [radius; 3],
            half => half,
        }
    }

    fn reach(&self) -> i32 {
        match self.half {
            [radius, 0, 0] => radius,
            half => upper_length(half),
        }
    }
}

impl Gyroid {
    /// `None` where x and y are (nearly) parallel. y is turned within their plane until it is at right angles to x.
    pub fn new(center: Point, [x, y]: [Dir; 2], cell: i32, thickness: i32, bound: Bound) -> Option<Gyroid> {
        let y = square(x, y)?;
        Some(Gyroid {
            center,
            x,
            y,
            cell,
            thickness,
            bound,
        })
    }

    /// Half the extent along each of the scene's axes, units.
    pub(super) fn extent(&self) -> [i32; 3] {
        match self.bound.radius() {
            Some(radius) => [radius; 3],
            None => turned_extent(self.x, self.y, self.bound.half),
        }
    }
}

impl Solid for Gyroid {
    type Field = GyroidField;

    #[inline]
    fn place(&self) -> Place {
        Place {
            center: self.center,
            reach: self.bound.reach(),
            axes: Some([self.x, self.y]),
        }
    }

    fn field(&self, place: &Place, _: &[Blob]) -> GyroidField {
        let up = place.up();
        // At most 2^25: a cell is at most four reaches.
        let cell = self.cell << up;
        let r = recip(cell as u32);
        // thickness/2 · 3π/cell as Q24; 3π/2 = 4.712389 = 308831/2^16.
        let wall = r.times(mul_q16(self.thickness << up, 308_831), 24);
        let radius = self.bound.radius().map(|radius| radius << up);
        GyroidField {
            frequency: (r.mantissa >> 1) as i32,
            shift: r.shift - 33,
            wall,
            // √3/2 · cell/(3π): 0.0918881 = 6022/2^16.
            steepness: mul_q16(cell, 6022),
            // 1/(2π) = 0.1591549 = 10430.38/2^16
            radian: mul_q16(cell, 10_430),
            thickness: self.thickness << up,
            half: self.bound.half.map(|h| h << up),
            radius,
        }
    }
}

pub(crate) struct GyroidField {
    /// Turns (2^32) a fine step, less `shift` + 32 bits.
    frequency: i32,
    shift: u32,
    /// What |g| is at the wall's faces, Q24.
    wall: i32,
    /// Fine steps for a change of g by 1, at least.
    steepness: i32,
    /// Fine steps for a radian.
    radian: i32,
    thickness: i32,
    half: [i32; 3],
    radius: Option<i32>,
}

impl GyroidField {
    /// Sines and cosines of the three angles, Q16.
    #[inline]
    fn angles(&self, p: [i32; 3]) -> ([i32; 3], [i32; 3]) {
        let [x, y, z] = p.map(|c| {
            let phase = mul_shift(c, self.frequency, self.shift);
            sin_cos(Turn::from_bits(phase as u32))
        });
        ([x.0, y.0, z.0], [x.1, y.1, z.1])
    }

    /// g, Q24.
    #[inline]
    fn value(s: [i32; 3], c: [i32; 3]) -> i32 {
        Dir(s).dot_q24(Dir([c[1], c[2], c[0]]))
    }

    #[inline]
    fn bound(&self, p: [i32; 3]) -> i32 {
        match self.radius {
            Some(radius) => length(p) - radius,
            None => (p[0].abs() - self.half[0])
                .max(p[1].abs() - self.half[1])
                .max(p[2].abs() - self.half[2]),
        }
    }
}

impl Field for GyroidField {
    /// The wall's own part is 1 steep at most: |∇g|² ≤ 3 · (2π/cell)², since
    /// (cos X₀ cos X₁ − sin X₂ sin X₀)² ≤ cos² X₁ + sin² X₂, and of the three, cosines and sines add up to 3.
    #[inline]
    fn distance(&self, p: [i32; 3]) -> i32 {
        let (s, c) = self.angles(p);
        let above = Self::value(s, c).abs() - self.wall;
        let wall = mul_shift(above, self.steepness, 24);
        // Rounded towards 0 it could be on the wrong side.
        let wall = if above > 0 { wall.max(1) } else { wall };
        wall.max(self.bound(p))
    }

    fn slope(&self, p: [i32; 3]) -> ([i32; 3], i32) {
        let (s, c) = self.angles(p);
        let g = Self::value(s, c);
        let above = g.abs() - self.wall;
        let bound = self.bound(p);
        if bound >= mul_shift(above, self.steepness, 24) {
            let outwards = match self.radius {
                Some(_) => p,
                None => [0, 1, 2].map(|i| {
                    let size = (p[i].abs() - self.half[i] == bound) as i32;
                    if p[i] < 0 { -size } else { size }
                }),
            };
            return (outwards, bound);
        }
        // Q16 in each.
        let part = |i: usize, j: usize, k: usize| {
            let steep = mul_shift(c[i], c[j], 8) - mul_shift(s[k], s[i], 8);
            if g < 0 { -steep } else { steep }
        };
        let gradient = [part(0, 1, 2), part(1, 2, 0), part(2, 0, 1)];
        // Q24; |∇g| a radian is small only where holes close.
        let steep = length(gradient).max(1 << 18);
        let height = recip(steep as u32).times(mul_shift(above, self.radian, 24), 24);
        (gradient, height)
    }

    #[inline]
    fn step(&self) -> i32 {
        // At the bound walls end in edges, where a chord is twice as deep as it is far from the edge: 20 steps lose 10.
        // No step passes through a wall.
        (self.thickness >> (FINE + 2)).clamp(16, 20)
    }
}
