//! Denoised pictures, one or a sequence, as a board makes them: the core's denoiser in memory of the host's.

use microlux::camera::Camera;
use microlux::color::{Radiance, Rgb9e5};
use microlux::film::Feature;
use microlux::film::denoise::network::{Neural, TRAINED};
use microlux::film::denoise::{
    Atrous, Clean, Denoiser, Filter, Memory, Off, Pair, ROWS, Row, Scratch, Seen, Shown, Size,
};
use microlux::integrator::{Integrator, Path};
use microlux::render::{Motion, Renderer, Settings};
use microlux::sampler::{Independent, PcgRxsMXs32, Sampler};
use microlux::scene::Scene;
use rayon::prelude::*;

/// What is done about noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Denoise {
    #[default]
    Off,
    /// `microlux::film::denoise::Atrous`, as tuned for the number of samples.
    Atrous,
    /// `microlux::film::denoise::network`.
    Neural,
}

/// What stands between samples and picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cleaning {
    pub denoise: Denoise,
    /// How many pixels of the picture a rendered one is wide and high: 1, 2 or 3, of which both sides are multiples.
    pub upscale: u32,
    /// Whether each picture of a sequence is half of the one shown before, where that was: `microlux::film::denoise::Shown`.
    pub taa: bool,
}

impl Default for Cleaning {
    fn default() -> Cleaning {
        Cleaning {
            denoise: Denoise::Off,
            upscale: 1,
            taa: false,
        }
    }
}

impl Cleaning {
    /// Whether there is anything to do.
    pub fn is_on(self) -> bool {
        self != Cleaning::default()
    }

    /// The rendered picture's side for one that is seen.
    pub fn coarse(self, side: u32) -> u32 {
        side / self.upscale.max(1)
    }
}

/// One of the core's filters.
enum Chosen<'m> {
    Off(Off),
    Atrous(Atrous),
    Neural(Neural<'m>),
}

impl Filter for Chosen<'_> {
    fn filter(&mut self, pair: &impl Pair, size: Size, frame: &[Feature], lengths: &[u8], scratch: Scratch) {
        match self {
            Chosen::Off(off) => off.filter(pair, size, frame, lengths, scratch),
            Chosen::Atrous(atrous) => atrous.filter(pair, size, frame, lengths, scratch),
            Chosen::Neural(neural) => neural.filter(pair, size, frame, lengths, scratch),
        }
    }
}

/// What became of a frame.
#[derive(Clone, Debug)]
pub struct Cleaned {
    /// At the size that is seen.
    pub pixels: Vec<Radiance>,
    /// Before the filter: the frame with the light of those before it.
    pub gathered: Vec<Feature>,
    /// How many frames that light is of, 1 to 8; empty where nothing is denoised.
    pub lengths: Vec<u8>,
}

/// Two of rayon's threads.
struct Threads;

impl Pair for Threads {
    fn both(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
        rayon::join(one, other);
    }
}

/// Everything a frame depends on but scene, camera and seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    /// Of the picture that is seen.
    pub width: u16,
    pub height: u16,
    pub spp: u32,
    pub cleaning: Cleaning,
}

/// A sequence under way: what the denoiser remembers, and where the camera was.
pub struct Sequence<'m> {
    frames: Frames,
    denoiser: Denoiser<'m>,
    filter: Chosen<'m>,
    before: Option<Camera>,
    /// What was shown last; empty if nothing was since a cut.
    shown: Vec<Rgb9e5>,
}

/// Lends memory to a sequence.
pub fn sequence<R>(frames: Frames, show: impl FnOnce(&mut Sequence) -> R) -> R {
    let size = frames.coarse();
    let count = size.pixels();
    let mut pixels = [vec![Feature::default(); count], vec![Feature::default(); count]];
    let mut lengths = [vec![0; count], vec![0; count]];
    let mut rows = vec![Rgb9e5::BLACK; ROWS * usize::from(size.width)];
    let [now, before] = &mut pixels;
    let [lengths_now, lengths_before] = &mut lengths;
    let memory = Memory {
        frames: [now, before],
        lengths: [lengths_now, lengths_before],
        rows: &mut rows,
    };
    let denoiser = Denoiser::new(size, frames.spp, memory).expect("as long as it has to be");
    let mut own = match frames.cleaning.denoise {
        Denoise::Neural => vec![0; Neural::needs(size)],
        Denoise::Off | Denoise::Atrous => Vec::new(),
    };
    let filter = match frames.cleaning.denoise {
        Denoise::Off => Chosen::Off(Off),
        Denoise::Atrous => Chosen::Atrous(Atrous::for_spp(frames.spp)),
        Denoise::Neural => {
            let neural = Neural::new(TRAINED, size, frames.spp, &mut own);
            Chosen::Neural(neural.expect("as long as it has to be, and as large as pictures get"))
        }
    };
    show(&mut Sequence {
        frames,
        denoiser,
        filter,
        before: None,
        shown: Vec::new(),
    })
}

impl Frames {
    /// Rows that are rendered.
    pub fn rows(&self) -> usize {
        usize::from(self.coarse().height)
    }

    fn coarse(&self) -> Size {
        let side = |side: u16| self.cleaning.coarse(u32::from(side)) as u16;
        Size {
            width: side(self.width),
            height: side(self.height),
        }
    }
}

impl Sequence<'_> {
    /// The next frame, and how many rays it took; `advance` is told of each row that is done, and says whether to go on.
    ///
    /// Where nothing is denoised there is no history either, and no firefly is clamped: frames are as they are rendered.
    pub fn frame<S, I>(
        &mut self,
        scene: &Scene,
        camera: Camera,
        integrator: I,
        sampler: &S,
        advance: &(dyn Fn(u64) -> bool + Sync),
    ) -> Option<(Vec<Radiance>, u64)>
    where
        S: Sampler + Clone + Sync,
        I: Integrator + Copy + Sync,
    {
        let size = self.denoiser.size();
        let settings = Settings {
            width: size.width,
            height: size.height,
            spp: self.frames.spp,
        };
        let width = usize::from(size.width).max(1);
        let row = |(y, row): (usize, &mut [Feature])| {
            let mut renderer = Renderer::new(scene, camera, integrator, sampler.clone(), settings);
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = renderer.feature(x as u16, y as u16);
            }
            let rays = u64::from(renderer.rays());
            advance(rays).then_some(rays)
        };
        let rows = self.denoiser.frame().par_chunks_mut(width).enumerate();
        let rays = rows.map(row).collect::<Option<Vec<u64>>>()?.iter().sum();
        Some((self.finish(scene, camera).pixels, rays))
    }

    /// The same of a frame that was rendered already.
    pub fn take(&mut self, scene: &Scene, camera: Camera, frame: &[Feature]) -> Cleaned {
        self.denoiser.frame().copy_from_slice(frame);
        self.finish(scene, camera)
    }

    /// A cut: the next frame has no history.
    pub fn forget(&mut self) {
        self.denoiser.forget();
        self.shown.clear();
    }

    fn finish(&mut self, scene: &Scene, camera: Camera) -> Cleaned {
        let Sequence {
            frames,
            denoiser,
            filter,
            before,
            shown,
        } = self;
        let size = denoiser.size();
        match frames.cleaning.denoise {
            Denoise::Off => {
                let gathered = denoiser.frame().to_vec();
                let light: Vec<Rgb9e5> = gathered.iter().map(|pixel| pixel.irradiance).collect();
                let clean = Clean {
                    size,
                    frame: &gathered,
                    light: &light,
                    lengths: &[],
                    spp: frames.spp,
                    whole: 1,
                };
                let pixels = show(*frames, scene, camera, &clean, None);
                Cleaned {
                    pixels,
                    gathered,
                    lengths: Vec::new(),
                }
            }
            Denoise::Atrous | Denoise::Neural => {
                let before = before.replace(camera).unwrap_or(camera);
                let mut motion = Motion::between(before, camera, size.width, size.height);
                if frames.cleaning.upscale == 1 {
                    motion = motion.whole();
                }
                let clean = denoiser.denoise_by(&Threads, Some(&motion), filter);
                let upscale = frames.cleaning.upscale as u16;
                let motion = Motion::between(before, camera, upscale * size.width, upscale * size.height);
                let last = Shown {
                    size: Size {
                        width: frames.width,
                        height: frames.height,
                    },
                    lights: &*shown,
                    motion: &motion,
                };
                let last = (!shown.is_empty()).then_some(&last);
                let pixels = show(*frames, scene, camera, &clean, last);
                if frames.cleaning.taa {
                    *shown = pixels.iter().map(|light| Rgb9e5::encode(*light)).collect();
                }
                Cleaned {
                    pixels,
                    gathered: clean.frame.to_vec(),
                    lengths: clean.lengths.to_vec(),
                }
            }
        }
    }
}

/// Rows that a thread shows at a time.
const BAND: u16 = 16;

/// At the size that is seen, times the albedo; outlines without steps, unless nothing is denoised, and half of what was shown
/// `before`.
pub fn show(
    frames: Frames,
    scene: &Scene,
    camera: Camera,
    clean: &Clean,
    before: Option<&Shown<Motion>>,
) -> Vec<Radiance> {
    let Frames {
        width,
        height,
        cleaning,
        ..
    } = frames;
    let settings = Settings {
        width: clean.size.width * cleaning.upscale as u16,
        height: clean.size.height * cleaning.upscale as u16,
        spp: 1,
    };
    let sampler = Independent::<PcgRxsMXs32>::new(0);
    let guides = Renderer::new(scene, camera, Path::new(1), sampler, settings);
    if cleaning.denoise == Denoise::Off {
        let row = |y: u16| {
            let mut guides = guides.clone();
            let pixel = |x| match cleaning.upscale {
                3 => clean.pixel_3x(x, y, &guides.guide(x, y)),
                2 => clean.pixel_2x(x, y, &guides.guide(x, y)),
                _ => clean.pixel(x, y),
            };
            (0..width).map(pixel).collect::<Vec<_>>()
        };
        return (0..height).into_par_iter().flat_map_iter(row).collect();
    }
    let band = |number: u16| {
        let rows = number * BAND..height.min((number + 1) * BAND);
        let mut guides = guides.clone();
        let mut ring = vec![Seen::default(); 3 * usize::from(width)];
        let mut pixels = Vec::new();
        let show = |y, row: Row| match before {
            Some(before) => pixels.extend(row.steadied(y, before).map(Rgb9e5::decode)),
            None => pixels.extend(row.lights()),
        };
        match cleaning.upscale {
            3 => clean.rows_3x(rows, &mut ring, |x, y| guides.guide(x, y), show),
            2 => clean.rows_2x(rows, &mut ring, |x, y| guides.guide(x, y), show),
            _ => clean.rows(rows, &mut ring, show),
        }
        pixels
    };
    (0..height.div_ceil(BAND))
        .into_par_iter()
        .flat_map_iter(band)
        .collect()
}
