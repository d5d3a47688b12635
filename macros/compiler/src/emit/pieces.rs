//! Texts that a body is made of: values, statements, outputs.

use crate::catalogue::Record;
use std::fmt::Write;

/// A binding, or statements without one.
pub struct Statement {
    /// Values that the left side binds.
    pub names: Vec<usize>,
    /// Left side; empty if nothing is bound.
    pub pattern: String,
    /// Right side.
    pub text: String,
    /// Values that the right side names.
    pub needs: Vec<usize>,
}

/// How closely the parts of a text hold together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// A sum or a difference.
    #[default]
    Sum,
    /// A product, a quotient or a negative.
    Product,
    /// What needs no parentheses.
    Whole,
}

/// Text of a value that is not bound.
#[derive(Clone, Default)]
pub struct Piece {
    /// The expression.
    pub text: String,
    /// Values that it names.
    pub needs: Vec<usize>,
    /// Whether it needs parentheses.
    pub level: Level,
}

/// The outputs of a program as texts.
pub struct Outputs<'a> {
    /// The expressions.
    pub pieces: &'a [Piece],
    /// Whether an output is a constant zero.
    pub is_zero: &'a dyn Fn(usize) -> bool,
}

impl Outputs<'_> {
    /// An array of some of them.
    pub fn list(&self, range: std::ops::Range<usize>) -> String {
        array(self.pieces.get(range).unwrap_or(&[]).iter().map(|p| p.text.as_str()).collect())
    }

    /// An array of columns, from the first so many outputs on.
    fn columns(&self, first: usize, rows: usize, columns: usize) -> String {
        let columns: Vec<String> =
            (0..columns).map(|k| self.list(first + k * rows..first + (k + 1) * rows)).collect();
        array(columns.iter().map(String::as_str).collect())
    }

    /// The matrix of so many rows and columns, from its columns after the first so many outputs.
    pub fn matrix(&self, first: usize, rows: usize, columns: usize) -> String {
        storage(&self.columns(first, rows, columns), "SMatrix")
    }

    /// A struct whose fields are the outputs in their order.
    pub fn record(&self, record: Record) -> String {
        let mut text = format!("::linkwork::__private::{} {{\n", record.name().0);
        let mut first = 0;
        for field in record.fields() {
            let value = match field.columns {
                None => self.list(first..first + field.rows),
                Some(n) => self.columns(first, field.rows, n),
            };
            let _ = writeln!(text, "{}: {value},", field.name);
            first += field.length();
        }
        text.push_str("}\n");
        text
    }

    /// True for a constant zero.
    pub fn is_zero(&self, k: usize) -> bool {
        (self.is_zero)(k)
    }
}

/// An array; what is the same everywhere is written once.
fn array(texts: Vec<&str>) -> String {
    match texts.as_slice() {
        [first, rest @ ..] if rest.len() > 1 && rest.iter().all(|text| text == first) => {
            format!("[{first}; {}]", texts.len())
        }
        _ => format!("[{}]", texts.join(", ")),
    }
}

pub fn storage(columns: &str, matrix: &str) -> String {
    format!(
        "::linkwork::nalgebra::{matrix}::from_array_storage(::linkwork::nalgebra::ArrayStorage({columns}))"
    )
}
