//! What is told of a light before directions are drawn: where it is dark, none of its light is reflected, and where a
//! direction sees no light, none comes back along the ray.

mod scenes;

use microlux::bvh::Node;
use microlux::color::{Radiance, albedo};
use microlux::geom::{Frame, Offset, Point, Ray};
use microlux::light::Light;
use microlux::material::Material;
use microlux::num::{Share, Uniform};
use microlux::q;
use microlux::sampler::warp;
use microlux::scene::builtin::Builtin;
use microlux::scene::{Prospect, Scene, SceneBuilder, Seen};
use microlux::shape::{Disk, Rectangle};
use scenes::{Draft, Random};

fn uniform(random: &mut Random) -> Uniform {
    let any = random.bits();
    Uniform::from_bits(random.pick(&[0, u32::MAX, any, any, any, any]))
}

/// Of how many surfaces and directions something was known.
#[derive(Debug, Default)]
struct Tally {
    prospects: u32,
    unlit: u32,
    lit: u32,
    directions: u32,
    dark: u32,
    lights: u32,
}

impl Tally {
    /// Directions from where rays from anywhere in a scene meet something.
    fn look(&mut self, random: &mut Random, scene: &Scene, rays: u32) {
        let grid = scene.parts().grid;
        for _ in 0..rays {
            let [origin, target] = [(); 2].map(|()| grid.to_scene([(); 3].map(|()| random.bits() as u16)));
            let Some((dir, _)) = origin.to(target).normalize() else {
                continue;
            };
            let ray = Ray { origin, dir };
            let Some(hit) = scene.closest(&ray) else {
                continue;
            };
            let vertex = scene.vertex(&ray, &hit);
            let (light, _) = scene.choose_light(uniform(random));
            let prospect = scene.prospect(&vertex);
            self.prospects += 1;
            self.unlit += u32::from(prospect == Prospect::Dark);
            for _ in 0..20 {
                let u = [uniform(random), uniform(random)];
                let sample = scene.sample_light(light, &vertex.surface, u);
                let lit = sample.is_some_and(|sample| vertex.eval(sample.wi).is_some());
                if let Some(sample) = sample {
                    assert_eq!(vertex.eval_with(&prospect, sample.wi), vertex.eval(sample.wi));
                }
                assert!(!lit || prospect != Prospect::Dark, "{vertex:?} {light} {u:?}");
                self.lit += u32::from(lit);
                let may = prospect.may_end_on_light(u);
                let Some(drawn) = vertex.draw(u, uniform(random)) else {
                    continue;
                };
                let next = Ray {
                    origin: vertex.surface.leave(drawn.wi),
                    dir: drawn.wi,
                };
                let seen = match scene.closest_light(&next) {
                    Some(Seen::Emitter(hit)) => scene.vertex(&next, &hit).light.map(|_| hit),
                    Some(Seen::Environment) => {
                        assert!(may);
                        continue;
                    }
                    None => None,
                };
                assert!(may || seen.is_none(), "{vertex:?} {u:?} {seen:?}");
                self.directions += 1;
                self.dark += u32::from(!may);
                self.lights += u32::from(seen.is_some());
            }
        }
    }
}

#[test]
fn of_the_built_in_scenes_no_light_is_missed() {
    for builtin in Builtin::ALL {
        let mut tally = Tally::default();
        builtin
            .with(|scene, _| tally.look(&mut Random(3), scene, 5000))
            .unwrap();
        println!("{}: {tally:?}", builtin.name());
        if builtin == Builtin::Cornell {
            assert!(tally.dark > tally.directions * 3 / 4 && tally.lights > 50);
        }
    }
}

/// `MICROLUX_SCENES` is how many scenes.
#[test]
fn of_random_scenes_no_light_is_missed() {
    let scenes = std::env::var("MICROLUX_SCENES").map_or(1500, |n| n.parse().unwrap());
    let mut tally = Tally::default();
    for seed in 0..scenes {
        let mut random = Random(seed);
        let mut draft = Draft::random(&mut random);
        // One light.
        let index = random.below(draft.shapes.len());
        for (i, shape) in draft.shapes.iter_mut().enumerate() {
            shape.light = (i == index).then_some(0);
        }
        draft.lights = vec![Light::Area {
            shape: index as u16,
            radiance: Radiance::WHITE,
        }];
        let meshes = draft.meshes();
        let Ok(scene) = Scene::new(draft.parts(&meshes)) else {
            continue;
        };
        tally.look(&mut random, &scene, 20);
    }
    println!("{tally:?}");
    assert!(tally.dark > tally.directions / 10 && tally.unlit > tally.prospects / 10 && tally.lights > 500);
}

/// Directions towards a light's rim, as far from its middle as it reaches, from surfaces that face anywhere.
#[test]
fn a_light_is_seen_up_to_its_rim() {
    let mut random = Random(11);
    let mut lights = 0;
    for _ in 0..100_000 {
        let center = Point([(); 3].map(|()| random.within(1 << 20)));
        let half = [(); 2].map(|()| (1 << 12) + random.within(1 << 18).abs());
        let (normal, place) = (random.dir(), Point([0; 3]));
        let out = center.to(place).normalize().map_or(normal, |(dir, _)| dir);
        let Frame { s, t, n } = Frame::about(out);
        let corner = [(); 2].map(|()| random.pick(&[-0.999, 0.999]));
        let rim = center
            .along(s, (corner[0] * half[0] as f64) as i32)
            .along(t, (corner[1] * half[1] as f64) as i32);
        let Some((towards, _)) = place.to(rim).normalize() else {
            continue;
        };
        // The numbers by which that direction is drawn.
        let local = Frame::about(normal)
            .to_local(towards)
            .0
            .map(|c| c as f64 / 65536.0);
        if local[2] < 0.01 {
            continue;
        }
        let share = (local[0].powi(2) + local[1].powi(2)).clamp(0.0, 1.0 - 1e-9);
        let turn = (local[1].atan2(local[0]) / std::f64::consts::TAU).rem_euclid(1.0);
        let u = [share, turn].map(|u| Uniform::from_bits((u * 4_294_967_296.0) as u32));

        let mut builder = SceneBuilder::<2, 1, 1>::new();
        let rho = q!(0.5, Share);
        let grey = builder
            .material(Material::lambert(albedo(rho, rho, rho)))
            .unwrap();
        let floor = Disk::new(place, normal, 100);
        builder.shape(floor, grey).unwrap();
        let light = Rectangle::new(center, s, t, half).unwrap();
        assert!(light.normal.dot(n) > 0);
        builder.emitter(light, grey, Radiance::WHITE).unwrap();
        let mut nodes = [Node::EMPTY; 4];
        let scene = builder.build(&mut nodes).unwrap();

        let ray = Ray {
            origin: place.along(normal, 1000),
            dir: -normal,
        };
        let Some(hit) = scene.closest(&ray) else {
            continue;
        };
        let vertex = scene.vertex(&ray, &hit);
        let Some(drawn) = vertex.draw(u, Uniform::ZERO) else {
            continue;
        };
        let next = Ray {
            origin: vertex.surface.leave(drawn.wi),
            dir: drawn.wi,
        };
        if scene.closest_light(&next).is_some() {
            lights += 1;
            assert!(
                scene.prospect(&vertex).may_end_on_light(u),
                "{center:?} {half:?} {normal:?} {u:?}"
            );
        }
    }
    println!("{lights}");
    assert!(lights > 20_000, "{lights}");
}

/// Known to 1/24, about any normal.
#[test]
fn a_coarse_direction_is_near_the_one_that_is_drawn() {
    let mut random = Random(5);
    let (mut most, mut least, mut turned) = (0.0f64, 1.0f64, 0.0f64);
    for _ in 0..2_000_000 {
        let Some((normal, _)) = Offset(random.point(1 << 16).0).normalize() else {
            continue;
        };
        let normal = random.pick(&[normal, main_axis(&normal)]);
        let u = [uniform(&mut random), uniform(&mut random)];
        let local = warp::sample_cosine_hemisphere(u);
        let drawn = Frame::turn(normal, local).0;
        let alone = Frame::turn_coarsely(normal, local.0.map(|c| c >> 2));
        for a in 0..3 {
            turned = turned.max((drawn[a] as f64 / 65536.0 - alone[a] as f64 / 16384.0).abs());
        }
        let coarse = Frame::turn_coarsely(normal, warp::coarse_cosine_hemisphere(u));
        let off = (0..3).map(|a| (drawn[a] as f64 / 65536.0 - coarse[a] as f64 / 16384.0).powi(2));
        most = most.max(off.sum::<f64>().sqrt());
        least = least.min(coarse.iter().map(|c| (*c as f64 / 16384.0).powi(2)).sum());
    }
    println!("{most} off, square {least} at least; {turned} by the turn alone");
    assert!(most < 1.0 / 24.0 && least > 1.0 - 1.0 / 128.0);
    assert!(turned < 1.0 / 2048.0);
    assert!(most > 1.0 / 40.0 && turned > 1.0 / 8192.0);
}

/// The axis along which a direction points most.
fn main_axis(dir: &microlux::geom::Dir) -> microlux::geom::Dir {
    let k = (0..3).max_by_key(|k| dir.0[*k].abs()).unwrap_or(0);
    let mut axis = [0; 3];
    axis[k] = dir.0[k].signum() * (1 << 16);
    microlux::geom::Dir(axis)
}
