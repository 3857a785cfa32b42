//! For cores of ARMv6-M, whose instructions know seven registers and no long product.
//!
//! What stays the same, and sums, stand in the upper eight. The network's sums: a word of weights holds two, of which one
//! multiplication makes two products (`Weights::new` says why their sums stay apart). Cycles of an activation, its test for 0
//! included: 24 by six words, 17 by four, 11 by two; 5 or 6 where it is 0. Compiled code takes 25 to 45 by two to four.

/// The upper registers that a caller wants back, onto the stack; r4 to r7 are free.
macro_rules! save_upper {
    () => {
        "mov r4, r8; mov r5, r9; mov r6, r10; mov r7, r11; push {{r4, r5, r6, r7}}"
    };
}

/// And back.
macro_rules! restore_upper {
    () => {
        "pop {{r4, r5, r6, r7}}; mov r8, r4; mov r9, r5; mov r10, r6; mov r11, r7"
    };
}

/// As many fours of activations as r2 says, from r1 on, by `$add`, which takes r0's words, `$bytes` of them, from r3 on; both
/// move on. Those that are 0 go by on a way of their own, back where one is not.
macro_rules! run {
    ({$($add:tt)*} $bytes:literal) => {
        concat!(
            "20: ldrb r0, [r1]; cmp r0, #0; beq 30f;",
            "21:", $($add)*,
            "ldrb r0, [r1, #1]; cmp r0, #0; beq 31f;",
            "22:", $($add)*,
            "ldrb r0, [r1, #2]; cmp r0, #0; beq 32f;",
            "23:", $($add)*,
            "ldrb r0, [r1, #3]; cmp r0, #0; beq 33f;",
            "24:", $($add)*,
            "adds r1, #4; subs r2, #1; bne 20b;",
            "b 34f;",
            "30: adds r3, #", $bytes, "; ldrb r0, [r1, #1]; cmp r0, #0; bne 22b;",
            "31: adds r3, #", $bytes, "; ldrb r0, [r1, #2]; cmp r0, #0; bne 23b;",
            "32: adds r3, #", $bytes, "; ldrb r0, [r1, #3]; cmp r0, #0; bne 24b;",
            "33: adds r3, #", $bytes, "; adds r1, #4; subs r2, #1; bne 20b;",
            "34:",
        )
    };
}

/// Four activations of the sums in two registers, to the frame's `out`, which moves on by its `stride`: 64ths with their biases,
/// 0 at least; those over 63 by way of `$over`, of [`cut`].
macro_rules! activate {
    ($low:literal, $high:literal, $over:literal, $back:literal) => {
        concat!(
            "add r0, sp, #{biases}; ldmia r0, {{r0, r1, r2, r3}};",
            "mov r5, ",
            $low,
            "; sxth r4, r5; subs r5, r5, r4; asrs r5, r5, #16;",
            "mov r7, ",
            $high,
            "; sxth r6, r7; subs r7, r7, r6; asrs r7, r7, #16;",
            "adds r4, r4, r0; adds r5, r5, r1; adds r6, r6, r2; adds r7, r7, r3;",
            "asrs r4, r4, #6; asrs r5, r5, #6; asrs r6, r6, #6; asrs r7, r7, #6;",
            "asrs r0, r4, #31; bics r4, r0; asrs r1, r5, #31; bics r5, r1;",
            "asrs r2, r6, #31; bics r6, r2; asrs r3, r7, #31; bics r7, r3;",
            "mov r0, r4; orrs r0, r5; orrs r0, r6; orrs r0, r7; cmp r0, #63; bhi ",
            $over,
            "f;",
            $back,
            ":",
            "ldr r1, [sp, #{out}]; ldr r0, [sp, #{stride}];",
            "strb r4, [r1]; strb r5, [r1, #1]; strb r6, [r1, #2]; strb r7, [r1, #3];",
            "adds r1, r1, r0; str r1, [sp, #{out}];",
        )
    };
}

/// What is over 63 becomes that.
macro_rules! cut {
    ($over:literal, $back:literal) => {
        concat!(
            $over,
            ":",
            "movs r0, #63;",
            "cmp r4, r0; bls 66f; movs r4, r0;",
            "66: cmp r5, r0; bls 67f; movs r5, r0;",
            "67: cmp r6, r0; bls 68f; movs r6, r0;",
            "68: cmp r7, r0; bls 69f; movs r7, r0;",
            "69: b ",
            $back,
            "b;",
        )
    };
}
pub(crate) mod column;
pub(crate) mod facets;
pub(crate) mod gather;
pub(crate) mod mean;
pub(crate) mod nine;
pub(crate) mod normalize;
pub(crate) mod pixel;
pub(crate) mod rectangle;
pub(crate) mod upsample;
pub(crate) mod walk;
