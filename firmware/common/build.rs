//! Bakes the mesh that the firmware carries: a torus knot, or the OBJ file that `MICROLUX_MESH` names.

use std::{env, fs, path::PathBuf};

use firmware_bake::{Baked, knot, obj};

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
    write(&baked);
}

/// Little-endian bytes, and their counts as Rust.
fn write(baked: &Baked) {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let triples = |all: &[[u16; 3]]| -> Vec<u8> {
        all.as_flattened()
            .iter()
            .flat_map(|half| half.to_le_bytes())
            .collect()
    };
    let nodes = baked.nodes.iter().flat_map(|node| node.to_le_bytes()).collect();
    let counts = format!(
        "const VERTEX_COUNT: usize = {};\nconst TRIANGLE_COUNT: usize = {};\nconst NODE_COUNT: usize = {};\n",
        baked.vertices.len(),
        baked.triangles.len(),
        baked.nodes.len()
    );
    for (name, bytes) in [
        ("vertices.bin", triples(&baked.vertices)),
        ("triangles.bin", triples(&baked.triangles)),
        ("nodes.bin", nodes),
        ("counts.rs", counts.into_bytes()),
    ] {
        fs::write(out.join(name), bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}
