//! Says whose assembly the target takes: `armv6m` (and Armv8-M base) or `armv7m` (and Armv8-M main), and `armv7em` besides.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(armv6m, armv7m, armv7em)");
    println!("cargo::rerun-if-changed=build.rs");
    let target = std::env::var("TARGET").unwrap_or_default();
    let is = |names: &[&str]| names.iter().any(|name| target.starts_with(name));
    if is(&["thumbv6m", "thumbv8m.base"]) {
        println!("cargo::rustc-cfg=armv6m");
    } else if is(&["thumbv7m", "thumbv7em", "thumbv8m.main"]) {
        println!("cargo::rustc-cfg=armv7m");
    }
    if is(&["thumbv7em"]) {
        println!("cargo::rustc-cfg=armv7em");
    }
}
