//! Textures as the core has them: few colours, and for each texel the number of one.

use std::collections::HashMap;
use std::sync::Arc;

use color_quant::NeuQuant;
use microlux::material::{Filter, Texels, Texture};

use super::mesh::signal;
use super::rounding::albedo;
use crate::desc::{TextureDesc, Vec3};

/// A texture by value.
#[derive(Debug)]
pub struct OwnedTexture {
    pub name: String,
    width: u16,
    height: u16,
    palette: Vec<[u16; 3]>,
    /// Half a byte each if 16 colours are enough.
    texels: Vec<u8>,
    filter: Filter,
    /// Colours of the picture, where they were more than fit a palette.
    pub colors_before: Option<usize>,
}

/// Colours that a byte can number.
const MOST: usize = 256;
/// Of NeuQuant's 1 (all pixels) to 30.
const SAMPLING: i32 = 1;

impl OwnedTexture {
    pub fn new(desc: &TextureDesc) -> OwnedTexture {
        let shares = |color: &Vec3| albedo(*color).0.map(|share| share.to_bits());
        let mut palette = Vec::new();
        let mut known = HashMap::new();
        let mut numbers: Vec<usize> = Vec::with_capacity(desc.texels.len());
        for color in desc.texels.iter().map(shares) {
            let number = known.entry(color).or_insert_with(|| {
                palette.push(color);
                palette.len() - 1
            });
            numbers.push(*number);
        }
        let mut colors_before = None;
        if palette.len() > MOST {
            colors_before = Some(palette.len());
            (palette, numbers) = reduced(&desc.texels);
        }
        let halves = palette.len() <= 16;
        let row = |row: &[usize]| -> Vec<u8> {
            if halves {
                row.chunks(2)
                    .map(|two| (two[0] | two.get(1).map_or(0, |high| high << 4)) as u8)
                    .collect()
            } else {
                row.iter().map(|&number| number as u8).collect()
            }
        };
        OwnedTexture {
            name: desc.name.clone(),
            width: desc.width as u16,
            height: desc.height as u16,
            texels: numbers.chunks(desc.width.max(1) as usize).flat_map(row).collect(),
            palette,
            filter: if desc.nearest {
                Filter::Nearest
            } else {
                Filter::Bilinear
            },
            colors_before,
        }
    }

    /// The same texels, whatever their names.
    fn is(&self, other: &OwnedTexture) -> bool {
        self.borrow() == other.borrow()
    }

    pub fn borrow(&self) -> Texture<'_> {
        Texture {
            width: self.width,
            height: self.height,
            palette: &self.palette,
            texels: if self.palette.len() <= 16 {
                Texels::Half(&self.texels)
            } else {
                Texels::Byte(&self.texels)
            },
            filter: self.filter,
        }
    }
}

/// 256 colours for all, and each texel's: NeuQuant (Dekker, "Kohonen Neural Networks for Optimal Colour Quantization",
/// Network 5(3), 1994) on sRGB signals, by what the eye sees; each palette entry is then the mean light of its texels, so
/// that the picture's is kept.
fn reduced(texels: &[Vec3]) -> (Vec<[u16; 3]>, Vec<usize>) {
    let bytes: Vec<u8> = texels
        .iter()
        .flat_map(|&[r, g, b]| [signal(r), signal(g), signal(b), 255])
        .collect();
    let network = NeuQuant::new(SAMPLING, MOST, &bytes);
    let numbers: Vec<usize> = bytes.chunks(4).map(|pixel| network.index_of(pixel)).collect();
    let mut sums = vec![([0.0; 3], 0.0); MOST];
    for (&number, texel) in numbers.iter().zip(texels) {
        let (sum, count) = &mut sums[number];
        (0..3).for_each(|i| sum[i] += texel[i].clamp(0.0, 1.0));
        *count += 1.0;
    }
    let palette = sums
        .into_iter()
        .map(|(sum, count): (Vec3, f64)| sum.map(|c| (c / count.max(1.0) * 32768.0).round() as u16));
    (palette.collect(), numbers)
}

/// The textures of a scene, each once, however often its file decodes it.
#[derive(Default)]
pub(super) struct Textures {
    pub list: Vec<OwnedTexture>,
    known: HashMap<*const TextureDesc, u16>,
}

impl Textures {
    pub fn of(&mut self, texture: &Arc<TextureDesc>) -> u16 {
        *self.known.entry(Arc::as_ptr(texture)).or_insert_with(|| {
            let made = OwnedTexture::new(texture);
            let same = self.list.iter().position(|other| other.is(&made));
            let number = same.unwrap_or_else(|| {
                self.list.push(made);
                self.list.len() - 1
            });
            number as u16
        })
    }
}
