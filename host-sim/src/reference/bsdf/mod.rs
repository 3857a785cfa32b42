//! What a surface does with light, in radiance transport: `wo` leaves towards the eye, `wi` towards the light.
//!
//! The geometric normal decides the side of a direction; the shading normal gives the angles.

mod blinn_phong;
mod fresnel;
mod ggx;
mod oren_nayar;

use std::f64::consts::{FRAC_1_PI, TAU};

use super::scene::{Material, Ray};
use super::shape::Hit;
use super::vec::{Rgb, Vec3};
use super::warp;
use blinn_phong::BlinnPhong;
use ggx::Glass;

/// A surface point as the eye's side sees it.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    pub point: Vec3,
    /// Unit, towards the eye.
    pub wo: Vec3,
    /// Geometric normal, turned to the eye's side.
    pub normal: Vec3,
    /// Shading normal, turned with the geometric one; where it points away from the eye, at the outline of a smooth mesh, the
    /// geometric one itself.
    pub shading: Vec3,
    /// The eye is on the side of the shape's own normal.
    pub front: bool,
}

/// A direction chosen by the material.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    pub wi: Vec3,
    /// f·cosθ over the density.
    pub weight: Rgb,
    /// Solid-angle density; `None` for a direction that only chance or law could choose (mirror, glass).
    pub pdf: Option<f64>,
    /// Index of refraction on the side of `wi` over that of `wo`.
    pub eta: f64,
}

impl Surface {
    pub fn new(ray: &Ray, hit: &Hit) -> Surface {
        let side = if hit.front { 1.0 } else { -1.0 };
        let (wo, normal, shading) = (-ray.direction, hit.normal * side, hit.shading * side);
        Surface {
            point: hit.point,
            wo,
            normal,
            shading: if shading.dot(wo) > 0.0 { shading } else { normal },
            front: hit.front,
        }
    }
}

impl Material {
    /// With the colour of its matt part, or of a mirror or metal, multiplied by another.
    pub fn tinted(self, tint: Rgb) -> Material {
        let mut tinted = self;
        match &mut tinted {
            Material::Diffuse { reflectance, .. }
            | Material::Mirror { reflectance, .. }
            | Material::Conductor { reflectance, .. }
            | Material::RoughConductor { reflectance, .. }
            | Material::OrenNayar { reflectance, .. } => *reflectance *= tint,
            Material::BlinnPhong { diffuse, .. } => *diffuse *= tint,
            Material::Black | Material::Dielectric { .. } | Material::RoughDielectric { .. } => {}
        }
        tinted
    }

    /// Whether light must arrive from one exact direction, so that choosing a point on a light is in vain.
    pub fn is_specular(&self) -> bool {
        match self {
            Material::Mirror { .. } | Material::Conductor { .. } | Material::Dielectric { .. } => true,
            Material::Black => true,
            Material::Diffuse { .. }
            | Material::OrenNayar { .. }
            | Material::BlinnPhong { .. }
            | Material::RoughConductor { .. }
            | Material::RoughDielectric { .. } => false,
        }
    }

    /// f·|cosθi| for radiance that arrives along `wi`, and the solid-angle density of `sample`; zeros for the specular ones.
    pub fn eval(&self, surface: &Surface, wi: Vec3) -> (Rgb, f64) {
        let dark = (Rgb::ZERO, 0.0);
        let (normal, wo) = (surface.shading, surface.wo);
        let above =
            |two_sided| reflects(surface, two_sided) && normal.dot(wi) > 0.0 && surface.normal.dot(wi) > 0.0;
        match *self {
            Material::Diffuse {
                reflectance,
                two_sided,
            } if above(two_sided) => {
                let pdf = normal.dot(wi) * FRAC_1_PI;
                (reflectance * pdf, pdf)
            }
            Material::OrenNayar {
                reflectance,
                sigma,
                model,
                two_sided,
            } if above(two_sided) => {
                let cos = normal.dot(wi);
                let f = oren_nayar::brdf(model, reflectance, sigma, normal, wo, wi);
                (f * cos, cos * FRAC_1_PI)
            }
            Material::BlinnPhong { two_sided, .. } if above(two_sided) => self
                .blinn_phong()
                .map_or(dark, |lobes| lobes.eval(normal, wo, wi)),
            Material::RoughConductor {
                alpha,
                reflectance,
                eta_k,
                two_sided,
            } if above(two_sided) => {
                let (scattered, facet_cos, pdf) = ggx::reflection(normal, wo, wi, alpha);
                (metal(reflectance, eta_k, facet_cos) * scattered, pdf)
            }
            Material::RoughDielectric { .. } => {
                let Some(glass) = self.glass(surface) else {
                    return dark;
                };
                // Both normals must agree on which side `wi` is.
                let leaks = surface.normal.dot(wi) * glass.normal.dot(wi) <= 0.0;
                if leaks { dark } else { glass.eval(wo, wi) }
            }
            _ => dark,
        }
    }

    /// A direction for the next segment: `u` chooses the direction, `lobe` between reflection and refraction, or between
    /// the lobes of a sum.
    ///
    /// `None` where nothing is reflected, or the direction chosen would leak through the surface.
    pub fn sample(&self, surface: &Surface, u: [f64; 2], lobe: f64) -> Option<Bounce> {
        let (normal, wo) = (surface.shading, surface.wo);
        let wi = match *self {
            Material::Diffuse { reflectance, .. } => {
                // As below, but that the weight is exact.
                let wi = normal.frame_to_world(warp::cosine_hemisphere(u));
                return self.bounce(surface, wi).map(|bounce| Bounce {
                    weight: reflectance,
                    ..bounce
                });
            }
            Material::Mirror {
                reflectance,
                two_sided,
            } => return mirror(surface, two_sided, |_| reflectance),
            Material::Conductor {
                reflectance,
                eta,
                k,
                two_sided,
            } => {
                return mirror(surface, two_sided, |cos| {
                    reflectance * fresnel::conductor(cos, eta, k)
                });
            }
            Material::Dielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            } => {
                let eta = if surface.front { eta } else { 1.0 / eta };
                return dielectric(surface, eta, [specular_reflectance, specular_transmittance], lobe);
            }
            Material::Black => return None,
            Material::OrenNayar { .. } => normal.frame_to_world(warp::cosine_hemisphere(u)),
            Material::BlinnPhong { .. } => self.blinn_phong()?.sample(normal, wo, u, lobe),
            Material::RoughConductor { alpha, .. } => {
                if normal.dot(wo) <= 0.0 {
                    return None;
                }
                reflected(wo, ggx::sample_facet(normal, wo, alpha, u))
            }
            Material::RoughDielectric { .. } => self.glass(surface)?.sample(wo, u, lobe)?,
        };
        self.bounce(surface, wi)
    }

    /// `sample` without a preference: uniform over the hemisphere where the material has a density, over the sphere where it
    /// lets light through.
    pub fn sample_uniform(&self, surface: &Surface, u: [f64; 2], lobe: f64) -> Option<Bounce> {
        if self.is_specular() {
            return self.sample(surface, u, lobe);
        }
        let through = matches!(self, Material::RoughDielectric { .. });
        let (height, area) = if through { (2.0, 2.0 * TAU) } else { (1.0, TAU) };
        let wi = surface.shading.frame_to_world(warp::cone(u, height));
        Some(Bounce {
            wi,
            weight: self.eval(surface, wi).0 * area,
            pdf: Some(1.0 / area),
            eta: self.eta_towards(surface, wi),
        })
    }

    /// The bounce into `wi`, which `sample` has chosen.
    fn bounce(&self, surface: &Surface, wi: Vec3) -> Option<Bounce> {
        let (scattered, pdf) = self.eval(surface, wi);
        (pdf > 0.0).then(|| Bounce {
            wi,
            weight: scattered / pdf,
            pdf: Some(pdf),
            eta: self.eta_towards(surface, wi),
        })
    }

    /// Index of refraction on the side of `wi` over that of `wo`.
    fn eta_towards(&self, surface: &Surface, wi: Vec3) -> f64 {
        match *self {
            Material::RoughDielectric { eta, .. } if surface.normal.dot(wi) < 0.0 => {
                if surface.front {
                    eta
                } else {
                    1.0 / eta
                }
            }
            _ => 1.0,
        }
    }

    fn blinn_phong(&self) -> Option<BlinnPhong> {
        match *self {
            Material::BlinnPhong {
                diffuse,
                specular,
                exponent,
                normalized,
                ..
            } => Some(BlinnPhong {
                diffuse,
                specular,
                exponent,
                normalized,
            }),
            _ => None,
        }
    }

    fn glass(&self, surface: &Surface) -> Option<Glass> {
        match *self {
            Material::RoughDielectric {
                alpha,
                eta,
                specular_reflectance,
                specular_transmittance,
            } => Some(Glass {
                normal: surface.shading,
                alpha,
                eta: if surface.front { eta } else { 1.0 / eta },
                reflectance: specular_reflectance,
                transmittance: specular_transmittance,
            }),
            _ => None,
        }
    }
}

/// Seen from a side that reflects.
fn reflects(surface: &Surface, two_sided: bool) -> bool {
    (surface.front || two_sided) && surface.shading.dot(surface.wo) > 0.0
}

fn reflected(wo: Vec3, normal: Vec3) -> Vec3 {
    normal * (2.0 * normal.dot(wo)) - wo
}

/// `weight` by the cosine of incidence.
fn mirror(surface: &Surface, two_sided: bool, weight: impl Fn(f64) -> Rgb) -> Option<Bounce> {
    let wi = reflected(surface.wo, surface.shading);
    let reflects = reflects(surface, two_sided) && surface.normal.dot(wi) > 0.0;
    reflects.then(|| Bounce {
        wi,
        weight: weight(surface.shading.dot(surface.wo).min(1.0)),
        pdf: None,
        eta: 1.0,
    })
}

/// What a facet of metal reflects at cosine `cos`; without an index, a perfect mirror's.
fn metal(reflectance: Rgb, eta_k: Option<(Rgb, Rgb)>, cos: f64) -> Rgb {
    match eta_k {
        Some((eta, k)) => reflectance * fresnel::conductor(cos.clamp(0.0, 1.0), eta, k),
        None => reflectance,
    }
}

/// `eta`: index of refraction beyond the surface over the one before it.
fn dielectric(
    surface: &Surface,
    eta: f64,
    [reflectance, transmittance]: [Rgb; 2],
    lobe: f64,
) -> Option<Bounce> {
    let wo = surface.wo;
    let normal = surface.shading;
    let cos_o = normal.dot(wo).min(1.0);
    let (fresnel, cos_t) = fresnel::dielectric(cos_o, eta);
    if lobe < fresnel {
        let wi = reflected(wo, normal);
        return (surface.normal.dot(wi) > 0.0).then_some(Bounce {
            wi,
            weight: reflectance,
            pdf: None,
            eta: 1.0,
        });
    }
    // Snell's law; radiance spreads or gathers with the solid angle (Veach 1997, section 5.2: L/η² is kept).
    let wi = (normal * (cos_o / eta - cos_t) - wo / eta).normalized();
    let weight = transmittance / (eta * eta);
    (surface.normal.dot(wi) < 0.0).then_some(Bounce {
        wi,
        weight,
        pdf: None,
        eta,
    })
}
