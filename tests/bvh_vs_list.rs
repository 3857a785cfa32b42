//! A tree answers what the list answers: the same triangle, distance and weights, on every ray.

mod meshes;

use meshes::{Model, Random};
use microlux::bvh::{closest, closest_linear, occluded, occluded_linear};
use microlux::shape::Slopes;

/// `rays` of all kinds, at limits from none to next to the hit.
fn compare(model: &Model, rays: u64, seed: u32) {
    let mesh = model.mesh();
    let nodes = &model.nodes;
    let mut random = Random(seed);
    let mut hits = 0;
    for i in 0..rays {
        let ray = random.ray(model);
        let slopes = Slopes::new(ray.dir);
        let tell = || format!("{} ray {i}: {ray:?}", model.name);
        let hit = closest_linear(&mesh, &ray, &slopes, i32::MAX);
        assert_eq!(closest(&mesh, nodes, &ray, &slopes, i32::MAX), hit, "{}", tell());
        assert_eq!(
            occluded(&mesh, nodes, &ray, &slopes, i32::MAX),
            hit.is_some(),
            "{}",
            tell()
        );
        hits += hit.is_some() as u64;
        // With limits the tree is asked, and the list knows: just before the hit, just behind, anywhere.
        let near = hit.map_or(1 << 20, |h| h.t);
        for t_max in [
            near,
            near.saturating_add(1),
            random.below(near as u32 + 1) as i32,
            0,
        ] {
            let within = hit.filter(|h| h.t < t_max);
            assert_eq!(
                closest(&mesh, nodes, &ray, &slopes, t_max),
                within,
                "{} {t_max}",
                tell()
            );
            assert_eq!(
                occluded(&mesh, nodes, &ray, &slopes, t_max),
                within.is_some(),
                "{} {t_max}",
                tell()
            );
        }
        if i % 64 == 0 {
            let t_max = near.saturating_add(random.below(2) as i32);
            let within = hit.filter(|h| h.t < t_max);
            assert_eq!(
                closest_linear(&mesh, &ray, &slopes, t_max),
                within,
                "{} {t_max}",
                tell()
            );
            assert_eq!(
                occluded_linear(&mesh, &ray, &slopes, t_max),
                within.is_some(),
                "{} {t_max}",
                tell()
            );
        }
    }
    println!(
        "{}: {rays} rays, {:.0} % hit",
        model.name,
        100.0 * hits as f64 / rays as f64
    );
    assert!(hits > rays / 20, "too few hits to mean something");
}

/// Every mesh gets an equal amount of work: rays in inverse proportion to its triangles. `MICROLUX_RAYS` is their sum.
#[test]
fn same_hit_as_the_list() {
    let mut models = vec![
        meshes::room(7),
        meshes::icosphere(1, 0),
        meshes::icosphere(3, 4),
        meshes::soup(300, 5),
        meshes::torus_knot(96, 12, 8),
    ];
    models.extend(meshes::files());
    let total: u64 = std::env::var("MICROLUX_RAYS").map_or(40_000, |n| n.parse().unwrap());
    let share: f64 = models.iter().map(|m| 1.0 / m.triangles.len() as f64).sum();
    for (i, model) in models.iter().enumerate() {
        let rays = total as f64 / (share * model.triangles.len() as f64);
        compare(model, (rays as u64).max(100), i as u32 + 1);
    }
}

#[test]
fn a_mesh_of_nothing() {
    let model = Model::new("nothing", meshes::room(0).grid, Vec::new(), Vec::new());
    let ray = microlux::geom::Ray {
        origin: microlux::geom::Point([0; 3]),
        dir: microlux::geom::Dir::Z,
    };
    let slopes = Slopes::new(ray.dir);
    assert_eq!(
        closest(&model.mesh(), &model.nodes, &ray, &slopes, i32::MAX),
        None
    );
    assert!(!occluded(&model.mesh(), &model.nodes, &ray, &slopes, i32::MAX));
}
