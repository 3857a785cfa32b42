//! The denoiser beside others, on one page: single frames, clips, pictures twice the size.
//!
//! [`measure`] renders and takes the numbers, `check` holds them against the bars; page, JSON and Markdown write them down.

mod check;
mod json;
mod markdown;
mod measure;
mod motion;
mod page;
mod stage;

pub use json::json;
pub use markdown::markdown;
pub use measure::measure;
pub use page::page;

use super::Shot;
use crate::desc::SceneDesc;
use crate::metrics::Metrics;
use crate::oidn::Oidn;
use crate::run::Options;

/// Frames of a clip.
pub const FRAMES: usize = 8;
/// How many times the samples of other references that of the still camera has, by which single frames are judged.
const STILL: u32 = 16;
/// How far the camera goes from each frame to the next: pixels, in the mean of what is not infinitely far.
pub const STEPS: [f64; FRAMES - 1] = [1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0];
/// Pixels without history that a scene must have for its own number of them, all frames together.
pub const UNCOVERED: usize = 100;

/// Said wherever a number is: who learnt on what.
pub const DOMAIN: &str = "The scenes are this renderer's own. Open Image Denoise was not trained on its pictures; ours was, \
                          on other families of scenes: those shown here were held out.";

/// What the page is to be about.
pub struct Request {
    pub scenes: Vec<Subject>,
    /// Samples a pixel of each of the references, but that of the still camera, which has 16 times as many, 65536 at
    /// most.
    pub reference_spp: u32,
    /// The peer, where it is installed.
    pub oidn: Option<Oidn>,
}

/// Samples a pixel of the still camera's reference.
fn still_spp(reference_spp: u32) -> u32 {
    (STILL * reference_spp).min(1 << 16)
}

/// A scene to be looked at.
pub struct Subject {
    pub desc: SceneDesc,
    /// Size, depth, sampler, seed, threads.
    pub options: Options,
}

/// All that was found.
pub struct Report {
    pub reference_spp: u32,
    pub seed: u32,
    pub has_oidn: bool,
    pub scenes: Vec<SceneReport>,
}

pub struct SceneReport {
    pub name: String,
    pub width: usize,
    pub height: usize,
    /// Or why there are no pictures of it.
    pub outcome: Result<Vec<Part>, String>,
}

/// What denoisers are tried on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One frame of so many samples a pixel.
    Frame(u32),
    /// One sample a pixel, the camera where it is.
    Still,
    /// One sample a pixel, the camera goes to the right.
    Moving,
    /// Twice as wide and high, one path for each pixel of that.
    Double,
}

/// One of the tasks, for one scene.
pub struct Part {
    pub kind: Kind,
    /// A picture for each frame.
    pub reference: Vec<Shot>,
    /// PSNR of the reference as far as its own noise is known from its halves, dB.
    pub reference_db: f64,
    pub tried: Vec<Tried>,
    pub uncovered: Option<Uncovered>,
}

/// What one of them made of it.
pub struct Tried {
    pub method: Method,
    /// A picture for each frame.
    pub shots: Vec<Shot>,
    /// Of each frame.
    pub metrics: Vec<Metrics>,
    /// Root of the mean squared change of the error along the motion, from frame to frame; only of clips.
    pub flicker: Option<f64>,
}

/// Pixels whose place was not to be seen in the frame before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncovered {
    pub pixels: usize,
    /// Of all pixels of the frames that have one before them.
    pub share: f64,
    /// PSNR there, dB: with history elsewhere, and with none anywhere.
    pub with_history: f64,
    pub without: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Noisy,
    Atrous,
    Bilateral,
    Ours,
    /// The same, each frame by itself.
    OursAlone,
    /// The same, without temporal antialiasing.
    OursUnsteady,
    OidnFast,
    OidnHigh,
    OidnClean,
    /// Given what our history gathered.
    OidnGathered,
    OidnBilinear,
    OidnUpsampled,
    OidnFull,
}

impl Method {
    /// As people read it.
    pub fn title(self) -> &'static str {
        match self {
            Method::Noisy => "noisy",
            Method::Atrous => "à-trous",
            Method::Bilateral => "joint bilateral",
            Method::Ours => "ours",
            Method::OursAlone => "ours, no history",
            Method::OursUnsteady => "ours, no TAA",
            Method::OidnFast => "OIDN fast",
            Method::OidnHigh => "OIDN high",
            Method::OidnClean => "OIDN high, clean aux",
            Method::OidnGathered => "OIDN high on our history",
            Method::OidnBilinear => "OIDN high, bilinear",
            Method::OidnUpsampled => "OIDN high before albedo, joint bilateral upsampling",
            Method::OidnFull => "OIDN high, 1 spp at full size",
        }
    }

    /// As files have it.
    pub fn key(self) -> &'static str {
        match self {
            Method::Noisy => "noisy",
            Method::Atrous => "atrous",
            Method::Bilateral => "joint_bilateral",
            Method::Ours => "ours",
            Method::OursAlone => "ours_without_history",
            Method::OursUnsteady => "ours_without_taa",
            Method::OidnFast => "oidn_fast",
            Method::OidnHigh => "oidn_high",
            Method::OidnClean => "oidn_high_clean_aux",
            Method::OidnGathered => "oidn_high_on_history",
            Method::OidnBilinear => "oidn_high_bilinear",
            Method::OidnUpsampled => "oidn_high_joint_bilateral_upsampling",
            Method::OidnFull => "oidn_high_full_size",
        }
    }
}

impl Kind {
    pub const ALL: [Kind; 5] = [
        Kind::Frame(1),
        Kind::Frame(4),
        Kind::Still,
        Kind::Moving,
        Kind::Double,
    ];

    /// As people read it.
    pub fn title(self) -> String {
        match self {
            Kind::Frame(1) => "One frame of 1 sample a pixel".to_string(),
            Kind::Frame(spp) => format!("One frame of {spp} samples a pixel"),
            Kind::Still => format!("A clip of {FRAMES} frames of 1 sample a pixel, the camera still"),
            Kind::Moving => "The same, the camera moving by 1 to 4 pixels a frame".to_string(),
            Kind::Double => "Twice the size, one path for each pixel that is seen".to_string(),
        }
    }

    /// In a few words.
    pub fn short(self) -> String {
        match self {
            Kind::Frame(spp) => format!("{spp} spp, one frame"),
            Kind::Still => "still clip".to_string(),
            Kind::Moving => "moving clip".to_string(),
            Kind::Double => "twice the size".to_string(),
        }
    }

    /// As files have it.
    pub fn key(self) -> String {
        match self {
            Kind::Frame(spp) => format!("frame_{spp}_spp"),
            Kind::Still => "still_clip".to_string(),
            Kind::Moving => "moving_clip".to_string(),
            Kind::Double => "twice_the_size".to_string(),
        }
    }

    fn is_clip(self) -> bool {
        matches!(self, Kind::Still | Kind::Moving)
    }
}

/// Over all scenes.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    pub kind: Kind,
    pub rows: Vec<Row>,
    /// Means of the scenes that have [`UNCOVERED`] such pixels.
    pub uncovered: Option<Uncovered>,
}

/// A method's means over all scenes and frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    pub method: Method,
    pub psnr_db: f64,
    pub ssim: f64,
    pub flip: f64,
    /// PSNR of the last frame.
    pub last_db: f64,
    pub flicker: Option<f64>,
}

impl Report {
    /// How many samples the references have.
    fn references(&self) -> String {
        let Self { reference_spp, .. } = self;
        format!(
            "{reference_spp} samples a pixel, of the still camera {}",
            still_spp(*reference_spp)
        )
    }

    /// The parts of a kind, of the scenes that were rendered.
    fn parts(&self, kind: Kind) -> impl Iterator<Item = &Part> {
        let parts = self.scenes.iter().filter_map(|scene| scene.outcome.as_ref().ok());
        parts.flatten().filter(move |part| part.kind == kind)
    }

    /// Means over all scenes, by what was tried.
    pub fn summaries(&self) -> Vec<Summary> {
        let kinds = Kind::ALL.into_iter();
        let of = |kind| {
            let parts: Vec<&Part> = self.parts(kind).collect();
            let methods = parts.first()?.tried.iter().map(|tried| tried.method);
            let row = |method| {
                let tried: Vec<&Tried> = parts
                    .iter()
                    .flat_map(|part| part.tried.iter().filter(|tried| tried.method == method))
                    .collect();
                Row::of(method, &tried)
            };
            Some(Summary {
                kind,
                rows: methods.map(row).collect(),
                uncovered: Uncovered::mean(parts.iter().filter_map(|part| part.uncovered)),
            })
        };
        kinds.filter_map(of).collect()
    }

    /// Scenes that are not rendered, and why.
    pub fn skipped(&self) -> impl Iterator<Item = (&str, &str)> {
        self.scenes.iter().filter_map(|scene| {
            let reason = scene.outcome.as_ref().err()?;
            Some((scene.name.as_str(), reason.as_str()))
        })
    }
}

impl Row {
    fn of(method: Method, tried: &[&Tried]) -> Row {
        let over = |value: &dyn Fn(&Tried) -> f64| mean(tried.iter().map(|tried| value(tried)));
        let of_frames =
            |value: fn(&Metrics) -> f64| over(&|tried: &Tried| mean(tried.metrics.iter().map(value)));
        Row {
            method,
            psnr_db: of_frames(|m| m.psnr_db),
            ssim: of_frames(|m| m.ssim),
            flip: of_frames(|m| m.flip),
            last_db: over(&|tried| tried.metrics.last().map_or(0.0, |m| m.psnr_db)),
            flicker: tried
                .first()
                .and_then(|tried| tried.flicker)
                .map(|_| over(&|tried| tried.flicker.unwrap_or(0.0))),
        }
    }
}

impl Uncovered {
    fn mean(all: impl Iterator<Item = Uncovered>) -> Option<Uncovered> {
        let enough: Vec<Uncovered> = all.filter(|one| one.pixels >= UNCOVERED).collect();
        let over = |value: fn(&Uncovered) -> f64| mean(enough.iter().map(value));
        (!enough.is_empty()).then(|| Uncovered {
            pixels: enough.iter().map(|one| one.pixels).sum(),
            share: over(|one| one.share),
            with_history: over(|one| one.with_history),
            without: over(|one| one.without),
        })
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, count), x| (sum + x, count + 1));
    sum / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metrics(psnr_db: f64) -> Metrics {
        Metrics {
            bias: 0.0,
            rmse: 0.0,
            psnr_db,
            ssim: psnr_db / 100.0,
            flip: 1.0 / psnr_db,
            block_p95: 0.0,
            block_max: 0.0,
        }
    }

    fn scene(name: &str, uncovered: usize, ours: [f64; 2]) -> SceneReport {
        let tried = |method, of: [f64; 2]| Tried {
            method,
            shots: Vec::new(),
            metrics: of.map(metrics).to_vec(),
            flicker: Some(of[0] / 1000.0),
        };
        SceneReport {
            name: name.to_string(),
            width: 8,
            height: 8,
            outcome: Ok(vec![Part {
                kind: Kind::Moving,
                reference: Vec::new(),
                reference_db: 50.0,
                tried: vec![tried(Method::Ours, ours), tried(Method::OidnHigh, [25.0, 25.0])],
                uncovered: Some(Uncovered {
                    pixels: uncovered,
                    share: 0.5,
                    with_history: 20.0,
                    without: 21.0,
                }),
            }]),
        }
    }

    fn report() -> Report {
        let mut broken = scene("a <b>", 0, [0.0; 2]);
        broken.outcome = Err("no <such> thing".to_string());
        Report {
            reference_spp: 4,
            seed: 0,
            has_oidn: true,
            scenes: vec![
                scene("one", UNCOVERED, [20.0, 30.0]),
                scene("two", UNCOVERED - 1, [22.0, 28.0]),
                broken,
            ],
        }
    }

    #[test]
    fn means_are_over_scenes_and_frames() {
        let summaries = report().summaries();
        assert_eq!(summaries.len(), 1, "of what was tried alone");
        let row = summaries[0].rows[0];
        assert_eq!((row.psnr_db, row.last_db), (25.0, 29.0));
        assert!((row.flicker.unwrap() - 0.021).abs() < 1e-12);
        let uncovered = summaries[0].uncovered.unwrap();
        assert_eq!(uncovered.pixels, UNCOVERED, "one scene has too few");
    }

    #[test]
    fn checks_are_of_the_means() {
        let checks = check::checks(&report());
        let measured: Vec<(&str, String)> = checks
            .iter()
            .filter(|check| check.kind == Kind::Moving)
            .map(|check| (check.mark().name(), check.measured()))
            .collect();
        let expected = [("ok", "+0.00 dB"), ("off", "-1.00 dB"), ("off", "0.84 ×")];
        assert_eq!(measured, expected.map(|(mark, text)| (mark, text.to_string())));
        assert_eq!(checks.iter().filter(|check| check.value.is_none()).count(), 17);
    }

    #[test]
    fn a_scene_that_is_not_rendered_is_told_and_not_in_the_means() {
        let report = report();
        let html = page(&report).unwrap();
        let allow = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..roxmltree::ParsingOptions::default()
        };
        let document = roxmltree::Document::parse_with_options(&html, allow).unwrap();
        let told = document
            .descendants()
            .filter(|node| node.attribute("class") == Some("skipped"));
        let told: Vec<&str> = told.filter_map(|node| node.text()).collect();
        assert_eq!(told, ["Not rendered: no <such> thing"]);
        assert!(html.contains("1 of 3 bars are met, 17 not measured"));
        assert_eq!(json(&report)["scenes"][2]["skipped"], "no <such> thing");
        assert!(
            markdown(&report)
                .contains("\n2 scenes, references of 4 samples a pixel, of the still camera 64.\n")
        );
    }
}
