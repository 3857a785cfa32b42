//! The tracer of raystones in 32-bit integers: no float, no division, no product wider than 32 bits, no recursion.
//!
//! | what | format | bound |
//! |---|---|---|
//! | point, way to a centre | Q11 | 31 a coordinate, 23 long: 2^16 |
//! | direction, normal | Q15 | longer or shorter than 1 by under 2^-11 |
//! | way along a ray | Q26 | 23 · 2^26 < 2^31, as each partial sum of the dot product is |
//! | place on a ball, from its centre | Q13 | 4 · 2^13 = 2^15: its square is Q26 |
//! | weight, share | Q15 | 1 |
//! | light of a pixel | Q16 | 60, and cut at 1 in the end |
//!
//! Where the C program starts each ray 10^-3 off the surface, here a ray leaves by name: outside it cannot meet the ball that
//! it stands on, inside it meets nothing else.

// Shares a file between programs of which some do not need all of it.
#![allow(dead_code)]

pub mod scene;
mod surface;

use microlux::num::{isqrt, leading_zeros, short_recip, short_rsqrt};

use scene::{BALLS, Ball, FAR, FLOOR, HEIGHT, LEVEL, NEAR, SCREEN, SKY, Vector, WIDE, WIDTH, dot};
use surface::{Hit, chequer};

/// 1 in Q15.
const ONE: i32 = 1 << 15;
/// Rays after the camera's; those that come later are sky.
const DEPTH: u32 = 2;

/// Red, green and blue of the pixel in column `x` and row `y`, from the upper left corner.
pub fn pixel(x: i32, y: i32) -> [u8; 3] {
    // Half pixels, Q8: |v|² is between 2^28 and 2^31.
    let v = [(2 * x + 1 - WIDTH) << 8, (HEIGHT - 2 * y - 1) << 8, -SCREEN];
    let mut sum = Sum::default();
    sum.follow(shorten(v, inverse_length(v)));
    sum.pixel()
}

/// 2^31/|v| to 2^-14, for |v|² in 2^28 .. 2^31.
fn inverse_length(v: Vector) -> i32 {
    let square = dot(v, v) as u32;
    if square < 1 << 30 {
        2 * short_rsqrt(4 * square) as i32
    } else {
        short_rsqrt(square) as i32
    }
}

/// v/|v| in Q15, to nearest, by what [`inverse_length`] says: each product is 2^31 times a component that is less than 1.
fn shorten(v: Vector, inverse: i32) -> Vector {
    v.map(|c| (c * inverse + (1 << 15)) >> 16)
}

/// What light a pixel has got.
#[derive(Default)]
struct Sum {
    /// Of matt surfaces, red, green and blue, Q16.
    matt: Vector,
    /// Of highlights, white, Q16.
    gloss: i32,
    /// Of the sky, in shares of its light straight above, Q15.
    sky: u32,
}

impl Sum {
    /// The camera's ray, and all that come of it.
    fn follow(&mut self, dir: Vector) {
        let eye = Ray {
            dir,
            weight: ONE,
            depth: 0,
        };
        let mut next = self.outside(&EYE, eye);
        let mut inside = Inside::default();
        while let Some(hit) = next.or_else(|| inside.pop()) {
            next = hit.shade(self, &mut inside);
        }
    }

    /// Follows a ray that is in no ball, to the ball that it meets first. Floor and sky end it.
    fn outside(&mut self, from: &Station, ray: Ray) -> Option<Hit> {
        let hit = from.first(ray);
        if hit.is_none() {
            match floor(from.point, ray.dir) {
                Some(point) => self.floor(point, ray.weight),
                None => self.sky(ray.weight, ray.dir[1]),
            }
        }
        hit
    }

    fn floor(&mut self, point: Vector, weight: i32) {
        let from = Station::new(point, BALLS.len());
        let light = surface::diffuse(&from);
        self.matt(light, weight, &chequer(point));
    }

    /// Adds diffuse light, Q13 and under 6, times a weight and a colour.
    fn matt(&mut self, light: i32, weight: i32, colour: &Vector) {
        let light = (light * weight) >> 15;
        for (sum, share) in self.matt.iter_mut().zip(colour) {
            *sum += (light * share) >> 12;
        }
    }

    /// Adds a highlight, Q13 and under 6, times a weight and one in Q10, at most 10.
    fn gloss(&mut self, light: i32, weight: i32, gloss: i32) {
        self.gloss += (((light * weight) >> 15) * gloss) >> 7;
    }

    /// Adds the sky in a direction of this height, which rounding may have brought under −1.
    fn sky(&mut self, weight: i32, height: i32) {
        self.sky += (weight as u32 * (ONE + height).max(0) as u32) >> 16;
    }

    fn pixel(&self) -> [u8; 3] {
        [0, 1, 2].map(|k| {
            // The sky's weights are at most 1 in all.
            let sky = (self.sky * SKY[k] as u32) >> 13;
            let light = self.matt[k] + self.gloss + sky as i32;
            ((light.min(1 << 16) * 255) >> 16) as u8
        })
    }
}

/// A ray whose start is known.
#[derive(Clone, Copy)]
struct Ray {
    dir: Vector,
    weight: i32,
    depth: u32,
}

/// Hits inside a ball whose turn has not come: at most one for each ray on the way.
#[derive(Default)]
struct Inside {
    hits: [Option<Hit>; DEPTH as usize],
}

impl Inside {
    fn push(&mut self, hit: Hit) {
        if let Some(free) = self.hits.iter_mut().find(|hit| hit.is_none()) {
            *free = Some(hit);
        }
    }

    fn pop(&mut self) -> Option<Hit> {
        self.hits.iter_mut().rev().find_map(Option::take)
    }
}

/// A point that rays start from, and the balls as it sees them: worked out once for all its rays.
struct Station {
    point: Vector,
    seen: [Seen; BALLS.len()],
}

/// A ball as seen from a point.
#[derive(Clone, Copy)]
struct Seen {
    /// The way to its centre, Q11.
    to: Vector,
    /// A ray misses the ball if the square of its way to the point nearest the centre is less, Q22.
    ///
    /// The squared distance less r² and [`MARGIN`]; under 512 in this scene, 0 in the ball. The largest number for a ball
    /// that no ray from here meets.
    clear: u32,
}

/// What the rounding of the way (under 0.03) and a direction's length (23² · 2^-11) may do to its square, Q22: 1/2.
const MARGIN: i32 = 1 << 21;

const EYE: Station = Station::new([0; 3], BALLS.len());

impl Station {
    /// `on` is the ball that the point lies on, if there is one of that number.
    const fn new(point: Vector, on: usize) -> Station {
        let mut seen = [Seen {
            to: [0; 3],
            clear: u32::MAX,
        }; BALLS.len()];
        let mut i = 0;
        while i < BALLS.len() {
            let c = &BALLS[i].center;
            let to = [c[0] - point[0], c[1] - point[1], c[2] - point[2]];
            seen[i].to = to;
            if i != on {
                // The squares may be more than 2^31, less r² they are not.
                let square = (to[0] * to[0])
                    .wrapping_add(to[1] * to[1])
                    .wrapping_add(to[2] * to[2]);
                let clear = square.wrapping_sub((BALLS[i].square() >> 4) + MARGIN);
                seen[i].clear = if clear < 0 { 0 } else { clear as u32 };
            }
            i += 1;
        }
        Station { point, seen }
    }

    /// The balls that a ray may meet, which few of those are that it misses, and the way along it.
    fn near(&self, dir: Vector) -> impl Iterator<Item = (usize, i32)> {
        self.seen.iter().enumerate().filter_map(move |(i, seen)| {
            let along = dot(seen.to, dir);
            let way = along >> 15;
            (way > 0 && (way * way) as u32 >= seen.clear).then_some((i, along))
        })
    }

    /// The hit nearest the start.
    fn first(&self, ray: Ray) -> Option<Hit> {
        let mut nearest = i32::MAX;
        let mut hit = None;
        for (ball, along) in self.near(ray.dir) {
            let pass = Pass::new(&BALLS[ball], self.seen[ball].to, ray.dir, along);
            if pass.depth < 0 {
                continue;
            }
            let half = isqrt(pass.depth as u32) as i32;
            let way = (along >> 13) - half;
            if way < nearest {
                nearest = way;
                // −(pass.to + half · dir), rounded to nearest.
                let place = [0, 1, 2].map(|k| -pass.to[k] - ((half * ray.dir[k] + (1 << 14)) >> 15));
                hit = Some(Hit { ball, place, ray });
            }
        }
        hit
    }

    /// Whether a ball stands between the point and a light.
    fn shadowed(&self, dir: Vector) -> bool {
        self.near(dir)
            .any(|(ball, along)| Pass::new(&BALLS[ball], self.seen[ball].to, dir, along).depth >= 0)
    }
}

/// How a ray passes a ball's centre.
struct Pass {
    /// From the ray's nearest point to the centre, Q13; under 4.2, as [`Station::near`] says.
    to: Vector,
    /// r² less that way's square, Q26: negative for a miss, else half the way through the ball, squared.
    depth: i32,
}

impl Pass {
    /// The way along the ray may be rounded: what that moves the nearest point by counts only squared.
    fn new(ball: &Ball, to: Vector, dir: Vector, along: i32) -> Pass {
        let way = along >> 15;
        let to = [0, 1, 2].map(|k| ((to[k] << 15) - way * dir[k] + (1 << 12)) >> 13);
        Pass {
            to,
            depth: ball.square() - dot(to, to),
        }
    }
}

/// Where a ray from above meets the floor. Without a division, unless it does.
fn floor(point: Vector, dir: Vector) -> Option<Vector> {
    let down = -dir[1];
    if down < LEVEL {
        return None;
    }
    // Coordinates times `down`, Q26; a point and its height make a vector under 31.
    let height = point[1] - FLOOR;
    let x = point[0] * down + height * dir[0];
    let z = point[2] * down + height * dir[2];
    if x.abs() >= WIDE * down || z >= NEAR * down || z <= FAR * down {
        return None;
    }
    // height · 2^15/down, Q11: under 40, and its products with dir are ways on the floor.
    let zeros = leading_zeros(down as u32) - 16;
    let half = 1 << (15 - zeros);
    let way = (height * short_recip((down as u32) << zeros) + half) >> (16 - zeros);
    let [x, z] = [0, 2].map(|k| point[k] + ((way * dir[k] + (1 << 14)) >> 15));
    Some([x, FLOOR, z])
}
