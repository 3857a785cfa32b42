use super::layer::Packed;
use super::{CHANNELS, HEAD, INPUTS, Input, LEVELS, Network, Scratch, Shape, exposure};
use crate::film::Feature;
use crate::film::denoise::Pair;
use zerocopy::IntoBytes;

impl Network<'_> {
    /// The heads of all sizes, from what `input` says of pixel number i.
    pub fn extract(&mut self, pair: &impl Pair, input: impl Fn(usize) -> Input + Sync) {
        self.extract_by(pair, |at, _| input(at));
    }

    /// The heads of all sizes of a frame, from how many `samples` are in pixel number i's mean.
    pub fn extract_frame(
        &mut self,
        pair: &impl Pair,
        frame: &[Feature],
        samples: impl Fn(usize) -> u32 + Sync,
    ) {
        let exposure = exposure(frame);
        self.extract_by(pair, |at, before| {
            let pixel = |at: usize| frame.get(at).copied().unwrap_or_default();
            let before = before.map(|seen| (pixel(at - 1), seen));
            Input::beside(&pixel(at), samples(at), exposure, before)
        });
    }

    /// From what `input` says of pixel number i and, if there is one, what it said of the pixel before in the row.
    fn extract_by(&mut self, pair: &impl Pair, input: impl Fn(usize, Option<Input>) -> Input + Sync) {
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
        let see = |y: usize, _: &[u8], row: &mut [u8]| {
            let mut before = None;
            for (x, pixel) in row.as_chunks_mut().0.iter_mut().enumerate() {
                let seen = input(y * width + x, before);
                *pixel = seen.0;
                before = Some(seen);
            }
        };
        // The finest activations stand where their row's heads will.
        let keep = |row: &[u8], place: &mut [u8]| place[..row.len()].copy_from_slice(row);
        let layer = Convolution {
            packed,
            shape: shape[0],
            inputs: INPUTS,
            outputs: CHANNELS[0],
        };
        layer.run(pair, &mut rings, activations[0], see, keep);
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
            layer.run(pair, &mut rings, coarse, pool, keep);
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
        layer.run(pair, &mut rings, activations[bottom], fill, keep);

        // Up: the coarser size and this one's own activations merged, convolved in place; the finest heads on the way.
        for level in (0..bottom).rev() {
            let (merge, rest) = weights.pack(5 + 2 * (bottom - 1 - level), words);
            let (packed, rest) = weights.pack(6 + 2 * (bottom - 1 - level), rest);
            let [fine, coarse] = neighbours(&mut activations, level);
            let (own, coarse_inputs) = (CHANNELS[level], CHANNELS[level + 1]);
            let coarse_row = coarse_inputs * shape[level + 1].width;
            let fill = |y: usize, own_row: &[u8], row: &mut [u8]| {
                let above = &coarse[(y >> 1) * coarse_row..][..coarse_row];
                merge.merge(above, coarse_inputs, &own_row[..row.len()], row);
            };
            let layer = Convolution {
                packed,
                shape: shape[level],
                inputs: own,
                outputs: own,
            };
            if level > 0 {
                layer.run(pair, &mut rings, fine, fill, keep);
            } else {
                let (head, _) = weights.pack(11, rest);
                let keep = |row: &[u8], place: &mut [u8]| {
                    head.heads(row, place.as_chunks_mut().0);
                };
                layer.run(pair, &mut rings, fine, fill, keep);
            }
        }

        // The coarser heads: those of a quarter of the size after those of half of it, the others in their activations' place.
        let (eighth, quarter) = coarse.as_mut_bytes().split_at_mut(count(3));
        squeeze(&weights.pack(14, words).0, eighth);
        let half = near.as_mut_bytes();
        squeeze(&weights.pack(12, words).0, &mut half[..count(1)]);
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

/// Activations to heads, from the start on: none is narrower than a head.
fn squeeze(head: &Packed, activations: &mut [u8]) {
    for at in 0..activations.len() / head.inputs {
        let made = head.head(&activations[at * head.inputs..][..head.inputs]);
        activations[at * HEAD..][..HEAD].copy_from_slice(&made);
    }
}

/// The parts at `level` and `level + 1`.
fn neighbours<'p>(parts: &'p mut [&mut [u8]; LEVELS], level: usize) -> [&'p mut [u8]; 2] {
    let (fine, coarse) = parts.split_at_mut(level + 1);
    [&mut *fine[level], &mut *coarse[0]]
}

/// A 3 × 3 layer over a picture.
struct Convolution<'a> {
    packed: Packed<'a>,
    shape: Shape,
    inputs: usize,
    outputs: usize,
}

impl Convolution<'_> {
    /// Runs over the rows of `plane`, which hold outputs afterwards and have room for as much at least: `fill` makes the
    /// layer's input of row number y and of what stands in that row, and `keep` puts its output there.
    ///
    /// A row is put when it and the next were read, and each half's nearest row is read before the other half begins.
    fn run(
        &self,
        pair: &impl Pair,
        rings: &mut [&mut [u8]; 2],
        plane: &mut [u8],
        fill: impl Fn(usize, &[u8], &mut [u8]) + Sync,
        keep: impl Fn(&[u8], &mut [u8]) + Sync,
    ) {
        let Shape { width, height } = self.shape;
        let (seen, made, line) = (self.inputs * width, self.outputs * width, plane.len() / height);
        let half = height.div_ceil(2);
        let (upper, lower) = plane.split_at_mut(half * line);
        let [one, two] = rings.each_mut().map(|ring| Ring::new(ring, seen, made));
        if half < height {
            fill(half, &lower[..line], &mut *one.beyond);
            fill(
                half - 1,
                &upper[(half - 1) * line..],
                &mut two.rows[(half - 1) % 3 * seen..][..seen],
            );
        }
        let band = |first: usize, rows: &mut [u8], ring: Ring| {
            let Ring {
                rows: near,
                beyond,
                out,
            } = ring;
            let at = |y: usize| y % 3 * seen..(y % 3 + 1) * seen;
            let end = first + rows.len() / line;
            for y in first..end {
                if y == first {
                    fill(y, &rows[..line], &mut near[at(y)]);
                }
                if y + 1 < end {
                    fill(
                        y + 1,
                        &rows[(y + 1 - first) * line..][..line],
                        &mut near[at(y + 1)],
                    );
                } else if y + 1 < height {
                    near[at(y + 1)].copy_from_slice(beyond);
                }
                let three = [y.saturating_sub(1), y, (y + 1).min(height - 1)];
                self.packed.convolve(three.map(|y| &near[at(y)]), out);
                keep(out, &mut rows[(y - first) * line..][..line]);
            }
        };
        pair.both(|| band(0, upper, one), || band(half, lower, two));
    }
}

/// A worker's rows.
struct Ring<'a> {
    /// Three inputs; row y is number y modulo 3.
    rows: &'a mut [u8],
    /// The input below the worker's last row.
    beyond: &'a mut [u8],
    /// An output.
    out: &'a mut [u8],
}

impl<'a> Ring<'a> {
    fn new(bytes: &'a mut [u8], seen: usize, made: usize) -> Ring<'a> {
        let (rows, rest) = bytes.split_at_mut(3 * seen);
        let (beyond, rest) = rest.split_at_mut(seen);
        Ring {
            rows,
            beyond,
            out: &mut rest[..made],
        }
    }
}

/// The largest of each 2 × 2 pixels, channel by channel; a row or column that is not there is the last.
///
/// `line` is how many bytes lie between rows.
fn pool(fine: &[u8], line: usize, channels: usize, shape: Shape, y: usize, row: &mut [u8]) {
    let upper = &fine[2 * y * line..][..line];
    let lower = &fine[(2 * y + 1).min(shape.height - 1) * line..][..line];
    for (x, out) in row.chunks_exact_mut(channels).enumerate() {
        let (left, right) = (2 * x * channels, (2 * x + 1).min(shape.width - 1) * channels);
        for (c, out) in out.iter_mut().enumerate() {
            let above = upper[left + c].max(upper[right + c]);
            *out = above.max(lower[left + c]).max(lower[right + c]);
        }
    }
}
