use core::arch::naked_asm;
use core::marker::PhantomData;
use core::mem::{MaybeUninit, offset_of};
use core::ptr;

use super::facets;
use crate::facets::Facets;
use crate::ray::{DEPTH_BITS, LAST_BIT, Leaves, NODE, Order, Ray, STACK, are_nodes};

/// Where a ray is in a tree, in the order in which [`step`] reads it.
#[repr(C)]
pub struct Walk<'a> {
    nodes: *const u8,
    count: u32,
    /// Of the origin along the dominant axis and the two across, bytes from a node's first.
    origins: [u32; 3],
    offsets: [i32; 2],
    /// Where the ray may be met, along the axis; from the limit.
    range: MaybeUninit<[i32; 2]>,
    /// Of the planes along the two axes across and the dominant one, bytes from a node's first.
    planes: [u32; 3],
    slopes: [i32; 2],
    /// All ones for a ray that goes down the axis.
    flip: i32,
    /// Bytes into the table of [`step`].
    tests: u32,
    depths: u32,
    /// The node that comes next, if it is not beyond the limit: depth and index, as those that wait.
    next: u32,
    /// What looks at leaves, if not the caller.
    facets: *mut Facets<'static>,
    depth: Depth,
    waiting: Waiting,
    tree: PhantomData<&'a [u8]>,
}

/// What tells where a ray enters a child.
#[repr(C)]
struct Depth {
    face: u32,
    across: MaybeUninit<[Across; 2]>,
    plane: i32,
}

/// Of an axis across.
#[repr(C)]
struct Across {
    /// Of the planes that the ray comes to first, bytes from a node's first.
    face: u32,
    /// All ones where the slope falls.
    fall: i32,
    /// The slope's size · 2^8: as far aside or farther is no way within a node. 0 of slopes under 1/32.
    beyond: u32,
    /// 2^23 over the slope's size.
    recip: u32,
}

#[repr(C)]
struct Waiting {
    bytes: u32,
    stack: MaybeUninit<[u32; STACK]>,
}

/// A place in the table of [`step`].
const fn test_of(order: Order) -> u32 {
    match order {
        Order::Any => 16,
        Order::Face => 20,
        Order::Entry => 28,
    }
}

const _: () = assert!(offset_of!(Walk, waiting) == offset_of!(Walk, depth) + size_of::<Depth>());

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
        if !are_nodes(nodes, count) {
            return None;
        }
        let walk = place.as_mut_ptr();
        // SAFETY: what is not written here, `begin` writes, or may stay as it is.
        unsafe {
            (*walk).nodes = nodes.as_ptr();
            (*walk).count = count as u32;
            (*walk).offsets = ray.offsets;
            (*walk).slopes = ray.slopes;
            (*walk).flip = -i32::from(ray.negative);
            (*walk).next = 0;
            (*walk).facets = ptr::null_mut();
            (*walk).depth.plane = ray.plane;
            (*walk).waiting.bytes = 0;
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
        // SAFETY: `nodes` points to `count` nodes that outlive the walk, offsets are those of a node's parts, and the stack
        // is as full as `waiting` says.
        Leaves::found(unsafe { step(self, limit, ptr::null_mut()) })
    }
}

/// [`Facets::follow`].
#[inline(always)]
pub(crate) fn follow(facets: &mut Facets, nodes: &[u8], count: usize, ray: &Ray, recips: &[u16; 128]) {
    let place = &mut MaybeUninit::uninit();
    let Some(walk) = Walk::begin(place, nodes, count, ray, Order::Entry, recips) else {
        return;
    };
    let limit = facets.depth() >> DEPTH_BITS;
    if limit >= 0 && facets.has_mesh() {
        // SAFETY: as in `leaves`; the facets are as `Facets::new` made them, or as their own look has left them.
        unsafe { step(walk, limit, ptr::from_mut(facets).cast()) };
    }
}

/// Whether the ray meets child `$at` of the planes at r1 and r2 (across) and r0 (along): if so, its bit in r7.
///
/// `$fall` are the axes along which the slope falls: of the child's two planes along the dominant axis, r3 and r4, that
/// changes which is the first to be asked.
#[rustfmt::skip]
macro_rules! child {
    ($at:literal, $high:literal, $bit:literal, $most1:literal, $least1:literal, $most2:literal, $least2:literal) => {
        concat!(
            "ldrb r3, [r0, #", $at, "]; ldrb r4, [r0, #", $high, "];",
            "ldrb r5, [r1, #", $at, "]; lsls r5, r5, #13; mov r6, r8; muls r6, ", $most1, ", r6; subs r5, r5, r6; cmp r5, r10; bgt 3f;",
            "ldrb r5, [r1, #", $high, "]; lsls r5, r5, #13; mov r6, r8; muls r6, ", $least1, ", r6; subs r5, r5, r6; cmp r5, r10; blt 3f;",
            "ldrb r5, [r2, #", $at, "]; lsls r5, r5, #13; mov r6, r9; muls r6, ", $most2, ", r6; subs r5, r5, r6; cmp r5, r11; bgt 3f;",
            "ldrb r5, [r2, #", $high, "]; lsls r5, r5, #13; mov r6, r9; muls r6, ", $least2, ", r6; subs r5, r5, r6; cmp r5, r11; blt 3f;",
            "cmp r4, r12; blt 3f; cmp r3, lr; bgt 3f;",
            "adds r7, #", $bit, "; 3:",
        )
    };
}

#[rustfmt::skip]
macro_rules! children {
    ($most1:literal, $least1:literal, $most2:literal, $least2:literal) => {
        concat!(
            child!("0", "4", "1", $most1, $least1, $most2, $least2),
            child!("1", "5", "2", $most1, $least1, $most2, $least2),
            child!("2", "6", "4", $most1, $least1, $most2, $least2),
            child!("3", "7", "8", $most1, $least1, $most2, $least2),
        )
    };
}

/// The way aside to the first face across, in r4, as planes along the axis, where it is any: else on to label 4. The
/// bound is in `$bound`.
#[rustfmt::skip]
macro_rules! steps {
    ($bound:literal) => {
        concat!(
            "ldrb r4, [r0, r5]; lsls r4, r4, #13; mov r5, ", $bound, "; subs r4, r4, r5; eors r4, r6; subs r4, r4, r6;",
            "ldmia r1!, {{r5, r6}}; cmp r4, r5; bhs 4f;",
            "lsrs r4, r4, #5; muls r4, r6, r4; lsrs r4, r4, #18;",
        )
    };
}

/// What tells where the ray comes to an axis' planes: at r0, which moves on; its slope is `$slope` bytes from r1.
#[rustfmt::skip]
macro_rules! across {
    ($slope:literal) => {
        concat!(
            "ldr r5, [r1, #", $slope, "]; asrs r7, r5, #31; eors r5, r7; subs r5, r5, r7;",
            "movs r6, r7; eors r6, r4; lsrs r6, r6, #31; lsls r6, r6, #2; ldr r2, [r0]; adds r6, r6, r2;",
            "stmia r0!, {{r6, r7}}; movs r6, #0; cmp r5, #255; bls 4f;",
            "lsls r6, r5, #8; str r6, [r0]; movs r2, #8;",
            // Up to bit 15.
            "lsrs r6, r5, #12; bne 3f; lsls r5, r5, #4; subs r2, #4; 3:",
            "lsrs r6, r5, #14; bne 3f; lsls r5, r5, #2; subs r2, #2; 3:",
            "lsrs r6, r5, #15; bne 3f; lsls r5, r5, #1; subs r2, #1; 3:",
            // A guess and a Newton step.
            "lsls r6, r5, #17; lsrs r6, r6, #25; lsls r6, r6, #1; ldrh r6, [r3, r6];",
            "muls r5, r6, r5; movs r7, #1; lsls r7, r7, #31; subs r7, r7, r5; asrs r7, r7, #9; muls r7, r6, r7; asrs r7, r7, #22;",
            "adds r6, r6, r7; lsrs r6, r2; str r6, [r0, #4]; b 5f;",
            "4: str r6, [r0]; str r6, [r0, #4]; 5: adds r0, #8;",
        )
    };
}

/// r0: walk. r1: axis. r2: order. r3: first guesses of reciprocals. What the walk has of these and of its ray.
///
/// Cycles: 64, and 45 for each axis where order is by where the ray enters.
///
/// # Safety
///
/// The axis is 0 to 2; of the walk there are slopes and flip.
#[unsafe(naked)]
unsafe extern "C" fn begin(walk: *mut Walk<'static>, axis: u32, order: u32, recips: &[u16; 128]) {
    naked_asm!(
        "push {{r4, r5, r6, r7, lr}}",
        "movs r4, #24",
        "muls r1, r4, r1",
        "adr r4, 20f",
        "adds r4, r4, r1",
        "ldmia r4!, {{r5, r6, r7}}",
        "movs r1, r0",
        "adds r1, #{origins}",
        "stmia r1!, {{r5, r6, r7}}",
        "ldmia r4!, {{r5, r6, r7}}",
        "adds r1, #{planes} - {origins} - 12",
        "stmia r1!, {{r5, r6, r7}}",
        // From here on r1 is at the slopes, r4 all ones for a ray that goes down the axis.
        "str r5, [r0, #{across}]",
        "str r6, [r0, #{across} + 16]",
        "ldr r4, [r1, #8]",
        "lsrs r5, r4, #31",
        "lsls r5, r5, #2",
        "adds r7, r7, r5",
        "str r7, [r0, #{depth}]",
        "ldr r6, [r1]",
        "ldr r7, [r1, #4]",
        "lsrs r6, r6, #31",
        "lsls r6, r6, #1",
        "lsrs r7, r7, #31",
        "orrs r6, r7",
        "lsls r6, r6, #2",
        "str r6, [r1, #12]",
        "cmp r2, #{any}",
        "beq 21f",
        "adds r2, r2, r5",
        "21:",
        "str r2, [r1, #16]",
        "cmp r2, #{entry}",
        "blo 22f",
        "adds r0, #{across}",
        across!("0"),
        across!("4"),
        "22:",
        "pop {{r4, r5, r6, r7, pc}}",
        ".balign 4",
        "20:",
        ".word 28, 30, 32, 8, 16, 0",
        ".word 30, 32, 28, 16, 0, 8",
        ".word 32, 28, 30, 0, 8, 16",
        origins = const offset_of!(Walk, origins),
        planes = const offset_of!(Walk, planes),
        across = const offset_of!(Walk, depth.across),
        depth = const offset_of!(Walk, depth),
        any = const test_of(Order::Any),
        entry = const test_of(Order::Entry),
    )
}

/// Before what is in r1, a leaf at `$at` of the node in r5, if the top bit of r7 says so; which is shifted out.
#[rustfmt::skip]
macro_rules! meta {
    ($at:literal) => {
        concat!("lsls r7, r7, #1; bcc 3f; ldrb r2, [r5, #", $at, "]; lsls r1, r1, #8; orrs r1, r2; 3:")
    };
}

/// r0: walk. r1: limit. r2: null, or what looks at leaves. A node's first primitive, and
/// then its leaves; all ones for none.
///
/// Of the stack: the walk, the limit, the node's place, its origin along the axis; where the tests and the depths begin. High registers: slopes, bounds of the two axes across, range along the axis; the last two are free where
/// children are sorted.
///
/// Cycles: 86 a call; 64 a node; 41 a child that is met, 13 to 36 one that is not; where several are met, 12 and 85 for each
/// that is a node.
///
/// # Safety
///
/// The walk is as [`Walk::begin`] made it, or as this has left it.
#[unsafe(naked)]
unsafe extern "C" fn step(walk: &mut Walk, limit: i32, facets: *mut Facets<'static>) -> u64 {
    naked_asm!(
        "push {{r4, r5, r6, r7, lr}}",
        save_upper!(),
        "str r2, [r0, #{facets}]",
        "movs r2, r0",
        "adds r2, #{slopes}",
        "ldmia r2!, {{r3, r4, r5, r6, r7}}",
        "mov r8, r3",
        "mov r9, r4",
        // Backwards from −limit to 0 along the axis, else from 0 to the limit.
        "rsbs r3, r1, #0",
        "ands r5, r3",
        "ldr r3, [r0, #{plane}]",
        "adds r3, r3, r5",
        "str r3, [r0, #{range}]",
        "adds r3, r3, r1",
        "str r3, [r0, #{range} + 4]",
        "adr r3, 20f",
        "ldr r6, [r3, r6]",
        "ldr r7, [r3, r7]",
        "ldr r4, [r2]",
        "push {{r0, r1, r2, r3, r6, r7}}",
        "b 30f",
        ".balign 4",
        "20:",
        ".word 60f - 39f - 4, 61f - 39f - 4, 62f - 39f - 4, 63f - 39f - 4",
        ".word 70f - 47f - 4, 71f - 47f - 4, 72f - 47f - 4, 73f - 47f - 4, 74f - 47f - 4",
        // Nothing waits.
        "25:",
        "ldr r0, [sp]",
        "movs r4, #0",
        "mvns r4, r4",
        "str r4, [r0, #{next}]",
        "movs r0, r4",
        "26:",
        "add sp, #24",
        restore_upper!(),
        "pop {{r4, r5, r6, r7, pc}}",
        // The node in r4, or the last that waits, unless it is beyond the limit.
        "30:",
        "adds r5, r4, #1",
        "beq 32f",
        "31:",
        "ldr r5, [sp, #4]",
        "lsrs r6, r4, #16",
        "cmp r6, r5",
        "ble 35f",
        "32:",
        "ldr r1, [sp]",
        "adds r1, #{depth}",
        "ldr r5, [r1, #{bytes}]",
        "subs r5, #4",
        "bmi 25b",
        "str r5, [r1, #{bytes}]",
        "adds r1, r1, r5",
        "ldr r4, [r1, #{stack}]",
        "b 31b",
        // Node r4. The name is for those who count visits.
        "microlux_walk_node:",
        "35:",
        "ldr r7, [sp]",
        "ldmia r7!, {{r0, r5}}",
        "uxth r4, r4",
        "cmp r4, r5",
        "bhs 32b",
        "movs r5, #{node}",
        "muls r4, r5, r4",
        "adds r0, r0, r4",
        "str r0, [sp, #8]",
        "ldmia r7!, {{r1, r2, r3}}",
        "ldrh r1, [r0, r1]",
        "ldrh r2, [r0, r2]",
        "ldrh r3, [r0, r3]",
        "ldrh r6, [r0, #34]",
        "str r1, [sp, #12]",
        // −across >> e of the origin, along both axes across.
        "mov r4, r8",
        "muls r4, r1, r4",
        "lsls r2, r2, #13",
        "subs r4, r4, r2",
        "ldmia r7!, {{r2, r5}}",
        "subs r4, r4, r2",
        "asrs r4, r6",
        "mov r10, r4",
        "mov r4, r9",
        "muls r4, r1, r4",
        "lsls r3, r3, #13",
        "subs r4, r4, r3",
        "subs r4, r4, r5",
        "asrs r4, r6",
        "mov r11, r4",
        "ldmia r7!, {{r2, r3}}",
        "subs r2, r2, r1",
        "asrs r2, r6",
        "mov r12, r2",
        "subs r3, r3, r1",
        "asrs r3, r6",
        "mov lr, r3",
        "ldmia r7!, {{r1, r2, r3}}",
        "adds r1, r1, r0",
        "adds r2, r2, r0",
        "adds r0, r0, r3",
        "movs r7, #0",
        "ldr r5, [sp, #16]",
        "39:",
        "add pc, r5",
        "60:",
        children!("r4", "r3", "r4", "r3"),
        "b 40f",
        "61:",
        children!("r4", "r3", "r3", "r4"),
        "b 40f",
        "62:",
        children!("r3", "r4", "r4", "r3"),
        "b 40f",
        "63:",
        children!("r3", "r4", "r3", "r4"),
        // Children in r7.
        "40:",
        "ldr r0, [sp, #8]",
        "subs r5, r7, #1",
        "bpl 41f",
        "b 32b",
        "41:",
        "tst r5, r7",
        "bne 45f",
        // Straight on to a single one.
        "lsrs r5, r7, #1",
        "lsrs r6, r7, #3",
        "subs r5, r5, r6",
        "adds r5, r5, r0",
        "ldrb r5, [r5, #24]",
        "lsrs r4, r5, #8",
        "bcc 42f",
        "ldrh r4, [r0, #36]",
        "movs r6, #3",
        "ands r5, r6",
        "adds r4, r4, r5",
        "b 35b",
        "42:",
        "movs r4, #0",
        "mvns r4, r4",
        // Leaves in r7, the node that comes next in r4; the first primitive to r6.
        "43:",
        "ldr r1, [sp]",
        "str r4, [r1, #{next}]",
        "ldr r5, [sp, #8]",
        "movs r6, #35",
        "ldrb r6, [r5, r6]",
        "lsls r6, r6, #16",
        "ldrh r0, [r5, #38]",
        "orrs r6, r0",
        "ldr r0, [r1, #{facets}]",
        "cmp r0, #0",
        "beq 44f",
        "b 81f",
        "44:",
        "adds r4, #1",
        "bne 3f",
        "ldr r0, [r1, #{depth} + {bytes}]",
        "cmp r0, #0",
        "bne 3f",
        "movs r0, #1",
        "lsls r0, r0, #{last}",
        "orrs r6, r0",
        "3:",
        "movs r0, r6",
        "movs r1, #0",
        "lsls r7, r7, #28",
        meta!("27"),
        meta!("26"),
        meta!("25"),
        meta!("24"),
        "b 26b",
        // Several: the nearest in r12, the bit at hand in r2; r7 keeps those of leaves.
        "45:",
        "ldr r1, [sp]",
        "adds r1, #{depth}",
        "movs r2, #0",
        "mvns r2, r2",
        "mov r12, r2",
        "movs r2, #1",
        "46:",
        "tst r7, r2",
        "beq 49f",
        "ldrb r4, [r0, #24]",
        "lsrs r4, r4, #8",
        "bcc 49f",
        "bics r7, r2",
        "ldr r4, [sp, #20]",
        "47:",
        "add pc, r4",
        "70:",
        "movs r3, #0",
        "b 48f",
        // The face along the axis.
        "71:",
        "ldr r4, [r1]",
        "ldrb r3, [r0, r4]",
        "ldr r4, [r1, #{plane} - {depth}]",
        "51:",
        "ldr r5, [sp, #8]",
        "ldrh r5, [r5, #34]",
        "lsls r3, r5",
        "ldr r5, [sp, #12]",
        "subs r5, r5, r4",
        "adds r3, r3, r5",
        "asrs r4, r3, #31",
        "bics r3, r4",
        "48:",
        "lsls r3, r3, #16",
        "ldrb r4, [r0, #24]",
        "movs r5, #3",
        "ands r4, r5",
        "ldr r5, [sp, #8]",
        "ldrh r5, [r5, #36]",
        "adds r4, r4, r5",
        "uxth r4, r4",
        "orrs r3, r4",
        // The farther of two waits, if there are two.
        "mov r4, r12",
        "cmp r3, r4",
        "bhs 3f",
        "mov r12, r3",
        "movs r3, r4",
        "3:",
        "adds r4, r3, #1",
        "beq 49f",
        "ldr r4, [r1, #{bytes}]",
        "cmp r4, #{most}",
        "bhs 49f",
        "adds r5, r1, r4",
        "str r3, [r5, #{stack}]",
        "adds r4, #4",
        "str r4, [r1, #{bytes}]",
        "49:",
        "adds r0, #1",
        "lsls r2, r2, #1",
        // No bit left but those of leaves.
        "cmp r7, r2",
        "bhs 46b",
        "mov r4, r12",
        "cmp r7, #0",
        "bne 43b",
        "b 30b",
        "72:",
        "ldr r4, [r1]",
        "ldrb r3, [r0, r4]",
        "ldr r4, [r1, #{plane} - {depth}]",
        "50:",
        "ldr r5, [sp, #8]",
        "ldrh r5, [r5, #34]",
        "lsls r3, r5",
        "ldr r5, [sp, #12]",
        "adds r3, r3, r5",
        "subs r3, r4, r3",
        "asrs r4, r3, #31",
        "bics r3, r4",
        "b 48b",
        // Of three planes the last that the ray comes to.
        "73:",
        "ldmia r1!, {{r4, r5, r6}}",
        "ldrb r3, [r0, r4]",
        steps!("r10"),
        "subs r4, #1",
        "cmp r4, r3",
        "ble 4f",
        "movs r3, r4",
        "4:",
        "ldmia r1!, {{r5, r6}}",
        steps!("r11"),
        "subs r4, #1",
        "cmp r4, r3",
        "ble 4f",
        "movs r3, r4",
        "4:",
        "ldmia r1!, {{r4}}",
        "subs r1, #40",
        "b 51b",
        "74:",
        "ldmia r1!, {{r4, r5, r6}}",
        "ldrb r3, [r0, r4]",
        steps!("r10"),
        "adds r4, #3",
        "cmp r4, r3",
        "bge 4f",
        "movs r3, r4",
        "4:",
        "ldmia r1!, {{r5, r6}}",
        steps!("r11"),
        "adds r4, #3",
        "cmp r4, r3",
        "bge 4f",
        "movs r3, r4",
        "4:",
        "ldmia r1!, {{r4}}",
        "subs r1, #40",
        "b 50b",
        // Each leaf's triangles.
        "81:",
        "lsrs r7, r7, #1",
        "bcc 82f",
        "ldrb r2, [r5, #24]",
        "movs r1, #15",
        "ands r1, r2",
        "adds r1, r1, r6",
        "lsrs r2, r2, #4",
        "adds r2, r2, r1",
        "ldr r0, [sp]",
        "ldr r0, [r0, #{facets}]",
        "bl {look}",
        "82:",
        "adds r5, #1",
        "cmp r7, #0",
        "bne 81b",
        // What has been met is the limit.
        "ldr r0, [sp]",
        "ldr r1, [r0, #{facets}]",
        "ldr r1, [r1, #{met}]",
        "asrs r1, r1, #{bits}",
        "str r1, [sp, #4]",
        "ldr r5, [r0, #{flip}]",
        "rsbs r3, r1, #0",
        "ands r5, r3",
        "ldr r3, [r0, #{plane}]",
        "adds r3, r3, r5",
        "str r3, [r0, #{range}]",
        "adds r3, r3, r1",
        "str r3, [r0, #{range} + 4]",
        "ldr r4, [r0, #{next}]",
        "b 30b",
        look = sym facets::look,
        met = const Facets::DEPTH,
        bits = const DEPTH_BITS,
        facets = const offset_of!(Walk, facets),
        flip = const offset_of!(Walk, flip),
        slopes = const offset_of!(Walk, slopes),
        plane = const offset_of!(Walk, depth.plane),
        range = const offset_of!(Walk, range),
        next = const offset_of!(Walk, next),
        depth = const offset_of!(Walk, depth),
        bytes = const offset_of!(Walk, waiting.bytes) - offset_of!(Walk, depth),
        stack = const offset_of!(Walk, waiting.stack) - offset_of!(Walk, depth),
        node = const NODE,
        last = const LAST_BIT,
        most = const 4 * STACK,
    )
}
