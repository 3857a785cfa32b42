//! The network and its filter in `f32`, with what each step hands back: gradients by hand, for a CPU of few cores.
//!
//! All numbers are those of the core's integers: weights in 64ths, activations in 16ths, sums in 1024ths, features in
//! eighths, confidence and blend in 256ths. With [`Mode::Integer`] each is rounded where the core rounds it, and since
//! every sum is a whole number below 2^24, heads are the core's bit for bit. Backwards rounding counts as no change
//! (straight through).

use microlux::film::denoise::network::{EXP, FEATURES, HEAD, INPUTS, LEVELS, LIGHTS};
use wide::f32x8;

use crate::size::Size;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Nothing is rounded.
    Float,
    /// Weights and activations are rounded as in the core.
    Integer,
}

/// Weights and biases in the core's order and units, not yet rounded.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub size: Size,
    pub weights: Vec<f32>,
    pub biases: Vec<f32>,
}

impl Params {
    pub fn zero(size: Size) -> Params {
        let (weights, biases) = size.place(size.layers().len());
        Params {
            size,
            weights: vec![0.0; weights],
            biases: vec![0.0; biases],
        }
    }

    /// As the forward pass uses them.
    pub fn seen(&self, mode: Mode) -> Params {
        match mode {
            Mode::Float => self.clone(),
            Mode::Integer => Params {
                size: self.size,
                weights: self
                    .weights
                    .iter()
                    .map(|w| w.round().clamp(-127.0, 127.0))
                    .collect(),
                biases: self
                    .biases
                    .iter()
                    .map(|b| b.round().clamp(-32768.0, 32767.0))
                    .collect(),
            },
        }
    }
}

/// Channels of rows of numbers.
#[derive(Clone, Debug, Default)]
pub struct Planes {
    pub channels: usize,
    pub height: usize,
    pub width: usize,
    pub data: Vec<f32>,
}

impl Planes {
    pub fn new(channels: usize, height: usize, width: usize) -> Planes {
        Planes {
            channels,
            height,
            width,
            data: vec![0.0; channels * height * width],
        }
    }

    fn like(other: &Planes) -> Planes {
        Planes::new(other.channels, other.height, other.width)
    }

    /// The first `channels`, and the others.
    fn split(mut self, channels: usize) -> (Planes, Planes) {
        let data = self.data.split_off(channels * self.height * self.width);
        let rest = Planes {
            channels: self.channels - channels,
            data,
            ..self
        };
        self.channels = channels;
        (self, rest)
    }

    fn plane(&self, channel: usize) -> &[f32] {
        let size = self.height * self.width;
        &self.data[channel * size..][..size]
    }
}

const LANES: usize = 8;
type Lanes = f32x8;

#[inline(always)]
fn load(from: &[f32]) -> Lanes {
    let from: [f32; LANES] = from[..LANES].try_into().expect("eight");
    f32x8::from(from)
}

#[inline(always)]
fn fma(sum: &mut Lanes, a: &Lanes, b: &Lanes) {
    *sum = a.mul_add(*b, *sum);
}

/// Planes with an edge: each row `stride` long, a multiple of eight and some more.
struct Padded {
    stride: usize,
    rows: usize,
    data: Vec<f32>,
}

impl Padded {
    /// `edge` more on each side, repeated or zero; the width rounded up.
    fn of(planes: &Planes, edge: usize, repeat: bool) -> Padded {
        let (width, height) = (planes.width, planes.height);
        let stride = (width + 2 * edge).next_multiple_of(LANES) + LANES;
        let rows = height + 2 * edge;
        let mut data = vec![0.0; planes.channels * rows * stride];
        for c in 0..planes.channels {
            for y in 0..rows {
                let inside = y >= edge && y < edge + height;
                if !inside && !repeat {
                    continue;
                }
                let from = &planes.plane(c)[y.saturating_sub(edge).min(height - 1) * width..][..width];
                let to = &mut data[(c * rows + y) * stride..][..stride];
                to[edge..edge + width].copy_from_slice(from);
                if repeat {
                    to[..edge].fill(from[0]);
                    to[edge + width..].fill(from[width - 1]);
                }
            }
        }
        Padded { stride, rows, data }
    }

    #[inline(always)]
    fn row(&self, channel: usize, y: usize) -> &[f32] {
        &self.data[(channel * self.rows + y) * self.stride..][..self.stride]
    }
}

/// 3 × 3 over padded planes, the outputs from `first` on: `out` is smaller by 2 each way. Weights `[tap][input][output]`.
///
/// Answers with how many outputs it made.
fn correlate<const OUT: usize>(
    input: &Padded,
    inputs: usize,
    weights: &[f32],
    bias: &[f32],
    first: usize,
    out: &mut Planes,
) -> usize {
    let (width, size, outputs) = (out.width, out.width * out.height, out.channels);
    let start: [f32; OUT] = core::array::from_fn(|o| bias.get(first + o).copied().unwrap_or(0.0));
    for y in 0..out.height {
        for x in (0..width).step_by(LANES) {
            let mut sums: [Lanes; OUT] = start.map(f32x8::splat);
            for ky in 0..3 {
                for i in 0..inputs {
                    let row = &input.row(i, y + ky)[x..x + LANES + 2];
                    for kx in 0..3 {
                        let v = load(&row[kx..]);
                        let w: &[f32; OUT] = weights[((ky * 3 + kx) * inputs + i) * outputs + first..][..OUT]
                            .try_into()
                            .expect("as many as outputs");
                        for o in 0..OUT {
                            fma(&mut sums[o], &v, &f32x8::splat(w[o]));
                        }
                    }
                }
            }
            let count = LANES.min(width - x);
            for (o, sum) in sums.iter().enumerate() {
                let at = (first + o) * size + y * width + x;
                out.data[at..][..count].copy_from_slice(&sum.to_array()[..count]);
            }
        }
    }
    OUT
}

fn correlate_any(input: &Padded, inputs: usize, weights: &[f32], bias: &[f32], out: &mut Planes) {
    let mut first = 0;
    while first < out.channels {
        let made = match out.channels - first {
            4 => correlate::<4>,
            8 => correlate::<8>,
            INPUTS => correlate::<INPUTS>,
            12 => correlate::<12>,
            _ => correlate::<16>,
        };
        first += made(input, inputs, weights, bias, first, out);
    }
}

/// Gradient of a 3 × 3 layer's weights (added to `grad`), for outputs `from..from + BLOCK`.
fn weigh<const BLOCK: usize>(
    input: &Padded,
    inputs: usize,
    d: &Padded,
    height: usize,
    outputs: usize,
    from: usize,
    grad: &mut [f32],
) {
    let blocks = d.stride / LANES - 1;
    for i in 0..inputs {
        for ky in 0..3 {
            let [mut left, mut middle, mut right] = [[f32x8::ZERO; BLOCK]; 3];
            for y in 0..height {
                let row = &input.row(i, y + ky)[..blocks * LANES + 2];
                let rows: [&[f32]; BLOCK] = core::array::from_fn(|o| &d.row(from + o, y)[..blocks * LANES]);
                for x in (0..blocks * LANES).step_by(LANES) {
                    let v = &row[x..x + LANES + 2];
                    let (a, b, c) = (load(v), load(&v[1..]), load(&v[2..]));
                    for o in 0..BLOCK {
                        let g = load(&rows[o][x..x + LANES]);
                        fma(&mut left[o], &a, &g);
                        fma(&mut middle[o], &b, &g);
                        fma(&mut right[o], &c, &g);
                    }
                }
            }
            let sums = [left, middle, right];
            for (kx, sums) in sums.iter().enumerate() {
                for (o, sum) in sums.iter().enumerate() {
                    grad[((ky * 3 + kx) * inputs + i) * outputs + from + o] += sum.reduce_add();
                }
            }
        }
    }
}

/// Backwards through a 3 × 3 layer: gradients of weights and biases are added, that of the input is returned if wanted.
fn convolve_back(
    input: &Planes,
    weights: &[f32],
    d: &Planes,
    wanted: bool,
    grad: &mut [f32],
    bias_grad: &mut [f32],
) -> Planes {
    let (inputs, outputs) = (input.channels, d.channels);
    let padded = Padded::of(input, 1, true);
    let plain = Padded::of(d, 0, false);
    // Beyond the width the gradient is zero, so what the padded input holds there does not count.
    let mut from = 0;
    while outputs - from >= 8 {
        weigh::<8>(&padded, inputs, &plain, d.height, outputs, from, grad);
        from += 8;
    }
    if outputs - from == 4 {
        weigh::<4>(&padded, inputs, &plain, d.height, outputs, from, grad);
    }
    for (o, b) in bias_grad.iter_mut().enumerate() {
        *b += d.plane(o).iter().sum::<f32>();
    }
    if !wanted {
        return Planes::default();
    }
    // The same layer turned around, over the input with its edge; then the edge is folded back.
    let mut turned = vec![0.0; weights.len()];
    for tap in 0..9 {
        for i in 0..inputs {
            for o in 0..outputs {
                turned[((8 - tap) * outputs + o) * inputs + i] = weights[(tap * inputs + i) * outputs + o];
            }
        }
    }
    let around = Padded::of(d, 2, false);
    let mut wide = Planes::new(inputs, input.height + 2, input.width + 2);
    correlate_any(&around, outputs, &turned, &[], &mut wide);
    let mut back = Planes::like(input);
    for c in 0..inputs {
        let plane = wide.plane(c);
        let size = input.height * input.width;
        for y in 0..wide.height {
            let to = y.saturating_sub(1).min(input.height - 1) * input.width;
            for x in 0..wide.width {
                let at = to + x.saturating_sub(1).min(input.width - 1);
                back.data[c * size + at] += plane[y * wide.width + x];
            }
        }
    }
    back
}

/// 1 × 1: weights `[input][output]`.
fn mix(input: &Planes, weights: &[f32], bias: &[f32], outputs: usize) -> Planes {
    let size = input.height * input.width;
    let mut out = Planes::new(outputs, input.height, input.width);
    for o in 0..outputs {
        let to = &mut out.data[o * size..][..size];
        to.fill(bias[o]);
        for i in 0..input.channels {
            let w = weights[i * outputs + o];
            for (to, from) in to.iter_mut().zip(input.plane(i)) {
                *to = w.mul_add(*from, *to);
            }
        }
    }
    out
}

fn mix_back(input: &Planes, weights: &[f32], d: &Planes, grad: &mut [f32], bias_grad: &mut [f32]) -> Planes {
    let mut back = Planes::like(input);
    let size = input.height * input.width;
    let outputs = d.channels;
    for o in 0..outputs {
        let from = d.plane(o);
        bias_grad[o] += from.iter().sum::<f32>();
        for i in 0..input.channels {
            let mut sums = f32x8::ZERO;
            let (a, b) = (input.plane(i).chunks_exact(LANES), from.chunks_exact(LANES));
            let rest: f32 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
            for (a, b) in a.zip(b) {
                fma(&mut sums, &load(a), &load(b));
            }
            grad[i * outputs + o] += sums.reduce_add() + rest;
            let w = weights[i * outputs + o];
            for (to, from) in back.data[i * size..][..size].iter_mut().zip(from) {
                *to = w.mul_add(*from, *to);
            }
        }
    }
    back
}

/// Sums to activations; what the gradient has to know is whether they were within range.
fn activate(sums: &mut Planes, mode: Mode) -> Vec<bool> {
    sums.data
        .iter_mut()
        .map(|s| {
            let a = *s / 64.0;
            *s = match mode {
                Mode::Float => a,
                Mode::Integer => (a + 0.5).floor(),
            }
            .clamp(0.0, 63.0);
            a > 0.0 && a < 63.5
        })
        .collect()
}

fn gate(d: &mut Planes, within: &[bool]) {
    for (d, &within) in d.data.iter_mut().zip(within) {
        *d = if within { *d / 64.0 } else { 0.0 };
    }
}

/// The largest of each 2 × 2, and where it was.
fn pool(fine: &Planes) -> (Planes, Vec<u32>) {
    let mut out = Planes::new(fine.channels, fine.height.div_ceil(2), fine.width.div_ceil(2));
    let mut from = Vec::with_capacity(out.data.len());
    let (size, coarse) = (fine.height * fine.width, out.height * out.width);
    for c in 0..fine.channels {
        for y in 0..out.height {
            for x in 0..out.width {
                let (mut most, mut at) = (f32::MIN, 0);
                for (dy, dx) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let (y, x) = (
                        (2 * y + dy).min(fine.height - 1),
                        (2 * x + dx).min(fine.width - 1),
                    );
                    let place = c * size + y * fine.width + x;
                    if fine.data[place] > most {
                        (most, at) = (fine.data[place], place);
                    }
                }
                out.data[c * coarse + y * out.width + x] = most;
                from.push(at as u32);
            }
        }
    }
    (out, from)
}

/// The coarser size, each pixel four times, then the finer one's own.
fn join(coarse: &Planes, fine: &Planes) -> Planes {
    let mut out = Planes::new(coarse.channels + fine.channels, fine.height, fine.width);
    let size = fine.height * fine.width;
    for c in 0..coarse.channels {
        let plane = coarse.plane(c);
        for y in 0..fine.height {
            let row = &plane[(y / 2) * coarse.width..][..coarse.width];
            let to = &mut out.data[c * size + y * fine.width..][..fine.width];
            for (x, to) in to.iter_mut().enumerate() {
                *to = row[x / 2];
            }
        }
    }
    out.data[coarse.channels * size..].copy_from_slice(&fine.data);
    out
}

/// A pixel's head: features, confidence, blend, and nothing.
pub type Head = [f32; LANES];

const CONFIDENCE: usize = FEATURES;
const BLEND: usize = FEATURES + 1;

/// Heads of one size, pixel by pixel, and whether confidence and blend were within range.
pub struct Heads {
    pub height: usize,
    pub width: usize,
    pub heads: Vec<Head>,
    within: Vec<[bool; 2]>,
}

/// What the forward pass of the extractor leaves for the way back.
pub struct Trace {
    light: Planes,
    /// What else is seen of a pixel.
    own: Planes,
    /// Of each size: activations on the way down, whether within range, and where the pool took its input from.
    down: Vec<(Planes, Vec<bool>)>,
    pooled: Vec<(Planes, Vec<u32>)>,
    bottom: (Planes, Vec<bool>),
    /// From coarse to fine: joined, merged, convolved.
    up: Vec<(Planes, (Planes, Vec<bool>), (Planes, Vec<bool>))>,
    pub heads: Vec<Heads>,
}

/// One layer's part of a table.
fn part<'p>(params: &'p Params, number: usize) -> (&'p [f32], &'p [f32]) {
    let (w, b) = params.size.place(number);
    let layer = params.size.layers()[number];
    (
        &params.weights[w..][..layer.weights()],
        &params.biases[b..][..layer.outputs],
    )
}

fn part_mut<'p>(params: &'p mut Params, number: usize) -> (&'p mut [f32], &'p mut [f32]) {
    let (w, b) = params.size.place(number);
    let layer = params.size.layers()[number];
    (
        &mut params.weights[w..][..layer.weights()],
        &mut params.biases[b..][..layer.outputs],
    )
}

fn convolve(params: &Params, number: usize, input: &Planes, mode: Mode) -> (Planes, Vec<bool>) {
    let (weights, bias) = part(params, number);
    let mut out = Planes::new(bias.len(), input.height, input.width);
    correlate_any(
        &Padded::of(input, 1, true),
        input.channels,
        weights,
        bias,
        &mut out,
    );
    let within = activate(&mut out, mode);
    (out, within)
}

/// The first layer: 3 × 3 of light, and what else is seen of the pixel itself.
fn see(params: &Params, light: &Planes, own: &Planes, mode: Mode) -> (Planes, Vec<bool>) {
    let (weights, bias) = part(params, 0);
    let outputs = bias.len();
    let (of_light, of_own) = weights.split_at(weights.len() - own.channels * outputs);
    let mut out = mix(own, of_own, bias, outputs);
    let mut more = Planes::like(&out);
    correlate_any(
        &Padded::of(light, 1, true),
        light.channels,
        of_light,
        &[],
        &mut more,
    );
    add(&mut out, &more);
    let within = activate(&mut out, mode);
    (out, within)
}

/// `params` as [`Params::seen`] has them; `input` in whole numbers 0 ..= 63.
pub fn extract(params: &Params, input: Planes, mode: Mode) -> Trace {
    assert_eq!(input.channels, INPUTS);
    let (light, own) = input.split(LIGHTS);
    let mut down = vec![see(params, &light, &own, mode)];
    let mut pooled = Vec::new();
    for level in 1..LEVELS {
        let (small, from) = pool(&down[level - 1].0);
        down.push(convolve(params, level, &small, mode));
        pooled.push((small, from));
    }
    let bottom = convolve(params, LEVELS, &down[LEVELS - 1].0, mode);
    let mut heads = vec![head(params, LEVELS - 1, &bottom.0, mode)];
    let mut up: Vec<(Planes, _, (Planes, Vec<bool>))> = Vec::new();
    for level in (0..LEVELS - 1).rev() {
        let step = LEVELS - 2 - level;
        let coarse = up.last().map_or(&bottom.0, |(_, _, (planes, _))| planes);
        let joined = join(coarse, &down[level].0);
        let (weights, bias) = part(params, 5 + 2 * step);
        let mut merged = mix(&joined, weights, bias, bias.len());
        let within = activate(&mut merged, mode);
        let convolved = convolve(params, 6 + 2 * step, &merged, mode);
        heads.push(if level > 0 {
            head(params, level, &convolved.0, mode)
        } else {
            head(params, 0, &beside(&convolved.0, &own), mode)
        });
        up.push((joined, (merged, within), convolved));
    }
    heads.reverse();
    Trace {
        light,
        own,
        down,
        pooled,
        bottom,
        up,
        heads,
    }
}

/// What the finest heads are made of: activations, and what is seen of the pixel itself unless its light is of one sample.
fn beside(activations: &Planes, own: &Planes) -> Planes {
    let mut all = activations.clone();
    all.channels += own.channels;
    let samples = own.plane(own.channels - 1);
    for channel in 0..own.channels {
        let seen = own.plane(channel).iter().zip(samples);
        all.data
            .extend(seen.map(|(x, samples)| if *samples > 0.0 { *x } else { 0.0 }));
    }
    all
}

fn head(params: &Params, level: usize, input: &Planes, mode: Mode) -> Heads {
    let (weights, bias) = part(params, 11 + level);
    let sums = mix(input, weights, bias, HEAD);
    let size = input.height * input.width;
    let round = |x: f32| {
        if mode == Mode::Integer {
            (x + 0.5).floor()
        } else {
            x
        }
    };
    let mut within = Vec::with_capacity(size);
    let heads = (0..size)
        .map(|at| {
            let sum = |c: usize| sums.data[c * size + at];
            let free = [CONFIDENCE, BLEND].map(|c| 128.0 + round(sum(c) / 16.0));
            within.push(free.map(|x| (0.0..=255.0).contains(&x)));
            core::array::from_fn(|c| match c {
                CONFIDENCE | BLEND => free[c - FEATURES].clamp(0.0, 255.0),
                c if c < FEATURES => round(sum(c) / 128.0).clamp(-128.0, 127.0),
                _ => 0.0,
            })
        })
        .collect();
    Heads {
        height: input.height,
        width: input.width,
        heads,
        within,
    }
}

/// Backwards from gradients of heads; those of weights and biases are added to `grad`.
pub fn extract_back(params: &Params, trace: &Trace, heads: &[Vec<Head>], grad: &mut Params) {
    // What comes down from the finer size, for the coarser one's convolved activations.
    let mut from_finer: Option<Planes> = None;
    let mut skips: Vec<Planes> = Vec::new();
    for level in 0..LEVELS - 1 {
        let step = LEVELS - 2 - level;
        let (joined, (merged, merged_within), (convolved, within)) = &trace.up[step];
        let (made, wanted) = (&trace.heads[level], &heads[level]);
        let mut d = if level > 0 {
            head_back(params, level, convolved, made, wanted, grad)
        } else {
            let all = beside(convolved, &trace.own);
            let (d, _) = head_back(params, 0, &all, made, wanted, grad).split(convolved.channels);
            d
        };
        if let Some(more) = from_finer.take() {
            add(&mut d, &more);
        }
        gate(&mut d, within);
        let (weights, _) = part(params, 6 + 2 * step);
        let (gw, gb) = part_mut(grad, 6 + 2 * step);
        let mut d = convolve_back(merged, weights, &d, true, gw, gb);
        gate(&mut d, merged_within);
        let (weights, _) = part(params, 5 + 2 * step);
        let (gw, gb) = part_mut(grad, 5 + 2 * step);
        let d = mix_back(joined, weights, &d, gw, gb);
        // Apart again: four fine pixels to one coarse one, and the skip.
        let size = d.height * d.width;
        let [channels, coarse_channels] = [level, level + 1].map(|level| params.size.channels()[level]);
        let coarse = &trace.down[level + 1].0;
        let mut above = Planes::new(coarse_channels, coarse.height, coarse.width);
        for c in 0..above.channels {
            for y in 0..d.height {
                for x in 0..d.width {
                    let at = (c * above.height + y / 2) * above.width + x / 2;
                    above.data[at] += d.data[c * size + y * d.width + x];
                }
            }
        }
        let mut skip = Planes::new(channels, d.height, d.width);
        skip.data.copy_from_slice(&d.data[above.channels * size..]);
        skips.push(skip);
        from_finer = Some(above);
    }
    let bottom = LEVELS - 1;
    let (planes, within) = &trace.bottom;
    let mut d = head_back(params, bottom, planes, &trace.heads[bottom], &heads[bottom], grad);
    if let Some(more) = from_finer {
        add(&mut d, &more);
    }
    gate(&mut d, within);
    let (weights, _) = part(params, LEVELS);
    let (gw, gb) = part_mut(grad, LEVELS);
    let mut d = convolve_back(&trace.down[bottom].0, weights, &d, true, gw, gb);
    for level in (0..LEVELS).rev() {
        gate(&mut d, &trace.down[level].1);
        let (weights, _) = part(params, level);
        let (gw, gb) = part_mut(grad, level);
        if level == 0 {
            let (_, of_own) = weights.split_at(weights.len() - trace.own.channels * d.channels);
            let (light_gw, own_gw) = gw.split_at_mut(weights.len() - of_own.len());
            mix_back(&trace.own, of_own, &d, own_gw, gb);
            // The biases' were added.
            let mut again = vec![0.0; d.channels];
            convolve_back(&trace.light, &[], &d, false, light_gw, &mut again);
            break;
        }
        let (small, from) = &trace.pooled[level - 1];
        let small = convolve_back(small, weights, &d, true, gw, gb);
        d = skips.pop().expect("one a size");
        for (g, &at) in small.data.iter().zip(from) {
            d.data[at as usize] += g;
        }
    }
}

fn add(to: &mut Planes, more: &Planes) {
    to.data.iter_mut().zip(&more.data).for_each(|(a, b)| *a += b);
}

fn head_back(
    params: &Params,
    level: usize,
    input: &Planes,
    heads: &Heads,
    d: &[Head],
    grad: &mut Params,
) -> Planes {
    let size = input.height * input.width;
    let mut sums = Planes::new(HEAD, input.height, input.width);
    for (at, d) in d.iter().enumerate() {
        for c in 0..FEATURES {
            sums.data[c * size + at] = d[c] / 128.0;
        }
        for c in FEATURES..HEAD {
            // Out of range, but on the way back: let it.
            let value = heads.heads[at][c];
            let back = (value <= 0.0 && d[c] < 0.0) || (value >= 255.0 && d[c] > 0.0);
            if heads.within[at][c - FEATURES] || back {
                sums.data[c * size + at] = d[c] / 16.0;
            }
        }
    }
    let (weights, _) = part(params, 11 + level);
    let (gw, gb) = part_mut(grad, 11 + level);
    mix_back(input, weights, &sums, gw, gb)
}

/// Light of one size, pixel by pixel; the fourth number is nothing.
pub type Light = [f32; 4];

/// Values of the filter at each size, for the way back.
pub struct Filtered {
    /// Irradiance by confidence.
    light: Vec<Vec<Light>>,
    filtered: Vec<Vec<Light>>,
    raised: Vec<Vec<Light>>,
    /// What the weights of `filtered` add up to.
    totals: Vec<Vec<f32>>,
    pub out: Vec<Vec<Light>>,
}

/// The weight by features, and their differences (nothing behind them).
#[inline(always)]
fn affinity(a: &Head, b: &Head, mode: Mode) -> (f32, Lanes) {
    const ONES: Head = {
        let mut ones = [0.0; LANES];
        let mut i = 0;
        while i < FEATURES {
            ones[i] = 1.0;
            i += 1;
        }
        ones
    };
    let difference = (f32x8::from(*a) - f32x8::from(*b)) * f32x8::from(ONES);
    let square = (difference * difference).reduce_add();
    let weight = match mode {
        Mode::Float => (-square / 64.0).exp(),
        Mode::Integer => f32::from(EXP[((square as u32) >> 1).min(255) as usize]) / 255.0,
    };
    (weight, difference)
}

/// `to` += `by` · `difference`.
#[inline(always)]
fn shift(to: &mut Head, by: f32, difference: Lanes) {
    *to = difference.mul_add(f32x8::splat(by), f32x8::from(*to)).to_array();
}

#[inline(always)]
fn confidence(head: &Head) -> f32 {
    (head[CONFIDENCE] + 1.0) / 256.0
}

/// A neighbour's weight.
#[inline(always)]
fn weight(e: f32, other: &Head, mode: Mode) -> f32 {
    let w = e * confidence(other);
    match mode {
        Mode::Float => w,
        // 255 · 256 / 64
        Mode::Integer => (w * 1020.0 + 1e-3).floor() / 1020.0,
    }
}

/// What a pixel counts in the coarser one's light: never nothing, by one of 1020. Its affinity and their differences, too.
#[inline(always)]
fn shrinks(fine: &Head, coarse: &Head, mode: Mode) -> (f32, f32, Lanes) {
    let (e, difference) = affinity(fine, coarse, mode);
    (weight(e, fine, mode) + 1.0 / 1020.0, e, difference)
}

fn blend(head: &Head, mode: Mode) -> f32 {
    match mode {
        Mode::Float => head[BLEND] / 255.0,
        Mode::Integer => (head[BLEND] + if head[BLEND] >= 128.0 { 1.0 } else { 0.0 }) / 256.0,
    }
}

/// So that there is always something to divide by where four are raised; in the core it is one of 255.
const LEAST: f32 = 1.0 / 255.0;

fn reach(level: usize) -> usize {
    if level == 0 { 1 } else { 2 }
}

/// The four nearest coarse pixels of a fine one with their bilinear shares.
#[inline(always)]
fn nearest(x: usize, y: usize, width: usize, height: usize) -> [(usize, f32); 4] {
    let far = |x: usize, most: usize| {
        if x % 2 == 0 {
            (x / 2).saturating_sub(1)
        } else {
            (x / 2 + 1).min(most - 1)
        }
    };
    let (fx, fy) = (far(x, width), far(y, height));
    [
        (y / 2 * width + x / 2, 9.0),
        (y / 2 * width + fx, 3.0),
        (fy * width + x / 2, 3.0),
        (fy * width + fx, 1.0),
    ]
}

pub fn filter(irradiance: &[Light], heads: &[Heads], mode: Mode) -> Filtered {
    let mut light = vec![irradiance.to_vec()];
    for level in 1..LEVELS {
        let (fine, coarse) = (&heads[level - 1], &heads[level]);
        let mut shrunk = vec![[0.0; 4]; coarse.heads.len()];
        for (at, out) in shrunk.iter_mut().enumerate() {
            let mut total = 0.0;
            for from in quad(at, fine, coarse) {
                let (w, ..) = shrinks(&fine.heads[from], &coarse.heads[at], mode);
                total += w;
                (0..4).for_each(|c| out[c] += w * light[level - 1][from][c]);
            }
            out.iter_mut().for_each(|c| *c /= total);
        }
        light.push(shrunk);
    }
    let (mut filtered, mut totals) = (Vec::new(), Vec::new());
    for level in 0..LEVELS {
        let h = &heads[level];
        let mut out = vec![[0.0; 4]; h.heads.len()];
        let mut sums = vec![0.0; h.heads.len()];
        for y in 0..h.height {
            for x in 0..h.width {
                let at = y * h.width + x;
                let own = weight(1.0, &h.heads[at], mode);
                let mut total = own;
                let mut sum = light[level][at].map(|c| c * own);
                around(h, x, y, reach(level), |other| {
                    let (e, _) = affinity(&h.heads[at], &h.heads[other], mode);
                    let w = weight(e, &h.heads[other], mode);
                    total += w;
                    (0..4).for_each(|c| sum[c] += w * light[level][other][c]);
                });
                out[at] = sum.map(|c| c / total);
                sums[at] = total;
            }
        }
        filtered.push(out);
        totals.push(sums);
    }
    let mut raised = vec![Vec::new(); LEVELS];
    let mut out = vec![Vec::new(); LEVELS];
    out[LEVELS - 1] = filtered[LEVELS - 1].clone();
    for level in (0..LEVELS - 1).rev() {
        let (h, coarse) = (&heads[level], &heads[level + 1]);
        let mut up = vec![[0.0; 4]; h.heads.len()];
        let mut result = up.clone();
        for y in 0..h.height {
            for x in 0..h.width {
                let at = y * h.width + x;
                let (mut total, mut sum) = (LEAST, [0.0; 4]);
                let taps = nearest(x, y, coarse.width, coarse.height);
                (0..4).for_each(|c| sum[c] = LEAST * out[level + 1][taps[0].0][c]);
                for (other, share) in taps {
                    let (e, _) = affinity(&h.heads[at], &coarse.heads[other], mode);
                    let w = e * share;
                    total += w;
                    (0..4).for_each(|c| sum[c] += w * out[level + 1][other][c]);
                }
                up[at] = sum.map(|c| c / total);
                let a = blend(&h.heads[at], mode);
                result[at] = core::array::from_fn(|c| up[at][c] + a * (filtered[level][at][c] - up[at][c]));
            }
        }
        raised[level] = up;
        out[level] = result;
    }
    Filtered {
        light,
        filtered,
        raised,
        totals,
        out,
    }
}

/// The fine pixels of coarse pixel `at`; at an odd edge some twice.
#[inline(always)]
fn quad(at: usize, fine: &Heads, coarse: &Heads) -> [usize; 4] {
    let (x, y) = (at % coarse.width * 2, at / coarse.width * 2);
    let (right, below) = ((x + 1).min(fine.width - 1), (y + 1).min(fine.height - 1));
    [
        y * fine.width + x,
        y * fine.width + right,
        below * fine.width + x,
        below * fine.width + right,
    ]
}

#[inline(always)]
fn around(h: &Heads, x: usize, y: usize, reach: usize, mut of: impl FnMut(usize)) {
    for row in y.saturating_sub(reach)..=(y + reach).min(h.height - 1) {
        for column in x.saturating_sub(reach)..=(x + reach).min(h.width - 1) {
            if (row, column) != (y, x) {
                of(row * h.width + column);
            }
        }
    }
}

/// From the gradients of each size's `out` to those of all heads.
pub fn filter_back(heads: &[Heads], f: &Filtered, d_out: Vec<Vec<Light>>, mode: Mode) -> Vec<Vec<Head>> {
    let mut grads: Vec<Vec<Head>> = heads.iter().map(|h| vec![[0.0; LANES]; h.heads.len()]).collect();
    let mut of_light: Vec<Vec<Light>> = heads.iter().map(|h| vec![[0.0; 4]; h.heads.len()]).collect();
    let mut from_finer: Vec<Light> = Vec::new();
    for (level, mut d) in d_out.into_iter().enumerate() {
        for (d, more) in d.iter_mut().zip(&from_finer) {
            (0..3).for_each(|c| d[c] += more[c]);
        }
        let h = &heads[level];
        let mut of_coarse = match heads.get(level + 1) {
            Some(coarse) => vec![[0.0; 4]; coarse.heads.len()],
            None => Vec::new(),
        };
        for y in 0..h.height {
            for x in 0..h.width {
                let at = y * h.width + x;
                let here = h.heads[at];
                let mut own_part = d[at];
                if let Some(coarse) = heads.get(level + 1) {
                    let a = blend(&here, mode);
                    let (up, own) = (f.raised[level][at], f.filtered[level][at]);
                    let da: f32 = (0..3).map(|c| d[at][c] * (own[c] - up[c])).sum();
                    grads[level][at][BLEND] += da / 256.0;
                    let d_up = d[at].map(|g| g * (1.0 - a));
                    own_part = d[at].map(|g| g * a);
                    // Raised.
                    let taps = nearest(x, y, coarse.width, coarse.height);
                    let weights = taps.map(|(other, share)| {
                        let (e, difference) = affinity(&here, &coarse.heads[other], mode);
                        (e * share, difference)
                    });
                    let total: f32 = LEAST + weights.iter().map(|(w, _)| w).sum::<f32>();
                    (0..3).for_each(|c| of_coarse[taps[0].0][c] += LEAST / total * d_up[c]);
                    for ((other, _), (w, difference)) in taps.into_iter().zip(weights) {
                        let from = f.out[level + 1][other];
                        let mut dw = 0.0;
                        for c in 0..3 {
                            of_coarse[other][c] += w / total * d_up[c];
                            dw += (from[c] - up[c]) * d_up[c] / total;
                        }
                        let k = -dw * w / 32.0;
                        shift(&mut grads[level][at], k, difference);
                        shift(&mut grads[level + 1][other], -k, difference);
                    }
                }
                // Filtered.
                let own = weight(1.0, &here, mode);
                let total = f.totals[level][at];
                let value = f.filtered[level][at];
                let slope = |from: &Light| -> f32 {
                    (0..3).map(|c| (from[c] - value[c]) * own_part[c]).sum::<f32>() / total
                };
                grads[level][at][CONFIDENCE] += slope(&f.light[level][at]) / 256.0;
                if level > 0 {
                    let w = own / total;
                    (0..3).for_each(|c| of_light[level][at][c] += w * own_part[c]);
                }
                let mut here_gradient = grads[level][at];
                around(h, x, y, reach(level), |other| {
                    let (e, difference) = affinity(&here, &h.heads[other], mode);
                    let sure = confidence(&h.heads[other]);
                    let dw = slope(&f.light[level][other]);
                    grads[level][other][CONFIDENCE] += dw * e / 256.0;
                    let k = -dw * e * sure / 32.0;
                    shift(&mut here_gradient, k, difference);
                    shift(&mut grads[level][other], -k, difference);
                    if level > 0 {
                        let w = e * sure / total;
                        (0..3).for_each(|c| of_light[level][other][c] += w * own_part[c]);
                    }
                });
                grads[level][at] = here_gradient;
            }
        }
        from_finer = of_coarse;
    }
    // The pyramid, from the coarsest on.
    for level in (1..LEVELS).rev() {
        let (fine, coarse) = (&heads[level - 1], &heads[level]);
        for at in 0..coarse.heads.len() {
            let g = of_light[level][at];
            let places = quad(at, fine, coarse);
            let weights = places.map(|from| shrinks(&fine.heads[from], &coarse.heads[at], mode));
            let total: f32 = weights.iter().map(|(w, ..)| w).sum();
            for (from, (w, e, difference)) in places.into_iter().zip(weights) {
                let w = w / total;
                let mut dw = 0.0;
                for c in 0..3 {
                    of_light[level - 1][from][c] += w * g[c];
                    dw += (f.light[level - 1][from][c] - f.light[level][at][c]) * g[c] / total;
                }
                grads[level - 1][from][CONFIDENCE] += dw * e / 256.0;
                let k = -dw * e * confidence(&fine.heads[from]) / 32.0;
                shift(&mut grads[level - 1][from], k, difference);
                shift(&mut grads[level][at], -k, difference);
            }
        }
    }
    grads
}
