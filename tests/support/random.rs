//! Random states and property tests, the same in every run.

use linkwork::Mechanism;
use linkwork::nalgebra::SVector;
use proptest::test_runner::{Config, RngSeed};

/// Settings of a property test: how many cases, always the same ones, and no file of those that failed.
pub fn config(cases: u32) -> Config {
    Config { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(20_261_121), ..Default::default() }
}

/// SplitMix64 (Steele, Lea and Flood, 2014).
pub struct Random(u64);

impl Random {
    /// Another seed is another sequence.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// Uniform in `[-bound, bound)`.
    pub fn uniform(&mut self, bound: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        bound * ((z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    }

    /// Entries uniform in `[-bound, bound)`.
    pub fn vector<const N: usize>(&mut self, bound: f64) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.uniform(bound))
    }

    /// A configuration anywhere: every coordinate within 2 of zero, every orientation within reach.
    pub fn configuration<M, const NQ: usize, const NV: usize, const NU: usize>(
        &mut self,
        mechanism: &M,
    ) -> SVector<f64, NQ>
    where
        M: Mechanism<NQ, NV, NU, Scalar = f64>,
    {
        mechanism.integrate(&mechanism.neutral(), &self.vector(2.0))
    }
}
