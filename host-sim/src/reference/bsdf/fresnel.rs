//! How much of unpolarised light a smooth boundary reflects.

use super::super::vec::{Rgb, vec3};

/// Reflectance of unpolarised light that meets a boundary at cosine `cos_i`, and the cosine of the refracted ray.
///
/// `eta`: index beyond the boundary over the one before it. (1, 0) on total internal reflection. Born and Wolf,
/// "Principles of Optics", section 1.5.2.
pub fn dielectric(cos_i: f64, eta: f64) -> (f64, f64) {
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    ((perpendicular * perpendicular + parallel * parallel) / 2.0, cos_t)
}

/// The same for metal: the index is `eta` + i `k` relative to the air, a channel each.
///
/// Fresnel's formulas as they stand, in complex numbers (Born and Wolf, section 14.2).
pub fn conductor(cos_i: f64, eta: Rgb, k: Rgb) -> Rgb {
    vec3(
        metal(cos_i, Complex(eta.x, k.x)),
        metal(cos_i, Complex(eta.y, k.y)),
        metal(cos_i, Complex(eta.z, k.z)),
    )
}

fn metal(cos_i: f64, index: Complex) -> f64 {
    let sin2_i = 1.0 - cos_i * cos_i;
    let one = |factor: f64| Complex(factor, 0.0);
    let cos_t = one(1.0).minus(one(sin2_i).over(index.times(index))).root();
    let ratio = |a: Complex, b: Complex| a.minus(b).norm() / a.plus(b).norm();
    let perpendicular = ratio(one(cos_i), index.times(cos_t));
    let parallel = ratio(index.times(one(cos_i)), cos_t);
    (perpendicular + parallel) / 2.0
}

#[derive(Clone, Copy)]
struct Complex(f64, f64);

impl Complex {
    fn plus(self, other: Complex) -> Complex {
        Complex(self.0 + other.0, self.1 + other.1)
    }

    fn minus(self, other: Complex) -> Complex {
        Complex(self.0 - other.0, self.1 - other.1)
    }

    fn times(self, other: Complex) -> Complex {
        Complex(
            self.0 * other.0 - self.1 * other.1,
            self.0 * other.1 + self.1 * other.0,
        )
    }

    fn over(self, other: Complex) -> Complex {
        let Complex(re, im) = self.times(Complex(other.0, -other.1));
        Complex(re / other.norm(), im / other.norm())
    }

    /// The square of the modulus.
    fn norm(self) -> f64 {
        self.0 * self.0 + self.1 * self.1
    }

    /// The root with the real part that is not negative.
    fn root(self) -> Complex {
        let modulus = self.norm().sqrt();
        let re = ((modulus + self.0) / 2.0).max(0.0).sqrt();
        let im = ((modulus - self.0) / 2.0).max(0.0).sqrt();
        Complex(re, im.copysign(self.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresnel_agrees_with_the_special_angles() {
        let (normal, cos_t) = dielectric(1.0, 1.5);
        assert!((normal - 0.04).abs() < 1e-15 && cos_t == 1.0);
        // At Brewster's angle tanθ = η the parallel part vanishes and the perpendicular one is ((1−η²)/(1+η²))².
        let eta: f64 = 1.5;
        let (brewster, _) = dielectric(eta.atan().cos(), eta);
        let perpendicular = ((1.0 - eta * eta) / (1.0 + eta * eta)).powi(2);
        assert!((brewster - perpendicular / 2.0).abs() < 1e-15);
        // The critical angle from inside is asin(1/1.5) = 41.81°.
        assert!(dielectric(41.9f64.to_radians().cos(), 1.0 / 1.5).0 == 1.0);
        assert!(dielectric(41.7f64.to_radians().cos(), 1.0 / 1.5).0 < 1.0);
    }

    #[test]
    fn metal_agrees_with_its_closed_forms() {
        // At normal incidence ((η−1)² + k²) / ((η+1)² + k²).
        let (eta, k) = (vec3(0.2, 0.9, 1.1), vec3(3.9, 2.4, 0.0));
        let seen = conductor(1.0, eta, k);
        for channel in 0..3 {
            let (n, k) = (eta.get(channel), k.get(channel));
            let expected = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
            assert!((seen.get(channel) - expected).abs() < 1e-15);
        }
        // Without absorption it is a dielectric, total reflection and all.
        for step in 0..=20 {
            let cos = f64::from(step) / 20.0;
            let seen = conductor(cos, vec3(1.5, 0.61, 2.4), Rgb::ZERO);
            for (channel, eta) in [1.5, 0.61, 2.4].into_iter().enumerate() {
                assert!((seen.get(channel) - dielectric(cos, eta).0).abs() < 1e-14);
            }
        }
        // At grazing incidence everything is reflected.
        assert!((conductor(0.0, eta, k) - Rgb::ONE).abs().max_component() < 1e-15);
    }
}
