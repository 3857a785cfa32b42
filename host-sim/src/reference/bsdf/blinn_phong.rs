//! Diffuse and a half-vector lobe: Blinn, "Models of Light Reflection for Computer Synthesized Pictures" (SIGGRAPH 1977).

use std::f64::consts::{FRAC_1_PI, TAU};

use super::super::vec::{Rgb, Vec3, vec3};
use super::super::warp;

#[derive(Clone, Copy)]
pub struct BlinnPhong {
    pub diffuse: Rgb,
    pub specular: Rgb,
    pub exponent: f64,
    pub normalized: bool,
}

impl BlinnPhong {
    /// f·cosθi and the density of `sample`; both directions are on the side of `normal`.
    pub fn eval(&self, normal: Vec3, wo: Vec3, wi: Vec3) -> (Rgb, f64) {
        let cos = normal.dot(wi);
        let half = (wo + wi).normalized();
        let lobe = half.dot(normal).clamp(0.0, 1.0).powf(self.exponent);
        let scale = if self.normalized {
            (self.exponent + 8.0) / (4.0 * TAU) * cos
        } else {
            FRAC_1_PI
        };
        let scattered = self.diffuse * (FRAC_1_PI * cos) + self.specular * (scale * lobe);
        let by_half = (self.exponent + 1.0) / TAU * lobe / (4.0 * half.dot(wo));
        let share = self.specular_share();
        (scattered, share * by_half + (1.0 - share) * FRAC_1_PI * cos)
    }

    /// A cosine-weighted direction, or the reflection at a half vector of density (n+1)/(2π) cosⁿ; it may lie below.
    pub fn sample(&self, normal: Vec3, wo: Vec3, u: [f64; 2], lobe: f64) -> Vec3 {
        if lobe >= self.specular_share() {
            return normal.frame_to_world(warp::cosine_hemisphere(u));
        }
        let cos = (1.0 - u[0]).powf(1.0 / (self.exponent + 1.0));
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (y, x) = (TAU * u[1]).sin_cos();
        let half = normal.frame_to_world(vec3(sin * x, sin * y, cos));
        half * (2.0 * half.dot(wo)) - wo
    }

    /// How often the half-vector lobe is chosen: by the two reflectances.
    fn specular_share(&self) -> f64 {
        let sum = |c: Rgb| c.x + c.y + c.z;
        let (diffuse, specular) = (sum(self.diffuse), sum(self.specular));
        if specular > 0.0 {
            specular / (diffuse + specular)
        } else {
            0.0
        }
    }
}
