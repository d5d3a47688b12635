use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::SlidingRod;

const R: SlidingRod = SlidingRod { g: 9.81, mass: 0.3, half: 0.5, radius: 0.01, friction: 0.4 };

/// Returns a state of the rod with this angle, slip velocity of its end and angular velocity.
fn rod_state(angle: f64, slip: f64, rate: f64) -> (SVector<f64, 3>, SVector<f64, 3>) {
    let [c, d] = contact_relative_to_centre(angle);
    ([0.0, -d, angle].into(), [slip + rate * d, -rate * c, rate].into())
}

/// Returns the position of the rod's contact point relative to its centre.
fn contact_relative_to_centre(angle: f64) -> [f64; 2] {
    [-R.half * angle.cos(), -R.half * angle.sin() - R.radius]
}

/// Returns the normal acceleration of the rod's end per normal force, `1/m + c²/J + μ σ c d / J`.
fn acceleration_per_normal_force(rod: &SlidingRod, angle: f64, slip: f64) -> f64 {
    let ([c, d], inertia) = (contact_relative_to_centre(angle), rod.mass * rod.half * rod.half / 3.0);
    let part = slip / slip.hypot(1e-3);
    1.0 / rod.mass + c * c / inertia + rod.friction * part * c * d / inertia
}

#[test]
fn sliding_rod_has_closed_form_normal_force() {
    assert_eq!((SlidingRod::NC, SlidingRod::NS), (1, 2));
    for (slip, rate) in [(0.7, 0.0), (-0.7, 0.5), (1e-3, -0.8), (0.0, 0.0)] {
        let (q, v) = rod_state(0.6, slip, rate);
        assert!(R.constraint_residuals(&q).amax() < 1e-16 && R.constraint_rates(&q, &v).amax() < 1e-16);
        let (a, lambda) = R.try_constrained_dynamics(&q, &v, &SVector::zeros()).expect("it slides");
        let [c, d] = contact_relative_to_centre(0.6);
        // The centre of the end moves on a circle about the rod's centre.
        let normal =
            (R.g - R.half * 0.6_f64.sin() * rate * rate) / acceleration_per_normal_force(&R, 0.6, slip);
        let drag = -R.friction * normal * slip / slip.hypot(1e-3);
        assert_number_close(lambda[0], normal, 1e-12);
        let turn = (c * normal - d * drag) * 3.0 / (R.mass * R.half * R.half);
        assert_matrix_close(a, [drag / R.mass, normal / R.mass - R.g, turn].into(), 1e-12);
    }
}

/// Checks that a pushed rod on a rough floor slides if it is steep and jams if it is flat, while a pulled rod
/// always slides.
#[test]
fn pushed_rod_jams_if_flat() {
    let rough = SlidingRod { friction: 1.8, ..R };
    let mut seen = [0; 2];
    for k in 1..15 {
        let angle = 0.1 * f64::from(k);
        for slip in [-1.0, 1.0] {
            let (q, v) = rod_state(angle, slip, 0.0);
            let found = rough.try_constrained_dynamics(&q, &v, &SVector::zeros());
            let jams = acceleration_per_normal_force(&rough, angle, slip) <= 0.0;
            seen[usize::from(jams)] += 1;
            let jammed = Err(ConstraintError::Jammed { constraint: "floor.normal" });
            assert_eq!(found.is_err(), jams, "at {angle}");
            assert!(!jams || found == jammed);
            assert_eq!(rough.forward_dynamics(&q, &v, &SVector::zeros())[0].is_nan(), jams);
        }
    }
    assert!(seen[0] > 14 && seen[1] > 3, "{seen:?}");
    // The simulation therefore stops there with an error, for every method.
    let (q, v) = rod_state(0.8, -1.0, 0.0);
    assert!(acceleration_per_normal_force(&rough, 0.8, -1.0) <= 0.0);
    let is_jammed_by_floor = |end: Result<Sample<f64, 3, 3, 0>, Error>| match end {
        Err(Error::Constraint { reason, .. }) => {
            reason == ConstraintError::Jammed { constraint: "floor.normal" }
        }
        _ => false,
    };
    let simulate_rough_rod = || simulate(&rough).from(q, v).duration(0.1);
    assert!(
        is_jammed_by_floor(simulate_rough_rod().finish())
            && is_jammed_by_floor(simulate_rough_rod().method(Rk4::step(1e-3)).finish())
    );
    assert!(is_jammed_by_floor(simulate_rough_rod().method(ImplicitMidpoint::step(1e-3)).finish()));
    assert!(is_jammed_by_floor(simulate_rough_rod().method(Rosenbrock::step(1e-3)).finish()));
}
