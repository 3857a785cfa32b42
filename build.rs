//! Says which multiplier the target has: `narrow_mul` where 32×32→64 is not an instruction (Armv6-M, Armv8-M base); and
//! `assembly` where these, and RV32IM, take the routines of the crate `microlux-asm`.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(narrow_mul, counted_zeros, assembly)");
    println!("cargo::rerun-if-changed=build.rs");
    let target = std::env::var("TARGET").unwrap_or_default();
    let is_narrow = target.starts_with("thumbv6m") || target.starts_with("thumbv8m.base");
    if is_narrow {
        println!("cargo::rustc-cfg=narrow_mul");
    }
    let features = std::env::var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    if !is_narrow && (!target.starts_with("riscv") || features.split(',').any(|feature| feature == "zbb")) {
        println!("cargo::rustc-cfg=counted_zeros");
    }
    if (is_narrow || target.starts_with("riscv32im")) && std::env::var_os("CARGO_FEATURE_ASM").is_some() {
        println!("cargo::rustc-cfg=assembly");
    }
}
