//! Linear-quadratic regulator for any mechanism, in blocks of `NV` by `NV`. Several examples include this
//! module.

use linkwork::Derivatives;
use linkwork::discrete::{self, DifferentiableStep};
use linkwork::nalgebra::SVector;
use linkwork::optimal::{Policy, Quadratic, Value, backward};

/// Returns the linear-quadratic regulator about a state of rest, for any mechanism, and its cost-to-go. It
/// repeats the recursion of optimal control with the same step and the same costs until the cost-to-go
/// converges.
///
/// Returns `None` if it does not converge, as for a mechanism that cannot be stabilised, or if a value is not
/// finite.
pub fn linear_quadratic_regulator<M, S, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    method: &S,
    q: &SVector<f64, NQ>,
    u: &SVector<f64, NU>,
    costs: &Quadratic<f64, NV, NU>,
) -> Option<(Policy<f64, NV, NU>, Value<f64, NV>)>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
    S: DifferentiableStep<f64>,
{
    let step = discrete::transition(m, method, 0.0, q, &SVector::zeros(), u).ok()?;
    let mut to_go = Value::zeros();
    for _ in 0..10_000 {
        let (policy, before) = backward(&step, costs, &to_go, 0.0).ok()?;
        let change = (before.qq - to_go.qq).amax() + (before.vv - to_go.vv).amax();
        to_go = before;
        if change <= 1e-9 * to_go.vv.amax() {
            return Some((policy, to_go));
        }
    }
    None
}
