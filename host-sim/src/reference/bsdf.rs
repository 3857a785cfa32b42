//! What a surface does with light, in radiance transport: `wo` leaves towards the eye, `wi` towards the light.
//!
//! The geometric normal decides the side of a direction; the shading normal gives the angles.

use std::f64::consts::{FRAC_1_PI, TAU};

use super::scene::{Material, Ray};
use super::shape::Hit;
use super::vec::{Rgb, Vec3};
use super::warp;

/// A surface point as the eye's side sees it.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    pub point: Vec3,
    /// Unit, towards the eye.
    pub wo: Vec3,
    /// Geometric normal, turned to the eye's side.
    pub normal: Vec3,
    /// Shading normal, turned with the geometric one; where the surface bends away it may still point away from the eye.
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
        Surface {
            point: hit.point,
            wo: -ray.direction,
            normal: hit.normal * side,
            shading: hit.shading * side,
            front: hit.front,
        }
    }
}

impl Material {
    /// Whether light must arrive from one exact direction, so that choosing a point on a light is in vain.
    pub fn is_specular(&self) -> bool {
        !matches!(self, Material::Diffuse { .. })
    }

    /// f·|cosθi|; zero for the specular ones.
    pub fn eval(&self, surface: &Surface, wi: Vec3) -> Rgb {
        match *self {
            Material::Diffuse { reflectance, .. } => reflectance * self.pdf(surface, wi),
            _ => Rgb::ZERO,
        }
    }

    /// Solid-angle density of `sample`; zero for the specular ones.
    pub fn pdf(&self, surface: &Surface, wi: Vec3) -> f64 {
        match *self {
            Material::Diffuse { two_sided, .. } => {
                let cos = surface.shading.dot(wi);
                let reflects = reflects(surface, two_sided) && cos > 0.0 && surface.normal.dot(wi) > 0.0;
                if reflects { cos * FRAC_1_PI } else { 0.0 }
            }
            _ => 0.0,
        }
    }

    /// A direction for the next segment: `u` chooses the direction, `lobe` between reflection and refraction.
    ///
    /// `None` where nothing is reflected, or the direction chosen would leak through the surface.
    pub fn sample(&self, surface: &Surface, u: [f64; 2], lobe: f64) -> Option<Bounce> {
        match *self {
            Material::Diffuse { reflectance, .. } => {
                let wi = surface.shading.frame_to_world(warp::cosine_hemisphere(u));
                let pdf = self.pdf(surface, wi);
                (pdf > 0.0).then_some(Bounce {
                    wi,
                    weight: reflectance,
                    pdf: Some(pdf),
                    eta: 1.0,
                })
            }
            Material::Mirror {
                reflectance,
                two_sided,
            } => {
                let wi = reflected(surface.wo, surface.shading);
                let reflects = reflects(surface, two_sided) && surface.normal.dot(wi) > 0.0;
                reflects.then_some(Bounce {
                    wi,
                    weight: reflectance,
                    pdf: None,
                    eta: 1.0,
                })
            }
            Material::Dielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            } => {
                let eta = if surface.front { eta } else { 1.0 / eta };
                dielectric(surface, eta, [specular_reflectance, specular_transmittance], lobe)
            }
            Material::Black => None,
        }
    }

    /// `sample` without a preference: uniform over the hemisphere where the material has a density.
    pub fn sample_uniform(&self, surface: &Surface, u: [f64; 2], lobe: f64) -> Option<Bounce> {
        if self.is_specular() {
            return self.sample(surface, u, lobe);
        }
        let wi = surface.shading.frame_to_world(warp::uniform_hemisphere(u));
        Some(Bounce {
            wi,
            weight: self.eval(surface, wi) * TAU,
            pdf: Some(1.0 / TAU),
            eta: 1.0,
        })
    }
}

/// Seen from a side that reflects, and not where the shading normal has turned away from the eye.
fn reflects(surface: &Surface, two_sided: bool) -> bool {
    (surface.front || two_sided) && surface.shading.dot(surface.wo) > 0.0
}

fn reflected(wo: Vec3, normal: Vec3) -> Vec3 {
    normal * (2.0 * normal.dot(wo)) - wo
}

/// `eta`: index of refraction beyond the surface over the one before it.
fn dielectric(
    surface: &Surface,
    eta: f64,
    [reflectance, transmittance]: [Rgb; 2],
    lobe: f64,
) -> Option<Bounce> {
    let wo = surface.wo;
    // Glass has no dark side to show where the shading normal turns away: take the true one.
    let normal = if surface.shading.dot(wo) > 0.0 {
        surface.shading
    } else {
        surface.normal
    };
    let cos_o = normal.dot(wo).min(1.0);
    let (fresnel, cos_t) = fresnel(cos_o, eta);
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

/// Reflectance of unpolarised light that meets a boundary at cosine `cos_i`, and the cosine of the refracted ray.
///
/// `eta`: index beyond the boundary over the one before it. (1, 0) on total internal reflection. Born and Wolf,
/// "Principles of Optics", section 1.5.2.
pub fn fresnel(cos_i: f64, eta: f64) -> (f64, f64) {
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    ((perpendicular * perpendicular + parallel * parallel) / 2.0, cos_t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresnel_agrees_with_the_special_angles() {
        let (normal, cos_t) = fresnel(1.0, 1.5);
        assert!((normal - 0.04).abs() < 1e-15 && cos_t == 1.0);
        // At Brewster's angle tanθ = η the parallel part vanishes and the perpendicular one is ((1−η²)/(1+η²))².
        let eta: f64 = 1.5;
        let (brewster, _) = fresnel(eta.atan().cos(), eta);
        let perpendicular = ((1.0 - eta * eta) / (1.0 + eta * eta)).powi(2);
        assert!((brewster - perpendicular / 2.0).abs() < 1e-15);
        // The critical angle from inside is asin(1/1.5) = 41.81°.
        assert!(fresnel(41.9f64.to_radians().cos(), 1.0 / 1.5).0 == 1.0);
        assert!(fresnel(41.7f64.to_radians().cos(), 1.0 / 1.5).0 < 1.0);
    }
}
