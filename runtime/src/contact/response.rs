//! Responses of velocities to contact impulses.

use super::problem::{DelassusFactor, subtract_multiple};
use super::{Contacts, Responses, Rows};
use crate::Real;
use crate::blocks::transposed;
use nalgebra::{ArrayStorage, SMatrix, SVector};

/// Returns the responses of velocities to unit impulses at closed contacts, and zeros for other contacts.
#[doc(hidden)]
pub fn responses<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
    closed: &[bool; NK],
) -> Responses<T, NV, NR>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let jacobian = mechanism.contact_jacobian(t, q);
    let mut velocities = SMatrix::<T, NV, NR>::zeros();
    let features = mechanism.features();
    let is_plain = !features.constrained && !features.feedback;
    let factor =
        if is_plain { CholeskyFactor::cholesky_of_mass_matrix(&mechanism.mass_matrix(t, q)) } else { None };
    let still = SVector::zeros();
    let none = if factor.is_none() {
        mechanism.velocity_change_by_impulse(t, q, &still, T::zero(), &SVector::zeros())
    } else {
        still
    };
    let closed = mechanism.contact_tables().0.into_iter().zip(closed).filter(|(_, is_closed)| **is_closed);
    for row in closed.flat_map(|(Rows { first, count }, _)| first..first + count) {
        let p = jacobian.data.0.map(|column| column.get(row).copied().unwrap_or(T::zero()));
        let Some(answer) = velocities.data.0.get_mut(row) else { continue };
        *answer = match &factor {
            Some(factor) => factor.solve_with_factor(p),
            None => {
                (mechanism.velocity_change_by_impulse(t, q, &still, T::zero(), &SVector::from(p)) - none)
                    .data
                    .0[0]
            }
        };
    }
    let mut rates = SMatrix::<T, NR, NR>::zeros();
    for (rates, velocities) in rates.data.0.iter_mut().zip(&velocities.data.0) {
        // Bodies that a contact does not reach do not answer, and contacts that are open have no answer at
        // all.
        let answers = velocities.iter().zip(&jacobian.data.0).filter(|(velocity, _)| **velocity != T::zero());
        for (velocity, column) in answers {
            rates.iter_mut().zip(column).for_each(|(rate, entry)| *rate += *entry * *velocity);
        }
    }
    Responses { velocities, rates }
}

/// Effects of impulses at selected contacts on the velocities of a mechanism. The matrices are large and
/// filled in place.
pub(super) enum ImpulseEffects<T, const NV: usize, const CR: usize> {
    /// Not computed yet.
    Unknown,
    /// `L` of `M = L Lᵀ`. The effect of impulses is `L⁻ᵀ Bᵀ Λ`.
    Factor(CholeskyFactor<T, NV>),
    /// `M⁻¹ Gᵀ`, with the effects of constraints.
    Matrix(SMatrix<T, NV, CR>),
}

impl<T: Real, const NV: usize, const CR: usize> ImpulseEffects<T, NV, CR> {
    /// Returns the change of the velocity by impulses at the selected contacts.
    pub(super) fn velocity_change(
        &self,
        basis: &DelassusFactor<T, CR>,
        impulses: &SVector<T, CR>,
    ) -> SVector<T, NV> {
        match self {
            Self::Unknown => SVector::zeros(),
            Self::Factor(factor) => {
                let mut w = [T::zero(); NV];
                basis.write_changed_velocity_entries(impulses, &mut w);
                SVector::from(factor.solve_upper(w))
            }
            Self::Matrix(velocities) => velocities * impulses,
        }
    }
}

/// Cholesky factor `L` of the mass matrix `M = L Lᵀ`. Each row is stored from its first nonzero entry: bodies
/// that no joint connects have separate blocks.
pub(super) struct CholeskyFactor<T, const N: usize> {
    /// Rows, with the reciprocals of the diagonal.
    rows: [[T; N]; N],
    /// Index of the first entry of each row.
    starts: [usize; N],
    /// Index behind the last row of each row's block.
    ends: [usize; N],
}

impl<T: Real, const N: usize> CholeskyFactor<T, N> {
    /// Returns the Cholesky factor of a matrix; `None` if the matrix is not positive definite.
    pub(super) fn cholesky_of_mass_matrix(m: &SMatrix<T, N, N>) -> Option<Self> {
        let mut factor = Self::zero_factor();
        factor.factorise_matrix(m).then_some(factor)
    }

    /// Returns zeros, to be [filled](Self::factorise_matrix).
    pub(super) fn zero_factor() -> Self {
        Self { rows: [[T::zero(); N]; N], starts: [0; N], ends: [N; N] }
    }

    /// Factorises a matrix in place; false if it is not positive definite.
    pub(super) fn factorise_matrix(&mut self, matrix: &SMatrix<T, N, N>) -> bool {
        let Self { rows: m, starts, ends } = self;
        // Symmetric: columns are rows.
        *m = matrix.data.0;
        for (i, (start, row)) in starts.iter_mut().zip(&*m).enumerate() {
            *start = first_nonzero(row).min(i);
        }
        let (mut least, mut end) = (N, N);
        for i in (0..N).rev() {
            least = least.min(starts[i]);
            if least >= i {
                ends.iter_mut().take(end).skip(i).for_each(|entry| *entry = end);
                (least, end) = (N, i);
            }
        }
        for j in 0..N {
            let (above, below) = m.split_at_mut_checked(j + 1).unwrap_or_default();
            let Some(own) = above.last_mut() else { return false };
            let first = starts[j];
            let before = own.get(first..j).unwrap_or_default();
            let pivot = before.iter().fold(own[j], |pivot, entry| pivot - *entry * *entry);
            // A pivot that is NaN is not positive.
            let positive = pivot > T::zero();
            if !positive {
                return false;
            }
            let reciprocal = T::one() / pivot.sqrt();
            own[j] = reciprocal;
            let count = ends[j].saturating_sub(j + 1);
            let reached = below.iter_mut().zip(starts.iter().skip(j + 1)).take(count);
            for (row, start) in reached.filter(|(_, start)| **start <= j) {
                let from = (*start).max(first);
                let (left, right) = (row.get(from..j), own.get(from..j));
                let products = left.unwrap_or_default().iter().zip(right.unwrap_or_default());
                let entry = products.fold(row[j], |entry, (left, right)| entry - *left * *right);
                row[j] = entry * reciprocal;
            }
        }
        true
    }

    /// Returns the index behind the last entry of the block of row `j`.
    pub(super) fn block_end(&self, j: usize) -> usize {
        self.ends.get(j).copied().unwrap_or(N)
    }

    /// Returns the solution `x` of `L Lᵀ x = p`.
    pub(super) fn solve_with_factor(&self, p: [T; N]) -> [T; N] {
        let mut x = p;
        self.solve_lower(&mut x, first_nonzero(&p), N);
        self.solve_upper(x)
    }

    /// Returns the solutions `X` of `L Lᵀ X = P`, with operations on rows of all columns at once.
    pub(super) fn solve_all_columns<const C: usize>(&self, p: &SMatrix<T, N, C>) -> SMatrix<T, N, C> {
        let Self { rows, starts, .. } = self;
        let mut x = transposed(p).data.0;
        for i in 0..N {
            let (above, below) = x.split_at_mut(i);
            let Some(row) = below.first_mut() else { break };
            for (factor, other) in rows[i].iter().zip(above.iter()).skip(starts[i]) {
                subtract_multiple(row, *factor, other);
            }
            row.iter_mut().for_each(|entry| *entry *= rows[i][i]);
        }
        for i in (0..N).rev() {
            let (above, below) = x.split_at_mut(i);
            let Some(row) = below.first_mut() else { break };
            row.iter_mut().for_each(|entry| *entry *= rows[i][i]);
            for (factor, other) in rows[i].iter().zip(above).skip(starts[i]) {
                subtract_multiple(other, *factor, row);
            }
        }
        transposed(&SMatrix::from_array_storage(ArrayStorage(x)))
    }

    /// Replaces `p` by the solution `y` of `L y = p`. Entries before `start` are zero, and so are those of
    /// the solution from `end` on.
    pub(super) fn solve_lower(&self, x: &mut [T; N], start: usize, end: usize) {
        let Self { rows, starts, .. } = self;
        for i in start..end.min(N) {
            let known = starts[i].max(start)..i;
            let (row, solved) = (rows[i].get(known.clone()), x.get(known));
            let products = row.unwrap_or_default().iter().zip(solved.unwrap_or_default());
            x[i] = products.fold(x[i], |sum, (entry, x)| sum - *entry * *x) * rows[i][i];
        }
    }

    /// Returns `Lᵀ x`.
    pub(super) fn multiply_upper(&self, x: &[T; N]) -> [T; N] {
        let Self { rows, starts, .. } = self;
        let mut product = [T::zero(); N];
        for i in 0..N {
            product[i] = x[i] / rows[i][i];
            let above = product.get_mut(starts[i]..i).unwrap_or_default().iter_mut();
            let row = rows[i].get(starts[i]..i).unwrap_or_default();
            above.zip(row).for_each(|(product, entry)| *product += *entry * x[i]);
        }
        product
    }

    /// Returns the solution `x` of `Lᵀ x = y`.
    pub(super) fn solve_upper(&self, mut x: [T; N]) -> [T; N] {
        let Self { rows, starts, .. } = self;
        for i in (0..N).rev() {
            if x[i] != T::zero() {
                x[i] *= rows[i][i];
                let value = x[i];
                let above = x.get_mut(starts[i]..i).unwrap_or_default().iter_mut();
                let row = rows[i].get(starts[i]..i).unwrap_or_default();
                above.zip(row).for_each(|(x, entry)| *x -= *entry * value);
            }
        }
        x
    }
}

/// Returns the index of the first nonzero entry.
fn first_nonzero<T: Real, const N: usize>(row: &[T; N]) -> usize {
    row.iter().position(|entry| *entry != T::zero()).unwrap_or(N)
}
