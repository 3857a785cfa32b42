//! Shadow rays reach the light that they are aimed at, however near it is: what a ray's origin is lifted by does not bring
//! the light's own surface into its way.

use microlux::bvh::{Node, build_mesh};
use microlux::color::{Radiance, albedo};
use microlux::geom::{Dir, Point, Ray};
use microlux::material::Material;
use microlux::num::{Share, Uniform};
use microlux::q;
use microlux::scene::{Mesh, SceneBuilder};
use microlux::shape::{Attributes, Disk, Geometry, Grid, Rectangle, Sphere, TriangleMesh};

const BRIGHT: Radiance = Radiance::new(q!(3), q!(2), q!(1));
const METRE: i32 = 1 << 16;

/// A ball below a lamp that hangs a third of its radius above it.
fn assert_lit(what: &str, lamp: Geometry, meshes: &[Mesh]) {
    let mut b = SceneBuilder::<2, 1, 1>::new();
    let matt = b
        .material(Material::lambert(albedo(Share::ONE, Share::ONE, Share::ONE)))
        .unwrap();
    b.emitter(lamp, matt, BRIGHT).unwrap();
    b.shape(Sphere::new(Point([0, -METRE, 0]), METRE), matt).unwrap();
    let mut nodes = [Node::EMPTY; 4];
    let scene = b.build_with(meshes, &mut nodes).unwrap();
    let mut samples = 0;
    for (i, j) in (-16..16).flat_map(|i| (-16..16).map(move |j| (i, j))) {
        let origin = Point([i * METRE / 20, METRE / 8, j * METRE / 20]);
        let ray = Ray { origin, dir: -Dir::Y };
        let Some(hit) = scene.closest(&ray) else {
            continue;
        };
        let vertex = scene.vertex(&ray, &hit);
        for k in 0..16u32 {
            let u = [k.wrapping_mul(0x9e37_79b9), k << 28 | 1 << 27].map(Uniform::from_bits);
            let Some(sample) = scene.sample_light(0, &vertex.surface, u) else {
                continue;
            };
            if sample.wi.dot(vertex.surface.normal) <= 0 {
                continue;
            }
            samples += 1;
            let shadow = Ray {
                origin: vertex.surface.leave(sample.wi),
                dir: sample.wi,
            };
            assert!(
                !scene.occluded(&shadow, sample.distance, sample.shape),
                "{what}: from {:?} to {:?}",
                vertex.surface.point,
                sample.wi
            );
        }
    }
    assert!(samples > 5000, "{what}: {samples}");
}

/// A square of 2 m, a third of a metre up, that shines down.
const CENTER: Point = Point([0, METRE / 3, 0]);

#[test]
fn a_rectangle() {
    let (x, z) = (Dir([METRE, 0, 0]), Dir([0, 0, METRE]));
    assert_lit(
        "rectangle",
        Rectangle::new(CENTER, x, z, [METRE; 2]).unwrap().into(),
        &[],
    );
}

#[test]
fn a_disk() {
    assert_lit("disk", Disk::new(CENTER, -Dir::Y, METRE).into(), &[]);
}

#[test]
fn a_mesh() {
    let corners = [[0, 0], [0, 1], [1, 1], [1, 0]].map(|[x, z]| [100 + 32768 * x, 100, 100 + 32768 * z]);
    let grid = Grid::new(Point([-METRE - 400, METRE / 3, -METRE - 400]), 2).unwrap();
    let mut triangles = [[0, 2, 1], [0, 3, 2]];
    let mut nodes = [Node::EMPTY; 2];
    let used = build_mesh(&corners, &mut triangles, &mut nodes).unwrap();
    let mesh = Mesh {
        triangles: TriangleMesh {
            grid,
            vertices: &corners,
            triangles: &triangles,
            attributes: Attributes::NONE,
        }
        .into(),
        nodes: &nodes[..used],
    };
    assert_lit("mesh", Geometry::Mesh(0), &[mesh]);
}
