//! What each stage of the denoiser takes, on a frame as large as a Pico's: a [`region`] each.

use microlux::{
    color::{Radiance, Rgb9e5},
    film::Feature,
    film::denoise::network::{HEAD, Needs, Network, Neural, Scratch, TRAINED},
    film::denoise::{self, Alone, Atrous, Band, Clean, Filter, Past, Seen, Shown, Size, accumulate},
    integrator::Path,
    num::Crc,
    render::{Motion, Renderer, Settings},
    sampler::Sobol,
    scene::builtin::Builtin,
};

use crate::{denoise::moved, fingerprint, region};

/// Of the frame that is rendered.
pub const SIZE: Size = Size {
    width: 80,
    height: 60,
};
const PIXELS: usize = SIZE.pixels();
const NEEDS: Needs = Needs::of(SIZE.width as usize, SIZE.height as usize);

/// Stages by the number of their region, but for [`FILTER`].
pub const STAGES: [&str; 11] = [
    "firefly clamp, history",
    "à-trous, for 1 sample",
    "à-trous, for 4 samples",
    "network, extraction",
    "network, filter",
    "twice the size, outlines",
    "first hits for that",
    "rendering, 1 sample",
    "its own size, outlines",
    "its own size, outlines and TAA",
    "three times the size, outlines",
];

/// Of [`STAGES`], what the whole network's region has beside the extraction's, which is the other number.
pub const FILTER: (u32, u32) = (4, 3);

/// Memory for the second of two frames, and for what becomes of it.
struct Room {
    frames: [[Feature; PIXELS]; 2],
    lengths: [[u8; PIXELS]; 2],
    above: [Rgb9e5; SIZE.width as usize],
    fine: [[u8; HEAD]; NEEDS.fine],
    near: [u32; NEEDS.near],
    far: [u32; NEEDS.far],
    neural: [u32; Neural::needs(SIZE)],
    guides: [Feature; 4 * PIXELS],
    guides_3x: [Feature; 9 * PIXELS],
    shown: [Radiance; 9 * PIXELS],
    pictures: [[Rgb9e5; PIXELS]; 2],
    ring: [Seen; 3 * 3 * SIZE.width as usize],
}

/// Renders two frames of a scene between which the camera moves, one sample a pixel, and does with the second what there is
/// to do; answers with a CRC-32 of all that comes of it.
#[inline(never)]
pub fn run(scene: Builtin) -> u32 {
    let mut room = Room {
        frames: [[Feature::default(); PIXELS]; 2],
        lengths: [[0; PIXELS]; 2],
        above: [Rgb9e5::BLACK; SIZE.width as usize],
        fine: [[0; HEAD]; NEEDS.fine],
        near: [0; NEEDS.near],
        far: [0; NEEDS.far],
        neural: [0; Neural::needs(SIZE)],
        guides: [Feature::default(); 4 * PIXELS],
        guides_3x: [Feature::default(); 9 * PIXELS],
        shown: [Radiance::BLACK; 9 * PIXELS],
        pictures: [[Rgb9e5::BLACK; PIXELS]; 2],
        ring: [Seen::NOTHING; 3 * 3 * SIZE.width as usize],
    };
    fill(scene, &mut room).unwrap_or(0)
}

#[inline(never)]
fn fill(scene: Builtin, room: &mut Room) -> Option<u32> {
    let Room {
        frames: [before, now],
        lengths: [lengths_before, lengths],
        above,
        guides,
        guides_3x,
        ..
    } = room;
    let motion = scene
        .with(|scene, camera| {
            let cameras = [camera, moved(camera, 1)];
            let settings = Settings {
                width: SIZE.width,
                height: SIZE.height,
                spp: 1,
            };
            let render = |frame: &mut [Feature], number: usize| {
                let sampler = Sobol::new(number as u32 + 1);
                let mut renderer = Renderer::new(scene, cameras[number], Path::direct(), sampler, settings);
                if let Some(area) = renderer.area(0, PIXELS as u32) {
                    renderer.feature_tile(area, frame);
                }
            };
            render(before, 0);
            region::count(7, || render(now, 1));
            let guided = |scale: u16, guides: &mut [Feature]| {
                let Size { width, height } = SIZE.times(scale);
                let fine = Settings {
                    width,
                    height,
                    ..settings
                };
                let mut renderer = Renderer::new(scene, cameras[1], Path::direct(), Sobol::new(1), fine);
                for (i, guide) in guides.iter_mut().enumerate() {
                    let (x, y) = place(i, width);
                    *guide = renderer.guide(x, y);
                }
            };
            region::count(6, || guided(2, guides));
            guided(3, guides_3x);
            let motion = Motion::between(cameras[0], cameras[1], SIZE.width, SIZE.height);
            accumulate::<Motion>(band(before, lengths_before, above), None, 0);
            let past = Past {
                frame: &before[..],
                lengths: &lengths_before[..],
                motion: &motion,
            };
            region::count(0, || accumulate(band(now, lengths, above), Some(&past), 1));
            motion
        })
        .ok()?;
    Some(clean(room, &motion))
}

/// All of a frame.
fn band<'a>(rows: &'a mut [Feature], lengths: &'a mut [u8], above: &'a mut [Rgb9e5]) -> Band<'a> {
    Band {
        size: SIZE,
        first: 0,
        rows,
        lengths,
        above,
        below: &[],
    }
}

/// From the frame with its history on.
fn clean(room: &mut Room, motion: &Motion) -> u32 {
    let Room {
        frames: [before, now],
        lengths: [_, lengths],
        fine,
        near,
        far,
        neural,
        guides,
        guides_3x,
        shown,
        pictures: [last, picture],
        ring,
        ..
    } = room;
    let mut crc = Crc::new();
    for (number, spp) in [(2, 4), (1, 1)] {
        let mut atrous = Atrous::for_spp(spp);
        region::count(number, || {
            atrous.filter(&Alone, SIZE, now, lengths, denoise::Scratch::over(before))
        });
        for light in denoise::Scratch::over(before).light.iter() {
            crc.word(light.0);
        }
    }
    let light = denoise::Scratch::over(before).light;
    let clean = Clean {
        size: SIZE,
        frame: now,
        light,
        lengths,
        spp: 1,
        whole: 1,
    };
    region::count(8, || {
        let mut rest = last.iter_mut();
        clean.rows(0..SIZE.height, ring, |_, row| {
            for (shown, light) in rest.by_ref().zip(row.lights()) {
                *shown = Rgb9e5::encode(light);
            }
        });
    });
    // As if it had been what was shown before: the camera moved all the same.
    let shown_before = Shown {
        size: SIZE,
        lights: &last[..],
        motion,
    };
    region::count(9, || {
        let mut rest = picture.iter_mut();
        clean.rows(0..SIZE.height, ring, |y, row| {
            for (shown, light) in rest.by_ref().zip(row.steadied(y, &shown_before)) {
                *shown = light;
            }
        });
    });
    for light in picture {
        crc.word(light.0);
    }
    region::count(5, || {
        let width = 2 * SIZE.width;
        let guide = |x: u16, y: u16| guides[y as usize * width as usize + x as usize];
        let mut rest = shown.iter_mut();
        clean.rows_2x(0..2 * SIZE.height, ring, guide, |_, row| {
            for (shown, light) in rest.by_ref().zip(row.lights()) {
                *shown = light;
            }
        });
    });
    for light in &shown[..4 * PIXELS] {
        fingerprint::pixel(&mut crc, *light);
    }
    region::count(10, || {
        let width = 3 * SIZE.width;
        let guide = |x: u16, y: u16| guides_3x[y as usize * width as usize + x as usize];
        let mut rest = shown.iter_mut();
        clean.rows_3x(0..3 * SIZE.height, ring, guide, |_, row| {
            for (shown, light) in rest.by_ref().zip(row.lights()) {
                *shown = light;
            }
        });
    });
    for light in shown {
        fingerprint::pixel(&mut crc, *light);
    }
    let scratch = Scratch { fine, near, far };
    let (width, height) = (SIZE.width.into(), SIZE.height.into());
    let Ok(mut network) = Network::new(TRAINED, width, height, scratch) else {
        return 0;
    };
    region::count(FILTER.1, || {
        network.extract_frame(&Alone, now, |at| lengths[at].into());
    });
    let Ok(mut neural) = Neural::new(TRAINED, SIZE, 1, neural) else {
        return 0;
    };
    region::count(FILTER.0, || {
        neural.filter(&Alone, SIZE, now, lengths, denoise::Scratch::over(before));
    });
    for light in denoise::Scratch::over(before).light.iter() {
        crc.word(light.0);
    }
    crc.value()
}

fn place(number: usize, width: u16) -> (u16, u16) {
    ((number % width as usize) as u16, (number / width as usize) as u16)
}
