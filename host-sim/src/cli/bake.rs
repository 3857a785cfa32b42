//! `host-sim bake`.

use std::io::{self, Write};
use std::path::Path;

use serde_json::json;

use super::args::BakeArgs;
use super::progress::Meter;
use super::render::Output;
use super::table::{Table, grouped};
use super::{Failure, source, stop, terminal};
use crate::bake::{self, Aligned};
use crate::code;
use crate::flash::{self, Flash, Part, ScenePart};
use crate::picture::{Format, Style, Target, display_pixels};
use crate::quantise::CoreScene;
use crate::run::{self, Options};

/// Pixels across and samples of the preview.
const PREVIEW: (u32, u32) = (240, 16);

pub fn bake(args: &BakeArgs) -> Result<(), Failure> {
    let of_run = |error| Failure::of_run(&args.scene.scene, error);
    let desc = source::load(&args.scene, args.quiet)?;
    let blob = Target::check(&args.output)?;
    let rust = args.rust.as_deref().map(Target::check).transpose()?;
    let scene_rust = args.scene_rust.as_deref().map(Target::check).transpose()?;
    let json = args.json.as_deref().map(Target::check).transpose()?;
    let preview = args.preview.as_deref().map(Output::check).transpose()?;
    if let Some(wrong) = preview.as_ref().filter(|output| output.format() != Format::Png) {
        let path = wrong.target.path().display();
        return Err(Failure::Wrong(format!("{path}: a preview is a .png; name it so")));
    }
    let stop = stop::on_ctrl_c()?;
    let is_whole = !args.meshes_only && scene_rust.is_none() && !is_mesh(&args.scene.scene);
    let flash = flash::bake(&desc, is_whole).map_err(of_run)?;
    if flash.meshes.is_empty() && args.meshes_only {
        let none = "it has no mesh to bake; without --meshes-only the whole scene is";
        return Err(of_run(run::Error::Scene(none.to_string())));
    }
    let code = match &scene_rust {
        Some(_) => {
            let core = CoreScene::new(&desc).map_err(|error| of_run(error.into()))?;
            Some(code::rust(&desc, &core).map_err(of_run)?)
        }
        None => None,
    };
    let (width, spp) = PREVIEW;
    let options = Options {
        width,
        height: (width * desc.height / desc.width.max(1)).clamp(1, run::MAX_SIDE),
        spp,
        ..Options::for_scene(&desc)
    };
    let meter = Meter::new("preview", args.quiet);
    let seen = match flash.scene {
        Some(_) => flash::scene(&desc.name, Aligned::new(&flash.bytes))
            .map_err(run::Error::Scene)
            .and_then(|baked| run::render_fixed(&baked, &options, &meter, &stop)),
        None => run::render_baked(&desc, &flash.bytes, &options, &meter, &stop),
    };
    meter.finish();
    let (picture, _) = seen.map_err(of_run)?;

    blob.write(&flash.bytes)?;
    if let Some(target) = &rust {
        let name = if is_whole { "SCENE" } else { "MESHES" };
        target.write(bake::rust(&flash.bytes, name).as_bytes())?;
    }
    if let (Some(target), Some(code)) = (&scene_rust, &code) {
        target.write(code.as_bytes())?;
    }
    if let Some(target) = &json {
        target.write(format!("{:#}\n", as_json(&desc.name, &flash)).as_bytes())?;
    }
    if let Some(output) = &preview {
        output.write(&picture, &Style::default())?;
    }
    if args.quiet {
        return Ok(());
    }
    terminal::show(picture.width, picture.height, &display_pixels(&picture, 0.0));
    let written = args.output.display();
    writeln!(io::stdout(), "{}written to {written}", as_text(&flash))?;
    Ok(())
}

/// Whether a file has a mesh alone, no scene.
fn is_mesh(file: &str) -> bool {
    let ending = Path::new(file).extension().unwrap_or_default();
    ["obj", "ply"]
        .iter()
        .any(|mesh| ending.eq_ignore_ascii_case(mesh))
}

fn as_json(scene: &str, flash: &Flash) -> serde_json::Value {
    let sum = |of: fn(&Part) -> usize| flash.meshes.iter().map(of).sum::<usize>();
    json!({
        "scene": scene,
        "triangles": sum(|part| part.triangles),
        "bytes_total": flash.bytes.len(),
        "bytes_bvh": sum(|part| part.nodes),
        "bytes_geometry": sum(|part| part.treelets + part.vertices + part.leaves),
        "bytes_scene": flash.scene.map_or(0, |scene| scene.bytes),
        "meshes": flash.meshes.iter().map(|part| json!({
            "name": part.name,
            "triangles": part.triangles,
            "bytes_nodes": part.nodes,
            "bytes_treelets": part.treelets,
            "bytes_vertices": part.vertices,
            "bytes_leaves": part.leaves,
            "bytes_a_triangle": part.bytes() as f64 / part.triangles as f64,
            "displacement_worst": part.displacement[0],
            "displacement_rms": part.displacement[1],
            "extent": part.extent,
            "sah_cost": part.sah[0],
            "sah_cost_exact": part.sah[1],
        })).collect::<Vec<_>>(),
    })
}

fn as_text(flash: &Flash) -> String {
    let mut text = String::new();
    for part in &flash.meshes {
        let each = |bytes: usize| format!("{:.2}", bytes as f64 / part.triangles as f64);
        let row = |name: &str, bytes: usize| [name.to_string(), grouped(bytes as u64), each(bytes)];
        let mut table = Table::default();
        table
            .row([
                part.name.clone(),
                "bytes".into(),
                format!("each of {} triangles", grouped(part.triangles as u64)),
            ])
            .row(row("nodes", part.nodes))
            .row(row("treelets", part.treelets))
            .row(row("vertices", part.vertices))
            .row(row("leaves", part.leaves))
            .row(row("in all", part.bytes()));
        let [worst, rms] = part.displacement;
        let share = 100.0 / part.extent;
        let [rounded, exact] = part.sah;
        text += &table.text();
        text += &format!(
            "vertices moved by {worst:.2e} m at most ({:.4} % of the extent), {rms:.2e} m RMS\n\
             tree: {rounded:.2} nodes and triangles a ray by the surface area heuristic, {exact:.2} with exact boxes\n\n",
            worst * share
        );
    }
    if let Some(ScenePart {
        bytes,
        room: [shapes, materials, lights, lent],
    }) = flash.scene
    {
        let bytes = grouped(bytes as u64);
        text += &format!(
            "{bytes} bytes of shapes, materials, lights and the rest, for a Room::<{shapes}, {materials}, {lights}, {lent}>\n"
        );
    }
    text + &format!("{} bytes in all, ", grouped(flash.bytes.len() as u64))
}
