//! Renders the picture of the example `raystones` as region 0 and prints `raystones pixels=N crc32=89abcdef`.

#![no_std]
#![no_main]

#[path = "../console.rs"]
mod console;

use core::panic::PanicInfo;

#[cfg(target_arch = "arm")]
use cortex_m_rt::entry;
use firmware_common::{raystones, region};
#[cfg(target_arch = "riscv32")]
use riscv_rt::entry;
use semihosting::process;

#[entry]
fn main() -> ! {
    region::count(region::EMPTY, || ());
    let crc = region::count(0, raystones::run);
    console::print(&["raystones pixels="]);
    console::decimal(raystones::PIXELS);
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
