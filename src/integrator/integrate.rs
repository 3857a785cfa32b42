use super::{First, first};
use crate::camera::FilmPlane;
use crate::color::Radiance;
use crate::geom::Ray;
use crate::sampler::Sampler;
use crate::scene::{Ahead, Hit, Scene};

/// How light is followed: what comes back along one camera ray, and what arrives elsewhere in the picture meanwhile.
pub trait Integrator {
    /// Whether its light arrives anywhere in the picture, so that tiles alone would lose it.
    const NEEDS_SPLATS: bool = false;

    /// One sample of the radiance that comes back along `ray`, a ray of `view`'s film.
    ///
    /// Draws from the sampler from where the camera left it. What arrives elsewhere goes to `splats`, so that a pixel's
    /// light is the sum of what both brought, over the samples a pixel. `rays` counts what was asked of the scene,
    /// nearest hits and shadow rays.
    fn radiance(
        &self,
        view: &View,
        ray: Ray,
        sampler: &mut impl Sampler,
        splats: &mut impl SplatSink,
        rays: &mut u32,
    ) -> Radiance;

    /// The same sample in a tile, with what its path met first: for a denoiser.
    ///
    /// Unless the integrator knows better, that is what [`first`] finds along the ray.
    fn sense(&self, view: &View, ray: Ray, sampler: &mut impl Sampler, rays: &mut u32) -> (Radiance, First) {
        let light = self.radiance(view, ray, sampler, &mut NoSplats, rays);
        (light, first(view.scene, view.ahead.seen, ray, rays))
    }
}

/// A scene as a picture of it is taken.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    pub scene: &'a Scene<'a>,
    pub film: &'a FilmPlane,
    /// What is ahead of the camera's rays that are asked for.
    pub ahead: Ahead,
}

impl<'a> View<'a> {
    /// For any of the film's rays.
    pub fn new(scene: &'a Scene<'a>, film: &'a FilmPlane) -> View<'a> {
        View {
            scene,
            film,
            ahead: Ahead::ANY,
        }
    }

    /// The first thing that a ray of the camera meets.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.scene.closest_among(ray, self.ahead.seen)
    }
}

/// The whole picture, for light that arrives anywhere in it: a sum a pixel, in whatever order.
pub trait SplatSink {
    /// Whether there is one: an integrator counts on it, or weighs its strategies without.
    const EXISTS: bool;

    /// Adds light to pixel (x, y); one that is not in the picture is left out.
    fn add(&mut self, x: u16, y: u16, light: Radiance);
}

/// No frame: tiles are all there is.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSplats;

impl SplatSink for NoSplats {
    const EXISTS: bool = false;

    fn add(&mut self, _: u16, _: u16, _: Radiance) {}
}
