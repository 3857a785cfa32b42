//! The public renderer, linked for a core without float instructions; `cargo xtask no-float` reads the symbols.

#![no_std]
#![no_main]

use core::convert::Infallible;
use core::hint::black_box;

use embedded_graphics::pixelcolor::{BinaryColor, Gray8, Rgb565, Rgb666, Rgb888};
use embedded_graphics::prelude::*;
use microlux::bvh::{Node, build_mesh};
use microlux::camera::Camera;
use microlux::color::{Radiance, albedo};
use microlux::film::{Display, DisplayColor, Dither, ToneMap};
use microlux::geom::point;
use microlux::integrator::Path;
use microlux::light::Light;
use microlux::material::Material;
use microlux::num::{Share, Turn};
use microlux::q;
use microlux::render::{Renderer, Settings};
use microlux::sampler::{AnySampler, Independent, Sobol, Stratified};
use microlux::scene::{Mesh, SceneBuilder};
use microlux::shape::{Attributes, Geometry, Grid, Sphere, TriangleMesh};

/// A picture through the public API, from a seed that the compiler cannot foresee. What is not called is not checked.
fn render(seed: u32) -> Option<()> {
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
        .emitter(
            Sphere {
                center: origin,
                ..sphere
            },
            red,
            white,
        )
        .ok()?;
    builder
        .light(Light::Point {
            position: point(q!(0), q!(5), q!(0)),
            intensity: white,
        })
        .ok()?;
    builder.light(Light::Environment { radiance: white }).ok()?;

    let vertices = [
        [1000, 1000, 1000],
        [9000, 1000, 1000],
        [1000, 9000, 1000],
        [1000, 1000, 9000],
    ];
    let mut triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mut mesh_nodes = [Node::EMPTY; 4];
    let used = build_mesh(&vertices, &mut triangles, &mut mesh_nodes).ok()?;
    let triangles = TriangleMesh {
        grid: Grid::new(origin, 0)?,
        vertices: &vertices,
        triangles: &triangles,
        attributes: Attributes::NONE,
    };
    let meshes = [Mesh {
        triangles: triangles.into(),
        nodes: &mesh_nodes[..used],
    }];
    builder.shape(Geometry::Mesh(0), red).ok()?;

    let mut nodes = [Node::EMPTY; 8];
    let scene = builder.build_with(&meshes, &mut nodes).ok()?;
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
    let sampler = match seed % 3 {
        0 => AnySampler::Independent(Independent::new(seed)),
        1 => AnySampler::Stratified(Stratified::new(seed, settings.spp)),
        _ => AnySampler::Sobol(Sobol::new(seed)),
    };
    let mut renderer = Renderer::new(&scene, camera, Path::new(8), sampler, settings);
    let mut strip = [Radiance::BLACK; 64];
    while let Some(tile) = renderer.step(&mut strip) {
        let display = black_box(Display {
            tone_map: ToneMap::Filmic,
            dither: Dither::BlueNoise,
            ..Display::default()
        });
        tile.draw(&mut Sink::<Rgb565>::default(), &display).ok()?;
        tile.draw(&mut Sink::<Rgb666>::default(), &display).ok()?;
        tile.draw(&mut Sink::<Rgb888>::default(), &display).ok()?;
        tile.draw(&mut Sink::<Gray8>::default(), &display).ok()?;
        tile.draw(&mut Sink::<BinaryColor>::default(), &display).ok()?;
    }
    Some(())
}

/// A display that takes every pixel and shows none.
#[derive(Default)]
struct Sink<C>(core::marker::PhantomData<C>);

impl<C: DisplayColor> OriginDimensions for Sink<C> {
    fn size(&self) -> Size {
        Size::new(32, 32)
    }
}

impl<C: DisplayColor> DrawTarget for Sink<C> {
    type Color = C;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<C>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for pixel in pixels {
            black_box(pixel);
        }
        Ok(())
    }
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
