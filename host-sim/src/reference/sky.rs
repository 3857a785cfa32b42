//! Light from all around: a gradient, a sun, a picture. Each can be seen along a direction and chosen from.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::vec::{Rgb, Vec3, vec3};
use super::warp;

/// Radiance by the sine s of the elevation above `up`: from `horizon` at 0 to `zenith` at 1 and to `ground` at −1, straight
/// lines both.
#[derive(Clone, Copy, Debug)]
pub struct Gradient {
    pub zenith: Rgb,
    pub horizon: Rgb,
    pub ground: Rgb,
    /// Of any length but zero.
    pub up: Vec3,
}

/// A disk of constant radiance in the sky.
#[derive(Clone, Copy, Debug)]
pub struct Sun {
    /// Towards it, of any length but zero.
    pub direction: Vec3,
    pub radiance: Rgb,
    /// Angular diameter, degrees.
    pub angle: f64,
}

/// A latitude-longitude picture, row-major: pixel (i, j) is the radiance at u = (i + ½)/width (which wraps) and
/// v = j/(height − 1), from the north pole to the south pole; between them bilinear. u = atan2(x, −z)/2π and v = acos(y)/π of
/// the direction's coordinates on `axes`.
#[derive(Clone, Debug)]
pub struct Map {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<Rgb>,
    /// Orthonormal.
    pub axes: [Vec3; 3],
}

/// One of them, ready to be chosen from.
pub enum Sky {
    Gradient {
        sky: Gradient,
        /// Luminance over the ground's hemisphere and over the zenith's, both without the factor 2π.
        shares: [f64; 2],
    },
    Sun {
        sun: Sun,
        /// One less the cosine of half the angle.
        one_minus_cos: f64,
    },
    Map {
        map: Arc<Map>,
        cells: Cells,
    },
}

/// A map's cells between four pixels, to be chosen by the light in them.
pub struct Cells {
    /// Share of all light in the cells up to and including each, row by row.
    cumulative: Vec<f64>,
}

fn luminance(c: Rgb) -> f64 {
    0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
}

impl Sky {
    /// `None` where there is no light to choose.
    pub fn gradient(sky: Gradient) -> Option<Sky> {
        let mean = |end: Rgb| luminance(sky.horizon + end) / 2.0;
        let shares = [mean(sky.ground), mean(sky.zenith)];
        let sky = Gradient {
            up: sky.up.normalized(),
            ..sky
        };
        (shares[0] + shares[1] > 0.0).then_some(Sky::Gradient { sky, shares })
    }

    pub fn sun(sun: Sun) -> Option<Sky> {
        let half = (sun.angle.to_radians() / 2.0).sin();
        let cos = (1.0 - half * half).sqrt();
        let sun = Sun {
            direction: sun.direction.normalized(),
            ..sun
        };
        (luminance(sun.radiance) > 0.0).then_some(Sky::Sun {
            sun,
            one_minus_cos: half * half / (1.0 + cos),
        })
    }

    pub fn map(map: Arc<Map>) -> Option<Sky> {
        let cells = Cells::new(&map)?;
        Some(Sky::Map { map, cells })
    }

    /// What is seen along a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        match self {
            Sky::Gradient { sky, .. } => {
                let s = direction.dot(sky.up);
                let end = if s >= 0.0 { sky.zenith } else { sky.ground };
                sky.horizon + (end - sky.horizon) * s.abs().min(1.0)
            }
            Sky::Sun { sun, one_minus_cos } => {
                if sun.holds(*one_minus_cos, direction) {
                    sun.radiance
                } else {
                    Rgb::ZERO
                }
            }
            Sky::Map { map, .. } => map.radiance(direction),
        }
    }

    /// A direction, about as often as light comes from it.
    pub fn sample(&self, [u, v]: [f64; 2]) -> Vec3 {
        match self {
            Sky::Gradient { sky, shares } => {
                let below = shares[0] / (shares[0] + shares[1]);
                let (end, sign, u) = if u < below {
                    (sky.ground, -1.0, u / below)
                } else {
                    (sky.zenith, 1.0, (u - below) / (1.0 - below))
                };
                let s = linear(luminance(sky.horizon), luminance(end), u);
                let r = (1.0 - s * s).max(0.0).sqrt();
                let (sin, cos) = (TAU * v).sin_cos();
                sky.up.frame_to_world(vec3(r * cos, r * sin, s * sign))
            }
            Sky::Sun { sun, one_minus_cos } => {
                sun.direction.frame_to_world(warp::cone([u, v], *one_minus_cos))
            }
            Sky::Map { map, cells } => cells.sample(map, [u, v]),
        }
    }

    /// Solid-angle density of `sample`.
    pub fn pdf(&self, direction: Vec3) -> f64 {
        match self {
            Sky::Gradient { shares, .. } => {
                luminance(self.radiance(direction)) / (TAU * (shares[0] + shares[1]))
            }
            Sky::Sun { sun, one_minus_cos } => {
                if sun.holds(*one_minus_cos, direction) {
                    1.0 / (TAU * one_minus_cos)
                } else {
                    0.0
                }
            }
            Sky::Map { map, cells } => cells.pdf(map, direction),
        }
    }
}

impl Sun {
    /// Whether a unit direction is within the disk; by the chord, which is exact for small angles.
    fn holds(&self, one_minus_cos: f64, direction: Vec3) -> bool {
        // A sampled direction at the rim is off it by rounding, of no more than 1e-12 of the disk.
        (direction - self.direction).length_squared() <= 2.0 * one_minus_cos * (1.0 + 1e-12)
    }
}

/// The x in [0, 1] below which lies the share u of the area under the line from a at 0 to b at 1; both 0 or more.
fn linear(a: f64, b: f64, u: f64) -> f64 {
    // a x + (b − a) x²/2 = u (a + b)/2, by the root that does not cancel.
    let area = u * (a + b);
    let root = (a * a + area * (b - a)).max(0.0).sqrt();
    if a + root > 0.0 {
        (area / (a + root)).min(1.0)
    } else {
        u.sqrt()
    }
}

impl Map {
    /// Columns from the middle of pixel column 0, rows from the north pole, of a unit direction; both in pixels.
    fn place(&self, direction: Vec3) -> [f64; 2] {
        let [x, y, z] = self.axes.map(|axis| axis.dot(direction));
        let u = x.atan2(-z) / TAU;
        let v = y.clamp(-1.0, 1.0).acos() / PI;
        let column = (u * self.width as f64 - 0.5).rem_euclid(self.width as f64);
        [column, v * (self.height - 1) as f64]
    }

    fn pixel(&self, column: usize, row: usize) -> Rgb {
        self.pixels[row.min(self.height - 1) * self.width + column % self.width]
    }

    fn radiance(&self, direction: Vec3) -> Rgb {
        let [column, row] = self.place(direction);
        let [i, j] = [column, row].map(|c| c.floor() as usize);
        let [s, t] = [column.fract(), row.fract()];
        let across = |j: usize| self.pixel(i, j) * (1.0 - s) + self.pixel(i + 1, j) * s;
        across(j) * (1.0 - t) + across(j + 1) * t
    }

    /// Cosines of the polar angle at the top and at the bottom of a row of cells.
    fn band(&self, row: usize) -> [f64; 2] {
        [row, row + 1].map(|j| (PI * j as f64 / (self.height - 1) as f64).cos())
    }
}

impl Cells {
    /// A cell's light: the mean of its corners times its solid angle. `None` where all is black.
    fn new(map: &Map) -> Option<Cells> {
        let mut cumulative = Vec::with_capacity(map.width * (map.height - 1));
        let mut sum = 0.0;
        for row in 0..map.height - 1 {
            let [top, bottom] = map.band(row);
            for column in 0..map.width {
                let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
                let light: f64 = corners
                    .iter()
                    .map(|(i, j)| luminance(map.pixel(column + i, row + j)))
                    .sum();
                sum += light * (top - bottom);
                cumulative.push(sum);
            }
        }
        cumulative.iter_mut().for_each(|share| *share /= sum);
        (sum > 0.0).then_some(Cells { cumulative })
    }

    /// Uniform in the solid angle of the cell that is chosen.
    fn sample(&self, map: &Map, [u, v]: [f64; 2]) -> Vec3 {
        let cell = self.cumulative.partition_point(|&share| share <= u);
        let cell = cell.min(self.cumulative.len() - 1);
        let [before, after] = self.shares(cell);
        let within = ((u - before) / (after - before)).clamp(0.0, 1.0);
        let (column, row) = (cell % map.width, cell / map.width);
        let [top, bottom] = map.band(row);
        let y = top + (bottom - top) * v;
        let (sin, cos) = ((column as f64 + 0.5 + within) / map.width as f64 * TAU).sin_cos();
        let r = (1.0 - y * y).max(0.0).sqrt();
        let [x_axis, y_axis, z_axis] = map.axes;
        x_axis * (r * sin) + y_axis * y - z_axis * (r * cos)
    }

    fn pdf(&self, map: &Map, direction: Vec3) -> f64 {
        let [column, row] = map.place(direction);
        let column = (column as usize).min(map.width - 1);
        let row = (row as usize).min(map.height - 2);
        let [before, after] = self.shares(row * map.width + column);
        let [top, bottom] = map.band(row);
        (after - before) / ((top - bottom) * TAU / map.width as f64)
    }

    /// The shares of all cells before this one, and with it.
    fn shares(&self, cell: usize) -> [f64; 2] {
        let before = cell.checked_sub(1).map_or(0.0, |last| self.cumulative[last]);
        [before, self.cumulative[cell]]
    }
}
