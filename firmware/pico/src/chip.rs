//! What the RP2040 does in its own way.

use cortex_m::peripheral::MPU;

use crate::hal::{
    self,
    clocks::ClocksManager,
    fugit::HertzU32,
    pac::{self, RESETS, TIMER},
    pll::PLLConfig,
};

/// Frames that fill 240 x 240 pixels, and memory for them.
#[cfg(feature = "full")]
pub use firmware_common::flight::{FULL, FullRoom};

pub type Timer = hal::Timer;

/// 12 MHz * 133 / (6 * 2) = 133 MHz, the rated clock.
pub const SYSTEM: PLLConfig = PLLConfig {
    vco_freq: HertzU32::MHz(1596),
    refdiv: 1,
    post_div1: 6,
    post_div2: 2,
};
/// A quarter of the clock: the next divisor, a half, is beyond the display's 62.5 MHz.
pub const SPI: HertzU32 = HertzU32::Hz(33_250_000);
/// About a fifth of a second, in cycles.
pub const BLINK: u32 = 26_000_000;

/// The peripheral that counts microseconds.
pub fn timer(timer: TIMER, resets: &mut RESETS, clocks: &ClocksManager) -> Timer {
    Timer::new(timer, resets, clocks)
}

/// The field of `pac::Peripherals` that [`timer`] takes.
macro_rules! timer_of {
    ($peripherals:expr) => {
        $peripherals.TIMER
    };
}
pub(crate) use timer_of;

/// Instructions by which a faulty core may take core 0's stack: nothing stands in the way here.
macro_rules! lift_stack_limit {
    () => {
        ""
    };
}
pub(crate) use lift_stack_limit;

/// Connects the LED's pad.
pub fn release_led(_: &pac::Peripherals) {}

unsafe extern "C" {
    /// Lower end of core 0's stack, from `memory.x`.
    static _stack_end: u32;
}

/// Puts a guard of 256 bytes, which nothing may touch, below the stack of core 0, which calls this.
///
/// Core 1's stack has the guard that `rp2040-hal` sets up. An overflow of either is a fault at once.
pub fn guard_stack() {
    /// A size and an alignment that the protection unit knows.
    const BYTES: u32 = 256;
    const VALID_REGION_0: u32 = 1 << 4;
    const ENABLE: u32 = 1;
    const SIZE: u32 = (BYTES.ilog2() - 1) << 1;
    const NO_EXECUTION: u32 = 1 << 28;
    const DEFAULT_MAP_ELSEWHERE: u32 = 1 << 2;
    let bottom = &raw const _stack_end as u32;
    // SAFETY: the unit belongs to this core alone. The region takes away access to the lowest bytes of its stack,
    // which no value occupies as long as the stack is large enough; all else keeps the access it has by default.
    unsafe {
        let unit = &*MPU::PTR;
        unit.rbar.write(bottom | VALID_REGION_0);
        unit.rasr.write(NO_EXECUTION | SIZE | ENABLE);
        unit.ctrl.write(DEFAULT_MAP_ELSEWHERE | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
