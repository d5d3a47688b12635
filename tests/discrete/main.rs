//! Checks of single integration steps: their Jacobians against differences of steps and against the linear
//! system, and examples of their use.

use linkwork::discrete::{self, DifferentiableStep};
use linkwork::prelude::*;
use linkwork::{Derivatives, Frames, Mechanism, frame, index_of};
use support::differences::derivative_at_zero;
use support::random::Random;

/// Declares a ball that rolls on a tilted plane, with an input force and torque and a pendulum inside, and
/// with further fields.
macro_rules! ballbot {
    ($(# $attribute:tt)* struct $name:ident { $($field:tt)* }) => {
        $(# $attribute)*
        #[mechanism(gravity = -9.81 * z + 2 * x, momentum_derivatives)]
        struct $name {
            radius: f64,
            mass: f64,
            #[body(mass = 2, com = 0.03 * z, inertia = diagonal(0.01, 0.02, 0.015))]
            shell: Body,
            #[body(mass = mass, com = -radius / 2 * z, inertia = diagonal(0.004, 0.005, 0.001))]
            pendulum: Body,
            #[joint(ground -> shell)]
            flight: Free,
            #[joint(shell -> pendulum, about = unit(x + 0.3 * y))]
            hinge: Pin,
            #[constraint(rolls(shell.sphere(radius), ground.plane(unit(0.2 * x + z))))]
            contact: Rolling,
            #[acts(on = hinge)]
            motor: Torque,
            #[acts(on = shell.at(0.1 * x), along = shell.y)]
            push: Force,
            $($field)*
        }
    };
}

mod implicit;
mod speeds;

/// Flying body with four rotors, two of which also exert a drag torque, and a pendulum on a ball joint below.
#[mechanism(gravity = -9.81 * z, momentum_derivatives)]
struct RotorCraftWithPendulum {
    #[body(mass = 1.2, com = 0.02 * z, inertia = diagonal(0.01, 0.012, 0.02))]
    frame: Body,
    #[body(mass = 0.3, com = -0.4 * z + 0.05 * x, inertia = diagonal(0.004, 0.005, 0.001))]
    load: Body,
    #[joint(ground -> frame)]
    flight: Free,
    #[joint(frame.at(-0.05 * z) -> load)]
    hook: Ball,
    #[acts(on = frame.at(0.2 * x), along = frame.z)]
    front: Force,
    #[acts(on = frame.at(-0.2 * x + 0.1 * y), along = frame.z)]
    back: Force,
    #[acts(on = frame, about = frame.z)]
    drag: Torque,
}

/// Pendulum with a motor, on a pivot that is driven up and down.
#[mechanism(gravity = -9.81 * y, momentum_derivatives)]
struct PendulumOnDrivenPivot {
    rate: f64,
    #[point(at = 0.1 * sin(rate * t) * y)]
    pivot: Point,
    #[body(mass = 0.7, com = -0.3 * y, inertia = diagonal(0.01, 0.01, 0.02))]
    bob: Body,
    #[joint(pivot -> bob, about = z)]
    hinge: Pin,
    #[acts(on = hinge)]
    motor: Torque,
}

/// Panda arm without its fingers, so that all coordinates are joint angles.
#[mechanism(
    urdf = "../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"], derivatives
)]
struct Panda;

/// Closed loop whose derivatives include the constraint forces.
#[mechanism(gravity = -9.81 * y, momentum_derivatives)]
struct Linkage {
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    crank: Body,
    #[body(mass = 2, com = x, inertia = rod(2, 2, x))]
    coupler: Body,
    #[body(mass = 1.5, com = 0.75 * x, inertia = rod(1.5, 1.5, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    first: Pin,
    #[joint(crank.at(x) -> coupler, about = z)]
    second: Pin,
    #[joint(ground.at(1.8 * x) -> rocker, about = z)]
    third: Pin,
    #[joint(rocker.at(1.5 * x) -> coupler.at(2 * x), about = z)]
    closing: Pin,
    #[acts(on = first)]
    motor: Torque,
}

/// Returns a unit direction times `size` in the tangent space of displacements, changes of velocity and
/// changes of inputs: the component `k − first`, or zero.
fn unit_direction_times<const N: usize>(k: usize, first: usize, size: f64) -> SVector<f64, N> {
    SVector::from_fn(|i, _| if first + i == k { size } else { 0.0 })
}

/// Returns the derivatives of `f` along each direction of state and inputs, by central differences.
fn central_differences_along_directions<const NV: usize, const NU: usize, const R: usize>(
    f: impl Fn(&SVector<f64, NV>, &SVector<f64, NV>, &SVector<f64, NU>) -> SVector<f64, R>,
) -> Vec<SVector<f64, R>> {
    let value_along_direction = |k: usize, x: f64| {
        f(
            &unit_direction_times(k, 0, x),
            &unit_direction_times(k, NV, x),
            &unit_direction_times(k, 2 * NV, x),
        )
    };
    (0..2 * NV + NU).map(|k| derivative_at_zero(1e-3, |x| value_along_direction(k, x))).collect()
}

fn assert_concatenated_columns(what: &str, found: &[&[f64]], expected: &[f64], scale: f64) {
    let found: Vec<f64> = found.concat();
    assert_eq!(found.len(), expected.len(), "{what}");
    let worst = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-10 * scale, "{what}: off by {worst:e}, {found:?} instead of {expected:?}");
}

/// Compares the Jacobians of steps at random states with differences of steps.
fn check_jacobians_at_random_states<M, S, const NQ: usize, const NV: usize, const NU: usize>(
    name: &str,
    m: &M,
    method: &S,
    speed: f64,
    push: f64,
) where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
    S: DifferentiableStep<f64>,
{
    for seed in 0..3 {
        let mut random = Random::new(seed);
        let q = m.integrate(&m.neutral(), &SVector::from_fn(|_, _| random.uniform_number(1.2)));
        let v = SVector::from_fn(|_, _| random.uniform_number(speed));
        let u = SVector::from_fn(|_, _| random.uniform_number(push));
        check_step_jacobians(&format!("{name}, {seed}"), m, method, random.uniform_number(1.0), (&q, &v, &u));
    }
}

/// Compares the Jacobians of one integration step with finite differences of steps.
fn check_step_jacobians<M, S, const NQ: usize, const NV: usize, const NU: usize>(
    name: &str,
    m: &M,
    method: &S,
    t: f64,
    (q, v, u): (&SVector<f64, NQ>, &SVector<f64, NV>, &SVector<f64, NU>),
) where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
    S: DifferentiableStep<f64>,
{
    let mut random = Random::new(5);
    let step_state = |q: &_, v: &_, u: &_| discrete::step(m, method, t, q, v, u).expect("it is regular");
    let found = discrete::transition(m, method, t, q, v, u).expect("it is regular");
    let (next_q, next_v) = step_state(q, v, u);
    // The accelerations with derivatives come from other expressions, whose rounding errors differ.
    let off = (m.difference(&next_q, &found.q).amax(), (next_v - found.v).amax());
    let change = (found.v - v).amax().max(1.0);
    assert!(off.0 < 1e-14 && off.1 < 2e-14 * change, "{name}: {off:?}, {change}");
    let displaced_step = |dq: &_, dv: &SVector<f64, NV>, du: &SVector<f64, NU>| {
        step_state(&m.integrate(q, dq), &(v + dv), &(u + du))
    };
    let by_q: Vec<f64> = central_differences_along_directions(|dq, dv, du| {
        m.difference(&next_q, &displaced_step(dq, dv, du).0)
    })
    .iter()
    .flatten()
    .copied()
    .collect();
    let by_v: Vec<f64> = central_differences_along_directions(|dq, dv, du| displaced_step(dq, dv, du).1)
        .iter()
        .flatten()
        .copied()
        .collect();
    let q_blocks = [found.q_by_q.as_slice(), found.q_by_v.as_slice(), found.q_by_u.as_slice()];
    let v_blocks = [found.v_by_q.as_slice(), found.v_by_v.as_slice(), found.v_by_u.as_slice()];
    let largest_magnitude = |blocks: &[&[f64]]| blocks.concat().iter().fold(1.0_f64, |s, x| s.max(x.abs()));
    assert_concatenated_columns(
        &format!("{name}: configuration"),
        &q_blocks,
        &by_q,
        largest_magnitude(&q_blocks),
    );
    assert_concatenated_columns(&format!("{name}: velocity"), &v_blocks, &by_v, largest_magnitude(&v_blocks));
    // Adjoint products equal products with the transposed blocks.
    let (a, b) = (
        SVector::from_fn(|_, _| random.uniform_number(1.0)),
        SVector::from_fn(|_, _| random.uniform_number(1.0)),
    );
    let (back_q, back_v, back_u) = found.adjoint(&a, &b);
    let (dq, dv) = (
        SVector::from_fn(|_, _| random.uniform_number(1.0)),
        SVector::from_fn(|_, _| random.uniform_number(1.0)),
    );
    let du = SVector::from_fn(|_, _| random.uniform_number(1.0));
    let forth = a.dot(&(found.q_by_q * dq + found.q_by_v * dv + found.q_by_u * du))
        + b.dot(&(found.v_by_q * dq + found.v_by_v * dv + found.v_by_u * du));
    let back = back_q.dot(&dq) + back_v.dot(&dv) + back_u.dot(&du);
    assert!((forth - back).abs() < 1e-11 * largest_magnitude(&v_blocks), "{name}: {forth} {back}");
}

#[test]
fn step_jacobians_agree_with_differences() {
    let carrier = RotorCraftWithPendulum {};
    check_jacobians_at_random_states("carrier, Rk4", &carrier, &Rk4::step(0.02), 2.0, 5.0);
    check_jacobians_at_random_states("carrier, a long step of Rk4", &carrier, &Rk4::step(0.15), 4.0, 5.0);
    check_jacobians_at_random_states("carrier, Euler", &carrier, &SemiImplicitEuler::step(0.02), 2.0, 5.0);
    check_jacobians_at_random_states(
        "driven, Rk4",
        &PendulumOnDrivenPivot { rate: 30.0 },
        &Rk4::step(0.02),
        2.0,
        1.0,
    );
    check_jacobians_at_random_states(
        "driven, Euler",
        &PendulumOnDrivenPivot { rate: 30.0 },
        &SemiImplicitEuler::step(0.02),
        2.0,
        1.0,
    );
    check_jacobians_at_random_states("arm, Rk4", &Panda, &Rk4::step(0.01), 1.0, 0.0);
    check_jacobians_at_random_states("arm, Euler", &Panda, &SemiImplicitEuler::step(0.01), 1.0, 0.0);
}

/// Compares the linear motion of the trait with differences of accelerations, also for loops.
fn check_acceleration_linearization<M, const NQ: usize, const NV: usize, const NU: usize>(
    name: &str,
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    u: &SVector<f64, NU>,
) where
    M: Derivatives<NQ, NV, NU, Scalar = f64> + linkwork::Scleronomic,
{
    let acceleration_at_state = |q: &_, v: &_, u: &_| {
        Mechanism::forward_dynamics(m, 0.0, q, v, &Mechanism::generalized_forces(m, 0.0, q, v, u))
    };
    let found = m.linear_motion(q, v, u);
    assert!((found.acceleration - acceleration_at_state(q, v, u)).amax() < 1e-12);
    let expected = central_differences_along_directions(|dq, dv, du| {
        acceleration_at_state(&Mechanism::integrate(m, q, dq), &(v + dv), &(u + du))
    });
    let expected: Vec<f64> = expected.iter().flatten().copied().collect();
    let scale = expected.iter().fold(1.0_f64, |s, x| s.max(x.abs()));
    let blocks = [found.by_q.as_slice(), found.by_v.as_slice(), found.by_u.as_slice()];
    assert_concatenated_columns(name, &blocks, &expected, scale);
}

#[test]
fn linear_system_predicts_perturbed_motions() {
    let mut random = Random::new(7);
    let carrier = RotorCraftWithPendulum {};
    let q = carrier.integrate(
        &RotorCraftWithPendulum::neutral(&carrier),
        &SVector::from_fn(|_, _| random.uniform_number(1.0)),
    );
    let (v, u) = (
        SVector::from_fn(|_, _| random.uniform_number(1.0)),
        SVector::from_fn(|_, _| random.uniform_number(4.0)),
    );
    check_acceleration_linearization("carrier", &carrier, &q, &v, &u);
    // The matrix of the linear motion equals that of the mechanism's `linearize`.
    let (a, b) = carrier.linearize(&q, &v, &u);
    let found = carrier.linear_motion(&q, &v, &u);
    assert!((found.a::<{ 2 * RotorCraftWithPendulum::NV }>() - a).amax() < 1e-11 * a.amax());
    assert!((found.b::<{ 2 * RotorCraftWithPendulum::NV }>() - b).amax() < 1e-12 * b.amax());

    let driven = PendulumOnDrivenPivot { rate: 20.0 };
    check_acceleration_linearization(
        "driven",
        &at(&driven, 0.3),
        &[0.4].into(),
        &[1.0].into(),
        &[0.2].into(),
    );

    let linkage = Linkage {};
    let q = linkage.assemble(&[0.9, -0.5, 1.4].into(), &[0]).expect("it can be assembled");
    let v = linkage.complete_velocity(&q, &[1.0, 0.0, 0.0].into(), &[0]).expect("it moves");
    check_acceleration_linearization("linkage", &linkage, &q, &v, &[3.0].into());
}

/// A single step equals a simulation of that duration, for every method and with constraints.
#[test]
fn single_steps_equal_simulations() {
    fn check_discrete_derivatives_of_method<M, S, const NQ: usize, const NV: usize>(
        m: &M,
        method: S,
        h: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
    ) where
        M: Mechanism<NQ, NV, 1, Scalar = f64>,
        S: discrete::FixedStep<f64> + Copy,
    {
        let (t, u) = (0.7, SVector::from([0.8]));
        let (found_q, found_v) = discrete::step(m, &method, t, q, v, &u).expect("it moves");
        let run = simulate(m).from(*q, *v).start_at(t).method(method).inputs(|_, _, _| u).duration(h);
        let end = run.finish().expect("it moves");
        assert!((found_q - end.q).amax() < 1e-14 && (found_v - end.v).amax() < 1e-13, "{found_v} {}", end.v);
    }
    let (linkage, driven, h) = (Linkage {}, PendulumOnDrivenPivot { rate: 30.0 }, 0.01);
    let q = linkage.assemble(&[0.9, -0.5, 1.4].into(), &[0]).expect("it can be assembled");
    let v = linkage.complete_velocity(&q, &[1.0, 0.0, 0.0].into(), &[0]).expect("it moves");
    check_discrete_derivatives_of_method(&linkage, Rk4::step(h), h, &q, &v);
    check_discrete_derivatives_of_method(&linkage, ImplicitMidpoint::step(h), h, &q, &v);
    check_discrete_derivatives_of_method(&linkage, SemiImplicitEuler::step(h), h, &q, &v);
    check_discrete_derivatives_of_method(&driven, Rk4::step(h), h, &[0.4].into(), &[1.0].into());
    check_discrete_derivatives_of_method(&driven, ImplicitMidpoint::step(h), h, &[0.4].into(), &[1.0].into());
    check_discrete_derivatives_of_method(&driven, Rosenbrock::step(h), h, &[0.4].into(), &[1.0].into());
}

#[test]
fn invalid_sample_periods_are_errors() {
    let driven = PendulumOnDrivenPivot { rate: 1.0 };
    let (q, v, u) = ([0.4].into(), [1.0].into(), [0.0].into());
    for h in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let found = discrete::step(&driven, &Rk4::step(h), 0.0, &q, &v, &u);
        assert!(matches!(found, Err(Error::InvalidStep { .. })), "{found:?}");
        let found = discrete::transition(&driven, &SemiImplicitEuler::step(h), 0.0, &q, &v, &u);
        assert!(matches!(found, Err(Error::InvalidStep { .. })), "{found:?}");
    }
    let found = discrete::transition(&driven, &Rk4::step(0.1), 0.0, &[f64::NAN].into(), &v, &u);
    assert!(matches!(found, Err(Error::NotFinite { .. })), "{found:?}");
}

/// Checks that the placement of a frame found by index equals that of the frame found by name.
#[test]
fn frame_placements_by_index_equal_those_by_name() {
    let mut random = Random::new(3);
    let carrier = RotorCraftWithPendulum {};
    let q = carrier.integrate(
        &RotorCraftWithPendulum::neutral(&carrier),
        &SVector::from_fn(|_, _| random.uniform_number(1.0)),
    );
    let (v, a) = (
        SVector::from_fn(|_, _| random.uniform_number(1.0)),
        SVector::from_fn(|_, _| random.uniform_number(1.0)),
    );
    let load = index_of(<RotorCraftWithPendulum as Frames<11, 9>>::FRAMES, "load").expect("it is one");
    let named = frame!(RotorCraftWithPendulum, "load");
    assert_eq!(carrier.placement_of(load, 0.0, &q), Some(carrier.frame_placement(named, &q)));
    assert_eq!(carrier.velocity_of(load, 0.0, &q, &v), Some(carrier.frame_velocity(named, &q, &v)));
    assert_eq!(
        carrier.acceleration_of(load, 0.0, &q, &v, &a),
        Some(carrier.frame_acceleration(named, &q, &v, &a))
    );
    assert_eq!(carrier.jacobian_of(load, 0.0, &q), Some(carrier.frame_jacobian(named, &q)));
    assert_eq!(carrier.placement_of(RotorCraftWithPendulum::FRAMES.len(), 0.0, &q), None);
    // Frames of a driven mechanism depend on time.
    let driven = PendulumOnDrivenPivot { rate: 2.0 };
    let pivot = index_of(&PendulumOnDrivenPivot::FRAMES, "pivot").expect("it is one");
    let height = driven.placement_of(pivot, 0.4, &[0.1].into()).map(|p| p.translation.y);
    assert!(height.is_some_and(|y| (y - 0.1 * 0.8_f64.sin()).abs() < 1e-15));
}
