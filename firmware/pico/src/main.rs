//! Draws a picture on an ST7789 from both cores of a Raspberry Pi Pico, tile by tile as they are done.
//!
//! Wiring: [`board`]. What it shows when something goes wrong: [`fault`].

#![no_std]
#![no_main]

mod board;
mod bus;
mod fault;
mod guard;
mod panel;
mod provoke;
mod work;

#[cfg(feature = "defmt")]
use defmt_rtt as _;
use firmware_common::tile::{self, Frame};
use rp2040_hal::{
    self as hal,
    multicore::{Multicore, Stack},
    pac,
};

use fault::Cause;

/// The display.
const FRAME: Frame = if cfg!(feature = "wide") {
    tile::WIDE
} else {
    tile::SQUARE
};

/// Longest time between two tiles of core 0.
const HANG: fugit::MicrosDurationU32 = fugit::MicrosDurationU32::millis(8_000);

/// Loads the program from flash: the first 256 bytes.
#[unsafe(link_section = ".boot2")]
#[unsafe(no_mangle)]
#[used]
pub static BOOT2_FIRMWARE: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

/// 16 KiB, as many as core 0 has.
static CORE_1_STACK: Stack<4096> = Stack::new();

#[hal::entry]
fn main() -> ! {
    let (Some(peripherals), Some(core)) = (pac::Peripherals::take(), pac::CorePeripherals::take()) else {
        fault::stop(Cause::Display)
    };
    guard::install(&core.MPU);
    let Some(board) = board::start(peripherals) else {
        fault::stop(Cause::Display)
    };
    let board::Board {
        screen,
        console,
        timer,
        mut watchdog,
        core_1: (mut power, mut bus, mut fifo),
        was_hung,
    } = board;
    if was_hung {
        fault::stop(Cause::Watchdog);
    }
    watchdog.start(HANG);

    work::share(screen);
    let mut cores = Multicore::new(&mut power, &mut bus, &mut fifo);
    let (Some(stack), [_, core_1]) = (CORE_1_STACK.take(), cores.cores()) else {
        fault::stop(Cause::Fault)
    };
    if core_1
        .spawn(stack, || work::draw(|| provoke::on_core(1)))
        .is_err()
    {
        fault::stop(Cause::Fault);
    }
    work::draw(|| {
        watchdog.feed();
        provoke::on_core(0);
    });
    while !work::is_complete() {}

    report(&console, timer.get_counter().ticks());
    loop {
        watchdog.feed();
        cortex_m::asm::delay(1_000_000);
    }
}

/// Prints when the picture was complete, in microseconds since the start.
fn report(console: &board::Console, microseconds: u64) {
    #[cfg(feature = "defmt")]
    defmt::info!("frame complete at {} us", microseconds);

    let mut digits = [b'0'; 10];
    let mut rest = microseconds as u32;
    for digit in digits.iter_mut().rev() {
        *digit += (rest % 10) as u8;
        rest /= 10;
    }
    for part in [b"frame us=".as_slice(), &digits, b"\n"] {
        console.write_full_blocking(part);
    }
}
