//! The recursion of optimal control in blocks of `NV` by `NV`: what iterative linear-quadratic regulators (iLQR), differential
//! dynamic programming (DDP) and linear-quadratic regulators do at each instant, from the last to the first.
//!
//! With the step `x⁺ = A x + B δu` of a mechanism ([`Transition`]), the costs of an instant and those to go after it
//! ([`Value`]), [`backward`] finds the change of inputs that is best to second order, and the costs to go from there. Sources:
//! Mayne, *A second-order gradient method for determining optimal trajectories of non-linear discrete-time systems* (1966);
//! Tassa, Erez and Todorov, *Synthesis and stabilization of complex behaviors through online trajectory optimization* (2012).
//!
//! Nothing is allocated: trajectories are arrays of the caller.
//!
//! ```
//! use linkwork::optimal::{Quadratic, Value, backward};
//! use linkwork::discrete;
//! use linkwork::prelude::*;
//!
//! /// A mass on a rail.
//! #[mechanism(derivatives)]
//! struct Cart {
//!     #[body(mass = 2)]
//!     cart: Body,
//!     #[joint(ground -> cart, along = x)]
//!     rail: Sleeve,
//!     #[acts(on = rail)]
//!     push: Force,
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let step = discrete::transition(&Cart {}, &Rk4::step(0.01), 0.0, &[0.0].into(), &[0.0].into(), &[0.0].into())?;
//! // Costs of state and input, over so long a time that the gain no longer changes: the linear-quadratic regulator.
//! let mut cost = Quadratic::zeros();
//! (cost.qq[0], cost.uu[0]) = (1.0, 1.0);
//! let mut to_go = Value::zeros();
//! let mut gain = [0.0, 0.0];
//! for _ in 0..2000 {
//!     let policy;
//!     (policy, to_go) = backward(&step, &cost, &to_go, 0.0)?;
//!     gain = [policy.by_q[0], policy.by_v[0]];
//! }
//! // For a period that tends to zero they are −1 and −√(2 m) (Bryson and Ho, *Applied Optimal Control*, 1975, § 5.2).
//! assert!((gain[0] + 1.0).abs() < 0.02 && (gain[1] + 2.0).abs() < 0.04, "{gain:?}");
//! # Ok(())
//! # }
//! ```

use crate::discrete::Transition;
use crate::{InputSecondOrder, Real};
use nalgebra::{SMatrix, SVector};

/// Costs to second order about a state and inputs: `gradient · (δq, δv, δu) + ½ (δq, δv, δu) · Hessian (δq, δv, δu)`, in units of
/// the user's. Displacements of ball and free joints are in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic<T, const NV: usize, const NU: usize> {
    /// Gradient by configuration.
    pub q: SVector<T, NV>,
    /// Gradient by velocity.
    pub v: SVector<T, NV>,
    /// Gradient by inputs.
    pub u: SVector<T, NU>,
    /// By configuration twice.
    pub qq: SMatrix<T, NV, NV>,
    /// By configuration (rows) and velocity.
    pub qv: SMatrix<T, NV, NV>,
    /// By velocity twice.
    pub vv: SMatrix<T, NV, NV>,
    /// By configuration (rows) and inputs.
    pub qu: SMatrix<T, NV, NU>,
    /// By velocity (rows) and inputs.
    pub vu: SMatrix<T, NV, NU>,
    /// By inputs twice.
    pub uu: SMatrix<T, NU, NU>,
}

/// Costs to go from a state on, to second order: [`Quadratic`] without inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value<T, const NV: usize> {
    /// Gradient by configuration.
    pub q: SVector<T, NV>,
    /// Gradient by velocity.
    pub v: SVector<T, NV>,
    /// By configuration twice.
    pub qq: SMatrix<T, NV, NV>,
    /// By configuration (rows) and velocity.
    pub qv: SMatrix<T, NV, NV>,
    /// By velocity twice.
    pub vv: SMatrix<T, NV, NV>,
}

/// How the inputs change: `δu = α change + by_q δq + by_v δv`, with the length `α` of a line search, 1 for all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Policy<T, const NV: usize, const NU: usize> {
    /// The change that is best to second order.
    pub change: SVector<T, NU>,
    /// The gain on displacements of the configuration.
    pub by_q: SMatrix<T, NU, NV>,
    /// The gain on changes of velocity.
    pub by_v: SMatrix<T, NU, NV>,
    /// What `α change` adds to the costs: `α` times the first and `α²` times the second of these.
    pub expected: [T; 2],
}

/// Why there is no best change of inputs: the costs are not convex in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Indefinite {
    /// The input where the factorisation of the Hessian by inputs meets a pivot that is not positive.
    pub input: usize,
}

impl core::fmt::Display for Indefinite {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "the costs are not convex in input {}: add costs of inputs, or more regularisation",
            self.input
        )
    }
}

impl core::error::Error for Indefinite {}

impl<T: Real, const NV: usize, const NU: usize> Quadratic<T, NV, NU> {
    /// No costs.
    pub fn zeros() -> Self {
        let (state, mixed) = (SMatrix::zeros(), SMatrix::zeros());
        Self {
            q: SVector::zeros(),
            v: SVector::zeros(),
            u: SVector::zeros(),
            qq: state,
            qv: state,
            vv: state,
            qu: mixed,
            vu: mixed,
            uu: SMatrix::zeros(),
        }
    }

    /// With the curvature of the step besides ([`second_order`](crate::discrete::second_order), with the gradient of the costs to
    /// go as factors): differential dynamic programming; without it, iLQR.
    pub fn with_curvature(&self, (qq, qv, vv, qu, vu, uu): &InputSecondOrder<T, NV, NU>) -> Self {
        Self {
            qq: self.qq + qq,
            qv: self.qv + qv,
            vv: self.vv + vv,
            qu: self.qu + qu,
            vu: self.vu + vu,
            uu: self.uu + uu,
            ..*self
        }
    }
}

impl<T: Real, const NV: usize> Value<T, NV> {
    /// No costs.
    pub fn zeros() -> Self {
        let zero = SMatrix::zeros();
        Self { q: SVector::zeros(), v: SVector::zeros(), qq: zero, qv: zero, vv: zero }
    }
}

/// The change of inputs at an instant that is best to second order, and the costs to go from there, by those after the step;
/// `regularisation` is added to the diagonal of the Hessian by inputs.
///
/// # Errors
///
/// [`Indefinite`] where that Hessian is not positive definite, also where something is not finite.
pub fn backward<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    step: &Transition<T, NQ, NV, NU>,
    cost: &Quadratic<T, NV, NU>,
    after: &Value<T, NV>,
    regularisation: T,
) -> Result<(Policy<T, NV, NU>, Value<T, NV>), Indefinite> {
    // The rows of S [A B].
    let rows = |by_q: &SMatrix<T, NV, NV>, by_v: &SMatrix<T, NV, NV>| {
        (after.qq * by_q + after.qv * by_v, after.qv.tr_mul(by_q) + after.vv * by_v)
    };
    let (q_by_q, v_by_q) = rows(&step.q_by_q, &step.v_by_q);
    let (q_by_v, v_by_v) = rows(&step.q_by_v, &step.v_by_v);
    let q_by_u = after.qq * step.q_by_u + after.qv * step.v_by_u;
    let v_by_u = after.qv.tr_mul(&step.q_by_u) + after.vv * step.v_by_u;
    // The costs of state and inputs before the step.
    let uu = cost.uu + step.q_by_u.tr_mul(&q_by_u) + step.v_by_u.tr_mul(&v_by_u);
    let uq = cost.qu.transpose() + step.q_by_u.tr_mul(&q_by_q) + step.v_by_u.tr_mul(&v_by_q);
    let uv = cost.vu.transpose() + step.q_by_u.tr_mul(&q_by_v) + step.v_by_u.tr_mul(&v_by_v);
    let (back_q, back_v, back_u) = step.adjoint(&after.q, &after.v);
    let (q, v, u) = (cost.q + back_q, cost.v + back_v, cost.u + back_u);
    let (factor, pivots) = factors(&uu, regularisation)?;
    let change = -solve(&factor, &pivots, &u);
    let (by_q, by_v) = (-solve(&factor, &pivots, &uq), -solve(&factor, &pivots, &uv));
    let linear = u.dot(&change);
    let quadratic = (uu * change).dot(&change) * crate::private::constant(0.5);
    // With K = −Quu⁻¹ Qux the costs to go are Qxx + Qxuᵀ K, exactly so without regularisation; with it, two more terms.
    let (ru, rq, rv) = match regularisation == T::zero() {
        true => (SVector::zeros(), SMatrix::zeros(), SMatrix::zeros()),
        false => (change * -regularisation, by_q * -regularisation, by_v * -regularisation),
    };
    let half = |m: SMatrix<T, NV, NV>| (m + m.transpose()) * crate::private::constant::<T>(0.5);
    let to_go = Value {
        q: q + uq.tr_mul(&change) + by_q.tr_mul(&ru),
        v: v + uv.tr_mul(&change) + by_v.tr_mul(&ru),
        qq: half(
            cost.qq
                + step.q_by_q.tr_mul(&q_by_q)
                + step.v_by_q.tr_mul(&v_by_q)
                + uq.tr_mul(&by_q)
                + by_q.tr_mul(&rq),
        ),
        qv: cost.qv
            + step.q_by_q.tr_mul(&q_by_v)
            + step.v_by_q.tr_mul(&v_by_v)
            + uq.tr_mul(&by_v)
            + by_q.tr_mul(&rv),
        vv: half(
            cost.vv
                + step.q_by_v.tr_mul(&q_by_v)
                + step.v_by_v.tr_mul(&v_by_v)
                + uv.tr_mul(&by_v)
                + by_v.tr_mul(&rv),
        ),
    };
    Ok((Policy { change, by_q, by_v, expected: [linear, quadratic] }, to_go))
}

/// `L` and `1/D` of `H + r = L D Lᵀ`, with ones on the diagonal of `L`.
fn factors<T: Real, const N: usize>(
    matrix: &SMatrix<T, N, N>,
    regularisation: T,
) -> Result<(SMatrix<T, N, N>, SVector<T, N>), Indefinite> {
    let (mut l, mut inverse) = (*matrix, SVector::zeros());
    for j in 0..N {
        let pivot = l.data.0[j][j] + regularisation;
        if !(pivot > T::zero() && pivot.is_finite()) {
            return Err(Indefinite { input: j });
        }
        let over = T::one() / pivot;
        inverse.data.0[0][j] = over;
        let column = l.data.0[j];
        for k in j + 1..N {
            let factor = column[k] * over;
            for i in k..N {
                l.data.0[k][i] -= column[i] * factor;
            }
            l.data.0[j][k] = factor;
        }
    }
    Ok((l, inverse))
}

/// `(L D Lᵀ)⁻¹ B`.
fn solve<T: Real, const N: usize, const C: usize>(
    l: &SMatrix<T, N, N>,
    inverse: &SVector<T, N>,
    b: &SMatrix<T, N, C>,
) -> SMatrix<T, N, C> {
    // Row by row, so that all columns go at once.
    let mut rows: [[T; C]; N] = core::array::from_fn(|i| core::array::from_fn(|c| b.data.0[c][i]));
    for j in 0..N {
        let row = rows[j];
        for i in j + 1..N {
            let factor = l.data.0[j][i];
            for c in 0..C {
                rows[i][c] -= row[c] * factor;
            }
        }
    }
    for j in (0..N).rev() {
        let mut row = rows[j].map(|x| x * inverse.data.0[0][j]);
        for i in j + 1..N {
            let factor = l.data.0[j][i];
            for c in 0..C {
                row[c] -= rows[i][c] * factor;
            }
        }
        rows[j] = row;
    }
    SMatrix::from_fn(|i, c| rows[i][c])
}
