//! What path tracing cannot find in the scene `spheres`: light of the point that comes by its mirror or its glass ball
//! first. No ray meets a point, and no light sample goes through a ball.
//!
//! A light tracer in f64 for this one scene, with formulas of its own: of the scene it shares the numbers, of the
//! renderers nothing.

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a + t b.
fn along(a: V, t: f64, b: V) -> V {
    [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]]
}

fn unit(a: V) -> V {
    let length = dot(a, a).sqrt();
    a.map(|c| c / length)
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Matt(V),
    Mirror(V),
    Glass,
}

/// Center, radius, and what it is of.
const BALLS: [(V, f64, Kind); 3] = [
    ([-1.15, 0.5, 0.1], 0.5, Kind::Matt([0.62, 0.22, 0.12])),
    ([0.1, 0.7, -0.9], 0.7, Kind::Mirror([0.95, 0.93, 0.88])),
    ([0.95, 0.45, 0.6], 0.45, Kind::Glass),
];
const FLOOR: Kind = Kind::Matt([0.45, 0.45, 0.42]);
const LAMP: V = [-1.5, 3.2, 2.6];
const INTENSITY: V = [16.0, 14.5, 12.0];
const EYE: V = [0.0, 1.6, 5.2];
const TARGET: V = [0.0, 0.55, 0.0];
const FIELD: f64 = 34.0;
const ETA: f64 = 1.5;
const NEAR: f64 = 1e-9;

/// The nearest surface: distance, outward normal, kind.
fn nearest(from: V, way: V) -> Option<(f64, V, Kind)> {
    let mut best = None;
    let mut closest = f64::INFINITY;
    let t = -from[1] / way[1];
    if t > NEAR && t.is_finite() {
        (closest, best) = (t, Some((t, [0.0, 1.0, 0.0], FLOOR)));
    }
    for (center, radius, kind) in BALLS {
        let to = along(from, -1.0, center);
        let (b, c) = (dot(to, way), dot(to, to) - radius * radius);
        let root = (b * b - c).sqrt();
        for t in [-b - root, -b + root] {
            // Not a number fails both.
            if t > NEAR && t < closest {
                let normal = along(along(from, t, way), -1.0, center).map(|n| n / radius);
                (closest, best) = (t, Some((t, normal, kind)));
            }
        }
    }
    best
}

/// SplitMix64, in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly over all directions, by rejection.
    fn way(&mut self) -> V {
        loop {
            let v = [0; 3].map(|_| 2.0 * self.next() - 1.0);
            let square = dot(v, v);
            if square > 1e-6 && square < 1.0 {
                return unit(v);
            }
        }
    }
}

/// Onward by a mirror or through glass, as chance has it: Snell's law and Fresnel's, unpolarised. `None` if matt.
fn onward(way: V, normal: V, kind: Kind, power: &mut V, random: &mut Random) -> Option<V> {
    let across = dot(way, normal);
    match kind {
        Kind::Matt(_) => None,
        Kind::Mirror(tint) => {
            *power = [0, 1, 2].map(|i| power[i] * tint[i]);
            Some(along(way, -2.0 * across, normal))
        }
        Kind::Glass => {
            let (ratio, facing) = if across < 0.0 {
                (1.0 / ETA, normal)
            } else {
                (ETA, normal.map(|n| -n))
            };
            let cos = across.abs();
            let square = 1.0 - ratio * ratio * (1.0 - cos * cos);
            let reflected = along(way, -2.0 * across, normal);
            if square <= 0.0 {
                return Some(reflected);
            }
            let inner = square.sqrt();
            // n1/n2 = ratio.
            let s = (ratio * cos - inner) / (ratio * cos + inner);
            let p = (ratio * inner - cos) / (ratio * inner + cos);
            if random.next() < 0.5 * (s * s + p * p) {
                return Some(reflected);
            }
            Some(along(way.map(|c| ratio * c), ratio * cos - inner, facing))
        }
    }
}

/// By how much the mean of a square picture's pixels (and channels) exceeds that of path tracing, of paths up to `depth`
/// segments whose last surface the camera sees by itself; and how much of it is light that two matt surfaces or more
/// have passed on. From `count` paths.
///
/// What comes to the eye by mirror or glass as well is missing: there nothing finds the brightest of it either.
pub fn mean(count: u32, depth: u32, seed: u64) -> [f64; 2] {
    let mut random = Random(seed);
    let forward = unit(along(TARGET, -1.0, EYE));
    let right = unit([-forward[2], 0.0, forward[0]]);
    let up = [
        right[1] * forward[2] - right[2] * forward[1],
        right[2] * forward[0] - right[0] * forward[2],
        right[0] * forward[1] - right[1] * forward[0],
    ];
    let half = (FIELD / 2.0).to_radians().tan();
    let mut sums = [0.0; 2];
    for _ in 0..count {
        let (mut from, mut way) = (LAMP, random.way());
        let mut power = INTENSITY.map(|i| 4.0 * std::f64::consts::PI * i);
        let mut matt = 0;
        for segment in 1..depth {
            let Some((t, normal, kind)) = nearest(from, way) else {
                break;
            };
            from = along(from, t, way);
            if let Some(on) = onward(way, normal, kind, &mut power, &mut random) {
                way = on;
                continue;
            }
            // Found by path tracing: the lamp sees a matt surface.
            let Kind::Matt(tint) = kind else { break };
            if segment == 1 {
                break;
            }
            matt += 1;
            power = [0, 1, 2].map(|i| power[i] * tint[i]);
            let to = along(EYE, -1.0, from);
            let distance = dot(to, to).sqrt();
            let to_eye = to.map(|c| c / distance);
            let (cos, ahead) = (dot(to_eye, normal), -dot(to_eye, forward));
            let place = [right, up].map(|axis| -dot(to_eye, axis) / ahead);
            let clear = || nearest(from, to_eye).is_none_or(|(t, ..)| t > distance);
            if cos > 0.0 && ahead > 0.0 && place.iter().all(|p| p.abs() < half) && clear() {
                // Lambert's radiance, and the film's 4 tan² at distance 1 seen under cos³/d².
                let radiance = power.iter().sum::<f64>() / 3.0 / std::f64::consts::PI * cos;
                let measured = radiance / (4.0 * half * half * ahead.powi(3) * distance * distance);
                sums[0] += measured;
                if matt > 1 {
                    sums[1] += measured;
                }
            }
            // Onward by Lambert's law: a point of the unit ball's surface that touches here.
            way = unit(along(random.way(), 1.0, normal));
        }
    }
    sums.map(|sum| sum / f64::from(count))
}
