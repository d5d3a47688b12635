//! Inertias of solids compared with quadrature, and sums and rotations of inertias.

use super::value_of_expression;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::parse_source_and_import;
use linkwork_compiler::resolve::build_model;
use std::path::Path;

/// Returns the inertia matrix that the compiled model has for a solid.
fn inertia_of_solid(solid: &str) -> [[f64; 3]; 3] {
    let mut cx = Diagnostics::new();
    let item =
        format!("struct S {{ #[body(mass = 1, inertia = {solid})] b: Body, #[joint(ground -> b)] j: Free }}");
    let source =
        parse_source_and_import("".parse().unwrap(), item.parse().unwrap(), Path::new(""), &mut cx).unwrap();
    let graph = Graph::new();
    let model = build_model(&source.mechanism.description, &graph, &mut cx);
    let model = model.unwrap_or_else(|| panic!("{solid}: {:?}", cx.full_message_texts()));
    model.links[0].inertia.tensor.full_matrix().0.map(|row| row.map(value_of_expression))
}

fn assert_near_inertia(solid: &str, expected: [[f64; 3]; 3], tolerance: f64) {
    let found = inertia_of_solid(solid);
    let scale = expected.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((a - b).abs() <= tolerance * scale, "{solid}: {found:?}, expected {expected:?}");
    }
}

fn diagonal_matrix(d: [f64; 3]) -> [[f64; 3]; 3] {
    [[d[0], 0.0, 0.0], [0.0, d[1], 0.0], [0.0, 0.0, d[2]]]
}

/// Returns the axial moment, and the transverse moment about the centre of mass, of a solid of revolution
/// with mass 3 between two radii along z. Computed from slices.
fn moments_of_revolution(
    from: f64,
    to: f64,
    outer: impl Fn(f64) -> f64,
    inner: impl Fn(f64) -> f64,
) -> (f64, f64) {
    const SLICES: usize = 40_000;
    let (mut mass, mut first, mut axial, mut transverse) = (0.0, 0.0, 0.0, 0.0);
    for k in 0..SLICES {
        let z = from + (to - from) * (k as f64 + 0.5) / SLICES as f64;
        let (r2, s2) = (outer(z).powi(2), inner(z).powi(2));
        let slice = r2 - s2;
        mass += slice;
        first += slice * z;
        axial += slice * (r2 + s2) / 2.0;
        transverse += slice * ((r2 + s2) / 4.0 + z * z);
    }
    let density = 3.0 / mass;
    (axial * density, transverse * density - 3.0 * (first / mass).powi(2))
}

#[test]
fn solids_of_revolution_agree_with_quadrature() {
    let zero_radius = |_: f64| 0.0;
    let ball_profile_radius = |r: f64| move |z: f64| (r * r - z * z).max(0.0).sqrt();
    let thin = 1e-5;
    let table = [
        ("rod(3, 2, z)", moments_of_revolution(0.0, 2.0, |_| thin, zero_radius), 1e-8),
        ("ring(3, 0.5, z)", moments_of_revolution(0.0, thin, |_| 0.5, |_| 0.5 - thin), 1e-4),
        ("disk(3, 0.5, z)", moments_of_revolution(0.0, thin, |_| 0.5, zero_radius), 1e-8),
        ("cylinder(3, 0.5, 2, z)", moments_of_revolution(-1.0, 1.0, |_| 0.5, zero_radius), 1e-8),
        ("tube(3, 0.3, 0.5, 2, z)", moments_of_revolution(-1.0, 1.0, |_| 0.5, |_| 0.3), 1e-8),
        ("cone(3, 0.5, 2, z)", moments_of_revolution(0.0, 2.0, |z| z / 4.0, zero_radius), 1e-8),
        (
            "capsule(3, 0.5, 2, z)",
            moments_of_revolution(
                -1.5,
                1.5,
                |z| ball_profile_radius(0.5)((z.abs() - 1.0).max(0.0)),
                zero_radius,
            ),
            1e-8,
        ),
        ("sphere(3, 0.5)", moments_of_revolution(-0.5, 0.5, ball_profile_radius(0.5), zero_radius), 1e-8),
        (
            "shell(3, 0.5)",
            moments_of_revolution(-0.5, 0.5, ball_profile_radius(0.5), ball_profile_radius(0.5 - thin)),
            1e-4,
        ),
    ];
    for (solid, (axial, transverse), tolerance) in table {
        assert_near_inertia(solid, diagonal_matrix([transverse, transverse, axial]), tolerance);
        if solid.contains("z)") {
            assert_near_inertia(
                &solid.replace("z)", "x)"),
                diagonal_matrix([axial, transverse, transverse]),
                tolerance,
            );
            assert_near_inertia(
                &solid.replace("z)", "-y)"),
                diagonal_matrix([transverse, axial, transverse]),
                tolerance,
            );
            // Moments `a` about n and `t` about its normals: t 1 + (a − t) n nᵀ.
            let n = [1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0];
            let tensor = std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    (axial - transverse) * n[i] * n[j] + if i == j { transverse } else { 0.0 }
                })
            });
            assert_near_inertia(&solid.replace("z)", "[1 / 3, 2 / 3, -2 / 3])"), tensor, tolerance);
        }
    }
}

#[test]
fn solids_of_three_lengths_agree_with_quadrature() {
    // Second moments of a box by the two-point rule, which is exact for them.
    let second_moment = |a: f64| (a / 2.0 / 3.0_f64.sqrt()).powi(2);
    let inertia_from_second_moments =
        |m: f64, s: [f64; 3]| diagonal_matrix([m * (s[1] + s[2]), m * (s[0] + s[2]), m * (s[0] + s[1])]);
    let cuboid = inertia_from_second_moments(3.0, [0.5, 1.0, 2.0].map(second_moment));
    assert_near_inertia("cuboid(3, 0.5, 1, 2)", cuboid, 1e-12);
    assert_near_inertia("box(3, 0.5, 1, 2)", cuboid, 1e-12);
    assert_near_inertia(
        "plate(3, 0.5, 1)",
        inertia_from_second_moments(3.0, [second_moment(0.5), second_moment(1.0), 0.0]),
        1e-12,
    );
    // A ball of radius one has I = 2 ∫ z² dm about every axis. Each length scales only its own second moment.
    let (moment, _) = moments_of_revolution(-1.0, 1.0, |z| (1.0 - z * z).max(0.0).sqrt(), |_| 0.0);
    let second = [0.5_f64, 1.0, 2.0].map(|a| a * a * moment / 2.0 / 3.0);
    assert_near_inertia("ellipsoid(3, 0.5, 1, 2)", inertia_from_second_moments(3.0, second), 1e-8);
    assert_near_inertia("diagonal(2, 3, 4)", diagonal_matrix([2.0, 3.0, 4.0]), 0.0);
}

#[test]
fn inertias_are_added_and_rotated() {
    assert_near_inertia("diagonal(2, 3, 4).rotated(z(pi / 2))", diagonal_matrix([3.0, 2.0, 4.0]), 1e-15);
    // R I Rᵀ with R = R_x(π/2) R_z(π/2), whose columns are the rotated axes (0, 0, 1), (−1, 0, 0), (0, −1,
    // 0).
    assert_near_inertia(
        "diagonal(2, 3, 4).rotated(x(pi / 2), z(pi / 2))",
        diagonal_matrix([3.0, 4.0, 2.0]),
        1e-15,
    );
    let (c, s) = (0.3_f64.cos(), 0.3_f64.sin());
    let rotated =
        [[2.0 * c * c + 3.0 * s * s, -c * s, 0.0], [-c * s, 2.0 * s * s + 3.0 * c * c, 0.0], [0.0, 0.0, 4.0]];
    assert_near_inertia("diagonal(2, 3, 4).rotated(z(0.3))", rotated, 1e-15);
    assert_near_inertia("diagonal(2, 3, 4).rotated(eigenaxis(z, 0.3))", rotated, 1e-15);
    assert_near_inertia(
        "rod(1, 1, x).rotated(z(pi / 2)) + sphere(1, 1)",
        diagonal_matrix([29.0, 24.0, 29.0].map(|x| x / 60.0)),
        1e-15,
    );
    assert_near_inertia(
        "[[2, 0.1, 0.2], [0.1, 3, 0.3], [0.2, 0.3, 4]]",
        [[2.0, 0.1, 0.2], [0.1, 3.0, 0.3], [0.2, 0.3, 4.0]],
        0.0,
    );
}
