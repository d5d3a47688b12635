//! Printing of equations for the math mode of LaTeX with `amsmath`.

use super::names::{NameFragment, SymbolName};
use super::style::{PrintedArgument, PrintedFactor, PrintedNumber, Style};
use crate::expr::node::Symbol;

/// LaTeX style, with names and dots for symbols: `\tfrac{1}{3}\,m\,l^{2}\,\cos\theta`.
#[derive(Clone, Copy)]
pub struct Latex<'a> {
    /// Returns the name of a symbol and its number of dots.
    pub name: &'a dyn Fn(Symbol) -> (SymbolName, u8),
}

/// LaTeX space that is printed between factors.
const SPACE: &str = "\\,";

impl Style for Latex<'_> {
    fn format_symbol_power(&self, symbol: Symbol, power: u8) -> String {
        let (name, dots) = (self.name)(symbol);
        format!("{}{}", format_name(&name, dots), format_exponent(power))
    }

    fn format_number(&self, number: &PrintedNumber) -> String {
        match number {
            PrintedNumber::Fraction(p, q) if *q != 1 => format!("\\tfrac{{{p}}}{{{q}}}"),
            PrintedNumber::Pi(p, q, power) => {
                let pi = if power.abs() == 2 { "\\pi^{2}" } else { "\\pi" };
                let coefficient_or_empty = |k: &u32| if *k == 1 { String::new() } else { k.to_string() };
                match (*power > 0, q) {
                    (true, 1) => format!("{}{pi}", coefficient_or_empty(p)),
                    (true, q) => format!("\\tfrac{{{}{pi}}}{{{q}}}", coefficient_or_empty(p)),
                    (false, q) => format!("\\tfrac{{{p}}}{{{}{pi}}}", coefficient_or_empty(q)),
                }
            }
            PrintedNumber::Root(p, q, root) => {
                let p = if *p == 1 { String::new() } else { p.to_string() };
                match q {
                    1 => format!("{p}\\sqrt{{{root}}}"),
                    q => format!("\\tfrac{{{p}\\sqrt{{{root}}}}}{{{q}}}"),
                }
            }
            PrintedNumber::Scientific(digits, power) => format!("{digits}\\times 10^{{{power}}}"),
            _ => number.to_string(),
        }
    }

    fn format_power_of_sum(&self, sum: &str, power: u8) -> String {
        format!("{}{}", put_in_parentheses(sum), format_exponent(power))
    }

    fn format_function_call(&self, function: &str, power: u8, arguments: &[PrintedArgument]) -> String {
        let power = format_exponent(power);
        let head = match (function, arguments) {
            ("sqrt", [x]) if power.is_empty() => return format!("\\sqrt{{{}}}", x.text),
            ("sqrt", [x]) => return format!("\\left(\\sqrt{{{}}}\\right){power}", x.text),
            ("abs", [x]) => return format!("\\left|{}\\right|{power}", x.text),
            ("pow", [base, exponent]) => {
                let base = if base.lone { base.text.clone() } else { put_in_parentheses(&base.text) };
                let text = format!("{base}^{{{}}}", exponent.text);
                return if power.is_empty() { text } else { format!("{}{power}", put_in_parentheses(&text)) };
            }
            ("asin" | "acos" | "atan", _) => format!("\\arc{}", &function[1..]),
            ("signum", _) => "\\operatorname{sgn}".to_string(),
            ("sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh" | "exp" | "ln", _) => format!("\\{function}"),
            _ => format!("\\operatorname{{{function}}}"),
        };
        // A word gets parentheses: without them it would run into the next word.
        if let [PrintedArgument { text, lone: true }] = arguments
            && !["\\mathrm", "\\dot{\\mathrm"].iter().any(|word| text.starts_with(word))
        {
            let letter = text.starts_with(|c: char| c.is_alphanumeric());
            let gap = if letter && power.is_empty() { " " } else { "" };
            return format!("{head}{power}{gap}{text}");
        }
        let arguments: Vec<&str> = arguments.iter().map(|a| a.text.as_str()).collect();
        let arguments = put_in_parentheses(&arguments.join(", "));
        // Without the negative space, `\left` would be spaced like a factor.
        let gap = if arguments.starts_with("\\left") { "\\!" } else { "" };
        format!("{head}{power}{gap}{arguments}")
    }

    fn format_quotient_of_products(
        &self,
        number: Option<PrintedNumber>,
        factors: &[PrintedFactor],
        divisors: &[PrintedFactor],
    ) -> String {
        if divisors.is_empty() {
            let number = number.map(|n| self.format_number(&n));
            return number
                .into_iter()
                .chain(factors.iter().map(format_factor))
                .collect::<Vec<_>>()
                .join(SPACE);
        }
        // A fraction is not placed in the numerator of another one.
        let small = matches!(&number, Some(PrintedNumber::Fraction(_, q) | PrintedNumber::Root(_, q, _))
            if *q != 1)
            || matches!(&number, Some(PrintedNumber::Pi(_, q, power)) if *q != 1 || *power < 0);
        let number = number.map(|n| self.format_number(&n));
        let (before, above) = if small { (number, None) } else { (None, number) };
        let above = format_fraction_side(above.into_iter(), factors);
        let fraction = format!("\\frac{{{above}}}{{{}}}", format_fraction_side(std::iter::empty(), divisors));
        before.map_or(fraction.clone(), |number| format!("{number}{SPACE}{fraction}"))
    }
}

/// Formats the numerator or denominator of a fraction.
fn format_fraction_side(first: impl Iterator<Item = String>, factors: &[PrintedFactor]) -> String {
    let first: Vec<String> = first.collect();
    match (first.as_slice(), factors) {
        ([], []) => "1".to_string(),
        ([], [PrintedFactor::Sum(text)]) => text.clone(),
        _ => first.into_iter().chain(factors.iter().map(format_factor)).collect::<Vec<_>>().join(SPACE),
    }
}

fn format_factor(factor: &PrintedFactor) -> String {
    match factor {
        PrintedFactor::Single(text) => text.clone(),
        PrintedFactor::Sum(text) => put_in_parentheses(text),
    }
}

/// Puts a text in parentheses of matching height. `\left` is only used for the tallest texts, since it adds
/// space around the parentheses.
fn put_in_parentheses(text: &str) -> String {
    let contains_any = |parts: &[&str]| parts.iter().any(|part| text.contains(part));
    if contains_any(&["\\frac", "\\left", "\\sqrt", "\\bigl"]) {
        format!("\\left({text}\\right)")
    } else if contains_any(&["\\tfrac"]) {
        format!("\\bigl({text}\\bigr)")
    } else {
        format!("({text})")
    }
}

fn format_exponent(power: u8) -> String {
    if power == 1 { String::new() } else { format!("^{{{power}}}") }
}

/// Formats a name with dots above it, one for each time derivative.
pub fn format_name(name: &SymbolName, dots: u8) -> String {
    let base = format_glyph(&name.base);
    let base = match dots {
        0 => base,
        1 => format!("\\dot{{{base}}}"),
        _ => format!("\\ddot{{{base}}}"),
    };
    let indices: Vec<String> = name.indices.iter().map(format_glyph).collect();
    if indices.is_empty() { base } else { format!("{base}_{{{}}}", indices.join(",")) }
}

fn format_glyph(glyph: &NameFragment) -> String {
    match glyph {
        NameFragment::Letter(letter) => letter.to_string(),
        NameFragment::Greek(name, _) => format!("\\{name}"),
        NameFragment::Digits(digits) => digits.clone(),
        NameFragment::Word(word) => format!("\\mathrm{{{}}}", word.replace('_', "\\_")),
    }
}
