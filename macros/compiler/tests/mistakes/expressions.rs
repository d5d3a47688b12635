//! Expressions: functions, names and numbers in the terminology of other tools.

use super::{ARM, ErrorRow, check_error_rows};

/// Values of an output of an arm on a hinge, with a parameter `theta` and a length `l`.
const SCALARS: &[ErrorRow] = &[
    ("arctan(hinge)", "unknown function `arctan`", "did you mean `atan`?"),
    ("arcsin(hinge)", "unknown function `arcsin`", "did you mean `asin`?"),
    ("atan(hinge, 1)", "`atan` takes 1 argument", "did you mean `atan2`?"),
    ("arctan2(hinge, 1)", "unknown function `arctan2`", "did you mean `atan2`?"),
    ("log(hinge)", "unknown function `log`", "did you mean `ln`?"),
    ("sgn(hinge)", "unknown function `sgn`", "did you mean `signum`?"),
    ("sign(hinge)", "unknown function `sign`", "did you mean `signum`?"),
    ("sqr(hinge)", "unknown function `sqr`", "`pow(a, 2)`"),
    ("square(hinge)", "unknown function `square`", "`pow(a, 2)`"),
    ("cot(hinge)", "unknown function `cot`", "`1 / tan(a)`"),
    ("hypot(hinge, 1)", "unknown function `hypot`", "`sqrt(a * a + b * b)`"),
    ("clamp(hinge, 0, 1)", "unknown function `clamp`", "`min(max(a, low), high)`"),
    ("heaviside(hinge)", "unknown function `heaviside`", "`(1 + signum(a)) / 2`"),
    ("fabs(hinge)", "unknown function `fabs`", "did you mean `abs`?"),
    ("ddt(hinge)", "unknown function `ddt`", "did you mean `rate`?"),
    ("der(hinge)", "unknown function `der`", "did you mean `rate`?"),
    ("diff(hinge, t)", "unknown function `diff`", "did you mean `rate`?"),
    ("dot(hinge)", "`dot` takes 2 arguments", "`rate(coordinate)`"),
    ("norm2(r(arm / ground))", "unknown function `norm2`", "`dot(v, v)`"),
    ("length(r(arm / ground))", "unknown function `length`", "did you mean `norm`?"),
    ("magnitude(r(arm / ground))", "unknown function `magnitude`", "did you mean `norm`?"),
    ("abs(r(arm / ground))", "expected a scalar, found a vector", "`norm(v)`"),
    ("radians(90)", "unknown function `radians`", "did you mean `degrees`?"),
    ("deg2rad(90)", "unknown function `deg2rad`", "did you mean `degrees`?"),
    ("deg(90)", "unknown function `deg`", "did you mean `degrees`?"),
    ("90 * deg", "unknown name `deg`", "`degrees(90)`"),
    ("hinge_dot", "unknown name `hinge_dot`", "write `rate(hinge)`"),
    ("hinge_d", "unknown name `hinge_d`", "write `rate(hinge)`"),
    ("hingedot", "unknown name `hingedot`", "write `rate(hinge)`"),
    ("dhinge", "unknown name `dhinge`", "write `rate(hinge)`"),
    ("hinge.rate", "`hinge` is a joint and has no axes", "write `rate(hinge)`"),
    ("hinge.velocity", "`hinge` is a joint and has no axes", "write `rate(hinge)`"),
    ("hinge.angle", "`hinge` is a joint and has no axes", "write `hinge`"),
    ("hinge.dot()", "`.dot(…)` has no value here", "write `rate(hinge)`"),
    ("hinge.sin()", "`.sin(…)` has no value here", "write `sin(…)`"),
    ("hinge.powi(2)", "`.powi(…)` has no value here", "write `pow(a, n)`"),
    ("q[0]", "expected `,` or an operator", "coordinates have names"),
    ("time", "unknown name `time`", "did you mean `t`?"),
    ("PI * hinge", "unknown name `PI`", "did you mean `pi`?"),
    ("M_PI * hinge", "unknown name `M_PI`", "did you mean `pi`?"),
    ("π * hinge", "unknown name `π`", "did you mean `pi`?"),
    ("tau * hinge", "unknown name `tau`", "`2 * pi`"),
    ("std::f64::consts::PI * hinge", "expected `,` or an operator", "the number π is `pi`"),
    ("GRAVITY * hinge", "unknown name `GRAVITY`", "declare a parameter, `gravity: f64`"),
    ("STIFFNESS * hinge", "unknown name `STIFFNESS`", "the macro cannot see the value of a constant"),
    ("self.l * hinge", "parameters are named without `self`", "write `l`"),
    ("arm.mass * hinge", "a body has no `mass`", "its properties have no names here"),
    ("arm.length * hinge", "a body has no `length`", "its properties have no names here"),
    ("arm.position", "a body has no `position`", "`r(arm / ground)`"),
    ("arm.velocity", "a body has no `velocity`", "`v(arm / ground / ground)`"),
    ("θ * hinge", "unknown name `θ`", "did you mean `theta`?"),
    ("Theta * hinge", "unknown name `Theta`", "did you mean `theta`?"),
    ("ω(arm / ground)", "unknown function `ω`", "did you mean `omega`?"),
    (
        "hinge ** 2",
        "expected an expression: a number, a name, a call or a vector",
        "write `pow(a, n)` for a power",
    ),
    ("hinge ^ 2", "expected `,` or an operator", "write `pow(a, n)` for a power"),
    ("2 hinge", "expected `,` or an operator", "factors by `*`"),
    ("2 % hinge", "expected `,` or an operator", "the operators are"),
    ("hinge as f64", "expected `,` or an operator", "remove the conversion"),
    (
        "if hinge > 0 { 1 } else { 0 }",
        "the pieces differ where `hinge` is `0`: they are 0 and 1 there",
        "give both pieces the same value there",
    ),
    (
        "if hinge < theta { theta } else { 2 * hinge }",
        "the pieces differ where `hinge` is `theta`",
        "give both pieces the same value there",
    ),
    (
        "if hinge < 0 { 0 } else if hinge < 1 { hinge } else { 2 }",
        "the pieces differ where `hinge` is `1`: they are 1 and 2 there",
        "give both pieces the same value there",
    ),
    (
        "if hinge < 1 { sqrt(hinge - 2) } else { 0 }",
        "cannot determine whether the pieces agree where `hinge` is `1`",
        "defined there",
    ),
    (
        "if hinge < 2 * hinge { hinge } else { 0 }",
        "the boundary between the pieces depends on the compared quantity",
        "solve the comparison",
    ),
    (
        "if 1 < 2 { hinge } else { 0 }",
        "this comparison of two numbers is constant",
        "keep only the piece that applies",
    ),
    ("if hinge < 0 { 0 }", "an `if` needs an `else`: both branches need a value", "else { k"),
    ("if hinge { 1 } else { 0 }", "expected `<` or `>`: a condition compares two quantities", "else { k"),
    (
        "if hinge == 0 { 1 } else { 0 }",
        "expected `<` or `>`: a condition compares two quantities",
        "else { k",
    ),
    ("if hinge < 0 { } else { hinge }", "expected an expression in these braces", "else { k"),
    ("if hinge < 0 { 0 } else hinge", "expected `{` or `if` after `else`", "else { k"),
    (
        "if hinge < 0 && hinge > -1 { 0 } else { hinge }",
        "expected `{` and the expression for a true comparison",
        "else { k",
    ),
    ("if r(arm / ground) < 0 { 0 } else { hinge }", "expected a scalar, found a vector", "norm"),
    ("norm(wind_axes(arm, v(arm / ground / ground)))", "`wind_axes` takes 3 arguments", "[a, b, c]"),
    (
        "norm(wind_axes(arm, v(arm / ground / ground), 2))",
        "expected the three components in a list",
        "[-drag, side, -lift]",
    ),
    ("piecewise(hinge, 0)", "unknown function `piecewise`", "`if a < b { … } else { … }`"),
    ("hinge > 0", "expected `,` or an operator", "and a constraint is an equation"),
    ("sin hinge", "expected `,` or an operator", "factors by `*`"),
    ("sin()", "`sin` takes 1 argument", "write `sin(a)`"),
    ("sin(r(arm / ground))", "expected a scalar, found a vector", "dot("),
    ("atan2(hinge)", "`atan2` takes 2 arguments", "`atan2(y, x)`"),
    ("pow(hinge)", "`pow` takes 2 arguments", "`pow(a, n)`"),
    ("norm(hinge)", "expected a vector, found a scalar", "abs"),
    ("dot(r(arm / ground), 1)", "expected a vector, found a scalar", "direction"),
    ("v(arm)", "`v` is written with slashes", "`v(point / point / frame)`"),
    ("v(arm, ground)", "`v` is written with slashes", "`v(point / point / frame)`"),
    (
        "v(arm / ground)",
        "`v` needs the frame with respect to which it is taken",
        "`v(point / point / frame)`",
    ),
    ("velocity(arm / ground / ground)", "unknown function `velocity`", "did you mean `v`?"),
    ("position(arm / ground)", "unknown function `position`", "did you mean `r`?"),
    ("angular_velocity(arm / ground)", "unknown function `angular_velocity`", "did you mean `omega`?"),
    ("acc(arm / ground / ground)", "unknown function `acc`", "did you mean `a`?"),
    ("omega(arm)", "`omega` is written with slashes", "`omega(frame / frame)`"),
    (
        "norm(angular_momentum(arm))",
        "`angular_momentum` takes a body and a point",
        "`angular_momentum(body / point)`",
    ),
    ("norm(momentum(arm / ground))", "`momentum` takes a body", "`momentum(body)`"),
    ("kinetic_energy(ground)", "unknown body `ground`", "expected `arm`"),
    ("kinetic_energy(arms)", "unknown body `arms`", "did you mean `arm`?"),
    ("kinetic_energy(2)", "expected a body", "name a body or a particle"),
    ("power(hinge)", "unknown force element `hinge`", ""),
    ("power(arm, hinge)", "`power` takes one force element", "`power(spring)`"),
    ("power(2)", "expected a force element", ""),
    (
        "moment_of_inertia(arm, z)",
        "`moment_of_inertia` takes a body, a point and a direction",
        "`moment_of_inertia(body / point, direction)`",
    ),
    (
        "moment_of_inertia(arm / ground)",
        "`moment_of_inertia` takes a body, a point and a direction",
        "with a second direction",
    ),
    (
        "moment_of_inertia(arm / ground, x, y, z)",
        "`moment_of_inertia` takes one direction or two",
        "a product of inertia",
    ),
    ("moment_of_inertia(arms / ground, z)", "unknown body `arms`", "did you mean `arm`?"),
    ("moment_of_inertia(arm / ground, 2)", "expected a vector, found a scalar", "multiply it by a direction"),
    ("rate(l)", "`rate` takes a coordinate", "expected `hinge`"),
    ("rate(r(arm / ground))", "the rate of a vector is relative to a frame", "`rate(norm(vector))`"),
    (
        "rate(rate(rate(hinge)))",
        "this depends on accelerations or forces, whose rates are not known",
        "coordinates, velocities and time",
    ),
    ("rate(hinge, 2)", "`rate` takes one coordinate", "write `rate(hinge)`"),
    ("arm", "`arm` is a body, not a value", "its axes are"),
    ("arm.x", "expected a scalar, found a vector", "declare it as a `Vector`"),
    ("1kg", "a number cannot have the suffix `kg`", "SI units"),
    ("2 * kg", "unknown name `kg`", "SI units"),
    ("90 * degrees", "unknown name `degrees`", "write `degrees(90)`"),
    ("1e999", "this number is too large", "e"),
    ("\"hinge\"", "expected an expression, found a string", "without quotes"),
    ("'h'", "expected an expression, found a string", "without quotes"),
    ("true", "unknown name `true`", "a number"),
    ("cross(arm.x, arm.y) + 1", "a vector cannot be added to a scalar", "multiply the scalar by a direction"),
    ("arm.x * arm.y", "the product of two vectors is not defined", "`dot(a, b)` or `cross(a, b)`"),
    ("inner(arm.x, arm.y)", "unknown function `inner`", "did you mean `dot`?"),
    ("hinge / 0", "division by zero", "the divisor"),
    ("sqrt(-1)", "`sqrt` is not defined at -1", "its argument is a number here"),
    ("pow(-2, 0.5)", "`pow` is not defined at -2 and 0.5", "a base that can be negative requires an"),
    ("pow(0, -1 / 2)", "`pow` is infinite at 0 and -0.5", "a base that can be negative requires an"),
    (
        "pow(-2, hinge)",
        "powers of -2 are defined only for integer exponents",
        "a base that can be negative requires an",
    ),
];

#[test]
fn invalid_scalar_expressions_are_reported() {
    check_error_rows(
        |said| {
            let used = "#[acts(on = hinge, stiffness = l, free_angle = theta)] coil: Spring";
            (String::new(), format!("l: f64, theta: f64, {ARM} {used}, #[output({said})] seen: Scalar"))
        },
        SCALARS,
    );
}

/// Vectors as the centre of mass of a body, with a length `l`.
const VECTORS: &[ErrorRow] = &[
    ("(0, 0, l)", "expected a scalar or a vector, found a list", "write `[0, 0, l]`"),
    ("vec(0, 0, l)", "unknown function `vec`", "`[a, b, c]`"),
    ("Vector3::new(0, 0, l)", "expected `,` or an operator", "`[a, b, c]`"),
    ("vector![0, 0, l]", "expected `,` or an operator", "not macros"),
    ("[0, l]", "a vector has three components, found 2", "`[a, b, c]`"),
    ("l", "expected a vector, found a scalar", "`length * y`"),
    ("l * ey", "unknown name `ey`", "did you mean `y`?"),
    ("l y", "expected `,` or an operator", "factors by `*`"),
    ("l * Y", "unknown name `Y`", "did you mean `y`?"),
    ("l * body.y", "unknown body `body`", "are the axes of the current frame"),
    ("l * self.y", "parameters are named without `self`", "write `y`"),
    ("l * ground.y", "this vector is given in the axes of `ground`", "of the frame are allowed here"),
    ("normalize(l * y)", "unknown function `normalize`", "did you mean `unit`?"),
    ("l * y + 1", "a vector cannot be added to a scalar", "multiply the scalar by a direction"),
    ("l * hinge * y", "the coordinate `hinge` is not allowed here", "only numbers and parameters"),
    ("L * y", "unknown name `L`", "did you mean `l`?"),
    ("LENGTH * y", "unknown name `LENGTH`", "the macro cannot see the value of a constant"),
];

#[test]
fn invalid_vector_expressions_are_reported() {
    check_error_rows(
        |said| {
            let arm = format!("#[body(mass = 1, com = {said}, inertia = rod(1, l, y))] arm: Body");
            (String::new(), format!("l: f64, {arm}, #[joint(ground -> arm, about = z)] hinge: Pin"))
        },
        VECTORS,
    );
}

/// Inertias of a body with mass `m` and length `l`.
const INERTIAS: &[ErrorRow] = &[
    ("[1, 1, 1]", "expected a 3×3 matrix, found three numbers", "write `diagonal(1, 1, 1)`"),
    ("[m, l, m]", "expected a 3×3 matrix, found three numbers", "write `diagonal(m, l, m)`"),
    ("(1, 1, 1)", "expected an inertia, found a list", "write `diagonal(1, 1, 1)`"),
    (
        "[1, 0, 0, 1, 0, 1]",
        "expected a 3×3 matrix, found 6 numbers",
        "[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]",
    ),
    ("[[1, 0], [0, 1]]", "expected a 3×3 matrix, found 2 rows", "[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]"),
    ("diag(1, 1, 1)", "unknown solid `diag`", "did you mean `diagonal`?"),
    ("diagonal([1, 1, 1])", "`diagonal` takes 3 arguments", "write `diagonal(xx, yy, zz)`"),
    ("1", "expected an inertia, found a number", "`diagonal(1, 1, 1)`"),
    ("m * l * l / 12", "expected an inertia", "rod(m, l, y)"),
    ("m * l * l", "expected an inertia", "`diagonal(i, i, i)`"),
    ("cube(m, l)", "unknown solid `cube`", "it is written `cuboid(mass, x length, y length, z length)`"),
    ("brick(m, l, l, l)", "unknown solid `brick`", "did you mean `cuboid`?"),
    ("ball(m, l)", "unknown solid `ball`", "did you mean `sphere`?"),
    ("bar(m, l, y)", "unknown solid `bar`", "did you mean `rod`?"),
    ("hoop(m, l, y)", "unknown solid `hoop`", "did you mean `ring`?"),
    ("disc(m, l, y)", "unknown solid `disc`", "did you mean `disk`?"),
    ("point(m)", "unknown solid `point`", "leave `inertia` out"),
    ("rod(m, y, l)", "expected the length of the rod, found a vector", "write `rod(mass, length, axis)`"),
    ("rod(y, m, l)", "expected the mass of the rod, found a vector", "write `rod(mass, length, axis)`"),
    (
        "rod(l, m, y)",
        "`l` is a mass (kg) here, but a length (m) elsewhere",
        "write `rod(mass, length, axis)`",
    ),
    ("rod(m, l)", "`rod` takes 3 arguments", "write `rod(mass, length, axis)`"),
    ("rod(length = l, mass = m, axis = y)", "expected `,` or an operator", "without names"),
    ("sphere(m, l, y)", "`sphere` takes 2 arguments", "write `sphere(mass, radius)`"),
    ("rod(m, l, y) * 2", "expected an inertia", "twice the mass"),
    ("sphere(-1, l)", "this cannot be negative, but it is -1", "mass"),
    ("\"sphere\"", "expected an expression for `inertia`, found a string", "without quotes"),
];

#[test]
fn invalid_inertia_expressions_are_reported() {
    check_error_rows(
        |said| {
            let arm = format!("#[body(mass = m, com = l * y, inertia = {said})] arm: Body");
            (String::new(), format!("m: f64, l: f64, {arm}, #[joint(ground -> arm, about = z)] hinge: Pin"))
        },
        INERTIAS,
    );
}
