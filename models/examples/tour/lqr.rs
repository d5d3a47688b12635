//! A linear–quadratic regulator from the generated equations: linearise, sample, iterate Riccati's equation.

use linkwork::Mechanism;
use linkwork::nalgebra::{SMatrix, SVector};

/// `ẋ = A x + B u` at rest at `q`, in `x = (δq, v)`, by central differences. `NX` is twice `NV`; every coordinate plain.
pub fn linearise<M, const N: usize, const NU: usize, const NX: usize>(
    m: &M,
    q: &SVector<f64, N>,
) -> (SMatrix<f64, NX, NX>, SMatrix<f64, NX, NU>)
where
    M: Mechanism<N, N, NU, Scalar = f64>,
{
    const { assert!(NX == 2 * N, "a state is positions and velocities") };
    let rate = |x: SVector<f64, NX>, u: SVector<f64, NU>| -> SVector<f64, NX> {
        let q = q + x.fixed_rows::<N>(0);
        let v = x.fixed_rows::<N>(N).into_owned();
        let a = m.forward_dynamics(&q, &v, &m.generalized_forces(&q, &v, &u));
        SVector::from_fn(|k, _| if k < N { v[k] } else { a[k - N] })
    };
    let step = 1e-5;
    let (mut a, mut b) = (SMatrix::<f64, NX, NX>::zeros(), SMatrix::<f64, NX, NU>::zeros());
    for k in 0..NX {
        let mut dx = SVector::zeros();
        dx[k] = step;
        let column = (rate(dx, SVector::zeros()) - rate(-dx, SVector::zeros())) / (2.0 * step);
        a.set_column(k, &column);
    }
    for k in 0..NU {
        let mut du = SVector::zeros();
        du[k] = step;
        let column = (rate(SVector::zeros(), du) - rate(SVector::zeros(), -du)) / (2.0 * step);
        b.set_column(k, &column);
    }
    (a, b)
}

/// Gains `K` of `u = −K x` for inputs held over `period` seconds: the least sum of `xᵀ Q x + uᵀ R u`, both diagonal.
///
/// `None` if the iteration does not settle, as for a system that cannot be stabilised.
pub fn gains<const NX: usize, const NU: usize>(
    (a, b): &(SMatrix<f64, NX, NX>, SMatrix<f64, NX, NU>),
    period: f64,
    state_cost: [f64; NX],
    input_cost: [f64; NU],
) -> Option<SMatrix<f64, NU, NX>> {
    // Zero-order hold: x⁺ = Φ x + Γ u, with Φ = eᴬʰ and Γ = ∫ eᴬᵗ dt B by their series.
    let mut term = SMatrix::<f64, NX, NX>::identity();
    let (mut phi, mut integral) = (term, term * period);
    for k in 1..16 {
        term = term * a * period / k as f64;
        phi += term;
        integral += term * period / (k + 1) as f64;
    }
    let gamma = integral * b;

    let q = SMatrix::<f64, NX, NX>::from_diagonal(&state_cost.into());
    let r = SMatrix::<f64, NU, NU>::from_diagonal(&input_cost.into());
    let mut p = q;
    for _ in 0..100_000 {
        let k = (r + gamma.transpose() * p * gamma).try_inverse()? * gamma.transpose() * p * phi;
        let next = q + phi.transpose() * p * (phi - gamma * k);
        let change = (next - p).amax();
        p = (next + next.transpose()) / 2.0;
        if change <= 1e-10 * p.amax() {
            return Some(k);
        }
    }
    None
}
