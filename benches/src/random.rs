//! Generator of reproducible random numbers for the benchmarks.

/// Random generator (xorshift64*, Vigna 2016).
pub struct Random(u64);

impl Random {
    /// Creates a generator with a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Returns a number between `-limit` and `limit`.
    pub fn uniform_within(&mut self, limit: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        limit * (bits as f64 / (1_u64 << 52) as f64 - 1.0)
    }
}
