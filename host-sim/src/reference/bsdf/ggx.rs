//! Rough boundaries of GGX facets: metal, and glass.
//!
//! Walter, Marschner, Li and Torrance, "Microfacet Models for Refraction through Rough Surfaces" (EGSR 2007), with Smith's
//! masking and shadowing as the product of both directions' (their equation 23), as in Mitsuba 3.

use std::f64::consts::{PI, TAU};

use super::super::vec::{Rgb, Vec3, vec3};
use super::fresnel;

/// Density of facet normals at cosine `cos` to the surface's normal: equation 33.
fn distribution(cos: f64, alpha: f64) -> f64 {
    if cos <= 0.0 {
        return 0.0;
    }
    let cos2 = cos * cos;
    let spread = cos2 * alpha * alpha + (1.0 - cos2);
    alpha * alpha / (PI * spread * spread)
}

/// Share of the facets' area that is seen from a direction at cosine `cos`: equation 34.
fn visible(cos: f64, alpha: f64) -> f64 {
    let tan2 = (1.0 - cos * cos).max(0.0) / (cos * cos);
    2.0 / (1.0 + (1.0 + alpha * alpha * tan2).sqrt())
}

/// A facet's normal as often as `wo` sees such facets: density `visible` × `distribution` × (wo·h) / cosθo.
///
/// Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps" (HPG 2023): a hemisphere of unit roughness, seen
/// from `wo`, reflects uniformly into a cap of the sphere.
pub fn sample_facet(normal: Vec3, wo: Vec3, alpha: f64, [u, v]: [f64; 2]) -> Vec3 {
    let local = normal.frame_to_local(wo);
    let stretched = vec3(local.x * alpha, local.y * alpha, local.z).normalized();
    let z = (1.0 - v) * (1.0 + stretched.z) - stretched.z;
    let (sin, cos) = (TAU * u).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    let half = vec3(r * cos, r * sin, z) + stretched;
    let facet = vec3(half.x * alpha, half.y * alpha, half.z.max(0.0)).normalized();
    normal.frame_to_world(facet)
}

/// Density of `sample_facet` over the sphere of facet normals, for `wo` on their front.
fn facet_pdf(cos_o: f64, half_o: f64, half_n: f64, alpha: f64) -> f64 {
    visible(cos_o, alpha) * distribution(half_n, alpha) * half_o / cos_o
}

/// f·cosθi without the Fresnel factor, the facet's cosine for that factor, and the density of reflection at `sample_facet`.
///
/// Both directions are on the normal's side. Equations 20 and 14.
pub fn reflection(normal: Vec3, wo: Vec3, wi: Vec3, alpha: f64) -> (f64, f64, f64) {
    let (cos_o, cos_i) = (normal.dot(wo), normal.dot(wi));
    let half = (wo + wi).normalized();
    let (half_o, half_n) = (half.dot(wo), half.dot(normal));
    let seen = visible(cos_o, alpha) * visible(cos_i, alpha) * distribution(half_n, alpha);
    let scattered = seen / (4.0 * cos_o);
    let pdf = facet_pdf(cos_o, half_o, half_n, alpha) / (4.0 * half_o);
    (scattered, half_o, pdf)
}

/// A rough boundary between two dielectrics, seen from the side of `normal`.
pub struct Glass {
    pub normal: Vec3,
    pub alpha: f64,
    /// Index of refraction beyond the surface over the one before it.
    pub eta: f64,
    pub reflectance: Rgb,
    pub transmittance: Rgb,
}

impl Glass {
    /// f·|cosθi|, and the density of `sample`. `wi` may be on either side.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Rgb, f64) {
        let (cos_o, cos_i) = (self.normal.dot(wo), self.normal.dot(wi));
        if cos_o <= 0.0 || cos_i == 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        if cos_i > 0.0 {
            let (scattered, half_o, pdf) = reflection(self.normal, wo, wi, self.alpha);
            let (fresnel, _) = fresnel::dielectric(half_o.min(1.0), self.eta);
            return (self.reflectance * (scattered * fresnel), pdf * fresnel);
        }
        // Equation 16, turned to the front.
        let half = (wo + wi * self.eta).normalized();
        let half = half * 1f64.copysign(self.normal.dot(half));
        let (half_o, half_i, half_n) = (half.dot(wo), half.dot(wi), half.dot(self.normal));
        if !(half_o > 0.0 && half_i < 0.0) {
            return (Rgb::ZERO, 0.0);
        }
        let (fresnel, _) = fresnel::dielectric(half_o.min(1.0), self.eta);
        let compression = half_o + self.eta * half_i;
        // Equation 21 over η², since radiance is carried: it grows by η² on the way into the denser side.
        let seen =
            visible(cos_o, self.alpha) * visible(-cos_i, self.alpha) * distribution(half_n, self.alpha);
        let scattered = (1.0 - fresnel) * seen * half_o * -half_i / (cos_o * compression * compression);
        // Equation 17.
        let jacobian = self.eta * self.eta * -half_i / (compression * compression);
        let pdf = facet_pdf(cos_o, half_o, half_n, self.alpha) * (1.0 - fresnel) * jacobian;
        (self.transmittance * scattered, pdf)
    }

    /// A direction, by reflection or refraction at a facet that `wo` sees; `None` if it meets the surface once more.
    pub fn sample(&self, wo: Vec3, u: [f64; 2], lobe: f64) -> Option<Vec3> {
        let half = sample_facet(self.normal, wo, self.alpha, u);
        let half_o = half.dot(wo).clamp(0.0, 1.0);
        let (fresnel, cos_t) = fresnel::dielectric(half_o, self.eta);
        if lobe < fresnel {
            let wi = half * (2.0 * half_o) - wo;
            return (self.normal.dot(wi) > 0.0).then_some(wi);
        }
        let wi = (half * (half_o / self.eta - cos_t) - wo / self.eta).normalized();
        (self.normal.dot(wi) < 0.0).then_some(wi)
    }
}
