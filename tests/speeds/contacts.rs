//! Contacts and limits of mechanisms with declared generalized speeds, against the same mechanisms in joint
//! velocities.

use super::{DIFFERENCE, derivative_columns};
use linkwork::contact::{self, Contacts, Touch};
use linkwork::discrete;
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::prelude::*;

use linkwork::inverse_kinematics::{InverseKinematics, Target, Unreached};
use linkwork::{Frames, index_of};
use support::compare::{assert_close, assert_close_relative_to_largest};
use support::random::Random;
use support::with_common_fields;

with_common_fields! {
    {
        #[body(mass = 2, com = 0.05 * x + 0.2 * z, inertia = diagonal(0.03, 0.04, 0.05))]
        hull: Body,
        #[joint(ground -> hull)]
        pose: Free,
        #[contact(hull.at(0.3 * x), ground.plane(z), friction = 0.4, restitution = 0.3)]
        front: Contact,
        #[contact(
            hull.at(-0.2 * x + 0.2 * y).sphere(0.02), ground.plane(z), friction = 0.6, torsional = 0.01
        )]
        left: Contact,
        #[contact(hull.at(-0.2 * x - 0.2 * y), ground.plane(z))]
        right: Contact,
        #[acts(on = hull, along = ground.x)]
        wind: Force,
    }

    /// Tripod: a body on three feet with different contacts, one of which is a ball, and a wind force as
    /// input.
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct Tripod {}

    /// Tripod whose generalized speeds are the velocity of its hull's origin and the angular velocity, in
    /// ground axes.
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct TripodInSpeeds {
        #[speed(dot(v(hull / ground / ground), x))]
        ux: Speed,
        #[speed(dot(v(hull / ground / ground), y))]
        uy: Speed,
        #[speed(dot(v(hull / ground / ground), z))]
        uz: Speed,
        #[speed(dot(omega(hull / ground), x))]
        wx: Speed,
        #[speed(dot(omega(hull / ground), y))]
        wy: Speed,
        #[speed(dot(omega(hull / ground), z))]
        wz: Speed,
    }
}

with_common_fields! {
    {
        #[body(mass = 2, com = -0.2 * y, inertia = rod(2, 0.4, y))]
        thigh: Body,
        #[body(mass = 1, com = -0.2 * y, inertia = rod(1, 0.4, y))]
        shank: Body,
        #[joint(ground -> thigh, about = z)]
        hip: Pin,
        #[joint(thigh.at(-0.4 * y) -> shank, about = z)]
        knee: Pin,
        #[limit(on = knee, from = 0, to = 2, restitution = 0.4)]
        stop: Limit,
    }

    /// Leg on a hip and a knee, whose knee has limits with stops.
    #[mechanism(gravity = -9.81 * y, derivatives)]
    struct Leg {}

    /// Leg whose generalized speeds are the angular velocity of its shank, times a length, and the velocity of
    /// its foot across the thigh.
    #[mechanism(gravity = -9.81 * y, derivatives)]
    struct LegInSpeeds {
        #[body(mass = 0, inertia = 0)]
        foot: Body,
        #[joint(shank.at(-0.4 * y) -> foot)]
        sole: Weld,
        #[speed(0.4 * rate(hip) + 0.4 * rate(knee))]
        swing: Speed,
        #[speed(dot(v(shank.at(-0.7 * y) / ground / ground), thigh.x))]
        across: Speed,
    }
}

fn tripod_start() -> (SVector<f64, 7>, SVector<f64, 6>) {
    let m = Tripod {};
    let q = m.integrate(&m.neutral(), &[0.2, -0.1, 0.06, 0.1, 0.15, 0.9].into());
    (q, [0.6, -0.3, -0.8, 0.5, -1.2, 2.0].into())
}

/// Returns the matrix `Z(q)`, which maps generalized speeds to joint velocities.
fn speed_to_velocity_matrix(q: &SVector<f64, 7>) -> SMatrix<f64, 6, 6> {
    let unit_vector = |i: usize| SVector::<f64, 6>::from_fn(|j, _| if i == j { 1.0 } else { 0.0 });
    SMatrix::from_columns(&std::array::from_fn::<_, 6, _>(|i| {
        TripodInSpeeds {}.rates_of_speeds(q, &unit_vector(i))
    }))
}

#[test]
fn contacts_in_speeds_equal_contacts_in_velocities() {
    let (plain, m, (q, rates)) = (Tripod {}, TripodInSpeeds {}, tripod_start());
    let (u, z) = (m.speeds_of_rates(&q, &rates), speed_to_velocity_matrix(&q));
    assert_close("gaps", m.contact_gaps(&q).as_slice(), plain.contact_gaps(&q).as_slice(), 1e-14);
    assert_close(
        "rates",
        m.contact_rates(&q, &u).as_slice(),
        plain.contact_rates(&q, &rates).as_slice(),
        1e-13,
    );
    let jacobian = plain.contact_jacobian(&q);
    assert_close("Jacobian", m.contact_jacobian(&q).as_slice(), (jacobian * z).as_slice(), 1e-13);
    // Equivalent accelerations, and the accelerations of the contacts that they cause.
    let tau: SVector<f64, 6> = Random::new(4).random_vector(5.0);
    let a = plain.forward_dynamics(&q, &rates, &tau);
    let du = m.forward_dynamics(&q, &u, &(z.transpose() * tau));
    let expected = jacobian * a + plain.contact_bias(&q, &rates);
    let found = m.contact_jacobian(&q) * du + m.contact_bias(&q, &u);
    assert_close("accelerations", found.as_slice(), expected.as_slice(), 1e-11);
    let (ours, theirs) =
        (m.contact_responses(0.0, &q, &[true; 4]), plain.contact_responses(0.0, &q, &[true; 4]));
    assert_close("responses", ours.rates.as_slice(), theirs.rates.as_slice(), 1e-12);
    assert_close("responses", (z * ours.velocities).as_slice(), theirs.velocities.as_slice(), 1e-12);
    for touches in [
        [Touch::Sticks, Touch::Slips, Touch::Open, Touch::Sticks],
        [Touch::Slips, Touch::Sticks, Touch::Slips, Touch::Open],
    ] {
        let forces = m.generalized_forces(&q, &[3.0].into());
        let held = contact::forward_dynamics(&m, 0.0, &q, &u, &forces, &touches).unwrap();
        let tau = plain.generalized_forces(&q, &[3.0].into());
        let expected = contact::forward_dynamics(&plain, 0.0, &q, &rates, &tau, &touches).unwrap();
        assert_close("held", held.forces.as_slice(), expected.forces.as_slice(), 1e-10);
        let (landed, other) = (
            contact::land(&m, 0.0, &q, &u, &touches).unwrap(),
            contact::land(&plain, 0.0, &q, &rates, &touches).unwrap(),
        );
        assert_close("landed", (z * landed.v).as_slice(), other.v.as_slice(), 1e-12);
    }
    let mut down = q;
    down[2] -= plain.contact_gaps(&q).min() + 1e-12;
    let struck = contact::impact(&m, 0.0, &down, &u).unwrap();
    let expected = contact::impact(&plain, 0.0, &down, &rates).unwrap();
    assert!(expected.impulses.amax() > 0.1, "{expected:?}");
    assert_close("impulses", struck.impulses.as_slice(), expected.impulses.as_slice(), 1e-11);
    assert_close(
        "struck",
        (speed_to_velocity_matrix(&down) * struck.v).as_slice(),
        expected.v.as_slice(),
        1e-11,
    );
}

/// Motions with located events are equal; time stepping converges to the same motion as the step decreases.
#[test]
fn tripod_falls_and_slides_equally_in_speeds() {
    let (plain, m, (q, rates)) = (Tripod {}, TripodInSpeeds {}, tripod_start());
    let u = m.speeds_of_rates(&q, &rates);
    let events = EventDriven::new().tolerance(1e-12, 1e-12);
    for duration in [0.1, 0.4] {
        let expected = simulate(&plain).from(q, rates).duration(duration).method(events).finish().unwrap();
        let end = simulate(&m).from(q, u).duration(duration).method(events).finish().unwrap();
        let gaps = plain.contact_gaps(&expected.q);
        assert!(duration < 0.4 || gaps.iter().any(|gap| gap.abs() < 1e-6), "{gaps}");
        assert_close("place", end.q.as_slice(), expected.q.as_slice(), 1e-8);
        assert_close("velocity", m.rates_of_speeds(&end.q, &end.v).as_slice(), expected.v.as_slice(), 1e-7);
        let error_with_step = |h: f64| {
            let end =
                simulate(&m).from(q, u).duration(duration).method(TimeStepping::step(h)).finish().unwrap();
            (end.q - expected.q).amax()
        };
        let (coarse, fine) = (error_with_step(1e-3), error_with_step(1e-4));
        assert!(fine < coarse.max(1e-9) * 0.3 && fine < 2e-4, "{coarse:e} {fine:e}");
    }
}

#[test]
fn contact_motions_in_speeds_have_derivatives() {
    let (m, (q, rates)) = (TripodInSpeeds {}, tripod_start());
    let u = m.speeds_of_rates(&q, &rates);
    let tau: SVector<f64, 6> = Random::new(6).random_vector(3.0);
    let touches = [Touch::Slips, Touch::Sticks, Touch::Open, Touch::Open];
    let found = contact::forward_dynamics_derivatives(&m, 0.0, &q, &u, &tau, &touches).unwrap();
    let contact_forward_dynamics = |q: &SVector<f64, 7>, u: &SVector<f64, 6>, tau: &SVector<f64, 6>| {
        contact::forward_dynamics(&m, 0.0, q, u, tau, &touches).unwrap()
    };
    let displaced_configuration = |e: &SVector<f64, 6>| m.integrate(&q, e);
    let assert_similar_entries = |what: &str, found: &[f64], expected: &[f64]| {
        assert_close_relative_to_largest(what, found, expected, DIFFERENCE * 10.0);
    };
    assert_similar_entries(
        "∂u̇/∂q",
        found.by_q.as_slice(),
        derivative_columns(|e| contact_forward_dynamics(&displaced_configuration(&e), &u, &tau).a).as_slice(),
    );
    assert_similar_entries(
        "∂u̇/∂u",
        found.by_v.as_slice(),
        derivative_columns(|e| contact_forward_dynamics(&q, &(u + e), &tau).a).as_slice(),
    );
    assert_similar_entries(
        "∂u̇/∂τ",
        found.by_tau.as_slice(),
        derivative_columns(|e| contact_forward_dynamics(&q, &u, &(tau + e)).a).as_slice(),
    );
    assert_similar_entries(
        "∂f/∂q",
        found.forces_by_q.as_slice(),
        derivative_columns(|e| contact_forward_dynamics(&displaced_configuration(&e), &u, &tau).forces)
            .as_slice(),
    );
    assert_similar_entries(
        "∂f/∂u",
        found.forces_by_v.as_slice(),
        derivative_columns(|e| contact_forward_dynamics(&q, &(u + e), &tau).forces).as_slice(),
    );
    let landed = contact::land_derivatives(&m, 0.0, &q, &u, &touches).unwrap();
    let velocity_after_touchdown =
        |q: &SVector<f64, 7>, u: &SVector<f64, 6>| contact::land(&m, 0.0, q, u, &touches).unwrap().v;
    assert_similar_entries(
        "∂u⁺/∂q",
        landed.by_q.as_slice(),
        derivative_columns(|e| velocity_after_touchdown(&displaced_configuration(&e), &u)).as_slice(),
    );
    assert_similar_entries(
        "∂u⁺/∂u",
        landed.by_v.as_slice(),
        derivative_columns(|e| velocity_after_touchdown(&q, &(u + e))).as_slice(),
    );
    let push = [0.7].into();
    let motion = contact::linear_motion(&m, 0.0, &q, &u, &push, &touches).unwrap();
    assert_similar_entries("turning", motion.turning.as_slice(), m.turning(&q, &u).as_slice());
    // Steps with enforced contacts.
    let stance = contact::hold(&m, touches).stabilized(20.0);
    fn check_step_derivatives<S: discrete::DifferentiableStep<f64>>(
        stance: &contact::Holding<'_, TripodInSpeeds, f64, 4, 8>,
        method: &S,
        (q, u): (&SVector<f64, 7>, &SVector<f64, 6>),
    ) {
        let push = [0.7].into();
        let next = discrete::transition(stance, method, 0.0, q, u, &push).unwrap();
        let step_state = |q: &_, u: &_| discrete::step(stance, method, 0.0, q, u, &push).unwrap();
        let m = TripodInSpeeds {};
        let by_q = derivative_columns(|e| m.difference(&next.q, &step_state(&m.integrate(q, &e), u).0));
        assert_close_relative_to_largest("q by q", next.q_by_q.as_slice(), by_q.as_slice(), DIFFERENCE);
        let by_v = derivative_columns(|e| m.difference(&next.q, &step_state(q, &(u + e)).0));
        assert_close_relative_to_largest("q by u", next.q_by_v.as_slice(), by_v.as_slice(), DIFFERENCE);
        let by_q = derivative_columns(|e| step_state(&m.integrate(q, &e), u).1);
        assert_close_relative_to_largest(
            "u by q",
            next.v_by_q.as_slice(),
            by_q.as_slice(),
            DIFFERENCE * 10.0,
        );
        let by_v = derivative_columns(|e| step_state(q, &(u + e)).1);
        assert_close_relative_to_largest(
            "u by u",
            next.v_by_v.as_slice(),
            by_v.as_slice(),
            DIFFERENCE * 10.0,
        );
    }
    check_step_derivatives(&stance, &Rk4::step(0.01), (&q, &u));
    check_step_derivatives(&stance, &ImplicitMidpoint::step(0.01), (&q, &u));
}

/// Limits of a coordinate whose rate is not a generalized speed cause the same impacts.
#[test]
fn leg_stop_impacts_are_equal_in_speeds() {
    let (plain, m) = (Leg {}, LegInSpeeds {});
    let (q, rates): (SVector<f64, 2>, SVector<f64, 2>) = ([0.4, 1.1].into(), [-1.0, 4.0].into());
    let u = m.speeds_of_rates(&q, &rates);
    for duration in [0.3, 0.6] {
        let events = EventDriven::new().tolerance(1e-12, 1e-12);
        let expected = simulate(&plain).from(q, rates).duration(duration).method(events).finish().unwrap();
        let end = simulate(&m).from(q, u).duration(duration).method(events).finish().unwrap();
        assert_close("place", end.q.as_slice(), expected.q.as_slice(), 1e-9);
        let found = m.rates_of_speeds(&end.q, &end.v);
        assert_close("velocity", found.as_slice(), expected.v.as_slice(), 1e-8);
    }
    assert_eq!(<LegInSpeeds as Contacts<2, 2, 0, 2, 2>>::CONTACTS, ["stop.from", "stop.to"]);
}

/// Limits of coordinates apply for any choice of generalized speeds, and inverse kinematics respects them.
#[test]
fn coordinate_limits_are_independent_of_speeds() {
    let m = LegInSpeeds {};
    assert_eq!(m.lower_limits().as_slice(), [f64::NEG_INFINITY, 0.0]);
    assert_eq!(m.upper_limits().as_slice(), Leg {}.upper_limits().as_slice());
    assert_eq!(m.clamp_configuration(&[5.0, -0.3].into()).as_slice(), [5.0, 0.0]);
    // Two configurations place the foot there; one of them bends the knee in the wrong direction.
    let foot = index_of(<LegInSpeeds as Frames<2, 2>>::FRAMES, "foot").expect("it is a frame");
    let wanted = m.placement_of(foot, 0.0, &[0.5, 0.7].into()).unwrap();
    let found = InverseKinematics::new()
        .reach(&m, 0.0, &[Target::position(foot, wanted.translation.vector)], &[1.2, -0.7].into())
        .expect("it is in reach");
    assert_close("reached", found.q.as_slice(), &[0.5, 0.7], 1e-5);
    // The straight leg is the limit of its reach.
    let beyond = Target::position(foot, [0.1, -0.9, 0.0].into());
    let stretched = InverseKinematics::new().reach(&m, 0.0, &[beyond], &[0.6, 0.4].into()).unwrap_err();
    let Unreached::OutOfReach { q, .. } = stretched else { panic!("{stretched}") };
    assert_close("stretched", q.as_slice(), &[(0.1_f64 / 0.9).atan(), 0.0], 1e-4);
}

/// A mechanism without its contacts moves in generalized speeds as in joint velocities.
#[test]
fn mechanism_without_contacts_keeps_its_speeds() {
    let (plain, m, (q, rates)) = (Tripod {}, TripodInSpeeds {}, tripod_start());
    let u = m.speeds_of_rates(&q, &rates);
    let method = ImplicitMidpoint::step(1e-3);
    let expected = simulate(&contact::apart(&plain))
        .from(q, rates)
        .duration(0.5)
        .method(Rk4::step(1e-3))
        .finish()
        .unwrap();
    let end = simulate(&contact::apart(&m)).from(q, u).duration(0.5).method(method).finish().unwrap();
    assert_close("configuration", end.q.as_slice(), expected.q.as_slice(), 1e-4);
    assert_close("velocity", m.rates_of_speeds(&end.q, &end.v).as_slice(), expected.v.as_slice(), 1e-4);
    // Without contacts the hull falls freely: its origin passes the ground.
    assert!(end.q[2] < -0.2, "{}", end.q[2]);
}
