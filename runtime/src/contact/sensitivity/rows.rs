//! Derivatives at the rows of contact velocities.

use super::super::problem::LinearisedImpulseEquations;
use super::super::selection::ContactSelection;
use crate::Real;
use crate::blocks::{add_product, zeros};
use crate::discrete::VectorWithDerivatives;
use nalgebra::{SMatrix, SVector};

/// Derivatives of values at the rows of contacts, with respect to configuration, velocity and inputs before
/// the step.
#[derive(Clone, Copy)]
pub(super) struct ContactRowDerivatives<T, const CR: usize, const NV: usize, const NU: usize> {
    pub(super) by_q: SMatrix<T, CR, NV>,
    pub(super) by_v: SMatrix<T, CR, NV>,
    pub(super) by_u: SMatrix<T, CR, NU>,
}

impl<T: Real, const CR: usize, const NV: usize, const NU: usize> ContactRowDerivatives<T, CR, NV, NU> {
    pub(super) fn zeros() -> Self {
        Self { by_q: zeros(), by_v: zeros(), by_u: zeros() }
    }

    /// Adds a matrix times the derivatives of a vector.
    pub(super) fn add_matrix_product(
        &mut self,
        by: &SMatrix<T, CR, NV>,
        of: &VectorWithDerivatives<T, NV, NU>,
    ) {
        add_product(&mut self.by_q, by, &of.by_q);
        add_product(&mut self.by_v, by, &of.by_v);
        add_product(&mut self.by_u, by, &of.by_u);
    }

    /// Adds the product of a matrix `by` and the derivatives `of`, whose rows belong to contact velocities.
    pub(super) fn add_row_matrix_product(&mut self, by: &SMatrix<T, CR, CR>, of: &Self) {
        add_product(&mut self.by_q, by, &of.by_q);
        add_product(&mut self.by_v, by, &of.by_v);
        add_product(&mut self.by_u, by, &of.by_u);
    }

    /// Adds the derivatives `of`, with the rows multiplied by the entries of a vector.
    pub(super) fn add_scaled_rows(&mut self, factors: &SVector<T, CR>, of: &Self) {
        add_scaled_rows(&mut self.by_q, factors, &of.by_q);
        add_scaled_rows(&mut self.by_v, factors, &of.by_v);
        add_scaled_rows(&mut self.by_u, factors, &of.by_u);
    }

    /// Returns all derivatives, multiplied by a number.
    pub(super) fn scaled_row_derivatives(&self, s: T) -> Self {
        Self { by_q: self.by_q * s, by_v: self.by_v * s, by_u: self.by_u * s }
    }

    /// Returns the derivatives of the impulses, if `self` holds the derivatives of the contact velocities
    /// without impulses. Inputs may also change the coefficients of friction, with derivatives `friction` at
    /// the rows of friction.
    pub(super) fn impulse_derivatives(
        &self,
        equations: &LinearisedImpulseEquations<T, CR>,
        friction: Option<&SMatrix<T, CR, NU>>,
    ) -> Self {
        let Self { by_q, by_v, by_u } = self;
        Self {
            by_q: equations.impulse_changes(by_q, None),
            by_v: equations.impulse_changes(by_v, None),
            by_u: equations.impulse_changes(by_u, friction),
        }
    }

    /// Adds the velocity change due to the contact impulses, with its derivatives.
    pub(super) fn add_velocity_change(
        &self,
        responses: &SMatrix<T, NV, CR>,
        to: &mut VectorWithDerivatives<T, NV, NU>,
    ) {
        add_product(&mut to.by_q, responses, &self.by_q);
        add_product(&mut to.by_v, responses, &self.by_v);
        add_product(&mut to.by_u, responses, &self.by_u);
    }
}

/// Returns the rows of selected contacts.
pub(super) fn selected_contact_rows<
    T: Real,
    const C: usize,
    const NR: usize,
    const CK: usize,
    const CR: usize,
>(
    selection: &ContactSelection<CK, CR>,
    all: &SMatrix<T, NR, C>,
) -> SMatrix<T, CR, C> {
    let mut rows = zeros::<T, CR, C>();
    for (to, from) in rows.data.0.iter_mut().zip(&all.data.0) {
        *to = selection.selected_contact_rates(&SVector::from(*from)).data.0[0];
    }
    rows
}

/// Copies row `i` of a matrix to row `j` of another one.
pub(super) fn copy_row<T: Real, const R: usize, const S: usize, const C: usize>(
    from: &SMatrix<T, R, C>,
    i: usize,
    to: &mut SMatrix<T, S, C>,
    j: usize,
) {
    for (to, from) in to.data.0.iter_mut().zip(&from.data.0) {
        if let (Some(to), Some(from)) = (to.get_mut(j), from.get(i)) {
            *to = *from;
        }
    }
}

/// Adds a matrix whose rows are multiplied by the entries of a vector.
pub(super) fn add_scaled_rows<T: Real, const R: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    factors: &SVector<T, R>,
    rows: &SMatrix<T, R, C>,
) {
    for (sum, column) in sum.data.0.iter_mut().zip(&rows.data.0) {
        let entries = sum.iter_mut().zip(column).zip(factors);
        entries.for_each(|((sum, entry), factor)| *sum += *entry * *factor);
    }
}
