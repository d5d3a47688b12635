//! Stores of results in matrix arguments, each immediately after the result is computed.

use super::pieces::{ExpressionPiece, OutputTexts, Statement};
use super::signature::result_matrix_names;
use crate::catalogue::{InverseForm, Shape};
use crate::derive::Function;
use crate::lower::{Op, Operand, Program};
use crate::machine::{NEAR_STATEMENTS, TRANSPOSED_STATEMENTS};
use std::fmt;

/// Entry of a matrix argument, to which an output is stored.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct MatrixEntry {
    /// Name of the matrix that contains the entry.
    matrix: &'static str,
    /// Column index of the entry.
    column: usize,
    /// Row index of the entry.
    row: usize,
}

impl fmt::Display for MatrixEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.data.0[{}][{}]", self.matrix, self.column, self.row)
    }
}

/// Returns the statements with stores of the results inserted, and the results that are not stored and not
/// zero.
pub fn insert_result_stores(
    f: &Function,
    program: &Program,
    statements: Vec<Statement>,
    outputs: &OutputTexts<'_>,
) -> (Vec<Statement>, Vec<ExpressionPiece>) {
    let places = matrix_entries_by_output(f, outputs);
    let all = match !program.gathers.is_empty() && statements.len() <= TRANSPOSED_STATEMENTS {
        true => append_all_stores(statements, &places, outputs),
        false => insert_stores_after_dependencies(program, statements, &places, outputs),
    };
    let given = places.iter().map(Vec::len).chain(std::iter::repeat(0));
    let left = outputs.pieces.iter().zip(given).enumerate();
    let left = left.filter(|(k, (_, places))| *places == 0 && !outputs.is_zero(*k));
    (all, left.map(|(_, (piece, _))| piece.clone()).collect())
}

/// Returns the entries in which each output is stored. Constant zeros of derivatives are not stored; those of
/// an inverse are, because terms are added to it later. Trunk columns of a block arrow inverse are not
/// stored, because they are computed later.
fn matrix_entries_by_output(f: &Function, outputs: &OutputTexts<'_>) -> Vec<Vec<MatrixEntry>> {
    let given = result_matrix_names(f);
    let [matrix, ..] = *given.as_slice() else { return Vec::new() };
    let (before, has_forces, n) = match f.shape {
        Shape::Symmetric(_) => {
            let symmetric_entries = |&(row, column): &(usize, usize)| {
                let mut places = vec![
                    MatrixEntry { matrix, column, row },
                    MatrixEntry { matrix, column: row, row: column },
                ];
                places.dedup();
                places
            };
            return f.structure.entries.iter().map(symmetric_entries).collect();
        }
        Shape::Accelerated(n) => (n, false, n),
        Shape::Pair(n) | Shape::Forward(n) => (0, true, n),
        _ => return Vec::new(),
    };
    let entries_of_square_matrix =
        |matrix: &'static str| (0..n * n).map(move |k| MatrixEntry { matrix, column: k / n, row: k % n });
    let all = given.into_iter().flat_map(entries_of_square_matrix).enumerate();
    let overwritten = match &f.structure.inverse {
        InverseForm::BlockArrow { trunk, .. } => trunk.as_slice(),
        _ => &[],
    };
    let kept = all.map(|(k, place)| {
        let goes_nowhere =
            (has_forces && k < 2 * n * n && outputs.is_zero(k)) || overwritten.contains(&place.column);
        if goes_nowhere { vec![] } else { vec![place] }
    });
    (0..before).map(|_| Vec::new()).chain(kept).collect()
}

/// Inserts the store of every result directly after the last statement on which the result depends.
fn insert_stores_after_dependencies(
    program: &Program,
    statements: Vec<Statement>,
    places: &[Vec<MatrixEntry>],
    outputs: &OutputTexts<'_>,
) -> Vec<Statement> {
    let size = statements.iter().flat_map(|s| &s.names).max().map_or(0, |m| m + 1);
    let mut bound_by = vec![0; size];
    for (k, statement) in statements.iter().enumerate() {
        statement.names.iter().for_each(|name| bound_by[*name] = k + 1);
    }
    let mut ready: Vec<Vec<Statement>> = (0..=statements.len()).map(|_| Vec::new()).collect();
    let mut left = places.to_vec();
    let index_of_binding_statement = |name: usize| bound_by.get(name).copied().filter(|at| *at > 0);
    let last_binding_statement = |needs: &[usize]| {
        needs.iter().filter_map(|need| index_of_binding_statement(*need)).max().unwrap_or(0)
    };
    let mut pairs: Vec<Vec<[StoredLane; 2]>> = ready.iter().map(|_| Vec::new()).collect();
    for [one, next] in
        adjacent_lane_pairs(result_lanes_sorted_by_entry(program, places, &index_of_binding_statement))
    {
        for lane in [&one, &next] {
            left[lane.output].retain(|place| *place != lane.place);
        }
        pairs[one.known.max(next.known)].push([one, next]);
    }
    let widths = program.lane_counts();
    for (pairs, ready) in pairs.iter().zip(&mut ready) {
        ready.extend(pair_store_statements(pairs, &widths));
    }
    for (piece, places) in outputs.pieces.iter().zip(&left).filter(|(_, places)| !places.is_empty()) {
        let text = match places.as_slice() {
            [one] => format!("{one} = {};", piece.text),
            several => several.iter().fold(format!("let entry = {};", piece.text), |text, place| {
                format!("{text}\n{place} = entry;")
            }),
        };
        ready[last_binding_statement(&piece.needs)].push(store_statement(text, piece.needs.clone()));
    }
    let mut ready = ready.into_iter();
    let mut all: Vec<Statement> = ready.next().into_iter().flatten().collect();
    for (statement, ready) in statements.into_iter().zip(ready) {
        all.push(statement);
        all.extend(ready);
    }
    all
}

/// SIMD lane of a vector that is stored in a matrix.
struct StoredLane {
    /// Matrix entry in which the SIMD lane is stored.
    place: MatrixEntry,
    /// Index of the program output that is stored.
    output: usize,
    /// Number of the vector value that contains the lane.
    vector: usize,
    /// Index of the lane in the vector.
    lane: usize,
    /// Number of statements up to and including the one that computes the vector.
    known: usize,
}

/// Returns all results that are SIMD lanes of named vectors, sorted by their matrix entries.
fn result_lanes_sorted_by_entry(
    program: &Program,
    places: &[Vec<MatrixEntry>],
    known: &dyn Fn(usize) -> Option<usize>,
) -> Vec<StoredLane> {
    let mut all = Vec::new();
    for (output, (operand, places)) in program.outputs.iter().zip(places).enumerate() {
        if let Operand::Value(v) = operand
            && let Op::Lane(lane, Operand::Value(vector)) = program.instructions[*v]
            && let Some(known) = known(vector)
        {
            all.extend(places.iter().map(|place| StoredLane { place: *place, output, vector, lane, known }));
        }
    }
    all.sort_by_key(|lane| lane.place);
    all
}

/// Returns pairs of lanes that one instruction can store: their entries are adjacent in a column, and their
/// vectors are computed at most [`NEAR_STATEMENTS`] statements apart.
fn adjacent_lane_pairs(lanes: Vec<StoredLane>) -> Vec<[StoredLane; 2]> {
    let mut pairs = Vec::new();
    let mut rest = lanes.into_iter().peekable();
    while let Some(one) = rest.next() {
        let below = MatrixEntry { row: one.place.row + 1, ..one.place };
        let is_lane_below =
            |next: &StoredLane| next.place == below && next.known.abs_diff(one.known) <= NEAR_STATEMENTS;
        if let Some(next) = rest.next_if(is_lane_below) {
            pairs.push([one, next]);
        }
    }
    pairs
}

/// Returns the statements that store pairs of lanes. All lanes of a vector in adjacent rows are stored
/// together, as are all lanes of two vectors in adjacent columns; remaining pairs are stored individually.
fn pair_store_statements(pairs: &[[StoredLane; 2]], widths: &[usize]) -> Vec<Statement> {
    let mut statements = Vec::new();
    let mut rest = pairs;
    while let [[one, next], ..] = rest {
        let MatrixEntry { matrix, column, row } = one.place;
        let (a, b, width) = (one.vector, next.vector, widths[one.vector]);
        let is_continuation_of_run = |step: usize, down: usize, right: usize| {
            move |(k, [x, y]): &(usize, &[StoredLane; 2])| {
                let place = MatrixEntry { matrix, column: column + k * right, row: row + k * down };
                let lanes = (one.lane + k * step, next.lane + k * step);
                x.place == place && (x.vector, y.vector) == (a, b) && (x.lane, y.lane) == lanes
            }
        };
        let length_of_run = |step, down, right| {
            rest.iter().enumerate().take_while(is_continuation_of_run(step, down, right)).count()
        };
        let (text, taken) = if a == b
            && (one.lane, next.lane) == (0, 1)
            && 2 * length_of_run(2, 2, 0) == width
        {
            (
                format!(
                    "Ops::store_lanes_in_column::<{row}, _, _, _>(&mut {matrix}.data.0[{column}], t{a});"
                ),
                width / 2,
            )
        } else if (one.lane, next.lane) == (0, 0) && widths[b] == width && length_of_run(1, 0, 1) == width {
            (
                format!(
                    "Ops::store_two_rows::<{row}, {column}, _, _, _, _>(&mut {matrix}.data.0, t{a}, t{b});"
                ),
                width,
            )
        } else {
            let lanes = format!("{}, {}", one.lane, next.lane);
            let column = format!("{matrix}.data.0[{column}]");
            (
                format!(
                    "Ops::store_two_lanes_in_column::<{lanes}, {row}, _, _, _, _>(&mut {column}, t{a}, t{b});"
                ),
                1,
            )
        };
        statements.push(store_statement(text, vec![a, b]));
        rest = &rest[taken..];
    }
    statements
}

/// Appends the stores of all results after the last statement, in the order of their entries.
fn append_all_stores(
    mut statements: Vec<Statement>,
    places: &[Vec<MatrixEntry>],
    outputs: &OutputTexts<'_>,
) -> Vec<Statement> {
    let stored =
        || outputs.pieces.iter().zip(places).enumerate().filter(|(_, (_, places))| !places.is_empty());
    let mut text: Vec<String> =
        stored().map(|(k, (piece, _))| format!("let entry{k} = {};", piece.text)).collect();
    let mut all: Vec<(MatrixEntry, usize)> =
        stored().flat_map(|(k, (_, places))| places.iter().map(move |place| (*place, k))).collect();
    all.sort_unstable();
    text.extend(all.iter().map(|(place, k)| format!("{place} = entry{k};")));
    let needs = stored().flat_map(|(_, (piece, _))| piece.needs.clone()).collect();
    statements.push(store_statement(text.join("\n"), needs));
    statements
}

fn store_statement(text: String, needs: Vec<usize>) -> Statement {
    Statement { names: Vec::new(), pattern: String::new(), text, needs }
}
