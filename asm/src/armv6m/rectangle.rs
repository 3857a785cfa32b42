use core::arch::naked_asm;
use core::hint::assert_unchecked;

/// Distance along a ray to a rectangle, under `t_max` and 2^29: the bits of the core's portable twin.
///
/// Of the rectangle the normal, the directions of both sides, the centre, and half the sides' lengths; of the ray origin
/// and direction. `recips` are first guesses 2^47/n by n's seven bits below the top one.
#[inline(always)]
pub fn rectangle(rectangle: &[i32; 14], ray: &[i32; 6], t_max: i32, recips: &[u16; 128]) -> Option<i32> {
    // SAFETY: nothing is read but what the references stand for.
    let met = unsafe { meet(rectangle, ray, t_max, recips) };
    let is_met = met as u32;
    // SAFETY: as `meet` says.
    unsafe { assert_unchecked(is_met <= 1) };
    (is_met != 0).then_some((met >> 32) as i32)
}

/// `$a` times `$b`, Q16, rounded down, onto `$to`; both are lost, and `$with`.
#[rustfmt::skip]
macro_rules! product {
    ($a:literal, $b:literal, $with:literal, $to:literal) => {
        concat!(
            "asrs ", $with, ", ", $a, ", #16; muls ", $with, ", ", $b, ", ", $with, "; add ", $to, ", ", $with, ";",
            "uxth ", $a, ", ", $a, "; uxth ", $with, ", ", $b, "; muls ", $with, ", ", $a, ", ", $with, ";",
            "lsrs ", $with, ", ", $with, ", #16; add ", $to, ", ", $with, ";",
            "asrs ", $b, ", ", $b, ", #16; muls ", $b, ", ", $a, ", ", $b, "; add ", $to, ", ", $b, ";",
        )
    };
}

/// Of a normal along the axis whose words are `$at` bytes from the first: height over the plane to r5 and what the ray loses
/// of it to r6, if both are positive; then on to 40. What is nearly an axis goes on to 30.
#[rustfmt::skip]
macro_rules! upright {
    ($normal:literal, $at:literal) => {
        concat!(
            "lsls r7, ", $normal, ", #16; bne 9f;",
            "ldr r4, [r0, #24 + ", $at, "]; ldr r6, [r1, #12 + ", $at, "]; ldr r5, [r1, #", $at, "];",
            "subs r5, r5, r4; bmi 8f;",
            "rsbs r6, r6, #0; ble 7f; lsls r6, r6, #8; b 40f;",
            "7: movs r0, #0; pop {{r4, r5, r6, r7, pc}};",
            "9: b 30f;",
            "8: rsbs r5, r5, #0; cmp r6, #0; ble 7b; lsls r6, r6, #8;",
        )
    };
}

/// A component's part of height, r5, and slope, r6 and r4 (8 bits less).
#[rustfmt::skip]
macro_rules! part {
    ($at:literal) => {
        concat!(
            "ldr r3, [r0, #", $at, "]; cmp r3, #0; beq 9f;",
            "ldr r2, [r1, #12 + ", $at, "]; uxtb r7, r2; muls r7, r3, r7; adds r4, r4, r7;",
            "asrs r2, r2, #8; muls r2, r3, r2; adds r6, r6, r2;",
            "ldr r2, [r1, #", $at, "]; ldr r7, [r0, #36 + ", $at, "]; subs r2, r2, r7;",
            product!("r2", "r3", "r7", "r5"),
            "9:",
        )
    };
}

/// Of r6, which has its top bit, half of 2^63/r6: in r4, 31 bits at most (each r6 was tried).
#[rustfmt::skip]
macro_rules! recip {
    () => {
        concat!(
            "lsls r4, r6, #1; lsrs r4, r4, #25; lsls r4, r4, #1; ldrh r4, [r3, r4];",
            // 2^31 less the product, twice.
            "lsrs r3, r6, #16; movs r2, r3; muls r2, r4, r2; rsbs r2, r2, #0; lsls r2, r2, #1;",
            "asrs r2, r2, #10; muls r2, r4, r2; asrs r2, r2, #22; adds r4, r4, r2;",
            "muls r3, r4, r3; uxth r6, r6; muls r6, r4, r6; lsrs r6, r6, #16; adds r3, r3, r6;",
            "rsbs r3, r3, #0; lsls r3, r3, #1; adds r3, #2; asrs r3, r3, #2;",
            "lsrs r2, r4, #1; muls r3, r2, r3; asrs r3, r3, #14; lsls r4, r4, #15; adds r4, r4, r3;",
        )
    };
}

/// The place of the crossing along an axis, seen from the centre, which is `$center` bytes from r0: in r2.
#[rustfmt::skip]
macro_rules! place {
    ($at:literal, $center:literal, $a:literal, $b:literal) => {
        concat!(
            "ldr r2, [r1, #12 + ", $at, "]; movs ", $a, ", r2; muls ", $a, ", r3, ", $a, ";",
            "uxth ", $b, ", r2; muls ", $b, ", r4, ", $b, "; lsrs ", $b, ", ", $b, ", #16; adds ", $a, ", ", $a, ", ", $b, ";",
            "asrs r2, r2, #16; muls r2, r4, r2; adds r2, r2, ", $a, ";",
            "ldr ", $a, ", [r1, #", $at, "]; adds r2, r2, ", $a, ";",
            "ldr ", $a, ", [r0, #", $center, " + ", $at, "]; subs r2, r2, ", $a, ";",
        )
    };
}

/// The same times `$side`, of which there is nothing else: ±1, or on to `$turned`.
#[rustfmt::skip]
macro_rules! straight {
    ($at:literal, $center:literal, $side:literal, $a:literal, $b:literal, $turned:literal) => {
        concat!(
            "lsls r2, ", $side, ", #16; bne ", $turned, ";",
            place!($at, $center, $a, $b),
            "asrs ", $side, ", ", $side, ", #16; muls r2, ", $side, ", r2;",
        )
    };
}

/// A component's part of the place along a side at r0, onto lr.
#[rustfmt::skip]
macro_rules! aside {
    ($at:literal, $center:literal) => {
        concat!(
            "ldr r6, [r0, #", $at, "]; cmp r6, #0; beq 9f;",
            place!($at, $center, "r5", "r7"),
            product!("r2", "r6", "r5", "lr"),
            "9:",
        )
    };
}

/// On if the crossing is within the side at r0, behind which r0 moves: from there the centre is `$center` bytes, half the
/// side's length `$half`. What lies along no axis takes the way by `$turned`, or `$aside` where it has nothing of the first, and
/// comes back to `$x`, the place in r2.
#[rustfmt::skip]
macro_rules! side {
    ($center:literal, $half:literal, $turned:literal, $aside:literal, $x:literal) => {
        concat!(
            "ldmia r0!, {{r5, r6, r7}};",
            "cmp r5, #0; beq 6f; orrs r6, r7; bne 5f;",
            straight!("0", $center, "r5", "r6", "r7", "5f"), "b ", $x, "f;",
            "5: b ", $turned, "f;",
            "6: cmp r6, #0; beq 8f; cmp r7, #0; bne 9f;",
            straight!("4", $center, "r6", "r5", "r7", "9f"), "b ", $x, "f;",
            "7: movs r0, #0; pop {{r4, r5, r6, r7, pc}};",
            "9: b ", $aside, "f;",
            "8:", straight!("8", $center, "r7", "r5", "r6", "9b"),
            // Up to half of it, and 3 more below.
            $x, ": ldr r5, [r0, #", $half, "]; cmp r2, r5; bgt 7b; adds r5, #3; cmn r2, r5; blt 7b;",
        )
    };
}

/// What [`side!`] leaves out, of a centre `$center` bytes from the side: the first component is r5, or 0.
#[rustfmt::skip]
macro_rules! turned {
    ($center:literal, $turned:literal, $aside:literal, $x:literal) => {
        concat!(
            $turned, ": subs r0, #12;", place!("0", $center, "r6", "r7"),
            "movs r6, #0;", product!("r2", "r5", "r7", "r6"), "mov lr, r6; b 8f;",
            $aside, ": subs r0, #12; mov lr, r5;",
            "8:", aside!("4", $center), aside!("8", $center),
            "adds r0, #12; mov r2, lr; b ", $x, "b;",
        )
    };
}

/// r0: rectangle. r1: ray. r2: limit. r3: first guesses of reciprocals. 1 and, in the upper word, the distance; 0 in the lower
/// one for none.
///
/// From 40 on r5 is the height over the plane, r6 what the ray loses of it, Q24, both positive; r0 stands at the sides. r12:
/// the limit, then the distance. r3, r4: the distance by halves.
///
/// Cycles: 40 where it is not ahead, 55 beyond the limit, 150 past its first side, 195 where it is met; 45 more of any normal,
/// 50 of a side along no axis.
///
/// # Safety
///
/// None but that the references are valid.
#[unsafe(naked)]
unsafe extern "C" fn meet(rectangle: &[i32; 14], ray: &[i32; 6], t_max: i32, recips: &[u16; 128]) -> u64 {
    naked_asm!(
        "push {{r4, r5, r6, r7, lr}}",
        "ldmia r0!, {{r4, r5, r6}}",
        "cmp r4, #0",
        "beq 21f",
        "orrs r5, r6",
        "beq 20f",
        "b 30f",
        "21:",
        "cmp r6, #0",
        "beq 23f",
        "cmp r5, #0",
        "beq 22f",
        "b 30f",
        "20:",
        upright!("r4", "0"),
        "b 40f",
        "22:",
        upright!("r6", "8"),
        "b 40f",
        // From below: a height of 16 bits, a slope under 2^9, one of 2^24 or more.
        "45:",
        "lsrs r2, r7",
        "b 46f",
        "41:",
        "b 70f",
        "47:",
        "lsrs r6, r6, #1",
        "movs r4, #1",
        "lsls r4, r4, #31",
        "orrs r6, r4",
        "movs r7, #15",
        "b 43f",
        "23:",
        upright!("r5", "4"),
        // Clearly beyond the limit, or beyond 2^29. What is below that stays there: it comes out 1.2e-9 too large at most.
        "40:",
        "asrs r4, r2, #9",
        "adds r4, #1",
        "lsrs r7, r6, #16",
        "adds r7, #1",
        "muls r7, r4, r7",
        "lsrs r4, r5, #1",
        "cmp r4, r7",
        "bgt 7b",
        "lsrs r7, r5, #5",
        "cmp r7, r6",
        "bhs 7b",
        "mov r12, r2",
        // Up to the top bit; r7 is 22 less the zeros there were.
        "movs r7, #14",
        "lsls r6, r6, #8",
        "bcs 47b",
        "bmi 43f",
        "subs r7, #1",
        "lsls r6, r6, #1",
        "bmi 43f",
        "subs r7, #1",
        "lsls r6, r6, #1",
        "bmi 43f",
        "42:",
        "subs r7, #1",
        "bmi 41b",
        "lsls r6, r6, #1",
        "bpl 42b",
        "43:",
        recip!(),
        // The product with the height, 16 bits less.
        "uxth r3, r4",
        "lsrs r4, r4, #16",
        "uxth r2, r5",
        "movs r6, r2",
        "muls r6, r3, r6",
        "lsrs r6, r6, #16",
        "muls r2, r4, r2",
        "adds r2, r2, r6",
        "lsrs r5, r5, #16",
        "beq 45b",
        "muls r3, r5, r3",
        "adds r2, r2, r3",
        "lsrs r2, r7",
        "muls r4, r5, r4",
        "movs r6, #16",
        "subs r6, r6, r7",
        "lsls r4, r6",
        "adds r2, r2, r4",
        "46:",
        "cmp r2, r12",
        "bge 7b",
        "mov r12, r2",
        "lsrs r3, r2, #16",
        "uxth r4, r2",
        side!("12", "24", "50", "51", "52"),
        side!("0", "16", "60", "61", "62"),
        // Not at a distance of 0.
        "mov r1, r12",
        "subs r0, r1, #1",
        "movs r0, #0",
        "adcs r0, r0",
        "pop {{r4, r5, r6, r7, pc}}",
        turned!("24", "50", "51", "52"),
        turned!("12", "60", "61", "62"),
        // Of any normal; its first component is r4, or 0.
        "30:",
        "mov r12, r2",
        "mov lr, r3",
        "subs r0, #12",
        "movs r5, #0",
        "cmp r4, #0",
        "beq 32f",
        "ldr r6, [r1, #12]",
        "uxtb r3, r6",
        "muls r3, r4, r3",
        "asrs r6, r6, #8",
        "muls r6, r4, r6",
        "ldr r2, [r1]",
        "ldr r7, [r0, #36]",
        "subs r2, r2, r7",
        product!("r2", "r4", "r7", "r5"),
        "movs r4, r3",
        "33:",
        part!("4"),
        part!("8"),
        "asrs r4, r4, #8",
        "adds r6, r6, r4",
        "adds r0, #12",
        "mov r2, r12",
        "mov r3, lr",
        "cmp r5, #0",
        "bmi 31f",
        "rsbs r6, r6, #0",
        "ble 7f",
        "b 40b",
        "31:",
        "rsbs r5, r5, #0",
        "cmp r6, #0",
        "ble 7f",
        "b 40b",
        "32:",
        "movs r6, #0",
        "b 33b",
        // Hardly any slope: of the height there are less than 14 bits.
        "70:",
        "lsls r6, r6, #1",
        "beq 7f",
        "bmi 71f",
        "subs r7, #1",
        "b 70b",
        "7:",
        "movs r0, #0",
        "pop {{r4, r5, r6, r7, pc}}",
        "71:",
        recip!(),
        "uxth r3, r4",
        "lsrs r4, r4, #16",
        "muls r3, r5, r3",
        "muls r4, r5, r4",
        "rsbs r6, r7, #0",
        "lsls r4, r6",
        "adds r7, #16",
        "lsrs r3, r7",
        "adds r2, r3, r4",
        "b 46b",
    )
}
