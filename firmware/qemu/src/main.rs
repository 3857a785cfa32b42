//! Runs every job of `firmware-common` and prints `name crc32=xxxxxxxx` for each; the exit code reaches the shell.

#![no_std]
#![no_main]

use core::panic::PanicInfo;

#[cfg(target_arch = "arm")]
use cortex_m_rt::entry;
use firmware_common::{jobs, region};
#[cfg(target_arch = "riscv32")]
use riscv_rt::entry;
use semihosting::{eprintln, println, process};

#[entry]
fn main() -> ! {
    region::count(region::EMPTY, || ());
    for (id, job) in (0..).zip(jobs::all()) {
        let crc = region::count(id, job.run);
        println!("{} crc32={crc:08x}", job.name);
    }
    process::exit(0)
}

/// On an emulator a panic says where, and the run fails.
#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    eprintln!("{}: {info}", env!("MACHINE"));
    process::exit(1)
}

/// So does a fault, as a stack overflow ends in on the smaller machines.
#[cfg(target_arch = "arm")]
#[cortex_m_rt::exception]
unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
    eprintln!("{}: fault at {:#010x}", env!("MACHINE"), frame.pc());
    process::exit(2)
}
