//! CRC-32 (IEEE 802.3, reflected): the checksum of what is baked, and the fingerprint of a result.

/// `TABLE[n]`: the remainder that the four bits `n` leave.
const TABLE: [u32; 16] = {
    let mut table = [0; 16];
    let mut n = 0;
    while n < 16 {
        let mut rest = n as u32;
        let mut bit = 0;
        while bit < 4 {
            rest = (rest >> 1) ^ (0xedb8_8320 * (rest & 1));
            bit += 1;
        }
        table[n] = rest;
        n += 1;
    }
    table
};

/// A CRC-32 under way; four bits a step, 64 bytes of table.
#[derive(Clone, Copy, Debug)]
pub struct Crc(u32);

impl Crc {
    pub const fn new() -> Self {
        Self(!0)
    }

    pub fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let low = (self.0 ^ u32::from(byte)) & 15;
            self.0 = (self.0 >> 4) ^ TABLE[low as usize];
            let high = (self.0 ^ u32::from(byte >> 4)) & 15;
            self.0 = (self.0 >> 4) ^ TABLE[high as usize];
        }
    }

    /// Takes `word` in as four bytes, little end first.
    pub fn word(&mut self, word: u32) {
        self.bytes(&word.to_le_bytes());
    }

    pub const fn value(self) -> u32 {
        !self.0
    }
}

impl Default for Crc {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::Crc;

    #[test]
    fn matches_the_standard_check_value() {
        let mut crc = Crc::new();
        crc.bytes(b"123456789");
        assert_eq!(crc.value(), 0xcbf4_3926);
    }
}
