//! Hoisting of values that are computed before a program runs. Programs treat such values as constants with
//! symbols of their own, one for each sign. A node of the graph has the same symbol in all programs.

use super::{Operand, Program};
use crate::expr::{Id, Node, Symbol};

/// Bit of symbols that name a node of the graph.
const HOISTED: u32 = 1 << 31;
/// Bit of symbols that name the negative of a node.
const MINUS: u32 = 1 << 30;

/// Returns the node that a symbol names, and true for its negative; `None` for a symbol of the graph.
pub fn node_of_hoisted_symbol(symbol: Symbol) -> Option<(Id, bool)> {
    (symbol.0 & HOISTED != 0).then_some((symbol.0 & !(HOISTED | MINUS), symbol.0 & MINUS != 0))
}

/// Replaces symbols of hoisted nodes by other symbols.
pub fn replace_hoisted_symbols(program: &mut Program, place: &mut dyn FnMut(Id, bool) -> Symbol) {
    let mut with_hoisted_symbol_replaced = |o: Operand| match o {
        Operand::Symbol(s) => match node_of_hoisted_symbol(s) {
            Some((id, negative)) => Operand::Symbol(place(id, negative)),
            None => o,
        },
        _ => o,
    };
    for op in &mut program.instructions {
        *op = op.map_operands(&mut with_hoisted_symbol_replaced);
    }
    for output in &mut program.outputs {
        *output = with_hoisted_symbol_replaced(*output);
    }
    if let Some(program) = &mut program.simd {
        replace_hoisted_symbols(program, place);
    }
}

/// Returns the symbol of a hoisted node as an operand.
pub(super) fn operand_of_hoisted_node(id: Id) -> Operand {
    Operand::Symbol(Symbol(HOISTED | id))
}

/// Returns whether an operand is a constant or a hoisted value.
pub(super) fn is_constant_or_hoisted(o: Operand) -> bool {
    match o {
        Operand::Const(_) | Operand::Tuple(_) => true,
        Operand::Symbol(s) => node_of_hoisted_symbol(s).is_some(),
        Operand::Value(_) | Operand::Gather(_) => false,
    }
}

/// Returns the negative of a constant or hoisted value.
pub(super) fn negate_constant_or_hoisted(o: Operand) -> Operand {
    match o {
        Operand::Const(c) => Operand::Const(-c),
        Operand::Symbol(Symbol(s)) => Operand::Symbol(Symbol(s ^ MINUS)),
        Operand::Value(_) | Operand::Tuple(_) | Operand::Gather(_) => o,
    }
}

/// Returns for each node, operands first, whether it depends on known symbols and constants only, and on at
/// least one known symbol. Operations on constants alone are not hoisted.
pub(super) fn hoisting_flags_of_nodes(
    nodes: &[Node],
    place: impl Fn(Id) -> usize,
    known: &dyn Fn(Symbol) -> bool,
) -> Vec<bool> {
    let mut before: Vec<bool> = Vec::with_capacity(nodes.len());
    for node in nodes {
        before.push(match node {
            Node::Const(_) | Node::Tuple(_) | Node::Gather(_) | Node::Join(..) => false,
            Node::Symbol(s) => known(*s),
            _ => {
                let (mut all, mut any) = (true, false);
                node.visit_operands(|a| {
                    any |= before[place(a)];
                    all &= before[place(a)] || matches!(nodes[place(a)], Node::Const(_));
                });
                all && any
            }
        });
    }
    before
}

#[cfg(test)]
mod tests {
    use crate::expr::eval::eval_one;
    use crate::expr::{Graph, Symbol};
    use crate::lower::{draft_with_hoisted_arguments, node_of_hoisted_symbol};

    /// Checks a program with two parameters and two variables: it neither computes nor negates values of the
    /// parameters alone.
    #[test]
    fn programs_do_not_compute_hoisted_values() {
        let g = Graph::new();
        let [m, l, x, y] = [0, 1, 2, 3].map(|k| g.symbol(Symbol(k)));
        let is_parameter_symbol = |s: Symbol| s.0 < 2;
        let test_number_of_symbol = |s: Symbol| 0.7 + f64::from(s.0);
        let ml = m * l;
        for (outputs, operations) in [
            (vec![ml * l.sin() * x], 1),
            (vec![-(ml * x * y)], 2),
            (vec![-(m + l) * x, m - x, -(x - m)], 2),
            (vec![m / (l + g.num(2.0)), g.num(3.0)], 0),
            (vec![x * y - ml, ml - x * y + y], 3),
        ] {
            let program = draft_with_hoisted_arguments(&outputs, &is_parameter_symbol);
            let expected: Vec<f64> = outputs.iter().map(|e| eval_one(*e, &test_number_of_symbol)).collect();
            let found = program.interpret_program(&|s| match node_of_hoisted_symbol(s) {
                Some((id, negative)) => {
                    eval_one(g.expr(id), &test_number_of_symbol) * if negative { -1.0 } else { 1.0 }
                }
                None => test_number_of_symbol(s),
            });
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-14, "{found} is not {expected}");
            }
            assert_eq!(program.counts.total_operations() + program.counts.calls, operations, "{outputs:?}");
        }
    }
}
