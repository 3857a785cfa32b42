/// A ray as a tree's grid sees it.
#[derive(Clone, Copy)]
pub struct Ray {
    /// Where it starts along its dominant axis, 0 ..= 65535.
    pub plane: i32,
    /// Steps across for one along the axis, Q13, within ±2^13.
    pub slopes: [i32; 2],
    /// What a place across, Q13, less its slope's share, lacks to lie on the ray.
    pub offsets: [i32; 2],
    /// Whether it goes down the axis.
    pub negative: bool,
    /// The dominant axis, 0 to 2; the slopes are of the two that follow.
    pub axis: u8,
}

/// Which of a node's children comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    Any,
    /// By where its box begins along the dominant axis.
    Face,
    /// By where the ray enters its box.
    Entry,
}

/// Bytes of a node.
pub(crate) const NODE: usize = 40;

/// Whether there are `count` nodes, 2-aligned, and no more than an index can tell apart.
#[inline(always)]
pub(crate) fn are_nodes(nodes: &[u8], count: usize) -> bool {
    count <= 1 << 16 && count * NODE <= nodes.len() && nodes.as_ptr() as usize & 1 == 0
}

/// What tells where a ray comes to the planes of an axis across.
#[cfg(not(armv6m))]
#[repr(C)]
#[derive(Clone, Copy)]
pub(crate) struct Across {
    /// The slope's size · 2^8: as far aside or farther is no way within a node. 0 of slopes under 1/32.
    pub(crate) beyond: u32,
    /// 2^23 over the slope's size.
    pub(crate) recip: u32,
}

/// Nodes that may wait: what is more is passed by.
pub const STACK: usize = 40;
/// Fraction bits of a triangle's depth.
pub const DEPTH_BITS: u32 = 4;

/// Leaves of a node that the ray may meet.
#[derive(Clone, Copy)]
pub struct Leaves {
    base: u32,
    metas: u32,
}

/// Beside a node's first primitive: no node comes after it.
pub(crate) const LAST_BIT: u32 = 31;

impl Leaves {
    /// What a step found: the first primitive, and above it the leaves' bytes; `None` at the end of the walk.
    #[inline(always)]
    pub(crate) fn found(found: u64) -> Option<Leaves> {
        let (base, metas) = (found as u32, (found >> 32) as u32);
        (base != u32::MAX).then_some(Leaves { base, metas })
    }

    /// Of the node's leaves, the first primitive.
    #[inline(always)]
    pub fn base(self) -> u32 {
        self.base & 0xff_ffff
    }

    /// A byte for each, as the node has it.
    #[inline(always)]
    pub fn metas(self) -> u32 {
        self.metas
    }

    /// Whether no node comes after theirs.
    #[inline(always)]
    pub fn is_last(self) -> bool {
        self.base >> LAST_BIT != 0
    }
}

/// Where a ray meets a triangle, the first of those of its depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Met {
    pub triangle: u32,
    /// Along the dominant axis, in 1/16 steps, 1 or more.
    pub depth: i32,
    /// Weights of the second and third corner, Q16.
    pub weights: [i32; 2],
}

/// A vertex as a ray sees it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Corner {
    /// Steps aside; under 2^18 in magnitude.
    pub at: [i32; 2],
    /// Its coordinate along the dominant axis.
    pub z: i32,
}

/// Which of `triangles` lies there.
#[inline(always)]
pub(crate) fn number_of(triangle: usize, triangles: *const [u16; 3]) -> u32 {
    // An exact quotient: by 2, and by the inverse of 3 modulo 2^32.
    (triangle.wrapping_sub(triangles as usize) as u32 >> 1).wrapping_mul(0xaaaa_aaab)
}
