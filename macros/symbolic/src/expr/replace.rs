//! Substitution of expressions for symbols, and the symbols in expressions.

use super::eval::nodes_in_order;
use super::node::{Function, Id, Node, Symbol};
use super::{Expr, Graph, Memo};

/// Substitutes `by(s)` for every symbol `s` of an expression for which it is not `None`.
pub fn substitute_symbols<'g>(e: Expr<'g>, by: &dyn Fn(Symbol) -> Option<Expr<'g>>) -> Expr<'g> {
    substitute_symbols_in_all(&[e], by).pop().unwrap_or(e)
}

/// Substitutes `by(s)` for every symbol `s` of several expressions for which it is not `None`.
pub fn substitute_symbols_in_all<'g>(
    e: &[Expr<'g>],
    by: &dyn Fn(Symbol) -> Option<Expr<'g>>,
) -> Vec<Expr<'g>> {
    replace_symbols_and_calls(e, by, &|f, x| x.apply_function(f))
}

/// Constructor of the replacement for an elementary function of an expression.
type CallReplacement<'a, 'g> = &'a dyn Fn(Function, Expr<'g>) -> Expr<'g>;

/// Substitutes `by(s)` for every symbol `s` of several expressions for which it is not `None`, and builds
/// elementary functions with `call`.
pub fn replace_symbols_and_calls<'g>(
    e: &[Expr<'g>],
    by: &dyn Fn(Symbol) -> Option<Expr<'g>>,
    call: CallReplacement<'_, 'g>,
) -> Vec<Expr<'g>> {
    let Some(first) = e.first() else { return Vec::new() };
    let mut known = Memo::new(first.graph());
    e.iter().map(|e| substitute_in_expression(*e, &mut known, by, call)).collect()
}

/// Substitutes `by` for every occurrence of the node `part` in an expression.
pub fn substitute_subexpression<'g>(e: Expr<'g>, part: Expr<'g>, by: Expr<'g>) -> Expr<'g> {
    let mut known = Memo::new(e.graph());
    known.assign_number(part.id(), by.id());
    substitute_in_expression(e, &mut known, &|_| None, &|f, x| x.apply_function(f))
}

fn substitute_in_expression<'g>(
    e: Expr<'g>,
    known: &mut Memo<'g>,
    by: &dyn Fn(Symbol) -> Option<Expr<'g>>,
    call: CallReplacement<'_, 'g>,
) -> Expr<'g> {
    let graph = e.graph();
    // Operands before operations, without recursion.
    let mut todo = vec![e.id()];
    while let Some(&id) = todo.last() {
        if known.get(id).is_some() {
            todo.pop();
            continue;
        }
        let before = todo.len();
        graph.node(id).visit_operands(|a| {
            if known.get(a).is_none() {
                todo.push(a);
            }
        });
        if todo.len() == before {
            let new = rebuild_node(graph, id, known, by, call).id();
            known.assign_number(id, new);
            todo.pop();
        }
    }
    known.get(e.id()).map_or(e, |id| graph.expr(id))
}

fn rebuild_node<'g>(
    graph: &'g Graph,
    id: Id,
    known: &Memo<'g>,
    by: &dyn Fn(Symbol) -> Option<Expr<'g>>,
    call: CallReplacement<'_, 'g>,
) -> Expr<'g> {
    let replaced_operand = |a: Id| graph.expr(known.get(a).unwrap_or(a));
    match graph.node(id) {
        Node::Const(_) | Node::Tuple(_) | Node::Gather(_) => graph.expr(id),
        Node::Sum(n, a) => replaced_operand(a).lane_sum(n.into()),
        Node::Lane(k, a) => replaced_operand(a).lane(k.into()),
        Node::Join(n, a, b) => replaced_operand(a).append_lanes(n.into(), replaced_operand(b)),
        Node::Symbol(s) => by(s).unwrap_or(graph.expr(id)),
        Node::Neg(a) => -replaced_operand(a),
        Node::Add(a, b) => replaced_operand(a) + replaced_operand(b),
        Node::Sub(a, b) => replaced_operand(a) - replaced_operand(b),
        Node::Mul(a, b) => replaced_operand(a) * replaced_operand(b),
        Node::Div(a, b) => replaced_operand(a) / replaced_operand(b),
        Node::Call(f, a) => call(f, replaced_operand(a)),
        Node::Atan2(a, b) => replaced_operand(a).atan2(replaced_operand(b)),
        Node::Pow(a, b) => replaced_operand(a).pow(replaced_operand(b)),
        Node::Extreme(f, a, b) => replaced_operand(a).minimum_or_maximum(f, replaced_operand(b)),
        Node::Table(lookup, a, b, c) => {
            // Variables beyond those of the table are ignored.
            let x = [a, b, c];
            let last = lookup.variable_count().saturating_sub(1);
            graph.table_lookup(lookup, std::array::from_fn(|k| replaced_operand(x[k.min(last)])))
        }
    }
}

/// Returns all symbols that occur in expressions, in ascending order.
pub fn symbols_in(e: &[Expr<'_>]) -> Vec<Symbol> {
    let Some(first) = e.first() else { return Vec::new() };
    let graph = first.graph();
    let symbol_of_node = |id| match graph.node(id) {
        Node::Symbol(s) => Some(s),
        _ => None,
    };
    let mut symbols: Vec<Symbol> = nodes_in_order(graph, e).into_iter().filter_map(symbol_of_node).collect();
    symbols.sort_unstable();
    symbols
}
