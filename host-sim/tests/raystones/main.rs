//! The example `raystones` beside the same scene in floats.

mod peer;
#[path = "../../../examples/raystones/trace/mod.rs"]
mod trace;

use host_sim::metrics::flip_map;
use host_sim::picture::Picture;
use peer::{HEIGHT, WIDTH};

/// The 8-bit sRGB signals as the light that they mean.
fn light(bytes: &[[u8; 3]]) -> Picture {
    let linear = |byte: u8| match f32::from(byte) / 255.0 {
        signal if signal <= 0.04045 => signal / 12.92,
        signal => ((signal + 0.055) / 1.055).powf(2.4),
    };
    Picture {
        width: WIDTH,
        height: HEIGHT,
        rgb: bytes.iter().map(|pixel| pixel.map(linear)).collect(),
        aov: None,
        display: None,
    }
}

fn ours() -> Vec<[u8; 3]> {
    let at = (0..HEIGHT as i32).flat_map(|y| (0..WIDTH as i32).map(move |x| (x, y)));
    at.map(|(x, y)| trace::pixel(x, y)).collect()
}

/// FLIP and the mean of what signals differ by, in bytes.
fn difference(picture: &[[u8; 3]], reference: &[[u8; 3]]) -> (f32, f32) {
    let count = (WIDTH * HEIGHT) as f32;
    let flip = flip_map(&light(picture), &light(reference)).unwrap().sum::<f32>() / count;
    let pairs = picture.as_flattened().iter().zip(reference.as_flattened());
    let mean = pairs.map(|(&a, &b)| f32::from(a) - f32::from(b)).sum::<f32>() / (3.0 * count);
    (flip, mean)
}

/// Pixels of which a byte differs by more than 2.
fn far(picture: &[[u8; 3]], reference: &[[u8; 3]]) -> usize {
    let pairs = picture.iter().zip(reference);
    pairs
        .filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 2))
        .count()
}

/// FLIP is 0.0028, the mean 0.002 of 255, and 16 pixels are far off: edges, whose pixels fall on one side or the other.
#[test]
fn the_picture_is_that_of_floats() {
    let (picture, reference) = (ours(), peer::picture());
    let (flip, mean) = difference(&picture, &reference);
    let far = far(&picture, &reference);
    println!("FLIP {flip:.5}, mean difference {mean:.4} of 255, {far} pixels far off");
    assert!(
        flip < 0.0035 && mean.abs() < 0.02 && far <= 18,
        "{flip} {mean} {far}"
    );
}
