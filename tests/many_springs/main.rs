//! Mechanisms with so many springs that their forces are a shared function, which other functions call.
//! Energies, powers and differences are consistent with it.

mod arm;
mod tent;
mod trampoline;
mod web;

use linkwork::Mechanism;
use linkwork::nalgebra::{SVector, Vector1};
use support::differences::derivative_at_zero;

const STEP: f64 = 5e-4;

fn unit_vector<const N: usize>(i: usize) -> SVector<f64, N> {
    SVector::from_fn(|j, _| if i == j { 1.0 } else { 0.0 })
}

/// Returns the gradient `∂U/∂q` of the potential energy by finite differences.
fn potential_gradient<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
) -> SVector<f64, NV>
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let potential_energy_slope = |i: usize| {
        derivative_at_zero(STEP, |s| {
            Vector1::new(m.potential_energy(0.0, &m.integrate(q, &(unit_vector::<NV>(i) * s))))
        })[0]
    };
    SVector::from_fn(|i, _| potential_energy_slope(i))
}
