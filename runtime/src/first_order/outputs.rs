//! Outputs of mechanisms with first-order states, and their derivatives with respect to these states.

use super::FirstOrder;
use super::extended::{Extended, split};
use crate::{OutputDerivatives, OutputJacobians, Outputs, Real};
use nalgebra::{SMatrix, SVector};

/// Derivatives of all outputs with respect to first-order states. `#[mechanism(…, derivatives)]` implements
/// the trait for mechanisms that have both first-order states and [`Outputs`], but no constraints.
#[diagnostic::on_unimplemented(
    message = "the outputs of `{Self}` have no derivatives by states of first order",
    note = "enable them with the option: `#[mechanism(…, derivatives)]`; mechanisms with constraints have \
            none"
)]
pub trait OutputsByStates<const NQ: usize, const NV: usize, const NU: usize, const NX: usize, const NY: usize>:
    OutputDerivatives<NQ, NV, NU, NY>
{
    /// Returns the partial derivatives `∂y/∂x` of the [`outputs`](Outputs::outputs) with respect to the
    /// first-order states `x`.
    fn outputs_by_states(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SMatrix<Self::Scalar, NY, NX>;
}

/// Returns the outputs for the first-order states contained in the extended velocity.
impl<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NX: usize,
    const NE: usize,
    const NY: usize,
> Outputs<NQ, NE, NU, NY> for Extended<'_, M, NV, NX, NE>
where
    T: Real,
    M: Outputs<NQ, NV, NU, NY, Scalar = T> + FirstOrder<NQ, NV, NU, NX, NE, Scalar = T>,
{
    type Scalar = T;
    const OUTPUTS: [&'static str; NY] = M::OUTPUTS;
    const OUTPUT_UNITS: [&'static str; NY] = M::OUTPUT_UNITS;

    fn outputs(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NE>,
        a: &SVector<T, NE>,
        u: &SVector<T, NU>,
    ) -> SVector<T, NY> {
        let ((m, v), a) = (self.mechanism_and_velocities(v), split::<_, NV, NX, NE>(a).0);
        m.outputs(t, q, &v, &a, u)
    }
}

impl<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NX: usize,
    const NE: usize,
    const NY: usize,
> OutputDerivatives<NQ, NE, NU, NY> for Extended<'_, M, NV, NX, NE>
where
    T: Real,
    M: OutputsByStates<NQ, NV, NU, NX, NY, Scalar = T> + FirstOrder<NQ, NV, NU, NX, NE, Scalar = T>,
{
    fn output_derivatives(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NE>,
        a: &SVector<T, NE>,
        u: &SVector<T, NU>,
    ) -> OutputJacobians<T, NY, NE, NU> {
        let ((m, v), a) = (self.mechanism_and_velocities(v), split::<_, NV, NX, NE>(a).0);
        let own = m.output_derivatives(t, q, &v, &a, u);
        let (by_x, none) = (m.outputs_by_states(t, q, &v, &a, u), SMatrix::<T, NY, NX>::zeros());
        OutputJacobians {
            by_q: join_columns(&own.by_q, &none),
            by_v: join_columns(&own.by_v, &by_x),
            by_a: join_columns(&own.by_a, &none),
            by_u: own.by_u,
        }
    }
}

/// Concatenates the derivatives with respect to velocities (left columns) and with respect to first-order
/// states (right columns).
fn join_columns<T: Real, const R: usize, const NV: usize, const NX: usize, const NE: usize>(
    left: &SMatrix<T, R, NV>,
    right: &SMatrix<T, R, NX>,
) -> SMatrix<T, R, NE> {
    SMatrix::from_fn(|i, j| {
        let entry = left.get((i, j)).or(right.get((i, j.wrapping_sub(NV))));
        entry.copied().unwrap_or(T::zero())
    })
}
