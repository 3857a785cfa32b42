//! The network over random pixels, in pictures of odd sides and small ones: layers and filter are assembly on some cores.

use microlux::film::denoise::Alone;
use microlux::film::denoise::network::{
    BIASES, HEAD, INPUTS, Input, LAYERS, LIGHTS, Needs, Network, Scratch, TRAINED, WEIGHTS, Weights,
};
use microlux::num::Crc;

use crate::random::Xorshift;

const SIZES: [[usize; 2]; 6] = [[1, 1], [2, 3], [3, 2], [5, 4], [9, 7], [14, 3]];
const MOST: usize = 9 * 7;
const NEEDS: Needs = Needs::of(14, 7);
/// The most that an output's weights of one sign may add up to.
const REACH: i32 = 520;

/// Heads of every size, and the light that was filtered by them: by what was learned and by anything.
pub(crate) fn run() -> u32 {
    let mut random = Xorshift::new(0x2545_f491);
    let mut crc = Crc::new();
    for size in SIZES {
        if look(&mut crc, &mut random, TRAINED, size).is_none() {
            return 0;
        }
    }
    let (mut table, mut biases) = ([0; WEIGHTS], [0; BIASES]);
    for size in SIZES {
        fill(&mut random, &mut table, &mut biases);
        let weights = Weights::new(&table, &biases).ok();
        if weights
            .and_then(|weights| look(&mut crc, &mut random, weights, size))
            .is_none()
        {
            return 0;
        }
    }
    crc.value()
}

/// A quarter of the inputs are 0, a quarter of the pixels are black, and half of them have all but light and depth, and perhaps
/// one, of the one before.
fn look(crc: &mut Crc, random: &mut Xorshift, weights: Weights, [width, height]: [usize; 2]) -> Option<()> {
    let mut inputs = [[0; INPUTS]; MOST];
    for at in 0..MOST {
        inputs[at] = [(); INPUTS].map(|()| {
            let word = random.u32();
            if word >> 30 == 0 {
                0
            } else {
                (word >> 8 & 63) as u8
            }
        });
        if at > 0 && random.u32() >> 31 == 0 {
            let [_, _, _, rest @ .., _, samples] = inputs[at - 1];
            inputs[at][LIGHTS..INPUTS - 2].copy_from_slice(&rest);
            inputs[at][INPUTS - 1] = samples;
            // Often but for one.
            if let Some(input) = inputs[at].get_mut((random.u32() >> 8) as usize % (2 * INPUTS)) {
                *input ^= 1;
            }
        }
        if random.u32() >> 30 == 0 {
            inputs[at][..LIGHTS].fill(0);
        }
    }
    let lights = core::array::from_fn::<_, MOST, _>(|_| [(); 3].map(|()| (random.u32() >> 16) as u16));
    let mut fine = [[0; HEAD]; NEEDS.fine];
    let mut near = [0; NEEDS.near];
    let mut far = [0; NEEDS.far];
    let scratch = Scratch {
        fine: &mut fine,
        near: &mut near,
        far: &mut far,
    };
    let mut network = Network::new(weights, width, height, scratch).ok()?;
    network.extract(&Alone, |at| Input::from_bits(inputs[at]));
    for level in 0..4 {
        for byte in network.heads(level).as_flattened() {
            crc.word((*byte).into());
        }
    }
    let mut out = [[0; 3]; MOST];
    network
        .filter(&Alone, |at| lights[at], &mut out[..width * height], |light| light)
        .ok()?;
    for channel in out.as_flattened() {
        crc.word((*channel).into());
    }
    Some(())
}

/// Weights up to what is refused, large ones and small ones; of the biases, most within what a sum reaches.
fn fill(random: &mut Xorshift, table: &mut [i8; WEIGHTS], biases: &mut [i16; BIASES]) {
    let mut from = 0;
    for layer in LAYERS {
        let count = layer.weights();
        for output in 0..layer.outputs {
            let (mut above, mut below) = (REACH, REACH);
            let shift = random.u32() >> 30;
            for weight in table[from..from + count]
                .iter_mut()
                .skip(output)
                .step_by(layer.outputs)
            {
                let w = ((random.u32() >> 24) as u8 as i8) >> shift;
                let left = if w > 0 { &mut above } else { &mut below };
                let size = i32::from(w).abs();
                *weight = if size <= *left {
                    *left -= size;
                    w
                } else {
                    0
                };
            }
        }
        from += count;
    }
    biases.fill_with(|| {
        let word = random.u32();
        (word >> 16) as u16 as i16 >> (word >> 8 & 7)
    });
}
