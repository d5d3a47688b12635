use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::nalgebra::{Matrix2, Vector2};
use linkwork::{frame, prelude::*};
use linkwork_models::FiveBar;

const R: FiveBar = FiveBar {
    g: 9.81,
    crank_mass: 0.4,
    forearm_mass: 0.3,
    tool_mass: 0.9,
    base: 0.25,
    crank: 0.3,
    forearm: 0.4,
};

fn unit_direction(angle: f64) -> Vector2<f64> {
    Vector2::new(angle.cos(), angle.sin())
}

/// Returns the positions of both elbows and the tool for these crank angles; the tool is at the upper
/// intersection of two circles about the elbows.
fn closed_form_positions(left: f64, right: f64) -> [Vector2<f64>; 3] {
    let first = R.crank * unit_direction(left);
    let second = Vector2::new(R.base, 0.0) + R.crank * unit_direction(right);
    let half = (second - first) / 2.0;
    let height = (R.forearm * R.forearm - half.norm_squared()).sqrt();
    [first, second, first + half + Vector2::new(-half.y, half.x).normalize() * height]
}

fn linkage_configuration(left: f64, right: f64) -> SVector<f64, 4> {
    let [first, second, tool] = closed_form_positions(left, right);
    let angle_to_tool = |from: Vector2<f64>| (tool.y - from.y).atan2(tool.x - from.x);
    [left, angle_to_tool(first) - left, right, angle_to_tool(second) - right].into()
}

/// Returns the Jacobian of the tool with respect to the crank angles.
fn tool_jacobian(left: f64, right: f64) -> Matrix2<f64> {
    let [first, second, tool] = closed_form_positions(left, right);
    let forearms = [tool - first, tool - second];
    let inverse = Matrix2::from_rows(&forearms.map(|f| f.transpose())).try_inverse();
    let arm_speed =
        |k: usize, angle: f64| R.crank * forearms[k].dot(&Vector2::new(-angle.sin(), angle.cos()));
    inverse.expect("the forearms are not in line")
        * Matrix2::from_diagonal(&Vector2::new(arm_speed(0, left), arm_speed(1, right)))
}

#[test]
fn five_bar_tool_is_at_circle_intersection() {
    assert_eq!((FiveBar::NC, FiveBar::NP, FiveBar::NU), (2, 2, 2));
    for (left, right) in [(2.0, 0.9), (2.4, 0.3), (1.6, 1.2)] {
        let q = linkage_configuration(left, right);
        let guess = [left, 0.7 - left, right, 2.2 - right].into();
        assert_matrix_close(R.assemble(&guess, &[0, 2]).expect("the circles meet"), q, 1e-12);
        let [.., tool] = closed_form_positions(left, right);
        let place = R.frame_placement(frame!(FiveBar, "tool"), &q).translation.vector;
        assert_matrix_close(place.xy(), tool, 1e-15);
    }
}

/// Checks that torques from virtual work hold the linkage at rest, and that additional torque accelerates it
/// by its reduced inertia in the two crank angles.
#[test]
fn five_bar_torques_match_virtual_work_and_reduced_inertia() {
    let (left, right) = (2.0, 0.9);
    let q = linkage_configuration(left, right);
    let tool = tool_jacobian(left, right);
    let zero = SVector::zeros();
    let [first, second, at] = closed_form_positions(left, right);
    // Velocities of elbows and tool per crank rate.
    let velocity_of_elbow = |angle: f64| R.crank * Vector2::new(-angle.sin(), angle.cos());
    let elbows = [
        Matrix2::from_columns(&[velocity_of_elbow(left), Vector2::zeros()]),
        Matrix2::from_columns(&[Vector2::zeros(), velocity_of_elbow(right)]),
    ];
    let mut inertia = tool.transpose() * tool * R.tool_mass;
    let mut weight = tool.row(1) * R.tool_mass;
    for (k, from) in [first, second].into_iter().enumerate() {
        let middle = (elbows[k] + tool) / 2.0;
        // A rod is equivalent to two thirds of its mass in the middle and a sixth at each end.
        for (part, j) in [(1.0 / 6.0, elbows[k]), (4.0 / 6.0, middle), (1.0 / 6.0, tool)] {
            inertia += j.transpose() * j * (R.forearm_mass * part);
        }
        inertia += elbows[k].transpose() * elbows[k] * (R.crank_mass / 3.0);
        weight += middle.row(1) * R.forearm_mass + elbows[k].row(1) * (R.crank_mass / 2.0);
        assert_number_close((at - from).norm(), R.forearm, 1e-15);
    }
    let hold = weight.transpose() * R.g;
    let more = Vector2::new(0.7, -0.4);
    for (u, expected) in
        [(hold, Vector2::zeros()), (hold + more, inertia.lu().solve(&more).expect("regular"))]
    {
        let a = R.forward_dynamics(&q, &zero, &R.generalized_forces(&q, &u));
        assert_matrix_close(Vector2::new(a[0], a[2]), expected, 1e-12);
    }
}
