//! Baked meshes and scenes from anywhere: refused by name, or meshes hit exactly as their list of triangles is, scenes
//! rendered.

#![no_main]

use libfuzzer_sys::fuzz_target;
use microlux::bvh::{check_mesh, closest, closest_linear, occluded, occluded_linear};
use microlux::color::Radiance;
use microlux::integrator::Path;
use microlux::render::{Renderer, Settings};
use microlux::sampler::{Independent, PcgRxsMXs32};
use microlux::scene::{Baked, Room, Whole};
use microlux::shape::Slopes;
use microlux_fuzz::{Aligned, Rays, summed};

/// Rays against what was accepted.
const RAYS: usize = 8;
/// And pixels.
const SIZE: (u16, u16) = (4, 3);

fuzz_target!(|data: &[u8]| {
    // The first byte says whether the checksum shall fit, which no mutation would get right.
    let Some((&choice, bytes)) = data.split_first() else {
        return;
    };
    let bytes = if choice & 7 != 0 {
        summed(bytes)
    } else {
        bytes.to_vec()
    };
    let aligned = Aligned::new(&bytes);
    let baked = match Baked::open(aligned.bytes()) {
        Ok(baked) => baked,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    for mesh in 0..baked.count() {
        let mesh = baked.mesh(mesh).expect("an entry that `open` accepted");
        if let Err(error) = check_mesh(&mesh.triangles, mesh.nodes) {
            assert!(!error.to_string().is_empty());
            continue;
        }
        for ray in Rays::new(mesh.triangles.grid(), &bytes).take(RAYS) {
            let slopes = Slopes::new(ray.dir);
            let far = i32::MAX;
            let hit = closest(&mesh.triangles, mesh.nodes, &ray, &slopes, far);
            assert_eq!(hit, closest_linear(&mesh.triangles, &ray, &slopes, far));
            if let Some(hit) = hit {
                // Past the border all that is said of a triangle is there.
                assert_eq!(
                    mesh.triangles.normals(hit.triangle).is_some(),
                    mesh.triangles.is_smooth()
                );
            }
            assert_eq!(
                occluded(&mesh.triangles, mesh.nodes, &ray, &slopes, far),
                occluded_linear(&mesh.triangles, &ray, &slopes, far)
            );
        }
    }
    let mut room = Room::<16, 8, 8, 16>::new();
    match baked.scene(&mut room) {
        Ok(Whole { scene, shot }) => {
            let (width, height) = SIZE;
            let settings = Settings {
                width,
                height,
                spp: 1,
            };
            let mut renderer = Renderer::new(
                &scene,
                shot.camera,
                Path::new(4),
                Independent::<PcgRxsMXs32>::new(1),
                settings,
            );
            while renderer.step(&mut [Radiance::BLACK; SIZE.0 as usize]).is_some() {}
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
