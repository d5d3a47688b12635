//! Code of the statements of a function body, in order.

use super::pieces::{ExpressionPiece, Statement};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Maximum number of variable bindings in one block of a function body.
pub const BLOCK: usize = 200;

/// Writes the statements, and those of a long body in blocks: rustc's debug information needs stack for every
/// binding of a block.
pub fn write_statements(out: &mut String, statements: &[Statement], outputs: &[ExpressionPiece]) {
    if statements.len() <= BLOCK {
        for statement in statements {
            write_body_statement(out, statement);
        }
        return;
    }
    // A value outlives its block if a later block or an output needs it. The map holds the last block that
    // needs each value.
    let blocks: Vec<&[Statement]> = statements.chunks(BLOCK).collect();
    let given = outputs.iter().flat_map(|p| &p.needs).map(|need| (*need, blocks.len()));
    let within = blocks
        .iter()
        .enumerate()
        .flat_map(|(b, block)| block.iter().flat_map(|s| &s.needs).map(move |need| (*need, b)));
    // Sines and cosines are bound before the blocks, hence values may be needed that no block binds.
    let last_need: BTreeMap<usize, usize> = within.chain(given).collect();
    // Values that outlive a block are declared before it: as the value of the block they would be bound twice
    // and passed in a tuple.
    for (b, block) in blocks.iter().enumerate() {
        let is_used_after_block =
            |s: &&Statement| s.names.iter().any(|k| last_need.get(k).is_some_and(|last| *last > b));
        let names: Vec<String> = block
            .iter()
            .filter(is_used_after_block)
            .flat_map(|s| &s.names)
            .map(|k| format!("t{k}"))
            .collect();
        match names.as_slice() {
            [] => {}
            [one] => _ = writeln!(out, "let {one};"),
            many => _ = writeln!(out, "let ({});", many.join(", ")),
        }
        out.push_str("{\n");
        for statement in *block {
            match is_used_after_block(&statement) {
                true => _ = writeln!(out, "{} = {};", statement.pattern, statement.text),
                false => write_body_statement(out, statement),
            }
        }
        out.push_str("}\n");
    }
}

/// Writes one statement of a function body.
pub fn write_body_statement(out: &mut String, statement: &Statement) {
    if statement.pattern.is_empty() {
        let _ = writeln!(out, "{}", statement.text);
        return;
    }
    let _ = writeln!(out, "let {} = {};", statement.pattern, statement.text);
}
