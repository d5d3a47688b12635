use crate::testing::assert_matrix_close;
use linkwork::nalgebra::{Isometry3, Matrix6, UnitQuaternion, Vector3, Vector6};
use linkwork::prelude::*;
use linkwork_models::StewartPlatform;

/// Angles of each leg's foot and head on their circles, degrees.
const LEGS: [(f64, f64); 6] =
    [(10.0, 50.0), (110.0, 70.0), (130.0, 170.0), (230.0, 190.0), (250.0, 290.0), (350.0, 310.0)];

const P: StewartPlatform = StewartPlatform {
    g: 9.81,
    base_radius: 0.8,
    platform_radius: 0.5,
    platform_mass: 30.0,
    across: 1.5,
    axial: 2.5,
    leg_mass: 2.0,
    leg: 0.6,
};

fn point_on_circle(radius: f64, degrees: f64) -> Vector3<f64> {
    let (s, c) = degrees.to_radians().sin_cos();
    Vector3::new(radius * c, radius * s, 0.0)
}

/// Returns a pose of the platform without symmetry.
fn asymmetric_platform_pose() -> Isometry3<f64> {
    Isometry3::from_parts(
        Vector3::new(0.1, -0.05, 0.9).into(),
        UnitQuaternion::from_euler_angles(0.15, -0.2, 0.3),
    )
}

/// Returns the vectors of all legs from foot to head for a pose of the platform.
fn legs_as_vectors(pose: &Isometry3<f64>) -> [Vector3<f64>; 6] {
    LEGS.map(|(foot, head)| {
        let head = pose * linkwork::nalgebra::Point3::from(point_on_circle(P.platform_radius, head));
        head.coords - point_on_circle(P.base_radius, foot)
    })
}

/// Returns the configuration by inverse kinematics: the direction of a leg is
/// `(sin b, −sin a cos b, cos a cos b)`.
fn platform_configuration(pose: &Isometry3<f64>) -> SVector<f64, { StewartPlatform::NQ }> {
    let mut q = P.neutral();
    q.fixed_rows_mut::<3>(0).copy_from(&pose.translation.vector);
    q.fixed_rows_mut::<4>(3).copy_from(&pose.rotation.coords);
    for (k, leg) in legs_as_vectors(pose).into_iter().enumerate() {
        let n = leg.normalize();
        let angles = [(-n.y).atan2(n.z), n.x.asin(), leg.norm()];
        q.fixed_rows_mut::<3>(7 + 3 * k).copy_from_slice(&angles);
    }
    q
}

#[test]
fn stewart_platform_legs_match_inverse_kinematics() {
    assert_eq!((StewartPlatform::NV, StewartPlatform::NC), (24, 18));
    assert_eq!((StewartPlatform::NP, StewartPlatform::NS, StewartPlatform::NU), (6, 6, 6));
    let q = platform_configuration(&asymmetric_platform_pose());
    assert!(P.constraint_residuals(&q).amax() < 1e-15);
    // Assembly from a level platform with the pose fixed.
    let mut guess = platform_configuration(&Isometry3::translation(0.0, 0.0, 0.9));
    guess.fixed_rows_mut::<7>(0).copy_from(&q.fixed_rows::<7>(0));
    assert_matrix_close(P.assemble(&guess, &[0, 1, 2, 3, 4, 5]).expect("the legs reach"), q, 1e-13);
    // Forward kinematics: assembly with the lengths fixed.
    let lengths = [8, 11, 14, 17, 20, 23];
    let guess = P.integrate(&q, &SVector::from_fn(|k, _| if lengths.contains(&k) { 0.0 } else { 0.02 }));
    assert_matrix_close(P.assemble(&guess, &lengths).expect("a pose is near"), q, 1e-12);
}

/// Checks leg forces by virtual work. Rows of the matrices are derivatives of the weights' heights, and of
/// the lengths, with respect to the platform's velocity in body axes.
#[test]
fn stewart_leg_forces_satisfy_virtual_work() {
    let pose = asymmetric_platform_pose();
    let (mut lengths, mut weight) = (Matrix6::zeros(), Vector6::zeros());
    weight[2] = P.platform_mass;
    for (k, (leg, (_, head))) in legs_as_vectors(&pose).into_iter().zip(LEGS).enumerate() {
        let arm = pose.rotation * point_on_circle(P.platform_radius, head);
        let (length, n) = (leg.norm(), leg.normalize());
        let wrench_of_force_at_head = |f: Vector3<f64>| {
            let torque = arm.cross(&f);
            Vector6::new(f.x, f.y, f.z, torque.x, torque.y, torque.z)
        };
        lengths.set_column(k, &wrench_of_force_at_head(n));
        // A point at a fixed distance along the leg rises with the head's motion across the leg. A point at a
        // fixed distance from the head rises with the head, minus that amount.
        let across = (Vector3::z() - n * n.z) * (P.leg / 2.0 / length);
        weight += wrench_of_force_at_head(across) * P.leg_mass
            + wrench_of_force_at_head(Vector3::z() - across) * P.leg_mass;
    }
    let forces = lengths.lu().solve(&(weight * P.g)).expect("not singular");
    let (q, still) = (platform_configuration(&pose), SVector::zeros());
    let a = P.forward_dynamics(&q, &still, &P.generalized_forces(&q, &forces));
    assert!(a.amax() < 1e-11, "{a}");
    // With slightly smaller forces the platform sinks.
    let a = P.forward_dynamics(&q, &still, &P.generalized_forces(&q, &(forces * 0.9)));
    let up = pose.rotation * Vector3::new(a[0], a[1], a[2]);
    assert!(up.z < -0.1, "{up}");
}

#[test]
fn stewart_platform_conserves_energy() -> Result<(), Error> {
    let q = platform_configuration(&asymmetric_platform_pose());
    let mut v = SVector::<f64, { StewartPlatform::NV }>::zeros();
    v.fixed_rows_mut::<6>(0).copy_from_slice(&[0.3, -0.2, 0.5, 0.4, 0.6, -0.5]);
    let v = P.project_velocity(&q, &v).expect("regular");
    let total_energy = |q: &_, v: &_| P.kinetic_energy(q, v) + P.potential_energy(q);
    let end = simulate(&P).from(q, v).method(Rk4::step(1e-3)).duration(0.2).finish()?;
    let change = total_energy(&end.q, &end.v) - total_energy(&q, &v);
    assert!(change.abs() < 1e-8 * P.kinetic_energy(&end.q, &end.v), "{change}");
    assert!(P.constraint_residuals(&end.q).amax() < 1e-14);
    Ok(())
}
