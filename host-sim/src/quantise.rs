//! A scene as the files say it, rounded into the core's integers: the one place where floats become fixed point.

use crate::desc::{BsdfDesc, GeometryDesc, LightDesc, SceneDesc, ShapeDesc, Vec3};
use fixed::types::I12F20;
use microlux::camera::Camera;
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Dir, Point, REACH, Unit};
use microlux::light::Light;
use microlux::material::{Dielectric, Material};
use microlux::num::{Metres, Share};
use microlux::scene::{Parts, Scene, SceneError, Shape};
use microlux::shape::{Disk, Geometry, Plane, Rectangle, Sphere};
use thiserror::Error;

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
    names: Vec<String>,
}

impl CoreScene {
    /// Chooses the finest unit in which the scene fits, with the middle of the scene as origin, and rounds.
    pub fn new(desc: &SceneDesc) -> Result<CoreScene, QuantiseError> {
        let (origin, unit) = choose_unit(desc);
        let round = Rounding { origin, scale: f64::from(unit.fraction_bits()).exp2() };
        let materials = desc.materials.iter().map(|m| material(&m.name, m.two_sided, &m.bsdf));
        let materials = materials.collect::<Result<Vec<_>, _>>()?;
        let mut shapes = Vec::new();
        let mut lights = Vec::new();
        for (index, shape) in desc.shapes.iter().enumerate() {
            let light = shape.emission.map(|emission| {
                lights.push(Light::Area { shape: index as u16, radiance: radiance(emission) });
                (lights.len() - 1) as u16
            });
            let geometry = round.geometry(shape)?;
            shapes.push(Shape { geometry, material: shape.material as u16, light, id: index as u16 });
        }
        let mut environment = None;
        for light in &desc.lights {
            match light {
                LightDesc::Point { position, intensity } => {
                    lights.push(Light::Point { position: round.point(*position), intensity: radiance(*intensity) });
                }
                LightDesc::Directional { direction, irradiance } => {
                    lights.push(Light::Directional { direction: dir(*direction), irradiance: radiance(*irradiance) });
                }
                LightDesc::Constant { radiance: r } => {
                    environment = Some(Light::Environment { radiance: radiance(*r) });
                }
                LightDesc::EnvMap { .. } => {
                    let what = "the fixed-point core has no environment maps yet; use a constant one".to_string();
                    return Err(QuantiseError::Unsupported { name: "envmap".into(), what });
                }
            }
        }
        lights.extend(environment);
        let names = desc.shapes.iter().map(|shape| shape.name.clone()).collect();
        Ok(CoreScene { unit, origin, camera: round.camera(desc), shapes, materials, lights, names })
    }

    /// The checked view that is rendered; an error names the shape as the file does.
    pub fn scene(&self) -> Result<Scene<'_>, QuantiseError> {
        let parts = Parts {
            unit: self.unit,
            shapes: &self.shapes,
            materials: &self.materials,
            lights: &self.lights,
        };
        Scene::new(parts).map_err(|error| match error.shape().and_then(|id| self.names.get(id as usize)) {
            Some(name) => QuantiseError::Shape { name: name.clone(), error },
            None => QuantiseError::Scene(error),
        })
    }
}

/// Corners of a shape's bounding box; an infinite plane only has its point.
fn bounds(shape: &ShapeDesc) -> Vec<Vec3> {
    let around = |c: Vec3, r: Vec3| vec![[0, 1, 2].map(|i| c[i] - r[i]), [0, 1, 2].map(|i| c[i] + r[i])];
    match &shape.geometry {
        GeometryDesc::Sphere { center, radius } => around(*center, [*radius; 3]),
        GeometryDesc::Plane { point, .. } => vec![*point],
        GeometryDesc::Disk { center, radius, .. } => around(*center, [*radius; 3]),
        GeometryDesc::Rectangle { center, u, v } => around(*center, [0, 1, 2].map(|i| u[i].abs() + v[i].abs())),
        GeometryDesc::Mesh(mesh) => mesh.vertices.clone(),
    }
}

fn choose_unit(desc: &SceneDesc) -> (Vec3, Unit) {
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
        let degenerate = || QuantiseError::Unsupported { name: shape.name.clone(), what: "has no extent".into() };
        Ok(match &shape.geometry {
            GeometryDesc::Sphere { center, radius } => {
                Sphere::new(self.point(*center), self.length(*radius)).into()
            }
            GeometryDesc::Plane { point, normal } => Plane::new(self.point(*point), dir(*normal)).into(),
            GeometryDesc::Disk { center, normal, radius } => {
                Disk::new(self.point(*center), dir(*normal), self.length(*radius)).into()
            }
            GeometryDesc::Rectangle { center, u, v } => {
                let half = [self.length(norm(*u)), self.length(norm(*v))];
                Rectangle::new(self.point(*center), dir(*u), dir(*v), half).ok_or_else(degenerate)?.into()
            }
            GeometryDesc::Mesh(_) => return Err(degenerate()),
        })
    }

    fn camera(&self, desc: &SceneDesc) -> Camera {
        let camera = &desc.camera;
        let frame = [dir(camera.right), dir(camera.up), dir(camera.forward)];
        let tan_half = I12F20::saturating_from_num((camera.fov_x.to_radians() / 2.0).tan());
        let pinhole = Camera::from_frame(self.point(camera.origin), frame, tan_half);
        match camera.lens {
            Some(lens) => pinhole.with_lens(self.length(lens.aperture_radius), self.length(lens.focus_distance)),
            None => pinhole,
        }
    }
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
    Radiance::from_bits(color.map(|c| (c.max(0.0) * f64::from(-exponent).exp2()).round() as u32), exponent)
}

fn material(name: &str, two_sided: bool, bsdf: &BsdfDesc) -> Result<Material, QuantiseError> {
    Ok(match bsdf {
        BsdfDesc::Diffuse { reflectance } => Material::Lambert { albedo: albedo(*reflectance), two_sided },
        BsdfDesc::Conductor { specular_reflectance, eta_k: None } => {
            Material::Mirror { reflectance: albedo(*specular_reflectance), two_sided }
        }
        BsdfDesc::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
            Material::Dielectric(
                Dielectric::new(Metres::saturating_from_num(int_ior / ext_ior))
                    .tinted(albedo(*specular_reflectance), albedo(*specular_transmittance)),
            )
        }
        other => {
            let kind = format!("{other:?}");
            let kind = kind.split([' ', '{']).next().unwrap_or_default().to_lowercase();
            let what = format!("the fixed-point core has no {kind} yet; use diffuse, dielectric or a mirror");
            return Err(QuantiseError::Unsupported { name: name.to_string(), what });
        }
    })
}
