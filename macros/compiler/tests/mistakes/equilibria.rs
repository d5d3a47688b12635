//! Declared equilibria that are invalid or have no linear equations.

use super::{ErrorRow, check_error_rows, compiler_messages};

/// Returns the source of a pendulum with a motor and one declared equilibrium, for tests of error messages.
fn pendulum_mechanism_source(said: &str) -> (String, String) {
    let fields = "m: f64, l: f64,
        #[body(mass = m, com = -l * y, inertia = sphere(m, l))] arm: Body,
        #[joint(ground -> arm, about = z)] hinge: Pin,
        #[acts(on = hinge)] motor: Torque,";
    ("gravity = -9.81 * y".to_string(), format!("{fields} #[equilibrium({said})] rest: Equilibrium"))
}

const ROWS: &[ErrorRow] = &[
    (
        "hinge = pi / 2",
        "`rest` is not an equilibrium: the residual force `-9.81 m l` acts on `hinge`",
        "hold an input at a value that balances it",
    ),
    (
        "motor = 2",
        "`rest` is not an equilibrium: the residual force `2` acts on `hinge`",
        "choose coordinates",
    ),
    (
        "hinge = pi / 2, motor = 9.81 * m * l / 2",
        "`rest` is not an equilibrium: the residual force `-4.905 m l` acts on `hinge`",
        "hold an input",
    ),
    ("hinges = 0", "`hinges` cannot have a value at rest", "did you mean `hinge`?"),
    ("l = 2", "`l` cannot have a value at rest", "values here can be expressions of parameters"),
    ("arm = 2", "`arm` cannot have a value at rest", "expected `hinge` or `motor`"),
    ("hinge = 180", "an angle of 180 rad is more than a full turn", "degrees(180)"),
    ("hinge = motor", "the input `motor` is not allowed here", "only numbers and parameters"),
    ("hinge = 0, hinge = 1", "`hinge` is given twice", "remove one of the two"),
    ("hinge = x", "expected a scalar, found a vector", "length"),
    ("pi", "expected `name = value`", "#[equilibrium(joint = angle)]"),
    ("hinge = l", "`l` is a plain number here, but a length (m) elsewhere", "a factor is missing"),
];

#[test]
fn invalid_equilibria_are_reported() {
    check_error_rows(pendulum_mechanism_source, ROWS);
}

/// Returns the source of a cart on a rail with further fields, for tests of error messages.
fn carriage_mechanism_source(said: &str) -> (String, String) {
    let fields = "m: f64, k: f64,
        #[body(mass = m, inertia = sphere(m, 1))] cart: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve,";
    (String::new(), format!("{fields} {said}"))
}

const REFUSED: &[ErrorRow] = &[
    (
        "#[acts(on = rail, coulomb = k)] f: Friction, #[equilibrium] rest: Equilibrium",
        "dry friction cannot be linearised about `rest`",
        "or declare the equilibrium in a mechanism",
    ),
    (
        "#[acts(on = rail, value = -k * abs(rail))] f: Force, #[equilibrium] rest: Equilibrium",
        "a force has no derivative in `rest`: `abs` has a corner there",
        "round the corner off",
    ),
    (
        "#[acts(on = rail, value = -k * max(rail, 0))] f: Force, #[equilibrium] rest: Equilibrium",
        "a force has no derivative in `rest`: `max` has a corner there",
        "away from it",
    ),
    (
        "#[acts(on = rail, value = k * sin(t))] f: Force, #[equilibrium] rest: Equilibrium",
        "`rest` is not an equilibrium: the residual force `k sin(t)` acts on `rail`",
        "hold an input",
    ),
    (
        "#[acts(on = rail, value = -k * rail * (2 + sin(t)))] f: Force, #[equilibrium] rest: Equilibrium",
        "`rest` does not stay at rest: its prescribed motion depends on time",
        "forces that stay the same",
    ),
    (
        "#[state(rate = (3 - level) * k)] level: State, #[equilibrium] rest: Equilibrium",
        "the state `level` changes in `rest`: its rate is `3 k`",
        "the value at which its rate is zero",
    ),
    (
        "#[particle(mass = m)] p: Particle, #[joint(cart -> p, along = y)] mast: Sleeve, \
         #[constraint(rail + mast = 2 * k)] held: Holonomic, #[equilibrium] rest: Equilibrium",
        "`rest` does not satisfy the constraint `held`: the residual is `-2 k`",
        "values that fulfil it",
    ),
];

#[test]
fn mechanisms_without_linear_equations_are_reported() {
    check_error_rows(carriage_mechanism_source, REFUSED);
}

#[test]
fn equilibrium_quaternions_must_have_unit_norm() {
    let fields_with_equilibrium = |q: &str| {
        format!(
            "#[body(mass = 1, inertia = sphere(1, 1))] ball: Body, #[joint(ground -> ball)] tip: Ball,
            #[equilibrium({q})] rest: Equilibrium"
        )
    };
    let found = compiler_messages("", &fields_with_equilibrium("tip.qx = 1"));
    assert!(found.len() == 1 && found[0].contains("the quaternion of `tip.qx` in `rest`"), "{found:?}");
    assert_eq!(compiler_messages("", &fields_with_equilibrium("tip.qx = 1, tip.qw = 0")), [""; 0]);
    let found = compiler_messages("", &fields_with_equilibrium("tip = 1"));
    assert!(found.len() == 1 && found[0].contains("write `tip.qx = …`"), "{found:?}");
}

#[test]
fn kinematic_mechanisms_have_no_linear_equations() {
    let fields = "#[body] arm: Body, #[joint(ground -> arm, about = z)] hinge: Pin,
        #[equilibrium] rest: Equilibrium";
    let found = compiler_messages("inertia = none", fields);
    assert!(found.len() == 1 && found[0].starts_with("linear equations of motion need inertia"), "{found:?}");
}

/// Without inertia, all printed equations of motion are rejected.
#[test]
fn kinematic_mechanisms_have_no_equations_of_motion() {
    let fields = "#[body] arm: Body, #[joint(ground -> arm, about = z)] hinge: Pin";
    let found = compiler_messages("inertia = none, equations = hamilton", fields);
    assert!(
        found.len() == 1 && found[0].starts_with("without inertia there are no equations of motion"),
        "{found:?}"
    );
}
