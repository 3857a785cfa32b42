use core::arch::{asm, naked_asm};
use core::mem::offset_of;
use core::slice;

pub(super) type Head = [u8; 8];
pub(super) type Light = [u16; 3];

/// Pixels that a run may have.
const MOST: usize = 5;

/// Pixels side by side.
#[repr(C)]
struct Run {
    heads: *const Head,
    end: *const Head,
    lights: *const Light,
}

const _: () = assert!(offset_of!(Run, end) == 4 && offset_of!(Run, lights) == 8 && size_of::<Run>() == 12);

/// Weights of pixels in runs, and their lights by weight, added up modulo 2^32; five runs at most, and five pixels of each.
///
/// A weight is (confidence + 1) / 64 times what `table` says of half the squared distance of both heads' first six bytes
/// (signed), nothing from 256 on, as if its last entry were 0; confidence is the seventh byte.
#[inline(always)]
pub fn gather<const RUNS: usize>(
    own: &Head,
    runs: [(&[Head], &[Light]); RUNS],
    table: &[u8; 256],
) -> [u32; 4] {
    const { assert!(RUNS <= MOST) };
    if !runs.iter().all(|(heads, _)| is_aligned(heads)) || !is_aligned(slice::from_ref(own)) {
        return plain(own, &runs, table);
    }
    let runs = runs.map(|(heads, lights)| {
        let heads = &heads[..heads.len().min(lights.len()).min(MOST)];
        let range = heads.as_ptr_range();
        Run {
            heads: range.start,
            end: range.end,
            lights: lights.as_ptr(),
        }
    });
    let range = runs.as_ptr_range();
    let (weight, r, g, b);
    // SAFETY: `runs` are five at most, of five heads at most each, whole words, and have as many lights; an index into `table` is
    // under 256. `add` gives back r6 and r7.
    unsafe {
        asm!(
            "bl {add}",
            add = sym add,
            inout("r0") range.start => weight,
            inout("r1") range.end => r,
            inout("r2") own => g,
            inout("r3") table => b,
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
    [weight, r, g, b]
}

/// Whether heads are whole words.
#[inline(always)]
pub(super) fn is_aligned(heads: &[Head]) -> bool {
    heads.as_ptr().addr().is_multiple_of(4)
}

/// What [`gather`] does, for heads that are not whole words.
#[cold]
fn plain(own: &Head, runs: &[(&[Head], &[Light])], table: &[u8; 256]) -> [u32; 4] {
    let mut sums = [0u32; 4];
    for (heads, lights) in runs {
        for (head, light) in heads.iter().zip(*lights).take(MOST) {
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

/// `$at` bytes from r4, a channel by weight r5 onto `$sum`.
#[rustfmt::skip]
macro_rules! channel {
    ($at:literal, $sum:literal) => {
        concat!("ldrh r6, [r4, #", $at, "]; muls r6, r5, r6; adds ", $sum, ", ", $sum, ", r6;")
    };
}

/// r0, r1: the first run and behind the last, then two of the sums. r2: own head, and r3: table, then the others. r4, r5, r8 to
/// r12 and lr are not kept.
///
/// All weights are made before the first light is looked at: own bytes and sums are ten registers. Cycles of a pixel: 64; 22 where
/// two bytes of it say enough.
///
/// # Safety
///
/// All four point to what they say, and no more than 25 pixels are in the runs.
#[unsafe(naked)]
unsafe extern "C" fn add() {
    naked_asm!(
        "push {{r0, r1, r6, r7, lr}}",
        "push {{r0}}",
        "sub sp, #100",
        "mov r6, r3",
        "ldmia r2!, {{r0, r1}}",
        own!(),
        "mov r7, sp",
        // A run's weights, from r7 on.
        "20:",
        "ldr r0, [sp, #100]",
        "ldr r1, [sp, #108]",
        "cmp r0, r1",
        "beq 30f",
        "ldmia r0!, {{r4, r5}}",
        "adds r0, #4",
        "str r0, [sp, #100]",
        "cmp r4, r5",
        "beq 20b",
        "22:",
        "ldmia r4!, {{r0, r1}}",
        "asrs r2, r0, #24",
        "add r2, r11",
        "muls r2, r2, r2",
        square!("sxtb r3, r0", "r8"),
        "lsrs r3, r2, #9",
        "bne 28f",
        square!("lsls r3, r0, #16; asrs r3, r3, #24", "r9"),
        square!("lsls r3, r0, #8; asrs r3, r3, #24", "r10"),
        square!("sxtb r3, r1", "r12"),
        square!("lsls r3, r1, #16; asrs r3, r3, #24", "lr"),
        "lsrs r3, r2, #9",
        "bne 28f",
        "lsrs r2, r2, #1",
        "ldrb r2, [r6, r2]",
        "lsls r1, r1, #8",
        "lsrs r1, r1, #24",
        "muls r1, r2, r1",
        "adds r2, r2, r1",
        "lsrs r2, r2, #6",
        "24:",
        "stmia r7!, {{r2}}",
        "cmp r4, r5",
        "bne 22b",
        "b 20b",
        "28:",
        "movs r2, #0",
        "b 24b",
        // Their lights; r8 to r9 are the runs, r10 is the end of one's weights.
        "30:",
        "mov r9, r0",
        "ldr r4, [sp, #104]",
        "mov r8, r4",
        "mov r7, sp",
        "movs r0, #0",
        "movs r1, #0",
        "movs r2, #0",
        "movs r3, #0",
        "31:",
        "cmp r8, r9",
        "beq 39f",
        "mov r6, r8",
        "ldmia r6!, {{r4, r5}}",
        "subs r5, r5, r4",
        "lsrs r5, r5, #1",
        "adds r5, r5, r7",
        "mov r10, r5",
        "ldmia r6!, {{r4}}",
        "mov r8, r6",
        "cmp r7, r10",
        "beq 31b",
        "32:",
        "ldmia r7!, {{r5}}",
        "cmp r5, #0",
        "beq 34f",
        "adds r0, r0, r5",
        channel!(0, "r1"),
        channel!(2, "r2"),
        channel!(4, "r3"),
        "34:",
        "adds r4, #6",
        "cmp r7, r10",
        "bne 32b",
        "b 31b",
        "39:",
        "add sp, #112",
        "pop {{r6, r7, pc}}",
    )
}
