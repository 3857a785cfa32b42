//! Materials as the core holds them, in f64.

use super::albedo;
use crate::reference::{Material, OrenNayarModel};
use std::f64::consts::FRAC_PI_2;

pub(super) fn material(material: &microlux::material::Material) -> Material {
    use microlux::material::Material as Core;
    match *material {
        Core::Black => Material::Black,
        Core::Lambert { albedo: a, two_sided } => Material::Diffuse {
            reflectance: albedo(a).into(),
            two_sided,
        },
        Core::Mirror {
            reflectance,
            two_sided,
        } => Material::Mirror {
            reflectance: albedo(reflectance).into(),
            two_sided,
        },
        Core::Dielectric(d) => {
            let (reflectance, transmittance) = d.tints();
            Material::Dielectric {
                eta: d.eta().to_num(),
                specular_reflectance: albedo(reflectance).into(),
                specular_transmittance: albedo(transmittance).into(),
            }
        }
        Core::RoughDielectric(d) => {
            let (reflectance, transmittance) = d.tints();
            Material::RoughDielectric {
                alpha: d.alpha().to_num(),
                eta: d.eta().to_num(),
                specular_reflectance: albedo(reflectance).into(),
                specular_transmittance: albedo(transmittance).into(),
            }
        }
        Core::Conductor(metal) => {
            let reflectance = albedo(metal.reflectance()).into();
            let two_sided = metal.is_two_sided();
            let eta_k = metal.index().map(|[eta, k]| {
                let number = |of: [microlux::material::Index; 3]| of.map(|c| c.to_num::<f64>()).into();
                (number(eta), number(k))
            });
            match (metal.is_rough(), eta_k) {
                (true, eta_k) => Material::RoughConductor {
                    alpha: metal.alpha().to_num(),
                    reflectance,
                    eta_k,
                    two_sided,
                },
                (false, Some((eta, k))) => Material::Conductor {
                    reflectance,
                    eta,
                    k,
                    two_sided,
                },
                (false, None) => Material::Mirror {
                    reflectance,
                    two_sided,
                },
            }
        }
        Core::OrenNayar(diffuse) => {
            use microlux::material::OrenNayarModel as CoreModel;
            Material::OrenNayar {
                reflectance: albedo(diffuse.reflectance()).into(),
                sigma: diffuse.sigma().to_num::<f64>() * FRAC_PI_2,
                model: match diffuse.model() {
                    CoreModel::Full => OrenNayarModel::Full,
                    CoreModel::Qualitative => OrenNayarModel::Qualitative,
                    CoreModel::EnergyPreserving => OrenNayarModel::EnergyPreserving,
                },
                two_sided: diffuse.is_two_sided(),
            }
        }
        Core::BlinnPhong(phong) => Material::BlinnPhong {
            diffuse: albedo(phong.diffuse()).into(),
            specular: albedo(phong.specular()).into(),
            exponent: phong.exponent().to_num(),
            normalized: phong.is_normalized(),
            two_sided: phong.is_two_sided(),
        },
    }
}
