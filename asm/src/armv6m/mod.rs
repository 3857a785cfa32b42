//! For cores of ARMv6-M, whose instructions know seven registers and no long product.
//!
//! What stays the same, and sums, stand in the upper eight. The network's sums: a word of weights holds two, of which one
//! multiplication makes two products (`Weights::new` says why their sums stay apart). Cycles of an activation: 18 by four words,
//! 15 by three, 12 by two; 9 where it is 0. Compiled code takes 25 to 45.

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

pub(crate) mod facets;
pub(crate) mod normalize;
pub(crate) mod rectangle;
pub(crate) mod sums;
pub(crate) mod walk;
