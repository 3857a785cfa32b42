//! Random scenes: every shape, material and light, of every size, many on top of each other.

use microlux::bvh::{Node, build_mesh, max_nodes};
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Dir, Point, REACH, Rotation, Unit};
use microlux::light::{Environment, Light};
use microlux::material::{
    BlinnPhong, Conductor, Dielectric, Index, Material, OrenNayar, OrenNayarModel, RoughDielectric,
};
use microlux::num::{Metres, Share, Turn};
use microlux::scene::{Arrangement, Boxed, Mesh, Parts, Shape, Tint, arrange};
use microlux::shape::{
    Attributes, Blob, Bound, Capsule, Disk, Geometry, Grid, Gyroid, Implicit, Instance, Metaballs, Plane,
    Rectangle, RoundedBox, SmoothUnion, Sphere, Torus, TriangleMesh,
};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as u32
    }

    /// 0 ..< n.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.bits() as u64 * n as u64) >> 32) as usize
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// −limit ..= limit.
    pub fn within(&mut self, limit: i32) -> i32 {
        (self.bits() as i64 % (2 * limit as i64 + 1) - limit as i64) as i32
    }

    /// 1 ..= limit, each octave as often as the next.
    pub fn size(&mut self, limit: i32) -> i32 {
        let octave = self.below(limit.ilog2() as usize + 1);
        ((1 << octave) + self.below(1 << octave) as i32).min(limit)
    }

    pub fn point(&mut self, limit: i32) -> Point {
        Point([0; 3].map(|_| self.within(limit)))
    }

    /// Anywhere, along axes and diagonals, and next to an axis.
    pub fn dir(&mut self) -> Dir {
        let limit = self.pick(&[1, 1, 2, 1000, 1 << 20, 1 << 20, 1 << 20]);
        let mut v = self.point(limit).0;
        if self.one_in(4) {
            v[self.below(3)] = 1 << 20;
        }
        Dir::new(v).unwrap_or(Dir::Z)
    }
}

/// A mesh with its tree.
pub struct Model {
    pub grid: Grid,
    pub vertices: Vec<[u16; 3]>,
    pub triangles: Vec<[u16; 3]>,
    pub nodes: Vec<Node>,
}

impl Model {
    pub fn borrow(&self) -> Mesh<'_> {
        Mesh {
            triangles: TriangleMesh {
                grid: self.grid,
                vertices: &self.vertices,
                triangles: &self.triangles,
                attributes: Attributes::NONE,
            }
            .into(),
            nodes: &self.nodes,
        }
    }

    /// Triangles of all sizes, some without area, in a cube somewhere within reach.
    fn random(random: &mut Random) -> Model {
        let shift = random.below(8) as u8;
        let cube = 65536 << shift;
        let origin = [0; 3].map(|_| random.within(REACH - cube / 2) - cube / 2);
        let grid = Grid::new(Point(origin), shift).unwrap();
        let (low, high) = (Grid::MARGIN as i32, (u16::MAX - Grid::MARGIN) as i32);
        let count = 3 + random.below(40);
        let size = random.size(65535);
        let near = [0; 3].map(|_| random.below(65536) as i32);
        let mut vertex = || near.map(|c| (c + random.within(size)).clamp(low, high) as u16);
        let vertices: Vec<_> = (0..count).map(|_| vertex()).collect();
        let triangle = |_| [0; 3].map(|_| random.below(count) as u16);
        let mut triangles: Vec<_> = (0..2 * count).map(triangle).collect();
        let mut nodes = vec![Node::EMPTY; max_nodes(triangles.len())];
        let used = build_mesh(&vertices, &mut triangles, &mut nodes).unwrap();
        nodes.truncate(used);
        Model {
            grid,
            vertices,
            triangles,
            nodes,
        }
    }
}

/// What a scene is made of.
pub struct Draft {
    pub unit: Unit,
    pub shapes: Vec<Shape>,
    pub materials: Vec<Material>,
    pub lights: Vec<Light>,
    pub meshes: Vec<Model>,
    pub blobs: Vec<Blob>,
    pub nodes: Vec<Node>,
    pub arrangement: Arrangement,
}

/// Balls, mostly, near one another.
fn blobs(random: &mut Random) -> Vec<Blob> {
    let size = random.size(REACH / 8).max(500);
    let center = random.point(REACH - 4 * size);
    let near = |random: &mut Random| Point([0, 1, 2].map(|i| center.0[i] + random.within(size)));
    let blob = |_| {
        let (a, b) = (near(random), near(random));
        let radius = size / 4 + random.below(size as usize / 2) as i32;
        if random.one_in(8) {
            Capsule::new(a, b, radius).into()
        } else {
            Blob::ball(a, radius)
        }
    };
    (0..6).map(blob).collect()
}

/// A solid given by a function that the border lets pass, if it is to be had at the first try.
fn implicit(random: &mut Random, blobs: &[Blob]) -> Option<Implicit> {
    let size = random.size(REACH / 2).max(500);
    let center = random.point(REACH - 2 * size);
    let share = |random: &mut Random| size / 16 + random.below(size as usize / 2) as i32;
    let (x, y) = (random.dir(), random.dir());
    let (first, count) = (random.below(4) as u16, 1 + random.below(3) as u16);
    let solid = match random.below(6) {
        0 => Implicit::Torus(Torus::new(center, x, size, share(random))),
        1 => {
            let b = Point([0, 1, 2].map(|i| center.0[i] + random.within(size)));
            Implicit::Capsule(Capsule::new(center, b, share(random)))
        }
        2 => {
            let half = [0; 3].map(|_| share(random));
            let radius = 1 + random.below(half[0].min(half[1]).min(half[2]) as usize) as i32;
            Implicit::RoundedBox(RoundedBox::new(center, x, y, half, radius)?)
        }
        3 => {
            let cell = share(random);
            let bound = if random.one_in(2) {
                Bound::ball(size)
            } else {
                Bound::block([0; 3].map(|_| share(random)))
            };
            let thickness = cell / 4 + random.within(cell / 32);
            Implicit::Gyroid(Gyroid::new(center, [x, y], cell, thickness, bound)?)
        }
        4 => Implicit::Metaballs(Metaballs::new(
            blobs,
            first,
            count,
            1 << random.pick(&[22, 25, 26]),
        )),
        _ => Implicit::SmoothUnion(SmoothUnion::new(blobs, first, count, 100 + share(random))),
    };
    solid.check(blobs).is_ok().then_some(solid)
}

/// One of the meshes in any place, all of it within reach.
fn instance(random: &mut Random, meshes: &[Model]) -> Instance {
    let mesh = random.below(meshes.len());
    let grid = &meshes[mesh].grid;
    let cube = 65536 << grid.shift();
    let middle = grid.to_scene([32768; 3]);
    let scale = random.pick(&[1 << 12, 5000, 30_000, 65_535, 1 << 16, 99_999, 1 << 18, 1 << 20]);
    // Half its diagonal is less than its side.
    let most = i64::from(REACH) * 65536 / i64::from(cube) / 2;
    let scale = i64::from(scale).min(most).max(1 << 12) as i32;
    let size = ((i64::from(cube) * i64::from(scale)) >> 16) as i32;
    let quaternion = match random.below(4) {
        0 => [1, 0, 0, 0],
        1 => [1, 1, 0, 0],
        _ => [0; 4].map(|_| random.within(1 << 20)),
    };
    let turned = Instance::new(mesh as u16)
        .scaled(Metres::from_bits(scale))
        .turned(Rotation::new(quaternion).unwrap_or(Rotation::NONE));
    let Point(from) = turned.place(middle);
    let Point(to) = random.point((REACH - size).max(1));
    turned.moved(Point([0, 1, 2].map(|i| to[i] - from[i])))
}

fn geometry(random: &mut Random, meshes: &[Model], blobs: &[Blob]) -> Geometry {
    if random.one_in(4)
        && let Some(solid) = implicit(random, blobs)
    {
        let (low, high) = solid.bounds(blobs);
        if low.0.iter().all(|c| *c >= -REACH) && high.0.iter().all(|c| *c <= REACH) {
            return solid.into();
        }
    }
    let size = random.size(REACH);
    let center = random.point(REACH - size);
    match random.below(if meshes.is_empty() { 4 } else { 8 }) {
        0 => Sphere::new(center, size).into(),
        1 => Disk::new(center, random.dir(), size).into(),
        2 => {
            let (u, v) = (random.dir(), random.dir());
            // Its corners must be within reach.
            let half = [size / 2 + 1, random.size(size / 2 + 1)];
            Rectangle::new(Point(center.0.map(|c| c / 2)), u, v, half)
                .map_or(Sphere::new(center, size).into(), Into::into)
        }
        3 => Plane::new(random.point(REACH), random.dir()).into(),
        4 | 5 => Geometry::Mesh(random.below(meshes.len()) as u16),
        _ => instance(random, meshes).into(),
    }
}

fn albedo(random: &mut Random) -> Albedo {
    Albedo([0; 3].map(|_| Share::from_bits(random.pick(&[0, 1, 9000, 32767, 32768]))))
}

pub fn radiance(random: &mut Random) -> Radiance {
    let exponent = random.pick(&[-16, -16, -32, 0, 100, -100, 40_000, -40_000]);
    Radiance::from_bits([0; 3].map(|_| random.bits() >> random.below(32)), exponent)
}

fn material(random: &mut Random) -> Material {
    let (albedo, two_sided) = (albedo(random), random.one_in(2));
    match random.below(14) {
        0..=2 => Material::Lambert { albedo, two_sided },
        3 | 4 => Material::Mirror {
            reflectance: albedo,
            two_sided,
        },
        5 | 6 => {
            let eta = random.pick(&[
                0,
                1 << 14,
                60_000,
                65_535,
                65_536,
                65_537,
                98_304,
                1 << 18,
                i32::MAX,
            ]);
            Material::Dielectric(Dielectric::new(Metres::from_bits(eta)).tinted(albedo, Albedo::WHITE))
        }
        7..=12 => scattering(random, albedo, two_sided),
        _ => Material::Black,
    }
}

/// Those with parameters, at the ends of their ranges and in between.
fn scattering(random: &mut Random, albedo: Albedo, two_sided: bool) -> Material {
    let alpha = Share::from_bits(random.pick(&[32, 33, 1000, 9000, 32767, 32768]));
    match random.below(4) {
        0 => {
            let model = random.pick(&[
                OrenNayarModel::Full,
                OrenNayarModel::Qualitative,
                OrenNayarModel::EnergyPreserving,
            ]);
            let sigma = Turn::from_bits(random.pick(&[0, 1, 1 << 26, 1 << 29, 1 << 30]));
            let diffuse = OrenNayar::new(model, albedo, sigma);
            Material::OrenNayar(if two_sided { diffuse } else { diffuse.one_sided() })
        }
        1 => {
            let exponent = Metres::from_bits(random.pick(&[0, 1, 1 << 16, 20 << 16, 1 << 26, 1 << 30]));
            let phong = BlinnPhong::new(
                albedo,
                random.pick(&[Albedo::WHITE, Albedo::BLACK, albedo]),
                exponent,
            );
            let phong = if random.one_in(2) {
                phong
            } else {
                phong.unnormalized()
            };
            Material::BlinnPhong(if two_sided { phong } else { phong.one_sided() })
        }
        2 => {
            let metal = Conductor::new(albedo);
            let metal = if random.one_in(3) {
                metal
            } else {
                metal.rough(alpha)
            };
            let index = |random: &mut Random| {
                [0; 3].map(|_| Index::from_bits(random.pick(&[0, 1, 600, 4096, 9000, u16::MAX])))
            };
            let metal = if random.one_in(3) {
                metal
            } else {
                metal.with_index(index(random), index(random))
            };
            Material::Conductor(if two_sided { metal } else { metal.one_sided() })
        }
        _ => {
            let eta = random.pick(&[0, 1 << 14, 60_000, 66_048, 98_304, 1 << 18]);
            let smooth = Dielectric::new(Metres::from_bits(eta)).tinted(albedo, Albedo::WHITE);
            Material::RoughDielectric(RoughDielectric::new(smooth, alpha))
        }
    }
}

impl Draft {
    /// A scene that the border lets pass.
    pub fn random(random: &mut Random) -> Draft {
        let meshes: Vec<Model> = (0..random.below(3)).map(|_| Model::random(random)).collect();
        let blobs = blobs(random);
        let materials: Vec<Material> = (0..1 + random.below(5)).map(|_| material(random)).collect();
        let mut shapes: Vec<Shape> = Vec::new();
        let mut lights = vec![Light::Directional {
            direction: random.dir(),
            irradiance: Radiance::WHITE,
        }];
        for id in 0..1 + random.below(20) as u16 {
            // Often the same again: two at one place, and the first is to be found.
            let again = shapes.len() > 1 && random.one_in(4);
            let geometry = if again {
                shapes[random.below(shapes.len())].geometry
            } else {
                geometry(random, &meshes, &blobs)
            };
            let emits = random.one_in(4) && !matches!(geometry, Geometry::Plane(_) | Geometry::Instance(_));
            shapes.push(Shape {
                geometry,
                material: random.below(materials.len()) as u16,
                light: emits.then_some(lights.len() as u16),
                tint: Tint::None,
                id,
            });
            if emits {
                lights.push(Light::Area {
                    shape: id,
                    radiance: radiance(random),
                });
            }
        }
        if random.one_in(2) {
            lights.push(Light::Point {
                position: random.point(2 * REACH),
                intensity: radiance(random),
            });
        }
        if random.one_in(3) {
            lights.push(Light::Environment {
                radiance: radiance(random),
            });
        }
        let mut draft = Draft {
            unit: Unit::new(random.pick(&[-20, 0, 10, 16, 20, 40])),
            shapes,
            materials,
            lights,
            meshes,
            blobs,
            nodes: Vec::new(),
            arrangement: Arrangement {
                grid: Grid::UNIT,
                bounded: 0,
                nodes: 0,
            },
        };
        draft.arrange();
        draft
    }

    /// Builds the tree over the shapes as they are.
    pub fn arrange(&mut self) {
        self.nodes = vec![Node::EMPTY; max_nodes(self.shapes.len())];
        let mut boxes = vec![Boxed::EMPTY; self.shapes.len()];
        let meshes: Vec<Mesh> = self.meshes.iter().map(Model::borrow).collect();
        self.arrangement = arrange(
            &mut self.shapes,
            &meshes,
            &self.blobs,
            &mut self.lights,
            &mut boxes,
            &mut self.nodes,
        )
        .unwrap();
        self.nodes.truncate(self.arrangement.nodes);
    }

    pub fn meshes(&self) -> Vec<Mesh<'_>> {
        self.meshes.iter().map(Model::borrow).collect()
    }

    pub fn parts<'a>(&'a self, meshes: &'a [Mesh<'a>]) -> Parts<'a> {
        Parts {
            unit: self.unit,
            shapes: &self.shapes,
            bounded: self.arrangement.bounded as u16,
            materials: &self.materials,
            lights: &self.lights,
            environment: Environment::None,
            choice: &[],
            meshes,
            textures: &[],
            blobs: &self.blobs,
            grid: self.arrangement.grid,
            nodes: &self.nodes,
        }
    }
}
