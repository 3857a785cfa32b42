//! `<emitter>` outside of shapes: points, directions, and what surrounds the scene.

use super::super::math::{Affine, alike, unit};
use super::super::{ImportError, picture};
use super::color::Quantity;
use super::params::{Context, Params};
use super::tree::Element;
use crate::desc::{LightDesc, SunDesc, Vec3};

const KINDS: [&str; 5] = ["point", "directional", "constant", "gradient", "envmap"];

/// The light; `None` for one that is left out with a warning.
pub(super) fn read<'a>(
    element: &'a Element,
    context: &Context<'a>,
) -> Result<Option<LightDesc>, ImportError> {
    let params = Params::new(context, element);
    let light = match element.kind() {
        "point" => {
            let position = one_of(&params, "position")?;
            let position = match position {
                (Some(position), _) => position,
                (None, to_world) => to_world.translation,
            };
            LightDesc::Point {
                position,
                intensity: emission(&params, "intensity")?,
            }
        }
        "directional" => {
            let direction = match one_of(&params, "direction")? {
                (Some(direction), _) => direction,
                (None, to_world) => to_world.columns[2],
            };
            let direction = unit(direction)
                .ok_or_else(|| element.error("the direction is zero; point it somewhere".to_string()))?;
            LightDesc::Directional {
                direction,
                irradiance: emission(&params, "irradiance")?,
            }
        }
        "constant" => LightDesc::Constant {
            radiance: emission(&params, "radiance")?,
        },
        "gradient" => gradient(&params)?,
        "envmap" => environment(&params)?,
        "area" => {
            context.refuse(element, "an area emitter is part of a shape; move it into one")?;
            return Ok(None);
        }
        _ => {
            context.refuse_kind(element, &KINDS)?;
            return Ok(None);
        }
    };
    params.finish()?;
    Ok(Some(light))
}

fn emission(params: &Params, name: &'static str) -> Result<Vec3, ImportError> {
    Ok(params.color(name, Quantity::Emission)?.unwrap_or([1.0; 3]))
}

/// Where the light is said by `name` or by `to_world`, but not by both.
fn one_of(params: &Params, name: &'static str) -> Result<(Option<Vec3>, Affine), ImportError> {
    match (params.triple(name)?, params.transform("to_world")?) {
        (Some(_), Some(_)) => Err(params
            .element
            .error(format!("both {name} and to_world are given; keep one"))),
        (given, to_world) => Ok((given, to_world.unwrap_or(Affine::IDENTITY))),
    }
}

/// Our own: zenith, horizon, ground (the horizon's where it is not given), `up` or `to_world` (which turns +y up, and the
/// sun with it), and the sun where it has a direction.
fn gradient(params: &Params) -> Result<LightDesc, ImportError> {
    let element = params.element;
    let (up, to_world) = one_of(params, "up")?;
    if !to_world.uniform_scale().is_some_and(|scale| alike(scale, 1.0)) {
        return Err(element.error("a gradient can be turned but not scaled; leave the scale out"));
    }
    let up = up.unwrap_or(to_world.vector([0.0, 1.0, 0.0]));
    let up = unit(up).ok_or_else(|| element.error("up is zero; point it somewhere, such as 0, 1, 0"))?;
    let needed = |name: &'static str| {
        params.color(name, Quantity::Emission)?.ok_or_else(|| {
            element.error(format!(
                "gradient needs its {name}; add <rgb name=\"{name}\" value=\"...\"/>"
            ))
        })
    };
    let (zenith, horizon) = (needed("zenith")?, needed("horizon")?);
    let ground = params.color("ground", Quantity::Emission)?.unwrap_or(horizon);
    let sun = sun(params, &to_world)?;
    Ok(LightDesc::Gradient {
        zenith,
        horizon,
        ground,
        up,
        sun,
    })
}

fn sun(params: &Params, to_world: &Affine) -> Result<Option<SunDesc>, ImportError> {
    let element = params.element;
    let direction = params.triple("sun_direction")?;
    let radiance = params.color("sun_radiance", Quantity::Emission)?;
    let irradiance = params.color("sun_irradiance", Quantity::Emission)?;
    let angle = params.checked("sun_angle", "above 0 and at most 90 degrees", |a| {
        a > 0.0 && a <= 90.0
    })?;
    let Some(direction) = direction else {
        return if radiance.or(irradiance).is_some() || angle.is_some() {
            let message =
                "the sun has no direction; add <vector name=\"sun_direction\" value=\"...\"/>, towards it";
            Err(element.error(message))
        } else {
            Ok(None)
        };
    };
    let direction = unit(to_world.vector(direction))
        .ok_or_else(|| element.error("sun_direction is zero; point it at the sun"))?;
    // The sun's own diameter on an average day.
    let angle = angle.unwrap_or(0.533);
    let radiance = match (radiance, irradiance) {
        (Some(radiance), None) => radiance,
        (None, Some(irradiance)) => {
            let sin = (angle.to_radians() / 2.0).sin();
            irradiance.map(|e| e / (std::f64::consts::PI * sin * sin))
        }
        (Some(_), Some(_)) => {
            return Err(element.error("both sun_radiance and sun_irradiance are given; keep one"));
        }
        (None, None) => {
            let message = "the sun gives no light; add <rgb name=\"sun_irradiance\" value=\"...\"/>";
            return Err(element.error(message));
        }
    };
    Ok(Some(SunDesc {
        direction,
        radiance,
        angle,
    }))
}

fn environment(params: &Params) -> Result<LightDesc, ImportError> {
    let element = params.element;
    let to_world = params.transform("to_world")?.unwrap_or(Affine::IDENTITY);
    if !to_world.uniform_scale().is_some_and(|scale| alike(scale, 1.0)) {
        return Err(element.error("an envmap can be turned but not scaled; leave the scale out".to_string()));
    }
    let scale = params.checked("scale", "0 or more", |s| s >= 0.0)?.unwrap_or(1.0);
    let Some((at, filename)) = params.string("filename")? else {
        return Err(
            element.error("envmap names no file; add <string name=\"filename\" value=\"...\"/>".to_string())
        );
    };
    let path = at.resolve(filename);
    if !path.is_file() {
        return Err(at.error(format!("no file {}; check the name", path.display())));
    }
    let mut picture = picture::read(&path)?;
    picture
        .pixels
        .iter_mut()
        .for_each(|pixel| *pixel = pixel.map(|c| c * scale));
    let (width, height) = (picture.width, picture.height);
    if width < 2 || height < 2 {
        let message = format!("a picture of {width} x {height} has no sky in it; use one of 2 x 2 or more");
        return Err(at.error(message));
    }
    Ok(LightDesc::EnvMap {
        width,
        height,
        pixels: picture.pixels,
        to_world: to_world.columns,
    })
}
