//! Functions of the option `prepare`: their programs take values that depend only on the parameters as
//! arguments. These values are computed once and shared by all functions.

use super::output::{Function, PreparedFunctions};
use crate::catalogue;
use crate::expr::{Expr, Graph, Id};
use crate::lower::{lower, pipeline, replace_hoisted_symbols};
use crate::mechanism::Quantity;
use std::collections::BTreeMap;

/// Extracts the precomputed values from the programs of the functions, in the order of their first use.
pub fn extract_prepared_values(graph: &Graph, mut functions: Vec<Function>) -> PreparedFunctions {
    let mut numbers: Vec<Expr<'_>> = Vec::new();
    let mut known: BTreeMap<(Id, bool), usize> = BTreeMap::new();
    let mut prepared_symbol_of_value = |id: Id, negative: bool| {
        let next = numbers.len();
        let k = *known.entry((id, negative)).or_insert(next);
        if k == next {
            let e = graph.expr(id);
            numbers.push(if negative { -e } else { e });
        }
        Quantity::Prepared(k).symbol()
    };
    // Conditions on parameters are checked before the values are computed.
    functions.retain(|f| f.id != catalogue::GeneratedId::Figures);
    for f in &mut functions {
        replace_hoisted_symbols(&mut f.program, &mut prepared_symbol_of_value);
    }
    PreparedFunctions { numbers: lower(&numbers).run_passes(pipeline::PART), functions }
}
