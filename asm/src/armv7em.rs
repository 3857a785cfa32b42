//! For cores of ARMv7E-M, which add up two products of 16 bits at once.

use core::arch::{asm, naked_asm};
use core::mem::offset_of;

type Head = [u8; 8];
type Light = [u16; 3];

/// A head's first six bytes, signed, two to a word: bytes 0 and 2, 1 and 3, 4 and 5.
#[derive(Clone, Copy)]
pub struct Spread([u32; 3]);

impl Spread {
    #[inline(always)]
    pub fn of(head: &Head) -> Spread {
        let [a, b] = words(head);
        let (even, odd, last);
        // SAFETY: arithmetic in registers.
        unsafe {
            asm!(
                "sxtb16 {even}, {a}",
                "sxtb16 {odd}, {a}, ror #8",
                "pkhbt {last}, {b}, {b}, lsl #8",
                "sxtb16 {last}, {last}",
                a = in(reg) a,
                b = in(reg) b,
                even = out(reg) even,
                odd = out(reg) odd,
                last = out(reg) last,
                options(pure, nomem, nostack, preserves_flags),
            );
        }
        Spread([even, odd, last])
    }

    /// The squared distance to another head.
    #[inline(always)]
    pub fn square(self, head: &Head) -> u32 {
        let Spread([even, odd, last]) = self;
        let [a, b] = words(head);
        let square;
        // SAFETY: arithmetic in registers.
        unsafe {
            asm!(
                "sxtb16 {part}, {a}",
                "ssub16 {part}, {even}, {part}",
                "smuad {square}, {part}, {part}",
                "sxtb16 {part}, {a}, ror #8",
                "ssub16 {part}, {odd}, {part}",
                "smlad {square}, {part}, {part}, {square}",
                "pkhbt {part}, {b}, {b}, lsl #8",
                "sxtb16 {part}, {part}",
                "ssub16 {part}, {last}, {part}",
                "smlad {square}, {part}, {part}, {square}",
                a = in(reg) a,
                b = in(reg) b,
                even = in(reg) even,
                odd = in(reg) odd,
                last = in(reg) last,
                part = out(reg) _,
                square = out(reg) square,
                options(pure, nomem, nostack),
            );
        }
        square
    }
}

#[inline(always)]
fn words(head: &Head) -> [u32; 2] {
    let [a, b, c, d, e, f, g, h] = *head;
    [[a, b, c, d], [e, f, g, h]].map(u32::from_le_bytes)
}

/// Pixels side by side; in the order in which [`add`] reads it.
#[repr(C)]
struct Run {
    heads: *const Head,
    lights: *const Light,
    count: u32,
}

/// What [`add`] is told, and what it answers.
#[repr(C)]
struct Frame {
    own: *const Head,
    table: *const u8,
    /// The weights, and the lights by weight.
    sums: [u32; 4],
}

const _: () = assert!(offset_of!(Frame, table) == 4 && offset_of!(Frame, sums) == 8);

/// Weights of pixels in runs, and their lights by weight, added up modulo 2^32; weights, and pixels of a run, under 2^15 in
/// all.
///
/// A weight is (confidence + 1) / 64 times what `table` says of half the squared distance of both heads' first six bytes
/// (signed), its last entry of all that is larger; confidence is the seventh byte.
#[inline]
pub fn gather<const RUNS: usize>(
    own: &Head,
    runs: [(&[Head], &[Light]); RUNS],
    table: &[u8; 256],
) -> [u32; 4] {
    let runs = runs.map(|(heads, lights)| Run {
        heads: heads.as_ptr(),
        lights: lights.as_ptr(),
        count: heads.len().min(lights.len()) as u32,
    });
    let range = runs.as_ptr_range();
    let mut frame = Frame {
        own,
        table: table.as_ptr(),
        sums: [0; 4],
    };
    // SAFETY: `runs` have as many heads and lights each as they count, `own` has eight bytes, and an index into `table` is
    // cut to its 256.
    unsafe { add(&mut frame, range.start, range.end) }
    frame.sums
}

/// r0: frame. r1, r2: the first run and behind the last.
///
/// # Safety
///
/// All three point to what they say.
#[unsafe(naked)]
unsafe extern "C" fn add(frame: *mut Frame, first: *const Run, end: *const Run) {
    naked_asm!(
        "push {{r0, r1, r2, r4, r5, r6, r7, r8, r9, r10, r11, lr}}",
        "ldrd r2, r6, [r0]",
        "ldr r3, [r2]; ldr r2, [r2, #4]",
        // Bytes 0 and 2, 1 and 3, 4 and 5.
        "sxtb16 r7, r3; sxtb16 r8, r3, ror #8",
        "pkhbt r9, r2, r2, lsl #8; sxtb16 r9, r9",
        "mov r10, #0; mov r11, #0; mov r12, #0; mov lr, #0",
        "20:",
        "ldrd r1, r2, [sp, #4]; cmp r1, r2; beq 29f",
        "ldrd r4, r5, [r1]; ldr r3, [r1, #8]",
        "add r1, #12; str r1, [sp, #4]",
        "cmp r3, #0; beq 20b",
        // How many are left stands above the weights.
        "sub r3, #1; add r10, r10, r3, lsl #16",
        // The squared distance in r3, two differences at once.
        "22:",
        "ldr r0, [r4], #4; ldr r1, [r4], #4",
        "sxtb16 r2, r0; ssub16 r2, r7, r2; smuad r3, r2, r2",
        "sxtb16 r2, r0, ror #8; ssub16 r2, r8, r2; smlad r3, r2, r2, r3",
        "pkhbt r2, r1, r1, lsl #8; sxtb16 r2, r2; ssub16 r2, r9, r2; smlad r3, r2, r2, r3",
        // The weight.
        "usat r3, #8, r3, asr #1; ldrb r3, [r6, r3]",
        "ubfx r1, r1, #16, #8; mla r3, r1, r3, r3; lsrs r3, r3, #6",
        "ldrh r0, [r5], #2; mla r11, r0, r3, r11",
        "ldrh r0, [r5], #2; mla r12, r0, r3, r12",
        "ldrh r0, [r5], #2; mla lr, r0, r3, lr",
        "add r10, r3; subs r10, #0x10000; bpl 22b",
        "add r10, #0x10000",
        "b 20b",
        "29:",
        "ldr r0, [sp]; add r0, #8",
        "stm r0, {{r10, r11, r12, lr}}",
        "add sp, #12",
        "pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}",
    )
}
