//! No ray leaves a closed mesh, and no ray that starts on a mesh meets the triangle it starts from.

mod meshes;

use meshes::{Model, Random};
use microlux::bvh::closest;
use microlux::geom::{Dir, Point, Ray};
use microlux::num::mul_q16;
use microlux::shape::Slopes;

/// Directions from a point: anywhere, and through each vertex and edge of the mesh.
fn dirs<'a>(model: &'a Model, from: Point, random: &'a mut Random) -> impl Iterator<Item = Dir> + 'a {
    let towards = move |at: [i32; 3]| from.to(Point(at)).normalize().map(|(dir, _)| dir);
    let at = |i: u16| model.grid.to_scene(model.vertices[i as usize]).0;
    let vertices = (0..model.vertices.len() as u16).filter_map(move |i| towards(at(i)));
    let edges = model
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let middles = edges.filter_map(move |(a, b)| {
        let (a, b) = (at(a), at(b));
        towards([0, 1, 2].map(|i| (a[i] + b[i]) >> 1))
    });
    vertices.chain(middles).chain((0..4000).map(|_| random.dir()))
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let mut random = Random(5);
    for model in [
        meshes::room(0),
        meshes::room(7),
        meshes::icosphere(2, 0),
        meshes::icosphere(4, 6),
    ] {
        let middle = model.grid.to_scene([32768; 3]);
        let inner = (1 << model.grid.shift()) * 16000;
        for _ in 0..6 {
            let origin = Point(
                middle
                    .0
                    .map(|c| c + (inner as f64 * (2.0 * random.unit() - 1.0)) as i32),
            );
            for dir in dirs(&model, origin, &mut Random(random.bits())) {
                let ray = Ray { origin, dir };
                let hit = closest(&model.mesh(), &model.nodes, &ray, &Slopes::new(dir), i32::MAX);
                assert!(hit.is_some(), "{}: {ray:?}", model.name);
            }
        }
    }
}

/// From grid points through grid points in directions of slopes that are exact in Q13, so that the rays pass exactly
/// through vertices and edges.
#[test]
fn no_ray_leaves_through_a_vertex_or_edge_it_meets_exactly() {
    let mut random = Random(6);
    for _ in 0..2000 {
        // A fan of triangles around one vertex, over the whole view from below, with the ray through that vertex.
        let middle = [32768u16 + random.below(64) as u16, 32768, 40000];
        let ring: Vec<[u16; 3]> = (0..7)
            .map(|i| {
                let (s, c) = (i as f64 / 7.0 * std::f64::consts::TAU).sin_cos();
                let r = 1.0 + 20000.0 * random.unit() * random.unit();
                [
                    (32768.0 + r * c).round() as u16,
                    (32768.0 + r * s).round() as u16,
                    30000 + random.below(20000) as u16,
                ]
            })
            .collect();
        let mut vertices = ring;
        vertices.push(middle);
        let triangles = (0..7).map(|i| [i, (i + 1) % 7, 7]).collect();
        let model = Model::new("fan", meshes::room(0).grid, vertices, triangles);
        let slope = [0, 1].map(|_| {
            [0, 1 << 13, -(1 << 13), 1 << 12, random.below(16384) as i32 - 8192][random.below(5) as usize]
        });
        let origin = model.grid.to_scene(middle).0;
        let down = 8192 * (1 + random.below(2) as i32);
        let origin = Point([
            origin[0] - slope[0] * (down >> 13),
            origin[1] - slope[1] * (down >> 13),
            origin[2] - down,
        ]);
        // A direction as long as it must be for these slopes; its length does not matter here.
        let dir = Dir([slope[0] << 3, slope[1] << 3, 1 << 16]);
        let hit = closest(
            &model.mesh(),
            &model.nodes,
            &Ray { origin, dir },
            &Slopes::new(dir),
            i32::MAX,
        );
        let inside = model.vertices[..7]
            .iter()
            .all(|v| (v[0] as i32 - middle[0] as i32).abs() > 100);
        assert!(hit.is_some() || !inside, "{origin:?} {dir:?}");
    }
}

/// A ray that starts [`microlux::shape::TriangleMesh::offset`] off the surface never meets the triangle it left.
#[test]
fn a_ray_that_leaves_does_not_hit_where_it_left() {
    let mut random = Random(7);
    let mut bounced = 0;
    let mut models = vec![
        meshes::room(0),
        meshes::room(7),
        meshes::icosphere(3, 0),
        meshes::icosphere(4, 6),
    ];
    models.extend([meshes::torus_knot(200, 20, 7), meshes::soup(400, 0)]);
    models.extend(meshes::files());
    for model in models {
        let mesh = model.mesh();
        for _ in 0..20_000 {
            let ray = random.ray(&model);
            let Some(hit) = closest(&mesh, &model.nodes, &ray, &Slopes::new(ray.dir), i32::MAX) else {
                continue;
            };
            let Some(normal) = mesh.normal(hit.triangle) else {
                continue;
            };
            let normal = if normal.dot(ray.dir) > 0 { -normal } else { normal };
            let at = mesh.point(&hit).unwrap();
            // The next unit up: `along` rounds down.
            let origin = Point([0, 1, 2].map(|a| at.0[a] + mul_q16(mesh.offset(), normal.0[a] + 1)));
            let mut dir = random.dir();
            if dir.dot(normal) < 0 {
                dir = -dir;
            }
            let next = Ray { origin, dir };
            bounced += 1;
            let again = closest(&mesh, &model.nodes, &next, &Slopes::new(dir), i32::MAX);
            assert!(
                again.is_none_or(|h| h.triangle != hit.triangle),
                "{}: {ray:?} {hit:?} {next:?} {again:?}",
                model.name
            );
        }
    }
    assert!(bounced > 40_000);
}
