//! Where light from infinitely far away begins its paths: on a ball around all finite shapes.
//!
//! A direction is drawn, then a place on the disk that faces it and covers the ball; the ray begins where it enters the
//! ball (Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th ed., sections 12.2 and 12.5). Infinite planes
//! reach out of every ball. What no such ray reaches first, beside the disk or before the ball, has a density of 0, which the
//! other strategies' weights then know.

use super::Scene;
use crate::color::Radiance;
use crate::geom::{Dir, FAR, Frame, Offset, Point, Ray};
use crate::light::Emission;
use crate::num::{Uniform, Wide, isqrt, mul_q16};
use crate::sampler::warp;

/// A ball that holds all finite shapes, with more to spare than distances are rounded by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    center: Point,
    /// Units, under 2^23.
    radius: i32,
    /// Of the disk that covers it, units².
    disk: Wide,
}

impl Ball {
    /// Around a box.
    pub fn around((low, high): (Point, Point)) -> Ball {
        let half = low.to(high).normalize().map_or(0, |(_, norm)| norm.length() / 2);
        // Lengths are right to 3.7e-5.
        let radius = half + (half >> 13) + 2;
        let wide = Wide::new(radius as u32, 0);
        Ball {
            center: Point([0, 1, 2].map(|i| (low.0[i] + high.0[i]) >> 1)),
            radius,
            disk: wide * wide * Wide::PI,
        }
    }

    /// Where light that comes from `wi` enters, evenly over the disk.
    fn enter(&self, wi: Dir, u: [Uniform; 2]) -> Point {
        let [x, y] = warp::sample_disk(u);
        let square = |c: i32| c.unsigned_abs().min(0xffff).pow(2);
        let z = isqrt(!square(x).saturating_add(square(y))) as i32;
        let outward = Frame::about(wi).to_world(Dir([x, y, z]));
        Point([0, 1, 2].map(|i| self.center.0[i] + mul_q16(self.radius, outward.0[i])))
    }

    /// Whether light from `wi` that arrives at a point came through the ball, or would on its way from there.
    fn lies_before(&self, point: Point, wi: Dir) -> bool {
        let from = self.center.to(point);
        let is_within = |offset: Offset| {
            offset
                .normalize()
                .is_none_or(|(_, norm)| norm.length() <= self.radius)
        };
        if is_within(from) {
            return true;
        }
        let along = from.dot(wi);
        let across = Offset([0, 1, 2].map(|i| from.0[i] - mul_q16(along, wi.0[i])));
        along < 0 && is_within(across)
    }
}

impl Scene<'_> {
    /// A ray of light that arrives from `wi`, where `light` is the radiance over the direction's density `pdf` (or for
    /// parallel light the irradiance, and 1); `None` if there is nothing finite to send it to, or a plane in its way.
    pub(super) fn emit_from(
        &self,
        wi: Dir,
        light: Radiance,
        pdf: Wide,
        place: [Uniform; 2],
    ) -> Option<Emission> {
        let ball = self.ball?;
        let origin = ball.enter(wi, place);
        if self.planes_occlude(&Ray { origin, dir: wi }, FAR, usize::MAX) {
            return None;
        }
        Some(Emission {
            ray: Ray { origin, dir: -wi },
            power: light.scale(ball.disk),
            density: pdf / ball.disk,
            triangle: 0,
        })
    }

    /// The density, units⁻², of the place at which light from `wi` that is the first to reach a point begins; 0 where
    /// [`Self::emit`] begins no such path.
    pub fn distant_density(&self, point: Point, wi: Dir) -> Wide {
        match &self.ball {
            Some(ball) if ball.lies_before(point, wi) => ball.disk.recip(),
            _ => Wide::ZERO,
        }
    }

    /// Of a ray of [`Self::emit_from`], the direction's density.
    pub(super) fn distant_pdf(&self, emission: &Emission) -> Wide {
        self.ball.map_or(Wide::ZERO, |ball| emission.density * ball.disk)
    }
}
