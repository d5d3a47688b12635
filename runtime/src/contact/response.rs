//! How velocities answer to impulses at contacts.

use super::{Contacts, Responses, Rows};
use crate::Real;
use nalgebra::{SMatrix, SVector};

/// What impulses at contacts that are closed do; zeros of others.
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
    let factor =
        if features.constrained || features.feedback { None } else { factor(mechanism.mass_matrix(t, q)) };
    let still = SVector::zeros();
    let none =
        if factor.is_none() { mechanism.impulse(t, q, &still, T::zero(), &SVector::zeros()) } else { still };
    let closed = mechanism.contact_tables().0.into_iter().zip(closed).filter(|(_, is_closed)| **is_closed);
    for row in closed.flat_map(|(Rows { first, count }, _)| first..first + count) {
        let p = jacobian.data.0.map(|column| column.get(row).copied().unwrap_or(T::zero()));
        let Some(answer) = velocities.data.0.get_mut(row) else { continue };
        *answer = match &factor {
            Some(factor) => substitute(factor, p),
            None => (mechanism.impulse(t, q, &still, T::zero(), &SVector::from(p)) - none).data.0[0],
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

/// The factor `L` of `M = L Lᵀ` (Cholesky) by rows, with the reciprocals of its diagonal; `None` where `M` is
/// not positive definite.
fn factor<T: Real, const N: usize>(m: SMatrix<T, N, N>) -> Option<[[T; N]; N]> {
    // Symmetric: columns are rows.
    let mut m = m.data.0;
    for j in 0..N {
        let pivot = (0..j).fold(m[j][j], |pivot, k| pivot - m[j][k] * m[j][k]);
        // It is not where it is no number, either.
        let positive = pivot > T::zero();
        if !positive {
            return None;
        }
        let reciprocal = T::one() / pivot.sqrt();
        m[j][j] = reciprocal;
        for i in j + 1..N {
            let entry = (0..j).fold(m[i][j], |entry, k| entry - m[i][k] * m[j][k]);
            m[i][j] = entry * reciprocal;
        }
    }
    Some(m)
}

/// `x` of `L Lᵀ x = p`.
fn substitute<T: Real, const N: usize>(l: &[[T; N]; N], mut x: [T; N]) -> [T; N] {
    for i in 0..N {
        x[i] = (0..i).fold(x[i], |sum, k| sum - l[i][k] * x[k]) * l[i][i];
    }
    for i in (0..N).rev() {
        x[i] = (i + 1..N).fold(x[i], |sum, k| sum - l[k][i] * x[k]) * l[i][i];
    }
    x
}
