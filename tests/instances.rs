//! Meshes in places of their own: nothing leaks, and no ray meets the triangle that it left.

#[allow(dead_code)]
mod meshes;

use meshes::{Model, Random};
use microlux::bvh::{Node, max_nodes};
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Point, REACH, Ray, Rotation};
use microlux::light::Light;
use microlux::material::Material;
use microlux::num::{Metres, Share};
use microlux::scene::{Borrowed, Mesh, Scene, SceneBuilder, SceneError};
use microlux::shape::Instance;

/// A scene of one instance under a sky.
fn with(model: &Model, instance: Instance, look: impl FnOnce(&Scene)) {
    let meshes = [Mesh {
        triangles: model.mesh(),
        nodes: &model.nodes,
    }];
    let mut builder = SceneBuilder::<1, 1, 1>::new();
    let white = builder
        .material(Material::lambert(Albedo([Share::ONE; 3])))
        .unwrap();
    builder.shape(instance, white).unwrap();
    let radiance = Radiance::WHITE;
    builder.light(Light::Environment { radiance }).unwrap();
    let borrowed = Borrowed {
        meshes: &meshes,
        ..Borrowed::default()
    };
    let mut nodes = [Node::EMPTY; max_nodes(1)];
    look(&builder.build_from(borrowed, &mut nodes).unwrap());
}

/// All kinds of scale and turn, the mesh's middle somewhere near the scene's.
fn places(model: &Model, random: &mut Random) -> Vec<Instance> {
    let middle = model.grid.to_scene([32768; 3]);
    let cube = i64::from(65536u32 << model.grid.shift());
    let scales = [1 << 12, 9999, 40_000, 1 << 16, 111_111, 1 << 19, 1 << 20];
    let fits = |scale: &i32| (cube * i64::from(*scale)) >> 16 < i64::from(REACH) / 2;
    let place = |scale: i32| {
        let mut part = || random.bits() as i32 >> 4;
        let turned = Instance::new(0)
            .scaled(Metres::from_bits(scale))
            .turned(Rotation::new([part(), part(), part(), part()]).unwrap());
        let Point(from) = turned.place(middle);
        turned.moved(Point([0, 1, 2].map(|i| (part() >> 8) - from[i])))
    };
    scales.into_iter().filter(fits).map(place).collect()
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let mut random = Random(21);
    for model in [meshes::icosphere(3, 2), meshes::icosphere(4, 6), meshes::room(4)] {
        for instance in places(&model, &mut random) {
            with(&model, instance, |scene| {
                let inner = f64::from(1u32 << model.grid.shift()) * 14_000.0;
                let middle = model.grid.to_scene([32768; 3]).0;
                for _ in 0..4000 {
                    let mut near = |c: i32| c + (inner * (2.0 * random.unit() - 1.0)) as i32;
                    let origin = instance.place(Point(middle.map(&mut near)));
                    // Half of them through a vertex, as nearly as may be.
                    let vertex = model.vertices[random.below(model.vertices.len() as u32) as usize];
                    let at = instance.place(model.grid.to_scene(vertex));
                    let aimed = origin.to(at).normalize().map(|(dir, _)| dir);
                    let dir = aimed.filter(|_| random.below(2) == 0).unwrap_or(random.dir());
                    let hit = scene.closest(&Ray { origin, dir });
                    assert!(hit.is_some(), "{} {instance:?} {origin:?} {dir:?}", model.name);
                }
            });
        }
    }
}

#[test]
fn no_ray_meets_the_triangle_that_it_left() {
    let mut random = Random(22);
    let mut bounced = 0;
    for model in [
        meshes::icosphere(3, 0),
        meshes::icosphere(4, 6),
        meshes::torus_knot(200, 20, 5),
        meshes::soup(400, 3),
    ] {
        for instance in places(&model, &mut random) {
            with(&model, instance, |scene| {
                for _ in 0..4000 {
                    let vertex = model.vertices[random.below(model.vertices.len() as u32) as usize];
                    let Point(at) = instance.place(model.grid.to_scene(vertex));
                    let from = random.dir().times(REACH);
                    let origin = Point([0, 1, 2].map(|i| at[i] + from.0[i]));
                    let Some((dir, _)) = origin
                        .to(Point(at.map(|c| c + random.below(999) as i32)))
                        .normalize()
                    else {
                        continue;
                    };
                    let ray = Ray { origin, dir };
                    let Some(hit) = scene.closest(&ray) else { continue };
                    let vertex = scene.vertex(&ray, &hit);
                    let out = random.dir();
                    let dir = if out.dot(vertex.surface.normal) < 0 {
                        -out
                    } else {
                        out
                    };
                    for dir in [dir, -dir] {
                        let origin = vertex.surface.leave(dir);
                        bounced += 1;
                        let again = scene.closest(&Ray { origin, dir });
                        assert!(
                            again.is_none_or(|again| again.triangle != hit.triangle),
                            "{} {instance:?} {ray:?} {hit:?} {dir:?} {again:?}",
                            model.name
                        );
                    }
                }
            });
        }
    }
    assert!(bounced > 50_000, "{bounced}");
}

#[test]
fn what_cannot_be_is_named() {
    let model = meshes::icosphere(1, 0);
    let meshes = [Mesh {
        triangles: model.mesh(),
        nodes: &model.nodes,
    }];
    let refused = |instance: Instance, emits: bool| {
        let mut builder = SceneBuilder::<1, 1, 2>::new();
        let black = builder.material(Material::Black).unwrap();
        if emits {
            builder.emitter(instance, black, Radiance::WHITE).unwrap();
        } else {
            builder.shape(instance, black).unwrap();
        }
        let borrowed = Borrowed {
            meshes: &meshes,
            ..Borrowed::default()
        };
        let mut nodes = [Node::EMPTY; max_nodes(1)];
        builder.build_from(borrowed, &mut nodes).unwrap_err()
    };
    let shape = 0;
    assert_eq!(
        refused(Instance::new(1), false),
        SceneError::NoSuchMesh { shape, mesh: 1 }
    );
    assert_eq!(
        refused(Instance::new(0), true),
        SceneError::InstanceLight { shape }
    );
    let far = Instance::new(0).moved(Point([REACH, 0, 0]));
    assert_eq!(refused(far, false), SceneError::TooFar { shape });
    assert_eq!(refused(Instance::new(0), false), SceneError::NoLight);
}
