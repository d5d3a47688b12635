//! Solution of the equations of motion with sliding contacts: finds the signs of their normal forces, on
//! which friction depends.

use super::layout::Elimination;
use super::solve::{has_determined_pivot, regular_solution};
use super::{ConstraintError, Solution};
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

/// Returns accelerations and multipliers with friction proportional to the magnitudes of the multipliers
/// `rows`. `solve` returns the input of [`regular_solution`] for assumed signs of these multipliers.
/// Initially all normal forces are assumed to be compressive; the sign is changed for those that result as
/// tensile. One contact is resolved in the second attempt.
#[inline]
pub fn slipping_solution<T: Real, const NV: usize, const NC: usize, const K: usize>(
    rows: &[usize; K],
    groups: &[usize; NC],
    names: &[&'static str; NC],
    solve: impl Fn(&[T; K]) -> Elimination<T, NV, NC>,
) -> Result<Solution<T, NV, NC>, ConstraintError> {
    let jammed_error =
        |row: usize| ConstraintError::Jammed { constraint: names.get(row).copied().unwrap_or("") };
    let mut sides = [T::one(); K];
    for _ in 0..=2 * K {
        let found = solve(&sides);
        for row in 0..NC {
            if !has_determined_pivot(groups, &found, row) {
                return Err(if rows.contains(&row) { jammed_error(row) } else { ConstraintError::Singular });
            }
        }
        let mut settled = true;
        for (side, row) in sides.iter_mut().zip(rows) {
            let force = found.multipliers.get(*row).copied().unwrap_or(T::zero());
            if force * *side < T::zero() {
                *side = -*side;
                settled = false;
            }
        }
        if settled {
            return Ok(found.accelerations_and_multipliers());
        }
    }
    Err(jammed_error(rows.first().copied().unwrap_or(0)))
}

/// Returns the solution for lanes if all sliding contacts have positive normal forces in every lane.
#[inline]
pub fn pressing_solution<T: Real, const NV: usize, const NC: usize>(
    rows: &[usize],
    groups: &[usize; NC],
    found: &Elimination<T, NV, NC>,
) -> Option<Solution<T, NV, NC>> {
    let solution = regular_solution(groups, found)?;
    let has_positive_force = |row: &usize| solution.1.get(*row).is_some_and(|force| *force > T::zero());
    rows.iter().all(has_positive_force).then_some(solution)
}

/// Returns accelerations as a function of forces and biases, with the signs of the multipliers fixed. This is
/// the response of the motion to small changes.
#[inline]
pub fn slipping_response<'a, T: Real, const NV: usize, const NC: usize, const K: usize>(
    rows: &'a [usize; K],
    groups: &'a [usize; NC],
    lambda: &'a SVector<T, NC>,
    solve: impl Fn(&[T; NV], &[T; NC], &[T; K]) -> Elimination<T, NV, NC> + 'a,
) -> impl Fn(&[T; NV], &[T; NC]) -> SVector<T, NV> + 'a {
    move |force, bias| {
        let sides = rows.map(|row| match lambda.get(row) {
            Some(force) if *force < T::zero() => -T::one(),
            _ => T::one(),
        });
        let found = solve(force, bias, &sides);
        let is_determined = (0..NC).all(|k| has_determined_pivot(groups, &found, k));
        if is_determined {
            found.accelerations_and_multipliers().0
        } else {
            SVector::repeat(constant(f64::NAN))
        }
    }
}
