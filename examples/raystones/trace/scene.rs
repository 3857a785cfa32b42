//! The scene of raystones: four spheres over a chequered floor, three lights, a camera at the origin.
//!
//! Its numbers are those of "raystones.c" (Bruno Levy, learn-fpga, 2020), a port of Dmitry Sokolov's "tinyraytracer". Metres
//! there are units here, held in steps of 2^-11.

use fixed::types::{I17F15, I18F14, I20F12, I21F11, I22F10, I24F8};
use microlux::q;

/// Three coordinates in the format that stands beside it.
pub type Vector = [i32; 3];

/// Steps a unit, as a power of two.
pub const STEPS: u32 = 11;

pub const fn dot(a: Vector, b: Vector) -> i32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

macro_rules! place {
    ($x:expr, $y:expr, $z:expr) => {
        [
            q!($x, I21F11).to_bits(),
            q!($y, I21F11).to_bits(),
            q!($z, I21F11).to_bits(),
        ]
    };
}

macro_rules! share {
    ($value:expr) => {
        q!($value, I17F15).to_bits()
    };
}

/// How a surface answers light.
pub struct Material {
    /// Diffuse colour times its weight, Q15.
    pub matt: Vector,
    /// Weight of the highlights, Q10.
    pub gloss: i32,
    /// Exponent of the highlights.
    pub exponent: u32,
    /// Cosine to the mirror direction, Q15, under which all highlights of a light together are less than 2^-11.
    pub dull: i32,
    /// Weight of the mirrored ray, Q15.
    pub mirror: i32,
    /// Weight of the refracted ray, Q15. Only one material has one, so that the index of refraction is a constant.
    pub glass: i32,
}

pub struct Ball {
    /// Q11.
    pub center: Vector,
    /// Q0.
    pub radius: i32,
    /// One over the radius, Q15.
    pub inverse: i32,
    pub material: Material,
}

impl Ball {
    /// The radius squared, Q26.
    pub const fn square(&self) -> i32 {
        (self.radius * self.radius) << 26
    }
}

pub const BALLS: [Ball; 4] = [
    Ball {
        center: place!(-3, 0, -16),
        radius: 2,
        inverse: share!(0.5),
        material: Material {
            matt: [share!(0.24), share!(0.24), share!(0.18)],
            gloss: q!(0.3, I22F10).to_bits(),
            exponent: 50,
            dull: share!(0.869),
            mirror: share!(0.1),
            glass: 0,
        },
    },
    Ball {
        center: place!(-1, -1.5, -12),
        radius: 2,
        inverse: share!(0.5),
        material: Material {
            matt: [0; 3],
            gloss: q!(0.5, I22F10).to_bits(),
            exponent: 125,
            dull: share!(0.9416),
            mirror: share!(0.1),
            glass: share!(0.8),
        },
    },
    Ball {
        center: place!(1.5, -0.5, -18),
        radius: 3,
        inverse: share!(0.333333333),
        material: Material {
            matt: [share!(0.27), share!(0.09), share!(0.09)],
            gloss: q!(0.1, I22F10).to_bits(),
            exponent: 10,
            dull: share!(0.5536),
            mirror: 0,
            glass: 0,
        },
    },
    Ball {
        center: place!(7, 5, -18),
        radius: 4,
        inverse: share!(0.25),
        material: Material {
            matt: [0; 3],
            gloss: q!(10, I22F10).to_bits(),
            exponent: 142,
            dull: share!(0.9286),
            mirror: share!(0.8),
            glass: 0,
        },
    },
];

/// The ratio of the speeds of light, and its square, by entering and by leaving the glass, Q14.
pub const ENTER: [i32; 2] = [
    q!(0.666666667, I18F14).to_bits(),
    q!(0.444444444, I18F14).to_bits(),
];
pub const LEAVE: [i32; 2] = [q!(1.5, I18F14).to_bits(), q!(2.25, I18F14).to_bits()];

pub struct Light {
    /// Q11.
    pub place: Vector,
    /// Q12.
    pub intensity: i32,
}

pub const LIGHTS: [Light; 3] = [
    Light {
        place: place!(-20, 20, 20),
        intensity: q!(1.5, I20F12).to_bits(),
    },
    Light {
        place: place!(30, 50, -25),
        intensity: q!(1.8, I20F12).to_bits(),
    },
    Light {
        place: place!(30, 20, 30),
        intensity: q!(1.7, I20F12).to_bits(),
    },
];

/// The floor's height, its half width about x = 0, and its end nearer the camera and the other, Q11.
pub const FLOOR: i32 = -4 << STEPS;
pub const WIDE: i32 = 10 << STEPS;
pub const NEAR: i32 = -10 << STEPS;
pub const FAR: i32 = -30 << STEPS;
/// Rays closer to level than this, in Q15, miss the floor.
pub const LEVEL: i32 = q!(0.001, I17F15).to_bits();
/// The diffuse colours of its squares, Q15.
pub const SQUARES: [Vector; 2] = [
    [share!(0.3), share!(0.2), share!(0.1)],
    [share!(0.3), share!(0.3), share!(0.3)],
];

/// The sky's colour straight above, Q14; straight below it is black.
pub const SKY: Vector = [
    q!(0.2, I18F14).to_bits(),
    q!(0.7, I18F14).to_bits(),
    q!(1.3, I18F14).to_bits(),
];

pub const WIDTH: i32 = 120;
pub const HEIGHT: i32 = 60;
/// Distance of the screen in half pixels, Q8: 60 / tan(30°).
pub const SCREEN: i32 = q!(103.923048, I24F8).to_bits();

// What the tracer need not ask. Every light is higher than everything, so that a ray towards it climbs: it meets nothing
// behind the light, and never the floor. Every ball is above the floor: a ray that meets one meets the floor only later.
const _: () = {
    let mut i = 0;
    while i < BALLS.len() {
        let (ball, r) = (&BALLS[i], BALLS[i].radius << STEPS);
        assert!(ball.center[1] - r > FLOOR);
        let mut j = 0;
        while j < LIGHTS.len() {
            assert!(LIGHTS[j].place[1] > ball.center[1] + r);
            j += 1;
        }
        i += 1;
    }
};
