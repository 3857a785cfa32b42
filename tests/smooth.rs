//! Smooth normals: nothing leaks through a surface, and no outline is black.

use microlux::bvh::{Node, build_mesh, max_nodes};
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Dir, Octahedral, Point, Ray};
use microlux::integrator::Path;
use microlux::light::Light;
use microlux::material::Material;
use microlux::num::Share;
use microlux::sampler::{Independent, PcgRxsMXs32, Sampler};
use microlux::scene::{Borrowed, Mesh, Scene, SceneBuilder};
use microlux::shape::{Attributes, Geometry, Grid, TriangleMesh};

/// A large horizontal triangle at height 0 about the origin, with these normals, in the light of a point.
fn on_floor<R>(normals: &[Octahedral], lamp: [i32; 3], look: impl FnOnce(&Scene) -> R) -> R {
    let origin = Point([-(1 << 19), -(1 << 19), -(1 << 19)]);
    let grid = Grid::new(origin, 4).unwrap();
    let vertices = [[100, 32768, 100], [65000, 32768, 100], [32768, 32768, 65000]];
    let mut triangles = [[0, 2, 1]];
    let mut tree = [Node::EMPTY; max_nodes(1)];
    let used = build_mesh(&vertices, &mut triangles, &mut tree).unwrap();
    let meshes = [Mesh {
        triangles: TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &triangles,
            attributes: Attributes {
                normals,
                ..Attributes::NONE
            },
        }
        .into(),
        nodes: &tree[..used],
    }];
    let mut builder = SceneBuilder::<1, 1, 1>::new();
    let white = builder
        .material(Material::lambert(Albedo([Share::ONE; 3])))
        .unwrap();
    builder.shape(Geometry::Mesh(0), white).unwrap();
    let light = Light::Point {
        position: Point(lamp),
        intensity: Radiance::from_bits([1 << 16; 3], 0),
    };
    builder.light(light).unwrap();
    let borrowed = Borrowed {
        meshes: &meshes,
        ..Borrowed::default()
    };
    let mut nodes = [Node::EMPTY; max_nodes(1)];
    look(&builder.build_from(borrowed, &mut nodes).unwrap())
}

fn towards_the_middle(eye: [i32; 3]) -> Ray {
    let origin = Point(eye);
    let (dir, _) = origin.to(Point([0; 3])).normalize().unwrap();
    Ray { origin, dir }
}

/// What a ray from `eye` to the origin brings back of it, all its normals (x, y, 0) on the way to `lean`.
fn seen(lean: [i32; 3], lamp: [i32; 3], eye: [i32; 3]) -> Radiance {
    let normals = [Octahedral::encode(Dir::new(lean).unwrap()); 3];
    on_floor(&normals, lamp, |scene| {
        let mut sampler = Independent::<PcgRxsMXs32>::new(1);
        sampler.start(0, 0, 0);
        Path::direct().radiance(scene, towards_the_middle(eye), &mut sampler, &mut 0)
    })
}

const STEP: i32 = 1 << 16;

/// The normal leans towards a lamp that stands below the floor: its cosine there is positive, and it must not count.
#[test]
fn a_lamp_below_lights_nothing_above() {
    let lean = [STEP, STEP, 0];
    let above = seen(lean, [4 * STEP, STEP, 0], [0, 4 * STEP, 0]);
    assert!(!above.is_black());
    let below = seen(lean, [4 * STEP, -STEP, 0], [0, 4 * STEP, 0]);
    assert!(below.is_black(), "{below:?}");
}

/// From the other side it is the same.
#[test]
fn a_lamp_above_lights_nothing_below() {
    let lean = [STEP, STEP, 0];
    assert!(!seen(lean, [-4 * STEP, -STEP, 0], [0, -4 * STEP, 0]).is_black());
    assert!(seen(lean, [-4 * STEP, STEP, 0], [0, -4 * STEP, 0]).is_black());
}

/// The normal leans away from the eye so far that it faces away: there the floor is seen as it is.
#[test]
fn an_outline_is_lit_by_the_true_normal() {
    let (lamp, eye) = ([-2 * STEP, 4 * STEP, 0], [-6 * STEP, STEP, 0]);
    let turned = seen([STEP, STEP / 2, 0], lamp, eye);
    let flat = seen([0, STEP, 0], lamp, eye);
    let number = |light: Radiance| light.max_channel().to_fixed(16) as f64;
    let ratio = number(turned) / number(flat);
    assert!((ratio - 1.0).abs() < 0.01, "{turned:?} {flat:?}");
}

/// Where both normals agree on the sides, the cosine is the leaning one's.
#[test]
fn the_cosine_is_the_shading_normals() {
    // Straight above the point: cos 45° of what the flat floor gets.
    let (lamp, eye) = ([0, 4 * STEP, 0], [STEP, 4 * STEP, 0]);
    let number = |light: Radiance| light.max_channel().to_fixed(16) as f64;
    let ratio = number(seen([STEP, STEP, 0], lamp, eye)) / number(seen([0, STEP, 0], lamp, eye));
    assert!((ratio - 0.5f64.sqrt()).abs() < 0.01, "{ratio}");
}

/// A mirror there shows things behind it, or on it.
#[test]
fn a_mesh_is_flat_where_its_vertices_have_no_normals() {
    let is_flat = |normals: &[Octahedral]| {
        on_floor(normals, [0, 4 * STEP, 0], |scene| {
            let ray = towards_the_middle([STEP, 4 * STEP, 0]);
            let hit = scene.closest(&ray).unwrap();
            scene.is_flat(&hit, &scene.vertex(&ray, &hit))
        })
    };
    assert!(is_flat(&[]));
    assert!(!is_flat(&[Octahedral::encode(Dir::Y); 3]));
}
