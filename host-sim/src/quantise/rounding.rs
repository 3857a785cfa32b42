//! Numbers: the unit of a scene, and what places, lengths, directions, colours and light become in it.

use fixed::types::I12F20;
use microlux::camera::Camera;
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Dir, Point, REACH, Unit};
use microlux::shape::{Disk, Geometry, Plane, Rectangle, Sphere};

use super::QuantiseError;
use crate::desc::{GeometryDesc, LightDesc, SceneDesc, ShapeDesc, Vec3};
use crate::import::math::{dot, length};

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

/// The finest unit in which the scene fits, and where its middle is.
pub(super) fn choose_unit(desc: &SceneDesc) -> (Vec3, Unit) {
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
    // Directions tell the slopes of rays towards a plane to 2^-17; those of 2^-8 and more meet it within `FAR`, 2^7 times
    // `REACH`, if the camera stands within half of `REACH` of it.
    for shape in &desc.shapes {
        if let GeometryDesc::Plane { point, normal } = &shape.geometry {
            let from = [0, 1, 2].map(|i| desc.camera.origin[i] - point[i]);
            reach = reach.max(2.0 * dot(from, *normal).abs() / length(*normal));
        }
    }
    let bits = (f64::from(REACH) * 0.999 / reach.max(1e-12)).log2().floor();
    (origin, Unit::new(bits as i32))
}

/// From metres to units.
pub(super) struct Rounding {
    pub origin: Vec3,
    /// Units a metre.
    pub scale: f64,
}

impl Rounding {
    pub fn length(&self, metres: f64) -> i32 {
        (metres * self.scale).round().clamp(-1e9, 1e9) as i32
    }

    pub fn point(&self, p: Vec3) -> Point {
        Point([0, 1, 2].map(|i| self.length(p[i] - self.origin[i])))
    }

    /// A closed form.
    pub fn geometry(&self, shape: &ShapeDesc) -> Result<Geometry, QuantiseError> {
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
                let half = [self.length(length(*u)), self.length(length(*v))];
                Rectangle::new(self.point(*center), dir(*u), dir(*v), half)
                    .ok_or_else(degenerate)?
                    .into()
            }
            GeometryDesc::Mesh(_) | GeometryDesc::Instance(_) | GeometryDesc::Implicit(_) => {
                return Err(degenerate());
            }
        })
    }

    pub fn camera(&self, desc: &SceneDesc) -> Camera {
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

/// A direction, each component rounded to 2^-16.
pub(super) fn dir(v: Vec3) -> Dir {
    let norm = length(v);
    Dir(v.map(|c| (c / norm * 65536.0).round() as i32))
}

pub(super) fn albedo(color: Vec3) -> Albedo {
    Albedo::from_bits(color.map(|c| (c.clamp(0.0, 1.0) * 32768.0).round() as u16))
}

/// To 16 bits of the largest channel, each channel rounded to nearest.
pub(super) fn radiance(color: Vec3) -> Radiance {
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
