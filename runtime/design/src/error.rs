//! Errors of the analyses of linear systems and steady states.

use nalgebra::Complex;
use std::fmt;

/// Number of objects with their noun, printed as in `one unknown` or `3 unknowns`.
struct CountedNoun(usize, &'static str);

impl fmt::Display for CountedNoun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CountedNoun(1, what) => write!(f, "one {what}"),
            CountedNoun(n, what) => write!(f, "{n} {what}s"),
        }
    }
}

/// Reason why an analysis of a linear system or steady state has no result.
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A matrix whose shape does not fit the other matrices.
    Shape {
        /// Name of the matrix with the wrong shape.
        matrix: &'static str,
        /// Expected numbers of rows and columns of the matrix.
        expected: (usize, usize),
        /// Actual numbers of rows and columns of the matrix.
        found: (usize, usize),
    },
    /// A matrix, polynomial or list with an infinite or NaN entry.
    NotFinite {
        /// Name of the matrix, polynomial or list that is not finite.
        what: &'static str,
    },
    /// Error: a name of a state, input or output that does not exist.
    Unknown {
        /// Kind of the signal: state, input or output.
        kind: &'static str,
        /// Requested name of the signal.
        name: String,
        /// Existing names of signals of this kind.
        known: Vec<String>,
    },
    /// Error: a name of a state, input or output that is requested twice.
    Repeated {
        /// Kind of the signal: state, input or output.
        kind: &'static str,
        /// Name of the signal that is requested twice.
        name: String,
    },
    /// A number of signals or values that differs from the expected number.
    Count {
        /// Name of the counted objects, such as inputs.
        what: &'static str,
        /// Expected number of objects.
        expected: usize,
        /// Actual number of objects.
        found: usize,
    },
    /// A sampling period that is not positive and finite, s.
    Period {
        /// Rejected sampling period, s.
        period: f64,
    },
    /// Error: systems with different sampling periods, or a discrete system where a continuous one is
    /// expected, or the reverse.
    Time {
        /// The two periods, s; `None` for a continuous system, zero for an arbitrary period.
        periods: [Option<f64>; 2],
    },
    /// More zeros than poles: neither a state-space system nor a response exists.
    Improper {
        /// Degree of the numerator of the improper transfer function.
        numerator: usize,
        /// Degree of the denominator of the improper transfer function.
        denominator: usize,
    },
    /// An unstable system, for a result that exists only for stable systems.
    Unstable {
        /// Unstable pole of the system.
        pole: Complex<f64>,
    },
    /// An unstable mode that no input controls: no regulator exists.
    Unstabilizable {
        /// Eigenvalue of the unstable mode that no input controls.
        mode: Complex<f64>,
    },
    /// A mode that must be observable and appears in no output (or cost): no estimator, or no optimal
    /// regulator, exists.
    Undetectable {
        /// Eigenvalue of the mode that appears in no output or cost.
        mode: Complex<f64>,
    },
    /// A complex pole without its conjugate, or a pole that is not finite.
    Unpaired {
        /// Pole that is not finite or lacks its conjugate.
        pole: Complex<f64>,
    },
    /// Error: a singular matrix or equation.
    Singular {
        /// Name of the singular matrix or equation.
        what: &'static str,
    },
    /// A matrix that is not symmetric and positive (semi)definite, as required.
    Indefinite {
        /// Name of the matrix that is not symmetric and positive (semi)definite.
        matrix: &'static str,
    },
    /// A connection that has an algebraic loop without a solution: `I + D₁ D₂` is singular.
    AlgebraicLoop,
    /// Error: an iteration that did not converge.
    NotConverged {
        /// Name of the iteration that did not converge.
        what: &'static str,
    },
    /// Error: an infinite result.
    Infinite {
        /// Name of the result that is infinite.
        what: &'static str,
    },
    /// Error: a value outside its meaningful range.
    Range {
        /// Name of the value that is out of range.
        what: &'static str,
        /// Rejected value, which is out of range.
        value: f64,
    },
    /// Error: the state of a mechanism violates its constraints, or the constraints lose rank there.
    Constraint(linkwork::ConstraintError),
    /// Error: no state near the guess satisfies all conditions of a steady state.
    NoSteadyState {
        /// Condition of the steady state that is violated most: an acceleration (marked with two primes), the
        /// velocity of a constraint (one prime), a constraint, or an output.
        condition: String,
        /// Residual of the most violated condition of the steady state, in the unit of the condition.
        residual: f64,
        /// Number of conditions of the steady state.
        conditions: usize,
        /// Number of unknowns of the steady state.
        unknowns: usize,
        /// State of minimum violation, as names and values: the configuration, then the other unknowns.
        place: Vec<(String, f64)>,
    },
    /// Conditions of a steady state that do not determine all unknowns: there are too many unknowns, or the
    /// equations are singular at the solution.
    Undetermined {
        /// Unknowns that can change while all conditions remain satisfied.
        unknowns: Vec<String>,
        /// State of the solution, as names and values: the configuration, then the other unknowns.
        place: Vec<(String, f64)>,
    },
    /// Linearisation about a state that is not steady.
    NotSteady {
        /// Quantity that is not zero although the state should be steady: an acceleration (marked with two
        /// primes), a time derivative (one prime), or the violated condition of a trim.
        what: String,
        /// Value of the quantity that is not steady, m/s², rad/s² or rad/s, or the residual of the violated
        /// condition.
        rate: f64,
    },
    /// A motion without a second-order form: forces depend on a coordinate that has no independent velocity.
    NoSecondOrderForm {
        /// Name of the coordinate that has no independent velocity.
        coordinate: String,
    },
    /// An equilibrium whose stability cannot be decided by energy.
    NoPotential {
        /// Reason why energy cannot decide the stability of the equilibrium.
        why: &'static str,
    },
    /// A failure to draw a picture, with the message of the drawing library.
    Picture(String),
}

linkwork::debug_as_display!(Error);

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape { matrix, expected: (r, c), found: (rows, columns) } => {
                write!(f, "expected {r} × {c} entries of {matrix}, found {rows} × {columns}")
            }
            Self::NotFinite { what } => write!(f, "{what} has an entry that is not finite"),
            Self::Unknown { kind, name, known } => {
                write!(f, "no {kind} `{name}`")?;
                if let Some(nearest) = nearest_known_name(name, known) {
                    write!(f, ", perhaps `{nearest}`")?;
                }
                write!(f, "; there are {}", known.join(", "))
            }
            Self::Repeated { kind, name } => write!(f, "the {kind} `{name}` is requested twice"),
            Self::Count { what, expected, found } => write!(f, "expected {expected} {what}, found {found}"),
            Self::Period { period } => write!(f, "expected a positive period, found {period} s"),
            Self::Time { periods: [one, other] } => {
                write!(f, "{} and {} are incompatible", PeriodDescription(*one), PeriodDescription(*other))
            }
            Self::Improper { numerator, denominator } => {
                write!(f, "improper: degree {numerator} over degree {denominator}")
            }
            Self::Unstable { pole } => write!(f, "not stable: the pole {pole}"),
            Self::Unstabilizable { mode } => write!(f, "no input controls the mode {mode}"),
            Self::Undetectable { mode } => write!(f, "no output observes the mode {mode}"),
            Self::Unpaired { pole } => {
                write!(f, "the pole {pole} is not finite, or lacks its conjugate")
            }
            Self::Singular { what } => write!(f, "{what} is singular"),
            Self::Indefinite { matrix } => write!(f, "{matrix} is not symmetric and positive"),
            Self::AlgebraicLoop => {
                write!(f, "the direct feedthrough of both systems forms an algebraic loop without a solution")
            }
            Self::NotConverged { what } => write!(f, "{what} did not converge"),
            Self::Infinite { what } => write!(f, "{what} is infinite"),
            Self::Range { what, value } => write!(f, "{what} of {value} is not allowed"),
            Self::Constraint(error) => error.fmt(f),
            Self::NoSteadyState { condition, residual, conditions, unknowns, place } => write!(
                f,
                "no steady state near the guess: {} for {}, and `{condition}` is left at {residual:.3e}, at \
                 {}",
                CountedNoun(*unknowns, "unknown"),
                CountedNoun(*conditions, "condition"),
                ListedValues(place)
            ),
            Self::Undetermined { unknowns, place } => write!(
                f,
                "the conditions do not determine {} at {}: fix or prescribe one of them, add a condition, or \
                 take the nearest",
                unknowns.join(", "),
                ListedValues(place)
            ),
            Self::NotSteady { what, rate } => {
                write!(f, "not steady: `{what}` has a residual of {rate:.3e}")
            }
            Self::NoSecondOrderForm { coordinate } => write!(
                f,
                "no second-order form: forces depend on `{coordinate}`, which has no independent speed of \
                 its own"
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

/// List of names with their values, printed in an error message.
struct ListedValues<'a>(&'a [(String, f64)]);

impl fmt::Display for ListedValues<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, (name, value)) in self.0.iter().enumerate() {
            let comma = if k == 0 { "" } else { ", " };
            write!(f, "{comma}{name} {value:.6}")?;
        }
        Ok(())
    }
}

/// Returns the known name of minimum edit distance, if at most a third of the characters differ.
fn nearest_known_name<'a>(name: &str, known: &'a [String]) -> Option<&'a String> {
    let edit_distance_to = |other: &String| edit_distance(name, other);
    let best = known.iter().min_by_key(|other| edit_distance_to(other))?;
    (edit_distance_to(best) <= name.chars().count().div_ceil(3)).then_some(best)
}

/// Returns the Levenshtein distance of two names.
fn edit_distance(one: &str, other: &str) -> usize {
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

struct PeriodDescription(Option<f64>);

impl fmt::Display for PeriodDescription {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(0.0) => write!(f, "discrete time"),
            Some(period) => write!(f, "a period of {period} s"),
            None => write!(f, "continuous time"),
        }
    }
}
