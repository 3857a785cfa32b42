//! From inside a closed mesh no ray gets out: not by its faces, and not by the edges and vertices that they share.
//!
//! `MICROLUX_RAYS` is how many for each mesh. Spot and the bunny lie beside the repository; two meshes need no file. The
//! bunny's holes are closed with a fan each, so that whatever gets out got out by an edge.

#[path = "../../tests/meshes/mod.rs"]
#[allow(dead_code)]
mod meshes;

use std::collections::HashMap;

use meshes::{Model, Random};
use microlux::bvh::{check_mesh, closest, occluded};
use microlux::geom::{Dir, Point, Ray};
use microlux::shape::{Slopes, Triangles};
use microlux_bake::Packed;

/// Places inside that rays begin at.
const ORIGINS: usize = 48;

/// Edges that an odd number of triangles have.
fn open_edges(triangles: &[[u16; 3]]) -> Vec<[u16; 2]> {
    let mut counts: HashMap<[u16; 2], u32> = HashMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *counts.entry([from.min(to), from.max(to)]).or_default() += 1;
        }
    }
    let mut open: Vec<_> = counts.into_iter().filter(|(_, count)| count % 2 == 1).collect();
    open.sort();
    open.into_iter().map(|(edge, _)| edge).collect()
}

/// The mesh with a fan over each hole, about the hole's middle.
fn closed(model: &Model) -> Model {
    let (mut vertices, mut triangles) = (model.vertices.clone(), model.triangles.clone());
    let mut open = open_edges(&triangles);
    while let Some(first) = open.pop() {
        let mut rim = vec![first];
        // Edges that are joined to those of the rim, from either end.
        while let Some(at) = open.iter().position(|edge| {
            rim.iter()
                .any(|known| known.contains(&edge[0]) || known.contains(&edge[1]))
        }) {
            rim.push(open.swap_remove(at));
        }
        let sum = |axis: usize| {
            rim.iter()
                .map(|edge| u32::from(vertices[edge[0] as usize][axis]))
                .sum::<u32>()
        };
        let middle = [0, 1, 2].map(|axis| (sum(axis) / rim.len() as u32) as u16);
        let hub = vertices.len() as u16;
        vertices.push(middle);
        triangles.extend(rim.iter().map(|&[a, b]| [b, a, hub]));
    }
    assert_eq!(open_edges(&triangles), [[0u16; 2]; 0], "{}", model.name);
    with_tree(&model.name, model, vertices, triangles)
}

/// With a tree as `host-sim` builds it.
fn with_tree(name: &str, model: &Model, vertices: Vec<[u16; 3]>, mut triangles: Vec<[u16; 3]>) -> Model {
    let nodes = microlux_bake::build(&vertices, &mut triangles).unwrap();
    let made = Model {
        name: name.to_string(),
        grid: model.grid,
        vertices,
        triangles,
        nodes,
    };
    check_mesh(&made.mesh(), &made.nodes).unwrap();
    made
}

/// Whether a ray from a place crosses the mesh an odd number of times (Möller and Trumbore 1997, in f64).
fn is_inside(model: &Model, place: [f64; 3], dir: [f64; 3]) -> bool {
    let sub = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let crosses = |triangle: &&[u16; 3]| {
        let [a, b, c] = triangle.map(|i| model.vertices[i as usize].map(f64::from));
        let (e, f, from) = (sub(b, a), sub(c, a), sub(place, a));
        let (p, q) = (cross(dir, f), cross(from, e));
        let determinant = dot(e, p);
        let [u, v, t] = [dot(from, p), dot(dir, q), dot(f, q)].map(|part| part / determinant);
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0
    };
    model.triangles.iter().filter(crosses).count() % 2 == 1
}

/// Grid points inside, and not within a few steps of the surface.
fn origins(model: &Model) -> Vec<[u16; 3]> {
    let mut random = Random(31);
    let mut found = Vec::new();
    for _ in 0..100_000 {
        if found.len() == ORIGINS {
            break;
        }
        let place = [0; 3].map(|_| random.below(65536) as u16);
        // Rounding moves a ray's origin by half a step, and what it sees by as much.
        let near = |axis: usize, by: f64| {
            let mut moved = place.map(f64::from);
            moved[axis] += by;
            is_inside(model, moved, [0.5377, -0.6124, 0.5795])
        };
        let deep = (0..3).all(|axis| near(axis, -6.0) && near(axis, 6.0));
        if deep && is_inside(model, place.map(f64::from), [-0.3021, 0.8443, 0.4425]) {
            found.push(place);
        }
    }
    assert_eq!(found.len(), ORIGINS, "{}: places inside", model.name);
    found
}

/// Rays from inside, a third of them anywhere, a third at vertices, a third at edges: how many got out.
fn escapes(model: &Model, origins: &[[u16; 3]], rays: u64, seed: u32) -> u64 {
    let mut random = Random(seed);
    let packed = Packed::new(&model.plain(), &model.nodes).unwrap();
    let (plain, packed) = (model.mesh(), packed.mesh());
    let at = |v: [u16; 3]| model.grid.to_scene(v);
    let mut escaped = 0;
    for i in 0..rays {
        let origin = at(origins[random.below(origins.len() as u32) as usize]);
        let triangle = model.triangles[random.below(model.triangles.len() as u32) as usize];
        let [a, b, _] = triangle.map(|i| at(model.vertices[i as usize]).0);
        let aim = match i % 3 {
            0 => None,
            1 => Some(a),
            _ => {
                let share = random.unit();
                Some([0, 1, 2].map(|axis| a[axis] + (f64::from(b[axis] - a[axis]) * share).round() as i32))
            }
        };
        let dir = aim
            .and_then(|to| Dir::new(origin.to(Point(to)).0))
            .unwrap_or_else(|| random.dir());
        let (ray, slopes) = (Ray { origin, dir }, Slopes::new(dir));
        // What flash holds, too, and shadow rays.
        let is_hit = match i % 16 {
            0 => closest(&packed.triangles, packed.nodes, &ray, &slopes, i32::MAX).is_some(),
            1 => occluded(&plain, &model.nodes, &ray, &slopes, i32::MAX),
            _ => closest(&plain, &model.nodes, &ray, &slopes, i32::MAX).is_some(),
        };
        escaped += u64::from(!is_hit);
    }
    escaped
}

fn all(model: &Model, rays: u64) -> u64 {
    let origins = origins(model);
    std::thread::scope(|scope| {
        let (origins, half) = (&origins, rays / 2);
        let threads = [1, 2].map(|seed| scope.spawn(move || escapes(model, origins, half, seed)));
        threads.into_iter().map(|thread| thread.join().unwrap()).sum()
    })
}

#[test]
fn no_ray_gets_out() {
    let rays = std::env::var("MICROLUX_RAYS").map_or(60_000, |n| n.parse().unwrap());
    let mut models = vec![meshes::icosphere(4, 6), meshes::torus_knot(200, 20, 7)];
    let files = meshes::files().into_iter();
    models.extend(files.filter(|model| ["spot", "stanford-bunny"].contains(&&*model.name)));
    for model in models {
        let model = closed(&model);
        let escaped = all(&model, rays);
        println!("{}: {rays} rays, {escaped} got out", model.name);
        assert_eq!(escaped, 0, "{}", model.name);
    }
}

/// One triangle less by one step at one corner: a crack that rays at its edges find.
#[test]
fn a_crack_of_one_step_is_found() {
    let model = meshes::icosphere(2, 6);
    let (mut vertices, mut triangles) = (model.vertices.clone(), model.triangles.clone());
    let before = all(
        &with_tree("whole", &model, vertices.clone(), triangles.clone()),
        30_000,
    );
    // Towards the triangle's middle.
    let [a, b, c] = triangles[7].map(|i| vertices[i as usize].map(i32::from));
    let shrunk = [0, 1, 2].map(|axis| (a[axis] + (b[axis] + c[axis] - 2 * a[axis]).signum()) as u16);
    triangles[7][0] = vertices.len() as u16;
    vertices.push(shrunk);
    let cracked = with_tree("cracked", &model, vertices, triangles);
    let after = all(&cracked, 3_000_000);
    println!("{before} got out of the whole ball, {after} by the crack");
    assert!(before == 0 && after > 0, "{before} {after}");
    assert!(matches!(cracked.mesh(), Triangles::Plain(_)));
}
