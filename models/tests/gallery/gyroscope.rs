use crate::testing::assert_matrix_close;
use linkwork::prelude::*;
use linkwork_models::Gyroscope;

const G: Gyroscope = Gyroscope { g: 9.81, mass: 0.5, offset: 0.08, axial: 0.002, transverse: 0.0013 };

#[test]
fn gyroscope_precesses_steadily() {
    let across = G.transverse + G.mass * G.offset * G.offset;
    let (theta, rate) = (0.6_f64, 2.5_f64);
    let total = (across * rate * rate * theta.cos() + G.mass * G.g * G.offset) / (G.axial * rate);
    let q = SVector::from([0.3, theta, 1.0]);
    let v = SVector::from([rate, 0.0, total - rate * theta.cos()]);
    assert_matrix_close(G.forward_dynamics(&q, &v, &SVector::zeros()), SVector::zeros(), 1e-11);
}

#[test]
fn gyroscope_has_textbook_mass_matrix() {
    let across = G.transverse + G.mass * G.offset * G.offset;
    let (s, c) = 0.7_f64.sin_cos();
    let m = G.mass_matrix(&SVector::from([0.4, 0.7, 2.0]));
    let spin = G.axial * c;
    let expected = SMatrix::<f64, 3, 3>::new(
        across * s * s + G.axial * c * c,
        0.0,
        spin, //
        0.0,
        across,
        0.0, //
        spin,
        0.0,
        G.axial,
    );
    assert_matrix_close(m, expected, 1e-16);
}

#[test]
fn gyroscope_velocity_follows_euler_angle_rates() {
    let (theta, [precession, nutation, spin]) = (0.7_f64, [1.3, -0.4, 20.0]);
    let found = G.rotor_rate(&[0.2, theta, 2.0].into(), &[precession, nutation, spin].into());
    let expected = [nutation, precession * theta.sin(), spin + precession * theta.cos()];
    assert_matrix_close(found, SVector::from(expected), 1e-14);
}
