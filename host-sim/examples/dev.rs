use host_sim::{desc::*, import, quantise::CoreScene};
use microlux::{color::Radiance, integrator::Path, render::*, sampler::*};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let spp: u32 = a[3].parse().unwrap();
    let loaded =
        import::load(std::path::Path::new(&a[1]), &Default::default()).unwrap_or_else(|e| panic!("{e}"));
    let d = loaded.scene;
    let core = CoreScene::new(&d).unwrap_or_else(|e| panic!("{e}"));
    let meshes = core.meshes();
    let scene = core.scene(&meshes).unwrap_or_else(|e| panic!("{e}"));
    println!(
        "unit {:?} shapes {} depth {:?}",
        core.unit,
        d.shapes.len(),
        d.integrator
    );
    let path = Path {
        max_depth: d.integrator.max_depth.unwrap_or(1000) as u16,
        rr_depth: d.integrator.rr_depth as u16,
        hide_emitters: d.integrator.hide_emitters,
    };
    let s = Settings {
        width: d.width as u16,
        height: d.height as u16,
        spp,
    };
    let t = std::time::Instant::now();
    let rows: Vec<Vec<Radiance>> = {
        use rayon::prelude::*;
        (0..d.height)
            .into_par_iter()
            .map(|y| {
                let mut r = Renderer::new(&scene, core.camera, path, Stratified::new(7, spp), s);
                let mut strip = vec![Radiance::BLACK; d.width as usize];
                let area = r.area(y * d.width, d.width).unwrap();
                r.tile(area, &mut strip);
                strip
            })
            .collect()
    };
    println!("{:?}", t.elapsed());
    let px: Vec<f32> = rows
        .iter()
        .flatten()
        .flat_map(|p| {
            let (m, e) = p.to_parts();
            m.map(|m| m as f32 * 2f32.powi(e as i32 - 15))
        })
        .collect();
    exr::prelude::write_rgb_file(&a[2], d.width as usize, d.height as usize, |x, y| {
        let i = (y * d.width as usize + x) * 3;
        (px[i], px[i + 1], px[i + 2])
    })
    .unwrap();
}
