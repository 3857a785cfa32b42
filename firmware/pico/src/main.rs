//! Draws a picture on an ST7789 from both cores of a Raspberry Pi Pico, tile by tile as they are done.
//!
//! Wiring: [`board`]. What it shows when something goes wrong: [`fault`]. `firmware/pico2` compiles the same modules
//! for the RP2350, all but this one and [`chip`].

#![no_std]
#![no_main]

mod app;
mod board;
mod bus;
mod chip;
mod fault;
mod panel;
mod provoke;
mod work;

#[cfg(feature = "defmt")]
use defmt_rtt as _;
use rp2040_hal as hal;

/// Loads the program from flash: the first 256 bytes.
#[unsafe(link_section = ".boot2")]
#[unsafe(no_mangle)]
#[used]
pub static BOOT2_FIRMWARE: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

#[hal::entry]
fn main() -> ! {
    app::run()
}
