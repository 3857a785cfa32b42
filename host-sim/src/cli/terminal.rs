//! A picture in the terminal.

use std::io::{self, IsTerminal};

use image::{DynamicImage, RgbImage};

/// Two pixels a character, as large as fits; nothing where the standard output is no terminal or cannot show colours.
pub fn show(width: usize, height: usize, pixels: &[[u8; 3]]) {
    let dumb = std::env::var_os("TERM").is_none_or(|term| term == "dumb");
    if !io::stdout().is_terminal() || dumb {
        return;
    }
    let bytes = pixels.as_flattened().to_vec();
    let Some(image) = RgbImage::from_raw(width as u32, height as u32, bytes) else {
        return;
    };
    let config = viuer::Config {
        absolute_offset: false,
        use_kitty: false,
        use_iterm: false,
        ..viuer::Config::default()
    };
    // The file is written by now; a terminal that fails to show it takes nothing away.
    let _ = viuer::print(&DynamicImage::ImageRgb8(image), &config);
}
