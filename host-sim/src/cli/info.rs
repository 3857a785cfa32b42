//! `host-sim info`.

use std::io::{self, Write};
use std::path::Path;

use serde_json::{Map, Value};

use super::args::InfoArgs;
use super::table::{Table, grouped};
use super::{Failure, source};
use crate::flash;
use crate::picture::Target;
use crate::run::{self, Info, Options};

pub fn info(args: &InfoArgs) -> Result<(), Failure> {
    let desc = source::load(&args.scene, false)?;
    let options = args.settings.options(&desc);
    let json = args.json.as_deref().map(Target::check).transpose()?;
    let of_run = |error| Failure::of_run(&args.scene.scene, error);
    let mut info = run::describe(&desc, &options).map_err(of_run)?;
    let path = Path::new(&args.scene.scene);
    let is_baked = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("mlx"));
    if is_baked && desc.baked.is_none() {
        // As they are baked, not as they were taken apart to be shown.
        [info.bytes_geometry, info.bytes_bvh] = flash::bytes(path).map_err(of_run)?;
        info.bytes_normals = 0;
    }
    if let Some(target) = &json {
        let text = format!("{:#}\n", Value::Object(as_json(&desc.name, &info)));
        target.write(text.as_bytes())?;
    }
    io::stdout().write_all(as_text(&desc.name, &options, &info).as_bytes())?;
    Ok(())
}

/// One flat object; numbers but for `scene`.
fn as_json(scene: &str, info: &Info) -> Map<String, Value> {
    let numbers = [
        ("triangles", info.triangles),
        ("shapes", info.shapes),
        ("meshes", info.meshes),
        ("materials", info.materials),
        ("lights", info.lights),
        ("nodes", info.nodes),
        ("bvh_depth", info.bvh_depth),
        ("bytes_geometry", info.bytes_geometry),
        ("bytes_bvh", info.bytes_bvh),
        ("bytes_normals", info.bytes_normals),
        ("bytes_rest", info.bytes_rest),
        ("bytes_total", info.bytes_total()),
        ("ram_bytes", info.ram_bytes()),
    ];
    let mut map: Map<String, Value> = numbers
        .map(|(key, value)| (key.to_string(), value.into()))
        .into_iter()
        .collect();
    map.insert("unit".to_string(), info.unit.into());
    map.insert("scene".to_string(), scene.into());
    map
}

fn as_text(scene: &str, options: &Options, info: &Info) -> String {
    let count = |value: usize| grouped(value as u64);
    let mut counts = Table::default();
    counts
        .row(["shapes", &count(info.shapes)])
        .row(["meshes", &count(info.meshes)])
        .row(["triangles", &count(info.triangles)])
        .row(["materials", &count(info.materials)])
        .row(["lights", &count(info.lights)])
        .row(["BVH nodes", &count(info.nodes)])
        .row(["BVH depth", &count(info.bvh_depth)]);

    let [low, high] = &info.bounds;
    let mut extent = Table::default();
    extent.row(["metres", "x", "y", "z"]);
    for (label, corner) in [("from", low), ("to", high)] {
        let [x, y, z] = corner.map(|x| format!("{x:.3}"));
        extent.row([label.to_string(), x, y, z]);
    }

    let mut formats = String::new();
    let widest = info
        .formats
        .iter()
        .map(|(role, _)| role.len())
        .max()
        .unwrap_or(0)
        .max("scene step".len());
    formats += &format!("{:widest$}  {:.3e} m\n", "scene step", info.unit);
    for (role, format) in &info.formats {
        formats += &format!("{role:widest$}  {format}\n");
    }

    let mut bytes = Table::default();
    bytes
        .row(["flash", "bytes"])
        .row(["geometry", &count(info.bytes_geometry)])
        .row(["BVH", &count(info.bytes_bvh)])
        .row(["normals", &count(info.bytes_normals)])
        .row(["materials, lights, rest", &count(info.bytes_rest)])
        .row(["in all", &count(info.bytes_total())]);

    let mut ram = Table::default();
    ram.row(["RAM", "bytes"]);
    for (part, size) in &info.ram {
        ram.row([*part, &count(*size)]);
    }
    ram.row(["in all", &count(info.ram_bytes())]);

    let title = format!(
        "{scene}: {} pixels wide, {} rows a tile",
        options.width, options.tile_height
    );
    let parts = [counts.text(), extent.text(), formats, bytes.text(), ram.text()];
    format!("{title}\n\n{}", parts.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::tests::desc;

    fn sample() -> Info {
        Info {
            shapes: 10,
            meshes: 1,
            triangles: 69_451,
            materials: 3,
            lights: 2,
            nodes: 17_000,
            bvh_depth: 11,
            bounds: [[-1.0, 0.0, -2.5], [1.0, 2.0, 12.25]],
            unit: 1.0 / 1_048_576.0,
            formats: vec![
                ("position", "i32".to_string()),
                ("direction", "I2F14".to_string()),
            ],
            bytes_geometry: 800_000,
            bytes_bvh: 680_000,
            bytes_normals: 70_000,
            bytes_rest: 96,
            ram: vec![("tile", 15_360), ("path", 512)],
        }
    }

    #[test]
    fn the_text_says_all_of_it() {
        let expected = "\
nothing: 240 pixels wide, 8 rows a tile

shapes         10
meshes          1
triangles  69,451
materials       3
lights          2
BVH nodes  17,000
BVH depth      11

metres       x      y       z
from    -1.000  0.000  -2.500
to       1.000  2.000  12.250

scene step  9.537e-7 m
position    i32
direction   I2F14

flash                        bytes
geometry                   800,000
BVH                        680,000
normals                     70,000
materials, lights, rest         96
in all                   1,550,096

RAM      bytes
tile    15,360
path       512
in all  15,872
";
        assert_eq!(
            as_text("nothing", &Options::for_scene(&desc(240, 240)), &sample()),
            expected
        );
    }

    #[test]
    fn the_json_has_the_promised_keys() {
        let json = as_json("nothing", &sample());
        let promised =
            "triangles shapes nodes bytes_geometry bytes_bvh bytes_normals bytes_total bvh_depth ram_bytes";
        for key in promised.split_whitespace() {
            assert!(json[key].is_u64(), "{key}");
        }
        assert_eq!(
            (&json["bytes_total"], &json["ram_bytes"]),
            (&1_550_096.into(), &15_872.into())
        );
    }
}
