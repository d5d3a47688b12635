//! Free-body diagrams of bodies with contacts, under prescribed contact forces and under the forces of the
//! complementarity conditions.

use super::check_free_body_diagram_sums;
use linkwork::contact::{self, Touch};
use linkwork::free_body::Origin;
use linkwork::prelude::*;
use support::random::Random;

/// Trunk with a leg, on a foot and a heel.
#[mechanism(gravity = -9.81 * z)]
struct Walker {
    #[body(mass = 4, com = 0.05 * x, inertia = diagonal(0.1, 0.15, 0.2))]
    trunk: Body,
    #[joint(ground -> trunk)]
    pose: Free,
    #[body(mass = 1, com = -0.2 * z, inertia = rod(1, 0.4, z))]
    leg: Body,
    #[joint(trunk.at(0.3 * x) -> leg, about = y)]
    hip: Pin,
    #[acts(on = hip)]
    motor: Torque,
    #[limit(on = hip, from = -0.5, to = 1, restitution = 0)]
    stop: Limit,
    #[contact(leg.at(-0.4 * z).sphere(0.02), ground.plane(z), friction = 0.8, torsional = 0.02)]
    foot: Contact,
    #[contact(trunk.at(-0.3 * x - 0.42 * z), ground.plane(z), friction = 0.5)]
    heel: Contact,
    #[output(trunk)]
    on_trunk: FreeBody,
    #[output(momentum(trunk))]
    p_trunk: Vector,
    #[output(angular_momentum(trunk / ground))]
    h_trunk: Vector,
    #[output(center_of_mass(trunk / ground))]
    c_trunk: Vector,
    #[output(leg)]
    on_leg: FreeBody,
    #[output(momentum(leg))]
    p_leg: Vector,
    #[output(angular_momentum(leg / ground))]
    h_leg: Vector,
    #[output(center_of_mass(leg / ground))]
    c_leg: Vector,
}

/// Under the forces of prescribed contact modes (sticking, sliding, separated), the diagrams equal the rates
/// of the momenta.
#[test]
fn prescribed_contact_forces_balance_momentum_rates() {
    use Touch::{Open, Slips, Sticks};
    let m = Walker {};
    let mut random = Random::new(8);
    for touches in [
        [Open; 5],
        [Sticks, Open, Sticks, Open, Open],
        [Slips, Slips, Sticks, Open, Sticks],
        [Sticks, Sticks, Slips, Sticks, Open],
    ] {
        let q = m.integrate(&m.neutral(), &random.random_vector(0.5));
        let (v, u): (SVector<f64, 7>, SVector<f64, 1>) =
            (random.random_vector(1.0), random.random_vector(3.0));
        let tau = m.generalized_forces(&q, &u);
        let held = contact::forward_dynamics(&m, 0.0, &q, &v, &tau, &touches).unwrap();
        let state_after = |h: f64| (m.integrate(&q, &(v * h + held.a * (0.5 * h * h))), v + held.a * h);
        check_free_body_diagram_sums(&m.on_trunk_under(&q, &v, &u, &held.forces), |h| {
            let (q, v) = state_after(h);
            [m.p_trunk(&q, &v), m.h_trunk(&q, &v), m.c_trunk(&q)]
        });
        check_free_body_diagram_sums(&m.on_leg_under(&q, &v, &u, &held.forces), |h| {
            let (q, v) = state_after(h);
            [m.p_leg(&q, &v), m.h_leg(&q, &v), m.c_leg(&q)]
        });
    }
}

/// The contacts of a body at rest carry its weight, with forces at their contact points.
#[test]
fn contact_forces_carry_resting_bodies() {
    let m = Walker {};
    let mut q = m.neutral();
    q[2] = 0.42;
    // The motor holds the hip: the force of the heel is half of the weight of both, by their arms about the
    // foot.
    let (v, arm) = (SVector::zeros(), 0.6);
    let heel = 9.81 * (4.0 * 0.25) / arm;
    for push in [0.0, 0.2] {
        let u = SVector::from([push]);
        let on_leg = m.on_leg(&q, &v, &u).expect("friction is enough");
        let names: Vec<&str> = on_leg.actions.iter().map(|action| action.name).collect();
        assert_eq!(names, ["gravity", "hip", "foot", "foot.spin"]);
        let on_trunk = m.on_trunk(&q, &v, &u).expect("friction is enough");
        let names: Vec<&str> = on_trunk.actions.iter().map(|action| action.name).collect();
        assert_eq!(names, ["gravity", "hip", "heel"]);
        for diagram in [&on_leg.force(), &on_leg.torque(), &on_trunk.force(), &on_trunk.torque()] {
            assert!(diagram.norm() < 1e-6, "{diagram}");
        }
        let [.., foot, spin] = on_leg.actions;
        let below = m.c_leg(&q) + foot.point;
        assert!((below - SVector::from([0.3, 0.0, 0.0])).norm() < 1e-9, "{below}");
        assert_eq!((foot.origin, spin.origin), (Origin::Contact, Origin::Contact));
        assert!(foot.torque.norm() == 0.0 && spin.force.norm() < 1e-12);
        let [.., on_heel] = on_trunk.actions;
        assert!((on_heel.force[2] - heel).abs() < 1e-6, "{}", on_heel.force);
        assert!((foot.force[2] + on_heel.force[2] - 5.0 * 9.81).abs() < 1e-6);
    }
    // No contact force acts in the air.
    q[2] = 1.0;
    let on_leg = m.on_leg(&q, &v, &SVector::zeros()).expect("nothing touches");
    assert!(on_leg.get("foot").is_some_and(|foot| foot.force.norm() == 0.0));
    assert!((on_leg.force() - SVector::from([0.0, 0.0, -9.81])).norm() < 1e-9);
}
