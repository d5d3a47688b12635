//! Comparison of the results of contenders, and measurement of their times in turns.

use super::clock;
use super::contender::{Contender, ContenderOwner};

/// Tolerance between results of contenders, relative to one plus the largest number of the column.
pub const TOLERANCE: f64 = 1e-9;
/// Duration of one measurement, s, which is long enough that reading the clock costs nothing.
const BATCH: f64 = 1e-4;

/// Measured time and code size of a contender.
pub struct ContenderMeasurement {
    /// Library that the contender belongs to.
    pub owner: ContenderOwner,
    /// Variant of the contender among the implementations of one library.
    pub variant: String,
    /// Processor time per call, ns.
    pub time: f64,
    /// Size of the contender's machine code, bytes.
    pub bytes: Option<u64>,
}

/// Removes contenders whose results differ from those of the first one (Pinocchio if present). Returns a
/// message for each removed contender of Linkwork.
pub fn remove_disagreeing_contenders(
    contenders: &mut Vec<Box<dyn Contender>>,
    what: &str,
    (nv, states): (usize, usize),
    tolerance: f64,
) -> Vec<String> {
    let Some(first) = contenders.first_mut() else { return Vec::new() };
    let expected: Vec<Vec<f64>> = (0..states).map(|state| first.result_at_state(state)).collect();
    let mut wrong = Vec::new();
    contenders.retain_mut(|contender| {
        let errors = expected.iter().enumerate();
        let errors = errors.map(|(state, expected)| {
            largest_relative_difference(&contender.result_at_state(state), expected, nv)
        });
        let error = largest_or_nan(errors);
        let good = error <= tolerance;
        if !good {
            let message =
                format!("{what}: {:?} {} is off by {error:e}", contender.owner(), contender.variant_name());
            eprintln!("{message}");
            if matches!(
                contender.owner(),
                ContenderOwner::Linkwork
                    | ContenderOwner::Kept
                    | ContenderOwner::Parameters
                    | ContenderOwner::Prepared
            ) {
                wrong.push(message);
            }
        }
        good
    });
    wrong
}

/// Returns the largest difference of a result, relative in each column.
pub fn largest_relative_difference(found: &[f64], expected: &[f64], nv: usize) -> f64 {
    assert_eq!(found.len(), expected.len(), "size of a result");
    let columns = found.chunks_exact(nv).zip(expected.chunks_exact(nv));
    largest_or_nan(columns.map(|(found, expected)| {
        let error = largest_or_nan(found.iter().zip(expected).map(|(x, y)| (x - y).abs()));
        error / (1.0 + largest_or_nan(expected.iter().map(|y| y.abs())))
    }))
}

/// Returns the largest number, or NaN if one of the numbers is NaN.
pub fn largest_or_nan(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// Measures the contenders in turns, each for `budget` seconds. The result is the minimum time.
pub fn measure_in_turns(
    contenders: &mut [Box<dyn Contender>],
    states: usize,
    budget: f64,
) -> Vec<ContenderMeasurement> {
    let seconds_per_pass = |contender: &mut Box<dyn Contender>, passes: usize| {
        let start = clock::thread_seconds();
        for _ in 0..passes {
            contender.evaluate_all_states();
        }
        (clock::thread_seconds() - start) / passes as f64
    };
    let seconds_after_warmup = |contender: &mut Box<dyn Contender>| {
        (seconds_per_pass(contender, 1), seconds_per_pass(contender, 1)).1
    };
    let passes: Vec<usize> =
        contenders.iter_mut().map(|c| (BATCH / seconds_after_warmup(c)).ceil().max(1.0) as usize).collect();
    let mut least = vec![f64::INFINITY; contenders.len()];
    let end = clock::thread_seconds() + budget * contenders.len() as f64;
    while clock::thread_seconds() < end {
        for (k, contender) in contenders.iter_mut().enumerate() {
            least[k] = least[k].min(seconds_per_pass(contender, passes[k]));
        }
    }
    let measured = contenders.iter().zip(least).map(|(contender, least)| ContenderMeasurement {
        owner: contender.owner(),
        variant: contender.variant_name(),
        time: least * 1e9 / states as f64,
        bytes: contender.machine_code_size(),
    });
    measured.collect()
}
