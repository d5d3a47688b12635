//! Continuous piecewise laws: `if x < border { below } else { above }`.
//!
//! With the pieces `f` and `g`, the value is `f(min(x, b)) + g(max(x, b)) − f(b)`. Each piece is evaluated
//! only on its own side and need not be defined beyond; slopes are those of the pieces. A discontinuity at
//! the border is an error: integration methods, derivatives and energies assume continuous forces.

use super::scope::Scope;
use crate::diag::Diagnostics;
use crate::expr::eval::eval_one;
use crate::expr::replace::{substitute_subexpression, substitute_symbols};
use crate::expr::sample::sample_of_symbol;
use crate::expr::{Expr, Extreme, Symbol};
use crate::kinematics::symbols_in;
use crate::language::Callable;
use crate::mechanism::Quantity;
use crate::syntax::{self, ExprKind};

/// Maximum difference of two pieces at their border, relative to their magnitude.
const ROUNDING: f64 = 1e-9;
/// Magnitudes of the random samples at which continuity of piecewise laws is tested.
const SIZES: [f64; 12] = [1.0, 1.0, 1.0, 1.0, 1e-2, 1e2, 1e-1, 1e1, 1e-4, 1e4, 1e-3, 1e3];

/// A law in two pieces, as expressions of a symbol that replaces the compared expression.
struct PiecewiseLaw<'g> {
    symbol: Symbol,
    compared: Expr<'g>,
    border: Expr<'g>,
    pieces: [Expr<'g>; 2],
}

impl<'g> PiecewiseLaw<'g> {
    fn substitute_in_piece(&self, piece: usize, x: Expr<'g>) -> Expr<'g> {
        substitute_symbols(self.pieces[piece], &|s| (s == self.symbol).then_some(x))
    }

    fn piecewise_value(&self) -> Expr<'g> {
        let [below, above] =
            [Extreme::Min, Extreme::Max].map(|side| self.compared.minimum_or_maximum(side, self.border));
        let (first, second) =
            (self.substitute_in_piece(0, self.border), self.substitute_in_piece(1, self.border));
        // Both equal the common value of the pieces.
        let common = if second.constant_value().is_some() { second } else { first };
        self.substitute_in_piece(0, below) + self.substitute_in_piece(1, above) - common
    }

    /// Returns the values of both pieces at the border if they differ for any sample, and `None` otherwise. A
    /// sample is used only if the `nested_borders` are ordered like this border. Returns `Err` if no sample
    /// can be used.
    fn unequal_values_at_border(&self, nested_borders: &[(bool, Expr<'g>)]) -> Result<Option<[f64; 2]>, ()> {
        let at_border = [0, 1].map(|piece| self.substitute_in_piece(piece, self.border));
        let mut tried = false;
        for (seed, size) in (0_u64..).zip(SIZES) {
            let value_at_sample_point = |e: Expr<'g>| eval_one(e, &|s| size * sample_of_symbol(s, seed));
            let border = value_at_sample_point(self.border);
            let in_order =
                |(is_above, other): &(bool, Expr<'g>)| (value_at_sample_point(*other) >= border) == *is_above;
            let found = at_border.map(value_at_sample_point);
            if !nested_borders.iter().all(in_order)
                || !border.is_finite()
                || found.iter().any(|x| !x.is_finite())
            {
                continue;
            }
            tried = true;
            let sizes = [
                found[0],
                found[1],
                value_at_sample_point(self.pieces[0]),
                value_at_sample_point(self.pieces[1]),
            ]
            .map(f64::abs);
            let largest = sizes.into_iter().filter(|x| x.is_finite()).fold(0.0, f64::max);
            if (found[0] - found[1]).abs() > ROUNDING * largest {
                return Ok(Some(found));
            }
        }
        if tried { Ok(None) } else { Err(()) }
    }
}

impl<'g> Scope<'_, 'g> {
    /// Returns the symbol of an expression that is compared in one of the surrounding piecewise laws.
    pub fn symbol_of_compared_expression(&self, e: &syntax::Expr) -> Option<Expr<'g>> {
        let context = self.context.borrow();
        context.compared.iter().rev().find(|(written, _)| written.has_same_text(e)).map(|(_, symbol)| *symbol)
    }

    /// Resolves a piecewise law. The arguments are the compared expression, the border, the piece below and
    /// the piece above.
    pub fn resolve_piecewise_law(
        &self,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Expr<'g>> {
        let [left, right, below, above] = arguments else { return None };
        let compared = (self.resolve_scalar(left, cx), self.resolve_scalar(right, cx));
        let (x, border) = (compared.0?, compared.1?);
        let depends_on_variables = |e: Expr<'g>| {
            symbols_in(&[e]).into_iter().any(|s| !matches!(Quantity::from_symbol(s), Quantity::Parameter(_)))
        };
        // The border is the constant operand.
        let is_swapped =
            !depends_on_variables(x) && (depends_on_variables(border) || x.constant_value().is_some());
        let (written, compared, border, pieces) = match is_swapped {
            true => (right, border, x, [above, below]),
            false => (left, x, border, [below, above]),
        };
        if compared.constant_value().is_some() {
            cx.report_error(
                left.place.extend_to_end_of(&right.place),
                "this comparison of two numbers is constant",
            )
            .add_help("keep only the piece that applies");
            return None;
        }
        let depth = self.context.borrow().compared.len();
        let symbol = Quantity::Deciding(depth).symbol();
        self.context.borrow_mut().compared.push((written.clone(), self.graph.symbol(symbol)));
        let read = pieces.map(|piece| self.resolve_scalar(piece, cx));
        self.context.borrow_mut().compared.pop();
        // Definitions contain the compared expression in resolved form.
        let replace_compared_by_symbol =
            |e: Expr<'g>| substitute_subexpression(e, compared, self.graph.symbol(symbol));
        let pieces_read = [replace_compared_by_symbol(read[0]?), replace_compared_by_symbol(read[1]?)];
        if replace_compared_by_symbol(border).id() != border.id() {
            cx.report_error(
                left.place.extend_to_end_of(&right.place),
                "the boundary between the pieces depends on the compared quantity",
            )
            .add_help("solve the comparison: the compared quantity on one side, the boundary on the other");
            return None;
        }
        let law = PiecewiseLaw { symbol, compared, border, pieces: pieces_read };
        let nested_borders = self.borders_of_nested_laws(written, pieces, cx);
        self.check_continuous(&law, &nested_borders, left, right, cx).then(|| law.piecewise_value())
    }

    /// Returns the borders of nested piecewise laws with the same compared expression. The flag is false for
    /// the borders in the lower piece.
    fn borders_of_nested_laws(
        &self,
        written: &syntax::Expr,
        pieces: [&syntax::Expr; 2],
        cx: &mut Diagnostics,
    ) -> Vec<(bool, Expr<'g>)> {
        let mut all = Vec::new();
        for (is_above, piece) in [false, true].into_iter().zip(pieces) {
            for part in piece.all_subexpressions() {
                if let ExprKind::Call(name, arguments) = &part.kind
                    && let [a, b, ..] = arguments.as_slice()
                    && name.id == Some(Callable::If)
                {
                    let border = if a.has_same_text(written) { b } else { a };
                    if a.has_same_text(written) != b.has_same_text(written) {
                        all.extend(self.resolve_scalar(border, cx).map(|border| (is_above, border)));
                    }
                }
            }
        }
        all
    }

    fn check_continuous(
        &self,
        law: &PiecewiseLaw<'g>,
        nested_borders: &[(bool, Expr<'g>)],
        left: &syntax::Expr,
        right: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> bool {
        let place = left.place.extend_to_end_of(&right.place);
        let (a, b) = (left.short_source_text(), right.short_source_text());
        match law.unequal_values_at_border(nested_borders) {
            Ok(None) => true,
            Ok(Some([first, second])) => {
                let is_constant_at_border =
                    |piece: usize| law.substitute_in_piece(piece, law.border).constant_value().is_some();
                let values = match is_constant_at_border(0) && is_constant_at_border(1) {
                    true => format!(": they are {first} and {second} there"),
                    false => String::new(),
                };
                cx.report_error(place, format!("the pieces differ where `{a}` is `{b}`{values}")).add_help(
                    "integration requires continuous laws: give both pieces the same value there, or blend \
                     them over a short range, as `tanh` does",
                );
                false
            }
            Err(()) => {
                cx.report_error(
                    place,
                    format!("cannot determine whether the pieces agree where `{a}` is `{b}`"),
                )
                .add_help("both pieces must be defined there, and the boundaries must increase");
                false
            }
        }
    }
}
