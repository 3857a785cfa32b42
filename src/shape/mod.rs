//! What rays hit: closed forms, triangle meshes, and solids given by a function.
//!
//! Each closed form is intersected relative to itself, so that its error is a share of its own size and of the way
//! there, never of the scene; and it says how far a ray's origin must be lifted off it so that the ray does not meet it
//! again: bounds from the arithmetic, no epsilon.

mod attributes;
mod grid;
mod implicit;
mod instance;
mod mesh;
#[cfg(any(test, not(target_arch = "x86_64")))]
mod one_by_one;
mod packed;
mod planar;
pub mod polygon;
mod sight;
mod sphere;
#[cfg(target_arch = "x86_64")]
mod sse2;
mod treelet;
pub(crate) mod triangle;
mod triangles;

use crate::geom::{Dir, Point, Ray};

pub use attributes::{Attributes, Layers};
#[cfg(not(assembly))]
pub(crate) use grid::Rise;
pub use grid::{Bounds, Grid, GridRay, Slopes};
pub(crate) use grid::{DEPTH_BITS, LAST, SLOPE_BITS};
pub use implicit::{
    Blob, Bound, Capsule, FINEST, Gyroid, Implicit, ImplicitError, MAX_BLOBS, Metaballs, RoundedBox,
    SmoothUnion, Torus,
};
pub use instance::{Instance, LocalRay};
pub(crate) use mesh::corners;
pub use mesh::{MeshError, MeshHit, TriangleMesh};
pub use packed::PackedMesh;
pub use planar::{Disk, LIFT, Plane, Rectangle, onto_plane};
pub(crate) use sight::Sight;
pub use sphere::Sphere;
pub use treelet::Treelet;
pub use triangles::Triangles;

/// Where a shape is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Geometry {
    Sphere(Sphere),
    Plane(Plane),
    Disk(Disk),
    Rectangle(Rectangle),
    /// Index into the scene's meshes.
    Mesh(u16),
    /// A mesh at a place of its own.
    Instance(Instance),
    Implicit(Implicit),
}

impl From<Instance> for Geometry {
    fn from(shape: Instance) -> Geometry {
        Geometry::Instance(shape)
    }
}

impl From<Sphere> for Geometry {
    fn from(shape: Sphere) -> Geometry {
        Geometry::Sphere(shape)
    }
}

impl From<Plane> for Geometry {
    fn from(shape: Plane) -> Geometry {
        Geometry::Plane(shape)
    }
}

impl From<Disk> for Geometry {
    fn from(shape: Disk) -> Geometry {
        Geometry::Disk(shape)
    }
}

impl From<Rectangle> for Geometry {
    fn from(shape: Rectangle) -> Geometry {
        Geometry::Rectangle(shape)
    }
}

impl From<Implicit> for Geometry {
    fn from(shape: Implicit) -> Geometry {
        Geometry::Implicit(shape)
    }
}

impl Geometry {
    /// Distance to the first crossing with 0 < t < `t_max`. A mesh answers `None`, its own tree is asked; so does a solid
    /// given by a function, which may need the scene's blobs.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray, t_max: i32) -> Option<i32> {
        match self {
            Geometry::Rectangle(rectangle) if cfg!(rectangles) => rectangle.intersect(ray, t_max),
            form => form.intersect_one(ray, t_max),
        }
    }

    #[cfg_attr(rectangles, inline(never))]
    #[cfg_attr(not(rectangles), inline)]
    fn intersect_one(&self, ray: &Ray, t_max: i32) -> Option<i32> {
        match self {
            Geometry::Sphere(sphere) => sphere.intersect(ray, t_max),
            Geometry::Plane(plane) => plane.intersect(ray, t_max),
            Geometry::Disk(disk) => disk.intersect(ray, t_max),
            Geometry::Rectangle(rectangle) => rectangle.intersect(ray, t_max),
            Geometry::Mesh(_) | Geometry::Instance(_) | Geometry::Implicit(_) => None,
        }
    }

    /// [`Self::intersect`] for loops that ask shape after shape: what is clearly missed is left out where they stand.
    ///
    /// `K` is the ray's dominant axis.
    #[inline(always)]
    pub(crate) fn intersect_next<const K: usize>(&self, ray: &Ray, sight: &Sight, t_max: i32) -> Option<i32> {
        match self {
            Geometry::Sphere(Sphere { center, radius }) if !sight.is_near::<K>(ray, *center, *radius) => None,
            Geometry::Plane(plane) => plane.intersect(ray, t_max),
            geometry => geometry.intersect(ray, t_max),
        }
    }

    /// The point on a closed form nearest to one found along a ray, the normal there, and the lift.
    pub fn surface(&self, near: Point) -> Option<Surface> {
        let (point, normal, lift) = match self {
            Geometry::Sphere(sphere) => {
                let (point, normal) = sphere.surface(near);
                (point, normal, sphere.lift())
            }
            Geometry::Plane(Plane { point, normal }) => (onto_plane(*point, *normal, near), *normal, LIFT),
            Geometry::Disk(Disk { center, normal, .. }) => {
                (onto_plane(*center, *normal, near), *normal, LIFT)
            }
            Geometry::Rectangle(Rectangle { center, normal, .. }) => {
                (onto_plane(*center, *normal, near), *normal, LIFT)
            }
            Geometry::Mesh(_) | Geometry::Instance(_) | Geometry::Implicit(_) => return None,
        };
        Some(Surface { point, normal, lift })
    }
}

/// A place on a shape.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    pub point: Point,
    /// Geometric normal, as the shape says which side is out.
    pub normal: Dir,
    /// Distance along the normal that takes a ray's origin clear of the shape, units.
    pub lift: i32,
}

impl Surface {
    /// The origin of a ray that leaves towards `wi`: lifted to the side `wi` points to.
    #[inline]
    pub fn leave(&self, wi: Dir) -> Point {
        let lift = if wi.dot_q24_normal(self.normal) >= 0 {
            self.lift
        } else {
            -self.lift
        };
        self.point.along_briefly(self.normal, lift)
    }
}
