//! The picture of the example `raystones`, as every core draws it.

#[path = "../examples/raystones/trace/mod.rs"]
mod trace;

use trace::scene::{HEIGHT, WIDTH};

/// CRC-32 of three bytes a pixel, row by row. Overflow is an error in the test profile, and the picture
/// has no input: what does not overflow here does nowhere.
#[test]
fn the_picture_is_the_record() {
    let at = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    let picture: Vec<[u8; 3]> = at.map(|(x, y)| trace::pixel(x, y)).collect();
    assert_eq!(
        format!("{:08x}", crc32fast::hash(picture.as_flattened())),
        "3210bf9a"
    );
}
