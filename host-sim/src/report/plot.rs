//! Curves, as SVG to stand in the page. Colours are the style sheet's, by name, so that they follow its theme.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::*;

use super::{Level, bar};
use crate::metrics::Percentiles;

/// Pixels of a plot of the width of a column.
const SIZE: (u32, u32) = (380, 270);
const FONT: &str = "sans-serif";

/// Colours that exist in the style sheet alone: each is written as a colour that nobody would choose, then replaced.
const INK: RGBColor = RGBColor(1, 0, 0);
const FAINT: RGBColor = RGBColor(2, 0, 0);
const LIMIT: RGBColor = RGBColor(3, 0, 0);
/// Colours of curves, by number.
pub const CURVES: usize = 8;

fn curve_colour(i: usize) -> RGBColor {
    RGBColor(16 + (i % CURVES) as u8, 0, 0)
}

fn themed(svg: &str) -> String {
    let mut text = svg
        .replace("#010000", "var(--ink-2)")
        .replace("#020000", "var(--line)")
        .replace("#030000", "var(--off)");
    for i in 0..CURVES {
        text = text.replace(&format!("#{:02X}0000", 16 + i), &format!("var(--curve-{i})"));
    }
    text
}

/// An axis with given ticks.
struct Axis {
    low: f64,
    high: f64,
    ticks: Vec<f64>,
    scale: Scale,
}

#[derive(Clone, Copy, PartialEq)]
enum Scale {
    /// Equal factors are equal distances.
    Log,
    /// Equal differences are.
    Even,
}

impl Axis {
    fn place(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
            Scale::Even => (value - self.low) / (self.high - self.low),
        }
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + (self.place(*value) * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

/// Round numbers in the range: few of each power of ten where there are many powers.
fn decimal_ticks(low: f64, high: f64) -> Vec<f64> {
    let steps: &[f64] = match high / low {
        ratio if ratio < 8.0 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
        ratio if ratio < 200.0 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let every = if steps.len() > 1 {
        1
    } else {
        ((last - first) / 6).max(1)
    };
    let powers = (first..=last).step_by(every as usize);
    let ticks = powers.flat_map(|power| steps.iter().map(move |step| step * 10f64.powi(power)));
    ticks.filter(|x| (low..=high).contains(x)).collect()
}

fn doublings(high: u32) -> Vec<f64> {
    let all: Vec<f64> = (0..=high.ilog2()).map(|i| f64::from(1u32 << i)).collect();
    let every = all.len().div_ceil(7);
    all.into_iter().step_by(every).collect()
}

/// What is drawn: the number of its colour, and the errors.
pub struct Curve<'a> {
    pub colour: usize,
    pub levels: &'a [Level],
}

impl Curve<'_> {
    fn points(&self) -> Vec<(f64, f64)> {
        let known = |level: &Level| Some((f64::from(level.spp), level.rmse?));
        self.levels
            .iter()
            .filter_map(known)
            .filter(|(_, y)| *y > 0.0)
            .collect()
    }
}

/// Least and greatest error of curves, for plots that are to be compared; `None` if there is no error.
pub fn bounds<'a>(curves: impl IntoIterator<Item = &'a Curve<'a>>) -> Option<(f64, f64)> {
    let ys = curves
        .into_iter()
        .flat_map(|curve| curve.points())
        .map(|(_, y)| y);
    let (low, high) = ys.fold((f64::INFINITY, 0.0f64), |(low, high), y| {
        (low.min(y), high.max(y))
    });
    (low <= high).then_some((low / 1.3, high * 1.3))
}

/// RMSE against samples a pixel, both logarithmic; the dashed line falls as independent samples do, by n^-1/2.
pub fn convergence(curves: &[Curve], spp: u32, (low, high): (f64, f64)) -> String {
    let x = Axis {
        low: 0.9,
        high: f64::from(spp.max(2)) * 1.12,
        ticks: doublings(spp.max(2)),
        scale: Scale::Log,
    };
    let y = Axis {
        low,
        high,
        ticks: decimal_ticks(low, high),
        scale: Scale::Log,
    };
    let mut lines = vec![Line {
        points: guide(curves, spp, low),
        colour: INK,
        kind: Kind::Dashed,
    }];
    lines.extend(curves.iter().map(|curve| Line {
        points: curve.points(),
        colour: curve_colour(curve.colour),
        kind: Kind::Dotted,
    }));
    drawn(x, y, ["samples a pixel", "RMSE"], lines)
}

/// What is measured of each frame of a clip, by the number of the curve's colour.
pub fn frames(curves: &[(usize, Vec<f64>)], name: &str) -> String {
    let values = || curves.iter().flat_map(|(_, values)| values.iter().copied());
    let (low, high) = values().fold((f64::INFINITY, 0.0f64), |(low, high), y| {
        (low.min(y), high.max(y))
    });
    if low > high {
        return String::new();
    }
    let (low, high) = (low.floor() - 1.0, high.ceil() + 1.0);
    let every = ((high - low) / 6.0).ceil().max(1.0);
    let ticks = (1..)
        .map(|i| low + f64::from(i) * every)
        .take_while(|y| *y < high);
    let y = Axis {
        low,
        high,
        ticks: ticks.collect(),
        scale: Scale::Even,
    };
    let count = curves.iter().map(|(_, values)| values.len()).max().unwrap_or(1);
    let numbers: Vec<f64> = (1..=count).map(|number| number as f64).collect();
    let x = Axis {
        low: 0.7,
        high: count as f64 + 0.3,
        ticks: numbers.clone(),
        scale: Scale::Even,
    };
    let lines = curves.iter().map(|(colour, values)| Line {
        points: numbers.iter().copied().zip(values.iter().copied()).collect(),
        colour: curve_colour(*colour),
        kind: Kind::Dotted,
    });
    drawn(x, y, ["frame", name], lines)
}

/// Through the worst of the first points, n^-1/2, as far as the plot goes.
fn guide(curves: &[Curve], spp: u32, low: f64) -> Vec<(f64, f64)> {
    let firsts = curves
        .iter()
        .filter_map(|curve| curve.points().first().map(|(x, y)| y * x.sqrt()));
    let Some(start) = firsts.reduce(f64::max) else {
        return Vec::new();
    };
    let end = f64::from(spp.max(2)).min((start / low).powi(2));
    vec![(1.0, start), (end, start / end.sqrt())]
}

/// How large the hit points' errors are, against the share of rays that have larger ones: all rays, and those away
/// from silhouettes. Short thick lines are the bars.
pub fn hit_points(all: &Percentiles, away: &Percentiles) -> String {
    let tail = |p: &Percentiles| {
        let points = [
            (2.0, p.p50),
            (10.0, p.p90),
            (100.0, p.p99),
            (1e3, p.p999),
            (1e4, p.p9999),
        ];
        points.map(|(rank, error)| (rank, error.max(FLOOR))).to_vec()
    };
    let curves = [tail(all), tail(away)];
    let least = curves.iter().flatten().map(|p| p.1).fold(1.0, f64::min);
    let most = curves
        .iter()
        .flatten()
        .map(|p| p.1)
        .fold(bar::HIT_P9999, f64::max);
    let (low, high) = (least / 3.0, most * 3.0);
    let x = Axis {
        low: 1.6,
        high: 1.7e4,
        ticks: vec![2.0, 10.0, 100.0, 1e3, 1e4],
        scale: Scale::Log,
    };
    let y = Axis {
        low,
        high,
        ticks: decimal_ticks(low, high),
        scale: Scale::Log,
    };
    let bars = [(100.0, bar::HIT_P99), (1e4, bar::HIT_P9999)].map(|(rank, bar)| Line {
        points: vec![(rank / 1.6, bar), (rank * 1.6, bar)],
        colour: LIMIT,
        kind: Kind::Thick,
    });
    let curves = curves.into_iter().enumerate().map(|(i, points)| Line {
        points,
        colour: curve_colour(i),
        kind: Kind::Dotted,
    });
    drawn(
        x,
        y,
        ["one ray in … is farther off", "share of the extent"],
        bars.into_iter().chain(curves),
    )
}

/// Errors below this are drawn as this, for logarithms know no zero.
const FLOOR: f64 = 1e-9;

struct Line {
    points: Vec<(f64, f64)>,
    colour: RGBColor,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// With a dot at each point.
    Dotted,
    Dashed,
    Thick,
}

/// Lines between axes with names (below, to the left). Empty where drawing fails, which into memory it does not.
fn drawn(x: Axis, y: Axis, names: [&str; 2], lines: impl IntoIterator<Item = Line>) -> String {
    let mut svg = String::new();
    match draw(&mut svg, x, y, names, lines) {
        Ok(()) => themed(&svg),
        Err(_) => String::new(),
    }
}

fn draw(
    svg: &mut String,
    x: Axis,
    y: Axis,
    [below, left]: [&str; 2],
    lines: impl IntoIterator<Item = Line>,
) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    let mut chart = ChartBuilder::on(&area)
        .margin(6)
        .margin_right(14)
        .x_label_area_size(40)
        .y_label_area_size(58)
        .build_cartesian_2d(x, y)?;
    let text = (FONT, 12).into_font().color(&INK);
    chart
        .configure_mesh()
        .x_desc(below)
        .y_desc(left)
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(*y))
        .bold_line_style(FAINT)
        .light_line_style(TRANSPARENT)
        .axis_style(FAINT)
        .label_style(text.clone())
        .axis_desc_style(text)
        .draw()?;
    for line in lines {
        let style = line
            .colour
            .stroke_width(if line.kind == Kind::Thick { 4 } else { 2 });
        if line.kind == Kind::Dashed {
            let thin = line.colour.stroke_width(1);
            chart.draw_series(DashedLineSeries::new(line.points, 4, 4, thin))?;
            continue;
        }
        chart.draw_series(LineSeries::new(line.points.clone(), style))?;
        if line.kind == Kind::Dotted {
            let dots = line.points.into_iter();
            chart.draw_series(dots.map(|point| Circle::new(point, 3, line.colour.filled())))?;
        }
    }
    area.present()?;
    drop(chart);
    Ok(())
}

/// A tick's label: plain where it is short, else by powers of ten.
fn short(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(spp: u32, rmse: f64) -> Level {
        Level {
            spp,
            rmse: Some(rmse),
        }
    }

    fn labels(ticks: Vec<f64>) -> Vec<String> {
        ticks.into_iter().map(short).collect()
    }

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(
            labels(decimal_ticks(0.008, 0.3)),
            ["0.01", "0.02", "0.05", "0.1", "0.2"]
        );
        assert_eq!(labels(decimal_ticks(0.04, 0.11)), ["0.04", "0.05", "0.07", "0.1"]);
        assert_eq!(decimal_ticks(1e-8, 0.05).len(), 7);
        assert_eq!(doublings(16), [1.0, 2.0, 4.0, 8.0, 16.0]);
        assert_eq!(doublings(4096), [1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0]);
        assert_eq!(
            [1e-5, 0.002, 128.0, 1e4].map(short),
            ["1e-5", "0.002", "128", "10000"]
        );
    }

    #[test]
    fn equal_factors_are_equal_distances() {
        let mut axis = Axis {
            low: 1.0,
            high: 10_000.0,
            ticks: vec![],
            scale: Scale::Log,
        };
        let places = [1.0, 10.0, 100.0, 10_000.0].map(|x| axis.map(&x, (100, 500)));
        assert_eq!(places, [100, 200, 300, 500]);
        (axis.high, axis.scale) = (5.0, Scale::Even);
        assert_eq!([1.0, 2.0, 5.0].map(|x| axis.map(&x, (100, 500))), [100, 200, 500]);
    }

    #[test]
    fn curves_are_drawn_in_the_page_s_colours() {
        let (one, two) = ([level(1, 0.4), level(4, 0.2), level(16, 0.1)], [level(1, 0.3)]);
        let curves = [
            Curve {
                colour: 0,
                levels: &one,
            },
            Curve {
                colour: 3,
                levels: &two,
            },
        ];
        let svg = convergence(&curves, 16, bounds(&curves).unwrap());
        let document = roxmltree::Document::parse(&svg).unwrap();
        let circles = document.descendants().filter(|node| node.has_tag_name("circle"));
        assert_eq!(circles.count(), 4, "a dot for each level");
        assert!(!svg.contains('#'), "a colour that the page does not know: {svg}");
        assert!(
            svg.contains("var(--curve-0)")
                && svg.contains("var(--curve-3)")
                && !svg.contains("var(--curve-1)")
        );
    }

    #[test]
    fn frames_are_numbered_from_one() {
        let svg = frames(&[(0, vec![21.5, 23.0, 24.25]), (2, vec![30.0; 3])], "PSNR, dB");
        let document = roxmltree::Document::parse(&svg).unwrap();
        let circles = document.descendants().filter(|node| node.has_tag_name("circle"));
        assert_eq!(circles.count(), 6);
        let texts: Vec<&str> = document
            .descendants()
            .filter_map(|node| node.text())
            .map(str::trim)
            .collect();
        for label in ["1", "2", "3", "22", "30", "frame", "PSNR, dB"] {
            assert!(texts.contains(&label), "{label}: {texts:?}");
        }
        assert_eq!(frames(&[], ""), "");
    }

    #[test]
    fn nothing_to_draw_is_no_plot() {
        assert_eq!(bounds(&[]), None);
        let unknown = [Level { spp: 1, rmse: None }];
        assert_eq!(
            bounds(&[Curve {
                colour: 0,
                levels: &unknown
            }]),
            None
        );
    }
}
