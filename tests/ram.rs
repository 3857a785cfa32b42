//! What it takes to render: everything on one stack, and that stack measured.
//!
//! On the host, where pointers are twice as wide as on a microcontroller, and with the checks of a test build: the chip
//! takes less.

#![cfg(target_os = "linux")]

use core::convert::Infallible;
use core::ffi::c_void;
use core::hint::black_box;
use core::mem::size_of_val;

use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Size};
use embedded_graphics::pixelcolor::{IntoStorage, Rgb565};
use embedded_graphics::{Pixel, prelude::Point};
use microlux::bvh::{Node, max_nodes};
use microlux::camera::Camera;
use microlux::color::Radiance;
use microlux::film::Display;
use microlux::integrator::{Bdpt, Integrator, Path};
use microlux::render::{Renderer, Settings};
use microlux::sampler::{Sobol, Stratified};
use microlux::scene::Scene;
use microlux::scene::builtin::spheres;

const WIDTH: usize = 240;
/// What all of it may take, bytes.
const LIMIT: usize = 12 * 1024;

/// A display that adds up what it is sent.
struct Sum(u32);

impl OriginDimensions for Sum {
    fn size(&self) -> Size {
        Size::new(WIDTH as u32, WIDTH as u32)
    }
}

impl DrawTarget for Sum {
    type Color = Rgb565;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb565>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(Point { x, y }, color) in pixels {
            self.0 = self.0.wrapping_add(color.into_storage() as u32 ^ (x + y) as u32);
        }
        Ok(())
    }
}

/// The sizes of what lives as long as the render does, bytes.
#[derive(Default)]
struct Parts([(&'static str, usize); 5]);

/// Builds the scene of ten shapes, renders some strips of `N` pixels and draws them, as firmware would.
#[inline(never)]
fn render<const N: usize>(parts: &mut Parts) {
    let Ok((mut builder, camera)) = spheres() else {
        return;
    };
    let builder_size = size_of_val(&builder);
    let mut nodes = [Node::EMPTY; max_nodes(10)];
    let nodes_size = size_of_val(&nodes);
    let Ok(scene) = builder.build(&mut nodes) else {
        return;
    };
    let settings = Settings {
        width: WIDTH as u16,
        height: 24,
        spp: 1,
    };
    let mut strip = [Radiance::BLACK; N];
    let mut sum = Sum(0);
    let mut renderer = Renderer::new(&scene, camera, Path::new(12), Sobol::new(1), settings);
    *parts = Parts([
        ("scene builder", builder_size),
        ("tree", nodes_size),
        ("scene", size_of_val(&scene)),
        ("renderer", size_of_val(&renderer)),
        ("strip", size_of_val(&strip)),
    ]);
    while let Some(tile) = renderer.step(&mut strip) {
        let Ok(()) = tile.draw(&mut sum, &Display::default());
    }
    // The other sampler is the larger.
    let mut renderer = Renderer::new(&scene, camera, Path::new(12), Stratified::new(1, 1), settings);
    while let Some(tile) = renderer.step(&mut strip) {
        let Ok(()) = tile.draw(&mut sum, &Display::default());
    }
    black_box(sum.0);
}

const PAINT: u8 = 0xa5;
const STACK: usize = 256 * 1024;

/// Memory that a thread may have as its stack.
#[repr(align(4096))]
struct Stack([u8; STACK]);

/// Bytes of its stack that a thread wrote to while it ran `work`, what the system needs to start one included.
fn painted(work: &mut dyn FnMut()) -> usize {
    extern "C" fn entry(work: *mut c_void) -> *mut c_void {
        // SAFETY: `painted` passes a pointer to its own `work`, and waits for this thread.
        let work = unsafe { &mut *work.cast::<&mut dyn FnMut()>() };
        work();
        core::ptr::null_mut()
    }
    let mut stack = vec![Stack([PAINT; STACK])];
    let mut work: &mut dyn FnMut() = work;
    // SAFETY: the attributes are initialised before use; the stack is aligned, writable, and lives until the thread that
    // runs on it was joined; `work` lives as long, and nothing else touches either meanwhile.
    unsafe {
        let mut attributes: libc::pthread_attr_t = core::mem::zeroed();
        let mut thread: libc::pthread_t = core::mem::zeroed();
        assert_eq!(libc::pthread_attr_init(&mut attributes), 0);
        assert_eq!(
            libc::pthread_attr_setstack(&mut attributes, stack.as_mut_ptr().cast(), STACK),
            0
        );
        let argument = (&raw mut work).cast();
        assert_eq!(libc::pthread_create(&mut thread, &attributes, entry, argument), 0);
        assert_eq!(libc::pthread_join(thread, core::ptr::null_mut()), 0);
        libc::pthread_attr_destroy(&mut attributes);
    }
    let untouched = stack[0].0.iter().take_while(|byte| **byte == PAINT).count();
    STACK - untouched
}

/// RAM of rendering in strips of `N` pixels, all told.
fn measure<const N: usize>() -> usize {
    let mut parts = Parts::default();
    let idle = painted(&mut || ());
    let all = painted(&mut || render::<N>(&mut parts)) - idle;
    let held: usize = parts.0.iter().map(|(_, size)| size).sum();
    println!("strips of {} x {}:", WIDTH, N / WIDTH);
    for (name, size) in parts.0 {
        assert!(size > 0, "the scene was not built");
        println!("{size:>8}  {name}");
    }
    println!("{:>8}  stack beside these\n{all:>8}  bytes in all", all - held);
    all
}

#[test]
fn ten_shapes_on_a_strip_of_240_pixels() {
    let one_row = measure::<WIDTH>();
    assert!(one_row <= LIMIT, "{one_row} bytes are more than {LIMIT}");
    // And what the measurement sees is the strip's size.
    let two_rows = measure::<{ 2 * WIDTH }>();
    let row = WIDTH * size_of::<Radiance>();
    assert!(
        (two_rows - one_row).abs_diff(row) < 64,
        "a row more took {}",
        two_rows - one_row
    );
    assert!(two_rows <= LIMIT, "{two_rows} bytes are more than {LIMIT}");
}

/// What was written and released counts as well.
#[test]
fn the_measure_measures() {
    #[inline(never)]
    fn fill<const N: usize>() {
        black_box(&mut [1u8; N]);
    }
    let small = painted(&mut || fill::<1000>());
    let large = painted(&mut || fill::<50_000>());
    assert!((large - small).abs_diff(49_000) < 200, "{small} {large}");
}

/// Some pixels by one integrator; never inlined, so that its stack is its own.
#[inline(never)]
fn pixels<I: Integrator>(scene: &Scene, camera: Camera, integrator: I) {
    let settings = Settings {
        width: 8,
        height: 8,
        spp: 4,
    };
    let mut strip = [Radiance::BLACK; 64];
    let mut renderer = Renderer::new(scene, camera, integrator, Sobol::new(1), settings);
    while let Some(tile) = renderer.step(&mut strip) {
        black_box(tile.pixels);
    }
}

/// Bidirectional path tracing takes its vertices, and a little, more than path tracing.
#[test]
fn bidirectional_paths() {
    let (mut builder, camera) = spheres().unwrap();
    let mut nodes = [Node::EMPTY; max_nodes(10)];
    let scene = builder.build(&mut nodes).unwrap();
    let idle = painted(&mut || ());
    let path = painted(&mut || pixels(&scene, camera, Path::new(10))) - idle;
    let eight = painted(&mut || pixels(&scene, camera, Bdpt::new(10))) - idle;
    let sixteen = painted(&mut || pixels(&scene, camera, Bdpt::<16>::with_capacity(10))) - idle;
    println!("{path} bytes by path, {eight} by bdpt with 8 vertices, {sixteen} with 16");
    let vertex = (sixteen - eight) / 8;
    println!("{vertex} bytes a vertex");
    assert!((64..=128).contains(&vertex), "{vertex} bytes a vertex");
    assert!(
        eight <= path + 8 * vertex + 2048,
        "{eight} bytes are much more than {path}"
    );
}
