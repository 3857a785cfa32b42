//! `host-sim compare`.

use std::io::{self, Write};
use std::path::Path;

use serde_json::{Map, Value};

use super::args::CompareArgs;
use super::progress::Meter;
use super::render::{Output, settings};
use super::table::{Table, grouped, short};
use super::{Failure, source, stop, terminal};
use crate::clean::{Cleaning, Denoise};
use crate::metrics::{self, Metrics, MetricsError};
use crate::picture::{Format, Picture, Style, Target, display_pixels, read_exr};
use crate::run::{self, Options, PrimaryReport, Stats};

/// What a renderer answers.
type Made = Result<(Picture, Stats), run::Error>;

pub fn compare(args: &CompareArgs) -> Result<(), Failure> {
    let desc = source::load(&args.scene, args.quiet)?;
    let options = args.settings.options(&desc);
    let reference_options = Options {
        spp: args.reference_spp.unwrap_or(options.spp),
        ..options.clone()
    };
    let outputs = Output::check_all(&args.outputs)?;
    let diff = args.diff.as_deref().map(Output::check).transpose()?;
    let json = args.json.as_deref().map(Target::check).transpose()?;
    let against = args
        .against
        .as_deref()
        .map(|path| third(path, &options))
        .transpose()?;

    let stop = stop::on_ctrl_c()?;
    let failed = |error| Failure::of_run(&args.scene.scene, error);
    let measured = |label: &'static str, make: &dyn Fn(&Meter) -> Made| {
        let meter = Meter::new(label, args.quiet);
        let result = make(&meter);
        meter.finish();
        result.map_err(failed)
    };
    let (fixed, fixed_stats) = measured("fixed", &|meter| run::render_fixed(&desc, &options, meter, &stop))?;
    let noisy = if options.cleaning.denoise == Denoise::Off {
        None
    } else {
        let noisy_options = Options {
            cleaning: Cleaning::default(),
            ..options.clone()
        };
        let (noisy, _) = measured("noisy", &|meter| {
            run::render_fixed(&desc, &noisy_options, meter, &stop)
        })?;
        Some(noisy)
    };
    let (reference, reference_stats) = measured("reference", &|meter| {
        run::render_reference(&desc, &reference_options, meter, &stop)
    })?;
    let primary = run::compare_primary_rays(&desc, &options, &stop).map_err(failed)?;

    let comparison = Comparison {
        scene: desc.name,
        options,
        reference_spp: reference_options.spp,
        fixed_stats,
        reference_stats,
        primary,
        between: distance(
            "the fixed-point picture against the reference",
            &fixed,
            &reference,
        )?,
        noisy: match &noisy {
            Some(noisy) => Some(distance(
                "the noisy picture against the reference",
                noisy,
                &reference,
            )?),
            None => None,
        },
        against: match &against {
            Some(third) => Some([
                distance("the fixed-point picture against --against", &fixed, third)?,
                distance("the reference against --against", &reference, third)?,
            ]),
            None => None,
        },
    };
    for output in &outputs {
        output.write(&fixed, &Style::default())?;
    }
    if let Some(output) = &diff {
        write_difference(output, &fixed, &reference)?;
    }
    if let Some(target) = &json {
        let text = format!("{:#}\n", Value::Object(comparison.json()));
        target.write(text.as_bytes())?;
    }
    if args.quiet {
        return Ok(());
    }
    terminal::show(fixed.width, fixed.height, &display_pixels(&fixed, 0.0));
    let mut out = io::stdout().lock();
    out.write_all(comparison.text().as_bytes())?;
    let files = outputs.iter().chain(&diff).map(|output| output.target.path());
    for path in files.chain(json.as_ref().map(Target::path)) {
        writeln!(out, "written to {}", path.display())?;
    }
    Ok(())
}

/// The picture of `--against`, which must be comparable with what will be rendered.
fn third(path: &Path, options: &Options) -> Result<Picture, Failure> {
    let picture = read_exr(path)?;
    let wanted = (options.width as usize, options.height as usize);
    let found = (picture.width, picture.height);
    if found != wanted {
        let error = MetricsError::Sizes(found, wanted);
        return Err(Failure::Wrong(format!(
            "{}: {error}, --width {} --height {}",
            path.display(),
            found.0,
            found.1
        )));
    }
    match Metrics::of(&picture, &picture) {
        Ok(_) => Ok(picture),
        Err(error) => Err(Failure::Wrong(format!(
            "{}: {error}; write it anew",
            path.display()
        ))),
    }
}

fn distance(what: &str, picture: &Picture, reference: &Picture) -> Result<Metrics, Failure> {
    Metrics::of(picture, reference).map_err(|error| Failure::Wrong(format!("{what}: {error}")))
}

fn write_difference(output: &Output, fixed: &Picture, reference: &Picture) -> Result<(), Failure> {
    let failed = |error: MetricsError| Failure::Wrong(format!("{}: {error}", output.target.path().display()));
    if output.format() == Format::Png {
        let colours = metrics::difference_colours(fixed, reference).map_err(failed)?;
        let picture = Picture {
            display: Some(colours),
            ..fixed.clone()
        };
        output.write(&picture, &Style::default())
    } else {
        output.write(
            &metrics::difference(fixed, reference).map_err(failed)?,
            &Style::default(),
        )
    }
}

/// All that is known at the end.
struct Comparison {
    scene: String,
    options: Options,
    reference_spp: u32,
    fixed_stats: Stats,
    reference_stats: Stats,
    primary: PrimaryReport,
    between: Metrics,
    /// The same without denoising, where there was any.
    noisy: Option<Metrics>,
    /// Fixed, and reference, against the third picture.
    against: Option<[Metrics; 2]>,
}

impl Comparison {
    /// One flat object; numbers but for `scene`.
    fn json(&self) -> Map<String, Value> {
        let mut map = Map::new();
        map.insert("scene".to_string(), self.scene.as_str().into());
        map.insert("width".to_string(), self.options.width.into());
        map.insert("height".to_string(), self.options.height.into());
        map.insert("spp".to_string(), self.options.spp.into());
        map.insert("reference_spp".to_string(), self.reference_spp.into());
        insert_metrics(&mut map, "", &self.between);
        if let Some(noisy) = &self.noisy {
            insert_metrics(&mut map, "noisy_", noisy);
        }
        if let Some([fixed, reference]) = &self.against {
            insert_metrics(&mut map, "against_fixed_", fixed);
            insert_metrics(&mut map, "against_reference_", reference);
        }
        map.insert("primary_rays".to_string(), self.primary.rays.into());
        let primary = self.primary.entries();
        map.extend(primary.map(|(key, value)| (key.to_string(), value.into())));
        let numbers = [
            ("fixed_seconds", self.fixed_stats.seconds),
            ("reference_seconds", self.reference_stats.seconds),
            ("fixed_rays_per_second", self.fixed_stats.rays_per_second()),
            (
                "reference_rays_per_second",
                self.reference_stats.rays_per_second(),
            ),
        ];
        map.extend(numbers.map(|(key, value)| (key.to_string(), value.into())));
        map
    }

    fn text(&self) -> String {
        let mut speed = Table::default();
        let (fixed, reference) = (&self.fixed_stats, &self.reference_stats);
        speed
            .row(["", "fixed", "reference"])
            .row([
                "samples a pixel",
                &self.options.spp.to_string(),
                &self.reference_spp.to_string(),
            ])
            .row(["rays", &grouped(fixed.rays), &grouped(reference.rays)])
            .row([
                "seconds",
                &format!("{:.2}", fixed.seconds),
                &format!("{:.2}", reference.seconds),
            ])
            .row([
                "rays/s",
                &short(fixed.rays_per_second()),
                &short(reference.rays_per_second()),
            ]);

        let mut errors = Table::default();
        errors.row(["", "bias", "rmse", "psnr", "ssim", "flip", "block p95"]);
        errors.row(metrics_cells("fixed against reference", &self.between));
        if let Some(noisy) = &self.noisy {
            errors.row(metrics_cells("not denoised", noisy));
        }
        if let Some([fixed, reference]) = &self.against {
            errors.row(metrics_cells("fixed against --against", fixed));
            errors.row(metrics_cells("reference against --against", reference));
        }

        let mut hits = Table::default();
        hits.row([
            "hit point error, share of the extent",
            "rays",
            "p50",
            "p99",
            "p99.9",
            "p99.99",
            "max",
        ]);
        let rows = [
            ("where both hit", self.primary.hit_point_error),
            ("away from edges", self.primary.hit_point_error_away),
        ];
        for (label, tail) in rows {
            let tail_cells =
                [tail.p50, tail.p99, tail.p999, tail.p9999, tail.max].map(|x| format!("{x:.1e}"));
            let [p50, p99, p999, p9999, max] = tail_cells;
            hits.row([
                label.to_string(),
                grouped(tail.count as u64),
                p50,
                p99,
                p999,
                p9999,
                max,
            ]);
        }
        let disagreement = format!(
            "primary rays that hit on one side alone: {:.4} % of {}",
            100.0 * self.primary.hit_miss_disagreement,
            grouped(self.primary.rays)
        );
        let title = format!("{}: {}", self.scene, settings(&self.options));
        format!(
            "{title}\n\n{}\n{}\n{}{disagreement}\n",
            speed.text(),
            errors.text(),
            hits.text()
        )
    }
}

fn insert_metrics(map: &mut Map<String, Value>, prefix: &str, metrics: &Metrics) {
    map.extend(
        metrics
            .entries()
            .map(|(key, value)| (format!("{prefix}{key}"), value.into())),
    );
}

fn metrics_cells(label: &str, metrics: &Metrics) -> [String; 7] {
    [
        label.to_string(),
        format!("{:+.2} %", 100.0 * metrics.bias),
        format!("{:.4}", metrics.rmse),
        format!("{:.1} dB", metrics.psnr_db),
        format!("{:.4}", metrics.ssim),
        format!("{:.4}", metrics.flip),
        format!("{:.2} %", 100.0 * metrics.block_p95),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::tests::desc;
    use crate::metrics::Percentiles;

    fn comparison() -> Comparison {
        let metrics = Metrics {
            bias: -0.0012,
            rmse: 0.034,
            psnr_db: 31.46,
            ssim: 0.9512,
            flip: 0.0213,
            block_p95: 0.0441,
            block_max: 0.2,
        };
        let tail = Percentiles {
            count: 76_000,
            p50: 1e-6,
            p90: 2e-6,
            p99: 3e-6,
            p999: 4e-6,
            p9999: 5e-6,
            max: 6e-3,
        };
        Comparison {
            scene: "spheres".to_string(),
            options: Options {
                spp: 16,
                ..Options::for_scene(&desc(320, 240))
            },
            reference_spp: 64,
            fixed_stats: Stats {
                rays: 12_345_678,
                seconds: 2.0,
            },
            reference_stats: Stats {
                rays: 49_000_000,
                seconds: 40.0,
            },
            primary: PrimaryReport {
                rays: 76_800,
                hit_miss_disagreement: 2.0 / 76_800.0,
                hit_point_error: tail,
                hit_point_error_away: Percentiles {
                    count: 70_000,
                    p9999: 7e-6,
                    max: 8e-6,
                    ..tail
                },
            },
            between: metrics,
            noisy: None,
            against: None,
        }
    }

    #[test]
    fn the_table_is_aligned() {
        let expected = "\
spheres: 320 x 240, 16 spp, path of depth 8

                      fixed   reference
samples a pixel          16          64
rays             12,345,678  49,000,000
seconds                2.00       40.00
rays/s               6.17 M      1.23 M

                            bias    rmse     psnr    ssim    flip  block p95
fixed against reference  -0.12 %  0.0340  31.5 dB  0.9512  0.0213     4.41 %

hit point error, share of the extent    rays     p50     p99   p99.9  p99.99     max
where both hit                        76,000  1.0e-6  3.0e-6  4.0e-6  5.0e-6  6.0e-3
away from edges                       70,000  1.0e-6  3.0e-6  4.0e-6  7.0e-6  8.0e-6
primary rays that hit on one side alone: 0.0026 % of 76,800
";
        assert_eq!(comparison().text(), expected);
    }

    #[test]
    fn the_json_is_flat_and_has_the_promised_keys() {
        let json = comparison().json();
        assert_eq!(json["scene"], "spheres");
        let promised = "width height spp bias rmse psnr_db ssim flip hit_miss_disagreement hit_point_error_p99 \
                        hit_point_error_p9999 fixed_rays_per_second reference_rays_per_second";
        for key in promised.split_whitespace() {
            assert!(json[key].is_number(), "{key}");
        }
        assert!(
            json.iter()
                .all(|(key, value)| value.is_number() || key == "scene")
        );
        assert_eq!(json["hit_point_error_p9999"], 7e-6, "away from silhouettes");
        assert_eq!(json["hit_point_error_p99"], 3e-6);
    }

    #[test]
    fn a_denoised_picture_stands_beside_the_noisy_one() {
        let mut comparison = comparison();
        assert!(!comparison.json().contains_key("noisy_flip"));
        comparison.noisy = Some(Metrics {
            flip: 0.5,
            ..comparison.between
        });
        assert_eq!(comparison.json()["noisy_flip"], 0.5);
        assert!(comparison.text().contains("not denoised"));
    }

    #[test]
    fn a_third_picture_adds_both_errors() {
        let mut comparison = comparison();
        let other = Metrics {
            bias: 0.5,
            ..comparison.between
        };
        comparison.against = Some([comparison.between, other]);
        let json = comparison.json();
        assert_eq!(
            (&json["against_fixed_bias"], &json["against_reference_bias"]),
            (&(-0.0012).into(), &0.5.into())
        );
        assert!(
            comparison
                .text()
                .contains("reference against --against  +50.00 %")
        );
    }

    #[test]
    fn a_picture_to_compare_with_must_fit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("third.exr");
        let write = |rgb: [f32; 3]| {
            let picture = Picture {
                width: 4,
                height: 4,
                rgb: vec![rgb; 16],
                ..Picture::default()
            };
            std::fs::write(&path, Format::Exr.encode(&picture, &Style::default()).unwrap()).unwrap();
        };
        let told = |size| match third(&path, &Options::for_scene(&desc(size, 4))) {
            Err(Failure::Wrong(line)) => line.replace(&path.display().to_string(), "third.exr"),
            other => format!("{other:?}"),
        };
        write([0.5; 3]);
        assert_eq!(
            third(&path, &Options::for_scene(&desc(4, 4))).unwrap().rgb,
            [[0.5; 3]; 16]
        );
        let expected = "third.exr: 4 x 4 pixels cannot be compared with 5 x 4; render at the same size, \
                        --width 4 --height 4";
        assert_eq!(told(5), expected);
        write([f32::INFINITY, 0.0, 0.0]);
        assert_eq!(
            told(4),
            "third.exr: pixel (0, 0) is not a finite number; write it anew"
        );
    }
}
