//! Solids given by a function: the boundary of { p : f(p) ≤ 0 }, normals outwards along ∇f.
//!
//! Each f is written once, over any kind of number: with plain ones for marching, with dual ones for its gradient.

mod number;

use std::f64::consts::{PI, TAU};

use super::scene::Ray;
use super::vec::{Vec3, vec3};
use number::{Dual, Number};

/// A ray is followed in steps no shorter than this share of the solid's size: what is thinner along the ray may be missed.
const SHORTEST: f64 = 1e-7;
/// So many steps, and then the ray is taken to miss: only one that grazes a surface for two hundredths of the size needs more.
const STEPS: u32 = 200_000;

#[derive(Clone, Debug)]
pub enum Implicit {
    /// √((ρ − major)² + h²) − minor, with h along the unit `axis` and ρ across it.
    Torus {
        center: Vec3,
        axis: Vec3,
        major: f64,
        minor: f64,
    },
    Capsule(Capsule),
    /// Distance to the box of half extents `half` − `radius` in the frame `axes`, less `radius`.
    RoundedBox {
        center: Vec3,
        axes: [Vec3; 3],
        half: Vec3,
        radius: f64,
    },
    /// max(cell/(3π) |sin X cos Y + sin Y cos Z + sin Z cos X| − thickness/2, bound), (X, Y, Z) = 2π q / cell.
    Gyroid {
        center: Vec3,
        axes: [Vec3; 3],
        cell: f64,
        thickness: f64,
        bound: Bound,
    },
    /// threshold − Σ (1 − d²/r²)³ over the balls that are nearer than their radius.
    Metaballs {
        balls: Vec<Ball>,
        threshold: f64,
    },
    /// The parts' distances, one after the other joined by min(a, b) − max(k − |a − b|, 0)²/(4k).
    SmoothUnion {
        parts: Vec<Part>,
        k: f64,
    },
}

/// All points within `radius` of the segment.
#[derive(Clone, Copy, Debug)]
pub struct Capsule {
    pub a: Vec3,
    pub b: Vec3,
    pub radius: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub center: Vec3,
    pub radius: f64,
}

/// What cuts a gyroid, in its own frame.
#[derive(Clone, Copy, Debug)]
pub enum Bound {
    Sphere { radius: f64 },
    Box { half: Vec3 },
}

#[derive(Clone, Copy, Debug)]
pub enum Part {
    Ball(Ball),
    Capsule(Capsule),
}

/// A point, or the gradient's seed at one.
type Place<N> = [N; 3];

impl Implicit {
    /// f at a point: its sign tells the side, its size what `clearance` makes of it.
    pub fn value(&self, point: Vec3) -> f64 {
        self.field([point.x, point.y, point.z])
    }

    /// ∇f, at length one.
    pub fn normal(&self, point: Vec3) -> Vec3 {
        let axes = [vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)];
        let seeded = [0, 1, 2].map(|i| Dual {
            value: point.get(i),
            slope: axes[i],
        });
        self.field(seeded).slope.normalized()
    }

    fn field<N: Number>(&self, p: Place<N>) -> N {
        match self {
            Implicit::Torus {
                center,
                axis,
                major,
                minor,
            } => {
                let q = minus(p, *center);
                let h = along(q, *axis);
                let across = [0, 1, 2].map(|i| q[i] - h * N::from(axis.get(i)));
                let ring = length(across) - N::from(*major);
                (ring * ring + h * h).sqrt() - N::from(*minor)
            }
            Implicit::Capsule(capsule) => capsule.distance(p),
            Implicit::RoundedBox {
                center,
                axes,
                half,
                radius,
            } => {
                let q = into(p, *center, axes);
                let d = [0, 1, 2].map(|i| q[i].abs() - N::from(half.get(i) - radius));
                let zero = N::from(0.0);
                let inside = d[0].max(d[1]).max(d[2]).min(zero);
                length(d.map(|c| c.max(zero))) + inside - N::from(*radius)
            }
            Implicit::Gyroid {
                center,
                axes,
                cell,
                thickness,
                bound,
            } => {
                let q = into(p, *center, axes);
                let [x, y, z] = q.map(|c| c * N::from(TAU / cell));
                let g = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
                let wall = g.abs() * N::from(cell / (3.0 * PI)) - N::from(thickness / 2.0);
                let bound = match bound {
                    Bound::Sphere { radius } => length(q) - N::from(*radius),
                    Bound::Box { half } => {
                        let d = [0, 1, 2].map(|i| q[i].abs() - N::from(half.get(i)));
                        d[0].max(d[1]).max(d[2])
                    }
                };
                wall.max(bound)
            }
            Implicit::Metaballs { balls, threshold } => {
                let mut f = N::from(*threshold);
                for ball in balls {
                    let d = minus(p, ball.center);
                    let left = N::from(1.0) - along_self(d) * N::from(1.0 / (ball.radius * ball.radius));
                    if left.value() > 0.0 {
                        f = f - left * left * left;
                    }
                }
                f
            }
            Implicit::SmoothUnion { parts, k } => {
                let mut distances = parts.iter().map(|part| match part {
                    Part::Ball(ball) => length(minus(p, ball.center)) - N::from(ball.radius),
                    Part::Capsule(capsule) => capsule.distance(p),
                });
                let first = distances.next().unwrap_or(N::from(f64::INFINITY));
                distances.fold(first, |a, b| {
                    let overlap = (N::from(*k) - (a - b).abs()).max(N::from(0.0));
                    a.min(b) - overlap * overlap * N::from(0.25 / k)
                })
            }
        }
    }

    /// A length within which f keeps its sign around `point`, where its value is `value`.
    fn clearance(&self, point: Vec3, value: f64) -> f64 {
        match self {
            // Their slope is at most 1.
            Implicit::Torus { .. }
            | Implicit::Capsule(_)
            | Implicit::RoundedBox { .. }
            | Implicit::SmoothUnion { .. } => value.abs(),
            // The gradient of g is at most √3 long, per 2π/cell.
            Implicit::Gyroid { .. } => value.abs() * (3f64.sqrt() / 2.0),
            Implicit::Metaballs { balls, .. } => {
                // (1 − x²)³ falls by at most 96/(25√5) for each x = d/r, at x² = 1/5. Balls farther off than their radius
                // count once they are reached.
                let steepest = 96.0 / (25.0 * 5f64.sqrt());
                let mut slope = 0.0;
                let mut reach = f64::INFINITY;
                for ball in balls {
                    let beyond = (point - ball.center).length() - ball.radius;
                    if beyond < 0.0 {
                        slope += steepest / ball.radius;
                    } else {
                        reach = reach.min(beyond);
                    }
                }
                if slope > 0.0 {
                    reach = reach.min(value.abs() / slope);
                }
                reach
            }
        }
    }

    /// The smallest t > 0, up to `far`, at which the ray crosses the surface.
    ///
    /// Steps by `clearance`, as sphere tracing does (Hart 1996), until the sign of f changes within a step of `SHORTEST`; then
    /// bisection down to neighbouring numbers.
    pub fn first(&self, ray: &Ray, far: f64) -> Option<f64> {
        let (low, high) = self.bounds();
        let size = (high - low).length();
        let [enter, leave] = slabs(ray, low, high, size * SHORTEST)?;
        let end = leave.min(far);
        let mut t = enter.max(0.0);
        let mut value = self.value(ray.at(t));
        let inside = value <= 0.0;
        for _ in 0..STEPS {
            if t > end {
                break;
            }
            let step = self.clearance(ray.at(t), value).max(size * SHORTEST);
            let next = t + step;
            value = self.value(ray.at(next));
            if (value <= 0.0) != inside {
                return Some(self.bisect(ray, t, next, inside));
            }
            t = next;
        }
        None
    }

    fn bisect(&self, ray: &Ray, mut before: f64, mut after: f64, inside: bool) -> f64 {
        loop {
            let middle = before + (after - before) / 2.0;
            if middle <= before || middle >= after {
                return after;
            }
            if (self.value(ray.at(middle)) <= 0.0) == inside {
                before = middle;
            } else {
                after = middle;
            }
        }
    }

    /// Lowest and highest corner of a box that holds the solid.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let around = |center: Vec3, half: Vec3| (center - half, center + half);
        let turned = |axes: &[Vec3; 3], half: Vec3| {
            axes[0].abs() * half.x + axes[1].abs() * half.y + axes[2].abs() * half.z
        };
        let join = |a: (Vec3, Vec3), b: (Vec3, Vec3)| (a.0.min(b.0), a.1.max(b.1));
        let ball = |ball: &Ball| around(ball.center, Vec3::splat(ball.radius));
        let capsule = |c: &Capsule| {
            let radius = Vec3::splat(c.radius);
            (c.a.min(c.b) - radius, c.a.max(c.b) + radius)
        };
        let nothing = (Vec3::ZERO, Vec3::ZERO);
        match self {
            Implicit::Torus {
                center,
                axis,
                major,
                minor,
            } => {
                let reach = |c: f64| major * (1.0 - c * c).max(0.0).sqrt() + minor;
                around(*center, vec3(reach(axis.x), reach(axis.y), reach(axis.z)))
            }
            Implicit::Capsule(c) => capsule(c),
            Implicit::RoundedBox {
                center,
                axes,
                half,
                radius,
            } => {
                let radius = Vec3::splat(*radius);
                around(*center, turned(axes, *half - radius) + radius)
            }
            Implicit::Gyroid {
                center, axes, bound, ..
            } => match bound {
                Bound::Sphere { radius } => around(*center, Vec3::splat(*radius)),
                Bound::Box { half } => around(*center, turned(axes, *half)),
            },
            Implicit::Metaballs { balls, .. } => balls.iter().map(ball).reduce(join).unwrap_or(nothing),
            Implicit::SmoothUnion { parts, k } => {
                let boxes = parts.iter().map(|part| match part {
                    Part::Ball(b) => ball(b),
                    Part::Capsule(c) => capsule(c),
                });
                // Each blend takes at most k/4 off the distance.
                let grown = Vec3::splat(k / 4.0 * parts.len().saturating_sub(1) as f64);
                let (low, high) = boxes.reduce(join).unwrap_or(nothing);
                (low - grown, high + grown)
            }
        }
    }

    /// Centre and radius of a ball that holds the solid.
    pub fn ball(&self) -> (Vec3, f64) {
        match self {
            Implicit::Torus {
                center, major, minor, ..
            } => (*center, major + minor),
            Implicit::Capsule(c) => ((c.a + c.b) * 0.5, (c.b - c.a).length() / 2.0 + c.radius),
            Implicit::RoundedBox { center, half, .. } => (*center, half.length()),
            Implicit::Gyroid { center, bound, .. } => match bound {
                Bound::Sphere { radius } => (*center, *radius),
                Bound::Box { half } => (*center, half.length()),
            },
            Implicit::Metaballs { .. } | Implicit::SmoothUnion { .. } => {
                let (low, high) = self.bounds();
                ((low + high) * 0.5, (high - low).length() / 2.0)
            }
        }
    }
}

impl Capsule {
    fn distance<N: Number>(&self, p: Place<N>) -> N {
        let axis = self.b - self.a;
        let from_a = minus(p, self.a);
        let share = along(from_a, axis) * N::from(1.0 / axis.length_squared());
        let share = share.max(N::from(0.0)).min(N::from(1.0));
        let away = [0, 1, 2].map(|i| from_a[i] - share * N::from(axis.get(i)));
        length(away) - N::from(self.radius)
    }
}

fn minus<N: Number>(p: Place<N>, center: Vec3) -> Place<N> {
    [0, 1, 2].map(|i| p[i] - N::from(center.get(i)))
}

fn into<N: Number>(p: Place<N>, center: Vec3, axes: &[Vec3; 3]) -> Place<N> {
    let q = minus(p, center);
    axes.map(|axis| along(q, axis))
}

fn along<N: Number>(q: Place<N>, axis: Vec3) -> N {
    q[0] * N::from(axis.x) + q[1] * N::from(axis.y) + q[2] * N::from(axis.z)
}

fn along_self<N: Number>(q: Place<N>) -> N {
    q[0] * q[0] + q[1] * q[1] + q[2] * q[2]
}

fn length<N: Number>(q: Place<N>) -> N {
    along_self(q).sqrt()
}

/// Where the ray is inside the box grown by `pad`.
fn slabs(ray: &Ray, low: Vec3, high: Vec3, pad: f64) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        let (from, along) = (ray.origin.get(axis), ray.direction.get(axis));
        let [a, b] = [low.get(axis) - pad, high.get(axis) + pad];
        if along == 0.0 {
            if from < a || from > b {
                return None;
            }
            continue;
        }
        let [a, b] = [(a - from) / along, (b - from) / along];
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter <= leave).then_some([enter, leave])
}
