//! Tests of particles in user-defined coordinates.

use super::{EXACT, MOTION};
use linkwork::mechanism;
use linkwork::nalgebra::{Vector1, Vector2};
use support::compare::assert_close;
use support::simulate::state_after_duration;
use support::table::Record;

#[mechanism(gravity = -g * y)]
struct ElasticPendulum {
    g: f64,
    m: f64,
    k: f64,
    l: f64,
    theta: Coordinate,
    reach: Coordinate,
    #[particle(mass = m, at = reach * (sin(theta) * x - cos(theta) * y))]
    bob: Particle,
    #[acts(between = (ground, bob), stiffness = k, free_length = l)]
    spring: Spring,
}

/// The equations of motion are `r̈ = r θ̇² + g cos θ − (k / m) (r − l)`, `θ̈ = −(g sin θ + 2 ṙ θ̇) / r`.
#[test]
fn elastic_pendulum_has_the_textbook_equations() {
    let (g, m, k, l) = (9.81, 0.8, 60.0, 0.7);
    let pendulum = ElasticPendulum { g, m, k, l };
    let (q, v) = (Vector2::new(0.5, 0.9), Vector2::new(1.2, -0.4));
    let acceleration = pendulum.forward_dynamics(&q, &v, &Vector2::zeros());
    let expected = [
        -(g * q[0].sin() + 2.0 * v[1] * v[0]) / q[1],
        q[1] * v[0] * v[0] + g * q[0].cos() - k / m * (q[1] - l),
    ];
    assert_close("acceleration", acceleration.as_slice(), &expected, EXACT);
}

#[mechanism(gravity = -g * y)]
struct BeadOnParabola {
    g: f64,
    m: f64,
    p: f64,
    s: Coordinate,
    #[particle(mass = m, at = s * x + s * s / (2 * p) * y)]
    bead: Particle,
}

#[mechanism(gravity = -g * z)]
struct BeadOnHelix {
    g: f64,
    m: f64,
    radius: f64,
    rise: f64,
    turn: Coordinate,
    #[particle(mass = m, at = radius * (cos(turn) * x + sin(turn) * y) + rise * turn * z)]
    bead: Particle,
}

#[test]
fn beads_on_wires_have_closed_forms() {
    let (g, m, p) = (9.81, 0.4, 0.6);
    let wire = BeadOnParabola { g, m, p };
    let (s, v) = (0.7, 1.3);
    let (at, moving) = (Vector1::new(s), Vector1::new(v));
    assert_close("mass", wire.mass_matrix(&at).as_slice(), &[m * (1.0 + s * s / (p * p))], EXACT);
    let bias = m * s * v * v / (p * p) + m * g * s / p;
    assert_close("bias", wire.bias_forces(&at, &moving).as_slice(), &[bias], EXACT);

    let (radius, rise) = (0.3, 0.2);
    let spring = BeadOnHelix { g, m, radius, rise };
    let inertia = m * (radius * radius + rise * rise);
    assert_close("mass", spring.mass_matrix(&at).as_slice(), &[inertia], EXACT);
    assert_close("bias", spring.bias_forces(&at, &moving).as_slice(), &[m * g * rise], EXACT);
}

#[mechanism(gravity = -9.81 * z)]
struct SphericalByUniversal {
    #[body]
    rod: Body,
    #[particle(mass = 0.5, at = rod.at(-0.8 * z))]
    bob: Particle,
    #[joint(ground -> rod, about = (x, y))]
    gimbal: Universal,
    #[output(r(bob / ground))]
    place: Vector,
}

#[mechanism(gravity = -9.81 * z)]
struct SphericalByAngles {
    theta: Coordinate,
    phi: Coordinate,
    #[particle(
        mass = 0.5, at = 0.8 * (sin(theta) * cos(phi) * x + sin(theta) * sin(phi) * y - cos(theta) * z)
    )]
    bob: Particle,
    #[output(r(bob / ground))]
    place: Vector,
}

#[test]
fn spherical_pendulum_agrees_in_two_coordinate_charts() {
    let (one, other) = (SphericalByUniversal {}, SphericalByAngles {});
    let (q, v) = (Vector2::new(0.7, 0.4), Vector2::new(-0.5, 1.1));
    let (place, moving) = (one.place(&q), one.place_jacobian(&q) * v);
    let angles = Vector2::new((-place.z / 0.8).acos(), place.y.atan2(place.x));
    let jacobian = other.place_jacobian(&angles);
    let rates = Vector2::from_fn(|k, _| jacobian.column(k).dot(&moving) / jacobian.column(k).norm_squared());
    assert_close("velocity", (jacobian * rates).as_slice(), moving.as_slice(), EXACT);
    let sum_of_energies = |t: f64, u: f64| t + u;
    assert_close(
        "energy",
        &[sum_of_energies(one.kinetic_energy(&q, &v), one.potential_energy(&q))],
        &[sum_of_energies(other.kinetic_energy(&angles, &rates), other.potential_energy(&angles))],
        EXACT,
    );
    let (end, _) = state_after_duration(&one, &q, &v, 5.0);
    let (end_angles, _) = state_after_duration(&other, &angles, &rates, 5.0);
    assert_close("place", one.place(&end).as_slice(), other.place(&end_angles).as_slice(), MOTION);
}

/// Two particles whose coordinates are angles from the vertical. The lower one is placed relative to the
/// upper one, as in a double pendulum.
#[mechanism(gravity = -9.81 * y)]
struct DoublePendulumByAngles {
    first: Coordinate,
    second: Coordinate,
    #[particle(mass = 1, at = sin(first) * x - cos(first) * y)]
    upper: Particle,
    #[particle(mass = 1, at = upper.at(sin(second) * x - cos(second) * y))]
    lower: Particle,
}

#[mechanism(gravity = -9.81 * y)]
struct DoublePendulumByPins {
    #[body]
    upper_rod: Body,
    #[body]
    lower_rod: Body,
    #[particle(mass = 1, at = upper_rod.at(-1 * y))]
    upper: Particle,
    #[particle(mass = 1, at = lower_rod.at(-1 * y))]
    lower: Particle,
    #[joint(ground -> upper_rod, about = z)]
    shoulder: Pin,
    #[joint(upper_rod.at(-1 * y) -> lower_rod, about = z)]
    elbow: Pin,
}

#[test]
fn double_pendulum_agrees_in_absolute_and_relative_angles() {
    let (absolute, relative) = (DoublePendulumByAngles {}, DoublePendulumByPins {});
    let to_relative_angles = |a: &Vector2<f64>| Vector2::new(a[0], a[1] - a[0]);
    let (q, v) = (Vector2::new(0.8, -0.5), Vector2::new(0.3, 1.7));
    let (p, w) = (to_relative_angles(&q), to_relative_angles(&v));
    let energies = [absolute.kinetic_energy(&q, &v), absolute.potential_energy(&q)];
    assert_close(
        "energies",
        &energies,
        &[relative.kinetic_energy(&p, &w), relative.potential_energy(&p)],
        EXACT,
    );
    let (end, rates) = state_after_duration(&absolute, &q, &v, 3.0);
    let (end_relative, rates_relative) = state_after_duration(&relative, &p, &w, 3.0);
    assert_close("angles", to_relative_angles(&end).as_slice(), end_relative.as_slice(), MOTION);
    assert_close("rates", to_relative_angles(&rates).as_slice(), rates_relative.as_slice(), MOTION);

    let rows = Record::load("problems/pendulums.json").rows_with_key::<5>("double");
    let [_, a1, a2, r1, r2] = rows[0];
    let [t, expected @ ..] = rows[1];
    let (q, v) = state_after_duration(&absolute, &Vector2::new(a1, a2), &Vector2::new(r1, r2), t);
    assert_close("reference", &[q[0], q[1], v[0], v[1]], &expected, 1e-11);
}
