//! Compares the compiled accelerations and their derivatives with a numerical evaluation of Kane's equations.
//! This oracle belongs to the compiler's own tests and shares no code with the compiler. The mechanisms are
//! random and are defined in a file that the same generator writes.

#[path = "../macros/compiler/tests/oracle/jet.rs"]
mod jet;
#[allow(dead_code, reason = "the compiler's own test of the oracle needs the rest")]
#[path = "../macros/compiler/tests/oracle/kane.rs"]
mod kane;
#[path = "accelerations/mechanisms.rs"]
mod mechanisms;
#[allow(dead_code, reason = "the compiler's own test of the oracle needs the rest")]
#[path = "../macros/compiler/tests/oracle/motion.rs"]
mod motion;
#[allow(dead_code, reason = "the compiler's own test of the oracle needs the rest")]
#[path = "../macros/compiler/tests/oracle/random.rs"]
mod random;
#[path = "../macros/compiler/tests/oracle/spec.rs"]
mod spec;
#[path = "../macros/compiler/tests/oracle/words.rs"]
mod words;

use jet::{C, complex_from_real};
use kane::State;
use linkwork::nalgebra::SVector;
use spec::{GeneratorSettings, MechanismSpec};
use std::fmt::Write;

/// Number of random mechanisms that the test compiles.
const COUNT: u64 = 12;
/// Maximum difference between results, relative to the largest entry.
const TOLERANCE: f64 = 1e-9;
/// Imaginary step of the complex-step derivative: its square is below rounding error.
const STEP: f64 = 1e-40;

/// Returns the description of mechanism `k`: a random tree, and for every third `k` a mechanism with
/// identical limbs.
fn spec_of_random_mechanism(k: u64) -> MechanismSpec {
    let limbs = if k % 3 == 2 { 2 + k as usize % 2 } else { 0 };
    MechanismSpec {
        symbolic: false,
        ..spec::random_mechanism_spec(
            7_000 + k,
            GeneratorSettings { bodies: 5, limbs, decades: 0.5, noise: None },
        )
    }
}

/// Returns the text of the generated file `mechanisms.rs`.
fn generated_mechanisms_text() -> String {
    let mut out =
        String::from("//! Written by the test `generated_file_is_up_to_date`.\n\nuse linkwork::mechanism;\n");
    for k in 0..COUNT {
        let (arguments, item) =
            words::mechanism_source(&spec_of_random_mechanism(k), &format!("Random{k}"), ", derivatives");
        let about =
            format!("/// Random test mechanism {k}: bodies and joints with random masses and placements.");
        let _ = write!(out, "\n{about}\n#[mechanism({arguments})]\n{item}\n");
    }
    out
}

#[test]
fn generated_file_is_up_to_date() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/accelerations/mechanisms.rs");
    if std::env::var_os("LINKWORK_WRITE").is_some() {
        std::fs::write(path, generated_mechanisms_text()).unwrap();
    }
    let remove_whitespace = |text: &str| text.split_whitespace().collect::<String>();
    assert_eq!(
        remove_whitespace(&std::fs::read_to_string(path).unwrap()),
        remove_whitespace(&generated_mechanisms_text()),
        "write it anew with LINKWORK_WRITE=1"
    );
}

/// Splits complex numbers into values (real parts) and derivatives (imaginary parts over the step).
fn values_and_complex_step_derivatives(list: &[C]) -> (Vec<f64>, Vec<f64>) {
    list.iter().map(|x| (x.re, x.im / STEP)).unzip()
}

/// Solves `v̇ = M⁻¹ (τ − h)` by Gaussian elimination with row interchanges.
fn forward_dynamics((columns, bias): &(Vec<Vec<C>>, Vec<C>), tau: &[C]) -> Vec<C> {
    let n = bias.len();
    let mut rows: Vec<Vec<C>> =
        (0..n).map(|i| columns.iter().map(|column| column[i]).chain([tau[i] - bias[i]]).collect()).collect();
    for k in 0..n {
        let pivot_magnitude = |i: &usize| rows[*i][k].norm();
        let best = (k..n).max_by(|a, b| pivot_magnitude(a).total_cmp(&pivot_magnitude(b))).unwrap_or(k);
        rows.swap(k, best);
        let pivot = rows[k].clone();
        for row in rows.iter_mut().skip(k + 1) {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
        }
    }
    let mut x = vec![complex_from_real(0.0); n];
    for i in (0..n).rev() {
        let known: C = (i + 1..n).map(|j| rows[i][j] * x[j]).sum();
        x[i] = (rows[i][n] - known) / rows[i][i];
    }
    x
}

fn assert_close_entries(what: &str, k: u64, actual: &[f64], expected: &[f64]) {
    assert_eq!(actual.len(), expected.len());
    let scale = expected.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
    for (entry, (a, b)) in actual.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= TOLERANCE * scale, "{what} of mechanism {k}, entry {entry}: {a} and {b}");
    }
}

macro_rules! check {
    ($($k:literal $name:ident)*) => {$(
        let spec = spec_of_random_mechanism($k);
        let counts = kane::coordinate_and_velocity_counts(&spec);
        assert_eq!((mechanisms::$name::NQ, mechanisms::$name::NV), counts);
        let mut random = random::Random::new($k);
        let m = mechanisms::$name {};
        let q = m.integrate(&m.neutral(), &SVector::from_fn(|_, _| random.uniform_number(1.2)));
        let v = SVector::<f64, { mechanisms::$name::NV }>::from_fn(|_, _| random.uniform_number(1.0));
        let tau = SVector::<f64, { mechanisms::$name::NV }>::from_fn(|_, _| random.uniform_number(2.0));
        let state = State::new(q.as_slice(), v.as_slice(), tau.as_slice());
        let (by_q, by_v, inverse) = m.forward_dynamics_derivatives(&q, &v, &tau);
        let at_state = kane::mass_and_bias(&spec, &state.q, &state.v);
        let (accelerations, _) = values_and_complex_step_derivatives(&forward_dynamics(&at_state, &state.a));
        assert_close_entries("v̇", $k, m.forward_dynamics(&q, &v, &tau).as_slice(), &accelerations);
        let mut expected = [Vec::new(), Vec::new(), Vec::new()];
        for k in 0..mechanisms::$name::NV {
            let step = C::new(0.0, STEP);
            let q = kane::configuration_after_imaginary_step(&spec, &state.q, k, STEP);
            let (mut v, mut tau) = (state.v.clone(), state.a.clone());
            (v[k], tau[k]) = (v[k] + step, tau[k] + step);
            let moved = kane::mass_and_bias(&spec, &q, &state.v);
            let faster = kane::mass_and_bias(&spec, &state.q, &v);
            expected[0].extend(values_and_complex_step_derivatives(&forward_dynamics(&moved, &state.a)).1);
            expected[1].extend(values_and_complex_step_derivatives(&forward_dynamics(&faster, &state.a)).1);
            expected[2].extend(values_and_complex_step_derivatives(&forward_dynamics(&at_state, &tau)).1);
        }
        assert_close_entries("∂v̇/∂q", $k, by_q.as_slice(), &expected[0]);
        assert_close_entries("∂v̇/∂v", $k, by_v.as_slice(), &expected[1]);
        assert_close_entries("M⁻¹", $k, inverse.as_slice(), &expected[2]);
        assert_close_entries("M⁻¹ alone", $k, m.mass_matrix_inverse(&q).as_slice(), &expected[2]);
    )*};
}

#[test]
fn accelerations_and_derivatives_satisfy_kanes_equations() {
    check! {
        0 Random0 1 Random1 2 Random2 3 Random3 4 Random4 5 Random5
        6 Random6 7 Random7 8 Random8 9 Random9 10 Random10 11 Random11
    }
}
