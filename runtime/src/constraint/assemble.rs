//! Assembly: from a guess to a configuration that fulfils the constraints.

use super::{Constrained, ConstraintError, complete, largest, near, off};
use crate::private::{constant, epsilon};
use nalgebra::{SMatrix, SVector};

/// Most steps tried.
const MOST_STEPS: usize = 200;

/// How often it is tried again from around the guess, ever farther away: the first and the last distance, m or rad.
const AGAIN: usize = 24;
const NEAR: f64 = 0.05;
const FAR: f64 = 3.0;

/// By steps from the guess; where these end in a gap that no small step closes, from around it.
pub(super) fn assemble<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    mechanism: &M,
    t: M::Scalar,
    q: &SVector<M::Scalar, NQ>,
    held: &[usize],
) -> Result<SVector<M::Scalar, NQ>, ConstraintError>
where
    M: Constrained<NQ, NV, NU, NH, NC> + ?Sized,
{
    complete::check::<NV>(held)?;
    let first = descend(mechanism, t, q, held);
    if !matches!(first, Err(ConstraintError::Configuration { .. })) {
        return first;
    }
    // Steele and Vigna, Computationally easy, spectrally good multipliers for congruential generators, 2022.
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(0xD134_2543_DE82_EF95).wrapping_add(1);
        (state >> 32) as f64 / f64::from(1_u32 << 31) - 1.0
    };
    let mut distance = NEAR;
    for _ in 0..AGAIN {
        let step = SVector::<M::Scalar, NV>::from_fn(|k, _| {
            let part = next();
            if held.contains(&k) { nalgebra::zero() } else { constant(distance * part) }
        });
        let found = descend(mechanism, t, &mechanism.integrate(q, &step), held);
        if found.is_ok() {
            return found;
        }
        distance += (FAR - NEAR) / AGAIN as f64;
    }
    first
}

/// Levenberg–Marquardt on `½ |φ|²` over the coordinates that are not held.
fn descend<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(
    mechanism: &M,
    t: M::Scalar,
    q: &SVector<M::Scalar, NQ>,
    held: &[usize],
) -> Result<SVector<M::Scalar, NQ>, ConstraintError>
where
    M: Constrained<NQ, NV, NU, NH, NC> + ?Sized,
{
    let mut q = *q;
    let mut residuals = mechanism.constraint_residuals(t, &q);
    largest(&residuals)?;
    let mut damping = constant::<M::Scalar>(1e-3);
    for _ in 0..MOST_STEPS {
        let (_, size) = largest(&residuals)?;
        if size <= constant::<M::Scalar>(4.0) * epsilon() {
            break;
        }
        let jacobian = mechanism.constraint_jacobian(t, &q);
        let rows = SMatrix::<M::Scalar, NH, NV>::from_fn(|i, j| {
            let fixed = held.contains(&j);
            jacobian.get((i, j)).copied().filter(|_| !fixed).unwrap_or(nalgebra::zero())
        });
        let mut normal = rows * rows.transpose();
        // Relative to each row, so that units do not matter; rows without influence are left alone.
        for k in 0..NH {
            let own = normal[(k, k)];
            let influences = own > nalgebra::zero();
            normal[(k, k)] = if influences { own + own * damping } else { nalgebra::one() };
        }
        let step = normal.cholesky().map(|c| -(rows.transpose() * c.solve(&residuals)));
        let next = step.map(|step| mechanism.integrate(&q, &step));
        let trial = next.map(|next| (next, mechanism.constraint_residuals(t, &next)));
        match trial.filter(|(_, r)| r.norm() < residuals.norm()) {
            Some((next, r)) => {
                (q, residuals) = (next, r);
                damping *= constant(0.1);
            }
            // Rounding is all that is left.
            None if near(size, &q) => break,
            None => damping *= constant(10.0),
        }
        if damping > constant(1e12) {
            break;
        }
    }
    let (worst, size) = largest(&residuals)?;
    near(size, &q).then_some(q).ok_or_else(|| off(M::CONSTRAINTS, worst, size))
}
