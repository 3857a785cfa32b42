use core::arch::naked_asm;
use core::mem::offset_of;

use crate::facets::{Facets, SIZE};

/// What is kept in memory while triangles are looked at.
#[repr(C)]
pub(crate) struct Scratch {
    /// Of the corners, along the dominant axis.
    depths: [i32; 3],
    /// Behind the last triangle.
    end: u32,
    link: u32,
}

const CORNERS: usize = offset_of!(Facets, scratch) + offset_of!(Scratch, depths);
const END: usize = offset_of!(Facets, scratch) + offset_of!(Scratch, end);
const LINK: usize = offset_of!(Facets, scratch) + offset_of!(Scratch, link);
// Of the words that are loaded at once.
const _: () = assert!(offset_of!(Facets, vertices) == 0 && offset_of!(Facets, vertex_count) == 20);
const _: () = assert!(offset_of!(Facets, triangle_count) == offset_of!(Facets, triangles) + 4);
const _: () = assert!(offset_of!(Facets, negative) == offset_of!(Facets, plane) + 4);

/// What the ray sees of the vertex at `$vertex`: across the first axis in `$first`, across the second in the same register.
#[rustfmt::skip]
macro_rules! corner {
    ($vertex:literal, $first:literal, $other:literal, $kept:literal, $k:literal, $a:literal, $b:literal) => {
        concat!(
            "ldrh r7, [", $vertex, ", #", $k, "]; str r7, [r1, #{corners} + ", $kept, "];",
            "mla ", $first, ", r7, r9, r10; mla ", $other, ", r7, r11, r12;",
            "ldrh r7, [", $vertex, ", #", $a, "]; ldrh ", $vertex, ", [", $vertex, ", #", $b, "];",
            "add ", $first, ", r7, ", $first, ", asr #13;",
            "add ", $vertex, ", ", $vertex, ", ", $other, ", asr #13;",
        )
    };
}

/// `$high`:`$low` negated.
#[rustfmt::skip]
macro_rules! negate {
    ($low:literal, $high:literal) => {
        concat!("rsbs ", $low, ", ", $low, ", #0; sbc ", $high, ", ", $high, ", ", $high, ", lsl #1;")
    };
}

/// On to 55 if one of r10:r9, lr:r7, r12:r11 is 2^30 or more.
#[rustfmt::skip]
macro_rules! size {
    () => {
        concat!(
            "cmp r10, #0; itt eq; cmpeq lr, #0; cmpeq r12, #0; bne 55f;",
            "cmp r9, #0x40000000; itt lo; cmplo r7, #0x40000000; cmplo r11, #0x40000000; bhs 55f;",
        )
    };
}

/// The triangle that the ray sees in r2, r8, r3 across the first axis, in r4, r5, r6 across the second. r0: behind it; r1: facets,
/// with the corners' depths; both stay. On to 7 if it is nearer and that is enough, else to 8.
///
/// r10:r9 is u, lr:r7 is v, r12:r11 is −w.
#[rustfmt::skip]
macro_rules! test {
    ($name:tt) => {
        concat!(
            // u = cx by − cy bx, w = bx ay − by ax, v = ax cy − ay cx.
            "rsb r8, r8, #0; smull r9, r10, r3, r5; smlal r9, r10, r6, r8;",
            "smull r11, r12, r8, r4; smlal r11, r12, r5, r2; teq r10, r12; bpl 50f;",
            "rsbs r3, r3, #0; smull r7, lr, r2, r6; smlal r7, lr, r4, r3; teq r10, lr; bmi 51f;",
            "cmp r10, #0; bmi 53f;",
            "52:", negate!("r11", "r12"), size!(),
            // Met, u, v, w in r9, r7, r11. 1/(u + v + w): a guess, a Newton step in 16 bits, one in 32.
            "microlux_facets_", $name, "_met:",
            "56: add r2, r9, r7; add r2, r11; clz r3, r2; lsls r2, r3; lsls r7, r3; lsl r11, r11, r3;",
            "ldr r4, [r1, #{recips}]; ubfx r5, r2, #24, #7; ldrh r4, [r4, r5, lsl #1];",
            "lsrs r5, r2, #16; mov r6, #0x80000000; mls r5, r5, r4, r6; asrs r5, r5, #9; muls r5, r4, r5; add r4, r4, r5, asr #22;",
            "lsls r5, r4, #15; umull r6, r8, r2, r5; rsb r8, r8, #0x40000000; lsrs r4, r4, #1; mul r4, r4, r8;",
            "add r5, r5, r4, asr #14; lsls r5, r5, #1; it cs; movcs r5, #-1;",
            // Weights of b and c: r7, r11.
            "umull r6, r7, r7, r5; add r7, r7, #0x4000; lsrs r7, r7, #15; cmp r7, #0x10000; it hi; movhi r7, #0x10000;",
            "umull r6, r11, r11, r5; add r11, r11, #0x4000; lsr r11, r11, #15;",
            "rsb r6, r7, #0x10000; cmp r11, r6; it hi; movhi r11, r6;",
            // Depths of the corners: r3, and what b and c have more than a: r4, r5.
            "ldrd r3, r4, [r1, #{corners}]; ldr r5, [r1, #{corners} + 8]; ldrd r6, r8, [r1, #{plane}];",
            "subs r4, r4, r3; subs r5, r5, r3; subs r3, r3, r6;",
            "cmp r8, #0; ittt ne; rsbne r3, r3, #0; rsbne r4, r4, #0; rsbne r5, r5, #0;",
            "smull r6, r8, r4, r7; lsrs r6, r6, #8; orr r6, r6, r8, lsl #24;",
            "smull r4, r8, r5, r11; lsrs r4, r4, #8; orr r4, r4, r8, lsl #24;",
            "adds r6, r6, r4; adds r6, #8; asrs r6, r6, #4; add r6, r6, r3, lsl #4; cmp r6, #0; ble 8f;",
            // The nearest, and of equals the first.
            "subs r5, r0, #{size}; ldr r3, [r1, #{depth}]; cmp r6, r3; bgt 8f; bne 3f;",
            "ldr r3, [r1, #{triangle}]; cmp r5, r3; bhs 8f;",
            "3: ldr r2, [r1, #{once}]; str r6, [r1, #{depth}]; str r7, [r1, #{depth} + 4]; str r11, [r1, #{depth} + 8];",
            "str r5, [r1, #{triangle}]; cmp r2, #0; bne 7f; b 8f;",
            // u and w differ, unless one is 0.
            "50: orrs lr, r9, r10; it ne; orrsne lr, r11, r12; bne 8f;",
            "rsbs r3, r3, #0; smull r7, lr, r2, r6; smlal r7, lr, r4, r3;",
            "cmp r11, #0; it eq; cmpeq r12, #0; beq 57f;",
            // u = 0, w < 0.
            "cmp lr, #0; bmi 53f; it eq; cmpeq r7, #0; bne 8f; b 53f;",
            // w = 0.
            "57: cmp lr, #0; bmi 58f;",
            "cmp r9, #0; ittt eq; cmpeq r10, #0; cmpeq r7, #0; cmpeq lr, #0; bne 52b; b 8f;",
            "58: cmp r9, #0; it eq; cmpeq r10, #0; beq 53f; b 8f;",
            // u and v differ, unless v is 0.
            "51: cmp r7, #0; bne 8f; cmp lr, #0; bne 8f;",
            "53:", negate!("r9", "r10"), negate!("r7", "lr"), size!(), "b 56b;",
            // Seven bits less, if a corner has more than 16 bits: r8 and r3 are negated.
            "55: add r2, r2, #0x8000; add r4, r4, #0x8000; add r5, r5, #0x8000; add r6, r6, #0x8000;",
            "rsb r8, r8, #0x8000; rsb r3, r3, #0x8000;",
            "orrs r2, r3; orrs r4, r5; orr r6, r6, r8; orrs r2, r4; orrs r2, r6; lsrs r2, r2, #16; beq 56b;",
            "lsr r9, r9, #7; orr r9, r9, r10, lsl #25; lsrs r7, r7, #7; orr r7, r7, lr, lsl #25;",
            "lsr r11, r11, #7; orr r11, r11, r12, lsl #25; b 56b;",
        )
    };
}

/// How [`look`] does it for one dominant axis.
#[rustfmt::skip]
macro_rules! along {
    ($name:ident, $axis:tt, $k:literal, $a:literal, $b:literal) => {
        /// r1: facets. r0, r2: the first triangle and behind the last. In r0 whether it stopped at what is nearer; r1 stays,
        /// and no other register does.
        ///
        /// # Safety
        ///
        /// As [`look`], of facets with a mesh and this axis.
        #[unsafe(naked)]
        pub(crate) unsafe extern "C" fn $name() {
            naked_asm!(
                "ldrd r5, r6, [r1, #{triangles}]; cmp r2, r6; it hi; movhi r2, r6; cmp r0, r2; bhs 9f;",
                "movs r7, #{size}; mla r0, r0, r7, r5; mla r2, r2, r7, r5; str r2, [r1, #{end}]; str lr, [r1, #{link}];",
                "2: ldm r1, {{r2, r9, r10, r11, r12, lr}};",
                "ldrh r4, [r0], #2; ldrh r5, [r0], #2; ldrh r6, [r0], #2;",
                "cmp r4, lr; itt lo; cmplo r5, lr; cmplo r6, lr; bhs 8f;",
                "movs r7, #{size}; mla r4, r4, r7, r2; mla r5, r5, r7, r2; mla r6, r6, r7, r2;",
                corner!("r4", "r2", "r3", "0", $k, $a, $b),
                corner!("r5", "r8", "r3", "4", $k, $a, $b),
                corner!("r6", "r3", "lr", "8", $k, $a, $b),
                test!($axis),
                "8: ldr r2, [r1, #{end}]; cmp r0, r2; blo 2b;",
                "ldr lr, [r1, #{link}];",
                "9: movs r0, #0; bx lr;",
                "7: ldr lr, [r1, #{link}]; movs r0, #1; bx lr;",
                triangles = const offset_of!(Facets, triangles),
                size = const SIZE,
                corners = const CORNERS,
                end = const END,
                link = const LINK,
                recips = const offset_of!(Facets, recips),
                plane = const offset_of!(Facets, plane),
                once = const offset_of!(Facets, once),
                depth = const offset_of!(Facets, nearest.depth),
                triangle = const offset_of!(Facets, nearest.triangle),
            )
        }
    };
}

along!(along_x, "x", "0", "2", "4");
along!(along_y, "y", "2", "4", "0");
along!(along_z, "z", "4", "0", "2");

/// r0: facets. r1, r2: the first triangle and behind the last; without vertices, a triangle's corners and its number.
/// Whether it stopped at what is nearer.
///
/// # Safety
///
/// As [`Facets::new`] or [`Facets::of_corners`] made it, or as this has left it.
#[unsafe(naked)]
#[rustfmt::skip]
pub(crate) unsafe extern "C" fn look(facets: &mut Facets, first: u32, end: u32) -> bool {
    naked_asm!(
        "push {{r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
        "mov r3, r1; mov r1, r0; mov r0, r3; ldr r3, [r1]; cbz r3, 22f",
        "ldr r3, [r1, #{axis}]; cmp r3, #4; beq 20f; bhi 21f",
        "bl {along_x}; pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
        "20: bl {along_y}; pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
        "21: bl {along_z}; pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
        "microlux_facets_corners:",
        "22: mov r12, r0; adds r0, r2, #{size}",
        "ldrd r2, r4, [r12]; ldr r7, [r12, #8]; str r7, [r1, #{corners}]",
        "ldrd r8, r5, [r12, #12]; ldr r7, [r12, #20]; str r7, [r1, #{corners} + 4]",
        "ldrd r3, r6, [r12, #24]; ldr r7, [r12, #32]; str r7, [r1, #{corners} + 8]",
        test!("corner"),
        "7: movs r0, #1; pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
        "8: movs r0, #0; pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
        axis = const offset_of!(Facets, axis),
        size = const SIZE,
        corners = const CORNERS,
        along_x = sym along_x,
        along_y = sym along_y,
        along_z = sym along_z,
        recips = const offset_of!(Facets, recips),
        plane = const offset_of!(Facets, plane),
        once = const offset_of!(Facets, once),
        depth = const offset_of!(Facets, nearest.depth),
        triangle = const offset_of!(Facets, nearest.triangle),
    )
}
