//! Tests of error messages for coefficients outside the range of computations.

use super::{ErrorRow, check_error_rows, compiler_messages};

const ROWS: &[ErrorRow] = &[
    (
        "mass = 1e308, inertia = sphere(1, 1)",
        "this number is too large for `f64`: 1e308",
        "products of it overflow",
    ),
    (
        "mass = -1, inertia = sphere(1, 1)",
        "the mass of `arm` cannot be negative, but it is -1",
        "zero or more",
    ),
    ("mass = 1e-320, inertia = sphere(1, 1)", "this number is too small for `f64`: 1e-320", "write 0"),
    ("mass = 1, com = 1e200 * x", "this length is too large for `f64`: 1e200", "its square overflows"),
    (
        "mass = 1, inertia = diagonal(1e308, 1e308, 1e308)",
        "this number is too large for `f64`: 1e308",
        "products of it overflow",
    ),
    (
        "mass = 1e140, com = 1e70 * x",
        "the inertial parameters of `arm` are too large",
        "mass times the square of the distance from",
    ),
];

#[test]
fn coefficients_near_overflow_are_rejected() {
    check_error_rows(
        |said| {
            let arm = format!("#[body({said})] arm: Body");
            (String::new(), format!("{arm}, #[joint(ground -> arm, about = z)] hinge: Pin"))
        },
        ROWS,
    );
}

/// Functions that do not contain the overflowing coefficients remain finite.
#[test]
fn overflowing_products_are_rejected_only_where_used() {
    const ROWS: &[ErrorRow] = &[(
        "1e200 * hinge * 1e200",
        "the values of this mechanism are too large",
        "a product of masses, lengths or forces in its equations is not a finite number",
    )];
    check_error_rows(
        |said| {
            let arm = "#[body(mass = 1, com = x)] arm: Body, #[joint(ground -> arm, about = z)] hinge: Pin";
            (String::new(), format!("{arm}, #[acts(on = hinge, value = {said})] push: Torque"))
        },
        ROWS,
    );
}

const SINGLE: &[ErrorRow] = &[
    (
        "mass = 1e25, inertia = sphere(1, 1)",
        "this number is too large for `f32`: 1e25",
        "products of it overflow",
    ),
    ("mass = 1, com = 1e20 * x", "this length is too large for `f32`: 1e20", "its square overflows"),
    ("mass = 1e300, inertia = sphere(1, 1)", "this number is too large for `f32`: 1e300", "use `f64`"),
    ("mass = 1e-60, inertia = sphere(1, 1)", "this number is too small for `f32`: 1e-60", "use `f64`"),
];

#[test]
fn coefficients_near_single_precision_overflow_are_rejected() {
    check_error_rows(
        |said| {
            let arm = format!("#[body({said})] arm: Body");
            ("scalar = f32".to_string(), format!("{arm}, #[joint(ground -> arm, about = z)] hinge: Pin"))
        },
        SINGLE,
    );
}

/// Coefficients of planets and of small machines are accepted.
#[test]
fn coefficients_of_planets_and_micromachines_are_accepted() {
    for (scalar, mass, length) in [
        ("f64", "1.989e30", "1.5e11"),
        ("f64", "1e-15", "1e-6"),
        ("f32", "1e-9", "1e-4"),
        ("f32", "1e6", "100"),
    ] {
        let arm = format!(
            "#[body(mass = {mass}, com = {length} * x, inertia = rod({mass}, {length}, x))] arm: Body"
        );
        let fields = format!("{arm}, #[joint(ground.at({length} * y) -> arm, about = z)] hinge: Pin");
        assert_eq!(
            compiler_messages(&format!("scalar = {scalar}"), &fields),
            Vec::<String>::new(),
            "{mass} kg"
        );
    }
}
