use core::arch::naked_asm;
use core::mem::offset_of;

use crate::layer::{Steps, Task};

/// Activation number `$at` from r1 on times its words from r3 on; `$next` is the place behind.
#[rustfmt::skip]
macro_rules! step {
    (3, $at:literal, $next:literal) => {
        concat!(
            "ldrb r0, [r1, #", $at, "]; cbz r0, ", $next, "f;",
            "ldrd r4, r5, [r3, #12 * ", $at, "]; ldr r6, [r3, #12 * ", $at, " + 8];",
            "mla r8, r4, r0, r8; mla r9, r5, r0, r9; mla r10, r6, r0, r10;",
            $next, ":",
        )
    };
    (4, $at:literal, $next:literal) => {
        concat!(
            "ldrb r0, [r1, #", $at, "]; cbz r0, ", $next, "f;",
            "ldrd r4, r5, [r3, #16 * ", $at, "]; ldrd r6, r7, [r3, #16 * ", $at, " + 8];",
            "mla r8, r4, r0, r8; mla r9, r5, r0, r9; mla r10, r6, r0, r10; mla r11, r7, r0, r11;",
            $next, ":",
        )
    };
}

/// r2 activations from r1 on times the words at r3, which moves on, added to r8 to r11; then on to `$next`.
#[rustfmt::skip]
macro_rules! run {
    ($pairs:tt, $next:literal) => {
        concat!(
            "subs r2, #4; blo 24f;",
            "22:",
            step!($pairs, "0", "30"),
            step!($pairs, "1", "31"),
            step!($pairs, "2", "32"),
            step!($pairs, "3", "33"),
            "adds r1, #4; adds r3, #16 * ", $pairs, ";",
            "subs r2, #4; bhs 22b;",
            // The last three and fewer.
            "24:",
            "adds r2, #4; beq ", $next, ";",
            "25:",
            step!($pairs, "0", "34"),
            "adds r1, #1; adds r3, #4 * ", $pairs, ";",
            "subs r2, #1; bne 25b;",
            "b ", $next, ";",
        )
    };
}

/// Both activations of the sums in `$word`, with the biases at r0, to r1; both move on.
#[rustfmt::skip]
macro_rules! activate {
    ($word:literal) => {
        concat!(
            "ldrsh r2, [r0], #2; ldrsh r3, [r0], #2;",
            "sxth r4, ", $word, "; add r2, r4; adds r2, #32; usat r2, #6, r2, asr #6; strb r2, [r1], #1;",
            "add r4, ", $word, ", #0x8000; add r3, r3, r4, asr #16;",
            "adds r3, #32; usat r3, #6, r3, asr #6; strb r3, [r1], #1;",
        )
    };
}

/// The same as two signed bytes: 128ths, rounded.
#[rustfmt::skip]
macro_rules! feature {
    ($word:literal) => {
        concat!(
            "ldrsh r2, [r0], #2; ldrsh r3, [r0], #2;",
            "sxth r4, ", $word, "; add r2, r4; adds r2, #64; ssat r2, #8, r2, asr #7; strb r2, [r1], #1;",
            "add r4, ", $word, ", #0x8000; add r3, r3, r4, asr #16;",
            "adds r3, #64; ssat r3, #8, r3, asr #7; strb r3, [r1], #1;",
        )
    };
}

/// The same as two bytes about 128: 16ths, rounded.
#[rustfmt::skip]
macro_rules! share {
    ($word:literal) => {
        concat!(
            "ldrsh r2, [r0], #2; ldrsh r3, [r0], #2;",
            "sxth r4, ", $word, "; add r2, r4; add r2, #0x808; usat r2, #8, r2, asr #4; strb r2, [r1], #1;",
            "add r4, ", $word, ", #0x8000; add r3, r3, r4, asr #16;",
            "add r3, #0x808; usat r3, #8, r3, asr #4; strb r3, [r1], #1;",
        )
    };
}

const WORDS: usize = offset_of!(Task, words);
const BIASES: usize = offset_of!(Task, biases);
const OUT: usize = offset_of!(Task, out);
const GAP: usize = offset_of!(Task, gap);
const PIXELS: usize = offset_of!(Task, pixels);

/// A task for pixels one after the other: at `10` sums of 0, words from r3 on, and from r12 to lr what runs there are, at `20` the
/// next of these; at `29` they are through.
macro_rules! task {
    ($($line:tt)*) => {
        naked_asm!(
            "push {{r0, r1, r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
            "mov lr, r2",
            "10:",
            "ldrd r0, r12, [sp]; ldr r3, [r0, #{words}]",
            "mov r8, #0; mov r9, #0; mov r10, #0; mov r11, #0",
            "20:",
            "cmp r12, lr; beq 29f",
            $($line)*
            "add sp, #8",
            "pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
            words = const WORDS,
            biases = const BIASES,
            out = const OUT,
            gap = const GAP,
            pixels = const PIXELS,
        )
    };
}

macro_rules! layer {
    ($name:ident, $pairs:tt, $($make:ident $word:literal)*) => {
        /// r0: task. r1, r2: the first run and behind the last; what is to be done is gone when it is done.
        ///
        /// # Safety
        ///
        /// All three point to what they say, and so does the task.
        #[unsafe(naked)]
        pub(crate) unsafe extern "C" fn $name(task: *mut Task, first: *mut Steps, end: *const Steps) {
            task!(
                "ldrd r1, r2, [r12]; ldr r0, [r12, #8]; add r0, r1; str r0, [r12], #12",
                run!($pairs, "20b"),
                "29:",
                "ldr r12, [sp]; ldr r0, [r12, #{biases}]; ldr r1, [r12, #{out}]",
                $($make!($word),)*
                "ldr r2, [r12, #{gap}]; add r1, r2; str r1, [r12, #{out}]",
                "ldr r2, [r12, #{pixels}]; subs r2, #1; str r2, [r12, #{pixels}]",
                "bne 10b",
            )
        }
    };
}

/// Activations number `$at` from r1 on and from r7 on times their words from r3 on.
#[rustfmt::skip]
macro_rules! both {
    ($at:literal) => {
        concat!(
            "ldrb r0, [r1, #", $at, "]; ldrb r6, [r7, #", $at, "];",
            "ldrd r4, r5, [r3, #8 * ", $at, "];",
            "mla r8, r4, r0, r8; mla r9, r5, r0, r9; mla r10, r4, r6, r10; mla r11, r5, r6, r11;",
        )
    };
}

/// As the others, two pixels at once, so that the words are loaded once for both; a last one is made twice and kept once.
///
/// # Safety
///
/// All three point to what they say, and so does the task.
#[unsafe(naked)]
pub(crate) unsafe extern "C" fn layer_two(task: *mut Task, first: *mut Steps, end: *const Steps) {
    task!(
        "ldr r0, [sp]; ldr r0, [r0, #{pixels}]; cmp r0, #1",
        "ldrd r1, r2, [r12]; ldr r0, [r12, #8]",
        "ite hi; addhi r7, r1, r0; movls r7, r1",
        "add r0, r7; str r0, [r12], #12",
        "subs r2, #4; blo 24f",
        "22:",
        both!("0"),
        both!("1"),
        both!("2"),
        both!("3"),
        "adds r1, #4; adds r7, #4; adds r3, #32",
        "subs r2, #4; bhs 22b",
        // The last three and fewer.
        "24:",
        "adds r2, #4; beq 20b",
        "25:",
        both!("0"),
        "adds r1, #1; adds r7, #1; adds r3, #8",
        "subs r2, #1; bne 25b",
        "b 20b",
        "29:",
        "ldr r12, [sp]; ldr r0, [r12, #{biases}]; ldr r1, [r12, #{out}]",
        "ldr r5, [r12, #{gap}]; ldr r6, [r12, #{pixels}]",
        activate!("r8"),
        activate!("r9"),
        "add r1, r5; subs r6, #1; beq 30f",
        "subs r0, #8",
        activate!("r10"),
        activate!("r11"),
        "add r1, r5; subs r6, #1; beq 30f",
        "str r1, [r12, #{out}]; str r6, [r12, #{pixels}]",
        "b 10b",
        "30:",
    )
}

layer!(layer_three, 3, activate "r8" activate "r9" activate "r10");
layer!(layer_four, 4, activate "r8" activate "r9" activate "r10" activate "r11");
layer!(layer_heads, 4, feature "r8" feature "r9" feature "r10" share "r11");
