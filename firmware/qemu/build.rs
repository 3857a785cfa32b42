//! Lays the program out for the machine that `MACHINE` names; `MICROLUX_ROOM` names the file that `rays` looks at.

use std::{env, fs, path::PathBuf};

fn main() {
    let machine = env::var("MACHINE").expect("MACHINE names a file of memory/, as in MACHINE=microbit");
    let layout = format!("memory/{machine}.x");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(&layout, out.join("memory.x")).unwrap_or_else(|e| panic!("{layout}: {e}"));

    println!("cargo:rerun-if-env-changed=MICROLUX_ROOM");
    let room = env::var("MICROLUX_ROOM").unwrap_or_default();
    let bytes = if room.is_empty() {
        Vec::new()
    } else {
        println!("cargo:rerun-if-changed={room}");
        fs::read(&room).unwrap_or_else(|e| panic!("{room}: {e}"))
    };
    fs::write(out.join("room.bin"), bytes).unwrap_or_else(|e| panic!("room.bin: {e}"));

    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-env=MACHINE={machine}");
    println!("cargo:rerun-if-env-changed=MACHINE");
    println!("cargo:rerun-if-env-changed=MICROLUX_ONLY");
    println!("cargo:rerun-if-changed={layout}");

    // The Cortex-M start-up's script includes memory.x, the RISC-V one wants it first.
    let target = env::var("CARGO_CFG_TARGET_ARCH").expect("cargo sets the target");
    let arguments: &[_] = if target == "riscv32" {
        &["-Tmemory.x", "-Tlink.x"]
    } else {
        &["--nmagic", "-Tlink.x"]
    };
    for argument in arguments {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}
