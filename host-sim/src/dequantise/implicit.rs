//! Solids given by a function as the core holds them, in f64.

use super::{Frame, dir};
use crate::reference::{Ball, Bound, Capsule, Implicit, Part, Vec3};
use microlux::geom::Dir;
use microlux::shape::Blob;

/// Fraction bits of a metaball threshold.
const THRESHOLD_BITS: i32 = 27;

pub(super) fn implicit(frame: &Frame, solid: &microlux::shape::Implicit, blobs: &[Blob]) -> Implicit {
    use microlux::shape::Implicit as Core;
    let parts = |first: u16, count: u16| blobs.iter().skip(first.into()).take(count.into());
    match solid {
        Core::Torus(torus) => Implicit::Torus {
            center: frame.point(torus.center),
            axis: dir(torus.axis).normalized(),
            major: frame.length(torus.major),
            minor: frame.length(torus.minor),
        },
        Core::Capsule(capsule) => Implicit::Capsule(frame.capsule(&Blob::from(*capsule))),
        Core::RoundedBox(block) => Implicit::RoundedBox {
            center: frame.point(block.center),
            axes: axes(block.x, block.y),
            half: frame.lengths(block.half),
            radius: frame.length(block.radius),
        },
        Core::Gyroid(gyroid) => Implicit::Gyroid {
            center: frame.point(gyroid.center),
            axes: axes(gyroid.x, gyroid.y),
            cell: frame.length(gyroid.cell),
            thickness: frame.length(gyroid.thickness),
            bound: match gyroid.bound.radius() {
                Some(radius) => Bound::Sphere {
                    radius: frame.length(radius),
                },
                None => Bound::Box {
                    half: frame.lengths(gyroid.bound.half()),
                },
            },
        },
        Core::Metaballs(balls) => Implicit::Metaballs {
            balls: parts(balls.first, balls.count)
                .map(|ball| frame.ball(ball))
                .collect(),
            threshold: f64::from(balls.threshold()) * f64::from(-THRESHOLD_BITS).exp2(),
        },
        Core::SmoothUnion(union) => {
            let part = |part: &Blob| match part.is_ball() {
                true => Part::Ball(frame.ball(part)),
                false => Part::Capsule(frame.capsule(part)),
            };
            Implicit::SmoothUnion {
                parts: parts(union.first, union.count).map(part).collect(),
                k: frame.length(union.k),
            }
        }
    }
}

/// Orthonormal, x as it stands but for its length, and right-handed.
fn axes(x: Dir, y: Dir) -> [Vec3; 3] {
    let (x, y) = (dir(x).normalized(), dir(y));
    let y = (y - x * x.dot(y)).normalized();
    [x, y, x.cross(y)]
}

impl Frame {
    fn lengths(&self, units: [i32; 3]) -> Vec3 {
        units.map(|c| self.length(c)).into()
    }

    fn ball(&self, ball: &Blob) -> Ball {
        Ball {
            center: self.point(ball.a),
            radius: self.length(ball.radius),
        }
    }

    fn capsule(&self, part: &Blob) -> Capsule {
        Capsule {
            a: self.point(part.a),
            b: self.point(part.b),
            radius: self.length(part.radius),
        }
    }
}
