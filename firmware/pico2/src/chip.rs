//! What the RP2350 does in its own way.

use crate::hal::{
    clocks::ClocksManager,
    fugit::HertzU32,
    pac::{self, RESETS, TIMER0},
    pll::{PLLConfig, common_configs::PLL_SYS_150MHZ},
    timer::{self, CopyableTimer0},
};

/// Frames that fill 240 x 240 pixels, and memory for them.
#[cfg(feature = "full")]
pub use firmware_common::flight::{FINE as FULL, FineRoom as FullRoom};

pub type Timer = timer::Timer<CopyableTimer0>;

/// 150 MHz, the rated clock.
pub const SYSTEM: PLLConfig = PLL_SYS_150MHZ;
/// A quarter of the clock: the next divisor, a half, is beyond the display's 62.5 MHz.
pub const SPI: HertzU32 = HertzU32::Hz(37_500_000);
/// About a fifth of a second, in cycles.
pub const BLINK: u32 = 30_000_000;

/// The peripheral that counts microseconds.
pub fn timer(timer: TIMER0, resets: &mut RESETS, clocks: &ClocksManager) -> Timer {
    Timer::new_timer0(timer, resets, clocks)
}

/// The field of `pac::Peripherals` that [`timer`] takes.
macro_rules! timer_of {
    ($peripherals:expr) => {
        $peripherals.TIMER0
    };
}
pub(crate) use timer_of;

/// Instructions by which a faulty core may take core 0's stack, which lies below core 1's limit.
macro_rules! lift_stack_limit {
    () => {
        "movs r0, #0\nmsr msplim, r0"
    };
}
pub(crate) use lift_stack_limit;

/// Connects the LED's pad, which is isolated after a reset.
pub fn release_led(board: &pac::Peripherals) {
    board
        .PADS_BANK0
        .gpio(25)
        .modify(|_, w| w.iso().clear_bit().od().clear_bit());
}

unsafe extern "C" {
    /// Lower end of core 0's stack, from `memory.x`.
    static _stack_end: u32;
}

/// Sets the limit of core 0's stack; `rp235x-hal` sets core 1's. An overflow of either is a fault at once.
pub fn guard_stack() {
    // SAFETY: the limit is the lower end of the stack that this core runs on.
    unsafe { cortex_m::register::msplim::write(&raw const _stack_end as u32) };
}
