//! `<emitter>` outside of shapes: points, directions, and what surrounds the scene.

use super::super::math::{Affine, alike, unit};
use super::super::{ImportError, picture};
use super::color::Quantity;
use super::params::{Context, Params};
use super::tree::Element;
use crate::desc::{LightDesc, Vec3};

const KINDS: [&str; 4] = ["point", "directional", "constant", "envmap"];

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
    Ok(LightDesc::EnvMap {
        width,
        height,
        pixels: picture.pixels,
        to_world: to_world.columns,
    })
}
