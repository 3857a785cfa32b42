//! Nearest hits of the same rays on the same mesh: ours, the crate `bvh` (f32), and Embree one ray at a time.
//!
//! `peers MESH [--embree LIBRARY] [--rays N] [--only NAME]`: MESH is an OBJ file, or `knot:ALONGxAROUND`. Coordinates are
//! those of our grid, small integers, which are exact in f32. Prints a JSON object: rays a second by one thread, the median
//! of five turns of each in turn, and how far the answers agree. With `--only` one of them traces all rays once and prints
//! a sum: for counting instructions of `counted`. `--copies N` traces a scene of N meshes side by side in the same way, and
//! `peers strip:ROWSxSPP` renders the Cornell box by strips of so many rows.

mod embree;
mod grow;
mod mesh;
mod of_bvh;

use std::{process::ExitCode, time::Instant};

use mesh::Model;
use microlux::bvh::closest;
use microlux::geom::{Dir, Point, Ray};
use microlux::shape::{Slopes, Triangles};
use microlux_bake::Packed;
use of_bvh::Order;

/// Turns of each, whose medians count.
const TURNS: usize = 5;

/// A triangle and the distance to it, in lengths of the direction.
pub type Answer = Option<(u32, f32)>;

/// Anything that finds the nearest triangle along a ray.
trait Tracer {
    fn name(&self) -> &'static str;
    fn nearest(&self, ray: &Ray) -> Answer;
}

struct Ours<'a> {
    name: &'static str,
    triangles: Triangles<'a>,
    nodes: &'a [microlux::bvh::Node],
}

impl Tracer for Ours<'_> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn nearest(&self, ray: &Ray) -> Answer {
        let hit = closest(&self.triangles, self.nodes, ray, &Slopes::new(ray.dir), i32::MAX)?;
        Some((hit.triangle, hit.t as f32))
    }
}

/// From all around the mesh into its box, and from points in the box anywhere.
fn rays([low, high]: [[i32; 3]; 2], count: usize) -> Vec<Ray> {
    let mut state = 1u32;
    let mut random = || {
        let old = state;
        state = old.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((old >> ((old >> 28) + 4)) ^ old).wrapping_mul(277_803_737);
        f64::from((word >> 22) ^ word) / 4_294_967_296.0
    };
    let mut rays = Vec::new();
    while rays.len() < count {
        let [z, turn] = [2.0 * random() - 1.0, std::f64::consts::TAU * random()];
        let r = (1.0 - z * z).sqrt();
        let out = [r * turn.cos(), r * turn.sin(), z];
        let inside = |random: &mut dyn FnMut() -> f64, axis: usize| {
            f64::from(low[axis]) + random() * f64::from(high[axis] - low[axis])
        };
        let target = [0, 1, 2].map(|axis| inside(&mut random, axis));
        let origin = if rays.len() % 2 == 0 {
            [0, 1, 2].map(|axis| {
                let (low, high) = (f64::from(low[axis]), f64::from(high[axis]));
                ((low + high) / 2.0 + 1.25 * (high - low).max(16_384.0) * out[axis]) as i32
            })
        } else {
            [0, 1, 2].map(|axis| inside(&mut random, axis) as i32)
        };
        let to = [0, 1, 2].map(|axis| target[axis] as i32 - origin[axis]);
        if let Some(dir) = Dir::new(to) {
            rays.push(Ray {
                origin: Point(origin),
                dir,
            });
        }
    }
    rays
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("peers: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().ok_or("which mesh?")?;
    if let Some(size) = name.strip_prefix("strip:") {
        return grow::strip(size);
    }
    let (mut library, mut count, mut only, mut copies) = (None, 200_000, None, None);
    while let Some(option) = arguments.next() {
        let value = arguments
            .next()
            .ok_or_else(|| format!("{option} wants a value"))?;
        match option.as_str() {
            "--embree" => library = Some(value),
            "--rays" => count = value.parse().map_err(|_| format!("{value} rays?"))?,
            "--only" => only = Some(value),
            "--copies" => copies = Some(value.parse().map_err(|_| format!("{value} copies?"))?),
            _ => return Err(format!("{option}?")),
        }
    }
    let model = Model::new(&name)?;
    let plain = model.plain();
    if let Some(copies) = copies {
        return grow::copies(&model, copies, count);
    }
    let packed = Packed::new(&plain, &model.nodes).map_err(|error| error.to_string())?;
    let packed = packed.mesh();
    let rays = rays([model.low, model.high], count);
    let wanted = |name: &str| only.as_deref().is_none_or(|only| only == name);
    let mut tracers: Vec<Box<dyn Tracer + '_>> = Vec::new();
    if wanted("ours") {
        tracers.push(Box::new(Ours {
            name: "ours",
            triangles: plain.into(),
            nodes: &model.nodes,
        }));
    }
    if wanted("packed") {
        tracers.push(Box::new(Ours {
            name: "packed",
            triangles: packed.triangles,
            nodes: packed.nodes,
        }));
    }
    for (name, order) in [("bvh", Order::Any), ("bvh-nearest", Order::Nearest)] {
        if wanted(name) {
            tracers.push(Box::new(of_bvh::Tree::new(&model, order)));
        }
    }
    if let Some(library) = library.filter(|_| wanted("embree")) {
        tracers.push(Box::new(embree::Scene::new(&library, &model)?));
    }
    if only.is_some() {
        let [tracer] = &*tracers else {
            return Err("no such tracer".to_owned());
        };
        println!(
            "{}",
            counted(&rays, &|ray| tracer.nearest(ray).map(|hit| f64::from(hit.1)))
        );
        return Ok(());
    }
    compare(&name, &model, &tracers, &rays)
}

/// What is counted: nothing but the rays. Callgrind is told its name.
#[inline(never)]
#[unsafe(no_mangle)]
extern "Rust" fn counted(rays: &[Ray], nearest: &dyn Fn(&Ray) -> Option<f64>) -> f64 {
    rays.iter().filter_map(nearest).sum()
}

fn compare(name: &str, model: &Model, tracers: &[Box<dyn Tracer + '_>], rays: &[Ray]) -> Result<(), String> {
    let mut rates = vec![Vec::new(); tracers.len()];
    let mut answers: Vec<Vec<Answer>> = vec![Vec::new(); tracers.len()];
    for _ in 0..TURNS {
        for (at, tracer) in tracers.iter().enumerate() {
            let start = Instant::now();
            answers[at] = rays.iter().map(|ray| tracer.nearest(ray)).collect();
            rates[at].push(rays.len() as f64 / start.elapsed().as_secs_f64());
        }
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let hits = answers[0].iter().flatten().count();
    println!(
        "{{ \"mesh\": {name:?}, \"triangles\": {}, \"rays\": {}, \"hits\": {hits}, \"tracers\": [",
        model.triangles.len(),
        rays.len()
    );
    for (at, tracer) in tracers.iter().enumerate() {
        let mut ratios: Vec<f64> = rates[0]
            .iter()
            .zip(&rates[at])
            .map(|(ours, theirs)| ours / theirs)
            .collect();
        let told = agreement(model, rays, &answers[0], &answers[at], tracer.name() == "packed");
        println!(
            "  {{ \"name\": {:?}, \"rays_per_second\": {:.0}, \"ours_over_it\": {:.4}, \"same_triangle\": {}, \"same_distance\": {}, \"rim\": {}, \"other\": {} }}{}",
            tracer.name(),
            median(&mut rates[at].clone()),
            median(&mut ratios),
            told.triangle,
            told.distance,
            told.rim,
            told.other,
            if at + 1 < tracers.len() { "," } else { "" }
        );
        // What is neither is an error of one of the two.
        if told.other * 1000 > rays.len() {
            return Err(format!(
                "{} and ours disagree on {} rays",
                tracer.name(),
                told.other
            ));
        }
    }
    println!("] }}");
    Ok(())
}

#[derive(Default)]
struct Agreement {
    triangle: usize,
    distance: usize,
    /// One of the two hits where the other goes by, or goes on: at an outline.
    rim: usize,
    other: usize,
}

/// Steps of the grid within which a distance, or a ray's way past an edge, is the same.
const ROUNDING: f32 = 3.0;

fn agreement(model: &Model, rays: &[Ray], ours: &[Answer], theirs: &[Answer], packed: bool) -> Agreement {
    let mut told = Agreement::default();
    for ((ray, a), b) in rays.iter().zip(ours).zip(theirs) {
        match (a, b) {
            (None, None) => told.triangle += 1,
            // A packed mesh numbers its triangles otherwise.
            (Some(a), Some(b)) if a.0 == b.0 && !packed => told.triangle += 1,
            (Some(a), Some(b)) if (a.1 - b.1).abs() <= ROUNDING + a.1 * 1e-4 => told.distance += 1,
            _ if !packed
                && [a, b]
                    .iter()
                    .any(|hit| hit.is_some_and(|hit| model.is_at_rim(ray, hit.0, ROUNDING))) =>
            {
                told.rim += 1
            }
            _ => told.other += 1,
        }
    }
    told
}
