//! Runs every job of `firmware-common` and prints `name crc32=89abcdef` for each, and the memory that it took:
//! `memory name variables=BYTES stack=BYTES room=BYTES`. The exit code reaches the shell.
//!
//! It prints without `core`'s formatting, so that it is as small as a board's own program.

#![no_std]
#![no_main]

mod console;
mod stack;

use core::panic::PanicInfo;

#[cfg(target_arch = "arm")]
use cortex_m_rt::entry;
use firmware_common::{jobs, region};
#[cfg(target_arch = "riscv32")]
use riscv_rt::entry;
use semihosting::process;

/// The only job to run, if the build names one: for profiles.
const ONLY: &str = match option_env!("MICROLUX_ONLY") {
    Some(name) => name,
    None => "",
};

#[entry]
fn main() -> ! {
    region::count(region::EMPTY, || ());
    let wanted = |job: &jobs::Job| ONLY.is_empty() || job.name == ONLY;
    for (id, job) in jobs::of(env!("MACHINE")).filter(|(_, job)| wanted(job)) {
        stack::paint();
        let crc = job.run(id);
        let used = stack::used();
        console::print(&["memory ", job.name]);
        for (name, bytes) in [
            (" variables=", used.variables),
            (" stack=", used.stack),
            (" room=", used.room),
        ] {
            console::print(&[name]);
            console::decimal(bytes as u32);
        }
        console::print(&["\n", job.name, " crc32="]);
        console::hexadecimal(crc);
        console::print(&["\n"]);
    }
    process::exit(0)
}

/// A panic ends the run. With the feature `place` it says where, which takes formatting code along.
#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    console::print(&[env!("MACHINE"), ": panic"]);
    #[cfg(feature = "place")]
    if let Some(place) = info.location() {
        console::print(&[" at ", place.file(), ":"]);
        console::decimal(place.line());
    }
    let _ = info;
    console::print(&["\n"]);
    process::exit(1)
}

/// So does a fault, as a stack overflow ends in on the smaller machines.
#[cfg(target_arch = "arm")]
#[cortex_m_rt::exception]
unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
    console::print(&[env!("MACHINE"), ": fault at "]);
    console::hexadecimal(frame.pc());
    console::print(&["\n"]);
    process::exit(2)
}
