//! Tests of springs, dashpots, screw joints and impulses against closed forms.

use linkwork::nalgebra::{Matrix2, SVector, Vector2, Vector3};
use linkwork::{frame, mechanism};
use support::compare::assert_close;
use support::simulate::state_after_duration;

/// Mass on a rail, and wheel on a pin, each with a spring and a dashpot.
#[mechanism]
struct Oscillators {
    m: f64,
    j: f64,
    k: f64,
    c: f64,
    k_turn: f64,
    c_turn: f64,
    #[body(mass = m)]
    block: Body,
    #[body(inertia = diagonal(j, j, j))]
    wheel: Body,
    #[joint(ground -> block, along = x)]
    rail: Sleeve,
    #[joint(ground -> wheel, about = y)]
    axle: Pin,
    #[acts(on = rail, stiffness = k, free_length = 0)]
    spring: Spring,
    #[acts(on = rail, damping = c)]
    dashpot: Dashpot,
    #[acts(on = axle, stiffness = k_turn)]
    torsion_spring: Spring,
    #[acts(on = axle, damping = c_turn)]
    torsion_dashpot: Dashpot,
}

/// Returns position and velocity at time `t` of `m ẍ + c ẋ + k x = 0` from `x0`, `v0`, for subcritical
/// damping.
fn damped_oscillation(m: f64, c: f64, k: f64, [x0, v0]: [f64; 2], t: f64) -> [f64; 2] {
    let (decay, rate) = (c / (2.0 * m), (k / m - c * c / (4.0 * m * m)).sqrt());
    let (sin, cos) = (rate * t).sin_cos();
    let (a, b) = (x0, (v0 + decay * x0) / rate);
    let envelope = (-decay * t).exp();
    let x = envelope * (a * cos + b * sin);
    [x, -decay * x + envelope * rate * (b * cos - a * sin)]
}

#[test]
fn mass_spring_dashpot_has_its_closed_form() {
    // An inerter of 0.5 kg to the ground acts as another half kilogram: the published value includes both.
    for (m, published) in [(2.5, Some(-0.223_423_268_884_342_75)), (2.0, None)] {
        let oscillators = Oscillators { m, j: 0.3, k: 50.0, c: 3.0, k_turn: 8.0, c_turn: 0.1 };
        let (q, v) = (Vector2::new(1.0, 0.5), Vector2::new(0.0, -2.0));
        let (q, v) = state_after_duration(&oscillators, &q, &v, 1.0);
        if let Some(published) = published {
            assert_close("published", &[q[0]], &[published], 1e-13);
        }
        assert_close("sliding", &[q[0], v[0]], &damped_oscillation(m, 3.0, 50.0, [1.0, 0.0], 1.0), 1e-13);
        assert_close("turning", &[q[1], v[1]], &damped_oscillation(0.3, 0.1, 8.0, [0.5, -2.0], 1.0), 1e-13);
    }
}

/// A dashpot alone gives `v = v0 exp(−c t / m)`; the stopping distance is `m v0 / c`.
#[test]
fn dashpot_alone_stops_exponentially() {
    let oscillators = Oscillators { m: 2.0, j: 0.3, k: 0.0, c: 3.0, k_turn: 0.0, c_turn: 0.4 };
    let (q, v) = state_after_duration(&oscillators, &Vector2::zeros(), &Vector2::new(4.0, 5.0), 2.0);
    let (slowed, turned) = ((-3.0_f64 * 2.0 / 2.0).exp(), (-0.4_f64 * 2.0 / 0.3).exp());
    assert_close("speeds", v.as_slice(), &[4.0 * slowed, 5.0 * turned], 1e-13);
    let distances = [2.0 * 4.0 / 3.0 * (1.0 - slowed), 0.3 * 5.0 / 0.4 * (1.0 - turned)];
    assert_close("distances", q.as_slice(), &distances, 1e-13);
}

/// Two masses with springs: wall, k1 = 100, m1 = 2, k2 = 40, m2 = 1. The second mass slides on the first one,
/// so that the second spring acts on its joint.
#[mechanism]
struct TwoMasses {
    #[body(mass = 2)]
    first: Body,
    #[body(mass = 1)]
    second: Body,
    #[joint(ground -> first, along = x)]
    rail: Sleeve,
    #[joint(first -> second, along = x)]
    slide: Sleeve,
    #[acts(on = rail, stiffness = 100, free_length = 0.3)]
    anchor: Spring,
    #[acts(on = slide, stiffness = 40, free_length = 0.2)]
    coil: Spring,
}

#[test]
fn two_masses_have_their_natural_frequencies() {
    let at_rest = Vector2::new(0.3, 0.2);
    let spring_force = |q: Vector2<f64>| TwoMasses {}.bias_forces(&(at_rest + q), &Vector2::zeros());
    assert_close("at rest", spring_force(Vector2::zeros()).as_slice(), &[0.0, 0.0], 1e-14);
    let stiffness = Matrix2::from_columns(&[spring_force(Vector2::x()), spring_force(Vector2::y())]);
    let factor = TwoMasses {}.mass_matrix(&at_rest).cholesky().expect("a positive mass matrix");
    let inverse = factor.l().try_inverse().expect("a regular factor");
    let mut squares = (inverse * stiffness * inverse.transpose()).symmetric_eigenvalues();
    squares.as_mut_slice().sort_by(f64::total_cmp);
    // 2 ω⁴ − 220 ω² + 4000 = 0
    let root = 16_400_f64.sqrt();
    assert_close("ω²", squares.as_slice(), &[(220.0 - root) / 4.0, (220.0 + root) / 4.0], 1e-13);
}

/// Rod on a table that an impulse hits at a given distance from its centre.
#[mechanism]
struct StruckRod {
    m: f64,
    l: f64,
    distance: f64,
    #[body(mass = m, inertia = rod(m, l, x))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    table: Planar,
    #[acts(on = rod.at(distance * x), along = y)]
    blow: Force,
}

/// Checks the centre of percussion: the rod starts to rotate about a point at `l² / (12 d)` on the other side
/// of its centre.
#[test]
fn struck_rod_rotates_about_the_centre_of_percussion() {
    let rod = StruckRod { m: 1.2, l: 0.9, distance: 0.25 };
    let start = rod.neutral();
    let change = rod.forward_dynamics(
        &start,
        &SVector::zeros(),
        &rod.generalized_forces(&start, &SVector::from([3.0])),
    );
    let turning_point = rod.l * rod.l / (12.0 * rod.distance);
    let expected = [0.0, 3.0 / rod.m, 3.0 / rod.m / turning_point];
    assert_close("change of velocity", change.as_slice(), &expected, 1e-14);
}

/// A rod falls flat at the speed `v` on a stop at its end, with the restitution e. The impulse is
/// `m v (1 + e) / 4`; afterwards the rod rotates at `1.5 (1 + e) v / l` and its centre falls at
/// `v (3 − e) / 4`.
#[test]
fn falling_rod_impacts_a_stop_by_closed_form() {
    let (m, l, speed, restitution) = (1.2, 0.9, 2.0, 0.6);
    let rod = StruckRod { m, l, distance: -l / 2.0 };
    let start = rod.neutral();
    let impulse = SVector::from([m * speed * (1.0 + restitution) / 4.0]);
    let change =
        rod.mass_matrix(&start).try_inverse().expect("mass") * rod.generalized_forces(&start, &impulse);
    let after = Vector3::new(0.0, -speed, 0.0) + change;
    let expected = [0.0, -speed * (3.0 - restitution) / 4.0, -1.5 * (1.0 + restitution) * speed / l];
    assert_close("after", after.as_slice(), &expected, 1e-14);
    let end = after[1] - after[2] * l / 2.0;
    assert_close("restitution", &[end], &[speed * restitution], 1e-14);
}

/// Nut that slides down a fixed screw as it rotates.
#[mechanism(gravity = -9.81 * z)]
struct Nut {
    m: f64,
    j: f64,
    p: f64,
    #[body(mass = m, inertia = diagonal(j, j, j))]
    nut: Body,
    #[joint(ground -> nut, about = z, pitch = p)]
    thread: Screw,
}

/// The acceleration is `θ̈ = −m g p / (J + m p²)`.
#[test]
fn nut_on_a_screw_has_the_closed_form_acceleration() {
    let nut = Nut { m: 0.8, j: 0.002, p: 0.01 };
    let acceleration = -nut.m * 9.81 * nut.p / (nut.j + nut.m * nut.p * nut.p);
    let (q, v) = state_after_duration(&nut, &SVector::from([1.0]), &SVector::from([3.0]), 0.5);
    let expected = [1.0 + 3.0 * 0.5 + acceleration * 0.125, 3.0 + acceleration * 0.5];
    assert_close("turn", &[q[0], v[0]], &expected, 1e-13);
    let height = nut.frame_placement(frame!(Nut, "nut"), &q).translation.vector.z;
    assert_close("height", &[height], &[nut.p * expected[0]], 1e-13);
}
