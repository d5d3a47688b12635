//! Evaluation of many states of one mechanism at once, in the lanes of SIMD registers
//! ([guide](crate::guide::batches)).
//!
//! The option `batch` of `#[mechanism]` generates these functions. Every method of a state then has a
//! counterpart with the suffix `_lanes`, on vectors of [`Lanes`]; parameters are the same in all lanes.
//! [`Batch`] is the trait for generic code. [`Batch::lanes`] returns the mechanism with lanes as its scalar
//! type, for code that is not written for lanes.
//!
//! A [`Lanewise`] mechanism evaluates whole arrays of states (`inverse_dynamics_all` and related functions),
//! and [rolls out](Lanewise::roll_out) the motions of thousands of states, with the feature `rayon` on all
//! processors.
//!
//! On the same machine, each lane equals the result of the function of a single state bit for bit. The
//! exceptions are functions of a single state that use lanes themselves, for identical limbs or for the
//! columns of a matrix: they agree up to rounding.

mod columns;
mod differentiated;
mod error;
mod evaluate;
mod lanewise;
#[cfg(feature = "rayon")]
mod parallel;
mod rollout;

pub use error::Error;
pub use lanewise::Lanewise;
pub use rollout::{Lockstep, Progress, Rollout, unwatched};

use crate::{Lanes, Mechanism};
use nalgebra::{SMatrix, SVector};

/// Column vector whose entries are SIMD lanes over several states.
type LaneColumn<T, const L: usize, const N: usize> = SVector<Lanes<T, L>, N>;

/// Mechanism with functions that evaluate several states at once, implemented by `#[mechanism(…, batch)]`.
/// Shapes, units and conventions are those of [`Mechanism`] for the state in each lane. `t` has no effect if
/// the mechanism does not depend on time.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no functions of several states at once",
    label = "this needs the option `batch`",
    note = "add the option to the attribute: `#[mechanism(…, batch)]`"
)]
pub trait Batch<const NQ: usize, const NV: usize, const NU: usize>: Mechanism<NQ, NV, NU> {
    /// Returns the mechanism with `L` lanes as its scalar type.
    fn lanes<const L: usize>(&self) -> Lanewise<'_, Self, L>
    where
        Self: Sized,
    {
        Lanewise::new(self)
    }

    /// Returns [`integrate`](Mechanism::integrate) of each lane: `q ⊕ dv`.
    fn integrate_lanes<const L: usize>(
        &self,
        q: &LaneColumn<Self::Scalar, L, NQ>,
        dv: &LaneColumn<Self::Scalar, L, NV>,
    ) -> LaneColumn<Self::Scalar, L, NQ>;

    /// Returns [`difference`](Mechanism::difference) of each lane: `to ⊖ from`.
    fn difference_lanes<const L: usize>(
        &self,
        from: &LaneColumn<Self::Scalar, L, NQ>,
        to: &LaneColumn<Self::Scalar, L, NQ>,
    ) -> LaneColumn<Self::Scalar, L, NV>;

    /// Returns [`tangent_rate`](Mechanism::tangent_rate) for the state in each lane: the rate of `dv` such
    /// that `q ⊕ dv` moves with velocity `v`.
    fn tangent_rate_lanes<const L: usize>(
        &self,
        dv: &LaneColumn<Self::Scalar, L, NV>,
        v: &LaneColumn<Self::Scalar, L, NV>,
    ) -> LaneColumn<Self::Scalar, L, NV>;

    /// Returns [`displacement_rate`](Mechanism::displacement_rate) for the state in each lane: the rate of
    /// the displacement `dv` from `q` such that `q ⊕ dv` moves with velocity `v`.
    fn displacement_rate_lanes<const L: usize>(
        &self,
        _q: &LaneColumn<Self::Scalar, L, NQ>,
        dv: &LaneColumn<Self::Scalar, L, NV>,
        v: &LaneColumn<Self::Scalar, L, NV>,
    ) -> LaneColumn<Self::Scalar, L, NV> {
        self.tangent_rate_lanes(dv, v)
    }

    /// Returns [`mass_matrix`](Mechanism::mass_matrix) of each lane: `M(t, q)`; kg, kg·m, kg·m².
    fn mass_matrix_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &LaneColumn<Self::Scalar, L, NQ>,
    ) -> SMatrix<Lanes<Self::Scalar, L>, NV, NV>;

    /// Returns [`bias_forces`](Mechanism::bias_forces) of each lane: `h(t, q, v)`, N and N·m.
    fn bias_forces_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &LaneColumn<Self::Scalar, L, NQ>,
        v: &LaneColumn<Self::Scalar, L, NV>,
    ) -> LaneColumn<Self::Scalar, L, NV>;

    /// Returns [`inverse_dynamics`](Mechanism::inverse_dynamics) of each lane: `τ = M a + h`, N and N·m.
    fn inverse_dynamics_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &LaneColumn<Self::Scalar, L, NQ>,
        v: &LaneColumn<Self::Scalar, L, NV>,
        a: &LaneColumn<Self::Scalar, L, NV>,
    ) -> LaneColumn<Self::Scalar, L, NV>;

    /// Returns [`forward_dynamics`](Mechanism::forward_dynamics) of each lane: `v̇ = M⁻¹ (τ − h)`, m/s² and
    /// rad/s².
    fn forward_dynamics_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &LaneColumn<Self::Scalar, L, NQ>,
        v: &LaneColumn<Self::Scalar, L, NV>,
        tau: &LaneColumn<Self::Scalar, L, NV>,
    ) -> LaneColumn<Self::Scalar, L, NV>;

    /// Returns [`generalized_forces`](Mechanism::generalized_forces) of the inputs `u` of each lane, N and
    /// N·m.
    fn generalized_forces_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &LaneColumn<Self::Scalar, L, NQ>,
        v: &LaneColumn<Self::Scalar, L, NV>,
        u: &LaneColumn<Self::Scalar, L, NU>,
    ) -> LaneColumn<Self::Scalar, L, NV>;

    /// Returns [`kinetic_energy`](Mechanism::kinetic_energy) for the state in each lane, J.
    fn kinetic_energy_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &LaneColumn<Self::Scalar, L, NQ>,
        v: &LaneColumn<Self::Scalar, L, NV>,
    ) -> Lanes<Self::Scalar, L>;

    /// Returns [`potential_energy`](Mechanism::potential_energy) for the state in each lane, J.
    fn potential_energy_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &LaneColumn<Self::Scalar, L, NQ>,
    ) -> Lanes<Self::Scalar, L>;

    /// Returns [`generalized_momentum`](Mechanism::generalized_momentum) of each lane, `p`, kg·m/s and
    /// kg·m²/s.
    fn generalized_momentum_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &LaneColumn<Self::Scalar, L, NQ>,
        v: &LaneColumn<Self::Scalar, L, NV>,
    ) -> LaneColumn<Self::Scalar, L, NV>;

    /// Returns [`momentum_rate`](Mechanism::momentum_rate) of each lane: `ṗ` without inputs, N and N·m.
    fn momentum_rate_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &LaneColumn<Self::Scalar, L, NQ>,
        v: &LaneColumn<Self::Scalar, L, NV>,
    ) -> LaneColumn<Self::Scalar, L, NV>;
}
