//! The Pico, or the Pico 2, and what is wired to it.
//!
//! | GPIO | to |
//! | --- | --- |
//! | 0, 1 | UART log, 921,600 baud |
//! | 17 | display CS |
//! | 18 | display SCK |
//! | 19 | display SDA (MOSI) |
//! | 20 | display D/C |
//! | 21 | display RST |
//! | 25 | the Pico's LED |

use crate::hal::{
    Clock, Sio, Watchdog,
    clocks::ClocksManager,
    dma::DMAExt,
    fugit::{HertzU32, RateExtU32},
    gpio::{
        FunctionSioOutput, FunctionUart, Pin, Pins, PullDown,
        bank0::{Gpio0, Gpio1, Gpio21},
    },
    pac::{self, UART0},
    pll,
    sio::SioFifo,
    spi::Spi,
    uart::{self, UartConfig, UartPeripheral},
    xosc,
};
use embedded_hal::digital::OutputPin;
use mipidsi::{
    Builder, Display,
    options::{ColorInversion, Orientation, Rotation},
};

use crate::{
    app::FRAME,
    bus::Bus,
    chip::{self, SPI, SYSTEM, Timer},
    panel::Panel,
};

pub type Screen = Display<Bus, Panel, Pin<Gpio21, FunctionSioOutput, PullDown>>;
pub type Console = UartPeripheral<
    uart::Enabled,
    UART0,
    (
        Pin<Gpio0, FunctionUart, PullDown>,
        Pin<Gpio1, FunctionUart, PullDown>,
    ),
>;

const CRYSTAL: HertzU32 = HertzU32::MHz(12);

pub struct Board {
    pub screen: Screen,
    pub console: Console,
    pub timer: Timer,
    pub watchdog: Watchdog,
    /// What starting core 1 takes.
    pub core_1: (pac::PSM, pac::PPB, SioFifo),
    /// Whether this start is the watchdog's doing.
    pub was_hung: bool,
}

/// Clocks, pins and display; `None` if something of it does not start.
pub fn start(mut p: pac::Peripherals) -> Option<Board> {
    let was_hung = p.WATCHDOG.reason().read().timer().bit_is_set();
    let mut watchdog = Watchdog::new(p.WATCHDOG);
    let crystal = xosc::setup_xosc_blocking(p.XOSC, CRYSTAL).ok()?;
    watchdog.enable_tick_generation(12);
    let mut clocks = ClocksManager::new(p.CLOCKS);
    let system = pll::setup_pll_blocking(p.PLL_SYS, CRYSTAL, SYSTEM, &mut clocks, &mut p.RESETS).ok()?;
    let usb = pll::common_configs::PLL_USB_48MHZ;
    let usb = pll::setup_pll_blocking(p.PLL_USB, CRYSTAL, usb, &mut clocks, &mut p.RESETS).ok()?;
    clocks.init_default(&crystal, &system, &usb).ok()?;
    let peripheral_clock = clocks.peripheral_clock.freq();

    let mut timer = chip::timer(chip::timer_of!(p), &mut p.RESETS, &clocks);
    let sio = Sio::new(p.SIO);
    let pins = Pins::new(p.IO_BANK0, p.PADS_BANK0, sio.gpio_bank0, &mut p.RESETS);

    let speed = UartConfig::new(921_600.Hz(), uart::DataBits::Eight, None, uart::StopBits::One);
    let console = UartPeripheral::new(
        p.UART0,
        (pins.gpio0.reconfigure(), pins.gpio1.reconfigure()),
        &mut p.RESETS,
    )
    .enable(speed, peripheral_clock)
    .ok()?;

    let mut select = pins.gpio17.into_push_pull_output();
    select.set_low().ok()?;
    let spi_pins = (pins.gpio19.reconfigure(), pins.gpio18.reconfigure());
    let spi = Spi::<_, _, _, 8>::new(p.SPI0, spi_pins).init(
        &mut p.RESETS,
        peripheral_clock,
        SPI,
        embedded_hal::spi::MODE_3,
    );
    let dma = p.DMA.split(&mut p.RESETS);
    let bus = Bus::new(dma.ch0, spi, pins.gpio20.into_push_pull_output())?;
    let turn = if FRAME.width() > 240 {
        Rotation::Deg90
    } else {
        Rotation::Deg0
    };
    let (width, height) = if FRAME.width() > 240 {
        (FRAME.height(), FRAME.width())
    } else {
        (FRAME.width(), FRAME.height())
    };
    let screen = Builder::new(Panel { was_awake: was_hung }, bus)
        .display_size(width as u16, height as u16)
        .orientation(Orientation::new().rotate(turn))
        .invert_colors(ColorInversion::Inverted)
        .reset_pin(pins.gpio21.into_push_pull_output())
        .init(&mut timer)
        .ok()?;
    Some(Board {
        screen,
        console,
        timer,
        watchdog,
        core_1: (p.PSM, p.PPB, sio.fifo),
        was_hung,
    })
}
