//! The solids as their formulas say, in f64, and a root finder that knows nothing of the core's.

use microlux::geom::{Dir, Point};
use microlux::shape::{
    Blob, Bound, Capsule, Gyroid, Implicit, MAX_BLOBS, Metaballs, RoundedBox, SmoothUnion, Torus,
};

pub type Vec3 = [f64; 3];

pub fn dot(a: Vec3, b: Vec3) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| a[i] - b[i])
}

pub fn along(a: Vec3, d: Vec3, t: f64) -> Vec3 {
    [0, 1, 2].map(|i| a[i] + t * d[i])
}

pub fn scaled(a: Vec3, s: f64) -> Vec3 {
    a.map(|c| c * s)
}

pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub fn point(Point(p): Point) -> Vec3 {
    p.map(f64::from)
}

/// As its components stand.
pub fn dir(Dir(d): Dir) -> Vec3 {
    d.map(|c| f64::from(c) / 65536.0)
}

pub fn unit(v: Vec3) -> Vec3 {
    scaled(v, 1.0 / norm(v))
}

/// A solid, with what it is made of.
#[derive(Clone)]
pub struct Case {
    pub name: &'static str,
    pub solid: Implicit,
    pub blobs: Vec<Blob>,
}

fn segment(blob: &Blob, p: Vec3) -> f64 {
    let (a, b) = (point(blob.a), point(blob.b));
    let (ab, ap) = (sub(b, a), sub(p, a));
    let square = dot(ab, ab);
    let s = if square > 0.0 {
        (dot(ap, ab) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    norm(sub(ap, scaled(ab, s))) - f64::from(blob.radius)
}

pub fn frame(x: Dir, y: Dir) -> [Vec3; 3] {
    let (x, y) = (unit(dir(x)), unit(dir(y)));
    let y = unit(sub(y, scaled(x, dot(x, y))));
    [x, y, cross(x, y)]
}

impl Case {
    fn parts(&self, first: u16, count: u16) -> &[Blob] {
        &self.blobs[first as usize..(first + count) as usize]
    }

    /// f, units (metaballs: as it is).
    pub fn f(&self, p: Vec3) -> f64 {
        match self.solid {
            Implicit::Torus(Torus {
                center,
                axis,
                major,
                minor,
                ..
            }) => {
                let (v, axis) = (sub(p, point(center)), unit(dir(axis)));
                let h = dot(v, axis);
                let rho = norm(sub(v, scaled(axis, h)));
                (rho - f64::from(major)).hypot(h) - f64::from(minor)
            }
            Implicit::Capsule(capsule) => segment(&capsule.into(), p),
            Implicit::RoundedBox(RoundedBox {
                center,
                x,
                y,
                half,
                radius,
            }) => {
                let v = sub(p, point(center));
                let r = f64::from(radius);
                let axes = frame(x, y);
                let d = [0, 1, 2].map(|i| dot(v, axes[i]).abs() - (f64::from(half[i]) - r));
                norm(d.map(|c| c.max(0.0))) + d[0].max(d[1]).max(d[2]).min(0.0) - r
            }
            Implicit::Gyroid(Gyroid {
                center,
                x,
                y,
                cell,
                thickness,
                bound,
            }) => {
                let v = sub(p, point(center));
                let q = frame(x, y).map(|axis| dot(v, axis));
                let cell = f64::from(cell);
                let a = q.map(|c| c / cell * std::f64::consts::TAU);
                let g = a[0].sin() * a[1].cos() + a[1].sin() * a[2].cos() + a[2].sin() * a[0].cos();
                let bound = match bound.radius() {
                    Some(radius) => norm(q) - f64::from(radius),
                    None => (0..3)
                        .map(|i| q[i].abs() - f64::from(bound.half()[i]))
                        .fold(f64::MIN, f64::max),
                };
                (cell / (3.0 * std::f64::consts::PI) * g.abs() - f64::from(thickness) / 2.0).max(bound)
            }
            Implicit::Metaballs(balls) => {
                let kernel = |ball: &Blob| {
                    let v = sub(p, point(ball.a));
                    (1.0 - dot(v, v) / f64::from(ball.radius).powi(2))
                        .max(0.0)
                        .powi(3)
                };
                let sum: f64 = self.parts(balls.first, balls.count).iter().map(kernel).sum();
                f64::from(balls.threshold()) / f64::from(1 << 27) - sum
            }
            Implicit::SmoothUnion(union) => {
                let k = f64::from(union.k);
                let parts = self.parts(union.first, union.count);
                parts
                    .iter()
                    .map(|part| segment(part, p))
                    .reduce(|a, b| a.min(b) - (k - (a - b).abs()).max(0.0).powi(2) / (4.0 * k))
                    .unwrap()
            }
        }
    }

    /// The most that f changes a unit.
    pub fn lipschitz(&self) -> f64 {
        match self.solid {
            Implicit::Gyroid(_) => 2.0 / 3f64.sqrt(),
            Implicit::Metaballs(balls) => {
                let parts = self.parts(balls.first, balls.count);
                parts.iter().map(|ball| 1.7174 / f64::from(ball.radius)).sum()
            }
            _ => 1.0,
        }
    }

    /// ∇f, normalised, by central differences over `step` units.
    pub fn normal(&self, p: Vec3, step: f64) -> Vec3 {
        unit([0, 1, 2].map(|i| {
            let mut d = [0.0; 3];
            d[i] = step;
            self.f(along(p, d, 1.0)) - self.f(along(p, d, -1.0))
        }))
    }

    /// Middle of the box around it, and the radius of a ball about it that holds the box.
    pub fn ball(&self) -> (Vec3, f64) {
        let (low, high) = self.solid.bounds(&self.blobs);
        let (low, high) = (point(low), point(high));
        let center = [0, 1, 2].map(|i| 0.5 * (low[i] + high[i]));
        (center, norm(sub(high, center)))
    }

    /// The first change of side along a ray after `start`: steps of what f leaves free, no less than 2^-17 of the extent.
    pub fn first(&self, origin: Vec3, d: Vec3, start: f64) -> Option<f64> {
        let (center, radius) = self.ball();
        let to = sub(center, origin);
        let t0 = dot(to, d) / dot(d, d);
        let aside = norm(sub(to, scaled(d, t0)));
        if aside > radius {
            return None;
        }
        let half = (radius * radius - aside * aside).sqrt() * 1.001 + 1.0;
        let (mut t, end) = ((t0 - half).max(start), t0 + half);
        let f = |t: f64| self.f(along(origin, d, t));
        let inside = f(t) <= 0.0;
        let steep = self.lipschitz() * 1.0001;
        while t < end {
            let next = t + (f(t).abs() / steep).max(radius / 131072.0);
            if (f(next) <= 0.0) != inside {
                let (mut near, mut far) = (t, next);
                while far - near > 1e-9 * radius {
                    let middle = 0.5 * (near + far);
                    if (f(middle) <= 0.0) == inside {
                        near = middle
                    } else {
                        far = middle
                    }
                }
                return Some(0.5 * (near + far));
            }
            t = next;
        }
        None
    }
}

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as u32
    }

    /// 0 ..< 1.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.bits()) / f64::from(u32::MAX)
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Evenly on the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = [0; 3].map(|_| self.between(-1.0, 1.0));
            if (0.01..1.0).contains(&dot(v, v)) {
                return unit(v);
            }
        }
    }

    pub fn dir(&mut self) -> Dir {
        let v = self.direction();
        Dir::new(v.map(|c| (c * 1e8) as i32)).unwrap()
    }
}

/// One of each kind in each size, somewhere and turned somehow; `size` is about the reach, units.
pub fn cases(random: &mut Random, size: f64) -> Vec<Case> {
    let u = |share: f64| (share * size) as i32;
    let center = Point([0; 3].map(|_| (random.between(-1.0, 1.0) * (4e6 - 1.9 * size).max(0.0)) as i32));
    let add = |p: Vec3| Point([0, 1, 2].map(|i| center.0[i] + (p[i] * size) as i32));
    let (x, y) = (random.dir(), random.dir());
    let case = |name, solid: Implicit| Case {
        name,
        solid,
        blobs: Vec::new(),
    };
    let balls = vec![
        Blob::ball(add([0.0, 0.0, 0.0]), u(0.45)),
        Blob::ball(add([0.35, 0.1, 0.0]), u(0.4)),
        Blob::ball(add([-0.2, 0.3, 0.25]), u(0.35)),
        Blob::ball(add([0.1, -0.4, 0.2]), u(0.3)),
    ];
    let threshold = 0.2 * f64::from(1 << 27);
    let meta = Metaballs::new(&balls, 1, 3, threshold as u32);
    let parts = vec![
        Blob::ball(add([-0.3, 0.0, 0.0]), u(0.3)),
        Blob::ball(add([0.3, 0.1, 0.1]), u(0.25)),
        Capsule::new(add([0.0, -0.4, 0.0]), add([0.1, 0.5, -0.3]), u(0.1)).into(),
    ];
    let union = SmoothUnion::new(&parts, 0, 3, u(0.2));
    let tilted = RoundedBox::new(center, x, y, [u(0.5), u(0.7), u(0.3)], u(0.08)).unwrap();
    assert!(balls.len() <= MAX_BLOBS);
    vec![
        case("torus", Implicit::Torus(Torus::new(center, x, u(0.7), u(0.25)))),
        case(
            "thin torus",
            Implicit::Torus(Torus::new(center, x, u(0.9), u(0.03))),
        ),
        case(
            "capsule",
            Implicit::Capsule(Capsule::new(
                add([-0.5, -0.4, 0.3]),
                add([0.5, 0.3, -0.2]),
                u(0.2),
            )),
        ),
        case("rounded box", Implicit::RoundedBox(tilted)),
        case(
            "gyroid in a ball",
            Implicit::Gyroid(Gyroid::new(center, [x, y], u(0.7), u(0.09), Bound::ball(u(0.9))).unwrap()),
        ),
        case(
            "gyroid in a block",
            Implicit::Gyroid(
                Gyroid::new(
                    center,
                    [y, x],
                    u(0.9),
                    u(0.2),
                    Bound::block([u(0.6), u(0.5), u(0.5)]),
                )
                .unwrap(),
            ),
        ),
        Case {
            name: "metaballs",
            solid: Implicit::Metaballs(meta),
            blobs: balls,
        },
        Case {
            name: "smooth union",
            solid: Implicit::SmoothUnion(union),
            blobs: parts,
        },
    ]
}
