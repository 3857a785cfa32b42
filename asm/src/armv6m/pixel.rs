use core::arch::naked_asm;
use core::mem::offset_of;

/// Outputs of a pass of [`merge`].
const OUTPUTS: usize = 4;
/// Bytes of a head.
const HEAD: usize = 8;

/// A pass over a row of coarse pixels, each with two finer ones, whose frame this is.
#[repr(C)]
struct Pass {
    coarse: *const u8,
    coarse_inputs: usize,
    fine: *const u8,
    fine_inputs: usize,
    words: *const u32,
    /// With the half that rounds.
    biases: [i32; OUTPUTS],
    out: *mut u8,
    /// From one pixel's outputs to the next one's.
    stride: usize,
    /// Finer pixels to come.
    left: usize,
}

/// Outputs of 1 × 1 over each of `width` pixels of a row, and the pixel of the coarser size above it, which two share, from the
/// first on; both have a multiple of 4 activations. Outputs are as [`super::column::convolve`] has them.
///
/// Four outputs are a pass, of two words for each input, the coarse ones first. Nothing is made where anything is short.
pub fn merge(
    [coarse, fine]: [&[u8]; 2],
    [coarse_inputs, fine_inputs]: [usize; 2],
    width: usize,
    words: &[[u32; OUTPUTS / 2]],
    biases: &[i16],
    out: &mut [u8],
) {
    let fours = |inputs: usize| inputs > 0 && inputs.is_multiple_of(4);
    if !fours(coarse_inputs) || !fours(fine_inputs) {
        return;
    }
    let outputs = biases.len();
    // No product of two of these wraps.
    let is_small = (width | coarse_inputs | fine_inputs | outputs) >> 16 == 0;
    let is_short = fine.len() < width * fine_inputs
        || coarse.len() < width.div_ceil(2) * coarse_inputs
        || out.len() < width * outputs;
    if width == 0 || !is_small || is_short {
        return;
    }
    let (biases, _) = biases.as_chunks::<OUTPUTS>();
    let mut words = words;
    for (number, biases) in biases.iter().enumerate() {
        let Some((own, rest)) = words.split_at_checked(coarse_inputs + fine_inputs) else {
            return;
        };
        words = rest;
        let pass = Pass {
            coarse: coarse.as_ptr(),
            coarse_inputs,
            fine: fine.as_ptr(),
            fine_inputs,
            words: own.as_ptr().cast(),
            biases: biases.map(|bias| i32::from(bias) + 32),
            out: out.as_mut_ptr().wrapping_add(number * OUTPUTS),
            stride: outputs,
            left: width,
        };
        // SAFETY: there are `width` finer pixels and half as many coarse ones, `out` has `outputs` bytes for each, of which no
        // pass writes behind the last, and `words` are as many as both have activations.
        unsafe { pixels(&pass) }
    }
}

/// A row of heads, whose frame this is.
#[repr(C)]
struct Heads {
    pixels: *const u8,
    inputs: usize,
    words: *const u32,
    /// With what rounds.
    biases: [i32; HEAD],
    out: *mut u8,
    /// Pixels to come.
    left: usize,
}

/// Heads of pixels side by side, of `inputs` activations each, a multiple of 4: six signed bytes, 128ths of the sums with their
/// biases, then two about 128, 16ths of theirs. Nothing is made where anything is short.
pub fn heads(
    pixels: &[u8],
    inputs: usize,
    words: &[[u32; HEAD / 2]],
    biases: &[i16],
    out: &mut [[u8; HEAD]],
) {
    let is_small = inputs >> 8 == 0 && out.len() >> 24 == 0;
    if is_small && inputs > 0 && pixels.len() >= out.len() * inputs {
        // SAFETY: there are as many pixels as `out` has places.
        unsafe {
            make(
                pixels.as_ptr(),
                inputs,
                words,
                biases,
                out.as_flattened_mut().as_mut_ptr(),
                out.len(),
            )
        }
    }
}

/// The same in the activations' place, from the start on; no pixel has fewer than a head.
pub fn squeeze(activations: &mut [u8], inputs: usize, words: &[[u32; HEAD / 2]], biases: &[i16]) {
    if inputs >= HEAD {
        let place = activations.as_mut_ptr();
        // SAFETY: a pixel is read before its head is written, which is not behind it.
        unsafe { make(place, inputs, words, biases, place, activations.len() / inputs) }
    }
}

/// # Safety
///
/// There are `count` pixels of `inputs` bytes, not 0, and places for as many heads.
unsafe fn make(
    pixels: *const u8,
    inputs: usize,
    words: &[[u32; HEAD / 2]],
    biases: &[i16],
    out: *mut u8,
    count: usize,
) {
    let Some(biases) = biases.first_chunk::<HEAD>() else {
        return;
    };
    if count == 0 || !inputs.is_multiple_of(4) || words.len() < inputs {
        return;
    }
    let mut biases = biases.map(|bias| i32::from(bias) + 64);
    biases[6] += 0x808 - 64;
    biases[7] += 0x808 - 64;
    let heads = Heads {
        pixels,
        inputs,
        words: words.as_ptr().cast(),
        biases,
        out,
        left: count,
    };
    // SAFETY: the caller's, and there are words for each activation of a pixel.
    unsafe { head(&heads) }
}

/// Activations number `$at` from r1 on and from r7 on times their words at r3, which moves on.
macro_rules! both {
    ($at:literal) => {
        concat!(
            "ldrb r0, [r1, #",
            $at,
            "]; ldrb r6, [r7, #",
            $at,
            "]; ldmia r3!, {{r4, r5}};",
            "movs r2, r0; muls r2, r4, r2; muls r0, r5, r0; muls r4, r6, r4; muls r5, r6, r5;",
            "add r8, r2; add r9, r0; add r10, r4; add r11, r5;",
        )
    };
}

/// r0: the pass.
///
/// # Safety
///
/// All in it points to what it says.
#[unsafe(naked)]
unsafe extern "C" fn pixels(pass: *const Pass) {
    naked_asm!(
        "push {{r4, r5, r6, r7, lr}}",
        save_upper!(),
        "sub sp, #{frame}",
        "mov r1, sp",
        "ldmia r0!, {{r2, r3, r4, r5, r6, r7}}; stmia r1!, {{r2, r3, r4, r5, r6, r7}}",
        "ldmia r0!, {{r2, r3, r4, r5, r6, r7}}; stmia r1!, {{r2, r3, r4, r5, r6, r7}}",
        // What is coarse counts for both.
        "10:",
        "movs r0, #0; mov r8, r0; mov r9, r0",
        "ldr r3, [sp, #{words}]; ldr r1, [sp, #{coarse}]; ldr r2, [sp, #{coarse_inputs}]; lsrs r2, r2, #2",
        run!({ "ldmia r3!, {{r4, r5}}; muls r4, r0, r4; muls r5, r0, r5; add r8, r4; add r9, r5;" } "8"),
        "str r1, [sp, #{coarse}]",
        "mov r10, r8; mov r11, r9",
        // A last one by itself is made twice and kept once.
        "ldr r1, [sp, #{fine}]; ldr r2, [sp, #{fine_inputs}]; ldr r0, [sp, #{left}]",
        "adds r7, r1, r2; mov r12, r7; cmp r0, #1; bhi 40f",
        "movs r7, r1",
        "40:",
        both!("0"),
        both!("1"),
        both!("2"),
        both!("3"),
        "adds r1, #4; adds r7, #4; cmp r1, r12; bne 40b",
        "str r7, [sp, #{fine}]",
        activate!("r8", "r9", "60", "50"),
        "ldr r0, [sp, #{left}]; subs r0, #1; beq 58f",
        "str r0, [sp, #{left}]",
        activate!("r10", "r11", "61", "51"),
        "ldr r0, [sp, #{left}]; subs r0, #1; beq 58f",
        "str r0, [sp, #{left}]",
        "b 10b",
        "58:",
        "add sp, #{frame}",
        restore_upper!(),
        "pop {{r4, r5, r6, r7, pc}}",
        cut!("60", "50"),
        cut!("61", "51"),
        coarse = const offset_of!(Pass, coarse),
        coarse_inputs = const offset_of!(Pass, coarse_inputs),
        fine = const offset_of!(Pass, fine),
        fine_inputs = const offset_of!(Pass, fine_inputs),
        words = const offset_of!(Pass, words),
        biases = const offset_of!(Pass, biases),
        out = const offset_of!(Pass, out),
        stride = const offset_of!(Pass, stride),
        left = const offset_of!(Pass, left),
        frame = const size_of::<Pass>(),
    )
}

/// Both bytes of the sums in `$word`, with the biases at r0, to `$at` of r1 and behind it: `$shift` bits less, by way of `$low`
/// and `$high` where `$extend` does not keep them.
macro_rules! bytes {
    ($word:literal, $at:literal, $shift:literal, $extend:literal, $low:literal, $high:literal) => {
        concat!(
            "mov r5, ",
            $word,
            "; sxth r4, r5; subs r5, r5, r4; asrs r5, r5, #16;",
            "ldmia r0!, {{r2, r3}}; adds r4, r4, r2; adds r5, r5, r3;",
            "asrs r4, r4, #",
            $shift,
            "; ",
            $extend,
            " r2, r4; cmp r2, r4; bne ",
            $low,
            "f;",
            $low,
            "9: strb r4, [r1, #",
            $at,
            "];",
            "asrs r5, r5, #",
            $shift,
            "; ",
            $extend,
            " r2, r5; cmp r2, r5; bne ",
            $high,
            "f;",
            $high,
            "9: strb r5, [r1, #",
            $at,
            " + 1];",
        )
    };
}

/// The farthest byte on its side: of signed ones, 127 or −128.
macro_rules! farthest_signed {
    ($label:literal, $byte:literal) => {
        concat!(
            $label,
            ": asrs ",
            $byte,
            ", ",
            $byte,
            ", #31; movs r2, #127; eors ",
            $byte,
            ", r2; b ",
            $label,
            "9b;",
        )
    };
}

/// Of others, 255 or 0.
macro_rules! farthest {
    ($label:literal, $byte:literal) => {
        concat!(
            $label,
            ": asrs ",
            $byte,
            ", ",
            $byte,
            ", #31; mvns ",
            $byte,
            ", ",
            $byte,
            "; b ",
            $label,
            "9b;"
        )
    };
}

/// r0: the heads.
///
/// # Safety
///
/// All in it points to what it says.
#[unsafe(naked)]
unsafe extern "C" fn head(heads: *const Heads) {
    naked_asm!(
        "push {{r4, r5, r6, r7, lr}}",
        save_upper!(),
        "sub sp, #{frame}",
        "mov r1, sp",
        "ldmia r0!, {{r2, r3, r4, r5, r6, r7}}; stmia r1!, {{r2, r3, r4, r5, r6, r7}}",
        "ldmia r0!, {{r2, r3, r4, r5, r6, r7}}; stmia r1!, {{r2, r3, r4, r5, r6, r7}}",
        "ldmia r0!, {{r2}}; stmia r1!, {{r2}}",
        "10:",
        "movs r0, #0; mov r8, r0; mov r9, r0; mov r10, r0; mov r11, r0",
        "ldr r3, [sp, #{words}]; ldr r1, [sp, #{pixels}]; ldr r2, [sp, #{inputs}]; lsrs r2, r2, #2",
        run!({
            "ldmia r3!, {{r4, r5, r6, r7}};
             muls r4, r0, r4; muls r5, r0, r5; muls r6, r0, r6; muls r7, r0, r7;
             add r8, r4; add r9, r5; add r10, r6; add r11, r7;"
        } "16"),
        "str r1, [sp, #{pixels}]",
        "add r0, sp, #{biases}; ldr r1, [sp, #{out}]",
        bytes!("r8", "0", "7", "sxtb", "40", "41"),
        bytes!("r9", "2", "7", "sxtb", "42", "43"),
        bytes!("r10", "4", "7", "sxtb", "44", "45"),
        bytes!("r11", "6", "4", "uxtb", "46", "47"),
        "adds r1, #8; str r1, [sp, #{out}]",
        "ldr r0, [sp, #{left}]; subs r0, #1; beq 58f",
        "str r0, [sp, #{left}]",
        "b 10b",
        "58:",
        "add sp, #{frame}",
        restore_upper!(),
        "pop {{r4, r5, r6, r7, pc}}",
        farthest_signed!("40", "r4"),
        farthest_signed!("41", "r5"),
        farthest_signed!("42", "r4"),
        farthest_signed!("43", "r5"),
        farthest_signed!("44", "r4"),
        farthest_signed!("45", "r5"),
        farthest!("46", "r4"),
        farthest!("47", "r5"),
        pixels = const offset_of!(Heads, pixels),
        inputs = const offset_of!(Heads, inputs),
        words = const offset_of!(Heads, words),
        biases = const offset_of!(Heads, biases),
        out = const offset_of!(Heads, out),
        left = const offset_of!(Heads, left),
        frame = const size_of::<Heads>(),
    )
}
