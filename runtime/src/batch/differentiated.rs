//! Derivatives of the states in lanes, computed lane by lane.

use super::{Batch, Lanewise};
use crate::blocks::zeros;
use crate::derivatives::{ByMotion, Derivatives};
use crate::forward::constants;
use crate::lanes::{lane, set_lane};
use crate::{Lanes, Real};
use nalgebra::{SMatrix, SVector};

/// Stores the values of one state, taken from one lane.
trait LaneResultAssembly<T: Real, const L: usize> {
    /// Type that holds the results of all lanes.
    type LaneResults;

    fn zero_results() -> Self::LaneResults;

    /// Writes the result of one state to lane `k` of the results.
    fn write_lane(self, all: &mut Self::LaneResults, k: usize);
}

impl<T: Real, const L: usize, const R: usize, const C: usize> LaneResultAssembly<T, L> for SMatrix<T, R, C> {
    type LaneResults = SMatrix<Lanes<T, L>, R, C>;

    fn zero_results() -> Self::LaneResults {
        zeros()
    }

    fn write_lane(self, all: &mut Self::LaneResults, k: usize) {
        set_lane(all, k, &self);
    }
}

impl<T: Real, const L: usize, A: LaneResultAssembly<T, L>, B: LaneResultAssembly<T, L>>
    LaneResultAssembly<T, L> for (A, B)
{
    type LaneResults = (A::LaneResults, B::LaneResults);

    fn zero_results() -> Self::LaneResults {
        (A::zero_results(), B::zero_results())
    }

    fn write_lane(self, all: &mut Self::LaneResults, k: usize) {
        self.0.write_lane(&mut all.0, k);
        self.1.write_lane(&mut all.1, k);
    }
}

impl<
    T: Real,
    const L: usize,
    A: LaneResultAssembly<T, L>,
    B: LaneResultAssembly<T, L>,
    C: LaneResultAssembly<T, L>,
> LaneResultAssembly<T, L> for (A, B, C)
{
    type LaneResults = (A::LaneResults, B::LaneResults, C::LaneResults);

    fn zero_results() -> Self::LaneResults {
        (A::zero_results(), B::zero_results(), C::zero_results())
    }

    fn write_lane(self, all: &mut Self::LaneResults, k: usize) {
        self.0.write_lane(&mut all.0, k);
        self.1.write_lane(&mut all.1, k);
        self.2.write_lane(&mut all.2, k);
    }
}

/// Returns the results of all lanes, each computed by `of`.
fn results_of_all_lanes<T: Real, const L: usize, R: LaneResultAssembly<T, L>>(
    of: impl Fn(usize) -> R,
) -> R::LaneResults {
    let mut all = R::zero_results();
    for k in 0..L {
        of(k).write_lane(&mut all, k);
    }
    all
}

/// Defines functions of `t` and vectors that evaluate each lane separately.
macro_rules! of_each {
    ($($name:ident[$($time:ident)?]($($argument:ident: $of:ident),*) -> $result:ty;)+) => {$(
        fn $name(&self, $($time: Self::Scalar,)? $($argument: &SVector<Self::Scalar, $of>),*) -> $result {
            results_of_all_lanes(|k| Derivatives::$name(self.mechanism, $($time.0[k],)? $(&lane($argument, k)),*))
        }
    )+};
}

type SquareMatrix<T, const NV: usize> = SMatrix<T, NV, NV>;
type MatrixPair<T, const NV: usize> = (SquareMatrix<T, NV>, SquareMatrix<T, NV>);

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const L: usize, const NQ: usize, const NV: usize, const NU: usize> Derivatives<NQ, NV, NU>
    for Lanewise<'_, M, L>
where
    M: Batch<NQ, NV, NU> + Derivatives<NQ, NV, NU>,
{
    crate::forward::linear_motion!(NQ, NV, NU);
    constants!(derivatives, M);

    of_each! {
        integrate_derivatives[](dv: NV) -> MatrixPair<Self::Scalar, NV>;
        tangent_rate_derivatives[](dv: NV, v: NV) -> MatrixPair<Self::Scalar, NV>;
        integrate_derivatives_at[](q: NQ, dv: NV) -> MatrixPair<Self::Scalar, NV>;
        displacement_rate_derivatives[](q: NQ, dv: NV, v: NV) -> ByMotion<Self::Scalar, NV, NV>;
        turning[](q: NQ, v: NV) -> SquareMatrix<Self::Scalar, NV>;
        coriolis_matrix[t](q: NQ, v: NV) -> SquareMatrix<Self::Scalar, NV>;
        inverse_dynamics_derivatives[t](q: NQ, v: NV, a: NV) -> MatrixPair<Self::Scalar, NV>;
        generalized_forces_derivatives[t](q: NQ, v: NV, u: NU) -> ByMotion<Self::Scalar, NV, NU>;
        generalized_momentum_derivatives[t](q: NQ, v: NV) -> SquareMatrix<Self::Scalar, NV>;
        momentum_rate_derivatives[t](q: NQ, v: NV) -> MatrixPair<Self::Scalar, NV>;
        forward_dynamics_derivatives[t](q: NQ, v: NV, tau: NV) -> ByMotion<Self::Scalar, NV, NV>;
    }

    fn forward_dynamics_derivatives_into(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
        by_q: &mut SquareMatrix<Self::Scalar, NV>,
        by_v: &mut SquareMatrix<Self::Scalar, NV>,
        by_tau: &mut SquareMatrix<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        let (acceleration, found) = results_of_all_lanes(|k| {
            let (mut by_q, mut by_v, mut by_tau) = (zeros(), zeros(), zeros());
            let (q, v, tau) = (lane(q, k), lane(v, k), lane(tau, k));
            let acceleration = self.mechanism.forward_dynamics_derivatives_into(
                t.0[k],
                &q,
                &v,
                &tau,
                &mut by_q,
                &mut by_v,
                &mut by_tau,
            );
            (acceleration, (by_q, by_v, by_tau))
        });
        (*by_q, *by_v, *by_tau) = found;
        acceleration
    }

    /// Returns `None`, because generic code over constraints is not available for lanes.
    fn visit_constraints<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::constraint::Visitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }
}
