//! Expressions and polynomials as text.

use super::factor::{Item, Order, fraction, items};
use super::graph::{Expr, Node, Symbol};
use super::polynomial::{Atom, Monomial, Polynomial, Ring, Wave};

/// An expression in one line, with names for its symbols. For small expressions: what is shared is written out, up to
/// a limit of depth.
pub fn plain(e: Expr<'_>, name: &dyn Fn(Symbol) -> String) -> String {
    term(e, name, 0, 24)
}

/// Text of a node; parentheses where its operator binds less than `level` (1 for sums, 2 for products, 3 for powers).
fn term(e: Expr<'_>, name: &dyn Fn(Symbol) -> String, level: u8, depth: u8) -> String {
    if depth == 0 {
        return "…".to_string();
    }
    let at = |id, level| term(e.graph().expr(id), name, level, depth - 1);
    let (text, own) = match e.node() {
        Node::Const(c) => (format!("{c}"), if c < 0.0 { 1 } else { 4 }),
        Node::Symbol(s) => (name(s), 4),
        Node::Neg(a) => (format!("-{}", at(a, 2)), 1),
        Node::Add(a, b) => (format!("{} + {}", at(a, 1), at(b, 1)), 1),
        Node::Sub(a, b) => (format!("{} - {}", at(a, 1), at(b, 2)), 1),
        Node::Mul(a, b) => (format!("{} * {}", at(a, 2), at(b, 2)), 2),
        Node::Div(a, b) => (format!("{} / {}", at(a, 2), at(b, 3)), 2),
        Node::Call(f, a) => (format!("{}({})", f.name(), at(a, 0)), 4),
        Node::Atan2(a, b) => (format!("atan2({}, {})", at(a, 0), at(b, 0)), 4),
        Node::Pow(a, b) => (format!("pow({}, {})", at(a, 0), at(b, 0)), 4),
    };
    if own < level { format!("({text})") } else { text }
}

/// Writes polynomials the way a person does: `1/3 m l² cos(theta)`.
pub struct Writer<'a> {
    ring: &'a Ring,
    order: Order,
    name: &'a dyn Fn(Symbol) -> String,
}

impl<'a> Writer<'a> {
    /// For the polynomials of a ring, with names for its symbols.
    pub fn new(ring: &'a Ring, name: &'a dyn Fn(Symbol) -> String) -> Writer<'a> {
        Writer { ring, order: Order::of(ring), name }
    }

    /// A polynomial, grouped.
    pub fn polynomial(&self, p: &Polynomial) -> String {
        self.sum(&items(self.ring, &self.order, p))
    }

    fn sum(&self, items: &[Item]) -> String {
        joined(items.iter().map(|item| (item.coefficient < 0.0, self.item(item))))
    }

    fn item(&self, item: &Item) -> String {
        let power = if item.power == 2 { "²" } else { "" };
        let sum = (!item.sum.is_empty()).then(|| format!("({}){power}", self.sum(&item.sum)));
        self.product(item.coefficient, item.factor, sum)
    }

    /// Number, parameters, sum, all else; then what it is divided by. Without the sign.
    fn product(&self, coefficient: f64, m: Monomial, sum: Option<String>) -> String {
        let parameters = self.order.parameters(m);
        let (mut factors, mut divisors) = (Vec::new(), Vec::new());
        self.factors(parameters, &mut factors, &mut divisors);
        factors.extend(sum);
        self.factors(m.without(parameters), &mut factors, &mut divisors);
        let number = number(coefficient.abs(), !factors.is_empty());
        if number != "1" || factors.is_empty() {
            factors.insert(0, number);
        }
        match divisors.as_slice() {
            [] => factors.join(" "),
            [one] if !one.contains(' ') || one.ends_with(')') => format!("{}/{one}", factors.join(" ")),
            _ => format!("{}/({})", factors.join(" "), divisors.join(" ")),
        }
    }

    fn factors(&self, m: Monomial, factors: &mut Vec<String>, divisors: &mut Vec<String>) {
        for (atom, power) in self.order.factors(m) {
            match &self.ring.atoms[atom] {
                Atom::Inverse(p) => divisors.push(self.divisor(p, power)),
                atom => factors.push(self.atom(atom, power)),
            }
        }
    }

    fn divisor(&self, p: &Polynomial, power: u8) -> String {
        match p.terms.as_slice() {
            [t] => match t.monomial.factors().next() {
                Some((atom, 1)) => self.atom(&self.ring.atoms[atom], power),
                _ => format!("({}){}", self.polynomial(p), exponent(power)),
            },
            _ => format!("({}){}", self.polynomial(p), exponent(power)),
        }
    }

    fn atom(&self, atom: &Atom, power: u8) -> String {
        let power = exponent(power);
        match atom {
            Atom::Symbol(s) => format!("{}{power}", (self.name)(*s)),
            Atom::Wave(w) => {
                format!("{}{power}({})", if w.cosine { "cos" } else { "sin" }, self.angle(w))
            }
            Atom::Call(f, p) => format!("{}{power}({})", f.name(), self.polynomial(p)),
            Atom::Atan2(y, x) => format!("atan2{power}({}, {})", self.polynomial(y), self.polynomial(x)),
            Atom::Power(a, b) => format!("pow{power}({}, {})", self.polynomial(a), self.polynomial(b)),
            Atom::Inverse(p) => format!("(1/({})){power}", self.polynomial(p)),
        }
    }

    /// The argument of a wave, in the order of its angles.
    fn angle(&self, wave: &Wave) -> String {
        let parts = self.ring.angles.iter().zip(wave.angle).filter(|(_, n)| *n != 0);
        joined(parts.map(|(angle, n)| {
            let coefficient = angle.coefficient * f64::from(n);
            (coefficient < 0.0, self.product(coefficient, angle.monomial, None))
        }))
    }
}

/// A sum of texts with their signs.
fn joined(parts: impl Iterator<Item = (bool, String)>) -> String {
    let mut out = String::new();
    for (negative, text) in parts {
        out.push_str(match (out.is_empty(), negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        });
        out.push_str(&text);
    }
    if out.is_empty() { "0".to_string() } else { out }
}

fn exponent(power: u8) -> &'static str {
    match power {
        2 => "²",
        3 => "³",
        4 => "⁴",
        5 => "⁵",
        6 => "⁶",
        7 => "⁷",
        _ => "",
    }
}

/// A positive number for reading: a fraction where it is one of small numbers and stands before something, else up to
/// six significant digits.
pub fn number(value: f64, before: bool) -> String {
    if let Some((p, q)) = fraction(value).filter(|(_, q)| *q == 1 || before || q % 3 == 0) {
        return if q == 1 { format!("{p}") } else { format!("{p}/{q}") };
    }
    let exponent = value.log10().floor() as i32;
    if !(-4..9).contains(&exponent) {
        let text = format!("{value:.5e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", trimmed(digits));
    }
    let decimals = usize::try_from(5 - exponent).unwrap_or(0);
    trimmed(&format!("{value:.decimals$}")).to_string()
}

fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// Text in lines of up to `width` characters, broken before the signs of a sum, outermost ones first; further lines
/// are indented.
pub fn wrapped(text: &str, width: usize, indent: &str) -> String {
    let (mut out, mut rest, mut first) = (String::new(), text, true);
    loop {
        let room = if first { width } else { width.saturating_sub(indent.len()) };
        let cut = if rest.chars().count() > room { break_at(rest, room) } else { None };
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

/// A side of an equation that is not put on a line of its own.
const SHORT: usize = 24;

/// Where to break: the last sign of the least depth within `room` characters; the next one after it if there is none.
fn break_at(text: &str, room: usize) -> Option<usize> {
    let (mut depth, mut best) = (0_usize, None::<(usize, usize)>);
    let mut previous = ' ';
    for (column, (at, c)) in text.char_indices().enumerate() {
        let sign = match c {
            '+' | '-' => true,
            // A short side is not worth a line.
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
