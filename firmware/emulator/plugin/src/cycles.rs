//! What an instruction costs on a Cortex-M0+ with the single-cycle multiplier and memory without wait states.
//!
//! "Cortex-M0+ Technical Reference Manual", ARM DDI 0484, table 3-1. The table leaves open whether N of `POP` with PC
//! counts PC; here it does not, and N of `PUSH` counts LR. Exceptions are not charged.

/// Cycles of `opcode`, a conditional branch as if it were not taken: one more if it is.
///
/// A 32-bit instruction has its first halfword on top.
pub const fn of(opcode: u32, bytes: u64) -> u64 {
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

/// Whether `opcode` is a 16-bit conditional branch.
pub const fn is_conditional_branch(opcode: u32, bytes: u64) -> bool {
    bytes == 2 && opcode >> 12 == 0b1101 && (opcode >> 8) & 0xf < 0xe
}

#[cfg(test)]
mod tests {
    use super::{is_conditional_branch, of};

    #[test]
    fn table() {
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
            assert_eq!(of(opcode, 2), cycles, "{text}");
        }
        assert_eq!(of(0xf000_f801, 4), 3, "bl");
        assert!(
            is_conditional_branch(0xd0fe, 2) && !is_conditional_branch(0xdfab, 2),
            "beq, svc"
        );
    }
}
