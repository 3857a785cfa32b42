use super::{EnvironmentSample, chance_by, choose_by};
use crate::color::{Radiance, Rgb9e5};
use crate::geom::{Dir, Frame};
use crate::num::{ONE_Q16, Turn, Uniform, Wide, atan2, isqrt, mul_q16, ratio, sin_cos};

/// A latitude-longitude picture of the environment, in constant memory, with a table to draw directions by.
///
/// In the map's own frame a direction (x, y, z) meets the picture at u = atan2(x, −z) / 2π (modulo 1) and
/// v = acos(y) / π. Column i stands at u = (i + ½) / `width` and wraps; row j at v = j / (`height` − 1), so that the
/// first and last rows are the poles; between them it is bilinear: all as Mitsuba 3 has it.
///
/// The table divides the sphere into cells of equal solid angle, bands of even height in y, each in even steps of u; a
/// cell is drawn by its chance, and a direction in it evenly. Each cell has a chance, so that no light is missed.
#[derive(Clone, Copy, Debug)]
pub struct Map<'a> {
    width: u16,
    height: u16,
    texels: &'a [Rgb9e5],
    exponent: i16,
    frame: Frame,
    bands: &'a [u16],
    steps: &'a [u16],
    steps_in_band: u16,
    flux: Wide,
}

/// What is wrong with a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapError {
    /// At least 1 × 2 texels, at most 2^14 a side, and as many as `width` times `height`, `needed`.
    Texels { needed: usize },
    /// The table of `bands` or of `steps` has not as many bounds as there are cells, or one that does not rise.
    Table,
    /// The frame's axes are no unit vectors.
    Frame,
}

impl core::fmt::Display for MapError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Texels { needed } => {
                write!(
                    f,
                    "{needed} texels are needed; 1 to 16384 columns, 2 to 16384 rows"
                )
            }
            Self::Table => write!(f, "the table of bounds is too short, or does not rise"),
            Self::Frame => write!(f, "its axes are no unit vectors"),
        }
    }
}

impl core::error::Error for MapError {}

/// What a [`Map`] is made of.
#[derive(Clone, Copy, Debug)]
pub struct MapParts<'a> {
    pub width: u16,
    pub height: u16,
    /// Row by row.
    pub texels: &'a [Rgb9e5],
    /// All texels are times 2^this.
    pub exponent: i16,
    /// The map's axes x, y, z in the scene.
    pub axes: [Dir; 3],
    /// Bounds between the bands, from y = 1 down, for [`choose_by`]: one fewer than there are bands.
    pub bands: &'a [u16],
    /// For each band, the bounds between its steps of u: one fewer than there are steps.
    pub steps: &'a [u16],
    pub steps_in_band: u16,
}

impl<'a> Map<'a> {
    /// Checks everything once.
    pub fn new(parts: MapParts<'a>) -> Result<Map<'a>, MapError> {
        let MapParts {
            width,
            height,
            texels,
            exponent,
            axes,
            bands,
            steps,
            steps_in_band,
        } = parts;
        let needed = width as usize * height as usize;
        let largest = 1 << 14;
        if width < 1 || height < 2 || width.max(height) > largest || texels.len() != needed {
            return Err(MapError::Texels { needed });
        }
        let rises = |bounds: &[u16]| {
            let from = core::iter::once(&0).chain(bounds);
            from.zip(bounds).all(|(before, bound)| before < bound)
        };
        let row = (steps_in_band as usize).checked_sub(1).ok_or(MapError::Table)?;
        let fits = bands.len() < largest as usize
            && steps_in_band <= largest
            && steps.len() == row * (bands.len() + 1)
            && rises(bands)
            && (row == 0 || steps.chunks_exact(row).all(rises));
        if !fits {
            return Err(MapError::Table);
        }
        let unit = |d: &Dir| {
            d.0.iter().all(|c| c.unsigned_abs() <= 2 << 16) && (d.dot_q24(*d) - (1 << 24)).abs() <= 1 << 12
        };
        let [x, y, z] = axes;
        let square = || [x.dot(y), y.dot(z), z.dot(x)].iter().all(|cos| cos.abs() <= 16);
        if !axes.iter().all(unit) || !square() {
            return Err(MapError::Frame);
        }
        let mut map = Map {
            width,
            height,
            texels,
            exponent,
            frame: Frame { s: x, t: y, n: z },
            bands,
            steps,
            steps_in_band,
            flux: Wide::ZERO,
        };
        map.flux = map.integrate();
        Ok(map)
    }

    /// What it is made of.
    pub const fn parts(&self) -> MapParts<'a> {
        MapParts {
            width: self.width,
            height: self.height,
            texels: self.texels,
            exponent: self.exponent,
            axes: [self.frame.s, self.frame.t, self.frame.n],
            bands: self.bands,
            steps: self.steps,
            steps_in_band: self.steps_in_band,
        }
    }

    /// Bytes of constant memory behind it.
    pub const fn bytes(&self) -> usize {
        size_of_val(self.texels) + size_of_val(self.bands) + size_of_val(self.steps)
    }

    /// What is seen along a direction.
    pub fn radiance(&self, dir: Dir) -> Radiance {
        let [x, y, z] = self.frame.to_local(dir).0;
        let (width, height) = (self.width as u32, self.height as u32);
        // Places in Q16 texels: half a texel back across, and around.
        let across = (atan2(x, -z).to_bits() >> 16) * width + (width << 16) - (1 << 15);
        let square = |c: i32| c.unsigned_abs().min(0xffff).pow(2);
        let radius = isqrt(square(x).saturating_add(square(z))) as i32;
        // From 0 at +y to half a turn at −y.
        let down = (atan2(radius, y).to_bits().min((1 << 31) - 1) >> 15) * (height - 1);
        let row = (down >> 16).min(height - 2);
        let columns = [across >> 16, (across >> 16) + 1].map(|c| c % width);
        let (fx, fy) = (across & 0xffff, (down - (row << 16)).min(0xffff));
        let weights = |f: u32| [(1 << 16) - f, f];
        let mut sum = Radiance::BLACK;
        for (row, wy) in [row, row + 1].into_iter().zip(weights(fy)) {
            for (column, wx) in columns.into_iter().zip(weights(fx)) {
                let texel = self.texels.get((row * width + column) as usize);
                // Both weights are 2^16 at most.
                let weight = Wide::new(wx, -16) * Wide::new(wy, -16);
                if let Some(texel) = texel
                    && !weight.is_zero()
                {
                    sum = sum.add(texel.scaled(self.exponent as i32).scale(weight));
                }
            }
        }
        sum
    }

    /// A direction by the table.
    pub fn sample(&self, u: [Uniform; 2]) -> Option<EnvironmentSample> {
        let (band, down) = choose_by(u[0], self.bands);
        let bounds = self.steps_of(band);
        let (step, around) = choose_by(u[1], bounds);
        // y = 1 − 2 (band + down) / bands; u = (step + around) / steps
        let cells = [self.bands.len() as u32 + 1, self.steps_in_band as u32];
        let place = |index: u32, rest: Uniform, cells: u32| {
            ratio((index << 16) + (rest.to_bits() >> 16), cells << 16)
        };
        let y = ONE_Q16 - (place(band, down, cells[0]) >> 15) as i32;
        let turn = Turn::from_bits(place(step, around, cells[1]));
        let (sin_phi, cos_phi) = sin_cos(turn);
        let high = y.unsigned_abs().min(0xffff);
        let radius = isqrt(!(high * high)) as i32;
        let local = Dir([mul_q16(radius, sin_phi), y, -mul_q16(radius, cos_phi)]);
        let wi = self.frame.to_world(local);
        Some(EnvironmentSample {
            wi,
            radiance: self.radiance(wi),
            pdf: self.density(band, step),
        })
    }

    /// The density of [`Self::sample`] at a direction.
    pub fn pdf(&self, dir: Dir) -> Wide {
        let [x, y, z] = self.frame.to_local(dir).0;
        let bands = self.bands.len() as u32 + 1;
        // 2^17 is all of y.
        let band = ((ONE_Q16 - y).clamp(0, 2 * ONE_Q16 - 1) as u32 * bands) >> 17;
        let turn = atan2(x, -z).to_bits() >> 16;
        let step = (turn * self.steps_in_band as u32) >> 16;
        self.density(band, step)
    }

    /// The chance of a cell over its solid angle, 4π / (bands · steps).
    fn density(&self, band: u32, step: u32) -> Wide {
        let cells = (self.bands.len() as u32 + 1) * self.steps_in_band as u32;
        let chance = chance_by(band as usize, self.bands) * chance_by(step as usize, self.steps_of(band));
        chance * Wide::new(cells, -2) * Wide::INV_PI
    }

    fn steps_of(&self, band: u32) -> &'a [u16] {
        let row = self.steps_in_band as usize - 1;
        let from = band as usize * row;
        self.steps.get(from..from + row).unwrap_or(&[])
    }

    pub(super) const fn flux(&self) -> Wide {
        self.flux
    }

    /// ∫ of the luminance over the sphere: a row weighs sin θ, a pole the sixth of a row's step.
    fn integrate(&self) -> Wide {
        let rows = self.texels.chunks_exact(self.width as usize);
        let steps = self.height as u32 - 1;
        let mut sum = Wide::ZERO;
        for (j, row) in (0u32..).zip(rows) {
            let sine = if j == 0 || j == steps {
                Wide::PI / Wide::new(6 * steps, 0)
            } else {
                Wide::from_q16(sin_cos(Turn::from_bits(ratio(j, 2 * steps))).0)
            };
            let luminance = row.iter().fold(Wide::ZERO, |sum, texel| {
                sum + texel.scaled(self.exponent as i32).luminance()
            });
            sum = sum + luminance * sine;
        }
        // 2π/width · π/steps
        sum * Wide::PI.shl(1) * Wide::PI / Wide::new(self.width as u32 * steps, 0)
    }
}
