//! Links by `esp-hal`'s layout: program and constants in flash through the cache, the rest in RAM.

fn main() {
    println!("cargo:rustc-link-arg-bins=-Tlinkall.x");
}
