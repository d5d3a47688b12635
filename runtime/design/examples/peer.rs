//! Example that computes results for systems read from standard input, for comparison with python-control
//! (`benches/peers/run control`). Each system is a line `n m p`, then the entries of A, B, C, D by rows.
//! Prints one line per result, then the time in seconds of each kind of result.

use linkwork_design::matrices::{Cost, discrete_riccati, lyapunov, riccati};
use linkwork_design::{Error, Hold, StateSpace};
use nalgebra::{Complex, DMatrix};
use std::collections::BTreeMap;
use std::error::Error as Failure;
use std::io::Read;
use std::time::Instant;

type ResultNumbers = Result<Vec<f64>, Error>;

fn flatten_matrix_by_rows(m: &DMatrix<f64>) -> Vec<f64> {
    m.transpose().iter().copied().collect()
}

fn flatten_complex_numbers(all: &[Complex<f64>]) -> Vec<f64> {
    all.iter().flat_map(|x| [x.re, x.im]).collect()
}

/// Computes the named result of a system, such as `poles`, `zeros` or `care`.
fn compute_result(name: &str, s: &StateSpace) -> ResultNumbers {
    let (n, m) = s.b().shape();
    let cost_with_identity_weights = || Cost::new(DMatrix::identity(n, n), DMatrix::identity(m, m));
    Ok(match name {
        "poles" => flatten_complex_numbers(&s.poles()?),
        "zeros" => flatten_complex_numbers(&s.zeros()?),
        "lyap" => flatten_matrix_by_rows(&lyapunov(s.a(), &DMatrix::identity(n, n))?),
        "care" => flatten_matrix_by_rows(&riccati(s.a(), s.b(), &cost_with_identity_weights())?.x),
        "dare" => {
            let held = s.discretize(0.1, Hold::Zero)?;
            flatten_matrix_by_rows(&discrete_riccati(held.a(), held.b(), &cost_with_identity_weights())?.x)
        }
        "gram" => flatten_matrix_by_rows(&s.controllability_gramian()?),
        "h2" => vec![
            StateSpace::new(s.a().clone(), s.b().clone(), s.c().clone(), DMatrix::zeros(s.d().nrows(), m))?
                .h2_norm()?,
        ],
        "hinf" => vec![s.peak_gain()?.gain],
        "zoh" => {
            let held = s.discretize(0.1, Hold::Zero)?;
            [flatten_matrix_by_rows(held.a()), flatten_matrix_by_rows(held.b())].concat()
        }
        "response" => {
            let map = s.frequency_map()?;
            let mut all = Vec::new();
            for w in [0.01, 0.1, 1.0, 10.0, 100.0] {
                let values: Vec<_> = map.response(w)?.transpose().iter().copied().collect();
                all.extend(flatten_complex_numbers(&values));
            }
            all
        }
        _ => {
            let margins = s.channel(0, 0)?.margins()?;
            let gain = margins.gain_increase().map_or(f64::INFINITY, |m| m.factor);
            vec![
                gain,
                margins.nearest_phase().map_or(f64::INFINITY, |m| m.degrees.abs()),
                margins.stability.distance,
            ]
        }
    })
}

fn main() -> Result<(), Box<dyn Failure>> {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let mut numbers = text.split_whitespace().map(str::parse::<f64>);
    let mut times = BTreeMap::new();
    while let Some(n) = numbers.next() {
        let mut next_number_or_zero = || numbers.next().unwrap_or(Ok(0.0));
        let (n, m, p) = (n? as usize, next_number_or_zero()? as usize, next_number_or_zero()? as usize);
        let mut next_matrix = |rows: usize, columns: usize| -> Result<DMatrix<f64>, Box<dyn Failure>> {
            let entries =
                (0..rows * columns).map(|_| next_number_or_zero()).collect::<Result<Vec<_>, _>>()?;
            Ok(DMatrix::from_row_slice(rows, columns, &entries))
        };
        let system =
            StateSpace::new(next_matrix(n, n)?, next_matrix(n, m)?, next_matrix(p, n)?, next_matrix(p, m)?)?;
        for name in
            ["poles", "zeros", "lyap", "care", "dare", "gram", "h2", "hinf", "zoh", "response", "margins"]
        {
            let start = Instant::now();
            let found = compute_result(name, &system);
            *times.entry(name).or_insert(0.0) += start.elapsed().as_secs_f64();
            match found {
                Ok(values) => {
                    let words: Vec<String> = values.iter().map(|x| format!("{x:e}")).collect();
                    println!("{name} {}", words.join(" "));
                }
                Err(error) => println!("{name} error {error}"),
            }
        }
    }
    for (name, seconds) in times {
        println!("time {name} {seconds}");
    }
    Ok(())
}
