use crate::testing::assert_matrix_close;
use linkwork::prelude::*;
use linkwork_models::CartPole;

#[test]
fn cart_pole_mass_matrix_and_bias_match_formulas() {
    let p = CartPole { cart_mass: 1.3, pole_mass: 0.4, pole_length: 0.9, rail_damping: 0.2 };
    let (q, v) = (SVector::from([0.5, 0.8]), SVector::from([-1.2, 2.3]));
    let half = 0.4 * 0.9 / 2.0;
    let (s, c) = 0.8_f64.sin_cos();
    let mass = SMatrix::<f64, 2, 2>::new(1.7, -half * c, -half * c, 0.4 * 0.9 * 0.9 / 3.0);
    assert_matrix_close(p.mass_matrix(&q), mass, 1e-14);
    let bias = [half * s * 2.3 * 2.3 - 0.2 * 1.2, -half * 9.81 * s];
    assert_matrix_close(p.bias_forces(&q, &v), SVector::from(bias), 1e-14);
    let push = p.generalized_forces(&q, &SVector::from([3.0]));
    assert_matrix_close(push, SVector::from([3.0, 0.0]), 0.0);
}
