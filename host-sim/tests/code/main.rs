//! Scenes as Rust source: what is written, compiled, is the scene that it was written from, bit for bit.
//!
//! The sources beside this file are what `host-sim` writes; `MICROLUX_BLESS=1` writes them anew.

#[rustfmt::skip]
mod cornell;
#[rustfmt::skip]
mod dressed;
#[rustfmt::skip]
mod implicits;
#[rustfmt::skip]
mod materials;
#[rustfmt::skip]
mod sky;

#[path = "../dressed/mod.rs"]
mod dressing;

use std::path::Path as File;

use dressing::dressed;
use host_sim::desc::SceneDesc;
use host_sim::quantise::CoreScene;
use host_sim::{builtin, code};
use microlux::bvh::{Node, max_nodes};
use microlux::camera::Camera;
use microlux::integrator::Path;
use microlux::sampler::{Independent, PcgRxsMXs32, Sampler};
use microlux::scene::Scene;

/// The scene's file, as it should be.
fn source(name: &str, desc: &SceneDesc, core: &CoreScene) {
    let written = code::rust(desc, core).unwrap();
    let path = File::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/code/{name}.rs"));
    if std::env::var_os("MICROLUX_BLESS").is_some() {
        std::fs::write(&path, &written).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    assert!(
        kept == written,
        "{name}.rs is not what is written now: MICROLUX_BLESS=1 to write it anew"
    );
}

/// Paths through pixels here and there.
fn looks(scene: &Scene, camera: &Camera) -> Vec<([u16; 3], i16)> {
    let film = camera.film(40, 30);
    let mut sampler = Independent::<PcgRxsMXs32>::new(5);
    let mut seen = Vec::new();
    for i in 0..400u16 {
        let (x, y) = (i % 40, i * 7 % 30);
        sampler.start(x, y, u32::from(i));
        let (place, lens) = (sampler.next_2d(), sampler.next_2d());
        let ray = film.ray(x, y, place, lens).unwrap();
        seen.push(Path::new(6).radiance(scene, ray, &mut sampler, &mut 0).to_parts());
    }
    seen
}

macro_rules! check {
    ($name:ident, $desc:expr, $($sky:ident)?) => {{
        let desc = $desc;
        let core = CoreScene::new(&desc).unwrap();
        source(stringify!($name), &desc, &core);
        let lent = core.lend();
        let before = looks(&core.scene(&lent).unwrap(), &core.camera);
        let (mut builder, camera) = $name::scene().unwrap();
        let mut nodes = vec![Node::EMPTY; max_nodes(64)];
        $(let $sky = $name::$sky();)?
        let borrowed = $name::borrowed(&lent.meshes $(, &$sky)?);
        let after = looks(&builder.build_from(borrowed, &mut nodes).unwrap(), &camera);
        assert!(before.iter().any(|(mantissa, _)| *mantissa != [0; 3]));
        assert!(before == after, "{}", stringify!($name));
    }};
}

#[test]
fn sources_are_their_scenes() {
    check!(cornell, builtin::scene("cornell").unwrap(),);
    check!(materials, builtin::scene("materials").unwrap(),);
    check!(implicits, builtin::scene("implicits").unwrap(),);
    check!(sky, builtin::scene("sky").unwrap(), sky);
    check!(dressed, dressed(),);
}

#[test]
fn maps_are_refused_by_name() {
    let desc = builtin::scene("map").unwrap();
    let core = CoreScene::new(&desc).unwrap();
    let error = code::rust(&desc, &core).unwrap_err().to_string();
    assert!(error.contains("environment map"), "{error}");
}
