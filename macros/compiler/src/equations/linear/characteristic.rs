//! Characteristic polynomial of linear equations: the determinant of `M s² + C s + K`, bordered by the
//! constraints, expanded by minors.

use super::parts::{EquilibriumCoefficients, rank_of_symbol};
use super::rest::vanishes_identically;
use crate::algebra::factor::remove_rounding_noise;
use crate::algebra::normal::NormalFormCache;
use crate::algebra::polynomial::{Polynomial, Ring};
use crate::algebra::trigonometry::simplify_trigonometry;
use crate::expr::{Expr, Node, Symbol};
use crate::mechanism::{Model, Rule};
use std::collections::BTreeMap;

/// Maximum number of velocities of mechanisms whose polynomial is printed.
const VELOCITIES: usize = 3;
/// Maximum number of rows of the linear system, including constraints and states.
const ROWS: usize = 6;
/// Maximum degree: the largest power of the root that a monomial can have.
const DEGREE: usize = 7;
/// Maximum number of terms of all coefficients of the characteristic polynomial.
const TERMS: usize = 120;

/// A characteristic polynomial, with the properties of its parameters that the stability analysis uses.
pub struct CharacteristicPolynomial {
    /// Ring of all polynomials.
    pub ring: Ring,
    /// Coefficients in ascending powers of the root; the last coefficient is not zero.
    pub coefficients: Vec<Polynomial>,
    /// True if the forces derive from a potential. The squares of the roots are then real.
    pub conservative: bool,
    /// Parameters that are masses or otherwise required to be positive.
    pub positive: Vec<Symbol>,
}

/// A polynomial in the root: its coefficients in ascending powers.
type RootPolynomial = Vec<Polynomial>;

/// Returns the characteristic polynomial. `None` if the mechanism has too many velocities, or the polynomial
/// is too long or its degree too high.
pub fn characteristic_polynomial<'g>(
    model: &Model<'g>,
    all: &EquilibriumCoefficients<'g>,
) -> Option<CharacteristicPolynomial> {
    let (nv, nc) = (model.nv(), model.constraints.len());
    let rows = all.inputs.len();
    if nv > VELOCITIES || rows > ROWS {
        return None;
    }
    let mut normal = NormalFormCache::new(model.graph, rank_of_symbol);
    normal.ring.raise_term_limits();
    let mut matrix: Vec<Vec<RootPolynomial>> = Vec::new();
    for k in 0..rows {
        let deviations = 0..rows - nc;
        let root_polynomial_of_entry =
            |normal: &mut NormalFormCache<'g>, c: usize| -> Option<RootPolynomial> {
                all.orders.iter().map(|order| normal.normal_form(order[k][c])).collect()
            };
        let mut row: Vec<RootPolynomial> =
            deviations.map(|c| root_polynomial_of_entry(&mut normal, c)).collect::<Option<_>>()?;
        for multiplier in &all.multipliers[k] {
            row.push(vec![normal.normal_form(-*multiplier)?]);
        }
        matrix.push(row);
    }
    let conservative = is_conservative(model, all, &mut normal)?;
    let determinant = determinant_of_polynomials(&matrix, &mut normal.ring)?;
    let mut coefficients = Vec::new();
    for p in determinant {
        let p = remove_rounding_noise(&normal.ring, &p);
        let p = simplify_trigonometry(&mut normal.ring, &p)?;
        coefficients.push(if vanishes_identically(&normal.ring, &p) { Polynomial::default() } else { p });
    }
    while coefficients.last().is_some_and(|p| p.terms.is_empty()) {
        coefficients.pop();
    }
    let terms: usize = coefficients.iter().map(|p| p.terms.len()).sum();
    let positive = positive_parameters(model);
    let degree = coefficients.len().checked_sub(1)?;
    (terms <= TERMS && (1..=DEGREE).contains(&degree)).then_some(CharacteristicPolynomial {
        ring: normal.ring,
        coefficients,
        conservative,
        positive,
    })
}

/// Returns the parameters that are masses or otherwise required to be positive.
fn positive_parameters(model: &Model<'_>) -> Vec<Symbol> {
    let mut found = Vec::new();
    for requirement in &model.requirements {
        if let (Rule::Mass | Rule::Positive, [value]) = (requirement.rule, requirement.values.as_slice())
            && let Node::Symbol(symbol) = value.node()
        {
            found.push(symbol);
        }
    }
    found
}

/// Returns true if there is no damping and the stiffness is symmetric. `None` beyond the limits of the ring.
fn is_conservative<'g>(
    model: &Model<'g>,
    all: &EquilibriumCoefficients<'g>,
    normal: &mut NormalFormCache<'g>,
) -> Option<bool> {
    let nv = model.nv();
    let [stiffness, damping, _] = &all.orders;
    let holonomic = model.constraints.iter().all(|c| c.residual.is_some());
    if !holonomic || !model.acceleration_forces.is_empty() || all.inputs.len() > nv + model.constraints.len()
    {
        return Some(false);
    }
    let mut is_identically_zero = |e: Expr<'g>| -> Option<bool> {
        let p = normal.normal_form(e)?;
        Some(vanishes_identically(&normal.ring, &p))
    };
    for i in 0..nv {
        for j in 0..nv {
            if !is_identically_zero(damping[i][j])?
                || (j < i && !is_identically_zero(stiffness[i][j] - stiffness[j][i])?)
            {
                return Some(false);
            }
        }
    }
    Some(true)
}

/// Returns the determinant of a matrix of polynomials, built up from minors of its last rows.
fn determinant_of_polynomials(matrix: &[Vec<RootPolynomial>], ring: &mut Ring) -> Option<RootPolynomial> {
    let n = matrix.len();
    let mut minors: BTreeMap<u32, RootPolynomial> = BTreeMap::from([(0, vec![Polynomial::from_number(1.0)])]);
    for row in matrix.iter().rev() {
        let mut next: BTreeMap<u32, RootPolynomial> = BTreeMap::new();
        for (columns, minor) in &minors {
            for (c, entry) in row.iter().enumerate().filter(|(c, _)| columns & (1 << c) == 0) {
                if entry.iter().all(|p| p.terms.is_empty()) {
                    continue;
                }
                // Number of the other columns before this one.
                let before = (columns & ((1 << c) - 1)).count_ones();
                let sign = if before % 2 == 0 { 1.0 } else { -1.0 };
                let sum = next.entry(columns | (1 << c)).or_default();
                add_product(sum, entry, minor, sign, ring)?;
            }
        }
        minors = next;
    }
    // Rows that are zero leave no minor.
    Some(minors.remove(&((1 << n) - 1)).unwrap_or_default())
}

fn add_product(
    sum: &mut RootPolynomial,
    a: &RootPolynomial,
    b: &RootPolynomial,
    sign: f64,
    ring: &mut Ring,
) -> Option<()> {
    for (i, a) in a.iter().enumerate().filter(|(_, a)| !a.terms.is_empty()) {
        for (j, b) in b.iter().enumerate().filter(|(_, b)| !b.terms.is_empty()) {
            let product = ring.multiply_and_reduce(a, b)?.multiplied_by_number(sign);
            if sum.len() <= i + j {
                sum.resize(i + j + 1, Polynomial::default());
            }
            sum[i + j] = ring.add_within_limits(&sum[i + j], &product)?;
        }
    }
    Some(())
}
