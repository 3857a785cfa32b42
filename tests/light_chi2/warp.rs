use crate::chi2::{Patch, Random, SAMPLES, assert_chi2, wide};
use microlux::geom::Dir;
use microlux::num::{ONE_Q16, Wide};
use microlux::sampler::warp::{
    Cone, pdf_cosine_hemisphere, sample_cosine_hemisphere, sample_disk, sample_linear, sample_triangle,
};

#[test]
fn cosine_hemisphere() {
    Patch::new([0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2).assert(
        "cosine hemisphere",
        0.0,
        |u| {
            let dir = sample_cosine_hemisphere(u);
            Some((dir, pdf_cosine_hemisphere(dir.0[2])))
        },
        |dir| pdf_cosine_hemisphere(dir.0[2]),
    );
}

#[test]
fn cones() {
    for degrees in [0.02, 0.26, 5.0, 22.4, 22.6, 57.0, 89.9] {
        let cone = Cone::new((degrees / 360.0 * 2f64.powi(32)) as u32);
        let exact = 1.0 - f64::to_radians(degrees).cos();
        let error = wide(cone.versine()) / exact - 1.0;
        println!("{degrees}: 1 - cos to {error:+.1e}");
        assert!(error.abs() < 2e-4, "{degrees}: {error}");
        let pdf = |dir: Dir| {
            if cone.holds(Dir::Z, dir) {
                cone.pdf()
            } else {
                Wide::ZERO
            }
        };
        // Steps of 2^-16 are as coarse as the narrowest cone.
        if degrees > 0.2 {
            Patch::new([0.0, 0.0, 1.0], f64::to_radians(1.2 * degrees)).assert(
                &format!("cone of {degrees} degrees"),
                0.01,
                |u| Some((cone.sample(u), cone.pdf())),
                pdf,
            );
        }
    }
}

#[test]
fn linear() {
    let mut random = Random(3);
    for [a, b] in [
        [1.0, 1.0],
        [0.0, 1.0],
        [1.0, 0.0],
        [0.2, 3.0],
        [7.0, 6.5],
        [1e-4, 1.0],
    ] {
        let [wide_a, wide_b] = [a, b].map(|x: f64| Wide::new((x * 65536.0).round() as u32, -16));
        let mut found = vec![0.0; 64];
        for _ in 0..SAMPLES {
            let t = sample_linear(random.point()[0], wide_a, wide_b);
            assert!((0..=ONE_Q16).contains(&t));
            found[(t as usize * 64 / 65536).min(63)] += 1.0;
        }
        let share = |i: f64| a * i / 64.0 + (b - a) * (i / 64.0).powi(2) / 2.0;
        let expected: Vec<f64> = (0..64)
            .map(|i| (share(f64::from(i) + 1.0) - share(f64::from(i))) / ((a + b) / 2.0) * SAMPLES as f64)
            .collect();
        assert_chi2(&format!("linear from {a} to {b}"), &found, &expected);
    }
}

/// In cells of equal area: rings and sectors of a disk; a triangle's strips by one weight, cut by the share of another.
#[test]
fn disk_and_triangle() {
    let mut random = Random(4);
    let mut disk = vec![0.0; 256];
    let mut triangle = vec![0.0; 256];
    let cell = |a: f64, b: f64| (a * 16.0).min(15.0) as usize * 16 + (b * 16.0).min(15.0) as usize;
    for _ in 0..SAMPLES {
        let [x, y] = sample_disk(random.point()).map(|c| f64::from(c) / 65536.0);
        let turn = y.atan2(x) / std::f64::consts::TAU;
        disk[cell(x * x + y * y, turn.rem_euclid(1.0))] += 1.0;
        let [b1, b2] = sample_triangle(random.point()).map(|c| f64::from(c) / 65536.0);
        assert!(b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0, "{b1} {b2}");
        // What is left of weight b1 is even when squared.
        triangle[cell((1.0 - b1).powi(2), b2 / (1.0 - b1).max(1e-9))] += 1.0;
    }
    let expected = vec![SAMPLES as f64 / 256.0; 256];
    assert_chi2("disk", &disk, &expected);
    assert_chi2("triangle", &triangle, &expected);
}
