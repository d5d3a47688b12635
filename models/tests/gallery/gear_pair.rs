use crate::testing::assert_matrix_close;
use linkwork::prelude::*;
use linkwork_models::GearPair;

const G: GearPair =
    GearPair { small_inertia: 2e-4, large_inertia: 3e-3, small_radius: 0.02, large_radius: 0.05 };

#[test]
fn gear_pair_has_reduced_inertia_and_tooth_force() {
    assert_eq!((GearPair::NC, GearPair::NP), (1, 1));
    let ratio: f64 = 0.4;
    let torque = 0.3;
    let expected = torque / (2e-4 + ratio * ratio * 3e-3);
    let (q, v) = (SVector::from([0.5, -0.2]), SVector::from([10.0, -4.0]));
    assert!(G.constraint_residuals(&q).amax() < 1e-17);
    let (a, force) = G.constrained_dynamics(&q, &v, &G.generalized_forces(&q, &[torque].into()));
    assert_matrix_close(a, [expected, -ratio * expected].into(), 1e-13);
    // The teeth push the pinion backwards.
    assert_matrix_close(force, [-ratio / 0.05 * 3e-3 * expected].into(), 1e-13);
}

/// Checks that assembly moves the wheels to the nearest angles at which the teeth mesh.
#[test]
fn assembly_moves_gears_into_mesh() {
    let q = G.assemble(&[1.0, 0.3].into(), &[0]).expect("the wheel can follow");
    assert_matrix_close(q, [1.0, -0.4].into(), 1e-15);
}
