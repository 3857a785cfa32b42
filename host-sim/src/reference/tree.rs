//! A bounding-box tree over triangles: split at the median centre along the longest axis.

use super::scene::Ray;
use super::vec::Vec3;

/// Deeper than any median tree over 2^32 triangles.
const STACK: usize = 64;

#[derive(Clone, Debug)]
pub struct Tree {
    nodes: Vec<Node>,
    /// Triangle indices, leaf by leaf.
    order: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// A leaf: `count` entries of `order` from `first`. Else `count` is 0 and the children are `left` and `first`.
    first: u32,
    count: u32,
    left: u32,
    axis: u8,
}

impl Tree {
    /// A tree with at most `leaf` triangles to a leaf.
    ///
    /// Boxes are padded by 1e-9 of the mesh's diagonal. The triangle test rounds by about 1e-16 of the distance to the
    /// ray's origin, so up to a million diagonals away no ray that hits a triangle misses its box.
    pub fn new(vertices: &[Vec3], triangles: &[[u32; 3]], leaf: usize) -> Tree {
        let boxes: Vec<(Vec3, Vec3)> = triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize]);
                (a.min(b).min(c), a.max(b).max(c))
            })
            .collect();
        let mut tree = Tree {
            nodes: Vec::new(),
            order: (0..triangles.len() as u32).collect(),
        };
        if !boxes.is_empty() {
            let (low, high) = around(&boxes, &tree.order);
            let pad = Vec3::splat((high - low).length() * 1e-9);
            tree.split(&boxes, 0, triangles.len(), leaf, pad);
        }
        tree
    }

    fn split(&mut self, boxes: &[(Vec3, Vec3)], start: usize, end: usize, leaf: usize, pad: Vec3) -> u32 {
        let (low, high) = around(boxes, &self.order[start..end]);
        let axis = (high - low).largest_axis();
        let index = self.nodes.len();
        let (first, count) = (start as u32, (end - start) as u32);
        self.nodes.push(Node {
            low: low - pad,
            high: high + pad,
            first,
            count,
            left: 0,
            axis: axis as u8,
        });
        if end - start > leaf {
            let middle = start + (end - start) / 2;
            let center_2x = |&index: &u32| {
                let (low, high) = boxes[index as usize];
                low.get(axis) + high.get(axis)
            };
            self.order[start..end]
                .select_nth_unstable_by(middle - start, |a, b| center_2x(a).total_cmp(&center_2x(b)));
            let left = self.split(boxes, start, middle, leaf, pad);
            let right = self.split(boxes, middle, end, leaf, pad);
            self.nodes[index] = Node {
                first: right,
                count: 0,
                left,
                ..self.nodes[index]
            };
        }
        index as u32
    }

    /// Calls `test(triangle, far)` for each triangle whose box the ray meets before `far`, roughly near to far; `test`
    /// answers with the new `far`.
    pub fn visit(&self, ray: &Ray, mut far: f64, mut test: impl FnMut(u32, f64) -> f64) {
        if self.nodes.is_empty() {
            return;
        }
        let d = ray.direction;
        let inverse = Vec3 {
            x: 1.0 / d.x,
            y: 1.0 / d.y,
            z: 1.0 / d.z,
        };
        let mut stack = [0u32; STACK];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let node = &self.nodes[stack[height] as usize];
            if !node.meets(ray.origin, inverse, far) {
                continue;
            }
            if node.count > 0 {
                for &triangle in &self.order[node.first as usize..][..node.count as usize] {
                    far = test(triangle, far);
                }
            } else {
                let backwards = d.get(node.axis as usize) < 0.0;
                let (near, other) = if backwards {
                    (node.first, node.left)
                } else {
                    (node.left, node.first)
                };
                stack[height] = other;
                stack[height + 1] = near;
                height += 2;
            }
        }
    }
}

impl Node {
    /// Kay and Kajiya's slabs. A ray within a face (0·∞ is NaN) may pass or fail: the face is padding, nothing is there.
    fn meets(&self, origin: Vec3, inverse: Vec3, far: f64) -> bool {
        let a = (self.low - origin) * inverse;
        let b = (self.high - origin) * inverse;
        let (enter, leave) = (a.min(b), a.max(b));
        let enter = enter.x.max(enter.y).max(enter.z).max(0.0);
        let leave = leave.x.min(leave.y).min(leave.z).min(far);
        enter <= leave
    }
}

fn around(boxes: &[(Vec3, Vec3)], indices: &[u32]) -> (Vec3, Vec3) {
    let empty = (Vec3::splat(f64::INFINITY), Vec3::splat(f64::NEG_INFINITY));
    indices.iter().fold(empty, |(low, high), &index| {
        let (l, h) = boxes[index as usize];
        (low.min(l), high.max(h))
    })
}
