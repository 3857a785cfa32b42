//! How many rays a second the scene of the paper's author takes on one thread: whole renders, and nearest hits alone.
//!
//!     queries rays FILE       write rays as they leave surfaces of the scene: origin and direction, six f64 each
//!     queries whole SIDE SPP  render it: queries and seconds
//!     queries bare ROUNDS     the nearest hits of those rays, again and again: queries and seconds
//!
//! `cargo xtask bench-host --seed-program DIR` runs it beside the author's own program.

use std::hint::black_box;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use host_sim::dequantise::Frame;
use host_sim::desc::SamplerKind;
use host_sim::quantise::CoreScene;
use host_sim::run::Options;
use host_sim::{builtin, run};
use microlux::geom::Ray;
use microlux::num::Uniform;
use microlux::sampler::{Independent, PcgRxsMXs32, Sampler};
use microlux::scene::Scene;

/// Rays that start at surfaces, towards where light comes from as often as a path goes there.
const RAYS: usize = 20_000;

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let desc = builtin::scene("seed").context("there is no scene \"seed\"")?;
    let core = CoreScene::new(&desc)?;
    let lent = core.lend();
    let scene = core.scene(&lent)?;
    let (queries, started) = match words[..] {
        ["rays", file] => {
            let rays = rays(&core, &scene);
            let bytes: Vec<u8> = rays
                .iter()
                .flat_map(|ray| numbers(&core, ray))
                .flat_map(f64::to_le_bytes)
                .collect();
            std::fs::write(file, bytes).with_context(|| file.to_string())?;
            return Ok(());
        }
        ["whole", side, spp] => {
            let options = Options {
                width: side.parse()?,
                height: side.parse()?,
                spp: spp.parse()?,
                sampler: SamplerKind::Independent,
                threads: 1,
                ..Options::for_scene(&desc)
            };
            let (_, stats) = run::render_fixed(&desc, &options, &(), &AtomicBool::new(false))?;
            println!("{} queries {} seconds", stats.rays, stats.seconds);
            return Ok(());
        }
        ["bare", rounds] => {
            let rounds: usize = rounds.parse()?;
            let rays = rays(&core, &scene);
            let started = Instant::now();
            for _ in 0..rounds {
                for ray in &rays {
                    black_box(scene.closest(black_box(ray)));
                }
            }
            (rays.len() * rounds, started)
        }
        _ => bail!("rays FILE, whole SIDE SPP, or bare ROUNDS"),
    };
    println!("{queries} queries {} seconds", started.elapsed().as_secs_f64());
    Ok(())
}

/// The second segments of paths, one a sample.
fn rays(core: &CoreScene, scene: &Scene) -> Vec<Ray> {
    let film = core.camera.film(256, 256);
    let mut sampler = Independent::<PcgRxsMXs32>::new(1);
    let mut rays = Vec::new();
    for index in 0.. {
        for pixel in 0..=u16::MAX {
            let (x, y) = (pixel & 255, pixel >> 8);
            sampler.start(x, y, index);
            let lens = [Uniform::ZERO; 2];
            let vertex = film.ray(x, y, sampler.next_2d(), lens).and_then(|ray| {
                let hit = scene.closest(&ray)?;
                Some(scene.vertex(&ray, &hit))
            });
            let Some(vertex) = vertex else { continue };
            let (u, lobe) = (sampler.next_2d(), sampler.next_1d());
            if let Some(sample) = vertex.sample(u, lobe) {
                let origin = vertex.surface.leave(sample.wi);
                rays.push(Ray {
                    origin,
                    dir: sample.wi,
                });
            }
        }
        if rays.len() >= RAYS {
            break;
        }
    }
    // Evenly over the picture.
    let step = rays.len() / RAYS;
    rays.into_iter().step_by(step.max(1)).take(RAYS).collect()
}

/// Origin and direction in metres, as the file of the scene has them.
fn numbers(core: &CoreScene, ray: &Ray) -> [f64; 6] {
    let origin = Frame::of(core).point(ray.origin);
    let dir = ray.dir.0.map(|c| f64::from(c) / 65536.0);
    [origin.x, origin.y, origin.z, dir[0], dir[1], dir[2]]
}
