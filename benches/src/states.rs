//! Reproducible random states at which the benchmarked functions are called.

use crate::generic::{JointMotion, Model};
use crate::random::Random;
use nalgebra::SVector;

/// Number of states that the calls cycle through.
pub const STATES: usize = 256;

/// State at which measured functions are called: `q`, `v`, `a` and `τ`.
#[derive(Clone, Copy, Debug)]
pub struct State<const NQ: usize, const NV: usize> {
    /// Configuration of the robot.
    pub q: SVector<f64, NQ>,
    /// Velocity of the robot.
    pub v: SVector<f64, NV>,
    /// Acceleration of the robot.
    pub a: SVector<f64, NV>,
    /// Generalized force on the robot.
    pub tau: SVector<f64, NV>,
}

impl<const NQ: usize, const NV: usize> State<NQ, NV> {
    /// Returns a state with random coordinates and unit quaternions; velocities, accelerations and forces are
    /// of order one.
    fn random_state_of_model(model: &Model, random: &mut Random) -> State<NQ, NV> {
        let mut q = SVector::<f64, NQ>::from_fn(|_, _| random.uniform_within(3.0));
        for link in model.links.iter().filter(|link| link.motion == JointMotion::Free) {
            let mut quaternion = q.fixed_rows_mut::<4>(link.q + 3);
            quaternion.normalize_mut();
        }
        let mut random_vector = || SVector::from_fn(|_, _| random.uniform_within(2.0));
        State { q, v: random_vector(), a: random_vector(), tau: random_vector() * 10.0 }
    }

    /// Returns all numbers of the state: `q`, `v`, `a` and `τ`, concatenated.
    pub fn concatenated_state_numbers(&self) -> impl Iterator<Item = f64> {
        [self.q.as_slice(), self.v.as_slice(), self.a.as_slice(), self.tau.as_slice()].concat().into_iter()
    }
}

/// Returns [`STATES`] random states. Panics if the model has other sizes.
pub fn random_states<const NQ: usize, const NV: usize>(model: &Model) -> Vec<State<NQ, NV>> {
    assert_eq!((model.nq, model.nv), (NQ, NV), "size of the model");
    let mut random = Random::new(1);
    (0..STATES).map(|_| State::random_state_of_model(model, &mut random)).collect()
}
