//! A flight past a scene: few samples a pixel, denoised, shown twice as large, by two workers.

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
    film::denoise::{Atrous, Denoiser, Memory, Pair, ROWS, Seen, Size, TooShort},
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

/// Of a frame as it is rendered.
pub const SIZE: Size = Size {
    width: 80,
    height: 60,
};
/// Of a frame as it is shown, pixels.
pub const WIDTH: usize = 2 * SIZE.width as usize;
pub const HEIGHT: usize = 2 * SIZE.height as usize;
/// Rows that a worker shows at a time; it makes one more above and below.
const BAND: usize = 30;
/// Pixels that become colours at a time: a row's light would take stack.
const PIECE: usize = 8;

/// Samples a pixel.
pub const SPP: u32 = 1;

/// Frames there and back.
pub const FRAMES: u32 = 64;

const PIXELS: usize = SIZE.pixels();
const EMPTY: Feature = Feature {
    irradiance: Rgb9e5::BLACK,
    albedo: [0; 3],
    depth: 0,
    normal: Octahedral([0; 2]),
    id: 0,
};

/// Memory that flights take, in a variable of the program's.
pub struct Room {
    frames: [[Feature; PIXELS]; 2],
    lengths: [[u8; PIXELS]; 2],
    rows: [Rgb9e5; ROWS * SIZE.width as usize],
    /// The network's own; then, in its place, three rows as they are shown, for each worker.
    network: [u32; Neural::needs(SIZE)],
}

const _: () = assert!(size_of::<[[Seen; 3 * WIDTH]; 2]>() <= 4 * Neural::needs(SIZE));

impl Room {
    pub const EMPTY: Room = Room {
        frames: [[EMPTY; PIXELS]; 2],
        lengths: [[0; PIXELS]; 2],
        rows: [Rgb9e5::BLACK; ROWS * SIZE.width as usize],
        network: [0; Neural::needs(SIZE)],
    };
}

/// A room that does not suffice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    Denoiser(TooShort),
    Network(NetworkError),
}

/// Frame after frame; remembers what it saw.
pub struct Flight<'m> {
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

impl<'m> Flight<'m> {
    pub fn new(room: &'m mut Room) -> Result<Flight<'m>, Refused> {
        let [now, before] = &mut room.frames;
        let [lengths, lengths_before] = &mut room.lengths;
        let memory = Memory {
            frames: [now, before],
            lengths: [lengths, lengths_before],
            rows: &mut room.rows,
        };
        Ok(Flight {
            denoiser: Denoiser::new(SIZE, SPP, memory).map_err(Refused::Denoiser)?,
            atrous: Atrous::for_spp(SPP),
            neural: Neural::new(TRAINED, SIZE, SPP, &mut room.network).map_err(Refused::Network)?,
            before: None,
        })
    }

    /// Renders, cleans and shows frame `number`, the first of which has no history: `show` gets each row of RGB565,
    /// whichever worker has it.
    pub fn frame(
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
        let camera = widened(stage.camera, SIZE.width.into(), SIZE.height.into());
        let camera = moved(camera, place.min(FRAMES - place));
        let settings = |scale: u16, spp| Settings {
            width: scale * SIZE.width,
            height: scale * SIZE.height,
            spp,
        };
        let renderer = |settings, seed| {
            let sampler: Independent = Independent::new(seed);
            Renderer::new(stage.scene, camera, Path::direct(), sampler, settings)
        };

        let rows = self.denoiser.frame().chunks_exact_mut(SIZE.width.into());
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
        let motion = Motion::between(before, camera, SIZE.width, SIZE.height);
        let clean = match way {
            Way::Atrous => self.denoiser.denoise_by(pair, Some(&motion), &mut self.atrous),
            Way::Neural => self.denoiser.denoise_by(pair, Some(&motion), &mut self.neural),
        };

        let bands = Turns::new((0..HEIGHT as u16).step_by(BAND));
        let raise = |ring: &mut [Seen]| {
            let mut renderer = renderer(settings(2, 1), 0);
            let mut guide = |x, y| renderer.guide(x, y);
            let mut colours = [0; WIDTH];
            while let Some(first) = bands.next() {
                clean.rows_2x(first..first + BAND as u16, ring, &mut guide, |y, row| {
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
                });
            }
        };
        // What the network works in is not needed now.
        let rows = Seen::over(self.neural.memory());
        let (ring, other) = rows.split_at_mut(rows.len() / 2);
        pair.both(|| raise(ring), || raise(other));
    }
}
