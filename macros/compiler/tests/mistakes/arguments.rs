//! Tests of error messages for arguments in the terminology of other tools.

use super::{ARM, CART, ErrorRow, check_error_rows};

/// Wrong arguments of bodies, with the expected messages.
const BODIES: &[ErrorRow] = &[
    ("m = 1", "a Body has no argument `m`", "did you mean `mass`?"),
    ("weight = 1", "a Body has no argument `weight`", "did you mean `mass`?"),
    ("mass = 1, cog = x", "a Body has no argument `cog`", "did you mean `com`?"),
    ("mass = 1, center_of_mass = x", "a Body has no argument `center_of_mass`", "did you mean `com`?"),
    ("mass = 1, centre = x", "a Body has no argument `centre`", "did you mean `com`?"),
    ("mass = 1, I = sphere(1, 1)", "a Body has no argument `I`", "did you mean `inertia`?"),
    (
        "mass = 1, moment_of_inertia = 1",
        "a Body has no argument `moment_of_inertia`",
        "did you mean `inertia`?",
    ),
    ("mass = 1, Izz = 1", "a Body has no argument `Izz`", "`inertia = diagonal(xx, yy, zz)`"),
    ("mass = 1, ixx = 1, iyy = 1", "a Body has no argument `ixx`", "`inertia = diagonal(xx, yy, zz)`"),
    ("mass = 1, length = 1", "a Body has no argument `length`", "`inertia = rod(m, l, y)`"),
    ("mass = 1, radius = 1", "a Body has no argument `radius`", "`inertia = sphere(m, r)`"),
    ("density = 1000", "a Body has no argument `density`", "`mass = density * volume`"),
    ("mass = 1, position = x", "a Body has no argument `position`", "joint"),
    ("mass = 1, parent = ground", "a Body has no argument `parent`", "joint"),
    (
        "mass = 1, geometry = cuboid(1, 1, 1, 1)",
        "a Body has no argument `geometry`",
        "did you mean `inertia`?",
    ),
    ("1", "expected `name = value`", "expected `mass`, `com`, `inertia`, `about`, `at` or `frame`"),
];

#[test]
fn invalid_body_arguments_are_reported() {
    check_error_rows(
        |said| {
            let tool = format!("#[body({said})] tool: Body, #[joint(arm -> tool, about = z)] wrist: Pin");
            (String::new(), format!("{ARM} {tool}"))
        },
        BODIES,
    );
}

/// Wrong arguments of elements that act on a hinge, with the expected messages.
const ACTIONS: &[ErrorRow] = &[
    ("#[acts(on = hinge, k = 1)] coil: Spring", "a Spring has no argument `k`", "did you mean `stiffness`?"),
    (
        "#[acts(on = hinge, stiffnes = 1)] coil: Spring",
        "a Spring has no argument `stiffnes`",
        "did you mean `stiffness`?",
    ),
    (
        "#[acts(on = hinge, spring_constant = 1)] coil: Spring",
        "a Spring has no argument `spring_constant`",
        "did you mean `stiffness`?",
    ),
    (
        "#[acts(on = hinge, stiffness = 1, rest_angle = 1)] coil: Spring",
        "a Spring has no argument `rest_angle`",
        "did you mean `free_angle`?",
    ),
    (
        "#[acts(on = hinge, stiffness = 1, theta0 = 1)] coil: Spring",
        "a Spring has no argument `theta0`",
        "did you mean `free_angle`?",
    ),
    (
        "#[acts(between = (ground, arm.at(x)), stiffness = 1, length = 1)] coil: Spring",
        "a Spring has no argument `length`",
        "did you mean `free_length`?",
    ),
    (
        "#[acts(between = (ground, arm.at(x)), stiffness = 1, l0 = 1)] coil: Spring",
        "a Spring has no argument `l0`",
        "did you mean `free_length`?",
    ),
    (
        "#[acts(on = hinge, stiffness = 1, damping = 1)] coil: Spring",
        "a Spring has no argument `damping`",
        "a spring has no damping",
    ),
    ("#[acts(on = hinge, c = 1)] brake: Dashpot", "a Dashpot has no argument `c`", "did you mean `damping`?"),
    ("#[acts(on = hinge, b = 1)] brake: Dashpot", "a Dashpot has no argument `b`", "did you mean `damping`?"),
    (
        "#[acts(on = hinge, coefficient = 1)] brake: Dashpot",
        "a Dashpot has no argument `coefficient`",
        "did you mean `damping`?",
    ),
    (
        "#[acts(on = hinge, stiffness = 1)] brake: Dashpot",
        "a Dashpot has no argument `stiffness`",
        "a dashpot has no stiffness",
    ),
    (
        "#[acts(on = hinge, mass = 1)] wheel: Inerter",
        "an Inerter has no argument `mass`",
        "did you mean `inertance`?",
    ),
    (
        "#[acts(on = hinge, mu = 1)] rub: Friction",
        "a Friction has no argument `mu`",
        "did you mean `coulomb`? it is a force or a torque",
    ),
    (
        "#[acts(on = hinge, coulomb = 1, damping = 1)] rub: Friction",
        "a Friction has no argument `damping`",
        "did you mean `viscous`?",
    ),
    ("#[acts(joint = hinge)] motor: Torque", "a Torque has no argument `joint`", "did you mean `on`?"),
    ("#[acts(body = arm, about = x)] motor: Torque", "a Torque has no argument `body`", "did you mean `on`?"),
    ("#[acts(on = arm, axis = x)] motor: Torque", "a Torque has no argument `axis`", "did you mean `about`?"),
    (
        "#[acts(on = arm, along = x)] motor: Torque",
        "a Torque has no argument `along`",
        "did you mean `about`?",
    ),
    ("#[acts(on = arm, about = x)] push: Force", "a Force has no argument `about`", "did you mean `along`?"),
    (
        "#[acts(on = arm, direction = x)] push: Force",
        "a Force has no argument `direction`",
        "did you mean `along`?",
    ),
    (
        "#[acts(on = arm, magnitude = 3 * x)] push: Force",
        "a Force has no argument `magnitude`",
        "did you mean `value`?",
    ),
    (
        "#[acts(on = arm, at = x, along = y)] push: Force",
        "a Force has no argument `at`",
        "`on = body.at(length * x)`",
    ),
    ("#[acts(on = arm, along = x, max = 3)] push: Force", "a Force has no argument `max`", "limits"),
    (
        "#[acts(between = (ground, arm), g = 1)] pull: Gravity",
        "a Gravity has no argument `g`",
        "did you mean `constant`?",
    ),
    (
        "#[acts(on = (ground, arm), stiffness = 1)] coil: Spring",
        "`on` names one thing, found a list",
        "write `between = (ground, arm)`",
    ),
    (
        "#[acts(on = (ground, arm.at(x)), damping = 1)] brake: Dashpot",
        "`on` names one thing, found a list",
        "write `between = (ground, arm.at(x))`",
    ),
    (
        "#[acts(between = hinge, stiffness = 1)] coil: Spring",
        "`between` names two points",
        "write `on = hinge`",
    ),
    (
        "#[acts(between = [ground, arm], stiffness = 1)] coil: Spring",
        "`between` names two points",
        "write `between = (ground, arm)`",
    ),
    (
        "#[acts(from = ground, to = arm, stiffness = 1)] coil: Spring",
        "a Spring has no such ends",
        "write `between = (ground, arm)`",
    ),
    (
        "#[acts(a = ground, b = arm, damping = 1)] brake: Dashpot",
        "a Dashpot has no such ends",
        "write `between = (ground, arm)`",
    ),
    ("#[acts(hinge, stiffness = 1)] coil: Spring", "expected `name = value`", "write `on = hinge`"),
    ("#[acts(hinge)] motor: Torque", "expected `name = value`", "write `on = hinge`"),
    (
        "#[acts(ground, arm, stiffness = 1)] coil: Spring",
        "expected `name = value`",
        "write `between = (ground, arm)`",
    ),
    (
        "#[acts(ground -> arm, stiffness = 1)] coil: Spring",
        "a Spring is not a joint",
        "write `between = (ground, arm)`",
    ),
    ("#[acts(on = hinge, 1)] coil: Spring", "expected `name = value`", "write `stiffness = 1`"),
    ("#[acts(on = hinge)] coil: Spring", "missing `stiffness`", "write `#[acts(…, stiffness = k)]`"),
    (
        "#[acts(on = arm, stiffness = 1)] coil: Spring",
        "a Spring acts on the coordinate of a joint, but this is a body",
        "`on = hinge`",
    ),
    (
        "#[acts(on = hinge)] push: Force",
        "this coordinate is an angle",
        "the element that acts on it is a Torque",
    ),
    (
        "#[acts(on = \"hinge\")] motor: Torque",
        "expected an expression for `on`, found a string",
        "write it without quotes",
    ),
    ("#[acts(on = hing)] motor: Torque", "unknown joint or body `hing`", "did you mean `hinge`?"),
    (
        "#[acts(on = hinge, about = z)] motor: Torque",
        "the joint determines the direction",
        "remove this argument",
    ),
    ("#[acts(on = arm)] motor: Torque", "missing `about`", "on a body it needs a direction"),
    (
        "#[acts(on = hinge, free_length = 1, stiffness = 1)] coil: Spring",
        "the coordinate of this spring is an angle",
        "write `free_angle = …`",
    ),
];

#[test]
fn invalid_force_element_arguments_are_reported() {
    check_error_rows(|said| (String::new(), format!("{ARM} {said}")), ACTIONS);
}

/// Wrong arguments of other elements, with the expected messages.
const OTHERS: &[ErrorRow] = &[
    (
        "theta: Coordinate, #[particle(m = 1, at = theta * x)] bead: Particle",
        "a Particle has no argument `m`",
        "did you mean `mass`?",
    ),
    (
        "theta: Coordinate, #[particle(mass = 1, position = theta * x)] bead: Particle",
        "a Particle has no argument `position`",
        "did you mean `at`?",
    ),
    (
        "theta: Coordinate, #[particle(mass = 1, on = cart, at = theta * x)] bead: Particle",
        "a Particle has no argument `on`",
        "`at = body.at(length * x)`",
    ),
    (
        "#[frame(ground, about = z, angle = t)] turned: Frame",
        "a Frame has no argument `about`",
        "write `#[frame(ground, z(angle))]`",
    ),
    ("#[frame(ground, z, t)] turned: Frame", "expected a rotation", "`z(angle)`"),
    (
        "#[frame(parent = ground, z(t))] turned: Frame",
        "a Frame has no argument `parent`",
        "write `#[frame(ground, z(angle))]`",
    ),
    ("#[frame(z(t))] turned: Frame", "expected a body or a frame", "write `#[frame(ground, z(angle))]`"),
    ("#[frame(ground, rot_z(t))] turned: Frame", "expected a rotation", "`z(angle)`"),
    ("#[point(cart, x)] tip: Point", "expected `name = value`", "write `#[point(on = cart, at = x)]`"),
    ("#[point(body = cart, at = x)] tip: Point", "a Point has no argument `body`", "did you mean `on`?"),
    ("#[point(on = cart, pos = x)] tip: Point", "a Point has no argument `pos`", "did you mean `at`?"),
    (
        "#[output(value = rail)] seen: Scalar",
        "a Scalar has no argument `value`",
        "write `#[output(expression)]`",
    ),
    (
        "#[output(r(cart / ground), frame = cart)] seen: Vector",
        "a Vector has no argument `frame`",
        "did you mean `resolved_in`?",
    ),
    (
        "#[output(rail, rate(rail))] seen: Scalar",
        "`#[output(…)]` takes one expression, found 2",
        "a field for each",
    ),
    ("#[define(2 * rail = 2)] seen: Scalar", "expected `name = value`", "write `#[output(expression)]`"),
    ("#[define(rail = 2)] seen: Scalar", "a Scalar has no argument `rail`", "write `#[output(expression)]`"),
    (
        "#[constraint(v(cart / ground / ground) = 0)] hold: Holonomic",
        "`v(…)` is not allowed here",
        "a constraint on velocities is a `Nonholonomic`",
    ),
    (
        "#[constraint(rate(rail) = 1)] hold: Holonomic",
        "the rate of `rail` is not allowed here",
        "a constraint on velocities is a `Nonholonomic`",
    ),
    (
        "#[constraint(rail = 1)] hold: Nonholonomic",
        "this does not constrain any velocity",
        "a constraint on coordinates is a `Holonomic` one",
    ),
    (
        "#[constraint(rail > 1)] hold: Holonomic",
        "expected `,` or an operator",
        "a constraint is an equation, `a = b`",
    ),
    ("#[constraint(rail, 1)] hold: Holonomic", "expected one equation", "write `rail = 1`"),
    (
        "#[constraint(cart.circle(1, y), ground.plane(z))] contact: Rolling",
        "expected a pair that rolls",
        "rolls(",
    ),
    (
        "#[constraint(rolls(cart, ground))] contact: Rolling",
        "expected a surface",
        "write `cart.circle(radius, y)`",
    ),
];

#[test]
fn invalid_arguments_of_other_elements_are_reported() {
    check_error_rows(|said| (String::new(), format!("{CART} {said}")), OTHERS);
}
