use core::arch::{asm, naked_asm};
use core::marker::PhantomData;
use core::mem::offset_of;

use super::gather::{Head, Light, is_aligned, own, square};

/// What `table` says of a pixel and the one to its right; of it and those below to the left, below, and to the right.
pub type Kin = [u8; 4];

/// Each pixel of a row and those beside and below it: `table` by half the squared distance of both heads' first six bytes
/// (signed), its last entry of all that is larger. What is beyond an edge is left as it was.
///
/// Heads that are no whole words, and rows of unequal length, are left, too.
pub fn kins(row: &[Head], below: &[Head], table: &[u8; 256], out: &mut [Kin]) {
    if row.len() != below.len() || row.len() != out.len() || row.is_empty() {
        return;
    }
    if !is_aligned(row) || !is_aligned(below) {
        return;
    }
    let range = row.as_ptr_range();
    // SAFETY: all three rows are as long, heads are whole words, and an index into `table` is under 256. `fill` gives back r6
    // and r7.
    unsafe {
        asm!(
            "bl {fill}",
            fill = sym fill,
            inout("r0") range.start => _,
            inout("r1") range.end => _,
            inout("r2") below.as_ptr() => _,
            inout("r3") table => _,
            inout("r4") out.as_mut_ptr() => _,
            lateout("r5") _,
            lateout("r8") _,
            lateout("r9") _,
            lateout("r10") _,
            lateout("r11") _,
            lateout("r12") _,
            lateout("lr") _,
        );
    }
}

/// Three rows of pixels; in the order in which [`add`] reads it.
#[repr(C)]
pub struct Nine<'a> {
    heads: [*const Head; 3],
    lights: [*const Light; 3],
    kins: [*const Kin; 2],
    /// Pixels that have all of their neighbours.
    inner: usize,
    rows: PhantomData<&'a [Head]>,
}

const _: () = assert!(offset_of!(Nine, lights) == 12 && offset_of!(Nine, kins) == 24);

impl<'a> Nine<'a> {
    /// Of rows of pixels, with what [`kins`] says of the first and the second.
    pub fn new(heads: [&'a [Head]; 3], lights: [&'a [Light]; 3], kins: [&'a [Kin]; 2]) -> Nine<'a> {
        let width = heads[1].len();
        let is_whole = heads.iter().all(|row| row.len() == width && is_aligned(row))
            && lights.iter().all(|row| row.len() == width)
            && kins.iter().all(|row| row.len() == width);
        Nine {
            heads: heads.map(<[Head]>::as_ptr),
            lights: lights.map(<[Light]>::as_ptr),
            kins: kins.map(<[Kin]>::as_ptr),
            inner: if is_whole { width.saturating_sub(2) } else { 0 },
            rows: PhantomData,
        }
    }

    /// Weights of the pixels about number `x` of the middle row and their lights by weight, added up modulo 2^32; `None` at an
    /// edge.
    ///
    /// A weight is (confidence + 1) / 64 times what the table says, 255 of the pixel itself. Of the nine, row by row, those in
    /// whose place `others` has a bit count a quarter, rounded down.
    #[inline(always)]
    pub fn gather(&self, x: usize, others: u32) -> Option<[u32; 4]> {
        let left = x.wrapping_sub(1);
        if left >= self.inner {
            return None;
        }
        let (weight, r, g, b);
        // SAFETY: each row has pixels number x − 1 to x + 1. `add` gives back r6 and r7.
        unsafe {
            asm!(
                "bl {add}",
                add = sym add,
                inout("r0") self => weight,
                inout("r1") left => r,
                inout("r2") others => g,
                lateout("r3") b,
                lateout("r4") _,
                lateout("r5") _,
                lateout("r8") _,
                lateout("r9") _,
                lateout("r10") _,
                lateout("r11") _,
                lateout("r12") _,
                lateout("lr") _,
                options(pure, readonly),
            );
        }
        Some([weight, r, g, b])
    }
}

/// The affinity of the head in r0 and r1 to byte `$at` from r7.
#[rustfmt::skip]
macro_rules! affinity {
    ($at:literal) => {
        concat!(
            "asrs r2, r0, #24; add r2, r11; muls r2, r2, r2;",
            square!("sxtb r3, r0", "r8"),
            square!("lsls r3, r0, #16; asrs r3, r3, #24", "r9"),
            square!("lsls r3, r0, #8; asrs r3, r3, #24", "r10"),
            square!("sxtb r3, r1", "r12"),
            square!("lsls r3, r1, #16; asrs r3, r3, #24", "lr"),
            "lsrs r3, r2, #9; beq 1f; movs r2, #255; lsls r2, r2, #1;",
            "1: lsrs r2, r2, #1; ldrb r2, [r6, r2]; strb r2, [r7, #", $at, "];",
        )
    };
}

/// r0, r1: a row's first head and behind its last. r2: the first of the row below. r3: table. r4: the first answer. These, r5, r8
/// to r12 and lr are not kept.
///
/// Cycles of a pixel: 190.
///
/// # Safety
///
/// All point to what they say, both rows and the answers are as long, and heads are whole words.
#[unsafe(naked)]
unsafe extern "C" fn fill() {
    naked_asm!(
        "push {{r6, r7, lr}}",
        "push {{r1, r4}}",
        "mov r7, r4",
        "mov r6, r3",
        "mov r4, r0",
        // One to the left.
        "mov r5, r2",
        "subs r5, #8",
        "20:",
        "ldmia r4!, {{r0, r1}}",
        own!(),
        "ldr r3, [sp, #4]",
        "cmp r7, r3",
        "beq 21f",
        "ldr r0, [r5]",
        "ldr r1, [r5, #4]",
        affinity!(1),
        "21:",
        "ldr r0, [r5, #8]",
        "ldr r1, [r5, #12]",
        affinity!(2),
        "ldr r3, [sp]",
        "cmp r4, r3",
        "beq 29f",
        "ldr r0, [r4]",
        "ldr r1, [r4, #4]",
        affinity!(0),
        "ldr r0, [r5, #16]",
        "ldr r1, [r5, #20]",
        affinity!(3),
        "adds r5, #8",
        "adds r7, #4",
        "b 20b",
        "29:",
        "add sp, #8",
        "pop {{r6, r7, pc}}",
    )
}

/// The weight of a pixel in r5: of affinity r5, whose confidence is `$head` bytes from r3. A quarter of it if the next of r12's
/// bits is set, where `$kind` is `other`.
#[rustfmt::skip]
macro_rules! weight {
    (plain, $head:literal) => {
        concat!("ldrb r6, [r3, #", $head, "]; muls r6, r5, r6; adds r5, r5, r6; lsrs r5, r5, #6;")
    };
    (other, $head:literal) => {
        concat!(
            weight!(plain, $head),
            "mov r6, r12; lsrs r6, r6, #1; mov r12, r6; bcc 1f; lsrs r5, r5, #2; 1:",
        )
    };
}

/// A pixel whose affinity is in r5; its light is `$light` bytes from r4. Sums: r8 to r11.
#[rustfmt::skip]
macro_rules! pixel {
    ($kind:ident, $head:literal, $light:literal) => {
        concat!(
            weight!($kind, $head),
            "add r8, r5;",
            "ldrh r6, [r4, #", $light, "]; muls r6, r5, r6; add r9, r6;",
            "ldrh r6, [r4, #", $light, " + 2]; muls r6, r5, r6; add r10, r6;",
            "ldrh r6, [r4, #", $light, " + 4]; muls r6, r5, r6; add r11, r6;",
        )
    };
}

/// The three pixels of the row whose heads and lights stand `$at` bytes from r0, behind the first; their affinities by three
/// instructions into r5.
#[rustfmt::skip]
macro_rules! row {
    ($kind:ident, $at:literal, $one:literal, $two:literal, $three:literal) => {
        concat!(
            "ldr r3, [r0, #", $at, "]; adds r3, r3, r1; ldr r4, [r0, #12 + ", $at, "]; adds r4, r4, r2;",
            $one, ";", pixel!($kind, 6, 0),
            $two, ";", pixel!($kind, 14, 6),
            $three, ";", pixel!($kind, 22, 12),
        )
    };
}

#[rustfmt::skip]
macro_rules! rows {
    ($kind:ident) => {
        concat!(
            row!($kind, 0, "ldrb r5, [r7, #3]", "ldrb r5, [r7, #6]", "ldrb r5, [r7, #9]"),
            "ldr r7, [r0, #28]; lsrs r3, r1, #1; adds r7, r7, r3;",
            row!($kind, 4, "ldrb r5, [r7]", "movs r5, #255", "ldrb r5, [r7, #4]"),
            row!($kind, 8, "ldrb r5, [r7, #5]", "ldrb r5, [r7, #6]", "ldrb r5, [r7, #7]"),
        )
    };
}

/// r0: rows. r1: the number of the leftmost pixel. r2: whose weight is a quarter. Sums in r0 to r3; r4, r5, r8 to r12 and lr are
/// not kept.
///
/// Cycles: 240, and 50 where one's weight is a quarter.
///
/// # Safety
///
/// r0 points to rows, which have so many pixels and three more.
#[unsafe(naked)]
unsafe extern "C" fn add() {
    naked_asm!(
        "push {{r6, r7, lr}}",
        "mov r12, r2",
        // Bytes before the first: of affinities, lights, heads.
        "movs r3, #0",
        "mov r8, r3",
        "mov r9, r3",
        "mov r10, r3",
        "mov r11, r3",
        "lsls r3, r1, #2",
        "ldr r7, [r0, #24]",
        "adds r7, r7, r3",
        "lsls r2, r1, #1",
        "adds r2, r2, r3",
        "lsls r1, r1, #3",
        "mov r3, r12",
        "cmp r3, #0",
        "beq 20f",
        "b 30f",
        "20:",
        rows!(plain),
        "29:",
        "mov r0, r8",
        "mov r1, r9",
        "mov r2, r10",
        "mov r3, r11",
        "pop {{r6, r7, pc}}",
        "30:",
        rows!(other),
        "b 29b",
    )
}
