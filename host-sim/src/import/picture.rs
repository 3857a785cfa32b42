//! Pictures that light a scene: OpenEXR and Radiance HDR, linear.

use std::io::BufReader;
use std::path::Path;

use exr::prelude::{ReadChannels, ReadLayers};

use super::ImportError;
use crate::desc::Vec3;

/// Row-major, top row first, linear sRGB; nothing negative.
pub(super) struct Picture {
    pub width: u32,
    pub height: u32,
    pub pixels: Vec<Vec3>,
}

pub(super) fn read(path: &Path) -> Result<Picture, ImportError> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or("")
        .to_ascii_lowercase();
    let picture = match extension.as_str() {
        "exr" => read_exr(path)?,
        "hdr" => read_hdr(path)?,
        _ => return Err(ImportError::new(path, "not a picture of light; use .exr or .hdr")),
    };
    if let Some(at) = picture
        .pixels
        .iter()
        .position(|pixel| !pixel.iter().all(|c| c.is_finite() && *c >= 0.0))
    {
        let (x, y) = (at as u32 % picture.width, at as u32 / picture.width);
        return Err(ImportError::new(
            path,
            format!("pixel {x}, {y} is negative or not finite; repair the picture"),
        ));
    }
    Ok(picture)
}

fn read_exr(path: &Path) -> Result<Picture, ImportError> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Picture {
                width: size.0 as u32,
                height: size.1 as u32,
                pixels: vec![[0.0; 3]; size.area()],
            },
            |picture: &mut Picture, at, (r, g, b): (f32, f32, f32)| {
                picture.pixels[at.1 * picture.width as usize + at.0] = [r, g, b].map(f64::from);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|error| {
            ImportError::new(path, format!("not an OpenEXR picture with R, G and B ({error})"))
        })?;
    Ok(image.layer_data.channel_data.pixels)
}

fn read_hdr(path: &Path) -> Result<Picture, ImportError> {
    let file = std::fs::File::open(path).map_err(|error| ImportError::io(path, &error))?;
    let image = image::codecs::hdr::HdrDecoder::new(BufReader::new(file))
        .and_then(image::DynamicImage::from_decoder)
        .map_err(|error| ImportError::new(path, format!("not a Radiance HDR picture ({error})")))?
        .into_rgb32f();
    let (width, height) = image.dimensions();
    Ok(Picture {
        width,
        height,
        pixels: image.pixels().map(|pixel| pixel.0.map(f64::from)).collect(),
    })
}
