use core::arch::naked_asm;
use core::mem::offset_of;

use crate::facets::{Facets, SIZE};

/// What the ray sees of the vertex at `$vertex`: aside along the first axis in the same register, along the second in
/// `$second`.
#[rustfmt::skip]
macro_rules! corner {
    ($vertex:literal, $second:literal, $k:literal, $a:literal, $b:literal) => {
        concat!(
            "ldrh r0, [", $vertex, ", #", $k, "];",
            "mov r4, r11; muls r4, r0, r4; add r4, r12; asrs r4, r4, #13;",
            "ldrh ", $second, ", [", $vertex, ", #", $b, "]; adds ", $second, ", ", $second, ", r4;",
            "mov r4, r9; muls r4, r0, r4; add r4, r10; asrs r4, r4, #13;",
            "ldrh ", $vertex, ", [", $vertex, ", #", $a, "]; adds ", $vertex, ", ", $vertex, ", r4;",
        )
    };
}

/// On to 2 if the three are all below zero, or all above.
#[rustfmt::skip]
macro_rules! beside {
    ($a:literal, $b:literal, $c:literal) => {
        concat!(
            "movs r0, ", $a, "; ands r0, ", $b, "; ands r0, ", $c, "; bmi 2b;",
            "subs r0, ", $a, ", #1; subs r4, ", $b, ", #1; orrs r0, r4; subs r4, ", $c, ", #1; orrs r0, r4; bpl 2b;",
        )
    };
}

/// On to the next triangle that lies to no side of the ray: the loop for one dominant axis, from label 2 on.
#[rustfmt::skip]
macro_rules! front {
    ($k:literal, $a:literal, $b:literal) => {
        concat!(
            "2: movs r6, #6; ldr r7, [sp, #8];",
            "3: add lr, r6; mov r0, lr; ldr r4, [sp, #4]; cmp r0, r4; bhs 4f;",
            "ldrh r1, [r0]; cmp r1, r7; bhs 3b; ldrh r2, [r0, #2]; cmp r2, r7; bhs 3b; ldrh r3, [r0, #4]; cmp r3, r7; bhs 3b;",
            "muls r1, r6, r1; muls r2, r6, r2; muls r3, r6, r3; add r1, r8; add r2, r8; add r3, r8;",
            corner!("r1", "r7", $k, $a, $b),
            corner!("r2", "r6", $k, $a, $b),
            corner!("r3", "r5", $k, $a, $b),
            beside!("r1", "r2", "r3"),
            beside!("r7", "r6", "r5"),
            "b 50f; 4: b 25b;",
        )
    };
}

/// On to 60 if it has more than 16 bits.
#[rustfmt::skip]
macro_rules! large {
    ($at:literal) => {
        concat!("sxth r0, ", $at, "; cmp r0, ", $at, "; bne 60f;")
    };
}

/// `$high`·256 + `$low` negated.
#[rustfmt::skip]
macro_rules! negate {
    ($high:literal, $low:literal) => {
        concat!(
            "rsbs ", $low, ", ", $low, ", #0; movs r3, #0; sbcs r3, ", $high, "; movs ", $high, ", r3; uxtb ", $low, ", ", $low, ";",
        )
    };
}

/// r0 and r3 shifted, so that r0 has its top bit: by `$by` if the bits from `$from` on are 0.
#[rustfmt::skip]
macro_rules! zeros {
    ($from:literal, $by:literal) => {
        concat!("lsrs r4, r0, #", $from, "; bne 5f; lsls r0, r0, #", $by, "; adds r3, #", $by, "; 5:")
    };
}

/// `$part` times the reciprocal r6·2^16 + r0, the high word's upper 17 bits, rounded: in r3.
#[rustfmt::skip]
macro_rules! share {
    ($part:literal) => {
        concat!(
            "lsrs r3, ", $part, ", #16; uxth ", $part, ", ", $part, ";",
            "movs r4, ", $part, "; muls r4, r6, r4; movs r5, r3; muls r5, r0, r5;",
            "muls ", $part, ", r0, ", $part, "; muls r3, r6, r3;",
            "adds r4, r4, r5; bcc 5f; movs r5, #1; lsls r5, r5, #16; adds r3, r3, r5; 5:",
            "lsls r5, r4, #16; lsrs r4, r4, #16; adds ", $part, ", ", $part, ", r5; adcs r3, r4;",
            "lsrs r3, r3, #14; adds r3, #1; lsrs r3, r3, #1;",
        )
    };
}

/// r0: facets. r1, r2: the first triangle and behind the last; without vertices, a triangle's corners and its number.
/// Whether it stopped at what is nearer.
///
/// Of the stack: the facets' second half, the end (or the corners), the number of vertices, the loop for the dominant axis;
/// two words of an edge. High registers: vertices; slope and offset across, of either axis; the triangle. r1, r2, r3: what
/// the ray sees of the corners along the first axis, r7, r6, r5: along the second.
///
/// Cycles: 77 a call; 95 a triangle, 10 or 20 less where it lies to one side of the ray; 35 its edges, 85 where they take two
/// words; 135 what is met.
///
/// # Safety
///
/// As [`Facets::new`] or [`Facets::of_corners`] made it, or as this has left it.
#[unsafe(naked)]
pub(crate) unsafe extern "C" fn look(facets: &mut Facets, first: u32, end: u32) -> bool {
    naked_asm!(
        "push {{r4, r5, r6, r7, lr}}",
        save_upper!(),
        "sub sp, #24",
        "ldmia r0!, {{r3, r4, r5, r6, r7}}",
        "mov r8, r3",
        "mov r9, r4",
        "mov r10, r5",
        "mov r11, r6",
        "mov r12, r7",
        "cmp r3, #0",
        "bne 22f",
        // Three corners at r1, of the triangle in r2; nothing comes after it.
        "microlux_facets_corners:",
        "mov lr, r2",
        "adr r5, 20f",
        "ldr r5, [r5, #12]",
        "adds r0, #12",
        "str r0, [sp]",
        "str r1, [sp, #4]",
        "str r5, [sp, #12]",
        "ldr r7, [r1, #4]",
        "ldr r6, [r1, #16]",
        "ldr r5, [r1, #28]",
        "ldr r2, [r1, #12]",
        "ldr r3, [r1, #24]",
        "ldr r1, [r1]",
        "b 23f",
        "2:",
        "b 25f",
        "23:",
        beside!("r1", "r2", "r3"),
        beside!("r7", "r6", "r5"),
        "b 50f",
        "22:",
        "ldmia r0!, {{r3, r4, r5}}",
        "cmp r2, r5",
        "bls 21f",
        "movs r2, r5",
        "21:",
        "cmp r1, r2",
        "bhs 25f",
        "movs r6, #{size}",
        "muls r1, r6, r1",
        "muls r2, r6, r2",
        "adds r1, r1, r4",
        "adds r2, r2, r4",
        "subs r1, #{size}",
        "mov lr, r1",
        "adr r5, 20f",
        "ldr r4, [r0]",
        "ldr r5, [r5, r4]",
        "mov r4, sp",
        "stmia r4!, {{r0, r2, r3, r5}}",
        "b 27f",
        ".balign 4",
        "20:",
        ".word 30f - 28f - 4, 31f - 28f - 4, 32f - 28f - 4, 25f - 28f - 4",
        "25:",
        "movs r0, #0",
        "26:",
        "add sp, #24",
        restore_upper!(),
        "pop {{r4, r5, r6, r7, pc}}",
        "30:",
        front!("0", "2", "4"),
        "31:",
        front!("2", "4", "0"),
        "32:",
        front!("4", "0", "2"),
        "27:",
        "ldr r4, [sp, #12]",
        "28:",
        "add pc, r4",
        "50:",
        large!("r1"),
        large!("r2"),
        large!("r3"),
        large!("r5"),
        large!("r6"),
        large!("r7"),
        // u = cx by − cy bx, w = bx ay − by ax, v = ax cy − ay cx: r0, r2, r1.
        "movs r0, r3",
        "muls r0, r6, r0",
        "movs r4, r5",
        "muls r4, r2, r4",
        "subs r0, r0, r4",
        "muls r2, r7, r2",
        "muls r6, r1, r6",
        "subs r2, r2, r6",
        "muls r1, r5, r1",
        "muls r7, r3, r7",
        "subs r1, r1, r7",
        "movs r4, r0",
        "orrs r4, r1",
        "orrs r4, r2",
        "beq 27b",
        "bpl 70f",
        "rsbs r0, r0, #0",
        "rsbs r1, r1, #0",
        "rsbs r2, r2, #0",
        "movs r4, r0",
        "orrs r4, r1",
        "orrs r4, r2",
        "bmi 27b",
        "b 70f",
        // The same in two words: 256 high + low, the first factor of each product split at eight bits.
        "60:",
        "uxtb r0, r3",
        "muls r0, r6, r0",
        "uxtb r4, r5",
        "muls r4, r2, r4",
        "subs r0, r0, r4",
        "uxtb r4, r0",
        "str r4, [sp, #16]",
        "asrs r0, r0, #8",
        "asrs r4, r3, #8",
        "muls r4, r6, r4",
        "adds r0, r0, r4",
        "asrs r4, r5, #8",
        "muls r4, r2, r4",
        "subs r0, r0, r4",
        "str r0, [sp, #20]",
        "uxtb r0, r2",
        "muls r0, r7, r0",
        "uxtb r4, r6",
        "muls r4, r1, r4",
        "subs r0, r0, r4",
        "asrs r2, r2, #8",
        "muls r2, r7, r2",
        "asrs r6, r6, #8",
        "muls r6, r1, r6",
        "subs r2, r2, r6",
        "asrs r6, r0, #8",
        "adds r2, r2, r6",
        "uxtb r6, r0",
        "uxtb r0, r1",
        "muls r0, r5, r0",
        "uxtb r4, r7",
        "muls r4, r3, r4",
        "subs r0, r0, r4",
        "asrs r1, r1, #8",
        "muls r1, r5, r1",
        "asrs r7, r7, #8",
        "muls r7, r3, r7",
        "subs r1, r1, r7",
        "asrs r3, r0, #8",
        "adds r1, r1, r3",
        "uxtb r5, r0",
        "ldr r4, [sp, #16]",
        "ldr r0, [sp, #20]",
        // r0, r4; r1, r5; r2, r6: u, v, w.
        "movs r3, r0",
        "orrs r3, r1",
        "orrs r3, r2",
        "bpl 62f",
        negate!("r0", "r4"),
        negate!("r1", "r5"),
        negate!("r2", "r6"),
        "movs r3, r0",
        "orrs r3, r1",
        "orrs r3, r2",
        "bpl 62f",
        "61:",
        "b 27b",
        "62:",
        "movs r7, r3",
        "orrs r7, r4",
        "orrs r7, r5",
        "orrs r7, r6",
        "beq 61b",
        "lsrs r7, r3, #22",
        "beq 63f",
        // Seven bits less.
        "lsls r0, r0, #1",
        "lsrs r4, r4, #7",
        "orrs r0, r4",
        "lsls r1, r1, #1",
        "lsrs r5, r5, #7",
        "orrs r1, r5",
        "lsls r2, r2, #1",
        "lsrs r6, r6, #7",
        "orrs r2, r6",
        "b 70f",
        "63:",
        "lsls r0, r0, #8",
        "orrs r0, r4",
        "lsls r1, r1, #8",
        "orrs r1, r5",
        "lsls r2, r2, #8",
        "orrs r2, r6",
        "b 70f",
        // Met, u, v, w in r0, r1, r2. 1/(u + v + w): a guess, a Newton step in 16 bits, one in 32.
        "microlux_facets_met:",
        "70:",
        "adds r0, r0, r1",
        "adds r0, r0, r2",
        "movs r3, #0",
        zeros!("16", "16"),
        zeros!("24", "8"),
        zeros!("28", "4"),
        zeros!("30", "2"),
        zeros!("31", "1"),
        "lsls r1, r3",
        "lsls r2, r3",
        "ldr r6, [sp]",
        "ldr r5, [r6, #{recips}]",
        "lsls r4, r0, #1",
        "lsrs r4, r4, #25",
        "lsls r4, r4, #1",
        "ldrh r4, [r5, r4]",
        "lsrs r5, r0, #16",
        "movs r7, r5",
        "muls r7, r4, r7",
        "movs r3, #1",
        "lsls r3, r3, #31",
        "subs r7, r3, r7",
        "asrs r7, r7, #9",
        "muls r7, r4, r7",
        "asrs r7, r7, #22",
        "adds r4, r4, r7",
        "muls r5, r4, r5",
        "uxth r0, r0",
        "muls r0, r4, r0",
        "lsrs r0, r0, #16",
        "adds r0, r0, r5",
        "lsrs r0, r0, #1",
        "lsrs r3, r3, #1",
        "subs r0, r3, r0",
        "lsrs r5, r4, #1",
        "muls r5, r0, r5",
        "asrs r5, r5, #14",
        "lsls r4, r4, #15",
        "adds r4, r4, r5",
        "lsls r0, r4, #1",
        "bcc 71f",
        "movs r0, #0",
        "mvns r0, r0",
        "71:",
        // Weights of b and c: r1, r2.
        "lsrs r6, r0, #16",
        "uxth r0, r0",
        share!("r1"),
        "movs r7, #1",
        "lsls r7, r7, #16",
        "cmp r3, r7",
        "bls 72f",
        "movs r3, r7",
        "72:",
        "movs r1, r3",
        "subs r7, r7, r1",
        share!("r2"),
        "cmp r3, r7",
        "bls 73f",
        "movs r3, r7",
        "73:",
        "movs r2, r3",
        // Depths of the corners: r3, and what b and c have more than a: r4, r5.
        "mov r7, r8",
        "cmp r7, #0",
        "bne 81f",
        "ldr r7, [sp, #4]",
        "ldr r3, [r7, #8]",
        "ldr r4, [r7, #20]",
        "ldr r5, [r7, #32]",
        "ldr r6, [sp]",
        "b 82f",
        "81:",
        "mov r7, lr",
        "ldrh r3, [r7]",
        "ldrh r4, [r7, #2]",
        "ldrh r5, [r7, #4]",
        "movs r6, #{size}",
        "muls r3, r6, r3",
        "muls r4, r6, r4",
        "muls r5, r6, r5",
        "add r3, r8",
        "add r4, r8",
        "add r5, r8",
        "ldr r6, [sp]",
        "ldr r0, [r6]",
        "lsrs r0, r0, #1",
        "ldrh r3, [r3, r0]",
        "ldrh r4, [r4, r0]",
        "ldrh r5, [r5, r0]",
        "82:",
        "subs r4, r4, r3",
        "subs r5, r5, r3",
        "ldr r0, [r6, #{plane}]",
        "subs r3, r3, r0",
        "ldr r0, [r6, #{negative}]",
        "cmp r0, #0",
        "beq 74f",
        "rsbs r3, r3, #0",
        "rsbs r4, r4, #0",
        "rsbs r5, r5, #0",
        "74:",
        "lsrs r0, r1, #8",
        "muls r0, r4, r0",
        "uxtb r7, r1",
        "muls r7, r4, r7",
        "asrs r7, r7, #8",
        "adds r0, r0, r7",
        "lsrs r7, r2, #8",
        "muls r7, r5, r7",
        "adds r0, r0, r7",
        "uxtb r7, r2",
        "muls r7, r5, r7",
        "asrs r7, r7, #8",
        "adds r0, r0, r7",
        "adds r0, #8",
        "asrs r0, r0, #4",
        "lsls r3, r3, #4",
        "adds r0, r0, r3",
        "cmp r0, #0",
        "ble 76f",
        // The nearest, and of equals the first.
        "mov r3, lr",
        "ldr r4, [r6, #{depth}]",
        "cmp r0, r4",
        "blt 75f",
        "bne 76f",
        "ldr r4, [r6, #{triangle}]",
        "cmp r3, r4",
        "bhs 76f",
        "75:",
        "ldr r4, [r6, #{once}]",
        "adds r6, #{depth}",
        "stmia r6!, {{r0, r1, r2, r3}}",
        "cmp r4, #0",
        "beq 76f",
        "movs r0, #1",
        "b 26b",
        "76:",
        "b 27b",
        size = const SIZE,
        recips = const offset_of!(Facets, recips) - offset_of!(Facets, axis),
        plane = const offset_of!(Facets, plane) - offset_of!(Facets, axis),
        negative = const offset_of!(Facets, negative) - offset_of!(Facets, axis),
        once = const offset_of!(Facets, once) - offset_of!(Facets, axis),
        depth = const offset_of!(Facets, nearest) - offset_of!(Facets, axis),
        triangle = const offset_of!(Facets, nearest.triangle) - offset_of!(Facets, axis),
    )
}
