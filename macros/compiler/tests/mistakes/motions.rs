//! Instant centres, curves, cables and vector fields: missing, unknown or nonexistent quantities.

use super::{ARM, ErrorRow, check_error_rows, compiler_messages};

/// Vector outputs of a mechanism with an arm on a hinge, a bead on a curve with parameter `s`, and a free
/// stone.
const VECTORS: &[ErrorRow] = &[
    ("instant_center(arm)", "`instant_center` takes a body and a frame", "`instant_center(body / frame)`"),
    ("instant_center(arm / ground / ground)", "`instant_center` takes a body and a frame", "(body / frame)"),
    ("instant_center(arms / ground)", "unknown frame `arms`", "did you mean `arm`?"),
    (
        "instant_center(stone / ground)",
        "this body can slide along its axis of rotation: it has no point at rest",
        "`screw_axis(body / frame)`",
    ),
    (
        "acceleration_center(stone / ground)",
        "this body does not move in a plane",
        "accelerations of points are `a(point / point / frame)`",
    ),
    (
        "screw_axis(sledge / ground)",
        "`sledge` does not rotate with respect to `ground`",
        "a body in pure translation has no centre",
    ),
    ("screw_axis(bead / ground)", "`bead` is a point, which has no axes", "name a body or a frame"),
    (
        "center_of_percussion(arm / ground)",
        "`center_of_percussion` takes a body, a point and an axis",
        "`center_of_percussion(body / point, z)`",
    ),
    (
        "center_of_percussion(stone / stone, z)",
        "the centre of mass of `stone` lies on this axis",
        "a pure torque rotates the body without a",
    ),
    (
        "center_of_percussion(stone / ground, x + y)",
        "this axis is not a principal axis of inertia of `stone`",
        "every impulse then loads the bearings",
    ),
    ("momentum(arm, stone)", "`momentum` takes a body", "`momentum((first, second))`"),
    (
        "angular_momentum(arm, stone / ground)",
        "`angular_momentum` takes a body and a point",
        "`angular_momentum((first, second) / point)`",
    ),
    ("momentum((arm, stone, arm))", "`arm` is given twice", "name each body once"),
    ("momentum(())", "expected bodies, found none", "`(first, second)`"),
    ("momentum((arm, rock))", "unknown body `rock`", ""),
    (
        "center_of_mass(arm)",
        "`center_of_mass` takes bodies and a point",
        "`center_of_mass((first, second) / point)`",
    ),
    ("center_of_mass(shell / ground)", "a body without mass has no centre of mass", "with a `mass`"),
    ("rate(r(arm / ground))", "the rate of a vector is relative to a frame", "`rate(vector / frame)`"),
    ("rate(s / ground)", "expected a vector, found a scalar", "`rate(scalar)`"),
    ("rate(r(arm / ground) / grounds)", "unknown name `grounds`", ""),
    ("rate(r(arm / ground) / bead)", "`bead` is a point, which has no axes", "name a body or a frame"),
    ("gradient(s)", "`gradient` takes a scalar and a point", "`gradient(field / point)`"),
    ("gradient(2 * s / bed)", "unknown point `bed`", "did you mean `bead`?"),
    ("gradient(s * s / stone)", "this does not depend on the position of `stone`", "`r(stone / ground)`"),
    ("gradient(r(bead / ground) / bead)", "expected a scalar, found a vector", ""),
    (
        "gradient(norm(v(bead / ground / ground)) / arm)",
        "this does not depend on the position of `arm`",
        "`r(arm / ground)`",
    ),
    ("r(arm.at(s * q) / ground)", "unknown name `q`", ""),
    ("r(arm.at(rate(s) * x) / ground)", "the rate of `s` is not allowed here", "coordinates and time"),
];

/// Scalar outputs of a mechanism with an arm on a hinge, a bead on a curve with parameter `s`, and a free
/// stone.
const SCALARS: &[ErrorRow] = &[
    ("curvature(wire)", "`curvature` takes a curve and the coordinate along it", "`curvature(curve, s)`"),
    ("curvature(wire, u)", "`curvature` takes the coordinate that parametrises the curve", ""),
    ("curvature(wire, hinge)", "this vector does not depend on `hinge`", "`curvature(curve, s)`"),
    ("torsion(line, s)", "this curve is straight, and has no torsion", "its curvature is zero"),
    ("curvature(s, s)", "expected a vector, found a scalar", ""),
    (
        "cable(arm / bead)",
        "`cable` takes two points and a surface",
        "`cable(a / b, drum.cylinder(radius, axis))`",
    ),
    ("cable(arm / bead, arm)", "expected a sphere or a cylinder", "`ball.sphere(radius)`"),
    ("cable(arm / bead, arm.cone(1, z))", "a cable cannot wrap around a `cone`", "`sphere(radius)`"),
    (
        "cable(arm / bead, arm.cylinder(1))",
        "a cylinder that a cable wraps around is written `cylinder(radius, axis)`",
        "right-hand rule",
    ),
    (
        "cable(arm / bead, arm.sphere(-1))",
        "this length must be positive, but it is -1",
        "the direction of the axis",
    ),
    (
        "cable(bead / arm.at(0.1 * x), arm.sphere(0.2))",
        "this end of the cable lies inside of the sphere",
        "it is 0.1000 m from the centre, and the radius is 0.2 m",
    ),
    (
        "cable(arm.at(x) / bead, arm.cylinder(2, z))",
        "this end of the cable lies inside of the cylinder",
        "it is 1.0000 m from the axis",
    ),
    ("cable(arm / bead, arm.cylinder(1, 2 * z))", "this axis is not of unit length", "unit"),
    ("cable(arm / bed, arm.sphere(1))", "unknown point `bed`", "did you mean `bead`?"),
    ("screw_pitch(arm)", "`screw_pitch` takes a body and a frame", "`screw_pitch(body / frame)`"),
    ("winding(wire, s)", "unknown function `winding`", ""),
];

const MORE: &str = "s: Coordinate,
    #[define(cos(s) * x + sin(s) * y)] wire: Vector, #[define(s * x + 2 * s * y)] line: Vector,
    #[particle(mass = 1, at = wire + line)] bead: Particle,
    #[body(mass = 1, inertia = diagonal(1, 2, 2.5))] stone: Body, #[joint(ground -> stone)] flight: Free,
    #[body] shell: Body, #[joint(ground -> shell, about = x)] turn: Pin,
    #[body(mass = 1)] sledge: Body, #[joint(ground -> sledge, along = x)] way: Sleeve,";

#[test]
fn invalid_points_in_velocities_are_reported() {
    check_error_rows(|said| (String::new(), format!("{ARM} {MORE} #[output({said})] seen: Vector")), VECTORS);
    check_error_rows(|said| (String::new(), format!("{ARM} {MORE} #[output({said})] seen: Scalar")), SCALARS);
}

/// Matrix outputs of a mechanism with an arm on a hinge, a bead on a curve with parameter `s`, and a free
/// stone.
const MATRICES: &[ErrorRow] = &[
    ("r(arm / ground)", "expected a matrix, found a vector", "`projector(n)`"),
    ("2 * s", "expected a matrix, found a scalar", "`inertia(body / point)`"),
    ("projector(2)", "expected a vector, found a scalar", ""),
    ("projector(x, y)", "`projector` takes 1 argument", "`projector(a)`"),
    ("outer(x)", "`outer` takes 2 arguments", "`outer(a, b)`"),
    ("identity(3)", "`identity` takes no argument", "`identity()`"),
    ("rotation(arm)", "`rotation` takes two frames", "`rotation(B / A)`"),
    ("rotation(arm / bead)", "`bead` is a point, which has no axes", "name a body or a frame"),
    ("inertia(arm)", "`inertia` takes bodies and a point", "`inertia(body / point)`"),
    ("identity() + 1", "a matrix cannot be added to a scalar", "`identity()`"),
    ("1 - identity()", "a matrix cannot be subtracted from a scalar", "`identity()`"),
    ("x * identity()", "a vector cannot be multiplied by a matrix", "`M * v`"),
    ("1 / identity()", "a scalar cannot be divided by a matrix", "`transpose(M)`"),
    ("identity() / x", "a matrix cannot be divided by a vector", ""),
    ("rate(identity())", "the rate of a matrix is relative to a frame", "`rate(matrix / frame)`"),
    ("transpose(x)", "expected a matrix, found a vector", ""),
    ("[[1, 2], [3, 4]]", "expected a 3×3 matrix, found 2 rows", "by its rows"),
    (
        "outer(reaction_force(hinge), x)",
        "a reaction is not allowed here",
        "forces of joints and contacts are allowed in",
    ),
];

#[test]
fn invalid_matrix_outputs_are_reported() {
    check_error_rows(
        |said| (String::new(), format!("{ARM} {MORE} #[output({said})] seen: Matrix")),
        MATRICES,
    );
    let scalars: &[ErrorRow] = &[
        ("identity()", "expected a scalar, found a matrix", "declare it as a `Matrix`"),
        ("norm(identity())", "expected a vector, found a matrix", "`M * v`"),
        ("sin(skew(x))", "expected a scalar, found a matrix", "`trace(M)`"),
    ];
    check_error_rows(|said| (String::new(), format!("{ARM} {MORE} #[output({said})] seen: Scalar")), scalars);
    let fields: &[ErrorRow] = &[
        (
            "#[define(x)] named: Matrix",
            "`named` is a vector, but it is declared as a Matrix",
            "declare it as a `Vector`",
        ),
        (
            "#[define(skew(x))] named: Vector",
            "`named` is a matrix, but it is declared as a Vector",
            "declare it as a `Matrix`",
        ),
        (
            "#[body(mass = 1, com = projector(x) * y)] log: Body, \
             #[joint(ground -> log, about = z)] roll: Pin",
            "a matrix is not allowed here",
            "definitions, outputs and forces",
        ),
    ];
    check_error_rows(|said| (String::new(), format!("{ARM} {MORE} {said}")), fields);
}

/// Further fields of a mechanism with an arm on a hinge, a bead on a curve with parameter `s`, and a free
/// stone.
const FIELDS: &[ErrorRow] = &[
    ("#[frame(ground, frenet(line, s))] f: Frame", "this curve is straight, and has no normal", "unit"),
    (
        "#[frame(ground, frenet(wire))] f: Frame",
        "`frenet` takes a curve and the coordinate along it",
        "`frenet(curve, s)`",
    ),
    (
        "#[frame(ground, cylindrical(z))] f: Frame",
        "this vector lies on the z axis, on which `cylindrical` has no directions",
        "the axes are determined by a vector that is",
    ),
    (
        "#[frame(ground, spherical())] f: Frame",
        "`spherical` takes a vector",
        "`spherical(r(point / ground))`",
    ),
    (
        "#[frame(ground, z(s), cylindrical(wire))] f: Frame",
        "`cylindrical` must be the first rotation of a `Frame`",
        "`#[frame(ground, cylindrical(…))]`",
    ),
    (
        "#[acts(on = 2 * 3, stiffness = 1)] coil: Spring",
        "this contains no coordinate: a force on it has no effect",
        "`norm(r(a / b))`",
    ),
    (
        "#[acts(on = norm(rate(s) * x), stiffness = 1)] coil: Spring",
        "the rate of `s` is not allowed here",
        "coordinates and time",
    ),
    (
        "#[acts(on = norm(wire + x), along = x)] push: Force",
        "the expression determines the direction",
        "remove this argument",
    ),
    ("#[acts(on = wire, stiffness = 1)] coil: Spring", "expected a scalar, found a vector", "norm"),
    (
        "#[acts(between = (ground, stone.at(s * x)), stiffness = 1)] coil: Spring",
        "the coordinate `s` is not allowed here",
        "only numbers and parameters",
    ),
    (
        "#[body(mass = 1, about = 0)] log: Body, #[joint(ground -> log, about = z)] roll: Pin",
        "`about` is the reference point of the inertia, but there is no inertia",
        "`inertia = …`",
    ),
    (
        "#[body(mass = 1, inertia = rod(1, 2, x), about = 0)] log: Body, \
         #[joint(ground -> log, about = z)] roll: Pin",
        "the inertia of a `rod` is about its centre",
        "remove `about`",
    ),
    (
        "#[body(mass = 1, com = x, inertia = diagonal(1, 1.5, 0.6), about = 0)] log: Body, \
         #[joint(ground -> log, about = z)] roll: Pin",
        "the inertia of `log` is not positive definite",
        "principal moments",
    ),
];

#[test]
fn invalid_frames_elements_and_inertias_are_reported() {
    check_error_rows(|said| (String::new(), format!("{ARM} {MORE} {said}")), FIELDS);
}

/// Units of curvature and of cable lengths are inferred from the expressions around them.
#[test]
fn units_of_curvature_and_cable_length_are_inferred() {
    let assert_no_messages = |fields: &str| {
        let found = compiler_messages("", &format!("{ARM} {fields}"));
        assert_eq!(found, Vec::<String>::new(), "{fields}");
    };
    assert_no_messages(
        "a: f64, k: f64, s: Coordinate, #[define(a * cos(s) * x + a * sin(s) * y)] wire: Vector,
        #[particle(mass = 1, at = wire)] bead: Particle,
        #[acts(on = hinge, value = k * (curvature(wire, s) + 1 / a))] law: Torque",
    );
    assert_no_messages("r: f64, k: f64, l: f64,
        #[acts(on = cable(arm.at(-y) / ground.at(2 * x), ground.cylinder(r, z)), stiffness = k, free_length = l + r)] band: Spring");
    let wrong = [
        "a: f64, s: Coordinate, #[define(a * cos(s) * x + a * sin(s) * y)] wire: Vector,
            #[particle(mass = 1, at = wire)] bead: Particle, #[output(curvature(wire, s) + a)] seen: Scalar",
        "r: f64, #[acts(on = cable(arm.at(-y) / ground.at(2 * x), ground.cylinder(r, z)), stiffness = r)] \
         band: Spring",
        "m: f64, #[particle(mass = m, at = arm.at(x))] bead: Particle,
            #[output(norm(rate(momentum((arm, bead)) / ground)) + m)] seen: Scalar",
        "l: f64, #[output(norm(instant_center(arm / ground) + l * l * x) + l)] seen: Scalar",
    ];
    for fields in wrong {
        let found = compiler_messages("", &format!("{ARM} {fields}"));
        let is_unit_message =
            |message: &String| message.contains("a length (m)") || message.contains("a mass (kg)");
        assert!(found.len() == 1 && found.iter().all(is_unit_message), "{fields}: {found:?}");
    }
}
