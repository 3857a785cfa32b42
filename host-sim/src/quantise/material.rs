//! Materials in the core's numbers.

use super::QuantiseError;
use super::rounding::albedo;
use crate::desc::{BsdfDesc, OrenNayarModel, Vec3};
use fixed::traits::Fixed;
use microlux::material::{BlinnPhong, Conductor, Dielectric, Index, Material, OrenNayar, RoughDielectric};
use microlux::num::{Metres, Share, Turn};

/// What the file says, rounded to nearest; an error for what is out of the core's range.
pub(super) fn material(name: &str, two_sided: bool, bsdf: &BsdfDesc) -> Result<Material, QuantiseError> {
    let error = |what: String| QuantiseError::Unsupported {
        name: name.to_string(),
        what,
    };
    let material = round(two_sided, bsdf).map_err(error)?;
    material.check().map_err(|wrong| error(wrong.to_string()))?;
    Ok(material)
}

fn round(two_sided: bool, bsdf: &BsdfDesc) -> Result<Material, String> {
    Ok(match bsdf {
        BsdfDesc::Diffuse { reflectance } => Material::Lambert {
            albedo: albedo(*reflectance),
            two_sided,
        },
        BsdfDesc::Conductor {
            specular_reflectance,
            eta_k: None,
        } => Material::Mirror {
            reflectance: albedo(*specular_reflectance),
            two_sided,
        },
        BsdfDesc::Conductor {
            specular_reflectance,
            eta_k,
        } => Material::Conductor(metal(specular_reflectance, eta_k, two_sided)?),
        BsdfDesc::RoughConductor {
            alpha,
            specular_reflectance,
            eta_k,
        } => {
            let metal = metal(specular_reflectance, eta_k, two_sided)?;
            Material::Conductor(metal.rough(roughness(*alpha)))
        }
        BsdfDesc::Dielectric {
            int_ior,
            ext_ior,
            specular_reflectance,
            specular_transmittance,
        } => Material::Dielectric(
            boundary(*int_ior, *ext_ior)?
                .tinted(albedo(*specular_reflectance), albedo(*specular_transmittance)),
        ),
        BsdfDesc::RoughDielectric {
            alpha,
            int_ior,
            ext_ior,
            specular_reflectance,
            specular_transmittance,
        } => {
            let smooth = boundary(*int_ior, *ext_ior)?;
            let smooth = smooth.tinted(albedo(*specular_reflectance), albedo(*specular_transmittance));
            Material::RoughDielectric(RoughDielectric::new(smooth, roughness(*alpha)))
        }
        BsdfDesc::OrenNayar {
            reflectance,
            sigma_degrees,
            model,
        } => {
            use microlux::material::OrenNayarModel as Core;
            let model = match model {
                OrenNayarModel::Full => Core::Full,
                OrenNayarModel::Qualitative => Core::Qualitative,
                OrenNayarModel::EnergyPreserving => Core::EnergyPreserving,
            };
            let sigma = Turn::saturating_from_num(sigma_degrees / 360.0);
            let diffuse = OrenNayar::new(model, albedo(*reflectance), sigma);
            Material::OrenNayar(if two_sided { diffuse } else { diffuse.one_sided() })
        }
        BsdfDesc::BlinnPhong {
            diffuse_reflectance,
            specular_reflectance,
            exponent,
            normalized,
        } => {
            let exponent = nearest(*exponent);
            let phong = BlinnPhong::new(
                albedo(*diffuse_reflectance),
                albedo(*specular_reflectance),
                exponent,
            );
            let phong = if *normalized { phong } else { phong.unnormalized() };
            Material::BlinnPhong(if two_sided { phong } else { phong.one_sided() })
        }
    })
}

/// Rounded to nearest, and held at the type's ends.
fn nearest<F: Fixed>(x: f64) -> F {
    let step = F::DELTA.to_num::<f64>();
    F::saturating_from_num(x + step / 2.0)
}

/// 0 stands for a smooth surface there; what is rough in the file must not become that.
fn roughness(alpha: f64) -> Share {
    nearest::<Share>(alpha).max(Share::DELTA)
}

fn boundary(int_ior: f64, ext_ior: f64) -> Result<Dielectric, String> {
    let eta = int_ior / ext_ior;
    if !(0.25..=4.0).contains(&eta) {
        return Err(format!("int_ior / ext_ior is {eta}; the core takes 0.25 to 4"));
    }
    Ok(Dielectric::new(Metres::saturating_from_num(eta)))
}

fn metal(reflectance: &Vec3, eta_k: &Option<(Vec3, Vec3)>, two_sided: bool) -> Result<Conductor, String> {
    let metal = Conductor::new(albedo(*reflectance));
    let metal = match eta_k {
        None => metal,
        Some((eta, k)) => {
            if let Some(beyond) = eta.iter().chain(k).find(|x| !(0.0..16.0).contains(*x)) {
                return Err(format!("eta or k is {beyond}; the core takes 0 to less than 16"));
            }
            metal.with_index(eta.map(nearest::<Index>), k.map(nearest::<Index>))
        }
    };
    Ok(if two_sided { metal } else { metal.one_sided() })
}
