//! How the board shows that it has stopped.
//!
//! | cause | display | LED on GPIO25 |
//! | --- | --- | --- |
//! | panic | red | 2 blinks, pause |
//! | fault, as of a stack overflow or a wild address | magenta | 3 blinks, pause |
//! | the display does not start | as it was | 4 blinks, pause |
//! | a scene is refused: the firmware was built wrong | cyan | 6 blinks, pause |
//! | restarted by the watchdog: a core hung or locked up | yellow | 5 blinks, pause |
//!
//! Nothing that was running is trusted: the other core is stopped, and the registers are used directly.

use core::{arch::naked_asm, panic::PanicInfo};

use crate::{chip, hal::pac};

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    Panic,
    Fault,
    Display,
    Watchdog,
    Scene,
}

impl Cause {
    /// RGB565, or `None` to leave the display alone.
    const fn colour(self) -> Option<u16> {
        match self {
            Self::Panic => Some(0xf800),
            Self::Fault => Some(0xf81f),
            Self::Display => None,
            Self::Watchdog => Some(0xffe0),
            Self::Scene => Some(0x07ff),
        }
    }

    const fn blinks(self) -> u32 {
        match self {
            Self::Panic => 2,
            Self::Fault => 3,
            Self::Display => 4,
            Self::Watchdog => 5,
            Self::Scene => 6,
        }
    }

    const fn line(self) -> &'static [u8] {
        match self {
            Self::Panic => b"stopped: panic\n",
            Self::Fault => b"stopped: fault\n",
            Self::Display => b"stopped: display\n",
            Self::Watchdog => b"stopped: watchdog\n",
            Self::Scene => b"stopped: scene\n",
        }
    }
}

/// Shows the cause for ever.
pub fn stop(cause: Cause) -> ! {
    cortex_m::interrupt::disable();
    // SAFETY: the other core is stopped first and this one never returns, so no other code uses the peripherals.
    let board = unsafe { pac::Peripherals::steal() };
    let is_core_1 = board.SIO.cpuid().read().bits() == 1;
    board.PSM.frce_off().modify(|_, w| {
        if is_core_1 {
            w.proc0().set_bit()
        } else {
            w.proc1().set_bit()
        }
    });
    board.WATCHDOG.ctrl().modify(|_, w| w.enable().clear_bit());

    let up = board.RESETS.reset_done().read();
    for &byte in cause.line() {
        if up.uart0().bit_is_clear() || board.UART0.uartcr().read().uarten().bit_is_clear() {
            break;
        }
        while board.UART0.uartfr().read().txff().bit_is_set() {}
        // SAFETY: any byte may be sent.
        board.UART0.uartdr().write(|w| unsafe { w.data().bits(byte) });
    }
    if let Some(colour) = cause.colour()
        && up.spi0().bit_is_set()
    {
        fill(&board, colour);
    }
    blink(&board, cause.blinks())
}

/// Fills the display's whole memory, by hand.
fn fill(board: &pac::Peripherals, colour: u16) {
    const DATA: u32 = 1 << 20;
    const COLUMNS: u8 = 0x2a;
    const ROWS: u8 = 0x2b;
    const WRITE: u8 = 0x2c;
    let wait = || while board.SPI0.sspsr().read().bsy().bit_is_set() {};
    let send = |byte: u8| {
        while board.SPI0.sspsr().read().tnf().bit_is_clear() {}
        // SAFETY: any byte may be sent.
        board
            .SPI0
            .sspdr()
            .write(|w| unsafe { w.data().bits(u16::from(byte)) });
    };
    let command = |byte| {
        wait();
        // SAFETY: a one bit sets its pin, here D/C, and zeros leave theirs.
        board.SIO.gpio_out_clr().write(|w| unsafe { w.bits(DATA) });
        send(byte);
        wait();
        // SAFETY: as above.
        board.SIO.gpio_out_set().write(|w| unsafe { w.bits(DATA) });
    };
    // The longest side either way, so that no orientation leaves a rest.
    const LAST: [u8; 2] = 319_u16.to_be_bytes();

    // SAFETY: every channel may be stopped.
    board.DMA.chan_abort().write(|w| unsafe { w.bits(0xffff) });
    for window in [COLUMNS, ROWS] {
        command(window);
        for byte in [0, 0, LAST[0], LAST[1]] {
            send(byte);
        }
    }
    command(WRITE);
    for _ in 0..320 * 320 {
        let [high, low] = colour.to_be_bytes();
        send(high);
        send(low);
    }
}

fn blink(board: &pac::Peripherals, times: u32) -> ! {
    const LED: usize = 25;
    const SIO_FUNCTION: u8 = 5;
    board
        .RESETS
        .reset()
        .modify(|_, w| w.io_bank0().clear_bit().pads_bank0().clear_bit());
    chip::release_led(board);
    // SAFETY: 5 selects the processors' own port, and a one bit is a pin.
    unsafe {
        board
            .IO_BANK0
            .gpio(LED)
            .gpio_ctrl()
            .write(|w| w.funcsel().bits(SIO_FUNCTION));
        board.SIO.gpio_oe_set().write(|w| w.bits(1 << LED));
    }
    loop {
        for _ in 0..times {
            // SAFETY: as above.
            unsafe { board.SIO.gpio_out_set().write(|w| w.bits(1 << LED)) };
            cortex_m::asm::delay(chip::BLINK);
            // SAFETY: as above.
            unsafe { board.SIO.gpio_out_clr().write(|w| w.bits(1 << LED)) };
            cortex_m::asm::delay(chip::BLINK);
        }
        cortex_m::asm::delay(4 * chip::BLINK);
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    #[cfg(feature = "defmt")]
    defmt::error!("{}", defmt::Display2Format(info));
    #[cfg(not(feature = "defmt"))]
    let _ = info;
    stop(Cause::Panic)
}

/// Every fault of either core. The stack pointer may be what is wrong, so it starts anew, on core 0's stack.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() -> ! {
    naked_asm!(
        chip::lift_stack_limit!(),
        "ldr r0, =_stack_start",
        "mov sp, r0",
        "bl {after}",
        after = sym after_fault,
    )
}

extern "C" fn after_fault() -> ! {
    stop(Cause::Fault)
}
