//! `<transform>`: steps in the order of the file, each applied after the ones before it.

use super::super::ImportError;
use super::super::math::{Affine, length, sub, unit};
use super::params::{Context, number, numbers, value};
use super::tree::Element;
use crate::desc::Vec3;

const STEPS: [&str; 5] = ["translate", "rotate", "scale", "lookat", "matrix"];

pub(super) fn read(element: &Element, context: &Context) -> Result<Affine, ImportError> {
    let mut whole = Affine::IDENTITY;
    for child in &element.children {
        let step = match child.tag.as_str() {
            "translate" => Affine::translate(triple(child)?.map(|x| x.unwrap_or(0.0))),
            "scale" => Affine::scale(triple(child)?.map(|x| x.unwrap_or(1.0))),
            "rotate" => rotate(child, context)?,
            "lookat" => look_at(child)?,
            "matrix" => matrix(child)?,
            _ => {
                let steps = super::super::suggest::list(&STEPS);
                context.refuse(
                    child,
                    format!("{} cannot stand in a <transform>; use {steps}", child.describe()),
                )?;
                continue;
            }
        };
        whole = whole.then(step);
    }
    if whole.is_singular() {
        return Err(element.error("the transform flattens space; let no scale be 0".to_string()));
    }
    Ok(whole)
}

/// `value="x, y, z"`, `value="all"`, or x, y, z of which some may be missing.
pub(super) fn triple(element: &Element) -> Result<[Option<f64>; 3], ImportError> {
    let axes = ["x", "y", "z"].map(|axis| element.attribute(axis));
    let Some(text) = element.attribute("value") else {
        let mut found = [None; 3];
        for (slot, axis) in found.iter_mut().zip(axes) {
            *slot = axis.map(|text| number(element, text)).transpose()?;
        }
        return Ok(found);
    };
    if axes.iter().any(Option::is_some) {
        return Err(element.error(format!(
            "{} has both value and x, y, z; keep one way",
            element.describe()
        )));
    }
    match numbers(element, text)?[..] {
        [all] => Ok([Some(all); 3]),
        [x, y, z] => Ok([Some(x), Some(y), Some(z)]),
        ref other => {
            let holder = element.describe();
            Err(element.error(format!(
                "{holder} has {} numbers; write one or three",
                other.len()
            )))
        }
    }
}

fn rotate(element: &Element, context: &Context) -> Result<Affine, ImportError> {
    let axis = triple(element)?.map(|x| x.unwrap_or(0.0));
    let angle = number(element, element.attribute("angle").unwrap_or_default())?;
    let Some([x, y, z]) = unit(axis) else {
        return Err(
            element.error("the axis of rotation is zero; write x=\"1\", y=\"1\" or z=\"1\"".to_string())
        );
    };
    if (length(axis) - 1.0).abs() > 1e-5 {
        let advice = format!("write x=\"{x:.9}\" y=\"{y:.9}\" z=\"{z:.9}\"");
        context.refuse(
            element,
            format!("the axis is not of length 1, with which Mitsuba distorts; {advice}"),
        )?;
    }
    Affine::rotate(axis, angle).ok_or_else(|| element.error("the axis of rotation is zero; write x=\"1\""))
}

fn look_at(element: &Element) -> Result<Affine, ImportError> {
    let vector = |name: &str| -> Result<Option<Vec3>, ImportError> {
        let Some(text) = element.attribute(name) else {
            return Ok(None);
        };
        match numbers(element, text)?[..] {
            [x, y, z] => Ok(Some([x, y, z])),
            ref other => Err(element.error(format!("{name} has {} numbers; write three", other.len()))),
        }
    };
    let origin = vector("origin")?.unwrap_or_default();
    let target = vector("target")?.unwrap_or_default();
    let forward = unit(sub(target, origin))
        .ok_or_else(|| element.error("lookat's target is its origin; move one of them".to_string()))?;
    let up = vector("up")?
        .filter(|up| *up != [0.0; 3])
        .unwrap_or_else(|| any_perpendicular(forward));
    Affine::look_at(origin, target, up)
        .ok_or_else(|| element.error("lookat's up points along the line of sight; turn it".to_string()))
}

/// Mitsuba's choice where `up` is not given: the first vector of the frame in Duff et al., "Building an Orthonormal
/// Basis, Revisited", JCGT 6(1), 2017, listing 3.
fn any_perpendicular([x, y, z]: Vec3) -> Vec3 {
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    [1.0 + sign * x * x * a, sign * x * y * a, -sign * x]
}

fn matrix(element: &Element) -> Result<Affine, ImportError> {
    let given = numbers(element, value(element))?;
    let side = match given.len() {
        9 => 3,
        16 => 4,
        other => return Err(element.error(format!("matrix has {other} numbers; write 9 or 16, row by row"))),
    };
    let mut rows = [[0.0; 4]; 4];
    rows[3][3] = 1.0;
    for (row, numbers) in rows.iter_mut().zip(given.chunks(side)) {
        row[..side].copy_from_slice(numbers);
    }
    Affine::from_rows(rows)
        .ok_or_else(|| element.error("the matrix is a projection; let its last row be 0 0 0 1".to_string()))
}
