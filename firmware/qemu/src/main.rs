//! Runs every job of `firmware-common` and prints `name crc32=89abcdef` for each, on ARM also the memory that it took:
//! `memory name variables=BYTES stack=BYTES room=BYTES`. The exit code reaches the shell.

#![no_std]
#![no_main]

#[cfg(target_arch = "arm")]
mod stack;

use core::panic::PanicInfo;

#[cfg(target_arch = "arm")]
use cortex_m_rt::entry;
use firmware_common::{jobs, region};
#[cfg(target_arch = "riscv32")]
use riscv_rt::entry;
use semihosting::{eprintln, println, process};

/// The only job to run, if the build names one: for profiles.
const ONLY: &str = match option_env!("MICROLUX_ONLY") {
    Some(name) => name,
    None => "",
};

#[entry]
fn main() -> ! {
    region::count(region::EMPTY, || ());
    let wanted = |job: &jobs::Job| ONLY.is_empty() || job.name == ONLY;
    for (id, job) in (0..).zip(jobs::all()).filter(|(_, job)| wanted(job)) {
        #[cfg(target_arch = "arm")]
        stack::paint();
        let crc = region::count(id, || job.run());
        #[cfg(target_arch = "arm")]
        {
            let stack::Used {
                variables,
                stack,
                room,
            } = stack::used();
            println!(
                "memory {} variables={variables} stack={stack} room={room}",
                job.name
            );
        }
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
