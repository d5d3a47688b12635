//! Specialisation of programs to known parameters, and selection of the cheapest of several programs of a
//! function.

use crate::expr::{Expr, Symbol};
use crate::lower::{Program, draft_with_hoisted_arguments, operation_count};
use crate::mechanism::Quantity;

/// Tolerance of the comparison of sizes before lowering: factoring sums may change the operation count by the
/// first number of operations, plus one part in the second number.
const SPREAD: (usize, usize) = (3, 100);

/// Outputs of one candidate variant of a function, with their number of operations.
pub struct Candidate<'g> {
    /// Number of operations of the candidate.
    pub size: usize,
    /// Output expressions of the candidate.
    pub outputs: Vec<Expr<'g>>,
}

/// Specialisation of a function's program to parameters whose values are precomputed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterSpecialisation {
    /// No known parameters: the program computes all values.
    None,
    /// Parameters are known: values that depend only on parameters are precomputed.
    ByParameters,
}

impl ParameterSpecialisation {
    /// Lowers outputs to a program under this specialisation.
    pub fn lower_to_program(self, outputs: &[Expr<'_>]) -> Program {
        draft_with_hoisted_arguments(outputs, &|s| self.is_precomputed_symbol(s))
    }

    /// Returns the program with the fewest operations among equivalent candidates; among equal operation
    /// counts, the one with the fewest instructions.
    pub fn cheapest_program<'g>(self, lists: impl Iterator<Item = Candidate<'g>>) -> Program {
        self.cheapest_program_with_index(lists).1
    }

    /// Returns the program with the fewest operations among equivalent candidates, with the candidate's
    /// index.
    pub fn cheapest_program_with_index<'g>(
        self,
        lists: impl Iterator<Item = Candidate<'g>>,
    ) -> (usize, Program) {
        let all = candidates_with_fewest_operations(lists);
        let mut programs: Vec<(usize, Program)> =
            all.iter().map(|(k, list)| (*k, self.lower_to_program(list))).collect();
        let fewest = programs.iter().map(|(_, p)| p.counts.total_operations()).min();
        programs.retain(|(_, p)| Some(p.counts.total_operations()) == fewest);
        if programs.len() > 1 {
            programs.sort_by_cached_key(|(_, program)| program.instruction_count_after_fusion());
        }
        programs.into_iter().next().unwrap_or_default()
    }

    /// Returns the programs, with their indices, of the equivalent candidates that may be the cheapest in
    /// SIMD lanes.
    pub fn candidate_programs<'g>(self, lists: impl Iterator<Item = Candidate<'g>>) -> Vec<(usize, Program)> {
        candidates_with_fewest_operations(lists)
            .iter()
            .map(|(k, list)| (*k, self.lower_to_program(list)))
            .collect()
    }

    /// Returns the outputs as a candidate together with their number of operations.
    pub fn candidate_with_size(self, outputs: Vec<Expr<'_>>) -> Candidate<'_> {
        Candidate { size: operation_count(&outputs, &|s| self.is_precomputed_symbol(s)), outputs }
    }

    /// Returns true for a symbol whose value is precomputed.
    pub fn is_precomputed_symbol(self, symbol: Symbol) -> bool {
        self == ParameterSpecialisation::ByParameters
            && matches!(Quantity::from_symbol(symbol), Quantity::Parameter(_))
    }
}

/// Returns the equivalent candidates that may take the fewest operations, with their indices. Of identical
/// candidates, only the first is returned.
fn candidates_with_fewest_operations<'g>(
    lists: impl Iterator<Item = Candidate<'g>>,
) -> Vec<(usize, Vec<Expr<'g>>)> {
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
