//! Faults on purpose: `MICROLUX_PROVOKE` at build time names one, and the emulator's `faults` command checks what shows.
//!
//! Without it nothing of this is in the program.

use core::hint::black_box;

const WANTED: &str = match option_env!("MICROLUX_PROVOKE") {
    Some(fault) => fault,
    None => "",
};

/// Called by each core after a tile.
pub fn on_core(core: u32) {
    match (WANTED.as_bytes(), core) {
        (b"panic", 0) | (b"panic-1", 1) => panic!(),
        (b"stack", 0) | (b"stack-1", 1) => {
            deeper(black_box(1));
        }
        (b"address", 0) | (b"address-1", 1) => wild_read(),
        (b"hang", 0) => loop {
            cortex_m::asm::wfe();
        },
        _ => {}
    }
}

/// Needs 64 bytes of stack for each of its calls, of which there is no end.
fn deeper(depth: u32) -> u32 {
    let kept = black_box([depth; 16]);
    if depth == 0 {
        0
    } else {
        deeper(kept[(depth % 16) as usize] + 1) ^ kept[0]
    }
}

fn wild_read() {
    /// Nothing is there in an RP2040.
    const NOWHERE: *const u32 = 0x6000_0000 as *const u32;
    // SAFETY: there is none: the fault is what is asked for.
    black_box(unsafe { NOWHERE.read_volatile() });
}
