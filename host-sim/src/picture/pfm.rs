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

/// What `encode` writes, and others that say as much in three lines.
pub fn decode(bytes: &[u8]) -> Result<Picture, String> {
    let mut parts = bytes.splitn(4, |&byte| byte == b'\n');
    let mut line = || parts.next().and_then(|line| std::str::from_utf8(line).ok());
    let (kind, size, scale) = (line(), line(), line());
    let sides: Vec<usize> = size.map_or(Vec::new(), |size| {
        size.split_whitespace().filter_map(|n| n.parse().ok()).collect()
    });
    let is_little = scale
        .and_then(|s| s.trim().parse::<f32>().ok())
        .is_some_and(|s| s < 0.0);
    let (Some("PF"), [width, height], true) = (kind.map(str::trim), &sides[..], is_little) else {
        return Err("is no little-endian colour PFM".to_string());
    };
    let (width, height) = (*width, *height);
    let body = parts.next().unwrap_or(&[]);
    if width == 0 || body.len() != 12 * width * height {
        return Err(format!("has not the bytes of {width} x {height} pixels"));
    }
    let pixel = |b: &[u8]| [0, 4, 8].map(|i| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]));
    let rows = body.chunks_exact(12 * width).rev();
    Ok(Picture {
        width,
        height,
        rgb: rows.flat_map(|row| row.chunks_exact(12).map(pixel)).collect(),
        ..Picture::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let picture = Picture {
            width: 3,
            height: 2,
            rgb: (0..6).map(|i| [i as f32, -0.25, 1e20]).collect(),
            ..Picture::default()
        };
        let bytes = encode(&picture);
        assert_eq!(decode(&bytes).unwrap().rgb, picture.rgb);
        assert!(decode(&bytes[..bytes.len() - 1]).unwrap_err().contains("3 x 2"));
        assert!(
            decode(b"PF\n1 1\n1.0\n123456789012").is_err(),
            "the other end first"
        );
    }

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
