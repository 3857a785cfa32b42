//! What the firmware does, on either chip: both cores draw the picture, once.

use firmware_common::tile::{self, Frame};

use crate::{
    board::{self, Board, Console},
    chip,
    fault::{self, Cause},
    hal::{
        fugit::MicrosDurationU32,
        multicore::{Multicore, Stack},
        pac,
    },
    provoke, work,
};

/// The display.
pub const FRAME: Frame = if cfg!(feature = "wide") {
    tile::WIDE
} else {
    tile::SQUARE
};

/// Longest time between two tiles of core 0.
const HANG: MicrosDurationU32 = MicrosDurationU32::millis(8_000);

/// 16 KiB, as many as core 0 has.
static CORE_1_STACK: Stack<4096> = Stack::new();

pub fn run() -> ! {
    chip::guard_stack();
    let Some(board) = pac::Peripherals::take().and_then(board::start) else {
        fault::stop(Cause::Display)
    };
    let Board {
        screen,
        console,
        timer,
        mut watchdog,
        core_1,
        was_hung,
    } = board;
    if was_hung {
        fault::stop(Cause::Watchdog);
    }
    watchdog.start(HANG);

    work::share(screen);
    let (mut power, mut bus, mut fifo) = core_1;
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
fn report(console: &Console, microseconds: u64) {
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
