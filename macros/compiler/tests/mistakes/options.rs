//! Tests of error messages about options of `#[mechanism]`.

use super::{ARM, ErrorRow, check_error_rows};

const ROWS: &[ErrorRow] = &[
    (
        "g = 9.81",
        "`#[mechanism]` has no argument `g`",
        "did you mean `gravity`? it is a vector: `gravity = -9.81 * y`",
    ),
    ("gravity = 9.81", "expected a vector, found a scalar", "write `gravity = -9.81 * y`"),
    ("gravity = (0, -9.81, 0)", "expected a scalar or a vector, found a list", "write `[0, -9.81, 0]`"),
    ("gravity = -y * G", "unknown name `G`", "the macro cannot see the value of a constant"),
    ("gravity = -9.81 * down", "unknown name `down`", "downwards is `-y` or `-z`"),
    ("gravity = true", "unknown name `true`", "a value is a number"),
    ("gravity", "`gravity` has no value", "write `gravity = -9.81 * y`"),
    ("no_gravity", "unknown option `no_gravity`", "without `gravity` there is none"),
    ("derivatives = true", "`derivatives` is an option without a value", "write `derivatives` alone"),
    ("prepare = \"yes\"", "`prepare` is an option without a value", "write `prepare` alone"),
    ("batch = false", "`batch` is an option without a value", "leave it out"),
    ("derivatives()", "`derivatives` is an option without a value", "write `derivatives` alone"),
    ("jacobian", "unknown option `jacobian`", "did you mean `derivatives`?"),
    ("gradients", "unknown option `gradients`", "did you mean `derivatives`?"),
    ("linearize", "unknown option `linearize`", "did you mean `derivatives`?"),
    ("simd", "unknown option `simd`", "did you mean `batch`?"),
    ("sparse", "unknown option `sparse`", "did you mean `packed`?"),
    ("momentum", "unknown option `momentum`", "did you mean `centroidal`?"),
    ("\"two_links.urdf\"", "expected `name = value`, found a string", "write `urdf = \"two_links.urdf\"`"),
    ("file = \"two_links.urdf\"", "`#[mechanism]` has no argument `file`", "did you mean `urdf`?"),
    ("path = \"two_links.urdf\"", "`#[mechanism]` has no argument `path`", "did you mean `urdf`?"),
    ("mjcf = \"robot.xml\"", "there is no file `robot.xml`", "looked for"),
    ("sdf = \"robot.sdf\"", "there is no file `robot.sdf`", "looked for"),
    ("usd = \"robot.usd\"", "`#[mechanism]` has no argument `usd`", "URDF, MJCF and SDF files can be read"),
    ("xacro = \"r.urdf.xacro\"", "`#[mechanism]` has no argument `xacro`", "expand the template first"),
    ("urdf = robot", "expected a string for `urdf`", "write `urdf = \"…\"`"),
    ("base = free", "`base` is an option of imported files", "`#[joint(ground -> body)] pose: Free`"),
    ("loops = close", "`loops` is an option of imported files", "add `urdf"),
    ("contacts = file", "`contacts` is an option of imported files", "add `urdf"),
    ("floating_base = true", "`#[mechanism]` has no argument `floating_base`", "did you mean `base = free`?"),
    ("f32", "unknown option `f32`", "write `scalar = f32`"),
    ("scalar = f16", "unknown value `f16` for `scalar`", "expected `f64` or `f32`"),
    ("precision = f32", "`#[mechanism]` has no argument `precision`", "did you mean `scalar`?"),
    ("solver = rk4", "`#[mechanism]` has no argument `solver`", "`linkwork::integrate`"),
    ("dt = 0.01", "`#[mechanism]` has no argument `dt`", "`linkwork::integrate`"),
    ("units = si", "`#[mechanism]` has no argument `units`", "SI units"),
    ("formulation = lagrange", "unknown value `lagrange` for `formulation`", "did you mean `multipliers`?"),
    ("formulation = kane", "unknown value `kane` for `formulation`", "did you mean `speeds`?"),
    ("gravity = -9.81 * y, gravity = 0", "`gravity` is given twice", "remove one"),
    ("gravity = -9.81 * y derivatives", "expected `,`", "arguments are separated by `,`"),
    ("name = \"robot\"", "`#[mechanism]` has no argument `name`", "the struct's name"),
];

#[test]
fn invalid_options_are_reported() {
    check_error_rows(|said| (said.to_string(), ARM.to_string()), ROWS);
}
