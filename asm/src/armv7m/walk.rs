use core::arch::naked_asm;
use core::marker::PhantomData;
use core::mem::{MaybeUninit, offset_of};
use core::ptr;

use super::facets;
use crate::facets::Facets;
use crate::ray::{Across, DEPTH_BITS, LAST_BIT, Leaves, Order, Ray, STACK, are_nodes};

/// Where a ray is in a tree.
#[repr(C)]
pub struct Walk<'a> {
    nodes: *const u8,
    count: u32,
    /// Of the axes across, the ray's offsets, negated.
    bounds: [i32; 2],
    /// Where the ray may be met, along the axis; from the limit.
    range: MaybeUninit<[i32; 2]>,
    slopes: [i32; 2],
    limit: MaybeUninit<i32>,
    /// Of the nodes that wait, bytes.
    waiting: u32,
    /// All ones for a ray that goes down the axis.
    flip: i32,
    /// Where it starts along the axis, one more if it goes down.
    start: i32,
    /// From where depths are measured along the axis: so far off that all are 0, where any child may come first.
    from: i32,
    /// The flip once more: what sorts children lies together.
    fall: i32,
    across: [Across; 2],
    /// The node that comes next, if it is not beyond the limit: depth and index, as those that wait.
    next: u32,
    /// What looks at leaves, if not the caller.
    facets: MaybeUninit<*mut Facets<'static>>,
    /// Which code of [`step`] is the ray's: by its axis, by which slopes fall.
    code: u32,
    stack: MaybeUninit<[u32; STACK]>,
    tree: PhantomData<&'a [u8]>,
}

impl Across {
    #[inline(always)]
    fn new(slope: i32, recips: &[u16; 128]) -> Across {
        let size = slope.unsigned_abs();
        if size < 1 << 8 {
            return Across { beyond: 0, recip: 0 };
        }
        // 2 ..= 7 zeros below the upper half.
        let zeros = size.leading_zeros() & 7;
        let n = size << zeros;
        let r = i32::from(recips[(n >> 8 & 127) as usize]);
        let e = (1i32 << 31).wrapping_sub(n.wrapping_mul(r as u32) as i32);
        Across {
            beyond: size << 8,
            recip: (r + (r.wrapping_mul(e >> 9) >> 22)) as u32 >> (8 - zeros),
        }
    }
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
        if !are_nodes(nodes, count) {
            return None;
        }
        let flip = -i32::from(ray.negative);
        let walk = place.as_mut_ptr();
        // SAFETY: what is not written here may stay as it is.
        unsafe {
            for axis in 0..2 {
                (*walk).across[axis] = match order {
                    Order::Entry => Across::new(ray.slopes[axis], recips),
                    _ => Across { beyond: 0, recip: 0 },
                };
            }
            (*walk).nodes = nodes.as_ptr();
            (*walk).count = count as u32;
            (*walk).bounds = ray.offsets.map(i32::wrapping_neg);
            (*walk).slopes = ray.slopes;
            (*walk).waiting = 0;
            (*walk).flip = flip;
            (*walk).start = ray.plane - flip;
            (*walk).from = match order {
                Order::Any => ((1 << 30) ^ flip) - flip,
                _ => ray.plane,
            };
            (*walk).fall = flip;
            (*walk).next = 0;
            let falls = ray.slopes.map(|slope| slope as u32 >> 31);
            (*walk).code = u32::from(ray.axis.min(2)) * 4 + falls[0] * 2 + falls[1];
            Some(place.assume_init_mut())
        }
    }

    /// On to the next node of which the ray may meet leaves before the limit.
    #[inline(always)]
    pub fn leaves(&mut self, limit: i32) -> Option<Leaves> {
        if limit < 0 {
            return None;
        }
        // SAFETY: `nodes` points to `count` nodes that outlive the walk, `code` is under 12, and the stack is as full as
        // `waiting` says.
        Leaves::found(unsafe { step(ptr::from_mut(self).cast(), limit as u32, 0, ptr::null_mut()) })
    }
}

/// [`Facets::follow`]: the ray is what the facets say of it.
#[inline(always)]
pub(crate) fn follow(facets: &mut Facets, nodes: &[u8], count: usize, _: &Ray, _: &[u16; 128]) {
    if facets.depth() >= 0 && facets.has_mesh() && are_nodes(nodes, count) {
        let mut place = MaybeUninit::<Walk>::uninit();
        // SAFETY: there are so many nodes; the facets are as `Facets::new` made them, or as their own look has left them.
        unsafe {
            step(
                place.as_mut_ptr().cast(),
                nodes.as_ptr() as u32,
                count as u32,
                ptr::from_mut(facets).cast(),
            )
        };
    }
}

/// A plane of child `$slot` along the dominant axis, out of its word: the lower one to r3, the upper one to r4.
#[rustfmt::skip]
macro_rules! plane {
    ("0", "r3") => { "uxtb r3, r1;" };
    ("1", "r3") => { "uxtb r3, r1, ror #8;" };
    ("2", "r3") => { "uxtb r3, r1, ror #16;" };
    ("3", "r3") => { "lsrs r3, r1, #24;" };
    ("0", "r4") => { "uxtb r4, r2;" };
    ("1", "r4") => { "uxtb r4, r2, ror #8;" };
    ("2", "r4") => { "uxtb r4, r2, ror #16;" };
    ("3", "r4") => { "lsrs r4, r2, #24;" };
}

/// The second of two planes, if it is another one than the first.
#[rustfmt::skip]
macro_rules! second {
    ($slot:tt, "r3", "r3") => { "" };
    ($slot:tt, "r4", "r4") => { "" };
    ($slot:tt, $first:tt, $second:tt) => { plane!($slot, $second) };
}

/// The other plane, if two are the same.
#[rustfmt::skip]
macro_rules! third {
    ($slot:tt, "r3", "r3") => { plane!($slot, "r4") };
    ($slot:tt, "r4", "r4") => { plane!($slot, "r3") };
    ($slot:tt, $first:tt, $second:tt) => { "" };
}

/// On to 3 if the ray passes above child `$slot` of the node at r0 along an axis across, or below it.
#[rustfmt::skip]
macro_rules! beyond {
    ($slot:tt, $plane:tt, $side:tt, $slope:tt, $z:tt, $bound:tt, $beyond:tt) => {
        concat!(
            "ldrb r5, [r0, #", $plane, " + ", $side, " + ", $slot, "]; mla r6, ", $slope, ", ", $z, ", ", $bound, ";",
            "cmp r6, r5, lsl #13; b", $beyond, " 3f;",
        )
    };
}

/// Whether the ray meets child `$slot` of the node at r0: if so, its bit in r7, the top one of a byte, slot 0 the highest.
///
/// `$most` and `$least`: which of r3 and r4 makes most of a place across, and least. Children come in the order of their
/// places: what is met seldom is asked first.
#[rustfmt::skip]
macro_rules! child {
    ("low", $slot:tt, $x:tt, $y:tt, $most1:tt, $least1:tt, $most2:tt, $least2:tt) => {
        concat!(
            plane!($slot, $least1), beyond!($slot, $x, "4", "r8", $least1, "r10", "gt"),
            second!($slot, $least1, $least2), beyond!($slot, $y, "4", "r9", $least2, "r11", "gt"),
            third!($slot, $least1, $least2),
            beyond!($slot, $x, "0", "r8", $most1, "r10", "lt"),
            beyond!($slot, $y, "0", "r9", $most2, "r11", "lt"),
            child!($slot),
        )
    };
    ("high", $slot:tt, $x:tt, $y:tt, $most1:tt, $least1:tt, $most2:tt, $least2:tt) => {
        concat!(
            plane!($slot, $most1), beyond!($slot, $x, "0", "r8", $most1, "r10", "lt"),
            second!($slot, $most1, $most2), beyond!($slot, $y, "0", "r9", $most2, "r11", "lt"),
            third!($slot, $most1, $most2),
            beyond!($slot, $x, "4", "r8", $least1, "r10", "gt"),
            beyond!($slot, $y, "4", "r9", $least2, "r11", "gt"),
            child!($slot),
        )
    };
    ($slot:tt) => {
        concat!("cmp r4, r12; blt 3f; cmp r3, lr; bgt 3f; orr r7, r7, #0x80000000 >> (8 * ", $slot, "); 3:")
    };
}

/// Where the ray comes to the child at r3 across an axis, as planes along the dominant one: in r4 if it is `$later`.
///
/// `$aside`: how r5, Q13, and the bound make the way aside.
#[rustfmt::skip]
macro_rules! across {
    ($face:tt, $side:tt, $aside:tt, $bound:tt, $beyond:tt, $recip:tt, $later:tt) => {
        concat!(
            "ldrb r5, [r3, #", $face, " + ", $side, "];", $aside, " r5, ", $bound, ", r5, lsl #13; cmp r5, ", $beyond, "; bhs 3f;",
            "lsrs r5, r5, #5; mul r5, r5, ", $recip, "; cmp r4, r5, lsr #18; it ", $later, "; lsr", $later, " r4, r5, #18; 3:",
        )
    };
}

/// The next of the children in r7, all nodes, behind r3: depth and index to `$to`.
///
/// `$side`: which of two planes the ray comes to first.
#[rustfmt::skip]
macro_rules! depth {
    (
        $to:tt, [$x:tt, $y:tt, $z:tt], [$side1:tt, $side2:tt, $side:tt], [$aside1:tt, $aside2:tt],
        $before:tt, $later:tt, $after:tt
    ) => {
        concat!(
            "clz r5, r7; lsls r7, r5; bic r7, r7, #0x80000000; add r3, r3, r5, lsr #3;",
            "ldrb r6, [r3, #24]; ldrb r4, [r3, #", $z, " + ", $side, "];", $before,
            across!($x, $side1, $aside1, "r10", "r8", "r9", $later),
            across!($y, $side2, $aside2, "r11", "r12", "lr", $later),
            // The exponent, and the first node above it.
            "ldr r5, [r0, #34];", $after, "bic r4, r4, r4, asr #31;",
            "and r6, r6, #3; add ", $to, ", r6, r5, lsr #16; bfi ", $to, ", r4, #16, #16;",
        )
    };
}

/// Of the children in r7, all nodes, one at least: the nearest to r2, the others wait.
#[rustfmt::skip]
macro_rules! sort {
    ($($how:tt),*) => {
        concat!(
            "mov r3, r0;",
            depth!("r2", $($how),*),
            "cmp r7, #0; beq 47f;",
            "4:",
            depth!("r5", $($how),*),
            // The farther of two waits.
            "cmp r5, r2; mov r6, r5; itt lo; movlo r6, r2; movlo r2, r5;",
            "ldr r5, [sp]; ldr r4, [r5, #{waiting}]; cmp r4, #{most}; bhs 5f;",
            "adds r4, #4; str r4, [r5, #{waiting}]; add r5, r4; str r6, [r5, #{stack} - 4];",
            "5: cmp r7, #0; bne 4b;",
            // On to it, if it is not beyond the limit; leaves first.
            "47: ldr r3, [sp]; ldr r7, [sp, #8]; cmp r7, #0; bne 48f;",
            "ldr r5, [r3, #{limit}]; ldrd r8, r9, [r3, #{slopes}]; uxth r4, r2; cmp r5, r2, lsr #16; bhs 36f; b 33f;",
        )
    };
}

/// What has been met is the limit, from now on also r5; r3 is the walk.
#[rustfmt::skip]
macro_rules! limit {
    () => {
        concat!(
            "ldr r3, [sp]; ldr r5, [r1, #{met}]; ldrd r6, r7, [r3, #{flip}]; asrs r5, r5, #{bits}; str r5, [r3, #{limit}];",
            "eor r2, r5, r6; add r2, r7; add r6, r3, r6, lsl #2; str r2, [r6, #{range} + 4];",
        )
    };
}

/// For one dominant axis, and for slopes that rise or fall; r3 is the walk.
///
/// r8, r9: slopes; r10, r11: bounds across; r12, lr: range along the axis; the last two are free where children are sorted,
/// as are the slopes. On the stack: the walk, a node, its leaves.
#[rustfmt::skip]
macro_rules! walk {
    (
        $entry:tt, $root:tt, $number:tt, $along:tt, [$x:tt, $y:tt, $z:tt], [$ox:tt, $oy:tt, $oz:tt],
        [$most1:tt, $least1:tt, $first1:tt, $last1:tt, $aside1:tt],
        [$most2:tt, $least2:tt, $first2:tt, $last2:tt, $aside2:tt]
    ) => {
        concat!(
            // Several leaves alone.
            "49: mov r7, r5; mvn r4, #0; b 43f;",
            "45: ldr r3, [sp]; ldr r6, [r0, #24]; rev r6, r6; bic r5, r7, r6; str r5, [sp, #8]; ands r7, r6; beq 49b;",
            "adds r5, r3, #{from}; ldm r5, {{r4, r6, r8, r9, r12, lr}}; ldrh r2, [r0, #", $oz, "]; cmp r6, #0; bne 46f;",
            "subs r1, r2, r4;",
            sort!([$x, $y, $z], [$first1, $first2, "0"], [$aside1, $aside2], "adds r4, #1;", "lo", "subs r4, #1; lsls r4, r5; add r4, r1;"),
            "46: subs r1, r4, r2;",
            sort!([$x, $y, $z], [$last1, $last2, "4"], [$aside1, $aside2], "subs r4, #3;", "gt", "adds r4, #3; lsls r4, r5; subs r4, r1, r4;"),
            "48: mov r4, r2;",
            // Leaves in r7, the node that comes next in r4.
            "43: str r4, [r3, #{next}]; ldr r1, [r3, #{facets}]; cmp r1, #0; beq 26f; str r0, [sp, #4];",
            "44: clz r4, r7; mov r5, #0x80000000; lsrs r5, r4; eors r7, r5; add r4, r0, r4, lsr #3; str r7, [sp, #8];",
            "ldrb r5, [r4, #24]; ldrh r2, [r0, #38]; ldrb r3, [r0, #35];",
            "and r0, r5, #15; add r0, r2; add r0, r0, r3, lsl #16; add r2, r0, r5, lsr #4; bl {", $along, "};",
            "ldrd r0, r7, [sp, #4]; cmp r7, #0; bne 44b;",
            limit!(),
            "ldr r4, [r3, #{next}]; ldr r6, [r3, #{waiting}]; ldrd r8, r9, [r3, #{slopes}]; b 31f;",
            // A single leaf.
            "42: ldr r3, [sp]; ldr r1, [r3, #{facets}]; cmp r1, #0; beq 28f;",
            "ldrh r2, [r0, #38]; ldrb r3, [r0, #35]; and r0, r5, #15; add r0, r2; add r0, r0, r3, lsl #16; add r2, r0, r5, lsr #4; bl {", $along, "};",
            limit!(),
            "ldr r6, [r3, #{waiting}]; ldrd r8, r9, [r3, #{slopes}]; b 32f;",
            $entry, ":",
            "ldr r4, [r3, #{next}]; ldrd r8, r9, [r3, #{slopes}]; ldrd r5, r6, [r3, #{limit}];",
            // The node in r4, or the last that waits, unless it is beyond the limit.
            "31: adds r7, r4, #1; beq 32f; cmp r5, r4, lsr #16; bhs 35f; b 32f;",
            "33: ldr r3, [sp]; ldrd r5, r6, [r3, #{limit}];",
            "32: subs r6, #4; bmi 25f; adds r7, r3, r6; ldr r4, [r7, #{stack}]; cmp r5, r4, lsr #16; blo 32b;",
            "str r6, [r3, #{waiting}];",
            "35: uxth r4, r4; 36:", $root, ": ldm r3, {{r2, r5, r6, r7, r12, lr}}; cmp r4, r5; bhs 33b;",
            // Node r4. The name is for those who count visits.
            "microlux_walk_", $number, "_node:",
            "add r4, r4, r4, lsl #2; add r0, r2, r4, lsl #3;",
            "ldrh r1, [r0, #", $oz, "]; ldrh r2, [r0, #", $ox, "]; ldrh r3, [r0, #", $oy, "]; ldrb r4, [r0, #34];",
            // −across >> e of the origin, along both axes across.
            "mla r10, r8, r1, r6; sub r10, r10, r2, lsl #13; asr r10, r10, r4;",
            "mla r11, r9, r1, r7; sub r11, r11, r3, lsl #13; asr r11, r11, r4;",
            "sub r12, r12, r1; asr r12, r12, r4; sub lr, lr, r1; asr lr, lr, r4;",
            "ldr r1, [r0, #", $z, "]; ldr r2, [r0, #", $z, " + 4]; movs r7, #0;",
            child!("low", "0", $x, $y, $most1, $least1, $most2, $least2),
            child!("low", "1", $x, $y, $most1, $least1, $most2, $least2),
            child!("high", "2", $x, $y, $most1, $least1, $most2, $least2),
            child!("high", "3", $x, $y, $most1, $least1, $most2, $least2),
            "subs r5, r7, #1; blo 33b; tst r5, r7; bne 45b;",
            // Straight on to a single one.
            "clz r4, r7; add r5, r0, r4, lsr #3; ldrb r5, [r5, #24]; lsls r4, r5, #25; bcc 42b;",
            "ldrh r4, [r0, #36]; and r5, r5, #3; add r4, r5; ldr r3, [sp]; b 36b;",
        )
    };
}

/// [`walk!`] of slopes that rise and fall.
#[rustfmt::skip]
macro_rules! slopes {
    ([$($entry:tt, $root:tt: $number:tt),*], $along:tt, $planes:tt, $origins:tt) => {
        slopes!(@ [$([$entry, $root, $number])*], $along, $planes, $origins, ["r4", "r3", "0", "4", "rsb"], ["r3", "r4", "4", "0", "sub"])
    };
    (@ [[$e0:tt, $r0:tt, $n0:tt] [$e1:tt, $r1:tt, $n1:tt] [$e2:tt, $r2:tt, $n2:tt] [$e3:tt, $r3:tt, $n3:tt]], $along:tt, $planes:tt, $origins:tt, $rise:tt, $fall:tt) => {
        concat!(
            walk!($e0, $r0, $n0, $along, $planes, $origins, $rise, $rise),
            walk!($e1, $r1, $n1, $along, $planes, $origins, $rise, $fall),
            walk!($e2, $r2, $n2, $along, $planes, $origins, $fall, $rise),
            walk!($e3, $r3, $n3, $along, $planes, $origins, $fall, $fall),
        )
    };
}

/// What tells where a ray comes to an axis' planes, at `$at` of the walk at r0, of the slope's size in `$size`; r11: guesses of
/// reciprocals.
#[rustfmt::skip]
macro_rules! recip {
    ($size:tt, $at:tt) => {
        concat!(
            "movs r5, #0; movs r2, #0; cmp ", $size, ", #0x100; blo 3f;",
            // Up to bit 15.
            "clz r5, ", $size, "; subs r5, #16; lsl r2, ", $size, ", r5;",
            // A guess and a Newton step.
            "ubfx r7, r2, #8, #7; ldrh r7, [r11, r7, lsl #1]; muls r2, r7, r2; rsb r2, r2, #0x80000000;",
            "asrs r2, r2, #9; muls r2, r7, r2; add r2, r7, r2, asr #22; rsb r5, r5, #8; lsrs r2, r5; lsls r5, ", $size, ", #8;",
            "3: str r5, [r0, #{across} + ", $at, "]; str r2, [r0, #{across} + ", $at, " + 4];",
        )
    };
}

/// r0: walk. r3: null, then r1: limit: a node's first primitive, and then its leaves; all ones for none.
///
/// Or r3: what looks at leaves. r1, r2: nodes and their number.
///
/// # Safety
///
/// The walk is as [`Walk::begin`] made it, or as this has left it; or there are the nodes, and the facets have a mesh.
#[unsafe(naked)]
#[rustfmt::skip]
unsafe extern "C" fn step(
    walk: *mut Walk<'static>,
    limit_or_nodes: u32,
    count: u32,
    facets: *mut Facets<'static>,
) -> u64 {
    naked_asm!(
        "push {{r4, r5, r6, r7, r8, r9, r10, r11, lr}}; sub sp, #12; str r0, [sp]; str r3, [r0, #{facets}]; cmp r3, #0; bne 22f",
        // On, up to a limit: backwards from −limit to 0 along the axis, else from 0 to the limit.
        "mov r3, r0; str r1, [r3, #{limit}]",
        "ldrd r4, r5, [r3, #{flip}]; add r5, r4; ands r4, r1; subs r5, r5, r4; str r5, [r3, #{range}]; add r5, r1; str r5, [r3, #{range} + 4]",
        "ldr r4, [r3, #{code}]; tbh [pc, r4, lsl #1]",
        "29: .hword (60f - 29b) / 2, (61f - 29b) / 2, (62f - 29b) / 2, (63f - 29b) / 2",
        ".hword (64f - 29b) / 2, (65f - 29b) / 2, (66f - 29b) / 2, (67f - 29b) / 2",
        ".hword (68f - 29b) / 2, (69f - 29b) / 2, (70f - 29b) / 2, (71f - 29b) / 2",
        // At the root: slopes, and offsets negated.
        "22: str r1, [r0, #{nodes}]; str r2, [r0, #{nodes} + 4]",
        "adds r4, r3, #{facets_across}; ldm r4, {{r4, r5, r6, r7}}",
        "rsbs r5, r5, #0; str r5, [r0, #{bounds}]; rsbs r7, r7, #0; str r7, [r0, #{bounds} + 4]",
        "rsb r8, r4, #0; str r8, [r0, #{slopes}]; rsb r9, r6, #0; str r9, [r0, #{slopes} + 4]",
        // Which code is the ray's: r1. Where it starts, whether it goes down, and its limit: r2, r10, r12.
        "ldrd r1, r2, [r3, #{facets_axis}]; ldrd r10, r11, [r3, #{facets_negative}]; ldr r12, [r3, #{met}]; asr r12, r12, #{bits}",
        "lsr r5, r8, #31; add r1, r1, r5, lsl #1; add r1, r1, r9, lsr #31; rsb r10, r10, #0",
        "str r12, [r0, #{limit}]; str r2, [r0, #{from}]; str r10, [r0, #{flip}]; str r10, [r0, #{from} + 4]",
        "sub r5, r2, r10; str r5, [r0, #{flip} + 4]",
        "and r5, r12, r10; subs r2, r2, r5; str r2, [r0, #{range}]; add r2, r12; str r2, [r0, #{range} + 4]",
        "movs r5, #0; str r5, [r0, #{waiting}]",
        "eor r4, r8, r8, asr #31; sub r4, r4, r8, asr #31; eor r6, r9, r9, asr #31; sub r6, r6, r9, asr #31",
        recip!("r4", "0"),
        recip!("r6", "8"),
        "mov r3, r0; movs r4, #0; tbh [pc, r1, lsl #1]",
        "29: .hword (80f - 29b) / 2, (81f - 29b) / 2, (82f - 29b) / 2, (83f - 29b) / 2",
        ".hword (84f - 29b) / 2, (85f - 29b) / 2, (86f - 29b) / 2, (87f - 29b) / 2",
        ".hword (88f - 29b) / 2, (89f - 29b) / 2, (90f - 29b) / 2, (91f - 29b) / 2",
        slopes!(["60", "80": "0", "61", "81": "1", "62", "82": "2", "63", "83": "3"], "along_x", ["8", "16", "0"], ["30", "32", "28"]),
        slopes!(["64", "84": "4", "65", "85": "5", "66", "86": "6", "67", "87": "7"], "along_y", ["16", "0", "8"], ["32", "28", "30"]),
        slopes!(["68", "88": "8", "69", "89": "9", "70", "90": "10", "71", "91": "11"], "along_z", ["0", "8", "16"], ["28", "30", "32"]),
        // Nothing waits.
        "25: mov r0, #-1; str r0, [r3, #{next}]",
        "27: add sp, #12; pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
        // Leaves in r7 of the node at r0, before r4: to the caller.
        "28: mov r4, #-1; str r4, [r3, #{next}]",
        "26: ldrh r5, [r0, #38]; ldrb r6, [r0, #35]; orr r5, r5, r6, lsl #16",
        "adds r4, #1; bne 3f; ldr r4, [r3, #{waiting}]; cmp r4, #0; it eq; orreq r5, r5, #1 << {last}; 3: movs r1, #0",
        "tst r7, #0x80; itt ne; ldrbne r6, [r0, #27]; movne r1, r6",
        "tst r7, #0x8000; itt ne; ldrbne r6, [r0, #26]; orrne r1, r6, r1, lsl #8",
        "tst r7, #0x800000; itt ne; ldrbne r6, [r0, #25]; orrne r1, r6, r1, lsl #8",
        "tst r7, #0x80000000; itt ne; ldrbne r6, [r0, #24]; orrne r1, r6, r1, lsl #8",
        "mov r0, r5; b 27b",
        along_x = sym facets::along_x,
        along_y = sym facets::along_y,
        along_z = sym facets::along_z,
        across = const offset_of!(Walk, across),
        bounds = const offset_of!(Walk, bounds),
        facets_across = const offset_of!(Facets, across),
        facets_axis = const offset_of!(Facets, axis),
        facets_negative = const offset_of!(Facets, negative),
        from = const offset_of!(Walk, from),
        nodes = const offset_of!(Walk, nodes),
        bits = const DEPTH_BITS,
        code = const offset_of!(Walk, code),
        facets = const offset_of!(Walk, facets),
        flip = const offset_of!(Walk, flip),
        last = const LAST_BIT,
        limit = const offset_of!(Walk, limit),
        met = const Facets::DEPTH,
        most = const 4 * STACK,
        next = const offset_of!(Walk, next),
        range = const offset_of!(Walk, range),
        slopes = const offset_of!(Walk, slopes),
        stack = const offset_of!(Walk, stack),
        waiting = const offset_of!(Walk, waiting),
    )
}
