//! Program without the standard library, without an allocator and without panics. It has a computed-torque
//! controller with its seven-axis arm, a body in flight with every integrator, an engine with a closed loop,
//! a sledge that collides with the ground and comes to rest, a long chain, and two stones that fall on each
//! other. The panic handler calls a function that does not exist, so that a program with a remaining panic
//! cannot be linked.

#![no_std]
#![no_main]

mod chain;
mod handler;
mod stones;

use core::hint::black_box;
use linkwork::batch::{Rollout, unwatched};
use linkwork::frame;
use linkwork::prelude::*;

#[mechanism(
    urdf = "../../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"], batch,
    derivatives
)]
struct Arm;

type Joints = SVector<f64, { Arm::NV }>;

/// Returns torques that move the arm from `q`, `v` towards `target`.
fn control_torques(q: &Joints, v: &Joints, target: &Joints) -> Joints {
    let acceleration = (target - q) * 25.0 - v * 10.0;
    Arm.inverse_dynamics(q, v, &acceleration)
}

/// Returns the state of the arm after one step of a millisecond.
fn arm_step(q: &Joints, v: &Joints, u: &Joints) -> (Joints, Joints) {
    let v = v + Arm.forward_dynamics(q, v, &Arm.generalized_forces(q, u)) * 1e-3;
    (Arm.integrate(q, &(v * 1e-3)), v)
}

/// Whether the generated functions of the arm are consistent with each other.
fn is_consistent(q: &Joints, v: &Joints, a: &Joints) -> bool {
    let mass_matrix = Arm.mass_matrix(q);
    let forces = mass_matrix * a + Arm.bias_forces(q, v);
    let kinetic = v.dot(&(mass_matrix * v)) / 2.0;
    let tool = frame!(Arm, "panda_hand_tcp");
    let velocity = Arm.frame_jacobian(tool, q) * v;
    let height = Arm.frame_placement(tool, q).translation.vector.z + Arm.center_of_mass(q).z;
    let (by_q, by_v, inverse) = Arm.forward_dynamics_derivatives(q, v, &forces);
    let (tau_by_q, tau_by_v) = Arm.inverse_dynamics_derivatives(q, v, a);
    (forces - Arm.inverse_dynamics(q, v, a)).norm() < 1e-9
        && (kinetic - Arm.kinetic_energy(q, v)).abs() < 1e-9
        && (velocity - Arm.frame_velocity(tool, q, v)).norm() < 1e-9
        && (inverse * forces - inverse * Arm.bias_forces(q, v) - a).norm() < 1e-6
        && (mass_matrix * (by_q * v) + tau_by_q * v).norm() < 1e-6
        && (mass_matrix * (by_v * v) + tau_by_v * v).norm() < 1e-6
        && (Arm.generalized_momentum(q, v) - mass_matrix * v).norm() < 1e-9
        && Arm.momentum(q, v).norm() + Arm.momentum_rate(q, v).norm() + height + Arm.potential_energy(q) < 1e9
}

/// Whether several arms in SIMD lanes move in the same way as a single arm.
fn side_by_side(q: &Joints, v: &Joints) -> bool {
    const COUNT: usize = 5;
    let (mut qs, mut vs) = ([0.0; 7 * COUNT], [0.0; 7 * COUNT]);
    let columns = qs.chunks_exact_mut(COUNT).zip(vs.chunks_exact_mut(COUNT));
    for ((qs, vs), (q, v)) in columns.zip(q.iter().zip(v)) {
        qs.fill(*q);
        vs.fill(*v);
    }
    let rollout = Rollout::new(Rk4::step(1e-3), 2);
    let damping_force = |_, _, _: &_, v: &SVector<f64x4, 7>| *v * Lanes::splat(-1.0);
    let done = Arm.lanes::<4>().roll_out(&rollout, &mut qs, &mut vs, damping_force, unwatched);
    let damping_inputs = |_, _: &Joints, v: &Joints| -v;
    let Ok(one) =
        simulate(&Arm).from(*q, *v).inputs(damping_inputs).method(Rk4::step(1e-3)).duration(2e-3).finish()
    else {
        return false;
    };
    let is_same_in_all_lanes = |(numbers, x): (&[f64], &f64)| numbers.iter().all(|y| (x - y).abs() < 1e-12);
    done.is_ok() && qs.chunks_exact(COUNT).zip(one.q.iter()).all(is_same_in_all_lanes)
}

/// Body in the air with a pendulum on a ball joint.
#[mechanism(gravity = -9.81 * z)]
struct Flight {
    mass: f64,
    #[body(mass = 2, inertia = diagonal(0.1, 0.2, 0.25))]
    hull: Body,
    #[body(mass = mass, com = -0.2 * z, inertia = cylinder(mass, 0.05, 0.4, z))]
    pendulum: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[joint(hull.at(-0.1 * z) -> pendulum)]
    hanger: Ball,
    #[acts(on = hull.at(0.3 * x), along = z)]
    thruster: Force,
}

/// Whether all integrators compute the same flight of a body.
fn integrators_agree_on_flight(mass: f64) -> bool {
    let flight = Flight { mass };
    let v = SVector::from([1.0, 0.0, 3.0, 0.1, 0.2, 0.3, -0.5, 0.4, 0.3]);
    let simulate_flight = || simulate(&flight).from(flight.neutral(), v).duration(0.1);
    let simulate_with_control = || simulate_flight().control_every(0.03, |t, _, _| SVector::from([t]));
    let (Ok(precise), Ok(driven)) = (simulate_flight().finish(), simulate_with_control().finish()) else {
        return false;
    };
    let fixed = [
        simulate_flight().method(Rk4::step(1e-3)).finish(),
        simulate_flight().method(ImplicitMidpoint::step(1e-3)).finish(),
        simulate_flight().method(SemiImplicitEuler::step(1e-3)).finish(),
    ];
    let is_close_to_precise = |end: &_| match end {
        Ok(Sample { q, .. }) => flight.difference(&precise.q, q).norm() < 1e-2,
        Err(_) => false,
    };
    driven.t == precise.t && fixed.iter().all(is_close_to_precise)
}

/// Engine: crank, rod and piston in a closed loop.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct Engine {
    length: f64,
    #[body(mass = 2, com = 0.02 * x, inertia = rod(2, 0.04, x))]
    crank: Body,
    #[body(mass = 0.5, com = length / 2 * x, inertia = rod(0.5, length, x))]
    rod: Body,
    #[body(mass = 0.4)]
    piston: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(0.04 * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(ground -> piston, along = x)]
    cylinder: Sleeve,
    #[joint(rod.at(length * x) -> piston, about = z)]
    small_end: Pin,
    #[acts(on = main)]
    motor: Torque,
}

/// Whether the engine can be assembled and its loop stays closed.
fn keeps_loop_closed(length: f64) -> bool {
    let engine = Engine { length };
    let Ok(q) = engine.assemble(&[0.8, -1.0, 0.1].into(), &[0]) else { return false };
    let Ok(v) = engine.complete_velocity(&q, &[50.0, 0.0, 0.0].into(), &[0]) else { return false };
    let Ok(v) = engine.project_velocity(&q, &v) else { return false };
    let (a, lambda) = engine.constrained_dynamics(&q, &v, &engine.generalized_forces(&q, &[3.0].into()));
    let Ok(linear) = engine.linearize(&q, &v, &[3.0].into(), &[0]) else { return false };
    let run = simulate(&engine).from(q, v).inputs(|_, _, _| [3.0].into()).duration(0.1);
    let Ok(end) = run.finish() else { return false };
    let Ok(held) = engine.project_configuration(&end.q) else { return false };
    let consistent = (engine.constraint_jacobian(&q) * a + engine.constraint_bias(&q, &v)).norm() < 1e-9;
    let finite = lambda.norm() + linear.a.norm() + linear.b.norm() < 1e9;
    consistent && finite && (held - end.q).norm() < 1e-9
}

/// Sledge with contacts at the rear and front of its runners, with friction.
#[mechanism(gravity = -9.81 * y)]
struct Sledge {
    friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.4, 0.2, 0.1))]
    hull: Body,
    #[joint(ground -> hull, about = z)]
    pose: Planar,
    #[contact(hull.at(-0.2 * x - 0.1 * y), ground.plane(y), friction = friction, restitution = 0.3)]
    rear: Contact,
    #[contact(hull.at(0.2 * x - 0.1 * y), ground.plane(y), friction = friction, restitution = 0.3)]
    front: Contact,
}

/// Whether the sledge falls, slides and comes to rest, with time stepping and with located events.
fn comes_to_rest(friction: f64) -> bool {
    let sledge = Sledge { friction };
    let simulate_sledge = || simulate(&sledge).from([0.0, 0.15, 0.1], [0.5, 0.0, 0.0]).duration(2.0);
    let steps = simulate_sledge().method(TimeStepping::step(1e-3)).finish();
    let (Ok(steps), Ok(events)) = (steps, simulate_sledge().method(EventDriven::new()).finish()) else {
        return false;
    };
    let is_at_rest = |end: &Sample<f64, 3, 3, 0>| (end.q[1] - 0.1).abs() < 1e-7 && end.v.norm() < 1e-9;
    is_at_rest(&steps) && is_at_rest(&events) && (steps.q - events.q).norm() < 1e-2
}

#[unsafe(no_mangle)]
extern "C" fn main(_: i32, _: *const *const u8) -> i32 {
    let mut q: Joints = black_box(Joints::from([0.1, -0.5, 0.2, -1.9, 0.1, 1.5, 0.7]));
    let mut v: Joints = black_box(Joints::zeros());
    let target: Joints = black_box(Joints::from([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8]));
    let mut sound = true;
    let mut remaining = 3000;
    while remaining > 0 {
        let u = control_torques(&q, &v, &target);
        sound &= is_consistent(&q, &v, &u);
        (q, v) = arm_step(&q, &v, &u);
        remaining -= 1;
    }
    let arrived = (q - target).norm() < 1e-3;
    let alone = integrators_agree_on_flight(black_box(0.5))
        && keeps_loop_closed(black_box(0.13))
        && comes_to_rest(black_box(0.4))
        && chain::derivatives_agree_with_differences(black_box(0.7))
        && stones::upper_stone_comes_to_rest(black_box(0.5));
    i32::from(!(sound && arrived && side_by_side(&q, &v) && alone))
}
