use super::{BsdfSample, Drawn, Local, Worth, facing};
use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, Frame};
use crate::num::{Uniform, Wide};
use crate::sampler::warp;

/// f·cos θi = ρ/π · cos θi, density cos θi / π.
#[inline]
pub(super) fn eval(albedo: Albedo, two_sided: bool, local: &Local, wi: Dir) -> Option<(Radiance, Wide)> {
    eval_about(albedo, facing(two_sided, local)?, wi)
}

/// The same about the normal on the eye's side.
#[inline]
pub(super) fn eval_about(albedo: Albedo, normal: Dir, wi: Dir) -> Option<(Radiance, Wide)> {
    let cos = wi.dot_normal(normal);
    if cos <= 0 {
        return None;
    }
    let pdf = warp::pdf_cosine_hemisphere(cos);
    Some((Radiance::from_albedo(albedo, pdf), pdf))
}

/// The density of [`eval`].
#[inline]
pub(super) fn pdf(two_sided: bool, local: &Local, wi: Dir) -> Wide {
    facing(two_sided, local).map_or(Wide::ZERO, |normal| warp::pdf_cosine_hemisphere(wi.dot(normal)))
}

/// Cosine-distributed about the normal: the weight is the reflectance.
#[inline]
pub(super) fn draw(albedo: Albedo, two_sided: bool, local: &Local, u: [Uniform; 2]) -> Option<Drawn> {
    let normal = facing(two_sided, local)?;
    let drawn = warp::sample_cosine_hemisphere(u);
    Some(Drawn {
        wi: Frame::turn(normal, drawn),
        worth: Worth::Diffuse {
            albedo,
            cos: drawn.0[2],
        },
    })
}

/// What a direction of [`draw`] is worth.
#[inline]
pub(super) fn weigh(albedo: Albedo, cos: i32, wi: Dir) -> BsdfSample {
    BsdfSample {
        wi,
        weight: Radiance::from_albedo(albedo, Wide::ONE),
        pdf: warp::pdf_cosine_hemisphere(cos),
        eta_squared: Wide::ONE,
    }
}
