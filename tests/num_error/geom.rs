//! Directions, frames and products of `geom` against f64: what their documentation says, held both ways.

use crate::figures::{Figures, Mean, Random, Said};
use microlux::geom::{Dir, Frame, Offset};

type Vector = [f64; 3];

fn unit(d: Dir) -> Vector {
    d.0.map(|c| f64::from(c) / 65536.0)
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    let minor = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

fn length(v: Vector) -> f64 {
    dot(v, v).sqrt()
}

/// The angle between two vectors, right also where it is tiny.
fn angle(a: Vector, b: Vector) -> f64 {
    let (a, b) = (a.map(|c| c / length(a)), b.map(|c| c / length(b)));
    let apart = length([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
    2.0 * (apart / 2.0).asin()
}

/// Offsets of every size and shape: along axes, in planes, of components as different as they can be.
fn offsets() -> impl Iterator<Item = Offset> {
    let mut random = Random(11);
    let edges = [0, 1, -1, 3, 0x7fff, 0x8000, -0x8000, i32::MAX, i32::MIN];
    let corners = (0..729).map(move |i| Offset([i % 9, i / 9 % 9, i / 81].map(|at: usize| edges[at])));
    let any = (0..500_000).map(move |i| {
        let most = 1 + i % 32;
        Offset(if i % 3 == 0 {
            [0; 3].map(|_| random.signed(32))
        } else {
            [0; 3].map(|_| random.bits() as i32 >> (32 - most))
        })
    });
    corners.chain(any)
}

/// Directions, evenly and near the axes.
fn directions() -> impl Iterator<Item = Dir> {
    offsets().filter_map(|o| Dir::new(o.0))
}

#[test]
fn normalizing() {
    let [mut turned, mut one, mut long, mut square] = [(); 4].map(|()| Figures::default());
    for offset in offsets() {
        let exact = offset.0.map(f64::from);
        let Some((dir, norm)) = offset.normalize() else {
            assert_eq!(offset.0, [0; 3]);
            continue;
        };
        turned.add(angle(unit(dir), exact));
        one.add(length(unit(dir)) - 1.0);
        let l = length(exact);
        // Rounded down, from what the 15 bits gave.
        let short = f64::from(norm.length()) - l;
        if l < 2f64.powi(31) {
            assert!(
                (-1.0 - 3.7e-5 * l..=3.7e-5 * l).contains(&short),
                "{offset:?}: {short}"
            );
        }
        if (2f64.powi(20)..2f64.powi(31)).contains(&l) {
            long.add(short / l);
        }
        let s = norm.square();
        square.add(f64::from(s.mantissa()) * 2f64.powi(i32::from(s.exponent()) - 15) / (l * l) - 1.0);
    }
    turned.assert(
        "normalize, angle",
        Said {
            max: 1.3e-5,
            rms: 5.9e-6,
            mean: Mean::Is(5.2e-6),
        },
    );
    one.assert(
        "normalize, length of the direction",
        Said {
            max: 4.6e-5,
            rms: 9.6e-6,
            mean: Mean::Within(1e-7),
        },
    );
    long.assert(
        "Norm::length, relative",
        Said {
            max: 3.7e-5,
            rms: 1.1e-5,
            mean: Mean::Within(2e-7),
        },
    );
    square.assert(
        "Norm::square, relative",
        Said {
            max: 8.4e-5,
            rms: 1.8e-5,
            mean: Mean::Within(2e-7),
        },
    );
}

#[test]
fn products() {
    let mut random = Random(12);
    let [mut q16, mut q24, mut along, mut one, mut turned, mut crossed] =
        [(); 6].map(|()| Figures::default());
    let all: Vec<Dir> = directions().collect();
    for a in &all {
        let b = all[random.below(all.len() as u32) as usize];
        let cosine = dot(unit(*a), unit(b));
        // Away from zero counts as positive: that is what would brighten.
        q16.add((f64::from(a.dot(b)) / 65536.0 - cosine) * cosine.signum());
        q24.add(f64::from(a.dot_q24(b)) - cosine * 2f64.powi(24));
        let offset = Offset([0; 3].map(|_| random.signed(24)));
        along.add(f64::from(offset.dot(b)) - dot(offset.0.map(f64::from), unit(b)));
        let n = unit(b);
        let reflected = a.reflect(b);
        let exact = [0, 1, 2].map(|i| 2.0 * cosine * n[i] - unit(*a)[i]);
        one.add(length(unit(reflected)) - 1.0);
        turned.add(angle(unit(reflected), exact));
        let across = cross(unit(*a), n);
        match a.cross(b) {
            Some(dir) => crossed.add(angle(unit(dir), across)),
            None => assert!(across.iter().all(|c| c.abs() < 2f64.powi(-10) + 2f64.powi(-29))),
        }
    }
    q16.assert(
        "Dir::dot",
        Said {
            max: 7.7e-6,
            rms: 4.3e-6,
            mean: Mean::Within(2e-8),
        },
    );
    q24.assert(
        "Dir::dot_q24, ulp",
        Said {
            max: 1.0,
            rms: 0.57,
            mean: Mean::Is(-0.48),
        },
    );
    along.assert(
        "Offset::dot, units",
        Said {
            max: 3.0,
            rms: 1.45,
            mean: Mean::Is(-1.3),
        },
    );
    one.assert(
        "Dir::reflect, length",
        Said {
            max: 1.75e-4,
            rms: 2.2e-5,
            mean: Mean::Within(1e-7),
        },
    );
    crossed.assert(
        "Dir::cross, angle",
        Said {
            max: 1.3e-5,
            rms: 6e-6,
            mean: Mean::Is(5.3e-6),
        },
    );
    turned.assert(
        "Dir::reflect, angle",
        Said {
            max: 3.4e-5,
            rms: 1.25e-5,
            mean: Mean::Is(1.1e-5),
        },
    );
}

#[test]
fn frames() {
    let [mut right, mut one, mut there, mut local] = [(); 4].map(|()| Figures::default());
    let all: Vec<Dir> = directions()
        .chain([Dir([0, 0, -65536]), Dir::X, Dir::Y, Dir::Z])
        .collect();
    let mut random = Random(13);
    for n in &all {
        let frame = Frame::about(*n);
        let (s, t, n) = (unit(frame.s), unit(frame.t), unit(frame.n));
        for (a, b) in [(s, t), (s, n), (t, n)] {
            right.add(dot(a, b));
        }
        one.add(length(s) - 1.0);
        one.add(length(t) - 1.0);
        assert!(angle(cross(s, t), n) < 1e-3, "{frame:?} is left-handed");
        let d = all[random.below(all.len() as u32) as usize];
        let w = unit(d);
        let exact = [0, 1, 2].map(|i| w[0] * s[i] + w[1] * t[i] + w[2] * n[i]);
        let world = unit(frame.to_world(d));
        for i in 0..3 {
            there.add(world[i] - exact[i]);
        }
        let back = unit(frame.to_local(d));
        for (i, axis) in [s, t, n].into_iter().enumerate() {
            local.add(back[i] - dot(w, axis));
        }
    }
    right.assert(
        "Frame::about, cosine of two axes",
        Said {
            max: 1.12e-4,
            rms: 1.4e-5,
            mean: Mean::Is(1.8e-6),
        },
    );
    one.assert(
        "Frame::about, length of a tangent",
        Said {
            max: 4e-5,
            rms: 8.6e-6,
            mean: Mean::Is(5.2e-6),
        },
    );
    there.assert(
        "Frame::to_world, a component",
        Said {
            max: 7.7e-6,
            rms: 4.2e-6,
            mean: Mean::Within(2e-8),
        },
    );
    local.assert(
        "Frame::to_local, a component",
        Said {
            max: 7.7e-6,
            rms: 4.2e-6,
            mean: Mean::Within(2e-8),
        },
    );
}
