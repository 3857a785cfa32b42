//! What a beam of camera rays may meet, and what may shade that.

use super::Scene;
use super::arrange::shape_bounds;
use crate::bvh::{Child, SCENE_PAD, primitives};
use crate::geom::{Beam, Point};
use crate::light::Light;
use crate::shape::{Bounds, Disk, Geometry, Rectangle};
use core::num::NonZeroU32;

/// Shapes that may matter to some rays: a potentially visible set (Airey et al., "Towards Image Realism with Interactive
/// Update Rates in Complex Virtual Building Environments", I3D 1990).
///
/// Few of them by name, or all there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShapeSet(NonZeroU32);

/// Bits of a name: the shape's index and one.
pub(super) const NAME: u32 = 5;
/// Names that a set has room for.
pub(super) const MOST: usize = 6;
/// Bit 30: a mesh is among them, or an instance of one.
const MESH: u32 = 1 << 30;
/// Bit 31: they are named.
const NAMED: NonZeroU32 = NonZeroU32::new(1 << 31).unwrap();

impl ShapeSet {
    /// Any shape.
    pub const ALL: ShapeSet = ShapeSet(NonZeroU32::MIN);

    const NONE: ShapeSet = ShapeSet(NAMED);

    /// One shape more, before the others; `None` where there is no room for it.
    fn with(self, index: usize, geometry: &Geometry) -> Option<ShapeSet> {
        let names = self.0.get() & (MESH - 1);
        let is_full = names >> (NAME * (MOST as u32 - 1)) != 0;
        if is_full || index + 1 >= 1 << NAME {
            return None;
        }
        let mesh = match geometry {
            Geometry::Mesh(_) | Geometry::Instance(_) => MESH,
            _ => 0,
        };
        let names = names << NAME | (index as u32 + 1);
        Some(ShapeSet(NAMED | self.0.get() & MESH | mesh | names))
    }

    #[inline]
    pub(super) fn is_all(self) -> bool {
        self.0.get() & NAMED.get() == 0
    }

    #[inline]
    pub(super) fn has_mesh(self) -> bool {
        self.0.get() & MESH != 0
    }

    /// The shapes that it names, by index.
    #[inline]
    pub(super) fn named(self) -> impl Iterator<Item = usize> {
        let mut names = self.0.get() & (MESH - 1);
        core::iter::from_fn(move || {
            let name = (names & ((1 << NAME) - 1)) as usize;
            names >>= NAME;
            name.checked_sub(1)
        })
    }
}

/// What is ahead of some of the camera's rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ahead {
    /// What they may meet.
    pub seen: ShapeSet,
    /// What may stand between that and the lights.
    pub shading: ShapeSet,
}

impl Ahead {
    /// Of any ray.
    pub const ANY: Ahead = Ahead {
        seen: ShapeSet::ALL,
        shading: ShapeSet::ALL,
    };
}

/// A box as seen from the beam's origin, steps of 4 of the scene's grid; within ±2^15.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    low: [i32; 3],
    high: [i32; 3],
}

/// A finite shape that a beam may meet.
pub(super) struct Patch {
    /// The shape's index.
    pub(super) shape: u16,
    /// How far away it begins, along the view, steps of 16.
    pub(super) near: u16,
    /// About what the beam meets of it.
    pub(super) extent: Extent,
}

impl Scene<'_> {
    /// What is ahead of the rays of a beam.
    ///
    /// A box is not met where all of it is outside one of the beam's sides, so that each is asked: of the
    /// [`SCENE_PAD`] steps that boxes have to spare the place of the beam's origin takes 4. What is met of a box lies in
    /// the box about a part of the beam, and what shades it in the one about that and all lights (after Haines and Wallace,
    /// "Shaft Culling for Efficient Ray-Traced Radiosity", 1991), on neither side of both if it is flat. That is told if
    /// `is_lit`, where light samples are taken.
    #[inline(never)]
    pub fn ahead(&self, beam: &Beam, is_lit: bool) -> Ahead {
        let from = self.steps(beam.origin);
        if !is_near(from) {
            return Ahead::ANY;
        }
        let mut patches = heapless::Vec::new();
        let Some(seen) = self.seen(beam, from, &mut patches) else {
            return Ahead::ANY;
        };
        let shading = if is_lit {
            self.shading(from, &patches, |shape| self.extent(shape, from))
        } else {
            None
        };
        Ahead {
            seen,
            shading: shading.unwrap_or(ShapeSet::ALL),
        }
    }

    /// The nearest first, by where it begins.
    #[inline(never)]
    fn seen(
        &self,
        beam: &Beam,
        from: [i32; 3],
        patches: &mut heapless::Vec<Patch, MOST>,
    ) -> Option<ShapeSet> {
        let (finite, all) = (self.parts.bounded as usize, self.parts.shapes.len());
        if all >= 1 << NAME {
            return None;
        }
        for shape in 0..finite {
            let extent = self.extent(shape, from)?;
            if beam.sides.iter().all(|side| extent.along(*side)[1] >= 0) {
                let (near, extent) = extent.within(beam);
                // Of 2^17 at most.
                let near = (near >> 2) as u16;
                let nearer = patches.iter().position(|patch| patch.near < near);
                let place = nearer.unwrap_or(patches.len());
                let shape = shape as u16;
                patches.insert(place, Patch { shape, near, extent }).ok()?;
            }
        }
        let mut set = ShapeSet::NONE;
        for index in (finite..all).chain(patches.iter().map(|patch| usize::from(patch.shape))) {
            set = set.with(index, &self.parts.shapes.get(index)?.geometry)?;
        }
        Some(set)
    }

    #[inline(never)]
    pub(super) fn shading(
        &self,
        from: [i32; 3],
        patches: &[Patch],
        extent_of: impl Fn(usize) -> Option<Extent>,
    ) -> Option<ShapeSet> {
        let shapes = self.parts.shapes;
        // What a plane shows is not bounded, nor the way to what is infinitely far.
        if shapes.len() > self.parts.bounded as usize || self.environment.is_sampled() {
            return None;
        }
        let mut lights = Extent::EMPTY;
        for light in self.parts.lights {
            match *light {
                Light::Point { position, .. } if is_near(self.steps(position)) => {
                    lights = lights.union(&self.place(position, from));
                }
                Light::Point { .. } | Light::Directional { .. } => return None,
                Light::Area { shape, .. } => lights = lights.union(&extent_of(shape as usize)?),
                Light::Environment { .. } => {}
            }
        }
        // Nothing to be shaded from: light comes from all around, unasked.
        if self.light_count == 0 {
            return None;
        }
        let mut set = ShapeSet::NONE;
        for (index, shape) in shapes.iter().enumerate() {
            let extent = &extent_of(index)?;
            let may_shade = |patch: &Patch| {
                patch.extent.union(&lights).meets(extent)
                    && !patch.extent.is_beside(&lights, extent)
                    && (usize::from(patch.shape) != index || !is_flat(&shape.geometry))
                    && !self.is_aside(&shape.geometry, from, [&patch.extent, &lights])
            };
            // A flat light's rays end before it.
            let is_end = self.light_count == 1 && shape.light.is_some() && is_flat(&shape.geometry);
            if !is_end && patches.iter().any(may_shade) {
                set = set.with(index, &shape.geometry)?;
            }
        }
        Some(set)
    }

    /// Where a point is in the grid, in steps of 4.
    fn steps(&self, point: Point) -> [i32; 3] {
        let grid = &self.parts.grid;
        grid.origin().to(point).0.map(|c| c >> (grid.shift() + 2))
    }

    /// The box of a finite shape; `None` where it is no shape's and no leaf's.
    pub(super) fn extent(&self, index: usize, from: [i32; 3]) -> Option<Extent> {
        let shape = self.parts.shapes.get(index)?;
        let bounds = match shape.geometry {
            Geometry::Mesh(_) | Geometry::Instance(_) => self.leaf(index as u32)?,
            _ => shape_bounds(shape, &[], self.parts.blobs, &self.parts.grid).pad(SCENE_PAD),
        };
        Some(Extent::of(&bounds, from))
    }

    /// The box of the leaf in which a shape is: of a mesh's own it would take all its vertices to tell.
    #[cold]
    #[inline(never)]
    fn leaf(&self, index: u32) -> Option<Bounds> {
        for node in self.parts.nodes {
            for (slot, meta) in node.meta.into_iter().enumerate() {
                if let Child::Leaf(base, leaf) = node.child(meta)
                    && primitives(base, leaf).contains(&index)
                {
                    return Some(node.bounds(slot));
                }
            }
        }
        None
    }

    /// Whether two boxes lie on one side of a flat shape's plane; not of any other shape.
    pub(super) fn is_aside(&self, geometry: &Geometry, from: [i32; 3], boxes: [&Extent; 2]) -> bool {
        let (Geometry::Rectangle(Rectangle { center, normal, .. })
        | Geometry::Disk(Disk { center, normal, .. })) = *geometry
        else {
            return false;
        };
        let normal = normal.0.map(|c| c >> 2);
        let center = self.place(center, from).along(normal);
        // A normal's rounding is worth 2^15·√3 · √3 / 2^14 steps, of the three of 4.
        let spare = 8 << 14;
        let [a, b] = boxes.map(|extent| extent.along(normal));
        (a[0] > center[1] + spare && b[0] > center[1] + spare)
            || (a[1] < center[0] - spare && b[1] < center[0] - spare)
    }

    /// About a point of the scene.
    fn place(&self, point: Point, from: [i32; 3]) -> Extent {
        let steps = self.steps(point);
        let low = [0, 1, 2].map(|a| steps[a] - from[a]);
        Extent {
            low,
            high: low.map(|c| c + 1),
        }
    }
}

/// Whether it is no farther from the grid's cube than that is wide. Then what is seen from there is within ±2^15, its product
/// with a normal of √2 · 2^14 under √3 · 2^15 · √2 · 2^14, and a shaft's within 2 · 2^15 · 2^14: all under 2^31.
fn is_near(steps: [i32; 3]) -> bool {
    steps.iter().all(|c| (c.wrapping_add(1 << 14) as u32) < 3 << 14)
}

pub(super) fn is_flat(geometry: &Geometry) -> bool {
    matches!(geometry, Geometry::Rectangle(_) | Geometry::Disk(_))
}

impl Extent {
    const EMPTY: Extent = Extent {
        low: [i32::MAX; 3],
        high: [i32::MIN; 3],
    };

    fn of(bounds: &Bounds, from: [i32; 3]) -> Extent {
        Extent {
            low: [0, 1, 2].map(|a| (bounds.low[a] as i32 >> 2) - from[a]),
            high: [0, 1, 2].map(|a| ((bounds.high[a] as i32 + 3) >> 2) - from[a]),
        }
    }

    /// A cube of 2^`shift` steps, the one of this number along each axis; 2 or more.
    pub(super) fn of_cell(index: [i32; 3], shift: u32, from: [i32; 3]) -> Extent {
        Extent {
            low: [0, 1, 2].map(|a| (index[a] << (shift - 2)) - from[a]),
            high: [0, 1, 2].map(|a| ((index[a] + 1) << (shift - 2)) - from[a]),
        }
    }

    /// What of a box is in another that it meets.
    pub(super) fn part_in(&self, other: &Extent) -> Extent {
        Extent {
            low: [0, 1, 2].map(|a| self.low[a].max(other.low[a])),
            high: [0, 1, 2].map(|a| self.high[a].min(other.high[a])),
        }
    }

    fn union(&self, other: &Extent) -> Extent {
        Extent {
            low: [0, 1, 2].map(|a| self.low[a].min(other.low[a])),
            high: [0, 1, 2].map(|a| self.high[a].max(other.high[a])),
        }
    }

    pub(super) fn meets(&self, other: &Extent) -> bool {
        (0..3).all(|a| self.low[a] <= other.high[a] && other.low[a] <= self.high[a])
    }

    /// Whether `third` lies beside all ways from this to `other`, as seen along an axis.
    fn is_beside(&self, other: &Extent, third: &Extent) -> bool {
        const SIDES: [[bool; 2]; 4] = [[false, false], [false, true], [true, false], [true, true]];
        [[0, 1], [1, 2], [2, 0]]
            .iter()
            .any(|axes| SIDES.iter().any(|up| self.is_beyond(other, third, *axes, *up)))
    }

    /// Whether that is beyond the line through the ends of both that are up or down two axes, and both are not.
    #[inline(never)]
    fn is_beyond(&self, other: &Extent, third: &Extent, [a, b]: [usize; 2], up: [bool; 2]) -> bool {
        let end = |extent: &Extent, a: usize, up: bool| if up { extent.high[a] } else { extent.low[a] };
        let (x, y) = (end(self, a, up[0]), end(self, b, up[1]));
        let (dx, dy) = (end(other, a, up[0]) - x, end(other, b, up[1]) - y);
        // The line's normal that points to where those ends do: (dy, −dx), its opposite, or neither.
        let (nx, ny) = if (dy > 0) == up[0] { (dy, -dx) } else { (-dy, dx) };
        let is_outwards = |n: i32, up: bool| n == 0 || (n > 0) == up;
        is_outwards(nx, up[0])
            && is_outwards(ny, up[1])
            && nx * (end(third, a, !up[0]) - x) + ny * (end(third, b, !up[1]) - y) > 0
    }

    /// From where to where it reaches along a normal.
    #[inline(never)]
    fn along(&self, normal: [i32; 3]) -> [i32; 2] {
        let mut reach = [0; 2];
        for (a, n) in normal.into_iter().enumerate() {
            let (low, high) = (n * self.low[a], n * self.high[a]);
            reach = [reach[0] + low.min(high), reach[1] + low.max(high)];
        }
        reach
    }

    /// How far away it begins along the view, and what there is about what a beam meets of it.
    #[inline(never)]
    fn within(&self, beam: &Beam) -> (i32, Extent) {
        // From where to where along the view, by each axis along which all of the beam's rays go one way.
        let (mut near, mut far) = (0, 1 << 17);
        for (a, [least, most]) in beam.across.into_iter().enumerate() {
            let (low, high, least, most) = if most < 0 {
                (-self.high[a], -self.low[a], -most, -least)
            } else {
                (self.low[a], self.high[a], least, most)
            };
            if least > 0 {
                near = near.max((low << 12) / most).min(1 << 17);
                far = far.min((high << 12) / least + 1).max(0);
            }
        }
        let mut part = *self;
        for (a, [least, most]) in beam.across.into_iter().enumerate() {
            let low = (near * least).min(far * least) >> 12;
            let high = ((near * most).max(far * most) >> 12) + 1;
            part.low[a] = low.clamp(self.low[a], self.high[a]);
            part.high[a] = high.clamp(self.low[a], self.high[a]);
        }
        (near, part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Also of a box that the beam only seems to meet: sums about a part have as many bits as those about a box.
    #[test]
    fn what_is_met_of_a_box_lies_in_it() {
        let mut state = 1u32;
        let mut below = |n: i32| {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            ((state >> 16) as i32 * n) >> 16
        };
        let mut parts = 0;
        for _ in 0..100_000 {
            let low = [(); 3].map(|()| below(1 << 15) - (1 << 14));
            let extent = Extent {
                low,
                high: low.map(|c| c + 1 + below(1 << 13)),
            };
            let across = [(); 3].map(|()| {
                let least = below(1 << 13) - (1 << 12);
                [least, least + 1 + below(1 << 8)]
            });
            let beam = Beam {
                origin: Point([0; 3]),
                sides: [[0; 3]; 4],
                across,
            };
            let (near, part) = extent.within(&beam);
            assert!((0..=1 << 17).contains(&near));
            for a in 0..3 {
                assert!(extent.low[a] <= part.low[a] && part.high[a] <= extent.high[a]);
                assert!(part.low[a] <= extent.high[a] && extent.low[a] <= part.high[a]);
                parts += (part.low[a] > extent.low[a]) as u32;
            }
        }
        assert!(parts > 10_000, "{parts}");
    }
}
