//! Assembly: from a guess to a configuration that fulfils the constraints.

use super::{ConstraintError, complete, largest, near, off};
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::{SMatrix, SVector};

/// Most steps tried.
const MOST_STEPS: usize = 200;

/// How often it is tried again from around the guess, ever farther away: the first and the last distance, m or rad.
const AGAIN: usize = 24;
const NEAR: f64 = 0.05;
const FAR: f64 = 3.0;

/// What constraints say of configurations, whether there is inertia or not.
pub struct Loops<R, J, I, const NC: usize> {
    /// Name of every constraint.
    pub names: [&'static str; NC],
    /// What is left of those on configurations.
    pub residuals: R,
    /// Derivatives of all of them.
    pub jacobian: J,
    /// The configuration after a displacement.
    pub integrate: I,
}

/// By steps from the guess; where these end in a gap that no small step closes, from around it.
pub fn assemble<
    T: Real,
    R: Fn(&SVector<T, NQ>) -> SVector<T, NH>,
    J: Fn(&SVector<T, NQ>) -> SMatrix<T, NC, NV>,
    I: Fn(&SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NQ>,
    const NQ: usize,
    const NV: usize,
    const NH: usize,
    const NC: usize,
>(
    loops: &Loops<R, J, I, NC>,
    q: &SVector<T, NQ>,
    held: &[usize],
) -> Result<SVector<T, NQ>, ConstraintError> {
    complete::check::<NV>(held)?;
    let first = descend(loops, q, held);
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
        let step = SVector::<T, NV>::from_fn(|k, _| {
            let part = next();
            if held.contains(&k) { nalgebra::zero() } else { constant(distance * part) }
        });
        let found = descend(loops, &(loops.integrate)(q, &step), held);
        if found.is_ok() {
            return found;
        }
        distance += (FAR - NEAR) / AGAIN as f64;
    }
    first
}

/// Levenberg–Marquardt on `½ |φ|²` over the coordinates that are not held.
fn descend<
    T: Real,
    R: Fn(&SVector<T, NQ>) -> SVector<T, NH>,
    J: Fn(&SVector<T, NQ>) -> SMatrix<T, NC, NV>,
    I: Fn(&SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NQ>,
    const NQ: usize,
    const NV: usize,
    const NH: usize,
    const NC: usize,
>(
    loops: &Loops<R, J, I, NC>,
    q: &SVector<T, NQ>,
    held: &[usize],
) -> Result<SVector<T, NQ>, ConstraintError> {
    let mut q = *q;
    let mut residuals = (loops.residuals)(&q);
    largest(&residuals)?;
    let mut damping = constant::<T>(1e-3);
    for _ in 0..MOST_STEPS {
        let (_, size) = largest(&residuals)?;
        if size <= constant::<T>(4.0) * epsilon() {
            break;
        }
        let jacobian = (loops.jacobian)(&q);
        let rows = SMatrix::<T, NH, NV>::from_fn(|i, j| {
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
        let next = step.map(|step| (loops.integrate)(&q, &step));
        let trial = next.map(|next| (next, (loops.residuals)(&next)));
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
    near(size, &q).then_some(q).ok_or_else(|| off(loops.names, worst, size))
}
