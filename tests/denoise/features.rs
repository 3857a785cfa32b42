use crate::value;
use microlux::bvh::Node;
use microlux::camera::Camera;
use microlux::color::{Radiance, albedo};
use microlux::film::Feature;
use microlux::film::feature::{DEPTH_NOTHING, ID_NOTHING, albedo_code, depth_code, first_id};
use microlux::geom::{Dir, Point};
use microlux::integrator::{AmbientOcclusion, Bdpt, Integrator, Path};
use microlux::light::Light;
use microlux::material::Material;
use microlux::num::{Share, Turn, Uniform};
use microlux::q;
use microlux::render::{Renderer, Settings};
use microlux::sampler::Sobol;
use microlux::scene::builtin::Builtin;
use microlux::scene::{Scene, SceneBuilder};
use microlux::shape::{Plane, Sphere};
use std::collections::BTreeMap;

const SETTINGS: Settings = Settings {
    width: 24,
    height: 20,
    spp: 4,
};

/// Features against the picture of the same samples: their product is its light, but for steps.
fn agrees<I: Integrator + Copy>(scene: &Scene, camera: Camera, integrator: I) -> Vec<Feature> {
    let mut renderer = Renderer::new(scene, camera, integrator, Sobol::new(5), SETTINGS);
    let mut plain = renderer.clone();
    let mut found = Vec::new();
    let mut flat = 0;
    for y in 0..SETTINGS.height {
        for x in 0..SETTINGS.width {
            let pixel = renderer.feature(x, y);
            let exact = value(plain.pixel(x, y));
            let got = value(pixel.radiance());
            // One surface of one albedo in the whole pixel: then the means multiply.
            let largest = exact.iter().fold(0f64, |m, c| m.max(*c));
            let off = (0..3).map(|i| (got[i] - exact[i]).abs()).fold(0f64, f64::max);
            flat += usize::from(off <= 0.04 * largest + 1e-6);
            found.push(pixel);
        }
    }
    assert!(flat * 100 >= found.len() * 80, "{flat} of {}", found.len());
    assert_eq!(renderer.rays(), plain.rays(), "looking costs no ray");
    found
}

#[test]
fn light_is_irradiance_times_albedo_in_every_integrator() {
    Builtin::Cornell
        .with(|scene, camera| {
            let path = agrees(scene, camera, Path::new(6));
            let direct = agrees(scene, camera, Path::direct());
            let both = agrees(scene, camera, Bdpt::<8>::new(6));
            for (i, pixel) in path.iter().enumerate() {
                let guide = |f: &Feature| (f.albedo, f.normal, f.depth, f.id);
                assert_eq!(guide(pixel), guide(&both[i]));
                assert_eq!(guide(pixel), guide(&direct[i]));
            }
        })
        .unwrap();
}

/// A mirror of (1/2, 1, 1) two metres before the camera, a wall of (1/2, 1/2, 1) three metres behind it, and no more.
fn between_mirror_and_wall<R>(material: Material, look: impl FnOnce(&Scene, Camera) -> R) -> R {
    let mut builder = SceneBuilder::<2, 2, 1>::new();
    let half = q!(0.5, Share);
    let wall = builder
        .material(Material::lambert(albedo(half, half, Share::ONE)))
        .unwrap();
    let mirror = builder.material(material).unwrap();
    let unit = builder.unit();
    let at = |z| Point([0, 0, unit.length(z)]);
    let (front, back) = (at(q!(-2)), at(q!(3)));
    let plane = |point| Plane {
        point,
        normal: Dir::Z,
    };
    builder.shape(plane(front), mirror).unwrap();
    builder.shape(plane(back), wall).unwrap();
    let eye = at(q!(0));
    builder
        .light(Light::Point {
            position: eye,
            intensity: Radiance::WHITE,
        })
        .unwrap();
    let camera = Camera::look_at(eye, front, [0, 1, 0], Camera::tan_half(Turn::from_bits(1 << 22))).unwrap();
    let mut nodes = [Node::EMPTY; 2];
    look(&builder.build(&mut nodes).unwrap(), camera)
}

#[test]
fn mirrors_and_glass_are_looked_through() {
    let half = q!(0.5, Share);
    let mirror = Material::mirror(albedo(half, Share::ONE, Share::ONE));
    between_mirror_and_wall(mirror, |scene, camera| {
        let seen =
            |integrator| Renderer::new(scene, camera, integrator, Sobol::new(5), SETTINGS).feature(12, 10);
        let pixel = seen(Path::new(6));
        let code = albedo_code(half);
        assert_eq!(pixel.albedo, [albedo_code(q!(0.25, Share)), code, 255]);
        assert_eq!(pixel.id, first_id(1, 1));
        // Two metres there, five back.
        assert_eq!(pixel.depth, depth_code(scene.unit().length(q!(7))));
        assert_eq!(pixel.normal.decode(), -Dir::Z);
        assert!(!pixel.radiance().is_black());
        // Paths of one segment end at the mirror: it is what they met.
        let short = seen(Path::new(1));
        assert_eq!(
            (short.id, short.depth),
            (0, depth_code(scene.unit().length(q!(2))))
        );
        assert_eq!(short.radiance(), Radiance::BLACK);
    });
}

/// Where it is found again when the camera has moved.
#[test]
fn what_a_mirror_shows_is_behind_it_if_it_is_flat_and_on_it_if_it_is_a_ball() {
    let seen = |is_ball: bool, has_wall: bool| {
        let mut builder = SceneBuilder::<2, 2, 1>::new();
        let half = q!(0.5, Share);
        let grey = builder
            .material(Material::lambert(albedo(half, half, half)))
            .unwrap();
        let mirror = builder
            .material(Material::mirror(albedo(Share::ONE, Share::ONE, Share::ONE)))
            .unwrap();
        let unit = builder.unit();
        let at = |z| Point([0, 0, unit.length(z)]);
        if is_ball {
            let ball = Sphere::new(at(q!(-3)), unit.length(q!(1)));
            builder.shape(ball, mirror).unwrap();
        } else {
            let plane = Plane {
                point: at(q!(-2)),
                normal: Dir::Z,
            };
            builder.shape(plane, mirror).unwrap();
        }
        if has_wall {
            let plane = Plane {
                point: at(q!(3)),
                normal: -Dir::Z,
            };
            builder.shape(plane, grey).unwrap();
        }
        builder
            .light(Light::Environment {
                radiance: Radiance::WHITE,
            })
            .unwrap();
        let camera = Camera::look_at(
            at(q!(0)),
            at(q!(-2)),
            [0, 1, 0],
            Camera::tan_half(Turn::from_bits(1 << 22)),
        );
        let mut nodes = [Node::EMPTY; 2];
        let scene = builder.build(&mut nodes).unwrap();
        let mut renderer = Renderer::new(&scene, camera.unwrap(), Path::new(6), Sobol::new(5), SETTINGS);
        let guide = renderer.guide(SETTINGS.width / 2, SETTINGS.height / 2);
        let code = |metres| depth_code(unit.length(metres));
        ((guide.id, guide.depth), code(q!(2)), code(q!(7)))
    };
    let sky = first_id(ID_NOTHING, 1);
    let (flat, _, back) = seen(false, true);
    assert_eq!(flat, (first_id(1, 1), back));
    let (flat, ..) = seen(false, false);
    assert_eq!(flat, (sky, DEPTH_NOTHING));
    let (ball, front, _) = seen(true, true);
    assert_eq!(ball, (first_id(1, 1), front));
    let (ball, front, _) = seen(true, false);
    assert_eq!(ball, (sky, front));
}

/// A piece of a flat shape looks one way all over, a curved shape does not.
#[test]
fn what_is_flat_looks_one_way() {
    let mut kinds = [0; 2];
    for builtin in [
        Builtin::Cornell,
        Builtin::Materials,
        Builtin::Torus,
        Builtin::Implicits,
    ] {
        builtin
            .with(|scene, camera| {
                let (width, height) = (96, 80);
                let film = camera.film(width, height);
                let middle = [Uniform::from_bits(1 << 31); 2];
                let mut seen: BTreeMap<(bool, u16, u32), Vec<Dir>> = BTreeMap::new();
                for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                    let ray = film.ray(x, y, middle, middle).unwrap();
                    let Some(hit) = scene.closest(&ray) else {
                        continue;
                    };
                    let vertex = scene.vertex(&ray, &hit);
                    let is_flat = scene.is_flat(&hit, &vertex);
                    let piece = if is_flat { hit.triangle } else { 0 };
                    let ways = seen.entry((is_flat, hit.shape, piece)).or_default();
                    ways.push(vertex.facing());
                }
                for ((is_flat, shape, _), ways) in seen.into_iter().filter(|(_, ways)| ways.len() > 20) {
                    let is_one = ways.iter().all(|way| *way == ways[0]);
                    assert_eq!(is_one, is_flat, "{builtin:?} {shape}");
                    kinds[usize::from(is_flat)] += 1;
                }
            })
            .unwrap();
    }
    assert!(kinds[0] > 5 && kinds[1] > 5, "{kinds:?}");
}

#[test]
fn what_shines_and_what_is_far_away_has_its_light_as_irradiance() {
    Builtin::Cornell
        .with(|scene, camera| {
            let (width, height) = (72, 60);
            let settings = Settings {
                width,
                height,
                ..SETTINGS
            };
            let mut renderer = Renderer::new(scene, camera, Path::new(6), Sobol::new(5), settings);
            let pixels: Vec<_> = (0..height / 4)
                .flat_map(|y| (0..width).map(move |x| (x, y)))
                .map(|(x, y)| (renderer.feature(x, y), renderer.pixel(x, y)))
                .collect();
            let lamp = pixels
                .iter()
                .filter(|(f, _)| f.albedo == [255; 3] && f.depth < DEPTH_NOTHING);
            let mut count = 0;
            for (feature, light) in lamp {
                assert!(value(*light).iter().all(|c| *c > 1.0), "{feature:?} {light:?}");
                count += 1;
            }
            assert!(count > 3, "{count}");
        })
        .unwrap();
    Builtin::Sky
        .with(|scene, camera| {
            let mut renderer = Renderer::new(scene, camera, Path::new(6), Sobol::new(5), SETTINGS);
            let sky = renderer.feature(2, 0);
            assert_eq!(
                (sky.albedo, sky.depth, sky.id),
                ([255; 3], DEPTH_NOTHING, ID_NOTHING)
            );
            let (got, exact) = (value(sky.radiance()), value(renderer.pixel(2, 0)));
            assert!(
                (0..3).all(|i| (got[i] - exact[i]).abs() < exact[2] / 400.0),
                "{got:?} {exact:?}"
            );
        })
        .unwrap();
}

#[test]
fn chance_at_glass_is_no_feature() {
    // Of one sample: a path through glass is told apart from one reflected by it in nothing but its light.
    let settings = Settings { spp: 1, ..SETTINGS };
    for scene in [Builtin::Cornell, Builtin::Spheres, Builtin::Materials] {
        scene
            .with(|scene, camera| {
                let ao = AmbientOcclusion::new();
                let mut other = Renderer::new(scene, camera, ao, Sobol::new(5), settings);
                let mut path = Renderer::new(scene, camera, Path::new(8), Sobol::new(5), settings);
                let mut both = Renderer::new(scene, camera, Bdpt::<8>::new(8), Sobol::new(5), settings);
                for i in 0..SETTINGS.width * SETTINGS.height {
                    let (x, y) = (i % SETTINGS.width, i / SETTINGS.width);
                    let guide = |f: Feature| (f.albedo, f.normal, f.depth, f.id);
                    let found = guide(path.feature(x, y));
                    assert_eq!(found, guide(other.feature(x, y)), "{x} {y}");
                    assert_eq!(found, guide(both.feature(x, y)), "{x} {y}");
                }
            })
            .unwrap();
    }
}
