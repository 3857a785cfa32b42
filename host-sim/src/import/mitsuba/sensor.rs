//! `<sensor>`: camera, film and sampler.

use super::super::math::{Affine, alike, scaled, unit};
use super::super::{ImportError, suggest};
use super::params::{Context, Params};
use super::tree::Element;
use crate::desc::{CameraDesc, LensDesc, SamplerKind};

const KINDS: [&str; 2] = ["perspective", "thinlens"];
const FOV_AXES: [&str; 5] = ["x", "y", "smaller", "larger", "diagonal"];
const SAMPLERS: [&str; 4] = ["independent", "stratified", "multijitter", "ldsampler"];

/// The largest picture side: more would be a typing error here.
const LARGEST: i64 = 16_384;

/// A camera and the picture it takes.
pub(super) struct Sensor {
    pub camera: CameraDesc,
    pub width: u32,
    pub height: u32,
    pub spp: Option<u32>,
    pub sampler: Option<SamplerKind>,
}

pub(super) fn read<'a>(element: &'a Element, context: &Context<'a>) -> Result<Sensor, ImportError> {
    let kind = element.kind();
    if !KINDS.contains(&kind) {
        context.refuse_kind(element, &KINDS)?;
    }
    let params = Params::new(context, element);
    // Film and sampler have Mitsuba's defaults where they are not given.
    let (width, height) = match params.object("film")? {
        Some(film) => read_film(film, context)?,
        None => (768, 576),
    };
    let (sampler, spp) = match params.object("sampler")? {
        Some(sampler) => read_sampler(sampler, context).map(|(kind, count)| (Some(kind), Some(count)))?,
        None => (None, None),
    };
    // Mitsuba clips between these; here nothing does.
    params.positive("near_clip")?;
    let far_clip = params.positive("far_clip")?.unwrap_or(10_000.0);
    let fov_x = fov_x(&params, f64::from(width) / f64::from(height))?;
    let to_world = params.transform("to_world")?.unwrap_or(Affine::IDENTITY);
    let lens = match kind {
        "thinlens" => lens(&params, far_clip)?,
        _ => None,
    };
    params.finish()?;

    let scale = to_world.uniform_scale();
    if !scale.is_some_and(|scale| alike(scale, 1.0)) {
        context.refuse(
            element,
            "a camera's to_world must not scale or shear; use lookat, rotate and translate",
        )?;
    }
    let [left, up, forward] = orthonormal(to_world);
    let camera = CameraDesc {
        origin: to_world.translation,
        right: scaled(left, -1.0),
        up,
        forward,
        fov_x,
        lens,
    };
    Ok(Sensor {
        camera,
        width,
        height,
        spp,
        sampler,
    })
}

/// The frame of a transform, exact at right angles even where the file's digits are not.
fn orthonormal(to_world: Affine) -> [[f64; 3]; 3] {
    use super::super::math::{cross, dot};
    let [x, y, z] = to_world.columns;
    let forward = unit(z).unwrap_or([0.0, 0.0, 1.0]);
    let left = unit(cross(y, forward)).unwrap_or([1.0, 0.0, 0.0]);
    let up = cross(forward, left);
    let left = if dot(left, x) < 0.0 {
        scaled(left, -1.0)
    } else {
        left
    };
    [left, up, forward]
}

/// Degrees over the picture's width, from `fov` along its `fov_axis`, or from a 35 mm camera's `focal_length`.
fn fov_x(params: &Params, aspect: f64) -> Result<f64, ImportError> {
    let fov = params.checked("fov", "above 0 and below 180 degrees", |f| f > 0.0 && f < 180.0)?;
    let axis = params.string("fov_axis")?;
    let focal_length = params.string("focal_length")?;
    let along = |axis: &str, degrees: f64| {
        let tan = (degrees.to_radians() / 2.0).tan();
        let tan_x = match axis {
            "y" => tan * aspect,
            "smaller" if aspect > 1.0 => tan * aspect,
            "larger" if aspect < 1.0 => tan * aspect,
            "diagonal" => tan * aspect / aspect.hypot(1.0),
            _ => tan,
        };
        (2.0 * tan_x.atan()).to_degrees()
    };
    if let Some((at, other)) = axis.filter(|(_, axis)| !FOV_AXES.contains(axis)) {
        return Err(at.error(format!(
            "fov_axis \"{other}\" is not known; {}",
            suggest::advice(other, &FOV_AXES)
        )));
    }
    match (fov, focal_length) {
        (Some(_), Some((at, _))) => {
            Err(at.error("both fov and focal_length are given; keep one".to_string()))
        }
        (Some(fov), None) => Ok(along(axis.map_or("x", |(_, axis)| axis), fov)),
        (None, given) => {
            let millimetres = match given {
                None => 50.0,
                Some((at, text)) => {
                    let number = text.trim().trim_end_matches("mm").trim_end().parse::<f64>();
                    number.ok().filter(|f| *f > 0.0 && f.is_finite()).ok_or_else(|| {
                        at.error(format!(
                            "focal_length \"{text}\" is not a length; write, say, \"50mm\""
                        ))
                    })?
                }
            };
            // The diagonal of a 36 × 24 mm film.
            Ok(along(
                "diagonal",
                (2.0 * (36.0_f64.hypot(24.0) / 2.0 / millimetres).atan()).to_degrees(),
            ))
        }
    }
}

/// A lens of no width is a pinhole.
fn lens(params: &Params, far_clip: f64) -> Result<Option<LensDesc>, ImportError> {
    let aperture_radius = params
        .checked("aperture_radius", "0 or more", |r| r >= 0.0)?
        .ok_or_else(|| {
            let message =
                "thinlens needs <float name=\"aperture_radius\" value=\"...\"/>; add it, or use perspective";
            params.element.error(message)
        })?;
    let focus_distance = params.positive("focus_distance")?.unwrap_or(far_clip);
    Ok((aperture_radius > 0.0).then_some(LensDesc {
        aperture_radius,
        focus_distance,
    }))
}

/// Width and height.
fn read_film<'a>(film: &'a Element, context: &Context<'a>) -> Result<(u32, u32), ImportError> {
    if film.kind() != "hdrfilm" {
        context.refuse_kind(film, &["hdrfilm"])?;
    }
    let params = Params::new(context, film);
    let width = params.integer("width", 1..=LARGEST)?.unwrap_or(768);
    let height = params.integer("height", 1..=LARGEST)?.unwrap_or(576);
    match params.object("rfilter")? {
        Some(filter) if filter.kind() == "box" => Params::new(context, filter).finish()?,
        Some(filter) => context.refuse_kind(filter, &["box"])?,
        None => {
            let message = "no <rfilter>: Mitsuba would blur with a gaussian, here it is box; \
                           add <rfilter type=\"box\"/> to say so";
            context.warn(&film.error(message));
        }
    }
    params.finish()?;
    Ok((width as u32, height as u32))
}

fn read_sampler<'a>(sampler: &'a Element, context: &Context<'a>) -> Result<(SamplerKind, u32), ImportError> {
    let kind = match sampler.kind() {
        "independent" => SamplerKind::Independent,
        "stratified" => SamplerKind::Stratified,
        "multijitter" => SamplerKind::Cmj,
        "ldsampler" => SamplerKind::Sobol,
        _ => {
            context.refuse_kind(sampler, &SAMPLERS)?;
            SamplerKind::Independent
        }
    };
    let params = Params::new(context, sampler);
    let count = params.integer("sample_count", 1..=1 << 24)?.unwrap_or(4);
    params.finish()?;
    Ok((kind, count as u32))
}
