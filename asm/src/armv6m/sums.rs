use core::arch::naked_asm;

/// A run's first activation, and what lies behind its last.
#[repr(C)]
struct Run {
    first: *const u8,
    end: *const u8,
}

/// `PAIRS` is 2, 3 or 4, and there are no fewer words than activations.
#[inline]
pub fn sums<const PAIRS: usize, const RUNS: usize>(
    runs: [&[u8]; RUNS],
    words: &[[u32; PAIRS]],
) -> [u32; PAIRS] {
    let runs = runs.map(|run| {
        let range = run.as_ptr_range();
        Run {
            first: range.start,
            end: range.end,
        }
    });
    let range = runs.as_ptr_range();
    let mut sums = [0; PAIRS];
    let add = match PAIRS {
        2 => two,
        3 => three,
        _ => four,
    };
    // SAFETY: `runs` are slices one after the other, `words` has `PAIRS` words for each of their bytes (the caller's
    // promise), and `sums` has room for as many.
    unsafe { add(sums.as_mut_ptr(), range.start, range.end, words.as_ptr().cast()) }
    sums
}

/// Activation number `$at` from r1 on times the words at r3, which moves on. `$zero` is where r3 moves on for a 0, `$next`
/// is the place behind.
#[rustfmt::skip]
macro_rules! step {
    (2, $at:literal, $zero:literal, $next:literal) => {
        concat!(
            "ldrb r0, [r1, #", $at, "]; cmp r0, #0; beq ", $zero, "f;",
            "ldmia r3!, {{r4, r5}};",
            "muls r4, r0, r4; muls r5, r0, r5;",
            "add r8, r4; add r9, r5;",
            $next, ":",
        )
    };
    (3, $at:literal, $zero:literal, $next:literal) => {
        concat!(
            "ldrb r0, [r1, #", $at, "]; cmp r0, #0; beq ", $zero, "f;",
            "ldmia r3!, {{r4, r5, r6}};",
            "muls r4, r0, r4; muls r5, r0, r5; muls r6, r0, r6;",
            "add r8, r4; add r9, r5; add r10, r6;",
            $next, ":",
        )
    };
    (4, $at:literal, $zero:literal, $next:literal) => {
        concat!(
            "ldrb r0, [r1, #", $at, "]; cmp r0, #0; beq ", $zero, "f;",
            "ldmia r3!, {{r4, r5, r6, r7}};",
            "muls r4, r0, r4; muls r5, r0, r5; muls r6, r0, r6; muls r7, r0, r7;",
            "add r8, r4; add r9, r5; add r10, r6; add r11, r7;",
            $next, ":",
        )
    };
}

macro_rules! skip {
    ($pairs:literal, $zero:literal, $next:literal) => {
        concat!($zero, ": adds r3, #4 * ", $pairs, "; b ", $next, "b")
    };
}

macro_rules! kernel {
    ($name:ident, $pairs:tt, $store:literal) => {
        /// r0: sums out. r1, r2: the first run and behind the last. r3: words.
        ///
        /// # Safety
        ///
        /// All four point to what they say.
        #[unsafe(naked)]
        unsafe extern "C" fn $name(sums: *mut u32, first: *const Run, end: *const Run, words: *const u32) {
            naked_asm!(
                "push {{r0, r4, r5, r6, r7, lr}}",
                save_upper!(),
                "movs r4, #0",
                "mov r8, r4",
                "mov r9, r4",
                "mov r10, r4",
                "mov r11, r4",
                "mov lr, r2",
                // r12 is the run's place in their table: r1 goes on from its first activation to r2.
                "20:",
                "cmp r1, lr",
                "beq 29f",
                "ldmia r1!, {{r4, r5}}",
                "mov r12, r1",
                "movs r1, r4",
                "movs r2, r5",
                // Four at once, while r1 is under the end less three. An empty run lies anywhere, from 1 on.
                "adds r4, #3",
                "cmp r4, r5",
                "bhs 24f",
                "subs r2, #3",
                "22:",
                step!($pairs, "0", "30", "40"),
                step!($pairs, "1", "31", "41"),
                step!($pairs, "2", "32", "42"),
                step!($pairs, "3", "33", "43"),
                "adds r1, #4",
                "cmp r1, r2",
                "blo 22b",
                "adds r2, #3",
                // The last three and fewer.
                "24:",
                "cmp r1, r2",
                "beq 25f",
                step!($pairs, "0", "34", "44"),
                "adds r1, #1",
                "b 24b",
                "25:",
                "mov r1, r12",
                "b 20b",
                "29:",
                "mov r4, r8",
                "mov r5, r9",
                "mov r6, r10",
                "mov r7, r11",
                "ldr r0, [sp, #16]",
                concat!("stmia r0!, {{", $store, "}}"),
                restore_upper!(),
                "pop {{r0, r4, r5, r6, r7, pc}}",
                skip!($pairs, "30", "40"),
                skip!($pairs, "31", "41"),
                skip!($pairs, "32", "42"),
                skip!($pairs, "33", "43"),
                skip!($pairs, "34", "44"),
            )
        }
    };
}

kernel!(two, 2, "r4, r5");
kernel!(three, 3, "r4, r5, r6");
kernel!(four, 4, "r4, r5, r6, r7");
