use crate::color::Rgb9e5;
use crate::geom::Dir;
use crate::light::{Map, MapError, MapParts};

/// Texels of the picture.
const WIDTH: usize = 16;
const HEIGHT: usize = 9;
/// Cells that directions are drawn from.
const BANDS: usize = 8;
const STEPS: usize = 16;

static TEXELS: [Rgb9e5; WIDTH * HEIGHT] = picture();
static TABLE: Table = table(&TEXELS);

/// A studio of 144 texels: grey walls over a dark floor, a warm window on the right, a blue one on the left.
pub fn studio() -> Result<Map<'static>, MapError> {
    Map::new(MapParts {
        width: WIDTH as u16,
        height: HEIGHT as u16,
        texels: &TEXELS,
        exponent: 0,
        axes: [Dir::X, Dir::Y, Dir::Z],
        bands: &TABLE.bands,
        steps: TABLE.steps.as_flattened(),
        steps_in_band: STEPS as u16,
    })
}

/// The colour there in 1/32; pole at row 0, +x between columns 3 and 4.
const fn colour(row: usize, column: usize) -> [u32; 3] {
    match (row, column) {
        (2..=3, 3..=4) => [448, 384, 288],
        (1..=3, 11..=12) => [48, 80, 128],
        (row, _) if row < 2 => [6, 7, 9],
        (2..=4, _) => [12, 12, 12],
        (5, _) => [8, 7, 6],
        _ => [4, 3, 3],
    }
}

const fn picture() -> [Rgb9e5; WIDTH * HEIGHT] {
    let mut texels = [Rgb9e5(0); WIDTH * HEIGHT];
    let mut i = 0;
    while i < texels.len() {
        let [r, g, b] = colour(i / WIDTH, i % WIDTH);
        // In steps of 2^(19 − 24).
        texels[i] = Rgb9e5(r | g << 9 | b << 18 | 19 << 27);
        i += 1;
    }
    texels
}

/// Where the numbers for one band or step end and those for the next begin.
struct Table {
    bands: [u16; BANDS - 1],
    steps: [[u16; STEPS - 1]; BANDS],
}

/// Weighs each cell by the largest texel near it, so that none with light goes without a chance.
const fn table(texels: &[Rgb9e5]) -> Table {
    // A band is ¼ high in y; row j stands at y = cos(22.5° j). The rows that a band's light is mixed of:
    const ROWS: [[usize; 2]; BANDS] = [[0, 2], [1, 3], [2, 4], [3, 4], [4, 5], [4, 6], [5, 7], [6, 8]];
    let mut weights = [[0; STEPS]; BANDS];
    let mut sums = [0; BANDS];
    let mut band = 0;
    while band < BANDS {
        let mut step = 0;
        while step < STEPS {
            let mut row = ROWS[band][0];
            while row <= ROWS[band][1] {
                // Texel i stands in the middle of step i, and fades out at those beside it.
                let mut aside = 0;
                while aside < 3 {
                    let column = (step + aside + STEPS - 1) % STEPS;
                    let green = texels[row * WIDTH + column].0 >> 9 & 511;
                    if green > weights[band][step] {
                        weights[band][step] = green;
                    }
                    aside += 1;
                }
                row += 1;
            }
            sums[band] += weights[band][step];
            step += 1;
        }
        band += 1;
    }
    let mut steps = [[0; STEPS - 1]; BANDS];
    let mut band = 0;
    while band < BANDS {
        steps[band] = bounds(&weights[band], sums[band]);
        band += 1;
    }
    let mut all = 0;
    let mut band = 0;
    while band < BANDS {
        all += sums[band];
        band += 1;
    }
    Table {
        bands: bounds(&sums, all),
        steps,
    }
}

/// Running sums of weights above 0, as shares of 2^16.
const fn bounds<const N: usize, const M: usize>(weights: &[u32; N], sum: u32) -> [u16; M] {
    let mut bounds = [0; M];
    let mut so_far = 0;
    let mut i = 0;
    while i < M {
        so_far += weights[i];
        bounds[i] = ((so_far << 16) / sum) as u16;
        i += 1;
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::{Uniform, Wide};

    fn value(x: Wide) -> f64 {
        f64::from(x.mantissa()) * 2f64.powi(i32::from(x.exponent()) - 15)
    }

    /// No direction brings much more than the mean does.
    #[test]
    fn the_table_follows_the_light() {
        let map = studio().unwrap();
        let (mut drawn, mut largest) = (0.0, 0f64);
        let side = 256;
        for i in 0..side * side {
            let place = |n: u32| Uniform::from_bits((n << 24) + (1 << 23));
            let sample = map.sample([place(i / side), place(i % side)]).unwrap();
            let ratio = value(sample.radiance.luminance() / sample.pdf);
            drawn += ratio;
            largest = largest.max(ratio);
        }
        drawn /= f64::from(side * side);
        // Evenly drawn, the brightest window would have 19 times the mean.
        assert!(largest < 4.0 * drawn, "{largest} {drawn}");
    }
}
