//! What a point on a ball or on the floor shows: light with its shadows, and the rays that go on from it.

use microlux::num::isqrt;

use super::scene::{BALLS, ENTER, LEAVE, LIGHTS, Light, Material, SQUARES, Vector, dot};
use super::{DEPTH, Inside, Ray, Station, Sum, inverse_length, shorten};

/// A place on a ball, and the ray that came there.
#[derive(Clone, Copy)]
pub(super) struct Hit {
    /// Index into [`BALLS`].
    pub ball: usize,
    /// From its centre, Q13.
    pub place: Vector,
    pub ray: Ray,
}

impl Hit {
    /// Adds what the place shows by its own, sends rays on, and returns what the one outside the ball meets.
    pub fn shade(self, sum: &mut Sum, inside: &mut Inside) -> Option<Hit> {
        let ball = &BALLS[self.ball];
        let Ray { dir, weight, depth } = self.ray;
        let normal = self.place.map(|c| (c * ball.inverse + (1 << 12)) >> 13);
        let point = [0, 1, 2].map(|k| ball.center[k] + ((self.place[k] + 2) >> 2));
        let from = Station::new(point, self.ball);
        let cos = dot(dir, normal) >> 15;
        let mirrored = [0, 1, 2].map(|k| dir[k] - ((cos * normal[k]) >> 14));
        let material = &ball.material;
        highlights(sum, &from, normal, mirrored, material, weight);

        // One of the two goes on outside, the other inside.
        let refracted = if material.glass > 0 {
            refract(dir, normal, cos)
        } else {
            dir
        };
        let on = |dir, share| Ray {
            dir,
            weight: (weight * share) >> 15,
            depth: depth + 1,
        };
        let rays = [on(mirrored, material.mirror), on(refracted, material.glass)];
        let [out, into] = if cos < 0 { rays } else { [rays[1], rays[0]] };
        if depth == DEPTH {
            for ray in rays {
                sum.sky(ray.weight, ray.dir[1]);
            }
            return None;
        }
        if into.weight > 0 {
            inside.push(self.across(normal, into));
        }
        if out.weight > 0 {
            return sum.outside(&from, out);
        }
        None
    }

    /// Where a ray into the ball comes out of it.
    fn across(self, normal: Vector, ray: Ray) -> Hit {
        let ball = &BALLS[self.ball];
        // The chord, Q13: at most twice the radius.
        let chord = -2 * ball.radius * (dot(normal, ray.dir) >> 17);
        let place = [0, 1, 2].map(|k| self.place[k] + ((chord * (ray.dir[k] >> 1)) >> 14));
        Hit { place, ray, ..self }
    }
}

/// Diffuse light and highlights of all lights at a point of a ball.
fn highlights(
    sum: &mut Sum,
    from: &Station,
    normal: Vector,
    mirrored: Vector,
    material: &Material,
    weight: i32,
) {
    let (mut matt, mut gloss) = (0, 0);
    let is_matt = material.matt[0] > 0;
    for light in &LIGHTS {
        let v = to_light(light, from.point);
        let cos = dot(v, normal);
        if cos <= 0 {
            continue;
        }
        let inverse = inverse_length(v);
        let dir = shorten(v, inverse);
        let shine = dot(dir, mirrored) >> 15;
        if (is_matt || shine > material.dull) && !from.shadowed(dir) {
            matt += ((((cos >> 16) * inverse) >> 15) * light.intensity) >> 14;
            if shine > material.dull {
                gloss += (power(shine, material.exponent) * light.intensity) >> 14;
            }
        }
    }
    if is_matt {
        sum.matt(matt, weight, &material.matt);
    }
    sum.gloss(gloss, weight, material.gloss);
}

/// Light on the floor, Q13.
pub(super) fn diffuse(from: &Station) -> i32 {
    let mut sum = 0;
    for light in &LIGHTS {
        let v = to_light(light, from.point);
        let dir = shorten(v, inverse_length(v));
        if !from.shadowed(dir) {
            sum += (dir[1] * light.intensity) >> 14;
        }
    }
    sum
}

/// The colour of the floor's square.
pub(super) fn chequer(point: Vector) -> Vector {
    // Squares are two units wide: halves of Q11 coordinates, rounded towards zero where z is negative.
    SQUARES[(((point[0] >> 12) + (-point[2] >> 12)) & 1) as usize]
}

/// The way to a light, Q9: 40 to 76 long.
fn to_light(light: &Light, point: Vector) -> Vector {
    [0, 1, 2].map(|k| (light.place[k] - point[k]) >> 2)
}

/// x^n in Q15, for x in Q15, at most 1.
fn power(x: i32, n: u32) -> i32 {
    // In Q16, rounded to nearest: 65535² and a half are under 2^32.
    let times = |a: u32, b: u32| (a * b + (1 << 15)) >> 16;
    let (mut square, mut result, mut rest) = ((2 * x as u32).min(0xffff), 0xffff, n);
    loop {
        if rest & 1 == 1 {
            result = times(result, square);
        }
        rest >>= 1;
        if rest == 0 {
            return (result >> 1) as i32;
        }
        square = times(square, square);
    }
}

/// The refracted direction; `cos` is that of the ray to the normal, Q15, negative from outside.
fn refract(dir: Vector, normal: Vector, cos: i32) -> Vector {
    let [eta, square] = if cos < 0 { ENTER } else { LEAVE };
    let sine = ((1 << 30) - cos * cos).max(0) >> 15;
    // The other cosine, squared, Q29; a ball's far side has no total reflection, but for the rounding.
    let other = ((1 << 29) - square * sine).max(0);
    let root = isqrt(2 * other as u32) as i32;
    let along = ((eta * cos.abs()) >> 14) - root;
    let along = if cos < 0 { along } else { -along };
    [0, 1, 2].map(|k| (eta * dir[k] + ((along * normal[k]) >> 1)) >> 14)
}
