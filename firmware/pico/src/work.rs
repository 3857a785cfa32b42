//! Both cores draw: each takes the next tile, renders it, and hands it to the screen.

use core::cell::{Cell, RefCell};

use critical_section::Mutex;
use embedded_graphics_core::{
    pixelcolor::{Rgb565, raw::RawU16},
    prelude::*,
    primitives::Rectangle,
};
use firmware_common::tile;

use crate::{app::FRAME, board::Screen};

/// Tiles handed out so far, of the frame at hand.
static TAKEN: Mutex<Cell<u32>> = Mutex::new(Cell::new(0));
/// Tiles that are on the screen or on their way.
static DRAWN: Mutex<Cell<u32>> = Mutex::new(Cell::new(0));
/// Set before a core looks for a tile.
static SCREEN: Mutex<RefCell<Option<Screen>>> = Mutex::new(RefCell::new(None));

/// Gives the screen to both cores.
pub fn share(screen: Screen) {
    critical_section::with(|section| SCREEN.borrow_ref_mut(section).replace(screen));
}

/// The next tile that no core has.
fn take() -> Option<u32> {
    critical_section::with(|section| {
        let taken = TAKEN.borrow(section);
        let index = taken.get();
        taken.set(index + u32::from(index < FRAME.tiles()));
        (index < FRAME.tiles()).then_some(index)
    })
}

/// Renders tiles until none is left; calls `after` behind each.
pub fn draw(mut after: impl FnMut()) {
    let mut pixels = [0; tile::PIXELS];
    while let Some(index) = take() {
        FRAME.render(index, &mut pixels);
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
        let drawn = DRAWN.borrow(section);
        drawn.set(drawn.get() + 1);
    });
}

/// Whether the whole frame has left for the display.
pub fn is_complete() -> bool {
    critical_section::with(|section| {
        let mut screen = SCREEN.borrow_ref_mut(section);
        // SAFETY: it is only asked; no command passes by the display's driver.
        let is_sent = screen
            .as_mut()
            .is_some_and(|screen| unsafe { screen.dcs() }.is_idle());
        is_sent && DRAWN.borrow(section).get() == FRAME.tiles()
    })
}
