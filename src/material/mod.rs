//! What surfaces do with light: an `enum` of BSDFs, whose `eval` (value and density) and `sample` belong together.
//!
//! Directions point away from the surface: `wo` towards the eye, `wi` towards the light. `eval` gives f·|cos θi|, so
//! that nothing divides by the cosine.

mod blinn_phong;
mod conductor;
mod dielectric;
mod lambert;
mod microfacet;
mod oren_nayar;
mod rough_dielectric;
mod texture;

use crate::color::{Albedo, Radiance};
use crate::geom::Dir;
use crate::num::{Uniform, Wide};
use crate::sampler::warp;

pub use blinn_phong::BlinnPhong;
pub use conductor::{Conductor, Index, fresnel_conductor};
pub use dielectric::{Dielectric, fresnel_dielectric};
pub use oren_nayar::{OrenNayar, OrenNayarModel};
pub use rough_dielectric::RoughDielectric;
pub use texture::{Filter, Texels, Texture, TextureError};

/// The material of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Reflects nothing: lights that are only lights.
    Black,
    /// Ideal diffuse reflection; black from behind unless two-sided.
    Lambert { albedo: Albedo, two_sided: bool },
    /// Ideal mirror with a colour; black from behind unless two-sided.
    Mirror { reflectance: Albedo, two_sided: bool },
    /// Smooth boundary between two media.
    Dielectric(Dielectric),
    /// Rough diffuse reflection.
    OrenNayar(OrenNayar),
    /// Diffuse reflection and a lobe about the half vector.
    BlinnPhong(BlinnPhong),
    /// A metal, smooth or rough.
    Conductor(Conductor),
    /// Rough boundary between two media.
    RoughDielectric(RoughDielectric),
}

/// What is wrong with a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialError {
    /// A reflectance or a transmittance is above 1.
    Reflectance,
    /// σ of [`OrenNayar`] is above a quarter turn.
    Sigma,
    /// The exponent of [`BlinnPhong`] is negative or above 16384.
    Exponent,
    /// A roughness is above 1 or under 2^-10.
    Roughness,
    /// A rough boundary whose refractive indices differ by less than 1/128: it would neither reflect nor refract.
    Index,
}

impl core::fmt::Display for MaterialError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Reflectance => "a reflectance is above 1",
            Self::Sigma => "its sigma is above a quarter turn",
            Self::Exponent => "its exponent is not within 0 to 16384",
            Self::Roughness => "its alpha is not within 1/1024 to 1; take a smooth material for less",
            Self::Index => {
                "its two refractive indices are closer than 1/128; make them differ, or leave the surface out"
            }
        })
    }
}

impl core::error::Error for MaterialError {}

/// What of the surface a BSDF needs to know.
#[derive(Clone, Copy, Debug)]
pub struct Local {
    /// Geometric normal of the shape, as it stands (not turned to the eye).
    pub normal: Dir,
    /// Towards where the path came from.
    pub wo: Dir,
}

/// A direction drawn from a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    pub wi: Dir,
    /// f·|cos θi| / pdf.
    pub weight: Radiance,
    /// Per solid angle; [`Wide::ZERO`] for a direction drawn from a delta distribution.
    pub pdf: Wide,
    /// Squared ratio of refractive indices crossed (eye's side over the other), 1 for reflection: Russian roulette
    /// takes it back, since radiance in the denser medium is larger by it.
    pub eta_squared: Wide,
}

impl BsdfSample {
    /// Drawn from a delta distribution: no light sample can hit it.
    pub const fn is_specular(&self) -> bool {
        self.pdf.is_zero()
    }
}

/// A direction drawn from a BSDF; what it is worth is told when that is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    pub wi: Dir,
    worth: Worth,
}

#[derive(Clone, Copy, Debug)]
enum Worth {
    /// Of ideal diffuse reflection: the cosine is enough to tell.
    Diffuse { albedo: Albedo, cos: i32 },
    /// Of all others, found out by the way.
    Told {
        weight: Radiance,
        pdf: Wide,
        eta_squared: Wide,
    },
}

/// A density, which is seldom asked for: where a path meets a light.
#[derive(Clone, Copy, Debug)]
pub enum Density {
    Told(Wide),
    /// Of a direction drawn about a normal by its cosine, Q16.
    Cosine(i32),
}

impl Density {
    #[inline]
    pub fn tell(self) -> Wide {
        match self {
            Density::Told(pdf) => pdf,
            Density::Cosine(cos) => warp::pdf_cosine_hemisphere(cos),
        }
    }
}

impl Drawn {
    /// The sample's density.
    #[inline]
    pub fn density(&self) -> Density {
        match self.worth {
            Worth::Diffuse { cos, .. } => Density::Cosine(cos),
            Worth::Told { pdf, .. } => Density::Told(pdf),
        }
    }

    #[inline]
    pub fn weigh(self) -> BsdfSample {
        match self.worth {
            Worth::Diffuse { albedo, cos } => lambert::weigh(albedo, cos, self.wi),
            Worth::Told {
                weight,
                pdf,
                eta_squared,
            } => BsdfSample {
                wi: self.wi,
                weight,
                pdf,
                eta_squared,
            },
        }
    }
}

impl From<BsdfSample> for Drawn {
    #[inline]
    fn from(sample: BsdfSample) -> Drawn {
        let BsdfSample {
            wi,
            weight,
            pdf,
            eta_squared,
        } = sample;
        Drawn {
            wi,
            worth: Worth::Told {
                weight,
                pdf,
                eta_squared,
            },
        }
    }
}

impl Material {
    /// Two-sided diffuse.
    pub const fn lambert(albedo: Albedo) -> Material {
        Material::Lambert {
            albedo,
            two_sided: true,
        }
    }

    /// Two-sided mirror.
    pub const fn mirror(reflectance: Albedo) -> Material {
        Material::Mirror {
            reflectance,
            two_sided: true,
        }
    }

    /// Whether everything is within its range.
    pub fn is_valid(&self) -> bool {
        self.check().is_ok()
    }

    /// What of it is out of range, if anything is.
    pub fn check(&self) -> Result<(), MaterialError> {
        match self {
            Material::Black => Ok(()),
            Material::Lambert { albedo, .. }
            | Material::Mirror {
                reflectance: albedo, ..
            } => {
                if albedo.is_valid() {
                    Ok(())
                } else {
                    Err(MaterialError::Reflectance)
                }
            }
            Material::Dielectric(dielectric) => dielectric.check(),
            Material::OrenNayar(diffuse) => diffuse.check(),
            Material::BlinnPhong(phong) => phong.check(),
            Material::Conductor(metal) => metal.check(),
            Material::RoughDielectric(glass) => glass.check(),
        }
    }

    /// Whether light samples can contribute: the BSDF is not a delta distribution alone.
    #[inline]
    pub const fn is_smooth(&self) -> bool {
        match self {
            Material::Black | Material::Mirror { .. } | Material::Dielectric(_) => false,
            Material::Conductor(metal) => metal.is_rough(),
            Material::Lambert { .. }
            | Material::OrenNayar(_)
            | Material::BlinnPhong(_)
            | Material::RoughDielectric(_) => true,
        }
    }

    /// How much of white light it gives back, by colour: what a denoiser divides by.
    pub fn albedo(&self) -> Albedo {
        match self {
            Material::Black => Albedo::BLACK,
            Material::Lambert { albedo, .. }
            | Material::Mirror {
                reflectance: albedo, ..
            } => *albedo,
            Material::Dielectric(_) | Material::RoughDielectric(_) => Albedo::WHITE,
            Material::OrenNayar(diffuse) => diffuse.reflectance(),
            Material::BlinnPhong(phong) => phong.albedo(),
            Material::Conductor(metal) => metal.albedo(),
        }
    }

    /// The same with its own colour multiplied by another: what a matt part, or a mirror or metal, gives back. Glass has none.
    pub fn tinted(&self, tint: Albedo) -> Material {
        match *self {
            Material::Black | Material::Dielectric(_) | Material::RoughDielectric(_) => *self,
            Material::Lambert { albedo, two_sided } => Material::Lambert {
                albedo: albedo.times(tint),
                two_sided,
            },
            Material::Mirror {
                reflectance,
                two_sided,
            } => Material::Mirror {
                reflectance: reflectance.times(tint),
                two_sided,
            },
            Material::OrenNayar(diffuse) => Material::OrenNayar(diffuse.tinted(tint)),
            Material::BlinnPhong(phong) => Material::BlinnPhong(phong.tinted(tint)),
            Material::Conductor(metal) => Material::Conductor(metal.tinted(tint)),
        }
    }

    /// f·|cos θi| and the density with which [`Self::sample`] would draw `wi`; `None` where no light is scattered.
    #[inline]
    pub fn eval(&self, local: &Local, wi: Dir) -> Option<(Radiance, Wide)> {
        match self {
            Material::Lambert { albedo, two_sided } => lambert::eval(*albedo, *two_sided, local, wi),
            Material::OrenNayar(diffuse) => diffuse.eval(local, wi),
            Material::BlinnPhong(phong) => phong.eval(local, wi),
            Material::Conductor(metal) => metal.eval(local, wi),
            Material::RoughDielectric(glass) => glass.eval(local, wi),
            Material::Black | Material::Mirror { .. } | Material::Dielectric(_) => None,
        }
    }

    /// The density alone with which [`Self::sample`] would draw `wi`; 0 where no light is scattered.
    #[inline]
    pub fn pdf(&self, local: &Local, wi: Dir) -> Wide {
        match self {
            Material::Lambert { two_sided, .. } => lambert::pdf(*two_sided, local, wi),
            _ => self.eval(local, wi).map_or(Wide::ZERO, |(_, pdf)| pdf),
        }
    }

    /// The squared ratio of refractive indices crossed between two directions, the one's of `wi` over that of `wo`; 1 on
    /// one side.
    ///
    /// It turns what [`Self::eval`] and [`Self::sample`] say of radiance into what they say of light on its way from `wo`
    /// to `wi` (Veach 1997, equation 5.14).
    #[inline]
    pub fn eta_squared(&self, local: &Local, wi: Dir) -> Wide {
        let side = |w: Dir| w.dot_q24(local.normal) >= 0;
        let eta = match self {
            Material::Dielectric(glass) => glass.eta(),
            Material::RoughDielectric(glass) => glass.eta(),
            _ => return Wide::ONE,
        };
        if side(local.wo) == side(wi) {
            return Wide::ONE;
        }
        let eta = Wide::from_q16(eta.to_bits());
        let squared = eta * eta;
        if side(wi) { squared.recip() } else { squared }
    }

    /// Whether light is reflected as well one way as the other, but for [`Self::eta_squared`].
    #[inline]
    pub fn is_reciprocal(&self) -> bool {
        !matches!(self, Material::BlinnPhong(phong) if !phong.is_normalized())
    }

    /// The normal on the eye's side, if [`Self::draw`] takes directions with the density of a cosine about it
    /// ([`warp::sample_cosine_hemisphere`] in [`Frame::about`]).
    ///
    /// [`warp::sample_cosine_hemisphere`]: crate::sampler::warp::sample_cosine_hemisphere
    /// [`Frame::about`]: crate::geom::Frame::about
    #[inline]
    pub fn diffuse_normal(&self, local: &Local) -> Option<Dir> {
        match self {
            Material::Lambert { two_sided, .. } => facing(*two_sided, local),
            Material::OrenNayar(diffuse) => facing(diffuse.is_two_sided(), local),
            _ => None,
        }
    }

    /// [`Self::eval`] where [`Self::diffuse_normal`] is known.
    #[inline]
    pub fn eval_about(&self, normal: Dir, wo: Dir, wi: Dir) -> Option<(Radiance, Wide)> {
        match self {
            Material::Lambert { albedo, .. } => lambert::eval_about(*albedo, normal, wi),
            _ => self.eval(&Local { normal, wo }, wi),
        }
    }

    /// A direction drawn by two uniform numbers, and one more to choose a lobe; `None` where light is absorbed.
    #[inline]
    pub fn sample(&self, local: &Local, u: [Uniform; 2], lobe: Uniform) -> Option<BsdfSample> {
        self.draw(local, u, lobe).map(Drawn::weigh)
    }

    /// [`Self::sample`] for who may not ask what the direction is worth.
    #[inline]
    pub fn draw(&self, local: &Local, u: [Uniform; 2], lobe: Uniform) -> Option<Drawn> {
        let sample = match self {
            Material::Black => return None,
            Material::Lambert { albedo, two_sided } => return lambert::draw(*albedo, *two_sided, local, u),
            Material::Mirror {
                reflectance,
                two_sided,
            } => {
                if local.wo.dot(local.normal) <= 0 && !two_sided {
                    return None;
                }
                Some(BsdfSample {
                    wi: local.wo.reflect(local.normal),
                    weight: Radiance::WHITE.mul_albedo(*reflectance),
                    pdf: Wide::ZERO,
                    eta_squared: Wide::ONE,
                })
            }
            Material::Dielectric(dielectric) => dielectric.sample(local, lobe),
            Material::OrenNayar(diffuse) => diffuse.sample(local, u),
            Material::BlinnPhong(phong) => phong.sample(local, u, lobe),
            Material::Conductor(metal) => metal.sample(local, u),
            Material::RoughDielectric(glass) => glass.sample(local, u, lobe),
        };
        sample.map(Drawn::from)
    }
}

/// The normal on the eye's side; `None` behind a one-sided surface.
#[inline]
fn facing(two_sided: bool, local: &Local) -> Option<Dir> {
    if local.wo.dot_q24_normal(local.normal) > 0 {
        Some(local.normal)
    } else if two_sided {
        Some(-local.normal)
    } else {
        None
    }
}
