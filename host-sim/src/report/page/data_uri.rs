//! Pictures that stand in the page itself.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageResult};

use crate::picture::animated_png;
use crate::report::Shot;

/// Pictures of more pixels become JPEG: noise does not compress without loss.
const LOSSLESS: usize = 192 * 192;
const QUALITY: u8 = 92;

/// The picture as a `data:` address; empty where it cannot be encoded.
pub fn data_uri(shot: &Shot) -> String {
    let large = shot.pixels.len() > LOSSLESS;
    let kind = if large { "jpeg" } else { "png" };
    match encoded(shot, large) {
        Ok(bytes) => format!("data:image/{kind};base64,{}", STANDARD.encode(bytes)),
        Err(_) => String::new(),
    }
}

/// The pictures one after another, as a `data:` address of a picture that moves.
pub fn animated_uri(shots: &[Shot], fps: u16) -> String {
    let Some(first) = shots.first() else {
        return String::new();
    };
    let frames = shots.iter().map(|shot| shot.pixels.as_slice());
    match animated_png([first.width, first.height], frames, fps) {
        Ok(bytes) => format!("data:image/png;base64,{}", STANDARD.encode(bytes)),
        Err(_) => String::new(),
    }
}

fn encoded(shot: &Shot, large: bool) -> ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    let (pixels, kind) = (shot.pixels.as_flattened(), ExtendedColorType::Rgb8);
    let (width, height) = (shot.width as u32, shot.height as u32);
    if large {
        JpegEncoder::new_with_quality(&mut bytes, QUALITY).write_image(pixels, width, height, kind)?;
    } else {
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive)
            .write_image(pixels, width, height, kind)?;
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back(uri: &str, kind: &str) -> image::RgbImage {
        let code = uri.strip_prefix(&format!("data:image/{kind};base64,")).unwrap();
        image::load_from_memory(&STANDARD.decode(code).unwrap())
            .unwrap()
            .into_rgb8()
    }

    #[test]
    fn small_pictures_are_exact_and_large_ones_small() {
        let shot = |side: usize| Shot {
            width: side,
            height: side,
            pixels: (0..side * side)
                .map(|i| [(i % 251) as u8, (i / side % 256) as u8, 7])
                .collect(),
        };
        let small = shot(16);
        assert_eq!(
            back(&data_uri(&small), "png").as_raw().as_slice(),
            small.pixels.as_flattened()
        );
        let large = data_uri(&shot(256));
        assert_eq!(back(&large, "jpeg").dimensions(), (256, 256));
        assert!(large.len() < 256 * 256);
    }
}
