//! Linear dependence of columns of expressions. It is determined numerically: the columns are evaluated at
//! random states, and a column that is in the span of its predecessors is a combination of them.

use crate::expr::eval::eval;
use crate::expr::sample::sample_of_symbol;
use crate::expr::{Expr, Symbol};
use crate::kinematics::random_configuration;
use crate::mechanism::{Model, Quantity};

/// A column whose remainder relative to its norm is below this tolerance counts as dependent.
const TOLERANCE: f64 = 1e-8;

/// Linear combination of columns: pairs of an index and a factor.
pub type ColumnCombination = Vec<(usize, f64)>;

/// Result of the test of one column for linear independence.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnLinearDependence {
    /// Column that is linearly independent of its predecessors.
    Independent,
    /// This combination of independent predecessors; empty if the column is zero.
    Combination(ColumnCombination),
}

/// Classifies columns of equal length. A column whose factors depend on the parameters counts as independent.
pub fn classify_columns(model: &Model<'_>, columns: &[Vec<Expr<'_>>]) -> Vec<ColumnLinearDependence> {
    let one = test_column_independence(&sampled_column_values(model, columns, 0));
    if model.parameters.is_empty() {
        return one;
    }
    let other = test_column_independence(&sampled_column_values(model, columns, 1));
    let agreeing_test_result =
        |(one, other): (ColumnLinearDependence, ColumnLinearDependence)| match (&one, &other) {
            (ColumnLinearDependence::Combination(a), ColumnLinearDependence::Combination(b))
                if !are_equal_linear_combinations(a, b) =>
            {
                ColumnLinearDependence::Independent
            }
            _ => one,
        };
    one.into_iter().zip(other).map(agreeing_test_result).collect()
}

fn are_equal_linear_combinations(a: &[(usize, f64)], b: &[(usize, f64)]) -> bool {
    let is_nearly_equal = |x: f64, y: f64| (x - y).abs() <= 1e-6 * (1.0 + x.abs());
    a.len() == b.len() && a.iter().zip(b).all(|((i, x), (j, y))| i == j && is_nearly_equal(*x, *y))
}

/// Returns the values of each column at random states, for one choice of parameters. The number of values per
/// column exceeds the number of columns.
fn sampled_column_values(model: &Model<'_>, columns: &[Vec<Expr<'_>>], seed: u64) -> Vec<Vec<f64>> {
    let all: Vec<Expr<'_>> = columns.concat();
    let height = columns.first().map_or(1, Vec::len).max(1);
    let states = columns.len().div_ceil(height) + 4;
    let mut rows = vec![Vec::new(); columns.len()];
    for state in 0..states as u64 {
        let at = 1000 * (seed + 1) + state;
        let q = random_configuration(model, at);
        let found = eval(&all, &|s: Symbol| match Quantity::from_symbol(s) {
            Quantity::Configuration(k) => q[k],
            Quantity::Parameter(_) => sample_of_symbol(s, seed),
            _ => 4.0 * (sample_of_symbol(s, at) - 1.0),
        });
        for (row, found) in rows.iter_mut().zip(found.chunks(height)) {
            row.extend_from_slice(found);
        }
    }
    rows
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Orthogonalises the columns one after another (Gram–Schmidt, applied twice against rounding errors), and
/// returns which columns are independent.
fn test_column_independence(columns: &[Vec<f64>]) -> Vec<ColumnLinearDependence> {
    let largest = columns.iter().map(|c| dot(c, c).sqrt()).fold(0.0, f64::max);
    // Orthonormal vectors, each with its combination of independent columns.
    let mut base: Vec<(Vec<f64>, ColumnCombination)> = Vec::new();
    let mut parts = Vec::with_capacity(columns.len());
    for (k, column) in columns.iter().enumerate() {
        let size = dot(column, column).sqrt();
        if size <= TOLERANCE * largest {
            parts.push(ColumnLinearDependence::Combination(Vec::new()));
            continue;
        }
        let mut rest = column.clone();
        let mut along = vec![0.0; base.len()];
        for _ in 0..2 {
            for (share, (unit, _)) in along.iter_mut().zip(&base) {
                let part = dot(unit, &rest);
                *share += part;
                rest.iter_mut().zip(unit).for_each(|(r, u)| *r -= part * u);
            }
        }
        let mut combination = vec![0.0; k];
        for (share, (_, of)) in along.iter().zip(&base) {
            of.iter().for_each(|(i, factor)| combination[*i] += share * factor);
        }
        let left = dot(&rest, &rest).sqrt();
        if left > TOLERANCE * size {
            let mut of: ColumnCombination =
                (0..k).filter(|i| combination[*i] != 0.0).map(|i| (i, -combination[i] / left)).collect();
            of.push((k, 1.0 / left));
            base.push((rest.iter().map(|r| r / left).collect(), of));
            parts.push(ColumnLinearDependence::Independent);
        } else {
            let norm_of_column = |i: usize| dot(&columns[i], &columns[i]).sqrt();
            let is_significant_coefficient =
                |i: &usize| (combination[*i] * norm_of_column(*i)).abs() > 1e-7 * size;
            parts.push(ColumnLinearDependence::Combination(
                (0..k).filter(is_significant_coefficient).map(|i| (i, combination[i])).collect(),
            ));
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::{ColumnLinearDependence, test_column_independence};

    #[test]
    fn linear_combinations_are_detected() {
        let (a, b) = (vec![1.0, 2.0, -1.0, 0.5], vec![0.3, -1.0, 2.0, 4.0]);
        let zero = vec![0.0; 4];
        let c: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 2.0 * a - 0.5 * b).collect();
        let d = vec![1.0, 0.0, 0.0, 0.0];
        let found = test_column_independence(&[a, zero, b, c, d]);
        assert_eq!(
            (&found[0], &found[2], &found[4]),
            (
                &ColumnLinearDependence::Independent,
                &ColumnLinearDependence::Independent,
                &ColumnLinearDependence::Independent
            )
        );
        assert_eq!(found[1], ColumnLinearDependence::Combination(Vec::new()));
        let ColumnLinearDependence::Combination(list) = &found[3] else { panic!("{found:?}") };
        let [(0, x), (2, y)] = list[..] else { panic!("{list:?}") };
        assert!((x - 2.0).abs() < 1e-12 && (y + 0.5).abs() < 1e-12);
    }
}
