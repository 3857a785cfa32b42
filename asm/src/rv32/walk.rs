use core::arch::naked_asm;
use core::marker::PhantomData;
use core::mem::{MaybeUninit, offset_of};
use core::ptr;

use super::facets::{self, Facets};
use crate::ray::{Across, DEPTH_BITS, Leaves, NODE, Order, Ray, STACK, are_nodes};

/// The place of [`step`]'s table of tests, by [`Order`].
const fn test_of(order: Order) -> u32 {
    match order {
        Order::Any => 48,
        Order::Face => 52,
        Order::Entry => 60,
    }
}

/// Where a ray is in a tree.
#[repr(C)]
pub struct Walk<'a> {
    nodes: *const u8,
    /// The last node's index · 2^16.
    last: u32,
    slopes: [i32; 2],
    offsets: [i32; 2],
    /// Where a node is looked at, of the dominant axis and the slopes' signs; and where several of its children are.
    node: MaybeUninit<u32>,
    several: MaybeUninit<u32>,
    across: MaybeUninit<[Across; 2]>,
    /// Of the planes along the dominant axis that the ray comes to first, bytes from a node's first.
    face: MaybeUninit<u32>,
    plane: i32,
    /// All ones for a ray that goes down the axis.
    flip: i32,
    /// The node that comes next, if it is not beyond the limit: depth and index, as those that wait.
    next: u32,
    /// What looks at leaves, if not the caller.
    facets: MaybeUninit<*mut Facets<'static>>,
    /// Bytes of those that wait; before them stands what is beyond every limit.
    waiting: u32,
    stack: MaybeUninit<[u32; STACK + 1]>,
    tree: PhantomData<&'a [u8]>,
}

impl<'a> Walk<'a> {
    /// At the root. `None` if `nodes`, 2-aligned, has less than `count` nodes of 40 bytes. `recips` are first guesses 2^47/n
    /// by n's seven bits below the top one.
    #[inline(always)]
    pub fn begin<'w>(
        place: &'w mut MaybeUninit<Walk<'a>>,
        nodes: &'a [u8],
        count: usize,
        ray: &Ray,
        order: Order,
        recips: &[u16; 128],
    ) -> Option<&'w mut Walk<'a>> {
        if count == 0 || !are_nodes(nodes, count) {
            return None;
        }
        let walk = place.as_mut_ptr();
        // SAFETY: what is not written here, `begin` writes, or may stay as it is.
        unsafe {
            (*walk).nodes = nodes.as_ptr();
            (*walk).last = (count as u32 - 1) << 16;
            (*walk).offsets = ray.offsets;
            (*walk).slopes = ray.slopes;
            (*walk).plane = ray.plane;
            (*walk).flip = -i32::from(ray.negative);
            (*walk).next = 0;
            (*walk).waiting = 0;
            begin(walk.cast(), u32::from(ray.axis.min(2)), test_of(order), recips);
            Some(place.assume_init_mut())
        }
    }

    /// On to the next node of which the ray may meet leaves before the limit.
    #[inline(always)]
    pub fn leaves(&mut self, limit: i32) -> Option<Leaves> {
        if limit < 0 {
            return None;
        }
        // SAFETY: `nodes` points to as many nodes as `last` says, which outlive the walk, and the stack is as full as
        // `waiting` says.
        Leaves::found(unsafe { step(ptr::from_mut(self).cast(), limit, ptr::null_mut(), 0, 0) })
    }
}

impl Facets<'_> {
    /// Looks at the triangles of all leaves of their mesh's tree, as [`Walk::begin`] takes it, that the ray may meet before what
    /// it has met.
    #[inline(always)]
    pub fn follow(&mut self, nodes: &[u8], count: usize, ray: &Ray, _: &[u16; 128]) {
        if count == 0 || !are_nodes(nodes, count) {
            return;
        }
        // SAFETY: it is asked of a mesh alone.
        if self.depth() >= 0 && self.has_mesh() && unsafe { self.is_below_last() } {
            let mut place = MaybeUninit::<Walk>::uninit();
            let (nodes, last) = (nodes.as_ptr() as i32, (count as u32 - 1) << 16);
            // SAFETY: as in `leaves`; the facets are as `Facets::new` made them, or as their own look has left them.
            unsafe {
                step(
                    place.as_mut_ptr().cast(),
                    nodes,
                    ptr::from_mut(self).cast(),
                    last,
                    u32::from(ray.axis.min(2)),
                )
            };
        }
    }
}

/// Whether the ray meets child `$at` of the node in s0: if so, its bit in s1. Bytes from the node's first: of the child's planes
/// along the axis, low and high, and of those across.
///
/// Of the planes along the axis, in t0 and t1, the slope's sign says which is asked first.
#[rustfmt::skip]
macro_rules! child {
    ($at:literal, $bit:literal, $k:literal, $a:literal, $b:literal, $most1:literal, $least1:literal, $most2:literal, $least2:literal) => {
        concat!(
            "lbu t0, ", $k, "+", $at, "(s0); lbu t1, ", $k, "+4+", $at, "(s0);",
            "lbu a5, ", $a, "+4+", $at, "(s0); mul t2, s2, ", $least1, "; slli a5, a5, 13; sub a5, a5, t2; blt a5, a1, 3f;",
            "lbu a5, ", $a, "+", $at, "(s0); mul t2, s2, ", $most1, "; slli a5, a5, 13; sub a5, a5, t2; blt a1, a5, 3f;",
            "lbu a5, ", $b, "+4+", $at, "(s0); mul t2, s3, ", $least2, "; slli a5, a5, 13; sub a5, a5, t2; blt a5, a2, 3f;",
            "lbu a5, ", $b, "+", $at, "(s0); mul t2, s3, ", $most2, "; slli a5, a5, 13; sub a5, a5, t2; blt a2, a5, 3f;",
            "blt t1, a3, 3f; blt a4, t0, 3f;",
            "addi s1, s1, ", $bit, "; 3:",
        )
    };
}

/// From label `$node` on: what waits, or the node in t3, for one dominant axis and signs of slopes. Several children in s1 are
/// put in their places with t3 all ones; by where the ray enters, at the label that ends in 1, or 2 for a ray down the axis.
///
/// Then s0 is the node, t4 its origin along the axis, ra its exponent, a1 and a2 are the bounds across.
#[rustfmt::skip]
macro_rules! node {
    (
        $node:literal, $axis:literal, $k:literal, $a:literal, $b:literal,
        $most1:literal, $least1:literal, $most2:literal, $least2:literal,
        $aside1:literal, $aside2:literal, $up1:literal, $up2:literal, $down1:literal, $down2:literal
    ) => {
        concat!(
            "3: addi t0, t3, 1; bnez t0, 22f; j 25b;",
            $node, ": bgeu t6, t3, 21f;",
            "22: lw t3, 0(s6); addi s6, s6, -4; bltu t6, t3, 3b;",
            "21: slli t3, t3, 16;",
            "4: bltu s11, t3, 22b;",
            "microlux_walk_", $axis, $node, "_node:",
            "mulhu s0, t3, t5; add s0, s0, s10;",
            "lhu t4, 28+", $k, "/4(s0); lhu a5, 28+", $a, "/4(s0); lbu ra, 34(s0);",
            "mul a1, s2, t4; slli a5, a5, 13; sub a1, a1, s4; sub a1, a1, a5; lhu a5, 28+", $b, "/4(s0); sra a1, a1, ra;",
            "mul a2, s3, t4; slli a5, a5, 13; sub a2, a2, s5; sub a2, a2, a5; sra a2, a2, ra;",
            "sub a3, a6, t4; sub a4, a7, t4; sra a3, a3, ra; sra a4, a4, ra; li s1, 0;",
            child!("0", "1", $k, $a, $b, $most1, $least1, $most2, $least2),
            child!("1", "2", $k, $a, $b, $most1, $least1, $most2, $least2),
            child!("2", "4", $k, $a, $b, $most1, $least1, $most2, $least2),
            child!("3", "8", $k, $a, $b, $most1, $least1, $most2, $least2),
            "beqz s1, 22b; addi t0, s1, -1; and t0, t0, s1; bnez t0, 5f;",
            // Straight on to a single one.
            "srli t0, s1, 1; srli t1, s1, 3; sub t0, t0, t1; add t2, t0, s0; lb t0, 24(t2); lhu t3, 36(s0); bgez t0, 6f;",
            "andi t0, t0, 3; add t3, t3, t0; slli t3, t3, 16; j 4b;",
            "6: li t3, -1; j 39f;",
            "5: lw t0, {several}(a0); li t3, -1; jr t0;",
            // Of three planes the last that the ray comes to: on its way up, the low one along the axis.
            $node, "1: lw t2, {plane}(a0); li t0, 1; sub t4, t4, t2; sll t0, t0, ra; sub t4, t4, t0; lw a3, {beyond2}(a0); lhu a4, 36(s0);",
            each!("bnez s1, 7f; bgeu t6, t3, 21b; j 22b; 7: j 40f;", entry, $k, $a, $up1, $b, $up2, $aside1, $aside2, "1", "bge", "add t1, t1, t4"),
            $node, "2: lw t2, {plane}(a0); li t0, 3; sub t4, t2, t4; sll t0, t0, ra; sub t4, t4, t0; lw a3, {beyond2}(a0); lhu a4, 36(s0);",
            each!("bnez s1, 7f; bgeu t6, t3, 21b; j 22b; 7: j 40f;", entry, concat!($k, "+4"), $a, $down1, $b, $down2, $aside1, $aside2, "-3", "ble", "sub t1, t4, t1"),
        )
    };
}

#[rustfmt::skip]
macro_rules! nodes {
    ($first:literal, $second:literal, $third:literal, $fourth:literal, $axis:literal, $k:literal, $a:literal, $b:literal) => {
        concat!(
            node!($first, $axis, $k, $a, $b, "t1", "t0", "t1", "t0", "t2, a1", "t2, a2", "0", "0", "4", "4"),
            node!($second, $axis, $k, $a, $b, "t1", "t0", "t0", "t1", "t2, a1", "a2, t2", "0", "4", "4", "0"),
            node!($third, $axis, $k, $a, $b, "t0", "t1", "t1", "t0", "a1, t2", "t2, a2", "4", "0", "0", "4"),
            node!($fourth, $axis, $k, $a, $b, "t0", "t1", "t0", "t1", "a1, t2", "a2, t2", "4", "4", "0", "0"),
        )
    };
}

/// What tells where the ray comes to an axis' planes: of its slope in `$slope`, into `$at` of a0; the two stay, too.
#[rustfmt::skip]
macro_rules! across {
    ($slope:literal, $at:literal, $beyond:literal, $recip:literal) => {
        concat!(
            "srai t0, ", $slope, ", 31; xor t1, ", $slope, ", t0; sub t1, t1, t0;",
            "srli ", $beyond, ", t1, 8; beqz ", $beyond, ", 4f; slli ", $beyond, ", t1, 8; li t0, 8;",
            // Up to bit 15.
            "srli t3, t1, 12; bnez t3, 3f; slli t1, t1, 4; addi t0, t0, -4; 3:",
            "srli t3, t1, 14; bnez t3, 3f; slli t1, t1, 2; addi t0, t0, -2; 3:",
            "srli t3, t1, 15; bnez t3, 3f; slli t1, t1, 1; addi t0, t0, -1; 3:",
            // A guess and a Newton step.
            "srli t3, t1, 7; andi t3, t3, 0xfe; add t3, t3, a3; lhu t3, 0(t3); lui t2, 0x80000;",
            "mul t1, t1, t3; sub t1, t2, t1; srai t1, t1, 9; mul t1, t1, t3; srai t1, t1, 22;",
            "add t1, t1, t3; srl ", $recip, ", t1, t0; sw ", $recip, ", ", $at, "+4(a0);",
            "4: sw ", $beyond, ", ", $at, "(a0);",
        )
    };
}

/// Where nodes are looked at, into `$node`, and in t0 where several of their children are, by where the ray enters. a0: walk.
/// a1: axis. a6: flip, of which four bytes stay in t1. t4: the table.
#[rustfmt::skip]
macro_rules! places {
    ($slope1:literal, $slope2:literal, $node:literal) => {
        concat!(
            "srli t0, ", $slope1, ", 31; srli t1, ", $slope2, ", 31; slli t0, t0, 3; slli t1, t1, 2; slli t2, a1, 4;",
            "add t0, t0, t1; add t0, t0, t2; lla t4, microlux_walk_places; add t2, t4, t0; slli t0, t0, 1;",
            "lw ", $node, ", 0(t2); andi t1, a6, 4; add t0, t0, t4; add t0, t0, t1; lw t0, {entry}(t0); sw ", $node, ", {node}(a0);",
        )
    };
}

/// a0: walk. a1: axis. a2: order. a3: first guesses of reciprocals. What the walk has of these and of its ray.
///
/// # Safety
///
/// The axis is 0 to 2; of the walk there are slopes and flip.
#[unsafe(naked)]
unsafe extern "C" fn begin(walk: *mut Walk<'static>, axis: u32, order: u32, recips: &[u16; 128]) {
    naked_asm!(
        extensions!(),
        "lw a4, {slopes}(a0)",
        "lw a5, {slopes} + 4(a0)",
        "lw a6, {flip}(a0)",
        places!("a4", "a5", "a7"),
        "li t2, {entry}",
        "beq a2, t2, 8f",
        // Another order, which wants nothing of the slopes.
        "slli t2, a1, 3",
        "add t2, t2, t1",
        "sw t2, {face}(a0)",
        "li t2, {any}",
        "beq a2, t2, 1f",
        "add a2, a2, t1",
        "1:",
        "add t4, t4, a2",
        "lw t4, 0(t4)",
        "sw t4, {several}(a0)",
        "ret",
        "8:",
        "sw t0, {several}(a0)",
        across!("a4", "{across}", "a1", "a7"),
        across!("a5", "{across}+8", "a1", "a7"),
        "ret",
        ".option pop",
        slopes = const offset_of!(Walk, slopes),
        flip = const offset_of!(Walk, flip),
        node = const offset_of!(Walk, node),
        several = const offset_of!(Walk, several),
        across = const offset_of!(Walk, across),
        face = const offset_of!(Walk, face),
        any = const test_of(Order::Any),
        entry = const test_of(Order::Entry),
    )
}

/// If child `$at`, which is at hand, is a node, its place among those of several, by where the ray enters: of faces along the axis
/// and across, bytes from the node's first.
#[rustfmt::skip]
macro_rules! entry {
    (
        $at:literal, $bit:literal, $labels:literal, $face:expr, $a:literal, $face1:literal, $b:literal, $face2:literal,
        $aside1:literal, $aside2:literal, $before:literal, $min:literal, $along:literal
    ) => {
        concat!(
            "lb t0, 24+", $at, "(s0); andi t1, s1, ", $bit, "; beqz t1, 1", $labels, "f; bgez t0, 1", $labels, "f; addi s1, s1, -", $bit, ";",
            "lbu t2, ", $a, "+", $face1, "+", $at, "(s0); lbu t1, ", $face, "+", $at, "(s0);",
            "slli t2, t2, 13; sub t2, ", $aside1, "; addi t1, t1, ", $before, "; bgeu t2, s8, 1f;",
            "srli t2, t2, 5; mul t2, t2, s7; srli t2, t2, 18; ", $min, " t1, t2, 1f; mv t1, t2; 1:",
            "lbu t2, ", $b, "+", $face2, "+", $at, "(s0); andi t0, t0, 3; slli t2, t2, 13; sub t2, ", $aside2, "; bgeu t2, a3, 1f;",
            "srli t2, t2, 5; mul t2, t2, s9; srli t2, t2, 18; ", $min, " t1, t2, 1f; mv t1, t2; 1:",
            "sll t1, t1, ra; ", $along, "; add t0, t0, a4;",
            place!($labels),
        )
    };
}

/// By where its box begins.
#[rustfmt::skip]
macro_rules! face {
    ($at:literal, $bit:literal, $labels:literal, $along:literal) => {
        concat!(
            "lb t0, 24+", $at, "(s0); andi t1, s1, ", $bit, "; beqz t1, 1", $labels, "f; bgez t0, 1", $labels, "f; addi s1, s1, -", $bit, ";",
            "lbu t1, ", $at, "(a3); lhu a5, 36(s0); andi t0, t0, 3; sll t1, t1, ra; ", $along, "; add t0, t0, a5;",
            place!($labels),
        )
    };
}

/// Any first.
#[rustfmt::skip]
macro_rules! any {
    ($at:literal, $bit:literal, $labels:literal) => {
        concat!(
            "lb t0, 24+", $at, "(s0); andi t1, s1, ", $bit, "; beqz t1, 1", $labels, "f; bgez t0, 1", $labels, "f; addi s1, s1, -", $bit, ";",
            "lhu a5, 36(s0); andi t0, t0, 3; li t1, 0; add t0, t0, a5;",
            place!($labels),
        )
    };
}

/// The node t0, at depth t1, or at 0 if that is negative: the nearer of it and t3 into t3, the farther to those that wait, if there are two.
///
/// What is not usual stands in [`aside`].
#[rustfmt::skip]
macro_rules! place {
    ($labels:literal) => {
        concat!(
            "bltz t1, 2", $labels, "f; 3", $labels, ": slli t1, t1, 16; add t1, t1, t0; bgeu t1, t3, 4", $labels, "f;",
            "addi t2, t3, 1; beqz t2, 1f; addi t2, a0, {stack}+4*{most}; bgeu s6, t2, 1f; addi s6, s6, 4; sw t3, 0(s6); 1: mv t3, t1;",
            "1", $labels, ":",
        )
    };
}

/// A depth below 0; what is not the nearest.
#[rustfmt::skip]
macro_rules! aside {
    ($at:literal, $bit:literal, $labels:literal) => {
        concat!(
            "2", $labels, ": li t1, 0; j 3", $labels, "b;",
            "4", $labels, ": addi t2, a0, {stack}+4*{most}; bgeu s6, t2, 1", $labels, "b; addi s6, s6, 4; sw t1, 0(s6); j 1", $labels, "b;",
        )
    };
}

#[rustfmt::skip]
macro_rules! each {
    ($end:literal, $what:ident $(, $argument:expr)*) => {
        concat!(
            $what!("0", "1", "00" $(, $argument)*), $what!("1", "2", "01" $(, $argument)*),
            $what!("2", "4", "02" $(, $argument)*), $what!("3", "8", "03" $(, $argument)*),
            $end,
            aside!("0", "1", "00"), aside!("1", "2", "01"), aside!("2", "4", "02"), aside!("3", "8", "03"),
        )
    };
}

/// Before what is in a1, a leaf at `$at` of the node in s0, if s1 says so.
#[rustfmt::skip]
macro_rules! meta {
    ($at:literal, $bit:literal) => {
        concat!("lbu t0, 24+", $at, "(s0); andi t1, s1, ", $bit, "; beqz t1, 3f; slli a1, a1, 8; or a1, a1, t0; 3:")
    };
}

/// The limit t0, along the axis, from t1 on, down it if t2 is all ones: range in a6, a7; in t6 the largest that may come next.
#[rustfmt::skip]
macro_rules! limits {
    () => {
        concat!(
            "lui t3, 16; addi t3, t3, -1;",
            "neg a6, t0; and a6, a6, t2; add a6, a6, t1; add a7, a6, t0; ",
            // What is beyond every limit is beyond this one, too.
            "sltu t1, t0, t3; slli t6, t0, 16; addi t3, t3, -1; add t6, t6, t3; add t6, t6, t1;",
        )
    };
}

/// What of the walk leaves take for themselves.
#[rustfmt::skip]
macro_rules! registers {
    () => {
        concat!(
            "lw s10, {nodes}(a0); lw s11, {last}(a0); lw t0, {node}(a0); lui t5, {stride};",
            "lw s7, {recip1}(a0); lw s8, {beyond1}(a0); lw s9, {recip2}(a0);",
        )
    };
}

/// a0: walk. a1: limit. a2: null. A node's first primitive, and then its leaves; all ones for none. Or, from the root on to the
/// nearest hit: a0: room for a walk. a1: nodes. a2: what looks at leaves. a3: the last node's index · 2^16. a4: axis.
///
/// a0: walk. s2 to s5: slopes, offsets. s6: the last that waits. s10, s11: nodes, and the last one's index · 2^16. a6, a7:
/// range along the axis. t6: the largest that may come next. t5: bytes of a node · 2^16. s7, s8, s9: reciprocal and bound of
/// the first axis across, reciprocal of the second. Looking at triangles takes all from s6 on.
///
/// Cycles: 65 a call, or 160 a ray to its nearest hit; 25 a node; 26 a child that is met, 8 to 25 one that is not; where several
/// are met, 30 and 32 for each that is a node; 40 a node with leaves and 16 a leaf.
///
/// # Safety
///
/// The walk is as [`Walk::begin`] made it, or as this has left it.
#[unsafe(naked)]
unsafe extern "C" fn step(
    walk: *mut Walk<'static>,
    limit: i32,
    facets: *mut Facets<'static>,
    last: u32,
    axis: u32,
) -> u64 {
    naked_asm!(
        extensions!(),
        "addi sp, sp, -64",
        "sw ra, 0(sp); sw s0, 4(sp); sw s1, 8(sp); sw s2, 12(sp); sw s3, 16(sp); sw s4, 20(sp); sw s5, 24(sp)",
        "sw s6, 28(sp); sw s7, 32(sp); sw s8, 36(sp); sw s9, 40(sp); sw s10, 44(sp); sw s11, 48(sp)",
        "sw a2, {facets}(a0)",
        "beqz a2, 20f",
        "mv s10, a1",
        "mv s11, a3",
        "mv a7, a2",
        "sw a1, {nodes}(a0)",
        "sw a3, {last}(a0)",
        "lw s2, {facets_slopes}(a2)",
        "lw s3, {facets_slopes} + 4(a2)",
        "lw a6, {facets_flip}(a2)",
        "lw a3, {facets_recips}(a2)",
        "mv a1, a4",
        places!("s2", "s3", "a5"),
        "lui t5, {stride}",
        "sw t0, {several}(a0)",
        across!("s2", "{across}", "s8", "s7"),
        across!("s3", "{across}+8", "t4", "s9"),
        "mv t2, a6",
        "lw t1, {facets_plane}(a7)",
        "lw t0, {depth}(a7)",
        "lw s4, {facets_offsets}(a7)",
        "lw s5, {facets_offsets} + 4(a7)",
        "sw t1, {plane}(a0)",
        "mv t4, a7",
        "srai t0, t0, {bits}",
        limits!(),
        "sw a6, {range}(t4)",
        "sw a7, {range} + 4(t4)",
        "sw t6, {limit}(t4)",
        "addi s6, a0, {stack}",
        "li t1, -1",
        "sw t1, {stack}(a0)",
        "li t3, 0",
        "jr a5",
        "20:",
        "lw t1, {plane}(a0)",
        "lw t2, {flip}(a0)",
        "mv t0, a1",
        limits!(),
        "lw s2, {slopes}(a0)",
        "lw s3, {slopes} + 4(a0)",
        "lw s4, {offsets}(a0)",
        "lw s5, {offsets} + 4(a0)",
        "lw s6, {waiting}(a0)",
        "addi t0, a0, {stack}",
        "lw t3, {next}(a0)",
        "add s6, s6, t0",
        registers!(),
        "li t1, -1",
        "sw t1, {stack}(a0)",
        "jr t0",
        ".pushsection .rodata.microlux_walk_places, \"a\"",
        ".balign 4",
        ".globl microlux_walk_places",
        "microlux_walk_places:",
        ".word 60f, 61f, 62f, 63f, 64f, 65f, 66f, 67f, 68f, 69f, 70f, 71f",
        ".word 80f, 81f, 82f",
        ".word 601f, 602f, 611f, 612f, 621f, 622f, 631f, 632f, 641f, 642f, 651f, 652f",
        ".word 661f, 662f, 671f, 672f, 681f, 682f, 691f, 692f, 701f, 702f, 711f, 712f",
        // Here for its loops alone, which facets know.
        ".word {code}",
        ".popsection",
        // Nothing waits.
        "25:",
        "li a1, -1",
        "sw zero, {waiting}(a0)",
        "sw a1, {next}(a0)",
        "mv a0, a1",
        "26:",
        "lw ra, 0(sp); lw s0, 4(sp); lw s1, 8(sp); lw s2, 12(sp); lw s3, 16(sp); lw s4, 20(sp); lw s5, 24(sp)",
        "lw s6, 28(sp); lw s7, 32(sp); lw s8, 36(sp); lw s9, 40(sp); lw s10, 44(sp); lw s11, 48(sp)",
        "addi sp, sp, 64",
        "ret",
        nodes!("60", "61", "62", "63", "x", "0", "8", "16"),
        nodes!("64", "65", "66", "67", "y", "8", "16", "0"),
        nodes!("68", "69", "70", "71", "z", "16", "0", "8"),
        // Several children in s1.
        "80:",
        each!("j 32f;", any),
        "81:",
        "lw a3, {face}(a0)",
        "lw t2, {plane}(a0)",
        "add a3, a3, s0",
        "sub t4, t4, t2",
        each!("j 32f;", face, "add t1, t1, t4"),
        "82:",
        "lw a3, {face}(a0)",
        "lw t2, {plane}(a0)",
        "add a3, a3, s0",
        "sub t4, t2, t4",
        each!("j 32f;", face, "sub t1, t4, t1"),
        "32:",
        "bnez s1, 40f",
        "lw t0, {node}(a0)",
        "jr t0",
        // Leaves in s1, the node that comes next in t3; the first primitive to t4.
        "40:",
        "lw a7, {facets}(a0)",
        "mv t2, s0",
        "bnez a7, 43f",
        "41:",
        "lhu t4, 38(s0)",
        "lbu t1, 35(s0)",
        "sw t3, {next}(a0)",
        "slli t1, t1, 16",
        "or t4, t4, t1",
        "addi t1, a0, {stack}",
        "sub t1, s6, t1",
        "sw t1, {waiting}(a0)",
        "addi t3, t3, 1",
        "or t3, t3, t1",
        "li a1, 0",
        "mv a0, t4",
        "bnez t3, 42f",
        "lui t0, 0x80000",
        "or a0, a0, t0",
        "42:",
        meta!("3", "8"),
        meta!("2", "4"),
        meta!("1", "2"),
        meta!("0", "1"),
        "j 26b",
        // A leaf alone, at t2.
        "39:",
        "lw a7, {facets}(a0)",
        "beqz a7, 41b",
        "li s1, 1",
        // Each leaf's triangles, from the one at t2.
        "43:",
        "lhu t4, 38(s0)",
        "lbu t1, 35(s0)",
        "lw t0, {triangle_count}(a7)",
        "sw t3, {next}(a0)",
        "slli t1, t1, 16",
        "or t4, t4, t1",
        "lw t3, {triangles}(a7)",
        "sw a0, 52(sp)",
        "bgeu t4, t0, 48f",
        "li t1, 6",
        "mul t4, t4, t1",
        "sw s6, 56(sp)",
        "mv s0, t2",
        "add t4, t4, t3",
        "lw s6, {vertex_count}(a7)",
        "lw a0, {vertices}(a7)",
        "sw t4, 60(sp)",
        "lla ra, 46f",
        "44:",
        "andi t0, s1, 1",
        "srli s1, s1, 1",
        "beqz t0, 46f",
        "lbu t1, 24(s0)",
        "lw t3, {end}(a7)",
        "li t2, 6",
        "andi t0, t1, 15",
        "srli t1, t1, 4",
        "mul t0, t0, t2",
        "mul t1, t1, t2",
        "lw t6, {front}(a7)",
        "add s10, t4, t0",
        "add s11, s10, t1",
        "bltu t3, s11, 47f",
        "bgeu s10, s11, 46f",
        "jr t6",
        "46:",
        "lw t4, 60(sp)",
        "addi s0, s0, 1",
        "bnez s1, 44b",
        "lw a0, 52(sp)",
        "lw s6, 56(sp)",
        // What has been met is the limit.
        "48:",
        "lw a6, {range}(a7)",
        "lw t6, {limit}(a7)",
        "lw a7, {range} + 4(a7)",
        "lw t3, {next}(a0)",
        registers!(),
        "jr t0",
        "47:",
        "mv s11, t3",
        "bgeu s10, s11, 46b",
        "jr t6",
        ".option pop",
        code = sym facets::front,
        depth = const Facets::DEPTH,
        bits = const DEPTH_BITS,
        facets_slopes = const Facets::SLOPES,
        facets_offsets = const Facets::OFFSETS,
        facets_plane = const Facets::PLANE,
        facets_flip = const Facets::FLIP,
        facets_recips = const Facets::RECIPS,
        entry = const test_of(Order::Entry),
        across = const offset_of!(Walk, across),
        range = const Facets::RANGE,
        limit = const Facets::LIMIT,
        end = const Facets::END,
        front = const Facets::FRONT,
        vertices = const Facets::VERTICES,
        vertex_count = const Facets::VERTEX_COUNT,
        triangles = const Facets::TRIANGLES,
        triangle_count = const Facets::TRIANGLE_COUNT,
        nodes = const offset_of!(Walk, nodes),
        last = const offset_of!(Walk, last),
        node = const offset_of!(Walk, node),
        several = const offset_of!(Walk, several),
        slopes = const offset_of!(Walk, slopes),
        offsets = const offset_of!(Walk, offsets),
        plane = const offset_of!(Walk, plane),
        flip = const offset_of!(Walk, flip),
        next = const offset_of!(Walk, next),
        facets = const offset_of!(Walk, facets),
        face = const offset_of!(Walk, face),
        beyond1 = const offset_of!(Walk, across) + offset_of!(Across, beyond),
        recip1 = const offset_of!(Walk, across) + offset_of!(Across, recip),
        beyond2 = const offset_of!(Walk, across) + size_of::<Across>() + offset_of!(Across, beyond),
        recip2 = const offset_of!(Walk, across) + size_of::<Across>() + offset_of!(Across, recip),
        waiting = const offset_of!(Walk, waiting),
        stack = const offset_of!(Walk, stack),
        stride = const NODE << 4,
        most = const STACK,
    )
}
