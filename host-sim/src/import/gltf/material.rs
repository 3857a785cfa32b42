//! Materials of glTF, each mapped once.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use gltf::image::Source;
use gltf::material::AlphaMode;
use gltf::texture::MagFilter;
use gltf::{Material, Texture};

use super::super::error::ImportError;
use super::super::pbr::Pbr;
use super::super::texture::{self, Mean};
use super::buffer::Buffers;
use super::named;
use crate::desc::{NamedMaterial, TextureDesc, TintDesc, Vec3};

/// What a mesh's vertices have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Has {
    pub colors: bool,
    /// Of the set that its material's base colour texture names.
    pub uvs: bool,
}

pub(super) struct Materials<'a> {
    path: &'a Path,
    buffers: &'a Buffers,
    pub list: Vec<NamedMaterial>,
    pub notes: Vec<String>,
    pub warnings: Vec<String>,
    /// By the file's index, `None` being glTF's default material, and what its mesh has.
    known: HashMap<(Option<usize>, Has), (usize, Option<Vec3>)>,
    means: HashMap<usize, Mean>,
    pictures: HashMap<(usize, bool), Arc<TextureDesc>>,
}

impl<'a> Materials<'a> {
    pub fn new(path: &'a Path, buffers: &'a Buffers) -> Self {
        Materials {
            path,
            buffers,
            list: Vec::new(),
            notes: Vec::new(),
            warnings: Vec::new(),
            known: HashMap::new(),
            means: HashMap::new(),
            pictures: HashMap::new(),
        }
    }

    /// Index of the material, and the radiance it emits; `has` says what the mesh that it covers has.
    pub fn of(&mut self, material: &Material, has: Has) -> Result<(usize, Option<Vec3>), ImportError> {
        let key = (material.index(), has);
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let name = match material.index() {
            Some(index) => named("material", material.name(), index),
            None => "default material".to_string(),
        };
        let tint = self.tint(&name, material, has)?;
        let pbr = self.factors(&name, material, matches!(tint, Some(TintDesc::Texture { .. })))?;
        let emission = self.emission(&name, material)?;
        let mapped = pbr.map();
        let glow = match emission {
            Some(_) => ", emits",
            None => "",
        };
        self.tell(&format!("{name}: {}{glow}", mapped.words));
        for loss in &mapped.losses {
            self.warn(&format!("{name}: {loss}"));
        }
        self.ignored(&name, material, &pbr);
        self.list.push(NamedMaterial {
            name,
            two_sided: pbr.transmission < 0.5 || pbr.metallic >= 0.9,
            bsdf: mapped.bsdf,
            tint,
        });
        let found = (self.list.len() - 1, emission);
        self.known.insert(key, found);
        Ok(found)
    }

    fn tell(&mut self, what: &str) {
        self.notes.push(ImportError::new(self.path, what).to_string());
    }

    fn warn(&mut self, what: &str) {
        self.warnings.push(ImportError::new(self.path, what).to_string());
    }

    /// What the base colour is multiplied by: a texture as it is, else the mesh's colours. (glTF multiplies by both.)
    fn tint(&mut self, name: &str, material: &Material, has: Has) -> Result<Option<TintDesc>, ImportError> {
        let texture = material.pbr_metallic_roughness().base_color_texture();
        let Some(info) = texture.filter(|_| has.uvs) else {
            return Ok(has.colors.then_some(TintDesc::Vertices));
        };
        if has.colors {
            self.warn(&format!(
                "{name}: vertex colours are left out where it has a texture"
            ));
        }
        let texture = info.texture();
        let (index, nearest) = (
            texture.source().index(),
            texture.sampler().mag_filter() == Some(MagFilter::Nearest),
        );
        let picture = match self.pictures.get(&(index, nearest)) {
            Some(known) => Arc::clone(known),
            None => {
                let label = format!("images[{index}]");
                let decoded = self
                    .bytes(&texture)
                    .and_then(|bytes| texture::decode(&label, &bytes, nearest, false));
                let picture = decoded
                    .map_err(|what| ImportError::new(self.path, format!("{name}: {label}: {what}")))?;
                self.pictures.insert((index, nearest), Arc::clone(&picture));
                picture
            }
        };
        let to_uv = match info.texture_transform() {
            Some(transform) => {
                // Translation · rotation · scale (KHR_texture_transform).
                let [sx, sy] = transform.scale().map(f64::from);
                let [x, y] = transform.offset().map(f64::from);
                let (sin, cos) = f64::from(transform.rotation()).sin_cos();
                [[cos * sx, -sin * sy, x], [sin * sx, cos * sy, y]]
            }
            None => TintDesc::IN_PLACE,
        };
        Ok(Some(TintDesc::Texture {
            texture: picture,
            to_uv,
        }))
    }

    /// The factors, with textures by their means, but for the base colour's if it is there `as_texture`.
    fn factors(&mut self, name: &str, material: &Material, as_texture: bool) -> Result<Pbr, ImportError> {
        let pbr = material.pbr_metallic_roughness();
        let [r, g, b, _] = pbr.base_color_factor().map(f64::from);
        let mut factors = Pbr {
            base: [r, g, b],
            metallic: f64::from(pbr.metallic_factor()),
            roughness: f64::from(pbr.roughness_factor()),
            transmission: material
                .transmission()
                .map_or(0.0, |t| f64::from(t.transmission_factor())),
            ior: material.ior().map_or(1.5, f64::from),
        };
        if let Some(info) = pbr.base_color_texture().filter(|_| !as_texture) {
            let mean = self.mean(name, "baseColorTexture", &info.texture())?;
            (0..3).for_each(|i| factors.base[i] *= mean.linear[i]);
        }
        if let Some(info) = pbr.metallic_roughness_texture() {
            let mean = self.mean(name, "metallicRoughnessTexture", &info.texture())?;
            factors.roughness *= mean.stored[1];
            factors.metallic *= mean.stored[2];
        }
        if let Some(info) = material.transmission().and_then(|t| t.transmission_texture()) {
            let mean = self.mean(name, "transmissionTexture", &info.texture())?;
            factors.transmission *= mean.stored[0];
        }
        let shares = [factors.metallic, factors.roughness, factors.transmission];
        let in_range = shares
            .iter()
            .chain(&factors.base)
            .all(|x| (0.0..=1.0).contains(x));
        if !(in_range && factors.ior.is_finite() && factors.ior >= 0.0) {
            let message = format!("{name}: a factor is out of range 0 to 1, or its ior negative; correct it");
            return Err(ImportError::new(self.path, message));
        }
        Ok(factors)
    }

    fn emission(&mut self, name: &str, material: &Material) -> Result<Option<Vec3>, ImportError> {
        let strength = f64::from(material.emissive_strength().unwrap_or(1.0));
        let mut radiance = material.emissive_factor().map(|c| f64::from(c) * strength);
        if !radiance.iter().all(|c| c.is_finite() && *c >= 0.0) {
            let message = format!("{name}: its emission is negative or not finite; correct it");
            return Err(ImportError::new(self.path, message));
        }
        if radiance == [0.0; 3] {
            return Ok(None);
        }
        if let Some(info) = material.emissive_texture() {
            let mean = self.mean(name, "emissiveTexture", &info.texture())?;
            (0..3).for_each(|i| radiance[i] *= mean.linear[i]);
        }
        if material.double_sided() {
            self.warn(&format!("{name}: emits on its front alone, not on both sides"));
        }
        Ok(Some(radiance).filter(|r| *r != [0.0; 3]))
    }

    /// The mean of a texture, told once for each use; an error where the picture is broken or missing.
    fn mean(&mut self, name: &str, slot: &str, texture: &Texture) -> Result<Mean, ImportError> {
        let image = texture.source();
        let index = image.index();
        if let Some(&known) = self.means.get(&index) {
            self.warn(&format!("{name}: {slot} becomes its mean"));
            return Ok(known);
        }
        let mean = self
            .bytes(texture)
            .and_then(|bytes| texture::mean(&bytes))
            .map_err(|what| ImportError::new(self.path, format!("{name}: images[{index}]: {what}")))?;
        self.means.insert(index, mean);
        self.warn(&format!("{name}: {slot} becomes its mean"));
        Ok(mean)
    }

    /// A picture's file.
    fn bytes(&self, texture: &Texture) -> Result<Vec<u8>, String> {
        match texture.source().source() {
            Source::View { view, .. } => self.buffers.view(&view).map(<[u8]>::to_vec),
            Source::Uri { uri, .. } => self.buffers.uri(uri),
        }
    }

    /// What has no like here.
    fn ignored(&mut self, name: &str, material: &Material, pbr: &Pbr) {
        if material.normal_texture().is_some() {
            self.warn(&format!("{name}: its normal texture is left out"));
        }
        let alpha = material.pbr_metallic_roughness().base_color_factor()[3];
        match material.alpha_mode() {
            AlphaMode::Opaque => {}
            AlphaMode::Mask => self.warn(&format!("{name}: its alpha mask is left out: opaque all over")),
            AlphaMode::Blend => self.warn(&format!("{name}: its alpha of {alpha} is left out: opaque")),
        }
        if material.unlit() {
            self.warn(&format!(
                "{name}: is lit like all others, though the file says unlit"
            ));
        }
        let glass = pbr.transmission >= 0.5 && pbr.metallic < 0.9;
        let volume = material.volume();
        if glass && volume.as_ref().is_none_or(|v| v.thickness_factor() == 0.0) {
            self.warn(&format!(
                "{name}: its thin walls are taken as the surface of solid glass"
            ));
        }
        if let Some(volume) = volume
            && volume.attenuation_distance().is_finite()
            && volume.attenuation_color() != [1.0; 3]
        {
            self.warn(&format!("{name}: what it absorbs on the way is left out"));
        }
    }
}
