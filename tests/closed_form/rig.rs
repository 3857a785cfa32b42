//! A scene on the bench, a camera, and the comparison.

use fixed::types::I12F20;
use microlux::bvh::{Node, build_mesh, max_nodes};
use microlux::camera::Camera;
use microlux::color::{Albedo, Radiance};
use microlux::film::Exposure;
use microlux::geom::{Dir, Point, Unit};
use microlux::integrator::{Bdpt, Integrator, LightTracer, Path};
use microlux::light::{Environment, Light, Map, Sky};
use microlux::material::Material;
use microlux::num::Share;
use microlux::render::{Renderer, Settings};
use microlux::sampler::{AnySampler, Independent, Sobol, Stratified};
use microlux::scene::{Borrowed, MaterialId, Mesh, Scene, SceneBuilder};
use microlux::shape::{Attributes, Disk, Geometry, Grid, Plane, Rectangle, Sphere, TriangleMesh};

pub type Vec3 = [f64; 3];

/// Reflectances and radiances that differ by channel: rounding depends on the largest of three.
pub const RHO: Vec3 = [0.2, 0.5, 0.9];
pub const LIGHT: Vec3 = [4.0, 2.5, 1.0];

/// How far a mean may be from the answer, as a share of it.
const TOLERANCE: f64 = 0.0025;

pub fn map2(a: Vec3, b: Vec3, f: impl Fn(f64, f64) -> f64) -> Vec3 {
    [0, 1, 2].map(|i| f(a[i], b[i]))
}

pub fn dot(a: Vec3, b: Vec3) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// 1 + ρ + ... + ρ^(terms − 1).
pub fn geometric(rho: f64, terms: u32) -> f64 {
    (0..terms).map(|k| rho.powi(k as i32)).sum()
}

pub fn dir(v: Vec3) -> Dir {
    Dir(v.map(|c| (c / norm(v) * 65536.0).round() as i32))
}

pub fn albedo(rho: Vec3) -> Albedo {
    Albedo(rho.map(|c| Share::from_bits((c * 32768.0).round() as u16)))
}

/// A reflectance as the scene holds it.
pub fn rounded(rho: Vec3) -> Vec3 {
    albedo(rho).0.map(|share| share.to_bits() as f64 / 32768.0)
}

/// Exact for the radiances used here.
pub fn radiance(color: Vec3) -> Radiance {
    Radiance::from_bits(color.map(|c| (c * 65536.0).round() as u32), -16)
}

/// The nearest there is, of any magnitude.
pub fn radiance_of(color: Vec3) -> Radiance {
    let exponent = color.into_iter().fold(0.0, f64::max).log2().floor() as i32 - 30;
    Radiance::from_bits(color.map(|c| (c * 2f64.powi(-exponent)).round() as u32), exponent)
}

pub fn to_f64(radiance: Radiance) -> Vec3 {
    let (mantissa, exponent) = radiance.to_parts();
    mantissa.map(|m| m as f64 * 2f64.powi(exponent as i32 - 15))
}

/// A pinhole, and the half width of its square picture at distance 1.
#[derive(Clone, Copy)]
pub struct View {
    pub eye: Vec3,
    pub target: Vec3,
    pub half_width: f64,
    /// Pixels a side, and samples each.
    pub side: u16,
    pub spp: u32,
}

impl View {
    /// So narrow that a picture shows one place.
    pub fn at(eye: Vec3, target: Vec3) -> View {
        View {
            eye,
            target,
            half_width: 0.002,
            side: 16,
            spp: 64,
        }
    }

    pub fn wide(self, half_width: f64) -> View {
        View { half_width, ..self }
    }

    pub fn effort(self, side: u16, spp: u32) -> View {
        View { side, spp, ..self }
    }
}

#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Independent,
    Stratified,
    Sobol,
}

/// The two that are meant for pictures.
pub const PATTERNED: [Kind; 2] = [Kind::Stratified, Kind::Sobol];
pub const ALL: [Kind; 3] = [Kind::Independent, Kind::Stratified, Kind::Sobol];

impl Kind {
    fn sampler(self, spp: u32) -> AnySampler {
        match self {
            Kind::Independent => Independent::new(3).into(),
            Kind::Stratified => Stratified::new(3, spp).into(),
            Kind::Sobol => Sobol::new(3).into(),
        }
    }
}

struct OwnedMesh {
    grid: Grid,
    vertices: Vec<[u16; 3]>,
    triangles: Vec<[u16; 3]>,
    nodes: Vec<Node>,
}

/// A scene under construction, in metres.
pub struct Stage<'a> {
    unit: Unit,
    builder: SceneBuilder<8, 4, 8>,
    meshes: Vec<OwnedMesh>,
    sky: Option<Sky>,
    map: Option<Map<'a>>,
}

impl<'a> Stage<'a> {
    pub fn new() -> Stage<'a> {
        Stage::with_unit(Unit::DEFAULT)
    }

    pub fn with_unit(unit: Unit) -> Stage<'a> {
        Stage {
            unit,
            builder: SceneBuilder::with_unit(unit),
            meshes: Vec::new(),
            sky: None,
            map: None,
        }
    }

    pub fn length(&self, metres: f64) -> i32 {
        (metres * 2f64.powi(self.unit.fraction_bits())).round() as i32
    }

    pub fn point(&self, p: Vec3) -> Point {
        Point(p.map(|c| self.length(c)))
    }

    /// A length as the scene holds it, metres.
    pub fn held(&self, metres: f64) -> f64 {
        self.length(metres) as f64 / 2f64.powi(self.unit.fraction_bits())
    }

    pub fn material(&mut self, material: Material) -> MaterialId {
        self.builder.material(material).unwrap()
    }

    pub fn matt(&mut self, rho: Vec3) -> MaterialId {
        self.material(Material::lambert(albedo(rho)))
    }

    pub fn black(&mut self) -> MaterialId {
        self.material(Material::Black)
    }

    pub fn sphere(&self, center: Vec3, radius: f64) -> Geometry {
        Sphere::new(self.point(center), self.length(radius)).into()
    }

    pub fn plane(&self, point: Vec3, normal: Vec3) -> Geometry {
        Plane::new(self.point(point), dir(normal)).into()
    }

    pub fn disk(&self, center: Vec3, normal: Vec3, radius: f64) -> Geometry {
        Disk::new(self.point(center), dir(normal), self.length(radius)).into()
    }

    /// `center ± u ± v`.
    pub fn rectangle(&self, center: Vec3, u: Vec3, v: Vec3) -> Geometry {
        let half = [self.length(norm(u)), self.length(norm(v))];
        Rectangle::new(self.point(center), dir(u), dir(v), half)
            .unwrap()
            .into()
    }

    /// Triangles by index, in the finest grid that holds them.
    pub fn mesh(&mut self, vertices: &[Vec3], triangles: &[[u16; 3]]) -> Geometry {
        let points: Vec<Point> = vertices.iter().map(|v| self.point(*v)).collect();
        let fold = |f: fn(i32, i32) -> i32| {
            Point([0, 1, 2].map(|a| points.iter().map(|p| p.0[a]).reduce(f).unwrap()))
        };
        let grid = Grid::around(fold(i32::min), fold(i32::max), Grid::MARGIN).unwrap();
        let half = (1 << grid.shift()) >> 1;
        let step =
            |p: &Point| [0, 1, 2].map(|a| ((p.0[a] - grid.origin().0[a] + half) >> grid.shift()) as u16);
        let vertices: Vec<_> = points.iter().map(step).collect();
        let mut triangles = triangles.to_vec();
        let mut nodes = vec![Node::EMPTY; max_nodes(triangles.len())];
        let used = build_mesh(&vertices, &mut triangles, &mut nodes).unwrap();
        nodes.truncate(used);
        self.meshes.push(OwnedMesh {
            grid,
            vertices,
            triangles,
            nodes,
        });
        Geometry::Mesh(self.meshes.len() as u16 - 1)
    }

    pub fn shape(&mut self, geometry: Geometry, material: MaterialId) {
        self.builder.shape(geometry, material).unwrap();
    }

    pub fn emitter(&mut self, geometry: Geometry, material: MaterialId, emission: Vec3) {
        self.builder
            .emitter(geometry, material, radiance(emission))
            .unwrap();
    }

    pub fn light(&mut self, light: Light) {
        self.builder.light(light).unwrap();
    }

    pub fn sky(&mut self, sky: Sky) {
        self.sky = Some(sky);
    }

    pub fn map(&mut self, map: Map<'a>) {
        self.map = Some(map);
    }

    pub fn environment(&mut self, emission: Vec3) {
        self.light(Light::Environment {
            radiance: radiance(emission),
        });
    }

    /// The mean radiance of the view, by each integrator and sampler.
    fn means(&mut self, view: View, ways: &[Way], samplers: &[Kind]) -> Vec<(Way, Kind, Vec3)> {
        let meshes: Vec<Mesh> = self
            .meshes
            .iter()
            .map(|mesh| Mesh {
                triangles: TriangleMesh {
                    grid: mesh.grid,
                    vertices: &mesh.vertices,
                    triangles: &mesh.triangles,
                    attributes: Attributes::NONE,
                }
                .into(),
                nodes: &mesh.nodes,
            })
            .collect();
        let scale = 2f64.powi(self.unit.fraction_bits());
        let point = |p: Vec3| Point(p.map(|c| (c * scale).round() as i32));
        let tan_half = I12F20::from_num(view.half_width);
        // Up is none of the axes, so that pictures stand askew.
        let camera = Camera::look_at(point(view.eye), point(view.target), [3, 40, 11], tan_half).unwrap();
        let settings = Settings {
            width: view.side,
            height: view.side,
            spp: view.spp,
        };
        let mut nodes = [Node::EMPTY; max_nodes(8)];
        let environment = match (&self.sky, &self.map) {
            (Some(sky), _) => Environment::Sky(sky),
            (_, Some(map)) => Environment::Map(*map),
            _ => Environment::None,
        };
        let borrowed = Borrowed {
            meshes: &meshes,
            environment,
            ..Borrowed::default()
        };
        let scene = self.builder.build_from(borrowed, &mut nodes).unwrap();
        let mut means = Vec::new();
        for way in ways {
            for kind in samplers {
                let mean = way.mean(&scene, camera, kind.sampler(view.spp), settings);
                means.push((*way, *kind, mean));
            }
        }
        means
    }

    /// Asserts that the view's mean radiance is `exact(path)` by path tracing and by bidirectional path tracing, in tiles
    /// and in a frame, for each sampler.
    pub fn assert(
        &mut self,
        name: &str,
        view: View,
        paths: &[Path],
        samplers: &[Kind],
        exact: impl Fn(&Path) -> Vec3,
    ) {
        let ways = |path: &Path| [Way::Path(*path), Way::Tiles(*path), Way::Frame(*path)];
        let ways: Vec<Way> = paths.iter().flat_map(ways).collect();
        self.assert_ways(name, view, &ways, samplers, exact);
    }

    /// The same of light tracing.
    pub fn assert_light(
        &mut self,
        name: &str,
        view: View,
        paths: &[Path],
        samplers: &[Kind],
        exact: impl Fn(&Path) -> Vec3,
    ) {
        let ways: Vec<Way> = paths.iter().map(|path| Way::Light(*path)).collect();
        self.assert_ways(name, view, &ways, samplers, exact);
    }

    fn assert_ways(
        &mut self,
        name: &str,
        view: View,
        ways: &[Way],
        samplers: &[Kind],
        exact: impl Fn(&Path) -> Vec3,
    ) {
        for (way, kind, mean) in self.means(view, ways, samplers) {
            let exact = exact(way.path());
            let error = map2(
                mean,
                exact,
                |mean, exact| {
                    if exact == 0.0 { mean } else { mean / exact - 1.0 }
                },
            );
            let percent = error.map(|e| format!("{:+.4}", 100.0 * e)).join(" ");
            println!("{name}, {way:?}, {kind:?}: {percent} %");
            assert!(
                error.iter().all(|e| e.abs() <= TOLERANCE),
                "{name}, {way:?}, {kind:?}: {mean:?} is not {exact:?}: {percent} %"
            );
        }
    }
}

/// An integrator with the limits of a path's.
#[derive(Clone, Copy, Debug)]
pub enum Way {
    Path(Path),
    /// Bidirectional, without splats.
    Tiles(Path),
    /// Bidirectional, with them.
    Frame(Path),
    Light(Path),
}

impl Way {
    fn path(&self) -> &Path {
        match self {
            Way::Path(path) | Way::Tiles(path) | Way::Frame(path) | Way::Light(path) => path,
        }
    }

    fn mean(&self, scene: &Scene, camera: Camera, sampler: AnySampler, settings: Settings) -> Vec3 {
        let Path {
            max_depth,
            rr_depth,
            hide_emitters,
        } = *self.path();
        let bdpt: Bdpt = Bdpt {
            max_depth,
            rr_depth,
            hide_emitters,
        };
        let light = LightTracer {
            max_depth,
            rr_depth,
            hide_emitters,
        };
        match self {
            Way::Path(path) => in_a_tile(Renderer::new(scene, camera, *path, sampler, settings)),
            Way::Tiles(_) => in_a_tile(Renderer::new(scene, camera, bdpt, sampler, settings)),
            Way::Frame(_) => in_a_frame(Renderer::new(scene, camera, bdpt, sampler, settings)),
            Way::Light(_) => in_a_frame(Renderer::new(scene, camera, light, sampler, settings)),
        }
    }
}

fn mean(pixels: &[Radiance]) -> Vec3 {
    let sum = pixels
        .iter()
        .fold([0.0; 3], |sum, pixel| map2(sum, to_f64(*pixel), |a, b| a + b));
    sum.map(|c| c / pixels.len() as f64)
}

fn in_a_tile<I: Integrator>(mut renderer: Renderer<AnySampler, I>) -> Vec3 {
    let Settings { width, height, .. } = renderer.settings();
    let mut strip = vec![Radiance::BLACK; width as usize * height as usize];
    mean(renderer.step(&mut strip).unwrap().pixels)
}

fn in_a_frame<I: Integrator>(mut renderer: Renderer<AnySampler, I>) -> Vec3 {
    let Settings { width, height, spp } = renderer.settings();
    let count = width as usize * height as usize;
    let (mut sums, mut strip) = (vec![[0; 3]; count], vec![Radiance::BLACK; count]);
    let mut frame = Exposure::new(width, height, &mut sums).unwrap();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        renderer.expose(x, y, &mut frame);
    }
    mean(frame.rows(0, spp, &mut strip).unwrap().pixels)
}
