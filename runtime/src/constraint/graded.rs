//! Velocity changes that satisfy enforced constraint rows, for masses that differ by many orders of
//! magnitude.

use super::span::{ColumnSpan, MassFactorisation, entry_or_zero, rounding_threshold};
use crate::Real;
use nalgebra::{SMatrix, SVector};

/// Returns the change `x` of the velocity with `J x = changes` in the rows that are `held`, and impulses `λ`
/// in these rows with `M x = Jᵀ λ`; `None` if the rows depend on each other.
///
/// The rows are factorised in the metric of the kinetic energy, so that light bodies lose no digits to heavy
/// ones. Rows of one number in `groups` are components of one vector.
pub(crate) fn velocity_change_and_impulses<T: Real, const NV: usize, const NC: usize>(
    mass: &SMatrix<T, NV, NV>,
    jacobian: &SMatrix<T, NC, NV>,
    (held, groups): (&[bool; NC], &[usize; NC]),
    changes: &SVector<T, NC>,
) -> Option<(SVector<T, NV>, SVector<T, NC>)> {
    let mut rows = *jacobian;
    for column in &mut rows.data.0 {
        column.iter_mut().zip(held).filter(|(_, held)| !**held).for_each(|(entry, _)| *entry = T::zero());
    }
    let metric = MassFactorisation::new(&mass.data.0);
    let mut span = ColumnSpan::new(&metric, &rows, groups);
    span.extend_basis(rounding_threshold(), NC);
    if span.rank < held.iter().filter(|held| **held).count() {
        return None;
    }
    let solve_for_impulses = |changes: &SVector<T, NC>| {
        // `Rᵀ z = changes`, then `R λ = z`, by columns in the order in which they joined the basis.
        let mut z = [T::zero(); NV];
        for step in 0..span.rank {
            let (k, pivot) = span.column_of_basis_step(step)?;
            let change = entry_or_zero(&changes.data.0[0], k) / pivot.length;
            let rest = pivot.x.iter().zip(&z).take(step).fold(change, |rest, (x, z)| rest - *x * *z);
            *z.get_mut(step)? = rest / entry_or_zero(&pivot.x, step);
        }
        let mut impulses = SVector::<T, NC>::zeros();
        for step in (0..span.rank).rev() {
            let later = (step + 1..span.rank).filter_map(|later| span.column_of_basis_step(later));
            let rest = later.fold(entry_or_zero(&z, step), |rest, (k, column)| {
                rest - entry_or_zero(&column.x, step) * column.length * entry_or_zero(&impulses.data.0[0], k)
            });
            let (k, pivot) = span.column_of_basis_step(step)?;
            *impulses.get_mut(k)? = rest / (entry_or_zero(&pivot.x, step) * pivot.length);
        }
        Some((SVector::from(metric.solve_transposed(span.undo_reflections(z))), impulses))
    };
    let (x, impulses) = solve_for_impulses(changes)?;
    // Velocities of light bodies are much larger than their rounding errors, because the rows determine them.
    let (rest, more) = solve_for_impulses(&(changes - rows * x))?;
    Some((x + rest, impulses + more))
}
