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

/// Text of a value that is not bound.
#[derive(Clone, Default)]
pub struct Piece {
    /// The expression.
    pub text: String,
    /// Values that it names.
    pub needs: Vec<usize>,
    /// 1 for a sum, 2 for a product, 3 for what needs no parentheses.
    pub level: u8,
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
        let texts: Vec<&str> =
            self.pieces.get(range).unwrap_or(&[]).iter().map(|p| p.text.as_str()).collect();
        format!("[{}]", texts.join(", "))
    }

    /// The matrix of so many rows and columns, from its columns after the first so many outputs.
    pub fn matrix(&self, first: usize, rows: usize, columns: usize) -> String {
        let column = |k: usize| self.list(first + k * rows..first + (k + 1) * rows);
        let columns: Vec<String> = (0..columns).map(column).collect();
        storage(&format!("[{}]", columns.join(", ")), "SMatrix")
    }

    /// A struct whose fields are the outputs in their order.
    pub fn record(&self, record: Record) -> String {
        let mut text = format!("::linkwork::__private::{} {{\n", record.name().0);
        let mut first = 0;
        for field in record.fields() {
            let columns = |k: usize| self.list(first + k * field.rows..first + (k + 1) * field.rows);
            let value = match field.columns {
                None => columns(0),
                Some(n) => format!("[{}]", (0..n).map(columns).collect::<Vec<_>>().join(", ")),
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

pub fn storage(columns: &str, matrix: &str) -> String {
    format!(
        "::linkwork::nalgebra::{matrix}::from_array_storage(::linkwork::nalgebra::ArrayStorage({columns}))"
    )
}
