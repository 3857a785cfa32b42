//! The boards and machines that run firmware, by the names that commands, QEMU and `firmware/qemu/memory` share.

use clap::ValueEnum;

use crate::setup::Part;

/// A board, or a machine of QEMU's that stands for one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Board {
    /// Raspberry Pi Pico: RP2040, two Cortex-M0+, an ST7789 on its SPI bus
    Pico,
    /// Raspberry Pi Pico 2: RP2350, two Cortex-M33; built only, no emulator runs it here
    Pico2,
    /// ESP32-C3: RV32IMC; built only, no emulator runs it here
    Esp32c3,
    /// BBC micro:bit: Cortex-M0, 16 KiB of RAM
    Microbit,
    /// The RP2040's processor alone
    Rp2040,
    /// Cortex-M3
    Mps2An385,
    /// Cortex-M4F
    Mps2An386,
    /// Cortex-M7
    Mps2An500,
    /// Cortex-M33
    Mps2An505,
    /// RV32IMC
    Virt,
}

impl Board {
    pub const fn name(self) -> &'static str {
        match self {
            Board::Pico => "pico",
            Board::Pico2 => "pico2",
            Board::Esp32c3 => "esp32c3",
            Board::Microbit => "microbit",
            Board::Rp2040 => "rp2040",
            Board::Mps2An385 => "mps2-an385",
            Board::Mps2An386 => "mps2-an386",
            Board::Mps2An500 => "mps2-an500",
            Board::Mps2An505 => "mps2-an505",
            Board::Virt => "virt",
        }
    }

    /// The processor.
    pub const fn core(self) -> &'static str {
        match self {
            Board::Pico | Board::Rp2040 => "Cortex-M0+",
            Board::Microbit => "Cortex-M0",
            Board::Mps2An385 => "Cortex-M3",
            Board::Mps2An386 => "Cortex-M4F",
            Board::Mps2An500 => "Cortex-M7",
            Board::Pico2 | Board::Mps2An505 => "Cortex-M33",
            Board::Esp32c3 | Board::Virt => "RV32IMC",
        }
    }

    /// What the compiler calls it.
    pub const fn target(self) -> &'static str {
        match self {
            Board::Pico | Board::Microbit | Board::Rp2040 => "thumbv6m-none-eabi",
            Board::Mps2An385 => "thumbv7m-none-eabi",
            Board::Mps2An386 | Board::Mps2An500 => "thumbv7em-none-eabihf",
            Board::Pico2 | Board::Mps2An505 => "thumbv8m.main-none-eabihf",
            Board::Esp32c3 | Board::Virt => "riscv32imc-unknown-none-elf",
        }
    }

    /// What emulates it, if anything does.
    pub const fn emulated_by(self) -> Option<Part> {
        match self {
            Board::Pico | Board::Rp2040 => Some(Part::Node),
            Board::Pico2 | Board::Esp32c3 => None,
            _ => Some(Part::Qemu),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_has_the_same_names() {
        for board in Board::value_variants() {
            let value = board.to_possible_value().expect("none is hidden");
            assert_eq!(value.get_name(), board.name());
        }
    }
}
