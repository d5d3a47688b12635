//! Expressions as text in one line.

use super::{Expr, Node, Symbol};
use std::fmt;

impl fmt::Debug for Expr<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format_expression(*self, &|s| format!("s{}", s.0)))
    }
}

/// Formats a small expression in one line, with names for its symbols. Shared subexpressions are expanded, up
/// to a maximum depth.
fn format_expression(e: Expr<'_>, name: &dyn Fn(Symbol) -> String) -> String {
    format_node(e, name, 0, 24)
}

/// Formats a node, in parentheses if its operator has a precedence below `level` (1 for sums, 2 for products,
/// 3 for powers).
fn format_node(e: Expr<'_>, name: &dyn Fn(Symbol) -> String, level: u8, depth: u8) -> String {
    if depth == 0 {
        return "…".to_string();
    }
    let format_operand = |id, level| format_node(e.graph().expr(id), name, level, depth - 1);
    let (text, own) = match e.node() {
        Node::Const(c) => (format!("{c}"), if c < 0.0 { 1 } else { 4 }),
        Node::Symbol(s) => (name(s), 4),
        Node::Tuple(k) => (format!("{:?}", e.graph().lanes_of_tuple(k)), 4),
        Node::Gather(k) => {
            let names: Vec<String> = e.graph().symbols_of_gather(k).into_iter().map(name).collect();
            (format!("[{}]", names.join(", ")), 4)
        }
        Node::Sum(_, a) => (format!("sum({})", format_operand(a, 0)), 4),
        Node::Lane(k, a) => (format!("{}[{k}]", format_operand(a, 4)), 4),
        Node::Join(_, a, b) => (format!("[{}; {}]", format_operand(a, 0), format_operand(b, 0)), 4),
        Node::Neg(a) => (format!("-{}", format_operand(a, 2)), 1),
        Node::Add(a, b) => (format!("{} + {}", format_operand(a, 1), format_operand(b, 1)), 1),
        Node::Sub(a, b) => (format!("{} - {}", format_operand(a, 1), format_operand(b, 2)), 1),
        Node::Mul(a, b) => (format!("{} * {}", format_operand(a, 2), format_operand(b, 2)), 2),
        Node::Div(a, b) => (format!("{} / {}", format_operand(a, 2), format_operand(b, 3)), 2),
        Node::Call(f, a) => (format!("{}({})", f.function_name(), format_operand(a, 0)), 4),
        Node::Atan2(a, b) => (format!("atan2({}, {})", format_operand(a, 0), format_operand(b, 0)), 4),
        Node::Table(lookup, a, b, c) => {
            let arguments: Vec<String> =
                [a, b, c].into_iter().take(lookup.variable_count()).map(|a| format_operand(a, 0)).collect();
            (format!("{}({})", e.graph().table_name(lookup), arguments.join(", ")), 4)
        }
        Node::Pow(a, b) => (format!("pow({}, {})", format_operand(a, 0), format_operand(b, 0)), 4),
        Node::Extreme(f, a, b) => {
            (format!("{}({}, {})", f.function_name(), format_operand(a, 0), format_operand(b, 0)), 4)
        }
    };
    if own < level { format!("({text})") } else { text }
}
