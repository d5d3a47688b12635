use super::*;
use crate::Mechanism;
use crate::integrate::{ImplicitMidpoint, Rk4, SemiImplicitEuler};
use crate::testing::{FreeBody, OneDof, falling_ball, harmonic_oscillator, pendulum_period, unit_pendulum};
use core::cell::Cell;
use nalgebra::Vector3;
use std::vec::Vec;

const TIGHT: fn() -> DormandPrince<f64> = || DormandPrince::new().tolerance(1e-13, 1e-13);

/// Returns the times of the samples in a simulation of the oscillator.
fn sample_times_of_oscillator<S: Method<f64>>(method: S, duration: f64, interval: f64) -> Vec<f64> {
    let oscillator = harmonic_oscillator::<f64>();
    let run = simulate(&oscillator).from([1.0], [0.0]).duration(duration).sample_every(interval);
    run.method(method).map(|sample| sample.unwrap().t).collect()
}

#[test]
fn samples_are_at_requested_times() {
    let expected_sample_time = |interval: f64| move |k: usize| k as f64 * interval;
    for (duration, interval, count) in [(10.0, 0.01, 1000), (1.0, 0.1, 10), (0.3, 0.1, 3), (0.7, 0.7, 1)] {
        let mut wanted: Vec<f64> = (0..count).map(expected_sample_time(interval)).collect();
        wanted.push(duration);
        assert_eq!(sample_times_of_oscillator(DormandPrince::new(), duration, interval), wanted);
        assert_eq!(sample_times_of_oscillator(Rk4::step(0.003), duration, interval), wanted);
        assert_eq!(sample_times_of_oscillator(ImplicitMidpoint::step(0.04), duration, interval), wanted);
        assert_eq!(sample_times_of_oscillator(SemiImplicitEuler::step(0.01), duration, interval), wanted);
    }
    assert_eq!(sample_times_of_oscillator(Rk4::step(0.1), 1.0, 0.4), [0.0, 0.4, 0.8, 1.0]);
    assert_eq!(sample_times_of_oscillator(DormandPrince::new(), 1.0, 5.0), [0.0, 1.0]);
}

#[test]
fn without_an_interval_every_step_is_a_sample() {
    let oscillator = harmonic_oscillator::<f64>();
    let run = simulate(&oscillator).from([1.0], [0.0]).duration(1.0);
    assert_eq!(run.clone().method(Rk4::step(0.01)).count(), 101);
    assert_eq!(run.clone().method(Rk4::step(0.3)).count(), 5);
    let last = run.clone().last().unwrap().unwrap();
    assert_eq!(run.finish().unwrap(), last);
    assert_eq!(last.t, 1.0);
    let endless = simulate(&oscillator).from([1.0], [0.0]).method(Rk4::step(0.5));
    assert_eq!(endless.take(7).last().unwrap().unwrap().t, 3.0);
}

#[test]
fn interpolated_samples_are_accurate() {
    let oscillator = harmonic_oscillator::<f64>();
    let run = simulate(&oscillator).from([1.0], [0.0]).duration(10.0).sample_every(0.01).method(TIGHT());
    for sample in run {
        let sample = sample.unwrap();
        assert!((sample.q[0] - sample.t.cos()).abs() < 1e-11, "{sample:?}");
        assert!((sample.v[0] + sample.t.sin()).abs() < 1e-11, "{sample:?}");
    }
}

#[test]
fn default_start_is_neutral_at_rest() {
    let body = FreeBody { mass: 1.0, inertia: Vector3::new(1.0, 2.0, 2.5), gravity: 0.0 };
    let end = simulate(&body).duration(1.0).finish().unwrap();
    assert_eq!(end.q, Mechanism::neutral(&body));
    assert_eq!(end.v.norm(), 0.0);
    assert!(end.u.is_empty());
}

/// Simulates a reference to a mechanism, and checks that the result is that of the mechanism itself.
#[test]
fn mechanism_reference_is_simulated() {
    struct Controller<P> {
        plant: P,
    }
    let oscillator = harmonic_oscillator::<f64>();
    let controller = Controller { plant: &oscillator };
    let end = simulate(&controller.plant).from([1.0], [0.5]).duration(2.0).finish();
    assert_eq!(end, simulate(&oscillator).from([1.0], [0.5]).duration(2.0).finish());
}

#[test]
fn run_starts_at_given_time() {
    let simulate_pushed_oscillator_from = |start| {
        let oscillator = harmonic_oscillator::<f64>();
        let run = simulate(&oscillator).start_at(start).inputs(|t, _, _| SVector::from([t]));
        run.duration(1.0).finish().map(|end| (end.t, end.q[0])).unwrap()
    };
    let (t, q) = simulate_pushed_oscillator_from(2.0);
    // q̈ = −q + t from rest at t = 2: q = t − 2 cos(t − 2) − sin(t − 2).
    assert_eq!(t, 3.0);
    assert!((q - (3.0 - 2.0 * 1.0_f64.cos() - 1.0_f64.sin())).abs() < 1e-7);
}

/// Simulates a free mass with forces of alternating sign for periods of 0.1 s. The closed-form solution is a
/// sum.
fn simulate_controlled_mass<S: Method<f64>>(method: S) -> (f64, Vec<f64>) {
    let mass = OneDof { force: |_| 0.0, ..harmonic_oscillator::<f64>() };
    let calls = Cell::new(0);
    let instants = core::cell::RefCell::new(Vec::new());
    let run = simulate(&mass).control_every(0.1, |t, _, _| {
        instants.borrow_mut().push(t);
        calls.set(calls.get() + 1);
        SVector::from([if calls.get() % 2 == 1 { 1.0 } else { -1.0 }])
    });
    let end = run.duration(1.0).sample_every(0.05).method(method).last().unwrap().unwrap();
    (end.q[0], instants.take())
}

#[test]
fn digital_control_is_constant_within_period() {
    // Ten periods: up and down five times, and 0.01 m in each pair.
    for (q, instants) in [
        simulate_controlled_mass(DormandPrince::new()),
        simulate_controlled_mass(Rk4::step(0.02)),
        simulate_controlled_mass(ImplicitMidpoint::step(0.02)),
    ] {
        assert!((q - 0.05).abs() < 1e-13, "{q}");
        let wanted = (0..=10).map(f64::from).map(|k| k / 10.0);
        assert!(instants.len() == 11 && instants.iter().zip(wanted).all(|(t, k)| (t - k).abs() < 1e-15));
    }
}

/// Returns the inputs at samples every 0.1 s of a controller that counts its periods of 0.3 s.
fn sampled_inputs<S: Method<f64>>(method: S) -> Vec<f64> {
    let oscillator = harmonic_oscillator::<f64>();
    let mut count = -1.0;
    let run = simulate(&oscillator).control_every(0.3, |_, _, _| {
        count += 1.0;
        SVector::from([count])
    });
    run.duration(3.0).sample_every(0.1).method(method).map(|sample| sample.unwrap().u[0]).collect()
}

#[test]
fn samples_contain_held_inputs() {
    let wanted: Vec<f64> = (0..=30).map(|k| f64::from(k / 3)).collect();
    assert_eq!(sampled_inputs(Rk4::step(0.1)), wanted);
    assert_eq!(sampled_inputs(ImplicitMidpoint::step(0.03)), wanted);
    assert_eq!(sampled_inputs(DormandPrince::new()), wanted);
    let oscillator = harmonic_oscillator::<f64>();
    let run = simulate(&oscillator).inputs(|t, _, _| SVector::from([2.0 * t])).duration(1.0);
    assert!(run.sample_every(0.1).all(|sample| sample.is_ok_and(|s| s.u[0] == 2.0 * s.t)));
}

#[test]
fn pendulum_crossings_are_periodic() {
    let pendulum = unit_pendulum();
    let period = pendulum_period(2.5);
    let run = simulate(&pendulum).from([2.5], [0.0]).duration(5.0 * period).sample_every(100.0);
    let run =
        run.event(Crossing::Falling, |_, q, _| q[0]).event(Crossing::Rising, |_, q, _| q[0]).method(TIGHT());
    let mut count = 0;
    for sample in run.filter(|sample| sample.is_ok_and(|s| s.event.is_some())) {
        let sample = sample.unwrap();
        assert_eq!(sample.event, Some(count % 2));
        let wanted = period * (0.25 + 0.5 * count as f64);
        // The error of the energy, and with it of the period, grows linearly; errors of the times grow
        // quadratically.
        assert!(
            (sample.t - wanted).abs() < 5e-13 * ((count + 1) * (count + 1)) as f64,
            "{count}: {}",
            sample.t
        );
        count += 1;
    }
    assert_eq!(count, 10);
}

#[test]
fn run_ends_at_stopping_event() {
    // A stone thrown upwards from the ground lands after t = 2 v; the start is no event.
    let stone = falling_ball();
    let run = simulate(&stone).from([0.0], [3.0]).until(|_, q, _| q[0]);
    let assert_stops_at_event = |end: Result<Sample<f64, 1, 1, 1>, Error>| {
        let end = end.unwrap();
        assert!((end.t - 6.0).abs() < 1e-13 && (end.v[0] + 3.0).abs() < 1e-13, "{end:?}");
        assert_eq!(end.event, Some(0));
    };
    assert_stops_at_event(run.clone().finish());
    assert_stops_at_event(run.clone().method(Rk4::step(0.7)).finish());
    assert_stops_at_event(run.clone().method(ImplicitMidpoint::step(0.7)).finish());
    assert_stops_at_event(run.clone().sample_every(0.25).method(Rk4::step(0.07)).finish());
    // The stone passes 4 m on its way up, and again on its way down.
    let crossing_time_of_thrown_stone = |crossing| {
        let run = simulate(&stone).from([0.0], [3.0]).until_crossing(crossing, |_, q, _| q[0] - 4.0);
        run.finish().unwrap().t
    };
    assert!((crossing_time_of_thrown_stone(Crossing::Rising) - 2.0).abs() < 1e-13);
    assert!((crossing_time_of_thrown_stone(Crossing::Either) - 2.0).abs() < 1e-13);
    assert!((crossing_time_of_thrown_stone(Crossing::Falling) - 4.0).abs() < 1e-13);
}

#[test]
fn several_events_are_in_time_order() {
    let mass = OneDof { force: |_| 0.0, ..harmonic_oscillator::<f64>() };
    let run = simulate(&mass).from([0.0], [1.0]).duration(1.0).method(Rk4::step(1.0));
    let run = run
        .event(Crossing::Rising, |_, q, _| q[0] - 0.9)
        .event(Crossing::Either, |_, q, _| q[0] - 0.2)
        .event(Crossing::Rising, |t, _, _| t - 0.2)
        .event(Crossing::Falling, |_, q, _| q[0] - 0.5)
        .event(Crossing::Rising, |t, _, _| (t - 0.3) * (t - 0.6));
    let found: Vec<_> =
        run.map(|sample| sample.unwrap()).map(|s| (s.event, (s.t * 1e9).round() / 1e9)).collect();
    let wanted = [(None, 0.0), (Some(1), 0.2), (Some(2), 0.2), (Some(4), 0.6), (Some(0), 0.9), (None, 1.0)];
    assert_eq!(found, wanted);
}

#[test]
fn bouncing_ball_has_exact_impact_times() {
    // From 0.5 m with unit gravity, the ball falls for 1 s. Each bounce halves the speed: impacts at 1, 2,
    // 2.5 and 2.75 s.
    let ball = falling_ball();
    let run = simulate(&ball).from([0.5], [0.0]).duration(2.9);
    let run = run.impact(Crossing::Falling, |_, q, _| q[0], |_, _, v| v * -0.5);
    let assert_bounce_times = |samples: &mut dyn Iterator<Item = Result<Sample<f64, 1, 1, 1>, Error>>| {
        let hits: Vec<_> = samples.map(|s| s.unwrap()).filter(|s| s.event.is_some()).collect();
        let wanted = [(1.0, 0.5), (2.0, 0.25), (2.5, 0.125), (2.75, 0.0625), (2.875, 0.03125)];
        assert_eq!(hits.len(), wanted.len());
        for (hit, (t, v)) in hits.iter().zip(wanted) {
            assert!((hit.t - t).abs() < 1e-12 && (hit.v[0] - v).abs() < 1e-12, "{hit:?}");
        }
    };
    // The whole flight takes one step, or less.
    assert_bounce_times(&mut run.clone());
    assert_bounce_times(&mut run.clone().method(Rk4::step(2.9)));
    assert_bounce_times(&mut run.clone().method(DormandPrince::new().max_step(0.05)));
    assert_bounce_times(&mut run.clone().method(Rk4::step(0.01)));
    assert_bounce_times(&mut run.clone().method(ImplicitMidpoint::step(0.01)).sample_every(0.1));
    assert_bounce_times(&mut run.clone().method(DormandPrince::new().max_step(0.05)).sample_every(0.125));
}

#[test]
fn elastic_ball_bounces_without_loss() {
    let ball = falling_ball();
    let run = simulate(&ball).from([0.5], [0.0]).impact(Crossing::Falling, |_, q, _| q[0], |_, _, v| -v);
    // 500 flights of 2 s.
    let end = run.duration(1002.0).finish().unwrap();
    assert!((end.q[0] - 0.5).abs() < 1e-7 && end.v[0].abs() < 1e-6, "{end:?}");
    // Thrown from the surface that ends the flight.
    let thrown = simulate(&ball).from([0.0], [3.0]).until(|_, q, _| q[0]).duration(100.0).finish().unwrap();
    assert!((thrown.t - 6.0).abs() < 1e-12, "{thrown:?}");
}

/// Checks that bounces that each lose a fraction of the speed, which accumulate at a finite time, end with an
/// error.
#[test]
fn accumulating_impacts_are_an_error() {
    let ball = falling_ball();
    for part in [0.8, 0.5, 0.05] {
        let run = simulate(&ball).from([0.5], [0.0]);
        let run = run.impact(Crossing::Falling, |_, q, _| q[0], move |_, _, v| v * -part).duration(30.0);
        let rest = (1.0 + part) / (1.0 - part);
        for end in [run.clone().finish(), run.method(Rk4::step(0.01)).finish()] {
            assert!(
                matches!(end, Err(Error::Impacts { t, event: 0 }) if (t - rest).abs() < 1e-4),
                "{part}: {end:?}"
            );
        }
    }
}

#[test]
fn nan_event_function_is_an_error() {
    let ball = falling_ball();
    let end = simulate(&ball).duration(1.0).until(|t, _, _| if t < 0.5 { 1.0 } else { f64::NAN }).finish();
    assert!(matches!(end, Err(Error::Event { event: 0, .. })), "{end:?}");
    let run = simulate(&ball).event(Crossing::Rising, |_, q, _| q[0] - 1.0).duration(1.0);
    let end = run.event(Crossing::Either, |_, _, _| f64::NAN).finish();
    assert_eq!(end, Err(Error::Event { t: 0.0, event: 1 }));
}

#[test]
fn impact_coincides_with_control_instant() {
    let ball = falling_ball();
    let run = simulate(&ball).from([0.5], [0.0]).control_every(1.0, |_, _, _| SVector::zeros());
    let run = run.impact(Crossing::Falling, |_, q, _| q[0], |_, _, v| -v).duration(2.5);
    for end in [run.clone().finish(), run.sample_every(0.5).method(Rk4::step(0.1)).finish()] {
        let end = end.unwrap();
        assert!((end.q[0] - 0.375).abs() < 1e-12, "{end:?}");
    }
}

#[test]
fn iteration_ends_after_an_error() {
    let broken =
        OneDof { force: |q: f64| if q > 0.5 { f64::NAN } else { 1.0 }, ..harmonic_oscillator::<f64>() };
    let mut run = simulate(&broken).duration(2.0).method(Rk4::step(0.125));
    let failed = run.by_ref().find(Result::is_err);
    assert!(matches!(failed, Some(Err(Error::NotFinite { t })) if t > 0.8 && t < 1.01), "{failed:?}");
    assert!(run.next().is_none());
}

#[test]
fn changed_setting_restarts_the_run() {
    let oscillator = harmonic_oscillator::<f64>();
    let mut run = simulate(&oscillator).from([1.0], [0.0]).duration(1.0).sample_every(0.1);
    assert_eq!(run.by_ref().count(), 11);
    assert!(run.next().is_none());
    assert_eq!(run.duration(2.0).count(), 21);
}

/// Returns the gain of energy of a mechanism in one unit of time; the code is generic over mechanisms.
fn energy_gain<M: Mechanism<NQ, NV, NU>, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    q: SVector<M::Scalar, NQ>,
    v: SVector<M::Scalar, NV>,
) -> M::Scalar {
    let t = nalgebra::zero();
    let total_energy = |q, v| mechanism.kinetic_energy(t, q, v) + mechanism.potential_energy(t, q);
    let end = simulate(mechanism).from(q, v).duration(nalgebra::one()).finish().unwrap();
    total_energy(&end.q, &end.v) - total_energy(&q, &v)
}

#[test]
fn generic_code_simulates_mechanisms() {
    assert!(energy_gain(&unit_pendulum(), SVector::from([1.0]), SVector::from([0.0])).abs() < 1e-8);
    assert!(
        energy_gain(&harmonic_oscillator::<f32>(), SVector::from([1.0]), SVector::from([0.0])).abs() < 1e-4
    );
    let body = FreeBody { mass: 1.0, inertia: Vector3::new(1.0, 2.0, 2.5), gravity: 1.0 };
    assert!(
        energy_gain(&body, Mechanism::neutral(&body), SVector::from([1.0, 0.0, 2.0, 0.3, 1.0, -0.5])).abs()
            < 1e-8
    );
}

/// Checks that a plastic impact is an error: no contact force supports the ball afterwards, and it would fall
/// through the floor.
#[test]
fn plastic_impact_is_an_error() {
    let ball = falling_ball();
    for part in [0.0, -1e-9, 1e-12, 1e-7, 1e-5, 1e-3] {
        let run = simulate(&ball).from([0.5], [0.0]).duration(30.0);
        let run = run.impact(Crossing::Falling, |_, q, _| q[0], move |_, _, v| v * -part);
        let runs = [
            run.clone().finish(),
            run.clone().method(Rk4::step(0.01)).finish(),
            run.clone().sample_every(0.3).method(ImplicitMidpoint::step(0.01)).finish(),
            run.method(SemiImplicitEuler::step(0.001)).finish(),
        ];
        for end in runs {
            assert!(
                matches!(end, Err(Error::Impacts { t, event: 0 }) if (t - 1.0).abs() < 1e-2),
                "{part}: {end:?}"
            );
        }
    }
    // Without forces the ball remains on the surface; and the motion continues if the impact does not stop
    // it.
    let free = OneDof { force: |_| 0.0, ..harmonic_oscillator::<f64>() };
    let run = simulate(&free).from([0.5], [-1.0]).duration(3.0);
    let end = run.clone().impact(Crossing::Falling, |_, q, _| q[0], |_, _, v| v * 0.0).finish().unwrap();
    assert!(end.q[0].abs() < 1e-14 && end.v[0] == 0.0, "{end:?}");
    let end = run.impact(Crossing::Falling, |_, q, _| q[0], |_, _, v| v * 0.5).finish().unwrap();
    assert!((end.q[0] + 1.25).abs() < 1e-12, "{end:?}");
    // An impulse at a fixed time.
    let run = simulate(&free).duration(3.0).impact(
        Crossing::Rising,
        |t, _, _| t - 1.0,
        |_, _, v| v.add_scalar(2.0),
    );
    assert!((run.finish().unwrap().q[0] - 4.0).abs() < 1e-12);
}

/// Checks that all events of one instant take effect, in the order of their declaration.
#[test]
fn simultaneous_events_all_act() {
    let ball = falling_ball();
    let run = simulate(&ball).from([0.5], [0.0]).duration(4.0);
    let first =
        run.clone().impact(Crossing::Falling, |_, q, _| q[0], |_, _, v| -v).until(|_, q, _| q[0] * 3.0);
    let end = first.finish().unwrap();
    assert!((end.t - 1.0).abs() < 1e-12 && end.event == Some(1) && end.v[0] > 0.0, "{end:?}");
    let last = run.clone().until(|_, q, _| q[0]).impact(Crossing::Falling, |_, q, _| q[0], |_, _, v| -v);
    let end = last.finish().unwrap();
    assert!((end.t - 1.0).abs() < 1e-12 && end.event == Some(1) && end.v[0] > 0.0, "{end:?}");
    // Reports before and after the impact; each bounce is reported once.
    let run = run
        .event(Crossing::Either, |_, q, _| q[0])
        .impact(Crossing::Falling, |_, q, _| q[0] * 0.7, |_, _, v| -v)
        .event(Crossing::Either, |_, q, _| q[0] * 5.0);
    for method in [Rk4::step(0.01), Rk4::step(0.3)] {
        let events: Vec<_> = run.clone().method(method).filter_map(|s| s.unwrap().event).collect();
        assert_eq!(events, [0, 1, 2, 0, 1, 2]);
    }
}

/// Checks that an initial quaternion without unit norm is an error.
#[test]
fn initial_quaternion_must_be_unit() {
    let body = FreeBody { mass: 1.0, inertia: Vector3::new(1.0, 2.0, 2.5), gravity: 0.0 };
    for q in [[0.0; 7], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0], [1.0, 0.0, 0.0, 0.0, 0.6, 0.0, 0.7]] {
        let end = simulate(&body).from(q, [1.0; 6]).duration(0.1).finish();
        assert!(
            matches!(end, Err(Error::Quaternion { coordinate }) if coordinate.starts_with('q')),
            "{end:?}"
        );
    }
    assert!(
        simulate(&body).from([0.0, 0.0, 0.0, 0.0, 0.6, 0.0, 0.8], [1.0; 6]).duration(0.1).finish().is_ok()
    );
}

/// Checks that a run of zero duration yields only the initial state.
#[test]
fn zero_duration_yields_initial_state() {
    let oscillator = harmonic_oscillator::<f64>();
    let run = simulate(&oscillator).from([1.0], [2.0]).start_at(3.0).duration(0.0);
    let end = run.clone().finish().unwrap();
    assert_eq!((end.t, end.q[0], end.v[0]), (3.0, 1.0, 2.0));
    assert_eq!(run.clone().count(), 1);
    assert_eq!(run.sample_every(0.1).method(Rk4::step(0.1)).count(), 1);
}

/// Checks that control periods of one millisecond have the same length after hours as at the start, in single
/// precision.
#[test]
fn control_periods_stay_exact_in_single_precision() {
    let mass = OneDof { force: |_| 0.0, ..harmonic_oscillator::<f32>() };
    let start = 8192.0;
    let calls = Cell::new(0);
    let call_counting_controller = |_: f32, _: &_, _: &_| {
        calls.set(calls.get() + 1);
        SVector::from([0.0])
    };
    let run = simulate(&mass)
        .from([0.0], [1.0])
        .start_at(start)
        .duration(100.0)
        .control_every(1e-3, call_counting_controller);
    for fixed in [true, false] {
        calls.set(0);
        let run = run.clone().sample_every(2e-3);
        let (count, end) = if fixed {
            run.method(Rk4::step(1e-3)).fold((0, 0.0), |(n, _), s| (n + 1, s.unwrap().q[0]))
        } else {
            run.fold((0, 0.0), |(n, _), s| (n + 1, s.unwrap().q[0]))
        };
        assert_eq!((count, calls.get()), (50_001, 100_001));
        // Each of 10⁵ steps adds its rounding error.
        assert!((end - 100.0).abs() < 0.1, "{end}");
    }
}

/// Samples an oscillator at given times, with an adaptive method, which interpolates, and with a fixed-step
/// method.
fn check_listed_sample_times<S: Method<f64> + Clone>(method: S, tolerance: f64) {
    let (start, looked) = (2.0, [2.0, 2.013, 2.5, 2.500_000_1, 5.75]);
    let mass = harmonic_oscillator::<f64>();
    let run = simulate(&mass).from([1.0], [0.0]).start_at(start).method(method);
    let error_of_sample = |sample: &Sample<f64, 1, 1, 1>| (sample.q[0] - (sample.t - start).cos()).abs();
    let samples: Vec<_> = run.clone().sample_at(&looked).map(Result::unwrap).collect();
    assert_eq!(samples.iter().map(|sample| sample.t).collect::<Vec<_>>(), looked);
    assert!(samples.iter().all(|sample| error_of_sample(sample) < tolerance), "{samples:?}");
    let end = run.clone().sample_at(&looked).finish().unwrap();
    assert!(end.t == 5.75 && error_of_sample(&end) < tolerance);
    // With a duration, the end is a sample, too, and later times are ignored. The start is a sample only if
    // its time is listed.
    for (duration, expected) in [(4.0, &[2.013, 5.75, 6.0][..]), (3.0, &[2.013, 5.0][..])] {
        let run = run.clone().sample_at(&[2.013, 5.75]).duration(duration);
        assert_eq!(run.map(|sample| sample.unwrap().t).collect::<Vec<_>>(), expected);
    }
    // In the order of time, together with events.
    let run = run.sample_at(&[2.5, 4.0]).event(Crossing::Either, |_, q, _| q[0]);
    let times: Vec<f64> = run.map(|sample| sample.unwrap().t).collect();
    assert!(times.len() == 3 && (times[1] - start - core::f64::consts::FRAC_PI_2).abs() < 1e-4, "{times:?}");
}

#[test]
fn samples_lie_at_listed_times() {
    check_listed_sample_times(DormandPrince::new(), 1e-7);
    check_listed_sample_times(Rk4::step(1e-2), 1e-8);
}

#[test]
fn sample_times_must_increase() {
    let mass = harmonic_oscillator::<f64>();
    let simulation_error =
        |times: &[f64]| simulate(&mass).start_at(1.0).sample_at(times).finish().unwrap_err();
    let simulation_error_message = |times: &[f64]| std::string::ToString::to_string(&simulation_error(times));
    let first = "the time from the start to the first sample must be finite and positive, found -0.5";
    assert_eq!(simulation_error_message(&[0.5, 2.0]), first);
    assert_eq!(
        simulation_error_message(&[1.0, 3.0, 2.0]),
        "the time between samples must be finite and positive, found -1"
    );
    assert_eq!(
        simulation_error_message(&[1.0, 1.0]),
        "the time between samples must be finite and positive, found 0"
    );
    assert!(
        simulation_error_message(&[1.0, f64::NAN]).ends_with("found NaN")
            && simulation_error_message(&[f64::INFINITY]).ends_with("found inf")
    );
    assert_eq!(simulation_error(&[]), Error::Endless);
}
