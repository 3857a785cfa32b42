//! Results and condition flags of the 16-bit Thumb data instructions, by the processor itself and by a model.
//!
//! An ARM target executes the instruction, every other target evaluates the model of the ARMv6-M manual (section
//! A6.7), and both must give the same CRC. It has caught an emulator whose every *result* was right and whose carry
//! and overflow were not.

use crate::{jobs::Job, random::Xorshift};
use microlux::num::Crc;

/// N, Z, C, V in bits 3 to 0.
type Flags = u32;

const CORNERS: [u32; 12] = [
    0,
    1,
    2,
    31,
    32,
    33,
    255,
    0x7fff_ffff,
    0x8000_0000,
    0x8000_0001,
    0xffff_fffe,
    0xffff_ffff,
];

/// All pairs of corners under each flag setting, then 600 random pairs.
fn fuzz(instruction: impl Fn(u32, u32, Flags) -> (u32, Flags)) -> u32 {
    let mut crc = Crc::new();
    let mut check = |a, b, before| {
        let (result, after) = instruction(a, b, before);
        crc.word(result);
        crc.word(after);
    };
    for a in CORNERS {
        for b in CORNERS {
            for before in 0..16 {
                check(a, b, before);
            }
        }
    }
    let mut random = Xorshift::new(0x9e37_79b9);
    for _ in 0..600 {
        check(random.u32(), random.u32(), random.u32() >> 28);
    }
    crc.value()
}

/// One job for each line `name "assembly" model`, where r0 is the first source and the destination.
macro_rules! instructions {
    ($($name:ident $assembly:literal $model:expr;)*) => {
        pub(crate) const JOBS: &[Job] = &[$(Job::machine(concat!("flags-", stringify!($name)), $name)),*];
        $(
            #[cfg(target_arch = "arm")]
            fn $name() -> u32 {
                fuzz(|a, b, before| {
                    let (mut result, mut status) = (a, before << 28);
                    // SAFETY: the instruction works on registers alone, and the flags, which `asm!` takes as
                    // clobbered, are all it changes besides.
                    unsafe {
                        core::arch::asm!(
                            "msr apsr_nzcvq, r2",
                            $assembly,
                            "mrs r2, apsr",
                            inout("r0") result,
                            in("r1") b,
                            inout("r2") status,
                            options(nomem, nostack),
                        );
                    }
                    (result, status >> 28)
                })
            }

            #[cfg(not(target_arch = "arm"))]
            fn $name() -> u32 {
                fuzz($model)
            }
        )*
    };
}

instructions! {
    adds "adds r0, r0, r1" |a, b, _| model::add(a, b, false);
    adcs "adcs r0, r1" |a, b, f| model::add(a, b, model::carry(f));
    subs "subs r0, r0, r1" |a, b, _| model::add(a, !b, true);
    sbcs "sbcs r0, r1" |a, b, f| model::add(a, !b, model::carry(f));
    rsbs "rsbs r0, r1, #0" |_, b, _| model::add(!b, 0, true);
    cmp "cmp r0, r1" |a, b, _| (a, model::add(a, !b, true).1);
    cmn "cmn r0, r1" |a, b, _| (a, model::add(a, b, false).1);
    tst "tst r0, r1" |a, b, f| (a, model::logic(a & b, f).1);
    ands "ands r0, r1" |a, b, f| model::logic(a & b, f);
    orrs "orrs r0, r1" |a, b, f| model::logic(a | b, f);
    eors "eors r0, r1" |a, b, f| model::logic(a ^ b, f);
    bics "bics r0, r1" |a, b, f| model::logic(a & !b, f);
    mvns "mvns r0, r1" |_, b, f| model::logic(!b, f);
    muls "muls r0, r1, r0" |a, b, f| model::logic(a.wrapping_mul(b), f);
    lsls "lsls r0, r1" |a, b, f| model::shift_left(a, b & 255, f);
    lsrs "lsrs r0, r1" |a, b, f| model::shift_right(a, b & 255, false, f);
    asrs "asrs r0, r1" |a, b, f| model::shift_right(a, b & 255, true, f);
    rors "rors r0, r1" |a, b, f| model::rotate(a, b & 255, f);
    lsls_7 "lsls r0, r1, #7" |_, b, f| model::shift_left(b, 7, f);
    lsrs_7 "lsrs r0, r1, #7" |_, b, f| model::shift_right(b, 7, false, f);
    asrs_7 "asrs r0, r1, #7" |_, b, f| model::shift_right(b, 7, true, f);
    lsrs_32 "lsrs r0, r1, #32" |_, b, f| model::shift_right(b, 32, false, f);
    asrs_32 "asrs r0, r1, #32" |_, b, f| model::shift_right(b, 32, true, f);
    movs_0 "movs r0, #0" |_, _, f| model::logic(0, f);
    adds_200 "adds r0, #200" |a, _, _| model::add(a, 200, false);
    subs_200 "subs r0, #200" |a, _, _| model::add(a, !200, true);
    cmp_200 "cmp r0, #200" |a, _, _| (a, model::add(a, !200, true).1);
    rev "rev r0, r1" |_, b, f| (b.swap_bytes(), f);
    rev16 "rev16 r0, r1" |_, b, f| (b.swap_bytes().rotate_left(16), f);
    revsh "revsh r0, r1" |_, b, f| ((b as i16).swap_bytes() as u32, f);
    sxtb "sxtb r0, r1" |_, b, f| (b as i8 as u32, f);
    sxth "sxth r0, r1" |_, b, f| (b as i16 as u32, f);
    uxtb "uxtb r0, r1" |_, b, f| (b & 0xff, f);
    uxth "uxth r0, r1" |_, b, f| (b & 0xffff, f);
}

/// The manual's pseudocode (A2.2.1, A6.7) for targets that cannot run the instructions.
#[cfg(not(target_arch = "arm"))]
mod model {
    use super::Flags;

    pub(super) const fn carry(flags: Flags) -> bool {
        flags & 2 != 0
    }

    /// `AddWithCarry`; a subtraction adds the complement.
    pub(super) fn add(a: u32, b: u32, carry: bool) -> (u32, Flags) {
        let unsigned = u64::from(a) + u64::from(b) + u64::from(carry);
        let signed = i64::from(a as i32) + i64::from(b as i32) + i64::from(carry);
        let result = unsigned as u32;
        let carries = u32::from(u64::from(result) != unsigned);
        let overflows = u32::from(i64::from(result as i32) != signed);
        logic(result, carries << 1 | overflows)
    }

    /// N and Z follow the result; C and V stay as in `flags`.
    pub(super) fn logic(result: u32, flags: Flags) -> (u32, Flags) {
        let negative = result >> 31;
        let zero = u32::from(result == 0);
        (result, negative << 3 | zero << 2 | flags & 3)
    }

    fn shifted(result: u32, carry: bool, flags: Flags) -> (u32, Flags) {
        logic(result, u32::from(carry) << 1 | flags & 1)
    }

    pub(super) fn shift_left(x: u32, n: u32, flags: Flags) -> (u32, Flags) {
        if n == 0 {
            return logic(x, flags);
        }
        // Bit 32 of the extended value is the last one shifted out.
        let extended = u64::from(x).checked_shl(n).unwrap_or(0);
        shifted(extended as u32, extended >> 32 & 1 != 0, flags)
    }

    pub(super) fn shift_right(x: u32, n: u32, arithmetic: bool, flags: Flags) -> (u32, Flags) {
        if n == 0 {
            return logic(x, flags);
        }
        let wide = if arithmetic {
            i64::from(x as i32)
        } else {
            i64::from(x)
        };
        // One place more to the left, so that the last bit shifted out stays visible as bit 0.
        let extended = (wide << 1) >> n.min(63);
        shifted((extended >> 1) as u32, extended & 1 != 0, flags)
    }

    pub(super) fn rotate(x: u32, n: u32, flags: Flags) -> (u32, Flags) {
        if n == 0 {
            return logic(x, flags);
        }
        let result = x.rotate_right(n & 31);
        shifted(result, result >> 31 != 0, flags)
    }
}
