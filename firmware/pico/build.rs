//! Lays the program out by the repository's `memory.x`, which is the Pico's.

use std::{env, fs, path::PathBuf};

fn main() {
    const LAYOUT: &str = "../../memory.x";
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(LAYOUT, out.join("memory.x")).unwrap_or_else(|e| panic!("{LAYOUT}: {e}"));
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed={LAYOUT}");

    for setting in ["MICROLUX_PROVOKE", "MICROLUX_FIRST"] {
        println!("cargo:rerun-if-env-changed={setting}");
    }

    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if env::var_os("CARGO_FEATURE_DEFMT").is_some() {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}
