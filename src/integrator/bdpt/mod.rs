//! Bidirectional path tracing: light is followed from the camera and from the lights, and every vertex of one way is
//! joined to every vertex of the other.

mod camera;
mod connect;
mod light;
mod subpath;
mod weight;

use super::{First, Integrator, NoSplats, NoWitness, SplatSink, View, Witness};
use crate::color::Radiance;
use crate::geom::Ray;
use crate::num::Wide;
use crate::sampler::Sampler;
use heapless::Vec;
pub(super) use light::LightWalk;

/// Bidirectional path tracing, with all connections of which the camera's end is a pixel's own; and, where there is a
/// whole frame to add to, of light subpaths with the lens.
///
/// Lafortune and Willems, "Bi-Directional Path Tracing", Compugraphics 1993; Veach, "Robust Monte Carlo Methods for Light
/// Transport Simulation", 1997, chapter 10. Weights are in `weight`.
///
/// A camera subpath of up to `N` vertices that light can be connected to is kept; light subpaths are followed a vertex
/// at a time. Paths of up to [`Self::FULL_DEPTH`] segments are found by every strategy there is; what is longer by
/// those of path tracing alone, so that `N` costs memory and noise, never light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bdpt<const N: usize = 8> {
    /// Paths of at most this many segments: 1 for emission only, 2 for direct light.
    pub max_depth: u16,
    /// From this many segments on, Russian roulette may end a subpath.
    pub rr_depth: u16,
    /// The camera itself sees through lights that are shapes (up to 8 in a row), and no environment.
    pub hide_emitters: bool,
}

/// How a path was found: by how many vertices from a light and from the camera, the lens counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Strategy {
    pub light: u16,
    pub camera: u16,
}

/// Who wants to know what each strategy found.
pub trait Tally {
    /// Whether light subpaths are connected with the lens.
    const SPLATS: bool;

    /// Whether every connection is wanted, even one whose weight leaves next to nothing of it.
    const ALL: bool = false;

    /// Light for the pixel at hand, before its weight.
    fn gather(&mut self, strategy: Strategy, light: Radiance, weight: Wide);

    /// Light for another pixel.
    fn splat(&mut self, strategy: Strategy, pixel: (u16, u16), light: Radiance, weight: Wide);

    /// Who is told of what the camera's path meets.
    #[inline(always)]
    fn witness(&mut self) -> impl Witness {
        NoWitness
    }
}

/// The sum that makes a picture.
struct Sum<'a, F, W> {
    light: Radiance,
    splats: &'a mut F,
    witness: W,
}

impl<F: SplatSink, W: Witness> Tally for Sum<'_, F, W> {
    const SPLATS: bool = F::EXISTS;

    #[inline]
    fn gather(&mut self, _: Strategy, light: Radiance, weight: Wide) {
        self.light = self.light.add(light.scale(weight));
    }

    #[inline]
    fn splat(&mut self, _: Strategy, (x, y): (u16, u16), light: Radiance, weight: Wide) {
        self.splats.add(x, y, light.scale(weight));
    }

    #[inline(always)]
    fn witness(&mut self) -> impl Witness {
        &mut self.witness
    }
}

impl Bdpt {
    /// With memory for 8 vertices; roulette from the fifth segment on, as [`super::Path`].
    pub const fn new(max_depth: u16) -> Bdpt {
        Bdpt::with_capacity(max_depth)
    }
}

impl<const N: usize> Integrator for Bdpt<N> {
    #[inline]
    fn radiance(
        &self,
        view: &View,
        ray: Ray,
        sampler: &mut impl Sampler,
        splats: &mut impl SplatSink,
        rays: &mut u32,
    ) -> Radiance {
        let mut sum = Sum {
            light: Radiance::BLACK,
            splats,
            witness: NoWitness,
        };
        self.follow(view, ray, sampler, &mut sum, rays);
        sum.light
    }

    fn sense(&self, view: &View, ray: Ray, sampler: &mut impl Sampler, rays: &mut u32) -> (Radiance, First) {
        let mut sum = Sum {
            light: Radiance::BLACK,
            splats: &mut NoSplats,
            witness: First::new(),
        };
        self.follow(view, ray, sampler, &mut sum, rays);
        (sum.light, sum.witness.settled(view, ray, rays))
    }
}

impl<const N: usize> Bdpt<N> {
    /// Segments of the longest path that every strategy looks for.
    pub const FULL_DEPTH: u16 = N as u16 + 2;

    /// The same as [`Bdpt::new`] with memory for `N` vertices.
    pub const fn with_capacity(max_depth: u16) -> Bdpt<N> {
        Bdpt {
            max_depth,
            rr_depth: 5,
            hide_emitters: false,
        }
    }

    /// One sample: a camera subpath along `ray`, a light subpath, and what joins them.
    ///
    /// Draws as [`super::Path`] does; then for the light subpath which light (1-D), the place (2-D) and the direction
    /// (2-D), and at each of its vertices a place on the lens (2-D) if there is one, roulette of the
    /// connections (1-D), lobe (1-D), direction (2-D) and roulette (1-D). In tiles there is no light subpath where the camera's has no vertex to connect it with.
    pub fn follow<'a>(
        &self,
        view: &View<'a>,
        ray: Ray,
        sampler: &mut impl Sampler,
        tally: &mut impl Tally,
        rays: &mut u32,
    ) {
        let mut vertices = Vec::new();
        let found = self.camera_subpath(view, ray, sampler, tally, rays, &mut vertices);
        LightWalk {
            full: self.max_depth.min(Self::FULL_DEPTH),
            rr_depth: self.rr_depth,
            hide_emitters: self.hide_emitters,
            found,
        }
        .follow(view, sampler, tally, rays, &vertices);
    }
}
