//! `<texture>`: pictures, checkerboards, and the colours of a mesh's vertices.

use std::sync::Arc;

use super::super::math::Affine;
use super::super::{ImportError, texture};
use super::color::Quantity;
use super::params::{Context, Params};
use super::tree::Element;
use crate::desc::{TextureDesc, TintDesc};

const KINDS: [&str; 3] = ["bitmap", "checkerboard", "mesh_attribute"];

/// `None` for a kind that is left out.
pub(super) fn read<'a>(element: &'a Element, context: &Context<'a>) -> Result<Option<TintDesc>, ImportError> {
    let params = Params::new(context, element);
    let tint = match element.kind() {
        "bitmap" => TintDesc::Texture {
            texture: bitmap(&params)?,
            to_uv: to_uv(&params)?,
        },
        "checkerboard" => TintDesc::Texture {
            texture: checkerboard(&params)?,
            to_uv: to_uv(&params)?,
        },
        "mesh_attribute" => {
            match params.string("name")? {
                Some((_, "vertex_color")) => {}
                Some((at, other)) => {
                    let message = format!("attribute \"{other}\" is not supported; use vertex_color");
                    return Err(at.error(message));
                }
                None => return Err(element.error("mesh_attribute names none; use vertex_color")),
            }
            TintDesc::Vertices
        }
        _ => {
            context.refuse_kind(element, &KINDS)?;
            return Ok(None);
        }
    };
    params.finish()?;
    Ok(Some(tint))
}

fn to_uv(params: &Params) -> Result<[[f64; 3]; 2], ImportError> {
    let Affine {
        columns: [x, y, _],
        translation,
    } = params.transform("to_uv")?.unwrap_or(Affine::IDENTITY);
    Ok([0, 1].map(|i| [x[i], y[i], translation[i]]))
}

fn bitmap(params: &Params) -> Result<Arc<TextureDesc>, ImportError> {
    let Some((at, filename)) = params.string("filename")? else {
        let message = "bitmap names no file; add <string name=\"filename\" value=\"...\"/>";
        return Err(params.element.error(message));
    };
    let nearest = match params.string("filter_type")? {
        None | Some((_, "bilinear")) => false,
        Some((_, "nearest")) => true,
        Some((at, other)) => {
            return Err(at.error(format!(
                "filter \"{other}\" is not known; write bilinear or nearest"
            )));
        }
    };
    if let Some((at, mode)) = params.string("wrap_mode")?
        && mode != "repeat"
    {
        params.refuse(
            at,
            format!("wrap_mode \"{mode}\" is not supported; textures repeat"),
        )?;
    }
    let raw = params.boolean("raw")?.unwrap_or(false);
    let path = at.resolve(filename);
    let bytes = std::fs::read(&path).map_err(|error| ImportError::io(&path, &error))?;
    texture::decode(filename, &bytes, nearest, raw).map_err(|what| ImportError::new(&path, what))
}

/// Two by two in the unit square: `color0` where both halves are the same.
fn checkerboard(params: &Params) -> Result<Arc<TextureDesc>, ImportError> {
    let color = |name, default: f64| {
        let given = params.color(name, Quantity::Reflectance)?;
        Ok::<_, ImportError>(given.unwrap_or([default; 3]))
    };
    let (first, second) = (color("color0", 0.4)?, color("color1", 0.2)?);
    Ok(Arc::new(TextureDesc {
        name: params.element.name(),
        width: 2,
        height: 2,
        texels: vec![first, second, second, first],
        nearest: true,
    }))
}
