//! Portable float map, as Paul Debevec's HDRShop wrote it: three lines of text, then rows from the bottom.

use super::Picture;

/// Little-endian, which the negative scale says.
pub fn encode(picture: &Picture) -> Vec<u8> {
    let mut bytes = format!("PF\n{} {}\n-1.0\n", picture.width, picture.height).into_bytes();
    for row in picture.rgb.chunks(picture.width.max(1)).rev() {
        bytes.extend(row.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_go_from_the_bottom() {
        let rgb = vec![[1.0, 2.0, 3.0], [-0.5, 0.0, f32::MAX]];
        let bytes = encode(&Picture {
            width: 1,
            height: 2,
            rgb,
            ..Picture::default()
        });
        let mut expected = b"PF\n1 2\n-1.0\n".to_vec();
        for x in [-0.5f32, 0.0, f32::MAX, 1.0, 2.0, 3.0] {
            expected.extend(x.to_le_bytes());
        }
        assert_eq!(bytes, expected);
    }
}
