//! How many nodes a ray visits in a tree of 40-byte nodes, beside an uncompressed tree of the surface area heuristic over
//! the same triangles: exact boxes, every split looked at, four children a node, the nearest first.
//!
//! `MICROLUX_RAYS` is the number of rays a mesh. The files of ../shared/meshes are taken, too, where they are.

#[path = "../../tests/meshes/mod.rs"]
#[allow(dead_code)]
mod meshes;

use std::cell::Cell;
use std::ops::ControlFlow;

use meshes::{Model, Random};
use microlux::bvh::{Visitor, check_mesh, primitives, traverse};
use microlux::geom::{Point, Ray};
use microlux::shape::{GridRay, Slopes};
use microlux_bake as bake;

type Vec3 = [f64; 3];

fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Distance along a ray to a triangle, in its direction's lengths (Möller and Trumbore 1997).
fn meet(origin: Vec3, dir: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f64> {
    let (ab, ac) = (sub(b, a), sub(c, a));
    let p = cross(dir, ac);
    let det = dot(ab, p);
    let from = sub(origin, a);
    let q = cross(from, ab);
    let (u, v, t) = (dot(from, p) / det, dot(dir, q) / det, dot(ac, q) / det);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then_some(t)
}

#[derive(Clone, Copy)]
struct Box3([Vec3; 2]);

impl Box3 {
    const NONE: Box3 = Box3([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]);

    fn around(self, p: Vec3) -> Box3 {
        let [low, high] = self.0;
        Box3([
            [0, 1, 2].map(|i| low[i].min(p[i])),
            [0, 1, 2].map(|i| high[i].max(p[i])),
        ])
    }

    fn union(self, other: Box3) -> Box3 {
        other.0.iter().fold(self, |all, &p| all.around(p))
    }

    fn area(self) -> f64 {
        let [x, y, z] = sub(self.0[1], self.0[0]);
        x * y + y * z + z * x
    }

    /// Where a ray enters, if it does before `limit`.
    fn enter(self, origin: Vec3, dir: Vec3, limit: f64) -> Option<f64> {
        let (mut near, mut far) = (0f64, limit);
        for i in 0..3 {
            let [a, b] = [0, 1].map(|end| (self.0[end][i] - origin[i]) / dir[i]);
            if dir[i] == 0.0 {
                if origin[i] < self.0[0][i] || origin[i] > self.0[1][i] {
                    return None;
                }
            } else {
                (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
            }
        }
        (near <= far).then_some(near)
    }
}

/// Children are boxes with a leaf's triangles or a node.
enum Wide {
    Leaf(Vec<usize>),
    Node(Vec<(Box3, Wide)>),
}

/// Binary first: most triangles in a leaf, and a leaf only where a split costs more.
fn sweep(order: &mut [usize], boxes: &[Box3]) -> (Box3, Wide) {
    let all = |part: &[usize]| part.iter().fold(Box3::NONE, |all, &i| all.union(boxes[i]));
    let whole = all(order);
    let mut best = (f64::INFINITY, 0, 0);
    for axis in 0..3 {
        order.sort_by(|&a, &b| {
            let center = |i: usize| boxes[i].0[0][axis] + boxes[i].0[1][axis];
            center(a).total_cmp(&center(b)).then(a.cmp(&b))
        });
        let mut right = vec![0.0; order.len()];
        let mut bounds = Box3::NONE;
        for at in (0..order.len()).rev() {
            bounds = bounds.union(boxes[order[at]]);
            right[at] = bounds.area() * (order.len() - at) as f64;
        }
        let mut bounds = Box3::NONE;
        for at in 1..order.len() {
            bounds = bounds.union(boxes[order[at - 1]]);
            let cost = bounds.area() * at as f64 + right[at];
            if cost < best.0 {
                best = (cost, axis, at);
            }
        }
    }
    let count = order.len() as f64;
    let splits = whole.area() + best.0 < whole.area() * count;
    if order.len() == 1 || (order.len() <= 4 && !splits) {
        return (whole, Wide::Leaf(order.to_vec()));
    }
    let (_, axis, middle) = best;
    order.sort_by(|&a, &b| {
        let center = |i: usize| boxes[i].0[0][axis] + boxes[i].0[1][axis];
        center(a).total_cmp(&center(b)).then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(middle);
    (whole, Wide::Node(vec![sweep(left, boxes), sweep(right, boxes)]))
}

/// The child with the largest surface gives way to its own, as long as there are four at most.
fn widen((bounds, tree): (Box3, Wide)) -> (Box3, Wide) {
    let Wide::Node(mut children) = tree else {
        return (bounds, tree);
    };
    while children.len() < 4 {
        let inner = (0..children.len()).filter(|&i| matches!(children[i].1, Wide::Node(_)));
        let Some(largest) = inner.max_by(|&a, &b| children[a].0.area().total_cmp(&children[b].0.area()))
        else {
            break;
        };
        if let (_, Wide::Node(own)) = children.swap_remove(largest) {
            children.extend(own);
        }
    }
    (bounds, Wide::Node(children.into_iter().map(widen).collect()))
}

/// Visits of nodes by a ray, and the nearest distance.
fn walk(tree: &Wide, triangles: &[[Vec3; 3]], origin: Vec3, dir: Vec3) -> (u64, f64) {
    let (mut visits, mut limit) = (0, f64::INFINITY);
    let mut waiting = vec![(0.0, tree)];
    while let Some((near, tree)) = waiting.pop() {
        if near > limit {
            continue;
        }
        match tree {
            Wide::Leaf(leaf) => {
                for &i in leaf {
                    limit = meet(origin, dir, triangles[i]).map_or(limit, |t| t.min(limit));
                }
            }
            Wide::Node(children) => {
                visits += 1;
                let mut met: Vec<_> = children
                    .iter()
                    .filter_map(|(bounds, child)| Some((bounds.enter(origin, dir, limit)?, child)))
                    .collect();
                met.sort_by(|a, b| b.0.total_cmp(&a.0));
                waiting.extend(met);
            }
        }
    }
    (visits, limit)
}

/// Counts nodes, and finds hits by the same arithmetic as the other tree.
struct Count<'a> {
    triangles: &'a [[Vec3; 3]],
    origin: Vec3,
    dir: Vec3,
    /// Where depths are counted from, along the dominant axis.
    start: f64,
    axis: usize,
    nearest: f64,
    asked: Cell<u64>,
}

impl Visitor for Count<'_> {
    /// Asked twice a node.
    fn limit(&self) -> i32 {
        self.asked.set(self.asked.get() + 1);
        let steps = (self.origin[self.axis] + self.nearest * self.dir[self.axis] - self.start).abs();
        steps.min(65535.0) as i32
    }

    fn visit<const K: usize>(&mut self, _: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        for i in primitives(base, leaf) {
            let met = meet(self.origin, self.dir, self.triangles[i as usize]);
            self.nearest = met.map_or(self.nearest, |t| t.min(self.nearest));
        }
        ControlFlow::Continue(())
    }
}

/// Rays towards a model's triangles from around it, and away from them.
fn rays(model: &Model, count: u64, leaving: bool) -> Vec<Ray> {
    let mut random = Random(7);
    let grid = &model.grid;
    let mut rays = Vec::new();
    while (rays.len() as u64) < count {
        let triangle = model.triangles[random.below(model.triangles.len() as u32) as usize];
        let corners = triangle.map(|i| grid.to_scene(model.vertices[i as usize]).0);
        let at = Point([0, 1, 2].map(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3));
        let dir = random.dir();
        if leaving {
            rays.push(Ray { origin: at, dir });
            continue;
        }
        let far = 3 * (65536 << grid.shift());
        let origin = Point([0, 1, 2].map(|i| at.0[i] + ((i64::from(dir.0[i]) * far) >> 16) as i32));
        rays.push(Ray { origin, dir: -dir });
    }
    rays
}

/// Mean visits of the plain tree and of the compact one.
fn compare(model: &Model, rays: &[Ray]) -> [f64; 2] {
    let wide = |v: [u16; 3]| v.map(f64::from);
    let triangles: Vec<[Vec3; 3]> = model
        .triangles
        .iter()
        .map(|t| t.map(|i| wide(model.vertices[usize::from(i)])))
        .collect();
    let boxes: Vec<Box3> = triangles
        .iter()
        .map(|t| t.iter().fold(Box3::NONE, |b, &p| b.around(p)))
        .collect();
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    let (_, tree) = widen(sweep(&mut order, &boxes));
    let (size, from) = (f64::from(1 << model.grid.shift()), model.grid.origin());
    let (mut plain, mut compact, mut taken) = (0, 0, 0);
    for ray in rays {
        let slopes = Slopes::new(ray.dir);
        let Some(grid_ray) = GridRay::enter(&model.grid, ray, &slopes) else {
            continue;
        };
        let dir = ray.dir.0.map(f64::from);
        // A step off the surface, as rays are.
        let origin = [0, 1, 2].map(|i| f64::from(from.0[i] - ray.origin.0[i]) / -size + dir[i] / 65536.0);
        let (visits, nearest) = walk(&tree, &triangles, origin, dir);
        let axis = (0..3)
            .max_by(|&a, &b| dir[a].abs().total_cmp(&dir[b].abs()))
            .unwrap();
        let mut count = Count {
            triangles: &triangles,
            origin,
            dir,
            start: origin[axis].round().clamp(0.0, 65535.0),
            axis,
            nearest: f64::INFINITY,
            asked: Cell::new(0),
        };
        traverse(&model.nodes, &grid_ray, &mut count);
        // The quantised ray may pass a silhouette by.
        if count.nearest != nearest {
            continue;
        }
        taken += 1;
        plain += visits;
        compact += count.asked.get() / 2;
    }
    assert!(
        taken * 100 > 99 * rays.len(),
        "{}: {taken} of {}",
        model.name,
        rays.len()
    );
    [plain, compact].map(|visits| visits as f64 / taken as f64)
}

#[test]
fn compact_nodes_cost_few_visits() {
    let count = std::env::var("MICROLUX_RAYS").map_or(2000, |n| n.parse().unwrap());
    let mut models = vec![meshes::icosphere(4, 4), meshes::torus_knot(240, 32, 8)];
    models.extend(meshes::files());
    for mut model in models {
        assert_few(&model, "the device's tree", count, 1.25);
        model.nodes = bake::build(&model.vertices, &mut model.triangles).unwrap();
        check_mesh(&model.mesh(), &model.nodes).unwrap();
        // Faces along the axes: padded, their boxes reach over to where a ray that leaves them begins.
        let most = if model.name == "fandisk" { 1.2 } else { 1.15 };
        assert_few(&model, "swept", count, most);
    }
}

/// Of rays towards a mesh and leaving it together.
fn assert_few(model: &Model, builder: &str, count: u64, most: f64) {
    let bytes = size_of_val(&*model.nodes) as f64 / model.triangles.len() as f64;
    let ways = [false, true].map(|leaving| compare(model, &rays(model, count, leaving)));
    let [[plain, compact], [other_plain, other_compact]] = ways;
    let ratio = (compact + other_compact) / (plain + other_plain);
    println!(
        "{}, {builder}: {bytes:.2} bytes a triangle; towards {compact:.2} visits, plain {plain:.2}, {:.3}; \
         leaving {other_compact:.2}, plain {other_plain:.2}, {:.3}; together {ratio:.3}",
        model.name,
        compact / plain,
        other_compact / other_plain
    );
    assert!(ratio < most, "{}, {builder}: {ratio}", model.name);
}
