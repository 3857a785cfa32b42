//! Bakes the scene that the firmware carries, about a torus knot, or the OBJ file that `MICROLUX_MESH` names.

use std::{env, fs, path::PathBuf};

use firmware_bake::{knot, obj};

fn main() {
    println!("cargo:rerun-if-env-changed=MICROLUX_MESH");
    let baked = match env::var("MICROLUX_MESH") {
        Ok(file) if !file.is_empty() => {
            println!("cargo:rerun-if-changed={file}");
            let text = fs::read_to_string(&file).unwrap_or_else(|e| panic!("{file}: {e}"));
            obj(&text).unwrap_or_else(|e| panic!("{file}: {e}"))
        }
        _ => knot().unwrap_or_else(|e| panic!("torus knot: {e}")),
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR")).join("mesh.mlx");
    let blob = baked.blob().unwrap_or_else(|e| panic!("{e}"));
    fs::write(&out, blob).unwrap_or_else(|e| panic!("{}: {e}", out.display()));
}
