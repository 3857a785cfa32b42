//! The Pico's firmware on a Raspberry Pi Pico 2, RP2350, by its two Cortex-M33 cores.
//!
//! All modules but [`chip`] are `firmware/pico`'s.

#![no_std]
#![no_main]

#[path = "../../pico/src/app.rs"]
mod app;
#[path = "../../pico/src/board.rs"]
mod board;
#[path = "../../pico/src/bus.rs"]
mod bus;
mod chip;
#[path = "../../pico/src/fault.rs"]
mod fault;
#[path = "../../pico/src/panel.rs"]
mod panel;
#[path = "../../pico/src/provoke.rs"]
mod provoke;
#[path = "../../pico/src/work.rs"]
mod work;

#[cfg(feature = "defmt")]
use defmt_rtt as _;
use rp235x_hal as hal;

/// Tells the boot ROM what this program is: for a secure ARM core.
#[unsafe(link_section = ".start_block")]
#[used]
pub static IMAGE: hal::block::ImageDef = hal::block::ImageDef::secure_exe();

#[hal::entry]
fn main() -> ! {
    app::run()
}
