//! Mechanisms driven as functions of time, and bases with a prescribed motion.

use super::{EXACT, MOTION};
use linkwork::nalgebra::{Vector1, Vector2, Vector3};
use linkwork::{frame, mechanism, simulate};
use linkwork_models::KapitzaPendulum;
use std::f64::consts::PI;
use support::compare::assert_close;
use support::simulate::{state_after_duration, state_after_duration_from};

/// Checks Kapitza's pendulum with a vibrating pivot: `m l² θ̈ + m l (g + ÿ) sin θ = 0`. The upper equilibrium
/// is stable if `a² γ² > 2 g l` (Landau and Lifshitz, *Mechanics*, §§ 5 and 30).
#[test]
fn kapitza_pendulum_is_stable_upright() {
    let (g, m, l, amplitude, speed) = (9.81, 0.3, 0.5, 0.04, 160.0);
    let pendulum = KapitzaPendulum { g, mass: m, length: l, amplitude, frequency: speed };
    let (q, v) = (Vector1::new(0.9_f64), Vector1::new(2.0));
    for t in [0.0, 0.013, 0.05] {
        let pivot = -amplitude * speed * speed * (speed * t).cos();
        let bias = m * l * (g + pivot) * q[0].sin();
        assert_close("mass", pendulum.mass_matrix(t, &q).as_slice(), &[m * l * l], EXACT);
        assert_close("bias", pendulum.bias_forces(t, &q, &v).as_slice(), &[bias], EXACT);
        let point = pendulum.frame_placement(frame!(KapitzaPendulum, "pivot"), t, &q).translation.vector;
        assert_close("pivot", point.as_slice(), &[0.0, amplitude * (speed * t).cos(), 0.0], EXACT);
    }
    let swings = simulate(&pendulum).from([PI - 0.2], [0.0]).duration(2.0).sample_every(0.01);
    for sample in swings {
        let sample = sample.expect("the integrator arrives");
        assert!((sample.q[0] - PI).abs() < 0.4, "the pendulum stays up: {} at {} s", sample.q[0], sample.t);
    }
    let still = KapitzaPendulum { amplitude: 0.0, ..pendulum };
    let end = simulate(&still).from([PI - 0.2], [0.0]).until(|_, q, _| q[0]).duration(2.0).finish();
    assert!(end.expect("the integrator arrives").t < 2.0, "without it the pendulum falls");
}

#[mechanism(gravity = -g * y)]
struct PendulumOnCrank {
    g: f64,
    m: f64,
    l: f64,
    radius: f64,
    speed: f64,
    #[frame(ground, z(speed * t))]
    crank: Frame,
    #[point(at = radius * crank.x)]
    pivot: Point,
    #[body]
    rod: Body,
    #[particle(mass = m, at = rod.at(-l * y))]
    bob: Particle,
    #[joint(pivot -> rod, about = z)]
    pin: Pin,
}

/// Checks a pendulum on a rotating crank (Landau and Lifshitz, *Mechanics*, § 5, problem 3 a). The axes of
/// the pivot are those of the ground, so that the angle is measured from the vertical although the crank
/// rotates.
#[test]
fn pendulum_on_rotating_crank_has_the_textbook_equation() {
    let (g, m, l, radius, speed) = (9.81, 0.3, 0.5, 0.2, 3.0);
    let crank = PendulumOnCrank { g, m, l, radius, speed };
    let (q, v) = (Vector1::new(0.9_f64), Vector1::new(2.0));
    for t in [0.0, 0.4, 1.3] {
        let bias = m * l * (g * q[0].sin() - radius * speed * speed * (q[0] - speed * t).cos());
        assert_close("mass", crank.mass_matrix(t, &q).as_slice(), &[m * l * l], EXACT);
        assert_close("bias", crank.bias_forces(t, &q, &v).as_slice(), &[bias], EXACT);
        let (sin, cos) = (speed * t).sin_cos();
        let velocity = Vector2::new(
            -radius * speed * sin + l * v[0] * q[0].cos(),
            radius * speed * cos + l * v[0] * q[0].sin(),
        );
        assert_close(
            "energy",
            &[crank.kinetic_energy(t, &q, &v)],
            &[m / 2.0 * velocity.norm_squared()],
            EXACT,
        );
    }
}

#[mechanism]
struct Turntable {
    m: f64,
    k: f64,
    spin: f64,
    east: Coordinate,
    north: Coordinate,
    #[frame(ground, z(spin * t))]
    table: Frame,
    #[particle(mass = m, at = east * table.x + north * table.y)]
    bob: Particle,
    #[acts(between = (ground, bob), stiffness = k)]
    spring: Spring,
    #[output(v(bob / ground / table), resolved_in = table)]
    seen: Vector,
    #[output(a(bob / ground / table), resolved_in = table)]
    seen_acceleration: Vector,
    #[output(a(bob / ground / ground), resolved_in = table)]
    acceleration: Vector,
    #[output(v(bob / ground / ground), resolved_in = table)]
    velocity: Vector,
}

/// Checks an oscillator on a rotating table, as Foucault's pendulum at the pole. Coriolis and centrifugal
/// forces appear in the rotating frame; in the ground frame the plane of oscillation is constant.
#[test]
fn foucault_pendulum_precesses_at_the_pole() {
    let (m, k, spin) = (1.4, 20.0, 0.7);
    let table = Turntable { m, k, spin };
    let (t, q, v) = (0.6, Vector2::new(0.4, -0.3), Vector2::new(1.1, 0.5));
    let a = Vector2::new(-0.8, 2.0);
    let up = Vector3::z() * spin;
    let horizontal_vector = |v: &Vector2<f64>| Vector3::new(v[0], v[1], 0.0);
    assert_close("v seen", table.seen(t, &q, &v).as_slice(), horizontal_vector(&v).as_slice(), EXACT);
    let seen = table.seen_acceleration(t, &q, &v, &a);
    assert_close("a seen", seen.as_slice(), horizontal_vector(&a).as_slice(), EXACT);
    let whole = horizontal_vector(&a)
        + up.cross(&horizontal_vector(&v)) * 2.0
        + up.cross(&up.cross(&horizontal_vector(&q)));
    assert_close("a", table.acceleration(t, &q, &v, &a).as_slice(), whole.as_slice(), EXACT);
    let velocity = horizontal_vector(&v) + up.cross(&horizontal_vector(&q));
    assert_close("v", table.velocity(t, &q, &v).as_slice(), velocity.as_slice(), EXACT);
    let bias = (up.cross(&horizontal_vector(&v)) * 2.0 + up.cross(&up.cross(&horizontal_vector(&q)))) * m
        + horizontal_vector(&q) * k;
    assert_close("bias", table.bias_forces(t, &q, &v).as_slice(), &[bias.x, bias.y], EXACT);

    // Released at rest relative to the ground, the particle oscillates along one line of the ground frame.
    let (q0, v0) = (Vector2::new(0.5, 0.0), Vector2::new(0.0, -spin * 0.5));
    let end = 7.0;
    let (q, _) = state_after_duration(&table, &q0, &v0, end);
    let swing = 0.5 * ((k / m).sqrt() * end).cos();
    let (sin, cos) = (spin * end).sin_cos();
    assert_close("plane", q.as_slice(), &[swing * cos, -swing * sin], MOTION);
}

#[mechanism]
struct ForcedOscillator {
    m: f64,
    k: f64,
    f: f64,
    speed: f64,
    #[body(mass = m)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, stiffness = k)]
    spring: Spring,
    #[acts(on = rail, value = f * cos(speed * t))]
    drive: Force,
}

#[test]
fn forced_oscillator_has_the_closed_form_response() {
    let (m, k, f, speed) = (2.0, 18.0, 3.0, 2.0);
    let cart = ForcedOscillator { m, k, f, speed };
    let amplitude = f / (k - m * speed * speed);
    let (q, v) = state_after_duration(&cart, &Vector1::new(amplitude), &Vector1::zeros(), 4.0);
    let expected = [amplitude * (speed * 4.0).cos(), -amplitude * speed * (speed * 4.0).sin()];
    assert_close("steady state", &[q[0], v[0]], &expected, MOTION);
    // A run may start at any time.
    let (later, _) = state_after_duration_from(
        &cart,
        1.5,
        &Vector1::new(amplitude * (speed * 1.5).cos()),
        &Vector1::new(-amplitude * speed * (speed * 1.5).sin()),
        2.5,
    );
    assert_close("from another time", &[later[0]], &expected[..1], MOTION);
}

/// Pendulum on a base with a prescribed vertical oscillation and a constant tilt (a quaternion), which the
/// pendulum does not affect.
#[mechanism(gravity = -g * y)]
struct PendulumOnShakenBase {
    g: f64,
    m: f64,
    l: f64,
    amplitude: f64,
    speed: f64,
    #[frame(ground, quaternion(0, 0, 0.6, 0.8))]
    tilted: Frame,
    #[body(massive, at = amplitude * cos(speed * t) * y, frame = tilted)]
    base: Body,
    #[body]
    rod: Body,
    #[particle(mass = m, at = rod.at(-l * y))]
    bob: Particle,
    #[joint(base -> rod, about = z)]
    pin: Pin,
}

/// The base's acceleration acts as a change of gravity (Landau and Lifshitz, *Mechanics*, § 5, problem 3 c).
#[test]
fn accelerated_base_acts_like_gravity() {
    let (g, m, l, amplitude, speed) = (9.81, 0.3, 0.5, 0.02, 30.0);
    let base = PendulumOnShakenBase { g, m, l, amplitude, speed };
    let tilt = 2.0 * 0.6_f64.atan2(0.8);
    for (t, angle) in [(0.0, 0.4), (0.013, -1.1), (0.2, 2.0)] {
        let (q, v) = (Vector1::new(angle), Vector1::new(1.3));
        let lift = -amplitude * speed * speed * (speed * t).cos();
        let bias = m * l * (g + lift) * (angle + tilt).sin();
        assert_close("mass", base.mass_matrix(t, &q).as_slice(), &[m * l * l], EXACT);
        assert_close("bias", base.bias_forces(t, &q, &v).as_slice(), &[bias], EXACT);
    }
}
