//! OpenEXR: one part, 32-bit channels, named as compositing programs expect layers (`layer.channel`).

use std::io::Cursor;
use std::path::Path;

use exr::prelude::*;

use super::file::FileError;
use super::{Aov, Layer, Picture};

/// `R`, `G`, `B`, and the layers asked for; scan lines, losslessly compressed (ZIP).
pub fn encode(picture: &Picture, layers: &[Layer]) -> std::result::Result<Vec<u8>, String> {
    let mut channels = colour("", ["R", "G", "B"], &picture.rgb);
    if let Some(aov) = &picture.aov {
        channels.extend(layers.iter().flat_map(|&layer| layer_channels(layer, aov)));
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let layer = exr::image::Layer::new(
        (picture.width, picture.height),
        LayerAttributes::default(),
        encoding,
        channels,
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}

fn layer_channels(layer: Layer, aov: &Aov) -> Vec<AnyChannel<FlatSamples>> {
    match layer {
        Layer::Albedo => colour("albedo.", ["R", "G", "B"], &aov.albedo),
        Layer::Normal => colour("normal.", ["X", "Y", "Z"], &aov.normal),
        Layer::Depth => vec![AnyChannel::new("depth.Z", FlatSamples::F32(aov.depth.clone()))],
        Layer::Id => vec![AnyChannel::new("id.I", FlatSamples::U32(aov.id.clone()))],
    }
}

fn colour(prefix: &str, names: [&str; 3], values: &[[f32; 3]]) -> Vec<AnyChannel<FlatSamples>> {
    let channel = |c: usize| {
        let name = format!("{prefix}{}", names[c]);
        AnyChannel::new(
            name.as_str(),
            FlatSamples::F32(values.iter().map(|v| v[c]).collect()),
        )
    };
    (0..3).map(channel).collect()
}

/// The channels `R`, `G`, `B` of an EXR file's first part that has them.
pub fn read(path: &Path) -> std::result::Result<Picture, FileError> {
    let bytes = std::fs::read(path).map_err(|error| FileError::io(path, &error))?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| FileError::new(path, format!("not a readable EXR file ({error}); write it anew")))?;
    let found = image.layer_data.iter().find_map(|layer| {
        let channel = |name: &str| {
            layer
                .channel_data
                .list
                .iter()
                .find(|c| c.name.eq(name))
                .map(|c| &c.sample_data)
        };
        Some((layer.size, [channel("R")?, channel("G")?, channel("B")?]))
    });
    let (size, channels) =
        found.ok_or_else(|| FileError::new(path, "has no channels R, G, B; export it as an RGB picture"))?;
    let [r, g, b] = channels.map(|samples| samples.values_as_f32().collect::<Vec<f32>>());
    if [&r, &g, &b].iter().any(|channel| channel.len() != size.area()) {
        return Err(FileError::new(
            path,
            "has subsampled channels; export it with R, G, B of full size",
        ));
    }
    let rgb = (0..size.area()).map(|i| [r[i], g[i], b[i]]).collect();
    Ok(Picture {
        width: size.width(),
        height: size.height(),
        rgb,
        ..Picture::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Picture {
        let rgb: Vec<[f32; 3]> = (0..35).map(|i| [i as f32 / 7.0, -1.5, 1e9 * i as f32]).collect();
        let aov = Aov {
            albedo: rgb.iter().map(|v| [v[0], 0.5, 0.25]).collect(),
            normal: vec![[0.0, 0.6, -0.8]; 35],
            depth: (0..35).map(|i| i as f32).collect(),
            id: (0..35).collect(),
        };
        Picture {
            width: 7,
            height: 5,
            rgb,
            aov: Some(aov),
            display: None,
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let file = tempfile::NamedTempFile::with_suffix(".exr").unwrap();
        std::fs::write(file.path(), encode(&picture(), &[]).unwrap()).unwrap();
        let back = read(file.path()).unwrap();
        assert_eq!((back.width, back.height, back.rgb), (7, 5, picture().rgb));
    }

    #[test]
    fn layers_have_their_names() {
        let bytes = encode(
            &picture(),
            &[Layer::Albedo, Layer::Normal, Layer::Depth, Layer::Id],
        )
        .unwrap();
        let meta = MetaData::read_from_buffered(Cursor::new(bytes.as_slice()), true).unwrap();
        let names: Vec<String> = meta.headers[0]
            .channels
            .list
            .iter()
            .map(|c| c.name.to_string())
            .collect();
        let expected = "B G R albedo.B albedo.G albedo.R depth.Z id.I normal.X normal.Y normal.Z";
        assert_eq!(names.join(" "), expected);
    }

    #[test]
    fn what_is_no_picture_is_one_line() {
        let file = tempfile::NamedTempFile::with_suffix(".exr").unwrap();
        for bytes in [
            b"no exr at all".as_slice(),
            &encode(&picture(), &[]).unwrap()[..300],
        ] {
            std::fs::write(file.path(), bytes).unwrap();
            let error = read(file.path()).unwrap_err().to_string();
            assert!(
                error.contains("not a readable EXR file") && !error.contains('\n'),
                "{error}"
            );
        }
        assert!(
            read(Path::new("missing.exr"))
                .unwrap_err()
                .to_string()
                .starts_with("missing.exr: no such file")
        );
    }
}
