//! Work that grows: scenes of several meshes, strips of several rows, several samples.

use microlux::bvh::{Node, max_nodes};
use microlux::color::{Radiance, albedo};
use microlux::geom::{Point, Ray};
use microlux::integrator::Path;
use microlux::light::Light;
use microlux::material::Material;
use microlux::num::Share;
use microlux::q;
use microlux::render::{Renderer, Settings};
use microlux::sampler::Independent;
use microlux::scene::{Mesh, SceneBuilder, builtin::Builtin};
use microlux::shape::{Geometry, Grid, TriangleMesh};

use crate::mesh::Model;
use crate::{counted, rays};

/// The same triangles at up to eight places, each a mesh with its tree in one scene.
pub fn copies(model: &Model, copies: usize, count: usize) -> Result<(), String> {
    const STEP: i32 = 1 << 16;
    let place = |at: usize| [at & 1, at >> 1 & 1, at >> 2 & 1].map(|c| c as i32 * STEP);
    let meshes: Vec<Mesh> = (0..copies.min(8))
        .map(|at| Mesh {
            triangles: TriangleMesh {
                grid: Grid::new(Point(place(at)), 0).unwrap_or(Grid::UNIT),
                ..model.plain()
            }
            .into(),
            nodes: &model.nodes,
        })
        .collect();
    let mut builder = SceneBuilder::<8, 1, 1>::new();
    let told = |error: microlux::scene::SceneError| format!("{error:?}");
    let grey = [q!(0.5, Share); 3];
    let material = builder
        .material(Material::lambert(albedo(grey[0], grey[1], grey[2])))
        .map_err(told)?;
    for number in 0..meshes.len() {
        builder
            .shape(Geometry::Mesh(number as u16), material)
            .map_err(told)?;
    }
    let radiance = Radiance::WHITE;
    builder.light(Light::Environment { radiance }).map_err(told)?;
    let mut nodes = [Node::EMPTY; max_nodes(8)];
    let scene = builder.build_with(&meshes, &mut nodes).map_err(told)?;
    let mut high = model.high;
    for at in 0..meshes.len() {
        high = [0, 1, 2].map(|axis| high[axis].max(model.high[axis] + place(at)[axis]));
    }
    let rays = rays([model.low, high], count);
    let triangles = model.triangles.len() * meshes.len();
    let bytes = meshes
        .iter()
        .map(|mesh| mesh.triangles.bytes() + size_of_val(mesh.nodes))
        .sum::<usize>();
    let sum = counted(&rays, &|ray: &Ray| scene.closest(ray).map(|hit| f64::from(hit.t)));
    println!(
        "triangles={triangles} rays={} bytes={bytes} sum={sum}",
        rays.len()
    );
    Ok(())
}

/// 240 pixels wide, `direct`; says what lies in memory while a strip is rendered.
pub fn strip(size: &str) -> Result<(), String> {
    let (rows, spp) = size.split_once('x').ok_or("strip:ROWSxSPP")?;
    let number = |text: &str| text.parse::<u32>().map_err(|_| format!("{text}?"));
    let (rows, spp) = (number(rows)?, number(spp)?);
    let settings = Settings {
        width: 240,
        height: 48,
        spp,
    };
    let drawn = Builtin::Cornell.with(|scene, camera| {
        let mut renderer = Renderer::new(scene, camera, Path::direct(), Independent::new(1), settings);
        let mut strip = vec![Radiance::BLACK; (240 * rows) as usize];
        let bytes = size_of_val(&*strip) + size_of_val(&renderer);
        let pixels = counted_picture(&mut renderer, &mut strip);
        println!("samples={} bytes={bytes}", pixels * u64::from(spp));
    });
    drawn.map_err(|error| format!("{error:?}"))
}

/// What is counted. Callgrind is told its name.
#[inline(never)]
#[unsafe(no_mangle)]
extern "Rust" fn counted_picture(renderer: &mut Renderer<'_, Independent>, strip: &mut [Radiance]) -> u64 {
    let mut pixels = 0;
    while let Some(tile) = renderer.step(strip) {
        pixels += tile.pixels.len() as u64;
    }
    pixels
}
