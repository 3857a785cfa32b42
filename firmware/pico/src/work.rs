//! Both cores draw: each takes the next tile, renders it, and hands it to the screen.

use core::cell::{Cell, RefCell};

use critical_section::{CriticalSection, Mutex};
use embedded_graphics_core::{
    pixelcolor::{Rgb565, raw::RawU16},
    prelude::*,
    primitives::Rectangle,
};
use firmware_common::{
    stage::{NAMES, Stage},
    tile::{self, PASSES, Painter, Pass},
};

use crate::{app::FRAME, board::Screen};

/// A pass over a scene; they are counted from 0 and follow each other for ever.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Step(u32);

impl Step {
    /// Place in [`NAMES`].
    pub const fn scene(self) -> usize {
        self.0 as usize / PASSES.len() % NAMES.len()
    }

    pub const fn pass(self) -> Pass {
        PASSES[self.0 as usize % PASSES.len()]
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

/// The first step: `MICROLUX_FIRST` at build time names a scene that is not to wait for those before it.
const FIRST: u32 = match option_env!("MICROLUX_FIRST") {
    Some(name) => {
        let mut scene = 0;
        while scene < NAMES.len() && !is_same(NAMES[scene].as_bytes(), name.as_bytes()) {
            scene += 1;
        }
        (scene % NAMES.len() * PASSES.len()) as u32
    }
    None => 0,
};

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
pub fn draw(stages: &Stages, step: Step, mut after: impl FnMut()) {
    let Some(stage) = stages.get(step.scene()) else {
        return;
    };
    let mut painter = Painter::new(stage, FRAME, step.pass());
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

/// Core 0, when it has no tile left: waits until the whole frame has left for the display.
pub fn finish() {
    while !critical_section::with(is_complete) {
        cortex_m::asm::delay(PAUSE);
    }
}

fn is_complete(section: CriticalSection) -> bool {
    let mut screen = SCREEN.borrow_ref_mut(section);
    // SAFETY: it is only asked; no command passes by the display's driver.
    let is_sent = screen
        .as_mut()
        .is_some_and(|screen| unsafe { screen.dcs() }.is_idle());
    is_sent && PROGRESS.borrow(section).drawn.get() == FRAME.tiles()
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
