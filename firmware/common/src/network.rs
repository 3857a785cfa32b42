//! The network over random pixels, in pictures of odd sides and small ones: layers and filter are assembly on some cores.

use microlux::film::denoise::Alone;
use microlux::film::denoise::network::{HEAD, INPUTS, Input, Needs, Network, Scratch, TRAINED};
use microlux::num::Crc;

use crate::random::Xorshift;

const SIZES: [[usize; 2]; 6] = [[1, 1], [2, 3], [3, 2], [5, 4], [9, 7], [14, 3]];
const MOST: usize = 9 * 7;
const NEEDS: Needs = Needs::of(14, 7);

/// Heads of every size, and the light that was filtered by them; a third of the inputs are 0.
pub(crate) fn run() -> u32 {
    let mut random = Xorshift::new(0x2545_f491);
    let mut crc = Crc::new();
    for [width, height] in SIZES {
        let mut inputs = [[0; INPUTS]; MOST];
        for input in inputs.as_flattened_mut() {
            let word = random.u32();
            *input = if word >> 30 == 0 {
                0
            } else {
                (word >> 8 & 63) as u8
            };
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
        let Ok(mut network) = Network::new(TRAINED, width, height, scratch) else {
            return 0;
        };
        network.extract(&Alone, |at| Input::from_bits(inputs[at]));
        for level in 0..4 {
            for byte in network.heads(level).as_flattened() {
                crc.word((*byte).into());
            }
        }
        let mut out = [[0; 3]; MOST];
        let filtered = network.filter(&Alone, |at| lights[at], &mut out[..width * height], |light| light);
        if filtered.is_err() {
            return 0;
        }
        for channel in out.as_flattened() {
            crc.word((*channel).into());
        }
    }
    crc.value()
}
