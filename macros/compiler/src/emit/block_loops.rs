//! Calls of the runtime's loops over blocks of links.

use super::pieces::{ExpressionPiece, Statement, array_expression};
use super::signature::{SignatureContext, result_matrix_names};
use crate::derive::{BlockLoopDerivatives, Function};
use crate::mechanism::{BLOCK_LENGTH, LINK_QUANTITIES, LinkBlock, MASS_PROPERTIES};
use std::collections::BTreeMap;
use std::fmt::Write;

const RUNTIME: &str = "::linkwork::__private";

/// Returns the statement that declares the array `links` of the quantities of the links. Inputs and constants
/// are stored in it at once.
pub fn link_array_declaration(
    loops: &BlockLoopDerivatives,
    outputs: &[ExpressionPiece],
    zero: &str,
) -> String {
    let links = outputs.get(..loops.link_quantity_output_count()).unwrap_or(&[]);
    let known = links.iter().map(|piece| if piece.needs.is_empty() { piece.text.as_str() } else { zero });
    format!("let mut links = {};\n", array_of_block_rows(&known.collect::<Vec<_>>(), LINK_QUANTITIES))
}

/// Returns the statements with those that store the quantities of the links in the array `links`, each after
/// the quantity is computed.
pub fn insert_link_store_statements(
    loops: &BlockLoopDerivatives,
    statements: Vec<Statement>,
    outputs: &[ExpressionPiece],
) -> Vec<Statement> {
    let names =
        statements.iter().enumerate().flat_map(|(k, s)| s.names.iter().map(move |name| (*name, k + 1)));
    let bound_by: BTreeMap<usize, usize> = names.collect();
    let mut ready: Vec<Vec<Statement>> = (0..=statements.len()).map(|_| Vec::new()).collect();
    let links = outputs.get(..loops.link_quantity_output_count()).unwrap_or(&[]);
    for (k, piece) in links.iter().enumerate().filter(|(_, piece)| !piece.needs.is_empty()) {
        let known = piece.needs.iter().filter_map(|need| bound_by.get(need)).max().copied().unwrap_or(0);
        let (row, lane) = (k / BLOCK_LENGTH, k % BLOCK_LENGTH);
        let (block, row) = (row / LINK_QUANTITIES, row % LINK_QUANTITIES);
        let text = format!("links[{block}][{row}].0[{lane}] = {};", piece.text);
        let needs = piece.needs.clone();
        ready[known].push(Statement { names: Vec::new(), pattern: String::new(), text, needs });
    }
    let mut ready = ready.into_iter();
    let mut all: Vec<Statement> = ready.next().into_iter().flatten().collect();
    for (statement, stores) in statements.into_iter().zip(ready) {
        all.push(statement);
        all.extend(stores);
    }
    all
}

/// Returns the outputs that the call of the loops contains.
pub fn outputs_in_loop_call<'a>(
    loops: &BlockLoopDerivatives,
    outputs: &'a [ExpressionPiece],
) -> &'a [ExpressionPiece] {
    outputs.get(loops.link_quantity_output_count()..).unwrap_or(&[])
}

/// Returns the call of the loops, which write the derivatives to the matrix arguments, and the statements
/// that add the derivatives of passive forces.
pub fn call_of_loops(
    f: &Function,
    loops: &BlockLoopDerivatives,
    s: &SignatureContext<'_>,
    outputs: &[ExpressionPiece],
) -> String {
    let texts: Vec<&str> =
        outputs_in_loop_call(loops, outputs).iter().map(|piece| piece.text.as_str()).collect();
    let (inertias, others) = texts.split_at(texts.len().min(loops.mass_property_output_count()));
    let (ground, passive) = others.split_at(others.len().min(3));
    let matrices = result_matrix_names(f);
    let [by_q, by_v] = matrices.as_slice() else { return String::new() };
    let blocks: Vec<String> = loops.blocks.iter().map(block_expression).collect();
    let mut text = format!(
        "{RUNTIME}::chain_derivatives::<Ops, {}, {}, {}, {}>(
            &[{}],
            &links,
            &{},
            &[{}],
            [&mut *{by_q}, &mut *{by_v}],
            [&{:?}, &{:?}],
        );\n",
        s.scalar.scalar_name(),
        s.nv,
        loops.blocks.len(),
        loops.free,
        blocks.join(", "),
        array_of_block_rows(inertias, MASS_PROPERTIES),
        ground.join(", "),
        loops.zeros[0],
        loops.zeros[1],
    );
    for ((by_velocity, row, column), value) in loops.passive.iter().zip(passive) {
        let matrix = if *by_velocity { by_v } else { by_q };
        let _ = writeln!(text, "{matrix}.data.0[{column}][{row}] += {value};");
    }
    text
}

/// Returns the array of the rows of all blocks, given the values of their lanes.
fn array_of_block_rows(values: &[&str], rows: usize) -> String {
    let link_row_expression =
        |lanes: &[&str]| format!("{RUNTIME}::LinkRow({})", array_expression(lanes.to_vec()));
    let block_rows_expression = |values: &[&str]| {
        let rows: Vec<String> = values.chunks(BLOCK_LENGTH).map(link_row_expression).collect();
        format!("[{}]", rows.join(", "))
    };
    let blocks: Vec<String> = values.chunks(rows * BLOCK_LENGTH).map(block_rows_expression).collect();
    format!("[{}]", blocks.join(", "))
}

fn block_expression(block: &LinkBlock) -> String {
    let parent = match block.parent {
        Some(parent) => format!("::core::option::Option::Some({parent})"),
        None => "::core::option::Option::None".to_string(),
    };
    format!(
        "{RUNTIME}::LinkBlock {{ first: {}, count: {}, parent: {parent}, ancestors: &{:?}, \
         descendants: &{:?} }}",
        block.first, block.count, block.ancestors, block.descendants
    )
}
