//! Where `src/film/blue_noise.bin` comes from: void-and-cluster, made again and compared.
//!
//! R. Ulichney, "The void-and-cluster method for dither array generation", SPIE 1913, 1993, on a torus, with his
//! σ = 1.5. Energies are integers and ties go to the lowest index: the same mask on every host.
//! `BLESS=1 cargo test --test blue_noise` writes the file.

const SIDE: usize = 64;
const AREA: usize = SIDE * SIDE;
const SEED: u32 = 1993;
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/film/blue_noise.bin");

/// A binary pattern and, at each place, how crowded its ones are.
#[derive(Clone)]
struct Pattern {
    ones: Vec<bool>,
    energy: Vec<u64>,
}

impl Pattern {
    fn flip(&mut self, kernel: &[u64], at: usize) {
        self.ones[at] = !self.ones[at];
        for (i, energy) in self.energy.iter_mut().enumerate() {
            let x = (i + SIDE - at % SIDE) % SIDE;
            let y = (i / SIDE + SIDE - at / SIDE) % SIDE;
            let weight = kernel[y * SIDE + x];
            *energy = if self.ones[at] {
                *energy + weight
            } else {
                *energy - weight
            };
        }
    }

    fn tightest_cluster(&self) -> usize {
        let crowd = |i: &usize| (self.energy[*i], std::cmp::Reverse(*i));
        (0..AREA).filter(|i| self.ones[*i]).max_by_key(crowd).unwrap()
    }

    fn largest_void(&self) -> usize {
        (0..AREA)
            .filter(|i| !self.ones[*i])
            .min_by_key(|i| (self.energy[*i], *i))
            .unwrap()
    }
}

fn kernel() -> Vec<u64> {
    let squared = |d: usize| d.min(SIDE - d).pow(2) as f64;
    let gauss = |i: usize| (-(squared(i % SIDE) + squared(i / SIDE)) / (2.0 * 1.5 * 1.5)).exp();
    (0..AREA)
        .map(|i| (gauss(i) * 2f64.powi(32)).round() as u64)
        .collect()
}

fn mask() -> Vec<u8> {
    let kernel = kernel();
    // A tenth of the places at random, then spread until the tightest cluster is what would fill the largest void.
    let mut prototype = Pattern {
        ones: vec![false; AREA],
        energy: vec![0; AREA],
    };
    let mut state = SEED;
    let mut count = 0;
    while count < AREA / 10 {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let at = (state >> 20) as usize % AREA;
        if !prototype.ones[at] {
            prototype.flip(&kernel, at);
            count += 1;
        }
    }
    loop {
        let cluster = prototype.tightest_cluster();
        prototype.flip(&kernel, cluster);
        let void = prototype.largest_void();
        prototype.flip(&kernel, void);
        if void == cluster {
            break;
        }
    }
    // Phase I: ranks below, by taking the tightest clusters away.
    let mut ranks = vec![0; AREA];
    let mut pattern = prototype.clone();
    for rank in (0..count).rev() {
        let cluster = pattern.tightest_cluster();
        pattern.flip(&kernel, cluster);
        ranks[cluster] = rank;
    }
    // Phases II and III: ranks above, by filling voids; the tightest cluster of zeros is the largest void of ones, as
    // the energies of both add up to the same everywhere.
    for rank in count..AREA {
        let void = prototype.largest_void();
        prototype.flip(&kernel, void);
        ranks[void] = rank;
    }
    ranks.iter().map(|rank| (rank * 256 / AREA) as u8).collect()
}

#[test]
fn the_mask_is_what_void_and_cluster_makes() {
    let made = mask();
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(FILE, &made).unwrap();
    }
    assert!(
        std::fs::read(FILE).unwrap() == made,
        "src/film/blue_noise.bin differs; BLESS=1 writes it"
    );
}

/// Power of a pattern's frequencies, up to a third of that of evenly spaced dots, over what white noise would have.
fn low_frequencies(bits: &[bool]) -> f64 {
    let mean = bits.iter().filter(|b| **b).count() as f64 / AREA as f64;
    let reach = (SIDE as f64 * mean.min(1.0 - mean).sqrt() / 3.0) as i32;
    let (mut power, mut count) = (0.0, 0);
    for fy in -reach..=reach {
        for fx in -reach..=reach {
            if (fx, fy) == (0, 0) || fx * fx + fy * fy > reach * reach {
                continue;
            }
            let (mut re, mut im) = (0.0, 0.0);
            for (i, bit) in bits.iter().enumerate() {
                let turns = (fx * (i % SIDE) as i32 + fy * (i / SIDE) as i32) as f64 / SIDE as f64;
                let (sin, cos) = (turns * std::f64::consts::TAU).sin_cos();
                let value = f64::from(*bit) - mean;
                re += value * cos;
                im += value * sin;
            }
            power += re * re + im * im;
            count += 1;
        }
    }
    power / count as f64 / (AREA as f64 * mean * (1.0 - mean))
}

#[test]
fn its_patterns_have_no_low_frequencies() {
    let mask = mask();
    for level in [16, 64, 128, 192, 240] {
        let bits: Vec<bool> = mask.iter().map(|v| *v < level).collect();
        let share = low_frequencies(&bits);
        println!("{level:3}/256: {share:.4}");
        assert!(share < 0.1, "{level}: {share}");
    }
}
