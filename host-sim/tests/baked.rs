//! A whole scene in one blob: it renders as the scene does that it was baked of, with the same packed meshes, and what is
//! no scene is refused.

use std::sync::atomic::AtomicBool;

use host_sim::bake::Aligned;
use host_sim::desc::{IntegratorDesc, IntegratorKind, LensDesc, SceneDesc};
use host_sim::run::{Options, describe, render_baked, render_fixed, render_reference};
use host_sim::{builtin, flash};
use microlux::integrator::Path;
use microlux::num::Crc;
use microlux::render::{Renderer, Settings};
use microlux::sampler::Stratified;
use microlux::scene::{Baked, BakedError, Room, SceneError};

mod dressed;

fn small(desc: &SceneDesc) -> Options {
    Options {
        width: 24,
        height: 18,
        spp: 2,
        aov: true,
        ..Options::for_scene(desc)
    }
}

fn baked(desc: &SceneDesc) -> SceneDesc {
    let flash = flash::bake(desc, true).unwrap();
    flash::scene(&desc.name, Aligned::new(&flash.bytes)).unwrap()
}

#[test]
fn every_scene_renders_as_before_it_was_baked() {
    let mut scenes: Vec<_> = builtin::all()
        .iter()
        .filter_map(|(name, _)| builtin::scene(name))
        .collect();
    scenes.push(dressed::dressed());
    for desc in scenes {
        let again = baked(&desc);
        let (options, stop) = (small(&desc), AtomicBool::new(false));
        assert_eq!(small(&again), options, "{}", desc.name);
        let meshes = flash::bake(&desc, false).unwrap().bytes;
        let (one, _) = render_fixed(&again, &options, &(), &stop).unwrap();
        let (other, _) = render_baked(&desc, &meshes, &options, &(), &stop).unwrap();
        assert!(one == other, "{}", desc.name);
        // The reference renders what the core's integers say, which is the same but for the order of vertices.
        let reference = |desc| render_reference(desc, &options, &(), &stop).unwrap().0.rgb;
        let mean = |picture: Vec<[f32; 3]>| picture.iter().flatten().sum::<f32>() / picture.len() as f32;
        let (one, other) = (mean(reference(&again)), mean(reference(&desc)));
        assert!((one - other).abs() < 1e-3 * other, "{}: {one} {other}", desc.name);
        let info = |desc| describe(desc, &options).unwrap();
        let (one, other) = (info(&again), info(&desc));
        assert_eq!(
            (one.shapes, one.lights, one.triangles),
            (other.shapes, other.lights, other.triangles)
        );
    }
}

#[test]
fn how_it_wants_to_be_rendered_is_kept() {
    use IntegratorKind::{Ao, Bdpt, Direct, Light, Path};
    for kind in [Ao, Direct, Path, Bdpt, Light] {
        let mut desc = builtin::scene("cornell").unwrap();
        (desc.width, desc.height, desc.spp) = (33, 21, Some(12));
        desc.integrator = IntegratorDesc {
            kind,
            max_depth: if kind == Direct { Some(2) } else { Some(7) },
            rr_depth: 3,
            hide_emitters: true,
            ao_radius: Some(0.5),
        };
        desc.camera.lens = Some(LensDesc {
            aperture_radius: 0.25,
            focus_distance: 2.0,
        });
        let again = baked(&desc);
        assert_eq!(again.integrator, desc.integrator);
        assert_eq!((again.width, again.height, again.spp), (33, 21, Some(12)));
        let lens = again.camera.lens.unwrap();
        assert_eq!((lens.aperture_radius, lens.focus_distance), (0.25, 2.0));
        desc.integrator.ao_radius = None;
        desc.integrator.max_depth = if kind == Direct { Some(2) } else { None };
        assert_eq!(baked(&desc).integrator, desc.integrator);
    }
}

/// What a board does.
fn drawn(bytes: &[u8]) -> Result<u32, BakedError> {
    let bytes = Aligned::new(bytes);
    let mut room = Room::<32, 16, 8, 16>::new();
    let whole = Baked::open(bytes.bytes())?.scene(&mut room)?;
    let (path, settings) = (
        Path::new(4),
        Settings {
            width: 8,
            height: 6,
            spp: 1,
        },
    );
    let sampler = Stratified::new(1, 1);
    let mut renderer = Renderer::new(&whole.scene, whole.shot.camera, path, sampler, settings);
    let mut strip = [microlux::color::Radiance::BLACK; 48];
    let mut crc = Crc::new();
    if let Some(area) = renderer.area(0, 48) {
        renderer.tile(area, &mut strip);
    }
    for pixel in strip {
        let (mantissa, exponent) = pixel.to_parts();
        mantissa.iter().for_each(|m| crc.bytes(&m.to_le_bytes()));
        crc.bytes(&exponent.to_le_bytes());
    }
    Ok(crc.value())
}

/// With a checksum that fits.
fn summed(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut crc = Crc::new();
    crc.bytes(&bytes[20..]);
    bytes[16..20].copy_from_slice(&crc.value().to_le_bytes());
    bytes
}

#[test]
fn a_byte_that_is_another_is_refused_or_rendered() {
    for name in ["cornell", "materials", "implicits", "sky"] {
        let flash = flash::bake(&builtin::scene(name).unwrap(), true).unwrap();
        let first = flash.bytes.len() - flash.scene.unwrap().bytes;
        drawn(&flash.bytes).unwrap();
        let mut refused = 0;
        let places = first..flash.bytes.len();
        for place in places.clone() {
            for change in [0x01, 0x80, 0xff] {
                let mut bytes = flash.bytes.clone();
                bytes[place] ^= change;
                if let Err(error) = drawn(&summed(bytes)) {
                    assert!(!error.to_string().is_empty());
                    refused += 1;
                }
            }
        }
        // A third at least are padding, kinds, counts and directions.
        assert!(
            refused > places.len(),
            "{name}: {refused} of {}",
            3 * places.len()
        );
    }
}

#[test]
fn what_is_wrong_is_named() {
    let flash = flash::bake(&builtin::scene("cornell").unwrap(), true).unwrap();
    let first = flash.bytes.len() - flash.scene.unwrap().bytes;
    let told = |place: usize, byte: u8| {
        let mut bytes = flash.bytes.clone();
        bytes[first + place] = byte;
        drawn(&summed(bytes)).unwrap_err().to_string()
    };
    assert_eq!(told(0, 127), "the scene: its unit makes no sense");
    assert_eq!(told(1, 9), "the scene: its grid makes no sense");
    assert_eq!(told(2, 3), "the scene: its background makes no sense");
    assert_eq!(told(40, 5), "the scene: its technique makes no sense");
    assert_eq!(
        told(66, 77),
        "the scene: its directions of the camera makes no sense"
    );
    let cut = drawn(&summed({
        let mut bytes = flash.bytes.clone();
        bytes.truncate(bytes.len() - 4);
        let length = bytes.len() as u32;
        bytes[12..16].copy_from_slice(&length.to_le_bytes());
        bytes
    }));
    assert!(matches!(cut, Err(BakedError::Cut { .. })), "{cut:?}");
    let more = drawn(&summed({
        let mut bytes = [&flash.bytes[..], &[0; 4]].concat();
        let length = bytes.len() as u32;
        bytes[12..16].copy_from_slice(&length.to_le_bytes());
        bytes
    }));
    assert_eq!(more, Err(BakedError::Cut { left: 4 }));
    let bytes = Aligned::new(&flash.bytes);
    let full = Baked::open(bytes.bytes())
        .unwrap()
        .scene(&mut Room::<2, 16, 8, 0>::new())
        .map(|_| ());
    assert!(
        matches!(
            full,
            Err(BakedError::Scene(SceneError::Full { what: "shapes", .. }))
        ),
        "{full:?}"
    );
    let meshes = flash::bake(&builtin::scene("torus-knot").unwrap(), false).unwrap();
    assert_eq!(drawn(&meshes.bytes), Err(BakedError::NoScene));
}
