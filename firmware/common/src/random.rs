//! Operands for the self-tests.

/// Marsaglia's xorshift32 (triple 13, 17, 5; "Xorshift RNGs", 2003): period 2^32 - 1.
pub(crate) struct Xorshift(u32);

impl Xorshift {
    /// `seed` is not 0, the one state that maps to itself.
    pub(crate) const fn new(seed: u32) -> Self {
        assert!(seed != 0);
        Self(seed)
    }

    pub(crate) const fn u32(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    pub(crate) fn i64(&mut self) -> i64 {
        let high = u64::from(self.u32());
        (high << 32 | u64::from(self.u32())) as i64
    }
}
