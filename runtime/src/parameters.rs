//! Checks of parameter values: whether a physical mechanism can have them.

use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use core::fmt;

/// Error of the function `validate` of a mechanism with parameters: a value that no physical mechanism can
/// have.
///
/// ```
/// use linkwork::prelude::*;
/// use linkwork::{Fault, ParameterError};
///
/// #[mechanism(gravity = -9.81 * y)]
/// struct Pendulum {
///     mass: f64,
///     length: f64,
///     #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
///     rod: Body,
///     #[joint(ground -> rod, about = z)]
///     hinge: Pin,
/// }
///
/// # fn main() -> Result<(), ParameterError> {
/// Pendulum { mass: 2.0, length: 1.5 }.validate()?;
/// let error = Pendulum { mass: -2.0, length: 1.5 }.validate().unwrap_err();
/// assert_eq!((error.fault, error.parameters), (Fault::Negative, &["mass"][..]));
/// assert_eq!(error.to_string(), "the mass of `rod` cannot be negative, but it is -2 (by the parameter `mass`)");
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, PartialEq)]
pub struct ParameterError {
    /// Condition that the checked value violates.
    pub fault: Fault,
    /// Description of the checked value: ``the mass of `rod` ``.
    pub figure: &'static str,
    /// Names of the parameters on which the value depends.
    pub parameters: &'static [&'static str],
    /// Checked value in SI units. For a range: its lower end minus its upper end. For an inertia: the sum of
    /// the two smaller principal moments minus the largest. NaN if the value is not a number or differs
    /// between SIMD lanes.
    pub value: f64,
}

/// Condition that a checked value violates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// The checked value is infinite or NaN.
    NotFinite,
    /// The checked value is negative. Masses, sizes and coefficients of friction or damping must be zero or
    /// positive.
    Negative,
    /// The checked value is zero or negative. Sizes of surfaces and the velocities of smooth friction laws
    /// must be positive.
    NotPositive,
    /// The checked value is so large that products with it overflow.
    TooLarge,
    /// The checked value is not zero, but so small that its reciprocal overflows.
    TooSmall,
    /// The checked half angle of a cone is not between zero and a right angle.
    NotHalfAngle,
    /// The checked squared norm of a unit quaternion or vector is not one.
    NotUnit,
    /// The checked coefficient of restitution is below zero or above one.
    NotFraction,
    /// The upper end of the checked range is below its lower end.
    EmptyRange,
    /// No rigid body has this inertia: a principal moment is negative, or exceeds the sum of the other two.
    Inertia,
}

crate::debug_as_display!(ParameterError);

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fault, figure, parameters, value } = self;
        match fault {
            Fault::NotFinite => write!(f, "{figure} is not a finite number: it is {value}"),
            Fault::Negative => write!(f, "{figure} cannot be negative, but it is {value}"),
            Fault::NotPositive => write!(f, "{figure} must be positive, but it is {value}"),
            Fault::TooLarge => write!(f, "{figure} is too large to compute with: {value:e}"),
            Fault::TooSmall => write!(f, "{figure} is too small to divide by, and not zero: {value:e}"),
            Fault::NotHalfAngle => write!(f, "{figure} is not between 0 and π/2: it is {value}"),
            Fault::NotUnit => {
                write!(f, "{figure} is not of unit length: the square of its length is {value}")
            }
            Fault::NotFraction => write!(f, "{figure} is not between 0 and 1: it is {value}"),
            Fault::EmptyRange => write!(f, "{figure} has a lower bound above the upper one, by {value}"),
            Fault::Inertia => write!(
                f,
                "{figure} is not physically consistent: a principal moment is negative, or exceeds the sum \
                 of the others, by {} kg·m²",
                -value
            ),
        }?;
        let [first, rest @ ..] = parameters else { return Ok(()) };
        // The description already names a single parameter.
        if rest.is_empty() && figure.starts_with("the parameter") {
            return Ok(());
        }
        let s = if rest.is_empty() { "" } else { "s" };
        write!(f, " (by the parameter{s} `{first}`")?;
        rest.iter().try_for_each(|name| write!(f, ", `{name}`"))?;
        f.write_str(")")
    }
}

impl core::error::Error for ParameterError {}

/// Check of parameter values that generated code performs: one value, or several values together.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// Condition that the values must satisfy.
    pub rule: Rule,
    /// Description of the checked value for error messages.
    pub name: &'static str,
    /// Names of the parameters on which the value depends.
    pub parameters: &'static [&'static str],
}

/// Conditions that parameter values must satisfy; the compiler's documentation explains them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "no part of the public interface")]
pub enum Rule {
    Finite,
    Mass,
    Length,
    NotNegative,
    Positive,
    HalfAngle,
    Unit,
    Fraction,
    Order,
    Inertia,
}

impl Rule {
    /// Returns the number of values that the condition takes.
    fn number_of_rule_arguments(self) -> usize {
        match self {
            Rule::Order => 2,
            Rule::Inertia => 7,
            _ => 1,
        }
    }
}

/// Checks all conditions of `figures`. The list `values` contains the values of each condition in the same
/// order, one after another.
///
/// # Errors
///
/// The first violated condition.
pub fn validate<T: Real>(figures: &[Figure], values: &[T]) -> Result<(), ParameterError> {
    let mut rest = values;
    for figure in figures {
        let Some((own, after)) = rest.split_at_checked(figure.rule.number_of_rule_arguments()) else { break };
        rest = after;
        if let Some((fault, value)) = fault_of_violated_condition(figure.rule, own) {
            let Figure { name, parameters, .. } = *figure;
            return Err(ParameterError { fault, figure: name, parameters, value });
        }
    }
    Ok(())
}

/// Limits of the magnitudes of parameters for a scalar type. The compiler checks constants against the same
/// limits.
struct ParameterMagnitudeLimits {
    /// Maximum mass and moment of inertia that the check accepts, kg and kg·m².
    most: f64,
    /// Maximum length that the check accepts, m.
    length: f64,
    /// Minimum mass other than zero that the check accepts, kg.
    least: f64,
    /// Relative tolerance of inertias: published values are rounded, and single precision rounds more.
    tolerance: f64,
}

impl ParameterMagnitudeLimits {
    fn magnitude_limits_of_scalar<T: Real>() -> ParameterMagnitudeLimits {
        if epsilon::<T>() > constant(1e-10) {
            return ParameterMagnitudeLimits { most: 1e18, length: 1e9, least: 1e-36, tolerance: 1e-5 };
        }
        ParameterMagnitudeLimits { most: 1e150, length: 1e75, least: 1e-300, tolerance: 1e-6 }
    }
}

/// Moment of inertia, kg·m², below which a value counts as zero. Exporters of robot files write such small
/// values for bodies without inertia.
const NOTHING: f64 = 1e-18;

/// Square of the radius of gyration, m², below which the moments of inertia of a body with mass count as
/// zero.
const SMALLEST: f64 = 1e-16;

/// Returns the fault and the value to report, if the values violate the condition.
fn fault_of_violated_condition<T: Real>(rule: Rule, values: &[T]) -> Option<(Fault, f64)> {
    if let Some(x) = values.iter().find(|x| !is_finite(**x)) {
        return Some((Fault::NotFinite, to_f64(*x)));
    }
    let ParameterMagnitudeLimits { most, length, least, tolerance } =
        ParameterMagnitudeLimits::magnitude_limits_of_scalar::<T>();
    let zero = T::zero();
    let fault_unless = |holds: bool, fault: Fault, value: T| (!holds).then(|| (fault, to_f64(value)));
    match (rule, values) {
        (Rule::Mass, [m]) => {
            let (m, least) = (*m, constant(least));
            fault_unless(is_at_least(m, zero), Fault::Negative, m)
                .or_else(|| fault_unless(is_at_most(m, constant(most)), Fault::TooLarge, m))
                .or_else(|| fault_unless(is_zero_or_at_least(m, least), Fault::TooSmall, m))
        }
        (Rule::Length, [x]) => fault_unless(is_at_most(x.abs(), constant(length)), Fault::TooLarge, *x),
        (Rule::NotNegative, [x]) => fault_unless(is_at_least(*x, zero), Fault::Negative, *x),
        (Rule::Positive, [x]) => fault_unless(*x > zero, Fault::NotPositive, *x),
        (Rule::HalfAngle, [x]) => fault_unless(*x > zero && *x < T::frac_pi_2(), Fault::NotHalfAngle, *x),
        (Rule::Unit, [square]) => {
            let off = (*square - T::one()).abs();
            fault_unless(is_at_most(off, constant(tolerance)), Fault::NotUnit, *square)
        }
        (Rule::Fraction, [x]) => {
            fault_unless(is_at_least(*x, zero) && is_at_most(*x, T::one()), Fault::NotFraction, *x)
        }
        (Rule::Order, [low, high]) => fault_unless(is_at_least(*high, *low), Fault::EmptyRange, *low - *high),
        (Rule::Inertia, [xx, yy, zz, xy, xz, yz, m]) => {
            let moments = [*xx, *yy, *zz, *xy, *xz, *yz];
            let large = moments.iter().find(|x| !is_at_most(x.abs(), constant(most)));
            large.map(|x| (Fault::TooLarge, to_f64(*x))).or_else(|| {
                let holds = is_physical_inertia(moments, *m, tolerance);
                (!holds).then(|| (Fault::Inertia, triangle_inequality_margin(moments.map(to_f64))))
            })
        }
        _ => None,
    }
}

/// Whether a number is finite; for lanes, whether all of them are.
fn is_finite<T: Real>(x: T) -> bool {
    x * T::zero() == T::zero()
}

/// Whether `x ≥ y`; for lanes, whether this is true in all of them.
fn is_at_least<T: Real>(x: T, y: T) -> bool {
    x.max(y) == x
}

/// Whether `x ≤ y`; for lanes, whether this is true in all of them.
fn is_at_most<T: Real>(x: T, y: T) -> bool {
    x.min(y) == x
}

/// Whether a nonnegative number is zero or at least `least`; for lanes, whether each of them is.
fn is_zero_or_at_least<T: Real>(m: T, least: T) -> bool {
    let part = m.min(least) / least;
    (T::one() - part) * part == T::zero()
}

/// Whether a body of mass `m` can have the inertia xx, yy, zz, xy, xz, yz: whether `½ tr(I) 1 − I`, the
/// second moments of its mass, is positive semidefinite (Wensing, Kim and Slotine, *Linear matrix
/// inequalities for physically consistent inertial parameter identification*, 2018). The pivots tested are
/// those of the matrix with the tolerance added to its diagonal.
fn is_physical_inertia<T: Real>([xx, yy, zz, xy, xz, yz]: [T; 6], m: T, tolerance: f64) -> bool {
    let half = (xx + yy + zz) * constant(0.5);
    let nothing = m.max(T::zero()) * constant(SMALLEST) + constant(NOTHING);
    let size = half.abs() + nothing;
    let lift = nothing / size + constant(tolerance * 0.5);
    let [a, b, c] = [xx, yy, zz].map(|i| (half - i) / size + lift);
    let [ab, ac, bc] = [xy, xz, yz].map(|i| -i / size);
    let (l, n) = (ab / a, ac / a);
    let second = b - l * ab;
    let off = bc - l * ac;
    let third = c - n * ac - off * off / second;
    a > T::zero() && second > T::zero() && third > T::zero()
}

/// Returns the sum of the two smaller principal moments of inertia minus the largest, computed by Jacobi
/// rotations.
fn triangle_inequality_margin([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> f64 {
    // Diagonal entries xx, yy, zz, and the off-diagonal entries opposite to them: yz, xz, xy.
    let (mut d, mut o) = ([xx, yy, zz], [yz, xz, xy]);
    for _ in 0..16 {
        for [p, q, r] in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
            if o[r] == 0.0 {
                continue;
            }
            let half = (d[q] - d[p]) / (2.0 * o[r]);
            let size = half.abs() + sqrt(half * half + 1.0);
            let t = if half < 0.0 { -1.0 / size } else { 1.0 / size };
            let c = 1.0 / sqrt(t * t + 1.0);
            let s = t * c;
            (d[p], d[q]) = (d[p] - t * o[r], d[q] + t * o[r]);
            (o[r], o[q], o[p]) = (0.0, c * o[q] - s * o[p], s * o[q] + c * o[p]);
        }
    }
    let largest = d.into_iter().fold(f64::NEG_INFINITY, f64::max);
    d.into_iter().sum::<f64>() - 2.0 * largest
}

/// Returns the square root of `x`, also if the standard library is not available.
fn sqrt(x: f64) -> f64 {
    nalgebra::ComplexField::sqrt(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Lanes, f64x4};

    fn fault_of_values<T: Real>(rule: Rule, values: &[f64]) -> Option<Fault> {
        let values: std::vec::Vec<T> = values.iter().map(|x| constant(*x)).collect();
        validate(&[Figure { rule, name: "x", parameters: &["p"] }], &values).err().map(|error| error.fault)
    }

    /// Conditions and values, with the fault that each must report in every scalar type.
    const TABLE: [(Rule, &[f64], Option<Fault>); 26] = [
        (Rule::Finite, &[-1.0], None),
        (Rule::Finite, &[f64::NAN], Some(Fault::NotFinite)),
        (Rule::Finite, &[f64::INFINITY], Some(Fault::NotFinite)),
        (Rule::Mass, &[0.0], None),
        (Rule::Mass, &[3.0], None),
        (Rule::Mass, &[-1e-3], Some(Fault::Negative)),
        (Rule::Mass, &[f64::NAN], Some(Fault::NotFinite)),
        (Rule::Length, &[-2.0], None),
        (Rule::NotNegative, &[0.0], None),
        (Rule::NotNegative, &[-1.0], Some(Fault::Negative)),
        (Rule::Positive, &[0.1], None),
        (Rule::Positive, &[0.0], Some(Fault::NotPositive)),
        (Rule::HalfAngle, &[0.7], None),
        (Rule::HalfAngle, &[1.6], Some(Fault::NotHalfAngle)),
        (Rule::Unit, &[1.0], None),
        (Rule::Unit, &[1.1], Some(Fault::NotUnit)),
        (Rule::Order, &[-1.0, 1.0], None),
        (Rule::Order, &[1.0, 1.0], None),
        (Rule::Order, &[1.0, -1.0], Some(Fault::EmptyRange)),
        // A ball; a rod, at the bound; a rod along (1, 1, 0); zero; one moment above the sum of the others; a
        // negative moment; a product of inertia that is too large.
        (Rule::Inertia, &[0.4, 0.4, 0.4, 0.0, 0.0, 0.0, 1.0], None),
        (Rule::Inertia, &[0.0, 0.3, 0.3, 0.0, 0.0, 0.0, 1.0], None),
        (Rule::Inertia, &[0.15, 0.15, 0.3, -0.15, 0.0, 0.0, 1.0], None),
        (Rule::Inertia, &[0.0; 7], None),
        (Rule::Inertia, &[0.1, 0.1, 0.3, 0.0, 0.0, 0.0, 1.0], Some(Fault::Inertia)),
        (Rule::Inertia, &[-0.1, 0.1, 0.1, 0.0, 0.0, 0.0, 1.0], Some(Fault::Inertia)),
        (Rule::Inertia, &[0.2, 0.2, 0.2, 0.19, 0.0, 0.0, 1.0], Some(Fault::Inertia)),
    ];

    #[test]
    fn faults_agree_in_all_scalar_types() {
        for (rule, values, fault) in TABLE {
            assert_eq!(fault_of_values::<f64>(rule, values), fault, "{rule:?} {values:?}");
            assert_eq!(
                fault_of_values::<f32>(rule, values),
                fault,
                "{rule:?} {values:?} in single precision"
            );
            assert_eq!(fault_of_values::<f64x4>(rule, values), fault, "{rule:?} {values:?} in lanes");
        }
    }

    #[test]
    fn fault_in_one_lane_is_reported() {
        let parameter_check_with_rule = |rule| [Figure { rule, name: "x", parameters: &[] }];
        for (rule, values, fault) in TABLE {
            // The other lanes contain values that every rule except `Order` admits.
            let valid_rule_argument = |k: usize| {
                if rule == Rule::Order { k as f64 } else { [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0][k] }
            };
            let lanes_with_one_fault =
                |k: usize| f64x4::from_fn(|lane| if lane == 2 { values[k] } else { valid_rule_argument(k) });
            let values: std::vec::Vec<f64x4> = (0..values.len()).map(lanes_with_one_fault).collect();
            let found = validate(&parameter_check_with_rule(rule), &values).err().map(|error| error.fault);
            assert_eq!(found, fault, "{rule:?} {values:?}");
        }
        assert_eq!(validate(&parameter_check_with_rule(Rule::Mass), &[Lanes([0.0, 1.0, 2.0])]), Ok(()));
        let small = validate(&parameter_check_with_rule(Rule::Mass), &[Lanes([0.0, 1.0, 1e-310])]);
        assert_eq!(small.unwrap_err().fault, Fault::TooSmall);
    }

    #[test]
    fn magnitude_limits_follow_scalar_type() {
        assert_eq!(fault_of_values::<f64>(Rule::Mass, &[1e30]), None);
        assert_eq!(fault_of_values::<f32>(Rule::Mass, &[1e30]), Some(Fault::TooLarge));
        assert_eq!(fault_of_values::<f64>(Rule::Length, &[-1e80]), Some(Fault::TooLarge));
        assert_eq!(fault_of_values::<f64>(Rule::Mass, &[1e-310]), Some(Fault::TooSmall));
    }

    #[test]
    fn inertia_error_states_violation_of_triangle_inequality() {
        // Rotated by 45° about z, then about x: principal moments 0.1, 0.2, 0.5.
        let (a, b) = (core::f64::consts::FRAC_1_SQRT_2, 0.5);
        let axes = [[a, a, 0.0], [-b, b, a], [b, -b, a]];
        let moments = [0.1, 0.5, 0.2];
        let inertia_entry = |i: usize, j: usize| (0..3).map(|k| moments[k] * axes[k][i] * axes[k][j]).sum();
        let full = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|(i, j)| inertia_entry(i, j));
        assert!((triangle_inequality_margin(full) + 0.2).abs() < 1e-12);
        let [xx, yy, zz, xy, xz, yz] = full;
        let figure = Figure { rule: Rule::Inertia, name: "the inertia of `hand`", parameters: &["m", "l"] };
        let error = validate(&[figure], &[xx, yy, zz, xy, xz, yz, 1.0]).unwrap_err();
        assert!((error.value + 0.2).abs() < 1e-12);
        let said = std::string::ToString::to_string(&error);
        assert!(said.starts_with("the inertia of `hand` is not physically consistent"), "{said}");
        assert!(said.ends_with("(by the parameters `m`, `l`)"), "{said}");
    }
}
