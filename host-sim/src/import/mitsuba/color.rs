//! Colours: linear sRGB, whatever way they are written.

use super::super::ImportError;
use super::params::{number, numbers, value};
use super::tree::Element;
use crate::desc::Vec3;
use crate::picture::from_srgb;

/// What a colour measures, which decides its range and what a single spectral number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// 0 to 1.
    Reflectance,
    /// Radiance, intensity, irradiance: not negative.
    Emission,
    /// Index of refraction or absorption: not negative.
    Index,
}

/// The colour of a spectrum that is 1 at all wavelengths, in linear sRGB (whose white is D65): measured on Mitsuba 3.9.1,
/// whose emitters show `<spectrum value="1"/>` so.
const EQUAL_ENERGY: Vec3 = [1.204_793_93, 0.948_291_004, 0.908_916_056];

/// `<rgb value="r, g, b"/>`, `<rgb value="grey"/>`, `<rgb value="#rrggbb"/>`, `<spectrum value="number"/>` or
/// `<float value="number"/>`.
pub(super) fn read(element: &Element, name: &str, quantity: Quantity) -> Result<Vec3, ImportError> {
    let text = value(element);
    let color = match element.tag.as_str() {
        "rgb" => rgb(element, text)?,
        "spectrum" => {
            let number = text.trim().parse::<f64>().map_err(|_| {
                let message = format!(
                    "a spectrum of wavelengths (\"{text}\") is not supported; write one number or <rgb>"
                );
                element.error(message)
            })?;
            let white = if quantity == Quantity::Emission {
                EQUAL_ENERGY
            } else {
                [1.0; 3]
            };
            white.map(|w| w * number)
        }
        _ => [number(element, text)?; 3],
    };
    let (holds, range) = match quantity {
        Quantity::Reflectance => (color.iter().all(|c| (0.0..=1.0).contains(c)), "0 to 1"),
        Quantity::Emission | Quantity::Index => {
            (color.iter().all(|c| *c >= 0.0 && c.is_finite()), "0 or more")
        }
    };
    match holds {
        true => Ok(color),
        false => Err(element.error(format!(
            "{name} {text} is out of range; each channel must be {range}"
        ))),
    }
}

fn rgb(element: &Element, text: &str) -> Result<Vec3, ImportError> {
    if let Some(digits) = text.trim().strip_prefix('#') {
        return hexadecimal(digits).ok_or_else(|| {
            element.error(format!("\"{text}\" is not #rrggbb; write six hexadecimal digits"))
        });
    }
    match numbers(element, text)?[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        ref other => Err(element.error(format!("rgb has {} numbers; write one or three", other.len()))),
    }
}

/// Six digits of sRGB, decoded to linear light.
fn hexadecimal(digits: &str) -> Option<Vec3> {
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let code = u32::from_str_radix(digits, 16).ok()?;
    Some([16, 8, 0].map(|shift| from_srgb(f64::from(code >> shift & 0xff) / 255.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_is_decoded_to_light() {
        let [r, g, b] = hexadecimal("ff8000").unwrap();
        assert_eq!((r, b), (1.0, 0.0));
        assert!((g - 0.215_860_5).abs() < 1e-6);
        assert_eq!(hexadecimal("ff80"), None);
        assert_eq!(hexadecimal("+f8000"), None);
    }
}
