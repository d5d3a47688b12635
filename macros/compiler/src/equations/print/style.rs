//! Styles that format the components of a polynomial, and the plain text style.

use crate::algebra::item::{fraction_of_number, greatest_common_divisor};
use crate::expr::node::Symbol;
use std::f64::consts::PI;
use std::fmt;

/// Printed text in all output formats; empty if there are no equations.
#[derive(Clone, Debug, Default)]
pub struct PrintedEquations {
    /// Equations as plain text without markup.
    pub plain: String,
    /// Equations for the math mode of LaTeX.
    pub latex: String,
    /// Equations as HTML with MathML, in one line.
    pub mathml: String,
}

/// Output format in which polynomials are printed: text, LaTeX or MathML.
pub trait Style {
    /// Formats a symbol raised to a power.
    fn format_symbol_power(&self, symbol: Symbol, power: u8) -> String;

    /// Formats the absolute value of a number.
    fn format_number(&self, number: &PrintedNumber) -> String {
        number.to_string()
    }

    /// Returns the sign before a term of a sum, empty for a positive first term.
    fn sign_before_term(&self, first: bool, negative: bool) -> &'static str {
        match (first, negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        }
    }

    /// Formats a sum in parentheses, raised to a power.
    fn format_power_of_sum(&self, sum: &str, power: u8) -> String;

    /// Formats a function call raised to a power, given the function's name in the language.
    fn format_function_call(&self, function: &str, power: u8, arguments: &[PrintedArgument]) -> String;

    /// Formats the product of a number and factors, divided by `divisors`. `number` is `None` only if there
    /// are factors.
    fn format_quotient_of_products(
        &self,
        number: Option<PrintedNumber>,
        factors: &[PrintedFactor],
        divisors: &[PrintedFactor],
    ) -> String;
}

/// Formatted factor of a printed product.
pub enum PrintedFactor {
    /// Factor that is printed without parentheses.
    Single(String),
    /// Sum that is printed in parentheses, here still without them.
    Sum(String),
}

/// Formatted argument of a printed function.
pub struct PrintedArgument {
    /// Text of the argument.
    pub text: String,
    /// True if the argument of the function is a single symbol.
    pub lone: bool,
}

/// A number for printing, without sign. Fractions with denominators of factors two and three are printed as
/// fractions. Simple multiples of powers of π and of the roots of 2 and 3 are printed as such. All other
/// numbers are printed as decimals.
#[derive(Clone, Debug, PartialEq)]
pub enum PrintedNumber {
    /// Fraction, by its numerator and denominator.
    Fraction(u32, u32),
    /// Numerator and denominator of the coefficient of a power of π, and that power: 1, 2, −1 or −2.
    Pi(u32, u32, i8),
    /// Numerator and denominator of the coefficient of the square root of 2 or 3, and 2 or 3.
    Root(u32, u32, u32),
    /// Decimal number, by its digits with or without a decimal point.
    Decimal(String),
    /// Decimal number in scientific notation, by its digits and its exponent of ten.
    Scientific(String, String),
}

impl PrintedNumber {
    /// The number zero.
    pub const ZERO: PrintedNumber = PrintedNumber::Fraction(0, 1);
    /// The number one.
    pub const ONE: PrintedNumber = PrintedNumber::Fraction(1, 1);

    /// Classifies a positive number: a fraction, multiple of π or multiple of a root if the integers involved
    /// are small, otherwise up to six significant digits.
    pub fn classify_number(value: f64) -> PrintedNumber {
        if let Some((p, q)) = fraction_of_number(value) {
            return PrintedNumber::Fraction(p, q);
        }
        if let Some((p, q, power)) = multiple_of_pi(value) {
            return PrintedNumber::Pi(p, q, power);
        }
        if let Some((p, q, root)) = multiple_of_root(value) {
            return PrintedNumber::Root(p, q, root);
        }
        let exponent = libm::log10(value).floor() as i32;
        if !(-4..9).contains(&exponent) {
            let text = format!("{value:.5e}");
            let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
            return PrintedNumber::Scientific(trim_trailing_zeros(digits).to_string(), power.to_string());
        }
        let decimals = usize::try_from(5 - exponent).unwrap_or(0);
        PrintedNumber::Decimal(trim_trailing_zeros(&format!("{value:.decimals$}")).to_string())
    }
}

/// Maximum numerator of the coefficient of an irrational number: larger numerators match by chance.
const SIMPLE: u32 = 48;

/// Returns numerator and denominator of the coefficient of the square root of 2 or 3, which occur in sines of
/// 45° and 60°.
fn multiple_of_root(value: f64) -> Option<(u32, u32, u32)> {
    [2_u32, 3].into_iter().find_map(|root| {
        let found = fraction_of_number(value / f64::from(root).sqrt());
        found.filter(|(p, _)| *p <= SIMPLE).map(|(p, q)| (p, q, root))
    })
}

/// Returns numerator and denominator of the coefficient of a power of π, and the power: simple fractions, and
/// for π itself also whole degrees up to two revolutions.
fn multiple_of_pi(value: f64) -> Option<(u32, u32, i8)> {
    for power in [1, 2, -1, -2] {
        let factor = value / libm::pow(PI, power.into());
        if let Some((p, q)) = fraction_of_number(factor).filter(|(p, _)| *p <= SIMPLE) {
            return Some((p, q, power));
        }
    }
    let degrees = value * 180.0 / PI;
    let whole = degrees.round();
    if !(1.0..=720.0).contains(&whole) || (degrees - whole).abs() > 1e-11 * whole {
        return None;
    }
    let whole = whole as u32;
    let common = greatest_common_divisor(whole, 180);
    Some((whole / common, 180 / common, 1)).filter(|(p, ..)| *p <= SIMPLE)
}

fn trim_trailing_zeros(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

impl fmt::Display for PrintedNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PrintedNumber::Fraction(p, 1) => write!(f, "{p}"),
            PrintedNumber::Fraction(p, q) => write!(f, "{p}/{q}"),
            PrintedNumber::Pi(p, q, power) => {
                let pi = if power.abs() == 2 { "pi²" } else { "pi" };
                match (*power > 0, p, q) {
                    (true, 1, 1) => f.write_str(pi),
                    (true, p, 1) => write!(f, "{p} {pi}"),
                    (true, 1, q) => write!(f, "{pi}/{q}"),
                    (true, p, q) => write!(f, "{p}/{q} {pi}"),
                    (false, p, 1) => write!(f, "{p}/{pi}"),
                    (false, p, q) => write!(f, "{p}/({q} {pi})"),
                }
            }
            PrintedNumber::Root(1, 1, root) => write!(f, "sqrt({root})"),
            PrintedNumber::Root(1, q, root) => write!(f, "sqrt({root})/{q}"),
            PrintedNumber::Root(p, 1, root) => write!(f, "{p} sqrt({root})"),
            PrintedNumber::Root(p, q, root) => write!(f, "{p}/{q} sqrt({root})"),
            PrintedNumber::Decimal(digits) => f.write_str(digits),
            PrintedNumber::Scientific(digits, power) => write!(f, "{digits}e{power}"),
        }
    }
}

/// Plain text style, with names for symbols: `1/3 m l² cos(theta)`.
#[derive(Clone, Copy)]
pub struct Plain<'a> {
    /// Closure that returns the printed name of a symbol.
    pub name: &'a dyn Fn(Symbol) -> String,
}

impl Style for Plain<'_> {
    fn format_symbol_power(&self, symbol: Symbol, power: u8) -> String {
        format!("{}{}", (self.name)(symbol), format_exponent(power))
    }

    fn format_power_of_sum(&self, sum: &str, power: u8) -> String {
        format!("({sum}){}", format_exponent(power))
    }

    fn format_function_call(&self, function: &str, power: u8, arguments: &[PrintedArgument]) -> String {
        let arguments: Vec<&str> = arguments.iter().map(|a| a.text.as_str()).collect();
        format!("{function}{}({})", format_exponent(power), arguments.join(", "))
    }

    fn format_quotient_of_products(
        &self,
        number: Option<PrintedNumber>,
        factors: &[PrintedFactor],
        divisors: &[PrintedFactor],
    ) -> String {
        let text_of_factor = |factor: &PrintedFactor| match factor {
            PrintedFactor::Single(text) => text.clone(),
            PrintedFactor::Sum(text) => format!("({text})"),
        };
        let number = number.map(|n| n.to_string());
        let above: Vec<String> = number.into_iter().chain(factors.iter().map(text_of_factor)).collect();
        let below: Vec<String> = divisors.iter().map(text_of_factor).collect();
        match below.as_slice() {
            [] => above.join(" "),
            [one] if !one.contains(' ') || one.ends_with(')') => format!("{}/{one}", above.join(" ")),
            _ => format!("{}/({})", above.join(" "), below.join(" ")),
        }
    }
}

fn format_exponent(power: u8) -> &'static str {
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
