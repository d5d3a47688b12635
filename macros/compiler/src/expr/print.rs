//! Expressions as text.

use super::graph::{Expr, Node, Symbol};

/// An expression in one line, with names for its symbols. For small expressions: what is shared is written out, up to
/// a limit of depth.
pub fn plain(e: Expr<'_>, name: &dyn Fn(Symbol) -> String) -> String {
    term(e, name, 0, 24)
}

/// Text of a node; parentheses where its operator binds less than `level` (1 for sums, 2 for products, 3 for powers).
fn term(e: Expr<'_>, name: &dyn Fn(Symbol) -> String, level: u8, depth: u8) -> String {
    if depth == 0 {
        return "…".to_string();
    }
    let at = |id, level| term(e.graph().expr(id), name, level, depth - 1);
    let (text, own) = match e.node() {
        Node::Const(c) => (format!("{c}"), if c < 0.0 { 1 } else { 4 }),
        Node::Symbol(s) => (name(s), 4),
        Node::Neg(a) => (format!("-{}", at(a, 2)), 1),
        Node::Add(a, b) => (format!("{} + {}", at(a, 1), at(b, 1)), 1),
        Node::Sub(a, b) => (format!("{} - {}", at(a, 1), at(b, 2)), 1),
        Node::Mul(a, b) => (format!("{} * {}", at(a, 2), at(b, 2)), 2),
        Node::Div(a, b) => (format!("{} / {}", at(a, 2), at(b, 3)), 2),
        Node::Call(f, a) => (format!("{}({})", f.name(), at(a, 0)), 4),
        Node::Atan2(a, b) => (format!("atan2({}, {})", at(a, 0), at(b, 0)), 4),
        Node::Pow(a, b) => (format!("pow({}, {})", at(a, 0), at(b, 0)), 4),
    };
    if own < level { format!("({text})") } else { text }
}
