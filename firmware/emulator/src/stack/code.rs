//! Machine code, reduced to what moves the stack pointer or leaves the function.

use std::collections::HashMap;

use anyhow::{Result, anyhow};
use capstone::{
    Capstone,
    arch::{BuildsCapstone, BuildsCapstoneExtraMode, arm, riscv},
};

/// Something that an instruction does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Calls the function at an address.
    Call(u64),
    /// Calls whatever a register points at.
    CallPointer,
    /// Goes on elsewhere, in this function or at the start of another.
    Jump(u64),
    /// Goes on where a register points: a `match` by table, or a call at a function's very end.
    JumpPointer,
    /// Takes bytes off the stack pointer.
    Grow(u64),
    /// Takes as many off it as a register says.
    GrowUnknown,
    /// Puts an address together.
    Address(u64),
}

/// A disassembler for one instruction set.
pub struct Decoder {
    capstone: Capstone,
    is_arm: bool,
}

impl Decoder {
    pub fn thumb() -> Result<Decoder> {
        let builder = Capstone::new().arm().mode(arm::ArchMode::Thumb);
        let capstone = builder
            .extra_mode([arm::ArchExtraMode::MClass].into_iter())
            .build();
        Decoder::new(capstone, true)
    }

    pub fn riscv() -> Result<Decoder> {
        let builder = Capstone::new().riscv().mode(riscv::ArchMode::RiscV32);
        let capstone = builder
            .extra_mode([riscv::ArchExtraMode::RiscVC].into_iter())
            .build();
        Decoder::new(capstone, false)
    }

    fn new(capstone: capstone::CsResult<Capstone>, is_arm: bool) -> Result<Decoder> {
        let mut capstone = capstone.map_err(|error| anyhow!("capstone: {error}"))?;
        // Padding between functions is no code.
        capstone
            .set_skipdata(true)
            .map_err(|error| anyhow!("capstone: {error}"))?;
        Ok(Decoder { capstone, is_arm })
    }

    /// What the code at `address` does, in its order.
    pub fn steps(&self, code: &[u8], address: u64) -> Result<Vec<Step>> {
        let all = self
            .capstone
            .disasm_all(code, address)
            .map_err(|error| anyhow!("capstone: {error}"))?;
        let mut halves = Halves::default();
        let steps = all.iter().filter_map(|instruction| {
            let name = instruction.mnemonic()?;
            let operands: Vec<_> = instruction.op_str().unwrap_or_default().split(", ").collect();
            let latest = halves.latest.clone();
            let step = if self.is_arm {
                thumb(name, &operands, &mut halves)
            } else {
                riscv(name, &operands, instruction.address(), &mut halves)
            };
            // What no instruction has set anew is no longer the latest.
            halves.latest = halves.latest.take().filter(|now| Some(now) != latest.as_ref());
            step
        });
        Ok(steps.collect())
    }
}

/// Registers that hold the first half of an address.
#[derive(Default)]
struct Halves {
    values: HashMap<String, u64>,
    /// The one that the instruction before has set: what is called through a far address.
    latest: Option<String>,
}

impl Halves {
    fn set(&mut self, register: &str, value: u64) {
        self.values.insert(register.to_owned(), value);
        self.latest = Some(register.to_owned());
    }

    /// A first half with its second.
    fn with(&self, register: &str, offset: &str) -> Option<u64> {
        let half = self.values.get(register)?;
        Some(half.wrapping_add(number(offset)?) & 0xffff_ffff)
    }

    /// The same, if the instruction before has set the first.
    fn just_with(&self, register: &str, offset: &str) -> Option<u64> {
        let is_latest = self.latest.as_deref() == Some(register);
        self.with(register, offset).filter(|_| is_latest)
    }
}

fn thumb(name: &str, operands: &[&str], halves: &mut Halves) -> Option<Step> {
    let name = name.trim_end_matches(".w");
    match (name, operands) {
        ("bl", [target]) => Some(Step::Call(number(target)?)),
        ("blx", [_]) => Some(Step::CallPointer),
        ("bx", ["lr"]) | ("ldr", ["pc", "[sp]", ..]) | ("bkpt", _) => None,
        // What is added to the place at hand comes from a table of a `match`.
        ("add", ["pc", ..]) => None,
        ("bx", [_]) | ("mov" | "ldr", ["pc", ..]) => Some(Step::JumpPointer),
        ("push" | "vpush", [..]) | ("stmdb", ["sp!", ..]) => {
            let registers = operands.iter().filter(|operand| **operand != "sp!").count() as u64;
            Some(Step::Grow(if name == "vpush" { 8 } else { 4 } * registers))
        }
        ("str" | "strd", [.., "[sp", offset]) if offset.ends_with("]!") => {
            Some(Step::Grow(number(offset.trim_end_matches("]!"))?.wrapping_neg()))
        }
        ("sub" | "subw", ["sp", .., bytes]) => Some(number(bytes).map_or(Step::GrowUnknown, Step::Grow)),
        ("add" | "addw", ["sp", .., bytes]) if number(bytes).is_none() => Some(Step::GrowUnknown),
        ("movw", [register, low]) => {
            halves.set(register, number(low)?);
            None
        }
        ("movt", [register, high]) => {
            let address = halves.values.remove(*register)? | number(high)? << 16;
            Some(Step::Address(address & !1))
        }
        _ if name.starts_with('b') => Some(Step::Jump(number(operands.first()?)?)),
        _ => None,
    }
}

fn riscv(name: &str, operands: &[&str], address: u64, halves: &mut Halves) -> Option<Step> {
    let wrap = |address: u64| address & 0xffff_ffff;
    let name = name.trim_start_matches("c.");
    match (name, operands) {
        ("jal", ["zero", offset]) | ("j", [offset]) => {
            Some(Step::Jump(wrap(address.wrapping_add(number(offset)?))))
        }
        ("jal", [.., offset]) => Some(Step::Call(wrap(address.wrapping_add(number(offset)?)))),
        ("ret", _) | ("jr", ["ra"]) | ("jalr", ["zero", "ra", "0"]) => None,
        ("jr", [register]) => Some(
            halves
                .just_with(register, "0")
                .map_or(Step::JumpPointer, Step::Jump),
        ),
        ("jalr", [register]) => Some(
            halves
                .just_with(register, "0")
                .map_or(Step::CallPointer, Step::Call),
        ),
        ("jalr", ["zero", register, offset]) => Some(
            halves
                .just_with(register, offset)
                .map_or(Step::JumpPointer, Step::Jump),
        ),
        ("jalr", [_, register, offset]) => Some(
            halves
                .just_with(register, offset)
                .map_or(Step::CallPointer, Step::Call),
        ),
        ("addi", ["sp", "sp", bytes]) | ("addi" | "addi16sp", ["sp", bytes]) => {
            let bytes = number(bytes)? as i64;
            (bytes < 0).then_some(Step::Grow(bytes.unsigned_abs()))
        }
        ("add" | "sub", ["sp", ..]) => Some(Step::GrowUnknown),
        ("lui", [register, high]) => {
            halves.set(register, wrap(number(high)? << 12));
            None
        }
        ("auipc", [register, high]) => {
            halves.set(register, wrap(address.wrapping_add(number(high)? << 12)));
            None
        }
        ("addi", [.., register, offset]) => Some(Step::Address(halves.with(register, offset)?)),
        _ => None,
    }
}

/// `#0x10`, `-16`, `0x10`: negative ones in two's complement.
fn number(text: &str) -> Option<u64> {
    let text = text.trim_start_matches('#');
    let (is_negative, text) = text.strip_prefix('-').map_or((false, text), |rest| (true, rest));
    let number = match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16).ok()?,
        None => text.parse().ok()?,
    };
    Some(if is_negative {
        number.wrapping_neg()
    } else {
        number
    })
}

#[cfg(test)]
mod tests {
    use super::{Step::*, *};

    #[test]
    fn thumb_instructions() {
        let code: [u16; 17] = [
            0xb5f0, // push {r4-r7, lr}
            0xb084, // sub sp, #16
            0xf000, 0xf802, // bl 0x1010
            0x4798, // blx r3
            0x4770, // bx lr
            0x4718, // bx r3
            0x4687, // mov pc, r0
            0xd0f6, // beq 0x1000
            0xe7fe, // b 0x1012
            0xf000, 0xb800, // b.w 0x1018
            0x44a5, // add sp, r4
            0xb002, // add sp, #8
            0xbdf0, // pop {r4-r7, pc}
            0xbe00, // bkpt
            0x4388, // bics r0, r1
        ];
        let bytes: Vec<u8> = code.iter().flat_map(|half| half.to_le_bytes()).collect();
        let steps = Decoder::thumb().unwrap().steps(&bytes, 0x1000).unwrap();
        assert_eq!(
            steps,
            [
                Grow(20),
                Grow(16),
                Call(0x100c),
                CallPointer,
                JumpPointer,
                JumpPointer,
                Jump(0x1000),
                Jump(0x1012),
                Jump(0x1018),
                GrowUnknown,
            ]
        );
    }

    #[test]
    fn thumb_2_instructions() {
        let code: [u16; 12] = [
            0xe92d, 0x4ff0, // push.w {r4-r11, lr}
            0xed2d, 0x8b02, // vpush {d8}
            0xf5ad, 0x6d80, // sub.w sp, sp, #1024
            0xf84d, 0xed04, // str lr, [sp, #-4]!
            0xf241, 0x2035, // movw r0, #0x1235
            0xf2c2, 0x0000, // movt r0, #0x2000
        ];
        let bytes: Vec<u8> = code.iter().flat_map(|half| half.to_le_bytes()).collect();
        let steps = Decoder::thumb().unwrap().steps(&bytes, 0x1000).unwrap();
        assert_eq!(
            steps,
            [Grow(36), Grow(8), Grow(1024), Grow(4), Address(0x2000_1234)]
        );
    }

    #[test]
    fn riscv_instructions() {
        let code: [u32; 9] = [
            0x00c0_00ef, // jal ra, +12
            0xff5f_f06f, // j -12
            0xfe01_0113, // addi sp, sp, -32
            0x0201_0113, // addi sp, sp, 32
            0x0000_8067, // ret
            0x0005_00e7, // jalr a0
            0x0005_0067, // jr a0
            0x0000_1097, // auipc ra, 1
            0x0080_80e7, // jalr ra, 8(ra)
        ];
        let mut bytes: Vec<u8> = code.iter().flat_map(|word| word.to_le_bytes()).collect();
        // c.addi16sp sp, -64; c.jr a5; c.jalr a5
        bytes.extend(
            [0x7139u16, 0x8782, 0x9782]
                .iter()
                .flat_map(|half| half.to_le_bytes()),
        );
        let steps = Decoder::riscv().unwrap().steps(&bytes, 0x1000).unwrap();
        assert_eq!(
            steps,
            [
                Call(0x100c),
                Jump(0xff8),
                Grow(32),
                CallPointer,
                JumpPointer,
                Call(0x2024),
                Grow(64),
                JumpPointer,
                CallPointer,
            ]
        );
    }
}
