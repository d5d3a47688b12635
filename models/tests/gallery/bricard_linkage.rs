use crate::testing::{assert_number_close, precise_integrator};
use linkwork::{frame, prelude::*};
use linkwork_models::BricardLinkage;

const B: BricardLinkage = BricardLinkage { g: 9.81, mass: 1.0, length: 1.0 };

/// Checks that the rods of the linkage initially lie along edges of a cube of one metre, as in the benchmark.
#[test]
fn bricard_rods_start_along_cube_edges() {
    let q = B.neutral();
    let placed = [
        (B.frame_placement(frame!(BricardLinkage, "rod1"), &q), [0.0, 0.0, 0.0]),
        (B.frame_placement(frame!(BricardLinkage, "rod2"), &q), [1.0, 0.0, 0.0]),
        (B.frame_placement(frame!(BricardLinkage, "rod3"), &q), [1.0, -1.0, 0.0]),
        (B.frame_placement(frame!(BricardLinkage, "rod4"), &q), [1.0, -1.0, 1.0]),
        (B.frame_placement(frame!(BricardLinkage, "rod5"), &q), [0.0, -1.0, 1.0]),
    ];
    for (rod, corner) in placed {
        assert_eq!(rod.translation.vector, SVector::from(corner));
    }
}

#[test]
fn bricard_has_one_dependent_constraint() {
    assert_eq!((BricardLinkage::NV, BricardLinkage::NP, BricardLinkage::NS), (5, 1, 1));
    let q = B.neutral();
    assert!(B.constraint_residuals(&q).amax() < 1e-15);
    let rows = B.constraint_jacobian(&q);
    let rank = (rows.transpose() * rows).symmetric_eigenvalues().iter().filter(|e| **e > 1e-9).count();
    assert_eq!(rank, 4);
}

/// Checks that the linkage, released from the cube, conserves its energy for ten seconds and passes
/// configurations with all rods in one plane.
#[test]
fn bricard_linkage_conserves_energy() -> Result<(), Error> {
    let start = B.potential_energy(&B.neutral());
    let run = simulate(&B).method(precise_integrator()).duration(10.0).sample_every(0.25);
    let mut farthest = 0.0_f64;
    for sample in run {
        let Sample { q, v, .. } = sample?;
        assert_number_close(B.kinetic_energy(&q, &v) + B.potential_energy(&q), start, 1e-10);
        let (odd, even) = (q[0].sin(), q[1].sin());
        assert_number_close(odd + even + odd * even, 0.0, 1e-12);
        assert!((q[2] - q[0]).abs().max((q[4] - q[0]).abs()).max((q[3] - q[1]).abs()) < 1e-11, "{q}");
        farthest = farthest.max(q[0]);
    }
    assert!(farthest > 3.0, "{farthest}");
    Ok(())
}
