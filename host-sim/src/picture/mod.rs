//! A rendered picture, and the files it becomes.

mod exr;
mod file;
mod pfm;
mod png;

use std::path::Path;

pub use self::exr::read as read_exr;
pub use self::file::{FileError, Target};
pub use self::pfm::decode as decode_pfm;
pub use self::png::animated as animated_png;

/// Linear light, row by row from the top left, beside what else was asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    pub width: usize,
    pub height: usize,
    /// Linear sRGB radiance, W·sr⁻¹·m⁻², before exposure.
    pub rgb: Vec<[f32; 3]>,
    pub aov: Option<Aov>,
    /// What the display of the options shows: tone mapped, dithered, as 8-bit sRGB.
    pub display: Option<Vec<[u8; 3]>>,
}

/// Features of each pixel's first non-specular hit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Aov {
    pub albedo: Vec<[f32; 3]>,
    /// World space, unit length; zero where nothing was hit.
    pub normal: Vec<[f32; 3]>,
    /// Metres along the ray; zero where nothing was hit.
    pub depth: Vec<f32>,
    /// Number of the shape from 1; zero where nothing was hit.
    pub id: Vec<u32>,
}

/// One of the features, to be written into an EXR.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    Albedo,
    Normal,
    Depth,
    Id,
}

/// How a picture is to be written.
#[derive(Clone, Debug, Default)]
pub struct Style {
    /// Stops; PNG only, and only where there is no display picture: a display has its own.
    pub exposure: f64,
    /// EXR only; layers that the picture has not are left out.
    pub layers: Vec<Layer>,
}

/// Kinds of picture files, by ending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB: what the display shows where there is one, else light exposed and clipped.
    Png,
    /// Linear, 32-bit float, with layers; losslessly compressed.
    Exr,
    /// Linear, 32-bit float, RGB alone.
    Pfm,
}

impl Format {
    pub fn of(path: &Path) -> Result<Format, FileError> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("png") => Ok(Format::Png),
            Some("exr") => Ok(Format::Exr),
            Some("pfm") => Ok(Format::Pfm),
            Some(other) => Err(FileError::new(
                path,
                format!("cannot write pictures as .{other}; end the name in .png, .exr or .pfm"),
            )),
            None => Err(FileError::new(
                path,
                "the name says no kind of picture; end it in .png, .exr or .pfm",
            )),
        }
    }

    /// The whole file.
    pub fn encode(self, picture: &Picture, style: &Style) -> Result<Vec<u8>, String> {
        match self {
            Format::Png => png::encode(
                picture.width,
                picture.height,
                &display_pixels(picture, style.exposure),
            ),
            Format::Exr => exr::encode(picture, &style.layers),
            Format::Pfm => Ok(pfm::encode(picture)),
        }
    }
}

/// What is to be seen: the display's picture, else the light at `exposure` stops, clipped, as sRGB.
pub fn display_pixels(picture: &Picture, exposure: f64) -> Vec<[u8; 3]> {
    match &picture.display {
        Some(pixels) => pixels.clone(),
        None => {
            let gain = exposure.exp2();
            picture
                .rgb
                .iter()
                .map(|rgb| rgb.map(|x| (srgb(f64::from(x) * gain) * 255.0).round() as u8))
                .collect()
        }
    }
}

/// Linear light as an sRGB signal (IEC 61966-2-1), both 0..1; what is outside is clipped, what is no number is 0.
pub fn srgb(linear: f64) -> f64 {
    let x = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
    if x <= 0.0031308 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}

/// Light without bound as light under 1: x / (1 + x), what is negative as 0.
pub fn compressed(light: [f32; 3]) -> [f32; 3] {
    light.map(|x| x.max(0.0) / (1.0 + x.max(0.0)))
}

/// The light that an sRGB signal stands for (IEC 61966-2-1), both 0..1.
pub fn from_srgb(signal: f64) -> f64 {
    if signal <= 0.04045 {
        signal / 12.92
    } else {
        ((signal + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_has_its_known_values() {
        assert_eq!(srgb(0.0), 0.0);
        assert!((srgb(1.0) - 1.0).abs() < 1e-12);
        assert!((srgb(0.5) - 0.735_356_983_052_45).abs() < 1e-9);
        assert!((srgb(0.001) - 0.01292).abs() < 1e-12);
        assert_eq!([srgb(-1.0), srgb(f64::NAN), srgb(7.0)], [0.0, 0.0, srgb(1.0)]);
    }

    #[test]
    fn exposure_doubles_light_but_not_the_display() {
        let mut picture = Picture {
            width: 1,
            height: 1,
            rgb: vec![[0.25, 0.0, 2.0]],
            ..Picture::default()
        };
        assert_eq!(display_pixels(&picture, 1.0), [[188, 0, 255]]);
        picture.display = Some(vec![[1, 2, 3]]);
        assert_eq!(display_pixels(&picture, 1.0), [[1, 2, 3]]);
    }

    #[test]
    fn endings_name_the_format() {
        assert_eq!(Format::of(Path::new("a/b.PNG")), Ok(Format::Png));
        let error = Format::of(Path::new("a/b.jpg")).unwrap_err().to_string();
        assert_eq!(
            error,
            "a/b.jpg: cannot write pictures as .jpg; end the name in .png, .exr or .pfm"
        );
        assert!(Format::of(Path::new("picture")).is_err());
    }
}
