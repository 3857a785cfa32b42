//! Rays to random rectangles: in assembly on ARMv6-M, by the portable code elsewhere.

use microlux::{
    geom::{Dir, FAR, Point, Ray},
    num::Crc,
    shape::Rectangle,
};

use crate::random::Xorshift;

const RECTANGLES: u32 = 240;
const RAYS: u32 = 24;
/// Most of the rays have to meet theirs.
const FEWEST: u32 = RECTANGLES * RAYS / 4;

/// Along axes, about one, and turned anyhow, from a unit to 2^22 large; rays from far and near, from behind and from the plane,
/// to all of the rectangle, its rim, past it and along it; limits about the distance that is met, and others.
pub(crate) fn run() -> u32 {
    let mut random = Xorshift::new(0x6c07_8965);
    let mut crc = Crc::new();
    let mut met = 0;
    for round in 0..RECTANGLES {
        let Some(rectangle) = rectangle(&mut random, round) else {
            continue;
        };
        for number in 0..RAYS {
            if let Some(ray) = ray(&mut random, &rectangle, number) {
                met += u32::from(look(&mut crc, &mut random, &rectangle, &ray));
            }
        }
    }
    if met < FEWEST { 0 } else { crc.value() }
}

fn below(random: &mut Xorshift, end: u32) -> u32 {
    (random.u32() >> 8) % end
}

/// Of up to so many bits, either sign.
fn signed(random: &mut Xorshift, bits: u32) -> i32 {
    random.u32() as i32 >> (32 - bits)
}

fn any(random: &mut Xorshift, bits: u32) -> [i32; 3] {
    [(); 3].map(|()| signed(random, bits))
}

fn rectangle(random: &mut Xorshift, round: u32) -> Option<Rectangle> {
    let axes = [Dir::X, Dir::Y, Dir::Z];
    let axis = (round / 8 % 3) as usize;
    let [along, a, b] = [0, 1, 2].map(|next| axes[(axis + next) % 3]);
    let mut either = |dir: Dir| if random.u32() >> 31 == 0 { dir } else { -dir };
    let (along, a, b) = (either(along), either(a), either(b));
    // Turned about the axis, a little or anyhow.
    let bits = 1 + below(random, 17);
    let [x, y] = [65_536, 0].map(|c| c + signed(random, bits));
    let turned = Dir::new([0, 1, 2].map(|i| (a.0[i] * (x >> 8) + b.0[i] * (y >> 8)) >> 8))?;
    let (u, v) = match round % 8 {
        0 => (a, b),
        1 => (b, a),
        // Upright, its sides along no axis.
        2 => (turned, along.cross(turned)?),
        3 => (along.cross(turned)?, turned),
        // One side along the axis.
        4 => (along, turned),
        5 => (turned, along),
        6 => (Dir::new(any(random, 17))?, turned),
        _ => (Dir::new(any(random, 17))?, Dir::new(any(random, 17))?),
    };
    let spread = 2 + below(random, 22);
    let half = [(); 2].map(|()| 1 + (random.u32() >> (10 + below(random, 22))) as i32);
    let center = Point(any(random, spread));
    let mut rectangle = Rectangle::new(center, u, v, half)?;
    if round % 8 < 2 {
        // As a scene that is written down has it.
        (rectangle.u, rectangle.v) = (u, v);
    }
    // Within what a scene's check lets pass: not quite an axis.
    if round % 61 == 60 {
        rectangle.normal.0[axis] -= 3;
        rectangle.u.0[axis] += 2;
    }
    Some(rectangle)
}

fn ray(random: &mut Xorshift, rectangle: &Rectangle, number: u32) -> Option<Ray> {
    let Rectangle {
        center,
        u,
        v,
        normal,
        half,
    } = *rectangle;
    let on = |random: &mut Xorshift| {
        let [a, b] = half.map(|half| {
            let share = match number % 4 {
                // Its rim, to a few units.
                0 => 65_536 * (1 - 2 * (random.u32() >> 31) as i32),
                // Past it, perhaps.
                1 => signed(random, 18),
                _ => signed(random, 17),
            };
            ((i64::from(half) * i64::from(share)) >> 16) as i32 + signed(random, 3)
        });
        center.along(u, a).along(v, b)
    };
    let to = on(random);
    let from = match number % 8 {
        // From the plane, or a little off it.
        5 => on(random).along(normal, signed(random, 4)),
        // From where only a plane lies.
        6 => Point(any(random, 30)),
        7 => center.along(normal, signed(random, 25)),
        _ => {
            let bits = 3 + number + below(random, 3);
            Point(any(random, bits))
        }
    };
    let along = |dir: Dir| if number & 1 == 0 { dir } else { -dir };
    let dir = match number {
        16 => along(u),
        17 => along(v),
        18 | 19 => along(normal),
        // Nearly along it, and away.
        20 => Dir(u.0.map(|c| c + signed(random, 4))),
        21 => -from.to(to).normalize()?.0,
        22 => [Dir::X, -Dir::Y, Dir::Z][below(random, 3) as usize],
        _ => from.to(to).normalize()?.0,
    };
    let origin = if matches!(number, 18 | 22) {
        to.along(dir, signed(random, 24))
    } else {
        from
    };
    Some(Ray { origin, dir })
}

/// Whether it is met at all.
#[inline(never)]
fn look(crc: &mut Crc, random: &mut Xorshift, rectangle: &Rectangle, ray: &Ray) -> bool {
    let mut at = |t_max: i32| {
        let t = rectangle.intersect(ray, t_max);
        crc.word(t.unwrap_or(-1) as u32);
        t
    };
    let met = at(i32::MAX);
    let t = met.unwrap_or((random.u32() >> 3) as i32);
    for t_max in [
        t - 1,
        t,
        t + 1,
        t + (t >> 7),
        FAR,
        FAR + 1,
        (random.u32() >> 20) as i32,
        0,
        -1,
    ] {
        at(t_max);
    }
    met.is_some()
}
