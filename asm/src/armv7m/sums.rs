use core::arch::naked_asm;

use crate::sums::Run;

/// Activation number `$at` from r1 on times its words from r3 on; `$next` is the place behind.
#[rustfmt::skip]
macro_rules! step {
    (2, $at:literal, $next:literal) => {
        concat!(
            "ldrb r0, [r1, #", $at, "]; cbz r0, ", $next, "f;",
            "ldrd r4, r5, [r3, #8 * ", $at, "];",
            "mla r8, r4, r0, r8; mla r9, r5, r0, r9;",
            $next, ":",
        )
    };
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

macro_rules! kernel {
    ($name:ident, $pairs:tt, $store:literal) => {
        /// r0: sums out. r1, r2: the first run and behind the last. r3: words.
        ///
        /// # Safety
        ///
        /// All four point to what they say.
        #[unsafe(naked)]
        pub(crate) unsafe extern "C" fn $name(
            sums: *mut u32,
            first: *const Run,
            end: *const Run,
            words: *const u32,
        ) {
            naked_asm!(
                "push {{r0, r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
                "mov r12, r1",
                "mov lr, r2",
                "movs r4, #0",
                "mov r8, r4",
                "mov r9, r4",
                "mov r10, r4",
                "mov r11, r4",
                // r12 is the run's place in their table. r1 goes on from its first activation, r2 counts those that are left.
                "20:",
                "cmp r12, lr",
                "beq 29f",
                "ldrd r1, r2, [r12], #8",
                "subs r2, r2, r1",
                "subs r2, #4",
                "blo 24f",
                "22:",
                step!($pairs, "0", "30"),
                step!($pairs, "1", "31"),
                step!($pairs, "2", "32"),
                step!($pairs, "3", "33"),
                "adds r1, #4",
                concat!("adds r3, #16 * ", $pairs),
                "subs r2, #4",
                "bhs 22b",
                // The last three and fewer.
                "24:",
                "adds r2, #4",
                "beq 20b",
                "25:",
                step!($pairs, "0", "34"),
                "adds r1, #1",
                concat!("adds r3, #4 * ", $pairs),
                "subs r2, #1",
                "bne 25b",
                "b 20b",
                "29:",
                "pop {{r0}}",
                concat!("stm r0, {{", $store, "}}"),
                "pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
            )
        }
    };
}

kernel!(two, 2, "r8, r9");
kernel!(three, 3, "r8, r9, r10");
kernel!(four, 4, "r8, r9, r10, r11");
