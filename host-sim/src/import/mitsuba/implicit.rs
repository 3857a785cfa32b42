//! `<shape>`s given by a function, which are our own: torus, capsule, rounded box, gyroid, metaballs, smooth union.
//!
//! What they mean stands at `ImplicitDesc`. `to_world` may turn, move, mirror and scale uniformly.

use super::super::ImportError;
use super::super::math::{Affine, cross, dot, scaled, sub, unit};
use super::params::{Context, Params};
use super::tree::Element;
use crate::desc::{BallDesc, BoundDesc, CapsuleDesc, ImplicitDesc, PartDesc, Vec3};

pub(super) const KINDS: [&str; 6] = [
    "torus",
    "capsule",
    "roundedbox",
    "gyroid",
    "metaballs",
    "smoothunion",
];

/// The thickest wall of a gyroid, in cells: at 1/π there would be no holes left.
const THICKEST: f64 = 0.3;

/// A rigid map and a scale.
struct Place {
    map: Affine,
    scale: f64,
}

impl Place {
    fn of(element: &Element, map: Affine) -> Result<Place, ImportError> {
        let scale = map.uniform_scale().ok_or_else(|| {
            let kind = element.kind();
            element.error(format!(
                "a {kind} scaled differently along its axes is not supported; scale it uniformly"
            ))
        })?;
        Ok(Place { map, scale })
    }

    /// Where the axes go: orthonormal and right-handed, exactly so up to rounding.
    ///
    /// A mirroring map is made right-handed by turning all three axes round, which changes no solid that is its own point
    /// reflection, as boxes and gyroids are.
    fn axes(&self) -> [Vec3; 3] {
        let [x, y, _] = self.map.columns;
        let x = unit(x).unwrap_or([1.0, 0.0, 0.0]);
        let y = unit(sub(y, scaled(x, dot(x, y)))).unwrap_or([0.0, 1.0, 0.0]);
        if self.map.determinant() < 0.0 {
            let (x, y) = (scaled(x, -1.0), scaled(y, -1.0));
            return [x, y, cross(x, y)];
        }
        [x, y, cross(x, y)]
    }
}

pub(super) fn read<'a>(
    element: &'a Element,
    to_world: &Affine,
    params: &Params<'_, 'a>,
    context: &Context<'a>,
) -> Result<ImplicitDesc, ImportError> {
    let place = Place::of(element, *to_world)?;
    match element.kind() {
        "torus" => torus(&place, params),
        "capsule" => Ok(ImplicitDesc::Capsule(capsule(&place, params)?)),
        "roundedbox" => rounded_box(&place, params),
        "gyroid" => gyroid(&place, params),
        "metaballs" => {
            let balls = parts(element, &place, params, context, &["sphere"])?;
            let balls = balls.into_iter().filter_map(|part| match part {
                PartDesc::Ball(ball) => Some(ball),
                PartDesc::Capsule(_) => None,
            });
            let threshold = params.checked("threshold", "above 0 and below 1", |t| t > 0.0 && t < 1.0)?;
            Ok(ImplicitDesc::Metaballs {
                balls: balls.collect(),
                threshold: threshold.unwrap_or(0.5),
            })
        }
        _ => {
            let parts = parts(element, &place, params, context, &["sphere", "capsule"])?;
            let k = params.positive("smoothness")?.ok_or_else(|| {
                let message =
                    "smoothunion needs <float name=\"smoothness\" value=\"...\"/>, how far apart surfaces melt; add it";
                element.error(message)
            })?;
            Ok(ImplicitDesc::SmoothUnion {
                parts,
                k: k * place.scale,
            })
        }
    }
}

fn torus(place: &Place, params: &Params) -> Result<ImplicitDesc, ImportError> {
    let element = params.element;
    let center = params.triple("center")?.unwrap_or([0.0; 3]);
    let axis = params.triple("axis")?.unwrap_or([0.0, 0.0, 1.0]);
    let axis = unit(place.map.vector(axis))
        .ok_or_else(|| element.error("the torus's axis is zero; point it somewhere, such as 0, 0, 1"))?;
    let major = params.positive("major_radius")?.unwrap_or(1.0);
    let minor = params.positive("minor_radius")?.unwrap_or(0.25);
    if minor >= major {
        let message = format!(
            "minor_radius {minor} closes the hole of a torus of major_radius {major}; make it smaller"
        );
        return Err(element.error(message));
    }
    Ok(ImplicitDesc::Torus {
        center: place.map.point(center),
        axis,
        major: major * place.scale,
        minor: minor * place.scale,
    })
}

/// `p0`, `p1` and `radius`, as Mitsuba's cylinder has them.
fn capsule(place: &Place, params: &Params) -> Result<CapsuleDesc, ImportError> {
    let a = params.triple("p0")?.unwrap_or([0.0; 3]);
    let b = params.triple("p1")?.unwrap_or([0.0, 0.0, 1.0]);
    if a == b {
        let message = "p0 and p1 are the same point; move one of them, or use a sphere";
        return Err(params.element.error(message));
    }
    let radius = params.positive("radius")?.unwrap_or(1.0);
    Ok(CapsuleDesc {
        a: place.map.point(a),
        b: place.map.point(b),
        radius: radius * place.scale,
    })
}

fn ball(place: &Place, params: &Params) -> Result<BallDesc, ImportError> {
    let center = params.triple("center")?.unwrap_or([0.0; 3]);
    let radius = params.positive("radius")?.unwrap_or(1.0);
    Ok(BallDesc {
        center: place.map.point(center),
        radius: radius * place.scale,
    })
}

/// Half of each side; each is above 0.
fn half_extents(params: &Params) -> Result<Option<Vec3>, ImportError> {
    let Some(half) = params.triple("half_extents")? else {
        return Ok(None);
    };
    if !half.iter().all(|h| *h > 0.0 && h.is_finite()) {
        let [x, y, z] = half;
        let message = format!("half_extents {x}, {y}, {z} is out of range; each must be above 0");
        return Err(params.element.error(message));
    }
    Ok(Some(half))
}

fn rounded_box(place: &Place, params: &Params) -> Result<ImplicitDesc, ImportError> {
    let center = params.triple("center")?.unwrap_or([0.0; 3]);
    let half = half_extents(params)?.unwrap_or([1.0; 3]);
    let radius = params.positive("radius")?.unwrap_or(0.1);
    let least = half.into_iter().fold(f64::INFINITY, f64::min);
    if radius > least {
        let message =
            format!("radius {radius} is more than the least of half_extents, {least}; make it smaller");
        return Err(params.element.error(message));
    }
    Ok(ImplicitDesc::RoundedBox {
        center: place.map.point(center),
        axes: place.axes(),
        half: half.map(|h| h * place.scale),
        radius: radius * place.scale,
    })
}

fn gyroid(place: &Place, params: &Params) -> Result<ImplicitDesc, ImportError> {
    let element = params.element;
    let center = params.triple("center")?.unwrap_or([0.0; 3]);
    let cell = params.positive("cell_size")?.unwrap_or(1.0);
    let thickness = params.positive("thickness")?.unwrap_or(0.1 * cell);
    if thickness > THICKEST * cell {
        let most = THICKEST * cell;
        let message =
            format!("thickness {thickness} leaves no holes; at most {most} goes with cell_size {cell}");
        return Err(element.error(message));
    }
    let bound = match (params.positive("radius")?, half_extents(params)?) {
        (Some(radius), None) => BoundDesc::Sphere {
            radius: radius * place.scale,
        },
        (None, Some(half)) => BoundDesc::Box {
            half: half.map(|h| h * place.scale),
        },
        (None, None) => {
            let message = "a gyroid goes on for ever; bound it by a radius (sphere) or by half_extents (box)";
            return Err(element.error(message));
        }
        (Some(_), Some(_)) => {
            return Err(element.error("both radius and half_extents bound the gyroid; keep one"));
        }
    };
    Ok(ImplicitDesc::Gyroid {
        center: place.map.point(center),
        axes: place.axes(),
        cell: cell * place.scale,
        thickness: thickness * place.scale,
        bound,
    })
}

/// The nested `<shape>`s, placed by their own `to_world` and then by the whole's.
fn parts<'a>(
    element: &'a Element,
    place: &Place,
    params: &Params<'_, 'a>,
    context: &Context<'a>,
    kinds: &[&str],
) -> Result<Vec<PartDesc>, ImportError> {
    let mut parts = Vec::new();
    for part in params.objects("shape")? {
        if !kinds.contains(&part.kind()) {
            context.refuse_kind(part, kinds)?;
            continue;
        }
        let params = Params::new(context, part);
        let to_world = params.transform("to_world")?.unwrap_or(Affine::IDENTITY);
        let placed = Place::of(part, to_world.then(place.map))?;
        parts.push(match part.kind() {
            "sphere" => PartDesc::Ball(ball(&placed, &params)?),
            _ => PartDesc::Capsule(capsule(&placed, &params)?),
        });
        params.finish()?;
    }
    if parts.is_empty() {
        let (whole, kind) = (element.kind(), kinds[0]);
        return Err(element.error(format!("{whole} holds no <shape>; put a {kind} in it")));
    }
    Ok(parts)
}
