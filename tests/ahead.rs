//! What is ahead of a block of pixels: a ray that is asked of those shapes alone meets what it meets of all, and a shadow
//! ray from there is stopped by them if it is stopped at all; so it is by what may shade the part of the scene where it
//! begins, and a ray that goes from part to part meets what it meets of all.

mod scenes;

use microlux::bvh::Node;
use microlux::camera::Camera;
use microlux::color::{Radiance, albedo};
use microlux::geom::{Dir, Frame, Point, REACH, Ray};
use microlux::light::Light;
use microlux::material::Material;
use microlux::num::{Share, Uniform};
use microlux::q;
use microlux::scene::builtin::Builtin;
use microlux::scene::{Ahead, Cell, Scene, SceneBuilder, ShapeSet};
use microlux::shape::{Geometry, Sphere};
use scenes::{Draft, Random};

/// Of how many rays something was known ahead.
#[derive(Debug, Default)]
struct Tally {
    rays: u32,
    named: u32,
    hits: u32,
    shadows: u32,
    shaded: u32,
    free: u32,
    bounces: u32,
    foreseen: u32,
    foreseen_shaded: u32,
}

impl Tally {
    /// Some rays of some blocks of a camera's picture.
    fn look(&mut self, random: &mut Random, scene: &Scene, camera: Camera, [width, height]: [u16; 2]) {
        let film = camera.film(width, height);
        let mut cells = [Cell::UNKNOWN; 4096];
        let cells = &mut cells[..random.pick(&[7, 8, 100, 600, 600, 4096])];
        let told = scene.foresee(cells);
        let uniform = |random: &mut Random| {
            let any = random.bits();
            Uniform::from_bits(random.pick(&[0, u32::MAX, any]))
        };
        for _ in 0..20 {
            let side = random.pick(&[1, 8, 16, 64]);
            let [x, y] = [width, height].map(|size| random.below(size as usize) as u16 / side * side);
            let ahead = film
                .beam(x, y, side)
                .map_or(Ahead::ANY, |beam| scene.ahead(&beam, true));
            for _ in 0..10 {
                let [px, py] = [(x, width), (y, height)]
                    .map(|(c, size)| (c + random.below(side as usize) as u16).min(size - 1));
                let [u, v] = [(); 2].map(|()| [(); 2].map(|()| uniform(random)));
                let Some(ray) = film.ray(px, py, u, v) else {
                    continue;
                };
                let tell = || format!("{px} {py} of {x} {y} + {side}: {ahead:?} {ray:?}");
                let hit = scene.closest(&ray);
                assert_eq!(scene.closest_among(&ray, ahead.seen), hit, "{}", tell());
                self.rays += 1;
                self.named += u32::from(ahead.seen != ShapeSet::ALL);
                let Some(hit) = hit else { continue };
                self.hits += 1;
                let vertex = scene.vertex(&ray, &hit);
                let left = hit.shape;
                for _ in 0..4 {
                    let Some(dir) = Dir::new([(); 3].map(|()| random.within(1 << 16))) else {
                        continue;
                    };
                    let bounce = Ray {
                        origin: vertex.surface.leave(dir),
                        dir,
                    };
                    let hit = scene.closest(&bounce);
                    assert_eq!(told.closest_from(&bounce, left), hit, "{left} {bounce:?}");
                    self.bounces += u32::from(hit.is_some());
                }
                for _ in 0..4 {
                    let (light, _) = scene.choose_light(Uniform::from_bits(random.bits()));
                    let Some(sample) =
                        scene.sample_light(light, &vertex.surface, [(); 2].map(|()| uniform(random)))
                    else {
                        continue;
                    };
                    let shadow = Ray {
                        origin: vertex.surface.leave(sample.wi),
                        dir: sample.wi,
                    };
                    let (distance, except) = (sample.distance, sample.shape);
                    let occluded = scene.occluded(&shadow, distance, except);
                    assert_eq!(
                        scene.occluded_by(ahead.shading, &shadow, distance, except),
                        occluded,
                        "{}, {shadow:?} {distance}",
                        tell()
                    );
                    let shade = told.shade_at(vertex.surface.point);
                    assert_eq!(
                        scene.occluded_by(shade, &shadow, distance, except),
                        occluded,
                        "{shade:?}, {vertex:?}, {shadow:?} {distance}"
                    );
                    self.foreseen += u32::from(shade != ShapeSet::ALL);
                    self.foreseen_shaded += u32::from(shade != ShapeSet::ALL && occluded);
                    if ahead.shading != ShapeSet::ALL {
                        self.shadows += 1;
                        self.shaded += u32::from(occluded);
                        self.free += u32::from(!occluded);
                    }
                }
            }
        }
    }
}

/// From anywhere in reach or a little beyond, towards something.
fn camera(random: &mut Random, scene: &Scene) -> Camera {
    let grid = scene.parts().grid;
    let inside = |random: &mut Random| grid.to_scene([(); 3].map(|()| random.bits() as u16));
    let origin = if random.one_in(2) {
        inside(random)
    } else {
        random.point(REACH)
    };
    let along = [Dir::X, Dir::Y, Dir::Z];
    let frame = if random.one_in(2) {
        let target = inside(random);
        let forward = origin.to(target).normalize().map_or(Dir::Z, |(dir, _)| dir);
        let Frame { s, t, .. } = Frame::about(forward);
        random.pick(&[[s, t, forward], [t, -s, forward]])
    } else {
        // Along an axis, turned about it: boxes that are beside a beam along another are outside none of its sides.
        let k = random.below(3);
        let forward = random.pick(&[along[k], -along[k]]);
        let mut right = [(); 3].map(|()| random.within(1 << 16));
        right[k] = 0;
        let right = Dir::new(right).unwrap_or(along[(k + 1) % 3]);
        let up = right.cross(forward).expect("at right angles");
        [right, up, forward]
    };
    let tan = random.pick(&[
        1 << 10,
        1 << 13,
        1 << 17,
        1 << 18,
        1 << 19,
        700_000,
        1 << 20,
        1 << 21,
    ]);
    Camera::from_frame(origin, frame, fixed::types::I12F20::from_bits(tan))
}

const SIZES: [[u16; 2]; 4] = [[240, 240], [80, 60], [1000, 300], [2000, 1000]];

#[test]
fn of_the_built_in_scenes_nothing_is_missed() {
    for builtin in Builtin::ALL {
        let mut tally = Tally::default();
        let look = |scene: &Scene, own: Camera| {
            let mut random = Random(7);
            for round in 0..60 {
                let camera = if round < 20 {
                    own
                } else {
                    camera(&mut random, scene)
                };
                let size = random.pick(&SIZES);
                tally.look(&mut random, scene, camera, size);
            }
        };
        builtin.with(look).unwrap();
        println!("{}: {tally:?}", builtin.name());
        if builtin == Builtin::Cornell {
            assert!(tally.named > tally.rays / 2 && tally.shaded > 500 && tally.free > 5000);
            assert!(tally.foreseen > 5000 && tally.foreseen_shaded > 500);
        }
    }
}

/// `MICROLUX_SCENES` is how many scenes.
#[test]
fn of_random_scenes_nothing_is_missed() {
    let scenes = std::env::var("MICROLUX_SCENES").map_or(1500, |n| n.parse().unwrap());
    let mut tally = Tally::default();
    for seed in 0..scenes {
        let mut random = Random(seed);
        let mut draft = Draft::random(&mut random);
        // Of planes, and of the first light, which is parallel, no bounds are known.
        draft
            .shapes
            .retain(|shape| !matches!(shape.geometry, Geometry::Plane(_)));
        if draft.shapes.is_empty() {
            continue;
        }
        draft.arrange();
        if !random.one_in(8) {
            let position = random.point(REACH);
            draft.lights[0] = Light::Point {
                position,
                intensity: Radiance::WHITE,
            };
        }
        let meshes = draft.meshes();
        let scene = Scene::new(draft.parts(&meshes)).unwrap();
        for _ in 0..4 {
            let camera = camera(&mut random, &scene);
            let size = random.pick(&SIZES);
            tally.look(&mut random, &scene, camera, size);
        }
    }
    println!("{tally:?}");
    assert!(tally.named > tally.rays / 2 && tally.shaded.min(tally.free) > tally.hits / 20);
    assert!(tally.foreseen_shaded > tally.hits / 20);
}

/// With too little memory, and beyond the scene, nothing is told.
#[test]
fn where_no_cell_is_nothing_is_foreseen() {
    Builtin::Cornell
        .with(|scene, _| {
            let wall = Point([-65_000, 1 << 16, 0]);
            let (mut few, mut many) = ([Cell::UNKNOWN; 7], [Cell::UNKNOWN; 64]);
            assert_eq!(scene.foresee(&mut few).shade_at(wall), ShapeSet::ALL);
            assert_ne!(scene.foresee(&mut many).shade_at(wall), ShapeSet::ALL);
            // Beyond the scene.
            let far = Point([1 << 24, 0, 0]);
            assert_eq!(scene.foresee(&mut many).shade_at(far), ShapeSet::ALL);
        })
        .unwrap();
}

/// What comes from all around, unasked, has no place to be shaded from.
#[test]
fn light_from_all_around_is_no_light_to_look_from() {
    let mut builder = SceneBuilder::<4, 1, 1>::new();
    let grey = builder.material(Material::lambert(albedo(
        q!(0.5, Share),
        q!(0.5, Share),
        q!(0.5, Share),
    )));
    let grey = grey.unwrap();
    for x in [-3, 3] {
        let ball = Sphere::new(Point([x << 16, 0, 0]), 1 << 16);
        builder.shape(ball, grey).unwrap();
    }
    let radiance = Radiance::WHITE;
    builder.light(Light::Environment { radiance }).unwrap();
    let mut nodes = [Node::EMPTY; 4];
    let scene = builder.build(&mut nodes).unwrap();
    let tan = fixed::types::I12F20::from_bits(1 << 19);
    let camera = Camera::from_frame(Point([0, 0, 5 << 16]), [Dir::X, Dir::Y, -Dir::Z], tan);
    let beam = camera.film(16, 16).beam(0, 0, 16).unwrap();
    let ahead = scene.ahead(&beam, true);
    assert_ne!(ahead.seen, ShapeSet::ALL);
    assert_eq!(ahead.shading, ShapeSet::ALL);
}

/// A lens starts rays anywhere on it, and what is far aside of the view is too far for a beam's bounds.
#[test]
fn nothing_is_known_ahead_of_a_lens() {
    let camera = |tan| {
        Camera::from_frame(
            Point([0; 3]),
            [Dir::X, Dir::Y, -Dir::Z],
            fixed::types::I12F20::from_bits(tan),
        )
    };
    assert!(camera(1 << 19).film(240, 240).beam(0, 0, 16).is_some());
    assert_eq!(
        camera(1 << 19)
            .with_lens(100, 10_000)
            .film(240, 240)
            .beam(0, 0, 16),
        None
    );
    assert_eq!(camera(1 << 21).film(240, 240).beam(0, 0, 16), None);
    assert!(camera(1 << 21).film(240, 240).beam(112, 112, 16).is_some());
}
