//! Words and expressions as written.

use crate::diag::Place;
use crate::language::{Callable, Method};

/// A word of the user's: an identifier of the source or a name of an imported file.
#[derive(Clone, Debug)]
pub struct Name {
    /// Text of the word.
    pub text: String,
    /// Span or position in the source.
    pub place: Place,
}

/// A word of the language as written, with its row in the tables.
#[derive(Clone, Debug)]
pub struct Term<I> {
    /// Text of the word.
    pub text: String,
    /// Span or position in the source.
    pub place: Place,
    /// The row; `None` for a word that is in no table.
    pub id: Option<I>,
}

/// A word before parentheses: a function, a solid, a rotation, or a table of the user's.
pub type Callee = Term<Callable>;

impl Callee {
    /// Looks up a word in the tables.
    pub fn new(name: Name) -> Callee {
        let id = Callable::of_name(&name.text);
        Term { text: name.text, place: name.place, id }
    }
}

/// A word behind the dot of a body.
pub type Member = Term<Method>;

impl Member {
    /// Looks up a word in the tables, with the number of its arguments.
    pub fn new(name: Name, count: usize) -> Member {
        let id = Method::of_call(&name.text, count);
        Term { text: name.text, place: name.place, id }
    }
}

/// An expression as written; names are not yet resolved.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub place: Place,
}

/// The forms of an expression.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A number, finite.
    Number(f64),
    /// `length`, `x`, `t`.
    Name(String),
    /// `hoop.x`.
    Field(Box<Expr>, Name),
    /// `body.at(vector)`.
    Method(Box<Expr>, Member, Vec<Expr>),
    /// `sin(angle)`, `rod(mass, length, y)`.
    Call(Callee, Vec<Expr>),
    /// `-e`.
    Neg(Box<Expr>),
    /// `a + b` and its kin, with the operator's place.
    Binary(BinaryOp, Box<Expr>, Box<Expr>, Place),
    /// `(a, b)`.
    Tuple(Vec<Expr>),
    /// `[a, b, c]`.
    Array(Vec<Expr>),
}

/// The operators between two expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `*`
    Mul,
    /// `/`, both division and the slash of `r(y / x)`
    Div,
}

impl Expr {
    /// This expression and everything inside it, from the outside in.
    pub fn parts(&self) -> Vec<&Expr> {
        let mut parts = vec![self];
        let mut at = 0;
        while let Some(part) = parts.get(at) {
            at += 1;
            match &part.kind {
                ExprKind::Number(_) | ExprKind::Name(_) => {}
                ExprKind::Field(base, _) | ExprKind::Neg(base) => parts.push(base),
                ExprKind::Method(base, _, items) => parts.extend([&**base].into_iter().chain(items)),
                ExprKind::Call(_, items) | ExprKind::Tuple(items) | ExprKind::Array(items) => {
                    parts.extend(items);
                }
                ExprKind::Binary(_, a, b, _) => parts.extend([&**a, b]),
            }
        }
        parts
    }

    /// The name that it is, if it is one.
    pub fn name(&self) -> Option<&str> {
        match &self.kind {
            ExprKind::Name(name) => Some(name),
            _ => None,
        }
    }

    /// The number that it is as written, with its sign.
    pub fn literal(&self) -> Option<f64> {
        match &self.kind {
            ExprKind::Number(n) => Some(*n),
            ExprKind::Neg(inner) => inner.literal().map(|n| -n),
            _ => None,
        }
    }

    /// A number at a place.
    pub fn number(value: f64, place: &Place) -> Expr {
        Expr { kind: ExprKind::Number(value), place: place.clone() }
    }

    /// A function call at a place.
    pub fn call(function: &str, arguments: Vec<Expr>, place: &Place) -> Expr {
        let name = Name { text: function.to_string(), place: place.clone() };
        Expr { kind: ExprKind::Call(Callee::new(name), arguments), place: place.clone() }
    }

    /// Two expressions with an operator between them, at the place of the first.
    pub fn binary(op: BinaryOp, a: Expr, b: Expr) -> Expr {
        let place = a.place.clone();
        Expr { kind: ExprKind::Binary(op, Box::new(a), Box::new(b), place.clone()), place }
    }

    /// `of.word(arguments)` at the place of what it is of.
    pub fn method(of: Expr, word: &str, arguments: Vec<Expr>) -> Expr {
        let place = of.place.clone();
        let name = Name { text: word.to_string(), place: place.clone() };
        let member = Member::new(name, arguments.len());
        Expr { kind: ExprKind::Method(Box::new(of), member, arguments), place }
    }

    /// Three numbers as a vector `[a, b, c]` at a place.
    pub fn vector(values: [f64; 3], place: &Place) -> Expr {
        let items = values.iter().map(|v| Expr::number(*v, place)).collect();
        Expr { kind: ExprKind::Array(items), place: place.clone() }
    }
}
