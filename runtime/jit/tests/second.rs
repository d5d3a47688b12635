//! Checks second derivatives of loaded robots with differences of first derivatives.

use linkwork_jit::{Error, Loader, Matrix};

const CRANE: &str = "#[mechanism(gravity = -9.81 * y, second_derivatives)]
    struct Crane {
        #[body(mass = 2)]
        trolley: Body,
        #[body(mass = 0.5, com = -0.3 * y, inertia = rod(0.5, 0.6, y))]
        rope: Body,
        #[body(mass = 1, com = -0.2 * y, inertia = rod(1, 0.4, y))]
        load: Body,
        #[joint(ground -> trolley, along = x)]
        rail: Sleeve,
        #[joint(trolley -> rope, about = z)]
        swing: Pin,
        #[joint(rope.at(-0.6 * y) -> load, about = z)]
        hook: Pin,
        #[acts(on = rail)]
        drive: Force,
    }";
const N: usize = 3;

/// `λᵀ τ` differentiated twice equals central differences of `λᵀ ∂τ/∂q` and `λᵀ ∂τ/∂v`.
#[test]
fn second_derivatives_are_differences_of_first_derivatives() -> Result<(), Error> {
    let crane = Loader::text(CRANE).load()?;
    let f = crane.function("inverse_dynamics_second_derivatives")?;
    let names: Vec<&str> = f.results().iter().map(|matrix: &Matrix| matrix.name).collect();
    assert_eq!(names, ["by_qq", "by_qv", "by_vv", "by_qa"]);
    let (q, v, a, lambda) = ([0.2, 0.7, -0.4], [0.5, -1.1, 0.8], [0.3, 0.9, -0.6], [0.7, -0.2, 1.3]);
    let found = crane.evaluate(&f, &[&q, &v, &a, &lambda])?;
    let first = crane.function("inverse_dynamics_derivatives")?;
    // λᵀ ∂τ/∂q, then λᵀ ∂τ/∂v.
    let contracted_torque_derivatives = |q: &[f64], v: &[f64], a: &[f64]| -> Result<Vec<f64>, Error> {
        let all = crane.evaluate(&first, &[q, v, a])?;
        Ok(all.chunks(N).map(|column| column.iter().zip(&lambda).map(|(x, l)| x * l).sum()).collect())
    };
    let e = 1e-6;
    for j in 0..N {
        let with_displaced_entry = |x: [f64; N], by: f64| {
            let mut x = x;
            x[j] += by;
            x
        };
        let central_differences = |ahead: Vec<f64>, behind: Vec<f64>| -> Vec<f64> {
            ahead.iter().zip(behind).map(|(a, b)| (a - b) / (2.0 * e)).collect()
        };
        let by_q = central_differences(
            contracted_torque_derivatives(&with_displaced_entry(q, e), &v, &a)?,
            contracted_torque_derivatives(&with_displaced_entry(q, -e), &v, &a)?,
        );
        let by_v = central_differences(
            contracted_torque_derivatives(&q, &with_displaced_entry(v, e), &a)?,
            contracted_torque_derivatives(&q, &with_displaced_entry(v, -e), &a)?,
        );
        let by_a = central_differences(
            contracted_torque_derivatives(&q, &v, &with_displaced_entry(a, e))?,
            contracted_torque_derivatives(&q, &v, &with_displaced_entry(a, -e))?,
        );
        for i in 0..N {
            let second_derivative_entry = |block: usize| found[block * N * N + j * N + i];
            for (found, expected) in [
                (second_derivative_entry(0), by_q[i]),
                (second_derivative_entry(1), by_v[i]),
                (second_derivative_entry(2), by_v[N + i]),
                (second_derivative_entry(3), by_a[i]),
            ] {
                assert!((found - expected).abs() < 1e-7, "({i}, {j}): {found} instead of {expected}");
            }
        }
    }
    Ok(())
}
