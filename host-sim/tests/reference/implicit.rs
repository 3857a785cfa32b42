//! Solids given by a function.

use host_sim::reference::{Ball, Bound, Capsule, Implicit, Part, Ray};

use super::chi_square::Random;
use super::*;

fn axes() -> [Vec3; 3] {
    // A rotation with short numbers.
    [
        vec3(0.36, 0.48, -0.8),
        vec3(-0.8, 0.6, 0.0),
        vec3(0.48, 0.64, 0.6),
    ]
}

fn ball(center: Vec3, radius: f64) -> Ball {
    Ball { center, radius }
}

fn solids() -> Vec<(&'static str, Implicit)> {
    let capsule = Capsule {
        a: vec3(-0.5, 0.2, 0.3),
        b: vec3(0.6, -0.4, 0.1),
        radius: 0.3,
    };
    let gyroid = |bound| Implicit::Gyroid {
        center: vec3(0.1, 0.0, -0.1),
        axes: axes(),
        cell: 0.7,
        thickness: 0.12,
        bound,
    };
    vec![
        (
            "torus",
            Implicit::Torus {
                center: vec3(0.1, -0.1, 0.2),
                axis: axes()[2],
                major: 0.7,
                minor: 0.25,
            },
        ),
        ("capsule", Implicit::Capsule(capsule)),
        (
            "rounded box",
            Implicit::RoundedBox {
                center: vec3(-0.1, 0.1, 0.0),
                axes: axes(),
                half: vec3(0.6, 0.4, 0.3),
                radius: 0.15,
            },
        ),
        ("gyroid in a sphere", gyroid(Bound::Sphere { radius: 0.9 })),
        (
            "gyroid in a box",
            gyroid(Bound::Box {
                half: vec3(0.7, 0.5, 0.6),
            }),
        ),
        (
            "metaballs",
            Implicit::Metaballs {
                balls: vec![
                    ball(vec3(-0.3, 0.0, 0.0), 0.6),
                    ball(vec3(0.3, 0.1, 0.1), 0.7),
                    ball(vec3(0.0, 0.5, -0.3), 0.5),
                ],
                threshold: 0.5,
            },
        ),
        (
            "smooth union",
            Implicit::SmoothUnion {
                parts: vec![
                    Part::Ball(ball(vec3(-0.4, 0.2, 0.0), 0.35)),
                    Part::Capsule(capsule),
                    Part::Ball(ball(vec3(0.2, 0.5, 0.2), 0.3)),
                ],
                k: 0.2,
            },
        ),
    ]
}

fn random_ray(random: &mut Random) -> Ray {
    let mut within = |size: f64| {
        let mut one = || (2.0 * random.uniform() - 1.0) * size;
        vec3(one(), one(), one())
    };
    let origin = within(2.0);
    let direction = (within(0.8) - origin).normalized();
    Ray { origin, direction }
}

#[test]
fn the_first_crossing_is_the_first_and_on_the_surface() {
    let mut random = Random::new(2);
    for (name, solid) in solids() {
        let (mut hits, mut inside) = (0, 0);
        for _ in 0..400 {
            let ray = random_ray(&mut random);
            let start = solid.value(ray.origin) <= 0.0;
            inside += u32::from(start);
            let found = solid.first(&ray, f64::INFINITY);
            // A blunt look at one point every thousandth: nothing earlier, and the next side right behind it.
            let end = found.unwrap_or(6.0);
            let step = 1e-3;
            for i in 1..(end / step) as u32 {
                let t = f64::from(i) * step;
                let other = (solid.value(ray.at(t)) <= 0.0) != start;
                assert!(!other, "{name}: {ray:?} crosses before {found:?}, at {t}");
            }
            let Some(t) = found else { continue };
            hits += 1;
            assert!(
                solid.value(ray.at(t)).abs() < 1e-13,
                "{name}: off by {}",
                solid.value(ray.at(t))
            );
            let normal = solid.normal(ray.at(t));
            assert!((normal.length() - 1.0).abs() < 1e-12);
            assert_eq!(
                normal.dot(ray.direction) > 0.0,
                start,
                "{name}: the normal points inwards"
            );
            assert!(solid.first(&ray, t * 0.999).is_none() && solid.first(&ray, t * 1.001).is_some());
        }
        assert!(
            hits > 120 && inside < 100,
            "{name}: {hits} hits, {inside} from inside"
        );
    }
}

#[test]
fn normals_are_slopes_and_no_slope_is_steeper_than_its_bound() {
    let mut random = Random::new(4);
    for (name, solid) in solids() {
        let (low, high) = solid.bounds();
        let steepest = match name {
            "gyroid in a sphere" | "gyroid in a box" => 2.0 / 3f64.sqrt(),
            "metaballs" => 96.0 / (25.0 * 5f64.sqrt()) * (1.0 / 0.6 + 1.0 / 0.7 + 1.0 / 0.5),
            _ => 1.0,
        };
        for _ in 0..2000 {
            let u = vec3(random.uniform(), random.uniform(), random.uniform());
            let p = low + (high - low) * u;
            let h = 1e-6;
            let along = |d: Vec3| (solid.value(p + d * h) - solid.value(p - d * h)) / (2.0 * h);
            let slope = vec3(
                along(vec3(1.0, 0.0, 0.0)),
                along(vec3(0.0, 1.0, 0.0)),
                along(vec3(0.0, 0.0, 1.0)),
            );
            assert!(
                slope.length() <= steepest * (1.0 + 1e-6),
                "{name}: {slope:?} at {p:?}"
            );
            // Creases are thinner than the step, or told apart by a slope of their own.
            if solid.value(p).abs() < 0.05 && slope.length() > 0.3 {
                let off = (slope.normalized() - solid.normal(p)).length();
                assert!(
                    off < 1e-5 || slope.length() < 0.99 * steepest,
                    "{name} at {p:?}: {off}"
                );
            }
        }
    }
}

#[test]
fn solids_lie_within_their_boxes_and_balls() {
    let mut random = Random::new(6);
    for (name, solid) in solids() {
        let (low, high) = solid.bounds();
        let (center, radius) = solid.ball();
        let mut told = 0;
        for _ in 0..20_000 {
            let mut one = || 3.0 * random.uniform() - 1.5;
            let p = vec3(one(), one(), one());
            if solid.value(p) <= 0.0 {
                told += 1;
                assert!(
                    p.min(low) == low && p.max(high) == high,
                    "{name}: {p:?} is outside"
                );
                assert!(
                    (p - center).length() <= radius,
                    "{name}: {p:?} is outside of the ball"
                );
            }
        }
        assert!(told > 100, "{name}: {told}");
    }
}

#[test]
fn crossings_by_closed_forms() {
    let ray = |origin: Vec3, direction: Vec3| Ray { origin, direction };
    let first = |solid: &Implicit, origin, direction| {
        solid
            .first(&ray(origin, direction), f64::INFINITY)
            .expect("it is hit")
    };
    let x = vec3(1.0, 0.0, 0.0);
    let torus = Implicit::Torus {
        center: Vec3::ZERO,
        axis: vec3(0.0, 0.0, 1.0),
        major: 2.0,
        minor: 0.5,
    };
    // Through both walls, from without, within the wall, and within the hole.
    for (from, t) in [(-5.0, 2.5), (-2.4, 0.9), (-1.0, 2.5), (1.6, 0.9)] {
        assert!((first(&torus, x * from, x) - t).abs() < 1e-14);
    }
    assert!(
        torus
            .first(&ray(vec3(0.0, 0.0, 4.0), vec3(0.0, 0.0, -1.0)), f64::INFINITY)
            .is_none()
    );
    assert!((first(&torus, vec3(2.3, 0.0, 4.0), vec3(0.0, 0.0, -1.0)) - 3.6).abs() < 1e-14);

    // The ray passes the cap at 0.3 from its end point, and the wall at 0.5 from the axis.
    let capsule = Implicit::Capsule(Capsule {
        a: Vec3::ZERO,
        b: vec3(0.0, 0.0, 2.0),
        radius: 0.5,
    });
    assert!((first(&capsule, vec3(0.3, 0.0, -3.0), vec3(0.0, 0.0, 1.0)) - 2.6).abs() < 1e-14);
    assert!((first(&capsule, vec3(-3.0, 0.0, 1.3), x) - 2.5).abs() < 1e-14);

    // Face, and the ball at the corner along the diagonal: √3 (1 − 0.2) + 0.2 from the middle.
    let rounded = Implicit::RoundedBox {
        center: Vec3::ZERO,
        axes: [x, vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)],
        half: Vec3::ONE,
        radius: 0.2,
    };
    assert!((first(&rounded, x * -3.0, x) - 2.0).abs() < 1e-14);
    let diagonal = Vec3::ONE.normalized();
    assert!((first(&rounded, diagonal * -5.0, diagonal) - (4.8 - 0.8 * 3f64.sqrt())).abs() < 1e-14);

    // Alone, a ball shows at r √(1 − ∛threshold).
    let blob = Implicit::Metaballs {
        balls: vec![ball(Vec3::ZERO, 2.0)],
        threshold: 0.343,
    };
    assert!((first(&blob, x * -4.0, x) - (4.0 - 2.0 * 0.3f64.sqrt())).abs() < 1e-14);

    // Where both distances are equal, the minimum lies k/4 lower: in the plane between two balls at ±1, at height h with
    // √(1 + h²) = 0.9 + 0.4/4 + ...: 1 of radius 0.95 and k = 0.4 meet at √(1 + h²) − 0.95 = 0.1.
    let union = Implicit::SmoothUnion {
        parts: vec![Part::Ball(ball(x, 0.95)), Part::Ball(ball(-x, 0.95))],
        k: 0.4,
    };
    let height = (1.05f64 * 1.05 - 1.0).sqrt();
    let y = vec3(0.0, 1.0, 0.0);
    assert!((first(&union, y * 3.0, -y) - (3.0 - height)).abs() < 1e-14);

    // sin x cos y + … = sin x on the x axis: |sin 2πx/cell| = 3π thickness/(2 cell) at the wall.
    let gyroid = Implicit::Gyroid {
        center: Vec3::ZERO,
        axes: [x, y, vec3(0.0, 0.0, 1.0)],
        cell: 2.0,
        thickness: 0.2,
        bound: Bound::Sphere { radius: 1.9 },
    };
    let half = (3.0 * std::f64::consts::PI * 0.2 / 4.0).asin() / std::f64::consts::PI;
    assert!((first(&gyroid, Vec3::ZERO, x) - half).abs() < 1e-14);
    assert!((first(&gyroid, x * 0.5, x) - (0.5 - half)).abs() < 1e-14);
    // The wall at 2 reaches out of the bound at 1.9.
    assert!((first(&gyroid, x * 3.0, -x) - 1.1).abs() < 1e-14);
}

#[test]
fn lossless_solid_glass_in_a_uniform_sky_is_invisible() {
    for (name, solid) in solids() {
        let camera = Camera::look_at(vec3(-3.0, 0.4, 0.1), Vec3::ZERO, vec3(0.0, 1.0, 0.0), 30.0);
        let sky = vec![Light::Constant {
            radiance: Rgb::splat(2.0),
        }];
        let furnace = scene(camera, vec![shape(Geometry::Implicit(Arc::new(solid)), 2)], sky);
        let settings = Settings {
            width: 6,
            height: 6,
            spp: 16,
            rr_depth: 2000,
            max_depth: Some(2000),
            ..Settings::default()
        };
        for [r, _, _] in picture(&furnace, &settings).pixels {
            assert!((r - 2.0).abs() < 1e-9, "{name}: {r}");
        }
    }
}

#[test]
fn a_glowing_blob_lights_as_the_sphere_it_is() {
    let (radius, threshold) = (1.5f64, 0.343f64);
    let visible = radius * (1.0 - threshold.cbrt()).sqrt();
    let blob = Implicit::Metaballs {
        balls: vec![ball(vec3(0.0, 2.0, 0.0), radius)],
        threshold,
    };
    let blob = lamp(Geometry::Implicit(Arc::new(blob)), 3.0, 1);
    let lit = scene(peephole(), vec![shape(floor(), 0), blob], vec![]);
    let expected = 0.5 * 3.0 * (visible / 2.0).powi(2);
    assert_near(pixel(&lit, 1 << 16, 2), expected, 3e-3);
}
