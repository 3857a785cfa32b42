//! Scenes by program: families of rooms, open places and tables, each scene a number of its family.

use std::f64::consts::TAU;
use std::sync::Arc;

use host_sim::builtin;
use host_sim::desc::{
    BsdfDesc, CameraDesc, GeometryDesc, IntegratorDesc, IntegratorKind, LightDesc, MeshDesc, NamedMaterial,
    OrenNayarModel, SceneDesc, ShapeDesc, SunDesc, TextureDesc, TintDesc, Vec3,
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Which part of the scenes something is for. No family is in two of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Split {
    Train,
    Validation,
    Test,
}

impl Split {
    pub const ALL: [Split; 3] = [Split::Train, Split::Validation, Split::Test];

    pub fn name(self) -> &'static str {
        match self {
            Split::Train => "train",
            Split::Validation => "validation",
            Split::Test => "test",
        }
    }

    /// Families made by program, then scenes made by hand (`host-sim scenes`).
    pub fn families(self) -> (&'static [Family], &'static [&'static str]) {
        match self {
            Split::Train => (
                &[
                    Family::Room,
                    Family::Open,
                    Family::Solids,
                    Family::Studio,
                    Family::Alcove,
                    Family::Void,
                    Family::Park,
                    Family::Night,
                ],
                &[],
            ),
            Split::Validation => (&[Family::Columns, Family::Stairs], &[]),
            Split::Test => (
                &[Family::Gallery, Family::Terrain],
                &[
                    "cornell",
                    "seed",
                    "spheres",
                    "torus-knot",
                    "materials",
                    "sky",
                    "map",
                    "implicits",
                ],
            ),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// A closed room with boxes and balls under one or two lamps.
    Room,
    /// A floor under a sky, with a sun or without.
    Open,
    /// Bumpy, twisted and smooth meshes before a wall.
    Solids,
    /// A glossy table between large soft lamps.
    Studio,
    /// A hall of columns with light from the side.
    Columns,
    /// Pictures on the walls of a room, glass cases, small lamps.
    Gallery,
    /// Hills under a low sun.
    Terrain,
    /// A room of plain, strong colours without its front wall, seen from outside, where all is black.
    Alcove,
    /// Things on a plate in the black, under a lamp or a point of light.
    Void,
    /// Things on unbounded ground in an environment map with windows of light in it.
    Park,
    /// Unbounded planes lit by dim balls that are seen, glass among them.
    Night,
    /// Steps in the black, a lamp above them.
    Stairs,
}

impl Family {
    pub fn name(self) -> &'static str {
        match self {
            Family::Room => "room",
            Family::Open => "open",
            Family::Solids => "solids",
            Family::Studio => "studio",
            Family::Columns => "columns",
            Family::Gallery => "gallery",
            Family::Terrain => "terrain",
            Family::Alcove => "alcove",
            Family::Void => "void",
            Family::Park => "park",
            Family::Night => "night",
            Family::Stairs => "stairs",
        }
    }

    /// Scene `number` of this family, of the size asked for.
    pub fn scene(self, number: u32, side: u32) -> SceneDesc {
        let seed = (u64::from(number) << 8 | self as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut stage = Stage::new(seed);
        match self {
            Family::Room => stage.room(),
            Family::Open => stage.open(),
            Family::Solids => stage.solids(),
            Family::Studio => stage.studio(),
            Family::Columns => stage.columns(),
            Family::Gallery => stage.gallery(),
            Family::Terrain => stage.terrain(),
            Family::Alcove => stage.alcove(),
            Family::Void => stage.void(),
            Family::Park => stage.park(),
            Family::Night => stage.night(),
            Family::Stairs => stage.stairs(),
        }
        stage.desc.name = format!("{}-{number}", self.name());
        stage.desc.width = side;
        stage.desc.height = side;
        stage.desc
    }
}

/// One made by hand.
pub fn by_hand(name: &str, side: u32) -> SceneDesc {
    let mut desc = builtin::scene(name).expect("the list above names scenes that there are");
    desc.width = side;
    desc.height = side;
    desc
}

struct Stage {
    desc: SceneDesc,
    rng: Pcg64Mcg,
}

impl Stage {
    fn new(seed: u64) -> Stage {
        let desc = SceneDesc {
            name: String::new(),
            width: 0,
            height: 0,
            spp: None,
            sampler: None,
            integrator: IntegratorDesc {
                kind: IntegratorKind::Path,
                max_depth: Some(7),
                rr_depth: 4,
                hide_emitters: false,
                ao_radius: None,
            },
            camera: camera([0.0; 3], [0.0, 0.0, -1.0], 45.0),
            materials: Vec::new(),
            shapes: Vec::new(),
            lights: Vec::new(),
            baked: None,
        };
        Stage {
            desc,
            rng: Pcg64Mcg::seed_from_u64(seed),
        }
    }

    fn num(&mut self, from: f64, to: f64) -> f64 {
        self.rng.random_range(from..to)
    }

    fn chance(&mut self, of: f64) -> bool {
        self.rng.random_bool(of)
    }

    /// A colour of some lightness, more or less saturated.
    fn colour(&mut self, from: f64, to: f64) -> Vec3 {
        let value = self.num(from, to);
        let saturation = self.num(0.0, 1.0).powi(2) * 0.9;
        let hue = self.num(0.0, 3.0);
        [0.0, 1.0, 2.0].map(|c| {
            let away = (hue - c).abs().min(3.0 - (hue - c).abs()).min(1.0);
            (value * (1.0 - saturation * away)).clamp(0.02, 0.95)
        })
    }

    fn material(&mut self, bsdf: BsdfDesc, two_sided: bool, tint: Option<TintDesc>) -> usize {
        self.desc.materials.push(NamedMaterial {
            name: format!("material {}", self.desc.materials.len()),
            two_sided,
            bsdf,
            tint,
        });
        self.desc.materials.len() - 1
    }

    fn matt(&mut self, from: f64, to: f64) -> usize {
        let reflectance = self.colour(from, to);
        self.material(BsdfDesc::Diffuse { reflectance }, true, None)
    }

    fn metal(&mut self, alpha: Option<f64>) -> usize {
        let specular_reflectance = self.colour(0.6, 0.95);
        let bsdf = match alpha {
            None => BsdfDesc::Conductor {
                specular_reflectance,
                eta_k: None,
            },
            Some(alpha) => BsdfDesc::RoughConductor {
                alpha,
                specular_reflectance,
                eta_k: None,
            },
        };
        self.material(bsdf, true, None)
    }

    fn glass(&mut self) -> usize {
        let white = [1.0; 3];
        let bsdf = BsdfDesc::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: white,
            specular_transmittance: white,
        };
        self.material(bsdf, false, None)
    }

    fn any_material(&mut self) -> usize {
        match self.num(0.0, 1.0) {
            x if x < 0.55 => self.matt(0.15, 0.95),
            x if x < 0.65 => {
                let (reflectance, sigma_degrees) = (self.colour(0.2, 0.9), self.num(10.0, 40.0));
                let bsdf = BsdfDesc::OrenNayar {
                    reflectance,
                    sigma_degrees,
                    model: OrenNayarModel::EnergyPreserving,
                };
                self.material(bsdf, true, None)
            }
            x if x < 0.75 => {
                let (kd, exponent) = (self.colour(0.1, 0.6), self.num(20.0, 300.0));
                let bsdf = BsdfDesc::BlinnPhong {
                    diffuse_reflectance: kd,
                    specular_reflectance: [self.num(0.1, 0.3); 3],
                    exponent,
                    normalized: true,
                };
                self.material(bsdf, true, None)
            }
            x if x < 0.85 => {
                let alpha = self.num(0.08, 0.4);
                self.metal(Some(alpha))
            }
            x if x < 0.92 => self.metal(None),
            _ => self.glass(),
        }
    }

    /// A matt surface with a picture: squares, stripes, spots or blotches of some colours.
    fn textured(&mut self) -> usize {
        let side = [8, 16, 32, 64][self.rng.random_range(0..4usize)];
        let colours: Vec<Vec3> = (0..4).map(|_| self.colour(0.1, 0.95)).collect();
        let kind = self.rng.random_range(0..4u32);
        let grain = self.num(0.0, 0.15);
        let mut texels = Vec::new();
        for y in 0..side {
            for x in 0..side {
                let (u, v) = (f64::from(x) / f64::from(side), f64::from(y) / f64::from(side));
                let which = match kind {
                    0 => ((x * 4 / side) + (y * 4 / side)) % 2,
                    1 => (x * 8 / side) % 3,
                    2 => u32::from((u - 0.5).hypot(v - 0.5) < 0.3),
                    _ => ((((u * TAU).sin() + (v * 2.0 * TAU).cos()) + 2.0) * 0.99) as u32,
                };
                let jitter = 1.0 - grain * self.num(0.0, 1.0);
                texels.push(colours[which as usize % 4].map(|c| c * jitter));
            }
        }
        let nearest = self.chance(0.5);
        let texture = Arc::new(TextureDesc {
            name: format!("texture {}", self.desc.materials.len()),
            width: side,
            height: side,
            texels,
            nearest,
        });
        let tint = TintDesc::Texture {
            texture,
            to_uv: TintDesc::IN_PLACE,
        };
        let bsdf = BsdfDesc::Diffuse {
            reflectance: [1.0; 3],
        };
        self.material(bsdf, true, Some(tint))
    }

    fn shape(&mut self, material: usize, geometry: GeometryDesc) {
        self.desc.shapes.push(ShapeDesc {
            name: format!("shape {}", self.desc.shapes.len()),
            geometry,
            material,
            emission: None,
        });
    }

    fn ball(&mut self, material: usize, center: Vec3, radius: f64) {
        self.shape(material, GeometryDesc::Sphere { center, radius });
    }

    /// The parallelogram `center ± u ± v`, with or without a picture that is repeated over it.
    fn panel(&mut self, center: Vec3, u: Vec3, v: Vec3, share_textured: f64) {
        if self.chance(share_textured) {
            let material = self.textured();
            let repeat = self.rng.random_range(1..5u32).into();
            let at = |i: f64, j: f64| [0, 1, 2].map(|k| center[k] + i * u[k] + j * v[k]);
            let mesh = MeshDesc {
                vertices: vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                uvs: vec![[0.0, 0.0], [repeat, 0.0], [repeat, repeat], [0.0, repeat]],
                ..MeshDesc::default()
            };
            self.shape(material, GeometryDesc::Mesh(mesh));
        } else {
            let material = self.matt(0.3, 0.9);
            self.shape(material, GeometryDesc::Rectangle { center, u, v });
        }
    }

    /// An upright box as five panels of one material (no bottom), turned about y.
    fn block(&mut self, material: usize, foot: Vec3, half: Vec3, turn: f64) {
        let (sin, cos) = turn.sin_cos();
        let turned = |p: Vec3| {
            let [x, y, z] = [p[0] * half[0], p[1] * half[1], p[2] * half[2]];
            [
                foot[0] + x * cos + z * sin,
                foot[1] + y,
                foot[2] - x * sin + z * cos,
            ]
        };
        let mut mesh = MeshDesc::default();
        for (normal, a, b) in [
            ([1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
            ([-1.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
            ([0.0, 1.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ([0.0, 1.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
            ([0.0, 2.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ] {
            let first = mesh.vertices.len() as u32;
            for (i, j) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                mesh.vertices
                    .push(turned([0, 1, 2].map(|k: usize| normal[k] + i * a[k] + j * b[k])));
            }
            mesh.triangles
                .extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        self.shape(material, GeometryDesc::Mesh(mesh));
    }

    /// A closed surface about `center`: a ball with waves, or a torus with waves, smooth or flat.
    fn bumpy(&mut self, material: usize, center: Vec3, radius: f64) {
        let (along, around) = (48u32, 24u32);
        let torus = self.chance(0.5);
        let (waves, depth) = (self.rng.random_range(0..7u32), self.num(0.0, 0.25));
        let (twist, tilt) = (self.rng.random_range(0..4u32), self.num(0.0, TAU));
        let place = |s: f64, t: f64| -> Vec3 {
            let wave = 1.0 + depth * (f64::from(waves) * s + f64::from(twist) * t).sin();
            let [x, y, z] = if torus {
                let tube = 0.35 * wave;
                let r = 0.65 + tube * t.cos();
                [r * s.cos(), tube * t.sin(), r * s.sin()]
            } else {
                let (latitude, wave) = (t / 2.0 - TAU / 4.0, wave * 0.8);
                let r = latitude.cos().max(0.02) * wave;
                [r * s.cos(), latitude.sin() * wave, r * s.sin()]
            };
            let (sin, cos) = tilt.sin_cos();
            let [x, y, z] = [x, y * cos - z * sin, y * sin + z * cos];
            [
                center[0] + radius * x,
                center[1] + radius * y,
                center[2] + radius * z,
            ]
        };
        let smooth = self.chance(0.7);
        let mut mesh = MeshDesc::default();
        let (rows, wrap) = if torus {
            (around, true)
        } else {
            (around + 1, false)
        };
        for j in 0..rows {
            for i in 0..along {
                let (s, t) = (
                    TAU * f64::from(i) / f64::from(along),
                    TAU * f64::from(j) / f64::from(around),
                );
                let t = if wrap { t } else { t.clamp(0.001, TAU - 0.001) };
                mesh.vertices.push(place(s, t));
                if smooth {
                    let (a, b) = (
                        sub(place(s + 1e-4, t), place(s - 1e-4, t)),
                        sub(place(s, t + 1e-4), place(s, t - 1e-4)),
                    );
                    mesh.normals.push(unit(cross(b, a)));
                }
            }
        }
        for j in 0..around {
            for i in 0..along {
                let at = |i: u32, j: u32| (j % rows) * along + i % along;
                let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        self.shape(material, GeometryDesc::Mesh(mesh));
    }

    fn lamp(&mut self, radiance: Vec3, geometry: GeometryDesc) {
        let black = self.material(
            BsdfDesc::Diffuse {
                reflectance: [0.0; 3],
            },
            false,
            None,
        );
        self.shape(black, geometry);
        self.desc.shapes.last_mut().expect("just added").emission = Some(radiance);
    }

    /// White, warm or cold, of a brightness.
    fn light(&mut self, brightness: f64) -> Vec3 {
        let warmth = self.num(-0.25, 0.35);
        [1.0 + warmth, 1.0, 1.0 - warmth].map(|c| c * brightness)
    }

    /// Balls, boxes and bumpy solids on a floor at y = 0, within ± `half`.
    fn things(&mut self, count: std::ops::Range<u32>, half: [f64; 2], bumpy: f64) {
        for _ in 0..self.rng.random_range(count) {
            let material = self.any_material();
            let (x, z) = (self.num(-half[0], half[0]), self.num(-half[1], half[1]));
            let size = self.num(0.2, 0.65);
            if self.chance(bumpy) {
                self.bumpy(material, [x, size, z], size);
            } else if self.chance(0.55) {
                self.ball(material, [x, size, z], size);
            } else {
                let (tall, turn) = (self.num(0.3, 1.4), self.num(0.0, TAU));
                self.block(material, [x, 0.0, z], [size * 0.7, tall * 0.5, size * 0.6], turn);
            }
        }
    }

    fn look(&mut self, eye: [(f64, f64); 3], at: [(f64, f64); 3]) {
        let origin = eye.map(|(a, b)| self.num(a, b));
        let target = at.map(|(a, b)| self.num(a, b));
        let fov = self.num(32.0, 60.0);
        self.desc.camera = camera(origin, target, fov);
    }

    /// Floor, ceiling and walls about y in 0 ..= `high`.
    fn walls(&mut self, [w, high, d]: Vec3, textured: f64) {
        let mid = high / 2.0;
        self.panel([0.0; 3], [w, 0.0, 0.0], [0.0, 0.0, -d], textured);
        self.panel([0.0, high, 0.0], [w, 0.0, 0.0], [0.0, 0.0, d], 0.0);
        self.panel([0.0, mid, -d], [w, 0.0, 0.0], [0.0, mid, 0.0], textured * 0.5);
        self.panel([0.0, mid, d], [w, 0.0, 0.0], [0.0, -mid, 0.0], 0.0);
        self.panel([-w, mid, 0.0], [0.0, 0.0, d], [0.0, -mid, 0.0], textured * 0.3);
        self.panel([w, mid, 0.0], [0.0, 0.0, d], [0.0, mid, 0.0], textured * 0.3);
    }

    fn ceiling_lamp(&mut self, x: f64, y: f64, z: f64, size: f64, brightness: f64) {
        let radiance = self.light(brightness / (size * size));
        let geometry = if self.chance(0.5) {
            GeometryDesc::Rectangle {
                center: [x, y, z],
                u: [size, 0.0, 0.0],
                v: [0.0, 0.0, size],
            }
        } else if self.chance(0.5) {
            GeometryDesc::Disk {
                center: [x, y, z],
                normal: [0.0, -1.0, 0.0],
                radius: size,
            }
        } else {
            GeometryDesc::Sphere {
                center: [x, y - size, z],
                radius: size * 0.6,
            }
        };
        self.lamp(radiance, geometry);
    }

    fn room(&mut self) {
        let size = [self.num(1.8, 3.0), self.num(2.3, 3.4), self.num(2.0, 3.5)];
        self.walls(size, 0.6);
        self.things(3..9, [size[0] * 0.7, size[2] * 0.6], 0.1);
        for _ in 0..self.rng.random_range(1..3u32) {
            let (x, z) = (self.num(-1.2, 1.2), self.num(-1.2, 1.2));
            let (lamp, power) = (self.num(0.15, 0.6), self.num(0.8, 3.0));
            self.ceiling_lamp(x, size[1] - 0.02, z, lamp, power);
        }
        let z = size[2] * 0.93;
        self.look(
            [(-1.0, 1.0), (1.0, 2.0), (z - 0.3, z)],
            [(-0.5, 0.5), (0.5, 1.1), (-1.0, 0.0)],
        );
    }

    fn sky(&mut self, sun: f64) {
        let blue = self.num(0.3, 1.0);
        let light = self.num(0.2, 0.9);
        let zenith = [0.35 * blue * light, 0.55 * light, 1.0 * light];
        let horizon = [0.9 * light, 0.9 * light, 0.95 * light];
        let sun = self.chance(sun).then(|| {
            let (turn, height) = (self.num(0.0, TAU), self.num(0.25, 0.9));
            let angle = self.num(0.6, 6.0);
            let share = (angle / 2.0_f64).to_radians().sin().powi(2) * std::f64::consts::PI;
            let power = self.num(0.8, 3.0);
            SunDesc {
                direction: unit([turn.cos(), height * 1.5, turn.sin()]),
                radiance: [1.1, 1.0, 0.85].map(|c| c * power / share),
                angle,
            }
        });
        let ground = self.colour(0.1, 0.4);
        self.desc.lights.push(LightDesc::Gradient {
            zenith,
            horizon,
            ground,
            up: [0.0, 1.0, 0.0],
            sun,
        });
    }

    fn open(&mut self) {
        let half = 12.0;
        self.panel([0.0; 3], [half, 0.0, 0.0], [0.0, 0.0, -half], 0.5);
        self.things(4..12, [2.2, 2.0], 0.1);
        if self.chance(0.25) {
            let radiance = self.light(0.8);
            self.desc.lights.push(LightDesc::Constant { radiance });
        } else {
            self.sky(0.7);
        }
        self.look(
            [(-2.0, 2.0), (0.9, 2.6), (3.4, 5.0)],
            [(-0.6, 0.6), (0.2, 0.8), (-0.5, 0.5)],
        );
    }

    fn solids(&mut self) {
        self.panel([0.0; 3], [5.0, 0.0, 0.0], [0.0, 0.0, -5.0], 0.4);
        self.panel([0.0, 2.0, -2.5], [5.0, 0.0, 0.0], [0.0, 3.0, 0.0], 0.4);
        self.things(2..6, [1.6, 1.2], 0.8);
        let (size, power) = (self.num(0.3, 1.0), self.num(2.0, 6.0));
        let x = self.num(-1.5, 1.5);
        self.ceiling_lamp(x, 3.6, 0.8, size, power);
        if self.chance(0.5) {
            let intensity = self.light(4.0);
            let position = [self.num(-3.0, 3.0), self.num(1.5, 4.0), self.num(1.0, 3.0)];
            self.desc.lights.push(LightDesc::Point { position, intensity });
        }
        self.look(
            [(-1.6, 1.6), (0.8, 2.2), (3.0, 4.2)],
            [(-0.4, 0.4), (0.4, 0.9), (-0.5, 0.2)],
        );
    }

    fn studio(&mut self) {
        let alpha = self.num(0.1, 0.4);
        let table = if self.chance(0.4) {
            self.metal(Some(alpha))
        } else {
            self.any_material()
        };
        let ground = GeometryDesc::Rectangle {
            center: [0.0; 3],
            u: [0.0, 0.0, 4.0],
            v: [4.0, 0.0, 0.0],
        };
        self.shape(table, ground);
        self.things(3..8, [1.5, 1.3], 0.3);
        for _ in 0..self.rng.random_range(1..4u32) {
            let (turn, high) = (self.num(0.0, TAU), self.num(1.5, 4.0));
            let (radius, size) = (self.num(2.5, 4.5), self.num(0.5, 1.4));
            let center = [radius * turn.cos(), high, radius * turn.sin()];
            let towards = unit(sub([0.0, 0.4, 0.0], center));
            let side = unit(cross(towards, [0.0, 1.0, 0.0]));
            let up = cross(side, towards);
            let power = self.num(1.5, 6.0);
            let radiance = self.light(power);
            self.lamp(
                radiance,
                GeometryDesc::Rectangle {
                    center,
                    u: up.map(|c| c * size),
                    v: side.map(|c| c * size),
                },
            );
        }
        let radiance = self.light(0.12);
        self.desc.lights.push(LightDesc::Constant { radiance });
        self.look(
            [(-1.2, 1.2), (0.8, 2.4), (2.6, 3.8)],
            [(-0.3, 0.3), (0.2, 0.5), (-0.4, 0.2)],
        );
    }

    fn columns(&mut self) {
        self.walls([2.6, 3.2, 5.0], 0.5);
        for row in 0..4 {
            let material = if self.chance(0.8) {
                self.matt(0.3, 0.9)
            } else {
                self.any_material()
            };
            for side in [-1.3, 1.3] {
                let z = f64::from(row) * 1.6 - 4.0;
                let wide = self.num(0.15, 0.3);
                let turn = self.num(0.0, 1.5);
                self.block(material, [side, 0.0, z], [wide, 1.6, wide], turn);
            }
        }
        self.things(2..5, [0.8, 2.0], 0.3);
        for z in [-2.5, 1.5] {
            let radiance = self.light(6.0);
            let side = if self.chance(0.5) { 1.0 } else { -1.0 };
            self.lamp(
                radiance,
                GeometryDesc::Rectangle {
                    center: [side * 2.55, 2.1, z],
                    u: [0.0, 0.5, 0.0],
                    v: [0.0, 0.0, -side * 0.7],
                },
            );
        }
        self.look(
            [(-0.6, 0.6), (1.0, 1.9), (4.0, 4.7)],
            [(-0.4, 0.4), (0.9, 1.3), (-3.0, -1.0)],
        );
    }

    fn gallery(&mut self) {
        self.walls([3.0, 3.0, 3.2], 0.2);
        for x in [-1.9, 0.0, 1.9] {
            let high = self.num(1.4, 1.8);
            self.panel([x, high, -3.15], [0.7, 0.0, 0.0], [0.0, 0.5, 0.0], 1.0);
            let radiance = self.light(25.0);
            self.lamp(
                radiance,
                GeometryDesc::Sphere {
                    center: [x, 2.7, -2.4],
                    radius: 0.1,
                },
            );
        }
        for x in [-1.2, 1.0] {
            let stand = self.matt(0.4, 0.9);
            let (z, turn) = (self.num(-1.5, 0.2), self.num(0.0, 1.5));
            self.block(stand, [x, 0.0, z], [0.3, 0.4, 0.3], turn);
            let shown = if self.chance(0.4) {
                self.glass()
            } else {
                self.any_material()
            };
            if self.chance(0.5) {
                self.ball(shown, [x, 1.11, z], 0.3);
            } else {
                self.bumpy(shown, [x, 1.16, z], 0.32);
            }
        }
        self.ceiling_lamp(0.0, 2.98, 1.0, 0.5, 1.0);
        self.look(
            [(-0.8, 0.8), (1.2, 1.7), (2.3, 3.0)],
            [(-0.3, 0.3), (1.0, 1.4), (-2.0, -1.0)],
        );
    }

    /// One plain wall.
    fn wall(&mut self, material: usize, center: Vec3, u: Vec3, v: Vec3) {
        self.shape(material, GeometryDesc::Rectangle { center, u, v });
    }

    fn alcove(&mut self) {
        let (w, high, d) = (self.num(0.9, 2.2), self.num(1.6, 2.6), self.num(0.8, 2.0));
        let mid = high / 2.0;
        let plain = self.matt(0.5, 0.9);
        let any = |stage: &mut Stage| {
            if stage.chance(0.4) {
                plain
            } else {
                stage.matt(0.15, 0.9)
            }
        };
        let [floor, ceiling, back, left, right] = [(); 5].map(|()| any(self));
        self.wall(floor, [0.0; 3], [0.0, 0.0, d], [w, 0.0, 0.0]);
        self.wall(ceiling, [0.0, high, 0.0], [w, 0.0, 0.0], [0.0, 0.0, d]);
        self.wall(back, [0.0, mid, -d], [w, 0.0, 0.0], [0.0, mid, 0.0]);
        self.wall(left, [-w, mid, 0.0], [0.0, mid, 0.0], [0.0, 0.0, d]);
        self.wall(right, [w, mid, 0.0], [0.0, 0.0, d], [0.0, mid, 0.0]);
        self.things(2..6, [w * 0.6, d * 0.6], 0.25);
        for _ in 0..self.rng.random_range(1..3u32) {
            let (x, z, size) = (
                self.num(-0.5, 0.5) * w,
                self.num(-0.5, 0.5) * d,
                self.num(0.06, 0.4),
            );
            self.ceiling_lamp(x, high - 0.02, z, size, 1.0);
        }
        let far = self.num(1.2, 3.0) * w + d;
        self.look(
            [(-0.8, 0.8), (0.4 * high, 0.8 * high), (far, far + 0.5)],
            [(-0.3, 0.3), (0.4 * high, 0.6 * high), (-0.4, 0.0)],
        );
    }

    fn void(&mut self) {
        let half = self.num(1.5, 6.0);
        self.panel([0.0; 3], [half, 0.0, 0.0], [0.0, 0.0, -half], 0.3);
        let bumpy = self.num(0.2, 0.9);
        self.things(1..6, [1.3, 1.2], bumpy);
        if self.chance(0.6) {
            let (x, z) = (self.num(-1.5, 1.5), self.num(-1.0, 1.5));
            let (size, high) = (self.num(0.1, 1.0), self.num(2.4, 4.0));
            self.ceiling_lamp(x, high, z, size, 3.0);
        } else {
            for _ in 0..self.rng.random_range(1..4u32) {
                let position = [self.num(-3.0, 3.0), self.num(1.5, 4.0), self.num(-1.0, 3.0)];
                let power = self.num(1.0, 6.0);
                let intensity = self.light(power);
                self.desc.lights.push(LightDesc::Point { position, intensity });
            }
        }
        self.look(
            [(-2.0, 2.0), (0.6, 2.8), (3.0, 5.0)],
            [(-0.4, 0.4), (0.3, 1.0), (-0.5, 0.3)],
        );
    }

    fn park(&mut self) {
        let ground = self.matt(0.2, 0.7);
        let plane = GeometryDesc::Plane {
            point: [0.0; 3],
            normal: [0.0, 1.0, 0.0],
        };
        self.shape(ground, plane);
        let bumpy = self.num(0.0, 0.5);
        self.things(3..10, [2.0, 1.8], bumpy);
        let (width, height) = (24u32, 12u32);
        let sky = [
            self.colour(0.1, 0.8),
            self.colour(0.1, 0.8),
            self.colour(0.05, 0.3),
        ];
        let mut pixels: Vec<Vec3> = (0..height)
            .flat_map(|row| (0..width).map(move |_| row))
            .map(|row| {
                sky[if row < 3 {
                    0
                } else if row < 7 {
                    1
                } else {
                    2
                }]
            })
            .collect();
        for _ in 0..self.rng.random_range(1..4u32) {
            let (left, top) = (self.rng.random_range(0..width), self.rng.random_range(1..5u32));
            let (wide, tall) = (self.rng.random_range(1..5u32), self.rng.random_range(1..3u32));
            let power = 2f64.powf(self.num(0.5, 5.5));
            let light = self.light(power);
            for row in top..top + tall {
                (left..left + wide)
                    .for_each(|column| pixels[(row * width + column % width) as usize] = light);
            }
        }
        self.desc.lights.push(LightDesc::EnvMap {
            width,
            height,
            pixels,
            to_world: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        });
        self.look(
            [(-2.0, 2.0), (0.7, 2.4), (3.2, 5.0)],
            [(-0.6, 0.6), (0.2, 0.8), (-0.5, 0.5)],
        );
    }

    fn night(&mut self) {
        let (floor, back) = (self.matt(0.2, 0.8), self.matt(0.2, 0.8));
        let far = self.num(-4.0, -1.5);
        for (material, point, normal) in [
            (floor, [0.0; 3], [0.0, 1.0, 0.0]),
            (back, [0.0, 0.0, far], [0.0, 0.0, 1.0]),
        ] {
            self.shape(material, GeometryDesc::Plane { point, normal });
        }
        self.things(2..6, [1.8, 1.4], 0.2);
        for _ in 0..self.rng.random_range(1..4u32) {
            let radius = self.num(0.1, 0.6);
            let center = [
                self.num(-2.2, 2.2),
                self.num(radius, 3.0),
                self.num(far + 0.8, 2.2),
            ];
            let mut radiance = self.light(0.6 / radius);
            if self.chance(0.4) {
                let tint = self.colour(0.3, 0.95);
                radiance.iter_mut().zip(tint).for_each(|(c, t)| *c *= t);
            }
            self.lamp(radiance, GeometryDesc::Sphere { center, radius });
        }
        self.look(
            [(-1.2, 1.2), (0.6, 2.0), (3.2, 4.8)],
            [(-0.5, 0.5), (0.4, 1.0), (-1.0, 0.0)],
        );
    }

    fn stairs(&mut self) {
        let turn = self.num(-0.8, 0.8);
        for step in 0..5 {
            let material = if self.chance(0.8) {
                self.matt(0.2, 0.9)
            } else {
                self.any_material()
            };
            let (n, deep) = (f64::from(step), self.num(0.25, 0.35));
            self.block(
                material,
                [0.0, 0.0, 1.2 - 0.6 * n],
                [1.4, 0.12 + 0.12 * n, deep],
                turn * 0.1,
            );
        }
        let shown = self.any_material();
        self.ball(shown, [-0.4, 0.95, -0.6], 0.35);
        let shown = self.matt(0.2, 0.9);
        self.bumpy(shown, [0.5, 0.7, 0.6], 0.35);
        let (x, size) = (self.num(-1.5, 1.5), self.num(0.15, 0.7));
        self.ceiling_lamp(x, 3.4, 0.9, size, 2.0);
        self.look(
            [(-2.5, 2.5), (1.4, 2.6), (3.2, 4.4)],
            [(-0.2, 0.2), (0.4, 0.8), (-0.4, 0.2)],
        );
    }

    fn terrain(&mut self) {
        let (side, half) = (60u32, 6.0);
        let waves: Vec<[f64; 4]> = (0..5)
            .map(|i| {
                let k = 0.5 * 1.8_f64.powi(i);
                [
                    self.num(-k, k),
                    self.num(-k, k),
                    self.num(0.0, TAU),
                    0.5 / 1.7_f64.powi(i),
                ]
            })
            .collect();
        let height = |x: f64, z: f64| -> f64 {
            waves
                .iter()
                .map(|[a, b, c, d]| d * (a * x + b * z + c).sin())
                .sum()
        };
        let mut mesh = MeshDesc::default();
        for j in 0..=side {
            for i in 0..=side {
                let at = |i: u32| (f64::from(i) / f64::from(side) * 2.0 - 1.0) * half;
                mesh.vertices.push([at(i), height(at(i), at(j)), at(j)]);
                mesh.uvs.push([f64::from(i) / 10.0, f64::from(j) / 10.0]);
            }
        }
        for j in 0..side {
            for i in 0..side {
                let a = j * (side + 1) + i;
                let (b, c, d) = (a + 1, a + side + 2, a + side + 1);
                mesh.triangles.extend([[a, c, b], [a, d, c]]);
            }
        }
        let ground = if self.chance(0.5) {
            self.textured()
        } else {
            self.matt(0.3, 0.7)
        };
        self.shape(ground, GeometryDesc::Mesh(mesh));
        for _ in 0..6 {
            let material = self.any_material();
            let (x, z, radius) = (self.num(-2.0, 2.0), self.num(-2.0, 2.0), self.num(0.2, 0.6));
            self.ball(material, [x, height(x, z) + radius * 0.8, z], radius);
        }
        self.sky(1.0);
        let (x, z) = (self.num(-2.0, 2.0), 4.8);
        let eye = [x, height(x, z) + 1.6, z];
        let fov = self.num(40.0, 55.0);
        self.desc.camera = camera(eye, [0.0, height(0.0, 0.0) + 0.2, 0.0], fov);
    }
}

/// From `origin` towards `target`, y up.
fn camera(origin: Vec3, target: Vec3, fov_x: f64) -> CameraDesc {
    let forward = unit(sub(target, origin));
    let right = unit(cross(forward, [0.0, 1.0, 0.0]));
    CameraDesc {
        origin,
        right,
        up: cross(right, forward),
        forward,
        fov_x,
        lens: None,
    }
}

fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn unit(v: Vec3) -> Vec3 {
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt().max(1e-12);
    v.map(|c| c / length)
}
