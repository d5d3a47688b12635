//! Stability analysis from the characteristic polynomial: zero roots, the frequency of a single oscillation,
//! and the conditions for bounded deviations. With odd powers, the conditions are those of Routh and Hurwitz
//! in the form of Liénard and Chipart (Gantmacher, *The Theory of Matrices*, vol. 2, 1959, ch. XV, § 13).
//! Without odd powers, the squares of the roots must be real, negative and distinct, for which the
//! coefficients and the discriminant must be positive. If the forces have a potential, these squares are
//! always real and need not be distinct (Lagrange and Dirichlet).

use super::characteristic::CharacteristicPolynomial;
use super::parts::ROOT;
use super::rest::{random_parameter, values_at_random_parameters, vanishes_identically};
use crate::algebra::normal::inverse_of_polynomial;
use crate::algebra::polynomial::{Atom, Monomial, Polynomial, Ring, Term};
use crate::expr::{Function, Symbol};

/// Stability properties of an equilibrium.
pub struct Stability {
    /// Ring of all polynomials.
    pub ring: Ring,
    /// Coefficients of the characteristic polynomial in ascending powers, without common factors.
    pub coefficients: Vec<Polynomial>,
    /// Parameters that the polynomial was divided by, which are assumed to be positive.
    pub divided: Vec<Symbol>,
    /// Multiplicity of the root zero of the characteristic polynomial.
    pub zeros: usize,
    /// Frequency of oscillation, rad/s, if all nonzero roots belong to one undamped oscillation.
    pub frequency: Option<Polynomial>,
    /// Stability with respect to the nonzero roots.
    pub verdict: StabilityVerdict,
}

/// Stability with respect to the nonzero roots of the characteristic polynomial.
#[derive(Clone, Debug, PartialEq)]
pub enum StabilityVerdict {
    /// The equilibrium is asymptotically stable if all of these polynomials are positive.
    Asymptotic(Vec<Polynomial>),
    /// The equilibrium is stable if all of these polynomials are positive: deviations oscillate and remain
    /// bounded.
    Oscillation(Vec<Polynomial>),
    /// The equilibrium is not asymptotically stable for any values of the parameters.
    NotAsymptotic,
    /// The equilibrium is unstable for all values of the parameters.
    Unstable,
    /// The characteristic polynomial has no nonzero roots.
    Nothing,
    /// The stability conditions are too long to be printed.
    Long,
}

/// Maximum number of terms of all stability conditions together.
const TERMS: usize = 120;

/// Analyses the stability. `None` if the sign of the leading coefficient depends on the parameters.
pub fn analyse_stability(c: CharacteristicPolynomial) -> Option<Stability> {
    let CharacteristicPolynomial { mut ring, mut coefficients, conservative, positive: known } = c;
    let mut positive = known.clone();
    coefficients = multiplied_by_even_denominators(&coefficients, &mut ring)?;
    let leading = coefficients.last()?;
    let signs = values_at_random_parameters(|seed| {
        Some(ring.evaluate_polynomial(leading, &|s| random_parameter(s, seed)).signum())
    });
    let sign = *signs.first()?;
    if signs.iter().any(|other| *other != sign) {
        return None;
    }
    let divided = divide_by_common_monomial(&ring, &mut coefficients, sign);
    positive.extend(&divided);
    let divided: Vec<Symbol> = divided.into_iter().filter(|s| !known.contains(s)).collect();
    let zeros = coefficients.iter().take_while(|p| p.terms.is_empty()).count();
    let rest = coefficients[zeros..].to_vec();
    let even = rest.iter().skip(1).step_by(2).all(|p| p.terms.is_empty());
    let verdict = match (rest.len() - 1, even) {
        (0, _) => StabilityVerdict::Nothing,
        (_, false) => lienard_chipart_conditions(&rest, &mut ring, &positive),
        (_, true) => oscillation_conditions(&rest, conservative, &mut ring, &positive),
    };
    ring.intern_atom_as_monomial(Atom::Symbol(ROOT.symbol()))?;
    let oscillates = matches!(verdict, StabilityVerdict::Oscillation(_));
    let frequency = match rest.as_slice() {
        [last, middle, first] if middle.terms.is_empty() && oscillates => {
            natural_frequency(last, first, &mut ring)
        }
        _ => None,
    };
    Some(Stability { ring, coefficients, divided, zeros, frequency, verdict })
}

/// Divides all coefficients by their common monomial and by a sign. Returns the parameters that the common
/// monomial contains to an odd power, which are assumed to be positive.
fn divide_by_common_monomial(ring: &Ring, coefficients: &mut [Polynomial], sign: f64) -> Vec<Symbol> {
    let sign = sign / common_coefficient_divisor(coefficients.iter());
    let mut terms = coefficients.iter().flat_map(|p| &p.terms).map(|t| t.monomial);
    let Some(first) = terms.next() else { return Vec::new() };
    let common = terms.fold(first, Monomial::greatest_common_divisor);
    let (mut divisor, mut odd) = (Monomial::ONE, Vec::new());
    for (atom, power) in common.atoms_with_powers() {
        let symbol = match ring.atoms[atom] {
            Atom::Symbol(symbol) => symbol,
            _ => continue,
        };
        if power % 2 == 1 {
            odd.push(symbol);
        }
        divisor = (0..power)
            .fold(divisor, |m, _| m.checked_product(Monomial::first_power_of_atom(atom)).unwrap_or(m));
    }
    for p in coefficients {
        *p = multiplied_and_rounded(&divide_by_monomial(p, divisor), sign);
    }
    odd
}

/// Returns the frequency of an undamped oscillation, `sqrt(last / first)`.
fn natural_frequency(last: &Polynomial, first: &Polynomial, ring: &mut Ring) -> Option<Polynomial> {
    let inverse = inverse_of_polynomial(ring, first)?;
    let square = ring.multiply_and_reduce(last, &inverse)?;
    if let [Term { monomial: Monomial::ONE, coefficient }] = square.terms.as_slice() {
        return Some(Polynomial::from_number(coefficient.sqrt()));
    }
    Some(Polynomial::from_term(ring.intern_atom_as_monomial(Atom::Call(Function::Sqrt, square))?, 1.0))
}

/// Returns the conditions of Liénard and Chipart: every other coefficient and every other Hurwitz determinant
/// is positive.
fn lienard_chipart_conditions(rest: &[Polynomial], ring: &mut Ring, positive: &[Symbol]) -> StabilityVerdict {
    let n = rest.len() - 1;
    let mut conditions: Vec<Polynomial> = rest.iter().step_by(2).take(n.div_ceil(2)).cloned().collect();
    // Determinants of orders n − 1, n − 3, …
    let mut orders: Vec<usize> = (1..n).rev().step_by(2).collect();
    orders.reverse();
    if n == 1 {
        conditions.truncate(1);
    }
    for order in orders {
        match hurwitz_determinant(rest, order, ring) {
            Some(determinant) => conditions.push(determinant),
            None => return StabilityVerdict::Long,
        }
    }
    remove_trivial_stability_conditions(conditions, StabilityVerdict::Asymptotic, ring, positive)
}

/// Returns the Hurwitz determinant of an order. `None` beyond the limits of the ring.
fn hurwitz_determinant(rest: &[Polynomial], order: usize, ring: &mut Ring) -> Option<Polynomial> {
    let n = rest.len() - 1;
    // Row i, column j, counted from one: the coefficient of s^(n − (2 i − j)).
    let coefficient_index = |i: usize, j: usize| (2 * i).checked_sub(j).and_then(|k| n.checked_sub(k));
    let rows: Vec<Vec<Polynomial>> = (1..=order)
        .map(|i| {
            (1..=order)
                .map(|j| coefficient_index(i, j).map_or(Polynomial::default(), |k| rest[k].clone()))
                .collect()
        })
        .collect();
    determinant_by_expansion(&rows, ring)
}

/// Returns a determinant of polynomials, expanded along its first row.
fn determinant_by_expansion(rows: &[Vec<Polynomial>], ring: &mut Ring) -> Option<Polynomial> {
    let Some((first, others)) = rows.split_first() else { return Some(Polynomial::from_number(1.0)) };
    let mut sum = Polynomial::default();
    for (c, entry) in first.iter().enumerate().filter(|(_, p)| !p.terms.is_empty()) {
        let row_without_column = |row: &Vec<Polynomial>| {
            let kept = row.iter().enumerate().filter(|(k, _)| *k != c);
            kept.map(|(_, p)| p.clone()).collect()
        };
        let own = determinant_by_expansion(&others.iter().map(row_without_column).collect::<Vec<_>>(), ring)?;
        let product =
            ring.multiply_and_reduce(entry, &own)?.multiplied_by_number(if c % 2 == 0 { 1.0 } else { -1.0 });
        sum = ring.add_within_limits(&sum, &product)?;
    }
    Some(sum)
}

/// Returns the conditions that the squares of the roots are real, negative and distinct.
fn oscillation_conditions(
    rest: &[Polynomial],
    conservative: bool,
    ring: &mut Ring,
    positive: &[Symbol],
) -> StabilityVerdict {
    let squares: Vec<Polynomial> = rest.iter().step_by(2).cloned().collect();
    let mut conditions = squares[..squares.len() - 1].to_vec();
    if !conservative && squares.len() > 2 {
        match polynomial_discriminant(&squares, ring) {
            Some(discriminant) => conditions.push(discriminant),
            None => return StabilityVerdict::Long,
        }
    }
    remove_trivial_stability_conditions(conditions, StabilityVerdict::Oscillation, ring, positive)
}

/// Returns the discriminant of a quadratic or cubic polynomial, `None` for other degrees.
fn polynomial_discriminant(c: &[Polynomial], ring: &mut Ring) -> Option<Polynomial> {
    let mut scaled_product_of_coefficients = |factor: f64, parts: &[usize]| {
        let one = Polynomial::from_number(factor);
        parts.iter().try_fold(one, |product, k| ring.multiply_and_reduce(&product, &c[*k]))
    };
    let terms = match c.len() {
        3 => vec![
            scaled_product_of_coefficients(1.0, &[1, 1])?,
            scaled_product_of_coefficients(-4.0, &[0, 2])?,
        ],
        4 => vec![
            scaled_product_of_coefficients(18.0, &[0, 1, 2, 3])?,
            scaled_product_of_coefficients(-4.0, &[2, 2, 2, 0])?,
            scaled_product_of_coefficients(1.0, &[1, 1, 2, 2])?,
            scaled_product_of_coefficients(-4.0, &[1, 1, 1, 3])?,
            scaled_product_of_coefficients(-27.0, &[0, 0, 3, 3])?,
        ],
        _ => return None,
    };
    let mut sum = Polynomial::default();
    for term in &terms {
        sum = ring.add_within_limits(&sum, term)?;
    }
    Some(sum)
}

/// Removes conditions that always hold. Returns another verdict if a condition never holds.
fn remove_trivial_stability_conditions(
    conditions: Vec<Polynomial>,
    verdict: fn(Vec<Polynomial>) -> StabilityVerdict,
    ring: &mut Ring,
    positive: &[Symbol],
) -> StabilityVerdict {
    let mut kept: Vec<Polynomial> = Vec::new();
    let (mut unstable, mut zero) = (false, false);
    for condition in conditions {
        let Some(condition) = remove_positive_factors(&condition, ring, positive) else {
            return StabilityVerdict::Long;
        };
        if condition.terms.is_empty() || vanishes_identically(ring, &condition) {
            zero = true;
        } else if has_only_positive_terms(&condition.multiplied_by_number(-1.0), ring, positive) {
            unstable = true;
        } else if !has_only_positive_terms(&condition, ring, positive) && !kept.contains(&condition) {
            kept.push(condition);
        }
    }
    let has_opposite_condition = |p: &Polynomial| kept.contains(&p.multiplied_by_number(-1.0));
    zero |= kept.iter().any(has_opposite_condition);
    match (unstable, zero) {
        (true, _) => StabilityVerdict::Unstable,
        (_, true) => StabilityVerdict::NotAsymptotic,
        _ if kept.iter().map(|p| p.terms.len()).sum::<usize>() > TERMS => StabilityVerdict::Long,
        _ => verdict(kept),
    }
}

/// Returns true if all terms of a polynomial are positive.
fn has_only_positive_terms(p: &Polynomial, ring: &Ring, positive: &[Symbol]) -> bool {
    let is_positive_power =
        |(atom, power): (usize, u8)| power % 2 == 0 || is_positive_atom(ring, atom, positive);
    !p.terms.is_empty()
        && p.terms
            .iter()
            .all(|t| t.coefficient > 0.0 && t.monomial.atoms_with_powers().all(is_positive_power))
}

fn is_positive_atom(ring: &Ring, atom: usize, positive: &[Symbol]) -> bool {
    match &ring.atoms[atom] {
        Atom::Symbol(symbol) => positive.contains(symbol),
        Atom::Call(Function::Sqrt | Function::Exp | Function::Cosh, _) => true,
        Atom::Inverse(p) => has_only_positive_terms(p, ring, positive),
        _ => false,
    }
}

/// Removes positive factors from a condition. If the remaining sum has a definite sign and other factors
/// remain, only the sign is retained.
fn remove_positive_factors(p: &Polynomial, ring: &mut Ring, positive: &[Symbol]) -> Option<Polynomial> {
    let p = multiplied_by_even_denominators(std::slice::from_ref(p), ring)?.pop()?;
    let Some(common) = common_monomial(&p) else { return Some(p) };
    let mut divisor = Monomial::ONE;
    for (atom, power) in common.atoms_with_powers() {
        let times = if is_positive_atom(ring, atom, positive) { power } else { power - power % 2 };
        divisor = (0..times)
            .fold(divisor, |m, _| m.checked_product(Monomial::first_power_of_atom(atom)).unwrap_or(m));
    }
    let factor = common.quotient(divisor);
    let left = divide_by_monomial(&p, common);
    let sign = [1.0, -1.0]
        .into_iter()
        .find(|sign| has_only_positive_terms(&left.multiplied_by_number(*sign), ring, positive));
    if let (Some(sign), true) = (sign, factor != Monomial::ONE) {
        return Some(Polynomial::from_term(factor, sign));
    }
    Some(multiplied_and_rounded(&divide_by_monomial(&p, divisor), 1.0 / common_coefficient_divisor([&p])))
}

/// Returns the common monomial of all terms, `None` for zero.
fn common_monomial(p: &Polynomial) -> Option<Monomial> {
    let first = p.terms.first()?;
    Some(p.terms.iter().fold(first.monomial, |m, t| m.greatest_common_divisor(t.monomial)))
}

/// Divides a polynomial by a monomial.
fn divide_by_monomial(p: &Polynomial, divisor: Monomial) -> Polynomial {
    let divide_term = |t: &Term| Term { monomial: t.monomial.quotient(divisor), ..*t };
    Polynomial::sum_of_terms(p.terms.iter().map(divide_term).collect())
}

/// Returns the smallest magnitude of the coefficients if all coefficients are integer multiples of it,
/// otherwise one.
fn common_coefficient_divisor<'a>(all: impl IntoIterator<Item = &'a Polynomial>) -> f64 {
    let sizes: Vec<f64> = all.into_iter().flat_map(|p| &p.terms).map(|t| t.coefficient.abs()).collect();
    let least = sizes.iter().copied().fold(f64::MAX, f64::min);
    let is_integer_multiple_of_least = |size: &f64| (size / least - (size / least).round()).abs() < 1e-9;
    if sizes.iter().all(is_integer_multiple_of_least) { least } else { 1.0 }
}

/// Multiplies a polynomial by a number, and rounds coefficients that are integers up to rounding error.
fn multiplied_and_rounded(p: &Polynomial, factor: f64) -> Polynomial {
    let scale_and_round_term = |t: &Term| {
        let coefficient = t.coefficient * factor;
        let rounded = coefficient.round();
        let near = rounded != 0.0 && (coefficient - rounded).abs() < 1e-11 * rounded.abs();
        Term { coefficient: if near { rounded } else { coefficient }, ..*t }
    };
    Polynomial { terms: p.terms.iter().map(scale_and_round_term).collect() }
}

/// Multiplies all polynomials by the even powers of atoms that occur in their denominators.
fn multiplied_by_even_denominators(all: &[Polynomial], ring: &mut Ring) -> Option<Vec<Polynomial>> {
    let mut out = all.to_vec();
    for k in 0..ring.atoms.len() {
        let Atom::Inverse(p) = &ring.atoms[k] else { continue };
        let [Term { monomial, .. }] = p.terms.as_slice() else { continue };
        let monomial = *monomial;
        let power = out.iter().flat_map(|p| &p.terms).map(|t| t.monomial.power_of_atom(k)).max().unwrap_or(0);
        let factor = Polynomial::from_term(monomial, 1.0);
        for _ in 0..power.saturating_sub(power % 2) {
            out = out.iter().map(|p| ring.multiply_and_reduce(p, &factor)).collect::<Option<_>>()?;
        }
    }
    Some(out)
}
