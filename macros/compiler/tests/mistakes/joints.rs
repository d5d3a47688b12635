//! Tests of error messages about the endpoints and axes of joints.

use super::{ErrorRow, check_error_rows};

const ROWS: &[ErrorRow] = &[
    (
        "#[joint(parent = ground, child = arm, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `ground -> arm`",
    ),
    (
        "#[joint(child = arm, parent = ground, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `ground -> arm`",
    ),
    (
        "#[joint(from = ground, to = arm, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `ground -> arm`",
    ),
    (
        "#[joint(base = ground, follower = arm, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `ground -> arm`",
    ),
    (
        "#[joint(frame_a = ground, frame_b = arm, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `ground -> arm`",
    ),
    (
        "#[joint(between = (ground, arm), about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `ground -> arm`",
    ),
    (
        "#[joint(ground, arm, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `ground -> arm`",
    ),
    (
        "#[joint(on = arm, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `parent -> arm`",
    ),
    (
        "#[joint(arm, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `parent -> arm`",
    ),
    (
        "#[joint(about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `#[joint(parent -> child, …)]`",
    ),
    (
        "#[joint(\"ground\" -> \"arm\", about = z)] hinge: Pin",
        "expected an expression, found a string",
        "write it without quotes",
    ),
    ("#[joint(ground --> arm, about = z)] hinge: Pin", "expected `->`", "write `ground -> arm`"),
    ("#[joint(ground ->> arm, about = z)] hinge: Pin", "expected `->`", "write `ground -> arm`"),
    ("#[joint(ground <-> arm, about = z)] hinge: Pin", "expected `->`", "write `ground -> arm`"),
    ("#[joint(ground => arm, about = z)] hinge: Pin", "expected `->`", "write `ground -> arm`"),
    ("#[joint(ground > arm, about = z)] hinge: Pin", "expected `->`", "write `ground -> arm`"),
    (
        "#[joint(ground - arm, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `ground -> arm`",
    ),
    ("#[joint(ground to arm, about = z)] hinge: Pin", "expected `->`", "write `ground -> arm`"),
    ("#[joint(ground : arm, about = z)] hinge: Pin", "expected `->`", "write `ground -> arm`"),
    (
        "#[joint(ground = arm, about = z)] hinge: Pin",
        "a joint needs the two bodies that it connects",
        "write `ground -> arm`",
    ),
    ("#[joint(world -> arm, about = z)] hinge: Pin", "unknown body `world`", "did you mean `ground`?"),
    ("#[joint(base -> arm, about = z)] hinge: Pin", "unknown body `base`", "did you mean `ground`?"),
    ("#[joint(Ground -> arm, about = z)] hinge: Pin", "unknown body `Ground`", "did you mean `ground`?"),
    (
        "#[joint(arm -> ground, about = z)] hinge: Pin",
        "the ground cannot be the child of a joint",
        "reverse the joint",
    ),
    ("#[joint(ground -> arm.com, about = z)] hinge: Pin", "expected a body", "`arm.at(vector)`"),
    ("#[joint(ground.x -> arm, about = z)] hinge: Pin", "expected a body", "`ground.at(vector)`"),
    ("#[joint(ground + x -> arm, about = z)] hinge: Pin", "expected a body", "`ground.at(vector)`"),
    (
        "#[joint(ground.pos(x) -> arm, about = z)] hinge: Pin",
        "unknown method `.pos(…)` of a body",
        "did you mean `at`?",
    ),
    (
        "#[joint(ground.translate(x) -> arm, about = z)] hinge: Pin",
        "unknown method `.translate(…)` of a body",
        "did you mean `at`?",
    ),
    (
        "#[joint(ground.rotate(z(1)) -> arm, about = z)] hinge: Pin",
        "unknown method `.rotate(…)` of a body",
        "did you mean `rotated`?",
    ),
    (
        "#[joint(ground.at(0, 0, 1) -> arm, about = z)] hinge: Pin",
        "expected one vector in `.at(…)`",
        "[0, 0, 1]",
    ),
    (
        "#[joint(ground.at((0, 0, 1)) -> arm, about = z)] hinge: Pin",
        "expected a scalar or a vector, found a list",
        "write `[0, 0, 1]`",
    ),
    ("#[joint(ground.rotated(z, 1) -> arm, about = z)] hinge: Pin", "expected a rotation", "`z(angle)`"),
    ("#[joint(ground.rotated(0, 0, 1) -> arm, about = z)] hinge: Pin", "expected a rotation", "`z(angle)`"),
    (
        "#[joint(ground.rotated(rpy(0, 0, 1)) -> arm, about = z)] hinge: Pin",
        "expected a rotation",
        "`z(yaw), y(pitch), x(roll)`",
    ),
    ("#[joint(ground -> arm, axis = z)] hinge: Pin", "a Pin has no argument `axis`", "did you mean `about`?"),
    (
        "#[joint(ground -> arm, axis = x)] rail: Sleeve",
        "a Sleeve has no argument `axis`",
        "did you mean `along`?",
    ),
    (
        "#[joint(ground -> arm, direction = x)] rail: Sleeve",
        "a Sleeve has no argument `direction`",
        "did you mean `along`?",
    ),
    ("#[joint(ground -> arm, along = z)] hinge: Pin", "a Pin has no argument `along`", "expected `about`"),
    ("#[joint(ground -> arm)] hinge: Pin", "missing `about`: a Pin has one axis", "write `about = z`"),
    ("#[joint(ground -> arm, z)] hinge: Pin", "expected `name = value`", "write `about = z`"),
    (
        "#[joint(ground -> arm, about = (0, 0, 1))] hinge: Pin",
        "expected a direction, found three numbers",
        "write `about = z`",
    ),
    (
        "#[joint(ground -> arm, about = (0, 0, -1))] hinge: Pin",
        "expected a direction, found three numbers",
        "write `about = -z`",
    ),
    (
        "#[joint(ground -> arm, along = (0.6, 0.8, 0))] rail: Sleeve",
        "expected a direction, found three numbers",
        "write `along = [0.6, 0.8, 0]`",
    ),
    (
        "#[joint(ground -> arm, about = 1)] hinge: Pin",
        "expected a direction, found a number",
        "`x`, `y` or `z`",
    ),
    (
        "#[joint(ground -> arm, about = \"z\")] hinge: Pin",
        "expected an expression for `about`, found a string",
        "write it without quotes",
    ),
    ("#[joint(ground -> arm, about = Z)] hinge: Pin", "unknown name `Z`", "did you mean `z`?"),
    (
        "#[joint(ground -> arm, about = +z)] hinge: Pin",
        "expected an expression: a number, a name, a call or a vector",
        "remove the `+`",
    ),
    ("#[joint(ground -> arm, about = ez)] hinge: Pin", "unknown name `ez`", "did you mean `z`?"),
    ("#[joint(ground -> arm, about = z_hat)] hinge: Pin", "unknown name `z_hat`", "did you mean `z`?"),
    ("#[joint(ground -> arm, about = k)] hinge: Pin", "unknown name `k`", "the axes are `x`, `y` and `z`"),
    (
        "#[joint(ground -> arm, about = ground.z)] hinge: Pin",
        "this vector is given in the axes of `ground`",
        "axes `x`, `y` and `z`",
    ),
    ("#[joint(ground -> arm, about = xy)] hinge: Universal", "unknown name `xy`", "write `(x, y)`"),
    (
        "#[joint(ground -> arm, about = x)] hinge: Universal",
        "a Universal has two axes in `about`, found 1",
        "write `about = (x, y)`",
    ),
    (
        "#[joint(ground -> arm, about = z, origin = x)] hinge: Pin",
        "a Pin has no argument `origin`",
        "`parent.at(length * x) -> child`",
    ),
    (
        "#[joint(ground -> arm, about = z, pos = x)] hinge: Pin",
        "a Pin has no argument `pos`",
        "`parent.at(length * x) -> child`",
    ),
    (
        "#[joint(ground -> arm, about = z, rpy = [0, 0, 1])] hinge: Pin",
        "a Pin has no argument `rpy`",
        "`parent.rotated(z(angle)) -> child`",
    ),
    (
        "#[joint(ground -> arm, about = z, damping = 1)] hinge: Pin",
        "a Pin has no argument `damping`",
        "`#[acts(on = hinge, damping = c)] damper: Dashpot`",
    ),
    (
        "#[joint(ground -> arm, about = z, stiffness = 1)] hinge: Pin",
        "a Pin has no argument `stiffness`",
        "`#[acts(on = hinge, stiffness = k)] spring: Spring`",
    ),
    (
        "#[joint(ground -> arm, about = z, friction = 1)] hinge: Pin",
        "a Pin has no argument `friction`",
        "`#[acts(on = hinge, coulomb = f)] friction: Friction`",
    ),
    (
        "#[joint(ground -> arm, about = z, limit = 1)] hinge: Pin",
        "a Pin has no argument `limit`",
        "`#[limit(on = hinge, from = a, to = b)] range: Limit`",
    ),
    (
        "#[joint(ground -> arm, about = z, torque = 1)] hinge: Pin",
        "a Pin has no argument `torque`",
        "`#[acts(on = hinge)] motor: Torque`",
    ),
    (
        "#[joint(ground -> arm, about = z, angle = 1)] hinge: Pin",
        "a Pin has no argument `angle`",
        "`parent.rotated(z(angle)) -> child`",
    ),
    (
        "#[joint(ground -> arm, about = z, coordinate = theta)] hinge: Pin",
        "a Pin has no argument `coordinate`",
        "the joint's name is its coordinate",
    ),
];

#[test]
fn invalid_joint_arguments_are_reported() {
    check_error_rows(
        |said| {
            (
                String::new(),
                format!("#[body(mass = 1, com = -y, inertia = sphere(1, 0.1))] arm: Body, {said}"),
            )
        },
        ROWS,
    );
}
