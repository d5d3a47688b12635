//! Texts that a body is made of.

/// A value as text.
#[derive(Clone, Default)]
pub struct Piece {
    /// The expression.
    pub text: String,
    /// Values that it names.
    pub needs: Vec<usize>,
    /// 1 for a sum, 2 for a product, 3 for what needs no parentheses.
    pub level: u8,
}

impl Piece {
    /// What names no values and needs no parentheses.
    pub fn plain(text: String) -> Piece {
        Piece { text, needs: Vec::new(), level: 3 }
    }

    /// The text, in parentheses if it binds less than this.
    pub fn wrapped(&self, level: u8) -> String {
        if self.level < level { format!("({})", self.text) } else { self.text.clone() }
    }
}

/// Lines that bind values.
pub struct Statement {
    /// The values that they bind.
    pub names: Vec<usize>,
    /// The lines.
    pub text: String,
}
