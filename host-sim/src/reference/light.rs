//! Choosing a point on each light, and the density with which it is chosen.

use std::f64::consts::TAU;

use super::scene::{Geometry, Light, Scene};
use super::shape::Hit;
use super::sky::Sky;
use super::vec::{Rgb, Vec3};
use super::warp;

/// The scene's lights, ready to be sampled.
pub struct Lights {
    pub each: Vec<Emitter>,
    /// Radiance from where no shape is: all constant environments together.
    ///
    /// It is met by following the material's own directions, with weight 1 and no light samples: against a constant
    /// those have no variance but that of visibility, which a sample of the environment would share.
    constant: Rgb,
    /// For each shape, its place in `each`.
    of_shape: Vec<Option<usize>>,
}

pub enum Emitter {
    Point {
        position: Vec3,
        intensity: Rgb,
    },
    Directional {
        toward: Vec3,
        irradiance: Rgb,
    },
    Area(Area),
    Sky(Sky),
    /// A solid without a way to choose points of it: directions into its bounding sphere are chosen instead.
    Solid {
        shape: usize,
        center: Vec3,
        radius: f64,
        emission: Rgb,
    },
}

pub struct Area {
    geometry: Geometry,
    emission: Rgb,
    area: f64,
    /// For meshes: the share of the area up to and including each triangle.
    cumulative: Vec<f64>,
}

/// Light that would arrive along `wi` from `distance` away if nothing were between.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    pub wi: Vec3,
    pub from: From,
    /// Radiance over the density; for lights without extent, irradiance on a plane facing the light.
    pub weight: Rgb,
    /// Solid-angle density, or `None` for lights without extent, which no chosen direction would meet.
    pub pdf: Option<f64>,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug)]
pub enum From {
    /// A point this far away; infinity for the sky.
    Distance(f64),
    /// The front of this shape, if that is what the direction meets first.
    Shape(usize),
}

impl Lights {
    pub fn new(scene: &Scene) -> Lights {
        let mut lights = Lights {
            each: Vec::new(),
            constant: Rgb::ZERO,
            of_shape: vec![None; scene.shapes.len()],
        };
        for light in &scene.lights {
            match *light {
                Light::Point { position, intensity } => {
                    lights.each.push(Emitter::Point { position, intensity });
                }
                Light::Directional {
                    direction,
                    irradiance,
                } => {
                    lights.each.push(Emitter::Directional {
                        toward: -direction.normalized(),
                        irradiance,
                    });
                }
                Light::Constant { radiance } => lights.constant += radiance,
                Light::Gradient(sky) => lights.sky(Sky::gradient(sky)),
                Light::Sun(sun) => lights.sky(Sky::sun(sun)),
                Light::Map(ref map) => lights.sky(Sky::map(map.clone())),
            }
        }
        for (index, shape) in scene.shapes.iter().enumerate() {
            let Some(emission) = shape.emission else {
                continue;
            };
            let emitter = match &shape.geometry {
                Geometry::Implicit(solid) => {
                    let (center, radius) = solid.ball();
                    Some(Emitter::Solid {
                        shape: index,
                        center,
                        radius,
                        emission,
                    })
                }
                geometry => Area::new(geometry, emission).map(Emitter::Area),
            };
            if let Some(emitter) = emitter {
                lights.of_shape[index] = Some(lights.each.len());
                lights.each.push(emitter);
            }
        }
        lights
    }

    fn sky(&mut self, sky: Option<Sky>) {
        self.each.extend(sky.map(Emitter::Sky));
    }

    /// Radiance from beyond all shapes along a unit direction, each part of it weighted by `weight` of the solid-angle density
    /// with which a light sample would have chosen that direction: 0 for what has no light samples.
    pub fn background(&self, direction: Vec3, weight: impl Fn(f64) -> f64) -> Rgb {
        let mut sum = self.constant * weight(0.0);
        for emitter in &self.each {
            if let Emitter::Sky(sky) = emitter {
                sum += sky.radiance(direction) * weight(sky.pdf(direction));
            }
        }
        sum
    }

    /// Solid-angle density, seen from `point`, with which `Emitter::sample` would have chosen `hit`; 0 if it could not.
    pub fn pdf(&self, point: Vec3, hit: &Hit) -> f64 {
        match self.of_shape[hit.shape].map(|index| &self.each[index]) {
            Some(Emitter::Area(area)) => area.pdf(point, hit.point, hit.normal),
            Some(&Emitter::Solid { center, radius, .. }) => {
                1.0 / (TAU * cone_or_sphere(point, center, radius))
            }
            _ => 0.0,
        }
    }
}

impl Emitter {
    /// `None` if nothing arrives at `point` from the place that `u` chooses.
    pub fn sample(&self, point: Vec3, u: [f64; 2]) -> Option<Arrival> {
        match *self {
            Emitter::Point { position, intensity } => {
                let to_light = position - point;
                let d2 = to_light.length_squared();
                let weight = intensity / d2;
                (d2 > 0.0).then(|| Arrival {
                    wi: to_light.normalized(),
                    from: From::Distance(d2.sqrt()),
                    weight,
                    pdf: None,
                })
            }
            Emitter::Directional { toward, irradiance } => Some(Arrival {
                wi: toward,
                from: From::Distance(f64::INFINITY),
                weight: irradiance,
                pdf: None,
            }),
            Emitter::Area(ref area) => {
                let (on_light, normal) = area.choose(point, u)?;
                let pdf = area.pdf(point, on_light, normal);
                let to_light = on_light - point;
                let weight = area.emission / pdf;
                (pdf > 0.0).then(|| Arrival {
                    wi: to_light.normalized(),
                    from: From::Distance(to_light.length()),
                    weight,
                    pdf: Some(pdf),
                })
            }
            Emitter::Sky(ref sky) => {
                let wi = sky.sample(u);
                let pdf = sky.pdf(wi);
                (pdf > 0.0).then(|| Arrival {
                    wi,
                    from: From::Distance(f64::INFINITY),
                    weight: sky.radiance(wi) / pdf,
                    pdf: Some(pdf),
                })
            }
            Emitter::Solid {
                shape,
                center,
                radius,
                emission,
            } => {
                let one_minus_cos = cone_or_sphere(point, center, radius);
                let axis = if center == point {
                    Vec3::ONE
                } else {
                    center - point
                };
                let wi = axis.normalized().frame_to_world(warp::cone(u, one_minus_cos));
                let pdf = 1.0 / (TAU * one_minus_cos);
                Some(Arrival {
                    wi,
                    from: From::Shape(shape),
                    weight: emission / pdf,
                    pdf: Some(pdf),
                })
            }
        }
    }
}

impl Area {
    fn new(geometry: &Geometry, emission: Rgb) -> Option<Area> {
        let mut cumulative = Vec::new();
        let area = match *geometry {
            Geometry::Plane { .. } | Geometry::Implicit(_) => return None,
            Geometry::Sphere { radius, .. } => 2.0 * TAU * radius * radius,
            Geometry::Disk { radius, .. } => TAU / 2.0 * radius * radius,
            Geometry::Rectangle { u, v, .. } => 4.0 * u.cross(v).length(),
            Geometry::Mesh(ref mesh) => {
                let mut sum = 0.0;
                for triangle in 0..mesh.triangles().len() as u32 {
                    sum += mesh.double_area_normal(triangle).length() / 2.0;
                    cumulative.push(sum);
                }
                cumulative.iter_mut().for_each(|share| *share /= sum);
                sum
            }
        };
        (area > 0.0).then(|| Area {
            geometry: geometry.clone(),
            emission,
            area,
            cumulative,
        })
    }

    /// A point of the surface and its unit normal there.
    fn choose(&self, point: Vec3, u: [f64; 2]) -> Option<(Vec3, Vec3)> {
        match self.geometry {
            Geometry::Sphere { center, radius } => choose_on_sphere(point, center, radius, u),
            Geometry::Disk {
                center,
                normal,
                radius,
            } => {
                let normal = normal.normalized();
                let [x, y] = warp::disk(u).map(|c| c * radius);
                Some((center + normal.frame_to_world(Vec3 { x, y, z: 0.0 }), normal))
            }
            Geometry::Rectangle {
                center,
                u: half_u,
                v: half_v,
            } => {
                let on_light = center + half_u * (2.0 * u[0] - 1.0) + half_v * (2.0 * u[1] - 1.0);
                Some((on_light, half_u.cross(half_v).normalized()))
            }
            Geometry::Mesh(ref mesh) => {
                let index = self
                    .cumulative
                    .partition_point(|&share| share <= u[0])
                    .min(self.cumulative.len() - 1);
                let before = if index == 0 {
                    0.0
                } else {
                    self.cumulative[index - 1]
                };
                let within = ((u[0] - before) / (self.cumulative[index] - before)).clamp(0.0, 1.0);
                let [a, b, c] = mesh.corners(index as u32);
                let [i, j, k] = warp::triangle([within, u[1]]);
                Some((
                    a * i + b * j + c * k,
                    mesh.double_area_normal(index as u32).normalized(),
                ))
            }
            Geometry::Plane { .. } | Geometry::Implicit(_) => None,
        }
    }

    /// Solid-angle density at `point` of choosing `on_light`, whose unit normal is `normal`; 0 seen from behind.
    fn pdf(&self, point: Vec3, on_light: Vec3, normal: Vec3) -> f64 {
        let from_light = point - on_light;
        let cos_distance = from_light.dot(normal);
        if cos_distance <= 0.0 {
            return 0.0;
        }
        match self.geometry {
            Geometry::Sphere { center, radius } => match cone_around(point, center, radius) {
                Some(one_minus_cos) => 1.0 / (TAU * one_minus_cos),
                None => 0.0,
            },
            // Area to solid angle: r² / (cosθ A).
            _ => from_light.length_squared() * from_light.length() / (cos_distance * self.area),
        }
    }
}

/// One minus the cosine of the half angle under which a sphere is seen; `None` from inside, whence it is dark.
fn cone_around(point: Vec3, center: Vec3, radius: f64) -> Option<f64> {
    let sin2 = radius * radius / (center - point).length_squared();
    (sin2 < 1.0).then(|| sin2 / (1.0 + (1.0 - sin2).sqrt()))
}

/// The same from anywhere: all directions from inside.
fn cone_or_sphere(point: Vec3, center: Vec3, radius: f64) -> f64 {
    cone_around(point, center, radius).unwrap_or(2.0)
}

/// Uniform in the solid angle of the sphere (Shirley, Wang and Zimmerman, "Monte Carlo Techniques for Direct Lighting
/// Calculations", 1996), and then the nearer point of the sphere in that direction.
fn choose_on_sphere(point: Vec3, center: Vec3, radius: f64, u: [f64; 2]) -> Option<(Vec3, Vec3)> {
    let one_minus_cos = cone_around(point, center, radius)?;
    let to_center = center - point;
    let distance = to_center.length();
    let local = warp::cone(u, one_minus_cos);
    let direction = (to_center / distance).frame_to_world(local);
    let miss2 = distance * distance * (local.x * local.x + local.y * local.y);
    let t = distance * local.z - (radius * radius - miss2).max(0.0).sqrt();
    let normal = (point + direction * t - center).normalized();
    Some((center + normal * radius, normal))
}
