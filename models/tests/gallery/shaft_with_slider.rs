use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::ShaftWithSlider;

const S: ShaftWithSlider = ShaftWithSlider { inertia: 0.4, mass: 0.7 };

#[test]
fn shaft_with_slider_has_textbook_equations() {
    let (q, v) = (SVector::from([1.1, 0.6]), SVector::from([2.0, -0.5]));
    let mass = SMatrix::<f64, 2, 2>::new(0.4 + 0.7 * 0.36, 0.0, 0.0, 0.7);
    assert_matrix_close(S.mass_matrix(&q), mass, 1e-15);
    let bias = [2.0 * 0.7 * 0.6 * -0.5 * 2.0, -0.7 * 0.6 * 4.0];
    assert_matrix_close(S.bias_forces(&q, &v), SVector::from(bias), 1e-15);
}

#[test]
fn shaft_with_slider_conserves_momentum() -> Result<(), Error> {
    let start = (0.4 + 0.7 * 0.01) * 10.0;
    let run = simulate(&S).from([0.0, 0.1], [10.0, 0.0]).method(ImplicitMidpoint::step(0.001));
    for sample in run.duration(2.0).sample_every(0.1) {
        let Sample { q, v, .. } = sample?;
        assert_number_close(S.generalized_momentum(&q, &v)[0], start, 1e-12);
    }
    Ok(())
}

#[test]
fn slider_moves_outwards_as_cosh() -> Result<(), Error> {
    let omega = 3.0;
    let end = simulate(&S)
        .from([0.0, 0.1], [omega, 0.0])
        .inputs(|_, q, v| SVector::from([2.0 * S.mass * q[1] * v[1] * v[0]]))
        .method(DormandPrince::new().tolerance(1e-12, 1e-12))
        .duration(1.0)
        .finish()?;
    assert_number_close(end.q[1], 0.1 * omega.cosh(), 1e-9);
    assert_number_close(end.q[0], omega, 1e-9);
    Ok(())
}
