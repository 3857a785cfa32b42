//! The subset of Mitsuba 3's XML that `DESIGN.md` names, with Mitsuba's meaning and defaults.
//!
//! `tree` walks the XML, `params` hands each element's parameters out by name and type and refuses the rest; the other
//! files are one kind of element each.

mod bsdf;
mod color;
mod emitter;
mod implicit;
mod instance;
mod params;
mod sensor;
mod shape;
mod texture;
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
        notes: Vec::new(),
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
                ao_radius: None,
            }
        }
    };
    let sensor = params.object("sensor")?.ok_or_else(|| {
        root.error("the scene has no <sensor>; add <sensor type=\"perspective\"> with its to_world")
    })?;
    let sensor = sensor::read(sensor, context)?;

    let mut materials = bsdf::Materials::default();
    let mut shapes = Vec::new();
    let mut groups = instance::Groups::default();
    for shape in params.objects("shape")? {
        shapes.extend(shape::read(shape, context, &mut materials, &mut groups)?);
    }
    let mut lights = Vec::new();
    for emitter in params.objects("emitter")? {
        let light = emitter::read(emitter, context)?;
        let surrounds = |light: &LightDesc| {
            matches!(
                light,
                LightDesc::Constant { .. } | LightDesc::Gradient { .. } | LightDesc::EnvMap { .. }
            )
        };
        if light.as_ref().is_some_and(surrounds) && lights.iter().any(surrounds) {
            return Err(emitter.error("a second emitter that surrounds the scene; keep one"));
        }
        lights.extend(light);
    }
    // Textures and materials that nothing uses are read for their errors only.
    for element in params.objects("texture")? {
        texture::read(element, context)?;
    }
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
        baked: None,
    })
}

const INTEGRATORS: [&str; 5] = ["path", "direct", "ao", "bdpt", "light"];

fn read_integrator<'a>(element: &'a Element, context: &Context<'a>) -> Result<IntegratorDesc, ImportError> {
    let params = Params::new(context, element);
    let mut integrator = IntegratorDesc {
        kind: IntegratorKind::Path,
        max_depth: None,
        rr_depth: 5,
        hide_emitters: false,
        ao_radius: None,
    };
    if element.kind() == "ao" {
        integrator.kind = IntegratorKind::Ao;
        integrator.ao_radius = params.positive("radius")?;
        params.finish()?;
        return Ok(integrator);
    }
    integrator.hide_emitters = params.boolean("hide_emitters")?.unwrap_or(false);
    if element.kind() == "direct" {
        integrator.kind = IntegratorKind::Direct;
        integrator.max_depth = Some(2);
        params.finish()?;
        return Ok(integrator);
    }
    integrator.kind = match element.kind() {
        "bdpt" => IntegratorKind::Bdpt,
        "light" => IntegratorKind::Light,
        "path" => IntegratorKind::Path,
        _ => {
            context.refuse_kind(element, &INTEGRATORS)?;
            IntegratorKind::Path
        }
    };
    // -1 is Mitsuba's word for no limit.
    let max_depth = params.integer("max_depth", -1..=1 << 16)?.unwrap_or(-1);
    integrator.max_depth = u32::try_from(max_depth).ok();
    integrator.rr_depth = params.integer("rr_depth", 1..=1 << 16)?.unwrap_or(5) as u32;
    params.finish()?;
    Ok(integrator)
}
