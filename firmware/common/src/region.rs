//! Brackets around a piece of work, seen by the counting emulator.
//!
//! [`begin`] and [`end`] store to the byte of [`MICROLUX_REGIONS`] that belongs to the region. On a chip that costs a
//! call and a store; in the emulator the counting plugin watches those two functions and books the instructions in
//! between under the number that the stored address tells.

use core::sync::atomic::{AtomicU8, Ordering::Relaxed};

/// Regions are numbered from 0 to `COUNT - 1`; a higher number wraps around.
pub const COUNT: usize = 256;

/// The region that brackets nothing: what the brackets themselves cost.
pub const EMPTY: u32 = COUNT as u32 - 1;

/// 1 while a region is open; its place tells its number.
#[unsafe(no_mangle)]
pub static MICROLUX_REGIONS: [AtomicU8; COUNT] = [const { AtomicU8::new(0) }; COUNT];

/// Runs `work` as region `id`.
pub fn count<R>(id: u32, work: impl FnOnce() -> R) -> R {
    begin(id);
    let result = work();
    end(id);
    result
}

/// Opens a region. Regions nest; the same one does not.
#[inline(never)]
#[unsafe(export_name = "microlux_region_begin")]
pub extern "C" fn begin(id: u32) {
    MICROLUX_REGIONS[id as usize % COUNT].store(1, Relaxed);
}

/// Closes the region.
#[inline(never)]
#[unsafe(export_name = "microlux_region_end")]
pub extern "C" fn end(id: u32) {
    MICROLUX_REGIONS[id as usize % COUNT].store(0, Relaxed);
}
