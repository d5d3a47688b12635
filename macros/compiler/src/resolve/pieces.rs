//! Laws in pieces that meet: `if x < border { below } else { above }`.
//!
//! With `f` the one and `g` the other piece, the value is `f(min(x, b)) + g(max(x, b)) − f(b)`: each piece is
//! evaluated on its own side alone, so that it need not be defined beyond, and slopes are those of the
//! pieces. Pieces that do not meet at the border are a mistake: methods of integration, derivatives and
//! energies take forces to be continuous.

use super::scope::Scope;
use crate::diag::Diagnostics;
use crate::expr::eval::eval_one;
use crate::expr::replace::{replace, replace_part};
use crate::expr::sample::sample;
use crate::expr::{Expr, Extreme, Symbol};
use crate::kinematics::symbols_in;
use crate::language::Callable;
use crate::mechanism::Quantity;
use crate::syntax::{self, ExprKind};

/// How far pieces may be apart where they meet, beside their size.
const ROUNDING: f64 = 1e-9;
/// Sizes of the numbers with which it is tried whether pieces meet.
const SIZES: [f64; 12] = [1.0, 1.0, 1.0, 1.0, 1e-2, 1e2, 1e-1, 1e1, 1e-4, 1e4, 1e-3, 1e3];

/// A law in two pieces, by a symbol for what decides.
struct Pieces<'g> {
    symbol: Symbol,
    decides: Expr<'g>,
    border: Expr<'g>,
    pieces: [Expr<'g>; 2],
}

impl<'g> Pieces<'g> {
    fn with(&self, piece: usize, x: Expr<'g>) -> Expr<'g> {
        replace(self.pieces[piece], &|s| (s == self.symbol).then_some(x))
    }

    fn value(&self) -> Expr<'g> {
        let [below, above] = [Extreme::Min, Extreme::Max].map(|side| self.decides.extreme(side, self.border));
        let (first, second) = (self.with(0, self.border), self.with(1, self.border));
        // Both are what the pieces have in common.
        let common = if second.value().is_some() { second } else { first };
        self.with(0, below) + self.with(1, above) - common
    }

    /// The values of both pieces at the border for some numbers with which borders beside it are in order, if
    /// they differ for any; `Err` if there are no such numbers.
    fn gap(&self, beside: &[(bool, Expr<'g>)]) -> Result<Option<[f64; 2]>, ()> {
        let at_border = [0, 1].map(|piece| self.with(piece, self.border));
        let mut tried = false;
        for (seed, size) in (0_u64..).zip(SIZES) {
            let number = |e: Expr<'g>| eval_one(e, &|s| size * sample(s, seed));
            let border = number(self.border);
            let in_order = |(is_above, other): &(bool, Expr<'g>)| (number(*other) >= border) == *is_above;
            let found = at_border.map(number);
            if !beside.iter().all(in_order) || !border.is_finite() || found.iter().any(|x| !x.is_finite()) {
                continue;
            }
            tried = true;
            let sizes = [found[0], found[1], number(self.pieces[0]), number(self.pieces[1])].map(f64::abs);
            let largest = sizes.into_iter().filter(|x| x.is_finite()).fold(0.0, f64::max);
            if (found[0] - found[1]).abs() > ROUNDING * largest {
                return Ok(Some(found));
            }
        }
        if tried { Ok(None) } else { Err(()) }
    }
}

impl<'g> Scope<'_, 'g> {
    /// The symbol for an expression that decides between pieces which are being read.
    pub fn deciding(&self, e: &syntax::Expr) -> Option<Expr<'g>> {
        let context = self.context.borrow();
        context.deciding.iter().rev().find(|(written, _)| written.is_like(e)).map(|(_, symbol)| *symbol)
    }

    /// A law in pieces: what decides, the border, the piece below and that above.
    pub fn pieces(&self, arguments: &[syntax::Expr], cx: &mut Diagnostics) -> Option<Expr<'g>> {
        let [left, right, below, above] = arguments else { return None };
        let compared = (self.scalar(left, cx), self.scalar(right, cx));
        let (x, border) = (compared.0?, compared.1?);
        let moves = |e: Expr<'g>| {
            symbols_in(&[e]).into_iter().any(|s| !matches!(Quantity::of(s), Quantity::Parameter(_)))
        };
        // The border is what does not move.
        let turned = !moves(x) && (moves(border) || x.value().is_some());
        let (written, decides, border, pieces) = match turned {
            true => (right, border, x, [above, below]),
            false => (left, x, border, [below, above]),
        };
        if decides.value().is_some() {
            cx.error(left.place.join(&right.place), "this comparison of two numbers is always the same")
                .help("keep the piece that holds alone");
            return None;
        }
        let depth = self.context.borrow().deciding.len();
        let symbol = Quantity::Deciding(depth).symbol();
        self.context.borrow_mut().deciding.push((written.clone(), self.graph.symbol(symbol)));
        let read = pieces.map(|piece| self.scalar(piece, cx));
        self.context.borrow_mut().deciding.pop();
        // Definitions name what decides in their own words.
        let by_symbol = |e: Expr<'g>| replace_part(e, decides, self.graph.symbol(symbol));
        let pieces_read = [by_symbol(read[0]?), by_symbol(read[1]?)];
        if by_symbol(border).id() != border.id() {
            cx.error(left.place.join(&right.place), "the border between the pieces moves with what decides")
                .help("solve the comparison: what decides on one side, the border on the other");
            return None;
        }
        let law = Pieces { symbol, decides, border, pieces: pieces_read };
        let beside = self.borders(written, pieces, cx);
        self.check_continuous(&law, &beside, left, right, cx).then(|| law.value())
    }

    /// The borders of pieces within the pieces, by the same expression: false for those below.
    fn borders(
        &self,
        written: &syntax::Expr,
        pieces: [&syntax::Expr; 2],
        cx: &mut Diagnostics,
    ) -> Vec<(bool, Expr<'g>)> {
        let mut all = Vec::new();
        for (is_above, piece) in [false, true].into_iter().zip(pieces) {
            for part in piece.parts() {
                if let ExprKind::Call(name, arguments) = &part.kind
                    && let [a, b, ..] = arguments.as_slice()
                    && name.id == Some(Callable::If)
                {
                    let border = if a.is_like(written) { b } else { a };
                    if a.is_like(written) != b.is_like(written) {
                        all.extend(self.scalar(border, cx).map(|border| (is_above, border)));
                    }
                }
            }
        }
        all
    }

    fn check_continuous(
        &self,
        law: &Pieces<'g>,
        beside: &[(bool, Expr<'g>)],
        left: &syntax::Expr,
        right: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> bool {
        let place = left.place.join(&right.place);
        let (a, b) = (left.spelt(), right.spelt());
        match law.gap(beside) {
            Ok(None) => true,
            Ok(Some([first, second])) => {
                let plain = |piece: usize| law.with(piece, law.border).value().is_some();
                let values = match plain(0) && plain(1) {
                    true => format!(": they are {first} and {second} there"),
                    false => String::new(),
                };
                cx.error(place, format!("the pieces do not meet where `{a}` is `{b}`{values}")).help(
                    "laws are continuous, as methods of integration need it: give both pieces one value there, or go from one to the other within a short way, as `tanh` does",
                );
                false
            }
            Err(()) => {
                cx.error(place, format!("it cannot be told whether the pieces meet where `{a}` is `{b}`"))
                    .help("both pieces must be defined there, and borders further on must lie further on");
                false
            }
        }
    }
}
