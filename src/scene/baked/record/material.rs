use super::canonical;
use crate::color::Albedo;
use crate::material::{
    BlinnPhong, Conductor, Dielectric, Filter, Index, Material, OrenNayar, OrenNayarModel, RoughDielectric,
};
use crate::num::{Metres, Share, Turn};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// A material, 32 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 | kind: 0 black, 1 Lambert, 2 mirror, 3 dielectric, 4 Oren–Nayar, 5 Blinn–Phong, 6 conductor, 7 rough dielectric |
/// | 1 | bits: 1 two-sided, 2 Blinn–Phong that is not normalised, 4 a conductor with refractive indices, 8 a rough one |
/// | 2, 3 | alpha in 2^-15; the model of Oren–Nayar: 0 full, 1 qualitative, 2 energy-preserving |
/// | 4 ..= 9 | reflectance in 2^-15; Blinn–Phong: diffuse |
/// | 10 ..= 15 | transmittance; Blinn–Phong: specular |
/// | 16 ..= 19 | ratio of refractive indices, or exponent, in 2^-16; sigma in 2^-17 of a turn |
/// | 20 ..= 31 | a conductor's refractive indices η, then k, by colour, in 2^-12 |
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct MaterialRecord {
    kind: u8,
    bits: u8,
    alpha: u16,
    colors: [[u16; 3]; 2],
    value: i32,
    index: [[u16; 3]; 2],
}

const TWO_SIDED: u8 = 1;
const UNNORMALIZED: u8 = 2;
const INDEX: u8 = 4;
const ROUGH: u8 = 8;

impl MaterialRecord {
    fn new(kind: u8, two_sided: bool, first: Albedo, second: Albedo) -> MaterialRecord {
        let bits = |Albedo(color): Albedo| color.map(|c| c.to_bits());
        MaterialRecord {
            kind,
            bits: if two_sided { TWO_SIDED } else { 0 },
            alpha: 0,
            colors: [bits(first), bits(second)],
            value: 0,
            index: [[0; 3]; 2],
        }
    }

    pub fn of(material: &Material) -> MaterialRecord {
        let black = Albedo::BLACK;
        match material {
            Material::Black => MaterialRecord::new(0, false, black, black),
            Material::Lambert { albedo, two_sided } => MaterialRecord::new(1, *two_sided, *albedo, black),
            Material::Mirror {
                reflectance,
                two_sided,
            } => MaterialRecord::new(2, *two_sided, *reflectance, black),
            Material::Dielectric(glass) => {
                let (reflectance, transmittance) = glass.tints();
                MaterialRecord {
                    value: glass.eta().to_bits(),
                    ..MaterialRecord::new(3, false, reflectance, transmittance)
                }
            }
            Material::OrenNayar(diffuse) => MaterialRecord {
                alpha: match diffuse.model() {
                    OrenNayarModel::Full => 0,
                    OrenNayarModel::Qualitative => 1,
                    OrenNayarModel::EnergyPreserving => 2,
                },
                value: i32::from(diffuse.sigma().to_bits()),
                ..MaterialRecord::new(4, diffuse.is_two_sided(), diffuse.reflectance(), black)
            },
            Material::BlinnPhong(phong) => {
                let record = MaterialRecord::new(5, phong.is_two_sided(), phong.diffuse(), phong.specular());
                let unnormalized = if phong.is_normalized() { 0 } else { UNNORMALIZED };
                MaterialRecord {
                    bits: record.bits | unnormalized,
                    value: phong.exponent().to_bits(),
                    ..record
                }
            }
            Material::Conductor(metal) => {
                let record = MaterialRecord::new(6, metal.is_two_sided(), metal.reflectance(), black);
                let index = metal.index();
                let rough = if metal.is_rough() { ROUGH } else { 0 };
                MaterialRecord {
                    bits: record.bits | rough | index.map_or(0, |_| INDEX),
                    alpha: metal.alpha().to_bits(),
                    index: index.map_or(record.index, |of| of.map(|of| of.map(|c| c.to_bits()))),
                    ..record
                }
            }
            Material::RoughDielectric(glass) => {
                let (reflectance, transmittance) = glass.tints();
                MaterialRecord {
                    alpha: glass.alpha().to_bits(),
                    value: glass.eta().to_bits(),
                    ..MaterialRecord::new(7, false, reflectance, transmittance)
                }
            }
        }
    }

    /// The material, or what of the record makes no sense.
    pub fn material(&self) -> Result<Material, &'static str> {
        let has = |bit| self.bits & bit != 0;
        let two_sided = has(TWO_SIDED);
        let [first, second] = self.colors.map(Albedo::from_bits);
        let alpha = Share::from_bits(self.alpha);
        let value = Metres::from_bits(self.value);
        let material = match self.kind {
            0 => Material::Black,
            1 => Material::Lambert {
                albedo: first,
                two_sided,
            },
            2 => Material::Mirror {
                reflectance: first,
                two_sided,
            },
            3 => Material::Dielectric(Dielectric::new(value).tinted(first, second)),
            4 => {
                let model = match self.alpha {
                    0 => OrenNayarModel::Full,
                    1 => OrenNayarModel::Qualitative,
                    2 => OrenNayarModel::EnergyPreserving,
                    _ => return Err("model"),
                };
                let sigma = Turn::from_bits((self.value as u32) << 15);
                let diffuse = OrenNayar::new(model, first, sigma);
                Material::OrenNayar(if two_sided { diffuse } else { diffuse.one_sided() })
            }
            5 => {
                let phong = BlinnPhong::new(first, second, value);
                let phong = if has(UNNORMALIZED) {
                    phong.unnormalized()
                } else {
                    phong
                };
                Material::BlinnPhong(if two_sided { phong } else { phong.one_sided() })
            }
            6 => {
                let [eta, k] = self.index.map(|of| of.map(Index::from_bits));
                let metal = Conductor::new(first);
                let metal = if has(INDEX) {
                    metal.with_index(eta, k)
                } else {
                    metal
                };
                let metal = if has(ROUGH) { metal.rough(alpha) } else { metal };
                Material::Conductor(if two_sided { metal } else { metal.one_sided() })
            }
            7 => {
                let smooth = Dielectric::new(value).tinted(first, second);
                Material::RoughDielectric(RoughDielectric::new(smooth, alpha))
            }
            _ => return Err("kind"),
        };
        canonical(self, &MaterialRecord::of(&material), material)
    }
}

/// A texture without palette and texels, 8 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 ..= 3 | width and height, u16 |
/// | 4, 5 | colours of its palette |
/// | 6 | texels: 0 half a byte each, 1 a byte |
/// | 7 | between texels: 0 the nearest, 1 bilinear |
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct TextureRecord {
    pub width: u16,
    pub height: u16,
    pub colors: u16,
    pub kind: u8,
    pub filter: u8,
}

impl TextureRecord {
    /// How colours between texels come about.
    pub fn filter(&self) -> Option<Filter> {
        match self.filter {
            0 => Some(Filter::Nearest),
            1 => Some(Filter::Bilinear),
            _ => None,
        }
    }

    /// Bytes of its texels, if they are of a kind there is.
    pub fn texel_bytes(&self) -> Option<usize> {
        let (width, height) = (usize::from(self.width), usize::from(self.height));
        match self.kind {
            0 => Some(width.div_ceil(2) * height),
            1 => Some(width * height),
            _ => None,
        }
    }
}

const _: () = assert!(size_of::<MaterialRecord>() == 32 && size_of::<TextureRecord>() == 8);
