use crate::testing::{assert_matrix_close, assert_number_close, elliptic_integral, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::CylinderInTrough;

const C: CylinderInTrough = CylinderInTrough { g: 9.81, mass: 1.7, radius: 0.1, width: 0.25, trough: 0.6 };

#[test]
fn cylinder_in_trough_matches_closed_form() {
    let (phi, rate) = (0.8_f64, 2.1);
    let (q, v) = (SVector::from([phi]), SVector::from([rate]));
    assert_matrix_close(C.mass_matrix(&q), SMatrix::<f64, 1, 1>::new(1.5 * 1.7 * 0.25), 1e-15);
    assert_matrix_close(C.bias_forces(&q, &v), SVector::from([1.7 * 9.81 * 0.5 * phi.sin()]), 1e-14);
}

#[test]
fn cylinder_in_trough_has_pendulum_period() -> Result<(), Error> {
    let start = 1.2_f64;
    let end = simulate(&C)
        .from([start], [0.0])
        .method(precise_integrator())
        .until_crossing(Crossing::Falling, |_, _, v| v[0])
        .finish()?;
    let length = 1.5 * (C.trough - C.radius);
    assert_number_close(
        end.t,
        4.0 * (length / C.g).sqrt() * elliptic_integral((start / 2.0).sin().powi(2)),
        1e-9,
    );
    Ok(())
}
