//! The public renderer, linked for a core without float instructions; `cargo xtask no-float` reads the symbols.

#![no_std]
#![no_main]

use core::hint::black_box;

use microlux::camera::Camera;
use microlux::color::{Radiance, albedo};
use microlux::geom::point;
use microlux::integrator::Path;
use microlux::light::Light;
use microlux::material::Material;
use microlux::num::{Share, Turn};
use microlux::q;
use microlux::render::{Renderer, Settings};
use microlux::sampler::Sobol;
use microlux::scene::SceneBuilder;
use microlux::shape::Sphere;

/// A picture through the public API, from a seed that the compiler cannot foresee. What is not called is not checked.
fn render(seed: u32) -> Option<Radiance> {
    let mut builder = SceneBuilder::<4, 4, 4>::new();
    let unit = builder.unit();
    let red = albedo(q!(0.61, Share), q!(0.06, Share), q!(0.06, Share));
    let red = builder.material(Material::lambert(red)).ok()?;
    let white = Radiance::new(q!(1), q!(1), q!(1));
    let origin = unit.point(q!(0), q!(0), q!(0));
    let sphere = Sphere {
        center: unit.point(q!(0), q!(1), q!(-3)),
        radius: unit.length(q!(1)),
    };
    builder.shape(sphere, red).ok()?;
    builder
        .light(Light::Point {
            position: point(q!(0), q!(5), q!(0)),
            intensity: white,
        })
        .ok()?;
    builder.light(Light::Environment { radiance: white }).ok()?;
    let scene = builder.build().ok()?;
    let camera = Camera::look_at(
        origin,
        sphere.center,
        [0, 1, 0],
        Camera::tan_half(Turn::from_bits(seed)),
    )?;
    let settings = Settings {
        width: 32,
        height: 32,
        spp: 16,
    };
    Some(Renderer::new(&scene, camera, Path::new(8), Sobol::new(seed), settings).pixel(5, 7))
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
