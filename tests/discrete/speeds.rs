//! Jacobians of steps of mechanisms with declared generalized speeds, also under constraints, against
//! differences of steps.

use super::check_jacobians_at_random_states;
use super::implicit::check_constrained_step_jacobians;
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use support::random::Random;

/// Body on Cardan angles with a slider. The generalized speeds are the angular velocity in body axes.
#[mechanism(gravity = -9.81 * z, momentum_derivatives)]
struct Gimbal {
    #[body(mass = 0, inertia = 0)]
    first: Body,
    #[body(mass = 0, inertia = 0)]
    second: Body,
    #[body(mass = 2, com = 0.3 * z, inertia = diagonal(0.2, 0.3, 0.45))]
    top: Body,
    #[joint(ground -> first, about = z)]
    psi: Pin,
    #[joint(first -> second, about = y)]
    theta: Pin,
    #[joint(second -> top, about = x)]
    phi: Pin,
    #[particle(mass = 0.3)]
    bead: Particle,
    #[joint(top.at(0.1 * x) -> bead, along = z)]
    rail: Sleeve,
    #[acts(on = rail, stiffness = 40)]
    spring: Spring,
    #[acts(on = rail, damping = 0.3)]
    dashpot: Dashpot,
    #[acts(on = phi)]
    motor: Torque,
    #[speed(dot(omega(top / ground), top.x))]
    wx: Speed,
    #[speed(dot(omega(top / ground), top.y))]
    wy: Speed,
    #[speed(dot(omega(top / ground), top.z))]
    wz: Speed,
}

ballbot! {
    /// Ball that rolls on a tilted plane. The generalized speeds are the velocity of its centre in ground
    /// axes.
    struct Ballbot {
        #[speed(dot(v(shell / ground / ground), x))]
        ux: Speed,
        #[speed(dot(v(shell / ground / ground), y))]
        uy: Speed,
        #[speed(dot(v(shell / ground / ground), z))]
        uz: Speed,
        #[speed(dot(omega(shell / ground), x))]
        wx: Speed,
        #[speed(dot(omega(shell / ground), y))]
        wy: Speed,
        #[speed(dot(omega(shell / ground), z))]
        wz: Speed,
    }
}

/// Two arms whose ends are connected by a rod of time-dependent length: a spatial loop.
#[mechanism(gravity = -9.81 * z, momentum_derivatives)]
struct ArmsLinkedByRod {
    span: f64,
    rate: f64,
    #[body(mass = 0.8, com = 0.3 * x, inertia = diagonal(0.01, 0.05, 0.06))]
    left: Body,
    #[body(mass = 1.1, com = -0.4 * x + 0.1 * y, inertia = diagonal(0.03, 0.05, 0.05))]
    right: Body,
    #[joint(ground -> left)]
    shoulder: Ball,
    #[joint(ground.at(span * x) -> right, about = (y, z))]
    other: Universal,
    #[constraint(norm(r(right.at(-0.8 * x) / left.at(0.7 * x))) = span - 1.4 + 0.05 * sin(rate * t))]
    rod: Holonomic,
    #[acts(on = other.first)]
    motor: Torque,
    #[speed(dot(omega(left / ground), x))]
    wx: Speed,
    #[speed(dot(omega(left / ground), y))]
    wy: Speed,
    #[speed(dot(omega(left / ground), z))]
    wz: Speed,
    #[speed(rate(other.first) * cos(other.second))]
    swing: Speed,
}

/// Spatial loop of four pins. The generalized speeds are the angular velocities of its bars and the velocity
/// of one of their ends along the bar.
#[mechanism(gravity = -9.81 * y, momentum_derivatives)]
struct FourBar {
    base: f64,
    mass: f64,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    crank: Body,
    #[body(mass = mass, com = x, inertia = rod(mass, 2, x))]
    coupler: Body,
    #[body(mass = 1.5, com = 0.75 * x, inertia = rod(1.5, 1.5, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    first: Pin,
    #[joint(crank.at(0.9 * x) -> coupler, about = z)]
    second: Pin,
    #[joint(ground.at(base * x) -> rocker, about = z)]
    third: Pin,
    #[joint(rocker.at(1.5 * x) -> coupler.at(2 * x), about = z)]
    closing: Pin,
    #[acts(on = first)]
    motor: Torque,
    #[speed(dot(v(coupler.at(2 * x) / ground / ground), coupler.y))]
    across: Speed,
    #[speed(dot(omega(coupler / ground), z))]
    turn: Speed,
}

#[test]
fn step_jacobians_in_speeds_agree_with_differences() {
    check_jacobians_at_random_states("gimbal, Rk4", &Gimbal {}, &Rk4::step(0.02), 1.0, 1.0);
    check_jacobians_at_random_states("gimbal, Euler", &Gimbal {}, &SemiImplicitEuler::step(0.02), 1.0, 1.0);
    check_jacobians_at_random_states("gimbal, midpoint", &Gimbal {}, &ImplicitMidpoint::step(0.02), 1.0, 1.0);
}

#[test]
fn constrained_step_jacobians_in_speeds_agree_with_differences() {
    let mut random = Random::new(23);
    for k in 0..2 {
        let mut near = |x: f64| x * (1.0 + random.uniform_number(0.15));
        let bars = FourBar { base: near(1.8), mass: near(2.0) };
        let arms = ArmsLinkedByRod { span: near(1.9), rate: near(5.0) };
        let ball = Ballbot { radius: near(0.3), mass: near(1.0) };
        let closed = bars.assemble(&[0.9, -0.5, 1.4].into(), &[0]).expect("it can be assembled");
        check_constrained_step_jacobians(&format!("four bars, {k}"), &bars, &mut random, &closed);
        let bent = arms.integrate(&linkwork::Mechanism::neutral(&arms), &[0.1, 0.1, 0.4, 0.1, -0.1].into());
        check_constrained_step_jacobians(&format!("arms, {k}"), &arms, &mut random, &bent);
        let mut lifted: SVector<f64, 8> = Mechanism::neutral(&ball);
        lifted[2] = ball.radius;
        check_constrained_step_jacobians(&format!("ball, {k}"), &ball, &mut random, &lifted);
    }
}
