//! Motion of mechanisms that nothing drives.

use linkwork::integrate::DormandPrince;
use linkwork::nalgebra::SVector;
use linkwork::{Mechanism, simulate};

/// The state after `duration`, integrated to the last digits of `f64`.
pub fn advance<M, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    duration: f64,
) -> (SVector<f64, NQ>, SVector<f64, NV>)
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let method = DormandPrince::new().tolerance(1e-14, 1e-14);
    let end = simulate(mechanism).from(*q, *v).duration(duration).method(method).finish();
    let end = end.expect("the integrator arrives");
    (end.q, end.v)
}
