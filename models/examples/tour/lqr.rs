//! A linear–quadratic regulator of a linear system: sample, iterate Riccati's equation.

use linkwork::nalgebra::SMatrix;

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
