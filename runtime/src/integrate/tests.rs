use super::*;
use crate::Mechanism;
use crate::lie::{ball_difference, free_difference};
use crate::simulate::simulate;
use crate::testing::{
    FreeBody, OneDof, SpinningTop, harmonic_oscillator, pendulum_period, rotate_vector, symmetric_top_motion,
    unit_pendulum,
};
use nalgebra::Vector3;
use std::format;

const SYMMETRIC: Vector3<f64> = Vector3::new(1.0, 1.0, 0.4);
const TUMBLING: Vector3<f64> = Vector3::new(1.0, 2.0, 2.7);
const SPIN: [f64; 3] = [0.8, -0.5, 1.2];

/// Returns a Dormand–Prince method of order 5 whose steps all have the length `h`.
fn fixed_step_dormand_prince(h: f64) -> DormandPrince<f64> {
    DormandPrince::new().tolerance(1e6, 1e6).initial_step(h).max_step(h)
}

/// Returns the Dormand–Prince method of order 8 whose steps all have the length `h`.
fn eighth_order_method_with_fixed_step(h: f64) -> DormandPrince8<f64> {
    DormandPrince8::new().tolerance(1e6, 1e6).initial_step(h).max_step(h)
}

/// Returns the observed order: log₂ of the ratio of the errors with step `h` and step `h / 2`.
fn observed_order(error: impl Fn(f64) -> f64, h: f64) -> f64 {
    (error(h) / error(h / 2.0)).log2()
}

/// Returns the error of the driven, damped oscillator `q̈ = −q − v/5 + sin 2t` at t = 3, whose closed-form
/// solution starts at rest.
fn driven_oscillator_error<S: Method<f64>>(method: S) -> f64 {
    let mechanism = OneDof { damping: 0.2, ..harmonic_oscillator::<f64>() };
    let end = simulate(&mechanism)
        .inputs(|t, _, _| SVector::from([(2.0 * t).sin()]))
        .duration(3.0)
        .method(method)
        .finish()
        .unwrap();
    // Particular solution a sin 2t + b cos 2t, homogeneous part e^(−t/10) (c cos wt + d sin wt).
    let (a, b) = (-3.0 / 9.16, -0.4 / 9.16);
    let w = 0.99_f64.sqrt();
    let (c, d) = (-b, (-2.0 * a - 0.1 * b) / w);
    let t = 3.0_f64;
    let free = (-0.1 * t).exp() * (c * (w * t).cos() + d * (w * t).sin());
    (end.q[0] - (a * (2.0 * t).sin() + b * (2.0 * t).cos() + free)).abs()
}

/// Returns the error of attitude and angular velocity of the free symmetric top at t = 2.
fn free_top_error<S: Method<f64>>(method: S) -> f64 {
    let top = SpinningTop { inertia: SYMMETRIC };
    let end = simulate(&top).from(top.neutral(), SPIN).duration(2.0).method(method).finish().unwrap();
    let (attitude, w) = symmetric_top_motion(SYMMETRIC, SPIN.into(), 2.0);
    let turn = Vector3::from(ball_difference(attitude, end.q.into()));
    turn.norm() + (end.v - w).norm()
}

/// Returns the error of the pose of a thrown symmetric body at t = 2: the centre of mass follows a parabola.
fn thrown_body_pose_error<S: Method<f64>>(method: S) -> f64 {
    let body = FreeBody { mass: 2.0, inertia: SYMMETRIC, gravity: 1.5 };
    let [x, y, z] = SPIN;
    let end = simulate(&body)
        .from(body.neutral(), [1.0, -0.5, 2.0, x, y, z])
        .duration(2.0)
        .method(method)
        .finish()
        .unwrap();
    let [qx, qy, qz, qw] = symmetric_top_motion(SYMMETRIC, SPIN.into(), 2.0).0;
    let pose = [2.0, -1.0, 4.0 - 3.0, qx, qy, qz, qw];
    SVector::from(free_difference(pose, end.q.into())).norm()
}

fn assert_orders<F: Fn(f64) -> f64>(expected: f64, h: f64, errors: [F; 3]) {
    for (case, error) in errors.iter().enumerate() {
        let found = observed_order(error, h);
        std::println!("order {expected}, case {case}: {found:.3}, error {:.1e}", error(h));
        assert!((found - expected).abs() < 0.25, "case {case}: order {found}, expected {expected}");
    }
}

macro_rules! orders {
    ($($name:ident: $method:expr, $order:expr, $h:expr;)+) => {
        $(
            #[test]
            fn $name() {
                let method = $method;
                let cases: [&dyn Fn(f64) -> f64; 3] = [
                    &|h| driven_oscillator_error(method(h)),
                    &|h| free_top_error(method(h)),
                    &|h| thrown_body_pose_error(method(h)),
                ];
                assert_orders($order, $h, cases);
            }
        )+
    };
}

orders! {
    semi_implicit_euler_has_order_one: SemiImplicitEuler::step, 1.0, 2.0 / 1024.0;
    implicit_midpoint_has_order_two: ImplicitMidpoint::step, 2.0, 2.0 / 128.0;
    rosenbrock_has_order_two: Rosenbrock::step, 2.0, 2.0 / 512.0;
    rk4_has_order_four: Rk4::step, 4.0, 2.0 / 64.0;
    dormand_prince_has_order_five: fixed_step_dormand_prince, 5.0, 2.0 / 32.0;
    rodas_has_order_four: |h| Rodas::new().tolerance(1e6, 1e6).initial_step(h).max_step(h), 4.0, 2.0 / 32.0;
}

/// Checks that the observed order is 8 to within one half. Steps that are short enough to show the order
/// leave little error above rounding.
#[test]
fn dormand_prince_8_has_order_eight() {
    let cases: [&dyn Fn(f64) -> f64; 3] = [
        &|h| driven_oscillator_error(eighth_order_method_with_fixed_step(h)),
        &|h| free_top_error(eighth_order_method_with_fixed_step(h)),
        &|h| thrown_body_pose_error(eighth_order_method_with_fixed_step(h)),
    ];
    for (case, error) in cases.iter().enumerate() {
        let found = observed_order(error, 0.5);
        std::println!("order 8, case {case}: {found:.3}, error {:.1e}", error(0.5));
        assert!((found - 8.0).abs() < 0.6, "case {case}: order {found}");
    }
}

#[test]
fn dense_output_has_order_four() {
    // The error of one interpolated step is of order h⁵.
    let dense_output_error = |h: f64| {
        let oscillator = harmonic_oscillator::<f64>();
        let samples = simulate(&oscillator).from([1.0], [0.5]).duration(h).sample_every(h / 7.0);
        samples.method(fixed_step_dormand_prince(h)).fold(0.0_f64, |worst, sample| {
            let sample = sample.unwrap();
            worst.max((sample.q[0] - sample.t.cos() - 0.5 * sample.t.sin()).abs())
        })
    };
    let found = observed_order(dense_output_error, 0.1);
    std::println!("dense output: {found:.3}");
    assert!((found - 5.0).abs() < 0.25, "{found}");
}

#[test]
fn dense_output_of_order_eight_has_order_seven() {
    let dense_output_error = |h: f64| {
        let oscillator = harmonic_oscillator::<f64>();
        let samples = simulate(&oscillator).from([1.0], [0.5]).duration(h).sample_every(h / 7.0);
        samples.method(eighth_order_method_with_fixed_step(h)).fold(0.0_f64, |worst, sample| {
            let sample = sample.unwrap();
            worst.max((sample.q[0] - sample.t.cos() - 0.5 * sample.t.sin()).abs())
        })
    };
    let found = observed_order(dense_output_error, 1.0);
    std::println!("dense output: {found:.3}, {:.1e}", dense_output_error(1.0));
    assert!((found - 8.0).abs() < 0.5, "{found}");
}

fn assert_tolerance_met<S: Method<f64> + Copy>(tolerance: f64, method: S) {
    for error in [driven_oscillator_error(method), free_top_error(method), thrown_body_pose_error(method)] {
        assert!(error < 20.0 * tolerance, "{tolerance}: {error}");
    }
}

#[test]
fn adaptive_methods_meet_tolerances() {
    for tolerance in [1e-6, 1e-8, 1e-10, 1e-12] {
        assert_tolerance_met(tolerance, DormandPrince::new().tolerance(tolerance, tolerance));
        assert_tolerance_met(tolerance, DormandPrince8::new().tolerance(tolerance, tolerance));
    }
    for tolerance in [1e-4, 1e-6, 1e-8] {
        assert_tolerance_met(tolerance, Rodas::new().tolerance(tolerance, tolerance));
    }
}

/// Compares the number of force evaluations of two methods for a pendulum that swings ten times, with a
/// tolerance of 1e-12.
#[test]
fn order_eight_takes_fewer_evaluations_where_tolerances_are_tight() {
    let calls = core::cell::Cell::new(0_u32);
    let pendulum = unit_pendulum();
    let run = simulate(&pendulum).from([2.5], [0.0]).duration(30.0).inputs(|_, _, _| {
        calls.set(calls.get() + 1);
        SVector::from([0.0])
    });
    run.clone().method(DormandPrince::new().tolerance(1e-12, 1e-12)).finish().unwrap();
    let fifth = calls.replace(0);
    run.method(DormandPrince8::new().tolerance(1e-12, 1e-12)).finish().unwrap();
    assert!(calls.get() * 2 < fifth, "{} for {fifth}", calls.get());
}

/// Checks the solution of van der Pol's oscillator, `q̈ = μ (1 − q²) q̇ − q` with μ = 1000, after 2000 s,
/// beyond its second jump: problem VDPOL of the *Test Set for IVP Solvers* (Mazzia and Magherini, 2008),
/// whose time is scaled by μ and whose `y₁(2)` is 1.706 167 732 170 48.
#[test]
fn rodas_follows_a_stiff_oscillator() {
    let calls = core::cell::Cell::new(0_u32);
    let mechanism = OneDof { force: |q: f64| -q, ..harmonic_oscillator() };
    let run = simulate(&mechanism).from([2.0], [0.0]).duration(2000.0).inputs(|_, q, v| {
        calls.set(calls.get() + 1);
        SVector::from([1e3 * (1.0 - q[0] * q[0]) * v[0]])
    });
    let end = run.method(Rodas::new().tolerance(1e-6, 1e-9)).finish().unwrap();
    std::println!("{} after {} evaluations", end.q[0], calls.get());
    assert!((end.q[0] - 1.706_167_732_170_469).abs() < 1e-4, "{}", end.q[0]);
    assert!(calls.get() < 20_000, "{}", calls.get());
}

#[test]
fn pendulum_swings_with_the_elliptic_period() {
    let period = pendulum_period(2.5);
    let method = DormandPrince::new().tolerance(1e-13, 1e-13);
    let end = simulate(&unit_pendulum())
        .from([2.5], [0.0])
        .duration(10.0 * period)
        .method(method)
        .finish()
        .unwrap();
    assert!((end.q[0] - 2.5).abs() < 1e-10 && end.v[0].abs() < 1e-10, "{end:?}");
}

/// Returns momentum in the ground frame and kinetic energy of a free top.
fn invariants_of_top(top: &SpinningTop<f64>, q: SVector<f64, 4>, v: SVector<f64, 3>) -> (Vector3<f64>, f64) {
    (rotate_vector(q.into(), top.generalized_momentum(0.0, &q, &v)), top.kinetic_energy(0.0, &q, &v))
}

#[test]
fn tumbling_body_conserves_momentum_and_energy() {
    let top = SpinningTop { inertia: TUMBLING };
    let start = invariants_of_top(&top, top.neutral(), SPIN.into());
    let run = simulate(&top).from(top.neutral(), SPIN);
    let tight = DormandPrince::new().tolerance(1e-13, 1e-13);
    let exact = run.clone().duration(5.0).method(tight).finish().unwrap();
    let (momentum, energy) = invariants_of_top(&top, exact.q, exact.v);
    assert!((momentum - start.0).norm() < 2e-12 && (energy - start.1).abs() < 2e-12);
    let small = run.duration(5.0).method(Rk4::step(1e-3)).finish().unwrap();
    assert!((small.v - exact.v).norm() < 1e-12 && (small.q - exact.q).norm() < 1e-12);
}

#[test]
fn midpoint_rule_preserves_top_invariants() {
    let top = SpinningTop { inertia: TUMBLING };
    let start = invariants_of_top(&top, top.neutral(), SPIN.into());
    let run = simulate(&top).from(top.neutral(), SPIN).method(ImplicitMidpoint::step(0.05));
    let end = run.duration(500.0).finish().unwrap();
    let (momentum, energy) = invariants_of_top(&top, end.q, end.v);
    assert!((energy - start.1).abs() < 1e-11, "{}", energy - start.1);
    assert!((momentum.norm() - start.0.norm()).abs() < 1e-11);
    assert!((momentum - start.0).norm() > 1e-9, "only its length is kept exactly");
}

#[test]
fn midpoint_rule_bounds_pendulum_energy_error() {
    let pendulum = unit_pendulum();
    let run = simulate(&pendulum).from([2.0], [0.0]).method(ImplicitMidpoint::step(0.05)).duration(5000.0);
    let mut worst = [0.0_f64; 2];
    for sample in run {
        let sample = sample.unwrap();
        let energy =
            pendulum.kinetic_energy(0.0, &sample.q, &sample.v) + pendulum.potential_energy(0.0, &sample.q);
        let late = usize::from(sample.t > 2500.0);
        worst[late] = worst[late].max((energy - (1.0 - 2.0_f64.cos())).abs());
    }
    assert!(worst[0] < 1e-3 && worst[1] < worst[0] * 1.01, "{worst:?}");
}

#[test]
fn midpoint_rule_is_reversible() {
    let top = SpinningTop { inertia: TUMBLING };
    let there = simulate(&top).from(top.neutral(), SPIN).method(ImplicitMidpoint::step(0.1)).duration(20.0);
    let there = there.finish().unwrap();
    let back = simulate(&top).from(there.q, -there.v).method(ImplicitMidpoint::step(0.1)).duration(20.0);
    let back = back.finish().unwrap();
    assert!((back.v + Vector3::from(SPIN)).norm() < 1e-11 && (back.q - top.neutral()).norm() < 1e-11);
}

#[test]
fn midpoint_rule_rests_in_equilibrium() {
    let held = OneDof { force: |_| -9.81, ..harmonic_oscillator::<f64>() };
    let run = simulate(&held).inputs(|_, q, v| SVector::from([9.81 - 1e3 * q[0] - v[0]])).duration(10.0);
    let end = run.from([1e-3], [0.0]).method(ImplicitMidpoint::step(1e-3)).finish().unwrap();
    assert!(end.q[0].abs() < 1e-3 && end.q[0].is_finite());
}

#[test]
fn quaternions_stay_unit_over_many_steps() {
    let top = SpinningTop { inertia: TUMBLING };
    let run = simulate(&top).from(top.neutral(), SPIN).duration(100.0);
    let norms = [
        run.clone().method(Rk4::step(1e-3)).finish().unwrap().q.norm(),
        run.clone().method(SemiImplicitEuler::step(1e-3)).finish().unwrap().q.norm(),
        run.method(ImplicitMidpoint::step(1e-3)).finish().unwrap().q.norm(),
    ];
    assert!(norms.iter().all(|norm| (norm - 1.0).abs() < 4e-16), "{norms:?}");
}

#[test]
fn simulation_runs_in_single_precision() {
    let oscillator = harmonic_oscillator::<f32>();
    let run = simulate(&oscillator).from([1.0], [0.0]).duration(10.0);
    let ends = [
        run.clone().finish().unwrap().q[0],
        run.clone().method(Rk4::step(0.01)).finish().unwrap().q[0],
        run.method(ImplicitMidpoint::step(0.001)).finish().unwrap().q[0],
    ];
    assert!(ends.iter().all(|q| (q - 10.0_f32.cos()).abs() < 1e-3), "{ends:?}");
}

#[test]
fn invalid_settings_are_rejected() {
    let oscillator = harmonic_oscillator::<f64>();
    let run = simulate(&oscillator).duration(1.0);
    let is_invalid_step =
        |result: Result<_, Error>| matches!(result.map(|_| ()), Err(Error::InvalidStep { .. }));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(is_invalid_step(run.clone().method(Rk4::step(bad)).finish()));
        assert!(is_invalid_step(run.clone().method(SemiImplicitEuler::step(bad)).finish()));
        assert!(is_invalid_step(run.clone().method(ImplicitMidpoint::step(bad)).finish()));
        assert!(is_invalid_step(run.clone().method(DormandPrince::new().tolerance(bad, 1e-9)).finish()));
        assert!(is_invalid_step(run.clone().method(DormandPrince::new().max_step(bad)).finish()));
        assert!(bad == 0.0 || is_invalid_step(run.clone().duration(bad).finish()));
        assert!(is_invalid_step(run.clone().sample_every(bad).finish()));
        assert!(is_invalid_step(run.clone().control_every(bad, |_, _, _| SVector::zeros()).finish()));
    }
    assert_eq!(simulate(&oscillator).finish(), Err(Error::Endless), "a run without end has no last sample");
    let shown = format!("{}", Error::InvalidStep { name: "the step", value: -1.0 });
    assert_eq!(shown, "the step must be finite and positive, found -1");
}

#[test]
fn failed_runs_return_errors() {
    let broken = OneDof { force: |_| f64::NAN, ..harmonic_oscillator::<f64>() };
    let run = simulate(&broken).duration(1.0);
    let lost = Err(Error::NotFinite { t: 0.0 });
    assert_eq!(run.clone().finish(), lost);
    assert_eq!(run.clone().method(Rk4::step(0.1)).finish(), lost);
    assert_eq!(run.clone().method(SemiImplicitEuler::step(0.1)).finish(), lost);
    assert_eq!(run.method(ImplicitMidpoint::step(0.1)).finish(), lost);
    assert_eq!(simulate(&harmonic_oscillator::<f64>()).from([f64::NAN], [0.0]).duration(1.0).finish(), lost);

    // The solution of q̈ = 2 q³ from q = v = 1 is 1/(1 − t), which diverges at t = 1.
    let escaping = OneDof { force: |q: f64| 2.0 * q.powi(3), ..harmonic_oscillator::<f64>() };
    let end = simulate(&escaping).from([1.0], [1.0]).duration(2.0).finish();
    let is_near_singular_time = |t: f64| (t - 1.0).abs() < 1e-3;
    assert!(
        matches!(
            end, Err(Error::StepTooSmall { t, .. } | Error::NotFinite { t }) if is_near_singular_time(t),
        ),
        "{end:?}"
    );

    let stiff = OneDof { force: |q: f64| -1e6 * q, ..harmonic_oscillator::<f64>() };
    let run = simulate(&stiff).from([1.0], [0.0]).duration(1.0);
    let end = run.clone().method(ImplicitMidpoint::step(0.1)).finish();
    assert!(matches!(end, Err(Error::NotConverged { .. })), "{end:?}");
    assert!(end.is_err_and(|error| error.to_string().ends_with("take smaller steps")));
    let end = run.clone().method(DormandPrince::new().max_steps(10)).finish();
    assert!(matches!(end, Err(Error::TooManySteps { t }) if t < 1.0), "{end:?}");
    let end = run.method(DormandPrince::new().min_step(0.1)).finish();
    assert!(matches!(end, Err(Error::StepTooSmall { .. })), "{end:?}");
}

/// Checks that a mass on a spring and a dashpot a million times faster than the applied force follows that
/// force, with steps a thousand times longer than the stability limit of an explicit method.
#[test]
fn rosenbrock_is_stable_where_springs_are_stiff() {
    let mechanism = OneDof { damping: 2e3, force: |q: f64| -1e8 * q, ..harmonic_oscillator() };
    let run = simulate(&mechanism)
        .from([1e-3], [0.0])
        .inputs(|t: f64, _, _| SVector::from([t.sin()]))
        .duration(3.0);
    let end = run.clone().method(Rosenbrock::step(0.05)).finish().unwrap();
    let slow = 3.0_f64.sin() / 1e8;
    assert!((end.q[0] - slow).abs() < 0.01 * slow, "{} for {slow}", end.q[0]);
    assert!(run.method(Rk4::step(0.05)).finish().is_err());
}

#[test]
fn rodas_is_stable_where_springs_are_stiff() {
    let mechanism = OneDof { damping: 2e3, force: |q: f64| -1e8 * q, ..harmonic_oscillator() };
    let run = simulate(&mechanism)
        .from([0.0], [1e-4])
        .inputs(|t: f64, _, _| SVector::from([1e4 * t.sin()]))
        .duration(3.0);
    let end = run.method(Rodas::new().tolerance(1e-4, 1e-7).max_steps(1000)).finish().unwrap();
    // Two-scale expansion: q = (sin t − 2e-5 cos t + …) / 1e4.
    let slow = (3.0_f64.sin() - 2e-5 * 3.0_f64.cos()) / 1e4;
    assert!((end.q[0] - slow).abs() < 1e-8, "{} for {slow}", end.q[0]);
}
