//! Tests of messages about angles that are probably meant in degrees.

use super::{ARM, ErrorRow, check_error_rows, compiler_messages};

const ROWS: &[ErrorRow] = &[
    (
        "#[joint(ground.rotated(z(90)) -> tool, about = z)] wrist: Pin",
        "an angle of 90 rad is more than a full turn",
        "write `degrees(90)`",
    ),
    (
        "#[joint(ground.rotated(z(-45)) -> tool, about = z)] wrist: Pin",
        "an angle of -45 rad is more than a full turn",
        "write `degrees(-45)`",
    ),
    (
        "#[joint(ground.rotated(eigenaxis(z, 180)) -> tool, about = z)] wrist: Pin",
        "an angle of 180 rad is more than a full turn",
        "write `degrees(180)`",
    ),
    (
        "#[joint(ground -> tool, about = [cos(30), sin(pi), 0])] wrist: Pin",
        "an angle of 30 rad is more than a full turn",
        "write `degrees(30)`",
    ),
    (
        "#[joint(ground -> tool, about = z)] wrist: Pin, \
         #[acts(on = wrist, stiffness = 1, free_angle = 45)] coil: Spring",
        "an angle of 45 rad is more than a full turn",
        "`1 * 45`",
    ),
    (
        "#[joint(ground -> tool, about = z)] wrist: Pin, #[frame(tool, x(90), z(t))] turned: Frame",
        "an angle of 90 rad is more than a full turn",
        "write `degrees(90)`",
    ),
    (
        "#[joint(ground -> tool, about = z)] wrist: Pin, #[constraint(hinge = 45)] held: Holonomic",
        "an angle of 45 rad is more than a full turn",
        "write `degrees(45)`",
    ),
    (
        "#[joint(ground -> tool, about = z)] wrist: Pin, \
         #[constraint(angle(arm.x, tool.x) = 60)] held: Holonomic",
        "an angle of 60 rad is more than a full turn",
        "write `degrees(60)`",
    ),
    (
        "#[joint(ground -> tool, about = degrees(90))] wrist: Pin",
        "expected a vector, found a scalar",
        "direction",
    ),
    (
        "#[joint(ground.rotated(degrees(90)) -> tool, about = z)] wrist: Pin",
        "expected a rotation",
        "`z(angle)`",
    ),
    (
        "#[joint(ground.rotated(z(degrees(1, 2))) -> tool, about = z)] wrist: Pin",
        "`degrees` takes 1 argument",
        "write `degrees(90)`",
    ),
];

#[test]
fn angles_written_in_degrees_are_reported() {
    check_error_rows(
        |said| (String::new(), format!("{ARM} #[body(mass = 1, inertia = sphere(1, 1))] tool: Body, {said}")),
        ROWS,
    );
}

/// Checks that plausible angles, such as `2 * pi` and `degrees(90)`, are accepted without an error.
#[test]
fn plausible_angles_are_accepted() {
    for angle in [
        "degrees(90)",
        "-degrees(90)",
        "6.2832",
        "2 * pi",
        "40 * pi",
        "1 * 90",
        "degrees(720)",
        "-3",
        "_tilt",
        "t * 90",
    ] {
        let tool = "#[body(mass = 1, inertia = sphere(1, 1))] tool: Body";
        let constant = if angle.contains('t') { "_tilt" } else { angle };
        let fields = format!(
            "_tilt: f64, {ARM} {tool}, #[joint(ground.rotated(z({constant})) -> tool, about = z)] wrist: Pin,
            #[acts(on = wrist, stiffness = 1, free_angle = {constant})] coil: Spring,
            #[frame(tool, x({angle}))] turned: Frame"
        );
        assert_eq!(compiler_messages("", &fields), Vec::<String>::new(), "{angle}");
    }
}

/// Right angles in degrees are exact: the generated code is identical to that with radians.
#[test]
fn right_angles_in_degrees_are_exact() {
    let expand_with_angle = |angle: &str| {
        let arm = "#[body(mass = 1, com = x + y, inertia = diagonal(1, 2, 3))] arm: Body";
        let hinge = format!(
            "#[joint(ground.at(x).rotated(x({angle})) -> arm.rotated(z({angle})), about = z)] hinge: Pin"
        );
        let item = format!("struct Machine {{ {arm}, {hinge} }}").parse().unwrap();
        linkwork_compiler::expand("gravity = -9.81 * y".parse().unwrap(), item, std::path::Path::new("")).text
    };
    for (degrees, radians) in [
        ("90", "pi / 2"),
        ("-90", "-pi / 2"),
        ("180", "pi"),
        ("270", "3 * pi / 2"),
        ("45", "pi / 4"),
        ("0", "0"),
    ] {
        assert!(
            expand_with_angle(&format!("degrees({degrees})")) == expand_with_angle(radians),
            "{degrees}°"
        );
    }
}
