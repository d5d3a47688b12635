//! Modes, observability and compensators of second-order systems, compared with closed forms.

use linkwork_design::{StateSpace, picture::Chart};
use nalgebra::{DMatrix, dmatrix};
use std::f64::consts::{LN_2, PI};

/// Decay rate of the oscillator, 1/s.
const DECAY: f64 = 0.3;
/// Damped natural frequency of the oscillator, rad/s.
const DAMPED_FREQUENCY: f64 = 2.0;

/// Returns an oscillator with a force as input and the position as output, with the poles
/// `−DECAY ± i DAMPED_FREQUENCY`.
fn oscillator() -> StateSpace {
    let square = DECAY * DECAY + DAMPED_FREQUENCY * DAMPED_FREQUENCY;
    let (a, b) = (dmatrix![0.0, 1.0; -square, -2.0 * DECAY], dmatrix![0.0; 1.0]);
    let system = StateSpace::new(a, b, dmatrix![1.0, 0.0], dmatrix![0.0]).unwrap();
    system.with_states([("position", "m"), ("velocity", "m/s")]).unwrap()
}

#[test]
fn oscillator_mode_decays_by_its_closed_form() {
    let [mode] = <[_; 1]>::try_from(oscillator().modes().unwrap()).unwrap();
    assert!((mode.time_constant() - 1.0 / DECAY).abs() < 1e-12);
    let cycles = LN_2 / DECAY / (2.0 * PI / DAMPED_FREQUENCY);
    assert!((mode.cycles_to_half().unwrap() - cycles).abs() < 1e-12);
    // The velocity of the mode is its position times the eigenvalue.
    let ratio = mode.shape_of("velocity").unwrap() / mode.shape_of("position").unwrap();
    assert!((ratio - mode.pole).norm() < 1e-12, "{ratio}");
    assert!(mode.shape_of("height").is_none());
}

#[test]
fn unmeasured_modes_are_unobservable() {
    let oscillator = oscillator();
    // The rows `C` and `C A` are position and velocity.
    assert!((oscillator.observability_matrix() - DMatrix::identity(2, 2)).amax() < 1e-15);
    let a = dmatrix![-1.0, 0.0; 0.0, -3.0];
    let first = StateSpace::new(a, dmatrix![1.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0]).unwrap();
    for (pole, distance) in first.mode_observability().unwrap() {
        assert_eq!(distance > 1e-3, (pole.re + 1.0).abs() < 1e-9, "{pole}: {distance}");
    }
}

/// The closed loop has the poles of the regulator `A − B K` and of the estimator `A − L C` (separation
/// principle).
#[test]
fn compensator_places_the_poles_of_regulator_and_estimator() {
    let plant = oscillator();
    let (gain, estimator) = (dmatrix![5.0, 2.0], dmatrix![4.0; 7.0]);
    let compensator = plant.compensator(&gain, &estimator).unwrap();
    let found = plant.feedback(&compensator).unwrap().poles().unwrap();
    let eigenvalues_of_matrix = |a: DMatrix<f64>| linkwork_design::matrices::eigenvalues(&a).unwrap();
    let mut expected = eigenvalues_of_matrix(plant.a() - plant.b() * &gain);
    expected.extend(eigenvalues_of_matrix(plant.a() - &estimator * plant.c()));
    assert_eq!(found.len(), expected.len());
    for pole in expected {
        assert!(found.iter().any(|other| (other - pole).norm() < 1e-9), "{pole} among {found:?}");
    }
}

#[test]
fn chart_axes_and_size_can_be_set() {
    let draw = |points: &[(f64, f64)]| {
        Chart::new("Gain", "frequency", "gain").logarithmic_along().curve("", points.iter().copied())
    };
    let decades = [(1.0, 0.0), (10.0, 1.0), (100.0, 2.0)];
    // Only points with a positive first coordinate have a logarithm.
    let with_zero = [(0.0, 1.0), decades[0], decades[1], decades[2]];
    assert_eq!(draw(&with_zero).svg().unwrap(), draw(&decades).svg().unwrap());
    let svg = draw(&decades).sized(400, 300).svg().unwrap();
    assert!(svg.contains("400") && svg.contains("300") && !draw(&decades).svg().unwrap().contains("\"400\""));
}
