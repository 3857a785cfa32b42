//! Vectors and affine maps in f64, as far as reading scenes needs them.

use crate::desc::{MeshDesc, Vec3};

pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scaled(a: Vec3, s: f64) -> Vec3 {
    a.map(|x| x * s)
}

pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// `a` at length 1; `None` for the zero vector and anything not finite.
pub(crate) fn unit(a: Vec3) -> Option<Vec3> {
    let length = length(a);
    (length > 0.0 && length.is_finite()).then(|| scaled(a, 1.0 / length))
}

/// Two directions at a right angle, up to rounding (1e-9 of their lengths).
pub(crate) fn perpendicular(a: Vec3, b: Vec3) -> bool {
    dot(a, b).abs() <= 1e-9 * length(a) * length(b)
}

/// Equal up to one part in a million.
pub(crate) fn alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * a.abs().max(b.abs())
}

/// `p ↦ columns · p + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Affine {
    /// Where the axes x, y and z go.
    pub columns: [Vec3; 3],
    pub translation: Vec3,
}

impl Affine {
    pub const IDENTITY: Self = Self {
        columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0; 3],
    };

    pub fn translate(by: Vec3) -> Self {
        Self {
            translation: by,
            ..Self::IDENTITY
        }
    }

    pub fn scale([x, y, z]: Vec3) -> Self {
        Self {
            columns: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]],
            ..Self::IDENTITY
        }
    }

    /// Counter-clockwise about `axis` seen from its tip (Rodrigues); `None` for an axis of length zero.
    pub fn rotate(axis: Vec3, degrees: f64) -> Option<Self> {
        let axis = unit(axis)?;
        let (sin, cos) = degrees.to_radians().sin_cos();
        let turned = |v: Vec3| {
            let along = scaled(axis, dot(axis, v) * (1.0 - cos));
            add(add(scaled(v, cos), scaled(cross(axis, v), sin)), along)
        };
        Some(Self {
            columns: Self::IDENTITY.columns.map(turned),
            ..Self::IDENTITY
        })
    }

    /// Mitsuba's frame for cameras: z towards `target`, x to the *left* of the picture, y up.
    ///
    /// `None` where `target` is `origin` or `up` is parallel to the line of sight.
    pub fn look_at(origin: Vec3, target: Vec3, up: Vec3) -> Option<Self> {
        let forward = unit(sub(target, origin))?;
        let left = cross(unit(up)?, forward);
        let left = unit(left).filter(|_| length(left) > 1e-9)?;
        Some(Self {
            columns: [left, cross(forward, left), forward],
            translation: origin,
        })
    }

    /// From a row-major matrix; `None` where the last row is not `0 0 0 1`.
    pub fn from_rows(m: [[f64; 4]; 4]) -> Option<Self> {
        let column = |i: usize| [m[0][i], m[1][i], m[2][i]];
        (m[3] == [0.0, 0.0, 0.0, 1.0]).then(|| Self {
            columns: [column(0), column(1), column(2)],
            translation: column(3),
        })
    }

    /// First `self`, then `next`.
    pub fn then(self, next: Self) -> Self {
        Self {
            columns: self.columns.map(|c| next.vector(c)),
            translation: next.point(self.translation),
        }
    }

    pub fn vector(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.columns;
        add(add(scaled(x, v[0]), scaled(y, v[1])), scaled(z, v[2]))
    }

    pub fn point(&self, p: Vec3) -> Vec3 {
        add(self.vector(p), self.translation)
    }

    /// A normal: the inverse transpose, not normalised (scaled by |determinant|).
    pub fn normal(&self, n: Vec3) -> Vec3 {
        let [x, y, z] = self.columns;
        let cofactor = Self {
            columns: [cross(y, z), cross(z, x), cross(x, y)],
            ..Self::IDENTITY
        };
        scaled(cofactor.vector(n), self.determinant().signum())
    }

    /// A mesh in its place; winding and normals keep their side, as in `RawMesh::place`.
    pub fn mesh(&self, mesh: &MeshDesc) -> MeshDesc {
        let mut triangles = mesh.triangles.clone();
        if self.determinant() < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        MeshDesc {
            vertices: mesh.vertices.iter().map(|&v| self.point(v)).collect(),
            triangles,
            normals: mesh
                .normals
                .iter()
                .map(|&n| unit(self.normal(n)).unwrap_or(n))
                .collect(),
            colors: mesh.colors.clone(),
            uvs: mesh.uvs.clone(),
        }
    }

    pub fn determinant(&self) -> f64 {
        let [x, y, z] = self.columns;
        dot(x, cross(y, z))
    }

    /// Flattens space (a scale of 0, say) or holds a number that is not finite.
    pub fn is_singular(&self) -> bool {
        let size: f64 = self.columns.iter().map(|&c| length(c)).product();
        let determinant = self.determinant().abs();
        !determinant.is_finite()
            || determinant <= 1e-12 * size
            || self.translation.iter().any(|x| !x.is_finite())
    }

    /// The scale, and where the axes point, of a transform that turns, scales and moves, and does not mirror.
    pub fn similarity(&self) -> Option<(f64, [Vec3; 3])> {
        let scale = self.uniform_scale().filter(|scale| *scale > 0.0)?;
        (self.determinant() > 0.0).then(|| (scale, self.columns.map(|axis| scaled(axis, 1.0 / scale))))
    }

    /// The scale factor where it is the same for every direction (rotation, mirroring and translation allowed).
    pub fn uniform_scale(&self) -> Option<f64> {
        let [x, y, z] = self.columns;
        let square = perpendicular_enough(x, y) && perpendicular_enough(y, z) && perpendicular_enough(z, x);
        (square && alike(length(x), length(y)) && alike(length(x), length(z))).then(|| length(x))
    }
}

/// At a right angle up to one part in a million: matrices in files carry few digits.
pub(crate) fn perpendicular_enough(a: Vec3, b: Vec3) -> bool {
    dot(a, b).abs() <= 1e-6 * length(a) * length(b)
}
