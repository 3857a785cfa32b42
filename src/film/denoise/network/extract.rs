use super::layer::Packed;
use super::{CHANNELS, HEAD, INPUTS, Input, LEVELS, Network, Shape};

/// Activations and heads, cut out of the caller's bytes. The finest heads stand where its activations stood.
pub(super) struct Cut<'a> {
    pub ring: &'a mut [u8],
    pub activations: [&'a mut [u8]; LEVELS],
    /// Empty at the finest size.
    pub heads: [&'a mut [u8]; LEVELS],
}

impl<'a> Cut<'a> {
    pub fn new(bytes: &'a mut [u8], shape: &[Shape; LEVELS]) -> Cut<'a> {
        let (ring, mut rest) = bytes.split_at_mut(Shape::ring(shape[0].width));
        let mut take = |count: usize| {
            let (part, others) = core::mem::take(&mut rest).split_at_mut(count);
            rest = others;
            part
        };
        let activations = core::array::from_fn(|level| take(CHANNELS[level] * shape[level].pixels()));
        let heads = core::array::from_fn(|level| {
            let pixels = if level == 0 { 0 } else { shape[level].pixels() };
            take(HEAD * pixels)
        });
        Cut {
            ring,
            activations,
            heads,
        }
    }
}

impl Network<'_> {
    /// The heads of all sizes, from what `input` says of each pixel (row by row, each asked once).
    pub fn extract(&mut self, mut input: impl FnMut(usize) -> Input) {
        let Network {
            weights,
            shape,
            scratch,
        } = self;
        let Cut {
            ring,
            mut activations,
            heads,
        } = Cut::new(scratch.bytes, shape);

        // Down: what is seen, then the largest activation of each 2 × 2, convolved.
        let (packed, _) = weights.pack(0, scratch.words);
        let width = shape[0].width;
        let see = |_: &mut &mut [u8], y: usize, row: &mut [u8]| {
            for (x, pixel) in row.chunks_exact_mut(INPUTS).enumerate() {
                pixel.copy_from_slice(&input(y * width + x).0);
            }
        };
        let keep = |all: &mut &mut [u8], y: usize, row: &[u8]| {
            all[y * row.len()..][..row.len()].copy_from_slice(row);
        };
        convolve(
            &packed,
            shape[0],
            INPUTS,
            CHANNELS[0],
            ring,
            &mut activations[0],
            see,
            keep,
        );
        for level in 1..LEVELS {
            let (packed, _) = weights.pack(level, scratch.words);
            let [fine, coarse] = pair(&mut activations, level - 1);
            let (inputs, finer) = (CHANNELS[level - 1], shape[level - 1]);
            let pool = |_: &mut &mut [u8], y: usize, row: &mut [u8]| pool(fine, inputs, finer, y, row);
            convolve(
                &packed,
                shape[level],
                inputs,
                CHANNELS[level],
                ring,
                coarse,
                pool,
                keep,
            );
        }

        // Once more at the coarsest size, in place: a row is written when it and the next were read.
        let bottom = LEVELS - 1;
        let (packed, rest) = weights.pack(LEVELS, scratch.words);
        let (head, _) = weights.pack(11 + bottom, rest);
        let fill = |all: &mut &mut [u8], y: usize, row: &mut [u8]| {
            row.copy_from_slice(&all[y * row.len()..][..row.len()]);
        };
        let (inputs, coarsest) = (CHANNELS[bottom], shape[bottom]);
        convolve(
            &packed,
            coarsest,
            inputs,
            inputs,
            ring,
            &mut activations[bottom],
            fill,
            keep,
        );
        put_heads(&head, activations[bottom], inputs, heads[bottom]);

        // Up: the coarser size and this one's own activations merged, convolved in place, and read by the head.
        for level in (0..bottom).rev() {
            let (merge, rest) = weights.pack(5 + 2 * (bottom - 1 - level), scratch.words);
            let (packed, rest) = weights.pack(6 + 2 * (bottom - 1 - level), rest);
            let (head, _) = weights.pack(11 + level, rest);
            let [fine, coarse] = pair(&mut activations, level);
            let (own, coarse_inputs) = (CHANNELS[level], CHANNELS[level + 1]);
            let coarse_row = coarse_inputs * shape[level + 1].width;
            let fill = |all: &mut &mut [u8], y: usize, row: &mut [u8]| {
                let above = &coarse[(y >> 1) * coarse_row..][..coarse_row];
                merge.merge(above, coarse_inputs, &all[y * row.len()..][..row.len()], row);
            };
            if level > 0 {
                convolve(&packed, shape[level], own, own, ring, fine, fill, keep);
                put_heads(&head, fine, own, heads[level]);
            } else {
                let keep = |all: &mut &mut [u8], y: usize, row: &[u8]| {
                    put_heads(&head, row, own, &mut all[y * row.len()..][..row.len()]);
                };
                convolve(&packed, shape[0], own, own, ring, fine, fill, keep);
            }
        }
    }

    /// The heads of size `level` (0 is the finest), after [`Self::extract`]: six features as `i8`, confidence, blend.
    pub fn heads(&mut self, level: usize) -> &[[u8; HEAD]] {
        let level = level.min(LEVELS - 1);
        let Cut {
            activations, heads, ..
        } = Cut::new(self.scratch.bytes, &self.shape);
        let mut parts = if level == 0 { activations } else { heads };
        let part: &mut [u8] = core::mem::take(&mut parts[level]);
        part.as_chunks().0
    }
}

/// The parts at `level` and `level + 1`.
fn pair<'p, 'a>(parts: &'p mut [&'a mut [u8]; LEVELS], level: usize) -> [&'p mut &'a mut [u8]; 2] {
    let (fine, coarse) = parts.split_at_mut(level + 1);
    [&mut fine[level], &mut coarse[0]]
}

/// Runs a 3 × 3 layer over a picture whose rows `fill` makes, each once and in order, and `keep` takes; row y is taken
/// after row y + 1 was made, so both may use the same memory.
#[allow(clippy::too_many_arguments)]
fn convolve<S>(
    packed: &Packed,
    shape: Shape,
    inputs: usize,
    outputs: usize,
    ring: &mut [u8],
    state: &mut S,
    mut fill: impl FnMut(&mut S, usize, &mut [u8]),
    mut keep: impl FnMut(&mut S, usize, &[u8]),
) {
    let Shape { width, height } = shape;
    let (ring, rest) = ring.split_at_mut(3 * inputs * width);
    let out = &mut rest[..outputs * width];
    let row = |y: usize| (y % 3) * inputs * width..(y % 3 + 1) * inputs * width;
    fill(state, 0, &mut ring[row(0)]);
    for y in 0..height {
        if y + 1 < height {
            fill(state, y + 1, &mut ring[row(y + 1)]);
        }
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)];
        packed.convolve(rows.map(|y| &ring[row(y)]), out);
        keep(state, y, out);
    }
}

/// The largest of each 2 × 2 pixels, channel by channel; a row or column that is not there is the last.
fn pool(fine: &[u8], channels: usize, shape: Shape, y: usize, row: &mut [u8]) {
    let line = channels * shape.width;
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

fn put_heads(head: &Packed, pixels: &[u8], channels: usize, out: &mut [u8]) {
    for (pixel, out) in pixels.chunks_exact(channels).zip(out.as_chunks_mut::<HEAD>().0) {
        *out = head.head(pixel);
    }
}
