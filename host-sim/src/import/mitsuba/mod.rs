//! The subset of Mitsuba 3's XML that `DESIGN.md` names, with Mitsuba's meaning and defaults.
//!
//! `tree` walks the XML, `params` hands each element's parameters out by name and type and refuses the rest; the other
//! files are one kind of element each.

mod bsdf;
mod color;
mod emitter;
mod params;
mod sensor;
mod shape;
mod transform;
mod tree;

use std::path::Path;

use super::{ImportError, Loaded, Options, stem};
use crate::desc::{IntegratorDesc, IntegratorKind, LightDesc, SceneDesc};
use params::{Context, Params};
use tree::Element;

/// Reads a `<scene>`.
pub(super) fn load(path: &Path, options: &Options) -> Result<Loaded, ImportError> {
    let mut warnings = Vec::new();
    let root = tree::read(path, options, &mut warnings)?;
    let context = Context::new(&root, options.lenient, warnings)?;
    let mut scene = read_scene(&root, &context)?;
    scene.name = stem(path);
    Ok(Loaded {
        scene,
        warnings: context.warnings.into_inner(),
    })
}

fn read_scene<'a>(root: &'a Element, context: &Context<'a>) -> Result<SceneDesc, ImportError> {
    let params = Params::new(context, root);
    let integrator = match params.object("integrator")? {
        Some(integrator) => read_integrator(integrator, context)?,
        None => {
            context.warn(&root.error("no <integrator>; path without a depth limit is used"));
            IntegratorDesc {
                kind: IntegratorKind::Path,
                max_depth: None,
                rr_depth: 5,
                hide_emitters: false,
            }
        }
    };
    let sensor = params.object("sensor")?.ok_or_else(|| {
        root.error("the scene has no <sensor>; add <sensor type=\"perspective\"> with its to_world")
    })?;
    let sensor = sensor::read(sensor, context)?;

    let mut materials = bsdf::Materials::default();
    let mut shapes = Vec::new();
    for shape in params.objects("shape")? {
        shapes.extend(shape::read(shape, context, &mut materials)?);
    }
    let mut lights = Vec::new();
    for emitter in params.objects("emitter")? {
        let light = emitter::read(emitter, context)?;
        let surrounds =
            |light: &LightDesc| matches!(light, LightDesc::Constant { .. } | LightDesc::EnvMap { .. });
        if light.as_ref().is_some_and(surrounds) && lights.iter().any(surrounds) {
            return Err(emitter.error("a second emitter that surrounds the scene; keep one"));
        }
        lights.extend(light);
    }
    // Materials that nothing uses are read for their errors only.
    for bsdf in params.objects("bsdf")? {
        bsdf::read(bsdf, context)?;
    }
    params.finish()?;
    Ok(SceneDesc {
        name: String::new(),
        width: sensor.width,
        height: sensor.height,
        spp: sensor.spp,
        sampler: sensor.sampler,
        integrator,
        camera: sensor.camera,
        materials: materials.list,
        shapes,
        lights,
    })
}

fn read_integrator<'a>(element: &'a Element, context: &Context<'a>) -> Result<IntegratorDesc, ImportError> {
    let params = Params::new(context, element);
    let hide_emitters = params.boolean("hide_emitters")?.unwrap_or(false);
    if element.kind() == "direct" {
        params.finish()?;
        return Ok(IntegratorDesc {
            kind: IntegratorKind::Direct,
            max_depth: Some(2),
            rr_depth: 5,
            hide_emitters,
        });
    }
    if element.kind() != "path" {
        context.refuse_kind(element, &["path", "direct"])?;
    }
    // -1 is Mitsuba's word for no limit.
    let max_depth = params.integer("max_depth", -1..=1 << 16)?.unwrap_or(-1);
    let rr_depth = params.integer("rr_depth", 1..=1 << 16)?.unwrap_or(5);
    params.finish()?;
    let max_depth = u32::try_from(max_depth).ok();
    Ok(IntegratorDesc {
        kind: IntegratorKind::Path,
        max_depth,
        rr_depth: rr_depth as u32,
        hide_emitters,
    })
}
