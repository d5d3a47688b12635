//! Formatting of expressions and polynomials, as plain text or typeset.

use crate::algebra::common::FactorScope;
use crate::algebra::factor::items_of_polynomial;
use crate::algebra::item::{PrintOrder, PrintedTerm};
use crate::algebra::polynomial::{Atom, Monomial, Polynomial, Ring, Wave};
use crate::expr::node::Symbol;

pub mod aligned;
pub mod latex;
pub mod mathml;
pub mod names;
pub mod style;

pub use latex::Latex;
pub use mathml::MathMl;
pub use names::SymbolName;
pub use style::{Plain, PrintedEquations, Style};

use style::{PrintedArgument, PrintedFactor, PrintedNumber};

/// Formatter of polynomials as in textbooks: `1/3 m l² cos(theta)`. The writer decides the order of terms and
/// factors; the style decides their appearance.
pub struct PolynomialWriter<'a, S = Plain<'a>> {
    ring: &'a Ring,
    order: PrintOrder,
    style: S,
}

impl<'a> PolynomialWriter<'a> {
    /// Creates a writer of plain text for the polynomials of a ring, with names for its symbols.
    pub fn new(ring: &'a Ring, name: &'a dyn Fn(Symbol) -> String) -> PolynomialWriter<'a> {
        PolynomialWriter::new_with_style(ring, Plain { name })
    }
}

impl<'a, S: Style> PolynomialWriter<'a, S> {
    /// Creates a writer for the polynomials of a ring in the given style.
    pub fn new_with_style(ring: &'a Ring, style: S) -> PolynomialWriter<'a, S> {
        PolynomialWriter { ring, order: PrintOrder::new(ring), style }
    }

    /// Formats a polynomial with grouped terms and extracted common factors.
    pub fn format_polynomial(&self, p: &Polynomial) -> String {
        self.format_sum(&items_of_polynomial(self.ring, &self.order, p, FactorScope::All))
    }

    /// Formats an energy. Terms of different degree in rates are not factored together.
    pub fn format_energy(&self, p: &Polynomial) -> String {
        self.format_sum(&items_of_polynomial(self.ring, &self.order, p, FactorScope::Kinds))
    }

    /// Formats a linear form. Its coefficients are not factored together.
    pub fn format_linear_form(&self, p: &Polynomial) -> String {
        self.format_sum(&items_of_polynomial(self.ring, &self.order, p, FactorScope::None))
    }

    fn format_sum(&self, items: &[PrintedTerm]) -> String {
        self.join_signed_terms(
            items.iter().map(|item| (item.coefficient < 0.0, self.format_term_of_sum(item))),
        )
    }

    /// Joins terms, given as sign (true if negative) and text, to a sum.
    fn join_signed_terms(&self, parts: impl Iterator<Item = (bool, String)>) -> String {
        let mut out = String::new();
        for (negative, text) in parts {
            out.push_str(self.style.sign_before_term(out.is_empty(), negative));
            out.push_str(&text);
        }
        if out.is_empty() { self.style.format_number(&PrintedNumber::ZERO) } else { out }
    }

    fn format_term_of_sum(&self, item: &PrintedTerm) -> String {
        let sums =
            item.sums.iter().map(|sum| self.sum_power_as_factor(self.format_sum(&sum.items), sum.power));
        let constant = item.sums.iter().all(|sum| self.order.contains_only_parameters(&sum.items));
        self.format_product(item.coefficient, item.factor, sums.collect(), constant)
    }

    /// Returns a sum, raised to a power, as a factor of a product.
    fn sum_power_as_factor(&self, sum: String, power: u8) -> PrintedFactor {
        if power == 1 {
            PrintedFactor::Sum(sum)
        } else {
            PrintedFactor::Single(self.style.format_power_of_sum(&sum, power))
        }
    }

    /// Formats a product without its sign. The order is: number, parameters, positions (before sums that are
    /// not constant), sums, all other factors, divisors.
    fn format_product(
        &self,
        coefficient: f64,
        m: Monomial,
        sums: Vec<PrintedFactor>,
        constant: bool,
    ) -> String {
        let positions = if constant { Monomial::ONE } else { m.restrict_to_mask(self.order.positions) };
        let front = self.order.parameters_of_monomial(m).union_of_bits(positions);
        let (mut factors, mut divisors) = (Vec::new(), Vec::new());
        self.format_factors(front, &mut factors, &mut divisors);
        factors.extend(sums);
        self.format_factors(m.clear_mask(front), &mut factors, &mut divisors);
        let number = PrintedNumber::classify_number(coefficient.abs());
        let number = (number != PrintedNumber::ONE || factors.is_empty()).then_some(number);
        self.style.format_quotient_of_products(number, &factors, &divisors)
    }

    fn format_factors(
        &self,
        m: Monomial,
        factors: &mut Vec<PrintedFactor>,
        divisors: &mut Vec<PrintedFactor>,
    ) {
        for (atom, power) in self.order.factors_in_printing_order(m) {
            match &self.ring.atoms[atom] {
                Atom::Inverse(p) => divisors.push(self.format_divisor(p, power)),
                atom => factors.push(PrintedFactor::Single(self.format_atom(atom, power))),
            }
        }
    }

    fn format_divisor(&self, p: &Polynomial, power: u8) -> PrintedFactor {
        if let [t] = p.terms.as_slice()
            && let Some((atom, 1)) = t.monomial.atoms_with_powers().next()
        {
            return PrintedFactor::Single(self.format_atom(&self.ring.atoms[atom], power));
        }
        self.sum_power_as_factor(self.format_polynomial(p), power)
    }

    fn format_atom(&self, atom: &Atom, power: u8) -> String {
        let format_call =
            |name, arguments: &[PrintedArgument]| self.style.format_function_call(name, power, arguments);
        match atom {
            Atom::Symbol(s) => self.style.format_symbol_power(*s, power),
            Atom::Wave(w) => format_call(if w.cosine { "cos" } else { "sin" }, &[self.format_angle(w)]),
            Atom::Call(f, p) => format_call(f.function_name(), &[self.format_argument(p)]),
            Atom::Atan2(y, x) => format_call("atan2", &[self.format_argument(y), self.format_argument(x)]),
            Atom::Power(a, b) => format_call("pow", &[self.format_argument(a), self.format_argument(b)]),
            Atom::Extreme(f, a, b) => {
                format_call(f.function_name(), &[self.format_argument(a), self.format_argument(b)])
            }
            Atom::Table(name, _, x) => {
                format_call(name, &x.iter().map(|x| self.format_argument(x)).collect::<Vec<_>>())
            }
            Atom::Inverse(p) => {
                let divisor = PrintedFactor::Sum(self.format_polynomial(p));
                self.style.format_power_of_sum(
                    &self.style.format_quotient_of_products(Some(PrintedNumber::ONE), &[], &[divisor]),
                    power,
                )
            }
        }
    }

    fn format_argument(&self, p: &Polynomial) -> PrintedArgument {
        let lone = matches!(p.terms.as_slice(), [t] if self.is_single_symbol(t.coefficient, t.monomial));
        PrintedArgument { text: self.format_polynomial(p), lone }
    }

    /// Formats the argument of a wave, with its angles in the order of the ring.
    fn format_angle(&self, wave: &Wave) -> PrintedArgument {
        let angles = self.ring.angles.iter().zip(wave.angle).filter(|(_, n)| *n != 0);
        let parts: Vec<(f64, Monomial)> =
            angles.map(|(angle, n)| (angle.coefficient * f64::from(n), angle.monomial)).collect();
        let text = self.join_signed_terms(
            parts.iter().map(|(c, m)| (*c < 0.0, self.format_product(*c, *m, Vec::new(), true))),
        );
        PrintedArgument { text, lone: matches!(parts.as_slice(), [(c, m)] if self.is_single_symbol(*c, *m)) }
    }

    fn is_single_symbol(&self, coefficient: f64, m: Monomial) -> bool {
        let mut factors = m.atoms_with_powers();
        let first = factors.next();
        coefficient == 1.0
            && factors.next().is_none()
            && first.is_some_and(|(k, n)| n == 1 && matches!(self.ring.atoms[k], Atom::Symbol(_)))
    }
}

/// Breaks text into lines of at most `width` characters, before the signs of a sum and at the outermost
/// parentheses first. Further lines are indented.
pub fn wrap_text(text: &str, width: usize, indent: &str) -> String {
    let (mut out, mut rest, mut first) = (String::new(), text, true);
    loop {
        let room = if first { width } else { width.saturating_sub(indent.len()) };
        let cut = if rest.chars().count() > room { line_break_position(rest, room) } else { None };
        if !first {
            out.push('\n');
            out.push_str(indent);
        }
        let Some(cut) = cut else {
            out.push_str(rest);
            return out;
        };
        out.push_str(rest[..cut].trim_end());
        (rest, first) = (&rest[cut..], false);
    }
}

/// Maximum number of characters of an equation's side that shares a line with the other side.
const SHORT: usize = 24;

/// Returns the position of the line break: the last sign of minimum nesting depth within `room` characters,
/// or the next sign after them.
fn line_break_position(text: &str, room: usize) -> Option<usize> {
    let (mut depth, mut best) = (0_usize, None::<(usize, usize)>);
    let mut previous = ' ';
    for (column, (at, c)) in text.char_indices().enumerate() {
        let sign = match c {
            '+' | '-' => true,
            // A short side gets no line of its own.
            '=' => at > SHORT && text.len() - at > SHORT,
            _ => false,
        };
        let sign = sign && at > 0 && previous == ' ' && text[at + 1..].starts_with(' ');
        if sign && (column <= room || best.is_none()) && best.is_none_or(|(d, _)| depth <= d) {
            best = Some((depth, at));
        }
        if column > room && best.is_some() {
            break;
        }
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        previous = c;
    }
    best.map(|(_, at)| at)
}

#[cfg(test)]
mod tests;
