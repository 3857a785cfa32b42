//! Errors gathered, and compared with what the documentation says, both ways.

/// Max, RMS and signed mean of errors.
#[derive(Default)]
pub struct Figures {
    pub max: f64,
    squares: f64,
    sum: f64,
    count: f64,
}

/// What the documentation of a kernel says.
pub struct Said {
    pub max: f64,
    pub rms: f64,
    pub mean: Mean,
}

pub enum Mean {
    /// About this much.
    Is(f64),
    /// No bias; at most this much either way.
    Within(f64),
}

impl Figures {
    pub fn add(&mut self, error: f64) {
        assert!(error.is_finite());
        self.max = self.max.max(error.abs());
        self.squares += error * error;
        self.sum += error;
        self.count += 1.0;
    }

    pub fn rms(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }

    pub fn mean(&self) -> f64 {
        self.sum / self.count
    }

    /// Red when worse than what is said, and when it is less than half of it: then the documentation is out of date.
    pub fn assert(&self, what: &str, said: Said) {
        let (max, rms, mean) = (self.max, self.rms(), self.mean());
        println!(
            "{what}: max {max:.3e}, RMS {rms:.3e}, mean {mean:+.3e} ({} cases)",
            self.count
        );
        let fits = |measured: f64, said: f64| (0.5..=1.0).contains(&(measured / said));
        assert!(
            fits(max, said.max),
            "{what}: max {max:.3e}, said {:.3e}",
            said.max
        );
        assert!(
            fits(rms, said.rms),
            "{what}: RMS {rms:.3e}, said {:.3e}",
            said.rms
        );
        match said.mean {
            Mean::Is(said) => assert!(fits(mean, said), "{what}: mean {mean:+.3e}, said {said:+.3e}"),
            Mean::Within(said) => assert!(mean.abs() <= said, "{what}: mean {mean:+.3e}, said ±{said:.3e}"),
        }
    }
}

/// Random numbers: PCG RXS-M-XS 32 (O'Neill, 2014), and shapes of them that reach all magnitudes.
pub struct Random(pub u32);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    }

    /// Evenly over `0 .. n`.
    pub fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(n)) >> 32) as u32
    }

    /// At least 1, each number of bits equally often.
    pub fn any_size(&mut self) -> u32 {
        let zeros = self.below(32);
        (self.bits() | 1 << 31) >> zeros
    }

    /// Evenly over −2^(bits − 1) .. 2^(bits − 1), the number of bits evenly over 1 ..= `most`.
    pub fn signed(&mut self, most: u32) -> i32 {
        let bits = self.below(most) + 1;
        (self.bits() as i32) >> (32 - bits)
    }
}
