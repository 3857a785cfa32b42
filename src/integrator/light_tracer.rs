use super::bdpt::LightWalk;
use super::{Integrator, SplatSink, Strategy, Tally, View};
use crate::color::Radiance;
use crate::geom::Ray;
use crate::num::Wide;
use crate::sampler::Sampler;

/// Light tracing: paths from the lights alone, each surface on the way connected with the lens.
///
/// Arvo, "Backward Ray Tracing", SIGGRAPH course notes 12, 1986; Dutré and Willems, "Importance-driven Monte Carlo Light
/// Tracing", 1994. What the camera sees of the lights themselves comes back along its own rays. Mirrors and glass are
/// black in it, since no path from a light meets the lens by them; and so is what a constant environment lights, and on
/// infinite planes what skies and parallel light reach beside a ball about all finite shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightTracer {
    /// Paths of at most this many segments: 1 for emission only, 2 for direct light.
    pub max_depth: u16,
    /// From this many segments on, Russian roulette may end a path.
    pub rr_depth: u16,
    /// The camera sees through lights that are shapes (up to 8 in a row), and no environment.
    pub hide_emitters: bool,
}

impl LightTracer {
    /// Roulette from the fifth segment on, as [`super::Path`].
    pub const fn new(max_depth: u16) -> LightTracer {
        LightTracer {
            max_depth,
            rr_depth: 5,
            hide_emitters: false,
        }
    }
}

/// One strategy has all the weight.
struct Unweighted<'a, F>(&'a mut F);

impl<F: SplatSink> Tally for Unweighted<'_, F> {
    const SPLATS: bool = true;

    fn gather(&mut self, _: Strategy, _: Radiance, _: Wide) {}

    #[inline]
    fn splat(&mut self, _: Strategy, (x, y): (u16, u16), light: Radiance, _: Wide) {
        self.0.add(x, y, light);
    }
}

impl Integrator for LightTracer {
    const NEEDS_SPLATS: bool = true;

    /// Draws for the light's path as [`super::Bdpt`] does.
    fn radiance(
        &self,
        view: &View,
        ray: Ray,
        sampler: &mut impl Sampler,
        splats: &mut impl SplatSink,
        rays: &mut u32,
    ) -> Radiance {
        LightWalk {
            full: self.max_depth,
            rr_depth: self.rr_depth,
            hide_emitters: self.hide_emitters,
            found: Wide::ZERO,
        }
        .follow(view, sampler, &mut Unweighted(splats), rays, &[]);
        if self.hide_emitters || self.max_depth == 0 {
            return Radiance::BLACK;
        }
        *rays = rays.wrapping_add(1);
        match view.closest(&ray) {
            Some(hit) => view.scene.vertex(&ray, &hit).emission,
            None => view.scene.background(ray.dir),
        }
    }
}
