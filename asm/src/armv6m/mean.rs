use core::arch::{asm, naked_asm};
use core::mem::offset_of;

use super::gather::Light;

/// What [`mean`] looks up.
#[repr(C)]
pub struct Tables {
    /// Those above a byte's highest bit.
    pub zeros: &'static [u8; 256],
    /// First guesses 2^47/n by n's seven bits below the top one.
    pub recips: &'static [u16; 128],
}

const _: () = assert!(offset_of!(Tables, recips) == 4);

/// A centre plus the mean of differences from it, from weights that add up to `weight`, under 2^15 and not 0, and lights by weight:
/// the bits of the core's portable twin.
#[inline(always)]
pub fn mean(weight: u32, [r, g, b]: [u32; 3], centre: &Light, tables: &'static Tables) -> Light {
    let (x, y, z): (u32, u32, u32);
    // SAFETY: the tables are asked for a byte and for seven bits, whatever the numbers are. `divide` gives back r6 and r7.
    unsafe {
        asm!(
            "bl {divide}",
            divide = sym divide,
            inout("r0") weight => x,
            inout("r1") r => y,
            inout("r2") g => z,
            inout("r3") b => _,
            inout("r4") centre => _,
            inout("r5") tables => _,
            lateout("r8") _,
            lateout("r9") _,
            lateout("r10") _,
            lateout("r11") _,
            lateout("r12") _,
            lateout("lr") _,
            options(pure, readonly),
        );
    }
    [x, y, z].map(|light| light as u16)
}

/// Of a channel whose sum is r1: its light in r5. The places are those of [`rare`], and where it goes on from there.
#[rustfmt::skip]
macro_rules! channel {
    ($at:literal, $large:literal, $small:literal, $found:literal, $done:literal) => {
        concat!(
            "ldrh r5, [r4, #", $at, "]; movs r6, r5; muls r6, r0, r6; subs r1, r1, r6; beq ", $done, "f;",
            "asrs r7, r1, #31; eors r1, r7; subs r1, r1, r7;",
            // Zeros above it.
            "lsrs r6, r1, #16; bne ", $large, "f; lsrs r6, r1, #8; beq ", $small, "f;",
            "ldrb r6, [r2, r6]; adds r6, #16;",
            $found, ": lsls r1, r6; lsrs r1, r1, #16; muls r1, r3, r1;",
            "add r6, r12; lsrs r1, r6; adds r1, #1; lsrs r1, r1, #1;",
            // No more than the largest difference: the light is of 16 bits.
            "eors r1, r7; subs r1, r1, r7; adds r5, r5, r1;",
            $done, ":",
        )
    };
}

/// What is rare in a channel.
#[rustfmt::skip]
macro_rules! rare {
    ($large:literal, $small:literal, $found:literal) => {
        concat!(
            $large, ": lsrs r6, r1, #24; bne 1f; lsrs r6, r1, #16; ldrb r6, [r2, r6]; adds r6, #8; b ", $found, "b;",
            "1: ldrb r6, [r2, r6]; b ", $found, "b;",
            $small, ": ldrb r6, [r2, r1]; adds r6, #24; b ", $found, "b;",
        )
    };
}

/// r0: weight. r1, r2, r3: sums. r4: centre. r5: tables. Light in r0 to r2; r3 to r5, r8 to r12 and lr are not kept.
///
/// Cycles: 136; 13 less of a channel that is the centre's.
///
/// # Safety
///
/// r4 and r5 point to what they say.
#[unsafe(naked)]
unsafe extern "C" fn divide() {
    naked_asm!(
        "push {{r6, r7, lr}}",
        "mov r8, r2",
        "mov r9, r3",
        "ldmia r5!, {{r2, r3}}",
        // Zeros above the weight, and 30 less those.
        "uxth r0, r0",
        "lsrs r5, r0, #8",
        "beq 10f",
        "ldrb r5, [r2, r5]",
        "adds r5, #16",
        "11:",
        "movs r7, #30",
        "subs r7, r7, r5",
        "mov r12, r7",
        // 2^31 over its upper 16 bits, in 16 bits: a guess and a step.
        "movs r6, r0",
        "lsls r6, r5",
        "lsrs r6, r6, #16",
        "lsls r5, r6, #17",
        "lsrs r5, r5, #25",
        "lsls r5, r5, #1",
        "ldrh r3, [r3, r5]",
        "muls r6, r3, r6",
        "rsbs r6, r6, #0",
        "lsls r6, r6, #1",
        "asrs r6, r6, #10",
        "muls r6, r3, r6",
        "asrs r6, r6, #22",
        "adds r3, r3, r6",
        "lsrs r6, r3, #16",
        "subs r3, r3, r6",
        channel!(0, "20", "21", "22", "23"),
        "mov r10, r5",
        "mov r1, r8",
        channel!(2, "30", "31", "32", "33"),
        "mov r11, r5",
        "mov r1, r9",
        channel!(4, "40", "41", "42", "43"),
        "mov r2, r5",
        "mov r1, r11",
        "mov r0, r10",
        "pop {{r6, r7, pc}}",
        "10:",
        "ldrb r5, [r2, r0]",
        "adds r5, #24",
        "b 11b",
        rare!("20", "21", "22"),
        rare!("30", "31", "32"),
        rare!("40", "41", "42"),
    )
}
