//! The same bits everywhere: a CRC-32 for each picture of a table, however the picture is cut and by whom.
//!
//! `tests/golden.txt` is the record. `MICROLUX_BLESS=1` (or `cargo xtask golden --bless`) writes it anew.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::panic::catch_unwind;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};

use embedded_graphics::primitives::PointsIter;
use microlux::camera::Camera;
use microlux::color::Radiance;
use microlux::film::Tile;
use microlux::integrator::Path;
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
const INTEGRATORS: [(&str, Path); 2] = [("direct", Path::direct()), ("path", Path::new(8))];
const SAMPLERS: [&str; 3] = ["independent", "stratified", "sobol"];
const SEEDS: [u32; 2] = [1, 0xdead_beef];

const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden.txt");
const HEADER: &str = "\
# Golden pictures: 30 x 25 pixels, 4 samples each. A row: scene, integrator (path: at most 8 segments), sampler, seed,
# CRC-32 (IEEE) of all pixels' mean radiance row by row, 8 bytes a pixel: three u16 mantissas and the i16 exponent,
# little-endian. A change here is a commit of its own, with a line under \"Pictures\" in CHANGELOG.md.
#     cargo xtask golden --bless
";

/// One row of the table.
#[derive(Clone, Copy)]
struct Case {
    scene: Builtin,
    integrator: &'static str,
    sampler: &'static str,
    seed: u32,
}

/// Each scene by the samplers of its time; the two youngest where shapes and lights are most.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |scene, integrator, sampler| {
        cases.extend(SEEDS.map(|seed| Case {
            scene,
            integrator,
            sampler,
            seed,
        }));
    };
    for scene in [Builtin::Cornell, Builtin::Spheres, Builtin::Torus] {
        for (integrator, _) in INTEGRATORS {
            SAMPLERS
                .into_iter()
                .for_each(|sampler| add(scene, integrator, sampler));
        }
    }
    for scene in [Builtin::Materials, Builtin::Sky, Builtin::Map] {
        ["independent", "sobol"]
            .into_iter()
            .for_each(|sampler| add(scene, "path", sampler));
    }
    for scene in [Builtin::Cornell, Builtin::Spheres] {
        ["cmj", "blue"]
            .into_iter()
            .for_each(|sampler| add(scene, "path", sampler));
    }
    ["independent", "sobol"]
        .into_iter()
        .for_each(|sampler| add(Builtin::Implicits, "path", sampler));
    cases
}

impl Case {
    fn renderer<'s>(&self, scene: &'s Scene<'s>, camera: Camera) -> Renderer<'s, AnySampler> {
        let (_, path) = INTEGRATORS
            .into_iter()
            .find(|(name, _)| *name == self.integrator)
            .unwrap();
        let sampler = match self.sampler {
            "independent" => Independent::new(self.seed).into(),
            "stratified" => Stratified::new(self.seed, SETTINGS.spp).into(),
            "cmj" => Cmj::new(self.seed, SETTINGS.spp).into(),
            "blue" => ZSobol::new(self.seed, SETTINGS.spp).into(),
            _ => Sobol::new(self.seed).into(),
        };
        Renderer::new(scene, camera, path, sampler, SETTINGS)
    }
}

/// A picture put together of tiles, each pixel as the eight bytes that the record speaks of.
struct Picture(Vec<Option<[u8; 8]>>);

impl Picture {
    fn new() -> Picture {
        Picture(vec![None; PIXELS])
    }

    fn put(&mut self, tile: &Tile) {
        let places = tile.area.points();
        assert_eq!(tile.pixels.len(), places.clone().count());
        for (place, pixel) in places.zip(tile.pixels) {
            let ([r, g, b], exponent) = pixel.to_parts();
            let bytes = [
                r.to_le_bytes(),
                g.to_le_bytes(),
                b.to_le_bytes(),
                exponent.to_le_bytes(),
            ];
            let at = place.y as usize * SETTINGS.width as usize + place.x as usize;
            let before = self.0[at].replace(bytes.concat().try_into().unwrap());
            assert_eq!(before, None, "{place:?} was drawn twice");
        }
    }

    fn crc(&self) -> u32 {
        let pixels: Vec<[u8; 8]> = self.0.iter().map(|pixel| pixel.expect("every pixel")).collect();
        crc32fast::hash(pixels.as_flattened())
    }
}

/// By `step`, with a strip of `room` pixels.
fn stepped(renderer: &mut Renderer<AnySampler>, room: usize) -> u32 {
    let mut picture = Picture::new();
    let mut strip = vec![Radiance::BLACK; room];
    while let Some(tile) = renderer.step(&mut strip) {
        picture.put(&tile);
    }
    picture.crc()
}

/// By `threads` that each have a renderer of their own and take the next tile from a common counter.
fn shared(case: &Case, scene: &Scene, camera: Camera, threads: usize, room: u32) -> u32 {
    let picture = Mutex::new(Picture::new());
    let next = AtomicU32::new(0);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                let mut renderer = case.renderer(scene, camera);
                let mut strip = vec![Radiance::BLACK; room as usize];
                let take = || next.fetch_add(room, Ordering::Relaxed);
                while let Some(area) = renderer.area(take(), room) {
                    picture.lock().unwrap().put(&renderer.tile(area, &mut strip));
                }
            });
        }
    });
    picture.into_inner().unwrap().crc()
}

/// As the record has it.
fn row(case: &Case, crc: u32) -> String {
    format!(
        "{:<8} {:<6} {:<11} {:<10} {crc:08x}\n",
        case.scene.name(),
        case.integrator,
        case.sampler,
        case.seed
    )
}

#[test]
fn pictures_are_the_record() {
    let mut table = HEADER.to_string();
    let mut crcs = BTreeSet::new();
    for case in cases() {
        let crc = case
            .scene
            .with(|scene, camera| stepped(&mut case.renderer(scene, camera), PIXELS))
            .unwrap();
        table += &row(&case, crc);
        // Neither seed nor sampler, integrator or scene goes unused.
        assert!(crcs.insert(crc), "{} repeats a picture", row(&case, 0));
    }
    if std::env::var_os("MICROLUX_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(RECORD, &table).unwrap();
    }
    let record = std::fs::read_to_string(RECORD).expect("tests/golden.txt");
    let mut differences = String::new();
    for (now, then) in table.lines().zip(record.lines()) {
        if now != then {
            writeln!(differences, "- {then}\n+ {now}").unwrap();
        }
    }
    assert!(
        table == record,
        "pictures changed; if they should: cargo xtask golden --bless\n{differences}"
    );
}

#[test]
fn tiles_threads_and_restarts_do_not_change_a_picture() {
    let width = SETTINGS.width as usize;
    for case in cases().iter().filter(|case| case.seed == SEEDS[0]) {
        let name = row(case, 0);
        case.scene
            .with(|scene, camera| {
                let mut renderer = case.renderer(scene, camera);
                let whole = stepped(&mut renderer, PIXELS);
                // Tile heights, tiles that are parts of rows, a last tile that is smaller.
                for room in [width, 8 * width, 16 * width, 7, width - 1, width + 1] {
                    renderer.restart();
                    assert_eq!(stepped(&mut renderer, room), whole, "strip of {room}: {name}");
                }
                // Begun, given up, begun again.
                renderer.restart();
                let mut strip = vec![Radiance::BLACK; 5];
                assert!(renderer.step(&mut strip).is_some());
                renderer.restart();
                assert_eq!(stepped(&mut renderer, 8 * width), whole, "restart: {name}");
                for threads in [1, 2] {
                    let by_threads = shared(case, scene, camera, threads, 2 * width as u32);
                    assert_eq!(by_threads, whole, "{threads} threads: {name}");
                }
            })
            .unwrap();
    }
}

/// What makes a green golden mean that nothing overflows on a chip.
#[test]
fn overflow_is_checked_here() {
    let add = || std::hint::black_box(i32::MAX) + std::hint::black_box(1);
    assert_eq!(catch_unwind(add).is_err(), cfg!(debug_assertions));
}
