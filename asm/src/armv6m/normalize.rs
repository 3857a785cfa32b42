use core::arch::{asm, naked_asm};

/// What [`normalize`] finds out about a vector.
pub struct Normal {
    /// Of length 1, Q16.
    pub dir: [i32; 3],
    /// Squared length of the vector shifted right by [`Normal::shift`].
    pub square: u32,
    /// 1/√square = mantissa · 2^([`Normal::half`] − 47).
    pub mantissa: u32,
    /// In the upper bytes how far it was shifted left, to 30 bits; in the lowest 15, less one where the square has under 31.
    shifts: i32,
}

impl Normal {
    #[inline(always)]
    pub fn shift(&self) -> i32 {
        15 - (self.shifts >> 8)
    }

    #[inline(always)]
    pub fn half(&self) -> u32 {
        15 - (self.shifts & 255) as u32
    }
}

/// Direction and length; `None` for nothing. `zeros` are those above a byte's highest bit, `roots` first guesses 2^31/√n by
/// n's top byte.
///
/// In registers both ways: a caller takes what it wants, and what it does not costs nothing.
#[inline(always)]
pub fn normalize(v: [i32; 3], zeros: &[u8; 256], roots: &[u16; 256]) -> Option<Normal> {
    let [mut x, mut y, mut z] = v;
    let (square, mantissa, shifts);
    // SAFETY: `unit` reads the two tables by a byte each and writes to its own stack alone; it gives back r6, r7 and the upper
    // registers but r12 and lr.
    unsafe {
        asm!(
            "bl {unit}",
            unit = sym unit,
            inout("r0") x,
            inout("r1") y,
            inout("r2") z,
            inout("r3") zeros.as_ptr() => square,
            inout("r4") roots.as_ptr() => mantissa,
            lateout("r5") shifts,
            lateout("r12") _,
            lateout("lr") _,
            options(pure, readonly),
        );
    }
    let normal = Normal {
        dir: [x, y, z],
        square,
        mantissa,
        shifts,
    };
    (square != 0).then_some(normal)
}

/// `$c` of 30 bits and a sign times half the mantissa over 2^30, rounded down.
///
/// `$c` is r6·2^15 and a rest of 14 bits and a sign, half the mantissa r3·2^15 + r4: every product is under 2^31, and so is
/// the sum of the three lower ones.
#[rustfmt::skip]
macro_rules! scaled {
    ($c:literal) => {
        concat!(
            "asrs r6, ", $c, ", #15; adcs r6, r7; lsls ", $c, ", ", $c, ", #17; asrs ", $c, ", ", $c, ", #17;",
            "movs r5, ", $c, "; muls r5, r4, r5; asrs r5, r5, #15; muls ", $c, ", r3, ", $c, "; adds ", $c, ", ", $c, ", r5;",
            "movs r5, r6; muls r5, r4, r5; adds ", $c, ", ", $c, ", r5; asrs ", $c, ", ", $c, ", #15;",
            "muls r6, r3, r6; adds ", $c, ", ", $c, ", r6;",
        )
    };
}

/// r0, r1, r2: a vector, then its direction. r3: zeros above a byte, then the square, 0 for nothing. r4: guesses of roots,
/// then the mantissa. r5: the shifts. r12 and lr are not kept.
///
/// Cycles: 149 of vectors from 2^16 to 2^24, 3 to 9 more of others; 13 to call it and to ask whether there is any.
///
/// # Safety
///
/// The tables have 256 entries.
#[unsafe(naked)]
unsafe extern "C" fn unit() {
    naked_asm!(
        "push {{r4, r6, r7, lr}}",
        // All the bits there are.
        "asrs r5, r0, #31",
        "eors r5, r0",
        "asrs r6, r1, #31",
        "eors r6, r1",
        "orrs r5, r6",
        "asrs r6, r2, #31",
        "eors r6, r2",
        "orrs r5, r6",
        // The largest component of 30.
        "lsrs r6, r5, #16",
        "beq 21f",
        "lsrs r7, r6, #8",
        "bne 20f",
        "ldrb r6, [r3, r6]",
        "adds r6, #6",
        "2:",
        "lsls r0, r6",
        "lsls r1, r6",
        "lsls r2, r6",
        "3:",
        // The square of 15 of them, rounded by the carry.
        "movs r7, #0",
        "asrs r3, r0, #15",
        "adcs r3, r7",
        "muls r3, r3, r3",
        "asrs r5, r1, #15",
        "adcs r5, r7",
        "muls r5, r5, r5",
        "adds r3, r3, r5",
        "asrs r5, r2, #15",
        "adcs r5, r7",
        "muls r5, r5, r5",
        "adds r3, r3, r5",
        "mov r12, r3",
        "lsls r6, r6, #8",
        "adds r6, #15",
        "lsrs r5, r3, #30",
        "bne 4f",
        "lsls r3, r3, #2",
        "subs r6, #1",
        "4:",
        "mov lr, r6",
        // 1/√n: a guess, a Newton step in 16 bits: r4.
        "lsrs r5, r3, #24",
        "lsls r5, r5, #1",
        "ldrh r4, [r4, r5]",
        "movs r5, r4",
        "muls r5, r5, r5",
        "lsrs r5, r5, #16",
        "lsrs r6, r3, #16",
        "muls r5, r6, r5",
        "ldr r7, 29f",
        "subs r7, r7, r5",
        "lsrs r7, r7, #16",
        "muls r4, r7, r4",
        "lsrs r4, r4, #15",
        // n r² / 2^32, by n r = r6·2^16 + r3.
        "muls r6, r4, r6",
        "uxth r3, r3",
        "muls r3, r4, r3",
        "lsrs r5, r3, #16",
        "adds r6, r6, r5",
        "uxth r3, r3",
        "muls r3, r4, r3",
        "lsrs r3, r3, #16",
        "uxth r5, r6",
        "muls r5, r4, r5",
        "adds r5, r5, r3",
        "lsrs r5, r5, #16",
        "lsrs r6, r6, #16",
        "muls r6, r4, r6",
        "adds r6, r6, r5",
        // A step in 32, which some squares from 2^30 − 9 on would take under 2^31.
        "movs r5, #1",
        "lsls r5, r5, #30",
        "subs r5, r5, r6",
        "lsrs r6, r4, #2",
        "muls r5, r6, r5",
        "asrs r5, r5, #13",
        "lsls r4, r4, #16",
        "adds r4, r4, r5",
        "bpl 25f",
        "5:",
        "str r4, [sp]",
        // The direction, rounded by the carry once more.
        "lsrs r3, r4, #16",
        "uxth r4, r4",
        "lsrs r4, r4, #1",
        "movs r7, #0",
        scaled!("r0"),
        scaled!("r1"),
        scaled!("r2"),
        "mov r5, lr",
        "asrs r0, r5",
        "adcs r0, r7",
        "asrs r1, r5",
        "adcs r1, r7",
        "asrs r2, r5",
        "adcs r2, r7",
        "mov r3, r12",
        "26:",
        "pop {{r4, r6, r7, pc}}",
        "20:",
        "ldrb r6, [r3, r7]",
        "subs r6, #2",
        "bmi 22f",
        "b 2b",
        "21:",
        "lsrs r6, r5, #8",
        "beq 23f",
        "ldrb r6, [r3, r6]",
        "adds r6, #14",
        "b 2b",
        "22:",
        "asrs r0, r0, #1",
        "asrs r1, r1, #1",
        "asrs r2, r2, #1",
        "b 3b",
        "23:",
        "ldrb r6, [r3, r5]",
        "adds r6, #22",
        "cmp r5, #0",
        "beq 24f",
        "b 2b",
        // Of 0 and −1 alone.
        "24:",
        "subs r6, #1",
        "movs r3, r0",
        "orrs r3, r1",
        "orrs r3, r2",
        "beq 26b",
        "b 2b",
        "25:",
        "movs r4, #1",
        "lsls r4, r4, #31",
        "b 5b",
        // 3·2^30, and what rounds down to 2^14 the product that is taken off it.
        ".balign 4",
        "29:",
        ".word (3 << 30) + (1 << 14) - 1",
    )
}
