use super::grid::{Grid, Slopes};
use super::triangles::Triangles;
use crate::geom::{Dir, Offset, Point, Ray, Rotation};
use crate::num::{Metres, leading_zeros, mul_shift, recip};

/// A mesh at a place of its own: scaled, turned and moved, p = at + R (s q), q being where it says that it is.
///
/// One mesh may be placed any number of times; a place takes a few dozen bytes. It does not emit light.
///
/// A ray is taken into the mesh's own frame and traced there. Its origin comes out right to 3/s units each way, its
/// direction to 2^-27, and a place on the mesh back in the scene to 3 + s units: the lift covers all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instance {
    /// Index into the scene's meshes.
    pub mesh: u16,
    /// Where the mesh's origin is, within ±2^27.
    pub at: Point,
    pub rotation: Rotation,
    /// Q16: [`Instance::SMALLEST`] ..= [`Instance::LARGEST`].
    scale: u32,
    /// 2^`shift` over the scale, within 2^29 ..= 2^30, relative error 2^-27.
    inverse: i32,
    shift: u8,
}

/// A ray in a mesh's own frame.
#[derive(Clone, Copy, Debug)]
pub struct LocalRay {
    pub ray: Ray,
    pub slopes: Slopes,
}

/// Units by which transforms there and back move a ray that starts on the mesh, at most.
const TRANSFORMS: i32 = 10;

impl Instance {
    /// The least scale, Q16: 1/16.
    pub const SMALLEST: u32 = 1 << 12;
    /// The greatest scale, Q16: 16.
    pub const LARGEST: u32 = 1 << 20;

    /// The mesh where it says that it is.
    pub fn new(mesh: u16) -> Instance {
        Instance {
            mesh,
            at: Point([0; 3]),
            rotation: Rotation::NONE,
            scale: 1 << 16,
            inverse: 1 << 30,
            shift: 30,
        }
    }

    /// Scaled by 1/16 to 16: what is beyond is cut.
    pub fn scaled(self, scale: Metres) -> Instance {
        let scale = (scale.to_bits().max(0) as u32).clamp(Self::SMALLEST, Self::LARGEST);
        // 2^(16 + shift)/scale, scale being 2^log ..= 2^(log + 1).
        let log = 31 - leading_zeros(scale);
        Instance {
            scale,
            inverse: recip(scale).times(1 << 30, log),
            shift: (14 + log) as u8,
            ..self
        }
    }

    pub fn turned(self, rotation: Rotation) -> Instance {
        Instance { rotation, ..self }
    }

    pub fn moved(self, at: Point) -> Instance {
        Instance { at, ..self }
    }

    /// Q16.
    pub fn scale(&self) -> u32 {
        self.scale
    }

    /// Units of the mesh's frame that an origin may be away from it: what is farther does not see it.
    const FAR: u32 = 1 << 29;

    /// A ray in the mesh's frame; `None` from so far away that it does not see it.
    #[inline]
    pub fn enter(&self, ray: &Ray) -> Option<LocalRay> {
        let Offset(from) = self.at.to(ray.origin);
        let near = |v: [i32; 3]| v.iter().all(|c| c.unsigned_abs() <= Instance::FAR);
        if !near(from) {
            return None;
        }
        let turned = self.rotation.back(from);
        let reach = match self.scale {
            0x1_0000.. => Instance::FAR,
            scale => mul_shift(Instance::FAR as i32, scale as i32, 16) as u32,
        };
        if turned.iter().any(|c| c.unsigned_abs() > reach) {
            return None;
        }
        let origin = Point(turned.map(|c| mul_shift(c, self.inverse, u32::from(self.shift))));
        // Q28.
        let fine = self.rotation.back(ray.dir.0.map(|c| c << 12));
        Some(LocalRay {
            ray: Ray {
                origin,
                dir: Dir(fine.map(|c| (c + (1 << 11)) >> 12)),
            },
            slopes: Slopes::fine(fine),
        })
    }

    /// A distance in the mesh's frame as one of the scene's, rounded down, at least 1 and at most `i32::MAX`.
    #[inline]
    pub fn distance(&self, t: i32) -> i32 {
        let scale = self.scale as i32;
        if mul_shift(t, scale, 47) > 0 {
            return i32::MAX;
        }
        mul_shift(t, scale, 16).max(1)
    }

    /// The least distance in the mesh's frame whose [`Self::distance`] is `t_max` or more; at most `i32::MAX`.
    #[inline]
    pub fn limit(&self, t_max: i32) -> i32 {
        if t_max <= 1 {
            return 1;
        }
        let shift = u32::from(self.shift);
        if shift <= 30 && mul_shift(t_max, self.inverse, shift + 31) > 0 {
            return i32::MAX;
        }
        // The reciprocal's error is 2^-27: a start below, and not far.
        let near = mul_shift(t_max, self.inverse, shift);
        let mut limit = near.saturating_sub(2 + (near >> 26)).max(1);
        for _ in 0..80 {
            if self.distance(limit) >= t_max {
                break;
            }
            limit = limit.saturating_add(1);
        }
        limit
    }

    /// Where a place of the mesh's frame is in the scene.
    #[inline]
    pub fn place(&self, point: Point) -> Point {
        let scaled = point.0.map(|c| mul_shift(c, self.scale as i32, 16));
        self.at.add(Offset(self.rotation.turn(scaled)))
    }

    /// Where a direction of the mesh's frame points in the scene.
    #[inline]
    pub fn direction(&self, dir: Dir) -> Dir {
        // Q18, so that the rounding of the products is none.
        Dir(self.rotation.turn(dir.0.map(|c| c << 2)).map(|c| (c + 2) >> 2))
    }

    /// [`Triangles::offset`], in the scene.
    #[inline]
    pub(crate) fn lift(&self, mesh: &Triangles) -> i32 {
        mul_shift(mesh.offset() + TRANSFORMS, self.scale as i32, 16) + TRANSFORMS
    }

    /// The steps of a mesh's grid as a power of two in scene units, rounded up.
    pub(crate) fn step(&self, grid: &Grid) -> u32 {
        let log = 32 - leading_zeros(self.scale - 1);
        (grid.shift() + log).saturating_sub(16)
    }

    /// The corners of a box around the mesh, and a few steps more.
    pub(crate) fn reach(&self, mesh: &Triangles) -> Option<(Point, Point)> {
        let bounds = mesh.bounds();
        if bounds.low[0] > bounds.high[0] {
            return None;
        }
        let bounds = bounds.pad(4);
        let ends = [
            mesh.grid().to_scene(bounds.low),
            mesh.grid().to_scene(bounds.high),
        ];
        let corner = |i: usize| self.place(Point([0, 1, 2].map(|axis| ends[i >> axis & 1].0[axis])));
        let (mut low, mut high) = (corner(0), corner(0));
        for i in 1..8 {
            let Point(p) = corner(i);
            low = Point([0, 1, 2].map(|axis| low.0[axis].min(p[axis])));
            high = Point([0, 1, 2].map(|axis| high.0[axis].max(p[axis])));
        }
        let grow = |Point(p): Point, by: i32| Point(p.map(|c| c.saturating_add(by)));
        Some((grow(low, -TRANSFORMS), grow(high, TRANSFORMS)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::Turn;

    #[test]
    fn limits_are_exact() {
        for bits in [
            1 << 12,
            4097,
            12345,
            65535,
            1 << 16,
            65537,
            99_999,
            1 << 18,
            700_001,
            1 << 20,
        ] {
            let instance = Instance::new(0).scaled(Metres::from_bits(bits));
            for t_max in [
                1,
                2,
                3,
                15,
                16,
                17,
                1000,
                65_536,
                1 << 20,
                (1 << 26) + 7,
                1 << 29,
                (1 << 29) + 1,
            ] {
                let limit = instance.limit(t_max);
                assert!(
                    limit == i32::MAX || instance.distance(limit) >= t_max,
                    "{bits} {t_max}"
                );
                assert!(
                    limit == 1 || instance.distance(limit - 1) < t_max,
                    "{bits} {t_max} {limit}"
                );
                let exact = ((i64::from(t_max) << 16) + i64::from(bits) - 1) / i64::from(bits);
                assert!(
                    i64::from(limit) == exact.min(i64::from(i32::MAX)) || t_max == 1,
                    "{bits} {t_max}"
                );
            }
        }
    }

    /// What the documentation says of origins and places.
    #[test]
    fn there_and_back() {
        let axis = Dir::new([3, -5, 7]).unwrap();
        for (i, bits) in [1 << 12, 40_000, 1 << 16, 300_000, 1 << 20]
            .into_iter()
            .enumerate()
        {
            let scale = f64::from(bits) / 65536.0;
            let instance = Instance::new(0)
                .scaled(Metres::from_bits(bits))
                .turned(Rotation::about(axis, Turn::from_num(0.07 * (i + 1) as f64)))
                .moved(Point([12_345, -777_777, 1 << 20]));
            for q in [
                [0, 0, 0],
                [1 << 21, -(1 << 20), 99],
                [-12_345, 1 << 17, -(1 << 21)],
            ] {
                let q = q.map(|c| (f64::from(c) / scale.max(1.0)) as i32);
                let ray = Ray {
                    origin: instance.place(Point(q)),
                    dir: Dir::Z,
                };
                let back = instance.enter(&ray).unwrap().ray.origin.0;
                for i in 0..3 {
                    let error = f64::from(back[i] - q[i]).abs() * scale;
                    assert!(error <= 6.0 + scale, "{bits} {q:?} {back:?}");
                }
            }
            let dir = Dir::new([5, 6, -7]).unwrap();
            let turned = instance.direction(dir);
            let local = instance
                .enter(&Ray {
                    origin: instance.at,
                    dir: turned,
                })
                .unwrap();
            assert!(
                (0..3).all(|i| (local.ray.dir.0[i] - dir.0[i]).abs() <= 2),
                "{dir:?} {local:?}"
            );
        }
        let far = Ray {
            origin: Point([(1 << 29) - 8, 0, 0]),
            dir: Dir::X,
        };
        assert!(
            Instance::new(0)
                .scaled(Metres::from_bits(1 << 12))
                .enter(&far)
                .is_none()
        );
        assert!(Instance::new(0).enter(&far).is_some());
    }
}
