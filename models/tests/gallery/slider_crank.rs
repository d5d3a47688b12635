use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::SliderCrank;

const S: SliderCrank = SliderCrank { g: 9.81, r: 0.04, l: 0.13, m_crank: 0.9, m_rod: 0.5, m_piston: 0.35 };

/// Function of the crank angle, as its value with the first and second derivative.
type ValueWithCrankDerivatives = [f64; 3];

/// Returns the closed forms of the rod's angle, x and y of its centre, and the position of the piston, as
/// functions of the crank angle.
fn closed_form_positions(theta: f64) -> [ValueWithCrankDerivatives; 4] {
    let SliderCrank { r, l, .. } = S;
    let (s, c) = theta.sin_cos();
    let phi = (-r / l * s).asin();
    let (sp, cp) = phi.sin_cos();
    let first = -r / l * c / cp;
    let second = (r / l * s + sp * first * first) / cp;
    // x of a point at `r` along the crank and at `k` along the rod.
    let course =
        |k: f64| [r * c + k * cp, -r * s - k * sp * first, -r * c - k * (cp * first * first + sp * second)];
    [[phi, first, second], course(l / 2.0), [r / 2.0 * s, r / 2.0 * c, -r / 2.0 * s], course(l)]
}

fn crank_state(theta: f64, rate: f64) -> (SVector<f64, 3>, SVector<f64, 3>) {
    let [rod, .., piston] = closed_form_positions(theta);
    let q = [theta, rod[0] - theta, piston[0]];
    (q.into(), [rate, (rod[1] - 1.0) * rate, piston[1] * rate].into())
}

#[test]
fn piston_position_matches_closed_form() {
    assert_eq!((SliderCrank::NC, SliderCrank::NP, SliderCrank::NU), (2, 1, 1));
    for k in 0..12 {
        let theta = 0.1 + f64::from(k) * std::f64::consts::PI / 6.0;
        let (q, v) = crank_state(theta, 300.0);
        let s = theta.sin();
        assert_number_close(q[2], S.r * theta.cos() + (S.l * S.l - S.r * S.r * s * s).sqrt(), 1e-15);
        let found = S.assemble(&[theta, -theta, 0.1].into(), &[0]).expect("the crank goes round");
        assert_matrix_close(found, q, 1e-13);
        let found = S.project_velocity(&q, &[300.0, -300.0, 0.0].into()).expect("no dead centre");
        assert_matrix_close(found / found[0], v / 300.0, 1e-13);
    }
}

/// Checks that the acceleration follows from Eksergian's equation, and that the power of the motor is the
/// rate of the energy.
#[test]
fn slider_crank_follows_eksergians_equation() {
    let SliderCrank { g, r, l, m_crank, m_rod, m_piston } = S;
    let (theta, rate, torque) = (0.8, 120.0, 7.0);
    let courses = closed_form_positions(theta);
    let [rod, x, y, piston] = courses;
    let masses = [m_rod * l * l / 12.0, m_rod, m_rod, m_piston];
    let sum_over_masses = |f: fn(&ValueWithCrankDerivatives) -> f64| {
        masses.iter().zip(&courses).map(|(m, c)| m * f(c)).sum::<f64>()
    };
    let inertia = m_crank * r * r / 3.0 + sum_over_masses(|c| c[1] * c[1]);
    let lift = g * (m_crank * r / 2.0 * theta.cos() + m_rod * y[1]);
    let expected = (torque - sum_over_masses(|c| c[1] * c[2]) * rate * rate - lift) / inertia;

    let (q, v) = crank_state(theta, rate);
    assert_number_close(S.kinetic_energy(&q, &v), inertia * rate * rate / 2.0, 1e-13);
    let a = S.forward_dynamics(&q, &v, &S.generalized_forces(&q, &[torque].into()));
    let crank_function_acceleration = |c: &ValueWithCrankDerivatives| c[1] * expected + c[2] * rate * rate;
    assert_matrix_close(
        a,
        [expected, crank_function_acceleration(&rod) - expected, crank_function_acceleration(&piston)].into(),
        1e-12,
    );
    assert_number_close(x[0], r * theta.cos() + l / 2.0 * rod[0].cos(), 1e-15);
}
