//! Numbers as text, without `core`'s formatting, which would be in a board's program for this alone.

/// `number` in decimal digits, which lie in `digits`.
pub fn decimal(number: u32, digits: &mut [u8; 10]) -> &[u8] {
    let mut rest = number;
    let mut first = digits.len();
    for (place, digit) in digits.iter_mut().enumerate().rev() {
        *digit = b'0' + (rest % 10) as u8;
        rest /= 10;
        first = place;
        if rest == 0 {
            break;
        }
    }
    digits.get(first..).unwrap_or(&[])
}

/// `number` in eight hexadecimal digits, small letters.
pub fn hexadecimal(number: u32) -> [u8; 8] {
    let mut digits = [0; 8];
    for (digit, place) in digits.iter_mut().rev().zip(0..) {
        let value = (number >> (4 * place) & 15) as u8;
        *digit = if value < 10 {
            b'0' + value
        } else {
            b'a' + value - 10
        };
    }
    digits
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::format;

    #[test]
    fn numbers_are_as_formatting_writes_them() {
        for number in [0, 1, 9, 10, 4096, 0x0abc_def0, 0x9000_000a, u32::MAX] {
            assert_eq!(decimal(number, &mut [0; 10]), format!("{number}").as_bytes());
            assert_eq!(hexadecimal(number), format!("{number:08x}").as_bytes());
        }
    }
}
