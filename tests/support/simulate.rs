//! Simulation of mechanisms without inputs, for tests.

use linkwork::integrate::DormandPrince;
use linkwork::nalgebra::SVector;
use linkwork::{Mechanism, simulate};

/// Returns the state after `duration` from t = 0, integrated to the precision of `f64`.
pub fn state_after_duration<M, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    duration: f64,
) -> (SVector<f64, NQ>, SVector<f64, NV>)
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    state_after_duration_from(mechanism, 0.0, q, v, duration)
}

/// Returns the state after `duration` from the time `start`, integrated to the precision of `f64`.
pub fn state_after_duration_from<M, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    start: f64,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    duration: f64,
) -> (SVector<f64, NQ>, SVector<f64, NV>)
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let method = DormandPrince::new().tolerance(1e-14, 1e-14);
    let run = simulate(mechanism).from(*q, *v).start_at(start).duration(duration).method(method);
    let end = run.finish().expect("the integrator arrives");
    (end.q, end.v)
}
