//! Motions whose slip stops within a step, with closed-form solutions for random parameters.
//!
//! A step does not locate the instant at which slip stops. The velocity after it is exact, because the
//! impulse of friction follows from the velocity that it stops. With the deceleration `a`, the position is
//! off by at most `a h² / 8`: a trapezoid takes the place of a parabola that ends within the step.

use super::lasting::{BlockOnSlope, SlidingBox, WheelOnIncline};
use super::laws::Random;
use linkwork::prelude::*;

const GRAVITY: f64 = 9.81;

/// Largest error of a position that a stop within a step explains, as a multiple of `a h²`.
const STOP: f64 = 0.125 + 1e-6;

/// Uniform ball of 1 kg on a level floor.
#[mechanism(gravity = -9.81 * z)]
struct BowlingBallOnLane {
    friction: f64,
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.1), ground.plane(z), friction = friction)]
    floor: Contact,
}

/// Returns a random number between two bounds.
fn number_between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * (random.next() + 1.0) / 2.0
}

/// Calls `check` ten times for each step size and kind of step, with a random generator, the step size and
/// the method.
fn check_with_all_step_methods(seed: u64, check: impl Fn(&mut Random, f64, TimeStepping<f64>)) {
    let mut random = Random(seed);
    for h in [8e-3, 4e-3, 2e-3, 1e-3] {
        for _ in 0..10 {
            let method = TimeStepping::step(h);
            for method in [method, method.midpoint(), method.leapfrog()] {
                check(&mut random, h, method);
            }
        }
    }
}

/// Returns a slope, a coefficient of friction above its tangent, a speed downhill, and the deceleration.
fn random_slope_and_stopping_motion(random: &mut Random) -> [f64; 4] {
    let slope = number_between(random, 0.0, 0.3);
    let friction = slope.tan() + number_between(random, 0.05, 0.8);
    let deceleration = GRAVITY * (friction * slope.cos() - slope.sin());
    [slope, friction, number_between(random, 0.1, 1.5), deceleration]
}

#[test]
fn particle_on_a_slope_stops_where_its_kinetic_energy_is_dissipated() {
    check_with_all_step_methods(1, |random, h, method| {
        let [slope, friction, speed, a] = random_slope_and_stopping_motion(random);
        let m = BlockOnSlope { slope, friction };
        let run = simulate(&m).from([0.0; 3], [speed, 0.0, 0.0]).method(method);
        let end = run.duration(speed / a + 0.1).finish().unwrap();
        let error = (end.q[0] - speed * speed / (2.0 * a)).abs() + end.q[1].abs() + end.q[2].abs();
        assert!(error < STOP * a * h * h, "{slope} {friction} {speed} {h}: {error:e}");
        assert!(end.v.norm() < 1e-14, "{slope} {friction} {speed} {h}: {}", end.v);
    });
}

#[test]
fn box_on_a_slope_stops_where_its_kinetic_energy_is_dissipated() {
    check_with_all_step_methods(2, |random, h, method| {
        let [slope, friction, speed, a] = random_slope_and_stopping_motion(random);
        let yaw = 3.0 * random.next();
        let m = SlidingBox { slope, friction };
        let ((half_sine, half_cosine), (sine, cosine)) = ((yaw / 2.0).sin_cos(), yaw.sin_cos());
        let v = [speed * cosine, -speed * sine, 0.0, 0.0, 0.0, 0.0];
        let run = simulate(&m).from([0.0, 0.0, 0.05, 0.0, 0.0, half_sine, half_cosine], v).method(method);
        let end = run.duration(speed / a + 0.1).finish().unwrap();
        let rotation = (end.q[5] - half_sine).abs();
        let error = (end.q[0] - speed * speed / (2.0 * a)).hypot(end.q[1]) + rotation;
        assert!(error < STOP * a * h * h, "{slope} {friction} {speed} {yaw} {h}: {error:e}");
        assert!(end.v.norm() < 1e-13, "{slope} {friction} {speed} {yaw} {h}: {}", end.v);
    });
}

/// Friction at the four corners of a box that spins about the vertical has the moment `μ m g r`, where `r` is
/// half the diagonal.
#[test]
fn box_that_spins_on_the_floor_stops_where_its_kinetic_energy_is_dissipated() {
    check_with_all_step_methods(3, |random, h, method| {
        let (friction, spin) = (number_between(random, 0.05, 0.8), number_between(random, 1.0, 10.0));
        let squared_diagonal = 0.3 * 0.3 + 0.2 * 0.2_f64;
        let a = friction * GRAVITY * (squared_diagonal.sqrt() / 2.0) / (squared_diagonal / 12.0);
        let m = SlidingBox { slope: 0.0, friction };
        let start = [0.0, 0.0, 0.05, 0.0, 0.0, 0.0, 1.0];
        let run = simulate(&m).from(start, [0.0, 0.0, 0.0, 0.0, 0.0, spin]).method(method);
        let end = run.duration(spin / a + 0.1).finish().unwrap();
        let angle = 2.0 * end.q[5].atan2(end.q[6]) - spin * spin / (2.0 * a);
        let turns = (angle / std::f64::consts::TAU).round();
        let error = (angle - turns * std::f64::consts::TAU).abs() + end.q[0].hypot(end.q[1]);
        assert!(error < STOP * a * h * h, "{friction} {spin} {h}: {error:e}");
        assert!(end.v.norm() < 1e-13, "{friction} {spin} {h}: {}", end.v);
    });
}

/// A hoop slides until its contact point is at rest, and rolls from then on. The bound of the error counts
/// the accelerations before and after the transition.
#[test]
fn hoop_on_a_slope_begins_to_roll() {
    check_with_all_step_methods(4, |random, h, method| {
        let [slope, friction, ..] = random_slope_and_stopping_motion(random);
        let (radius, inertia) = (0.1, 0.01);
        let (speed, spin) = (1.5 * random.next(), 15.0 * random.next());
        let slip = speed + radius * spin;
        let force = -slip.signum() * friction * GRAVITY * slope.cos();
        let downhill = GRAVITY * slope.sin();
        let (sliding, rolling) = (downhill + force, downhill / (1.0 + inertia / (radius * radius)));
        let instant = -slip / (sliding + radius * (force * radius / inertia));
        let velocity = speed + sliding * instant;
        let position = speed * instant + sliding * instant * instant / 2.0;
        let m = WheelOnIncline { slope, friction, offset: 0.0 };
        let run = simulate(&m).from([0.0, radius, 0.0], [speed, 0.0, spin]).method(method);
        let end = run.duration(instant + 0.1).finish().unwrap();
        let error = (end.q[0] - position - velocity * 0.1 - rolling * 0.005).abs();
        let bound = STOP * (sliding.abs() + rolling.abs()) * h * h;
        assert!(error < bound, "{slope} {friction} {speed} {spin} {h}: {error:e} {bound:e}");
        let difference = (end.v[0] - velocity - rolling * 0.1).abs();
        assert!(difference < 1e-11, "{slope} {friction} {speed} {spin} {h}: {difference:e}");
    });
}

/// The slip of a uniform ball keeps its direction, and its velocity when it begins to roll is
/// `v − 2/7 (slip)`, whatever the coefficient of friction. Steps with four stages integrate the velocity in
/// the axes of the ball, which rotates by up to 0.2 rad in a step: their errors are larger.
#[test]
fn bowling_ball_begins_to_roll() {
    check_with_all_step_methods(5, |random, h, method| {
        let friction = number_between(random, 0.05, 0.8);
        let [vx, vy] = [0; 2].map(|_| 1.5 * random.next());
        let [wx, wy, wz] = [0; 3].map(|_| 15.0 * random.next());
        let slip = SVector::from([vx - 0.1 * wy, vy + 0.1 * wx]);
        let a = friction * GRAVITY;
        let direction = slip / slip.norm();
        let instant = slip.norm() / (3.5 * a);
        let velocity = SVector::from([vx, vy]) - slip / 3.5;
        let position = SVector::from([vx, vy]) * instant - direction * (a * instant * instant / 2.0);
        let m = BowlingBallOnLane { friction };
        let start = [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0];
        let run = simulate(&m).from(start, [vx, vy, 0.0, wx, wy, wz]).method(method);
        let end = run.duration(instant + 0.1).finish().unwrap();
        let error = (end.q.fixed_rows::<2>(0) - position - velocity * 0.1).norm();
        let factor = if method == TimeStepping::step(h) { 20.0 } else { STOP };
        assert!(error < factor * a * h * h, "{friction} {vx} {vy} {wx} {wy} {wz} {h}: {error:e}");
    });
}
