//! The same bits everywhere, of denoised pictures: `tests/golden_denoise.txt` is the record.

use crate::with_denoiser;
use microlux::camera::Camera;
use microlux::color::{Radiance, Rgb9e5};
use microlux::film::denoise::network::{Neural, TRAINED};
use microlux::film::denoise::{Atrous, Filter, Row, Seen, Shown, Size};
use microlux::geom::{Dir, Point};
use microlux::integrator::Path;
use microlux::render::{Motion, Renderer, Settings};
use microlux::sampler::Sobol;
use microlux::scene::Scene;
use microlux::scene::builtin::Builtin;

const SIZE: Size = Size {
    width: 24,
    height: 20,
};
const FRAMES: u32 = 4;

const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden_denoise.txt");
const HEADER: &str = "\
# Golden denoised pictures: 24 x 20 pixels of at most 8 segments, sobol with seeds 1, 2, 3, 4, the camera going a 64th of
# its height to the right each frame. A row: scene, filter, samples a pixel, CRC-32 (IEEE) of all frames' pixels after the
# filter (8 bytes each, as in golden.txt), and of the last frame's at twice the size. taa is the filter atrous, each picture
# half of the one before.
#     MICROLUX_BLESS=1 cargo test --test denoise
";

/// A frame's camera: to the right by so many 64ths of its height above the floor, looking the same way.
fn moved(camera: Camera, frame: u32) -> Camera {
    let Point([x, y, z]) = camera.origin();
    let aside = (y.abs() / 64).saturating_mul(frame as i32);
    let [Dir(right), ..] = camera.frame();
    let by = right.map(|c| ((i64::from(c) * i64::from(aside)) >> 16) as i32);
    Camera::from_frame(
        Point([x + by[0], y + by[1], z + by[2]]),
        camera.frame(),
        camera.half_width(),
    )
}

/// The filters by name, and samples a pixel, so that each has rows of its own; `taa` is à-trous with what was shown before.
const WAYS: [(&str, u32); 5] = [
    ("atrous", 1),
    ("atrous", 4),
    ("neural", 1),
    ("neural", 4),
    ("taa", 1),
];

fn crc(scene: &Scene, camera: Camera, filter: &str, spp: u32) -> u32 {
    if filter != "neural" {
        return crc_of(scene, camera, &mut Atrous::for_spp(spp), filter == "taa", spp);
    }
    let mut memory = vec![0; Neural::needs(SIZE)];
    let mut neural = Neural::new(TRAINED, SIZE, spp, &mut memory).unwrap();
    crc_of(scene, camera, &mut neural, false, spp)
}

fn crc_of(scene: &Scene, camera: Camera, filter: &mut impl Filter, is_steadied: bool, spp: u32) -> u32 {
    let settings = Settings {
        width: SIZE.width,
        height: SIZE.height,
        spp,
    };
    let mut bytes = Vec::new();
    let (mut lights, mut next) = (Vec::new(), Vec::new());
    with_denoiser(SIZE, spp, |denoiser| {
        for frame in 0..FRAMES {
            let now = moved(camera, frame);
            let before = moved(camera, frame.saturating_sub(1));
            let motion = Motion::between(before, now, SIZE.width, SIZE.height);
            let mut renderer = Renderer::new(scene, now, Path::new(8), Sobol::new(frame + 1), settings);
            let area = renderer.area(0, SIZE.pixels() as u32).unwrap();
            assert_eq!(renderer.feature_tile(area, denoiser.frame()), SIZE.pixels());
            let clean = denoiser.denoise(Some(&motion), filter);
            let mut ring = [Seen::default(); 3 * 2 * SIZE.width as usize];
            let shown = Shown {
                size: SIZE,
                lights: &lights,
                motion: &motion,
            };
            clean.rows(
                0..SIZE.height,
                &mut ring[..3 * usize::from(SIZE.width)],
                |y, row| {
                    if is_steadied {
                        next.extend(row.steadied(y, &shown));
                    } else {
                        bytes.extend(row.lights().flat_map(eight));
                    }
                },
            );
            bytes.extend(next.iter().map(|light: &Rgb9e5| light.decode()).flat_map(eight));
            lights = std::mem::take(&mut next);
            let keep = |_, row: Row| bytes.extend(row.lights().flat_map(eight));
            if frame + 1 == FRAMES {
                let (width, height) = (2 * SIZE.width, 2 * SIZE.height);
                let fine = Settings {
                    width,
                    height,
                    spp: 1,
                };
                let mut guides = Renderer::new(scene, now, Path::new(1), Sobol::new(0), fine);
                clean.rows_2x(0..height, &mut ring, |x, y| guides.guide(x, y), keep);
            }
        }
    });
    crc32fast::hash(&bytes)
}

fn eight(light: Radiance) -> [u8; 8] {
    let ([r, g, b], exponent) = light.to_parts();
    let halves = [r, g, b, exponent as u16].map(u16::to_le_bytes);
    std::array::from_fn(|i| halves[i / 2][i % 2])
}

#[test]
fn denoised_pictures_are_the_record() {
    let mut table = HEADER.to_string();
    for scene in [
        Builtin::Cornell,
        Builtin::Spheres,
        Builtin::Torus,
        Builtin::Materials,
        Builtin::Sky,
    ] {
        for (filter, spp) in WAYS {
            let crc = scene.with(|scene, camera| crc(scene, camera, filter, spp));
            table += &format!("{:<9} {filter:<6} {spp} {:08x}\n", scene.name(), crc.unwrap());
        }
    }
    if std::env::var_os("MICROLUX_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(RECORD, &table).unwrap();
    }
    let record = std::fs::read_to_string(RECORD).unwrap_or_default();
    assert!(table == record, "{table}\n{record}");
}

/// One of one sample of the Cornell box, the network's, three times the size: the record has twice the size alone.
#[test]
fn three_times_the_size_has_the_bits_it_had() {
    let bits = Builtin::Cornell.with(|scene, camera| {
        let settings = |size: Size, spp| Settings {
            width: size.width,
            height: size.height,
            spp,
        };
        let mut memory = vec![0; Neural::needs(SIZE)];
        let mut neural = Neural::new(TRAINED, SIZE, 1, &mut memory).unwrap();
        let mut bytes = Vec::new();
        with_denoiser(SIZE, 1, |denoiser| {
            let mut renderer = Renderer::new(scene, camera, Path::new(8), Sobol::new(1), settings(SIZE, 1));
            let area = renderer.area(0, SIZE.pixels() as u32).unwrap();
            renderer.feature_tile(area, denoiser.frame());
            let clean = denoiser.denoise(None::<&Motion>, &mut neural);
            let fine = SIZE.times(3);
            let mut guides = Renderer::new(scene, camera, Path::new(1), Sobol::new(0), settings(fine, 1));
            let mut ring = vec![Seen::default(); 3 * usize::from(fine.width)];
            let guide = |x, y| guides.guide(x, y);
            clean.rows_3x(0..fine.height, &mut ring, guide, |_, row| {
                bytes.extend(row.lights().flat_map(eight));
            });
        });
        assert_eq!(bytes.len(), 8 * 9 * SIZE.pixels());
        crc32fast::hash(&bytes)
    });
    assert_eq!(bits.unwrap(), 0x342b_734a);
}
