//! The public renderer, linked for a core without float instructions; `cargo xtask no-float` reads the symbols.

#![no_std]
#![no_main]

use core::hint::black_box;

use microlux::color::Radiance;
use microlux::geom::Dir;
use microlux::q;
use microlux::sampler::{Sampler, Sobol, warp};

/// A picture through the public API, from a seed that the compiler cannot foresee. What is not called is not checked.
fn render(seed: u32) -> Radiance {
    let mut sampler = Sobol::new(seed);
    let light = Dir([0, 0, 1 << 16]);
    let mut sum = Radiance::new(q!(0), q!(0), q!(0));
    for sample in 0..16 {
        sampler.start(3, 5, sample);
        let wi = warp::sample_cosine_hemisphere(sampler.next_2d());
        let cos = wi.reflect(light).dot(light);
        sum = sum
            .add(Radiance::new(q!(0.5), q!(0.25), q!(0.125)).scale(warp::pdf_cosine_hemisphere(cos.abs())));
    }
    sum
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
