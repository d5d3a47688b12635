//! Peaks, crossings, step responses and stable gains of random systems, compared with closed forms.

use linkwork_design::nalgebra::{Complex, DMatrix};
use linkwork_design::{Error, GainRange, Hold, Polynomial, StateSpace, StepFigures, TransferFunction};
use std::f64::consts::PI;

type C = Complex<f64>;

struct Random(u64);

impl Random {
    /// Returns a random number between zero and one.
    fn unit_number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn uniform_number(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit_number()
    }

    /// Returns a number whose logarithm is uniformly distributed.
    fn log_uniform_number(&mut self, low: f64, high: f64) -> f64 {
        self.uniform_number(low.ln(), high.ln()).exp()
    }
}

fn transfer_function(numerator: &[f64], denominator: &[f64]) -> TransferFunction {
    TransferFunction::new(numerator.to_vec(), denominator.to_vec()).unwrap()
}

fn state_space(numerator: &[f64], denominator: &[f64]) -> StateSpace {
    transfer_function(numerator, denominator).state_space().unwrap()
}

#[track_caller]
fn assert_relatively_close(what: &str, found: f64, expected: f64, relative: f64) {
    assert!(
        (found - expected).abs() <= relative * expected.abs(),
        "{what}: expected {expected}, found {found}"
    );
}

/// Returns the maximum of `|(s² + e s + f) / (s² + b s + c)|` over frequencies. In `x = ω²` the square of the
/// magnitude is a ratio of quadratics, which is stationary at the roots of another quadratic.
fn biproper_peak(e: f64, f: f64, b: f64, c: f64) -> f64 {
    let (n, d) = ([1.0, e * e - 2.0 * f, f * f], [1.0, b * b - 2.0 * c, c * c]);
    let squared_gain = |x: f64| ((f - x).powi(2) + e * e * x) / ((c - x).powi(2) + b * b * x);
    let (p, q, r) = (d[1] - n[1], 2.0 * (d[2] - n[2]), n[1] * d[2] - n[2] * d[1]);
    let root = (q * q - 4.0 * p * r).max(0.0).sqrt();
    let stationary = [(-q + root) / (2.0 * p), (-q - root) / (2.0 * p)];
    let squares = stationary.into_iter().filter(|x| *x > 0.0).map(squared_gain);
    squares.fold(squared_gain(0.0).max(1.0), f64::max).sqrt()
}

#[test]
fn biproper_systems_have_closed_form_peak_gain() {
    let mut random = Random(1);
    for k in 0..1000 {
        let light = k % 4 == 3;
        let (c, f) = (random.uniform_number(0.1, 50.0), random.uniform_number(0.0, 50.0));
        let random_damping_coefficient = |random: &mut Random| {
            if light { random.log_uniform_number(1e-5, 1.0) } else { random.uniform_number(0.05, 10.0) }
        };
        let (b, e) = (random_damping_coefficient(&mut random), random_damping_coefficient(&mut random));
        let system = state_space(&[1.0, e, f], &[1.0, b, c]);
        let expected = biproper_peak(e, f, b, c);
        assert_relatively_close(
            &format!("{e} {f} {b} {c}"),
            system.peak_gain().unwrap().gain,
            expected,
            1e-9,
        );
        if k % 3 == 0 {
            let held = system.discretize(0.05, Hold::Tustin).unwrap();
            assert_relatively_close("Tustin's", held.peak_gain().unwrap().gain, expected, 1e-7);
        }
    }
}

/// Compares the peak gain of a system with two inputs and outputs with SLICOT's AB13DD (slycot 0.7.1,
/// tolerance 1e-13), which returns 1.414487935024265 at 4.638148816470194 rad/s. The largest singular value
/// of `D` is one; that of the response is larger.
#[test]
fn peak_gain_of_two_channels_matches_slicot() {
    let system = StateSpace::new(
        DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, -16.0, -4.0, 0.0, 0.0, 1.0, -1.0]),
        DMatrix::from_row_slice(3, 2, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        DMatrix::from_row_slice(2, 3, &[-9.0, 1.0, 0.0, 0.0, 0.2, 0.1]),
        DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 0.5]),
    );
    let peak = system.unwrap().peak_gain().unwrap();
    assert_relatively_close("gain", peak.gain, 1.414487935024265, 1e-11);
    assert_relatively_close("frequency", peak.frequency, 4.638148816470194, 1e-6);
}

/// Checks that loops whose magnitude does not cross one have no phase margins: all-passes, whose magnitude is
/// one, and `s / (s + a)`, whose magnitude only approaches one.
#[test]
fn loops_without_gain_crossings_have_no_phase_margin() {
    let mut random = Random(2);
    for _ in 0..200 {
        let (a, b) = (random.log_uniform_number(1e-2, 1e2), random.log_uniform_number(1e-2, 1e2));
        let all_pass = state_space(&[1.0, -(a + b), a * b], &[1.0, a + b, a * b]);
        assert_relatively_close("gain", all_pass.peak_gain().unwrap().gain, 1.0, 1e-12);
        let margins = all_pass.margins().unwrap();
        assert!(margins.phase.is_empty(), "{margins:?}");
        // The all-pass reaches −1 where the average lag of both factors is 90°.
        let [gain] = margins.gain[..] else { panic!("{margins:?}") };
        assert_relatively_close("factor", gain.factor, 1.0, 1e-9);
        assert_relatively_close("frequency", gain.frequency, (a * b).sqrt(), 1e-9);
        assert!(margins.stability.distance < 1e-9, "{margins:?}");
        for washout in [state_space(&[1.0, 0.0], &[1.0, a]), state_space(&[a], &[1.0, a])] {
            for loose in [washout.discretize(0.1, Hold::Tustin).unwrap(), washout] {
                let margins = loose.margins().unwrap();
                assert!(margins.gain.is_empty() && margins.phase.is_empty(), "{a}: {margins:?}");
            }
        }
        // A pole at zero that a zero cancels: (s + a) / (s − a) begins at −1.
        let cancelled = state_space(&[1.0, a, 0.0], &[1.0, -a, 0.0]).margins().unwrap();
        assert!(cancelled.stability.distance < 1e-6, "{cancelled:?}");
    }
}

/// Checks `k / (s (s + a) (s + b))`, which is real and negative at `ω = √(a b)` with magnitude
/// `k / (a b (a + b))`. Tustin's rule changes the frequency only. Neither loop has a margin at zero
/// frequency, where there is a pole, or at the Nyquist frequency, where there is a zero.
#[test]
fn integrator_loops_have_closed_form_gain_margins() {
    let mut random = Random(3);
    for _ in 0..120 {
        let (a, b) = (random.log_uniform_number(0.1, 10.0), random.log_uniform_number(0.1, 10.0));
        let (k, h) = (random.log_uniform_number(1e-3, 1e3), random.log_uniform_number(1e-3, 0.3));
        let system = state_space(&[k], &[1.0, a + b, a * b, 0.0]);
        let (factor, frequency) = (a * b * (a + b) / k, (a * b).sqrt());
        let held = system.discretize(h, Hold::Tustin).unwrap().margins().unwrap();
        let found = system.margins().unwrap();
        for (margins, frequency) in [(&found, frequency), (&held, 2.0 / h * (0.5 * h * frequency).atan())] {
            let [gain] = margins.gain[..] else { panic!("{a} {b} {k} {h}: {margins:?}") };
            assert_relatively_close("factor", gain.factor, factor, 1e-7);
            assert_relatively_close("frequency", gain.frequency, frequency, 1e-7);
            assert_eq!(margins.phase.len(), 1, "{a} {b} {k} {h}: {margins:?}");
        }
        assert_relatively_close("distance", held.stability.distance, found.stability.distance, 1e-6);
    }
}

/// Checks `k / (s⁵ + a s⁴ + b s³ + c s² + d s)`, which is real where `ω⁴ − b ω² + d = 0`, and there has the
/// value `k / (a ω⁴ − c ω²)`. In many of these loops a bisection meets the root of a derivative exactly.
#[test]
fn loops_with_two_real_crossings_have_margins_at_the_negative_ones() {
    let mut random = Random(5);
    for _ in 0..1000 {
        let [a, c, d, k] = [0; 4].map(|_| random.log_uniform_number(0.1, 1e6));
        let b = 2.0 * d.sqrt() * (1.0 + random.log_uniform_number(1e-3, 1e3));
        let larger_square = b / 2.0 + (b * b / 4.0 - d).sqrt();
        let expected: Vec<[f64; 2]> = [d / larger_square, larger_square]
            .into_iter()
            .filter(|square| a * square < c)
            .map(|square| [square.sqrt(), square * (c - a * square) / k])
            .collect();
        let found = transfer_function(&[k], &[1.0, a, b, c, d, 0.0]).margins().unwrap();
        assert_eq!(found.gain.len(), expected.len(), "{a} {b} {c} {d} {k}: {found:?}");
        for (margin, [frequency, factor]) in found.gain.iter().zip(expected) {
            assert_relatively_close("frequency", margin.frequency, frequency, 1e-9);
            // The difference of the two terms of the real part may have few digits.
            let terms = (c + a * frequency * frequency) * frequency * frequency / k;
            assert!((margin.factor - factor).abs() < 1e-9 * terms, "{margin:?} {factor}");
        }
    }
}

/// Checks the stability margins of an integrator with a zero-order hold, `h / (z − 1)`: it is real at the
/// Nyquist frequency only, with magnitude `h / 2`, and has magnitude one at `sin(ω h / 2) = h / 2`. A double
/// integrator discretised by Tustin's rule is real at all frequencies.
#[test]
fn held_integrator_margins_match_closed_form() {
    let mut random = Random(4);
    for _ in 0..200 {
        let h = random.log_uniform_number(1e-3, 1.0);
        let margins = state_space(&[1.0], &[1.0, 0.0]).discretize(h, Hold::Zero).unwrap().margins().unwrap();
        let ([gain], [phase]) = (&margins.gain[..], &margins.phase[..]) else { panic!("{h}: {margins:?}") };
        assert_relatively_close("factor", gain.factor, 2.0 / h, 1e-9);
        assert_relatively_close("frequency", gain.frequency, PI / h, 1e-12);
        let half = (0.5 * h).asin();
        assert_relatively_close("frequency", phase.frequency, 2.0 * half / h, 1e-9);
        assert_relatively_close("degrees", phase.degrees, 90.0 - half.to_degrees(), 1e-9);
        assert_relatively_close("distance", margins.stability.distance, 1.0 - 0.5 * h, 1e-12);
        let double = state_space(&[1.0], &[1.0, 0.0, 0.0]).discretize(h, Hold::Tustin).unwrap();
        let margins = double.margins().unwrap();
        assert!(margins.gain.is_empty(), "{h}: {margins:?}");
        let [phase] = margins.phase[..] else { panic!("{h}: {margins:?}") };
        assert_relatively_close("frequency", phase.frequency, 2.0 / h * (0.5 * h).atan(), 1e-9);
    }
    // Lead compensator for a motor with a lag, with a hold of 0.1 s: recomputed with 50 digits (mpmath).
    let held = state_space(&[2.0, 1.0], &[1.0, 3.0, 2.0, 0.0]).discretize(0.1, Hold::Zero).unwrap();
    let margins = held.margins().unwrap();
    let [low, high] = margins.gain[..] else { panic!("{margins:?}") };
    assert_relatively_close("factor", low.factor, 26.185347040842, 1e-11);
    assert_relatively_close("frequency", low.frequency, 6.9937676541209, 1e-11);
    assert_relatively_close("factor", high.factor, 4822.08927739, 1e-8);
    assert_eq!(margins.gain_reduction(), None);
}

/// Checks `k / (s (s + a) (s + b))` with crossings up to 15 decades apart: the response is real at `√(a b)`,
/// and has magnitude one where `x (x + a²) (x + b²) = k²` with `x = ω²`.
#[test]
fn crossings_decades_apart_are_found() {
    let mut random = Random(9);
    for _ in 0..300 {
        let (a, b) = (random.log_uniform_number(1e-3, 1e3), random.log_uniform_number(1e-3, 1e3));
        let k = random.log_uniform_number(1e-12, 1e12);
        let open = transfer_function(&[k], &[1.0, a + b, a * b, 0.0]);
        let margins = open.margins().unwrap();
        let ([gain], [phase]) = (&margins.gain[..], &margins.phase[..]) else {
            panic!("{a} {b} {k}: {margins:?}")
        };
        assert_relatively_close("frequency", gain.frequency, (a * b).sqrt(), 1e-13);
        assert_relatively_close("factor", gain.factor, a * b * (a + b) / k, 1e-13);
        let x = phase.frequency.powi(2);
        assert_relatively_close("magnitude", x * (x + a * a) * (x + b * b), k * k, 1e-12);
        let lag = (phase.frequency / a).atan() + (phase.frequency / b).atan();
        assert_relatively_close("degrees", phase.degrees, 90.0 - lag.to_degrees(), 1e-9);
        // With a zero-order hold of 1 s, an integrator of gain `k` has magnitude one at `2 asin(k / 2)`.
        let held =
            transfer_function(&[k.min(1.0)], &[1.0, -1.0]).with_period(1.0).unwrap().margins().unwrap();
        let ([gain], [phase]) = (&held.gain[..], &held.phase[..]) else { panic!("{k}: {held:?}") };
        assert_relatively_close("frequency", phase.frequency, 2.0 * (0.5 * k.min(1.0)).asin(), 1e-13);
        assert_relatively_close("factor", gain.factor, 2.0 / k.min(1.0), 1e-13);
    }
}

/// Compares all crossings of loops with large and small gains with values recomputed with 60 digits (mpmath).
#[test]
fn crossings_of_extreme_gain_loops_match_reference() {
    let steep = transfer_function(
        &[8382104296.556898, 26490146733.51389, 65074465968.99992, 93444242998.93744],
        &[
            1.0,
            -0.5152020682763674,
            1.2074879781514056,
            -0.7767410453600813,
            0.002016026377416458,
            -0.001383857497498535,
        ],
    );
    let slow = transfer_function(
        &[-1714957.3087524266],
        &[
            1.0,
            4.8016267146869085,
            1.0542071457621687,
            0.2738782644189882,
            -0.0007385319316432803,
            1.5650073620452797e-06,
            0.0,
        ],
    );
    let wide = transfer_function(
        &[0.11444153383927728, 167.75050094755014, 58143.63665266256],
        &[
            1.0,
            -0.7768608453432341,
            23.407347795049848,
            1.0447362983656336,
            2.3242893998160503,
            0.09534291584289714,
            0.006677738576904043,
            0.0,
        ],
    );
    let weak =
        transfer_function(&[2.2212423715779894e-12, 6.663565009317896e-15], &[1.0, 5.657373680400875, 0.0]);
    let gains: [&[[f64; 2]]; 4] = [
        &[[0.0, 0.001383857497498535 / 93444242998.93744], [0.04131015381617908, 6.405517808976807e-16]],
        &[[0.00239056835589427, 2.4811137685910916e-15], [0.23881567495549713, 1.915898294253801e-09]],
        &[[0.05442139518586992, 4.698567604304131e-09], [713.5845483346278, 787025555371896.5]],
        &[],
    ];
    let phases = [
        [91553.83276991732, -0.002300198663442053],
        [10.790929269990698, -155.8287840426211],
        [5.669252226295807, -116.58429641104428],
        [1.17785484674679e-15, 90.00000000002248],
    ];
    for ((open, gains), [frequency, degrees]) in [steep, slow, wide, weak].iter().zip(gains).zip(phases) {
        for (margins, exact) in
            [(open.margins().unwrap(), 1e-12), (open.state_space().unwrap().margins().unwrap(), 1e-6)]
        {
            assert_eq!(margins.gain.len(), gains.len(), "{open}: {margins:?}");
            for (found, [frequency, factor]) in margins.gain.iter().zip(gains) {
                assert_relatively_close("frequency", found.frequency, *frequency, exact);
                assert_relatively_close("factor", found.factor, *factor, exact);
            }
            let [phase] = margins.phase[..] else { panic!("{open}: {margins:?}") };
            assert_relatively_close("frequency", phase.frequency, frequency, exact);
            assert_relatively_close("degrees", phase.degrees, degrees, exact);
        }
    }
}

/// Checks that `((z − 1) / h)^k` times the matched system tends to `s^k` times the continuous system for low
/// frequencies.
#[test]
fn matched_systems_preserve_low_frequencies() {
    let pole_zero_matched_coefficients = |g: &TransferFunction, h: f64| {
        let matched = g.factored().unwrap().matched(h).unwrap().transfer_function();
        (matched.numerator().coefficients().to_vec(), matched.denominator().coefficients().to_vec())
    };
    let mut random = Random(5);
    for _ in 0..300 {
        let (h, a) = (random.log_uniform_number(1e-4, 10.0), random.log_uniform_number(1e-8, 30.0));
        let (numerator, denominator) =
            pole_zero_matched_coefficients(&transfer_function(&[1.0], &[1.0, 0.0]), h);
        assert_eq!((numerator, denominator), (vec![h], vec![1.0, -1.0]));
        let (numerator, denominator) =
            pole_zero_matched_coefficients(&transfer_function(&[1.0], &[1.0, 0.0, 0.0]), h);
        assert_eq!(denominator, [1.0, -2.0, 1.0]);
        numerator.iter().for_each(|found| assert_relatively_close("1 / s²", *found, 0.5 * h * h, 1e-14));
        // 1 / (s (s + a)): h (1 − e^{−a h}) (z + 1) / (2 a (z − 1) (z − e^{−a h})).
        let (numerator, _) = pole_zero_matched_coefficients(&transfer_function(&[1.0], &[1.0, a, 0.0]), h);
        let expected = -0.5 * h * (-a * h).exp_m1() / a;
        numerator.iter().for_each(|found| assert_relatively_close("1 / (s (s + a))", *found, expected, 1e-9));
        // a / (s + a) and s / (s + a), whose gains stay accurate for poles near zero.
        let (numerator, _) = pole_zero_matched_coefficients(&transfer_function(&[a], &[1.0, a]), h);
        assert_relatively_close("a / (s + a)", numerator[0], -(-a * h).exp_m1(), 1e-12);
        let (numerator, _) = pole_zero_matched_coefficients(&transfer_function(&[1.0, 0.0], &[1.0, a]), h);
        assert_relatively_close("s / (s + a)", numerator[0], -(-a * h).exp_m1() / (a * h), 1e-12);
    }
    // An oscillation at the sampling frequency is indistinguishable from a pole at zero.
    let aliased = transfer_function(&[1.0], &[1.0, 0.0, 4.0 * PI * PI]).factored().unwrap();
    assert_eq!(aliased.matched(1.0), Err(Error::Singular { what: "the gain of the matched system at rest" }));
}

/// Returns the deviation of the step response of `ω² / (s² + 2 ζ ω s + ω²)` from its final value, with time
/// `t` in units of `1 / ω`.
fn oscillation_deviation(zeta: f64, t: f64) -> f64 {
    let damped = (1.0 - zeta * zeta).sqrt();
    -(-zeta * t).exp() * ((damped * t).cos() + zeta / damped * (damped * t).sin())
}

/// Returns the first time at which the step response of an oscillator reaches a level, by bisection before
/// the first peak.
fn first_time_at_level(zeta: f64, level: f64) -> f64 {
    let (mut low, mut high) = (0.0, PI / (1.0 - zeta * zeta).sqrt());
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if 1.0 + oscillation_deviation(zeta, middle) < level { low = middle } else { high = middle }
    }
    low
}

#[test]
fn second_order_step_responses_match_closed_forms() {
    let mut random = Random(6);
    for _ in 0..1000 {
        let (zeta, omega) = (random.log_uniform_number(1e-6, 0.95), random.log_uniform_number(1e-2, 1e3));
        let final_value = random.uniform_number(-5.0, 5.0);
        let square = omega * omega;
        let system = state_space(&[final_value * square], &[1.0, 2.0 * zeta * omega, square]);
        let figures = system.step_figures().unwrap();
        let damped = (1.0 - zeta * zeta).sqrt();
        let part = (-PI * zeta / damped).exp();
        assert_relatively_close("overshoot", figures.overshoot, 100.0 * part, 1e-9);
        assert_relatively_close("peak", figures.peak, final_value.abs() * (1.0 + part), 1e-10);
        assert_relatively_close("peak time", figures.peak_time * omega, PI / damped, 1e-7);
        assert_relatively_close(
            "rise time",
            figures.rise_time * omega,
            first_time_at_level(zeta, 0.9) - first_time_at_level(zeta, 0.1),
            1e-8,
        );
        // The last extremum outside the band is at half period k; the response enters the band before the
        // next one.
        let last = (50.0_f64.ln() * damped / (zeta * PI)).floor();
        let settled = figures.settling_time * omega;
        let half = PI / damped;
        assert!(settled > last * half && settled < (last + 1.0) * half, "{zeta}: {settled}");
        // Rounding of the natural frequency shifts the phase after many periods.
        let tolerance = 1e-10 + 1e-13 / zeta;
        assert!((oscillation_deviation(zeta, settled).abs() - 0.02).abs() < tolerance, "{zeta}: {settled}");
        let trough = final_value * (1.0 - part * part);
        let turns = [final_value * (1.0 + part), if part * part > 0.1 { trough } else { 0.9 * final_value }];
        assert_relatively_close("least", figures.least_after_rise, turns[0].min(turns[1]), 1e-8);
        assert_relatively_close("largest", figures.largest_after_rise, turns[0].max(turns[1]), 1e-8);
    }
}

/// Checks the step response of a fast oscillation on a slow rise: `½ / (s + 1) + ½ ω² / (s² + 0.1 ω s + ω²)`
/// with `ω` = 1000 reaches 90 % of its final value within the first half period. The expected times were
/// computed with 50 digits (mpmath).
#[test]
fn step_response_values_of_two_time_scales_are_found() {
    let slow = transfer_function(&[0.5], &[1.0, 1.0]);
    let both = slow.plus(&transfer_function(&[5e5], &[1.0, 100.0, 1e6])).unwrap();
    let figures = both.step_figures().unwrap();
    assert_relatively_close("rise time", figures.rise_time, 0.0021301006296717387, 1e-8);
    assert_relatively_close("settling time", figures.settling_time, 25.0_f64.ln(), 1e-9);
    assert_eq!((figures.overshoot, figures.peak_time), (0.0, f64::INFINITY));
}

/// Checks `1 / (s + 1)⁸`, whose poles coincide: the step response is `1 − (1 + t + … + t⁷ / 7!) e^{−t}`.
#[test]
fn repeated_poles_have_closed_form_step_response() {
    let denominator = Polynomial::from_roots(&[C::new(-1.0, 0.0); 8]);
    let system = TransferFunction::quotient(&Polynomial::constant(1.0), &denominator).unwrap();
    let figures = system.step_figures().unwrap();
    let distance_from_final_value = |t: f64| {
        let terms = (1..8).scan(1.0, |term, k| {
            *term *= t / f64::from(k);
            Some(*term)
        });
        (1.0 + terms.sum::<f64>()) * (-t).exp()
    };
    let time_to_reach_level = |level: f64| {
        let (mut low, mut high) = (0.0, 40.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if distance_from_final_value(middle) > level { low = middle } else { high = middle }
        }
        low
    };
    assert_relatively_close("settling time", figures.settling_time, time_to_reach_level(0.02), 1e-9);
    assert_relatively_close(
        "rise time",
        figures.rise_time,
        time_to_reach_level(0.1) - time_to_reach_level(0.9),
        1e-9,
    );
    assert_eq!((figures.overshoot, figures.undershoot, figures.peak_time), (0.0, 0.0, f64::INFINITY));
}

/// Checks the step-response values of an oscillator discretised with a zero-order hold against samples of the
/// continuous oscillator.
#[test]
fn sampled_step_figures_match_continuous_oscillator() {
    let mut random = Random(7);
    for _ in 0..200 {
        let (zeta, h) = (random.log_uniform_number(3e-4, 0.9), random.log_uniform_number(1e-2, 2.0));
        let held = state_space(&[1.0], &[1.0, 2.0 * zeta, 1.0]).discretize(h, Hold::Zero).unwrap();
        let StepFigures { rise_time, settling_time, overshoot, peak_time, .. } = held.step_figures().unwrap();
        let count = (12.0 / (zeta * h)) as usize;
        let samples: Vec<f64> = (0..count).map(|k| oscillation_deviation(zeta, h * k as f64)).collect();
        let first_sample_above = |level: f64| samples.iter().position(|e| 1.0 + e >= level).unwrap();
        let last = samples.iter().rposition(|e| e.abs() > 0.02).unwrap();
        assert_eq!(
            (rise_time / h).round() as usize,
            first_sample_above(0.9) - first_sample_above(0.1),
            "{zeta} {h}"
        );
        assert_eq!((settling_time / h).round() as usize, last + 1, "{zeta} {h}");
        let largest = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!((overshoot - 100.0 * largest.max(0.0)).abs() < 1e-8, "{zeta} {h}: {overshoot}, {largest}");
        if largest > 1e-6 {
            let at = oscillation_deviation(zeta, peak_time);
            assert!((at - largest).abs() < 1e-9, "{zeta} {h}: {at} at {peak_time}, {largest}");
        }
    }
    // A system with a zero at s = 0 has the final value zero, to which no step characteristics can refer.
    let at_rest = state_space(&[1.0, 0.0], &[1.0, 3.0, 2.0]);
    let error = Err(Error::Range { what: "a final value", value: 0.0 });
    assert_eq!(at_rest.step_figures(), error);
    assert_eq!(at_rest.discretize(0.1, Hold::Zero).unwrap().step_figures(), error);
}

fn stable_gain_ranges(one: &[f64], other: &[f64]) -> Vec<GainRange> {
    Polynomial::new(one.to_vec()).stable_gains(&Polynomial::new(other.to_vec())).unwrap()
}

/// Compares stable gain intervals with the Hurwitz criterion: `s³ + (3 + k) s² + 3 s + 1 + k` is stable for
/// `k > −1`, and `s³ + k (s² + 2 s + 1)` for `2 k² > k`. The sum of a stable polynomial and a multiple of
/// itself is stable for all gains except the one that cancels it.
#[test]
fn stable_gains_satisfy_hurwitz_criterion() {
    let (least, most) = (f64::NEG_INFINITY, f64::INFINITY);
    /// Denominator and numerator of a loop, and the expected ranges of stable gains.
    type StableGainCase<'a> = (&'a [f64], &'a [f64], &'a [(f64, f64)]);
    let cases: [StableGainCase<'_>; 8] = [
        (&[1.0, 3.0, 3.0, 1.0], &[1.0, 0.0, 1.0], &[(-1.0, most)]),
        (&[1.0, 0.0, 0.0, 0.0], &[1.0, 2.0, 1.0], &[(0.5, most)]),
        (&[1.0, 3.0, 2.0], &[1.0, 3.0, 2.0], &[(least, -1.0), (-1.0, most)]),
        (&[1.0, 3.0, 2.0], &[1.0], &[(-2.0, most)]),
        // The second polynomial has the higher degree: k s² + (1 + k) s + 1.
        (&[1.0, 1.0], &[1.0, 1.0, 0.0], &[(0.0, most)]),
        // Zeros at ±i: s + 1 + k (s² + 1).
        (&[1.0, 1.0], &[1.0, 0.0, 1.0], &[(0.0, most)]),
        // With a common factor on the imaginary axis, no gain is stable.
        (&[1.0, 1.0, 1.0, 1.0], &[1.0, 0.0, 1.0], &[]),
        // Small coefficients: 1e-9 s² + 1e-9 s + k.
        (&[1e-9, 1e-9, 0.0], &[1.0], &[(0.0, most)]),
    ];
    for (one, other, expected) in cases {
        let found = stable_gain_ranges(one, other);
        let has_same_gain_limits = |(found, (low, high)): (&GainRange, &(f64, f64))| {
            let is_equal_or_close = |a: f64, b: f64| a == b || (a - b).abs() < 1e-10;
            is_equal_or_close(found.low, *low) && is_equal_or_close(found.high, *high)
        };
        assert!(
            found.len() == expected.len() && found.iter().zip(expected).all(has_same_gain_limits),
            "{one:?} {other:?}: {found:?}"
        );
    }
}

/// Checks that a gain is within a range if and only if all roots are in the left half-plane.
#[test]
fn stable_gain_range_matches_root_locations() {
    let mut random = Random(8);
    for round in 0..600 {
        let mut polynomial = |degree: usize| {
            let mut product = Polynomial::constant(random.uniform_number(0.5, 2.0));
            while product.degree() < degree {
                let w = random.log_uniform_number(0.1, 10.0);
                let factor = match (random.unit_number(), degree - product.degree()) {
                    (x, 2..) if x < 0.3 => Polynomial::new([1.0, 0.0, w * w]),
                    (x, 2..) if x < 0.7 => {
                        Polynomial::new([1.0, random.uniform_number(-0.4, 2.0) * w, w * w])
                    }
                    (x, _) if x < 0.2 => Polynomial::new([1.0, 0.0]),
                    _ => Polynomial::new([1.0, w]),
                };
                product = &product * &factor;
            }
            product
        };
        let (one, other) = (polynomial(round % 6), polynomial(round / 6 % 6));
        let ranges = one.stable_gains(&other).unwrap();
        for pair in ranges.windows(2) {
            assert!(pair[0].high <= pair[1].low, "{one} and {other}: {ranges:?}");
        }
        for k in 0..60 {
            let gain = random.log_uniform_number(1e-4, 1e4) * if k % 2 == 0 { 1.0 } else { -1.0 };
            let roots = (&one + &other.scaled(gain)).roots().unwrap();
            let rightmost = roots.iter().map(|r| r.re / r.norm().max(1e-3)).fold(f64::NEG_INFINITY, f64::max);
            if rightmost.abs() > 1e-6 && rightmost.is_finite() {
                let within = ranges.iter().any(|range| range.low < gain && gain < range.high);
                assert_eq!(within, rightmost < 0.0, "{one} and {gain} times {other}: {ranges:?}, {roots:?}");
            }
        }
    }
}
