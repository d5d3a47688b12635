//! Mechanisms with so many springs that their forces are a shared function, which other functions call.
//! Energies, powers and differences are consistent with it.

mod arm;
mod tent;
mod trampoline;
mod web;

use linkwork::Mechanism;
use linkwork::nalgebra::SVector;

/// Returns the derivative at zero by central differences of fourth order.
fn derivative_at_zero<const R: usize>(f: impl Fn(f64) -> SVector<f64, R>) -> SVector<f64, R> {
    let h = 1e-3;
    ((f(h) - f(-h)) * 8.0 - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
}

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
        derivative_at_zero(|s| [m.potential_energy(0.0, &m.integrate(q, &(unit_vector::<NV>(i) * s)))].into())
            [0]
    };
    SVector::from_fn(|i, _| potential_energy_slope(i))
}
