//! Says which multiplier the target has: `narrow_mul` where 32×32→64 is not an instruction (Armv6-M, Armv8-M base); and
//! `assembly` where these, and RV32IM, take the routines of the crate `microlux-asm`: `columns` or `layers` where it has the
//! network's layers, `gathers` where it adds up its filter's taps, `neighbours` where it does so by rows, and by affinities that
//! two pixels share; `normalizes` where it has a vector's direction, `rectangles` where it meets those, `upsamples` where
//! it has the denoiser's pixels twice the size.

fn main() {
    println!(
        "cargo::rustc-check-cfg=cfg(narrow_mul, counted_zeros, assembly, columns, layers, gathers, neighbours, normalizes, rectangles, upsamples)"
    );
    println!("cargo::rerun-if-changed=build.rs");
    let target = std::env::var("TARGET").unwrap_or_default();
    let is = |names: &[&str]| names.iter().any(|name| target.starts_with(name));
    let is_narrow = is(&["thumbv6m", "thumbv8m.base"]);
    if is_narrow {
        println!("cargo::rustc-cfg=narrow_mul");
    }
    let features = std::env::var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    let has_zbb = features.split(',').any(|feature| feature == "zbb");
    if !is_narrow && (!is(&["riscv"]) || has_zbb) {
        println!("cargo::rustc-cfg=counted_zeros");
    }
    let has_routines = is_narrow || is(&["thumbv7m", "thumbv7em", "thumbv8m.main", "riscv32im"]);
    if has_routines && std::env::var_os("CARGO_FEATURE_ASM").is_some() {
        println!("cargo::rustc-cfg=assembly");
        if is_narrow {
            println!("cargo::rustc-cfg=columns");
            println!("cargo::rustc-cfg=normalizes");
            println!("cargo::rustc-cfg=rectangles");
            println!("cargo::rustc-cfg=neighbours");
            println!("cargo::rustc-cfg=upsamples");
        }
        if is(&["thumbv7m", "thumbv7em", "thumbv8m.main"]) {
            println!("cargo::rustc-cfg=layers");
        }
        if is(&["thumbv7em"]) {
            println!("cargo::rustc-cfg=gathers");
        }
    }
}
