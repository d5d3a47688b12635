//! Generalized speeds: the velocities on which they depend, their invertibility, and the inverse matrix.

use super::redundancy::OrthonormalRowBasis;
use super::rows::{random_configuration, symbol_value_at_rest};
use crate::algebra::normal::NormalFormCache;
use crate::algebra::polynomial::{AtomRank, polynomial_to_expression};
use crate::algebra::trigonometry::simplify_trigonometry;
use crate::algebra::unit::simplify_on_unit_sphere;
use crate::expr::eval::Tape;
use crate::expr::{Expr, Symbol};
use crate::mechanism::{Chart, Model, Quantity};
use std::collections::BTreeMap;

/// Maximum size of a block of coupled speeds, since the inverse is expanded by minors.
pub const MOST_COUPLED: usize = 8;
/// Number of random configurations in which identities are tested.
const SAMPLES: u64 = 4;
/// A row counts as a linear combination of others if its relative remainder is below this tolerance.
const TOLERANCE: f64 = 1e-9;

type ExpressionMatrix<'g> = Vec<Vec<Expr<'g>>>;

/// Returns the entries of a matrix in random configurations, row by row.
fn sampled_matrix_entries(model: &Model<'_>, rows: &ExpressionMatrix<'_>) -> Vec<Vec<Vec<f64>>> {
    let entries: Vec<Expr<'_>> = rows.iter().flatten().copied().collect();
    let (tape, width) = (Tape::new(&entries), rows.first().map_or(0, Vec::len).max(1));
    let sampled_rows = |seed| {
        let q = random_configuration(model, seed);
        tape.evaluate_at(&|s| symbol_value_at_rest(s, &q, seed)).chunks(width).map(<[f64]>::to_vec).collect()
    };
    (0..SAMPLES).map(sampled_rows).collect()
}

/// Returns the columns of a matrix that are not zero in all configurations.
pub fn nonzero_columns(model: &Model<'_>, rows: &ExpressionMatrix<'_>) -> Vec<usize> {
    let all = sampled_matrix_entries(model, rows);
    let width = rows.first().map_or(0, Vec::len);
    let is_nonzero_column = |k: &usize| all.iter().flatten().any(|row| row[*k].abs() > TOLERANCE);
    (0..width).filter(is_nonzero_column).collect()
}

/// Returns the first row that is a combination of its predecessors in every configuration; `None` if there is
/// none.
pub fn index_of_first_dependent_row(model: &Model<'_>, rows: &ExpressionMatrix<'_>) -> Option<usize> {
    let first_dependent_row = |sample: &Vec<Vec<f64>>| {
        let mut basis = OrthonormalRowBasis::default();
        sample.iter().position(|row| {
            let before = basis.rank();
            basis.add_independent_row(row, TOLERANCE);
            basis.rank() == before
        })
    };
    let found: Vec<Option<usize>> =
        sampled_matrix_entries(model, rows).iter().map(first_dependent_row).collect();
    found.into_iter().collect::<Option<Vec<usize>>>().and_then(|rows| rows.into_iter().max())
}

/// Returns the inverse of a square matrix, block by block: minors over determinants, simplified. Returns
/// `None` if a block is larger than [`MOST_COUPLED`] or not square.
pub fn inverse_of_speed_matrix<'g>(
    model: &Model<'g>,
    rows: &ExpressionMatrix<'g>,
) -> Option<ExpressionMatrix<'g>> {
    let n = rows.len();
    let mut out = vec![vec![model.graph.zero(); n]; n];
    for (own_rows, own_columns) in connected_blocks(rows) {
        if own_rows.len() > MOST_COUPLED || own_rows.len() != own_columns.len() {
            return None;
        }
        let block = own_rows.iter().map(|i| own_columns.iter().map(|j| rows[*i][*j]).collect()).collect();
        let found = invert_speed_block_with_minors(model, &block);
        for (i, row) in own_columns.iter().zip(found) {
            for (j, entry) in own_rows.iter().zip(row) {
                out[*i][*j] = entry;
            }
        }
    }
    Some(out)
}

/// Returns the sets of rows and columns that are connected by nonzero entries.
fn connected_blocks(rows: &ExpressionMatrix<'_>) -> Vec<(Vec<usize>, Vec<usize>)> {
    let n = rows.len();
    let mut left: Vec<usize> = (0..n).collect();
    let mut blocks = Vec::new();
    while let Some(first) = left.first().copied() {
        let (mut own, mut columns) = (vec![first], Vec::new());
        let mut at = 0;
        while let Some(row) = own.get(at).copied() {
            at += 1;
            for j in (0..n).filter(|j| !rows[row][*j].is_zero()) {
                if columns.contains(&j) {
                    continue;
                }
                columns.push(j);
                let others: Vec<usize> =
                    left.iter().copied().filter(|i| !own.contains(i) && !rows[*i][j].is_zero()).collect();
                own.extend(others);
            }
        }
        own.sort_unstable();
        columns.sort_unstable();
        left.retain(|i| !own.contains(i));
        blocks.push((own, columns));
    }
    blocks
}

fn invert_speed_block_with_minors<'g>(
    model: &Model<'g>,
    rows: &ExpressionMatrix<'g>,
) -> ExpressionMatrix<'g> {
    let n = rows.len();
    let mut minors = MinorCache { model, rows, known: BTreeMap::new() };
    let all = (1_u32 << n) - 1;
    let whole = minors.submatrix_determinant(all, all);
    let mut inverse_entry = |i: usize, j: usize| {
        let minor = minors.submatrix_determinant(all & !(1 << j), all & !(1 << i));
        let signed = if (i + j).is_multiple_of(2) { minor } else { -minor };
        shorten_expression(model, signed / whole)
    };
    (0..n).map(|i| (0..n).map(|j| inverse_entry(i, j)).collect()).collect()
}

/// Cache of the minors of a matrix; sets of rows and columns are bit masks.
struct MinorCache<'a, 'g> {
    model: &'a Model<'g>,
    rows: &'a ExpressionMatrix<'g>,
    known: BTreeMap<(u32, u32), Expr<'g>>,
}

impl<'g> MinorCache<'_, 'g> {
    /// Returns the determinant of a submatrix, expanded along its first row.
    fn submatrix_determinant(&mut self, rows: u32, columns: u32) -> Expr<'g> {
        if rows == 0 {
            return self.model.graph.one();
        }
        if let Some(known) = self.known.get(&(rows, columns)) {
            return *known;
        }
        let first = rows.trailing_zeros() as usize;
        let mut sum = self.model.graph.zero();
        let own = (0..self.rows.len()).filter(|j| columns & (1 << j) != 0);
        for (k, j) in own.enumerate() {
            let entry = self.rows[first][j];
            if entry.is_zero() {
                continue;
            }
            let product = entry * self.submatrix_determinant(rows & (rows - 1), columns & !(1 << j));
            if k % 2 == 0 { sum += product } else { sum -= product }
        }
        let sum = shorten_expression(self.model, sum);
        self.known.insert((rows, columns), sum);
        sum
    }
}

/// Returns an equivalent expression of the configuration with fewer operations, if identities of sines and
/// cosines or of unit quaternions give one; otherwise the expression itself.
pub fn shorten_expression<'g>(model: &Model<'g>, e: Expr<'g>) -> Expr<'g> {
    let found = simplified_form(model, e);
    found.filter(|found| Tape::new(&[*found]).node_count() < Tape::new(&[e]).node_count()).unwrap_or(e)
}

fn simplified_form<'g>(model: &Model<'g>, e: Expr<'g>) -> Option<Expr<'g>> {
    let mut normal = NormalFormCache::new(model.graph, |_: Symbol| AtomRank::Position);
    let p = normal.normal_form(e)?;
    let mut p = simplify_trigonometry(&mut normal.ring, &p)?;
    for quaternion in quaternion_symbols(model) {
        p = simplify_on_unit_sphere(&mut normal.ring, &p, &quaternion)?;
    }
    Some(polynomial_to_expression(model.graph, &normal.ring, &p))
}

/// Returns the symbols of the components of all unit quaternions.
pub fn quaternion_symbols(model: &Model<'_>) -> Vec<[Symbol; 4]> {
    let firsts = model.charts.iter().filter_map(Chart::first_quaternion_index);
    firsts.map(|q| [0, 1, 2, 3].map(|k| Quantity::Configuration(q.0 + k).symbol())).collect()
}
