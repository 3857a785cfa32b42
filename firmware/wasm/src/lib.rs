//! The common jobs for wasm32, called by `run.mjs`.

#![no_std]
#![cfg(target_arch = "wasm32")]

use core::panic::PanicInfo;

use firmware_common::jobs::{self, Job};

/// A caller's wrong number traps.
fn job(index: usize) -> &'static Job {
    jobs::all().nth(index).expect("index < job_count()")
}

#[unsafe(no_mangle)]
pub extern "C" fn job_count() -> usize {
    jobs::all().count()
}

/// Address of the name's first byte.
#[unsafe(no_mangle)]
pub extern "C" fn job_name(index: usize) -> *const u8 {
    job(index).name.as_ptr()
}

/// Bytes of UTF-8 in the name.
#[unsafe(no_mangle)]
pub extern "C" fn job_name_bytes(index: usize) -> usize {
    job(index).name.len()
}

#[unsafe(no_mangle)]
pub extern "C" fn job_run(index: usize) -> u32 {
    job(index).run(index as u32)
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    core::arch::wasm32::unreachable()
}
