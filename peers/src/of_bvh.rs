//! The crate `bvh`: a binary tree of boxes in f32.

use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::Bvh;
use bvh::ray;
use microlux::geom::Ray;
use nalgebra::{Point3, Vector3};

use crate::mesh::Model;
use crate::{Answer, Tracer};

struct Triangle {
    corners: [Point3<f32>; 3],
    number: u32,
    node: usize,
}

impl Bounded<f32, 3> for Triangle {
    fn aabb(&self) -> Aabb<f32, 3> {
        self.corners
            .iter()
            .fold(Aabb::empty(), |all, corner| all.grow(corner))
    }
}

impl BHShape<f32, 3> for Triangle {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

pub struct Tree {
    triangles: Vec<Triangle>,
    bvh: Bvh<f32, 3>,
    order: Order,
}

/// Which of the crate's iterators is asked.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// All whose box is met.
    Any,
    /// The nearest box first, up to the one that begins behind the hit.
    Nearest,
}

impl Tree {
    pub fn new(model: &Model, order: Order) -> Tree {
        let triangle = |number: usize| Triangle {
            corners: model.corners(number).map(|[x, y, z]| Point3::new(x, y, z)),
            number: number as u32,
            node: 0,
        };
        let mut triangles: Vec<_> = (0..model.triangles.len()).map(triangle).collect();
        let bvh = Bvh::build(&mut triangles);
        Tree {
            triangles,
            bvh,
            order,
        }
    }
}

/// Möller and Trumbore 1997, both sides: the crate's own sees fronts alone.
fn meet(ray: &ray::Ray<f32, 3>, [a, b, c]: &[Point3<f32>; 3]) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = ray.direction.cross(&ac);
    let det = ab.dot(&p);
    if det == 0.0 {
        return None;
    }
    let inverse = 1.0 / det;
    let from = ray.origin - a;
    let u = from.dot(&p) * inverse;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = from.cross(&ab);
    let v = ray.direction.dot(&q) * inverse;
    if v < 0.0 || u + v > 1.0 {
        return None;
    }
    let t = ac.dot(&q) * inverse;
    (t > 0.0).then_some(t)
}

impl Tracer for Tree {
    fn name(&self) -> &'static str {
        match self.order {
            Order::Any => "bvh",
            Order::Nearest => "bvh-nearest",
        }
    }

    fn nearest(&self, ray: &Ray) -> Answer {
        let [x, y, z] = ray.origin.0.map(|c| c as f32);
        let [dx, dy, dz] = ray.dir.0.map(|c| c as f32 / 65_536.0);
        let ray = ray::Ray::new(Point3::new(x, y, z), Vector3::new(dx, dy, dz));
        let mut nearest: Answer = None;
        let mut look = |triangle: &Triangle| {
            if let Some(t) = meet(&ray, &triangle.corners)
                && nearest.is_none_or(|(_, before)| t < before)
            {
                nearest = Some((triangle.number, t));
            }
            nearest.map_or(f32::INFINITY, |(_, t)| t)
        };
        match self.order {
            Order::Any => {
                for triangle in self.bvh.traverse_iterator(&ray, &self.triangles) {
                    look(triangle);
                }
            }
            Order::Nearest => {
                let mut limit = f32::INFINITY;
                for triangle in self.bvh.nearest_traverse_iterator(&ray, &self.triangles) {
                    let slice = ray.intersection_slice_for_aabb(&triangle.aabb());
                    if slice.is_some_and(|(from, _)| from > limit) {
                        break;
                    }
                    limit = look(triangle);
                }
            }
        }
        nearest
    }
}
