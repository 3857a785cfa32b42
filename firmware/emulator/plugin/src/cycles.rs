//! What an instruction costs on a core whose memory has no wait states.
//!
//! - Cortex-M0+ with the single-cycle multiplier: "Cortex-M0+ Technical Reference Manual", ARM DDI 0484, table 3-1. The
//!   table leaves open whether N of `POP` with PC counts PC; here it does not, and N of `PUSH` counts LR.
//! - Cortex-M4: "Cortex-M4 Technical Reference Manual", ARM DDI 0439, table 3-1: a load 2, a store 1 (it is buffered), a
//!   branch 2 more where it is taken, a division 7 of its 2 to 12.
//! - Hazard3: its documentation, "Instruction cycle counts": a load 1 more where the next instruction needs it, a branch 1
//!   more where it is taken, a jump 2, a division 18.
//!
//! Exceptions are not charged.

/// A core with a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Core {
    M0Plus,
    M4,
    Hazard3,
}

impl Core {
    pub fn named(name: &str) -> Option<Core> {
        Some(match name {
            "m0plus" => Core::M0Plus,
            "m4" => Core::M4,
            "hazard3" => Core::Hazard3,
            _ => return None,
        })
    }

    /// Cycles of `opcode`, a conditional branch as if it were not taken.
    ///
    /// A 32-bit instruction has its first halfword on top.
    pub const fn cycles(self, opcode: u32, bytes: u64) -> u64 {
        match self {
            Core::M0Plus => m0plus(opcode, bytes),
            Core::M4 => m4(opcode, bytes),
            Core::Hazard3 => hazard3(opcode, bytes),
        }
    }

    /// Cycles more of a conditional branch that is taken.
    pub const fn taken(self) -> u64 {
        match self {
            Core::M4 => 2,
            Core::M0Plus | Core::Hazard3 => 1,
        }
    }

    /// Whether `opcode` is a conditional branch.
    pub const fn is_conditional_branch(self, opcode: u32, bytes: u64) -> bool {
        match (self, bytes) {
            (Core::Hazard3, 4) => opcode >> 16 & 0x7f == 0x63,
            (Core::Hazard3, _) => opcode & 0xc003 == 0xc001,
            (Core::M0Plus, 4) => false,
            (Core::M4, 4) => {
                opcode >> 27 == 0b11110 && opcode & 0xd000 == 0x8000 && opcode >> 22 & 0xe != 0xe
            }
            (_, _) => {
                (opcode >> 12 == 0b1101 && (opcode >> 8) & 0xf < 0xe)
                    || (matches!(self, Core::M4) && opcode & 0xf500 == 0xb100) // CBZ, CBNZ
            }
        }
    }

    /// Cycles that `opcode` waits for the register that the one before it loads.
    pub const fn waits(self, before: (u32, u64), opcode: u32, bytes: u64) -> u64 {
        match self {
            Core::Hazard3 => (loaded(before.0, before.1) & read(opcode, bytes) & !1 != 0) as u64,
            Core::M0Plus | Core::M4 => 0,
        }
    }
}

const fn m0plus(opcode: u32, bytes: u64) -> u64 {
    if bytes == 4 {
        return 3; // BL, MRS, MSR and the barriers: ARMv6-M has no other
    }
    let cycles = match opcode >> 12 {
        0b0100 if opcode >> 11 == 0b01001 => 2,    // LDR from the literal pool
        0b0100 if opcode >> 8 == 0b0100_0111 => 2, // BX, BLX
        0b0100 if matches!(opcode & 0xff87, 0x4487 | 0x4687) => 2, // ADD, MOV to PC
        0b0101..=0b1001 => 2,                      // loads and stores of one register
        0b1011 if opcode >> 9 == 0b101_1010 => 1 + (opcode & 0x1ff).count_ones(), // PUSH
        0b1011 if opcode >> 8 == 0b1011_1100 => 1 + (opcode & 0xff).count_ones(), // POP
        0b1011 if opcode >> 8 == 0b1011_1101 => 3 + (opcode & 0xff).count_ones(), // POP with PC
        0b1011 if matches!(opcode, 0xbf20 | 0xbf30) => 2, // WFE, WFI
        0b1100 => 1 + (opcode & 0xff).count_ones(), // LDM, STM
        0b1110 => 2,                               // B
        _ => 1,
    };
    cycles as u64
}

const fn m4(opcode: u32, bytes: u64) -> u64 {
    if bytes == 4 {
        let (first, last) = (opcode >> 16, opcode & 0xffff);
        return match first >> 9 {
            0b111_0100 if first & 0xfff0 == 0xe8d0 && last & 0xffe0 == 0xf000 => 4, // TBB, TBH
            0b111_0100 if first & 0x40 != 0 => 3,                                   // LDRD, STRD
            0b111_0100 => several(last, first >> 4 & last >> 15 & 1),               // LDM, STM
            0b111_1100 => 1 + (first >> 4 & 1) as u64,                              // LDR, STR and their kind
            0b111_1101 if matches!(first & 0xfff0, 0xfb90 | 0xfbb0) => 7,           // SDIV, UDIV
            0b111_1000..=0b111_1011 if last & 0x9000 == 0x9000 => 3,                // BL, B
            _ => 1,
        };
    }
    match opcode >> 12 {
        0b0100 if opcode >> 11 == 0b01001 => 2,    // LDR from the literal pool
        0b0100 if opcode >> 8 == 0b0100_0111 => 3, // BX, BLX
        0b0100 if matches!(opcode & 0xff87, 0x4487 | 0x4687) => 3, // ADD, MOV to PC
        0b0101 => 1 + (opcode >> 9 & 7 >= 3) as u64, // by register: STR, STRH, STRB, then the loads
        0b0110..=0b1001 => 1 + (opcode >> 11 & 1) as u64,
        0b1011 if opcode >> 9 == 0b101_1010 => several(opcode & 0x1ff, 0), // PUSH
        0b1011 if opcode >> 9 == 0b101_1110 => several(opcode & 0x1ff, opcode >> 8 & 1), // POP
        0b1100 => several(opcode & 0xff, 0),                               // LDM, STM
        0b1110 => 3,                                                       // B
        _ => 1,
    }
}

/// Registers from or to memory, and whether PC is among them.
const fn several(list: u32, jumps: u32) -> u64 {
    (1 + list.count_ones() + 3 * jumps) as u64
}

const fn hazard3(opcode: u32, bytes: u64) -> u64 {
    let word = opcode.rotate_left(16);
    match bytes {
        4 if matches!(word & 0x7f, 0x6f | 0x67) => 2, // JAL, JALR
        4 if word & 0xfe00_007f == 0x0200_0033 && word >> 14 & 1 != 0 => 18, // DIV and its kind
        2 if matches!(opcode & 0xe003, 0xa001 | 0x2001) => 2, // C.J, C.JAL
        2 if opcode & 0xe07f == 0x8002 => 2,          // C.JR, C.JALR
        _ => 1,
    }
}

/// The register that a RISC-V instruction loads, as a bit; 1 for none.
const fn loaded(opcode: u32, bytes: u64) -> u32 {
    let word = opcode.rotate_left(16);
    match bytes {
        4 if word & 0x7f == 0x03 => 1 << (word >> 7 & 31),
        2 if opcode & 0xe003 == 0x4000 => 1 << (8 + (opcode >> 2 & 7)), // C.LW
        2 if opcode & 0xe003 == 0x4002 => 1 << (opcode >> 7 & 31),      // C.LWSP
        _ => 1,
    }
}

/// The registers that a RISC-V instruction reads, as bits.
const fn read(opcode: u32, bytes: u64) -> u32 {
    if bytes == 4 {
        let word = opcode.rotate_left(16);
        let (first, second) = (1 << (word >> 15 & 31), 1 << (word >> 20 & 31));
        return match word & 0x7f {
            0x37 | 0x17 | 0x6f => 0, // LUI, AUIPC, JAL
            0x33 | 0x23 | 0x63 => first | second,
            _ => first,
        };
    }
    let (full, low) = (1 << (opcode >> 7 & 31), 1 << (opcode >> 2 & 31));
    let (high_short, low_short) = (1 << (8 + (opcode >> 7 & 7)), 1 << (8 + (opcode >> 2 & 7)));
    let stack = 1 << 2;
    match (opcode & 3, opcode >> 13) {
        (0, 0) => stack,                                           // C.ADDI4SPN
        (0, 6) => high_short | low_short,                          // C.SW
        (0, _) => high_short,                                      // C.LW
        (1, 0) => full,                                            // C.ADDI
        (1, 4) if opcode >> 10 & 3 == 3 => high_short | low_short, // C.SUB and its kind
        (1, 4 | 6 | 7) => high_short,                              // C.SRLI and its kind, C.BEQZ, C.BNEZ
        (1, 3) if opcode >> 7 & 31 == 2 => stack,                  // C.ADDI16SP
        (2, 0) => full,                                            // C.SLLI
        (2, 2) => stack,                                           // C.LWSP
        (2, 4) if opcode >> 12 & 1 != 0 || low == 1 => full | low, // C.ADD, C.JR, C.JALR
        (2, 4) => low,                                             // C.MV
        (2, 6) => low | stack,                                     // C.SWSP
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::Core;

    #[test]
    fn of_an_m0_plus() {
        let costs = [
            (0x4348, 1, "muls r0, r1, r0"),
            (0x4801, 2, "ldr r0, [pc, #4]"),
            (0x4770, 2, "bx lr"),
            (0x4788, 2, "blx r1"),
            (0x468f, 2, "mov pc, r1"),
            (0x4608, 1, "mov r0, r1"),
            (0x4487, 2, "add pc, r0"),
            (0x5c40, 2, "ldrb r0, [r0, r1]"),
            (0x9001, 2, "str r0, [sp, #4]"),
            (0xb5f0, 6, "push {r4-r7, lr}"),
            (0xbdf0, 7, "pop {r4-r7, pc}"),
            (0xbcf0, 5, "pop {r4-r7}"),
            (0xb084, 1, "sub sp, #16"),
            (0xc90e, 4, "ldm r1!, {r1-r3}"),
            (0xd0fe, 1, "beq"),
            (0xe7fe, 2, "b"),
        ];
        for (opcode, cycles, text) in costs {
            assert_eq!(Core::M0Plus.cycles(opcode, 2), cycles, "{text}");
        }
        assert_eq!(Core::M0Plus.cycles(0xf000_f801, 4), 3, "bl");
        assert!(
            Core::M0Plus.is_conditional_branch(0xd0fe, 2) && !Core::M0Plus.is_conditional_branch(0xdfab, 2),
            "beq, svc"
        );
    }

    #[test]
    fn of_an_m4() {
        let costs = [
            (0x6808, 2, 2, "ldr r0, [r1]"),
            (0x6008, 2, 1, "str r0, [r1]"),
            (0x5088, 2, 1, "str r0, [r1, r2]"),
            (0x5c88, 2, 2, "ldrb r0, [r1, r2]"),
            (0x5688, 2, 2, "ldrsb r0, [r1, r2]"),
            (0xbdf0, 2, 9, "pop {r4-r7, pc}"),
            (0xb5f0, 2, 6, "push {r4-r7, lr}"),
            (0xe7fe, 2, 3, "b"),
            (0xe92d_4ff0, 4, 10, "push.w {r4-r11, lr}"),
            (0xe8bd_8ff0, 4, 13, "pop.w {r4-r11, pc}"),
            (0xe9d0_1200, 4, 3, "ldrd r1, r2, [r0]"),
            (0xe8df_f001, 4, 4, "tbb [pc, r1]"),
            (0xf8d0_1000, 4, 2, "ldr.w r1, [r0]"),
            (0xf8c0_1000, 4, 1, "str.w r1, [r0]"),
            (0xfbb0_f0f1, 4, 7, "udiv r0, r0, r1"),
            (0xfb80_0101, 4, 1, "smull r0, r1, r0, r1"),
            (0xf000_f801, 4, 3, "bl"),
            (0xf000_b801, 4, 3, "b.w"),
            (0xf000_8001, 4, 1, "beq.w"),
            (0xeb01_0002, 4, 1, "add.w r0, r1, r2"),
        ];
        for (opcode, bytes, cycles, text) in costs {
            assert_eq!(Core::M4.cycles(opcode, bytes), cycles, "{text}");
        }
        for (opcode, bytes, is_one, text) in [
            (0xf000_8001, 4, true, "beq.w"),
            (0xf000_b801, 4, false, "b.w"),
            (0xf3bf_8f5f, 4, false, "dmb"),
            (0xb108, 2, true, "cbz r0"),
            (0xb148, 2, true, "cbz r0"),
            (0xb508, 2, false, "push {r3, lr}"),
        ] {
            assert_eq!(Core::M4.is_conditional_branch(opcode, bytes), is_one, "{text}");
        }
    }

    #[test]
    fn of_a_hazard3() {
        // The first halfword on top.
        let costs = [
            (0x00ef_0040, 4, 2, "jal ra"),
            (0x8533_02c5, 4, 1, "mul a0, a1, a2"),
            (0xd533_02c5, 4, 18, "divu a0, a1, a2"),
            (0x8082, 2, 2, "ret"),
            (0xa001, 2, 2, "c.j"),
            (0x4188, 2, 1, "c.lw a0, 0(a1)"),
        ];
        for (opcode, bytes, cycles, text) in costs {
            assert_eq!(Core::Hazard3.cycles(opcode, bytes), cycles, "{text}");
        }
        let load = (0x4188, 2);
        for (opcode, bytes, cycles, text) in [
            (0x95aa, 2, 1, "c.add a1, a0"),
            (0x85aa, 2, 1, "c.mv a1, a0"),
            (0x8533_02c5, 4, 0, "mul a0, a1, a2"),
            (0x0593_0015, 4, 1, "addi a1, a0, 1"),
            (0xc188, 2, 1, "c.sw a0, 0(a1)"),
            (0x4601, 2, 0, "c.li a2, 0"),
        ] {
            assert_eq!(Core::Hazard3.waits(load, opcode, bytes), cycles, "{text}");
        }
        assert_eq!(Core::Hazard3.waits((0x85aa, 2), 0x95aa, 2), 0, "no load");
        assert!(Core::Hazard3.is_conditional_branch(0xc111, 2), "c.beqz");
        assert!(Core::Hazard3.is_conditional_branch(0x0063_00a5, 4), "beq");
    }
}
