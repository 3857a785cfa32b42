//! The network's sums as the core makes them, over random activations: in assembly on ARMv6-M, by the plain loop elsewhere.

use microlux::num::Crc;
use microlux_asm::sums;

use crate::random::Xorshift;

const MOST: usize = 64;

/// Runs of every length up to 16, alone and by three and nine, by two, three and four words; half of the activations
/// are 0.
pub(crate) fn run() -> u32 {
    let mut random = Xorshift::new(0x9e37_79b9);
    let mut inputs = [0; MOST];
    let mut words = [0; 9 * 16 * 4];
    let mut crc = Crc::new();
    for round in 0..68 {
        for input in &mut inputs {
            *input = ((random.u32() >> 8) & 63) as u8 * (random.u32() >> 31) as u8;
        }
        words.fill_with(|| random.u32());
        let length = round % 17;
        let run = |number: usize| &inputs[number * 5..][..length];
        let other = &inputs[40..][..16 - length];
        let (twos, _) = words.as_chunks::<2>();
        let (threes, _) = words.as_chunks::<3>();
        let (fours, _) = words.as_chunks::<4>();
        all(&mut crc, run, other, twos);
        all(&mut crc, run, other, threes);
        all(&mut crc, run, other, fours);
    }
    crc.value()
}

fn all<'a, const PAIRS: usize>(
    crc: &mut Crc,
    run: impl Fn(usize) -> &'a [u8],
    other: &[u8],
    words: &[[u32; PAIRS]],
) {
    for sum in [
        sums([run(0)], words),
        sums([run(1), &[], other], words),
        sums([run(2), run(3), run(4)], words),
        sums(core::array::from_fn::<_, 9, _>(&run), words),
    ] {
        sum.into_iter().for_each(|word| crc.word(word));
    }
}
