//! The curves: one panel for each scene, all with the same axes' steps.

use anyhow::{Result, anyhow};
use plotters::prelude::*;

use super::{LEVELS, Row, SAMPLERS};

const PANEL: (u32, u32) = (300, 240);
const COLUMNS: usize = 3;
const COLOURS: [RGBColor; SAMPLERS.len()] = [
    RGBColor(110, 110, 110),
    RGBColor(217, 95, 2),
    RGBColor(27, 158, 119),
    RGBColor(31, 120, 180),
    RGBColor(150, 70, 190),
];

/// The pixels' mean error against samples a pixel, both logarithmic, as SVG.
pub fn curves(rows: &[Row]) -> Result<String> {
    let mut svg = String::new();
    draw(&mut svg, rows).map_err(|error| anyhow!("the curves cannot be drawn: {error}"))?;
    Ok(svg)
}

fn draw(svg: &mut String, rows: &[Row]) -> Result<(), Box<dyn std::error::Error>> {
    let lines = rows.len().div_ceil(COLUMNS);
    let size = (PANEL.0 * COLUMNS as u32, PANEL.1 * lines as u32);
    let area = SVGBackend::with_string(svg, size).into_drawing_area();
    area.fill(&WHITE)?;
    for (i, (panel, row)) in area.split_evenly((lines, COLUMNS)).iter().zip(rows).enumerate() {
        let errors = || {
            row.near
                .as_flattened()
                .iter()
                .map(|spread| spread.mean)
                .filter(|e| *e > 0.0)
        };
        let (low, high) = (errors().fold(f64::MAX, f64::min), errors().fold(0.0, f64::max));
        if low > high {
            continue;
        }
        let last = f64::from(LEVELS[LEVELS.len() - 1]);
        let mut chart = ChartBuilder::on(panel)
            .caption(row.label(), ("sans-serif", 13))
            .margin(6)
            .x_label_area_size(28)
            .y_label_area_size(48)
            .build_cartesian_2d(
                (0.9..last * 1.15).log_scale().base(2.0),
                (low / 1.3..high * 1.3).log_scale(),
            )?;
        chart
            .configure_mesh()
            .x_desc("samples a pixel")
            .x_label_formatter(&|x| format!("{x:.0}"))
            .y_labels(5)
            .y_label_formatter(&|y| format!("{y:.0e}"))
            .light_line_style(TRANSPARENT)
            .label_style(("sans-serif", 10))
            .draw()?;
        for ((name, errors), colour) in SAMPLERS.iter().zip(&row.near).zip(COLOURS) {
            let means = errors.iter().map(|spread| spread.mean);
            let points = LEVELS.iter().map(|spp| f64::from(*spp)).zip(means);
            let points: Vec<_> = points.filter(|(_, error)| *error > 0.0).collect();
            chart
                .draw_series(LineSeries::new(points, colour.stroke_width(2)))?
                .label(*name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 12, y)], colour.stroke_width(2)));
        }
        // One legend for all: more would hide curves.
        if i == 0 {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::LowerLeft)
                .background_style(WHITE.mix(0.8))
                .label_font(("sans-serif", 10))
                .draw()?;
        }
    }
    area.present()?;
    Ok(())
}
