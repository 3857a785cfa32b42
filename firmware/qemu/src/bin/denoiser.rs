//! The denoiser's stages as regions, on the Cornell box: prints `denoiser pixels=N crc32=89abcdef`.

#![no_std]
#![no_main]

#[path = "../console.rs"]
mod console;

use core::panic::PanicInfo;

#[cfg(target_arch = "arm")]
use cortex_m_rt::entry;
use firmware_common::{cost, region};
use microlux::scene::builtin::Builtin;
#[cfg(target_arch = "riscv32")]
use riscv_rt::entry;
use semihosting::process;

#[entry]
fn main() -> ! {
    region::count(region::EMPTY, || ());
    let crc = cost::run(Builtin::Cornell);
    console::print(&["denoiser pixels="]);
    console::decimal(cost::SIZE.pixels() as u32);
    console::print(&[" crc32="]);
    console::hexadecimal(crc);
    console::print(&["\n"]);
    process::exit(0)
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    console::print(&[env!("MACHINE"), ": panic\n"]);
    process::exit(1)
}
