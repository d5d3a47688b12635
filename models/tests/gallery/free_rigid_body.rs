use crate::testing::{assert_matrix_close, assert_number_close, elliptic_integral, precise_integrator};
use linkwork::nalgebra::Vector3;
use linkwork::prelude::*;
use linkwork_models::FreeRigidBody;

const B: FreeRigidBody = FreeRigidBody { mass: 0.4, ixx: 1.0, iyy: 2.0, izz: 2.5 };

#[test]
fn free_body_satisfies_newton_and_euler() {
    let (v, w) = (Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.3, 2.0, -1.1));
    let inertia = SMatrix::<f64, 3, 3>::from_diagonal(&Vector3::new(1.0, 2.0, 2.5));
    let found = B.bias_forces(&B.neutral(), &[v.x, v.y, v.z, w.x, w.y, w.z].into());
    assert_matrix_close(found.fixed_rows::<3>(0).into_owned(), 0.4 * w.cross(&v), 1e-15);
    assert_matrix_close(found.fixed_rows::<3>(3).into_owned(), w.cross(&(inertia * w)), 1e-14);
}

/// Checks the flip of a rigid body that spins about its intermediate axis with a slight wobble. After half a
/// period it is upside down, and after a whole period it returns.
#[test]
fn intermediate_axis_rotation_flips() -> Result<(), Error> {
    // No spin about x at the start, so that L² > 2 E I₂.
    let start = Vector3::new(0.0, 5.0, 0.01);
    let inertia = Vector3::new(B.ixx, B.iyy, B.izz);
    let twice = start.component_mul(&start).dot(&inertia);
    let momentum2 = start.component_mul(&inertia).norm_squared();
    let (excess, rest) = (momentum2 - twice * B.ixx, twice * B.izz - momentum2);
    let k2 = (B.iyy - B.ixx) * rest / ((B.izz - B.iyy) * excess);
    let scale = (B.ixx * B.iyy * B.izz / ((B.izz - B.iyy) * excess)).sqrt();
    let period = 4.0 * elliptic_integral(k2) * scale;
    let run = simulate(&B)
        .from(B.neutral(), [0.0, 0.0, 0.0, start.x, start.y, start.z])
        .method(precise_integrator())
        .duration(period);
    let angular = B.momentum(&B.neutral(), &[0.0, 0.0, 0.0, start.x, start.y, start.z].into());
    for (k, sample) in run.sample_every(period / 2.0).enumerate() {
        let Sample { q, v, .. } = sample?;
        let sign = if k == 1 { -1.0 } else { 1.0 };
        assert_matrix_close(v.fixed_rows::<3>(3).into_owned(), Vector3::new(0.0, sign * 5.0, 0.01), 1e-7);
        assert_matrix_close(B.momentum(&q, &v), angular, 1e-9);
        assert_number_close(B.kinetic_energy(&q, &v), twice / 2.0, 1e-10);
    }
    Ok(())
}
