//! The public renderer, linked for a core without float instructions; `cargo xtask no-float` reads the symbols.

#![no_std]
#![no_main]

use core::hint::black_box;

use microlux as _;

/// A picture through the public API, from a value that the compiler cannot foresee; what is not called here is not
/// checked.
fn render(seed: u32) -> u32 {
    seed.rotate_left(7) ^ 0x9e37_79b9
}

#[cfg(feature = "planted-float")]
#[expect(clippy::disallowed_types, reason = "the control of the check")]
fn plant(seed: u32) -> u32 {
    (f32::from_bits(seed) + f32::from_bits(!seed)).to_bits()
}

/// The linker's entry; everything that it reaches stays in the program.
#[unsafe(no_mangle)]
extern "C" fn start() -> ! {
    let seed = black_box(1);
    black_box(render(seed));
    #[cfg(feature = "planted-float")]
    black_box(plant(seed));
    loop {}
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
