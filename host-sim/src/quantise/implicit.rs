//! Solids given by a function in the core's numbers.

use super::rounding::{Rounding, dir};
use crate::desc::{BallDesc, BoundDesc, CapsuleDesc, ImplicitDesc, PartDesc, Vec3};
use microlux::shape::{
    Blob, Bound, Capsule, Gyroid, Implicit, MAX_BLOBS, Metaballs, RoundedBox, SmoothUnion, Torus,
};

/// Fraction bits of a metaball threshold.
const THRESHOLD_BITS: i32 = 27;

/// Rounds to nearest; what the solid is made of is put behind `blobs`. An error says what the core can't take.
pub(super) fn implicit(
    round: &Rounding,
    solid: &ImplicitDesc,
    blobs: &mut Vec<Blob>,
) -> Result<Implicit, String> {
    let flat = || "its axes lie in one direction".to_string();
    Ok(match solid {
        ImplicitDesc::Torus {
            center,
            axis,
            major,
            minor,
        } => Implicit::Torus(Torus::new(
            round.point(*center),
            dir(*axis),
            round.length(*major),
            round.length(*minor),
        )),
        ImplicitDesc::Capsule(capsule) => Implicit::Capsule(round.capsule(capsule)),
        ImplicitDesc::RoundedBox {
            center,
            axes: [x, y, _],
            half,
            radius,
        } => {
            let half = half.map(|h| round.length(h));
            let solid = RoundedBox::new(
                round.point(*center),
                dir(*x),
                dir(*y),
                half,
                round.length(*radius),
            );
            Implicit::RoundedBox(solid.ok_or_else(flat)?)
        }
        ImplicitDesc::Gyroid {
            center,
            axes: [x, y, _],
            cell,
            thickness,
            bound,
        } => gyroid(round, *center, [*x, *y], [*cell, *thickness], bound)?.ok_or_else(flat)?,
        ImplicitDesc::Metaballs { balls, threshold } => {
            let (first, count) = add(blobs, balls.iter().map(|ball| round.ball(ball)))?;
            let threshold = threshold * f64::from(THRESHOLD_BITS).exp2();
            Implicit::Metaballs(Metaballs::new(blobs, first, count, threshold.round() as u32))
        }
        ImplicitDesc::SmoothUnion { parts, k } => {
            let parts = parts.iter().map(|part| match part {
                PartDesc::Ball(ball) => round.ball(ball),
                PartDesc::Capsule(capsule) => round.capsule(capsule).into(),
            });
            let (first, count) = add(blobs, parts)?;
            Implicit::SmoothUnion(SmoothUnion::new(blobs, first, count, round.length(*k)))
        }
    })
}

fn gyroid(
    round: &Rounding,
    center: Vec3,
    axes: [Vec3; 2],
    [cell, thickness]: [f64; 2],
    bound: &BoundDesc,
) -> Result<Option<Implicit>, String> {
    let (bound, within) = match bound {
        BoundDesc::Sphere { radius } => (Bound::ball(round.length(*radius)), *radius),
        BoundDesc::Box { half } => {
            let corner = half.iter().map(|h| h * h).sum::<f64>().sqrt();
            (Bound::block(half.map(|h| round.length(h))), corner)
        }
    };
    if cell > 4.0 * within {
        return Err(format!(
            "a cell of {cell} is more than four times the {within} of its bound; make the cell smaller"
        ));
    }
    let cell = round.length(cell);
    // Both are rounded: the thickest wall there may be stays one.
    let most = (i64::from(cell) * 3 / 10) as i32;
    let thickness = round.length(thickness).min(most);
    let solid = Gyroid::new(round.point(center), axes.map(dir), cell, thickness, bound);
    Ok(solid.map(Implicit::Gyroid))
}

/// Puts the parts of one solid behind what is there: the first's index, and how many there are.
fn add(blobs: &mut Vec<Blob>, parts: impl ExactSizeIterator<Item = Blob>) -> Result<(u16, u16), String> {
    let (first, count) = (blobs.len(), parts.len());
    if count > MAX_BLOBS {
        return Err(format!(
            "is made of {count} shapes, and can be of {MAX_BLOBS}; make two of it"
        ));
    }
    let room = usize::from(u16::MAX) - count;
    if first > room {
        return Err("is made of more shapes than all solids together can have, 65535".into());
    }
    blobs.extend(parts);
    Ok((first as u16, count as u16))
}

impl Rounding {
    fn capsule(&self, capsule: &CapsuleDesc) -> Capsule {
        let CapsuleDesc { a, b, radius } = *capsule;
        Capsule::new(self.point(a), self.point(b), self.length(radius))
    }

    fn ball(&self, ball: &BallDesc) -> Blob {
        Blob::ball(self.point(ball.center), self.length(ball.radius))
    }
}
