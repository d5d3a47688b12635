//! Bilaterally enforced contacts with stabilization gains: decay of gaps and contact velocities, and steps
//! with given accelerations.

use super::derivatives::{QuadrupedOnPointFeet, quadruped_state_and_torques};
use linkwork::contact::{self, Touch};
use linkwork::discrete;
use linkwork::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use linkwork::prelude::*;

/// Checks that the gap of an enforced contact decays if it is stabilized by gains, and otherwise stays at one
/// millimetre.
#[test]
fn gaps_of_fixed_contacts_decay_with_gains() {
    let (mut q, _, _) = quadruped_state_and_torques();
    let m = QuadrupedOnPointFeet {};
    q[2] -= m.contact_gaps(&q)[0] - 1e-3;
    let simulate_held_contact = |rate: f64| {
        let held = contact::hold(&m, [Touch::Sticks, Touch::Open]).stabilized(rate);
        simulate(&held).from(q, SVector::zeros()).method(Rk4::step(1e-4)).duration(0.1).finish().unwrap()
    };
    let (free, steady) = (simulate_held_contact(0.0), simulate_held_contact(100.0));
    assert!((m.contact_gaps(&free.q)[0] - 1e-3).abs() < 1e-8);
    // Critically damped decay: (1 + α t) e^(−α t).
    assert!((m.contact_gaps(&steady.q)[0] - 11.0 * (-10.0_f64).exp() * 1e-3).abs() < 1e-9);
}

/// A foot with a remaining contact velocity stops after a fiftieth of its speed (in metres per m/s) if only
/// the velocity has a gain.
#[test]
fn contact_velocities_decay_with_a_separate_gain() {
    let (q, _, _) = quadruped_state_and_torques();
    let m = QuadrupedOnPointFeet {};
    // The foot moves down together with the whole robot.
    let turned = UnitQuaternion::from_quaternion(Quaternion::new(q[6], q[3], q[4], q[5]));
    let down = turned.inverse_transform_vector(&Vector3::new(0.0, 0.0, -0.1));
    let v = SVector::from_fn(|k, _| if k < 3 { down[k] } else { 0.0 });
    let held = contact::hold(&m, [Touch::Sticks, Touch::Open]).with_gains(0.0, 50.0);
    let run = simulate(&held).from(q, v).method(Rk4::step(1e-4)).duration(0.2);
    let end = run.finish().unwrap();
    let sunk = m.contact_gaps(&q)[0] - m.contact_gaps(&end.q)[0];
    assert!((sunk - 0.1 / 50.0 * (1.0 - (-10.0_f64).exp())).abs() < 1e-8, "{sunk}");
    assert!((m.contact_rates(&end.q, &end.v)[0] + 0.1 * (-10.0_f64).exp()).abs() < 1e-7);
}

/// A step from given accelerations and their derivatives has the state and the Jacobians of the step that
/// computes them, and its contact forces enforce the contacts.
#[test]
fn steps_accept_precomputed_accelerations() {
    let (q, v, _) = quadruped_state_and_torques();
    let (m, touches, h) = (QuadrupedOnPointFeet {}, [Touch::Sticks, Touch::Slips], 2e-3);
    let held = contact::hold(&m, touches).with_gains(0.0, 50.0);
    let u = SVector::<f64, 12>::from_fn(|k, _| 0.4 * (0.9 * k as f64).cos());
    let tau = m.generalized_forces(&q, &u);
    let found = held.held_derivatives(0.0, &q, &v, &tau).unwrap();
    let by_u = found.by_tau.fixed_columns::<12>(6).into_owned();
    let mut made = discrete::Transition::zeros();
    let by = (&found.by_q, &found.by_v, &by_u);
    discrete::semi_implicit_into(&held, h, (&q, &v), &found.a, by, &mut made);
    let method = SemiImplicitEuler::step(h);
    let step = discrete::transition(&held, &method, 0.0, &q, &v, &u).unwrap();
    assert!(
        (made.a::<36>() - step.a::<36>()).amax() < 1e-12 && (made.b::<36>() - step.b::<36>()).amax() < 1e-12
    );
    assert!((made.q - step.q).amax() < 1e-14 && (made.v - step.v).amax() < 1e-13);
    let motion = held.held(0.0, &q, &v, &tau).unwrap();
    assert_eq!((motion.a, motion.forces), (found.a, found.forces));
    let unmoved = m.forward_dynamics(&q, &v, &(tau + m.contact_jacobian(&q).tr_mul(&motion.forces)));
    assert!((unmoved - motion.a).amax() < 1e-9 * (1.0 + motion.a.amax()));
}
