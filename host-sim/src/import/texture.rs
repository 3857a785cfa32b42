//! Textures: as they are where a mesh says where in them it is, else what they are on average.

use std::sync::Arc;

use crate::desc::{TextureDesc, Vec3};
use crate::picture::from_srgb;

/// The mean of a picture's texels as they are stored, and of the light they stand for (sRGB), each 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mean {
    pub stored: Vec3,
    pub linear: Vec3,
}

/// Of a PNG or JPEG file in memory.
pub(super) fn mean(bytes: &[u8]) -> Result<Mean, String> {
    let picture = image::load_from_memory(bytes).map_err(|error| format!("is no picture ({error})"))?;
    let (mut stored, mut linear) = ([0.0; 3], [0.0; 3]);
    let pixels = picture.to_rgb8();
    for pixel in pixels.pixels() {
        for i in 0..3 {
            let share = f64::from(pixel.0[i]) / 255.0;
            stored[i] += share;
            linear[i] += from_srgb(share);
        }
    }
    let count = (pixels.len() / 3).max(1) as f64;
    Ok(Mean {
        stored: stored.map(|sum| sum / count),
        linear: linear.map(|sum| sum / count),
    })
}

/// Longest side that a texture may have.
const LONGEST: u32 = 4096;

/// A PNG or JPEG file in memory, its signals sRGB unless they are `raw` light.
pub(super) fn decode(name: &str, bytes: &[u8], nearest: bool, raw: bool) -> Result<Arc<TextureDesc>, String> {
    let picture = image::load_from_memory(bytes).map_err(|error| format!("is no picture ({error})"))?;
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 || width.max(height) > LONGEST {
        return Err(format!(
            "is {width} x {height} texels; 1 to {LONGEST} a side are possible: scale it down"
        ));
    }
    let light = |byte: u8| match f64::from(byte) / 255.0 {
        share if raw => share,
        signal => from_srgb(signal),
    };
    Ok(Arc::new(TextureDesc {
        name: name.to_string(),
        width,
        height,
        texels: picture
            .to_rgb8()
            .pixels()
            .map(|pixel| pixel.0.map(light))
            .collect(),
        nearest,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_averaged_not_signals() {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let board = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb([if x == 0 { 255 } else { 0 }, 188, 0]));
        board.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let mean = mean(bytes.get_ref()).unwrap();
        assert_eq!((mean.stored[0], mean.linear[0]), (0.5, 0.5));
        assert!((mean.linear[1] - 0.5029).abs() < 1e-4, "{mean:?}");
        assert!(super::mean(b"no picture").is_err());
    }
}
