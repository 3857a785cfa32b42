//! What becomes of the cost as the work grows: a section of `docs/performance.md` and its curve.

use std::fmt::Write as _;

use anyhow::{Context, Result, anyhow, ensure};
use clap::Args;
use plotters::prelude::*;

use crate::accuracy::Header;
use crate::{bench_host, peers, shell};

#[derive(Args)]
pub struct Options {}

pub(crate) const TITLE: &str = "## As the work grows";
const PLOT: &str = "docs/img/growth.svg";

/// Tubes of a thousand triangles to as many as one mesh can number, then scenes of several.
const SCENES: [(&str, usize); 8] = [
    ("knot:64x8", 1),
    ("knot:128x16", 1),
    ("knot:256x32", 1),
    ("knot:512x64", 1),
    ("knot:1000x64", 1),
    ("knot:1000x64", 2),
    ("knot:1000x64", 4),
    ("knot:1000x64", 8),
];
const RAYS: &str = "10000";
/// Rows of a strip, 240 pixels each, and samples a pixel.
const STRIPS: [(u32, u32); 8] = [
    (1, 1),
    (4, 1),
    (16, 1),
    (48, 1),
    (16, 2),
    (16, 4),
    (16, 8),
    (16, 16),
];

struct Scene {
    triangles: u64,
    meshes: usize,
    bytes: u64,
    ray: u64,
}

/// Counts, prints, draws and writes.
pub fn run(_: &Options) -> Result<()> {
    ensure!(
        shell::have("valgrind"),
        "valgrind is missing: `apt-get install valgrind`"
    );
    let program = peers::build()?;
    let mut scenes = Vec::new();
    for (mesh, meshes) in SCENES {
        let arguments = [mesh, "--copies", &meshes.to_string(), "--rays", RAYS];
        let (counted, told) = peers::count(&program, "counted", &arguments)?;
        let scene = Scene {
            triangles: word(&told, "triangles=")?,
            meshes,
            bytes: word(&told, "bytes=")?,
            ray: counted / word(&told, "rays=")?,
        };
        println!("{} triangles: {} instructions a ray", scene.triangles, scene.ray);
        scenes.push(scene);
    }
    let mut strips = Vec::new();
    for (rows, spp) in STRIPS {
        let (counted, told) = peers::count(&program, "counted_picture", &[&format!("strip:{rows}x{spp}")])?;
        let sample = counted / word(&told, "samples=")?;
        println!("{rows} rows, {spp} spp: {sample} instructions a sample");
        strips.push((rows, spp, sample, word(&told, "bytes=")?));
    }
    let plot = shell::root().join(PLOT);
    std::fs::write(&plot, curve(&scenes)?).with_context(|| plot.display().to_string())?;
    bench_host::put(TITLE, &text(&Header::now(0)?, &scenes, &strips)?)
}

/// A number of the line that `peers` prints.
fn word(told: &str, name: &str) -> Result<u64> {
    let word = told.split_whitespace().find_map(|word| word.strip_prefix(name));
    Ok(word.with_context(|| format!("{told:?} has no {name}"))?.parse()?)
}

fn text(header: &Header, scenes: &[Scene], strips: &[(u32, u32, u64, u64)]) -> Result<String> {
    let mut text = format!(
        "Written by `cargo xtask growth`, {}, commit {}, {}.\n\n\
        Nearest hits of {RAYS} rays towards tubes along a torus knot, half from around the scene, half from within its box:\n\
        instructions of x86-64 a ray, counted by callgrind. A mesh numbers 65,536 vertices, about 131 thousand triangles at\n\
        most: larger scenes are several meshes, each with its tree, side by side under the scene\'s; rays then also cross what\n\
        is empty between them. *Flash*: plain triangles, vertices and nodes; no RAM grows with them: what a ray needs is on the\n\
        stack, of the same depth for all (`docs/device.md`).\n\n\
        ![Instructions a ray against triangles]({})\n\n\
        | triangles | meshes | instructions a ray | for twice as many | flash, bytes a triangle |\n|--:|--:|--:|--:|--:|\n",
        header.date,
        header.commit,
        header.tools,
        PLOT.trim_start_matches("docs/")
    );
    let mut before: Option<&Scene> = None;
    for scene in scenes {
        // By how much the cost grows where the triangles double.
        let growth = before.map_or(String::new(), |before| {
            let doublings = (scene.triangles as f64 / before.triangles as f64).log2();
            format!("{:+.0}", (scene.ray as f64 - before.ray as f64) / doublings)
        });
        writeln!(
            text,
            "| {} | {} | {} | {growth} | {:.1} |",
            scene.triangles,
            scene.meshes,
            scene.ray,
            scene.bytes as f64 / scene.triangles as f64
        )?;
        before = Some(scene);
    }
    text += "\nThe Cornell box, `direct`, 240 pixels wide and 48 high, by strips of whole rows: instructions a sample, and all that is in\n\
        memory beside scene and stack.\n\n| rows | samples a pixel | instructions a sample | renderer and strip, bytes |\n|--:|--:|--:|--:|\n";
    for (rows, spp, sample, bytes) in strips {
        writeln!(text, "| {rows} | {spp} | {sample} | {bytes} |")?;
    }
    Ok(text)
}

/// Instructions a ray against triangles, those logarithmic, as SVG.
fn curve(scenes: &[Scene]) -> Result<String> {
    let mut svg = String::new();
    draw(&mut svg, scenes).map_err(|error| anyhow!("the curve cannot be drawn: {error}"))?;
    Ok(svg)
}

fn draw(svg: &mut String, scenes: &[Scene]) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, (600, 320)).into_drawing_area();
    area.fill(&WHITE)?;
    let last = scenes.iter().map(|scene| scene.triangles).max().unwrap_or(2) as f64;
    let most = scenes.iter().map(|scene| scene.ray).max().unwrap_or(1) as f64;
    let mut chart = ChartBuilder::on(&area)
        .margin(8)
        .x_label_area_size(32)
        .y_label_area_size(52)
        .build_cartesian_2d((700.0..last * 1.3).log_scale(), 0.0..most * 1.15)?;
    chart
        .configure_mesh()
        .x_desc("triangles")
        .y_desc("instructions a ray")
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| format!("{y:.0}"))
        .light_line_style(TRANSPARENT)
        .label_style(("sans-serif", 11))
        .draw()?;
    let colours = [RGBColor(31, 120, 180), RGBColor(217, 95, 2)];
    for (name, colour, several) in [
        ("one mesh", colours[0], false),
        ("several meshes", colours[1], true),
    ] {
        let points = || {
            let of_kind = scenes.iter().filter(move |scene| (scene.meshes > 1) == several);
            of_kind.map(|scene| (scene.triangles as f64, scene.ray as f64))
        };
        chart
            .draw_series(LineSeries::new(points(), colour.stroke_width(2)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 12, y)], colour.stroke_width(2)));
        chart.draw_series(points().map(|point| Circle::new(point, 3, colour.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.8))
        .label_font(("sans-serif", 11))
        .draw()?;
    area.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_by_the_doubling() {
        let scene = |triangles, ray| Scene {
            triangles,
            meshes: 1,
            bytes: 10 * triangles,
            ray,
        };
        let header = Header {
            spp: 0,
            date: String::new(),
            commit: String::new(),
            tools: String::new(),
        };
        let scenes = [scene(1000, 500), scene(4000, 700)];
        let text = text(&header, &scenes, &[(16, 2, 4000, 30_840)]).unwrap();
        assert!(text.contains("| 4000 | 1 | 700 | +100 | 10.0 |\n"), "{text}");
        assert!(text.contains("| 16 | 2 | 4000 | 30840 |\n"), "{text}");
        let svg = curve(&scenes).unwrap();
        assert!(
            svg.contains("instructions a ray") && svg.contains("<circle"),
            "{svg}"
        );
        assert_eq!(word("triangles=12 rays=5", "rays=").unwrap(), 5);
        assert!(word("triangles=12", "rays=").is_err());
    }
}
