//! Contenders in turns: whether they agree, and how long each takes.

use super::clock;
use super::contender::{Contender, Owner};

/// How far results may differ, relative to one plus the largest number of the column.
pub const TOLERANCE: f64 = 1e-9;
/// Seconds that are measured at a time, so that reading the clock costs nothing.
const BATCH: f64 = 1e-4;

/// What is known of a contender after it has been measured.
pub struct Measured {
    /// Whose it is.
    pub owner: Owner,
    /// Which of several.
    pub variant: String,
    /// Nanoseconds of a call.
    pub time: f64,
    /// Bytes of machine code.
    pub bytes: Option<u64>,
}

/// Leaves out what differs from the first, Pinocchio if it is there; tells of those of our own.
pub fn agree(
    contenders: &mut Vec<Box<dyn Contender>>,
    what: &str,
    (nv, states): (usize, usize),
    tolerance: f64,
) -> Vec<String> {
    let Some(first) = contenders.first_mut() else { return Vec::new() };
    let expected: Vec<Vec<f64>> = (0..states).map(|state| first.result(state)).collect();
    let mut wrong = Vec::new();
    contenders.retain_mut(|contender| {
        let errors = expected.iter().enumerate();
        let errors = errors.map(|(state, expected)| difference(&contender.result(state), expected, nv));
        let error = largest(errors);
        let good = error <= tolerance;
        if !good {
            let message =
                format!("{what}: {:?} {} is off by {error:e}", contender.owner(), contender.variant());
            eprintln!("{message}");
            if matches!(
                contender.owner(),
                Owner::Linkwork | Owner::Kept | Owner::Parameters | Owner::Prepared
            ) {
                wrong.push(message);
            }
        }
        good
    });
    wrong
}

/// How far a result is off, column by column.
pub fn difference(found: &[f64], expected: &[f64], nv: usize) -> f64 {
    assert_eq!(found.len(), expected.len(), "size of a result");
    let columns = found.chunks_exact(nv).zip(expected.chunks_exact(nv));
    largest(columns.map(|(found, expected)| {
        let error = largest(found.iter().zip(expected).map(|(x, y)| (x - y).abs()));
        error / (1.0 + largest(expected.iter().map(|y| y.abs())))
    }))
}

/// The largest of some numbers, or what is no number.
pub fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// Measures in turns, each for `budget` seconds; the least time counts.
pub fn time(contenders: &mut [Box<dyn Contender>], states: usize, budget: f64) -> Vec<Measured> {
    let seconds = |contender: &mut Box<dyn Contender>, passes: usize| {
        let start = clock::seconds();
        for _ in 0..passes {
            contender.pass();
        }
        (clock::seconds() - start) / passes as f64
    };
    let once = |contender: &mut Box<dyn Contender>| (seconds(contender, 1), seconds(contender, 1)).1;
    let passes: Vec<usize> =
        contenders.iter_mut().map(|c| (BATCH / once(c)).ceil().max(1.0) as usize).collect();
    let mut least = vec![f64::INFINITY; contenders.len()];
    let end = clock::seconds() + budget * contenders.len() as f64;
    while clock::seconds() < end {
        for (k, contender) in contenders.iter_mut().enumerate() {
            least[k] = least[k].min(seconds(contender, passes[k]));
        }
    }
    let measured = contenders.iter().zip(least).map(|(contender, least)| Measured {
        owner: contender.owner(),
        variant: contender.variant(),
        time: least * 1e9 / states as f64,
        bytes: contender.bytes(),
    });
    measured.collect()
}
