//! Random states and property tests that are reproducible in every run.

use linkwork::Mechanism;
use linkwork::nalgebra::SVector;
use proptest::test_runner::{Config, RngSeed};

/// Returns the settings of a property test: the number of cases, a fixed seed, and no file of failed cases.
pub fn property_test_config(cases: u32) -> Config {
    Config { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(20_261_121), ..Default::default() }
}

/// Random generator SplitMix64 (Steele, Lea and Flood, 2014).
pub struct Random(u64);

impl Random {
    /// Creates the generator of the sequence with this seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// Returns a number that is uniform in `[-bound, bound)`.
    pub fn uniform_number(&mut self, bound: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        bound * ((z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    }

    /// Returns a vector with entries uniform in `[-bound, bound)`.
    pub fn random_vector<const N: usize>(&mut self, bound: f64) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.uniform_number(bound))
    }

    /// Returns a random configuration: each coordinate is within 2 of zero, and orientations cover all
    /// rotations.
    pub fn random_configuration<M, const NQ: usize, const NV: usize, const NU: usize>(
        &mut self,
        mechanism: &M,
    ) -> SVector<f64, NQ>
    where
        M: Mechanism<NQ, NV, NU, Scalar = f64>,
    {
        mechanism.integrate(&mechanism.neutral(), &self.random_vector(2.0))
    }
}
