//! Many states of one mechanism at once, in the lanes of vector registers ([guide](crate::guide::batches)).
//!
//! The word `batch` among the arguments of `#[mechanism]` asks for them. Every method of the state then has a twin with
//! `_lanes` behind its name, on vectors of [`Lanes`]; parameters are the same in all lanes. [`Batch`] is the trait for
//! generic code, and [`Batch::lanes`] makes of the mechanism one whose scalars are lanes, for code that knows nothing
//! of them.
//!
//! On top of that a [`Lanewise`] mechanism evaluates whole arrays of states (`inverse_dynamics_all` and its like), and
//! [rolls out](Lanewise::roll_out) the motions of thousands, with the feature `rayon` on all processors.
//!
//! Each lane gives, bit for bit, what the function of a single state gives on the same machine; up to rounding where a
//! single state has lanes of its own, for alike limbs or for columns of a matrix.

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

use crate::{Lanes, Rheonomic};
use nalgebra::{SMatrix, SVector};

/// A column of lanes.
type Column<T, const L: usize, const N: usize> = SVector<Lanes<T, L>, N>;

/// A mechanism with functions of several states at once: what `#[mechanism(…, batch)]` implements. Shapes, units and
/// conventions are those of [`Rheonomic`], for the state of every lane; where nothing depends on time, `t` has no
/// effect.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no functions of several states at once",
    label = "this needs the word `batch`",
    note = "add the word to the attribute: `#[mechanism(…, batch)]`"
)]
pub trait Batch<const NQ: usize, const NV: usize, const NU: usize>: Rheonomic<NQ, NV, NU> {
    /// The mechanism with `L` lanes for scalars.
    fn lanes<const L: usize>(&self) -> Lanewise<'_, Self, L>
    where
        Self: Sized,
    {
        Lanewise::new(self)
    }

    /// [`integrate`](Rheonomic::integrate): `q ⊕ dv`.
    fn integrate_lanes<const L: usize>(
        &self,
        q: &Column<Self::Scalar, L, NQ>,
        dv: &Column<Self::Scalar, L, NV>,
    ) -> Column<Self::Scalar, L, NQ>;

    /// [`difference`](Rheonomic::difference): `to ⊖ from`.
    fn difference_lanes<const L: usize>(
        &self,
        from: &Column<Self::Scalar, L, NQ>,
        to: &Column<Self::Scalar, L, NQ>,
    ) -> Column<Self::Scalar, L, NV>;

    /// [`tangent_rate`](Rheonomic::tangent_rate): rate of `dv` such that `q ⊕ dv` moves with velocity `v`.
    fn tangent_rate_lanes<const L: usize>(
        &self,
        dv: &Column<Self::Scalar, L, NV>,
        v: &Column<Self::Scalar, L, NV>,
    ) -> Column<Self::Scalar, L, NV>;

    /// [`displacement_rate`](Rheonomic::displacement_rate): rate of `dv` such that `q ⊕ dv` moves with velocity `v`, from `q`.
    fn displacement_rate_lanes<const L: usize>(
        &self,
        _q: &Column<Self::Scalar, L, NQ>,
        dv: &Column<Self::Scalar, L, NV>,
        v: &Column<Self::Scalar, L, NV>,
    ) -> Column<Self::Scalar, L, NV> {
        self.tangent_rate_lanes(dv, v)
    }

    /// [`mass_matrix`](Rheonomic::mass_matrix): `M(t, q)`; kg, kg·m, kg·m².
    fn mass_matrix_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &Column<Self::Scalar, L, NQ>,
    ) -> SMatrix<Lanes<Self::Scalar, L>, NV, NV>;

    /// [`bias_forces`](Rheonomic::bias_forces): `h(t, q, v)`, N and N·m.
    fn bias_forces_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &Column<Self::Scalar, L, NQ>,
        v: &Column<Self::Scalar, L, NV>,
    ) -> Column<Self::Scalar, L, NV>;

    /// [`inverse_dynamics`](Rheonomic::inverse_dynamics): `τ = M a + h`, N and N·m.
    fn inverse_dynamics_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &Column<Self::Scalar, L, NQ>,
        v: &Column<Self::Scalar, L, NV>,
        a: &Column<Self::Scalar, L, NV>,
    ) -> Column<Self::Scalar, L, NV>;

    /// [`forward_dynamics`](Rheonomic::forward_dynamics): `v̇ = M⁻¹ (τ − h)`, m/s² and rad/s².
    fn forward_dynamics_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &Column<Self::Scalar, L, NQ>,
        v: &Column<Self::Scalar, L, NV>,
        tau: &Column<Self::Scalar, L, NV>,
    ) -> Column<Self::Scalar, L, NV>;

    /// [`generalized_forces`](Rheonomic::generalized_forces) of the inputs `u`, N and N·m.
    fn generalized_forces_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &Column<Self::Scalar, L, NQ>,
        v: &Column<Self::Scalar, L, NV>,
        u: &Column<Self::Scalar, L, NU>,
    ) -> Column<Self::Scalar, L, NV>;

    /// [`kinetic_energy`](Rheonomic::kinetic_energy), J.
    fn kinetic_energy_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &Column<Self::Scalar, L, NQ>,
        v: &Column<Self::Scalar, L, NV>,
    ) -> Lanes<Self::Scalar, L>;

    /// [`potential_energy`](Rheonomic::potential_energy), J.
    fn potential_energy_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &Column<Self::Scalar, L, NQ>,
    ) -> Lanes<Self::Scalar, L>;

    /// [`generalized_momentum`](Rheonomic::generalized_momentum) `p`, kg·m/s and kg·m²/s.
    fn generalized_momentum_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &Column<Self::Scalar, L, NQ>,
        v: &Column<Self::Scalar, L, NV>,
    ) -> Column<Self::Scalar, L, NV>;

    /// [`momentum_rate`](Rheonomic::momentum_rate): `ṗ` without inputs, N and N·m.
    fn momentum_rate_lanes<const L: usize>(
        &self,
        t: Lanes<Self::Scalar, L>,
        q: &Column<Self::Scalar, L, NQ>,
        v: &Column<Self::Scalar, L, NV>,
    ) -> Column<Self::Scalar, L, NV>;
}
