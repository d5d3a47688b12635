//! Isolated configurations in which generalized speeds do not determine the rates of coordinates: integration
//! is impossible there and returns an error.

use super::{DiskInSpeeds, EulerAngleBodyInSpeeds, sample_body_in_speeds};
use linkwork::discrete;
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use support::mechanisms::SatelliteInSpeeds;

/// Returns a gimbal-lock configuration, in which `ψ` and `φ` rotate about the same axis (`sin θ = 0`), and
/// generalized speeds.
fn gimbal_lock_state() -> (SVector<f64, 3>, SVector<f64, 3>) {
    ([0.3, 0.0, -0.4].into(), [0.5, -0.7, 6.0].into())
}

#[test]
fn singular_speeds_yield_nonfinite_coordinate_rates() {
    let (m, (q, u)) = (sample_body_in_speeds(), gimbal_lock_state());
    assert!(m.rates_of_speeds(&q, &u).iter().any(|x| !x.is_finite()));
    assert!(m.forward_dynamics(&q, &u, &SVector::zeros()).iter().any(|x| !x.is_finite()));
    // Functions that do not need the rates are still correct: the inverse transformation, inertia and
    // energies.
    let back = m.speeds_of_rates(&q, &[1.0, 2.0, 3.0].into());
    assert!((back - SVector::from([2.0 * (-0.4_f64).cos(), 2.0 * 0.4_f64.sin(), 4.0])).norm() < 1e-14);
    let energy = m.kinetic_energy(&[0.3, 1e-4, -0.4].into(), &u);
    let fixed = 2.0 * 0.3 * 0.3;
    let expected = 0.5 * ((0.2 + fixed) * 0.25 + (0.3 + fixed) * 0.49 + 0.45 * 36.0);
    assert!((energy - expected).abs() < 1e-9, "{energy} {expected}");
}

#[test]
fn motions_from_singular_speeds_are_errors() {
    let (m, (q, u)) = (sample_body_in_speeds(), gimbal_lock_state());
    fn simulation_error_from_start<S: linkwork::integrate::Method<f64>>(
        m: &EulerAngleBodyInSpeeds,
        (q, u): (SVector<f64, 3>, SVector<f64, 3>),
        method: S,
    ) -> Error {
        let run = simulate(m).from(q, u).duration(0.1).method(method).finish();
        run.map(|end| end.q).expect_err("it has no rates")
    }
    for error in [
        simulation_error_from_start(&m, (q, u), Rk4::step(1e-3)),
        simulation_error_from_start(&m, (q, u), SemiImplicitEuler::step(1e-3)),
        simulation_error_from_start(&m, (q, u), ImplicitMidpoint::step(1e-3)),
        simulation_error_from_start(&m, (q, u), DormandPrince::new()),
        simulation_error_from_start(&m, (q, u), Rodas::new()),
    ] {
        assert!(matches!(error, Error::NotFinite { t: 0.0 }), "{error}");
    }
    let push = [1.0].into();
    let step = discrete::step(&m, &Rk4::step(1e-3), 0.0, &q, &u, &push);
    assert!(matches!(step, Err(Error::NotFinite { .. })), "{step:?}");
    let step = discrete::transition(&m, &Rk4::step(1e-3), 0.0, &q, &u, &push);
    assert!(matches!(step, Err(Error::NotFinite { .. })));
}

/// Checks that a configuration in which generalized speeds do not determine the rates of coordinates is found
/// under constraints, too: a rolling disk has one where it lies flat, a free body has none.
#[test]
fn constraints_do_not_hide_singular_speeds() {
    let flat: SVector<f64, 6> = [0.0, 0.0, 0.0, 0.2, std::f64::consts::FRAC_PI_2, 0.1].into();
    let run = simulate(&DiskInSpeeds {}).from(flat, [0.1, 0.0, 0.0, 0.3, 0.2, 0.1]).duration(0.1);
    // The cosine of a right angle is 6e-17 in floating point: rates are finite, but too large for any step.
    assert!(run.method(Rk4::step(1e-3)).finish().is_err());
    let m = SatelliteInSpeeds {};
    let upside_down = m.integrate(&m.neutral(), &[0.0, 0.0, 0.0, 0.0, std::f64::consts::PI, 0.0, 0.0].into());
    assert!(m.rates_of_speeds(&upside_down, &SVector::repeat(1.0)).iter().all(|x| x.is_finite()));
}
