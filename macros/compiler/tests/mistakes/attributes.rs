//! Tests of error messages for attributes in the terminology of other tools.

use super::{ARM, ErrorRow, check_error_rows};

const ROWS: &[ErrorRow] = &[
    (
        "#[spring(on = hinge, stiffness = 1)] coil: Spring",
        "unknown attribute `#[spring]` on an element",
        "expected `#[acts(…)]`",
    ),
    (
        "#[damper(on = hinge, damping = 1)] brake: Dashpot",
        "unknown attribute `#[damper]` on an element",
        "expected `#[acts(…)]`",
    ),
    (
        "#[torque(on = hinge)] motor: Torque",
        "unknown attribute `#[torque]` on an element",
        "expected `#[acts(…)]`",
    ),
    ("#[act(on = hinge)] motor: Torque", "unknown attribute `#[act]` on an element", "did you mean `acts`?"),
    ("#[on(hinge)] motor: Torque", "unknown attribute `#[on]` on an element", "expected `#[acts(…)]`"),
    (
        "#[revolute(arm -> tool, about = z)] wrist: Pin",
        "unknown attribute `#[revolute]` on an element",
        "expected `#[joint(…)]`",
    ),
    (
        "#[pin(ground -> tool, about = z)] wrist: Pin",
        "unknown attribute `#[pin]` on an element",
        "expected `#[joint(…)]`",
    ),
    ("#[link(mass = 1)] tool: Body", "unknown attribute `#[link]` on an element", "expected `#[body(…)]`"),
    (
        "#[inertial(mass = 1)] tool: Body",
        "unknown attribute `#[inertial]` on an element",
        "expected `#[body(…)]`",
    ),
    ("#[mass(1)] tool: Particle", "unknown attribute `#[mass]` on an element", "expected `#[particle(…)]`"),
    (
        "#[holonomic(hinge = 0)] stop: Holonomic",
        "unknown attribute `#[holonomic]` on an element",
        "expected `#[constraint(…)]`",
    ),
    (
        "#[rolls(arm.circle(1, y), ground.plane(z))] contact: Rolling",
        "unknown attribute `#[rolls]` on an element",
        "expected `#[constraint(…)]`",
    ),
    (
        "#[potential(hinge)] well: Potential",
        "unknown attribute `#[potential]` on an element",
        "expected `#[energy(…)]`",
    ),
    (
        "#[vector(x)] up: Vector",
        "unknown attribute `#[vector]` on an element",
        "expected `#[define(…)]` or `#[output(…)]`",
    ),
    (
        "#[observe(hinge)] seen: Scalar",
        "unknown attribute `#[observe]` on an element",
        "expected `#[define(…)]` or `#[output(…)]`",
    ),
    ("#[input] push: Input", "unknown attribute `#[input]` on an element", "an `Input` has no attribute"),
    (
        "#[coordinate(0)] theta: Coordinate",
        "unknown attribute `#[coordinate]` on an element",
        "a `Coordinate` has no attribute",
    ),
    ("#[body(mass = 1)] wrist: Pin", "a `Pin` has no `#[body]`", "expected `#[joint(…)]`"),
    ("#[joint(ground -> arm)] tool: Body", "a `Body` has no `#[joint]`", "expected `#[body(…)]`"),
    (
        "#[unit(\"kg\")] k: f64, #[acts(on = hinge, stiffness = k)] coil: Spring",
        "expected a unit, found a string",
        "write it without quotes: `#[unit(kg)]`",
    ),
    (
        "#[unit = \"kg\"] k: f64, #[acts(on = hinge, stiffness = k)] coil: Spring",
        "missing unit",
        "write `#[unit(kg)]`",
    ),
    (
        "#[unit(N / m^2)] k: f64, #[acts(on = hinge, stiffness = k)] coil: Spring",
        "expected `*` or `/`",
        "write `m2` for a power of a unit",
    ),
    (
        "#[unit(deg)] k: f64, #[acts(on = hinge, stiffness = k)] coil: Spring",
        "unknown unit `deg`",
        "write `rad`",
    ),
    ("#[unit(Nm)] k: f64, #[acts(on = hinge, stiffness = k)] coil: Spring", "unknown unit `Nm`", "`N * m`"),
    (
        "#[unit(meter)] k: f64, #[acts(on = hinge, stiffness = k)] coil: Spring",
        "unknown unit `meter`",
        "write `m`",
    ),
    (
        "#[unit(kg, m)] k: f64, #[acts(on = hinge, stiffness = k)] coil: Spring",
        "expected `*` or `/`",
        "`#[unit(N * m / rad)]`",
    ),
];

#[test]
fn attributes_on_wrong_elements_are_rejected() {
    check_error_rows(|said| (String::new(), format!("{ARM} {said}")), ROWS);
}
