//! Networks of several sizes, trained alike: what more weights bring.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use anyhow::{Result, anyhow};
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use plotters::prelude::*;

use crate::data::Shot;
use crate::evaluate::{self, Ground};
use crate::scenes::Split;
use crate::size::Size;
use crate::train::{self, Recipe, State};

#[derive(Clone, Debug, clap::Args)]
pub struct Options {
    /// Which sizes; all if none is named
    #[arg(long, value_enum, value_delimiter = ',')]
    sizes: Vec<Size>,
    /// Folder with a state and a log of each size: those that are there are gone on with
    #[arg(long, default_value = "curve")]
    states: PathBuf,
    #[command(flatten)]
    recipe: Recipe,
    /// The folder `pyoidn/oidn` of the Python package `pyoidn`, for Open Image Denoise beside ours
    #[arg(long)]
    oidn: Option<PathBuf>,
    /// Markdown that is written
    #[arg(long, default_value = "curve.md")]
    out: PathBuf,
    /// The plot, SVG
    #[arg(long, default_value = "curve.svg")]
    plot: PathBuf,
    /// Threads; the weights are the same for any number
    #[arg(long, default_value_t = 1)]
    threads: usize,
}

/// Samples a pixel.
const COUNTS: [usize; 2] = [1, 4];
const OTHERS: [&str; 5] = ["noisy", "à-trous", "joint bilateral", "OIDN fast", "OIDN high"];

/// PSNR (dB), SSIM and FLIP for each of [`COUNTS`].
type Quality = [[f64; 3]; 2];

pub fn run(options: &Options) -> Result<()> {
    let all = Size::ALL.to_vec();
    let sizes = if options.sizes.is_empty() {
        &all
    } else {
        &options.sizes
    };
    train::by_threads(options.threads, || {
        let states = learn(options, sizes)?;
        let (ours, others) = measure(options, &states)?;
        let text = table(&ours, &others)?;
        fs::write(&options.out, &text)?;
        let mut svg = String::new();
        draw(&mut svg, &ours, &others).map_err(|error| anyhow!("{error}"))?;
        fs::write(&options.plot, svg)?;
        println!("{text}");
        Ok(())
    })
}

/// One size after the other.
fn learn(options: &Options, sizes: &[Size]) -> Result<Vec<State>> {
    let recipe = &options.recipe;
    fs::create_dir_all(&options.states)?;
    let bars = MultiProgress::new();
    let one = |size: &Size| {
        let [state, log] = ["bin", "txt"].map(|end| options.states.join(size.name()).with_extension(end));
        let bar = bars.add(ProgressBar::new(0));
        bar.set_prefix(format!("{:3}", size.name()));
        let state = train::train(recipe, *size, recipe.all(), &state, &log, &bar)?;
        bar.finish();
        Ok(state)
    };
    sizes.iter().map(one).collect()
}

type Ours = Vec<(Size, Quality)>;
type Others = Vec<(&'static str, Quality)>;

/// The rounded networks in the core's place, and others beside them, on the test scenes.
fn measure(options: &Options, states: &[State]) -> Result<(Ours, Others)> {
    let shots = Shot::read_all(&options.recipe.data, Split::Test)?;
    let validation = Shot::read_all(&options.recipe.data, Split::Validation)?;
    let oidn = evaluate::open_image_denoise(options.oidn.as_deref())?;
    let others = if oidn.is_some() { &OTHERS[..] } else { &OTHERS[..3] };
    let mut of_ours: Ours = states
        .iter()
        .map(|s| (s.params.size, Quality::default()))
        .collect();
    let mut of_others: Others = others.iter().map(|name| (*name, Quality::default())).collect();
    let bar = ProgressBar::new((COUNTS.len() * (states.len() + 1)) as u64);
    bar.set_style(ProgressStyle::with_template("test {wide_bar} {pos}/{len} {eta}")?);
    for (k, count) in COUNTS.into_iter().enumerate() {
        let ground = Ground::new(&shots, &validation, count, oidn.as_ref());
        for ((_, quality), state) in of_ours.iter_mut().zip(states) {
            quality[k] = ground.means(|shot| Ok(vec![ground.in_core(shot, &state.params)?]))?[0];
            bar.inc(1);
        }
        let means = ground.means(|shot| Ok([&ground.classical(shot)[..], &ground.oidn(shot)?].concat()))?;
        for ((_, quality), mean) in of_others.iter_mut().zip(means) {
            quality[k] = mean;
        }
        bar.inc(1);
    }
    bar.finish();
    Ok((of_ours, of_others))
}

fn table(ours: &Ours, others: &Others) -> Result<String> {
    let mut text = String::from(
        "| | channels | weights | products a pixel | 1 spp: PSNR, dB | SSIM | FLIP | 4 spp: PSNR, dB | SSIM | FLIP |\n\
         |---|---|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let line = |text: &mut String, name: &str, size: Option<Size>, quality: &Quality| -> Result<()> {
        let (channels, weights, products) = match size {
            Some(size) => (
                size.channels().map(|c| c.to_string()).join(", "),
                thousands(size.place(size.layers().len()).0),
                thousands(size.products().round() as usize),
            ),
            None => Default::default(),
        };
        write!(text, "| {name} | {channels} | {weights} | {products} |")?;
        for [psnr, ssim, flip] in quality {
            write!(text, " {psnr:.2} | {ssim:.4} | {flip:.4} |")?;
        }
        Ok(writeln!(text)?)
    };
    for (size, quality) in ours {
        line(&mut text, &size.name().to_uppercase(), Some(*size), quality)?;
    }
    for (name, quality) in others {
        line(&mut text, name, None, quality)?;
    }
    Ok(text)
}

fn thousands(number: usize) -> String {
    match (number / 1000, number % 1000) {
        (0, rest) => rest.to_string(),
        (more, rest) => format!("{},{rest:03}", thousands(more)),
    }
}

const PANEL: (u32, u32) = (320, 280);
const METRICS: [&str; 3] = ["PSNR, dB", "SSIM", "FLIP"];
const INK: RGBColor = RGBColor(31, 120, 180);
const COLOURS: [RGBColor; 4] = [
    RGBColor(217, 95, 2),
    RGBColor(230, 171, 2),
    RGBColor(27, 158, 119),
    RGBColor(150, 70, 190),
];

/// A panel for each number of samples and each metric: ours by products a pixel, the others (but for the noisy picture) as
/// levels.
fn draw(svg: &mut String, ours: &Ours, others: &Others) -> Result<(), Box<dyn std::error::Error>> {
    let (rows, columns) = (COUNTS.len(), METRICS.len());
    let size = (PANEL.0 * columns as u32, PANEL.1 * rows as u32);
    let area = SVGBackend::with_string(svg, size).into_drawing_area();
    area.fill(&WHITE)?;
    let products = || ours.iter().map(|(size, _)| size.products());
    let least = products().fold(f64::MAX, f64::min) / 1.5;
    let most = products().fold(0.0, f64::max) * 1.5;
    let others = &others[1..];
    for (at, panel) in area.split_evenly((rows, columns)).iter().enumerate() {
        let (k, metric) = (at / columns, at % columns);
        let values = || {
            let ours = ours.iter().map(|(_, quality)| quality[k][metric]);
            ours.chain(others.iter().map(|(_, quality)| quality[k][metric]))
        };
        let (low, high) = (
            values().fold(f64::MAX, f64::min),
            values().fold(f64::MIN, f64::max),
        );
        let edge = 0.12 * (high - low).max(1e-6);
        let mut chart = ChartBuilder::on(panel)
            .caption(
                format!("{}, {} spp", METRICS[metric], COUNTS[k]),
                ("sans-serif", 14),
            )
            .margin(6)
            .x_label_area_size(32)
            .y_label_area_size(48)
            .build_cartesian_2d((least..most).log_scale().base(2.0), low - edge..high + 2.0 * edge)?;
        let digits = if metric == 0 { 1 } else { 3 };
        chart
            .configure_mesh()
            .x_desc("products a pixel")
            .x_label_formatter(&|x| format!("{x:.0}"))
            .y_labels(6)
            .y_label_formatter(&|y| format!("{y:.digits$}"))
            .light_line_style(TRANSPARENT)
            .label_style(("sans-serif", 11))
            .draw()?;
        for ((name, quality), colour) in others.iter().zip(COLOURS) {
            let level = quality[k][metric];
            chart
                .draw_series(LineSeries::new(
                    [(least, level), (most, level)],
                    colour.stroke_width(2),
                ))?
                .label(*name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], colour.stroke_width(2)));
        }
        let points: Vec<(f64, f64)> = ours
            .iter()
            .map(|(size, quality)| (size.products(), quality[k][metric]))
            .collect();
        chart.draw_series(LineSeries::new(points.clone(), INK.stroke_width(2)))?;
        chart.draw_series(ours.iter().zip(points).map(|((size, _), point)| {
            EmptyElement::at(point)
                + Circle::new((0, 0), 4, INK.filled())
                + Text::new(size.name().to_uppercase(), (-5, -18), ("sans-serif", 12))
        }))?;
        // One legend for all, where there is room.
        if at == 0 {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::Coordinate(150, 118))
                .background_style(TRANSPARENT)
                .label_font(("sans-serif", 10))
                .draw()?;
        }
    }
    area.present()?;
    Ok(())
}
