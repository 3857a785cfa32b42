//! A picture in a window, live.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::*;
use embedded_graphics::primitives::Rectangle;
use embedded_graphics_simulator::{OutputSettings, SimulatorDisplay, SimulatorEvent, Window};

use super::progress::Meter;
use crate::desc::SceneDesc;
use crate::run::{Error, Options, Progress};

const FRAME: Duration = Duration::from_millis(30);

/// Makes a picture in another thread and shows its rows as they come; then waits until the window is closed.
///
/// Closing it earlier sets `stop`; where there will be no picture, the window closes by itself.
pub fn watch<T: Send>(
    desc: &SceneDesc,
    options: &Options,
    meter: &Meter,
    stop: &AtomicBool,
    make: impl FnOnce(&dyn Progress) -> Result<T, Error> + Send,
) -> Result<T, Error> {
    let size = Size::new(options.width, options.height);
    let display = Mutex::new(SimulatorDisplay::with_default_color(size, Rgb888::BLACK));
    let live = Live {
        meter,
        display: &display,
    };
    let mut window = Window::new(&desc.name, &OutputSettings::default());
    let failed = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let render = scope.spawn(|| {
            let result = make(&live);
            failed.store(result.is_err(), Ordering::SeqCst);
            result
        });
        let mut closed = false;
        while !closed && !failed.load(Ordering::SeqCst) && !stop.load(Ordering::SeqCst) {
            window.update(&lock(&display));
            closed = window.events().any(|event| event == SimulatorEvent::Quit);
            std::thread::sleep(FRAME);
        }
        if !render.is_finished() {
            stop.store(true, Ordering::SeqCst);
        }
        render
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Passes progress on to the meter and rows to the display.
struct Live<'a> {
    meter: &'a Meter,
    display: &'a Mutex<SimulatorDisplay<Rgb888>>,
}

impl Progress for Live<'_> {
    fn advance(&self, done: usize, total: usize, rays: u64) {
        self.meter.advance(done, total, rays);
    }

    fn wants_rows(&self) -> bool {
        true
    }

    fn rows(&self, first_row: usize, rgb8: &[[u8; 3]]) {
        let mut display = lock(self.display);
        let width = display.size().width;
        let height = rgb8.len() as u32 / width.max(1);
        let area = Rectangle::new(Point::new(0, first_row as i32), Size::new(width, height));
        let Ok(()) = display.fill_contiguous(&area, rgb8.iter().map(|&[r, g, b]| Rgb888::new(r, g, b)));
    }
}

fn lock(display: &Mutex<SimulatorDisplay<Rgb888>>) -> std::sync::MutexGuard<'_, SimulatorDisplay<Rgb888>> {
    display.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
