//! A Cornell box in memory that is all on the stack, a strip of rows at a time.
//!
//! `cargo run --release --example cornell` shows it in the terminal; `-- cornell.ppm` also writes a file.
//!
//! On a board the frame buffer goes: `tile.draw` takes the display's driver in its place.

use std::error::Error;
use std::io::Write;

use embedded_graphics::framebuffer::{Framebuffer, buffer_size};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::pixelcolor::raw::{BigEndian, RawU24};
use microlux::bvh::{Node, max_nodes};
use microlux::camera::Camera;
use microlux::color::{Radiance, albedo};
use microlux::film::{Display, Dither, ToneMap};
use microlux::geom::{Dir, Point, point};
use microlux::integrator::Path;
use microlux::material::Material;
use microlux::num::{Metres, Share, Turn, sin_cos};
use microlux::q;
use microlux::render::{Renderer, Settings};
use microlux::sampler::Sobol;
use microlux::scene::{Cell, MaterialId, SceneBuilder, SceneError};
use microlux::shape::Rectangle;

const WIDTH: usize = 96;
const HEIGHT: usize = 96;
/// Rows a strip: fewer take less memory, and the picture is the same.
const ROWS: usize = 8;
/// Five walls, two blocks of five faces, a lamp.
const SHAPES: usize = 16;

type Box = SceneBuilder<SHAPES, 4, 1>;
type Screen = Framebuffer<Rgb888, RawU24, BigEndian, WIDTH, HEIGHT, { buffer_size::<Rgb888>(WIDTH, HEIGHT) }>;

fn main() -> Result<(), std::boxed::Box<dyn Error>> {
    let mut builder = Box::new();
    fill(&mut builder)?;
    let mut nodes = [Node::EMPTY; max_nodes(SHAPES)];
    // What is where, and what may shade it, is told once: paths as long as these take less then, the picture is the same.
    let mut cells = [Cell::UNKNOWN; 512];
    let bytes = size_of_val(&builder) + size_of_val(&nodes) + size_of_val(&cells);
    let scene = builder.build(&mut nodes)?.foresee(&mut cells);

    let (eye, target) = (point(q!(0), q!(1), q!(4.1)), point(q!(0), q!(1), q!(0)));
    let field_of_view = Turn::from_bits((1 << 31) / 180 * 38); // 38°
    let camera = Camera::look_at(eye, target, [0, 1, 0], Camera::tan_half(field_of_view)).ok_or("no view")?;
    let settings = Settings {
        width: WIDTH as u16,
        height: HEIGHT as u16,
        spp: 64,
    };
    let mut renderer = Renderer::new(&scene, camera, Path::new(8), Sobol::new(7), settings);
    let display = Display {
        tone_map: ToneMap::Clamp,
        dither: Dither::BlueNoise,
        ..Display::default()
    };

    let mut screen = Screen::new();
    let mut strip = [Radiance::BLACK; WIDTH * ROWS];
    let bytes = bytes + size_of_val(&scene) + size_of_val(&renderer) + size_of_val(&strip);
    while let Some(tile) = renderer.step(&mut strip) {
        tile.draw(&mut screen, &display)?;
    }

    show(screen.data());
    println!(
        "scene, tree, renderer and a strip of {ROWS} rows: {bytes} bytes; {} rays",
        renderer.rays()
    );
    if let Some(path) = std::env::args().nth(1) {
        let mut file = std::fs::File::create(&path)?;
        writeln!(file, "P6 {WIDTH} {HEIGHT} 255")?;
        file.write_all(screen.data())?;
        println!("written to {path}");
    }
    Ok(())
}

/// Walls, blocks and lamp, in metres.
fn fill(scene: &mut Box) -> Result<(), SceneError> {
    let colour = |r, g, b| Material::lambert(albedo(r, g, b));
    let white = scene.material(colour(q!(0.74, Share), q!(0.73, Share), q!(0.70, Share)))?;
    let red = scene.material(colour(q!(0.60, Share), q!(0.07, Share), q!(0.06, Share)))?;
    let green = scene.material(colour(q!(0.13, Share), q!(0.44, Share), q!(0.12, Share)))?;
    let black = scene.material(Material::Black)?;

    let one = [q!(1); 2];
    face(scene, white, point(q!(0), q!(0), q!(0)), [Dir::Z, Dir::X], one)?;
    face(scene, white, point(q!(0), q!(2), q!(0)), [Dir::X, Dir::Z], one)?;
    face(scene, white, point(q!(0), q!(1), q!(-1)), [Dir::X, Dir::Y], one)?;
    face(scene, red, point(q!(-1), q!(1), q!(0)), [Dir::Y, Dir::Z], one)?;
    face(scene, green, point(q!(1), q!(1), q!(0)), [Dir::Z, Dir::Y], one)?;
    let tall = [q!(0.29), q!(0.61), q!(0.29)];
    block(scene, white, point(q!(-0.36), q!(0.61), q!(-0.30)), tall, 17)?;
    let short = [q!(0.29), q!(0.28), q!(0.29)];
    block(scene, white, point(q!(0.35), q!(0.28), q!(0.33)), short, -19)?;

    let half = [q!(0.26), q!(0.21)].map(|side| scene.unit().length(side));
    if let Some(lamp) = Rectangle::new(point(q!(0), q!(1.985), q!(-0.05)), Dir::X, Dir::Z, half) {
        scene.emitter(lamp, black, Radiance::new(q!(16.5), q!(13.6), q!(8.6)))?;
    }
    Ok(())
}

/// A rectangle about `center`, half its sides along the two directions.
fn face(
    scene: &mut Box,
    material: MaterialId,
    center: Point,
    [u, v]: [Dir; 2],
    half: [Metres; 2],
) -> Result<(), SceneError> {
    let half = half.map(|side| scene.unit().length(side));
    match Rectangle::new(center, u, v, half) {
        Some(rectangle) => scene.shape(rectangle, material),
        None => Ok(()),
    }
}

/// A box without its bottom, turned about the vertical.
fn block(
    scene: &mut Box,
    material: MaterialId,
    center: Point,
    half: [Metres; 3],
    degrees: i32,
) -> Result<(), SceneError> {
    let (sin, cos) = sin_cos(Turn::from_bits(((1 << 31) / 180 * degrees as i64) as u32));
    let (x, y, z) = (Dir([cos, 0, -sin]), Dir::Y, Dir([sin, 0, cos]));
    let [a, b, c] = half;
    let faces = [
        (-x, a, [z, y], [c, b]),
        (x, a, [y, z], [b, c]),
        (y, b, [z, x], [c, a]),
        (-z, c, [y, x], [b, a]),
        (z, c, [x, y], [a, b]),
    ];
    for (out, distance, sides, half) in faces {
        let middle = center.along(out, scene.unit().length(distance));
        face(scene, material, middle, sides, half)?;
    }
    Ok(())
}

/// Two rows a line: the upper half of a block in one colour, the lower in another.
fn show(rgb: &[u8]) {
    for rows in rgb.chunks_exact(2 * 3 * WIDTH) {
        let (above, below) = rows.split_at(3 * WIDTH);
        for (a, b) in above.chunks_exact(3).zip(below.chunks_exact(3)) {
            print!(
                "\x1b[38;2;{};{};{}m\x1b[48;2;{};{};{}m▀",
                a[0], a[1], a[2], b[0], b[1], b[2]
            );
        }
        println!("\x1b[0m");
    }
}
