//! Tests that constraints whose components restrict no motion are rejected.

use super::{check_error_counts, check_error_rows};

/// Test mechanism: two carts that move independently in parallel planes.
const CARTS: &str = "h: f64, #[body(mass = 1)] first: Body, #[body(mass = 3)] second: Body,
    #[joint(ground -> first, along = (x, y))] one: Stage, #[joint(ground.at(h * z) -> second, along = (x, y))] two: Stage,";

#[test]
fn constraints_without_effect_are_rejected() {
    let carts_with_constraint = |constraint: &str| (String::new(), format!("{CARTS} {constraint}"));
    check_error_rows(
        carts_with_constraint,
        &[
            (
                "#[constraint(dot(v(first / ground / ground), z) * z)] none: Nonholonomic",
                "this does not constrain any velocity",
                "a constraint on coordinates is a `Holonomic` one",
            ),
            (
                "#[constraint(dot(r(first / ground), z) * z)] none: Holonomic",
                "this does not constrain any coordinate",
                "a holonomic constraint sets an expression of",
            ),
            // Nonzero, and no motion makes it zero.
            (
                "#[constraint(r(first / ground) = r(second / ground))] same: Holonomic",
                "this does not constrain any coordinate",
                "a holonomic constraint sets an expression of",
            ),
        ],
    );
}

#[test]
fn partially_effective_constraints_are_accepted() {
    let carts_with_constraint = |constraint: &str| format!("{CARTS} {constraint}");
    for constraint in [
        "#[constraint(v(first / ground / ground) = v(second / ground / ground))] same: Nonholonomic",
        "#[constraint(r(first / ground) = r(second / ground) - h * z)] same: Holonomic",
    ] {
        check_error_counts(&[("", &carts_with_constraint(constraint), 0)]);
    }
}

/// A product that is zero in every configuration but not simplified to zero. Its row contains only rounding
/// errors.
#[test]
fn constraint_rows_of_rounding_error_are_dropped() {
    let fields = "#[body(mass = 2, com = x, inertia = rod(2, 1, x))] arm: Body,
        #[joint(ground -> arm, about = z)] collar: Collar,
        #[body(mass = 0.9, com = 0.3 * x, inertia = cuboid(0.9, 0.1, 0.2, 0.3))] hand: Body,
        #[joint(arm -> hand, about = y)] wrist: Collar,
        #[constraint(dot(wrist.turn * ground.y, cross(r(hand.at(0.3 * x) / arm.at([0.7, -1.2, 0.4])), ground.y)))] none: Holonomic,";
    check_error_counts(&[("", fields, 0), ("formulation = speeds", fields, 0)]);
}
