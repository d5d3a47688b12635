//! Assembly: search for a configuration that satisfies the constraints, and its assembly mode.

use super::{
    ConstraintError, complete, is_residual_acceptable, largest_entry, unsatisfied_configuration_error,
};
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::{SMatrix, SVector};

/// Maximum number of steps of one descent from a starting point towards an assembled configuration.
const MOST_STEPS: usize = 200;

/// Maximum change of an angle in one step of assembly, rad. With short steps, a guess near an assembly mode
/// leads to this mode.
const LONGEST: f64 = 0.3;

/// Number of further starting points around the guess of an assembly. Their distances grow from `NEAR` to
/// `FAR`, m or rad.
const AGAIN: usize = 24;
const NEAR: f64 = 0.05;
const FAR: f64 = 3.0;
/// Number of repetitions of all starting points of an assembly if a particular assembly mode is requested.
const ROUNDS: usize = 8;

/// Constraints of a mechanism with or without inertia, for assembly.
pub struct Loops<'a, R, J, I, const NV: usize, const NC: usize> {
    /// Names of the constraints that assembly satisfies.
    pub names: [&'static str; NC],
    /// Indices of the entries of `q` that are angles.
    pub angles: &'a [usize],
    /// Whether each velocity is that of a rotation.
    pub turns: [bool; NV],
    /// Numbers of holonomic constraints and of velocities; further rows and columns are padding.
    pub sizes: [usize; 2],
    /// Function that returns the residuals of the holonomic constraints.
    pub residuals: R,
    /// Function that returns the derivatives of all constraint rates with respect to the velocities.
    pub jacobian: J,
    /// Function that returns the configuration after a displacement.
    pub integrate: I,
}

/// Finds a configuration that satisfies the constraints, starting at a guess. If the descent ends at a
/// nonzero residual, or more than half a revolution away, points around the guess are tried. If `mode` is
/// given, the result has this [`assembly_mode`].
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
    loops: &Loops<'_, R, J, I, NV, NC>,
    q: &SVector<T, NQ>,
    held: &[usize],
    mode: Option<i8>,
) -> Result<SVector<T, NQ>, ConstraintError> {
    complete::check_held_velocity_indices::<NV>(held)?;
    let has_wanted_mode = |q: &SVector<T, NQ>| mode.is_none() || assembly_mode(loops, q, held) == mode;
    // First configuration found whose angles differ by more than half a revolution, as gears may require.
    let mut far = None;
    let mut try_assembly_from = |from: &SVector<T, NQ>| -> Result<Option<SVector<T, NQ>>, ConstraintError> {
        let found = remove_whole_revolutions(loops, q, descend_to_configuration(loops, from, held)?);
        let turned = loops
            .angles
            .iter()
            .map(|k| revolutions_from_guess(q, &found, *k).abs())
            .fold(T::zero(), |a, b| a.max(b));
        if turned <= constant(0.5) && has_wanted_mode(&found) {
            return Ok(Some(found));
        }
        far = far.or_else(|| has_wanted_mode(&found).then_some(found));
        Ok(None)
    };
    let first = try_assembly_from(q);
    match first {
        Ok(Some(found)) => return Ok(found),
        Ok(None) | Err(ConstraintError::Configuration { .. }) => {}
        Err(error) => return Err(error),
    }
    // Steele and Vigna, Computationally easy, spectrally good multipliers for congruential generators, 2022.
    let mut state = 1_u64;
    let mut next_random_number = || {
        state = state.wrapping_mul(0xD134_2543_DE82_EF95).wrapping_add(1);
        (state >> 32) as f64 / f64::from(1_u32 << 31) - 1.0
    };
    for start in 0..AGAIN * if mode.is_some() { ROUNDS } else { 1 } {
        let distance = NEAR + (FAR - NEAR) / AGAIN as f64 * (start % AGAIN) as f64;
        let step = SVector::<T, NV>::from_fn(|k, _| {
            let part = next_random_number();
            if held.contains(&k) { nalgebra::zero() } else { constant(distance * part) }
        });
        if let Ok(Some(found)) = try_assembly_from(&(loops.integrate)(q, &step)) {
            return Ok(found);
        }
    }
    match (far, first, mode) {
        (Some(far), ..) => Ok(far),
        (None, Err(error), _) => Err(error),
        (None, Ok(_), mode) => Err(ConstraintError::Mode { mode: mode.unwrap_or(0) }),
    }
}

/// Returns the number of revolutions by which an angle differs from that of the guess.
fn revolutions_from_guess<T: Real, const NQ: usize>(
    guess: &SVector<T, NQ>,
    q: &SVector<T, NQ>,
    k: usize,
) -> T {
    let coordinate_entry = |q: &SVector<T, NQ>| q.get(k).copied().unwrap_or(T::zero());
    (coordinate_entry(q) - coordinate_entry(guess)) / T::two_pi()
}

/// Subtracts whole revolutions from angles that are more than half a revolution from the guess, if the result
/// still satisfies the constraints. First tries all angles together, then each individually.
fn remove_whole_revolutions<
    T: Real,
    R: Fn(&SVector<T, NQ>) -> SVector<T, NH>,
    J,
    I,
    const NQ: usize,
    const NV: usize,
    const NH: usize,
    const NC: usize,
>(
    loops: &Loops<'_, R, J, I, NV, NC>,
    guess: &SVector<T, NQ>,
    q: SVector<T, NQ>,
) -> SVector<T, NQ> {
    let subtract_revolutions_from_guess = |mut q: SVector<T, NQ>, angles: &[usize]| {
        for k in angles {
            let whole = revolutions_from_guess(guess, &q, *k).round();
            if let Some(angle) = q.get_mut(*k) {
                *angle -= whole * T::two_pi();
            }
        }
        q
    };
    let satisfies_constraints = |q: &SVector<T, NQ>| {
        largest_entry(&(loops.residuals)(q)).is_ok_and(|(_, residual)| is_residual_acceptable(residual, q))
    };
    let all = subtract_revolutions_from_guess(q, loops.angles);
    if all == q || satisfies_constraints(&all) {
        return all;
    }
    loops.angles.chunks(1).fold(q, |q, angle| {
        let next = subtract_revolutions_from_guess(q, angle);
        if satisfies_constraints(&next) { next } else { q }
    })
}

/// Returns the configuration to which [`least_violation`] leads, if it satisfies the constraints.
fn descend_to_configuration<
    T: Real,
    R: Fn(&SVector<T, NQ>) -> SVector<T, NH>,
    J: Fn(&SVector<T, NQ>) -> SMatrix<T, NC, NV>,
    I: Fn(&SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NQ>,
    const NQ: usize,
    const NV: usize,
    const NH: usize,
    const NC: usize,
>(
    loops: &Loops<'_, R, J, I, NV, NC>,
    q: &SVector<T, NQ>,
    held: &[usize],
) -> Result<SVector<T, NQ>, ConstraintError> {
    let q = least_violation(loops, q, held)?;
    let (worst, size) = largest_entry(&(loops.residuals)(&q))?;
    is_residual_acceptable(size, &q)
        .then_some(q)
        .ok_or_else(|| unsatisfied_configuration_error(loops.names, worst, size))
}

/// Minimises `½ |φ|²` over the coordinates that are not held, by Levenberg–Marquardt steps of bounded length.
/// Returns the configuration, in which the constraints need not be satisfied.
#[doc(hidden)]
pub fn least_violation<
    T: Real,
    R: Fn(&SVector<T, NQ>) -> SVector<T, NH>,
    J: Fn(&SVector<T, NQ>) -> SMatrix<T, NC, NV>,
    I: Fn(&SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NQ>,
    const NQ: usize,
    const NV: usize,
    const NH: usize,
    const NC: usize,
>(
    loops: &Loops<'_, R, J, I, NV, NC>,
    q: &SVector<T, NQ>,
    held: &[usize],
) -> Result<SVector<T, NQ>, ConstraintError> {
    let mut q = *q;
    let mut residuals = (loops.residuals)(&q);
    largest_entry(&residuals)?;
    let mut damping = constant::<T>(1e-3);
    for _ in 0..MOST_STEPS {
        let (_, size) = largest_entry(&residuals)?;
        if size <= constant::<T>(4.0) * epsilon() {
            break;
        }
        let rows = holonomic_rows_of_free_velocities::<T, NV, NH, NC>(&(loops.jacobian)(&q), held);
        let mut normal = rows * rows.transpose();
        // Relative to each row, so that units have no effect. Zero rows are skipped.
        for k in 0..NH {
            let own = normal[(k, k)];
            let influences = own > nalgebra::zero();
            normal[(k, k)] = if influences { own + own * damping } else { nalgebra::one() };
        }
        let step = normal.cholesky().map(|c| -(rows.transpose() * c.solve(&residuals)));
        let next = step.map(|step| (loops.integrate)(&q, &limit_angle_steps(step, &loops.turns)));
        let trial = next.map(|next| (next, (loops.residuals)(&next)));
        match trial.filter(|(_, r)| r.norm() < residuals.norm()) {
            Some((next, r)) => {
                (q, residuals) = (next, r);
                damping *= constant(0.1);
            }
            // Only rounding errors remain.
            None if is_residual_acceptable(size, &q) => break,
            None => damping *= constant(10.0),
        }
        if damping > constant(1e12) {
            break;
        }
    }
    Ok(q)
}

/// Returns an assembly step that is scaled such that no angle changes by more than [`LONGEST`].
fn limit_angle_steps<T: Real, const NV: usize>(step: SVector<T, NV>, turns: &[bool; NV]) -> SVector<T, NV> {
    let angles = step.iter().zip(turns).filter(|(_, turns)| **turns);
    let longest = angles.fold(T::zero(), |longest, (angle, _)| longest.max(angle.abs()));
    if longest > constant(LONGEST) { step * (constant::<T>(LONGEST) / longest) } else { step }
}

/// Returns the rows of the holonomic constraints in the Jacobian, with zeros in the columns of velocities
/// that are held.
fn holonomic_rows_of_free_velocities<T: Real, const NV: usize, const NH: usize, const NC: usize>(
    jacobian: &SMatrix<T, NC, NV>,
    held: &[usize],
) -> SMatrix<T, NH, NV> {
    SMatrix::from_fn(|i, j| {
        let is_held = held.contains(&j);
        jacobian.get((i, j)).copied().filter(|_| !is_held).unwrap_or(nalgebra::zero())
    })
}

/// Returns the assembly mode of a configuration: the sign of the determinant of the derivatives of the
/// holonomic constraints with respect to the coordinates that are not held. Returns `None` in a singular
/// configuration, and if the number of these coordinates differs from that of the constraints.
pub fn assembly_mode<
    T: Real,
    R,
    J: Fn(&SVector<T, NQ>) -> SMatrix<T, NC, NV>,
    I,
    const NQ: usize,
    const NV: usize,
    const NH: usize,
    const NC: usize,
>(
    loops: &Loops<'_, R, J, I, NV, NC>,
    q: &SVector<T, NQ>,
    held: &[usize],
) -> Option<i8>
where
    R: Fn(&SVector<T, NQ>) -> SVector<T, NH>,
{
    let [holonomic, velocities] = loops.sizes;
    let is_held_velocity = |k: usize| held.contains(&k) || k >= velocities;
    if holonomic + (0..NV).filter(|k| is_held_velocity(*k)).count() != NV {
        return None;
    }
    // One row per constraint, then one per held velocity.
    let open = holonomic_rows_of_free_velocities::<T, NV, NH, NC>(&(loops.jacobian)(q), held);
    let mut rows = [[T::zero(); NV]; NV];
    let mut fixed = (0..NV).filter(|k| is_held_velocity(*k));
    for (i, row) in rows.iter_mut().enumerate() {
        if i < NH && i < holonomic {
            *row = core::array::from_fn(|j| open[(i, j)]);
        } else if let Some(own) = fixed.next().and_then(|k| row.get_mut(k)) {
            *own = T::one();
        }
        let length = row.iter().fold(T::zero(), |sum, x| sum + *x * *x).sqrt();
        row.iter_mut().for_each(|x| *x /= length);
    }
    let mut sign = 1;
    for k in 0..NV {
        let pivot = (k..NV).fold(k, |best, i| if rows[i][k].abs() > rows[best][k].abs() { i } else { best });
        // False if the pivot is NaN.
        let is_regular = rows[pivot][k].abs() > epsilon::<T>().sqrt();
        if !is_regular {
            return None;
        }
        if pivot != k {
            rows.swap(pivot, k);
            sign = -sign;
        }
        if rows[k][k] < T::zero() {
            sign = -sign;
        }
        let own = rows[k];
        for row in rows.iter_mut().skip(k + 1) {
            let factor = row[k] / own[k];
            row.iter_mut().zip(&own).for_each(|(x, own)| *x -= factor * *own);
        }
    }
    Some(sign)
}
