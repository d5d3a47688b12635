use crate::testing::assert_matrix_close;
use linkwork::prelude::*;
use linkwork_models::SphericalPendulum;

const P: SphericalPendulum = SphericalPendulum { g: 9.81, mass: 0.6, length: 1.2 };

#[test]
fn spherical_pendulum_has_closed_form_equations() {
    let (a, b, da, db) = (0.7_f64, -1.1_f64, 1.3, 0.8);
    let (q, v) = (SVector::from([a, b]), SVector::from([da, db]));
    let ml2 = P.mass * P.length * P.length;
    let mgl = P.mass * P.g * P.length;
    let mass = SMatrix::<f64, 2, 2>::new(ml2 * b.cos() * b.cos(), 0.0, 0.0, ml2);
    assert_matrix_close(P.mass_matrix(&q), mass, 1e-14);
    let h1 = -2.0 * ml2 * b.sin() * b.cos() * da * db + mgl * a.sin() * b.cos();
    let h2 = ml2 * b.sin() * b.cos() * da * da + mgl * a.cos() * b.sin();
    assert_matrix_close(P.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-14);
}

#[test]
fn spherical_pendulum_moves_on_a_cone() -> Result<(), Error> {
    // Start in the (y, z) plane at the inclination α, a = α, b = 0, moving along −x: ḃ = ω sin α.
    let alpha = 0.9_f64;
    let period = 2.0 * std::f64::consts::PI * (P.length * alpha.cos() / P.g).sqrt();
    let speed = 2.0 * std::f64::consts::PI / period * alpha.sin();
    let method = DormandPrince::new().tolerance(1e-12, 1e-12);
    let run = simulate(&P).from([alpha, 0.0], [0.0, speed]).method(method);
    for (k, sample) in run.duration(period).sample_every(period / 8.0).enumerate() {
        let q = sample?.q;
        let turned = std::f64::consts::PI / 4.0 * k as f64;
        let at = [-q[1].sin(), q[0].sin() * q[1].cos(), -q[0].cos() * q[1].cos()];
        let circle = [-alpha.sin() * turned.sin(), alpha.sin() * turned.cos(), -alpha.cos()];
        assert_matrix_close(SVector::from(at), SVector::from(circle), 1e-9);
    }
    Ok(())
}
