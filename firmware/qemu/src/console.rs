//! Standard output of whoever runs the emulator, by semihosting, without `core`'s formatting.

use firmware_common::text;
use semihosting::io::{Write, stdout};

/// Prints the texts one after the other.
pub fn print(texts: &[&str]) {
    for text in texts {
        write(text.as_bytes());
    }
}

/// Prints a number.
pub fn decimal(number: u32) {
    let mut digits = [0; 10];
    write(text::decimal(number, &mut digits));
}

/// Prints eight digits.
pub fn hexadecimal(number: u32) {
    write(&text::hexadecimal(number));
}

/// What cannot be printed is lost, and the line is missed by whoever reads.
fn write(bytes: &[u8]) {
    if let Ok(mut output) = stdout() {
        let _ = output.write_all(bytes);
    }
}
