//! Reproducible random numbers for tests.

/// Random number generator SplitMix64 (Steele, Lea and Flood, *Fast splittable pseudorandom number
/// generators*, 2014).
pub struct Random(u64);

impl Random {
    /// Creates a random number generator from a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x2545_f491_4f6c_dd1d))
    }

    /// Returns a uniformly distributed number in `[-bound, bound)`.
    pub fn uniform_number(&mut self, bound: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        bound * ((z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    }

    /// Returns a random integer below `n`.
    pub fn index_below(&mut self, n: usize) -> usize {
        ((self.uniform_number(0.5) + 0.5) * n as f64) as usize % n.max(1)
    }

    /// Returns a number between −1 and 1 with four decimal digits, which text represents exactly.
    pub fn four_digit_number(&mut self) -> f64 {
        self.index_below(20_001) as f64 / 1e4 - 1.0
    }

    /// Returns numbers between −1 and 1 with four decimal digits.
    pub fn four_digit_numbers<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.four_digit_number())
    }
}
