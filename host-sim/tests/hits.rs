//! What the core and the f64 reference say of the same hits: place, both normals, and colour.

mod dressed;

use dressed::dressed;
use host_sim::dequantise::{self, Frame};
use host_sim::desc::{SceneDesc, TintDesc};
use host_sim::quantise::CoreScene;
use host_sim::reference::{self, Vec3};
use microlux::num::Uniform;

const SIDE: u16 = 240;

fn angle(a: Vec3, b: Vec3) -> f64 {
    (a.normalized() - b.normalized()).length()
}

/// Rays through a regular grid of places; how many met a mesh's colour.
fn compare(desc: &SceneDesc) -> usize {
    let core = CoreScene::new(desc).unwrap();
    let (lent, frame) = (core.lend(), Frame::of(&core));
    let scene = core.scene(&lent).unwrap();
    let exact = dequantise::scene(&core).unwrap();
    let film = core.camera.film(SIDE, SIDE);
    let (mut told, mut apart) = (0, 0);
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let middle = [Uniform::from_bits(1 << 31); 2];
        let ray = film.ray(x, y, middle, [Uniform::ZERO; 2]).unwrap();
        let Some(hit) = scene.closest(&ray) else { continue };
        let vertex = scene.vertex(&ray, &hit);
        let (px, py) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let true_ray = reference::primary_ray(&exact, [SIDE.into(), SIDE.into()], px, py);
        let truth = reference::closest(&exact, &true_ray).unwrap();
        let point = frame.point(vertex.surface.point);
        let met = (usize::from(hit.shape), hit.triangle);
        if met != (truth.shape, truth.triangle.unwrap_or(0)) {
            // By an edge, of two things each sees another.
            apart += 1;
            continue;
        }
        // Across the ray, which at a grazing surface is a small part of it: directions are right to 1.3e-5 rad.
        let aside = (point - truth.point).cross(true_ray.direction).length();
        assert!(aside < 3e-5 * truth.t, "{x} {y}: {point:?} {truth:?}");
        let normal = dequantise::dir(vertex.surface.normal);
        assert!(
            angle(normal, truth.normal) < 1e-3,
            "{x} {y}: {normal:?} {truth:?}"
        );
        let shading = dequantise::dir(vertex.told.shading.unwrap_or(vertex.surface.normal));
        assert!(
            angle(shading, truth.shading) < 5e-3,
            "{x} {y}: {shading:?} {truth:?}"
        );
        let tint = vertex.told.tint.map_or([1.0; 3], dequantise::albedo);
        let true_tint: [f64; 3] = truth.tint.into();
        for (found, wanted) in tint.into_iter().zip(true_tint) {
            assert!((found - wanted).abs() < 0.012, "{x} {y}: {tint:?} {true_tint:?}");
        }
        told += usize::from(vertex.told.tint.is_some());
    }
    assert!(apart < 100, "{apart}");
    told
}

#[test]
fn instances_textures_colours_and_smooth_normals() {
    let desc = dressed();
    let told = compare(&desc);
    assert!(told > 250, "{told}");
    // The same without filtering, where a wrong place would be another colour.
    let mut sharp = desc;
    for material in &mut sharp.materials {
        if let Some(TintDesc::Texture { texture, .. }) = &mut material.tint {
            let mut nearest = (**texture).clone();
            nearest.nearest = true;
            *texture = nearest.into();
        }
    }
    assert_eq!(compare(&sharp), told);
}
