use super::input::{Wide, beside, see};
use super::{CHANNELS, HEAD, Input, LEVELS, Network, Packed, Row, SEEN, Scratch, Shape, exposure};
use crate::film::Feature;
use crate::film::denoise::Pair;
use zerocopy::{FromBytes, IntoBytes};

impl Network<'_> {
    /// The heads of all sizes, from what `input` says of pixel number i.
    pub fn extract(&mut self, pair: &impl Pair, input: impl Fn(usize) -> Input + Sync) {
        let seen = |first, row: Row| {
            let mut before = None;
            row.fill(|x| {
                let [bright, still @ ..] = input(first + x).words();
                let differs = before != Some(still);
                before = Some(still);
                (bright, differs.then_some(still))
            });
        };
        let beside = |first, row: &mut [Wide]| {
            for (x, [_, own @ ..]) in row.iter_mut().enumerate() {
                *own = input(first + x).own();
            }
        };
        self.extract_by(pair, seen, beside);
    }

    /// The heads of all sizes of a frame, from how many `samples` are in pixel number i's mean.
    pub fn extract_frame(
        &mut self,
        pair: &impl Pair,
        frame: &[Feature],
        samples: impl Fn(usize) -> u32 + Sync,
    ) {
        let exposure = exposure(frame);
        let from = |first: usize| frame.get(first..).unwrap_or(&[]);
        let seen = |first, row: Row| see(from(first), |x| samples(first + x), exposure, row);
        let beside = |first, row: &mut [Wide]| beside(from(first), |x| samples(first + x), row);
        self.extract_by(pair, seen, beside);
    }

    /// From what `input` makes of a row from pixel number i on, and what `beside` puts beside its activations for the heads.
    fn extract_by(
        &mut self,
        pair: &impl Pair,
        input: impl Fn(usize, Row) + Sync,
        beside: impl Fn(usize, &mut [Wide]) + Sync,
    ) {
        let Network {
            weights,
            shape,
            scratch: Scratch { fine, near, far },
        } = self;
        let count = |level: usize| CHANNELS[level] * shape[level].pixels();
        let (half, rings) = near.as_mut_bytes().split_at_mut(count(1));
        // Whole words, both.
        let (coarse, words) = far.split_at_mut((count(2) + count(3)) / 4);
        let (eighth, quarter) = coarse.as_mut_bytes().split_at_mut(count(3));
        let (one, two) = rings.split_at_mut(Shape::ring(shape[0].width));
        let mut rings = [one, two];
        let mut activations = [fine.as_flattened_mut(), half, quarter, eighth];

        // Down: what is seen, then the largest activation of each 2 × 2, convolved.
        let (packed, _) = weights.pack(0, words);
        let width = shape[0].width;
        let see = |y: usize, _: &[u8], row: &mut [u8]| input(y * width, packed.row(row));
        let layer = Convolution {
            packed,
            shape: shape[0],
            inputs: SEEN,
            outputs: CHANNELS[0],
        };
        // The finest activations stand where their row's heads will.
        layer.run(pair, &mut rings, activations[0], see, Plain);
        for level in 1..LEVELS {
            let (packed, _) = weights.pack(level, words);
            let [fine, coarse] = neighbours(&mut activations, level - 1);
            let (inputs, finer) = (CHANNELS[level - 1], shape[level - 1]);
            let line = fine.len() / finer.height;
            let pool = |y: usize, _: &[u8], row: &mut [u8]| pool(fine, line, inputs, finer, y, row);
            let layer = Convolution {
                packed,
                shape: shape[level],
                inputs,
                outputs: CHANNELS[level],
            };
            layer.run(pair, &mut rings, coarse, pool, Plain);
        }

        // Once more at the coarsest size, in place.
        let bottom = LEVELS - 1;
        let (packed, _) = weights.pack(LEVELS, words);
        let layer = Convolution {
            packed,
            shape: shape[bottom],
            inputs: CHANNELS[bottom],
            outputs: CHANNELS[bottom],
        };
        let fill = |_: usize, own: &[u8], row: &mut [u8]| row.copy_from_slice(own);
        layer.run(pair, &mut rings, activations[bottom], fill, Plain);

        // Up: the coarser size and this one's own activations merged, convolved in place; the finest heads on the way.
        for level in (0..bottom).rev() {
            let (merge, rest) = weights.pack(5 + 2 * (bottom - 1 - level), words);
            let (packed, rest) = weights.pack(6 + 2 * (bottom - 1 - level), rest);
            let [fine, coarse] = neighbours(&mut activations, level);
            let (own, coarse_inputs) = (CHANNELS[level], CHANNELS[level + 1]);
            let coarse_row = coarse_inputs * shape[level + 1].width;
            let fill = |y: usize, own_row: &[u8], row: &mut [u8]| {
                let above = &coarse[(y >> 1) * coarse_row..][..coarse_row];
                merge.merge(
                    above,
                    coarse_inputs,
                    &own_row[..row.len()],
                    shape[level].width,
                    row,
                );
            };
            let layer = Convolution {
                packed,
                shape: shape[level],
                inputs: own,
                outputs: own,
            };
            if level > 0 {
                layer.run(pair, &mut rings, fine, fill, Plain);
            } else {
                let (head, _) = weights.pack(11, rest);
                let beside = |y: usize, row: &mut [Wide]| beside(y * width, row);
                layer.run(pair, &mut rings, fine, fill, Finest { head, beside });
            }
        }

        // The coarser heads: those of a quarter of the size after those of half of it, the others in their activations' place.
        let (eighth, quarter) = coarse.as_mut_bytes().split_at_mut(count(3));
        weights.pack(14, words).0.squeeze(eighth);
        let half = near.as_mut_bytes();
        weights.pack(12, words).0.squeeze(&mut half[..count(1)]);
        let (_, places) = half.split_at_mut(HEAD * shape[1].pixels());
        let (head, _) = weights.pack(13, words);
        let (places, _) = places.as_chunks_mut();
        head.heads(quarter, &mut places[..shape[2].pixels()]);
    }

    /// The heads of size `level` (0 is the finest), after [`Self::extract`]: features as `i8`, confidence, blend.
    pub fn heads(&self, level: usize) -> &[[u8; HEAD]] {
        let [fine, half, quarter, eighth] = self.shape.map(Shape::pixels);
        let near = self.scratch.near.as_bytes().as_chunks().0;
        match level {
            0 => &self.scratch.fine[..fine],
            1 => &near[..half],
            2 => &near[half..][..quarter],
            _ => &self.scratch.far.as_bytes().as_chunks().0[..eighth],
        }
    }
}

/// The parts at `level` and `level + 1`.
fn neighbours<'p>(parts: &'p mut [&mut [u8]; LEVELS], level: usize) -> [&'p mut [u8]; 2] {
    let (fine, coarse) = parts.split_at_mut(level + 1);
    [&mut *fine[level], &mut *coarse[0]]
}

/// What becomes of a layer's activations.
trait Top: Sync {
    /// Whether it is heads.
    const HEADS: bool;

    /// The heads of row y from its activations; `wide` has a place for each pixel.
    fn heads(&self, y: usize, activations: &[u8], wide: &mut [Wide], heads: &mut [[u8; HEAD]]);
}

/// They stay.
struct Plain;

impl Top for Plain {
    const HEADS: bool = false;

    fn heads(&self, _: usize, _: &[u8], _: &mut [Wide], _: &mut [[u8; HEAD]]) {}
}

/// The finest heads, and what puts a row's own inputs beside its activations.
struct Finest<'a, B> {
    head: Packed<'a>,
    beside: B,
}

impl<B: Fn(usize, &mut [Wide]) + Sync> Top for Finest<'_, B> {
    const HEADS: bool = true;

    #[inline(always)]
    fn heads(&self, y: usize, activations: &[u8], wide: &mut [Wide], heads: &mut [[u8; HEAD]]) {
        (self.beside)(y, wide);
        for ([own, ..], four) in wide.iter_mut().zip(activations.as_chunks().0) {
            *own = u32::from_le_bytes(*four);
        }
        self.head.heads(wide.as_bytes(), heads);
    }
}

/// A 3 × 3 layer over a picture.
struct Convolution<'a> {
    packed: Packed<'a>,
    shape: Shape,
    inputs: usize,
    outputs: usize,
}

impl Convolution<'_> {
    /// Runs over the rows of `plane`, which hold outputs or their heads afterwards and have room for as much at least: `fill`
    /// makes the layer's input of row number y and of what stands in that row.
    ///
    /// A row's outputs are made when it and the next were read, and each half's nearest row is read before the other half
    /// begins.
    fn run<T: Top>(
        &self,
        pair: &impl Pair,
        rings: &mut [&mut [u8]; 2],
        plane: &mut [u8],
        fill: impl Fn(usize, &[u8], &mut [u8]) + Sync,
        top: T,
    ) {
        let Shape { width, height } = self.shape;
        let (seen, made, line) = (self.inputs * width, self.outputs * width, plane.len() / height);
        let half = height.div_ceil(2);
        let (upper, lower) = plane.split_at_mut(half * line);
        let [one, two] = rings.each_mut().map(|ring| Ring::new(ring, seen, made));
        if half < height {
            fill(half, &lower[..line], &mut *one.beyond);
            fill(half - 1, &upper[(half - 1) * line..], &mut *two.rows[0]);
        }
        let band = |first: usize, rows: &mut [u8], ring: Ring| {
            let Ring {
                rows: [mut above, mut at, mut below],
                beyond,
                out,
                wide,
            } = ring;
            if let Some(row) = rows.get(..line) {
                fill(first, row, at);
            }
            let mut rest = rows;
            let mut y = first;
            while let Some((row, next)) = rest.split_at_mut_checked(line) {
                let is_last = y + 1 == height;
                if !next.is_empty() {
                    fill(y + 1, &next[..line], below);
                } else if !is_last {
                    below.copy_from_slice(beyond);
                }
                let three = [
                    if y == 0 { &*at } else { &*above },
                    &*at,
                    if is_last { &*at } else { &*below },
                ];
                if T::HEADS {
                    self.packed.convolve(three, width, out);
                    top.heads(y, out, wide, row.as_chunks_mut().0);
                } else {
                    self.packed.convolve(three, width, &mut row[..made]);
                }
                (above, at, below) = (at, below, above);
                rest = next;
                y += 1;
            }
        };
        pair.both(|| band(0, upper, one), || band(half, lower, two));
    }
}

/// A worker's rows.
struct Ring<'a> {
    /// Three inputs: above, at and below.
    rows: [&'a mut [u8]; 3],
    /// The input below the worker's last row.
    beyond: &'a mut [u8],
    /// An output.
    out: &'a mut [u8],
    /// The finest size's, and what is beside it.
    wide: &'a mut [Wide],
}

impl<'a> Ring<'a> {
    fn new(bytes: &'a mut [u8], seen: usize, made: usize) -> Ring<'a> {
        let (above, rest) = bytes.split_at_mut(seen);
        let (at, rest) = rest.split_at_mut(seen);
        let (below, rest) = rest.split_at_mut(seen);
        let (beyond, rest) = rest.split_at_mut(seen);
        let (out, rest) = rest.split_at_mut(made);
        Ring {
            rows: [above, at, below],
            beyond,
            out,
            // Three words where an output of the finest size has one: there are always so many, and other layers need none.
            wide: <[Wide]>::mut_from_bytes(rest.get_mut(..3 * made).unwrap_or(&mut [])).unwrap_or(&mut []),
        }
    }
}

/// The largest of each 2 × 2 pixels, channel by channel; a row or column that is not there is the last.
///
/// `line` is how many bytes lie between rows.
fn pool(fine: &[u8], line: usize, channels: usize, shape: Shape, y: usize, row: &mut [u8]) {
    let upper = &fine[2 * y * line..][..channels * shape.width];
    let lower = &fine[(2 * y + 1).min(shape.height - 1) * line..][..channels * shape.width];
    let words = [upper, lower].map(<[u32]>::ref_from_bytes);
    if let ([Ok(upper), Ok(lower)], Ok(row)) = (words, <[u32]>::mut_from_bytes(row)) {
        return match channels / 4 {
            1 => pool_words::<1>([upper, lower], row),
            2 => pool_words::<2>([upper, lower], row),
            _ => pool_words::<3>([upper, lower], row),
        };
    }
    for (x, out) in row.chunks_exact_mut(channels).enumerate() {
        let (left, right) = (2 * x * channels, (2 * x + 1).min(shape.width - 1) * channels);
        for (c, out) in out.iter_mut().enumerate() {
            let above = upper[left + c].max(upper[right + c]);
            *out = above.max(lower[left + c]).max(lower[right + c]);
        }
    }
}

/// Four channels at once, of pixels of `N` words.
fn pool_words<const N: usize>(rows: [&[u32]; 2], row: &mut [u32]) {
    let [(upper, above), (lower, below)] = rows.map(|row| row.as_chunks::<N>().0.as_chunks::<2>());
    let mut outs = row.as_chunks_mut::<N>().0.iter_mut();
    for (([a, b], [c, d]), out) in upper.iter().zip(lower).zip(&mut outs) {
        *out = core::array::from_fn(|i| largest(largest(a[i], b[i]), largest(c[i], d[i])));
    }
    // The last of an odd row stands by itself.
    if let ([a], [b], Some(out)) = (above, below, outs.next()) {
        *out = core::array::from_fn(|i| largest(a[i], b[i]));
    }
}

/// Of four bytes under 128 each.
#[inline(always)]
fn largest(a: u32, b: u32) -> u32 {
    const TOPS: u32 = 0x8080_8080;
    // No byte borrows from the next; those of a are the larger where the top bit stays.
    let stays = ((a | TOPS) - b) & TOPS;
    b ^ ((a ^ b) & (stays - (stays >> 7)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_are_pooled_as_one_is() {
        let all = [0, 1, 2, 31, 62, 63];
        for (a, b) in all.iter().flat_map(|a| all.map(|b| (*a, b))) {
            let largest = largest(
                u32::from_le_bytes([a, b, 63, 0]),
                u32::from_le_bytes([b, a, 0, 63]),
            );
            let most = a.max(b);
            assert_eq!(largest.to_le_bytes(), [most, most, 63, 63], "{a} {b}");
        }
    }

    /// Bytes that are words, and bytes that are not.
    #[test]
    fn wherever_it_lies_a_row_is_pooled() {
        let mut bytes = [0; 4 * 100];
        for (at, byte) in bytes.iter_mut().enumerate() {
            *byte = (at * 37 % 64) as u8;
        }
        let mut words = [0u32; 101];
        let shape = Shape { width: 5, height: 5 };
        for y in 0..3 {
            let rows = [0, 1, 4].map(|from| {
                let fine = &mut words.as_mut_bytes()[from..][..400];
                fine.copy_from_slice(&bytes);
                let mut row = [[0u32; 2]; 3];
                pool(fine, 80, 8, shape, y, row.as_mut_bytes());
                row
            });
            assert!(rows[0] == rows[1] && rows[0] == rows[2], "{y}");
            let at = |x: usize, y: usize, c: usize| bytes[y.min(4) * 80 + x.min(4) * 8 + c];
            for (x, pixel) in rows[0].iter().enumerate() {
                for (c, byte) in pixel.as_bytes().iter().enumerate() {
                    let four = [(0, 0), (1, 0), (0, 1), (1, 1)];
                    let four = four.map(|(i, j)| at(2 * x + i, 2 * y + j, c));
                    assert_eq!(Some(byte), four.iter().max(), "{x} {y} {c}");
                }
            }
        }
    }
}
