//! What programs are specialised to, and which of several programs of a function is taken.

use crate::expr::{Expr, Symbol};
use crate::lower::{Program, lower_without, size};
use crate::mechanism::Quantity;

/// By how many operations equal functions may change places when their sums are factored: so many, and one in so many.
const SPREAD: (usize, usize) = (3, 100);

/// Outputs of one of several variants of a function, with their size in operations.
pub struct Candidate<'g> {
    /// Operations.
    pub size: usize,
    /// The outputs.
    pub outputs: Vec<Expr<'g>>,
}

/// What a function's program is specialised to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Specialisation {
    /// Nothing: it computes everything.
    None,
    /// Given parameters: what depends on them alone is computed before.
    ByParameters,
}

impl Specialisation {
    /// The program of outputs.
    pub fn program(self, outputs: &[Expr<'_>]) -> Program {
        lower_without(outputs, &|s| self.knows(s))
    }

    /// The program of the outputs that take the fewest operations of some that compute the same, and of equally many
    /// the fewest instructions.
    pub fn cheapest<'g>(self, lists: impl Iterator<Item = Candidate<'g>>) -> Program {
        self.cheapest_of(lists).1
    }

    /// The program of the outputs that take the fewest operations, with their number.
    pub fn cheapest_of<'g>(self, lists: impl Iterator<Item = Candidate<'g>>) -> (usize, Program) {
        let all = promising(lists);
        let mut programs: Vec<(usize, Program)> =
            all.iter().map(|(k, list)| (*k, self.program(list))).collect();
        let fewest = programs.iter().map(|(_, p)| p.counts.total()).min();
        programs.retain(|(_, p)| Some(p.counts.total()) == fewest);
        if programs.len() > 1 {
            programs.sort_by_cached_key(|(_, program)| program.fused_length());
        }
        programs.into_iter().next().unwrap_or_default()
    }

    /// The programs of those outputs, of some that compute the same, that may be the cheapest in lanes; with their
    /// numbers.
    pub fn programs<'g>(self, lists: impl Iterator<Item = Candidate<'g>>) -> Vec<(usize, Program)> {
        promising(lists).iter().map(|(k, list)| (*k, self.program(list))).collect()
    }

    /// Outputs with their size.
    pub fn sized(self, outputs: Vec<Expr<'_>>) -> Candidate<'_> {
        Candidate { size: size(&outputs, &|s| self.knows(s)), outputs }
    }

    /// True for what is known before.
    pub fn knows(self, symbol: Symbol) -> bool {
        self == Specialisation::ByParameters && matches!(Quantity::of(symbol), Quantity::Parameter(_))
    }
}

/// Those lists of outputs that may take the fewest operations of some that compute the same, with their numbers; of
/// lists that are the same, the first.
fn promising<'g>(lists: impl Iterator<Item = Candidate<'g>>) -> Vec<(usize, Vec<Expr<'g>>)> {
    let mut all: Vec<(usize, Candidate<'g>)> = lists.enumerate().collect();
    let most = all.iter().map(|(_, list)| list.size + SPREAD.0 + list.size / SPREAD.1).min().unwrap_or(0);
    all.retain(|(_, list)| list.size <= most);
    let mut chosen: Vec<(usize, Vec<Expr<'g>>)> = Vec::new();
    for (k, list) in all {
        if !chosen.iter().any(|(_, known)| *known == list.outputs) {
            chosen.push((k, list.outputs));
        }
    }
    chosen
}
