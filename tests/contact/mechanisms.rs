//! Contacts and stops of mechanisms with joints and loops.

use linkwork::contact;
use linkwork::prelude::*;

#[mechanism]
struct Elbow {
    #[body(mass = 2, com = 0.25 * x, inertia = rod(2, 0.5, x))]
    upper: Body,
    #[body(mass = 1.5, com = 0.2 * x, inertia = rod(1.5, 0.4, x))]
    fore: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(0.5 * x) -> fore, about = z)]
    elbow: Pin,
    #[acts(on = elbow)]
    motor: Torque,
    #[limit(on = elbow, from = -2, to = 0.5, restitution = 0)]
    stop: Limit,
}

/// A constant torque presses the elbow into its stop, where it stays until the torque turns round.
#[test]
fn an_elbow_rests_at_its_stop() {
    let m = Elbow {};
    let push = |t: f64| if t < 1.0 { 2.0 } else { -2.0 };
    let run = simulate(&m)
        .from([0.1, 0.0], [0.3, 0.0])
        .inputs(|t, _, _| [push(t)].into())
        .method(TimeStepping::step(1e-3))
        .duration(1.2);
    let mut reached = None;
    for sample in run {
        let sample = sample.unwrap();
        if reached.is_none() && (sample.q[1] - 0.5).abs() < 1e-9 {
            reached = Some(sample.t);
        }
        if reached.is_some() && sample.t < 1.0 {
            assert!((sample.q[1] - 0.5).abs() < 1e-8 && sample.v[1].abs() < 1e-13, "{sample:?}");
        }
    }
    assert!(reached.is_some_and(|t| t < 0.6), "{reached:?}");
}

/// The impact at the stop is v − M⁻¹ e (1 + r) vₑ / (M⁻¹)ₑₑ.
#[test]
fn an_impact_at_a_stop_is_that_of_the_closed_form() {
    let m = Elbow {};
    let (q, v) = ([0.4, 0.5].into(), SVector::from([0.7, 1.3]));
    let found = contact::impact(&m, 0.0, &q, &v).unwrap();
    let inverse = m.mass_matrix(&q).try_inverse().unwrap();
    let expected = v - inverse.column(1) * v[1] / inverse[(1, 1)];
    assert!((found.v - expected).norm() < 1e-13, "{}", found.v);
    assert_eq!(Elbow::CONTACTS, ["stop.from", "stop.to"]);
    assert!((found.impulses[1] - v[1] / inverse[(1, 1)]).abs() < 1e-13 && found.impulses[0] == 0.0);
}

#[mechanism]
struct Striking {
    restitution: f64,
    #[body(mass = 0.5, com = 0.02 * x, inertia = rod(0.5, 0.04, x))]
    crank: Body,
    #[body(mass = 0.5, com = 0.065 * x, inertia = rod(0.5, 0.13, x))]
    rod: Body,
    #[body(mass = 0.5)]
    piston: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(0.04 * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(ground -> piston, along = x)]
    cylinder: Sleeve,
    #[joint(rod.at(0.13 * x) -> piston, about = z)]
    small_end: Pin,
    #[limit(on = cylinder, to = 0.165, restitution = restitution)]
    wall: Limit,
}

/// A piston strikes a stop within a loop: the loop holds, the piston leaves as restitution says, the energy that is lost is
/// ½ (1 − e²) v² over the inverse mass of the piston under the constraints.
#[test]
fn a_piston_strikes_a_stop() {
    for e in [0.0, 0.3, 1.0] {
        let m = Striking { restitution: e };
        let place = 0.165;
        let crank = ((0.04_f64.powi(2) + place * place - 0.13 * 0.13) / (2.0 * 0.04 * place)).acos();
        let q = m.assemble(&[crank, -0.5, place].into(), &[2]).unwrap();
        let v = m.complete_velocity(&q, &[0.0, 0.0, 2.0].into(), &[2]).unwrap();
        let found = contact::impact(&m, 0.0, &q, &v).unwrap();
        assert!(m.constraint_rates(&q, &found.v).amax() < 1e-12);
        assert!((found.v[2] + e * 2.0).abs() < 1e-12, "{}", found.v);
        let unit = [0.0, 0.0, 1.0].into();
        let weight = Mechanism::impulse(&m, &q, &SVector::zeros(), 0.0, &unit)[2];
        let lost = m.kinetic_energy(&q, &v) - m.kinetic_energy(&q, &found.v);
        assert!((lost - 0.5 * (1.0 - e * e) * 4.0 / weight).abs() < 1e-12, "{lost}");
    }
}
