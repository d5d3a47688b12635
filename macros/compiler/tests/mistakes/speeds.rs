//! Tests of error messages about invalid generalized speeds.

use super::{ErrorRow, check_error_rows};

fn cart_and_arm_mechanism_source(fields: &str) -> (String, String) {
    let own = "a: f64,
        #[body(mass = 1)] cart: Body, #[body(mass = 1, com = y, inertia = sphere(1, 1))] arm: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve, #[joint(cart -> arm, about = z)] hinge: Pin,
        #[acts(on = rail)] push: Force, #[acts(on = hinge, damping = a)] friction: Dashpot,";
    (String::new(), format!("{own} {fields}"))
}

#[test]
fn invalid_generalized_speeds_are_reported() {
    const ROWS: &[ErrorRow] = &[
        (
            "#[speed(rate(rail) * rate(hinge))] u: Speed,",
            "a speed is linear in the rates",
            "coordinates and parameters",
        ),
        ("#[speed(rail + a)] u: Speed,", "this speed contains no rate", "rate(psi) * sin(theta)"),
        ("#[speed(rate(rail) + 1)] u: Speed,", "a speed cannot have a term without rates", "zero at rest"),
        (
            "#[speed(rate(rail) * sin(t))] u: Speed,",
            "the coefficients of rates in a speed cannot depend on time",
            "`#[output(…)]`",
        ),
        (
            "#[speed(rate(rail) * push)] u: Speed,",
            "a speed cannot depend on the input `push`",
            "coordinates and parameters",
        ),
        (
            "#[speed(rate(rail) + rate(hinge))] u: Speed,",
            "one speed names 2 velocities: `rail` and `hinge`",
            "#[speed(rate(hinge))] hinge_rate: Speed",
        ),
        (
            "#[speed(rate(rail) + rate(hinge))] u: Speed, \
             #[speed(2 * rate(rail) + 2 * rate(hinge))] w: Speed,",
            "the speed `w` depends on the speeds before it",
            "independent combinations",
        ),
        (
            "#[speed(rate(rail))] u: Speed, #[speed(2 * rate(rail))] w: Speed,",
            "the speed `w` depends on the speeds before it",
            "independent combinations",
        ),
        ("#[speed(rate(rial))] u: Speed,", "`rate` takes a coordinate", "`rail`"),
        ("#[define(rate(rail))] u: Speed,", "a `Speed` has no `#[define]`", "#[speed(…)]"),
        ("#[speed] u: Speed,", "`u` has no expression", "#[speed(expression)]"),
        (
            "#[speed(rate(rail) * x)] u: Speed,",
            "a speed is a scalar, and this is a vector",
            "declare a speed for each",
        ),
        (
            "#[speed(rate(rail))] u: Speed, #[limit(on = rail, to = 1, max_speed = 2)] stop: Limit,",
            "speeds replace the rate of `rail`, which has a `max_speed`",
            "or choose speeds that keep this rate",
        ),
        (
            "#[speed(rate(rail))] u: Speed, #[limit(on = rail, max_effort = 2)] stop: Limit,",
            "speeds replace the rate of `rail`, which has a `max_effort`",
            "it bounds the force on the rate of `rail`",
        ),
        ("#[speed(rate(rail))] u: GeneralizedSpeed,", "unknown element type `GeneralizedSpeed`", "Speed"),
    ];
    check_error_rows(cart_and_arm_mechanism_source, ROWS);
}
