//! An environment map for flash: a picture made small, in the core's texels, with the table that directions are drawn by.

use crate::desc::Vec3;
use microlux::color::{Radiance, Rgb9e5};
use microlux::geom::Dir;
use microlux::light::{Map, MapError, MapParts};

/// The largest map that is made; smaller pictures stay as they are.
pub const MAX_SIZE: [usize; 2] = [128, 64];

/// A map with all that it borrows.
#[derive(Clone, Debug)]
pub struct BakedMap {
    width: usize,
    height: usize,
    texels: Vec<Rgb9e5>,
    exponent: i16,
    axes: [Dir; 3],
    bands: Vec<u16>,
    steps: Vec<u16>,
    steps_in_band: usize,
}

/// A latitude-longitude picture, interpolated as the core does.
struct Picture<'a> {
    width: usize,
    height: usize,
    pixels: &'a [Vec3],
}

impl Picture<'_> {
    fn at(&self, u: f64, v: f64) -> Vec3 {
        let across = (u.rem_euclid(1.0) * self.width as f64 - 0.5).rem_euclid(self.width as f64);
        let down = v.clamp(0.0, 1.0) * (self.height - 1) as f64;
        let (column, row) = (across as usize, (down as usize).min(self.height - 2));
        let (fx, fy) = (across - column as f64, down - row as f64);
        let pixel = |row: usize, column: usize| self.pixels[row * self.width + column % self.width];
        let (a, b) = (pixel(row, column), pixel(row, column + 1));
        let (c, d) = (pixel(row + 1, column), pixel(row + 1, column + 1));
        let mix =
            |i: usize| (1.0 - fy) * ((1.0 - fx) * a[i] + fx * b[i]) + fy * ((1.0 - fx) * c[i] + fx * d[i]);
        [mix(0), mix(1), mix(2)]
    }

    /// The mean over all directions, exactly: a row weighs the integral of its tent times sin θ.
    fn mean(&self) -> Vec3 {
        let step = std::f64::consts::PI / (self.height - 1) as f64;
        let mut sum = [0.0; 3];
        for (j, row) in self.pixels.chunks_exact(self.width).enumerate() {
            let weight = if j == 0 || j == self.height - 1 {
                1.0 - step.sin() / step
            } else {
                (j as f64 * step).sin() * 2.0 * (1.0 - step.cos()) / step
            };
            for pixel in row {
                (0..3).for_each(|i| sum[i] += pixel[i] * weight / (2 * self.width) as f64);
            }
        }
        sum
    }

    /// Made smaller: each texel is the mean of what its own tent covers, by solid angle, and the mean over all
    /// directions is kept, channel by channel.
    fn resized(&self, width: usize, height: usize) -> Vec<Vec3> {
        let taps = |from: usize, to: usize| (2 * from.div_ceil(to)).max(4) as i32 * 2;
        let (across, down) = (taps(self.width, width), taps(self.height, height));
        let place = |tap: i32, taps: i32| (f64::from(tap) + 0.5) / f64::from(taps) * 2.0 - 1.0;
        let texel = |index: usize| {
            let (row, column) = (index / width, index % width);
            let (mut sum, mut total) = ([0.0; 3], 0.0);
            for y in (0..down).map(|tap| place(tap, down)) {
                let v = (row as f64 + y) / (height - 1) as f64;
                if !(0.0..=1.0).contains(&v) {
                    continue;
                }
                for x in (0..across).map(|tap| place(tap, across)) {
                    let weight = (1.0 - x.abs()) * (1.0 - y.abs()) * (v * std::f64::consts::PI).sin();
                    let pixel = self.at((column as f64 + 0.5 + x) / width as f64, v);
                    (0..3).for_each(|i| sum[i] += weight * pixel[i]);
                    total += weight;
                }
            }
            sum.map(|c| c / total)
        };
        let mut pixels: Vec<Vec3> = (0..width * height).map(texel).collect();
        let small = Picture {
            width,
            height,
            pixels: &pixels,
        };
        let (had, has) = (self.mean(), small.mean());
        let scale = [0, 1, 2].map(|i| if has[i] > 0.0 { had[i] / has[i] } else { 1.0 });
        pixels
            .iter_mut()
            .for_each(|p| (0..3).for_each(|i| p[i] *= scale[i]));
        pixels
    }
}

/// What is done to a picture of this size, if anything.
pub fn resizing(width: usize, height: usize) -> Option<[usize; 2]> {
    let size = [width.min(MAX_SIZE[0]), height.clamp(2, MAX_SIZE[1])];
    (size != [width, height]).then_some(size)
}

impl BakedMap {
    /// From a picture of at least one column and one row; `axes` are the map's own in the scene.
    pub fn new(width: usize, height: usize, pixels: &[Vec3], axes: [Dir; 3]) -> BakedMap {
        let clean: Vec<Vec3> = pixels.iter().map(|p| p.map(|c| c.max(0.0))).collect();
        // One row stands for both poles.
        let (height, clean) = if height == 1 {
            (2, [clean.clone(), clean].concat())
        } else {
            (height, clean)
        };
        let picture = Picture {
            width,
            height,
            pixels: &clean,
        };
        let [width, height] = resizing(width, height).unwrap_or([width, height]);
        let small = if (width, height) == (picture.width, picture.height) {
            clean.clone()
        } else {
            picture.resized(width, height)
        };
        let largest = small.iter().flatten().fold(0.0, |a: f64, c| a.max(*c));
        // The largest has the largest exponent there is.
        let exponent = if largest > 0.0 {
            (largest / 65_408.0).log2().ceil() as i16
        } else {
            0
        };
        let texels: Vec<Rgb9e5> = small.iter().map(|p| texel(*p, exponent)).collect();
        let held: Vec<Vec3> = texels
            .iter()
            .map(|t| value(t.scaled(i32::from(exponent))))
            .collect();
        let held = Picture {
            width,
            height,
            pixels: &held,
        };
        let (count, steps_in_band) = (height, width);
        let weights: Vec<Vec<f64>> = (0..count)
            .map(|band| {
                (0..steps_in_band)
                    .map(|step| cell(&held, band, count, step, steps_in_band))
                    .collect()
            })
            .collect();
        let by_band: Vec<f64> = weights.iter().map(|band| band.iter().sum()).collect();
        BakedMap {
            width,
            height,
            texels,
            exponent,
            axes,
            bands: bounds(&by_band),
            steps: weights.iter().flat_map(|band| bounds(band)).collect(),
            steps_in_band,
        }
    }

    /// What a core's map is made of, owned.
    pub fn of(parts: &MapParts) -> BakedMap {
        BakedMap {
            width: parts.width.into(),
            height: parts.height.into(),
            texels: parts.texels.to_vec(),
            exponent: parts.exponent,
            axes: parts.axes,
            bands: parts.bands.to_vec(),
            steps: parts.steps.to_vec(),
            steps_in_band: parts.steps_in_band.into(),
        }
    }

    /// As the core borrows it.
    pub fn map(&self) -> Result<Map<'_>, MapError> {
        Map::new(MapParts {
            width: self.width as u16,
            height: self.height as u16,
            texels: &self.texels,
            exponent: self.exponent,
            axes: self.axes,
            bands: &self.bands,
            steps: &self.steps,
            steps_in_band: self.steps_in_band as u16,
        })
    }
}

/// The nearest texel, times 2^`exponent`.
fn texel(color: Vec3, exponent: i16) -> Rgb9e5 {
    let scaled = color.map(|c| c * f64::from(-exponent).exp2());
    let largest = scaled.into_iter().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Rgb9e5(0);
    }
    let mut e = (largest.log2().floor() as i32 + 16).clamp(0, 31);
    let mantissas = |e: i32| scaled.map(|c| (c * f64::from(24 - e).exp2()).round() as u32);
    if e < 31 && mantissas(e).iter().any(|m| *m > 511) {
        e += 1;
    }
    let [r, g, b] = mantissas(e).map(|m| m.min(511));
    Rgb9e5(r | g << 9 | b << 18 | (e as u32) << 27)
}

fn value(radiance: Radiance) -> Vec3 {
    let (mantissa, exponent) = radiance.to_parts();
    mantissa.map(|m| f64::from(m) * f64::from(i32::from(exponent) - 15).exp2())
}

/// Luminance in a cell of the table: the mean of points evenly over it.
fn cell(map: &Picture, band: usize, bands: usize, step: usize, steps: usize) -> f64 {
    const DOWN: usize = 8;
    const ACROSS: usize = 4;
    let mut sum = 0.0;
    for tap in 0..DOWN * ACROSS {
        let at = |index: usize, tap: usize, taps: usize| index as f64 + (tap as f64 + 0.5) / taps as f64;
        let y = 1.0 - 2.0 * at(band, tap / ACROSS, DOWN) / bands as f64;
        let [r, g, b] = map.at(
            at(step, tap % ACROSS, ACROSS) / steps as f64,
            y.acos() / std::f64::consts::PI,
        );
        sum += 0.2126 * r + 0.7152 * g + 0.0722 * b;
    }
    sum
}

/// Bounds between choices of these weights, in 2^-16; each has a chance.
fn bounds(weights: &[f64]) -> Vec<u16> {
    let total: f64 = weights.iter().sum();
    let count = weights.len() as f64;
    let mut sum = 0.0;
    let mut bounds = Vec::new();
    for (before, weight) in weights.iter().enumerate().take(weights.len() - 1) {
        sum += if total > 0.0 { weight / total } else { 1.0 / count };
        bounds.push(((sum * (65_535.0 - count)).floor() as usize + before + 1) as u16);
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dark with a small bright place, of another colour.
    fn picture(width: usize, height: usize) -> Vec<Vec3> {
        let pixel = |index: usize| {
            let (x, y) = (
                (index % width) as f64 / width as f64,
                (index / width) as f64 / height as f64,
            );
            let sun = if (x - 0.3).abs() < 0.02 && (y - 0.2).abs() < 0.02 {
                900.0
            } else {
                0.0
            };
            [0.2 + x + sun, 0.3 + y * y + 0.9 * sun, 1.0 - y + 0.5 * sun]
        };
        (0..width * height).map(pixel).collect()
    }

    const AXES: [Dir; 3] = [Dir::X, Dir::Y, Dir::Z];

    fn mean_of(map: &BakedMap) -> Vec3 {
        let pixels: Vec<Vec3> = map
            .texels
            .iter()
            .map(|t| value(t.scaled(i32::from(map.exponent))))
            .collect();
        Picture {
            width: map.width,
            height: map.height,
            pixels: &pixels,
        }
        .mean()
    }

    #[test]
    fn smaller_maps_keep_the_mean() {
        for (width, height) in [
            (600, 300),
            (200, 40),
            (40, 200),
            (128, 64),
            (16, 8),
            (3, 2),
            (5, 1),
        ] {
            let pixels = picture(width, height);
            let rows = if height == 1 {
                [pixels.clone(), pixels.clone()].concat()
            } else {
                pixels.clone()
            };
            let exact = Picture {
                width,
                height: height.max(2),
                pixels: &rows,
            }
            .mean();
            let map = BakedMap::new(width, height, &pixels, AXES);
            assert!(map.width <= 128 && map.height <= 64);
            map.map().unwrap();
            let found = mean_of(&map);
            for i in 0..3 {
                let error = found[i] / exact[i] - 1.0;
                // A few texels may all round alike, by half a step of the largest channel's nine bits.
                let (few, apart) = (width * height < 100, (found[i] - exact[i]).abs());
                let half_step = exact.into_iter().fold(0.0, f64::max) / 512.0;
                println!("{width} x {height}, channel {i}: {error:+.1e}");
                assert!(
                    error.abs() < 1.6e-3 || (few && apart < half_step),
                    "{width} x {height}: {found:?} for {exact:?}"
                );
            }
        }
    }

    #[test]
    fn texels_are_the_nearest() {
        for (color, exponent) in [
            ([65_408.0, 0.1, 3.0], 0),
            ([511.6, 511.4, 0.0], 0),
            ([1e9, 2e9, 3e-3], 15),
            ([0.0; 3], 0),
        ] {
            let found = value(texel(color, exponent).scaled(i32::from(exponent)));
            let step = color.into_iter().fold(0.0, f64::max) / 256.0;
            for i in 0..3 {
                assert!((found[i] - color[i]).abs() <= 0.51 * step, "{color:?}: {found:?}");
            }
        }
    }

    /// Light samples of a map with a small sun carry about as much as its mean: they look where it is.
    #[test]
    fn the_table_finds_the_light() {
        use microlux::num::Uniform;
        let map = BakedMap::new(128, 64, &picture(128, 64), AXES);
        let map = map.map().unwrap();
        let exact = value(Radiance::WHITE.scale(map_mean(&map)))[0];
        let (mut sum, mut squares) = (0.0, 0.0);
        let count = 4096;
        for i in 0..count {
            let u = [i as f64 / f64::from(count), (f64::from(i) * 0.618_034).fract()]
                .map(|u| Uniform::from_num(u));
            let sample = map.sample(u).unwrap();
            let weight = value(Radiance::WHITE.scale(sample.radiance.luminance() / sample.pdf))[0]
                / 4.0
                / std::f64::consts::PI;
            sum += weight;
            squares += weight * weight;
        }
        let mean = sum / f64::from(count);
        let deviation = (squares / f64::from(count) - mean * mean).sqrt() / mean;
        println!("mean {mean} of {exact}, one sample's deviation {deviation:.2}");
        assert!((mean / exact - 1.0).abs() < 0.03);
        // Without the table it is about 9.
        assert!(deviation < 1.0, "{deviation}");
    }

    fn map_mean(map: &Map) -> microlux::num::Wide {
        use microlux::num::Wide;
        microlux::light::Environment::Map(*map).flux() * Wide::INV_PI.shl(-2)
    }
}
