//! Checks of second derivatives of inverse dynamics against those of Pinocchio.

use linkwork::prelude::*;
use support::compare::assert_close_relative_to_largest;
use support::table::Record;

#[mechanism(urdf = "../models/urdf/ur5.urdf", second_derivatives)]
struct Ur5;

#[mechanism(urdf = "../models/urdf/gen3.urdf", second_derivatives)]
struct Gen3;

#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, second_derivatives)]
struct Solo;

/// Tolerance relative to the largest entry of a reference value.
const REFERENCE: f64 = 1e-9;

macro_rules! robot {
    ($robot:ident, $file:literal) => {
        let table = Record::load(concat!("robots/second_order/", $file, ".json"));
        for (i, case) in table.records_with_key("cases").iter().enumerate() {
            let (q, v, a, lambda) = (
                &case.vector_with_key("q"),
                &case.vector_with_key("v"),
                &case.vector_with_key("a"),
                &case.vector_with_key("lambda"),
            );
            let (qq, qv, vv, qa) = $robot.inverse_dynamics_second_derivatives(q, v, a, lambda);
            for (key, found) in [("qq", qq), ("qv", qv), ("vv", vv), ("qa", qa)] {
                let expected: SMatrix<f64, { $robot::NV }, { $robot::NV }> = case.matrix_with_key(key);
                let what = format!("{}, case {i}: {key}", $file);
                assert_close_relative_to_largest(&what, found.as_slice(), expected.as_slice(), REFERENCE);
            }
        }
    };
}

#[test]
fn robot_second_derivatives_agree_with_pinocchio() {
    robot!(Ur5, "ur5");
    robot!(Gen3, "gen3");
    robot!(Solo, "solo12");
}
