//! How deep a job's stack gets: the free part of it is painted before, and what is left of the paint is measured after.

use core::{arch::asm, ptr};

unsafe extern "C" {
    /// Top of the stack, from the start-up's linker script, and first address behind the variables, down to which it may
    /// grow.
    static _stack_start: u32;
    static __sdata: u32;
    static __ebss: u32;
}

const PAINT: u32 = 0x5aa5_c33c;
/// Bytes under the caller that are left alone: what this module needs itself.
const OWN: usize = 256;

/// Bytes of the stack that are painted and looked at: all that a micro:bit has, and more than any job takes elsewhere.
const DEPTH: usize = 64 * 1024;

/// Bytes of the RAM that a program takes.
pub struct Used {
    pub variables: usize,
    pub stack: usize,
    /// All that there is for both.
    pub room: usize,
}

/// Fills what is not in use of the stack.
#[inline(never)]
pub fn paint() {
    let here = stack_pointer() - OWN;
    let mut word = lowest().cast_mut();
    while (word as usize) < here {
        // SAFETY: the word lies in the stack, below all that is in use of it.
        unsafe { ptr::write_volatile(word, PAINT) };
        word = word.wrapping_add(1);
    }
}

fn stack_pointer() -> usize {
    let address;
    // SAFETY: a register is read.
    unsafe {
        #[cfg(target_arch = "arm")]
        asm!("mov {}, sp", out(reg) address, options(nomem, nostack, preserves_flags));
        #[cfg(target_arch = "riscv32")]
        asm!("mv {}, sp", out(reg) address, options(nomem, nostack, preserves_flags));
    }
    address
}

/// The lowest word that is painted.
fn lowest() -> *const u32 {
    let (top, end) = (&raw const _stack_start, &raw const __ebss);
    end.max(top.wrapping_byte_sub(DEPTH))
}

/// What the program has used since it was painted, the stack as deep as it ever was.
pub fn used() -> Used {
    let top = &raw const _stack_start as usize;
    let mut word = lowest();
    // SAFETY: the word lies in the stack, which may be read.
    while (word as usize) < top && unsafe { ptr::read_volatile(word) } == PAINT {
        word = word.wrapping_add(1);
    }
    Used {
        variables: &raw const __ebss as usize - &raw const __sdata as usize,
        stack: top - word as usize,
        room: top - &raw const __sdata as usize,
    }
}
