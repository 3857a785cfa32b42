use core::arch::naked_asm;
use core::marker::PhantomData;

/// Two rows of pixels, of three words each, and of their lights, of which pixels between them are made.
///
/// A pixel's second word has an albedo below a distance in its highest byte, its third what is seen. A light has three
/// mantissas of nine bits below an exponent of five.
#[repr(C)]
pub struct Upsample<'a> {
    near: *const [u32; 3],
    far: *const [u32; 3],
    near_light: *const u32,
    far_light: *const u32,
    fall: &'a [u8; 64],
    recips: &'a [u16; 128],
    width: usize,
    rows: PhantomData<&'a [u32]>,
}

impl<'a> Upsample<'a> {
    /// The row that counts three times as much, and the other one. `fall` has weights by differences, `recips` first
    /// guesses 2^47/n by n's seven bits below the top one.
    #[inline]
    pub fn new(
        [near, far]: [&'a [[u32; 3]]; 2],
        [near_light, far_light]: [&'a [u32]; 2],
        fall: &'a [u8; 64],
        recips: &'a [u16; 128],
    ) -> Upsample<'a> {
        Upsample {
            near: near.as_ptr(),
            far: far.as_ptr(),
            near_light: near_light.as_ptr(),
            far_light: far_light.as_ptr(),
            fall,
            recips,
            width: near
                .len()
                .min(far.len())
                .min(near_light.len())
                .min(far_light.len()),
            rows: PhantomData,
        }
    }

    /// Shows the two pixels between the columns `left` and the next, by their own pixels: each one's light, the mean of the
    /// four about it by what they have of its thing, times its albedo, with what it is of: its number, its distance, [`MIDDLE`].
    ///
    /// Answers with 1 for the first and 2 for the second, if they are shown: not where one shines, where none is of its
    /// thing, where a number does not fit, or where the turn between two normals is not in `turns`: a pixel's below a guide's,
    /// and the turn, at place 0x9e3779b1 times the former, its upper two bits.
    #[inline]
    pub fn between(
        &self,
        left: usize,
        guides: &[[u32; 3]; 2],
        shown: &mut [[u32; 2]; 2],
        turns: &[[u32; 2]; 4],
    ) -> u32 {
        if left >= self.width || left + 1 >= self.width {
            return 0;
        }
        // SAFETY: both columns are in all of the rows.
        unsafe { pair(self, left, guides, shown, turns) }
    }
}

/// Tells that a pixel's place is its middle.
pub const MIDDLE: u32 = 254;

/// On to `$on` if it shines: white, and not infinitely far.
#[rustfmt::skip]
macro_rules! shines {
    ($seen:literal, $with:literal, $on:literal) => {
        concat!("adds ", $with, ", ", $seen, ", #1; beq 9f; lsls ", $with, ", ", $with, ", #8; beq ", $on, "; 9:")
    };
}

/// A light's channels, times 2^9 and under the exponent in r5, to `$to` on the stack.
#[rustfmt::skip]
macro_rules! unpack {
    ($light:literal, $to:literal) => {
        concat!(
            "lsrs r3, ", $light, ", #27; subs r3, r5, r3;",
            "lsls r0, ", $light, ", #23; lsrs r0, r0, #14; lsrs r0, r3;",
            "lsls r1, ", $light, ", #14; lsrs r1, r1, #23; lsls r1, r1, #9; lsrs r1, r3;",
            "lsls r2, ", $light, ", #5; lsrs r2, r2, #23; lsls r2, r2, #9; lsrs r2, r3;",
            "add r3, sp, #", $to, "; stmia r3!, {{r0, r1, r2}};",
        )
    };
}

/// What the pixel at r4 is unlike in by distance and albedo, eighths of a half-life, in r1; in r2 what is seen.
#[rustfmt::skip]
macro_rules! apart {
    () => {
        concat!(
            "ldmia r4!, {{r0, r2}}; lsrs r1, r0, #24; subs r1, r1, r5; bpl 9f; rsbs r1, r1, #0; 9: lsls r1, r1, #2;",
            "eors r0, r6; lsls r0, r0, #8; beq 9f; adds r1, #16; 9:",
        )
    };
}

/// On to 44 if the lowest bytes are more than eight apart.
#[rustfmt::skip]
macro_rules! few {
    ($a:literal, $b:literal) => {
        concat!("sxtb r2, ", $a, "; sxtb r3, ", $b, "; subs r2, r2, r3; adds r2, #8; cmp r2, #16; bhi 44f;")
    };
}

/// The light at r4 onto the sums, by the weight for r1, of which `$share` makes a share by r0; `$add` is how sums begin or go
/// on.
#[rustfmt::skip]
macro_rules! sum {
    ($share:literal, $add:literal) => {
        concat!(
            "ldrb r1, [r7, r1];", $share, $add, " r12, r1; ldmia r4!, {{r0, r2, r3}};",
            "muls r0, r1, r0; ", $add, " r8, r0; muls r2, r1, r2; ", $add, " r9, r2; muls r3, r1, r3; ", $add, " r10, r3;",
        )
    };
}

/// A pixel and its light onto the sums where all see the same: on to 39 if it is not alike enough.
#[rustfmt::skip]
macro_rules! same {
    ($share:literal, $add:literal) => {
        concat!(apart!(), "cmp r1, #32; blo 9f; b 39b; 9:", sum!($share, $add))
    };
}

/// The same of any.
#[rustfmt::skip]
macro_rules! any {
    ($share:literal, $add:literal) => {
        concat!(
            apart!(),
            "ldr r3, [sp, #116]; cmp r2, r3; beq 9f; bl 46f; 9: cmp r1, #48; bls 9f; movs r1, #48; 9:",
            sum!($share, $add),
        )
    };
}

/// All four pixels, by 9 : 3 : 3 : 1: those of the column at r4, then those of the column in r11.
#[rustfmt::skip]
macro_rules! nine_three_three_one {
    ($one:ident) => {
        concat!(
            $one!("lsls r0, r1, #3; adds r1, r1, r0;", "mov"),
            $one!("lsls r0, r1, #1; adds r1, r1, r0;", "add"),
            "mov r4, r11;",
            $one!("lsls r0, r1, #1; adds r1, r1, r0;", "add"),
            $one!("", "add"),
        )
    };
}

/// 3 · `$a` + `$b` in `$a`, by r0.
#[rustfmt::skip]
macro_rules! three_to_one {
    ($a:literal, $b:literal) => {
        concat!("lsls r0, ", $a, ", #1; adds ", $a, ", ", $a, ", r0; adds ", $a, ", ", $a, ", ", $b, ";")
    };
}

/// The high word of `$a` times r6·2^16 + r7.
#[rustfmt::skip]
macro_rules! high {
    ($a:literal) => {
        concat!(
            "uxth r4, ", $a, "; lsrs ", $a, ", ", $a, ", #16;",
            "movs r5, r4; muls r5, r7, r5; muls r4, r6, r4; movs r3, ", $a, "; muls r3, r7, r3; muls ", $a, ", r6, ", $a, ";",
            "adds r4, r4, r3; bcc 9f; movs r3, #1; lsls r3, r3, #16; adds ", $a, ", ", $a, ", r3; 9:",
            "lsls r3, r4, #16; lsrs r4, r4, #16; adds r5, r5, r3; adcs ", $a, ", r4;",
        )
    };
}

/// `$channel` times the share whose code is r5's lowest byte: its square times r6, half of r7 up.
#[rustfmt::skip]
macro_rules! shade {
    ($channel:literal) => {
        concat!(
            "uxtb r3, r5; muls r3, r3, r3; muls r3, r6, r3; adds r3, r3, r7; lsrs r3, r3, #16;",
            "muls ", $channel, ", r3, ", $channel, "; lsrs r5, r5, #8;",
        )
    };
}

/// r0: rows; r1: the left column; r2: guides; r3: what is shown; then the turns. Answers as [`Upsample::between`].
///
/// Of the stack: two columns of two pixels, each its second and third words and its light's channels; then rows, guides,
/// what is shown, whether all see the same (0), the distance if all are alike (else 256), the largest exponent, what is answered, the
/// albedo if all have one (else 0), the nearer column, what the guide sees, 0 if all lights are black. Upper registers: sums of
/// red, green, blue; the farther column; the sum of weights.
///
/// # Safety
///
/// Both columns are in both rows, and so are their lights.
#[unsafe(naked)]
unsafe extern "C" fn pair(
    rows: &Upsample,
    left: usize,
    guides: &[[u32; 3]; 2],
    shown: &mut [[u32; 2]; 2],
    turns: &[[u32; 2]; 4],
) -> u32 {
    naked_asm!(
        "push {{r4, r5, r6, r7, lr}}",
        save_upper!(),
        "sub sp, #124",
        "movs r4, #3",
        "str r4, [sp, #104]",
        "add r5, sp, #80",
        "stmia r5!, {{r0, r2, r3}}",
        "ldmia r0!, {{r4, r5, r6, r7}}",
        "movs r3, #12",
        "muls r3, r1, r3",
        "adds r4, r4, r3",
        "adds r5, r5, r3",
        "lsls r1, r1, #2",
        "adds r6, r6, r1",
        "adds r7, r7, r1",
        // Do all see the same? None shines.
        "ldr r0, [r4, #8]",
        "ldr r1, [r5, #8]",
        "ldr r2, [r4, #20]",
        "ldr r3, [r5, #20]",
        "str r0, [sp, #4]",
        "str r1, [sp, #24]",
        "str r2, [sp, #44]",
        "str r3, [sp, #64]",
        "eors r1, r0",
        "eors r2, r0",
        "eors r3, r0",
        "orrs r1, r2",
        "orrs r1, r3",
        "str r1, [sp, #92]",
        "ldr r0, [r4, #4]",
        "ldr r1, [r5, #4]",
        "ldr r2, [r4, #16]",
        "ldr r3, [r5, #16]",
        "str r0, [sp]",
        "str r1, [sp, #20]",
        "str r2, [sp, #40]",
        "str r3, [sp, #60]",
        shines!("r0", "r4", "31f"),
        shines!("r1", "r4", "31f"),
        shines!("r2", "r4", "31f"),
        shines!("r3", "r4", "31f"),
        // Are they alike in all? Of one albedo? A bit above it tells that there is one.
        "eors r1, r0",
        "eors r2, r0",
        "eors r3, r0",
        "orrs r1, r2",
        "orrs r1, r3",
        "lsrs r4, r0, #24",
        "ldr r2, [sp, #92]",
        "orrs r2, r1",
        "beq 20f",
        "movs r4, #1",
        "lsls r4, r4, #8",
        "20:",
        "str r4, [sp, #96]",
        "movs r2, #1",
        "lsls r2, r2, #24",
        "orrs r0, r2",
        "lsls r1, r1, #8",
        "beq 20f",
        "movs r0, #0",
        "20:",
        "str r0, [sp, #108]",
        // Lights under the largest exponent.
        "ldmia r6, {{r4, r6}}",
        "ldmia r7, {{r2, r7}}",
        "mov r12, r2",
        "lsrs r5, r4, #27",
        "lsrs r0, r6, #27",
        "cmp r5, r0",
        "bhs 20f",
        "movs r5, r0",
        "20:",
        "lsrs r0, r7, #27",
        "cmp r5, r0",
        "bhs 20f",
        "movs r5, r0",
        "20:",
        "lsrs r0, r2, #27",
        "cmp r5, r0",
        "bhs 20f",
        "movs r5, r0",
        "b 20f",
        "31:",
        "b 30f",
        "20:",
        "str r5, [sp, #100]",
        "orrs r2, r4",
        "orrs r2, r6",
        "orrs r2, r7",
        "lsls r2, r2, #5",
        "str r2, [sp, #120]",
        unpack!("r4", "8"),
        "mov r4, r12",
        unpack!("r4", "28"),
        unpack!("r6", "48"),
        unpack!("r7", "68"),
        "mov r4, sp",
        "b 41f",
        "30:",
        "movs r0, #0",
        "b 32f",
        // Not this pixel.
        "39:",
        "ldr r4, [sp, #112]",
        "mov r0, sp",
        "subs r4, r4, r0",
        "lsrs r4, r4, #5",
        "movs r0, #1",
        "lsls r0, r4",
        "ldr r4, [sp, #104]",
        "bics r4, r0",
        "str r4, [sp, #104]",
        "b 40f",
        "33:",
        "ldr r0, [sp, #104]",
        "32:",
        "add sp, #124",
        restore_upper!(),
        "pop {{r4, r5, r6, r7, pc}}",
        // The next pixel.
        "40:",
        "ldr r4, [sp, #112]",
        "mov r0, sp",
        "cmp r4, r0",
        "bne 33b",
        "adds r4, #40",
        "ldr r0, [sp, #84]",
        "adds r0, #12",
        "str r0, [sp, #84]",
        "ldr r0, [sp, #88]",
        "adds r0, #8",
        "str r0, [sp, #88]",
        "41:",
        "str r4, [sp, #112]",
        "ldr r0, [sp, #84]",
        "ldr r6, [r0, #4]",
        "ldr r1, [r0, #8]",
        shines!("r6", "r0", "39b"),
        "add r0, sp, #40",
        "subs r0, r0, r4",
        "add r0, sp",
        "mov r11, r0",
        "lsrs r5, r6, #24",
        "lsrs r0, r1, #16",
        "lsls r0, r0, #16",
        "lsls r2, r5, #8",
        "orrs r0, r2",
        "adds r0, #{middle}",
        "ldr r2, [sp, #88]",
        "str r0, [r2, #4]",
        "ldr r2, [sp, #92]",
        "ldr r3, [sp, #4]",
        "eors r3, r1",
        "orrs r2, r3",
        "beq 42f",
        "b 45f",
        "42:",
        "ldr r1, [sp, #96]",
        "cmp r1, r5",
        "bne 50f",
        // 9 : 3 : 3 : 1, if 16 bits have them exactly.
        "adds r4, #8",
        "ldmia r4!, {{r1, r2, r3}}",
        "adds r4, #8",
        "ldmia r4!, {{r5, r6, r7}}",
        three_to_one!("r1", "r5"),
        three_to_one!("r2", "r6"),
        three_to_one!("r3", "r7"),
        "mov r4, r11",
        "adds r4, #28",
        "ldmia r4!, {{r5, r6, r7}}",
        three_to_one!("r1", "r5"),
        three_to_one!("r2", "r6"),
        three_to_one!("r3", "r7"),
        "subs r4, #32",
        "ldmia r4!, {{r5, r6, r7}}",
        three_to_one!("r5", "r1"),
        three_to_one!("r6", "r2"),
        three_to_one!("r7", "r3"),
        "movs r0, r5",
        "orrs r0, r6",
        "orrs r0, r7",
        "lsls r0, r0, #26",
        "bne 49f",
        "lsrs r0, r5, #6",
        "lsrs r1, r6, #6",
        "lsrs r2, r7, #6",
        "ldr r4, [sp, #100]",
        "adds r4, #23",
        "b 60f",
        "49:",
        "ldr r4, [sp, #112]",
        "ldr r0, [sp, #84]",
        "ldr r6, [r0, #4]",
        "lsrs r5, r6, #24",
        // Weights by distance and albedo: what all have tells none apart.
        "50:",
        "ldr r0, [sp, #108]",
        "cmp r0, #0",
        "beq 51f",
        "movs r6, r0",
        "51:",
        "ldr r7, [sp, #80]",
        "ldr r7, [r7, #16]",
        nine_three_three_one!(same),
        "mov r0, r12",
        "b 48f",
        // Weights by all that tells apart, one thing from another, too.
        "45:",
        "str r1, [sp, #116]",
        "ldr r0, [sp, #120]",
        "cmp r0, #0",
        "bne 44f",
        // All four are black. So is what is between them, if the nearest is of its thing: of its number, seen alike, and turned
        // by few steps, which tell less apart than a number does.
        "ldr r0, [r4]",
        "cmp r0, r6",
        "bne 44f",
        "ldr r0, [r4, #4]",
        "lsrs r2, r0, #16",
        "lsrs r3, r1, #16",
        "cmp r2, r3",
        "bne 44f",
        few!("r0", "r1"),
        "lsrs r0, r0, #8",
        "lsrs r1, r1, #8",
        few!("r0", "r1"),
        "b 69f",
        "44:",
        "ldr r7, [sp, #80]",
        "ldr r7, [r7, #16]",
        nine_three_three_one!(any),
        // Maybe none of these is of the pixel's thing.
        "mov r0, r12",
        "cmp r0, #64",
        "bhi 48f",
        "47:",
        "b 39b",
        // Onto the eighths in r1 what a number and a turn add: r2 and r3 are what is seen. Back there by lr.
        "46:",
        "eors r2, r3",
        "lsrs r0, r2, #16",
        "beq 2f",
        "adds r1, #32",
        "2:",
        "lsls r2, r2, #16",
        "beq 3f",
        "cmp r1, #48",
        "bhs 3f",
        "lsrs r2, r2, #16",
        "eors r2, r3",
        "uxth r2, r2",
        "lsls r0, r3, #16",
        "orrs r2, r0",
        "ldr r0, 92f",
        "muls r0, r2, r0",
        "lsrs r0, r0, #30",
        "lsls r0, r0, #3",
        "ldr r3, [sp, #160]",
        "adds r0, r0, r3",
        "ldmia r0, {{r0, r3}}",
        "cmp r0, r2",
        "bne 47b",
        "lsls r3, r3, #1",
        "adds r1, r1, r3",
        "3:",
        "bx lr",
        "48:",
        // 1/weight: of 2^21 and more times it the top 16 bits are all there is.
        "movs r3, #21",
        "lsls r0, r0, #21",
        "bmi 53f",
        "52:",
        "adds r3, #1",
        "lsls r0, r0, #1",
        "bpl 52b",
        "53:",
        "ldr r7, [sp, #80]",
        "ldr r7, [r7, #20]",
        "lsls r1, r0, #1",
        "lsrs r1, r1, #25",
        "lsls r1, r1, #1",
        "ldrh r1, [r7, r1]",
        "lsrs r0, r0, #16",
        // 2^31 less the product, twice.
        "movs r2, r0",
        "muls r2, r1, r2",
        "rsbs r2, r2, #0",
        "lsls r2, r2, #1",
        "asrs r2, r2, #10",
        "muls r2, r1, r2",
        "asrs r2, r2, #22",
        "adds r1, r1, r2",
        "muls r0, r1, r0",
        "rsbs r0, r0, #0",
        "lsls r0, r0, #1",
        "adds r0, #2",
        "asrs r0, r0, #2",
        "lsrs r2, r1, #1",
        "muls r0, r2, r0",
        "asrs r0, r0, #14",
        "lsls r1, r1, #15",
        "adds r0, r0, r1",
        "lsls r0, r0, #1",
        "lsrs r6, r0, #16",
        "uxth r7, r0",
        // The sums, the largest with its top bit.
        "mov r0, r8",
        "mov r1, r9",
        "mov r2, r10",
        "movs r4, r0",
        "orrs r4, r1",
        "orrs r4, r2",
        "beq 58f",
        "movs r5, #4",
        "lsls r4, r4, #4",
        "bmi 55f",
        "54:",
        "adds r5, #1",
        "lsls r4, r4, #1",
        "bpl 54b",
        "55:",
        "lsls r0, r5",
        "lsls r1, r5",
        "lsls r2, r5",
        "subs r3, r3, r5",
        "mov r11, r3",
        high!("r0"),
        high!("r1"),
        high!("r2"),
        // To 16 bits.
        "movs r4, r0",
        "orrs r4, r1",
        "orrs r4, r2",
        "lsrs r4, r4, #31",
        "adds r4, #14",
        "lsrs r0, r4",
        "lsrs r1, r4",
        "lsrs r2, r4",
        "adds r0, #1",
        "adds r1, #1",
        "adds r2, #1",
        "lsrs r0, r0, #1",
        "lsrs r1, r1, #1",
        "lsrs r2, r2, #1",
        "movs r5, r0",
        "orrs r5, r1",
        "orrs r5, r2",
        "lsrs r5, r5, #16",
        "bne 59f",
        "add r4, r11",
        "ldr r3, [sp, #100]",
        "adds r4, r4, r3",
        "subs r4, #9",
        "b 60f",
        "58:",
        "b 69f",
        "59:",
        "b 39b",
        // Times the albedo: red, green, blue in r0, r1, r2 of 16 bits.
        "60:",
        "ldr r3, [sp, #84]",
        "ldr r5, [r3, #4]",
        "ldr r6, 90f",
        "movs r7, #128",
        "lsls r7, r7, #8",
        shade!("r0"),
        shade!("r1"),
        shade!("r2"),
        "movs r3, r0",
        "orrs r3, r1",
        "orrs r3, r2",
        "beq 69f",
        "movs r5, #0",
        "lsls r3, r3, #1",
        "bmi 62f",
        "61:",
        "adds r5, #1",
        "lsls r3, r3, #1",
        "bpl 61b",
        "62:",
        "lsls r0, r5",
        "lsls r1, r5",
        "lsls r2, r5",
        "subs r4, r4, r5",
        "subs r4, #23",
        "cmp r4, #31",
        "bhs 65f",
        // Halves up to 16 bits and then to nine.
        "ldr r6, 91f",
        "adds r0, r0, r6",
        "adds r1, r1, r6",
        "adds r2, r2, r6",
        "lsrs r0, r0, #22",
        "lsrs r1, r1, #22",
        "lsrs r2, r2, #22",
        "movs r3, r0",
        "orrs r3, r1",
        "orrs r3, r2",
        "lsrs r3, r3, #9",
        "bne 59b",
        "lsls r4, r4, #27",
        "orrs r0, r4",
        "63:",
        "lsls r1, r1, #9",
        "orrs r0, r1",
        "lsls r2, r2, #18",
        "orrs r0, r2",
        "64:",
        "ldr r3, [sp, #88]",
        "str r0, [r3]",
        "b 40b",
        "69:",
        "movs r0, #0",
        "b 64b",
        // Steps end here: to 16 bits, and then to as many as there are.
        "65:",
        "movs r3, #6",
        "subs r3, r3, r4",
        "cmp r3, #31",
        "bhi 59b",
        "lsrs r7, r7, #1",
        "adds r0, r0, r7",
        "adds r1, r1, r7",
        "adds r2, r2, r7",
        "lsrs r0, r0, #15",
        "lsrs r1, r1, #15",
        "lsrs r2, r2, #15",
        "movs r5, r0",
        "orrs r5, r1",
        "orrs r5, r2",
        "lsrs r5, r5, #16",
        "bne 59b",
        "lsrs r0, r3",
        "lsrs r1, r3",
        "lsrs r2, r3",
        "adds r0, #1",
        "adds r1, #1",
        "adds r2, #1",
        "lsrs r0, r0, #1",
        "lsrs r1, r1, #1",
        "lsrs r2, r2, #1",
        "b 63b",
        ".balign 4",
        "90: .word 33026",
        "91: .word 0x204000",
        "92: .word 0x9e3779b1",
        middle = const MIDDLE,
    )
}
