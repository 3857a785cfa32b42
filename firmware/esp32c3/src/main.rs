//! Draws a picture on an ST7789 from an ESP32-C3, tile by tile.
//!
//! | GPIO | to |
//! | --- | --- |
//! | 3 | an LED, lit when the program stops by a failure |
//! | 4 | display SCK |
//! | 5 | display RST |
//! | 6 | display SDA (MOSI) |
//! | 7 | display D/C |
//! | 10 | display CS |
//!
//! A failure is a panic, a fault, an overflow of the stack, which `esp-hal` watches, or a display that does not start.
//! No emulator here runs this chip: the program is built, its arithmetic is what `firmware/qemu` runs on `virt`, and
//! the rest is untried.

#![no_std]
#![no_main]

use core::panic::PanicInfo;

use embedded_graphics_core::{
    pixelcolor::{Rgb565, raw::RawU16},
    prelude::*,
    primitives::Rectangle,
};
use embedded_hal_bus::spi::ExclusiveDevice;
use esp_hal::{
    Blocking,
    clock::CpuClock,
    delay::Delay,
    gpio::{AnyPin, Level, Output, OutputConfig},
    main,
    spi::{
        Mode,
        master::{Config, Spi},
    },
    time::Rate,
};
use firmware_common::{
    stage::{Cornell, Stage},
    tile::{self, PASSES, Painter},
};
use mipidsi::{Builder, Display, interface::SpiInterface, models::ST7789, options::ColorInversion};

type Device = ExclusiveDevice<Spi<'static, Blocking>, Output<'static>, embedded_hal_bus::spi::NoDelay>;
type Screen<'a> = Display<SpiInterface<'a, Device, Output<'static>>, ST7789, Output<'static>>;

#[main]
fn main() -> ! {
    let chip = esp_hal::init(esp_hal::Config::default().with_cpu_clock(CpuClock::max()));
    let output = OutputConfig::default();
    let select = Output::new(chip.GPIO10, Level::High, output);
    let data = Output::new(chip.GPIO7, Level::Low, output);
    let reset = Output::new(chip.GPIO5, Level::High, output);
    let bus = Config::default()
        .with_frequency(Rate::from_mhz(40))
        .with_mode(Mode::_3);
    let Ok(bus) = Spi::new(chip.SPI2, bus) else { fail() };
    let bus = bus.with_sck(chip.GPIO4).with_mosi(chip.GPIO6);
    let Ok(device) = ExclusiveDevice::new_no_delay(bus, select);

    let mut buffer = [0; 2 * tile::PIXELS];
    let started = Builder::new(ST7789, SpiInterface::new(device, data, &mut buffer))
        .display_size(tile::SQUARE.width() as u16, tile::SQUARE.height() as u16)
        .invert_colors(ColorInversion::Inverted)
        .reset_pin(reset)
        .init(&mut Delay::new());
    match started {
        Ok(mut screen) => draw(&mut screen),
        Err(_) => fail(),
    }
    loop {
        core::hint::spin_loop();
    }
}

/// Draws the Cornell box in ever better passes: renders and sends each tile in turn.
fn draw(screen: &mut Screen) {
    let Ok(mut cornell) = Cornell::new() else { fail() };
    let Ok((scene, camera)) = cornell.scene() else {
        fail()
    };
    let stage = Stage {
        scene: &scene,
        camera,
    };
    let mut pixels = [0; tile::PIXELS];
    for pass in PASSES {
        let mut painter = Painter::new(&stage, tile::SQUARE, pass);
        for index in 0..tile::SQUARE.tiles() {
            painter.render(index, &mut pixels);
            let (left, top) = tile::SQUARE.origin(index);
            let area = Rectangle::new(
                Point::new(left as i32, top as i32),
                Size::new(tile::SIDE, tile::SIDE),
            );
            let colours = pixels.iter().map(|&pixel| Rgb565::from(RawU16::new(pixel)));
            if screen.fill_contiguous(&area, colours).is_err() {
                fail();
            }
        }
    }
}

/// Lights the LED for ever.
fn fail() -> ! {
    // SAFETY: nothing else uses this pin.
    let pin = unsafe { AnyPin::steal(3) };
    let _led = Output::new(pin, Level::High, OutputConfig::default());
    loop {
        core::hint::spin_loop();
    }
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    fail()
}
