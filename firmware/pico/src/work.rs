//! Both cores draw: each takes the next tile, renders it, and hands it to the screen. Of a flight core 0 leads, and core 1
//! does what it is given ([`Cores`]).

use core::cell::{Cell, RefCell};
use core::ptr::NonNull;

use critical_section::{CriticalSection, Mutex};
use embedded_graphics_core::{
    pixelcolor::{Rgb565, raw::RawU16},
    prelude::*,
    primitives::Rectangle,
};
use firmware_common::{
    denoise::Way,
    flight::{self, Flight},
    stage::{NAMES, Stage},
    tile::{self, PASSES, Painter, Pass},
};
use microlux::film::denoise::Pair;

use crate::{
    app::{FORM, FRAME},
    board::Screen,
};

/// A pass over a scene, or a frame of a flight; they are counted from 0 and follow each other for ever.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Step(u32);

/// What is drawn in a step.
#[derive(Clone, Copy)]
pub enum Part {
    /// A scene by its place in [`NAMES`].
    Still { scene: usize, pass: Pass },
    /// A frame by the place of its flight in [`flight::WAYS`], and its number.
    Frame { flight: usize, number: u32 },
}

/// Passes over all scenes.
const STILLS: u32 = (NAMES.len() * PASSES.len()) as u32;

impl Step {
    pub const fn part(self) -> Part {
        let place = self.0 % (STILLS + flight::WAYS.len() as u32 * flight::FRAMES);
        if place < STILLS {
            Part::Still {
                scene: place as usize / PASSES.len(),
                pass: PASSES[place as usize % PASSES.len()],
            }
        } else {
            let place = place - STILLS;
            Part::Frame {
                flight: (place / flight::FRAMES) as usize,
                number: place % flight::FRAMES,
            }
        }
    }
}

/// Scenes that both cores read.
pub type Stages = [Stage<'static>; NAMES.len()];

/// What the cores share. Tiles count within the step.
struct Progress {
    step: Cell<u32>,
    /// Tiles handed out.
    taken: Cell<u32>,
    /// Tiles that are on the screen or on their way.
    drawn: Cell<u32>,
}

static PROGRESS: Mutex<Progress> = Mutex::new(Progress {
    step: Cell::new(FIRST),
    taken: Cell::new(0),
    drawn: Cell::new(0),
});
/// Set before a core looks for a tile.
static SCREEN: Mutex<RefCell<Option<Screen>>> = Mutex::new(RefCell::new(None));

/// Cycles between two looks at what the other core does, which leave it the bus.
const PAUSE: u32 = 500;

/// Gives the screen to both cores.
pub fn share(screen: Screen) {
    critical_section::with(|section| SCREEN.borrow_ref_mut(section).replace(screen));
}

/// Every step in turn.
pub fn steps() -> impl Iterator<Item = Step> {
    (FIRST..).map(Step)
}

/// The first step: `MICROLUX_FIRST` at build time names a scene or a flight that is not to wait for those before it.
const FIRST: u32 = match option_env!("MICROLUX_FIRST") {
    Some(name) => match (find(&NAMES, name), find(&flight::NAMES, name)) {
        (Some(scene), _) => (scene * PASSES.len()) as u32,
        (_, Some(flight)) => STILLS + flight as u32 * flight::FRAMES,
        _ => 0,
    },
    None => 0,
};

const fn find(names: &[&str], name: &str) -> Option<usize> {
    let mut i = 0;
    while i < names.len() {
        if is_same(names[i].as_bytes(), name.as_bytes()) {
            return Some(i);
        }
        i += 1;
    }
    None
}

const fn is_same(a: &[u8], b: &[u8]) -> bool {
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

/// The next tile of the step that no core has.
fn take(step: Step) -> Option<u32> {
    critical_section::with(|section| {
        let progress = PROGRESS.borrow(section);
        let index = progress.taken.get();
        let is_there = progress.step.get() == step.0 && index < FRAME.tiles();
        progress.taken.set(index + u32::from(is_there));
        is_there.then_some(index)
    })
}

/// Renders tiles of a step until none is left; calls `after` behind each.
pub fn draw(stage: &Stage<'static>, step: Step, pass: Pass, mut after: impl FnMut()) {
    let mut painter = Painter::new(stage, FRAME, pass);
    let mut pixels = [0; tile::PIXELS];
    while let Some(index) = take(step) {
        painter.render(index, &mut pixels);
        show(index, &pixels);
        after();
    }
}

/// Copies a tile to the display's bus, which sends it while the next one is rendered.
fn show(index: u32, pixels: &[u16; tile::PIXELS]) {
    let (left, top) = FRAME.origin(index);
    let area = Rectangle::new(
        Point::new(left as i32, top as i32),
        Size::new(tile::SIDE, tile::SIDE),
    );
    let colours = pixels.iter().map(|&pixel| Rgb565::from(RawU16::new(pixel)));
    critical_section::with(|section| {
        if let Some(screen) = &mut *SCREEN.borrow_ref_mut(section) {
            let Ok(()) = screen.fill_contiguous(&area, colours);
        }
        let drawn = &PROGRESS.borrow(section).drawn;
        drawn.set(drawn.get() + 1);
    });
}

/// Core 0: draws frame `number` of a flight in the middle of the screen, with core 1's help, and waits until it has left
/// for the display.
pub fn fly(flight: &mut Flight<{ FORM.scale }>, stage: &Stage<'static>, way: Way, number: u32) {
    const WIDTH: usize = FORM.width();
    const LEFT: i32 = (FRAME.width() as i32 - WIDTH as i32) / 2;
    const TOP: i32 = (FRAME.height() as i32 - FORM.height() as i32) / 2;
    let whole = Rectangle::new(Point::zero(), Size::new(FRAME.width(), FRAME.height()));
    if number == 0 {
        critical_section::with(|section| {
            if let Some(screen) = &mut *SCREEN.borrow_ref_mut(section) {
                let Ok(()) = screen.fill_solid(&whole, Rgb565::BLACK);
            }
        });
    }
    flight.frame(&Cores, stage, way, number, &|y, row: &[u16; WIDTH]| {
        let area = Rectangle::new(Point::new(LEFT, TOP + y as i32), Size::new(WIDTH as u32, 1));
        let colours = row.iter().map(|&pixel| Rgb565::from(RawU16::new(pixel)));
        critical_section::with(|section| {
            if let Some(screen) = &mut *SCREEN.borrow_ref_mut(section) {
                let Ok(()) = screen.fill_contiguous(&area, colours);
            }
        });
    });
    while !critical_section::with(is_sent) {
        cortex_m::asm::delay(PAUSE);
    }
}

/// Core 0 leads, core 1 helps: it must be in [`help`], or get there.
struct Cores;

/// Work for core 1: what [`run`] takes, behind a pointer.
#[derive(Clone, Copy)]
struct Order {
    run: unsafe fn(NonNull<()>),
    work: NonNull<()>,
}

// SAFETY: the work is `Send`, and whoever gave the order leaves it alone until it is done.
unsafe impl Send for Order {}

static ORDER: Mutex<Cell<Option<Order>>> = Mutex::new(Cell::new(None));

impl Pair for Cores {
    fn both(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
        let mut work = Some(other);
        let order = Order {
            run: pointer_to_run(&work),
            work: NonNull::from(&mut work).cast(),
        };
        critical_section::with(|section| ORDER.borrow(section).set(Some(order)));
        one();
        // `work` lives until core 1 has taken the order back.
        while critical_section::with(|section| ORDER.borrow(section).get().is_some()) {
            cortex_m::asm::delay(PAUSE);
        }
    }
}

/// [`run`] for this work.
fn pointer_to_run<F: FnOnce()>(_: &Option<F>) -> unsafe fn(NonNull<()>) {
    run::<F>
}

/// Does the work.
///
/// # Safety
///
/// `work` must point to an `Option<F>` that nobody else uses meanwhile.
unsafe fn run<F: FnOnce()>(work: NonNull<()>) {
    // SAFETY: as the caller promises.
    let work = unsafe { work.cast::<Option<F>>().as_mut() };
    if let Some(work) = work.take() {
        work();
    }
}

/// Core 1, while there is a flight: does what core 0 gives it, until the next step has begun.
pub fn help(step: Step) {
    while critical_section::with(|section| PROGRESS.borrow(section).step.get() == step.0) {
        match critical_section::with(|section| ORDER.borrow(section).get()) {
            Some(order) => {
                // SAFETY: `Cores::both` wrote the order for this function, and waits until it is taken back.
                unsafe { (order.run)(order.work) };
                critical_section::with(|section| ORDER.borrow(section).set(None));
            }
            None => cortex_m::asm::delay(PAUSE),
        }
    }
}

/// Core 0, when it has no tile left: waits until the whole frame has left for the display.
pub fn finish() {
    while !critical_section::with(is_complete) {
        cortex_m::asm::delay(PAUSE);
    }
}

fn is_complete(section: CriticalSection) -> bool {
    is_sent(section) && PROGRESS.borrow(section).drawn.get() == FRAME.tiles()
}

fn is_sent(section: CriticalSection) -> bool {
    let mut screen = SCREEN.borrow_ref_mut(section);
    // SAFETY: it is only asked; no command passes by the display's driver.
    screen
        .as_mut()
        .is_some_and(|screen| unsafe { screen.dcs() }.is_idle())
}

/// Core 0, when all is drawn: begins the next step.
pub fn advance() {
    critical_section::with(|section| {
        let progress = PROGRESS.borrow(section);
        progress.step.set(progress.step.get().wrapping_add(1));
        progress.taken.set(0);
        progress.drawn.set(0);
    });
}

/// Core 1, when it has no tile left: waits until the next step has begun.
pub fn wait(step: Step) {
    while critical_section::with(|section| PROGRESS.borrow(section).step.get() == step.0) {
        cortex_m::asm::delay(PAUSE);
    }
}
