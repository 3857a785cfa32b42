/// What decides between two neighbouring colours, by the pixel's place alone: tiles cannot change the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Dither {
    /// The nearest colour: bands where the display has few.
    #[default]
    None,
    /// Bayer's 8×8 matrix: 64 thresholds (B. E. Bayer, "An optimum method for two-level rendition", ICC 1973).
    Ordered,
    /// 64×64, tileable, 256 thresholds, no low frequencies: R. Ulichney, "The void-and-cluster method for dither array
    /// generation", SPIE 1913, 1993. Made by `tests/blue_noise.rs`.
    BlueNoise,
}

/// Row by row; each value 0 ..= 255 stands there 16 times.
static BLUE_NOISE: &[u8; 64 * 64] = include_bytes!("blue_noise.bin");

/// Row by row, the ranks 0 ..= 63: bits of x ^ y and y, interleaved, the lowest of them first.
static BAYER: [u8; 64] = {
    let mut ranks = [0; 64];
    let mut i = 0;
    while i < 64 {
        let (x, y) = (i & 7, i >> 3);
        let mut bit = 0;
        while bit < 3 {
            let pair = (((x ^ y) >> bit) & 1) << 1 | ((y >> bit) & 1);
            ranks[i] |= (pair << (4 - 2 * bit)) as u8;
            bit += 1;
        }
        i += 1;
    }
    ranks
};

impl Dither {
    /// What [`super::DisplayColor::quantize`] takes, for the pixel (x, y) of the picture; negative ones too.
    ///
    /// In the middle of equal shares of 0 ..= 65534, so that the mean over a mask is the level itself, to half a share:
    /// 1/512 of the step between two colours for blue noise, 1/128 for Bayer's.
    #[inline]
    pub fn threshold(self, x: i32, y: i32) -> u16 {
        match self {
            Dither::None => 32767,
            Dither::Ordered => {
                let rank = BAYER[(((y & 7) << 3) | (x & 7)) as usize];
                ((rank as u16) << 10) + (1 << 9)
            }
            Dither::BlueNoise => {
                let value = BLUE_NOISE[(((y & 63) << 6) | (x & 63)) as usize];
                ((value as u16) << 8) + (1 << 7)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bayer_is_the_published_matrix() {
        let corner = |x, y| Dither::Ordered.threshold(x, y) >> 10;
        assert_eq!([0, 1, 2, 3].map(|x| corner(x, 0)), [0, 32, 8, 40]);
        assert_eq!([0, 1, 2, 3].map(|x| corner(x, 1)), [48, 16, 56, 24]);
        assert_eq!([0, 1, 2, 3].map(|x| corner(x, 2)), [12, 44, 4, 36]);
        assert_eq!([0, 1, 2, 3].map(|x| corner(x, 3)), [60, 28, 52, 20]);
    }

    #[test]
    fn every_threshold_comes_equally_often() {
        let mut counts = [[0; 256]; 2];
        for i in 0..64 * 64 {
            counts[0][(Dither::Ordered.threshold(i % 64, i / 64) >> 10) as usize] += 1;
            counts[1][(Dither::BlueNoise.threshold(i % 64, i / 64) >> 8) as usize] += 1;
        }
        assert!(counts[0][..64].iter().all(|n| *n == 64));
        assert!(counts[1].iter().all(|n| *n == 16));
    }

    #[test]
    fn masks_repeat_on_both_sides_of_zero() {
        for dither in [Dither::Ordered, Dither::BlueNoise] {
            assert_eq!(dither.threshold(-1, -3), dither.threshold(63, 61));
            assert_eq!(dither.threshold(i32::MIN, i32::MAX), dither.threshold(0, 63));
        }
    }
}
