use core::arch::{asm, naked_asm};
use core::mem::offset_of;
use core::ops::Range;

pub(super) type Head = [u8; 8];
pub(super) type Light = [u16; 3];

type Slices<'a, T, const ROWS: usize> = [&'a [T]; ROWS];

/// The most rows that there may be, and pixels of each that are asked for.
const MOST: usize = 5;

/// A row of pixels; in the order in which [`add`] reads it.
#[repr(C)]
#[derive(Clone, Copy)]
struct Row {
    heads: *const Head,
    lights: *const Light,
}

const _: () = assert!(offset_of!(Row, lights) == 4 && size_of::<Row>() == 8);

/// Rows about one of pixels, which is the middle one.
pub struct Rows<'a, const ROWS: usize> {
    /// Those that there are.
    rows: [Row; ROWS],
    count: usize,
    /// Of the middle one.
    own: *const Head,
    width: usize,
    /// For heads that are not whole words.
    plain: Option<(Slices<'a, Head, ROWS>, Slices<'a, Light, ROWS>)>,
}

impl<'a, const ROWS: usize> Rows<'a, ROWS> {
    /// What is shorter than the middle row counts for nothing; five rows at most, and an odd number.
    pub fn new(heads: [&'a [Head]; ROWS], lights: [&'a [Light]; ROWS]) -> Rows<'a, ROWS> {
        const { assert!(ROWS <= MOST && ROWS % 2 == 1) };
        let width = heads[ROWS / 2].len().min(lights[ROWS / 2].len());
        let mut rows = [Row {
            heads: heads[ROWS / 2].as_ptr(),
            lights: lights[ROWS / 2].as_ptr(),
        }; ROWS];
        let (mut count, mut is_plain) = (0, false);
        for (heads, lights) in heads.iter().zip(lights) {
            if heads.len() >= width && lights.len() >= width {
                is_plain |= !is_aligned(heads);
                rows[count] = Row {
                    heads: heads.as_ptr(),
                    lights: lights.as_ptr(),
                };
                count += 1;
            }
        }
        Rows {
            rows,
            count,
            own: heads[ROWS / 2].as_ptr(),
            width,
            plain: is_plain.then_some((heads, lights)),
        }
    }

    /// Weights of pixels about number `x` of the middle row, `ROWS` a row where there are as many, and their lights by weight,
    /// added up modulo 2^32.
    ///
    /// A weight is (confidence + 1) / 64 times what `table` says of half the squared distance of both heads' first six bytes
    /// (signed), nothing from 256 on, as if its last entry were 0; confidence is the seventh byte.
    #[inline(always)]
    pub fn gather(&self, x: usize, table: &[u8; 256]) -> [u32; 4] {
        if x >= self.width {
            return [0; 4];
        }
        let (first, end) = (x.saturating_sub(ROWS / 2), (x + ROWS / 2 + 1).min(self.width));
        if let Some((heads, lights)) = &self.plain {
            return plain(&heads[ROWS / 2][x], heads, lights, first..end, table);
        }
        let (weight, r, g, b);
        // SAFETY: `count` rows, five at most, have pixels number `first` to `end`, five at most, and the middle one has number x;
        // heads are whole words, an index into `table` is under 256. `add` gives back r6 and r7.
        unsafe {
            asm!(
                "bl {add}",
                add = sym add,
                inout("r0") self.rows.as_ptr() => weight,
                inout("r1") self.rows.as_ptr().add(self.count) => r,
                inout("r2") self.own.add(x) => g,
                inout("r3") table => b,
                inout("r4") first => _,
                inout("r5") end - first => _,
                lateout("r8") _,
                lateout("r9") _,
                lateout("r10") _,
                lateout("r11") _,
                lateout("r12") _,
                lateout("lr") _,
                options(pure, readonly),
            );
        }
        [weight, r, g, b]
    }
}

/// Whether heads are whole words.
#[inline(always)]
pub(super) fn is_aligned(heads: &[Head]) -> bool {
    heads.as_ptr().addr().is_multiple_of(4)
}

/// What [`Rows::gather`] does, for heads that are not whole words.
#[cold]
fn plain(
    own: &Head,
    heads: &[&[Head]],
    lights: &[&[Light]],
    columns: Range<usize>,
    table: &[u8; 256],
) -> [u32; 4] {
    let mut sums = [0u32; 4];
    for (heads, lights) in heads.iter().zip(lights) {
        let (heads, lights) = (heads.get(columns.clone()), lights.get(columns.clone()));
        for (head, light) in heads.into_iter().flatten().zip(lights.into_iter().flatten()) {
            let apart = |i: usize| i32::from(own[i] as i8) - i32::from(head[i] as i8);
            let square: i32 = (0..6).map(|i| apart(i) * apart(i)).sum();
            let affinity = u32::from(table[(square / 2).min(255) as usize]);
            let weight = (affinity * (u32::from(head[6]) + 1)) >> 6;
            let [r, g, b] = light.map(|light| u32::from(light) * weight);
            for (sum, part) in sums.iter_mut().zip([weight, r, g, b]) {
                *sum = sum.wrapping_add(part);
            }
        }
    }
    sums
}

/// A byte that `$extract` puts into r3, less what `$own` has negated: its square onto r2.
#[rustfmt::skip]
macro_rules! square {
    ($extract:literal, $own:literal) => {
        concat!($extract, "; add r3, ", $own, "; muls r3, r3, r3; adds r2, r2, r3;")
    };
}
pub(super) use square;

/// The first six bytes of the head in r0 and r1, negated, to r8 to r12 and lr; by r2.
#[rustfmt::skip]
macro_rules! own {
    () => {
        concat!(
            "sxtb r2, r0; rsbs r2, r2, #0; mov r8, r2;",
            "lsls r2, r0, #16; asrs r2, r2, #24; rsbs r2, r2, #0; mov r9, r2;",
            "lsls r2, r0, #8; asrs r2, r2, #24; rsbs r2, r2, #0; mov r10, r2;",
            "asrs r2, r0, #24; rsbs r2, r2, #0; mov r11, r2;",
            "sxtb r2, r1; rsbs r2, r2, #0; mov r12, r2;",
            "lsls r2, r1, #16; asrs r2, r2, #24; rsbs r2, r2, #0; mov lr, r2;",
        )
    };
}
pub(super) use own;

/// The weight of the head at r4 to r7; both move on.
#[rustfmt::skip]
macro_rules! weight {
    () => {
        concat!(
            "ldmia r4!, {{r0, r1}};",
            "asrs r2, r0, #24; add r2, r11; muls r2, r2, r2;",
            square!("sxtb r3, r0", "r8"),
            "lsrs r3, r2, #9; bne 1f;",
            square!("lsls r3, r0, #16; asrs r3, r3, #24", "r9"),
            square!("lsls r3, r0, #8; asrs r3, r3, #24", "r10"),
            square!("sxtb r3, r1", "r12"),
            square!("lsls r3, r1, #16; asrs r3, r3, #24", "lr"),
            "lsrs r3, r2, #9; beq 2f;",
            "1: movs r2, #0; b 3f;",
            "2: lsrs r2, r2, #1; ldrb r2, [r6, r2];",
            "lsls r1, r1, #8; lsrs r1, r1, #24; muls r1, r2, r1; adds r2, r2, r1; lsrs r2, r2, #6;",
            "3: stmia r7!, {{r2}};",
        )
    };
}

/// The light `$at` bytes from r4 by the weight at r7, which moves on.
#[rustfmt::skip]
macro_rules! light {
    ($at:literal) => {
        concat!(
            "ldmia r7!, {{r5}}; cmp r5, #0; beq 1f; adds r0, r0, r5;",
            "ldrh r6, [r4, #", $at, "]; muls r6, r5, r6; adds r1, r1, r6;",
            "ldrh r6, [r4, #", $at, " + 2]; muls r6, r5, r6; adds r2, r2, r6;",
            "ldrh r6, [r4, #", $at, " + 4]; muls r6, r5, r6; adds r3, r3, r6;",
            "1:",
        )
    };
}

/// r0, r1: the first row and behind the last, then two of the sums. r2: own head, and r3: table, then the others. r4: the number
/// of the first pixel of a row, r5: how many. These, r8 to r12 and lr are not kept.
///
/// All weights are made before the first light is looked at: own bytes and sums are ten registers. Cycles of a pixel: 58; 22 where
/// two bytes of it say enough.
///
/// # Safety
///
/// All point to what they say; rows and pixels of each are five at most, and one at least.
#[unsafe(naked)]
unsafe extern "C" fn add() {
    naked_asm!(
        "push {{r0, r1, r6, r7, lr}}",
        "lsls r5, r5, #3",
        "push {{r0, r4, r5}}",
        "sub sp, #100",
        "mov r6, r3",
        "ldmia r2!, {{r0, r1}}",
        own!(),
        "mov r7, sp",
        // A row's weights, from r7 on.
        "ldr r0, [sp, #100]",
        "20:",
        "ldr r4, [r0]",
        "adds r0, #8",
        "str r0, [sp, #100]",
        "ldr r5, [sp, #104]",
        "lsls r5, r5, #3",
        "adds r4, r4, r5",
        "ldr r5, [sp, #108]",
        "cmp r5, #40",
        "bne 21f",
        "b 50f",
        "21:",
        "adds r5, r5, r4",
        "22:",
        weight!(),
        "cmp r4, r5",
        "bne 22b",
        "26:",
        "ldr r0, [sp, #100]",
        "ldr r1, [sp, #116]",
        "cmp r0, r1",
        "bne 20b",
        "b 30f",
        // Their lights; r8 to r9 are the rows, r10 is the end of one's weights.
        "30:",
        "mov r9, r1",
        "ldr r4, [sp, #112]",
        "mov r8, r4",
        "mov r7, sp",
        "movs r0, #0",
        "movs r1, #0",
        "movs r2, #0",
        "movs r3, #0",
        "31:",
        "mov r6, r8",
        "ldr r4, [r6, #4]",
        "adds r6, #8",
        "mov r8, r6",
        "ldr r5, [sp, #104]",
        "lsls r6, r5, #2",
        "lsls r5, r5, #1",
        "adds r4, r4, r6",
        "adds r4, r4, r5",
        "ldr r5, [sp, #108]",
        "cmp r5, #40",
        "bne 33f",
        "b 60f",
        "33:",
        "lsrs r5, r5, #1",
        "adds r5, r5, r7",
        "mov r10, r5",
        "32:",
        light!(0),
        "adds r4, #6",
        "cmp r7, r10",
        "bne 32b",
        "36:",
        "cmp r8, r9",
        "bne 31b",
        "add sp, #120",
        "pop {{r6, r7, pc}}",
        // Whole rows.
        "50:",
        weight!(),
        weight!(),
        weight!(),
        weight!(),
        weight!(),
        "b 26b",
        "60:",
        light!(0),
        light!(6),
        light!(12),
        light!(18),
        light!(24),
        "b 36b",
    )
}
