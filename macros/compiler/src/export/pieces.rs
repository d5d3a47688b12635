//! C expressions and statements of a function body, as text.

/// C expression with the instructions on which it depends.
#[derive(Clone, Default)]
pub struct CExpression {
    /// Text of the expression in C.
    pub text: String,
    /// Indices of the instructions whose values the expression refers to.
    pub needs: Vec<usize>,
    /// Precedence: 1 for a sum, 2 for a product, 3 for an expression that never needs parentheses.
    pub level: u8,
}

impl CExpression {
    /// Creates an expression that refers to no values and needs no parentheses.
    pub fn from_atomic_text(text: String) -> CExpression {
        CExpression { text, needs: Vec::new(), level: 3 }
    }

    /// Returns the text, in parentheses if the precedence is below `level`.
    pub fn text_at_precedence(&self, level: u8) -> String {
        if self.level < level { format!("({})", self.text) } else { self.text.clone() }
    }
}

/// C statement that defines the values of instructions.
pub struct Statement {
    /// Indices of the instructions whose values the statement defines.
    pub names: Vec<usize>,
    /// Text of the statement, one or several lines.
    pub text: String,
}
