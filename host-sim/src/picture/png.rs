use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

/// 8-bit RGB.
pub fn encode(width: usize, height: usize, pixels: &[[u8; 3]]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(
            pixels.as_flattened(),
            width as u32,
            height as u32,
            ExtendedColorType::Rgb8,
        )
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// 8-bit RGB, picture after picture, again and again.
pub fn animated<'a>(
    [width, height]: [usize; 2],
    frames: impl ExactSizeIterator<Item = &'a [[u8; 3]]>,
    fps: u16,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_animated(frames.len() as u32, 0)?;
    encoder.set_frame_delay(1, fps)?;
    let mut writer = encoder.write_header()?;
    for frame in frames {
        writer.write_image_data(frame.as_flattened())?;
    }
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_is_written_is_read() {
        let pixels: Vec<[u8; 3]> = (0..12).map(|i| [i * 20, 255 - i, i]).collect();
        let bytes = super::encode(4, 3, &pixels).unwrap();
        let read = image::load_from_memory(&bytes).unwrap().into_rgb8();
        assert_eq!(read.dimensions(), (4, 3));
        assert_eq!(read.as_raw().as_slice(), pixels.as_flattened());
    }
    #[test]
    fn frames_follow_each_other_as_fast_as_asked() {
        let frames: Vec<Vec<[u8; 3]>> = (0..3).map(|i| vec![[80 * i; 3]; 6]).collect();
        let bytes = super::animated([3, 2], frames.iter().map(Vec::as_slice), 25).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        for frame in &frames {
            let mut pixels = vec![0; frame.as_flattened().len()];
            reader.next_frame(&mut pixels).unwrap();
            assert_eq!(pixels, frame.as_flattened());
            let control = reader.info().frame_control.unwrap();
            assert_eq!((control.delay_num, control.delay_den), (1, 25));
        }
        let animation = reader.info().animation_control.unwrap();
        // Again and again: as many times as 0 stands for.
        assert_eq!((animation.num_frames, animation.num_plays), (3, 0));
    }
}
