//! The scene as plain data: f64, metres, radiance in W·sr⁻¹·m⁻² per linear sRGB channel.
//!
//! Right-handed. What the words mean is Mitsuba 3's; each type says it where it matters.

use std::sync::Arc;

use super::implicit::Implicit;
use super::mesh::Mesh;
use super::sky::{Gradient, Map, Sun};
use super::texture::Tint;
use super::vec::{Rgb, Vec3, vec3};

#[derive(Clone, Debug)]
pub struct Scene {
    pub camera: Camera,
    pub shapes: Vec<Shape>,
    pub materials: Vec<Material>,
    /// The lights that are not shapes; a shape is a light if it has an `emission`.
    pub lights: Vec<Light>,
}

/// A perspective camera. `right`, `up` and `forward` are orthonormal; `right` and `up` point so in the picture.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    pub origin: Vec3,
    pub right: Vec3,
    pub up: Vec3,
    pub forward: Vec3,
    /// Horizontal field of view over the full picture width, in degrees, above 0 and below 180.
    pub fov_x: f64,
    /// `None`: a pinhole.
    pub lens: Option<Lens>,
}

/// A thin lens: what lies in the plane `focus_distance` ahead, measured along `forward`, is sharp.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    pub aperture_radius: f64,
    pub focus_distance: f64,
}

#[derive(Clone, Debug)]
pub struct Shape {
    pub geometry: Geometry,
    /// Index into `Scene::materials`.
    pub material: usize,
    /// Radiance emitted on the side of the geometric normal, none on the other.
    pub emission: Option<Rgb>,
    /// Of a mesh.
    pub tint: Option<Tint>,
    /// The caller's name for it; the renderer hands it back and makes no use of it.
    pub id: u32,
}

/// Normals may have any length but zero.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// The normal points outwards.
    Sphere {
        center: Vec3,
        radius: f64,
    },
    /// Unbounded. An emitting plane lights only what a sampled direction finds: it has no area to choose points from.
    Plane {
        point: Vec3,
        normal: Vec3,
    },
    Disk {
        center: Vec3,
        normal: Vec3,
        radius: f64,
    },
    /// `center ± u ± v` with `u ⊥ v`; the normal is along `u × v`.
    Rectangle {
        center: Vec3,
        u: Vec3,
        v: Vec3,
    },
    Mesh(Arc<Mesh>),
    Implicit(Arc<Implicit>),
}

#[derive(Clone, Copy, Debug)]
pub enum Material {
    /// Lambert: reflectance/π. One-sided: black seen from behind.
    Diffuse { reflectance: Rgb, two_sided: bool },
    /// Perfect mirror without Fresnel. One-sided: black seen from behind.
    Mirror { reflectance: Rgb, two_sided: bool },
    /// Smooth metal of index `eta` + i `k` relative to what is before it. One-sided: black seen from behind.
    Conductor {
        reflectance: Rgb,
        eta: Rgb,
        k: Rgb,
        two_sided: bool,
    },
    /// Metal of GGX facets; `eta_k` none for facets that are perfect mirrors. One-sided: black seen from behind.
    RoughConductor {
        alpha: f64,
        reflectance: Rgb,
        eta_k: Option<(Rgb, Rgb)>,
        two_sided: bool,
    },
    /// Smooth boundary; `eta` is the index of refraction behind the normal over the one before it.
    Dielectric {
        eta: f64,
        specular_reflectance: Rgb,
        specular_transmittance: Rgb,
    },
    /// Boundary of GGX facets; `eta` as above, other than 1.
    RoughDielectric {
        alpha: f64,
        eta: f64,
        specular_reflectance: Rgb,
        specular_transmittance: Rgb,
    },
    /// Rough diffuse; `sigma` is the standard deviation of the facets' slope angle in radians, 0 to π/2. One-sided: black seen
    /// from behind.
    OrenNayar {
        reflectance: Rgb,
        sigma: f64,
        model: OrenNayarModel,
        two_sided: bool,
    },
    /// With kd, ks, n the fields in turn and H the half vector: f = kd/π + ks (n+8)/(8π) (N·H)ⁿ where `normalized`, else
    /// f cosθi = kd/π cosθi + ks/π (N·H)ⁿ. One-sided: black seen from behind.
    BlinnPhong {
        diffuse: Rgb,
        specular: Rgb,
        exponent: f64,
        normalized: bool,
        two_sided: bool,
    },
    /// Reflects nothing: for shapes that only emit.
    Black,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrenNayarModel {
    /// The 1994 paper's, with its interreflection term.
    Full,
    /// Its section 4.4.
    Qualitative,
    /// EON (2025), of roughness `sigma` / (π/2).
    EnergyPreserving,
}

#[derive(Clone, Debug)]
pub enum Light {
    /// Radiant intensity, W·sr⁻¹.
    Point {
        position: Vec3,
        intensity: Rgb,
    },
    /// `direction` in which the light travels, of any length but zero; irradiance on a plane facing it, W·m⁻².
    Directional {
        direction: Vec3,
        irradiance: Rgb,
    },
    /// The same radiance from everywhere. All that surrounds the scene adds up.
    Constant {
        radiance: Rgb,
    },
    Gradient(Gradient),
    Sun(Sun),
    Map(Arc<Map>),
}

/// A half-line; `direction` has length one.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: Vec3,
    pub direction: Vec3,
}

impl Ray {
    pub fn at(&self, t: f64) -> Vec3 {
        self.origin + self.direction * t
    }
}

impl Camera {
    /// A pinhole at `origin` that looks at `target`; `up` need not be perpendicular to the view, nor of length one.
    pub fn look_at(origin: Vec3, target: Vec3, up: Vec3, fov_x: f64) -> Camera {
        let forward = (target - origin).normalized();
        let right = forward.cross(up).normalized();
        Camera {
            origin,
            right,
            up: right.cross(forward),
            forward,
            fov_x,
            lens: None,
        }
    }
}

impl Geometry {
    /// Lowest and highest corner of the bounding box; `None` for what is unbounded or empty.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let (center, half) = match *self {
            Geometry::Sphere { center, radius } => (center, Vec3::splat(radius)),
            Geometry::Plane { .. } => return None,
            Geometry::Disk {
                center,
                normal,
                radius,
            } => {
                let n = normal.normalized();
                let reach = |c: f64| radius * (1.0 - c * c).max(0.0).sqrt();
                (center, vec3(reach(n.x), reach(n.y), reach(n.z)))
            }
            Geometry::Rectangle { center, u, v } => (center, u.abs() + v.abs()),
            Geometry::Mesh(ref mesh) => return mesh.bounds(),
            Geometry::Implicit(ref solid) => return Some(solid.bounds()),
        };
        Some((center - half, center + half))
    }
}

/// Diagonal of the bounding box of all shapes that are bounded; 0 if there is none.
pub fn extent(scene: &Scene) -> f64 {
    let boxes = scene.shapes.iter().filter_map(|shape| shape.geometry.bounds());
    boxes
        .reduce(join)
        .map_or(0.0, |(low, high)| (high - low).length())
}

/// The length below which two points of the scene are the same to the renderer, before its factor of 1e-9.
///
/// The extent of shapes, camera, point lights and the planes' own points together: unlike `extent` it is of the order
/// of the coordinates even where every shape is a plane, and never zero.
pub(super) fn scale(scene: &Scene) -> f64 {
    let camera = scene.camera.origin;
    let shapes = scene.shapes.iter().filter_map(|shape| match shape.geometry {
        Geometry::Plane { point, .. } => Some((point, point)),
        ref bounded => bounded.bounds(),
    });
    let lights = scene.lights.iter().filter_map(|light| match *light {
        Light::Point { position, .. } => Some((position, position)),
        _ => None,
    });
    let (low, high) = shapes.chain(lights).fold((camera, camera), join);
    let diagonal = (high - low).length();
    if diagonal > 0.0 { diagonal } else { 1.0 }
}

fn join(a: (Vec3, Vec3), b: (Vec3, Vec3)) -> (Vec3, Vec3) {
    (a.0.min(b.0), a.1.max(b.1))
}
