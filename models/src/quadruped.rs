use linkwork::mechanism;

/// Solo 12 of the Open Dynamic Robot Initiative: a quadruped with a floating base and three joints a leg.
///
/// Source: `robot_properties_solo` (BSD-3-Clause) by way of `example-robot-data` 5.0.0; see the head of
/// `urdf/solo12.urdf`. Grimminger et al., *An open torque-controlled modular robot architecture for legged locomotion
/// research*, IEEE RA-L 5 (2020).
///
/// - Configuration: position and quaternion of the base, then the legs FL, FR, HL, HR (front, hind; left, right), each
///   with HAA (hip abduction, about x), HFE (hip flexion, about y) and KFE (knee flexion, about y), rad.
///   Inputs: a torque on each joint of the legs, N·m.
/// - Closed forms: in free fall, at rest, everything accelerates with g and no joint moves; a leg is two segments of
///   160 mm, so its foot is at `−0.16 (sin α + sin(α + β))` ahead of and `−0.16 (cos α + cos(α + β))` above its hip at
///   HFE = α and KFE = β.
#[mechanism(urdf = "urdf/solo12.urdf", base = free, derivatives, packed)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Solo12;

/// ANYmal B of ANYbotics: a quadruped with a floating base and three joints a leg, whose legs differ: hind and front,
/// left and right are mirror images of each other.
///
/// Source: `anymal_b_simple_description` (BSD-3-Clause) by way of `example-robot-data` 5.0.0; see the head of
/// `urdf/anymal_b.urdf`. Hutter et al., *ANYmal – a highly mobile and dynamic quadrupedal robot*, IROS 2016. (The file
/// gives `base` hardly any mass, and an inertia matrix that no body can have; `inertia = trust` takes it as it is.)
///
/// - Configuration: position and quaternion of the base, then the legs LF, LH, RF, RH (left, right; front, hind), each
///   with HAA (hip abduction, about x), HFE (hip flexion, about y) and KFE (knee flexion, about y), rad.
///   Inputs: a torque on each joint of the legs, N·m.
/// - Closed form: in free fall, at rest, everything accelerates with g and no joint moves.
#[mechanism(urdf = "urdf/anymal_b.urdf", base = free, inertia = trust, derivatives, packed)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnymalB;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near};
    use linkwork::prelude::*;

    #[test]
    fn free_fall() {
        let robot = Solo12;
        let mut q = robot.neutral();
        for k in 7..19 {
            q[k] = 0.3 * (k as f64).sin();
        }
        let mut expected = SVector::<f64, 18>::zeros();
        expected[2] = -9.81;
        let a = robot.forward_dynamics(&q, &SVector::zeros(), &SVector::zeros());
        assert_near(a, expected, 1e-11);
        let links: f64 = 2.0 * 0.14853845 + 0.03070001 + 0.00693606;
        assert_close(robot.total_mass(), 1.16115091 + 4.0 * links, 1e-14);
    }

    #[test]
    fn free_fall_with_different_legs() {
        let robot = AnymalB;
        let mut q = robot.neutral();
        for k in 7..19 {
            q[k] = 0.3 * (k as f64).sin();
        }
        let mut expected = SVector::<f64, 18>::zeros();
        expected[2] = -9.81;
        let a = robot.forward_dynamics(&q, &SVector::zeros(), &SVector::zeros());
        assert_near(a, expected, 1e-11);
        let leg = 1.42462064 + 1.634976467 + 0.207204302 + 0.140170767 + 0.001;
        assert_close(robot.total_mass(), 16.793507758 + 1e-6 + 0.05 + 4.0 * leg, 1e-14);
    }

    #[test]
    fn foot_of_a_leg() {
        let robot = Solo12;
        let mut q = robot.neutral();
        let (alpha, beta) = (0.6_f64, -1.3_f64);
        (q[8], q[9]) = (alpha, beta);
        let foot = robot.frame_placement(frame!(Solo12, "FL_FOOT"), &q).translation.vector;
        let x = 0.1946 - 0.16 * (alpha.sin() + (alpha + beta).sin());
        let z = -0.16 * (alpha.cos() + (alpha + beta).cos());
        let y = 0.0875 + 0.014 + 0.03745 + 0.008;
        assert_near(foot, SVector::from([x, y, z]), 1e-15);
    }
}
