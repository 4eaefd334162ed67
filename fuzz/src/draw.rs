//! Choices of a target.

/// Seeded random numbers, or the bytes of a fuzzer.
#[derive(Clone, Debug)]
pub enum Draw<'a> {
    /// State of a xorshift generator (Marsaglia, 2003), not 0.
    Random(u64),
    /// Bytes that are not used yet.
    Bytes(&'a [u8]),
}

impl<'a> Draw<'a> {
    /// Random numbers of a seed.
    #[must_use]
    pub fn random(seed: u64) -> Self {
        Self::Random((seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// The bytes of a fuzzer.
    #[must_use]
    pub fn bytes(bytes: &'a [u8]) -> Self {
        Self::Bytes(bytes)
    }

    /// Whether the fuzzer's bytes are used up. Random numbers never are.
    #[must_use]
    pub fn is_over(&self) -> bool {
        matches!(self, Self::Bytes([]))
    }

    /// Next number; 0 once the bytes are used up.
    pub fn number(&mut self) -> u32 {
        match self {
            Self::Random(state) => {
                *state ^= *state << 13;
                *state ^= *state >> 7;
                *state ^= *state << 17;
                (*state >> 32) as u32
            }
            Self::Bytes(bytes) => {
                let (now, rest) = bytes.split_at(bytes.len().min(2));
                *bytes = rest;
                now.iter().fold(0, |sum, &byte| sum << 8 | u32::from(byte))
            }
        }
    }

    /// Next number below a limit, which is not 0.
    pub fn below(&mut self, limit: usize) -> usize {
        self.number() as usize % limit
    }
}
