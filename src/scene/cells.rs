//! What is in each part of a scene, and what may shade the surfaces there: told once, for rays of paths.

use super::ahead::{Extent, MOST, NAME, Patch, is_flat};
use super::{Hit, Scene, ShapeSet};
use crate::geom::{Dir, FAR, Offset, Point, Ray};
use crate::num::{leading_zeros, mul_q16};
use crate::shape::Geometry;

/// A cube of the scene's space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// A bit for each shape that reaches into it, or [`BY_TREE`].
    inside: u32,
    /// What may stand between the surfaces in it and the lights.
    shade: ShapeSet,
}

impl Cell {
    /// Of which nothing is told.
    pub const UNKNOWN: Cell = Cell {
        inside: BY_TREE,
        shade: ShapeSet::ALL,
    };
}

/// A cube of cells about the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells<'a> {
    /// By x, y and z; none if nothing was told.
    cells: &'a [Cell],
    /// Log2 of how many cells stand along each axis.
    bits: u32,
    /// Log2 of how wide a cell is, units.
    shift: u32,
}

/// The tree is asked here: a mesh is among them, more than half of all shapes are, or nothing is known.
const BY_TREE: u32 = 1 << 31;

/// Log2 of the most cells along an axis.
const MOST_BITS: u32 = 5;
/// Shapes that sets have names for.
const SHAPES: usize = (1 << NAME) - 1;

impl Cells<'_> {
    pub(super) const NONE: Cells<'static> = Cells {
        cells: &[],
        bits: 0,
        shift: 0,
    };

    /// The cell of a place, seen from the scene's grid; `None` beyond that.
    #[inline]
    fn index(&self, offset: Offset) -> Option<[u32; 3]> {
        let cell = offset.0.map(|c| c as u32 >> self.shift);
        ((cell[0] | cell[1] | cell[2]) >> self.bits == 0).then_some(cell)
    }

    /// What reaches into a cell; `None` where the tree is asked.
    #[inline]
    fn inside(&self, at: usize) -> Option<u32> {
        let inside = self.cells.get(at)?.inside;
        (inside & BY_TREE == 0).then_some(inside)
    }

    #[inline]
    fn place(&self, [x, y, z]: [u32; 3]) -> usize {
        ((x << self.bits | y) << self.bits | z) as usize
    }
}

impl<'a> Scene<'a> {
    /// Tells once, for each cell of a cube about the scene, which shapes reach into it, and which may stand between the
    /// surfaces there and the lights. Rays then go from cell to cell instead of through the tree, and shadow rays of paths ask
    /// those shapes alone, with the same answers.
    ///
    /// 8, 64, 512, 4096 or 32,768 of `cells` are used; with fewer than 8, more than 31 shapes or an infinite plane the scene
    /// stays as it is. Where a mesh is, or more than half of all shapes, or more than six may shade, the tree is asked. It
    /// takes some thousand instructions a cell, and pays for long paths: what the camera sees itself is told block by block as
    /// it is drawn ([`Self::ahead`]).
    ///
    /// Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987; Haines and Wallace, "Shaft Culling for
    /// Efficient Ray-Traced Radiosity", 1991.
    pub fn foresee(mut self, cells: &'a mut [Cell]) -> Scene<'a> {
        let Some(bits) = (1..=MOST_BITS).rev().find(|bits| 1 << (3 * bits) <= cells.len()) else {
            return self;
        };
        if self.parts.shapes.len() > self.parts.bounded as usize {
            return self;
        }
        let from = [1 << 13; 3];
        let mut extents: heapless::Vec<Extent, SHAPES> = heapless::Vec::new();
        for shape in 0..self.parts.bounded {
            let Some(extent) = self.extent(shape.into(), from) else {
                return self;
            };
            if extents.push(extent).is_err() {
                return self;
            }
        }
        let side = 1 << bits;
        let indices = (0..side).flat_map(|x| (0..side).flat_map(move |y| (0..side).map(move |z| [x, y, z])));
        for (cell, index) in cells.iter_mut().zip(indices) {
            let cube = Extent::of_cell(index, 16 - bits, from);
            *cell = self.look_into(&cube, from, &extents);
        }
        let shift = 16 - bits + self.parts.grid.shift();
        self.cells = Cells { cells, bits, shift };
        self
    }

    fn look_into(&self, cube: &Extent, from: [i32; 3], extents: &[Extent]) -> Cell {
        let mut patches: heapless::Vec<Patch, MOST> = heapless::Vec::new();
        let (mut inside, mut is_crowded) = (0, false);
        for ((number, shape), extent) in (0..).zip(self.parts.shapes).zip(extents) {
            // Of a flat shape there is something only where its plane goes through.
            if extent.meets(cube) && !self.is_aside(&shape.geometry, from, [cube, cube]) {
                inside |= match shape.geometry {
                    Geometry::Mesh(_) | Geometry::Instance(_) => BY_TREE,
                    _ => 1 << number,
                };
                let (extent, near) = (extent.part_in(cube), 0);
                let patch = Patch {
                    shape: number,
                    near,
                    extent,
                };
                is_crowded |= patches.push(patch).is_err();
            }
        }
        // A cell that does not tell shapes apart.
        if 2 * inside.count_ones() as usize > extents.len() {
            inside |= BY_TREE;
        }
        let shade = if is_crowded || patches.is_empty() {
            None
        } else {
            self.shading(from, &patches, |shape| extents.get(shape).copied())
        };
        Cell {
            inside,
            shade: shade.unwrap_or(ShapeSet::ALL),
        }
    }

    /// What may shade a place on a surface.
    #[cfg_attr(narrow_mul, inline(never))]
    pub fn shade_at(&self, place: Point) -> ShapeSet {
        if self.cells.cells.is_empty() {
            return ShapeSet::ALL;
        }
        let cell = self
            .cells
            .index(self.parts.grid.origin().to(place))
            .and_then(|cell| self.cells.cells.get(self.cells.place(cell)));
        cell.map_or(ShapeSet::ALL, |cell| cell.shade)
    }

    /// [`Self::closest`] from cell to cell, of a ray that leaves shape number `from`; `None` where that does not tell.
    #[inline]
    pub(super) fn closest_in_cells(&self, ray: &Ray, from: u16) -> Option<Option<Hit>> {
        if self.cells.cells.is_empty() {
            return None;
        }
        let grid = &self.parts.grid;
        let offset = grid.origin().to(ray.origin);
        let cell = self.cells.index(offset)?;
        let mut inside = self.cells.inside(self.cells.place(cell))?;
        let start = offset.0.map(|c| c >> grid.shift());
        let mut walk = self.cells.walk(cell, start, ray.dir);
        let (mut nearest, mut t_max) = (usize::MAX, FAR + 1);
        // Where the nearest hit is.
        let mut end = usize::MAX;
        // A flat shape is not met by what leaves it: that is lifted off and goes away, or along it to beyond its sides.
        let own = self.parts.shapes.get(from as usize);
        let mut asked = match own {
            Some(shape) if is_flat(&shape.geometry) => 1u32 << (from & 31),
            _ => 0,
        };
        loop {
            if inside != 0 {
                let mut rest = inside & !asked;
                asked |= inside;
                while rest != 0 {
                    let index = (31 - leading_zeros(rest)) as usize;
                    rest ^= 1 << index;
                    let shape = self.parts.shapes.get(index)?;
                    if let Some(t) = self.form(&shape.geometry, ray, t_max + (index < nearest) as i32) {
                        (nearest, t_max) = (index, t);
                        let place = [0, 1, 2].map(|a| offset.0[a] + mul_q16(ray.dir.0[a], t));
                        end = self
                            .cells
                            .index(Offset(place))
                            .map_or(usize::MAX, |cell| self.cells.place(cell));
                    }
                }
                if walk.at == end {
                    break;
                }
            }
            if !walk.goes_on() {
                break;
            }
            inside = self.cells.inside(walk.at)?;
        }
        Some((nearest != usize::MAX).then(|| Hit::of_form(nearest, t_max)))
    }
}

/// The cells along a ray.
///
/// It is off by a step of the grid at the ray's origin, and by four at the far face for the direction's 14 bits: less than the
/// [`crate::bvh::SCENE_PAD`] steps that a shape's box has to spare.
struct CellWalk {
    at: usize,
    /// Of x and y, y and z, z and x, which comes to its next cell first: the former if below 0. (2^16 + 2^15) · 2^14 at most.
    first: [i32; 3],
    /// What a cell along each axis makes of that.
    step: [i32; 3],
    /// How many cells there are still along each axis.
    left: [i32; 3],
    stride: [i32; 3],
}

impl Cells<'_> {
    /// From a place in this cell, seen from the scene's grid in steps.
    #[inline(always)]
    fn walk(&self, cell: [u32; 3], start: [i32; 3], dir: Dir) -> CellWalk {
        let width = 1 << (16 - self.bits);
        // Along each axis: the slope's size, Q14; to the next cell, steps.
        let (mut size, mut ahead, mut left) = ([0; 3], [0; 3], [0; 3]);
        let mut stride = [1i32 << (2 * self.bits), 1 << self.bits, 1];
        for (a, d) in dir.0.into_iter().enumerate() {
            size[a] = (d.unsigned_abs() as i32 + 2) >> 2;
            let inner = start[a] & (width - 1);
            if d < 0 {
                ahead[a] = inner + 1;
                left[a] = cell[a] as i32;
                stride[a] = -stride[a];
            } else {
                ahead[a] = width - inner;
                left[a] = (1 << self.bits) - 1 - cell[a] as i32;
            }
        }
        CellWalk {
            at: self.place(cell),
            first: [
                ahead[0] * size[1] - ahead[1] * size[0],
                ahead[1] * size[2] - ahead[2] * size[1],
                ahead[2] * size[0] - ahead[0] * size[2],
            ],
            step: size.map(|size| size << (16 - self.bits)),
            left,
            stride,
        }
    }
}

impl CellWalk {
    /// On to the next cell; `false` where there is none.
    #[inline(always)]
    fn goes_on(&mut self) -> bool {
        let CellWalk {
            first: [xy, yz, zx],
            step,
            left,
            stride,
            ..
        } = self;
        let (left, stride) = if *xy < 0 && *zx >= 0 {
            (*xy, *zx) = (*xy + step[1], *zx - step[2]);
            (&mut left[0], stride[0])
        } else if *xy >= 0 && *yz < 0 {
            (*yz, *xy) = (*yz + step[2], *xy - step[0]);
            (&mut left[1], stride[1])
        } else {
            (*zx, *yz) = (*zx + step[0], *yz - step[1]);
            (&mut left[2], stride[2])
        };
        *left -= 1;
        self.at = self.at.wrapping_add_signed(stride as isize);
        *left >= 0
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::bvh::Node;
    use crate::color::Radiance;
    use crate::light::Light;
    use crate::material::Material;
    use crate::scene::SceneBuilder;
    use crate::scene::builtin::Builtin;
    use crate::shape::Sphere;

    /// Most cells of a room tell its shapes apart, and so do those of two balls; of one there is nothing to tell.
    #[test]
    fn cells_ask_the_tree_where_they_do_not_tell_shapes_apart() {
        let by_tree = |scene: Scene| {
            let mut cells = [Cell::UNKNOWN; 512];
            let scene = scene.foresee(&mut cells);
            let filled = scene.cells.cells.iter().filter(|cell| cell.inside != 0);
            let by_tree = filled.clone().filter(|cell| cell.inside & BY_TREE != 0);
            [by_tree.count(), filled.count()]
        };
        let [room, filled] = Builtin::Cornell.with(|scene, _| by_tree(*scene)).unwrap();
        assert!(20 * room < filled, "{room} of {filled}");
        let balls = |places: &[i32]| {
            let mut builder = SceneBuilder::<2, 1, 1>::new();
            let black = builder.material(Material::Black).unwrap();
            for x in places {
                let ball = Sphere::new(Point([*x, 0, 0]), 1 << 15);
                builder.shape(ball, black).unwrap();
            }
            let position = Point([0, 1 << 18, 0]);
            let intensity = Radiance::WHITE;
            builder.light(Light::Point { position, intensity }).unwrap();
            by_tree(builder.build(&mut [Node::EMPTY; 2]).unwrap())
        };
        let [one, filled] = balls(&[0]);
        assert!(one == filled && one > 0, "{one} of {filled}");
        let [two, filled] = balls(&[-1 << 16, 1 << 16]);
        assert!(two == 0 && filled > 0, "{two} of {filled}");
    }

    /// Each place of a ray, but for 6 steps about the cells' faces, is in a cell of the walk.
    #[test]
    fn a_walk_goes_by_where_its_ray_does() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state ^ (state >> 15)) as i32
        };
        let mut places = 0;
        for round in 0..60_000 {
            let bits = 1 + round % 5;
            let cells = Cells {
                cells: &[],
                bits,
                shift: 16 - bits,
            };
            let start = [(); 3].map(|()| random() & 0xffff);
            let mut to = [(); 3].map(|()| random() >> 16);
            to[round as usize % 3] >>= random() & 15;
            let Some(dir) = Dir::new(to) else { continue };
            let mut walk = cells.walk(cells.index(Offset(start)).unwrap(), start, dir);
            let mut visited = std::vec![walk.at];
            while walk.goes_on() {
                visited.push(walk.at);
            }
            for i in 0..40 {
                let t = f64::from(i) * 2500.0;
                let place = [0, 1, 2].map(|a| f64::from(start[a]) + 0.5 + t * f64::from(dir.0[a]) / 65_536.0);
                let width = f64::from(1 << (16 - bits));
                let is_clear = place
                    .iter()
                    .all(|c| (0.0..65_536.0).contains(c) && (6.0..width - 6.0).contains(&(c % width)));
                if is_clear {
                    let cell = cells.index(Offset(place.map(|c| c as i32))).unwrap();
                    assert!(
                        visited.contains(&cells.place(cell)),
                        "{start:?} {dir:?} {place:?} {bits}"
                    );
                    places += 1;
                }
            }
        }
        assert!(places > 500_000, "{places}");
    }
}
