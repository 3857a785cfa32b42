//! Where a ray meets the shapes: closest hit and any hit, by looking at every shape.

use super::mesh::{Mesh, TriangleHit};
use super::scene::{Geometry, Ray, Scene};
use super::texture::Tint;
use super::vec::{Rgb, Vec3};

/// The nearest hit of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance from the ray's origin.
    pub t: f64,
    pub point: Vec3,
    /// Unit geometric normal on the shape's own side (spheres: outwards), whatever side the ray came from.
    pub normal: Vec3,
    /// Unit shading normal: interpolated on meshes that carry normals, else the geometric one.
    pub shading: Vec3,
    /// Index into `Scene::shapes`.
    pub shape: usize,
    /// Index into the mesh's triangles.
    pub triangle: Option<u32>,
    /// The ray came from the side of the geometric normal.
    pub front: bool,
    /// What the material's own colour is multiplied by.
    pub tint: Rgb,
}

/// The nearest hit with t > 0; of equal distances the lowest shape, then the lowest triangle.
pub fn closest(scene: &Scene, ray: &Ray) -> Option<Hit> {
    let mut best: Option<(usize, Crossing)> = None;
    let mut far = f64::INFINITY;
    for (index, shape) in scene.shapes.iter().enumerate() {
        if let Some(crossing) = cross(&shape.geometry, ray, far)
            && crossing.t() < far
        {
            far = crossing.t();
            best = Some((index, crossing));
        }
    }
    best.map(|(index, crossing)| describe(scene, ray, index, crossing))
}

/// Whether any shape is hit with 0 < t < `far`.
pub fn occluded(scene: &Scene, ray: &Ray, far: f64) -> bool {
    scene.shapes.iter().any(|shape| match &shape.geometry {
        Geometry::Mesh(mesh) => mesh.occludes(ray, far),
        analytic => cross(analytic, ray, far).is_some_and(|crossing| crossing.t() < far),
    })
}

#[derive(Clone, Copy, Debug)]
enum Crossing {
    At(f64),
    Triangle(TriangleHit),
}

impl Crossing {
    fn t(&self) -> f64 {
        match self {
            Crossing::At(t) => *t,
            Crossing::Triangle(hit) => hit.t,
        }
    }
}

fn cross(geometry: &Geometry, ray: &Ray, far: f64) -> Option<Crossing> {
    let analytic = match *geometry {
        Geometry::Sphere { center, radius } => sphere(ray, center, radius),
        Geometry::Plane { point, normal } => plane(ray, point, normal),
        Geometry::Disk {
            center,
            normal,
            radius,
        } => plane(ray, center, normal).filter(|&t| (ray.at(t) - center).length_squared() <= radius * radius),
        Geometry::Rectangle { center, u, v } => plane(ray, center, u.cross(v)).filter(|&t| {
            let q = ray.at(t) - center;
            q.dot(u).abs() <= u.length_squared() && q.dot(v).abs() <= v.length_squared()
        }),
        Geometry::Mesh(ref mesh) => return mesh.closest(ray, far).map(Crossing::Triangle),
        Geometry::Implicit(ref solid) => solid.first(ray, far),
    };
    analytic.map(Crossing::At)
}

/// Smallest t > 0 on the sphere.
///
/// The discriminant from the chord's distance to the centre, and the small root by division: Haines, Günther and
/// Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection" (Ray Tracing Gems, 2019, chapter 7).
fn sphere(ray: &Ray, center: Vec3, radius: f64) -> Option<f64> {
    let f = ray.origin - center;
    let b = -f.dot(ray.direction);
    let discriminant = radius * radius - (f + ray.direction * b).length_squared();
    if discriminant < 0.0 {
        return None;
    }
    let far = b + discriminant.sqrt().copysign(b);
    let near = (f.length_squared() - radius * radius) / far;
    let (first, second) = if near < far { (near, far) } else { (far, near) };
    [first, second].into_iter().find(|&t| t > 0.0)
}

fn plane(ray: &Ray, point: Vec3, normal: Vec3) -> Option<f64> {
    let t = (point - ray.origin).dot(normal) / ray.direction.dot(normal);
    // Not so for a parallel ray, whose t is infinite or NaN.
    (t > 0.0 && t < f64::INFINITY).then_some(t)
}

fn describe(scene: &Scene, ray: &Ray, shape: usize, crossing: Crossing) -> Hit {
    let geometry = &scene.shapes[shape].geometry;
    let mut tint = Rgb::ONE;
    let mut point = ray.at(crossing.t());
    let (normal, shading, triangle) = match (geometry, crossing) {
        (Geometry::Mesh(mesh), Crossing::Triangle(hit)) => {
            let normal = mesh.double_area_normal(hit.triangle).normalized();
            point = triangle_point(mesh, &hit);
            tint = match &scene.shapes[shape].tint {
                None => Rgb::ONE,
                Some(Tint::Vertices) => mesh.color(&hit),
                Some(Tint::Texture(texture)) => texture.at(mesh.uv(&hit)),
            };
            (
                normal,
                mesh.shading_normal(&hit).unwrap_or(normal),
                Some(hit.triangle),
            )
        }
        (Geometry::Sphere { center, radius }, _) => {
            // Back onto the surface: at t times its rounding error the point may have left it.
            let normal = (point - *center).normalized();
            point = *center + normal * *radius;
            (normal, normal, None)
        }
        (Geometry::Rectangle { u, v, .. }, _) => {
            let normal = u.cross(*v).normalized();
            (normal, normal, None)
        }
        (Geometry::Plane { normal, .. } | Geometry::Disk { normal, .. }, _) => {
            let normal = normal.normalized();
            (normal, normal, None)
        }
        (Geometry::Implicit(solid), _) => {
            let normal = solid.normal(point);
            (normal, normal, None)
        }
        (Geometry::Mesh(_), Crossing::At(_)) => unreachable!("a mesh is crossed at a triangle"),
    };
    Hit {
        t: crossing.t(),
        point,
        normal,
        shading,
        shape,
        triangle,
        front: ray.direction.dot(normal) < 0.0,
        tint,
    }
}

fn triangle_point(mesh: &Mesh, hit: &TriangleHit) -> Vec3 {
    let [a, b, c] = mesh.corners(hit.triangle);
    a * hit.weights[0] + b * hit.weights[1] + c * hit.weights[2]
}
