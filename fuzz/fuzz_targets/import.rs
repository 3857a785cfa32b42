//! Scene files from anywhere: one error, or a scene that the core takes or refuses by name.

#![no_main]

use std::fs;

use host_sim::import::{Options, load};
use host_sim::quantise::CoreScene;
use libfuzzer_sys::fuzz_target;

/// The first byte picks one.
const KINDS: [&str; 6] = ["xml", "obj", "ply", "gltf", "glb", "mlx"];

fuzz_target!(|data: &[u8]| {
    let Some((&kind, bytes)) = data.split_first() else {
        return;
    };
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir());
    let folder = folder.expect("a folder of our own");
    let path = folder
        .path()
        .join(format!("scene.{}", KINDS[usize::from(kind) % KINDS.len()]));
    fs::write(&path, bytes).expect("the file is ours");
    let options = Options {
        lenient: kind & 0x80 != 0,
        ..Options::default()
    };
    match load(&path, &options) {
        Ok(loaded) => {
            let _ = CoreScene::new(&loaded.scene).map(|core| core.scene(&core.lend()).is_ok());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
