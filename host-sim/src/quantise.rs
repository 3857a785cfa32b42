//! A scene as the files say it, rounded into the core's integers: the one place where floats become fixed point.

use std::collections::HashMap;

use crate::bake;
use crate::desc::{GeometryDesc, LightDesc, MeshDesc, SceneDesc, ShapeDesc, TintDesc, Vec3};
use crate::envmap::{self, BakedMap};
use crate::picture::srgb;
use fixed::types::I12F20;
use instance::Shared;
use microlux::bvh::{Node, max_nodes};
use microlux::camera::Camera;
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Dir, Octahedral, Point, REACH, Unit};
use microlux::light::{Environment, Light, Sky};
use microlux::material::{Material, Texture};
use microlux::num::{Share, Turn};
use microlux::scene::{Arrangement, Boxed, Mesh, Parts, Scene, SceneError, Shape, Tint, arrange};
use microlux::shape::{
    Attributes, Blob, Disk, Geometry, Grid, Plane, Rectangle, Sphere, TriangleMesh, Triangles,
};
pub use texture::OwnedTexture;
use texture::Textures;
use thiserror::Error;

mod implicit;
mod instance;
mod material;
mod texture;

/// What the fixed-point core can't take.
#[derive(Debug, Error)]
pub enum QuantiseError {
    #[error("{name}: {what}")]
    Unsupported { name: String, what: String },
    #[error("{name}: {error}")]
    Shape { name: String, error: SceneError },
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// What of a scene is left out, a line each: the picture will differ by it.
pub fn losses(desc: &SceneDesc) -> Vec<String> {
    let mut lines = Vec::new();
    for shape in &desc.shapes {
        let tint = desc
            .materials
            .get(shape.material)
            .and_then(|material| material.tint.as_ref());
        let mesh = mesh_of(&shape.geometry);
        let told = match tint {
            Some(TintDesc::Vertices) if mesh.is_none_or(|mesh| mesh.colors.is_empty()) => {
                "colours of its vertices"
            }
            Some(TintDesc::Texture { .. }) if mesh.is_none_or(|mesh| mesh.uvs.is_empty()) => {
                "places in the texture"
            }
            _ => continue,
        };
        lines.push(format!(
            "{}: has no {told}: its material's own colour is left",
            shape.name
        ));
    }
    for light in &desc.lights {
        if let LightDesc::EnvMap { width, height, .. } = light
            && let Some([across, down]) = envmap::resizing(*width as usize, *height as usize)
        {
            lines.push(format!(
                "envmap: its {width} x {height} pixels become {across} x {down}, of the same mean"
            ));
        }
    }
    lines
}

/// A scene in the core's numbers, owned.
#[derive(Debug)]
pub struct CoreScene {
    pub unit: Unit,
    /// Where the scene frame's origin lies, metres.
    pub origin: Vec3,
    pub camera: Camera,
    shapes: Vec<Shape>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    meshes: Vec<OwnedMesh>,
    textures: Vec<OwnedTexture>,
    /// What metaballs and smooth unions are made of.
    blobs: Vec<Blob>,
    nodes: Vec<Node>,
    arrangement: Arrangement,
    names: Vec<String>,
    background: Background,
    /// How lights are chosen, by their power.
    choice: Vec<u32>,
}

/// What surrounds the scene and is no constant.
#[derive(Debug)]
enum Background {
    None,
    Sky(Sky),
    Map(BakedMap),
}

/// A mesh in its own grid, with the tree over it.
#[derive(Debug)]
pub struct OwnedMesh {
    /// Of the first shape that is made of it.
    pub name: String,
    /// By how far rounding moved a vertex, metres: at most, and as root of the mean square.
    pub displacement: [f64; 2],
    /// Longest side, metres.
    pub extent: f64,
    grid: Grid,
    vertices: Vec<[u16; 3]>,
    triangles: Vec<[u16; 3]>,
    /// One of each a vertex, or none.
    normals: Vec<Octahedral>,
    colors: Vec<[u8; 3]>,
    uvs: Vec<[i16; 2]>,
    nodes: Vec<Node>,
}

impl OwnedMesh {
    pub fn borrow(&self) -> Mesh<'_> {
        let triangles = TriangleMesh {
            grid: self.grid,
            vertices: &self.vertices,
            triangles: &self.triangles,
            attributes: Attributes {
                normals: &self.normals,
                colors: &self.colors,
                uvs: &self.uvs,
            },
        };
        Mesh {
            triangles: triangles.into(),
            nodes: &self.nodes,
        }
    }
}

/// What a scene borrows and the core knows by slices.
#[derive(Clone, Debug)]
pub struct Lent<'a> {
    pub meshes: Vec<Mesh<'a>>,
    pub textures: Vec<Texture<'a>>,
}

impl CoreScene {
    /// Chooses the finest unit in which the scene fits, with the middle of the scene as origin, and rounds.
    pub fn new(desc: &SceneDesc) -> Result<CoreScene, QuantiseError> {
        let (origin, unit) = choose_unit(desc);
        let round = Rounding {
            origin,
            scale: f64::from(unit.fraction_bits()).exp2(),
        };
        let materials = desc
            .materials
            .iter()
            .map(|m| material::material(&m.name, m.two_sided, &m.bsdf));
        let materials = materials.collect::<Result<Vec<_>, _>>()?;
        let mut shapes = Vec::new();
        let mut lights = Vec::new();
        let mut meshes = Vec::new();
        let mut blobs = Vec::new();
        let mut shared = Shared::new(&round, desc);
        let mut textures = Textures::default();
        for (index, shape) in desc.shapes.iter().enumerate() {
            let light = shape.emission.map(|emission| {
                lights.push(Light::Area {
                    shape: index as u16,
                    radiance: radiance(emission),
                });
                (lights.len() - 1) as u16
            });
            let wanted = desc
                .materials
                .get(shape.material)
                .and_then(|material| material.tint.as_ref());
            let geometry = match &shape.geometry {
                GeometryDesc::Mesh(mesh) => {
                    meshes.push(round.mesh(&shape.name, mesh, wanted)?);
                    Geometry::Mesh((meshes.len() - 1) as u16)
                }
                GeometryDesc::Instance(instance) => {
                    match shared.place(&round, &shape.name, instance, wanted, &mut meshes)? {
                        Some(placed) if light.is_none() => Geometry::Instance(placed),
                        _ => {
                            meshes.push(round.mesh(&shape.name, &instance.placed(), wanted)?);
                            Geometry::Mesh((meshes.len() - 1) as u16)
                        }
                    }
                }
                GeometryDesc::Implicit(solid) => {
                    let solid = implicit::implicit(&round, solid, &mut blobs);
                    Geometry::Implicit(solid.map_err(|what| QuantiseError::Unsupported {
                        name: shape.name.clone(),
                        what,
                    })?)
                }
                _ => round.geometry(shape)?,
            };
            shapes.push(Shape {
                geometry,
                material: shape.material as u16,
                light,
                tint: match (wanted, mesh_of(&shape.geometry)) {
                    (Some(TintDesc::Vertices), Some(mesh)) if !mesh.colors.is_empty() => Tint::Vertices,
                    (Some(TintDesc::Texture { texture, .. }), Some(mesh)) if !mesh.uvs.is_empty() => {
                        Tint::Texture(textures.of(texture))
                    }
                    _ => Tint::None,
                },
                id: index as u16,
            });
        }
        let mut environment = None;
        let mut background = Background::None;
        for light in &desc.lights {
            match light {
                LightDesc::Point { position, intensity } => {
                    lights.push(Light::Point {
                        position: round.point(*position),
                        intensity: radiance(*intensity),
                    });
                }
                LightDesc::Directional {
                    direction,
                    irradiance,
                } => {
                    lights.push(Light::Directional {
                        direction: dir(*direction),
                        irradiance: radiance(*irradiance),
                    });
                }
                LightDesc::Constant { radiance: r } => {
                    environment = Some(Light::Environment {
                        radiance: radiance(*r),
                    });
                }
                LightDesc::Gradient {
                    zenith,
                    horizon,
                    ground,
                    up,
                    sun,
                } => {
                    let sky = Sky::new(dir(*up), radiance(*zenith), radiance(*horizon), radiance(*ground));
                    background = Background::Sky(match sun {
                        Some(sun) => sky.with_sun(
                            dir(sun.direction),
                            Turn::saturating_from_num(sun.angle / 360.0),
                            radiance(sun.radiance),
                        ),
                        None => sky,
                    });
                }
                LightDesc::EnvMap {
                    width,
                    height,
                    pixels,
                    to_world,
                } => {
                    let axes = to_world.map(dir);
                    let map = BakedMap::new(*width as usize, *height as usize, pixels, axes);
                    background = Background::Map(map);
                }
            }
        }
        lights.extend(environment);
        let names = desc.shapes.iter().map(|shape| shape.name.clone()).collect();
        let mut nodes = vec![Node::EMPTY; max_nodes(shapes.len())];
        let mut boxes = vec![Boxed::EMPTY; shapes.len()];
        let borrowed: Vec<_> = meshes.iter().map(OwnedMesh::borrow).collect();
        let arrangement = arrange(
            &mut shapes,
            &borrowed,
            &blobs,
            &mut lights,
            &mut boxes,
            &mut nodes,
        )
        .map_err(|error| SceneError::Nodes { needed: error.needed })?;
        nodes.truncate(arrangement.nodes);
        let camera = round.camera(desc);
        let mut core = CoreScene {
            unit,
            origin,
            camera,
            shapes,
            materials,
            lights,
            meshes,
            textures: textures.list,
            blobs,
            nodes,
            arrangement,
            names,
            background,
            choice: Vec::new(),
        };
        core.choose_by_power();
        Ok(core)
    }

    /// Makes the table by which lights are chosen; a scene that the border refuses has none.
    fn choose_by_power(&mut self) {
        let lent = self.lend();
        let mut table = Vec::new();
        if let Ok(scene) = self.scene(&lent) {
            table = vec![0; scene.light_count().saturating_sub(1) as usize];
            scene.choose_by_power(&mut table);
        }
        self.choice = table;
    }

    /// Bytes of constant memory that a map of the environment takes.
    pub fn map_bytes(&self) -> usize {
        match &self.background {
            Background::Map(map) => map.map().map_or(0, |map| map.bytes()),
            Background::None | Background::Sky(_) => 0,
        }
    }

    /// The meshes, with what is known of them.
    pub fn owned_meshes(&self) -> &[OwnedMesh] {
        &self.meshes
    }

    /// The textures, with what is known of them.
    pub fn owned_textures(&self) -> &[OwnedTexture] {
        &self.textures
    }

    /// The meshes and textures as the core borrows them.
    pub fn lend(&self) -> Lent<'_> {
        Lent {
            meshes: self.meshes.iter().map(OwnedMesh::borrow).collect(),
            textures: self.textures.iter().map(OwnedTexture::borrow).collect(),
        }
    }

    /// The checked view that is rendered, over what [`Self::lend`] lends; an error names the shape as the file does.
    pub fn scene<'a>(&'a self, lent: &'a Lent<'a>) -> Result<Scene<'a>, QuantiseError> {
        let parts = Parts {
            unit: self.unit,
            shapes: &self.shapes,
            bounded: self.arrangement.bounded as u16,
            materials: &self.materials,
            lights: &self.lights,
            environment: match &self.background {
                Background::None => Environment::None,
                Background::Sky(sky) => Environment::Sky(sky),
                Background::Map(map) => {
                    Environment::Map(map.map().map_err(|error| QuantiseError::Unsupported {
                        name: "envmap".into(),
                        what: error.to_string(),
                    })?)
                }
            },
            choice: &self.choice,
            meshes: &lent.meshes,
            textures: &lent.textures,
            blobs: &self.blobs,
            grid: self.arrangement.grid,
            nodes: &self.nodes,
        };
        Scene::new(parts).map_err(
            |error| match error.shape().and_then(|id| self.names.get(id as usize)) {
                Some(name) => QuantiseError::Shape {
                    name: name.clone(),
                    error,
                },
                None => QuantiseError::Scene(error),
            },
        )
    }
}

/// Corners of a shape's bounding box; an infinite plane only has its point.
fn bounds(shape: &ShapeDesc) -> Vec<Vec3> {
    let around = |c: Vec3, r: Vec3| vec![[0, 1, 2].map(|i| c[i] - r[i]), [0, 1, 2].map(|i| c[i] + r[i])];
    match &shape.geometry {
        GeometryDesc::Sphere { center, radius } => around(*center, [*radius; 3]),
        GeometryDesc::Plane { point, .. } => vec![*point],
        GeometryDesc::Disk { center, radius, .. } => around(*center, [*radius; 3]),
        GeometryDesc::Rectangle { center, u, v } => {
            around(*center, [0, 1, 2].map(|i| u[i].abs() + v[i].abs()))
        }
        GeometryDesc::Mesh(mesh) => mesh.vertices.clone(),
        GeometryDesc::Instance(instance) => instance
            .mesh
            .vertices
            .iter()
            .map(|&v| instance.point(v))
            .collect(),
        GeometryDesc::Implicit(solid) => solid.bounds().to_vec(),
    }
}

/// Corners of the box around everything finite, metres; two metres about the origin if there is nothing.
pub fn bounds_of(desc: &SceneDesc) -> [Vec3; 2] {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for point in desc.shapes.iter().flat_map(bounds) {
        for i in 0..3 {
            low[i] = low[i].min(point[i]);
            high[i] = high[i].max(point[i]);
        }
    }
    if low[0] > high[0] {
        (low, high) = ([-1.0; 3], [1.0; 3]);
    }
    [low, high]
}

fn choose_unit(desc: &SceneDesc) -> (Vec3, Unit) {
    let [low, high] = bounds_of(desc);
    let origin = [0, 1, 2].map(|i| 0.5 * (low[i] + high[i]));
    let mut reach = (0..3).map(|i| high[i] - origin[i]).fold(0.0, f64::max);
    // The camera and point lights may stand twice as far out.
    let mut outside = |p: &Vec3| (0..3).for_each(|i| reach = reach.max((p[i] - origin[i]).abs() / 2.0));
    outside(&desc.camera.origin);
    for light in &desc.lights {
        if let LightDesc::Point { position, .. } = light {
            outside(position);
        }
    }
    let bits = (f64::from(REACH) * 0.999 / reach.max(1e-12)).log2().floor();
    (origin, Unit::new(bits as i32))
}

struct Rounding {
    origin: Vec3,
    /// Units a metre.
    scale: f64,
}

impl Rounding {
    fn length(&self, metres: f64) -> i32 {
        (metres * self.scale).round().clamp(-1e9, 1e9) as i32
    }

    fn point(&self, p: Vec3) -> Point {
        Point([0, 1, 2].map(|i| self.length(p[i] - self.origin[i])))
    }

    fn geometry(&self, shape: &ShapeDesc) -> Result<Geometry, QuantiseError> {
        let degenerate = || QuantiseError::Unsupported {
            name: shape.name.clone(),
            what: "has no extent".into(),
        };
        Ok(match &shape.geometry {
            GeometryDesc::Sphere { center, radius } => {
                Sphere::new(self.point(*center), self.length(*radius)).into()
            }
            GeometryDesc::Plane { point, normal } => Plane::new(self.point(*point), dir(*normal)).into(),
            GeometryDesc::Disk {
                center,
                normal,
                radius,
            } => Disk::new(self.point(*center), dir(*normal), self.length(*radius)).into(),
            GeometryDesc::Rectangle { center, u, v } => {
                let half = [self.length(norm(*u)), self.length(norm(*v))];
                Rectangle::new(self.point(*center), dir(*u), dir(*v), half)
                    .ok_or_else(degenerate)?
                    .into()
            }
            GeometryDesc::Mesh(_) | GeometryDesc::Instance(_) | GeometryDesc::Implicit(_) => {
                return Err(degenerate());
            }
        })
    }

    /// Into the finest cube around it; triangles that lose their area there are left out.
    fn mesh(&self, name: &str, mesh: &MeshDesc, tint: Option<&TintDesc>) -> Result<OwnedMesh, QuantiseError> {
        let error = |what: String| QuantiseError::Unsupported {
            name: name.to_string(),
            what,
        };
        let points: Vec<Point> = mesh.vertices.iter().map(|v| self.point(*v)).collect();
        let (low, high) = points
            .iter()
            .fold(([i32::MAX; 3], [i32::MIN; 3]), |(low, high), p| {
                (
                    [0, 1, 2].map(|i| low[i].min(p.0[i])),
                    [0, 1, 2].map(|i| high[i].max(p.0[i])),
                )
            });
        let grid = Grid::around(Point(low), Point(high), Grid::MARGIN);
        let grid = grid.ok_or_else(|| error("reaches too far, or has no vertices".into()))?;
        let step = f64::from(grid.shift()).exp2();
        let to_grid = |v: &Vec3| {
            [0, 1, 2].map(|i| {
                let units = (v[i] - self.origin[i]) * self.scale - f64::from(grid.origin().0[i]);
                (units / step)
                    .round()
                    .clamp(f64::from(Grid::MARGIN), f64::from(u16::MAX - Grid::MARGIN)) as u16
            })
        };
        let vertices: Vec<_> = mesh.vertices.iter().map(to_grid).collect();
        let said = Said {
            normals: normals(mesh),
            colors: match tint {
                Some(TintDesc::Vertices) => mesh.colors.iter().map(|color| color.map(signal)).collect(),
                _ => Vec::new(),
            },
            uvs: match tint {
                Some(TintDesc::Texture { to_uv, .. }) => uvs(mesh, to_uv).map_err(error)?,
                _ => Vec::new(),
            },
        };
        let after = vertices.iter().map(|&vertex| {
            let point = grid.to_scene(vertex).0;
            [0, 1, 2].map(|i| self.origin[i] + f64::from(point[i]) / self.scale)
        });
        let (displacement, extent) = moved(&mesh.vertices, after);
        let (vertices, said, places) = said.joined(&vertices);
        if vertices.len() > 1 << 16 {
            let count = vertices.len();
            return Err(error(format!(
                "has {count} vertices; a mesh can have 65536: split it"
            )));
        }
        let place = |i: u32| places[i as usize] as u16;
        let mut triangles: Vec<_> = mesh.triangles.iter().map(|t| t.map(place)).collect();
        let whole = Triangles::Plain(TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &triangles,
            attributes: Attributes::NONE,
        });
        let kept: Vec<bool> = (0..triangles.len())
            .map(|i| whole.normal(i as u32).is_some())
            .collect();
        let mut kept = kept.into_iter();
        triangles.retain(|_| kept.next().unwrap_or(false));
        if triangles.is_empty() {
            return Err(error("has no triangle with an area".into()));
        }
        let nodes = bake::build(&vertices, &mut triangles).map_err(|e| {
            error(format!(
                "needs {} nodes; a mesh can have 65536: split it",
                e.needed
            ))
        })?;
        Ok(OwnedMesh {
            name: name.to_string(),
            displacement,
            extent,
            grid,
            vertices,
            triangles,
            normals: said.normals,
            colors: said.colors,
            uvs: said.uvs,
            nodes,
        })
    }

    fn camera(&self, desc: &SceneDesc) -> Camera {
        let camera = &desc.camera;
        let frame = [dir(camera.right), dir(camera.up), dir(camera.forward)];
        let tan_half = I12F20::saturating_from_num((camera.fov_x.to_radians() / 2.0).tan());
        let pinhole = Camera::from_frame(self.point(camera.origin), frame, tan_half);
        match camera.lens {
            Some(lens) => pinhole.with_lens(
                self.length(lens.aperture_radius),
                self.length(lens.focus_distance),
            ),
            None => pinhole,
        }
    }
}

/// What vertices say beside their places: one of each, or none.
#[derive(Default)]
struct Said {
    normals: Vec<Octahedral>,
    colors: Vec<[u8; 3]>,
    uvs: Vec<[i16; 2]>,
}

impl Said {
    /// Vertices that are alike in everything become one; and for each of before which that is.
    fn joined(&self, vertices: &[[u16; 3]]) -> (Vec<[u16; 3]>, Said, Vec<usize>) {
        let (mut joined, mut said) = (Vec::new(), Said::default());
        let mut known = HashMap::new();
        let mut places = Vec::with_capacity(vertices.len());
        for (i, &vertex) in vertices.iter().enumerate() {
            let (normal, color, uv) = (self.normals.get(i), self.colors.get(i), self.uvs.get(i));
            places.push(*known.entry((vertex, normal, color, uv)).or_insert_with(|| {
                joined.push(vertex);
                said.normals.extend(normal);
                said.colors.extend(color);
                said.uvs.extend(uv);
                joined.len() - 1
            }));
        }
        (joined, said, places)
    }
}

/// The mesh that a shape is, or an instance of.
fn mesh_of(geometry: &GeometryDesc) -> Option<&MeshDesc> {
    match geometry {
        GeometryDesc::Mesh(mesh) => Some(mesh),
        GeometryDesc::Instance(instance) => Some(&instance.mesh),
        _ => None,
    }
}

fn signal(light: f64) -> u8 {
    (srgb(light) * 255.0).round() as u8
}

/// Places in a texture in steps of 2^-12, moved by whole turns so that they lie about 0.
fn uvs(mesh: &MeshDesc, to_uv: &[[f64; 3]; 2]) -> Result<Vec<[i16; 2]>, String> {
    let moved: Vec<[f64; 2]> = mesh
        .uvs
        .iter()
        .map(|[u, v]| to_uv.map(|row| row[0] * u + row[1] * v + row[2]))
        .collect();
    let turns = [0, 1].map(|i| {
        let along = moved.iter().map(|uv| uv[i]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| {
            (low.min(c), high.max(c))
        });
        ((low + high) / 2.0).floor()
    });
    let step = |uv: &[f64; 2]| {
        let steps = [0, 1].map(|i| ((uv[i] - turns[i]) * 4096.0).round());
        let fits = steps.iter().all(|c| (-32768.0..=32767.0).contains(c));
        fits.then(|| steps.map(|c| c as i16))
    };
    let steps: Option<Vec<_>> = moved.iter().map(step).collect();
    steps.ok_or_else(|| {
        "repeats its texture more than 16 times, or its uvs are not finite; split it, or scale them"
            .to_string()
    })
}

/// Largest and root mean square distance between two lists of points, and the longest side of the first.
fn moved(before: &[Vec3], after: impl Iterator<Item = Vec3>) -> ([f64; 2], f64) {
    let (mut worst, mut sum) = (0f64, 0.0);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (a, b) in before.iter().zip(after) {
        let square: f64 = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum();
        (worst, sum) = (worst.max(square), sum + square);
        low = [0, 1, 2].map(|i| low[i].min(a[i]));
        high = [0, 1, 2].map(|i| high[i].max(a[i]));
    }
    let extent = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let mean = sum / before.len().max(1) as f64;
    ([worst.sqrt(), mean.sqrt()], extent)
}

/// Smooth normals in two bytes each; none for a mesh whose vertices all have their faces' own, to half a degree.
fn normals(mesh: &MeshDesc) -> Vec<Octahedral> {
    const FLAT: f64 = 0.99996;
    let sub = |a: Vec3, b: Vec3| [0, 1, 2].map(|i| a[i] - b[i]);
    let dot = |a: Vec3, b: Vec3| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    let is_flat = |triangle: &[u32; 3]| {
        let corner = |i: usize| mesh.vertices[triangle[i] as usize];
        let (e, f) = (sub(corner(1), corner(0)), sub(corner(2), corner(0)));
        let face = [
            e[1] * f[2] - e[2] * f[1],
            e[2] * f[0] - e[0] * f[2],
            e[0] * f[1] - e[1] * f[0],
        ];
        let along = |&index: &u32| dot(mesh.normals[index as usize], face) >= FLAT * norm(face);
        triangle.iter().all(along)
    };
    if mesh.normals.is_empty() || mesh.triangles.iter().all(is_flat) {
        return Vec::new();
    }
    mesh.normals
        .iter()
        .map(|&normal| Octahedral::encode(dir(normal)))
        .collect()
}

fn norm(v: Vec3) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// A direction, each component rounded to 2^-16.
fn dir(v: Vec3) -> Dir {
    let length = norm(v);
    Dir(v.map(|c| (c / length * 65536.0).round() as i32))
}

fn albedo(color: Vec3) -> Albedo {
    Albedo(color.map(|c| Share::from_bits((c.clamp(0.0, 1.0) * 32768.0).round() as u16)))
}

/// To 16 bits of the largest channel, each channel rounded to nearest.
fn radiance(color: Vec3) -> Radiance {
    let largest = color.iter().fold(0.0, |a: f64, c| a.max(*c));
    if largest <= 0.0 {
        return Radiance::BLACK;
    }
    let exponent = largest.log2().floor() as i32 - 15;
    Radiance::from_bits(
        color.map(|c| (c.max(0.0) * f64::from(-exponent).exp2()).round() as u32),
        exponent,
    )
}
