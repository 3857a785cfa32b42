//! Puts shapes into the order of a tree over them.

use super::{Mesh, Parts, Shape};
use crate::bvh::{BuildError, Item, Node, SCENE_PAD, build_items};
use crate::geom::{Point, REACH};
use crate::light::Light;
use crate::num::{ONE_Q16, mul_q16};
use crate::shape::{Blob, Bounds, Disk, Geometry, Grid, Rectangle, Sphere};

/// A shape's box and number, while the tree is built.
#[derive(Clone, Copy, Debug)]
pub struct Boxed {
    bounds: Bounds,
    shape: u16,
}

impl Boxed {
    pub const EMPTY: Boxed = Boxed {
        bounds: Bounds::EMPTY,
        shape: 0,
    };
}

impl Item for Boxed {
    fn bounds(&self) -> Bounds {
        self.bounds
    }
}

/// What [`arrange`] found out.
#[derive(Clone, Copy, Debug)]
pub struct Arrangement {
    /// Around all finite shapes.
    pub grid: Grid,
    /// How many shapes are finite; infinite planes stand after them.
    pub bounded: usize,
    /// Nodes used.
    pub nodes: usize,
}

/// Orders shapes for the tree over them, which it builds, finite ones first; lights keep pointing at their shapes.
///
/// `boxes` holds at least as many as `shapes`; they are scratch.
pub fn arrange(
    shapes: &mut [Shape],
    meshes: &[Mesh],
    blobs: &[Blob],
    lights: &mut [Light],
    boxes: &mut [Boxed],
    nodes: &mut [Node],
) -> Result<Arrangement, BuildError> {
    let short = BuildError { needed: shapes.len() };
    let boxes = boxes.get_mut(..shapes.len()).ok_or(short)?;
    // Infinite planes last, each kind in its own order.
    let mut bounded = 0;
    let mut planes = shapes.len();
    for (index, shape) in shapes.iter().enumerate() {
        let at = if matches!(shape.geometry, Geometry::Plane(_)) {
            planes -= 1;
            planes
        } else {
            bounded += 1;
            bounded - 1
        };
        if let Some(place) = boxes.get_mut(at) {
            place.shape = index as u16;
        }
    }
    let (finite, infinite) = boxes.split_at_mut(bounded);
    infinite.reverse();
    let grid = scene_grid(shapes, meshes, blobs);
    for place in finite.iter_mut() {
        place.bounds = match shapes.get(place.shape as usize) {
            Some(shape) => shape_bounds(shape, meshes, blobs, &grid),
            None => Bounds::EMPTY,
        };
    }
    let nodes = build_items(finite, SCENE_PAD, nodes)?;
    reorder(shapes, boxes);
    for (index, shape) in shapes.iter().enumerate() {
        let light = shape.light.and_then(|light| lights.get_mut(light as usize));
        if let Some(Light::Area { shape, .. }) = light {
            *shape = index as u16;
        }
    }
    Ok(Arrangement { grid, bounded, nodes })
}

/// Moves shape `boxes[i].shape` to place i for all i, following the permutation's cycles.
fn reorder(shapes: &mut [Shape], boxes: &mut [Boxed]) {
    for start in 0..shapes.len() {
        let mut at = start;
        while let Some(place) = boxes.get_mut(at) {
            let from = place.shape as usize;
            place.shape = at as u16;
            if from == start || from >= shapes.len() {
                break;
            }
            shapes.swap(at, from);
            at = from;
        }
    }
}

/// The finest grid around all finite shapes with the margin that the tree's boxes grow by, and as coarse as the meshes'.
fn scene_grid(shapes: &[Shape], meshes: &[Mesh], blobs: &[Blob]) -> Grid {
    let mut low = [i32::MAX; 3];
    let mut high = [i32::MIN; 3];
    for (a, b) in shapes
        .iter()
        .filter_map(|shape| reach(&shape.geometry, meshes, blobs))
    {
        for i in 0..3 {
            low[i] = low[i].min(a.0[i]);
            high[i] = high[i].max(b.0[i]);
        }
    }
    if low[0] > high[0] {
        (low, high) = ([0; 3], [0; 3]);
    }
    let clamp = |v: [i32; 3]| Point(v.map(|c| c.clamp(-REACH, REACH)));
    let steps = coarsest(shapes, meshes).map_or(0, |(shift, _)| shift);
    Grid::around_in_steps(clamp(low), clamp(high), SCENE_PAD, steps)
        .or(Grid::new(Point([-2 * REACH; 3]), Grid::MAX_SHIFT))
        .unwrap_or(Grid::UNIT)
}

/// The coarsest grid of a mesh that is placed: its shift, and the mesh.
///
/// A mesh sees rays to a few of its own steps: [`SCENE_PAD`] covers that as long as the scene's are no smaller.
pub(super) fn coarsest(shapes: &[Shape], meshes: &[Mesh]) -> Option<(u32, u16)> {
    let placed = shapes.iter().filter_map(|shape| match shape.geometry {
        Geometry::Mesh(index) => Some((meshes.get(index as usize)?.triangles.grid().shift(), index)),
        Geometry::Instance(instance) => {
            let mesh = meshes.get(instance.mesh as usize)?;
            Some((instance.step(mesh.triangles.grid()), instance.mesh))
        }
        _ => None,
    });
    placed.max_by_key(|(shift, _)| *shift)
}

/// A finite shape's box in the scene's grid; nothing for a plane.
pub(super) fn shape_bounds(shape: &Shape, meshes: &[Mesh], blobs: &[Blob], grid: &Grid) -> Bounds {
    reach(&shape.geometry, meshes, blobs).map_or(Bounds::EMPTY, |(low, high)| grid.enclose(low, high))
}

/// How far a rectangle's corners lie from its centre along each axis, units; for wrong sizes or directions no more than
/// for the largest right ones.
pub(super) fn rectangle_reach(rectangle: &Rectangle) -> [i32; 3] {
    let Rectangle { u, v, half, .. } = rectangle;
    // Each product is rounded down, by less than one unit.
    let along = |half: i32, c: i32| mul_q16(half.clamp(0, REACH), c.clamp(-ONE_Q16, ONE_Q16).abs()) + 1;
    [0, 1, 2].map(|i| along(half[0], u.0[i]) + along(half[1], v.0[i]))
}

/// The corners of the box around all finite shapes, units; none if there are none.
pub(super) fn finite_box(parts: &Parts) -> Option<(Point, Point)> {
    let boxes = parts
        .shapes
        .iter()
        .filter_map(|shape| reach(&shape.geometry, parts.meshes, parts.blobs));
    let pick = |f: fn(i32, i32) -> i32, a: Point, b: Point| Point([0, 1, 2].map(|i| f(a.0[i], b.0[i])));
    boxes.reduce(|(a, b), (c, d)| (pick(Ord::min, a, c), pick(Ord::max, b, d)))
}

/// The corners of a finite shape's box, units.
pub(super) fn reach(geometry: &Geometry, meshes: &[Mesh], blobs: &[Blob]) -> Option<(Point, Point)> {
    let around = |Point(c): Point, r: [i32; 3]| {
        let low = Point([0, 1, 2].map(|i| c[i].saturating_sub(r[i])));
        (low, Point([0, 1, 2].map(|i| c[i].saturating_add(r[i]))))
    };
    match *geometry {
        Geometry::Sphere(Sphere { center, radius }) => Some(around(center, [radius; 3])),
        Geometry::Plane(_) => None,
        Geometry::Disk(Disk { center, radius, .. }) => Some(around(center, [radius; 3])),
        Geometry::Rectangle(rectangle) => Some(around(rectangle.center, rectangle_reach(&rectangle))),
        Geometry::Implicit(solid) => Some(solid.bounds(blobs)),
        Geometry::Instance(instance) => instance.reach(&meshes.get(instance.mesh as usize)?.triangles),
        Geometry::Mesh(index) => {
            let mesh = meshes.get(index as usize)?;
            let bounds = mesh.triangles.bounds();
            (bounds.low[0] <= bounds.high[0]).then(|| {
                (
                    mesh.triangles.grid().to_scene(bounds.low),
                    mesh.triangles.grid().to_scene(bounds.high),
                )
            })
        }
    }
}
