//! Second derivatives of steps with rotational displacements (ball and free joints), also under constraints.
//! The reference is second differences of the steps themselves, with displacements in the tangent spaces at
//! the start and at the end.

use super::constrained::{Marble, TiedFlyingBody};
use super::{FlyingBodyWithLoad, Solo};
use linkwork::prelude::*;
use linkwork::{SecondDerivatives, discrete};
use support::random::Random;

/// Weights of the central difference of tenth order for a second derivative at zero. They apply to the
/// multiples 1, 2, … of the step on both sides, for a function that is zero at the origin.
const WEIGHTS: [f64; 5] = [5.0 / 3.0, -5.0 / 21.0, 5.0 / 126.0, -5.0 / 1008.0, 1.0 / 3150.0];

/// Compares quadratic forms of the second derivatives along random changes of state and inputs with
/// differences.
fn check_second_derivative_quadratic_forms<M, S, const NQ: usize, const NV: usize, const NU: usize>(
    name: &str,
    m: &M,
    method: &S,
    state: (&SVector<f64, NQ>, &SVector<f64, NV>),
) where
    M: SecondDerivatives<NQ, NV, NU, Scalar = f64>,
    S: discrete::TwiceDifferentiableStep<f64>,
{
    let (mut random, t, (q, v)) = (Random::new(5), 0.3, state);
    let u = random.random_vector::<NU>(2.0);
    let (of_q, of_v) = (random.random_vector::<NV>(1.0), random.random_vector::<NV>(1.0));
    let (qq, qv, vv, qu, vu, uu) =
        discrete::second_order(m, method, t, q, v, &u, (&of_q, &of_v)).expect("it moves");
    for symmetric in [&qq, &vv] {
        assert!((symmetric - symmetric.transpose()).amax() < 1e-11 * (1.0 + symmetric.amax()), "{name}");
    }
    let end = discrete::step(m, method, t, q, v, &u).expect("it moves");
    // Each block separately, then all at once.
    for (case, weights) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3], [1.0; 3]]
        .into_iter()
        .cycle()
        .take(30)
        .enumerate()
    {
        let dq = random.random_vector::<NV>(weights[0]);
        let dv = random.random_vector::<NV>(weights[1]);
        let du = random.random_vector::<NU>(weights[2]);
        let weighted_step_end = |s: f64| {
            let (q, v) = (m.integrate(q, &(dq * s)), v + dv * s);
            let found = discrete::step(m, method, t, &q, &v, &(u + du * s)).expect("it moves");
            of_q.dot(&m.difference(&end.0, &found.0)) + of_v.dot(&(found.1 - end.1))
        };
        let step = 0.02;
        let mut expected = 0.0;
        for (k, weight) in (1..).zip(&WEIGHTS) {
            expected +=
                weight * (weighted_step_end(f64::from(k) * step) + weighted_step_end(f64::from(-k) * step));
        }
        expected /= step * step;
        let form = dq.dot(&(qq * dq)) + dv.dot(&(vv * dv)) + du.dot(&(uu * du));
        let found = form + 2.0 * (dq.dot(&(qv * dv)) + dq.dot(&(qu * du)) + dv.dot(&(vu * du)));
        let size = qq.norm() * dq.norm_squared() + vv.norm() * dv.norm_squared() + 1.0;
        assert!((found - expected).abs() < 1e-9 * size, "{name}, {case}: {found} instead of {expected}");
    }
}

#[test]
fn rotating_body_step_second_derivatives_agree_with_differences() {
    let mut random = Random::new(3);
    let m = FlyingBodyWithLoad {};
    let q = m.integrate(&m.neutral(), &random.random_vector(1.2));
    // Fast rotations, so that displacements rotate considerably within a step.
    let v = random.random_vector(4.0);
    check_second_derivative_quadratic_forms("carrier, Euler", &m, &SemiImplicitEuler::step(0.1), (&q, &v));
    check_second_derivative_quadratic_forms("carrier, Rk4", &m, &Rk4::step(0.1), (&q, &v));
    check_second_derivative_quadratic_forms(
        "carrier from rest",
        &m,
        &Rk4::step(0.1),
        (&q, &SVector::zeros()),
    );
    let q = Solo.integrate(&Solo.neutral(), &random.random_vector(0.8));
    check_second_derivative_quadratic_forms(
        "quadruped, Euler",
        &Solo,
        &SemiImplicitEuler::step(0.02),
        (&q, &random.random_vector(2.0)),
    );
}

#[test]
fn constrained_rotating_body_step_second_derivatives_agree() {
    let m = TiedFlyingBody {};
    let start = m.integrate(&m.neutral(), &(SVector::from_element(0.2)));
    let q = m.assemble(&start, &[]).expect("it can be assembled");
    let v = m.project_velocity(&q, &SVector::from_fn(|k, _| 0.4 + 0.1 * k as f64)).expect("it moves");
    check_second_derivative_quadratic_forms("tied bodies", &m, &Rk4::step(0.02), (&q, &v));
    // The state violates the constraints, so that the projection has a larger effect.
    let torn = m.integrate(&q, &SVector::from_element(0.03));
    check_second_derivative_quadratic_forms("torn bodies", &m, &Rk4::step(0.02), (&torn, &v.add_scalar(0.2)));

    let m = Marble {};
    let q = m.integrate(&m.neutral(), &SVector::from([0.1, 0.0, 0.3, 0.2, -0.3, 0.4]));
    let v = m.project_velocity(&q, &SVector::from([0.3, 0.1, 0.0, 1.0, 2.0, 0.5])).expect("it rolls");
    check_second_derivative_quadratic_forms("marble", &m, &Rk4::step(0.02), (&q, &v));
}
