//! Calls of functions of the language, with their unresolved arguments.

use crate::diag::{Diagnostics, Place};
use crate::language::FunctionId;
use crate::syntax::{self, BinaryOp, ExprKind};

/// A call of a function of the language.
#[derive(Clone, Copy)]
pub struct Call<'a> {
    /// Function of the language that is called.
    pub id: FunctionId,
    /// Source span of the function's name.
    pub place: &'a Place,
    /// Arguments of the call, as written by the user.
    pub arguments: &'a [syntax::Expr],
}

impl<'a> Call<'a> {
    /// Returns the name of the function.
    pub fn function_name(&self) -> &'static str {
        self.id.name()
    }

    /// Reports that the arguments of the function call are wrong.
    pub fn report_wrong_arguments<T>(&self, cx: &mut Diagnostics) -> Option<T> {
        let row = self.id.row();
        cx.report_error(self.place.clone(), format!("`{}` takes {}", row.name, row.takes))
            .add_help(row.usage);
        None
    }

    /// Returns the arguments, or reports a wrong number of them.
    pub fn take_arguments<const N: usize>(&self, cx: &mut Diagnostics) -> Option<&'a [syntax::Expr; N]> {
        self.arguments.try_into().ok().or_else(|| self.report_wrong_arguments(cx))
    }

    /// Returns the operands between the slashes of an argument, or reports a wrong number of them.
    pub fn take_operands<const N: usize>(
        &self,
        argument: &'a syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<[&'a syntax::Expr; N]> {
        flatten_slashes(argument).try_into().ok().or_else(|| self.report_wrong_arguments(cx))
    }

    /// Returns the operands between the slashes of the only argument, `y / x / A`; empty if there are several
    /// arguments.
    pub fn slash_operands(&self) -> Vec<&'a syntax::Expr> {
        if let [one] = self.arguments { flatten_slashes(one) } else { Vec::new() }
    }
}

/// Returns the operands of a slash expression `a / b / c`, as in `v(tip / base / ground)`.
pub fn flatten_slashes(e: &syntax::Expr) -> Vec<&syntax::Expr> {
    let mut parts = Vec::new();
    let mut current = e;
    while let ExprKind::Binary(BinaryOp::Div, left, right, _) = &current.kind {
        parts.push(&**right);
        current = left;
    }
    parts.push(current);
    parts.reverse();
    parts
}
