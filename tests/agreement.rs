//! Integrators agree in the mean: path tracing, and bidirectional path tracing in tiles and with a whole frame; and each
//! strategy of the bidirectional one, alone and unweighted, with every other that finds the same paths.
//!
//! Small pictures, many seeds: the means of pictures are normal, and differences are judged by their own spread over
//! the seeds, beyond a budget of 0.25 % for what rounding may do.

mod agreement_rooms;

use std::collections::BTreeMap;

use agreement_rooms::{ROOMS, Room};
use microlux::camera::Camera;
use microlux::color::Radiance;
use microlux::film::Exposure;
use microlux::integrator::{AmbientOcclusion, Bdpt, Integrator, Path, Strategy, Tally, View};
use microlux::num::Wide;
use microlux::render::{Renderer, Settings};
use microlux::sampler::{Independent, PcgRxsMXs32, Sampler};
use microlux::scene::Scene;
use microlux::scene::builtin::Builtin;

const SIDE: u16 = 12;
const PIXELS: usize = SIDE as usize * SIDE as usize;
const SEEDS: u32 = 32;

/// By how much means may differ for any number of samples, as a share.
const BUDGET: f64 = 0.0025;

/// Student's t with 31 degrees of freedom that is exceeded on either side with probability 0.01/200: there are fewer
/// comparisons than 200, so that all agree by chance in 99 of 100 runs.
const MOST: f64 = 4.71;

type Pcg = Independent<PcgRxsMXs32>;

/// The mean of a pixel's channels.
fn brightness(light: Radiance) -> f64 {
    let (mantissa, exponent) = light.to_parts();
    let sum: f64 = mantissa.iter().map(|m| f64::from(*m)).sum();
    sum * 2f64.powi(i32::from(exponent) - 15) / 3.0
}

fn number(x: Wide) -> f64 {
    f64::from(x.mantissa()) * 2f64.powi(i32::from(x.exponent()) - 15)
}

fn settings(spp: u32) -> Settings {
    Settings {
        width: SIDE,
        height: SIDE,
        spp,
    }
}

fn places() -> impl Iterator<Item = (u16, u16)> {
    (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)))
}

/// The means of pictures, one a seed.
type Means = Vec<f64>;

fn in_tiles<I: Integrator + Copy>(scene: &Scene, camera: Camera, integrator: I, spp: u32) -> Means {
    let picture = |seed| {
        let mut renderer = Renderer::new(scene, camera, integrator, Pcg::new(seed), settings(spp));
        let mut strip = [Radiance::BLACK; PIXELS];
        let tile = renderer.step(&mut strip).unwrap();
        tile.pixels.iter().map(|pixel| brightness(*pixel)).sum::<f64>() / PIXELS as f64
    };
    (1..=SEEDS).map(picture).collect()
}

fn in_a_frame<I: Integrator + Copy>(scene: &Scene, camera: Camera, integrator: I, spp: u32) -> Means {
    let picture = |seed| {
        let mut renderer = Renderer::new(scene, camera, integrator, Pcg::new(seed), settings(spp));
        let mut sums = [[0; 3]; PIXELS];
        let mut frame = Exposure::new(SIDE, SIDE, &mut sums).unwrap();
        for (x, y) in places() {
            renderer.expose(x, y, &mut frame);
        }
        let pixels = places().map(|(x, y)| brightness(frame.mean(x, y, spp)));
        pixels.sum::<f64>() / PIXELS as f64
    };
    (1..=SEEDS).map(picture).collect()
}

fn mean(samples: &[f64]) -> f64 {
    samples.iter().sum::<f64>() / samples.len() as f64
}

/// Standard error of the mean.
fn error(samples: &[f64]) -> f64 {
    let (n, mean) = (samples.len() as f64, mean(samples));
    let variance = samples.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (variance / n).sqrt()
}

/// Asserts that means over the same seeds do not differ beyond the budget and chance.
fn assert_equal(name: &str, a: &[f64], b: &[f64]) {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let (a, b, error) = (mean(a), mean(b), error(&differences));
    let beyond = (a - b).abs() - BUDGET * a.abs().max(b.abs());
    println!(
        "{name}: {a:.6} and {b:.6}, {:+.3} % with an error of {:.3} %",
        100.0 * (a - b) / b,
        100.0 * error / b
    );
    assert!(
        beyond <= MOST * error,
        "{name}: {a} is not {b}: {} errors beyond the budget",
        beyond / error
    );
}

fn assert_integrators(name: &str, scene: &Scene, camera: Camera, spp: u32) {
    for depth in [2, 3, 6, 20] {
        let path = in_tiles(scene, camera, Path::new(depth), spp);
        let tiles = in_tiles(scene, camera, Bdpt::new(depth), spp);
        assert_equal(&format!("{name}, {depth} segments, tiles"), &tiles, &path);
        let frame = in_a_frame(scene, camera, Bdpt::new(depth), spp);
        assert_equal(&format!("{name}, {depth} segments, frame"), &frame, &path);
    }
}

#[test]
fn builtin_scenes() {
    for scene in Builtin::ALL {
        scene
            .with(|scene_, camera| assert_integrators(scene.name(), scene_, camera, 8))
            .unwrap();
    }
}

#[test]
fn rooms() {
    for room in ROOMS {
        room.with(|scene, camera| assert_integrators(&format!("{room:?}"), scene, camera, 16));
    }
}

/// Longer than is kept: what memory leaves out, path tracing finds, whatever the capacity.
#[test]
fn memory_costs_no_light() {
    Room::Lamps.with(|scene, camera| {
        let path = in_tiles(scene, camera, Path::new(9), 16);
        let none = in_tiles(scene, camera, Bdpt::<0>::with_capacity(9), 16);
        assert_equal("no vertex", &none, &path);
        let one = in_a_frame(scene, camera, Bdpt::<1>::with_capacity(9), 16);
        assert_equal("one vertex", &one, &path);
        let three = in_tiles(scene, camera, Bdpt::<3>::with_capacity(9), 16);
        assert_equal("three vertices", &three, &path);
    });
}

/// What each strategy found, unweighted and weighted.
#[derive(Default)]
struct ByStrategy(BTreeMap<Strategy, [f64; 2]>);

impl Tally for ByStrategy {
    const SPLATS: bool = true;
    const ALL: bool = true;

    fn gather(&mut self, strategy: Strategy, light: Radiance, weight: Wide) {
        let sums = self.0.entry(strategy).or_default();
        sums[0] += brightness(light);
        sums[1] += brightness(light) * number(weight);
    }

    fn splat(&mut self, strategy: Strategy, _: (u16, u16), light: Radiance, weight: Wide) {
        self.gather(strategy, light, weight);
    }
}

/// Each strategy's means by seed, unweighted, of paths up to `depth` segments.
fn alone(scene: &Scene, camera: Camera, depth: u16, spp: u32) -> BTreeMap<Strategy, Means> {
    let film = camera.film(SIDE, SIDE);
    let view = View::new(scene, &film);
    let mut all: BTreeMap<Strategy, Means> = BTreeMap::new();
    for seed in 1..=SEEDS {
        let mut sampler = Pcg::new(seed);
        let mut tally = ByStrategy::default();
        for (x, y) in places() {
            for index in 0..spp {
                sampler.start(x, y, index);
                let (place, lens) = (sampler.next_2d(), sampler.next_2d());
                let ray = film.ray(x, y, place, lens).unwrap();
                Bdpt::new(depth).follow(&view, ray, &mut sampler, &mut tally, &mut 0);
            }
        }
        for (strategy, [unweighted, _]) in tally.0 {
            let samples = (PIXELS as u32 * spp) as f64;
            all.entry(strategy).or_default().push(unweighted / samples);
        }
    }
    all
}

/// However many vertices on the light's side.
const ALL: (u16, u16) = (0, u16::MAX);

/// In scenes of matt surfaces and lights that are met by rays, every strategy finds every path: each has the mean of its
/// neighbours, alone.
#[test]
fn strategies() {
    let compare = |name: &str, scene: &Scene, camera: Camera, (from_light, to_light): (u16, u16)| {
        let means = alone(scene, camera, 5, 48);
        for (strategy, found) in &means {
            let Strategy { light, camera } = *strategy;
            // With one vertex on a light, as path tracing does.
            let other = Strategy {
                light: 1,
                camera: light + camera - 1,
            };
            if light < from_light || light > to_light || light == 1 || other.camera < 2 {
                continue;
            }
            // Most of the sun's rays miss the room: joined by 1/d² in its corners, what is left has no variance to judge by.
            if name == "sun" && light > 1 && camera > 1 {
                continue;
            }
            let found: Means = (0..SEEDS as usize)
                .map(|i| found.get(i).copied().unwrap_or(0.0))
                .collect();
            assert_equal(&format!("{name}, {strategy:?}"), &found, &means[&other]);
        }
    };
    Builtin::Cornell
        .with(|scene, camera| compare("cornell", scene, camera, ALL))
        .unwrap();
    Room::Lamps.with(|scene, camera| compare("lamps", scene, camera, ALL));
    Room::Sun.with(|scene, camera| compare("sun", scene, camera, ALL));
    // Where a smooth normal puts the eye behind the surface, the eye sees the true one; light on its way scatters as if not,
    // and so not all ways from its second vertex on.
    Room::Smooth.with(|scene, camera| compare("smooth", scene, camera, (0, 2)));
    // No ray meets a point light.
    Room::Points.with(|scene, camera| compare("points", scene, camera, (1, u16::MAX)));
}

/// What direct light from a white sky makes of white surfaces.
#[test]
fn ambient_occlusion_is_a_white_sky() {
    Room::Open.with(|scene, camera| {
        let hidden = Path {
            hide_emitters: true,
            ..Path::direct()
        };
        let white = in_tiles(scene, camera, hidden, 16);
        let open = in_tiles(scene, camera, AmbientOcclusion::new(), 16);
        assert_equal("ambient occlusion", &open, &white);
        // Nothing stands so near; and what little stands near takes less than all there is.
        let near = |radius| mean(&in_tiles(scene, camera, AmbientOcclusion::within(radius), 4));
        let (none, some, all) = (near(1), near(1 << 15), near(AmbientOcclusion::FULL));
        assert!(all + 0.02 < some && some + 0.02 < none, "{all} {some} {none}");
    });
}
