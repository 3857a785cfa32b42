//! Triangles: a watertight test for one, a linear scan and a bounding-box tree over many.
//!
//! The test is Woop, Benthin and Wald's ("Watertight Ray/Triangle Intersection", JCGT 2013): a vertex is sheared to a
//! point that depends on that vertex and the ray alone, so the two sides of a shared edge see the edge function with
//! opposite signs exactly, and a ray on the edge hits at least one of them.

use super::scene::Ray;
use super::tree::Tree;
use super::vec::{Rgb, Vec3};

/// Meshes up to this many triangles are scanned one by one (after one test of the bounding box).
const LINEAR_UP_TO: usize = 32;

/// Triangles, counter-clockwise seen from the side of the normal.
#[derive(Clone, Debug)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<Vec3>,
    colors: Vec<Rgb>,
    uvs: Vec<[f64; 2]>,
    tree: Tree,
}

/// A hit on one triangle. `weights` are the barycentric coordinates of its three vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    pub t: f64,
    pub triangle: u32,
    pub weights: [f64; 3],
}

impl Mesh {
    /// `normals`: one a vertex (any length but zero) for smooth shading, or empty for flat faces.
    ///
    /// # Panics
    /// If a triangle names a vertex that is not there, or `normals` is neither empty nor as long as `vertices`.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>, normals: Vec<Vec3>) -> Mesh {
        assert!(
            normals.is_empty() || normals.len() == vertices.len(),
            "one normal a vertex, or none"
        );
        let inside = |index: &u32| (*index as usize) < vertices.len();
        assert!(
            triangles.iter().flatten().all(inside),
            "a triangle names a vertex that is not there"
        );
        let leaf = if triangles.len() <= LINEAR_UP_TO {
            LINEAR_UP_TO
        } else {
            4
        };
        let tree = Tree::new(&vertices, &triangles, leaf);
        Mesh {
            vertices,
            triangles,
            normals,
            colors: Vec::new(),
            uvs: Vec::new(),
            tree,
        }
    }

    /// With a colour and a place in a texture for each vertex, or none.
    ///
    /// # Panics
    /// If a list is neither empty nor as long as the vertices'.
    pub fn with_tints(self, colors: Vec<Rgb>, uvs: Vec<[f64; 2]>) -> Mesh {
        let fits = |length: usize| length == 0 || length == self.vertices.len();
        assert!(fits(colors.len()) && fits(uvs.len()), "one a vertex, or none");
        Mesh { colors, uvs, ..self }
    }

    /// The colour between the corners' of a hit; white without any.
    pub fn color(&self, hit: &TriangleHit) -> Rgb {
        if self.colors.is_empty() {
            return Rgb::ONE;
        }
        let [a, b, c] = self.triangles[hit.triangle as usize].map(|vertex| self.colors[vertex as usize]);
        a * hit.weights[0] + b * hit.weights[1] + c * hit.weights[2]
    }

    /// The place in a texture between the corners' of a hit.
    pub fn uv(&self, hit: &TriangleHit) -> [f64; 2] {
        if self.uvs.is_empty() {
            return [0.0; 2];
        }
        let corners = self.triangles[hit.triangle as usize].map(|vertex| self.uvs[vertex as usize]);
        [0, 1].map(|i| {
            (0..3)
                .map(|corner| corners[corner][i] * hit.weights[corner])
                .sum()
        })
    }

    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Lowest and highest corner; `None` without triangles.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let corners = || (0..self.triangles.len() as u32).flat_map(|index| self.corners(index));
        Some((corners().reduce(Vec3::min)?, corners().reduce(Vec3::max)?))
    }

    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        let [a, b, c] = self.triangles[triangle as usize];
        [
            self.vertices[a as usize],
            self.vertices[b as usize],
            self.vertices[c as usize],
        ]
    }

    /// Normal of the face times twice its area.
    pub fn double_area_normal(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Unit normal interpolated from the vertices, or `None` for flat faces (and where the normals cancel).
    pub fn shading_normal(&self, hit: &TriangleHit) -> Option<Vec3> {
        if self.normals.is_empty() {
            return None;
        }
        let [a, b, c] =
            self.triangles[hit.triangle as usize].map(|vertex| self.normals[vertex as usize].normalized());
        let sum = a * hit.weights[0] + b * hit.weights[1] + c * hit.weights[2];
        (sum.length_squared() > 0.0).then(|| sum.normalized())
    }

    /// The hit nearest to the origin with 0 < t <= `far`; of equal distances the lowest triangle.
    pub fn closest(&self, ray: &Ray, far: f64) -> Option<TriangleHit> {
        let shear = Shear::new(ray);
        let mut best: Option<TriangleHit> = None;
        self.tree.visit(ray, far, |index, far| {
            if let Some(hit) = shear.triangle(self.corners(index), index, far)
                && best.is_none_or(|best| hit.nearer_than(&best))
            {
                best = Some(hit);
            }
            best.map_or(far, |best| best.t)
        });
        best
    }

    /// The same as `closest`, by looking at every triangle: what the tree is tested against.
    pub fn closest_linear(&self, ray: &Ray, far: f64) -> Option<TriangleHit> {
        let shear = Shear::new(ray);
        let hits = (0..self.triangles.len() as u32)
            .filter_map(|index| shear.triangle(self.corners(index), index, far));
        hits.reduce(|best, hit| if hit.nearer_than(&best) { hit } else { best })
    }

    /// Whether anything is hit with 0 < t <= `far`.
    pub fn occludes(&self, ray: &Ray, far: f64) -> bool {
        let shear = Shear::new(ray);
        let mut found = false;
        self.tree.visit(ray, far, |index, far| {
            found = found || shear.triangle(self.corners(index), index, far).is_some();
            if found { f64::NEG_INFINITY } else { far }
        });
        found
    }
}

impl TriangleHit {
    fn nearer_than(&self, other: &TriangleHit) -> bool {
        self.t < other.t || (self.t == other.t && self.triangle < other.triangle)
    }
}

/// The shear and permutation of axes that turn a ray into the positive z axis.
struct Shear {
    origin: Vec3,
    axes: [usize; 3],
    shear: [f64; 3],
}

impl Shear {
    fn new(ray: &Ray) -> Shear {
        let z = ray.direction.abs().largest_axis();
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let along = ray.direction.get(z);
        let shear = [
            ray.direction.get(x) / along,
            ray.direction.get(y) / along,
            1.0 / along,
        ];
        Shear {
            origin: ray.origin,
            axes: [x, y, z],
            shear,
        }
    }

    fn apply(&self, vertex: Vec3) -> [f64; 3] {
        let relative = vertex - self.origin;
        let (x, y, z) = (
            relative.get(self.axes[0]),
            relative.get(self.axes[1]),
            relative.get(self.axes[2]),
        );
        [x - self.shear[0] * z, y - self.shear[1] * z, self.shear[2] * z]
    }

    /// 0 < t <= `far`, so that a hit as far as the best one so far can still win by its index.
    fn triangle(&self, corners: [Vec3; 3], triangle: u32, far: f64) -> Option<TriangleHit> {
        let (a, b, c) = (
            self.apply(corners[0]),
            self.apply(corners[1]),
            self.apply(corners[2]),
        );
        let edges = [edge(b, c), edge(c, a), edge(a, b)];
        if edges.iter().any(|&e| e < 0.0) && edges.iter().any(|&e| e > 0.0) {
            return None;
        }
        let sum = edges[0] + edges[1] + edges[2];
        if sum == 0.0 {
            return None;
        }
        let weights = edges.map(|e| e / sum);
        let t = weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2];
        (t > 0.0 && t <= far).then_some(TriangleHit { t, triangle, weights })
    }
}

/// Twice the signed area that the origin spans with the edge from `a` to `b`.
fn edge(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::super::rng::Rng;
    use super::super::vec::vec3;
    use super::super::warp;
    use super::*;

    fn random_point(rng: &mut Rng) -> Vec3 {
        vec3(rng.uniform(), rng.uniform(), rng.uniform()) * 2.0 - Vec3::ONE
    }

    fn random_direction(rng: &mut Rng) -> Vec3 {
        warp::cone(rng.pair(), 2.0)
    }

    /// Many small triangles anywhere, and some pairs that lie on each other.
    fn confetti(count: u32, rng: &mut Rng) -> Mesh {
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        for index in 0..count {
            let center = random_point(rng);
            vertices.extend([(); 3].map(|()| center + random_point(rng) * 0.3));
            triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
            if index % 5 == 0 {
                triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
            }
        }
        Mesh::new(vertices, triangles, vec![])
    }

    /// A closed surface: a grid of latitudes and longitudes, bent to `radius(direction)`.
    fn globe(bands: u32, radius: impl Fn(Vec3) -> f64) -> Mesh {
        let columns = 2 * bands;
        let mut vertices = vec![vec3(0.0, 0.0, radius(vec3(0.0, 0.0, 1.0)))];
        for band in 1..bands {
            for column in 0..columns {
                let (sin, cos) = (std::f64::consts::PI * f64::from(band) / f64::from(bands)).sin_cos();
                let (y, x) = (std::f64::consts::TAU * f64::from(column) / f64::from(columns)).sin_cos();
                let direction = vec3(sin * x, sin * y, cos);
                vertices.push(direction * radius(direction));
            }
        }
        let south = vertices.len() as u32;
        vertices.push(vec3(0.0, 0.0, -radius(vec3(0.0, 0.0, -1.0))));
        let at = |band: u32, column: u32| match band {
            0 => 0,
            band if band == bands => south,
            band => 1 + (band - 1) * columns + column % columns,
        };
        let mut triangles = Vec::new();
        for band in 0..bands {
            for column in 0..columns {
                let [a, b] = [at(band, column), at(band, column + 1)];
                let [c, d] = [at(band + 1, column), at(band + 1, column + 1)];
                triangles.extend(
                    [[a, c, d], [a, d, b]]
                        .into_iter()
                        .filter(|t| t[0] != t[1] && t[1] != t[2] && t[0] != t[2]),
                );
            }
        }
        Mesh::new(vertices, triangles, vec![])
    }

    fn assert_tree_is_linear(mesh: &Mesh, ray: &Ray) -> bool {
        let linear = mesh.closest_linear(ray, f64::INFINITY);
        assert_eq!(mesh.closest(ray, f64::INFINITY), linear, "{ray:?}");
        assert_eq!(mesh.occludes(ray, f64::INFINITY), linear.is_some(), "{ray:?}");
        if let Some(hit) = linear {
            assert_eq!(mesh.closest(ray, hit.t), linear);
            assert_eq!(
                mesh.occludes(ray, hit.t * 0.999),
                mesh.closest_linear(ray, hit.t * 0.999).is_some()
            );
        }
        linear.is_some()
    }

    #[test]
    fn the_tree_finds_what_the_linear_scan_finds() {
        let mut rng = Rng::new(11, 0);
        for count in [5, 30, 400] {
            let mesh = confetti(count, &mut rng);
            let hits = (0..4000).filter(|_| {
                let ray = Ray {
                    origin: random_point(&mut rng) * 1.5,
                    direction: random_direction(&mut rng),
                };
                assert_tree_is_linear(&mesh, &ray)
            });
            assert!(hits.count() > 20);
        }
    }

    #[test]
    fn the_tree_finds_it_along_the_axes_and_through_vertices_too() {
        let mut rng = Rng::new(12, 0);
        let mesh = globe(12, |d| 1.0 + 0.2 * (5.0 * d.x).sin());
        let axes = [vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)];
        for index in 0..mesh.vertices.len() {
            for axis in axes.into_iter().flat_map(|axis| [axis, -axis]) {
                assert_tree_is_linear(
                    &mesh,
                    &Ray {
                        origin: mesh.vertices[index] - axis * 3.0,
                        direction: axis,
                    },
                );
            }
            let direction = random_direction(&mut rng);
            let origin = mesh.vertices[index] - direction * 2.0;
            assert_tree_is_linear(&mesh, &Ray { origin, direction });
        }
    }

    #[test]
    fn no_ray_slips_out_through_an_edge_or_a_vertex() {
        let mesh = globe(12, |_| 1.0);
        let mut rng = Rng::new(13, 0);
        for _ in 0..20_000 {
            let triangle = rng.below(mesh.triangles.len()) as u32;
            let [a, b, _] = mesh.corners(triangle);
            let along = [0.0, 1.0, rng.uniform()][rng.below(3)];
            let origin = random_point(&mut rng) * 0.4;
            let direction = (a + (b - a) * along - origin).normalized();
            assert!(
                mesh.occludes(&Ray { origin, direction }, f64::INFINITY),
                "{origin:?} {direction:?}"
            );
        }
    }

    #[test]
    fn smooth_normals_point_from_the_centre_of_a_globe() {
        let flat = globe(12, |_| 2.0);
        let mesh = Mesh::new(
            flat.vertices.clone(),
            flat.triangles.clone(),
            flat.vertices.clone(),
        );
        let mut rng = Rng::new(14, 0);
        for _ in 0..1000 {
            let ray = Ray {
                origin: Vec3::ZERO,
                direction: random_direction(&mut rng),
            };
            let hit = mesh.closest(&ray, f64::INFINITY).expect("closed");
            assert!(flat.shading_normal(&hit).is_none());
            assert!((mesh.shading_normal(&hit).expect("smooth") - ray.direction).length() < 1e-14);
            // The winding gives outward faces.
            assert!(mesh.double_area_normal(hit.triangle).dot(ray.direction) > 0.0);
        }
    }
}
