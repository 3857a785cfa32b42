//! From a place in the picture to a ray.

use super::scene::{Camera, Ray, Scene};
use super::vec::Vec3;
use super::warp;

/// The ray through the centre of the lens; pixel (x, y) covers [x, x+1)×[y, y+1), y down, of `size` = [width, height].
pub fn primary_ray(scene: &Scene, size: [u32; 2], px: f64, py: f64) -> Ray {
    let camera = &scene.camera;
    Ray {
        origin: camera.origin,
        direction: toward(camera, size, px, py).normalized(),
    }
}

/// The ray through the point of the lens that `u` chooses; without a lens, `primary_ray`.
pub(super) fn lens_ray(camera: &Camera, size: [u32; 2], [px, py]: [f64; 2], u: [f64; 2]) -> Ray {
    let toward = toward(camera, size, px, py);
    let Some(lens) = camera.lens else {
        return Ray {
            origin: camera.origin,
            direction: toward.normalized(),
        };
    };
    let [x, y] = warp::disk(u).map(|c| c * lens.aperture_radius);
    let origin = camera.origin + camera.right * x + camera.up * y;
    // `toward` reaches depth 1 along `forward`, so the plane in focus lies at `focus_distance` times it.
    let focus = camera.origin + toward * lens.focus_distance;
    Ray {
        origin,
        direction: (focus - origin).normalized(),
    }
}

fn toward(camera: &Camera, [width, height]: [u32; 2], px: f64, py: f64) -> Vec3 {
    let half_width = (camera.fov_x.to_radians() / 2.0).tan();
    let (width, height) = (f64::from(width), f64::from(height));
    let right = (2.0 * px / width - 1.0) * half_width;
    let up = (height - 2.0 * py) / width * half_width;
    camera.forward + camera.right * right + camera.up * up
}
