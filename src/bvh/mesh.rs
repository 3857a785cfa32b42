//! A ray against a mesh: the nearest hit, or any; with a tree, or through the list.

use super::node::Node;
#[cfg(not(assembly))]
use super::traverse::traverse;
use super::traverse::{Order, Visitor};
use crate::geom::Ray;
use crate::shape::triangle::TriangleHit;
use crate::shape::{DEPTH_BITS, GridRay, MeshHit, Slopes, Triangles};
use core::ops::ControlFlow;

/// The nearest hit at a distance under `t_max`; of equal depths (1/16 step) that of the lowest number.
///
/// `nodes` is the mesh's tree, of [`super::build_mesh`] or past [`super::check_mesh`].
pub fn closest(mesh: &Triangles, nodes: &[Node], ray: &Ray, slopes: &Slopes, t_max: i32) -> Option<MeshHit> {
    // Either form has a ray of its own, so that what one knows of it need not lie in memory. By reference: to take it out would
    // copy it.
    #[cfg(assembly)]
    return match mesh {
        Triangles::Plain(mesh) => {
            let entered = GridRay::enter(&mesh.grid, ray, slopes);
            super::asm::closest(mesh, nodes, entered.as_ref()?, t_max)
        }
        Triangles::Packed(mesh) => {
            let entered = GridRay::enter(&mesh.grid, ray, slopes);
            super::asm::closest_packed(mesh, nodes, entered.as_ref()?, t_max)
        }
    };
    #[cfg(not(assembly))]
    {
        let entered = GridRay::enter(mesh.grid(), ray, slopes);
        let ray = entered.as_ref()?;
        let mut nearest = Nearest::within(mesh, depth_within(ray, t_max));
        traverse(nodes, ray, &mut nearest);
        nearest.hit(ray, t_max)
    }
}

/// A depth that no nearer hit exceeds: the limit has whole steps, so all sixteenths of the last.
#[inline(always)]
pub(super) fn depth_within(ray: &GridRay, t_max: i32) -> i32 {
    ((ray.limit(t_max) + 1) << DEPTH_BITS) - 1
}

/// The same answer from all triangles in turn.
pub fn closest_linear(mesh: &Triangles, ray: &Ray, slopes: &Slopes, t_max: i32) -> Option<MeshHit> {
    let ray = GridRay::enter(mesh.grid(), ray, slopes)?;
    let mut nearest = Nearest::within(mesh, i32::MAX);
    let _ = visit_all(mesh, &ray, &mut nearest);
    nearest.hit(&ray, t_max)
}

/// Whether anything is hit at a distance under `t_max`: exactly where [`closest`] answers something.
pub fn occluded(mesh: &Triangles, nodes: &[Node], ray: &Ray, slopes: &Slopes, t_max: i32) -> bool {
    let entered = GridRay::enter(mesh.grid(), ray, slopes);
    let Some(ray) = &entered else {
        return false;
    };
    #[cfg(assembly)]
    return super::asm::occluded(mesh, nodes, ray, t_max);
    #[cfg(not(assembly))]
    {
        let mut any = Any {
            mesh,
            limit: ray.limit(t_max),
            t_max,
            found: false,
        };
        traverse(nodes, ray, &mut any);
        any.found
    }
}

/// The same answer from all triangles in turn.
pub fn occluded_linear(mesh: &Triangles, ray: &Ray, slopes: &Slopes, t_max: i32) -> bool {
    let Some(ray) = GridRay::enter(mesh.grid(), ray, slopes) else {
        return false;
    };
    visit_all(
        mesh,
        &ray,
        &mut Any {
            mesh,
            limit: i32::MAX,
            t_max,
            found: false,
        },
    )
    .is_break()
}

fn visit_all(mesh: &Triangles, ray: &GridRay, visitor: &mut impl Visitor) -> ControlFlow<()> {
    match ray.axis {
        0 => visit_each::<0>(mesh, ray, visitor),
        1 => visit_each::<1>(mesh, ray, visitor),
        _ => visit_each::<2>(mesh, ray, visitor),
    }
}

fn visit_each<const K: usize>(
    mesh: &Triangles,
    ray: &GridRay,
    visitor: &mut impl Visitor,
) -> ControlFlow<()> {
    match mesh {
        Triangles::Plain(mesh) => visitor.visit::<K>(ray, 0, (mesh.triangles.len() as u32) << 4),
        Triangles::Packed(mesh) => mesh
            .each_leaf()
            .try_for_each(|leaf| visitor.visit::<K>(ray, leaf.block, leaf.count << 4 | leaf.place << 2)),
    }
}

/// The nearest hit so far, by depth and then by number.
struct Nearest<'a> {
    mesh: &'a Triangles<'a>,
    hit: TriangleHit,
    triangle: u32,
}

impl<'a> Nearest<'a> {
    const NONE: u32 = u32::MAX;

    /// Nothing yet, and nothing beyond a depth.
    fn within(mesh: &'a Triangles<'a>, depth: i32) -> Nearest<'a> {
        Nearest {
            mesh,
            hit: TriangleHit { depth, b1: 0, b2: 0 },
            triangle: Nearest::NONE,
        }
    }

    /// Keeps a hit if it is nearer than what there is.
    #[inline(always)]
    fn keep(&mut self, number: u32, hit: TriangleHit) {
        if hit.depth < self.hit.depth || (hit.depth == self.hit.depth && number < self.triangle) {
            (self.hit, self.triangle) = (hit, number);
        }
    }

    fn hit(&self, ray: &GridRay, t_max: i32) -> Option<MeshHit> {
        let t = (self.triangle != Nearest::NONE)
            .then(|| ray.distance(self.hit.depth))
            .filter(|&t| t < t_max)?;
        Some(MeshHit {
            t,
            triangle: self.triangle,
            b1: self.hit.b1,
            b2: self.hit.b2,
        })
    }
}

impl Visitor for Nearest<'_> {
    #[inline(always)]
    fn limit(&self) -> i32 {
        self.hit.depth >> DEPTH_BITS
    }

    #[cfg_attr(target_pointer_width = "32", inline(never))]
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    fn visit<const K: usize>(&mut self, ray: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        self.mesh.of_leaf::<K>(ray, base, leaf, |number, hit| {
            self.keep(number, hit);
            ControlFlow::Continue(())
        })
    }
}

/// Whether anything is in the way.
struct Any<'a> {
    mesh: &'a Triangles<'a>,
    limit: i32,
    t_max: i32,
    found: bool,
}

impl Visitor for Any<'_> {
    const ORDER: Order = Order::Any;

    #[inline(always)]
    fn limit(&self) -> i32 {
        self.limit
    }

    #[cfg_attr(target_pointer_width = "32", inline(never))]
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    fn visit<const K: usize>(&mut self, ray: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        let met = self
            .mesh
            .of_leaf::<K>(ray, base, leaf, |_, hit| stop_within(ray, hit.depth, self.t_max));
        self.found = met.is_break();
        met
    }
}

/// Breaks at a hit that is in the way.
#[inline(always)]
pub(super) fn stop_within(ray: &GridRay, depth: i32, t_max: i32) -> ControlFlow<()> {
    if ray.distance(depth) < t_max {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{build_mesh, max_nodes};
    use crate::geom::{Dir, Point};
    use crate::shape::{Attributes, Grid, TriangleMesh};

    /// A hundred times the same triangle, turned by its corners: the tree's order is not the list's.
    #[test]
    fn of_equals_the_first_is_hit() {
        let vertices = [
            [100, 100, 9000],
            [60000, 200, 9000],
            [300, 50000, 9000],
            [400, 400, 400],
            [500, 500, 500],
        ];
        let mut triangles: std::vec::Vec<[u16; 3]> = (0..100)
            .map(|i| [[0, 1, 2], [1, 2, 0], [2, 1, 0], [3, 4, 3]][i % 4])
            .collect();
        let mut nodes = std::vec![Node::EMPTY; max_nodes(100)];
        let used = build_mesh(&vertices, &mut triangles, &mut nodes).unwrap();
        let grid = Grid::new(Point([0; 3]), 0).unwrap();
        let mesh = Triangles::Plain(TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &triangles,
            attributes: Attributes::NONE,
        });
        let first = triangles.iter().position(|t| !t.contains(&3)).unwrap() as u32;
        for dir in [Dir::Z, Dir([300, -200, 65535])] {
            let (ray, slopes) = (
                Ray {
                    origin: Point([1000, 1000, 8]),
                    dir,
                },
                Slopes::new(dir),
            );
            let hit = closest_linear(&mesh, &ray, &slopes, i32::MAX);
            assert_eq!(hit.map(|h| (h.t, h.triangle)), Some((8992, first)));
            assert_eq!(closest(&mesh, &nodes[..used], &ray, &slopes, i32::MAX), hit);
            assert_eq!(closest(&mesh, &nodes[..used], &ray, &slopes, 8992), None);
            assert!(occluded(&mesh, &nodes[..used], &ray, &slopes, 8993));
        }
    }

    #[test]
    fn what_the_border_would_refuse_is_a_miss() {
        let vertices = [[100, 100, 9000], [60000, 200, 9000], [300, 50000, 9000]];
        let grid = Grid::new(Point([0; 3]), 0).unwrap();
        let mesh = Triangles::Plain(TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &[[0, 1, 3]],
            attributes: Attributes::NONE,
        });
        let ray = Ray {
            origin: Point([1000, 1000, 8]),
            dir: Dir::Z,
        };
        let slopes = Slopes::new(Dir::Z);
        assert_eq!(closest_linear(&mesh, &ray, &slopes, i32::MAX), None);
        // Node 0 leads to nodes and leaves that are not there.
        let whole = crate::shape::Bounds {
            low: [8; 3],
            high: [65000; 3],
        };
        let mut node = Node::around(whole, 7, 9);
        for (slot, meta) in [0x80, 0x83, 0x10, 0x7f].into_iter().enumerate() {
            node.set(slot, whole, meta);
        }
        assert_eq!(closest(&mesh, &[node], &ray, &slopes, i32::MAX), None);
    }
}
