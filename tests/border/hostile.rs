//! Scenes with extreme and with wrong numbers in them: refused, or rendered without a panic. Overflow is one here.

use crate::scenes::{Draft, Random, radiance};
use fixed::types::I12F20;
use microlux::camera::Camera;
use microlux::color::{Albedo, Radiance, Rgb9e5};
use microlux::geom::{Dir, Point, REACH, Rotation, Unit};
use microlux::integrator::Path;
use microlux::light::{Environment, Light, Map, MapParts, Sky};
use microlux::material::Material;
use microlux::num::{Metres, Share, Turn};
use microlux::render::{Renderer, Settings};
use microlux::sampler::{AnySampler, Cmj, Independent, Sobol, Stratified, ZSobol};
use microlux::scene::{Scene, SceneError, Tint};
use microlux::shape::{
    Blob, Bound, Capsule, Disk, Geometry, Grid, Gyroid, Implicit, Instance, Metaballs, Plane, Rectangle,
    RoundedBox, SmoothUnion, Sphere, Torus,
};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

const EXTREMES: [i32; 17] = [
    0,
    1,
    -1,
    2,
    7,
    65_536,
    -65_536,
    REACH - 1,
    REACH,
    -REACH,
    REACH + 1,
    2 * REACH,
    1 << 25,
    1 << 30,
    i32::MAX,
    i32::MIN,
    i32::MIN + 1,
];

fn number(random: &mut Random) -> i32 {
    match random.below(3) {
        0 => random.within(REACH),
        1 => (random.bits() as i32) >> random.below(31),
        _ => random.pick(&EXTREMES),
    }
}

fn point(random: &mut Random) -> Point {
    Point([0; 3].map(|_| number(random)))
}

fn dir(random: &mut Random) -> Dir {
    match random.below(4) {
        0 => Dir([0; 3].map(|_| number(random))),
        // Nearly a unit vector, or exactly one.
        1 => Dir(random.dir().0.map(|c| c + random.within(8))),
        _ => random.dir(),
    }
}

fn geometry(random: &mut Random, blobs: &[Blob]) -> Geometry {
    match random.below(8) {
        5 | 6 => implicit(random, blobs).into(),
        0 => Sphere::new(point(random), number(random)).into(),
        1 => Disk::new(point(random), dir(random), number(random)).into(),
        2 => Plane::new(point(random), dir(random)).into(),
        3 => Rectangle {
            center: point(random),
            u: dir(random),
            v: dir(random),
            normal: dir(random),
            half: [number(random), number(random)],
        }
        .into(),
        4 => Geometry::Mesh(random.below(4) as u16),
        _ => Instance::new(random.below(4) as u16)
            .scaled(Metres::from_bits(number(random)))
            .turned(match random.below(3) {
                0 => Rotation::from_rows([[0; 3]; 3].map(|row| row.map(|_| number(random)))),
                1 => Rotation::about(dir(random), Turn::from_bits(random.bits())),
                _ => Rotation::new([0; 4].map(|_| number(random))).unwrap_or(Rotation::NONE),
            })
            .moved(point(random))
            .into(),
    }
}

fn blob(random: &mut Random) -> Blob {
    Blob {
        a: point(random),
        b: point(random),
        radius: number(random),
    }
}

fn implicit(random: &mut Random, blobs: &[Blob]) -> Implicit {
    let center = point(random);
    let (x, y) = (dir(random), dir(random));
    let half = [0; 3].map(|_| number(random));
    let (first, count) = (random.below(9) as u16, random.pick(&[0, 1, 2, 3, 17, u16::MAX]));
    let threshold = random.bits() >> random.below(32);
    match random.below(6) {
        0 => Implicit::Torus(Torus {
            center,
            axis: x,
            side: y,
            major: number(random),
            minor: number(random),
        }),
        1 => Implicit::Capsule(Capsule::new(center, point(random), number(random))),
        2 => Implicit::RoundedBox(RoundedBox {
            center,
            x,
            y,
            half,
            radius: number(random),
        }),
        3 => Implicit::Gyroid(Gyroid {
            center,
            x,
            y,
            cell: number(random),
            thickness: number(random),
            bound: random.pick(&[Bound::ball(half[0]), Bound::block(half)]),
        }),
        4 => Implicit::Metaballs(Metaballs::new(blobs, first, count, threshold)),
        _ => Implicit::SmoothUnion(SmoothUnion::new(blobs, first, count, number(random))),
    }
}

fn light(random: &mut Random) -> Light {
    match random.below(4) {
        0 => Light::Point {
            position: point(random),
            intensity: radiance(random),
        },
        1 => Light::Directional {
            direction: dir(random),
            irradiance: radiance(random),
        },
        2 => Light::Area {
            shape: random.below(30) as u16,
            radiance: radiance(random),
        },
        _ => Light::Environment {
            radiance: radiance(random),
        },
    }
}

/// One thing or another that is wrong, or only unusual.
fn harm(draft: &mut Draft, random: &mut Random) {
    let shape = random.below(draft.shapes.len());
    match random.below(16) {
        15 => {
            let texture = random.below(3) as u16;
            draft.shapes[shape].tint = random.pick(&[Tint::Vertices, Tint::Texture(texture)]);
        }
        14 => {
            let place = random.below(draft.blobs.len());
            draft.blobs[place] = blob(random);
        }
        0..=2 => {
            let geometry = geometry(random, &draft.blobs);
            draft.shapes[shape].geometry = geometry;
        }
        3 => draft.shapes[shape].material = random.bits() as u16,
        4 => draft.shapes[shape].light = Some(random.below(6) as u16),
        5 => draft.lights.push(light(random)),
        6 => {
            draft.lights.pop();
            draft.lights.push(light(random));
        }
        7 => draft.lights.clear(),
        8 => {
            let albedo = Albedo([0; 3].map(|_| Share::from_bits(random.bits() as u16)));
            draft.materials.push(Material::lambert(albedo));
        }
        9 => {
            let (from, to) = (
                random.below(draft.nodes.len().max(1)),
                random.below(draft.nodes.len().max(1)),
            );
            if !draft.nodes.is_empty() {
                draft.nodes[to] = draft.nodes[from];
            }
        }
        10 => {
            draft.nodes.pop();
        }
        11 => draft.arrangement.bounded = random.below(draft.shapes.len() + 2),
        12 => {
            let grid = Grid::new(point(random), random.below(9) as u8);
            draft.arrangement.grid = grid.unwrap_or(Grid::UNIT);
        }
        _ => {
            let count = draft.meshes.len();
            let Some(mesh) = draft.meshes.get_mut(random.below(count.max(1))) else {
                draft.unit = Unit::new(number(random));
                return;
            };
            match random.below(5) {
                0 => {
                    mesh.vertices.pop();
                    mesh.vertices.push([0; 3].map(|_| random.bits() as u16));
                }
                1 => {
                    mesh.triangles.pop();
                    mesh.triangles.push([0; 3].map(|_| random.below(50) as u16));
                }
                2 => mesh.grid = Grid::new(point(random), random.below(9) as u8).unwrap_or(Grid::UNIT),
                3 => {
                    mesh.nodes.pop();
                }
                _ => mesh.triangles.clear(),
            }
        }
    }
}

/// Anywhere a camera may stand, with any field of view, or a frame that is none.
fn camera(random: &mut Random) -> Camera {
    let origin = match random.below(4) {
        0 => random.point(2 * REACH),
        1 => point(random),
        2 => random.point(1000),
        _ => random.point(REACH),
    };
    let tan_half =
        I12F20::from_bits(random.pick(&[i32::MIN, 0, 1, 1000, 1 << 19, 1 << 20, 1 << 24, i32::MAX]));
    let looking = Camera::look_at(origin, random.point(REACH), random.dir().0, tan_half);
    let camera = match looking {
        Some(camera) if !random.one_in(4) => camera,
        _ => Camera::from_frame(origin, [0; 3].map(|_| random.dir()), tan_half),
    };
    if random.one_in(4) {
        camera.with_lens(number(random), number(random))
    } else {
        camera
    }
}

/// Renders 8×8 pixels and their features.
fn render(scene: &Scene, random: &mut Random) {
    let settings = Settings {
        width: 8,
        height: 8,
        spp: 1 + random.below(4) as u32,
    };
    let path = Path {
        max_depth: random.pick(&[1, 2, 3, 8, 30]),
        rr_depth: random.pick(&[1, 2, 5]),
        hide_emitters: random.one_in(4),
    };
    let seed = random.bits();
    let sampler: AnySampler = match random.below(5) {
        0 => Independent::new(seed).into(),
        1 => Stratified::new(seed, settings.spp).into(),
        2 => Cmj::new(seed, settings.spp).into(),
        3 => ZSobol::new(seed, settings.spp).into(),
        _ => Sobol::new(seed).into(),
    };
    let mut renderer = Renderer::new(scene, camera(random), path, sampler, settings);
    let mut strip = [Radiance::BLACK; 64];
    assert_eq!(renderer.step(&mut strip).map(|tile| tile.pixels.len()), Some(64));
    for place in 0..64 {
        renderer.features(place % 8, place / 8);
    }
}

/// Any colours, any directions.
fn sky(random: &mut Random) -> Sky {
    let sky = Sky::new(dir(random), radiance(random), radiance(random), radiance(random));
    if random.one_in(2) {
        return sky;
    }
    let width = Turn::from_bits(random.size(i32::MAX) as u32);
    sky.with_sun(dir(random), width, radiance(random))
}

fn texels(random: &mut Random) -> Vec<Rgb9e5> {
    let black = random.one_in(4);
    (0..24)
        .map(|_| Rgb9e5(if black { 0 } else { random.bits() }))
        .collect()
}

/// Rising for the most part.
fn bounds(random: &mut Random) -> Vec<u16> {
    let mut bounds: Vec<u16> = (0..random.below(8)).map(|_| random.bits() as u16).collect();
    if !random.one_in(8) {
        bounds.sort_unstable();
    }
    bounds
}

fn bounds_u32(random: &mut Random) -> Vec<u32> {
    let mut bounds: Vec<u32> = (0..random.below(6)).map(|_| random.bits()).collect();
    bounds.sort_unstable();
    bounds
}

fn map<'a>(texels: &'a [Rgb9e5], bands: &'a [u16], random: &mut Random) -> Option<Map<'a>> {
    let [width, height] = random.pick(&[[6, 4], [12, 2], [1, 24], [24, 1], [5, 5], [0, 0]]);
    Map::new(MapParts {
        width,
        height,
        texels,
        exponent: random.pick(&[0, 5, -40, i16::MIN, i16::MAX]),
        axes: match random.below(3) {
            0 => [Dir::X, Dir::Y, Dir::Z],
            1 => [Dir::Z, Dir::X, Dir::Y],
            _ => [0; 3].map(|_| dir(random)),
        },
        bands,
        steps: &[],
        steps_in_band: random.pick(&[1, 1, 1, 0, 2, u16::MAX]),
    })
    .ok()
}

/// What kind of error it is, without its numbers.
fn kind(error: &SceneError) -> String {
    let text = format!("{error:?}");
    text.split([' ', '(']).next().unwrap_or_default().to_string()
}

/// `MICROLUX_SCENES` is how many scenes.
#[test]
fn refused_or_rendered() {
    let scenes = std::env::var("MICROLUX_SCENES").map_or(6000, |n| n.parse().unwrap());
    let mut ends: BTreeMap<String, u32> = BTreeMap::new();
    for seed in 0..scenes {
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let mut random = Random(seed);
            let mut draft = Draft::random(&mut random);
            for _ in 0..random.below(4) {
                harm(&mut draft, &mut random);
            }
            if random.one_in(2) {
                draft.arrange();
            }
            let meshes = draft.meshes();
            let (sky, texels, bands) = (sky(&mut random), texels(&mut random), bounds(&mut random));
            let map = map(&texels, &bands, &mut random);
            let choice = bounds_u32(&mut random);
            let mut parts = draft.parts(&meshes);
            match random.below(6) {
                0 => parts.environment = Environment::Sky(&sky),
                1 => parts.environment = map.map_or(Environment::None, Environment::Map),
                _ => (),
            }
            if random.one_in(20) {
                parts.choice = &choice;
            }
            let mut table = [0; 64];
            match Scene::new(parts) {
                Ok(scene) => {
                    let by_power = random.one_in(2);
                    let scene = if by_power {
                        scene.choose_by_power(&mut table)
                    } else {
                        scene
                    };
                    render(&scene, &mut random);
                    "rendered".to_string()
                }
                Err(error) => kind(&error),
            }
        }));
        match outcome {
            Ok(end) => *ends.entry(end).or_default() += 1,
            Err(_) => panic!("scene {seed} was neither refused nor rendered; see above"),
        }
    }
    println!("{ends:?}");
    assert!(
        ends["rendered"] as u64 > scenes / 4 && ends.len() > 8,
        "too few to mean something"
    );
}
