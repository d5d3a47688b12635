//! Why a result does not exist.

use nalgebra::Complex;
use std::fmt;

/// A number of things.
struct Counted(usize, &'static str);

impl fmt::Display for Counted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Counted(1, what) => write!(f, "one {what}"),
            Counted(n, what) => write!(f, "{n} {what}s"),
        }
    }
}

/// Why a result does not exist. Every variant names what is to blame.
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A matrix has another shape than the others ask for.
    Shape {
        /// The matrix.
        matrix: &'static str,
        /// Rows and columns that fit.
        expected: (usize, usize),
        /// Rows and columns that it has.
        found: (usize, usize),
    },
    /// A matrix, polynomial or list has an entry that is infinite or NaN.
    NotFinite {
        /// What has it.
        what: &'static str,
    },
    /// A signal of this name does not exist.
    Unknown {
        /// State, input or output.
        kind: &'static str,
        /// What was asked for.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// A signal of this name is asked for twice.
    Repeated {
        /// State, input or output.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// A number of signals or values that does not fit.
    Count {
        /// What is counted.
        what: &'static str,
        /// How many fit.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A sampling period that is not positive and finite, s.
    Period {
        /// What was given.
        period: f64,
    },
    /// Systems of different periods, or a discrete one where a continuous one is expected, or the reverse.
    Time {
        /// Periods that differ, s; none of a continuous system, zero for any period.
        periods: [Option<f64>; 2],
    },
    /// More zeros than poles: no state space, no response.
    Improper {
        /// Degree of the numerator.
        numerator: usize,
        /// Degree of the denominator.
        denominator: usize,
    },
    /// The result exists for stable systems alone.
    Unstable {
        /// A pole that is not stable.
        pole: Complex<f64>,
    },
    /// No input moves an unstable mode: no regulator exists.
    Unstabilizable {
        /// The eigenvalue of the mode.
        mode: Complex<f64>,
    },
    /// No output (or cost) shows a mode that must be seen: no estimator, or no best regulator, exists.
    Undetectable {
        /// The eigenvalue of the mode.
        mode: Complex<f64>,
    },
    /// A complex pole without its conjugate, or a pole that is not finite.
    Unpaired {
        /// The pole.
        pole: Complex<f64>,
    },
    /// A matrix cannot be inverted where it must be.
    Singular {
        /// The matrix or equation.
        what: &'static str,
    },
    /// A matrix that must be symmetric and positive (semi)definite is not.
    Indefinite {
        /// The matrix.
        matrix: &'static str,
    },
    /// The connection has an algebraic loop without a solution: `I + D₁ D₂` is singular.
    AlgebraicLoop,
    /// An iteration did not settle.
    NotConverged {
        /// The iteration.
        what: &'static str,
    },
    /// A result that is infinite.
    Infinite {
        /// The result.
        what: &'static str,
    },
    /// A value lies outside what has a meaning.
    Range {
        /// The value.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// The state of a mechanism does not fulfil its constraints, or they lose rank there.
    Constraint(linkwork::ConstraintError),
    /// No steady state near the guess fulfils all conditions.
    NoSteadyState {
        /// The condition that is violated most: an acceleration (with two primes), a constraint (its rate
        /// with a prime), an output.
        condition: String,
        /// What is left of it, in its own unit.
        residual: f64,
        /// How many conditions there are.
        conditions: usize,
        /// How many unknowns there are.
        unknowns: usize,
        /// The configuration, then the other unknowns, where the conditions are violated least.
        place: Vec<(String, f64)>,
    },
    /// The conditions of a steady state leave unknowns open: there are too many, or the equations are
    /// singular there.
    Undetermined {
        /// The unknowns that can change while all conditions hold.
        unknowns: Vec<String>,
        /// The configuration, then the other unknowns.
        place: Vec<(String, f64)>,
    },
    /// A linear motion was asked for about a state that is not steady.
    NotSteady {
        /// What should be zero, an acceleration with two primes, a rate with one; or the condition of a trim
        /// that does not hold.
        what: String,
        /// Its rate, m/s², rad/s² or rad/s; what is left of the condition.
        rate: f64,
    },
    /// Motions have no second-order form: forces depend on a coordinate without an independent speed of its
    /// own.
    NoSecondOrderForm {
        /// The coordinate.
        coordinate: String,
    },
    /// Stability by energy is not to be had.
    NoPotential {
        /// Why.
        why: &'static str,
    },
    /// A picture could not be drawn.
    Picture(String),
}

/// The text of `Display`, which `main` prints of an error that it returns.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape { matrix, expected: (r, c), found: (rows, columns) } => {
                write!(f, "expected {r} × {c} entries of {matrix}, found {rows} × {columns}")
            }
            Self::NotFinite { what } => write!(f, "{what} has an entry that is not finite"),
            Self::Unknown { kind, name, known } => {
                write!(f, "no {kind} `{name}`")?;
                if let Some(nearest) = nearest(name, known) {
                    write!(f, ", perhaps `{nearest}`")?;
                }
                write!(f, "; there are {}", known.join(", "))
            }
            Self::Repeated { kind, name } => write!(f, "the {kind} `{name}` is asked for twice"),
            Self::Count { what, expected, found } => write!(f, "expected {expected} {what}, found {found}"),
            Self::Period { period } => write!(f, "expected a positive period, found {period} s"),
            Self::Time { periods: [one, other] } => {
                write!(f, "{} and {} do not go together", TimeName(*one), TimeName(*other))
            }
            Self::Improper { numerator, denominator } => {
                write!(f, "improper: degree {numerator} over degree {denominator}")
            }
            Self::Unstable { pole } => write!(f, "not stable: the pole {pole}"),
            Self::Unstabilizable { mode } => write!(f, "no input moves the mode {mode}"),
            Self::Undetectable { mode } => write!(f, "no output shows the mode {mode}"),
            Self::Unpaired { pole } => {
                write!(f, "the pole {pole} is not finite, or comes without its conjugate")
            }
            Self::Singular { what } => write!(f, "{what} is singular"),
            Self::Indefinite { matrix } => write!(f, "{matrix} is not symmetric and positive"),
            Self::AlgebraicLoop => {
                write!(f, "the direct ways through both systems form a loop without a solution")
            }
            Self::NotConverged { what } => write!(f, "{what} did not converge"),
            Self::Infinite { what } => write!(f, "{what} is infinite"),
            Self::Range { what, value } => write!(f, "{what} of {value} has no meaning"),
            Self::Constraint(error) => error.fmt(f),
            Self::NoSteadyState { condition, residual, conditions, unknowns, place } => write!(
                f,
                "no steady state near the guess: {} for {}, and `{condition}` is left at {residual:.3e}, at {}",
                Counted(*unknowns, "unknown"),
                Counted(*conditions, "condition"),
                Listed(place)
            ),
            Self::Undetermined { unknowns, place } => write!(
                f,
                "the conditions leave {} open at {}: fix or hold one of them, add a condition, or take the nearest",
                unknowns.join(", "),
                Listed(place)
            ),
            Self::NotSteady { what, rate } => {
                write!(f, "not steady: `{what}` is off by {rate:.3e}")
            }
            Self::NoSecondOrderForm { coordinate } => write!(
                f,
                "no second-order form: forces depend on `{coordinate}`, which has no independent speed of its own"
            ),
            Self::NoPotential { why } => write!(f, "no stability by energy: {why}; modes decide"),
            Self::Picture(error) => write!(f, "no picture: {error}"),
        }
    }
}

impl std::error::Error for Error {}

impl From<linkwork::ConstraintError> for Error {
    fn from(error: linkwork::ConstraintError) -> Self {
        Self::Constraint(error)
    }
}

/// Names with values.
struct Listed<'a>(&'a [(String, f64)]);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, (name, value)) in self.0.iter().enumerate() {
            let comma = if k == 0 { "" } else { ", " };
            write!(f, "{comma}{name} {value:.6}")?;
        }
        Ok(())
    }
}

/// The known name that is spelt most alike, if at most a third of it differs.
fn nearest<'a>(name: &str, known: &'a [String]) -> Option<&'a String> {
    let distance = |other: &String| edits(name, other);
    let best = known.iter().min_by_key(|other| distance(other))?;
    (distance(best) <= name.chars().count().div_ceil(3)).then_some(best)
}

/// Levenshtein's distance.
fn edits(one: &str, other: &str) -> usize {
    let other: Vec<char> = other.chars().collect();
    let mut row: Vec<usize> = (0..=other.len()).collect();
    for (i, a) in one.chars().enumerate() {
        let mut corner = i;
        row[0] = i + 1;
        for (j, b) in other.iter().enumerate() {
            let replaced = corner + usize::from(a != *b);
            corner = row[j + 1];
            row[j + 1] = replaced.min(corner + 1).min(row[j] + 1);
        }
    }
    row[other.len()]
}

struct TimeName(Option<f64>);

impl fmt::Display for TimeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(0.0) => write!(f, "discrete time"),
            Some(period) => write!(f, "a period of {period} s"),
            None => write!(f, "continuous time"),
        }
    }
}
