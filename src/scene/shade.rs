//! What may shade the surfaces in each part of a scene, told once.

use super::ahead::{Extent, MOST, NAME, Patch};
use super::{Scene, ShapeSet};
use crate::geom::Point;

/// What may stand between the surfaces in each cell of the scene's grid and the lights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shade<'a> {
    /// By x, y and z; none if nothing was told.
    cells: &'a [ShapeSet],
    /// Log2 of how many cells stand along each axis.
    bits: u32,
}

/// Log2 of the most cells along an axis.
const MOST_BITS: u32 = 5;
/// Shapes that sets have names for.
const SHAPES: usize = (1 << NAME) - 1;

impl Shade<'_> {
    pub(super) const UNKNOWN: Shade<'static> = Shade { cells: &[], bits: 0 };
}

impl<'a> Scene<'a> {
    /// Tells once, for each cell of a cube about the scene, which shapes may stand between the surfaces in it and the lights.
    /// Shadow rays of paths then ask those alone, with the same answers.
    ///
    /// 8, 64, 512, 4096 or 32,768 of `cells` are used; with fewer than 8, or more than 31 shapes, the scene stays as it is.
    /// Where more than six may matter, all are asked. It takes some thousand instructions a cell, and pays for long paths: what
    /// the camera sees itself is told block by block as it is drawn ([`Self::ahead`]).
    ///
    /// Haines and Wallace, "Shaft Culling for Efficient Ray-Traced Radiosity", 1991.
    pub fn foresee_shade(mut self, cells: &'a mut [ShapeSet]) -> Scene<'a> {
        let Some(bits) = (1..=MOST_BITS).rev().find(|bits| 1 << (3 * bits) <= cells.len()) else {
            return self;
        };
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
            *cell = self.shade_in(&cube, from, &extents).unwrap_or(ShapeSet::ALL);
        }
        self.shade = Shade { cells, bits };
        self
    }

    /// Of the surfaces in a box; `None` where there are none.
    fn shade_in(&self, cube: &Extent, from: [i32; 3], extents: &[Extent]) -> Option<ShapeSet> {
        let mut patches: heapless::Vec<Patch, MOST> = heapless::Vec::new();
        for (shape, extent) in (0..).zip(extents).filter(|(_, extent)| extent.meets(cube)) {
            let extent = extent.part_in(cube);
            let near = 0;
            patches.push(Patch { shape, near, extent }).ok()?;
        }
        if patches.is_empty() {
            return None;
        }
        self.shading(from, &patches, |shape| extents.get(shape).copied())
    }

    /// What may shade a place on a surface.
    #[inline]
    pub fn shade_at(&self, place: Point) -> ShapeSet {
        let Shade { cells, bits } = self.shade;
        if cells.is_empty() {
            return ShapeSet::ALL;
        }
        let grid = &self.parts.grid;
        let [x, y, z] = grid
            .origin()
            .to(place)
            .0
            .map(|c| (c >> grid.shift()) as u32 >> (16 - bits));
        if (x | y | z) >> bits != 0 {
            return ShapeSet::ALL;
        }
        let cell = cells.get(((x << bits | y) << bits | z) as usize);
        cell.copied().unwrap_or(ShapeSet::ALL)
    }
}
