use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork_models::HeavyTop;

const TOP: HeavyTop<f64> = HeavyTop { g: 9.81, mass: 0.3, height: 0.05, axial: 2.4e-4, transverse: 1.8e-4 };

fn transverse_inertia_at_pivot() -> f64 {
    TOP.transverse + TOP.mass * TOP.height * TOP.height
}

#[test]
fn heavy_top_satisfies_eulers_equations() {
    let turn = UnitQuaternion::from_euler_angles(0.4, -0.9, 1.7);
    let omega = Vector3::new(3.0, -2.0, 40.0);
    let inertia = SMatrix::<f64, 3, 3>::from_diagonal(&Vector3::new(
        transverse_inertia_at_pivot(),
        transverse_inertia_at_pivot(),
        TOP.axial,
    ));
    let weight = turn.inverse() * Vector3::new(0.0, 0.0, -TOP.mass * TOP.g);
    let torque = Vector3::new(0.0, 0.0, TOP.height).cross(&weight);
    let q = SVector::from([turn.i, turn.j, turn.k, turn.w]);
    assert_matrix_close(TOP.mass_matrix(&q), inertia, 1e-16);
    assert_matrix_close(TOP.bias_forces(&q, &omega), omega.cross(&(inertia * omega)) - torque, 1e-14);
}

/// Checks that slow and fast steady precession exist for the same spin: the inclination of the axis is
/// constant, and it precesses at the predicted rate.
#[test]
fn heavy_top_precesses_steadily_at_two_rates() -> Result<(), Error> {
    let (theta, spin) = (0.5_f64, 150.0);
    let (a, b, c) =
        (transverse_inertia_at_pivot() * theta.cos(), TOP.axial * spin, TOP.mass * TOP.g * TOP.height);
    let root = (b * b - 4.0 * a * c).sqrt();
    for rate in [2.0 * c / (b + root), (b + root) / (2.0 * a)] {
        let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), theta);
        let mut omega = tilt.inverse() * Vector3::new(0.0, 0.0, rate);
        omega.z = spin;
        let end = simulate(&TOP)
            .from([tilt.i, tilt.j, tilt.k, tilt.w], omega)
            .method(DormandPrince::new().tolerance(1e-11, 1e-11))
            .duration(1.0 / rate)
            .finish()?;
        let axis = UnitQuaternion::from_quaternion(end.q.into()) * Vector3::z();
        // The axis starts towards −y and precesses by one radian.
        assert_number_close(axis.z, theta.cos(), 1e-8);
        assert_number_close(axis.x, theta.sin() * 1.0_f64.sin(), 1e-8);
        assert_number_close(axis.y, -theta.sin() * 1.0_f64.cos(), 1e-8);
    }
    Ok(())
}

/// Checks that near the upright position the top is stable with sufficient spin, and falls with less.
#[test]
fn heavy_top_is_stable_if_fast() -> Result<(), Error> {
    let critical = (4.0 * transverse_inertia_at_pivot() * TOP.mass * TOP.g * TOP.height).sqrt() / TOP.axial;
    for (part, sleeps) in [(1.05, true), (0.95, false)] {
        let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1e-4);
        let run = simulate(&TOP)
            .from([tilt.i, tilt.j, tilt.k, tilt.w], [0.0, 0.0, part * critical])
            .duration(5.0)
            .sample_every(0.01);
        let mut farthest = 0.0_f64;
        for sample in run {
            let axis = UnitQuaternion::from_quaternion(sample?.q.into()) * Vector3::z();
            farthest = farthest.max(axis.x.hypot(axis.y));
        }
        assert_eq!(farthest < 1e-3, sleeps, "{farthest} at {part} of the critical spin");
    }
    Ok(())
}
