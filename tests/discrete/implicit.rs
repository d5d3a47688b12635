//! Jacobians of implicit midpoint steps, of steps under constraints and of multipliers, against differences.

use super::{
    Linkage, PendulumOnDrivenPivot, RotorCraftWithPendulum, assert_concatenated_columns,
    central_differences_along_directions, check_jacobians_at_random_states, check_step_jacobians,
};
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork::{ConstrainedDerivatives, Mechanism, discrete};
use support::random::Random;

ballbot! {
    /// Ball that rolls on a tilted plane. It has constraints on velocities and on the configuration.
    struct Ballbot {}
}

/// Two arms on ball joints whose ends are connected by a rod of time-dependent length: a spatial loop.
#[mechanism(gravity = -9.81 * z, momentum_derivatives)]
struct ArmsLinkedByRod {
    span: f64,
    mass: f64,
    rate: f64,
    #[body(mass = mass, com = 0.3 * x, inertia = diagonal(0.01, 0.05, 0.06))]
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
}

/// Spatial loop of four pins, in which two constraints of each pin are redundant.
#[mechanism(gravity = -9.81 * y, momentum_derivatives)]
struct FourBar {
    base: f64,
    crank_length: f64,
    mass: f64,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    crank: Body,
    #[body(mass = mass, com = x, inertia = rod(mass, 2, x))]
    coupler: Body,
    #[body(mass = 1.5, com = 0.75 * x, inertia = rod(1.5, 1.5, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    first: Pin,
    #[joint(crank.at(crank_length * x) -> coupler, about = z)]
    second: Pin,
    #[joint(ground.at(base * x) -> rocker, about = z)]
    third: Pin,
    #[joint(rocker.at(1.5 * x) -> coupler.at(2 * x), about = z)]
    closing: Pin,
    #[acts(on = first)]
    motor: Torque,
}

#[test]
fn implicit_step_jacobians_agree_with_differences() {
    for h in [0.01, 0.03] {
        check_jacobians_at_random_states(
            &format!("carrier, {h}"),
            &RotorCraftWithPendulum {},
            &ImplicitMidpoint::step(h),
            2.0,
            5.0,
        );
        check_jacobians_at_random_states(
            &format!("driven, {h}"),
            &PendulumOnDrivenPivot { rate: 30.0 },
            &ImplicitMidpoint::step(h),
            2.0,
            1.0,
        );
    }
}

/// Checks the Jacobians of steps of all methods on a mechanism with constraints, at a state that satisfies
/// them. The directions of the derivatives include inadmissible ones.
pub(super) fn check_constrained_step_jacobians<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    name: &str,
    m: &M,
    random: &mut Random,
    preferred: &SVector<f64, NQ>,
) where
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = f64>,
{
    let t = random.uniform_number(0.3);
    let mut near = m.integrate(preferred, &random.random_vector(0.1));
    for _ in 0..10 {
        let residuals = m.constraint_residuals(t, &near);
        let gap = SVector::from_fn(|k, _| residuals.get(k).copied().unwrap_or(0.0));
        near = m.integrate(&near, &m.constraint_correction(t, &near, &gap));
    }
    let (q, v) = m.project(t, &near, &random.random_vector(1.0)).expect("it can be assembled");
    let u = random.random_vector(2.0);
    check_step_jacobians(&format!("{name}, Rk4"), m, &Rk4::step(0.01), t, (&q, &v, &u));
    check_step_jacobians(&format!("{name}, Euler"), m, &SemiImplicitEuler::step(0.01), t, (&q, &v, &u));
    check_step_jacobians(&format!("{name}, midpoint"), m, &ImplicitMidpoint::step(0.01), t, (&q, &v, &u));
    check_multiplier_derivatives(name, m, t, (&q, &v, &random.random_vector(3.0)));
}

fn check_multiplier_derivatives<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    name: &str,
    m: &M,
    t: f64,
    (q, v, tau): (&SVector<f64, NQ>, &SVector<f64, NV>, &SVector<f64, NV>),
) where
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = f64>,
{
    let (by_q, by_v, by_tau) = m.multiplier_derivatives(t, q, v, tau);
    let expected = central_differences_along_directions(|dq, dv, dtau: &SVector<f64, NV>| {
        m.constrained_dynamics(t, &m.integrate(q, dq), &(v + dv), &(tau + dtau)).1
    });
    let expected: Vec<f64> = expected.iter().flatten().copied().collect();
    let scale = expected.iter().fold(1.0_f64, |s, x| s.max(x.abs()));
    let found = [by_q.as_slice(), by_v.as_slice(), by_tau.as_slice()];
    assert_concatenated_columns(&format!("{name}, multipliers"), &found, &expected, scale);
}

#[test]
fn constrained_step_jacobians_agree_with_differences() {
    let mut random = Random::new(17);
    let linkage = Linkage {};
    let closed = linkage.assemble(&[0.9, -0.5, 1.4].into(), &[0]).expect("it can be assembled");
    check_constrained_step_jacobians("linkage", &linkage, &mut random, &closed);
    for k in 0..3 {
        let mut random_number_near = |x: f64| x * (1.0 + random.uniform_number(0.15));
        let bars = FourBar {
            base: random_number_near(1.8),
            crank_length: random_number_near(0.9),
            mass: random_number_near(2.0),
        };
        let arms = ArmsLinkedByRod {
            span: random_number_near(1.9),
            mass: random_number_near(0.8),
            rate: random_number_near(5.0),
        };
        let ball = Ballbot { radius: random_number_near(0.3), mass: random_number_near(1.0) };
        check_constrained_step_jacobians(&format!("four bars, {k}"), &bars, &mut random, &closed);
        let bent = arms.integrate(&Mechanism::neutral(&arms), &[0.1, 0.1, 0.4, 0.1, -0.1].into());
        check_constrained_step_jacobians(&format!("arms, {k}"), &arms, &mut random, &bent);
        let mut lifted = Mechanism::neutral(&ball);
        lifted[2] = ball.radius;
        check_constrained_step_jacobians(&format!("ball, {k}"), &ball, &mut random, &lifted);
    }
}

/// The projection at the end of a step removes changes that violate the constraints: the end satisfies them
/// to first order for any change of the start.
#[test]
fn steps_project_onto_constraints_to_first_order() {
    let linkage = Linkage {};
    let q = linkage.assemble(&[0.9, -0.5, 1.4].into(), &[0]).expect("it can be assembled");
    let v = linkage.complete_velocity(&q, &[1.0, 0.0, 0.0].into(), &[0]).expect("it moves");
    let step = discrete::transition(&linkage, &ImplicitMidpoint::step(0.01), 0.0, &q, &v, &[3.0].into())
        .expect("it moves");
    let j = linkage.constraint_jacobian(&step.q);
    for block in [step.q_by_q, step.q_by_v] {
        assert!((j * block).amax() < 1e-11, "{}", j * block);
    }
}
