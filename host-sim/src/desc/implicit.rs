//! Surfaces that are the zero set of a function: what their words mean, to the last constant.
//!
//! Each shape is the boundary of the solid { p : f(p) ≤ 0 }; its normal is along ∇f, outwards. All lengths are metres in
//! the world, where the file's transforms have put them. In the formulas, q = (q₀, q₁, q₂) is p in the shape's own frame:
//! qᵢ = (p − center)·axes[i].

use super::Vec3;

/// A closed surface given by a function.
#[derive(Clone, Debug, PartialEq)]
pub enum ImplicitDesc {
    /// Ring of circular cross-section: with h = (p − center)·axis and ρ = |p − center − h axis|,
    /// f = √((ρ − major)² + h²) − minor. 0 < minor < major; `axis` has length 1. |∇f| = 1.
    Torus {
        center: Vec3,
        axis: Vec3,
        /// Radius of the circle in the middle of the tube.
        major: f64,
        /// Radius of the tube.
        minor: f64,
    },
    /// All points within `radius` of the segment from a to b: with s = clamp((p − a)·(b − a) / |b − a|², 0, 1),
    /// f = |p − a − s (b − a)| − radius. a ≠ b. |∇f| = 1.
    Capsule(CapsuleDesc),
    /// A box rolled around by a ball: with dᵢ = |qᵢ| − (halfᵢ − radius),
    /// f = |max(d, 0)| + min(max(d₀, d₁, d₂), 0) − radius, max(d, 0) taken by component. `half` is half the box's extent
    /// *with* its rounding; 0 < radius ≤ min(half). |∇f| = 1 outside of the inner box.
    RoundedBox {
        center: Vec3,
        /// Orthonormal and right-handed.
        axes: [Vec3; 3],
        half: Vec3,
        radius: f64,
    },
    /// A wall along Schoen's gyroid, cut by a bound: with Xᵢ = 2π qᵢ / cell and
    /// g = sin X₀ cos X₁ + sin X₁ cos X₂ + sin X₂ cos X₀,
    /// f = max(cell/(3π) |g| − thickness/2, bound), where `bound` is |q| − radius for the sphere and
    /// maxᵢ(|qᵢ| − halfᵢ) for the box. |∇| of the first term is at most 2/√3, and between 2√2/3 and 2/√3 where g = 0, so
    /// that a thin wall is `thickness` thick within a seventh (2 % less on the average). 0 < thickness ≤ 0.3 cell.
    Gyroid {
        center: Vec3,
        /// Orthonormal and right-handed.
        axes: [Vec3; 3],
        /// Period along each axis.
        cell: f64,
        thickness: f64,
        bound: BoundDesc,
    },
    /// Blobs that flow together: f = threshold − Σ (1 − d²/r²)³ over the balls with d < r, where d is the distance of p to
    /// the ball's centre and r its radius of influence (Wyvill's kind of kernel). 0 < threshold < 1, so that no ball is
    /// lost: alone it shows as a sphere of radius r √(1 − ∛threshold). |∇f| of one ball is at most 1.7173 / r
    /// (96/(25√5), at d = r/√5).
    Metaballs { balls: Vec<BallDesc>, threshold: f64 },
    /// Spheres and capsules with filled creases: f = s(… s(s(f₀, f₁), f₂) …), in the file's order, where
    /// s(a, b) = min(a, b) − max(k − |a − b|, 0)² / (4k) (the quadratic polynomial minimum) and fᵢ are the parts' own
    /// distances. k > 0: surfaces closer than about k melt. |∇f| ≤ 1.
    SmoothUnion { parts: Vec<PartDesc>, k: f64 },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapsuleDesc {
    pub a: Vec3,
    pub b: Vec3,
    pub radius: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallDesc {
    pub center: Vec3,
    pub radius: f64,
}

/// What a gyroid is cut to, about its centre and in its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoundDesc {
    Sphere { radius: f64 },
    Box { half: Vec3 },
}

/// A part of a smooth union; a ball's own distance is |p − center| − radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartDesc {
    Ball(BallDesc),
    Capsule(CapsuleDesc),
}

impl ImplicitDesc {
    /// Corners of a box that holds the solid, parallel to the world's axes: tight but for the smooth union, whose parts'
    /// boxes are grown by k/4 a blend, and the metaballs, whose balls' boxes are those of their influence.
    pub fn bounds(&self) -> [Vec3; 2] {
        match self {
            ImplicitDesc::Torus {
                center,
                axis,
                major,
                minor,
            } => around(
                *center,
                axis.map(|c| major * (1.0 - c * c).max(0.0).sqrt() + minor),
            ),
            ImplicitDesc::Capsule(capsule) => capsule.bounds(),
            ImplicitDesc::RoundedBox {
                center,
                axes,
                half,
                radius,
            } => {
                let inner = half.map(|h| h - radius);
                around(*center, reach(axes, inner).map(|h| h + radius))
            }
            ImplicitDesc::Gyroid {
                center, axes, bound, ..
            } => match bound {
                BoundDesc::Sphere { radius } => around(*center, [*radius; 3]),
                BoundDesc::Box { half } => around(*center, reach(axes, *half)),
            },
            ImplicitDesc::Metaballs { balls, .. } => join(balls.iter().map(BallDesc::bounds)),
            ImplicitDesc::SmoothUnion { parts, k } => {
                let boxes = parts.iter().map(|part| match part {
                    PartDesc::Ball(ball) => ball.bounds(),
                    PartDesc::Capsule(capsule) => capsule.bounds(),
                });
                let [low, high] = join(boxes);
                let grown = k / 4.0 * (parts.len().saturating_sub(1)) as f64;
                [low.map(|c| c - grown), high.map(|c| c + grown)]
            }
        }
    }
}

impl BallDesc {
    fn bounds(&self) -> [Vec3; 2] {
        around(self.center, [self.radius; 3])
    }
}

impl CapsuleDesc {
    fn bounds(&self) -> [Vec3; 2] {
        join([self.a, self.b].map(|end| around(end, [self.radius; 3])))
    }
}

fn around(center: Vec3, half: Vec3) -> [Vec3; 2] {
    [
        [0, 1, 2].map(|i| center[i] - half[i]),
        [0, 1, 2].map(|i| center[i] + half[i]),
    ]
}

/// Half the extent, along the world's axes, of a box turned into `axes`.
fn reach(axes: &[Vec3; 3], half: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| (0..3).map(|a| axes[a][i].abs() * half[a]).sum())
}

fn join(boxes: impl IntoIterator<Item = [Vec3; 2]>) -> [Vec3; 2] {
    let empty = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    boxes.into_iter().fold(empty, |[low, high], [l, h]| {
        [
            [0, 1, 2].map(|i| low[i].min(l[i])),
            [0, 1, 2].map(|i| high[i].max(h[i])),
        ]
    })
}
