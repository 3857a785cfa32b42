//! A flight past a scene: few samples a pixel, denoised, shown larger, by two workers.

use core::cell::RefCell;

use critical_section::Mutex;
use embedded_graphics_core::{
    geometry::{Point, Size as Extent},
    pixelcolor::{IntoStorage, Rgb565},
    primitives::Rectangle,
};
use microlux::{
    camera::Camera,
    color::{Radiance, Rgb9e5},
    film::denoise::network::{NetworkError, Neural, TRAINED},
    film::denoise::{Atrous, Denoiser, Memory, Pair, ROWS, Row, Seen, Size, TooShort},
    film::{Feature, Tile},
    geom::Octahedral,
    integrator::Path,
    render::{Motion, Renderer, Settings},
    sampler::Independent,
};

use crate::{
    denoise::{Way, moved},
    stage::Stage,
    tile::{DISPLAY, widened},
};

/// The flights in the order in which the firmware shows them, each by its filter.
pub const WAYS: [Way; 2] = [Way::Atrous, Way::Neural];

/// Their names, which the firmware prints and the emulator is given.
pub const NAMES: [&str; WAYS.len()] = ["flight", "flight-neural"];

/// How large a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// As it is rendered.
    pub size: Size,
    /// How many shown pixels a rendered one is wide and high: 2 or 3.
    pub scale: u16,
}

impl Form {
    const fn new(width: u16, height: u16, scale: u16) -> Form {
        let form = Form {
            size: Size { width, height },
            scale,
        };
        assert!(size_of::<Seen>() * 2 * 3 * form.width() <= 4 * Neural::needs(form.size));
        form
    }

    /// Pixels that are shown.
    pub const fn width(self) -> usize {
        self.size.times(self.scale).width as usize
    }

    pub const fn height(self) -> usize {
        self.size.times(self.scale).height as usize
    }
}

/// 160 x 120 shown pixels.
pub const SMALL: Form = Form::new(80, 60, 2);
/// 240 x 240, where RAM is short.
pub const FULL: Form = Form::new(80, 80, 3);
/// 240 x 240, where there is more.
pub const FINE: Form = Form::new(120, 120, 2);

/// Rows that a worker shows at a time; it makes one more above and below.
const BAND: usize = 30;
/// Pixels that become colours at a time: a row's light would take stack.
const PIECE: usize = 8;

/// Samples a pixel.
pub const SPP: u32 = 1;

/// Frames there and back.
pub const FRAMES: u32 = 64;

const EMPTY: Feature = Feature {
    irradiance: Rgb9e5::BLACK,
    albedo: [0; 3],
    depth: 0,
    normal: Octahedral([0; 2]),
    id: 0,
};

/// Memory that flights take, in a variable of the program's: so many pixels, lights of [`ROWS`] and words of the network.
pub struct Room<const PIXELS: usize, const LIGHTS: usize, const WORDS: usize> {
    frames: [[Feature; PIXELS]; 2],
    lengths: [[u8; PIXELS]; 2],
    rows: [Rgb9e5; LIGHTS],
    /// The network's own; then, in its place, three rows as they are shown, for each worker.
    network: [u32; WORDS],
}

/// For flights of [`SMALL`] frames.
pub type SmallRoom = Room<{ SMALL.size.pixels() }, { lights(SMALL) }, { Neural::needs(SMALL.size) }>;
/// For flights of [`FULL`] frames.
pub type FullRoom = Room<{ FULL.size.pixels() }, { lights(FULL) }, { Neural::needs(FULL.size) }>;
/// For flights of [`FINE`] frames.
pub type FineRoom = Room<{ FINE.size.pixels() }, { lights(FINE) }, { Neural::needs(FINE.size) }>;

const fn lights(form: Form) -> usize {
    ROWS * form.size.width as usize
}

impl<const PIXELS: usize, const LIGHTS: usize, const WORDS: usize> Room<PIXELS, LIGHTS, WORDS> {
    pub const EMPTY: Self = Room {
        frames: [[EMPTY; PIXELS]; 2],
        lengths: [[0; PIXELS]; 2],
        rows: [Rgb9e5::BLACK; LIGHTS],
        network: [0; WORDS],
    };
}

/// A room that does not suffice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    Denoiser(TooShort),
    Network(NetworkError),
}

/// Frame after frame, shown so many times as large; remembers what it saw.
pub struct Flight<'m, const SCALE: u16> {
    size: Size,
    denoiser: Denoiser<'m>,
    atrous: Atrous,
    neural: Neural<'m>,
    before: Option<Camera>,
}

/// Things that both workers take in turn.
struct Turns<I>(Mutex<RefCell<I>>);

impl<I: Iterator> Turns<I> {
    fn new(things: I) -> Turns<I> {
        Turns(Mutex::new(RefCell::new(things)))
    }

    fn next(&self) -> Option<I::Item> {
        critical_section::with(|section| self.0.borrow_ref_mut(section).next())
    }
}

impl<'m, const SCALE: u16> Flight<'m, SCALE> {
    /// Of frames that are rendered at `size`.
    pub fn new<const PIXELS: usize, const LIGHTS: usize, const WORDS: usize>(
        size: Size,
        room: &'m mut Room<PIXELS, LIGHTS, WORDS>,
    ) -> Result<Self, Refused> {
        let [now, before] = &mut room.frames;
        let [lengths, lengths_before] = &mut room.lengths;
        let memory = Memory {
            frames: [now, before],
            lengths: [lengths, lengths_before],
            rows: &mut room.rows,
        };
        Ok(Flight {
            size,
            denoiser: Denoiser::new(size, SPP, memory).map_err(Refused::Denoiser)?,
            atrous: Atrous::for_spp(SPP),
            neural: Neural::new(TRAINED, size, SPP, &mut room.network).map_err(Refused::Network)?,
            before: None,
        })
    }

    /// Renders, cleans and shows frame `number`, the first of which has no history: `show` gets each row of RGB565,
    /// [`Form::width`] of them, whichever worker has it.
    pub fn frame<const WIDTH: usize>(
        &mut self,
        pair: &impl Pair,
        stage: &Stage,
        way: Way,
        number: u32,
        show: &(impl Fn(usize, &[u16; WIDTH]) + Sync),
    ) {
        if number == 0 {
            self.denoiser.forget();
        }
        let place = number % FRAMES;
        let size = self.size;
        let camera = widened(stage.camera, size.width.into(), size.height.into());
        let camera = moved(camera, place.min(FRAMES - place));
        let settings = |scale: u16, spp| Settings {
            width: scale * size.width,
            height: scale * size.height,
            spp,
        };
        let renderer = |settings, seed| {
            let sampler: Independent = Independent::new(seed);
            Renderer::new(stage.scene, camera, Path::direct(), sampler, settings)
        };

        let rows = self.denoiser.frame().chunks_exact_mut(size.width.into());
        let rows = Turns::new((0..).zip(rows));
        let render = || {
            let mut renderer = renderer(settings(1, SPP), number);
            while let Some((y, row)) = rows.next() {
                for (x, pixel) in (0..).zip(row) {
                    *pixel = renderer.feature(x, y);
                }
            }
        };
        pair.both(render, render);

        let before = self.before.replace(camera).unwrap_or(camera);
        let motion = Motion::between(before, camera, size.width, size.height);
        let clean = match way {
            Way::Atrous => self.denoiser.denoise_by(pair, Some(&motion), &mut self.atrous),
            Way::Neural => self.denoiser.denoise_by(pair, Some(&motion), &mut self.neural),
        };

        let bands = Turns::new((0..SCALE * size.height).step_by(BAND));
        let raise = |ring: &mut [Seen]| {
            let mut renderer = renderer(settings(SCALE, 1), 0);
            let mut guide = |x, y| renderer.guide(x, y);
            let mut colours = [0; WIDTH];
            while let Some(first) = bands.next() {
                let rows = first..first + BAND as u16;
                let line = |y: u16, row: Row| {
                    let mut lights = row.lights();
                    for (x, colours) in (0..).step_by(PIECE).zip(colours.chunks_exact_mut(PIECE)) {
                        let mut piece = [Radiance::BLACK; PIECE];
                        for (place, light) in piece.iter_mut().zip(&mut lights) {
                            *place = light;
                        }
                        let tile = Tile {
                            area: Rectangle::new(Point::new(x, y.into()), Extent::new(PIECE as u32, 1)),
                            pixels: &piece,
                        };
                        for (place, colour) in colours.iter_mut().zip(tile.colors::<Rgb565>(&DISPLAY)) {
                            *place = colour.into_storage();
                        }
                    }
                    show(y.into(), &colours);
                };
                match SCALE {
                    3 => clean.rows_3x(rows, ring, &mut guide, line),
                    _ => clean.rows_2x(rows, ring, &mut guide, line),
                }
            }
        };
        // What the network works in is not needed now.
        let rows = Seen::over(self.neural.memory());
        let (ring, other) = rows.split_at_mut(rows.len() / 2);
        pair.both(|| raise(ring), || raise(other));
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::{boxed::Box, sync::Mutex, vec, vec::Vec};

    use microlux::film::denoise::Alone;

    use super::*;
    use crate::stage::Cornell;

    /// The second worker first.
    struct Backwards;

    impl Pair for Backwards {
        fn both(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
            other();
            one();
        }
    }

    /// Frames of a form, row by row as they came.
    fn shown<const WIDTH: usize, const SCALE: u16>(
        mut flight: Flight<SCALE>,
        pair: &impl Pair,
        form: Form,
    ) -> Vec<Vec<Vec<u16>>> {
        let mut cornell = Cornell::new().unwrap();
        let (scene, camera) = cornell.scene().unwrap();
        let stage = Stage {
            scene: &scene,
            camera,
        };
        let one = |number| {
            let rows = Mutex::new(vec![Vec::new(); form.height()]);
            flight.frame(pair, &stage, Way::Neural, number, &|y, row: &[u16; WIDTH]| {
                let place = &mut rows.lock().unwrap()[y];
                assert!(place.is_empty(), "row {y} came twice");
                place.extend(row);
            });
            rows.into_inner().unwrap()
        };
        (0..2).map(one).collect()
    }

    /// Each row comes once and whole, the same whoever works first, and shows the box.
    fn is_whole<const WIDTH: usize, const SCALE: u16, const P: usize, const L: usize, const W: usize>(
        form: Form,
        mut room: Box<Room<P, L, W>>,
    ) -> Vec<Vec<u16>> {
        let mut frames = shown::<WIDTH, SCALE>(Flight::new(form.size, &mut room).unwrap(), &Alone, form);
        let other = shown::<WIDTH, SCALE>(Flight::new(form.size, &mut room).unwrap(), &Backwards, form);
        assert!(frames == other, "{form:?}");
        assert!(frames[0] != frames[1], "{form:?}: the camera moves");
        for rows in &frames {
            assert!(rows.iter().all(|row| row.len() == form.width()), "{form:?}");
            let lit = |x: usize| rows.iter().filter(|row| row[x] != 0).count();
            // The box is as wide as it is high.
            let (middle, aside) = (form.width() / 2, form.height() * 2 / 5);
            for x in [middle - aside, middle, middle + aside] {
                assert!(lit(x) > form.height() / 2, "{form:?}, column {x}: {}", lit(x));
            }
        }
        frames.remove(1)
    }

    #[test]
    fn every_form_shows_whole_frames() {
        is_whole::<{ SMALL.width() }, { SMALL.scale }, _, _, _>(SMALL, Box::new(SmallRoom::EMPTY));
        let full = is_whole::<{ FULL.width() }, { FULL.scale }, _, _, _>(FULL, Box::new(FullRoom::EMPTY));
        let fine = is_whole::<{ FINE.width() }, { FINE.scale }, _, _, _>(FINE, Box::new(FineRoom::EMPTY));
        // The same view by fewer pixels and by more: green, 64ths.
        let pairs = full.iter().flatten().zip(fine.iter().flatten());
        let off = pairs.map(|(a, b)| u32::from((a >> 5 & 63).abs_diff(b >> 5 & 63)));
        let mean = f64::from(off.sum::<u32>()) / (240.0 * 240.0);
        assert!(mean < 1.0, "{mean}");
    }
}
