//! A scene's tree answers what its list answers: the same shape, triangle and distance, on every ray.

mod scenes;

use microlux::bvh;
use microlux::geom::{FAR, Point, REACH, Ray};
use microlux::scene::{Hit, Scene};
use microlux::shape::{Geometry, LocalRay, Slopes};
use scenes::{Draft, Random};

/// From anywhere in reach or around it, from where a shape was met or its middle; anywhere, or towards a shape.
fn ray(random: &mut Random, scene: &Scene, met: Option<(Ray, Hit)>) -> Ray {
    let shapes = scene.parts().shapes;
    let middle = |random: &mut Random| match shapes[random.below(shapes.len())].geometry {
        Geometry::Sphere(sphere) => sphere.center,
        Geometry::Plane(plane) => plane.point,
        Geometry::Disk(disk) => disk.center,
        Geometry::Rectangle(rectangle) => rectangle.center,
        Geometry::Mesh(mesh) => {
            let mesh = scene.parts().meshes[mesh as usize].triangles.plain().unwrap();
            mesh.grid.to_scene(random.pick(mesh.vertices))
        }
        Geometry::Instance(instance) => {
            let mesh = scene.parts().meshes[instance.mesh as usize]
                .triangles
                .plain()
                .unwrap();
            instance.place(mesh.grid.to_scene(random.pick(mesh.vertices)))
        }
        Geometry::Implicit(solid) => {
            let (low, high) = solid.bounds(scene.parts().blobs);
            Point([0, 1, 2].map(|i| low.0[i] + (high.0[i] - low.0[i]) / 2))
        }
    };
    let origin = match (random.below(8), met) {
        (0..=2, Some((ray, hit))) => scene.vertex(&ray, &hit).surface.point,
        (3, _) => middle(random),
        (4, _) => random.point(2 * REACH),
        (5, _) => random.point(100),
        _ => random.point(REACH),
    };
    let aim = if random.one_in(2) {
        let at = middle(random);
        origin.to(at).normalize().map(|(dir, _)| dir)
    } else {
        None
    };
    Ray {
        origin,
        dir: aim.unwrap_or_else(|| random.dir()),
    }
}

/// How near the nearest of all shapes but one is, each asked by itself; beyond [`FAR`] if none is met.
fn distance_but(scene: &Scene, ray: &Ray, but: u16) -> i32 {
    let slopes = Slopes::new(ray.dir);
    let parts = scene.parts();
    let others = parts
        .shapes
        .iter()
        .enumerate()
        .filter(|(i, _)| *i != but as usize);
    others
        .filter_map(|(_, shape)| match shape.geometry {
            Geometry::Mesh(mesh) => {
                let triangles = &parts.meshes[mesh as usize].triangles;
                bvh::closest_linear(triangles, ray, &slopes, FAR + 1).map(|hit| hit.t)
            }
            Geometry::Instance(instance) => {
                let triangles = &parts.meshes[instance.mesh as usize].triangles;
                let LocalRay { ray, slopes } = instance.enter(ray)?;
                let hit = bvh::closest_linear(triangles, &ray, &slopes, instance.limit(FAR + 1))?;
                Some(instance.distance(hit.t))
            }
            Geometry::Implicit(solid) => solid.intersect(parts.blobs, ray, FAR + 1),
            closed => closed.intersect(ray, FAR + 1),
        })
        .min()
        .unwrap_or(FAR + 1)
}

/// `MICROLUX_SCENES` is how many scenes.
#[test]
fn same_hit_as_the_list() {
    let scenes = std::env::var("MICROLUX_SCENES").map_or(1500, |n| n.parse().unwrap());
    let (mut rays, mut hits, mut ties) = (0u32, 0u32, 0u32);
    for seed in 0..scenes {
        let mut random = Random(seed);
        let draft = Draft::random(&mut random);
        let meshes = draft.meshes();
        let scene = Scene::new(draft.parts(&meshes)).unwrap();
        let mut met = None;
        for i in 0..200 {
            let ray = ray(&mut random, &scene, met);
            let tell = || format!("scene {seed}, ray {i}: {ray:?}");
            let hit = scene.closest_linear(&ray);
            assert_eq!(scene.closest(&ray), hit, "{}", tell());
            let t = hit.map_or(FAR + 1, |hit| hit.t);
            for distance in [t, t + 1, 1 + random.below(t as usize) as i32, 0, FAR + 1] {
                let nearer = hit.is_some_and(|hit| hit.t < distance);
                assert_eq!(
                    scene.occluded(&ray, distance, None),
                    nearer,
                    "{distance}, {}",
                    tell()
                );
            }
            // Without one of the shapes: most often that which is hit.
            let but = hit.map_or(0, |hit| hit.shape);
            let any = random.below(scene.parts().shapes.len()) as u16;
            let but = random.pick(&[but, but, any]);
            let next = distance_but(&scene, &ray, but);
            for distance in [next, next + 1, 1 + random.below(next as usize) as i32] {
                assert_eq!(
                    scene.occluded(&ray, distance, Some(but)),
                    next < distance && next <= FAR,
                    "{distance} without {but}, {}",
                    tell()
                );
            }
            rays += 1;
            if let Some(hit) = hit {
                hits += 1;
                let twin = |s: &microlux::scene::Shape| {
                    s.geometry == scene.parts().shapes[hit.shape as usize].geometry
                };
                ties += (scene.parts().shapes.iter().filter(|s| twin(s)).count() > 1) as u32;
                met = Some((ray, hit));
            }
        }
    }
    println!("{rays} rays, {hits} hits, {ties} of them on one of several shapes at the same place");
    assert!(hits > rays / 4 && ties > rays / 20, "too few to mean something");
}
