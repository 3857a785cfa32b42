//! Raystones in single precision, as the C program has it: every ray is followed, whatever its weight, three deep.

use std::f32::consts::FRAC_PI_6;

type Vector = [f32; 3];

pub const WIDTH: usize = 120;
pub const HEIGHT: usize = 60;

struct Material {
    /// Diffuse, specular, mirrored, refracted.
    weights: [f32; 4],
    colour: Vector,
    exponent: f32,
    index: f32,
}

struct Ball {
    center: Vector,
    radius: f32,
    material: Material,
}

const BALLS: [Ball; 4] = [
    Ball {
        center: [-3.0, 0.0, -16.0],
        radius: 2.0,
        material: Material {
            weights: [0.6, 0.3, 0.1, 0.0],
            colour: [0.4, 0.4, 0.3],
            exponent: 50.0,
            index: 1.0,
        },
    },
    Ball {
        center: [-1.0, -1.5, -12.0],
        radius: 2.0,
        material: Material {
            weights: [0.0, 0.5, 0.1, 0.8],
            colour: [0.6, 0.7, 0.8],
            exponent: 125.0,
            index: 1.5,
        },
    },
    Ball {
        center: [1.5, -0.5, -18.0],
        radius: 3.0,
        material: Material {
            weights: [0.9, 0.1, 0.0, 0.0],
            colour: [0.3, 0.1, 0.1],
            exponent: 10.0,
            index: 1.0,
        },
    },
    Ball {
        center: [7.0, 5.0, -18.0],
        radius: 4.0,
        material: Material {
            weights: [0.0, 10.0, 0.8, 0.0],
            colour: [1.0, 1.0, 1.0],
            exponent: 142.0,
            index: 1.0,
        },
    },
];

/// Place and intensity.
const LIGHTS: [(Vector, f32); 3] = [
    ([-20.0, 20.0, 20.0], 1.5),
    ([30.0, 50.0, -25.0], 1.8),
    ([30.0, 20.0, 30.0], 1.7),
];

fn dot(a: Vector, b: Vector) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a + s b
fn along(a: Vector, s: f32, b: Vector) -> Vector {
    [0, 1, 2].map(|k| a[k] + s * b[k])
}

fn unit(v: Vector) -> Vector {
    v.map(|c| c / dot(v, v).sqrt())
}

fn mirror(dir: Vector, normal: Vector) -> Vector {
    along(dir, -2.0 * dot(dir, normal), normal)
}

/// Snell's law from a medium of index `from` into one of index `to`; what cannot be refracted goes along x.
fn refract(dir: Vector, normal: Vector, to: f32, from: f32) -> Vector {
    let cos = -dot(dir, normal).clamp(-1.0, 1.0);
    if cos < 0.0 {
        return refract(dir, normal.map(|c| -c), from, to);
    }
    let eta = from / to;
    let square = 1.0 - eta * eta * (1.0 - cos * cos);
    if square < 0.0 {
        return [1.0, 0.0, 0.0];
    }
    along(dir.map(|c| eta * c), eta * cos - square.sqrt(), normal)
}

/// The nearest way to the ball that is not negative.
fn meet(ball: &Ball, origin: Vector, dir: Vector) -> Option<f32> {
    let to = along(ball.center, -1.0, origin);
    let middle = dot(to, dir);
    let square = ball.radius * ball.radius - (dot(to, to) - middle * middle);
    if square < 0.0 {
        return None;
    }
    let half = square.sqrt();
    [middle - half, middle + half].into_iter().find(|way| *way >= 0.0)
}

struct Hit<'a> {
    point: Vector,
    normal: Vector,
    /// None for the floor, whose colour then counts.
    material: Option<&'a Material>,
    colour: Vector,
}

fn closest(origin: Vector, dir: Vector) -> Option<Hit<'static>> {
    let mut nearest = 1e30;
    let mut hit = None;
    for ball in &BALLS {
        if let Some(way) = meet(ball, origin, dir).filter(|way| *way < nearest) {
            nearest = way;
            let point = along(origin, way, dir);
            hit = Some(Hit {
                point,
                normal: unit(along(point, -1.0, ball.center)),
                material: Some(&ball.material),
                colour: ball.material.colour,
            });
        }
    }
    if dir[1].abs() > 1e-3 {
        let way = -(origin[1] + 4.0) / dir[1];
        let point = along(origin, way, dir);
        let inside = point[0].abs() < 10.0 && point[2] < -10.0 && point[2] > -30.0;
        if way > 0.0 && inside && way < nearest {
            nearest = way;
            let square = (0.5 * point[0] + 1000.0) as i32 + (0.5 * point[2]) as i32;
            hit = Some(Hit {
                point,
                normal: [0.0, 1.0, 0.0],
                material: None,
                colour: if square & 1 == 1 {
                    [0.3; 3]
                } else {
                    [0.3, 0.2, 0.1]
                },
            });
        }
    }
    hit.filter(|_| nearest < 1000.0)
}

/// Off the surface by 10^-3, to the side that `dir` goes to.
fn leave(hit: &Hit, dir: Vector) -> Vector {
    along(hit.point, 1e-3f32.copysign(dot(dir, hit.normal)), hit.normal)
}

fn cast(origin: Vector, dir: Vector, depth: u32) -> Vector {
    let Some(hit) = closest(origin, dir).filter(|_| depth <= 2) else {
        let height = 0.5 * (dir[1] + 1.0);
        return [0.2, 0.7, 1.3].map(|c| height * c);
    };
    let (weights, exponent, index) = match hit.material {
        Some(material) => (material.weights, material.exponent, material.index),
        None => ([1.0, 0.0, 0.0, 0.0], 0.0, 1.0),
    };
    let mirrored = unit(mirror(dir, hit.normal));
    let refracted = unit(refract(dir, hit.normal, index, 1.0));
    let mirrored_light = cast(leave(&hit, mirrored), mirrored, depth + 1);
    let refracted_light = cast(leave(&hit, refracted), refracted, depth + 1);
    let (mut diffuse, mut specular) = (0.0, 0.0);
    for (place, intensity) in LIGHTS {
        let to = along(place, -1.0, hit.point);
        let light = unit(to);
        let start = leave(&hit, light);
        let between = closest(start, light).map(|other| along(other.point, -1.0, start));
        if between.is_some_and(|way| dot(way, way) < dot(to, to)) {
            continue;
        }
        diffuse += intensity * dot(light, hit.normal).max(0.0);
        let shine = dot(mirror(light, hit.normal), dir);
        if shine > 0.0 && exponent > 0.0 {
            specular += shine.powf(exponent) * intensity;
        }
    }
    [0, 1, 2].map(|k| {
        diffuse * weights[0] * hit.colour[k]
            + specular * weights[1]
            + weights[2] * mirrored_light[k]
            + weights[3] * refracted_light[k]
    })
}

pub fn picture() -> Vec<[u8; 3]> {
    let (width, height) = (WIDTH as f32, HEIGHT as f32);
    let at = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x as f32, y as f32)));
    let pixel = |(x, y): (f32, f32)| {
        let screen = -height / (2.0 * FRAC_PI_6.tan());
        let dir = unit([x + 0.5 - width / 2.0, height / 2.0 - (y + 0.5), screen]);
        // Cut off, as the C program's conversion does.
        cast([0.0; 3], dir, 0).map(|c| (255.0 * c.clamp(0.0, 1.0)) as u8)
    };
    at.map(pixel).collect()
}
