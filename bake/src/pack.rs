//! A mesh and its tree, packed as [`microlux::shape::PackedMesh`] has it: lossless, in the tree's order.

use std::collections::{HashMap, HashSet};
use std::fmt;

use microlux::bvh::{Child, Node, primitives};
use microlux::geom::Octahedral;
use microlux::scene::Mesh;
use microlux::shape::{Attributes, Bounds, Grid, Layers, PackedMesh, Treelet, TriangleMesh, Triangles};
use zerocopy::IntoBytes;

/// Where a vertex is, and what else it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Vertex {
    place: [u16; 3],
    normal: Octahedral,
    color: [u8; 3],
    uv: [i16; 2],
}

type Corners = [Vertex; 3];

/// A packed mesh by value.
#[derive(Clone, Debug)]
pub struct Packed {
    pub grid: Grid,
    pub bounds: Bounds,
    pub layers: Layers,
    pub treelets: Vec<Treelet>,
    pub vertices: Vec<u8>,
    pub leaves: Vec<u8>,
    pub nodes: Vec<Node>,
}

/// Why a mesh can't be packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PackError {
    /// A node names a node or a triangle there is not.
    Tree { node: usize },
    /// More treelets than can be numbered, or more bytes than 2^24.
    TooLarge { triangles: usize },
}

impl fmt::Display for PackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tree { node } => write!(f, "node {node} of the tree names what there is not"),
            Self::TooLarge { triangles } => {
                write!(f, "{triangles} triangles are too many to pack: split the mesh")
            }
        }
    }
}

impl std::error::Error for PackError {}

/// Most treelets: a block numbers its own with 14 bits.
const TREELETS: usize = 1 << 14;
/// Most vertices of a treelet.
const VERTICES: usize = 256;

impl Packed {
    /// Packs a mesh whose tree is as [`microlux::bvh::check_mesh`] wants it.
    pub fn new(mesh: &TriangleMesh, nodes: &[Node]) -> Result<Packed, PackError> {
        let blocks = blocks(mesh, nodes)?;
        let mut packed = Packed {
            grid: mesh.grid,
            bounds: mesh.bounds(),
            layers: mesh.attributes.layers(),
            treelets: Vec::new(),
            vertices: Vec::new(),
            leaves: Vec::new(),
            nodes: nodes.to_vec(),
        };
        for group in groups(&blocks, packed.layers) {
            packed.treelet(&blocks[group]);
        }
        packed.vertices.extend([0; PackedMesh::TAIL]);
        let bytes = packed.leaves.len().max(packed.vertices.len());
        if packed.treelets.len() > TREELETS || bytes >= 1 << 24 {
            return Err(PackError::TooLarge {
                triangles: mesh.triangles.len(),
            });
        }
        Ok(packed)
    }

    /// As a scene borrows it.
    pub fn mesh(&self) -> Mesh<'_> {
        Mesh {
            triangles: Triangles::Packed(PackedMesh {
                grid: self.grid,
                bounds: self.bounds,
                layers: self.layers,
                treelets: &self.treelets,
                vertices: &self.vertices,
                leaves: &self.leaves,
            }),
            nodes: &self.nodes,
        }
    }

    /// Appends the vertices and blocks of one treelet; its nodes learn where their blocks are.
    fn treelet(&mut self, blocks: &[Block]) {
        let mut group = Group::default();
        let mut places: HashMap<Vertex, u8> = HashMap::new();
        let mut order = Vec::new();
        for vertex in blocks.iter().flat_map(Block::vertices) {
            if group.vertices.insert(vertex) {
                places.insert(vertex, order.len() as u8);
                order.push(vertex);
            }
            group.bounds = group.bounds.union(Bounds::of(&[vertex.place]));
        }
        let (number, base, widths) = (self.treelets.len(), group.bounds.low, group.widths());
        let start = self.vertices.len() as u32;
        self.treelets
            .push(Treelet::new(base, widths, start, order.len() as u32));
        let mut bits = BitWriter::default();
        for vertex in &order {
            for axis in 0..3 {
                bits.push(u32::from(vertex.place[axis] - base[axis]), widths[axis]);
            }
        }
        self.vertices.extend(bits.bytes);
        for vertex in &order {
            if self.layers.has(Layers::NORMALS) {
                self.vertices.extend(vertex.normal.as_bytes());
            }
            if self.layers.has(Layers::COLORS) {
                self.vertices.extend(vertex.color);
            }
            if self.layers.has(Layers::UVS) {
                self.vertices
                    .extend(vertex.uv.iter().flat_map(|part| part.to_le_bytes()));
            }
        }
        for block in blocks {
            let offset = self.leaves.len() as u32;
            let head = (number << 2 | (block.leaves.len() - 1)) as u16;
            self.leaves.extend(head.to_le_bytes());
            for leaf in &block.leaves {
                strip(leaf, |vertex| places[&vertex], &mut self.leaves);
            }
            if let Some(node) = self.nodes.get_mut(block.node) {
                *node = place(node, offset);
            }
        }
    }
}

/// A node's leaves become those of the block at `offset`.
fn place(node: &Node, offset: u32) -> Node {
    let mut bytes = node.to_le_bytes();
    let mut leaf = 0;
    for meta in &mut bytes[24..28] {
        if (0x10..0x80).contains(meta) {
            *meta = *meta & 0x70 | leaf << 2;
            leaf += 1;
        }
    }
    let [low, middle, high, _] = offset.to_le_bytes();
    (bytes[35], bytes[38], bytes[39]) = (high, low, middle);
    Node::from_le_bytes(bytes)
}

fn corners(mesh: &TriangleMesh, triangle: u32) -> Option<Corners> {
    let Attributes { normals, colors, uvs } = mesh.attributes;
    let vertex = |index: u16| {
        let index = usize::from(index);
        Some(Vertex {
            place: *mesh.vertices.get(index)?,
            normal: normals.get(index).copied().unwrap_or_default(),
            color: colors.get(index).copied().unwrap_or_default(),
            uv: uvs.get(index).copied().unwrap_or_default(),
        })
    };
    let [a, b, c] = *mesh.triangles.get(triangle as usize)?;
    Some([vertex(a)?, vertex(b)?, vertex(c)?])
}

/// The leaves of one node.
struct Block {
    node: usize,
    leaves: Vec<Vec<Corners>>,
}

impl Block {
    fn vertices(&self) -> impl Iterator<Item = Vertex> + '_ {
        self.leaves.iter().flatten().flatten().copied()
    }
}

/// The nodes with leaves, in the order in which a check meets them.
fn blocks(mesh: &TriangleMesh, nodes: &[Node]) -> Result<Vec<Block>, PackError> {
    let mut blocks = Vec::new();
    let mut waiting = if nodes.is_empty() { vec![] } else { vec![0] };
    let mut visits = 0;
    while let Some(node) = waiting.pop() {
        visits += 1;
        let wrong = PackError::Tree { node };
        let found = nodes.get(node).filter(|_| visits <= nodes.len());
        let children = found.ok_or(wrong)?.children().map(|(_, child)| child);
        let mut leaves = Vec::new();
        for child in children {
            if let Child::Leaf(base, leaf) = child {
                let leaf = primitives(base, leaf).map(|triangle| corners(mesh, triangle));
                leaves.push(leaf.collect::<Option<Vec<_>>>().ok_or(wrong)?);
            }
        }
        if !leaves.is_empty() {
            blocks.push(Block { node, leaves });
        }
        waiting.extend(children.iter().rev().filter_map(|child| match child {
            Child::Node(node) => Some(usize::from(*node)),
            Child::Leaf(..) | Child::None => None,
        }));
    }
    Ok(blocks)
}

/// What a treelet would hold.
struct Group {
    vertices: HashSet<Vertex>,
    bounds: Bounds,
}

impl Default for Group {
    fn default() -> Self {
        Group {
            vertices: HashSet::new(),
            bounds: Bounds::EMPTY,
        }
    }
}

impl Group {
    fn widths(&self) -> [u32; 3] {
        [0, 1, 2].map(|axis| {
            let extent = self.bounds.high[axis] - self.bounds.low[axis];
            u16::BITS - extent.leading_zeros()
        })
    }

    fn bytes(&self, layers: Layers) -> usize {
        let places = Treelet::bytes(self.widths(), self.vertices.len() as u32);
        size_of::<Treelet>() + places + self.vertices.len() * layers.stride()
    }
}

/// The cut of the row of blocks into treelets that takes the fewest bytes.
fn groups(blocks: &[Block], layers: Layers) -> Vec<std::ops::Range<usize>> {
    // For each end the fewest bytes up to there, and where the last treelet begins.
    let mut best = vec![(0, 0)];
    for end in 1..=blocks.len() {
        let mut group = Group::default();
        let mut choice = (usize::MAX, 0);
        for begin in (0..end).rev() {
            for vertex in blocks[begin].vertices() {
                group.vertices.insert(vertex);
                group.bounds = group.bounds.union(Bounds::of(&[vertex.place]));
            }
            if group.vertices.len() > VERTICES {
                break;
            }
            choice = choice.min((best[begin].0 + group.bytes(layers), begin));
        }
        best.push(choice);
    }
    let mut cuts = Vec::new();
    let mut end = blocks.len();
    while end > 0 {
        let begin = best[end].1;
        cuts.push(begin..end);
        end = begin;
    }
    cuts.reverse();
    cuts
}

/// Appends a leaf, its triangles in the order that takes the fewest bytes, winding kept.
fn strip(leaf: &[Corners], place: impl Fn(Vertex) -> u8, bytes: &mut Vec<u8>) {
    let (head, vertices) = orders(leaf.len())
        .into_iter()
        .map(|order| along(leaf, &order))
        .min_by_key(|(_, vertices)| vertices.len())
        .unwrap_or_default();
    bytes.push(head);
    bytes.extend(vertices.into_iter().map(place));
}

/// A leaf's first byte and the vertices that follow if its triangles are taken in this order.
fn along(leaf: &[Corners], order: &[usize]) -> (u8, Vec<Vertex>) {
    let mut head = leaf.len() as u8 - 1;
    let mut vertices: Vec<Vertex> = Vec::new();
    let mut before: Option<Corners> = None;
    for (i, &triangle) in order.iter().enumerate() {
        let corners = leaf[triangle];
        match before.and_then(|before| shared(before, corners)) {
            Some((code, turned)) => {
                head |= code << (2 * i);
                vertices.push(turned[2]);
                before = Some(turned);
            }
            None => {
                if i > 0 {
                    head |= 3 << (2 * i);
                }
                vertices.extend(corners);
                before = Some(corners);
            }
        }
    }
    (head, vertices)
}

/// Which edge of a triangle the next one runs backwards, and the next one turned so that it begins with it.
fn shared([a, b, c]: Corners, [d, e, f]: Corners) -> Option<(u8, Corners)> {
    let edges = [[b, a], [c, b], [a, c]];
    (0..3).find_map(|code| {
        [[d, e, f], [e, f, d], [f, d, e]]
            .into_iter()
            .find(|turned| turned[..2] == edges[code])
            .map(|turned| (code as u8, turned))
    })
}

/// All orders of so many things.
fn orders(count: usize) -> Vec<Vec<usize>> {
    (0..count).fold(vec![Vec::new()], |shorter, next| {
        let longer = |order: Vec<usize>| {
            (0..=order.len()).map(move |at| {
                let mut order = order.clone();
                order.insert(at, next);
                order
            })
        };
        shorter.into_iter().flat_map(longer).collect()
    })
}

/// Numbers of any width behind each other, the first in the lowest bits.
#[derive(Default)]
struct BitWriter {
    bytes: Vec<u8>,
    used: u32,
}

impl BitWriter {
    fn push(&mut self, value: u32, width: u32) {
        for bit in 0..width {
            if self.used.is_multiple_of(8) {
                self.bytes.push(0);
            }
            if let Some(last) = self.bytes.last_mut() {
                *last |= ((value >> bit & 1) as u8) << (self.used % 8);
            }
            self.used += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(place: [u16; 3]) -> Vertex {
        Vertex {
            place,
            normal: Octahedral::default(),
            color: [0; 3],
            uv: [0; 2],
        }
    }

    #[test]
    fn four_around_a_corner_are_one_strip() {
        let p = |x: u16, y: u16| at([100 + x, 200 + y, 300]);
        let middle = p(0, 0);
        let ring = [p(1, 0), p(0, 1), p(9, 1), p(0, 9), p(5, 5)];
        // In an order that shares nothing, turned in all ways.
        let leaf = [
            [middle, ring[0], ring[1]],
            [ring[3], middle, ring[2]],
            [ring[1], ring[2], middle],
            [middle, ring[3], ring[4]],
        ];
        let (head, vertices) = orders(4)
            .into_iter()
            .map(|order| along(&leaf, &order))
            .min_by_key(|(_, vertices)| vertices.len())
            .unwrap();
        assert_eq!((head & 3, vertices.len()), (3, 6));
        assert_eq!(orders(4).iter().collect::<HashSet<_>>().len(), 24);
    }

    #[test]
    fn a_triangle_that_runs_an_edge_the_same_way_begins_anew() {
        let [a, b, c, d] = [1, 2, 3, 4].map(|c| at([c; 3]));
        assert_eq!(shared([a, b, c], [a, b, d]), None);
        assert_eq!(shared([a, b, c], [d, b, a]), Some((0, [b, a, d])));
        assert_eq!(shared([a, b, c], [a, c, d]), Some((2, [a, c, d])));
    }
}
