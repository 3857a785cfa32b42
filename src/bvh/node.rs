use crate::shape::Bounds;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// Four children: their boxes, and where they are.
///
/// | byte | what |
/// |---|---|
/// | 0 ..= 23 | child planes, u8: for x, y, z the four low ones, then the four high ones |
/// | 24 ..= 27 | meta: 0 none; 0x80 + i the node `nodes` + i; (count << 4) + offset a leaf of 1 ..= 4 primitives |
/// | 28 ..= 33 | origin, 3×u16: a plane q lies at origin + (q << exponent) |
/// | 34 | exponent, 0 ..= 9 |
/// | 35 | bits 16 ..= 23 of the primitive base |
/// | 36, 37 | node base: the first inner child |
/// | 38, 39 | bits 0 ..= 15 of the primitive base: the first primitive of the first leaf |
///
/// Over a [`crate::shape::PackedMesh`] the primitive base is the offset of the node's block, and a leaf's offset four
/// times its place in it. Planes and meta come first since a Thumb-1 byte load reaches 31 bytes. Little-endian in flash.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct Node {
    pub(crate) planes: Planes,
    pub(crate) meta: [u8; 4],
    pub(crate) origin: [u16; 3],
    pub(crate) exponent: u8,
    primitives_high: u8,
    pub(crate) nodes: u16,
    primitives_low: u16,
}

/// `[axis][low or high][child]`.
pub(crate) type Planes = [[[u8; 4]; 2]; 3];

const _: () = assert!(size_of::<Node>() == 40 && align_of::<Node>() == 2);
const _: () = assert!(core::mem::offset_of!(Node, meta) == 24 && core::mem::offset_of!(Node, origin) == 28);
const _: () = assert!(core::mem::offset_of!(Node, nodes) == 36);

/// What a slot of a node holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    None,
    Node(u16),
    /// Base and leaf, as [`super::primitives`] takes them.
    Leaf(u32, u32),
}

impl Node {
    /// Without children.
    pub const EMPTY: Node = Node {
        planes: [[[u8::MAX; 4], [0; 4]]; 3],
        meta: [0; 4],
        origin: [0; 3],
        exponent: 0,
        primitives_high: 0,
        nodes: 0,
        primitives_low: 0,
    };

    /// As it lies in flash: the bytes of the table above.
    pub fn to_le_bytes(self) -> [u8; 40] {
        let mut bytes = [0; 40];
        bytes[..24].copy_from_slice(self.planes.as_flattened().as_flattened());
        bytes[24..28].copy_from_slice(&self.meta);
        for (two, value) in bytes[28..34].chunks_exact_mut(2).zip(self.origin) {
            two.copy_from_slice(&value.to_le_bytes());
        }
        bytes[34] = self.exponent;
        bytes[35] = self.primitives_high;
        bytes[36..38].copy_from_slice(&self.nodes.to_le_bytes());
        bytes[38..].copy_from_slice(&self.primitives_low.to_le_bytes());
        bytes
    }

    /// What [`Node::to_le_bytes`] wrote. Whether it makes sense is checked with its scene.
    pub const fn from_le_bytes(bytes: [u8; 40]) -> Node {
        const fn two(bytes: &[u8; 40], at: usize) -> u16 {
            u16::from_le_bytes([bytes[at], bytes[at + 1]])
        }
        let mut node = Node::EMPTY;
        let mut at = 0;
        while at < 24 {
            node.planes[at / 8][at / 4 % 2][at % 4] = bytes[at];
            at += 1;
        }
        node.meta = [bytes[24], bytes[25], bytes[26], bytes[27]];
        node.origin = [two(&bytes, 28), two(&bytes, 30), two(&bytes, 32)];
        node.exponent = bytes[34];
        node.primitives_high = bytes[35];
        node.nodes = two(&bytes, 36);
        node.primitives_low = two(&bytes, 38);
        node
    }

    /// Around `bounds`, with the finest exponent that reaches across; leaves count from `primitives` (< 2^24).
    pub fn around(bounds: Bounds, nodes: u16, primitives: u32) -> Node {
        let extent = (0..3)
            .map(|a| bounds.high[a].saturating_sub(bounds.low[a]))
            .max()
            .unwrap_or(0) as u32;
        // 255 << 9 > 65535.
        let exponent = (0..9).find(|&e| extent <= 255 << e).unwrap_or(9);
        Node {
            origin: bounds.low,
            exponent,
            primitives_high: (primitives >> 16) as u8,
            nodes,
            primitives_low: primitives as u16,
            ..Node::EMPTY
        }
    }

    /// Put a child in a slot: planes rounded outwards from a box within the node's.
    pub fn set(&mut self, slot: usize, bounds: Bounds, meta: u8) {
        let e = self.exponent;
        for (a, planes) in self.planes.iter_mut().enumerate() {
            let low = bounds.low[a].saturating_sub(self.origin[a]) as u32;
            let high = bounds.high[a].saturating_sub(self.origin[a]) as u32;
            planes[0][slot & 3] = (low >> e) as u8;
            planes[1][slot & 3] = ((high + (1 << e) - 1) >> e) as u8;
        }
        self.meta[slot & 3] = meta;
    }

    /// The first primitive of the node's leaves, or, of a packed mesh, where their block begins.
    #[inline(always)]
    pub(crate) const fn primitives(&self) -> u32 {
        (self.primitives_high as u32) << 16 | self.primitives_low as u32
    }

    /// The index of an inner child.
    #[inline(always)]
    pub(crate) const fn node(&self, meta: u8) -> u16 {
        self.nodes.wrapping_add((meta & 3) as u16)
    }

    /// The four slots: boxes, as the planes give them, and what is in them.
    pub fn children(&self) -> [(Bounds, Child); 4] {
        [0, 1, 2, 3].map(|slot| (self.bounds(slot), self.child(self.meta[slot])))
    }

    pub(crate) const fn child(&self, meta: u8) -> Child {
        if meta & 0x80 != 0 {
            Child::Node(self.node(meta))
        } else if meta >= 0x10 {
            Child::Leaf(self.primitives(), meta as u32)
        } else {
            Child::None
        }
    }

    /// A child's box as its planes give it, grid coordinates: what lies beyond the cube is cut off.
    pub(crate) fn bounds(&self, slot: usize) -> Bounds {
        let plane = |a: usize, side: usize| {
            let q = self.planes[a][side][slot & 3] as u32;
            (self.origin[a] as u32 + (q << (self.exponent & 15))).min(65535) as u16
        };
        Bounds {
            low: [0, 1, 2].map(|a| plane(a, 0)),
            high: [0, 1, 2].map(|a| plane(a, 1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_where_the_table_says() {
        let bytes: [u8; 40] = core::array::from_fn(|at| at as u8);
        let node = Node::from_le_bytes(bytes);
        assert_eq!(node.planes[1][0], [8, 9, 10, 11]);
        assert_eq!(
            (node.meta, node.origin[2], node.exponent, node.primitives()),
            ([24, 25, 26, 27], 0x2120, 34, 0x23_2726)
        );
        assert_eq!(node.to_le_bytes(), bytes);
    }

    #[test]
    fn planes_round_outwards() {
        let all = Bounds {
            low: [9, 100, 1000],
            high: [1009, 300, 1300],
        };
        let mut node = Node::around(all, 5, 70_000);
        assert_eq!((node.exponent, node.primitives()), (2, 70_000));
        let part = Bounds {
            low: [10, 103, 1001],
            high: [1009, 299, 1300],
        };
        node.set(1, part, 0x23);
        assert_eq!(
            node.bounds(1),
            Bounds {
                low: [9, 100, 1000],
                high: [1009, 300, 1300]
            }
        );
        assert_eq!(node.child(node.meta[1]), Child::Leaf(70_000, 0x23));
        assert_eq!(node.child(0x82), Child::Node(7));
        assert_eq!(node.child(node.meta[0]), Child::None);
    }
}
