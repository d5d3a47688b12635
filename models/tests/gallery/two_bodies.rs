use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::TwoBodies;
use std::f64::consts::TAU;

const P: TwoBodies = TwoBodies { constant: 0.5, m1: 3.0, m2: 1.0 };

fn relative_position(x: &SVector<f64, 6>) -> SVector<f64, 3> {
    x.fixed_rows::<3>(3) - x.fixed_rows::<3>(0)
}

#[test]
fn two_bodies_obey_newtons_law() {
    let q = SVector::from([0.1, -0.4, 0.3, 1.2, 0.7, -0.5]);
    let r = relative_position(&q);
    let pull = 0.5 * 3.0 / r.norm().powi(3) * r;
    let h = P.bias_forces(&q, &SVector::zeros());
    assert_matrix_close(h.fixed_rows::<3>(0).into_owned(), -pull, 1e-14);
    assert_matrix_close(h.fixed_rows::<3>(3).into_owned(), pull, 1e-14);
    assert_number_close(P.potential_energy(&q), -1.5 / r.norm(), 1e-14);
}

/// Checks that two gravitating bodies that start at the pericentre move relative to each other on an ellipse
/// with a = 1 and e = 0.6, while their centre of mass drifts.
#[test]
fn two_bodies_move_on_ellipses() -> Result<(), Error> {
    let (mu, a, e) = (2.0_f64, 1.0, 0.6);
    let period = TAU * (a * a * a / mu).sqrt();
    let near = a * (1.0 - e);
    let speed = (mu * (2.0 / near - 1.0 / a)).sqrt();
    let drift = 0.1;
    let q = SVector::from([-near / 4.0, 0.0, 0.0, 0.75 * near, 0.0, 0.0]);
    let v = SVector::from([0.0, -speed / 4.0, drift, 0.0, 0.75 * speed, drift]);
    let run = simulate(&P).from(q, v).method(precise_integrator()).duration(period);
    for (k, sample) in run.sample_every(period / 4.0).enumerate() {
        let Sample { t, q, v, .. } = sample?;
        let (r, dr) = (relative_position(&q), relative_position(&v));
        let laplace = dr.cross(&r.cross(&dr)) / mu - r.normalize();
        assert_matrix_close(laplace, SVector::from([e, 0.0, 0.0]), 1e-9);
        assert_number_close(P.center_of_mass(&q)[2], drift * t, 1e-10);
        // Half of the period to the apocentre, a whole period back to the pericentre.
        match k {
            2 => assert_matrix_close(r, SVector::from([-a * (1.0 + e), 0.0, 0.0]), 1e-8),
            4 => assert_matrix_close(r, SVector::from([near, 0.0, 0.0]), 1e-8),
            _ => {}
        }
    }
    Ok(())
}
