//! The same bits everywhere, of the integrators beside path tracing: `tests/golden_transport.txt` is the record.
//!
//! `MICROLUX_BLESS=1` writes it anew.

use std::collections::BTreeSet;

use microlux::camera::Camera;
use microlux::color::Radiance;
use microlux::film::Exposure;
use microlux::integrator::{AmbientOcclusion, Bdpt, Integrator, LightTracer};
use microlux::render::{Renderer, Settings};
use microlux::sampler::{AnySampler, Cmj, Independent, Sobol, Stratified, ZSobol};
use microlux::scene::Scene;
use microlux::scene::builtin::Builtin;

const SETTINGS: Settings = Settings {
    width: 30,
    height: 25,
    spp: 4,
};
const PIXELS: usize = SETTINGS.width as usize * SETTINGS.height as usize;
const INTEGRATORS: [&str; 4] = ["bdpt", "frame", "light", "ao"];
const SAMPLERS: [&str; 3] = ["independent", "stratified", "sobol"];
const SEED: u32 = 1;

const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden_transport.txt");
const HEADER: &str = "\
# Golden pictures as in golden.txt: 30 x 25 pixels, 4 samples each, seed 1. A row: scene, integrator, sampler, CRC-32.
# bdpt: bidirectional, at most 8 segments, in tiles; frame: the same with splats; light: light tracing, at most 8
# segments; ao: ambient occlusion without end.
#     MICROLUX_BLESS=1 cargo test --test golden_transport
";

fn sampler(name: &str) -> AnySampler {
    match name {
        "independent" => Independent::new(SEED).into(),
        "stratified" => Stratified::new(SEED, SETTINGS.spp).into(),
        "cmj" => Cmj::new(SEED, SETTINGS.spp).into(),
        "blue" => ZSobol::new(SEED, SETTINGS.spp).into(),
        _ => Sobol::new(SEED).into(),
    }
}

fn crc(pixels: &[Radiance]) -> u32 {
    assert_eq!(pixels.len(), PIXELS);
    let mut bytes = Vec::new();
    for pixel in pixels {
        let (mantissas, exponent) = pixel.to_parts();
        bytes.extend(mantissas.iter().flat_map(|half| half.to_le_bytes()));
        bytes.extend(exponent.to_le_bytes());
    }
    crc32fast::hash(&bytes)
}

/// In strips of `room` pixels.
fn tiles<I: Integrator>(mut renderer: Renderer<AnySampler, I>, room: usize) -> u32 {
    let (mut pixels, mut strip) = (Vec::new(), vec![Radiance::BLACK; room]);
    while let Some(tile) = renderer.step(&mut strip) {
        pixels.extend_from_slice(tile.pixels);
    }
    crc(&pixels)
}

/// Pixel by pixel, from the first or from the last.
fn frame<I: Integrator>(mut renderer: Renderer<AnySampler, I>, backwards: bool) -> u32 {
    let Settings { width, height, spp } = SETTINGS;
    let mut sums = [[0; 3]; PIXELS];
    let mut frame = Exposure::new(width, height, &mut sums).unwrap();
    let mut places: Vec<(u16, u16)> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .collect();
    if backwards {
        places.reverse();
    }
    for (x, y) in places {
        renderer.expose(x, y, &mut frame);
    }
    let mut strip = [Radiance::BLACK; PIXELS];
    crc(frame.rows(0, spp, &mut strip).unwrap().pixels)
}

/// Twice the same picture: in one strip and in short ones, or forwards and backwards.
fn pictures(scene: &Scene, camera: Camera, integrator: &str, kind: &str) -> [u32; 2] {
    let strips = [PIXELS, 7];
    let orders = [false, true];
    match integrator {
        "bdpt" => strips.map(|room| {
            tiles(
                Renderer::new(scene, camera, Bdpt::new(8), sampler(kind), SETTINGS),
                room,
            )
        }),
        "ao" => strips.map(|room| {
            let ao = AmbientOcclusion::new();
            tiles(Renderer::new(scene, camera, ao, sampler(kind), SETTINGS), room)
        }),
        "frame" => orders.map(|back| {
            frame(
                Renderer::new(scene, camera, Bdpt::new(8), sampler(kind), SETTINGS),
                back,
            )
        }),
        _ => orders.map(|back| {
            let light = LightTracer::new(8);
            frame(Renderer::new(scene, camera, light, sampler(kind), SETTINGS), back)
        }),
    }
}

/// Each scene by the samplers of its time; the two youngest on one. No path of light starts in a sky: there a frame has
/// nothing more than tiles have.
fn rows() -> Vec<(Builtin, &'static str, &'static str)> {
    let mut rows = Vec::new();
    let mut add = |scene, integrators: &[&'static str], samplers: &[&'static str]| {
        for integrator in integrators {
            rows.extend(samplers.iter().map(|sampler| (scene, *integrator, *sampler)));
        }
    };
    for scene in [Builtin::Cornell, Builtin::Spheres, Builtin::Torus] {
        add(scene, &INTEGRATORS, &SAMPLERS);
    }
    add(Builtin::Materials, &INTEGRATORS, &["independent", "sobol"]);
    add(Builtin::Sky, &["bdpt", "light", "ao"], &["sobol"]);
    add(Builtin::Map, &["bdpt", "light"], &["sobol"]);
    add(Builtin::Cornell, &INTEGRATORS, &["cmj", "blue"]);
    // Light is not traced from solids.
    add(Builtin::Implicits, &["bdpt", "ao"], &["sobol"]);
    rows
}

#[test]
fn pictures_are_the_record() {
    let mut table = HEADER.to_string();
    let mut seen = BTreeSet::new();
    for (scene, integrator, kind) in rows() {
        let [one, other] = scene
            .with(|scene, camera| pictures(scene, camera, integrator, kind))
            .unwrap();
        let row = format!("{:<8} {integrator:<6} {kind:<11} {one:08x}\n", scene.name());
        assert_eq!(one, other, "depends on how it is cut: {row}");
        assert!(seen.insert(one), "repeats a picture: {row}");
        table += &row;
    }
    if std::env::var_os("MICROLUX_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(RECORD, &table).unwrap();
    }
    let record = std::fs::read_to_string(RECORD).expect("tests/golden_transport.txt");
    let changed: Vec<_> = table
        .lines()
        .zip(record.lines())
        .filter(|(now, then)| now != then)
        .collect();
    assert!(table == record, "pictures changed: {changed:#?}");
}
