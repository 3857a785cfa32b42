use core::arch::naked_asm;
use core::mem::offset_of;

/// Words of an activation: its weights for the pixel before it, its own and the one behind it, four outputs each.
const WORDS: usize = 6;
/// Outputs of a pass.
const OUTPUTS: usize = 4;
/// Of what is seen of a pixel.
const LIGHTS: usize = 3;
/// Bytes of it.
const SEEN: usize = 12;

/// A pass over a row's columns, whose frame this is.
#[repr(C)]
struct Pass {
    /// Above, at and below; each goes on to the next column.
    rows: [*const u8; 3],
    /// Fours of bytes of a pixel.
    fours: usize,
    words: *const u32,
    /// With the half that rounds.
    biases: [i32; OUTPUTS],
    out: *mut u8,
    /// From one pixel's outputs to the next one's.
    stride: usize,
    /// Pixels to come; bit 31 until the first column was seen.
    left: usize,
}

const ROWS: usize = offset_of!(Pass, rows);
const FOURS: usize = offset_of!(Pass, fours);
const FROM: usize = offset_of!(Pass, words);
const BIASES: usize = offset_of!(Pass, biases);
const OUT: usize = offset_of!(Pass, out);
const STRIDE: usize = offset_of!(Pass, stride);
const LEFT: usize = offset_of!(Pass, left);
const FRAME: usize = size_of::<Pass>();

/// A 3 × 3 layer over the rows above, at and below, of `width` pixels of `inputs` (a multiple of 4) activations each; the
/// picture's edge goes on outwards. Outputs are sums modulo 2^32 of two 16-bit lanes, their lower one first, plus their biases,
/// a 64th of that, rounded, cut to 0 ..= 63.
///
/// Four outputs are a pass, of 3 · `inputs` times six words of weights: row by row, input by input, for the pixel to the left of
/// the input's, at it and to the right. Nothing is made where anything is short.
pub fn convolve(
    rows: [&[u8]; 3],
    [width, inputs]: [usize; 2],
    words: &[[u32; WORDS]],
    biases: &[i16],
    out: &mut [u8],
) {
    if inputs > 0 && inputs.is_multiple_of(4) {
        // SAFETY: `columns` takes fours of inputs.
        unsafe { passes(columns, rows, [width, inputs, inputs], words, biases, out) }
    }
}

/// The same over what is seen of a pixel: three inputs and a byte of 0, then the two words that its own sums begin with.
///
/// Rows that are no words in memory are no rows.
pub fn convolve_seen(rows: [&[u8]; 3], width: usize, words: &[[u32; WORDS]], biases: &[i16], out: &mut [u8]) {
    if rows.iter().all(|row| row.as_ptr().cast::<u32>().is_aligned()) && biases.len() == OUTPUTS {
        // SAFETY: `seen_columns` takes `SEEN` bytes a pixel, which are words, and `LIGHTS` of them times their weights.
        unsafe { passes(seen_columns, rows, [width, SEEN, LIGHTS], words, biases, out) }
    }
}

/// # Safety
///
/// `make` takes pixels of `size` bytes, not 0, and 3 · `inputs` times [`WORDS`] for a pass.
#[inline(always)]
unsafe fn passes(
    make: unsafe extern "C" fn(*const Pass),
    rows: [&[u8]; 3],
    [width, size, inputs]: [usize; 3],
    words: &[[u32; WORDS]],
    biases: &[i16],
    out: &mut [u8],
) {
    let outputs = biases.len();
    // No product of two of these wraps.
    let is_small = (width | size | outputs) >> 16 == 0;
    let is_short = rows.iter().any(|row| row.len() < width * size) || out.len() < width * outputs;
    if width == 0 || !is_small || is_short {
        return;
    }
    let (biases, _) = biases.as_chunks::<OUTPUTS>();
    let mut words = words;
    for (number, biases) in biases.iter().enumerate() {
        let Some((own, rest)) = words.split_at_checked(3 * inputs) else {
            return;
        };
        words = rest;
        let pass = Pass {
            rows: rows.map(<[u8]>::as_ptr),
            fours: size / 4,
            words: own.as_ptr().cast(),
            biases: biases.map(|bias| i32::from(bias) + 32),
            out: out.as_mut_ptr().wrapping_add(number * OUTPUTS),
            stride: outputs,
            left: width | 1 << 31,
        };
        // SAFETY: the caller's; all rows have `width` pixels, `out` has `outputs` bytes for each, and no pass writes behind them.
        unsafe { make(&pass) }
    }
}

/// The activation in r0, not 0, times the words at r3, which moves on, added to r8 to r12 and lr.
macro_rules! add {
    () => {
        concat!(
            "ldmia r3!, {{r4, r5, r6, r7}};",
            "muls r4, r0, r4; muls r5, r0, r5; muls r6, r0, r6; muls r7, r0, r7;",
            "add r8, r4; add r9, r5; add r10, r6; add r11, r7;",
            "ldmia r3!, {{r4, r5}};",
            "muls r4, r0, r4; muls r5, r0, r5;",
            "add r12, r4; add lr, r5;",
        )
    };
}

/// A function of a [`Pass`] from `$process`, which adds a column to the sums of the pixel before it (r8, r9), its own (r10, r11)
/// and the one behind it (r12, lr), and `$aside`, which is out of its way, and near.
macro_rules! pass {
    ({$($aside:tt)*} {$($process:tt)*}) => {
        naked_asm!(
            "push {{r4, r5, r6, r7, lr}}",
            save_upper!(),
            "sub sp, #{frame}",
            "mov r1, sp",
            "ldmia r0!, {{r2, r3, r4, r5, r6, r7}}; stmia r1!, {{r2, r3, r4, r5, r6, r7}}",
            "ldmia r0!, {{r2, r3, r4, r5, r6, r7}}; stmia r1!, {{r2, r3, r4, r5, r6, r7}}",
            "movs r0, #0; mov r8, r0; mov r9, r0; mov r10, r0; mov r11, r0; mov r12, r0; mov lr, r0",
            $($aside)*
            "10:",
            $($process)*
            "ldr r6, [sp, #{left}]; subs r6, #1; bmi 60f",
            "str r6, [sp, #{left}]",
            // The pixel before has all three columns.
            activate!("r8", "r9", "65", "50"),
            "ldr r6, [sp, #{left}]",
            "52:",
            "mov r8, r10; mov r9, r11; mov r10, r12; mov r11, lr",
            "movs r0, #0; mov r12, r0; mov lr, r0",
            "cmp r6, #1; bls 55f",
            "b 10b",
            "55: blo 58f",
            // The last column once more, for what lies behind the edge.
            "ldr r0, [sp, #{fours}]; lsls r0, r0, #2",
            "ldr r1, [sp, #{above}]; subs r1, r1, r0; str r1, [sp, #{above}]",
            "ldr r1, [sp, #{at}]; subs r1, r1, r0; str r1, [sp, #{at}]",
            "ldr r1, [sp, #{below}]; subs r1, r1, r0; str r1, [sp, #{below}]",
            "b 10b",
            "58:",
            "add sp, #{frame}",
            restore_upper!(),
            "pop {{r4, r5, r6, r7, pc}}",
            // The first column stands for the one before it, too, and no pixel is done.
            "60:",
            "lsls r6, r6, #1; lsrs r6, r6, #1; adds r6, #1; str r6, [sp, #{left}]",
            "add r10, r12; add r11, lr",
            "b 52b",
            cut!("65", "50"),
            above = const ROWS,
            at = const ROWS + 4,
            below = const ROWS + 8,
            fours = const FOURS,
            words = const FROM,
            biases = const BIASES,
            out = const OUT,
            stride = const STRIDE,
            left = const LEFT,
            frame = const FRAME,
        )
    };
}

/// r0: the pass.
///
/// # Safety
///
/// All in it points to what it says.
#[unsafe(naked)]
unsafe extern "C" fn columns(pass: *const Pass) {
    pass!({} {
        "ldr r3, [sp, #{words}]",
        "ldr r1, [sp, #{above}]; ldr r2, [sp, #{fours}]",
        run!({ add!() } "24"),
        "str r1, [sp, #{above}]",
        "ldr r1, [sp, #{at}]; ldr r2, [sp, #{fours}]",
        run!({ add!() } "24"),
        "str r1, [sp, #{at}]",
        "ldr r1, [sp, #{below}]; ldr r2, [sp, #{fours}]",
        run!({ add!() } "24"),
        "str r1, [sp, #{below}]",
    })
}

/// A row's light, three bytes in r2, from the lowest on.
macro_rules! light {
    () => {
        concat!(
            "uxtb r0, r2;",
            add!(),
            "lsrs r2, r2, #8; uxtb r0, r2;",
            add!(),
            "lsrs r0, r2, #8;",
            add!(),
        )
    };
}

/// r0: the pass, over what is seen.
///
/// # Safety
///
/// All in it points to what it says; pixels are whole words.
#[unsafe(naked)]
unsafe extern "C" fn seen_columns(pass: *const Pass) {
    pass!({
        "b 10f",
        // Black.
        "41: adds r3, #3 * 24; b 43f",
        "42: adds r3, #3 * 24; b 44f",
    } {
        "ldr r3, [sp, #{words}]",
        "ldr r1, [sp, #{above}]; ldr r2, [r1]; adds r1, #12; str r1, [sp, #{above}]",
        "cmp r2, #0; beq 41b",
        light!(),
        // The middle one has the pixel's own sums, too.
        "43:",
        "ldr r1, [sp, #{at}]; ldmia r1!, {{r2, r4, r5}}; str r1, [sp, #{at}]",
        "add r10, r4; add r11, r5",
        "cmp r2, #0; beq 42b",
        light!(),
        "44:",
        "ldr r1, [sp, #{below}]; ldr r2, [r1]; adds r1, #12; str r1, [sp, #{below}]",
        "cmp r2, #0; beq 45f",
        light!(),
        "45:",
    })
}
