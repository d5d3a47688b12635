//! Expressions as written, with unresolved names.

use crate::diag::Place;
use crate::language::{BodyOrInertiaMethod, Callable};

/// A word chosen by the user: an identifier of the source or a name of an imported file.
#[derive(Clone, Debug)]
pub struct Name {
    /// Text of the name.
    pub text: String,
    /// Span in the Rust source, or position in the imported file.
    pub place: Place,
}

/// A written word of the language, with its row in the tables.
#[derive(Clone, Debug)]
pub struct LanguageWord<I> {
    /// Text of the word.
    pub text: String,
    /// Span in the Rust source, or position in the imported file.
    pub place: Place,
    /// Row of the word in a table of the language; `None` for an unknown word.
    pub id: Option<I>,
}

/// A word before parentheses: a function, a solid, a rotation, or a table of the user.
pub type Callee = LanguageWord<Callable>;

impl Callee {
    /// Looks up a function name in the tables of the language.
    pub fn new(name: Name) -> Callee {
        let id = Callable::find_by_name(&name.text);
        LanguageWord { text: name.text, place: name.place, id }
    }
}

/// Word after the dot of a body, such as `at` in `body.at(vector)`.
pub type Member = LanguageWord<BodyOrInertiaMethod>;

impl Member {
    /// Looks up a method name with this number of arguments in the tables of the language.
    pub fn new(name: Name, count: usize) -> Member {
        let id = BodyOrInertiaMethod::find_by_name_and_argument_count(&name.text, count);
        LanguageWord { text: name.text, place: name.place, id }
    }
}

/// Expression with unresolved names.
#[derive(Clone, Debug)]
pub struct Expr {
    /// Kind of the expression with its operands.
    pub kind: ExprKind,
    /// Span in the Rust source, or position in the imported file.
    pub place: Place,
}

/// Kind of an expression with its operands.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// Finite number.
    Number(f64),
    /// Name such as `length`, `x` or `t`.
    Name(String),
    /// Member access such as `hoop.x`.
    Field(Box<Expr>, Name),
    /// Method call such as `body.at(vector)`.
    Method(Box<Expr>, Member, Vec<Expr>),
    /// Function call such as `sin(angle)` or `rod(mass, length, y)`.
    Call(Callee, Vec<Expr>),
    /// Negation `-e` of an expression.
    Neg(Box<Expr>),
    /// Binary operation such as `a + b`, with the span of the operator.
    Binary(BinaryOp, Box<Expr>, Box<Expr>, Place),
    /// Tuple `(a, b)` of expressions.
    Tuple(Vec<Expr>),
    /// Array `[a, b, c]` of expressions.
    Array(Vec<Expr>),
    /// Path of a mesh file, as in `hull("foot.obj")`.
    Text(String),
}

/// Binary operator of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    /// Addition `+`.
    Add,
    /// Subtraction `-`.
    Sub,
    /// Multiplication `*`.
    Mul,
    /// `/`, both division and the slash of `r(y / x)`
    Div,
}

impl Expr {
    /// Returns this expression and all its subexpressions, outer ones before inner ones.
    pub fn all_subexpressions(&self) -> Vec<&Expr> {
        let mut parts = vec![self];
        let mut next = 0;
        while let Some(part) = parts.get(next) {
            next += 1;
            match &part.kind {
                ExprKind::Number(_) | ExprKind::Name(_) | ExprKind::Text(_) => {}
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

    /// Returns the name if the expression is a single name.
    pub fn as_name(&self) -> Option<&str> {
        match &self.kind {
            ExprKind::Name(name) => Some(name),
            _ => None,
        }
    }

    /// Returns the number, with its sign, if the expression is a number.
    pub fn literal_number(&self) -> Option<f64> {
        match &self.kind {
            ExprKind::Number(n) => Some(*n),
            ExprKind::Neg(inner) => inner.literal_number().map(|n| -n),
            _ => None,
        }
    }

    /// Returns a number expression at a source position.
    pub fn number_at(value: f64, place: &Place) -> Expr {
        Expr { kind: ExprKind::Number(value), place: place.clone() }
    }

    /// Returns a function call at a source position.
    pub fn function_call_expression(function: &str, arguments: Vec<Expr>, place: &Place) -> Expr {
        let name = Name { text: function.to_string(), place: place.clone() };
        Expr { kind: ExprKind::Call(Callee::new(name), arguments), place: place.clone() }
    }

    /// Returns a binary operation at the source position of the first operand.
    pub fn binary_operation(op: BinaryOp, a: Expr, b: Expr) -> Expr {
        let place = a.place.clone();
        Expr { kind: ExprKind::Binary(op, Box::new(a), Box::new(b), place.clone()), place }
    }

    /// Returns the method call `base.word(arguments)` at the source position of `base`.
    pub fn method_call(base: Expr, word: &str, arguments: Vec<Expr>) -> Expr {
        let place = base.place.clone();
        let name = Name { text: word.to_string(), place: place.clone() };
        let member = Member::new(name, arguments.len());
        Expr { kind: ExprKind::Method(Box::new(base), member, arguments), place }
    }

    /// Returns three numbers as a vector `[a, b, c]` at a source position.
    pub fn vector_at(values: [f64; 3], place: &Place) -> Expr {
        let items = values.iter().map(|v| Expr::number_at(*v, place)).collect();
        Expr { kind: ExprKind::Array(items), place: place.clone() }
    }
}
