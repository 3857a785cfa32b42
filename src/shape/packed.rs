//! Triangles that take a few bytes each in flash: vertices in groups, indices of one byte, edges said once.
//!
//! The stream of leaves is a row of blocks, one for each node that has leaves, in the order in which
//! [`crate::bvh::check_mesh`] meets the nodes; a node's primitive base is its block's offset.
//!
//! | part of a block | what |
//! |---|---|
//! | u16 | leaves − 1 in bits 0 and 1, above them the number of the treelet that all its vertices belong to |
//! | then for each leaf: u8 | triangles − 1 in bits 0 and 1, then two bits for each further triangle: its code |
//! | u8 … | vertices: 3 of the first triangle, then 1 for each code 0 ..= 2, 3 for each code 3 |
//!
//! Code 0, 1, 2: the triangle begins with an edge of the one before, (a, b, c), run backwards: (b, a), (c, b), (a, c);
//! one more vertex completes it. Code 3: it shares none.
//!
//! A triangle's number is its block's offset · 16 + its leaf's place in the block · 4 + its place in the leaf. It rises
//! along the stream; it is what decides ties, and what a [`super::MeshHit`] names.

use super::attributes::Layers;
use super::grid::{Bounds, Grid};
use super::mesh::MeshError;
use super::treelet::Treelet;
use crate::geom::Octahedral;
use core::ops::ControlFlow;
use zerocopy::FromBytes;

/// A mesh as it was packed (on a host), borrowed as it lies in flash.
///
/// Nothing here panics for wrong bytes: such a triangle is never hit. [`crate::bvh::check_mesh`] is the border.
#[derive(Clone, Copy, Debug)]
pub struct PackedMesh<'a> {
    pub grid: Grid,
    /// Around all vertices, grid coordinates.
    pub bounds: Bounds,
    /// What vertices say beside where they are.
    pub layers: Layers,
    pub treelets: &'a [Treelet],
    /// Vertices of all treelets, then [`PackedMesh::TAIL`] bytes of any value.
    pub vertices: &'a [u8],
    /// Blocks, as the head of this file has them; under 2^24 bytes.
    pub leaves: &'a [u8],
}

impl<'a> PackedMesh<'a> {
    /// A distance of 16 bits is read with the three bytes it may lie in.
    pub const TAIL: usize = 2;

    /// The leaf at a place of a block, before its first triangle.
    #[inline]
    pub(crate) fn leaf(&self, block: u32, place: u32) -> Option<Strip<'a, ()>> {
        let &[low, high] = self.leaves.get(block as usize..)?.first_chunk()?;
        let treelet = self
            .treelets
            .get((u16::from_le_bytes([low, high]) >> 2) as usize)?;
        let mut at = block as usize + 2;
        for _ in 0..place {
            at += length(*self.leaves.get(at)?);
        }
        let head = *self.leaves.get(at)?;
        Some(Strip {
            treelet,
            rest: self.leaves.get(at + 1..)?,
            codes: u32::from(head | 3),
            corners: [(); 3],
        })
    }

    /// Each triangle of a leaf, its number and what `see` makes of its corners, until `look` breaks.
    ///
    /// The leaf as [`super::Triangles::of_leaf`] takes it.
    #[inline(always)]
    pub(crate) fn each_of_leaf<T: Copy>(
        &self,
        base: u32,
        leaf: u32,
        see: impl Fn(&[u16; 3]) -> T + Copy,
        mut look: impl FnMut(u32, &[T; 3]) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let strip = self.leaf(base, leaf >> 2 & 3);
        let Some(mut strip) = strip.and_then(|strip| strip.begin(self, see)) else {
            return ControlFlow::Continue(());
        };
        let first = base << 4 | leaf & 12;
        let mut number = first;
        loop {
            look(number, &strip.corners)?;
            number += 1;
            if number - first >= leaf >> 4 || strip.advance(self, see).is_none() {
                return ControlFlow::Continue(());
            }
        }
    }

    /// The corners of the triangle with a number, grid coordinates.
    pub(crate) fn corners(&self, triangle: u32) -> Option<[[u16; 3]; 3]> {
        // In words, which are copied quicker than half words are.
        let words = |&[x, y, z]: &[u16; 3]| [u32::from(x) | u32::from(y) << 16, z.into()];
        let leaf = self.leaf(triangle >> 4, triangle >> 2 & 3)?;
        let mut strip = leaf.begin(self, words)?;
        for _ in 0..(triangle & 3) {
            strip.advance(self, words)?;
        }
        Some(
            strip
                .corners
                .map(|[xy, z]| [xy as u16, (xy >> 16) as u16, z as u16]),
        )
    }

    /// The treelet of the triangle with a number, and its corners' indices in it.
    fn indices(&self, triangle: u32) -> Option<(&'a Treelet, [u8; 3])> {
        let Strip {
            treelet,
            mut rest,
            mut codes,
            ..
        } = self.leaf(triangle >> 4, triangle >> 2 & 3)?;
        let mut next = || {
            let (&index, after) = rest.split_first()?;
            rest = after;
            Some(index)
        };
        let mut corners = [0; 3];
        for _ in 0..=(triangle & 3) {
            let [a, b, c] = corners;
            let [first, second] = match codes & 3 {
                0 => [b, a],
                1 => [c, b],
                2 => [a, c],
                _ => [next()?, next()?],
            };
            codes >>= 2;
            corners = [first, second, next()?];
        }
        Some((treelet, corners))
    }

    /// What a vertex of a treelet says beside where it is; empty if it says nothing.
    fn said(&self, treelet: &Treelet, index: u8) -> Option<&'a [u8]> {
        let stride = self.layers.stride();
        let begin = treelet.start() + treelet.size();
        self.vertices
            .get(begin + usize::from(index) * stride..)?
            .get(..stride)
    }

    /// What the corners of the triangle with a number say in one of the layers; `None` if it has it not.
    fn layer<T: FromBytes>(&self, triangle: u32, layer: Layers) -> Option<[T; 3]> {
        if !self.layers.has(layer) {
            return None;
        }
        let (treelet, [a, b, c]) = self.indices(triangle)?;
        let one = |index| {
            let said = self.said(treelet, index)?.get(self.layers.before(layer)..)?;
            T::read_from_prefix(said).ok().map(|(value, _)| value)
        };
        Some([one(a)?, one(b)?, one(c)?])
    }

    pub(crate) fn normals(&self, triangle: u32) -> Option<[Octahedral; 3]> {
        self.layer(triangle, Layers::NORMALS)
    }

    pub(crate) fn colors(&self, triangle: u32) -> Option<[[u8; 3]; 3]> {
        self.layer(triangle, Layers::COLORS)
    }

    pub(crate) fn uvs(&self, triangle: u32) -> Option<[[i16; 2]; 3]> {
        let bytes: [[[u8; 2]; 2]; 3] = self.layer(triangle, Layers::UVS)?;
        Some(bytes.map(|uv| uv.map(i16::from_le_bytes)))
    }

    /// Each leaf in the order of the stream: block, place in it, triangles. It ends where the stream does, or makes no
    /// sense.
    pub(crate) fn each_leaf(&self) -> Leaves<'a> {
        Leaves {
            stream: self.leaves,
            block: 0,
            at: 0,
            place: 0,
            left: 0,
        }
    }
}

/// Bytes of a leaf that begins with this one.
#[inline(always)]
fn length(head: u8) -> usize {
    let apart = (head & head >> 1) >> 2;
    let apart = (apart & 1) + (apart >> 2 & 1) + (apart >> 4 & 1);
    4 + (head & 3) as usize + 2 * apart as usize
}

/// The triangles of a leaf, one after the other.
pub(crate) struct Strip<'a, T> {
    treelet: &'a Treelet,
    rest: &'a [u8],
    /// Those to come, the next in the lowest bits.
    codes: u32,
    /// Of the triangle at hand.
    pub corners: [T; 3],
}

impl<'a> Strip<'a, ()> {
    /// With its first triangle; `see` makes of a vertex what is kept of it.
    #[inline]
    pub fn begin<T: Copy>(
        self,
        mesh: &PackedMesh,
        see: impl Fn(&[u16; 3]) -> T + Copy,
    ) -> Option<Strip<'a, T>> {
        let Strip {
            treelet,
            mut rest,
            codes,
            ..
        } = self;
        let corners = [
            next(treelet, &mut rest, mesh, see)?,
            next(treelet, &mut rest, mesh, see)?,
            next(treelet, &mut rest, mesh, see)?,
        ];
        Some(Strip {
            treelet,
            rest,
            codes: codes >> 2,
            corners,
        })
    }
}

impl<T: Copy> Strip<'_, T> {
    /// On to the next triangle; `see` makes of a vertex what is kept of it.
    #[inline(never)]
    pub fn advance(&mut self, mesh: &PackedMesh, see: impl Fn(&[u16; 3]) -> T + Copy) -> Option<()> {
        match self.codes & 3 {
            0 => self.corners.swap(0, 1),
            1 => self.corners[0] = self.corners[2],
            2 => self.corners[1] = self.corners[2],
            _ => {
                self.corners[0] = next(self.treelet, &mut self.rest, mesh, see)?;
                self.corners[1] = next(self.treelet, &mut self.rest, mesh, see)?;
            }
        }
        self.codes >>= 2;
        self.corners[2] = next(self.treelet, &mut self.rest, mesh, see)?;
        Some(())
    }
}

/// The next vertex of a strip's, of which `rest` is still to come.
#[cfg_attr(narrow_mul, inline(never))]
#[cfg_attr(not(narrow_mul), inline)]
fn next<T>(
    treelet: &Treelet,
    rest: &mut &[u8],
    mesh: &PackedMesh,
    see: impl Fn(&[u16; 3]) -> T,
) -> Option<T> {
    let (&index, after) = rest.split_first()?;
    *rest = after;
    Some(see(&treelet.vertex(mesh.vertices, index)?))
}

/// What [`PackedMesh::each_leaf`] walks along.
pub(crate) struct Leaves<'a> {
    stream: &'a [u8],
    block: usize,
    /// Where the next leaf, or block, begins.
    pub at: usize,
    place: u32,
    /// Leaves of the block that are still to come.
    left: u32,
}

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Leaf {
    pub block: u32,
    pub place: u32,
    pub count: u32,
}

impl Leaf {
    /// The number of its first triangle.
    pub fn first(&self) -> u32 {
        self.block << 4 | self.place << 2
    }
}

impl Iterator for Leaves<'_> {
    type Item = Leaf;

    fn next(&mut self) -> Option<Leaf> {
        if self.left == 0 {
            let &[low, _] = self.stream.get(self.at..)?.first_chunk()?;
            (self.block, self.at) = (self.at, self.at + 2);
            (self.place, self.left) = (0, u32::from(low & 3) + 1);
        }
        let head = *self.stream.get(self.at)?;
        let leaf = Leaf {
            block: self.block as u32,
            place: self.place,
            count: u32::from(head & 3) + 1,
        };
        self.at += length(head);
        (self.place, self.left) = (self.place + 1, self.left - 1);
        Some(leaf)
    }
}

impl PackedMesh<'_> {
    /// What of a leaf could not be rendered, if anything.
    pub(crate) fn check_leaf(&self, leaf: Leaf) -> Result<(), MeshError> {
        let block = leaf.block as usize;
        let fault = MeshError::Cut {
            triangle: leaf.first(),
        };
        let head = self
            .leaves
            .get(block..)
            .and_then(|b| b.first_chunk())
            .ok_or(fault)?;
        let number = u16::from_le_bytes(*head) >> 2;
        let treelet = self.treelets.get(number as usize);
        let treelet = treelet.ok_or(MeshError::Treelet {
            triangle: leaf.first(),
        })?;
        if !treelet.is_valid() {
            return Err(MeshError::Width { treelet: number });
        }
        let strip = self.leaf(leaf.block, leaf.place).ok_or(fault)?;
        let bytes = length((strip.codes & !3) as u8 | (leaf.count - 1) as u8) - 1;
        let indices = strip.rest.get(..bytes).ok_or(fault)?;
        if indices.iter().any(|&index| index > treelet.last()) {
            return Err(MeshError::Index {
                triangle: leaf.first(),
            });
        }
        let cut = MeshError::Vertices { treelet: number };
        let mut strip = strip.begin(self, |vertex| *vertex).ok_or(cut)?;
        for triangle in leaf.first()..leaf.first() + leaf.count {
            if triangle > leaf.first() {
                strip.advance(self, |vertex| *vertex).ok_or(cut)?;
            }
            let keeps = Grid::MARGIN..=u16::MAX - Grid::MARGIN;
            if !strip.corners.as_flattened().iter().all(|c| keeps.contains(c)) {
                return Err(MeshError::Corner { triangle });
            }
            if !self.bounds.contains(Bounds::of(&strip.corners)) {
                return Err(MeshError::Bounds { triangle });
            }
        }
        match self.said(treelet, treelet.last()) {
            Some(_) => Ok(()),
            None => Err(MeshError::Vertices { treelet: number }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point;

    /// Two leaves in one block: a strip of three, then two triangles apart.
    #[test]
    fn strips_unfold() {
        let points: [[u16; 3]; 5] = [
            [100, 200, 300],
            [107, 200, 300],
            [100, 203, 309],
            [107, 203, 300],
            [100, 201, 315],
        ];
        let mut bits = 0u64;
        for (i, p) in points.iter().enumerate() {
            let local = (p[0] - 100) as u64 | ((p[1] - 200) as u64) << 3 | ((p[2] - 300) as u64) << 5;
            bits |= local << (9 * i);
        }
        let treelets = [Treelet::new([100, 200, 300], [3, 2, 4], 1, 5)];
        let mut vertices = [0; 9];
        vertices[1..].copy_from_slice(&bits.to_le_bytes());
        let leaves = [
            1,
            0,
            2 | 1 << 2 | 2 << 4,
            0,
            1,
            2,
            3,
            4,
            1 | 3 << 2,
            4,
            3,
            2,
            0,
            0,
            1,
        ];
        let mesh = PackedMesh {
            grid: Grid::new(Point([0; 3]), 0).unwrap(),
            bounds: Bounds::of(&[[100, 200, 300], [107, 203, 315], [100, 200, 300]]),
            layers: Layers::default(),
            treelets: &treelets,
            vertices: &vertices,
            leaves: &leaves,
        };
        let triangle = |t: [usize; 3]| Some(t.map(|i| points[i]));
        // (0, 1, 2), its edge (1, 2) run backwards, then (3)'s third edge.
        for (number, t) in [
            (0, [0, 1, 2]),
            (1, [2, 1, 3]),
            (2, [2, 3, 4]),
            (4, [4, 3, 2]),
            (5, [0, 0, 1]),
        ] {
            assert_eq!(mesh.corners(number), triangle(t), "{number}");
        }
        let leaves: std::vec::Vec<Leaf> = mesh.each_leaf().collect();
        assert_eq!(
            leaves
                .iter()
                .map(|l| (l.first(), l.count))
                .collect::<std::vec::Vec<_>>(),
            [(0, 3), (4, 2)]
        );
        assert!(leaves.iter().all(|&leaf| mesh.check_leaf(leaf).is_ok()));
    }
}
