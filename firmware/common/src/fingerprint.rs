//! The fingerprint of a picture: a CRC-32 of its pixels' bits, as the records in `tests/` have them.

use microlux::{color::Radiance, num::Crc};

/// Takes a pixel in: three mantissas and the exponent, little end first.
pub fn pixel(crc: &mut Crc, light: Radiance) {
    let (mantissas, exponent) = light.to_parts();
    for half in mantissas {
        crc.bytes(&half.to_le_bytes());
    }
    crc.bytes(&exponent.to_le_bytes());
}
