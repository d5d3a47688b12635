//! Source text of the parts of a body: values, statements, outputs.

use crate::catalogue::Record;
use std::fmt::Write;

/// Generated statement: a `let` binding, or statements that bind nothing.
pub struct Statement {
    /// Numbers of the values that the left side binds.
    pub names: Vec<usize>,
    /// Pattern on the left side of the `let`; empty if nothing is bound.
    pub pattern: String,
    /// Right side of the `let`, as source text.
    pub text: String,
    /// Numbers of the values that occur in the right side.
    pub needs: Vec<usize>,
}

/// Precedence of the outermost operation of an expression.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum PrecedenceLevel {
    /// Expression whose outermost operation is a sum or difference.
    #[default]
    Sum,
    /// Expression whose outermost operation is a product, quotient or negation.
    Product,
    /// Expression that needs no parentheses.
    Whole,
}

/// Source text of a value that has no variable of its own.
#[derive(Clone, Default)]
pub struct ExpressionPiece {
    /// Source text of the expression.
    pub text: String,
    /// Numbers of the values whose names occur in the expression.
    pub needs: Vec<usize>,
    /// Precedence, which determines whether parentheses are needed.
    pub level: PrecedenceLevel,
}

/// Outputs of a program as Rust source text.
pub struct OutputTexts<'a> {
    /// Expressions of the outputs.
    pub pieces: &'a [ExpressionPiece],
    /// Closure that returns whether an output is a constant zero.
    pub is_zero: &'a dyn Fn(usize) -> bool,
}

impl OutputTexts<'_> {
    /// Returns a Rust array of a range of outputs.
    pub fn array_of_outputs(&self, range: std::ops::Range<usize>) -> String {
        array_expression(self.pieces.get(range).unwrap_or(&[]).iter().map(|p| p.text.as_str()).collect())
    }

    /// Returns a Rust array of columns of outputs, starting at output `first`.
    fn array_of_columns(&self, first: usize, rows: usize, columns: usize) -> String {
        let columns: Vec<String> =
            (0..columns).map(|k| self.array_of_outputs(first + k * rows..first + (k + 1) * rows)).collect();
        array_expression(columns.iter().map(String::as_str).collect())
    }

    /// Returns the matrix with these numbers of rows and columns, by columns, starting at output `first`.
    pub fn output_matrix_constructor_text(&self, first: usize, rows: usize, columns: usize) -> String {
        storage_constructor(&self.array_of_columns(first, rows, columns), "SMatrix")
    }

    /// Returns a struct whose fields are the outputs in order.
    pub fn record_of_outputs(&self, record: Record) -> String {
        let mut text = format!("::linkwork::__private::{} {{\n", record.struct_name_and_sizes().0);
        let mut first = 0;
        for field in record.record_fields() {
            let value = match field.columns {
                None => self.array_of_outputs(first..first + field.rows),
                Some(n) => self.array_of_columns(first, field.rows, n),
            };
            let _ = writeln!(text, "{}: {value},", field.name);
            first += field.field_length();
        }
        text.push_str("}\n");
        text
    }

    /// Returns true for an output that is a constant zero.
    pub fn is_zero(&self, k: usize) -> bool {
        (self.is_zero)(k)
    }
}

/// Returns an array expression; if all items are equal, in the form with one item and a count.
pub fn array_expression(texts: Vec<&str>) -> String {
    match texts.as_slice() {
        [first, rest @ ..] if rest.len() > 1 && rest.iter().all(|text| text == first) => {
            format!("[{first}; {}]", texts.len())
        }
        _ => format!("[{}]", texts.join(", ")),
    }
}

/// Returns the constructor of a vector or matrix from an array of columns.
pub fn storage_constructor(columns: &str, matrix: &str) -> String {
    format!(
        "::linkwork::nalgebra::{matrix}::from_array_storage(::linkwork::nalgebra::ArrayStorage({columns}))"
    )
}
