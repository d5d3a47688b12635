use linkwork::mechanism;

/// A simple humanoid: a floating base, two legs with six joints each, a waist with three, two arms with seven each.
///
/// Source: `simple_humanoid_description` of LAAS-CNRS (BSD-2-Clause) by way of `example-robot-data` 5.0.0; see the head
/// of `urdf/simple_humanoid.urdf`.
///
/// - Configuration: position and quaternion of the base, then the angles of the joints, rad, depth first, the joints of
///   one link in alphabetical order of their names. Inputs: a torque on each joint, N·m.
/// - Closed form: in free fall, at rest, everything accelerates with g and no joint moves.
#[mechanism(urdf = "urdf/simple_humanoid.urdf", base = free, derivatives, packed)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SimpleHumanoid;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near};
    use linkwork::prelude::*;

    #[test]
    fn free_fall() {
        let robot = SimpleHumanoid;
        let mut q = robot.neutral();
        for k in 7..SimpleHumanoid::NQ {
            q[k] = 0.3 * (k as f64).sin();
        }
        let mut expected = SVector::zeros();
        expected[2] = -9.81;
        let a = robot.forward_dynamics(&q, &SVector::zeros(), &SVector::zeros());
        assert_near(a, expected, 1e-10);
        let trunk = 27.0 + 6.0 + 30.0 + 13.0;
        let arm = 3.0 + 0.6 + 1.0 + 0.6 + 0.4 + 0.4 + 0.4;
        let leg = 2.5 + 2.0 + 5.1 + 7.0 + 2.5 + 1.9;
        assert_close(robot.total_mass(), trunk + 2.0 * (arm + leg), 1e-14);
    }
}
