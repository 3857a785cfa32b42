//! The ST7789's start, in the shortest time its datasheet allows.

use embedded_graphics_core::pixelcolor::Rgb565;
use embedded_hal::delay::DelayNs;
use mipidsi::{
    dcs::{
        BitsPerPixel, EnterNormalMode, ExitSleepMode, InterfaceExt, PixelFormat, SetAddressMode,
        SetDisplayOn, SetInvertMode, SetPixelFormat,
    },
    interface::Interface,
    models::{Model, ModelInitError},
    options::ModelOptions,
};

/// ST7789 in 16-bit colour.
///
/// `mipidsi`'s own model waits 0.3 s. The datasheet (ST7789VW v1.0, 9.1.2, 9.1.12 and table 8.3) asks for 5 ms after a
/// reset, 120 ms from the reset to the end of sleep if the display was awake, and 5 ms after that.
pub struct Panel {
    /// Whether the display may have been awake before this start.
    pub was_awake: bool,
}

impl Model for Panel {
    type ColorFormat = Rgb565;
    const FRAMEBUFFER_SIZE: (u16, u16) = (240, 320);

    fn init<DELAY: DelayNs, DI: Interface>(
        &mut self,
        di: &mut DI,
        delay: &mut DELAY,
        options: &ModelOptions,
    ) -> Result<SetAddressMode, ModelInitError<DI::Error>> {
        delay.delay_ms(if self.was_awake { 120 } else { 5 });
        let address_mode = SetAddressMode::from(options);
        di.write_command(ExitSleepMode)?;
        delay.delay_ms(5);
        di.write_command(address_mode)?;
        di.write_command(SetInvertMode::new(options.invert_colors))?;
        let format = PixelFormat::with_all(BitsPerPixel::from_rgb_color::<Rgb565>());
        di.write_command(SetPixelFormat::new(format))?;
        di.write_command(EnterNormalMode)?;
        di.write_command(SetDisplayOn)?;
        Ok(address_mode)
    }
}
