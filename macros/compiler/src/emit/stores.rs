//! Results that go into matrices which a function is given: as soon as they are known, so that they need not wait in
//! memory of their own.

use super::body::{Outputs, Piece, Statement};
use super::function::{Function, Parted, Shape};
use std::fmt;

/// Up to how many statements results of alike limbs are stored at the end, column by column: then the lanes of several are
/// turned round in registers and stored together.
const TURNED: usize = 300;

/// An entry of a matrix.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    matrix: &'static str,
    column: usize,
    row: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.data.0[{}][{}]", self.matrix, self.column, self.row)
    }
}

/// The statements with those that store results, and the results that are left.
pub fn with_stores(
    f: &Function,
    statements: Vec<Statement>,
    outputs: &Outputs<'_>,
) -> (Vec<Statement>, Vec<Piece>) {
    let places = places(f, outputs);
    let in_limbs = f.program.in_lanes.as_ref().is_some_and(|program| !program.gathers.is_empty());
    let all = match in_limbs && statements.len() <= TURNED {
        true => at_the_end(statements, &places, outputs),
        false => as_known(statements, &places, outputs),
    };
    let given = places.iter().map(Vec::len).chain(std::iter::repeat(0));
    let left = outputs.pieces.iter().zip(given).enumerate();
    let left = left.filter(|(k, (_, places))| *places == 0 && !outputs.is_zero(*k));
    (all, left.map(|(_, (piece, _))| piece.clone()).collect())
}

/// Where each output goes. What is always zero goes nowhere, but in an inverse, to whose parts the rest is added; nor do the
/// columns of it that are still to come.
fn places(f: &Function, outputs: &Outputs<'_>) -> Vec<Vec<Place>> {
    let given = f.given();
    let Some(&matrix) = given.first() else { return Vec::new() };
    let (before, forces, n) = match f.shape {
        Shape::Symmetric(_) => {
            let both = |&(row, column): &(usize, usize)| {
                let mut places =
                    vec![Place { matrix, column, row }, Place { matrix, column: row, row: column }];
                places.dedup();
                places
            };
            return f.structure.entries.iter().map(both).collect();
        }
        Shape::Accelerated(n) => (n, 0, n),
        Shape::Pair(n) | Shape::Forward(n) => (0, 2 * n * n, n),
        _ => return Vec::new(),
    };
    let square = |matrix: &'static str| (0..n * n).map(move |k| Place { matrix, column: k / n, row: k % n });
    let all = given.into_iter().flat_map(square).enumerate();
    let overwritten = match &f.structure.inverse {
        Parted::Divided { trunk, .. } => trunk.as_slice(),
        _ => &[],
    };
    let kept = all.map(|(k, place)| {
        let goes_nowhere = (k < forces && outputs.is_zero(k)) || overwritten.contains(&place.column);
        if goes_nowhere { vec![] } else { vec![place] }
    });
    (0..before).map(|_| Vec::new()).chain(kept).collect()
}

/// Every result right after the last statement that it needs.
fn as_known(statements: Vec<Statement>, places: &[Vec<Place>], outputs: &Outputs<'_>) -> Vec<Statement> {
    let size = statements.iter().flat_map(|s| &s.names).max().map_or(0, |m| m + 1);
    let mut bound_by = vec![0; size];
    for (k, statement) in statements.iter().enumerate() {
        statement.names.iter().for_each(|name| bound_by[*name] = k + 1);
    }
    let mut ready: Vec<Vec<Statement>> = (0..=statements.len()).map(|_| Vec::new()).collect();
    for (piece, places) in outputs.pieces.iter().zip(places).filter(|(_, places)| !places.is_empty()) {
        let at = piece.needs.iter().filter_map(|need| bound_by.get(*need)).max().copied().unwrap_or(0);
        let text = match places.as_slice() {
            [one] => format!("{one} = {};", piece.text),
            several => several.iter().fold(format!("let entry = {};", piece.text), |text, place| {
                format!("{text}\n{place} = entry;")
            }),
        };
        ready[at].push(store(text, piece.needs.clone()));
    }
    let mut ready = ready.into_iter();
    let mut all: Vec<Statement> = ready.next().into_iter().flatten().collect();
    for (statement, ready) in statements.into_iter().zip(ready) {
        all.push(statement);
        all.extend(ready);
    }
    all
}

/// All results after the last statement.
fn at_the_end(
    mut statements: Vec<Statement>,
    places: &[Vec<Place>],
    outputs: &Outputs<'_>,
) -> Vec<Statement> {
    let stored =
        || outputs.pieces.iter().zip(places).enumerate().filter(|(_, (_, places))| !places.is_empty());
    let mut text: Vec<String> =
        stored().map(|(k, (piece, _))| format!("let entry{k} = {};", piece.text)).collect();
    let mut all: Vec<(Place, usize)> =
        stored().flat_map(|(k, (_, places))| places.iter().map(move |place| (*place, k))).collect();
    all.sort_unstable();
    text.extend(all.iter().map(|(place, k)| format!("{place} = entry{k};")));
    let needs = stored().flat_map(|(_, (piece, _))| piece.needs.clone()).collect();
    statements.push(store(text.join("\n"), needs));
    statements
}

fn store(text: String, needs: Vec<usize>) -> Statement {
    Statement { names: Vec::new(), pattern: String::new(), text, needs }
}
