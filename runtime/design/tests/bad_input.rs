//! Errors for results that do not exist: each invalid input, with the error message that names the cause.

use linkwork::prelude::{FirstOrder, mechanism};
use linkwork_design::flight::FlightModes;
use linkwork_design::matrices::{self, Cost};
use linkwork_design::steady::equilibrium;
use linkwork_design::{
    Error, Hold, Noise, Polynomial, StateSpace, StepLimits, TransferFunction, logarithmic, picture,
};
use nalgebra::{Complex, DMatrix, dmatrix};

const BAD_NUMBERS: [f64; 4] = [0.0, -1.0, f64::NAN, f64::INFINITY];

#[track_caller]
fn assert_error_message<T: std::fmt::Debug>(text: &str, result: Result<T, Error>) {
    assert_eq!(result.map_err(|error| error.to_string()).unwrap_err(), text);
}

fn system_without_feedthrough(a: DMatrix<f64>, b: DMatrix<f64>, c: DMatrix<f64>) -> StateSpace {
    let d = DMatrix::zeros(c.nrows(), b.ncols());
    StateSpace::new(a, b, c, d).unwrap()
}

/// Returns an unstable system, which grows at a rate of 2/s and whose input acts on both states.
fn unstable_system() -> StateSpace {
    system_without_feedthrough(dmatrix![-1.0, 0.0; 0.0, 2.0], dmatrix![1.0; 1.0], dmatrix![1.0, 1.0])
}

fn stable_system() -> StateSpace {
    system_without_feedthrough(dmatrix![-1.0, 1.0; 0.0, -2.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0])
}

fn double_integrator() -> StateSpace {
    system_without_feedthrough(dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0])
}

fn integrator_system() -> StateSpace {
    system_without_feedthrough(dmatrix![0.0], dmatrix![1.0], dmatrix![1.0])
}

fn system_with_two_inputs() -> StateSpace {
    system_without_feedthrough(dmatrix![-1.0], dmatrix![1.0, 2.0], dmatrix![1.0])
}

fn gain_system(k: f64) -> StateSpace {
    StateSpace::gain(dmatrix![k]).unwrap()
}

fn complex_from_real(x: f64) -> Complex<f64> {
    Complex::new(x, 0.0)
}

#[test]
fn matrix_errors_name_the_matrix() {
    let one_by_one_matrix = || dmatrix![1.0];
    assert_error_message(
        "A has an entry that is not finite",
        StateSpace::new(dmatrix![f64::NAN], one_by_one_matrix(), one_by_one_matrix(), one_by_one_matrix()),
    );
    assert_error_message(
        "expected 1 × 1 entries of A, found 1 × 2",
        StateSpace::new(dmatrix![1.0, 2.0], one_by_one_matrix(), one_by_one_matrix(), one_by_one_matrix()),
    );
    assert_error_message(
        "expected 1 × 1 entries of B, found 2 × 1",
        StateSpace::new(one_by_one_matrix(), dmatrix![1.0; 2.0], one_by_one_matrix(), one_by_one_matrix()),
    );
    assert_error_message(
        "A has an entry that is not finite",
        matrices::lyapunov(&dmatrix![f64::NAN], &one_by_one_matrix()),
    );
    assert_error_message(
        "expected 1 × 1 entries of Q, found 2 × 2",
        matrices::lyapunov(&one_by_one_matrix(), &DMatrix::identity(2, 2)),
    );
    let inputs = dmatrix![1.0, 2.0];
    let forced = stable_system().forced_response(&inputs, &[0.0, 0.0], &[0.0], Hold::Zero);
    assert_error_message("expected 1 × 1 entries of the inputs, found 1 × 2", forced);
    let response = stable_system().initial_response(&[f64::NAN, 0.0], &[0.0, 1.0]);
    assert_error_message("the initial state has an entry that is not finite", response);
    let noise = Noise { states: dmatrix![1.0], outputs: dmatrix![1.0] };
    assert_error_message(
        "expected 2 × 2 entries of the states' noise, found 1 × 1",
        unstable_system().kalman(&noise),
    );
    let noise = Noise { states: DMatrix::identity(2, 2), outputs: DMatrix::identity(3, 3) };
    assert_error_message(
        "expected 1 × 1 entries of the outputs' noise, found 3 × 3",
        unstable_system().kalman(&noise),
    );
}

#[test]
fn invalid_periods_and_instants_are_errors() {
    let (stable, lag) = (stable_system(), TransferFunction::new([1.0], [1.0, 1.0]).unwrap());
    for bad in BAD_NUMBERS {
        let text = format!("expected a positive period, found {bad} s");
        for hold in [Hold::Zero, Hold::First, Hold::Tustin, Hold::Prewarped(1.0)] {
            assert_error_message(&text, stable.discretize(bad, hold));
        }
        assert_error_message(&text, stable.clone().with_period(bad));
        assert_error_message(&text, stable.lqr_held(&Cost::diagonal(&[1.0, 1.0], &[1.0]), bad));
        assert_error_message(&text, lag.clone().with_period(bad));
        assert_error_message(&text, lag.factored().unwrap().matched(bad));
        assert_error_message(&format!("an end of {bad} is not allowed"), stable.times(bad, 10));
        assert_error_message(
            &format!("a distance of instants of {bad} is not allowed"),
            stable.step_response(0, &[0.0, bad]),
        );
        assert_error_message(&format!("a frequency of {bad} is not allowed"), logarithmic(bad, 10.0, 5));
        assert_error_message(
            &format!("a frequency for prewarping of {bad} is not allowed"),
            stable.discretize(0.1, Hold::Prewarped(bad)),
        );
    }
    assert_error_message(
        "an unequally spaced instant of 2 is not allowed",
        stable.step_response(0, &[0.0, 2.0, 1.0]),
    );
    for bad in [f64::NAN, f64::INFINITY] {
        let text = format!("a frequency of {bad} is not allowed");
        assert_error_message(&text, stable.frequency_response(0, 0, &[1.0, bad]));
        assert_error_message(&text, stable.frequency_map().unwrap().response(bad));
        assert_error_message(&text, stable.at(Complex::new(0.0, bad)));
    }
    let held = stable.discretize(0.1, Hold::Zero).unwrap();
    assert_error_message(
        "a period of 0.1 s and continuous time are incompatible",
        held.discretize(0.1, Hold::Zero),
    );
    assert_error_message(
        "continuous time and discrete time are incompatible",
        stable.undiscretize(Hold::Zero),
    );
    assert_error_message("continuous time and a period of 0.1 s are incompatible", stable.series(&held));
    let dead =
        system_without_feedthrough(dmatrix![0.0], dmatrix![1.0], dmatrix![1.0]).with_period(0.1).unwrap();
    assert_error_message("the logarithm of an eigenvalue of 0 is not allowed", dead.undiscretize(Hold::Zero));
    let fast = system_without_feedthrough(dmatrix![20.0], dmatrix![1.0], dmatrix![1.0]);
    assert_error_message("I − A / s of Tustin's rule is singular", fast.discretize(0.1, Hold::Tustin));
}

#[test]
fn unstable_systems_name_the_pole() {
    let (grows, rests) = ("not stable: the pole 2+0i", "not stable: the pole 0+0i");
    for (system, text) in
        [(unstable_system(), grows), (integrator_system(), rests), (double_integrator(), rests)]
    {
        assert_error_message(text, system.controllability_gramian());
        assert_error_message(text, system.observability_gramian());
        assert_error_message(text, system.hankel_values());
        assert_error_message(text, system.h2_norm());
        assert_error_message(text, system.peak_gain());
        assert_error_message(text, system.step_figures());
    }
    assert_error_message("A, with a pole at rest, is singular", integrator_system().gain_at_rest());
    assert_error_message(
        "s I − A, at a pole, is singular",
        integrator_system().frequency_response(0, 0, &[1.0, 0.0]),
    );
    assert_error_message("s I − A, at a pole, is singular", stable_system().at(complex_from_real(-1.0)));
    let direct = stable_system().parallel(&gain_system(1.0)).unwrap();
    assert_error_message("the H₂ norm, with direct feedthrough, is infinite", direct.h2_norm());
    let cancel = "the equation, whose eigenvalues cancel, is singular";
    assert_error_message(
        cancel,
        matrices::lyapunov(&dmatrix![1.0, 0.0; 0.0, -1.0], &DMatrix::identity(2, 2)),
    );
    assert_error_message(cancel, matrices::lyapunov(&dmatrix![0.0], &dmatrix![1.0]));
    assert_error_message(cancel, matrices::discrete_lyapunov(&dmatrix![1.0], &dmatrix![1.0]));
    assert_error_message("expected 1 input, found 2", system_with_two_inputs().step_figures());
    assert_error_message("expected 1 input, found 2", system_with_two_inputs().margins());
    let limits = StepLimits { settling: -0.02, ..StepLimits::default() };
    assert_error_message("a band of -0.02 is not allowed", stable_system().step_figures_within(limits));
}

/// Checks that the Lyapunov solvers accept an unsymmetric right-hand side `Q`.
#[test]
fn lyapunov_accepts_unsymmetric_right_side() {
    let (a, q) = (dmatrix![-1.0, 2.0; -3.0, -2.0], dmatrix![1.0, 5.0; -2.0, 0.5]);
    let x = matrices::lyapunov(&a, &q).unwrap();
    assert!((&a * &x + &x * a.transpose() + &q).amax() < 1e-14);
    let a = &a * 0.2;
    let x = matrices::discrete_lyapunov(&a, &q).unwrap();
    assert!((&a * &x * a.transpose() - &x + &q).amax() < 1e-14);
}

/// Checks margins of an unstable loop, and of loops whose response is real at all frequencies and therefore
/// has no crossings of the real axis.
#[test]
fn missing_margins_are_none() {
    let margins = double_integrator().margins().unwrap();
    assert!(margins.gain.is_empty(), "{margins:?}");
    let [phase] = margins.phase[..] else { panic!("{margins:?}") };
    assert!(phase.degrees.abs() < 1e-6 && (phase.frequency - 1.0).abs() < 1e-9);
    assert!(margins.stability.distance < 1e-9);
    for k in [0.0, 2.0] {
        let margins = gain_system(k).margins().unwrap();
        assert!(margins.gain.is_empty() && margins.phase.is_empty(), "{margins:?}");
        assert!((margins.stability.distance - (1.0 + k)).abs() < 1e-12);
    }
    let margins = gain_system(-0.5).margins().unwrap();
    assert!(margins.gain.iter().all(|m| (m.factor - 2.0).abs() < 1e-12 && m.frequency == 0.0), "{margins:?}");
    // 3 / (s − 1): the minimum stabilising gain factor is a third.
    let held = system_without_feedthrough(dmatrix![1.0], dmatrix![3.0], dmatrix![1.0]).margins().unwrap();
    assert!((held.gain_reduction().unwrap().factor - 1.0 / 3.0).abs() < 1e-12);
}

#[test]
fn impossible_regulators_name_the_mode() {
    let diagonal_cost = |q: &[f64], r: f64| Cost::diagonal(q, &[r]);
    let stuck =
        system_without_feedthrough(dmatrix![-1.0, 0.0; 0.0, 2.0], dmatrix![1.0; 0.0], dmatrix![1.0, 1.0]);
    assert_error_message("no input controls the mode 2+0i", stuck.lqr(&diagonal_cost(&[1.0, 1.0], 1.0)));
    assert_error_message(
        "no input controls the mode 2+0i",
        stuck.place(&[complex_from_real(-1.0), complex_from_real(-3.0)]),
    );
    let error = stuck.lqr_held(&diagonal_cost(&[1.0, 1.0], 1.0), 0.1).unwrap_err();
    let Error::Unstabilizable { mode } = error else { panic!("{error}") };
    assert!((mode.re - 0.2_f64.exp()).abs() < 1e-12);
    let double = double_integrator();
    assert_error_message("no output observes the mode 0+0i", double.lqr(&diagonal_cost(&[0.0, 0.0], 1.0)));
    assert_error_message("R is singular", double.lqr(&diagonal_cost(&[1.0, 1.0], 0.0)));
    assert_error_message("R is not symmetric and positive", double.lqr(&diagonal_cost(&[1.0, 1.0], -1.0)));
    assert_error_message(
        "Riccati's equation, with eigenvalues on the imaginary axis, did not converge",
        double.lqr(&diagonal_cost(&[-1.0, 1.0], 1.0)),
    );
    assert_error_message("expected 2 × 2 entries of Q, found 1 × 1", double.lqr(&diagonal_cost(&[1.0], 1.0)));
    assert_error_message(
        "Q has an entry that is not finite",
        double.lqr(&diagonal_cost(&[f64::NAN, 1.0], 1.0)),
    );
    let mute =
        system_without_feedthrough(dmatrix![-1.0, 0.0; 0.0, 2.0], dmatrix![1.0; 1.0], dmatrix![1.0, 0.0]);
    let noise_with_variance = |v: f64| Noise { states: DMatrix::identity(2, 2), outputs: dmatrix![v] };
    assert_error_message("no output observes the mode 2+0i", mute.kalman(&noise_with_variance(1.0)));
    assert_error_message(
        "the outputs' noise is singular",
        unstable_system().kalman(&noise_with_variance(0.0)),
    );
    assert_error_message(
        "the outputs' noise is not symmetric and positive",
        unstable_system().kalman(&noise_with_variance(-1.0)),
    );
    assert_error_message("expected 2 poles, found 1", double.place(&[complex_from_real(-1.0)]));
    let unpaired = "the pole -1+1i is not finite, or lacks its conjugate";
    assert_error_message(unpaired, double.place(&[Complex::new(-1.0, 1.0), Complex::new(-1.0, 1.0)]));
    let infinite = "the pole NaN+0i is not finite, or lacks its conjugate";
    assert_error_message(infinite, double.place(&[complex_from_real(f64::NAN), complex_from_real(-1.0)]));
}

#[test]
fn invalid_transfer_functions_are_errors() {
    let transfer_function = |n: &[f64], d: &[f64]| TransferFunction::new(n.to_vec(), d.to_vec());
    let improper = transfer_function(&[1.0, 0.0, 1.0], &[1.0, 1.0]).unwrap();
    let text = "improper: degree 2 over degree 1";
    assert_error_message(text, improper.state_space());
    assert_error_message(text, improper.step_figures());
    assert_error_message(text, improper.margins());
    assert_error_message(text, improper.factored().unwrap().matched(0.1));
    assert_error_message("improper: degree 1 over degree 0", TransferFunction::s().state_space());
    assert_error_message("a denominator of 0 is not allowed", transfer_function(&[1.0], &[0.0]));
    assert_error_message("a denominator of 0 is not allowed", transfer_function(&[1.0], &[]));
    assert_error_message(
        "a denominator of 0 is not allowed",
        transfer_function(&[1.0], &[1.0]).unwrap().divide(&transfer_function(&[0.0], &[1.0]).unwrap()),
    );
    assert_error_message(
        "the numerator has an entry that is not finite",
        transfer_function(&[f64::NAN], &[1.0]),
    );
    assert_error_message(
        "the denominator has an entry that is not finite",
        transfer_function(&[1.0], &[1.0, f64::INFINITY]),
    );
    let [one, minus] = [1.0, -1.0].map(TransferFunction::constant);
    let text = "the direct feedthrough of both systems forms an algebraic loop without a solution";
    assert_error_message(text, one.feedback(&minus));
    assert_error_message(text, gain_system(1.0).feedback_gain(&dmatrix![-1.0]));
    assert_error_message("a table of the polynomial of 0 is not allowed", Polynomial::new([0.0]).routh());
    assert_error_message(
        "the polynomial has an entry that is not finite",
        Polynomial::new([1.0, f64::NAN]).routh(),
    );
    assert_error_message(
        "the polynomial has an entry that is not finite",
        Polynomial::new([1.0, f64::NAN]).roots(),
    );
}

/// Checks `1 / (s + 1)³`: its step response is `1 − (1 + t + t²/2) e^{−t}`, and its mode is reported as
/// defective.
#[test]
fn repeated_poles_have_exact_results() {
    let triple = TransferFunction::new([1.0], [1.0, 3.0, 3.0, 1.0]).unwrap().state_space().unwrap();
    let times = triple.times(8.0, 30).unwrap();
    let response = triple.step_response(0, &times).unwrap().output(0).unwrap();
    for (t, y) in times.iter().zip(response) {
        assert!((y - (1.0 - (1.0 + t + 0.5 * t * t) * (-t).exp())).abs() < 1e-12, "{y} at {t}");
    }
    let modes = triple.modes().unwrap();
    assert!(modes.iter().any(linkwork_design::Mode::is_defective), "{modes:?}");
    assert!(modes.iter().all(|mode| (mode.exponent + 1.0).norm() < 1e-4), "{modes:?}");
    let double = double_integrator();
    let gain = double.place(&[complex_from_real(-1.0), complex_from_real(-1.0)]).unwrap();
    assert!((gain - dmatrix![1.0, 2.0]).amax() < 1e-12);
}

#[test]
fn unknown_names_suggest_the_nearest() {
    let named = stable_system().with_states([("alpha", "rad"), ("q", "rad/s")]).unwrap();
    assert_error_message(
        "no state `alhpa`, perhaps `alpha`; there are alpha, q",
        named.of_states(&["alhpa"]),
    );
    assert_error_message("the state `q` is requested twice", named.of_states(&["q", "alpha", "q"]));
    assert_error_message("no output `y2`, perhaps `y1`; there are y1", named.channel("y2", "u1"));
    assert_error_message("no input `elevator`; there are u1", named.step_response("elevator", &[0.0]));
    assert_error_message("no input `3`; there are u1", named.step_response(3, &[0.0]));
    assert_error_message(
        "expected 2 states, found 3",
        named.clone().with_states([("a", ""), ("b", ""), ("c", "")]),
    );
    // Without the states of an aircraft, no mode has a name.
    assert!(FlightModes::from_system(&named).unwrap().named_modes().is_empty());
}

/// Checks systems without states, inputs or outputs: results are empty, zero or an error, never a panic.
#[test]
fn systems_without_states_or_signals_do_not_panic() {
    let still = gain_system(2.0);
    assert!(still.modes().unwrap().is_empty() && still.poles().unwrap().is_empty());
    assert!(still.zeros().unwrap().is_empty() && still.hankel_values().unwrap().is_empty());
    assert_eq!(still.transfer_function(0, 0).unwrap().to_string(), "2");
    assert_eq!(still.step_response(0, &[0.0, 1.0]).unwrap().output(0).unwrap(), [2.0, 2.0]);
    assert_eq!(still.discretize(0.1, Hold::Zero).unwrap().d()[(0, 0)], 2.0);
    assert_eq!(still.peak_gain().unwrap().gain, 2.0);
    let alone = system_without_feedthrough(dmatrix![-1.0], DMatrix::zeros(1, 0), dmatrix![1.0]);
    assert!(!alone.is_controllable().unwrap() && alone.zeros().unwrap().is_empty());
    assert_eq!((alone.h2_norm().unwrap(), alone.peak_gain().unwrap().gain), (0.0, 0.0));
    let unseen = system_without_feedthrough(dmatrix![-1.0], dmatrix![1.0], DMatrix::zeros(0, 1));
    assert!(!unseen.is_observable().unwrap());
    assert_eq!(unseen.minimal(0.0).unwrap().order(), 0);
}

#[test]
fn pictures_without_data_are_errors() {
    let text = "no picture: no finite values to draw";
    let nothing = stable_system().frequency_response(0, 0, &[]).unwrap();
    assert_error_message(text, picture::bode(&nothing));
    assert_error_message(text, picture::nyquist(&nothing));
    assert_error_message(text, picture::history(&stable_system().step_response(0, &[]).unwrap(), "nothing"));
    assert_error_message(text, picture::Chart::over_time("nothing", "y").curve("a", [(0.0, f64::NAN)]).svg());
    assert_error_message("no picture: there are no modes", picture::modes(&[]));
    assert_error_message("the gain has an entry that is not finite", stable_system().root_locus(&[f64::NAN]));
}

#[mechanism(gravity = -9.81 * y, derivatives)]
struct Pendulum {
    lag: f64,
    command: Input,
    #[state(rate = (command - torque) / lag)]
    torque: State,
    #[body(mass = 2, com = -0.5 * y)]
    bob: Body,
    #[joint(ground -> bob, about = z)]
    hinge: Pin,
    #[acts(on = hinge, value = torque)]
    motor: Torque,
    #[output(hinge)]
    angle: Scalar,
}

/// Checks the errors of linearisations about a state that is no solution of a trim, and about the solution of
/// another trim.
#[test]
fn linearisation_off_steady_state_is_an_error() {
    let whole = Pendulum { lag: 0.2, torque: 0.0 };
    let whole = whole.extended();
    let rest = equilibrium(&whole);
    let hanging = rest.find().unwrap();
    assert!(rest.linear_system(&hanging).is_ok());
    // g / l sin 0.1 = 1.9587 rad/s².
    let mut beside = hanging.clone();
    beside.q[0] = 0.1;
    let text = "not steady: `hinge''` has a residual of -1.959e0";
    assert_error_message(text, rest.linear_system(&beside));
    assert_error_message(text, rest.measured_system(&beside));
    assert_error_message("expected 0 states of first order, found 1", rest.second_order_form(&hanging));
    let mut late = hanging.clone();
    (late.q[0], late.v[1], late.u[0]) = (0.0, 0.0, 0.3);
    assert_error_message("not steady: `torque'` has a residual of 1.500e0", rest.linear_system(&late));
    let tilted = equilibrium(&whole).inputs(["command"]).output("angle", 0.2);
    assert!(tilted.linear_system(&tilted.find().unwrap()).is_ok());
    assert_error_message("not steady: `angle` has a residual of -2.000e-1", tilted.linear_system(&hanging));
}

/// Checks the errors of wrongly posed trims: unknown names, repeated names, too few and too many unknowns.
#[test]
fn wrongly_posed_trims_are_errors() {
    let whole = Pendulum { lag: 0.2, torque: 0.0 };
    let whole = whole.extended();
    let equilibrium_problem = || equilibrium(&whole);
    let unknown_name_message =
        |kind: &str| format!("no {kind} `hing`, perhaps `hinge`; there are hinge, torque");
    assert_error_message(
        &unknown_name_message("coordinate"),
        equilibrium_problem().coordinates(["hing"]).find(),
    );
    assert_error_message(&unknown_name_message("coordinate"), equilibrium_problem().fix(["hing"]).find());
    assert_error_message(&unknown_name_message("coordinate"), equilibrium_problem().hold(["hing"]).find());
    assert_error_message(&unknown_name_message("speed"), equilibrium_problem().speeds(["hing"]).find());
    assert_error_message(
        &unknown_name_message("velocity"),
        equilibrium_problem().accelerating(["hing"]).find(),
    );
    assert_error_message(
        &unknown_name_message("velocity"),
        equilibrium_problem().acceleration("hing", 1.0).find(),
    );
    assert_error_message(
        "no input `comand`, perhaps `command`; there are command",
        equilibrium_problem().inputs(["comand"]).find(),
    );
    let problem_with_output_condition = || equilibrium_problem().inputs(["command"]).output("angle", 0.2);
    let angel = equilibrium_problem().inputs(["command"]).output("angel", 0.2);
    assert_error_message("no output `angel`, perhaps `angle`; there are angle", angel.find());
    assert_error_message(
        "the coordinate `hinge` is requested twice",
        equilibrium_problem().coordinates(["hinge", "hinge"]).find(),
    );
    assert_error_message(
        "the coordinate `hinge` is requested twice",
        equilibrium_problem().hold(["hinge"]).hold(["hinge"]).find(),
    );
    assert_error_message(
        "the input `command` is requested twice",
        problem_with_output_condition().inputs(["command"]).find(),
    );
    assert_error_message(
        "the output `angle` is requested twice",
        problem_with_output_condition().output("angle", 0.3).find(),
    );
    assert_error_message(
        "the velocity `hinge` is requested twice",
        equilibrium_problem().accelerating(["hinge"]).acceleration("hinge", 1.0).find(),
    );
    // Too many unknowns.
    assert_error_message(
        "the conditions do not determine hinge, torque', command at hinge 0.000000, torque' 0.000000, \
         command 0.000000: fix or prescribe one of them, add a condition, or take the nearest",
        equilibrium_problem().inputs(["command"]).find(),
    );
    // Too few unknowns, and equal numbers of unknowns and conditions without a solution.
    for (trim, start) in [
        (
            equilibrium_problem().output("angle", 0.2),
            "no steady state near the guess: 2 unknowns for 3 conditions, and `hinge''` is left at ",
        ),
        (
            equilibrium_problem().fix(["hinge"]).from([0.5].into()),
            "no steady state near the guess: one unknown for 2 conditions, and `torque'` is left at ",
        ),
        (
            equilibrium_problem().with_inputs([100.0].into()),
            "no steady state near the guess: 2 unknowns for 2 conditions, and `torque'` is left at ",
        ),
    ] {
        let text = trim.find().unwrap_err().to_string();
        assert!(text.starts_with(start) && text.contains(", at hinge "), "{text}");
    }
}
