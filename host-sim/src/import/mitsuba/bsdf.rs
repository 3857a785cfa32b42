//! `<bsdf>`: materials, each read once however often it is referred to.

use super::super::{ImportError, suggest};
use super::color::Quantity;
use super::params::{Context, Params, number, value};
use super::texture;
use super::tree::Element;
use crate::desc::{BsdfDesc, NamedMaterial, OrenNayarModel, Vec3};

const KINDS: [&str; 8] = [
    "diffuse",
    "conductor",
    "dielectric",
    "roughconductor",
    "roughdielectric",
    "orennayar",
    "blinnphong",
    "twosided",
];

/// Indices of refraction by name: Mitsuba 3's table (Hecht, Optics, 4th edition; at about 589 nm).
const REFRACTION: [(&str, f64); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000036),
    ("hydrogen", 1.000132),
    ("air", 1.000277),
    ("carbon dioxide", 1.00045),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];
const BK7: f64 = 1.5046;
const AIR: f64 = 1.000277;

/// The materials in use so far.
#[derive(Default)]
pub(super) struct Materials<'a> {
    pub list: Vec<NamedMaterial>,
    /// Which element became which material.
    read: Vec<(&'a Element, usize)>,
}

impl<'a> Materials<'a> {
    /// Index of the element's material.
    pub fn of(&mut self, element: &'a Element, context: &Context<'a>) -> Result<usize, ImportError> {
        if let Some(&(_, index)) = self.read.iter().find(|(known, _)| std::ptr::eq(*known, element)) {
            return Ok(index);
        }
        let index = self.push(read(element, context)?);
        self.read.push((element, index));
        Ok(index)
    }

    /// Index of what Mitsuba gives a shape without any: one-sided grey of 0.5, and black for one that emits.
    pub fn fallback(&mut self, emitter: bool) -> usize {
        let (name, grey) = if emitter {
            ("default of emitters", 0.0)
        } else {
            ("default", 0.5)
        };
        match self.list.iter().position(|known| known.name == name) {
            Some(index) => index,
            None => self.push(NamedMaterial {
                name: name.to_string(),
                two_sided: false,
                bsdf: BsdfDesc::Diffuse {
                    reflectance: [grey; 3],
                },
                tint: None,
            }),
        }
    }

    /// Index of the same material seen from the other side; `None` where no material says that.
    pub fn inside_out(&mut self, index: usize) -> Option<usize> {
        let material = &self.list[index];
        if material.two_sided {
            return Some(index);
        }
        let mut bsdf = material.bsdf.clone();
        match &mut bsdf {
            BsdfDesc::Dielectric { int_ior, ext_ior, .. }
            | BsdfDesc::RoughDielectric { int_ior, ext_ior, .. } => {
                std::mem::swap(int_ior, ext_ior);
            }
            _ => return None,
        }
        let name = format!("{} (inside out)", material.name);
        Some(match self.list.iter().position(|known| known.name == name) {
            Some(index) => index,
            None => self.push(NamedMaterial {
                name,
                two_sided: false,
                bsdf,
                tint: None,
            }),
        })
    }

    fn push(&mut self, material: NamedMaterial) -> usize {
        self.list.push(material);
        self.list.len() - 1
    }
}

/// The material of a `<bsdf>` element.
pub(super) fn read<'a>(element: &'a Element, context: &Context<'a>) -> Result<NamedMaterial, ImportError> {
    if element.kind() == "twosided" {
        return two_sided(element, context);
    }
    let params = Params::new(context, element);
    // What the material's own colour is given as; a texture multiplies white.
    let own = match element.kind() {
        "diffuse" | "orennayar" => Some("reflectance"),
        "conductor" | "roughconductor" => Some("specular_reflectance"),
        "blinnphong" => Some("diffuse_reflectance"),
        _ => None,
    };
    let tint = match own.map(|name| params.texture(name)).transpose()?.flatten() {
        Some(element) => texture::read(element, context)?,
        None => None,
    };
    let own_color = |name, default| match tint {
        Some(_) => Ok([1.0; 3]),
        None => reflectance(&params, name, default),
    };
    let bsdf = match element.kind() {
        "diffuse" => BsdfDesc::Diffuse {
            reflectance: own_color("reflectance", 0.5)?,
        },
        "conductor" => BsdfDesc::Conductor {
            eta_k: eta_k(&params)?,
            specular_reflectance: own_color("specular_reflectance", 1.0)?,
        },
        "roughconductor" => BsdfDesc::RoughConductor {
            alpha: ggx_alpha(&params)?,
            eta_k: eta_k(&params)?,
            specular_reflectance: own_color("specular_reflectance", 1.0)?,
        },
        "dielectric" => {
            let (int_ior, ext_ior) = iors(&params)?;
            BsdfDesc::Dielectric {
                int_ior,
                ext_ior,
                specular_reflectance: reflectance(&params, "specular_reflectance", 1.0)?,
                specular_transmittance: reflectance(&params, "specular_transmittance", 1.0)?,
            }
        }
        "roughdielectric" => {
            let (int_ior, ext_ior) = iors(&params)?;
            if int_ior == ext_ior {
                let message = "int_ior equals ext_ior, so that nothing scatters; make them differ";
                return Err(element.error(message));
            }
            BsdfDesc::RoughDielectric {
                alpha: ggx_alpha(&params)?,
                int_ior,
                ext_ior,
                specular_reflectance: reflectance(&params, "specular_reflectance", 1.0)?,
                specular_transmittance: reflectance(&params, "specular_transmittance", 1.0)?,
            }
        }
        "orennayar" => oren_nayar(&params, own_color("reflectance", 0.5)?)?,
        "blinnphong" => BsdfDesc::BlinnPhong {
            diffuse_reflectance: own_color("diffuse_reflectance", 0.5)?,
            specular_reflectance: reflectance(&params, "specular_reflectance", 0.2)?,
            exponent: params
                .checked("exponent", "0 or more", |n| n >= 0.0)?
                .unwrap_or(30.0),
            normalized: params.boolean("normalized")?.unwrap_or(true),
        },
        _ => {
            context.refuse_kind(element, &KINDS)?;
            let stand_in = BsdfDesc::Diffuse {
                reflectance: [0.5; 3],
            };
            return Ok(NamedMaterial {
                name: element.name(),
                two_sided: true,
                bsdf: stand_in,
                tint: None,
            });
        }
    };
    params.finish()?;
    Ok(NamedMaterial {
        name: element.name(),
        two_sided: false,
        bsdf,
        tint,
    })
}

fn two_sided<'a>(element: &'a Element, context: &Context<'a>) -> Result<NamedMaterial, ImportError> {
    let params = Params::new(context, element);
    let Some(inner) = params.object("bsdf")? else {
        return Err(element.error("twosided holds no <bsdf>; put one in it".to_string()));
    };
    params.finish()?;
    let mut material = read(inner, context)?;
    match material.bsdf {
        BsdfDesc::Dielectric { .. } | BsdfDesc::RoughDielectric { .. } => {
            context.refuse(
                inner,
                format!("{} lets light through; take it out of twosided", inner.describe()),
            )?;
        }
        _ => material.two_sided = true,
    }
    if element.attribute("id").is_some() || inner.attribute("id").is_none() {
        material.name = match element.attribute("id") {
            Some(id) => id.to_string(),
            None => format!("{} at line {}", inner.kind(), element.line),
        };
    }
    Ok(material)
}

fn reflectance(params: &Params, name: &'static str, default: f64) -> Result<Vec3, ImportError> {
    Ok(params.color(name, Quantity::Reflectance)?.unwrap_or([default; 3]))
}

/// `None` is Mitsuba's material `none`, a perfect mirror, and its default.
fn eta_k(params: &Params) -> Result<Option<(Vec3, Vec3)>, ImportError> {
    let material = params.string("material")?;
    let eta = params.color("eta", Quantity::Index)?;
    let k = params.color("k", Quantity::Index)?;
    match material {
        Some((at, _)) if eta.is_some() || k.is_some() => {
            Err(at.error("both material and eta, k are given; keep one way".to_string()))
        }
        Some((at, name)) if name != "none" => {
            let advice = "write \"none\", or its eta and k as <rgb>";
            Err(at.error(format!("material \"{name}\" is not supported; {advice}")))
        }
        // What one of them is when only the other is given: Mitsuba 3.9.1's defaults.
        _ if eta.is_some() || k.is_some() => Ok(Some((eta.unwrap_or([0.0; 3]), k.unwrap_or([1.0; 3])))),
        _ => Ok(None),
    }
}

/// Inside and outside index of refraction; bk7 in air by default.
fn iors(params: &Params) -> Result<(f64, f64), ImportError> {
    let one = |name, default| match params.number_or_string(name)? {
        Some(element) => ior(element, name),
        None => Ok(default),
    };
    Ok((one("int_ior", BK7)?, one("ext_ior", AIR)?))
}

fn ior(element: &Element, name: &str) -> Result<f64, ImportError> {
    let text = value(element);
    if element.tag == "string" {
        let known = REFRACTION
            .iter()
            .find(|(material, _)| material.eq_ignore_ascii_case(text));
        let names = REFRACTION.map(|(material, _)| material);
        return known.map(|&(_, ior)| ior).ok_or_else(|| {
            element.error(format!(
                "{name} \"{text}\" is not known; {}",
                suggest::advice(text, &names)
            ))
        });
    }
    match number(element, text)? {
        ior if ior > 0.0 => Ok(ior),
        ior => Err(element.error(format!("{name} {ior} is out of range; it must be above 0"))),
    }
}

/// The roughness; the distribution must say ggx, since Mitsuba's default is another.
fn ggx_alpha(params: &Params) -> Result<f64, ImportError> {
    let alpha = params
        .checked("alpha", "above 0 and at most 1", |a| a > 0.0 && a <= 1.0)?
        .unwrap_or(0.1);
    match params.string("distribution")? {
        Some((_, "ggx")) => {}
        Some((at, other)) => params.refuse(
            at,
            format!("distribution \"{other}\" is not supported; write \"ggx\""),
        )?,
        None => {
            let message = "Mitsuba's default distribution, beckmann, is not supported; \
                           add <string name=\"distribution\" value=\"ggx\"/>";
            params.refuse(params.element, message.to_string())?;
        }
    }
    Ok(alpha)
}

fn oren_nayar(params: &Params, reflectance: Vec3) -> Result<BsdfDesc, ImportError> {
    let sigma = params.checked("sigma", "0 to 90 degrees", |s| (0.0..=90.0).contains(&s))?;
    let sigma_degrees = sigma.ok_or_else(|| {
        params
            .element
            .error("orennayar needs its roughness; add <float name=\"sigma\" value=\"degrees\"/>".to_string())
    })?;
    let model = match params.string("model")? {
        None | Some((_, "qualitative")) => OrenNayarModel::Qualitative,
        Some((_, "full")) => OrenNayarModel::Full,
        Some((_, "energy_preserving")) => OrenNayarModel::EnergyPreserving,
        Some((at, other)) => {
            let advice = suggest::advice(other, &["full", "qualitative", "energy_preserving"]);
            return Err(at.error(format!("model \"{other}\" is not known; {advice}")));
        }
    };
    Ok(BsdfDesc::OrenNayar {
        reflectance,
        sigma_degrees,
        model,
    })
}
