//! How the parts of a polynomial look; and plain text.

use crate::expr::factor::fraction;
use crate::expr::node::Symbol;
use std::fmt;

/// A text in all ways of writing; empty where there is nothing that could be read.
#[derive(Clone, Debug, Default)]
pub struct Written {
    /// Plain text.
    pub plain: String,
    /// LaTeX.
    pub latex: String,
}

/// A way of writing.
pub trait Style {
    /// A symbol to a power.
    fn symbol(&self, symbol: Symbol, power: u8) -> String;

    /// A number without sign.
    fn number(&self, number: &Number) -> String {
        number.to_string()
    }

    /// What stands before a term of a sum.
    fn sign(&self, first: bool, negative: bool) -> &'static str {
        match (first, negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        }
    }

    /// A sum in parentheses to a power.
    fn power(&self, sum: &str, power: u8) -> String;

    /// A function to a power, by its name in the language.
    fn call(&self, function: &str, power: u8, arguments: &[Argument]) -> String;

    /// Number and factors divided by other factors. There is something to write before the divisors.
    fn product(&self, number: Option<Number>, factors: &[Factor], divisors: &[Factor]) -> String;
}

/// A factor of a product.
pub enum Factor {
    /// Holds together as it is.
    Single(String),
    /// A sum, still without parentheses.
    Sum(String),
}

/// An argument of a function.
pub struct Argument {
    /// How it is written.
    pub text: String,
    /// A symbol alone.
    pub lone: bool,
}

/// A number for reading, without sign.
#[derive(Clone, Debug, PartialEq)]
pub enum Number {
    /// Numerator and denominator.
    Fraction(u32, u32),
    /// Digits, with a point or without.
    Decimal(String),
    /// Digits, and the exponent of ten.
    Scientific(String, String),
}

impl Number {
    /// Nothing.
    pub const ZERO: Number = Number::Fraction(0, 1);
    /// One.
    pub const ONE: Number = Number::Fraction(1, 1);

    /// A positive number: a fraction where it is one of small numbers and stands before something, else up to six
    /// significant digits.
    pub fn of(value: f64, before: bool) -> Number {
        if let Some((p, q)) = fraction(value).filter(|(_, q)| *q == 1 || before || q % 3 == 0) {
            return Number::Fraction(p, q);
        }
        let exponent = value.log10().floor() as i32;
        if !(-4..9).contains(&exponent) {
            let text = format!("{value:.5e}");
            let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
            return Number::Scientific(trimmed(digits).to_string(), power.to_string());
        }
        let decimals = usize::try_from(5 - exponent).unwrap_or(0);
        Number::Decimal(trimmed(&format!("{value:.decimals$}")).to_string())
    }
}

fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Number::Fraction(p, 1) => write!(f, "{p}"),
            Number::Fraction(p, q) => write!(f, "{p}/{q}"),
            Number::Decimal(digits) => f.write_str(digits),
            Number::Scientific(digits, power) => write!(f, "{digits}e{power}"),
        }
    }
}

/// Plain text, with names for symbols: `1/3 m l² cos(theta)`.
pub struct Plain<'a> {
    /// Name of a symbol.
    pub name: &'a dyn Fn(Symbol) -> String,
}

impl Style for Plain<'_> {
    fn symbol(&self, symbol: Symbol, power: u8) -> String {
        format!("{}{}", (self.name)(symbol), exponent(power))
    }

    fn power(&self, sum: &str, power: u8) -> String {
        format!("({sum}){}", exponent(power))
    }

    fn call(&self, function: &str, power: u8, arguments: &[Argument]) -> String {
        let arguments: Vec<&str> = arguments.iter().map(|a| a.text.as_str()).collect();
        format!("{function}{}({})", exponent(power), arguments.join(", "))
    }

    fn product(&self, number: Option<Number>, factors: &[Factor], divisors: &[Factor]) -> String {
        let text = |factor: &Factor| match factor {
            Factor::Single(text) => text.clone(),
            Factor::Sum(text) => format!("({text})"),
        };
        let number = number.map(|n| n.to_string());
        let above: Vec<String> = number.into_iter().chain(factors.iter().map(text)).collect();
        let below: Vec<String> = divisors.iter().map(text).collect();
        match below.as_slice() {
            [] => above.join(" "),
            [one] if !one.contains(' ') || one.ends_with(')') => format!("{}/{one}", above.join(" ")),
            _ => format!("{}/({})", above.join(" "), below.join(" ")),
        }
    }
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
