use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork_models::Rattleback;

const R: Rattleback = Rattleback::BENCHMARK;

/// Returns a state in contact with the table, with this orientation and angular velocity in body axes.
fn state_on_table(turn: UnitQuaternion<f64>, w: Vector3<f64>) -> (SVector<f64, 7>, SVector<f64, 6>) {
    let n = turn.inverse() * Vector3::z();
    let squares = Vector3::new(R.a * R.a, R.b * R.b, R.c * R.c);
    let size = squares.dot(&n.component_mul(&n)).sqrt();
    let contact = -squares.component_mul(&n) / size;
    let v = -w.cross(&contact);
    ([0.0, 0.0, size, turn.i, turn.j, turn.k, turn.w].into(), [v.x, v.y, v.z, w.x, w.y, w.z].into())
}

#[test]
fn rattleback_contact_point_is_at_rest() {
    assert_eq!((Rattleback::NC, Rattleback::NH, Rattleback::NS), (3, 1, 3));
    let turn = UnitQuaternion::from_euler_angles(0.3, -0.2, 1.1);
    let (q, v) = state_on_table(turn, Vector3::new(0.4, -1.0, 3.0));
    assert!(R.constraint_residuals(&q).amax() < 1e-16);
    assert!(R.constraint_rates(&q, &v).amax() < 1e-15);
    let projected = R.project_velocity(&q, &v).expect("regular");
    assert_matrix_close(projected, v, 1e-14);
}

/// Checks that a rattleback that is spun backwards with a tilt of half a degree reverses its spin, and that
/// one spun forwards keeps its direction.
#[test]
fn rattleback_reverses_its_spin() -> Result<(), Error> {
    let tilt = 0.5_f64.to_radians();
    for (spin, turns_back) in [(-5.0, true), (5.0, false)] {
        let turn = UnitQuaternion::from_euler_angles(tilt, tilt, 0.0);
        let (q, v) = state_on_table(turn, Vector3::new(0.0, 0.0, spin));
        let total_energy = |q: &_, v: &_| R.kinetic_energy(q, v) + R.potential_energy(q);
        let end = simulate(&R).from(q, v).method(precise_integrator()).duration(6.0).finish()?;
        assert_eq!(end.v[5] / spin < -0.5, turns_back, "{} to {}", spin, end.v[5]);
        assert_eq!(end.v[5] / spin > 0.5, !turns_back, "{} to {}", spin, end.v[5]);
        assert_number_close(total_energy(&end.q, &end.v), total_energy(&q, &v), 1e-10);
        assert!(R.constraint_residuals(&end.q).amax() < 1e-14);
        assert!(R.constraint_rates(&end.q, &end.v).amax() < 1e-13);
    }
    Ok(())
}
