//! Presentation MathML, which browsers render without scripts. Browsers do not break formulas. Every term of
//! a sum is therefore a formula of its own, with line breaks between them.

use super::names::{NameFragment, SymbolName};
use super::style::{PrintedArgument, PrintedFactor, PrintedNumber, Style};
use crate::expr::node::Symbol;

/// MathML style, with names and dots for symbols.
#[derive(Clone, Copy)]
pub struct MathMl<'a> {
    /// Returns the name of a symbol and its number of dots.
    pub name: &'a dyn Fn(Symbol) -> (SymbolName, u8),
}

/// Marks of possible line breaks before signs: outside of parentheses, in one pair of parentheses, in two
/// pairs.
const BREAKS: [char; 3] = ['\u{1}', '\u{2}', '\u{3}'];
/// Formulas of more than this number of characters are also broken within parentheses.
const WIDE: usize = 36;
/// MathML operator between two factors.
const TIMES: &str = "<mo rspace=\".17em\">\u{2062}</mo>";
/// MathML operator between a function and an argument without parentheses.
const OF: &str = "<mo rspace=\".17em\">\u{2061}</mo>";

/// Formats equations and inequalities as HTML in one line of source, a paragraph each with indented
/// continuation lines. Their sides are separated by ` = ` or ` > `.
pub fn format_equations_as_html(lines: &[String]) -> String {
    let mut out = String::from("<div>");
    for line in lines {
        let line = line
            .replace(" = ", "\u{1}<mo form=\"infix\">=</mo>")
            .replace(" > ", "\u{1}<mo form=\"infix\">&gt;</mo>");
        out += "<div style=\"margin:.5em 0;padding-left:2em;text-indent:-2em;overflow:auto hidden\">";
        let parts: Vec<String> =
            split_at_breaks(&line, &BREAKS).iter().map(|p| format!("<math>{p}</math>")).collect();
        out += &parts.join(" ");
        out += "</div>";
    }
    out + "</div>"
}

/// Splits a line into pieces between which it may be broken: at outer signs, and at inner signs if a piece is
/// still too wide.
fn split_at_breaks(line: &str, breaks: &[char]) -> Vec<String> {
    let Some((outer, inner)) = breaks.split_first() else { return vec![remove_break_marks(line)] };
    if estimate_width(line) <= WIDE {
        return line.split(BREAKS[0]).map(remove_break_marks).collect();
    }
    line.split(*outer).flat_map(|piece| split_at_breaks(piece, inner)).collect()
}

/// Removes the marks of possible line breaks from a text.
fn remove_break_marks(text: &str) -> String {
    text.replace(BREAKS, "")
}

/// Estimates the number of visible characters of a MathML formula.
fn estimate_width(text: &str) -> usize {
    let (mut inside, mut count) = (false, 0);
    for c in text.chars() {
        match c {
            '<' => inside = true,
            '>' => inside = false,
            '\u{1}'..='\u{3}' | '\u{2061}' | '\u{2062}' => {}
            _ => count += usize::from(!inside),
        }
    }
    count
}

/// Wraps a formula in a single MathML element.
fn wrap_in_row(text: &str) -> String {
    format!("<mrow>{}</mrow>", remove_break_marks(text))
}

fn raised_to_power(base: &str, power: u8) -> String {
    if power == 1 { base.to_string() } else { format!("<msup>{base}<mn>{power}</mn></msup>") }
}

/// Puts a text in parentheses: stretched if it is short, otherwise of fixed size with marks of possible line
/// breaks.
fn put_in_parentheses(text: &str) -> String {
    if estimate_width(text) <= WIDE {
        return format!("<mrow><mo>(</mo>{}<mo>)</mo></mrow>", remove_break_marks(text));
    }
    let mut inner: String = text.replace(BREAKS[2], "");
    inner = inner.replace(BREAKS[1], "\u{3}").replace(BREAKS[0], "\u{2}");
    format!("<mo stretchy=\"false\">(</mo>{inner}<mo stretchy=\"false\">)</mo>")
}

fn format_fraction(above: &str, below: &str) -> String {
    format!("<mfrac>{}{}</mfrac>", wrap_in_row(above), wrap_in_row(below))
}

impl Style for MathMl<'_> {
    fn format_symbol_power(&self, symbol: Symbol, power: u8) -> String {
        let (name, dots) = (self.name)(symbol);
        format_name(&name, dots, power)
    }

    fn format_number(&self, number: &PrintedNumber) -> String {
        let number_element = |n: &dyn std::fmt::Display| format!("<mn>{n}</mn>");
        let multiple_of_term =
            |k: &u32, of: String| if *k == 1 { of } else { format!("<mrow><mn>{k}</mn>{of}</mrow>") };
        let fraction_element = |above: String, q: &u32| match q {
            1 => above,
            q => format!("<mfrac>{above}<mn>{q}</mn></mfrac>"),
        };
        match number {
            PrintedNumber::Fraction(p, q) => fraction_element(number_element(p), q),
            PrintedNumber::Pi(p, q, power) => {
                let pi = raised_to_power("<mi>π</mi>", power.unsigned_abs());
                match *power > 0 {
                    true => fraction_element(multiple_of_term(p, pi), q),
                    false => format!("<mfrac><mn>{p}</mn>{}</mfrac>", multiple_of_term(q, pi)),
                }
            }
            PrintedNumber::Root(p, q, root) => {
                fraction_element(multiple_of_term(p, format!("<msqrt><mn>{root}</mn></msqrt>")), q)
            }
            PrintedNumber::Decimal(text) => number_element(text),
            PrintedNumber::Scientific(text, power) => {
                let sign = if power.starts_with('-') { "<mo>−</mo>" } else { "" };
                let power = power.trim_start_matches('-');
                format!(
                    "<mn>{text}</mn><mo>×</mo><msup><mn>10</mn><mrow>{sign}<mn>{power}</mn></mrow></msup>"
                )
            }
        }
    }

    fn sign_before_term(&self, first: bool, negative: bool) -> &'static str {
        match (first, negative) {
            (true, false) => "",
            (true, true) => "<mo form=\"prefix\">−</mo>",
            (false, false) => "\u{1}<mo form=\"infix\">+</mo>",
            (false, true) => "\u{1}<mo form=\"infix\">−</mo>",
        }
    }

    fn format_power_of_sum(&self, sum: &str, power: u8) -> String {
        raised_to_power(&wrap_in_row(&put_in_parentheses(sum)), power)
    }

    fn format_function_call(&self, function: &str, power: u8, arguments: &[PrintedArgument]) -> String {
        let head = match (function, arguments) {
            ("sqrt", [x]) => {
                return raised_to_power(&format!("<msqrt>{}</msqrt>", wrap_in_row(&x.text)), power);
            }
            ("abs", [x]) => {
                return raised_to_power(
                    &format!("<mrow><mo>|</mo>{}<mo>|</mo></mrow>", remove_break_marks(&x.text)),
                    power,
                );
            }
            ("pow", [base, exponent]) => {
                let base = if base.lone { base.text.clone() } else { put_in_parentheses(&base.text) };
                let text = format!("<msup>{}{}</msup>", wrap_in_row(&base), wrap_in_row(&exponent.text));
                return if power == 1 { text } else { self.format_power_of_sum(&text, power) };
            }
            ("asin" | "acos" | "atan", _) => format!("arc{}", &function[1..]),
            ("signum", _) => "sgn".to_string(),
            _ => function.to_string(),
        };
        let head = raised_to_power(&format!("<mi>{}</mi>", escape_xml(&head)), power);
        if let [PrintedArgument { text, lone: true }] = arguments {
            return format!("{head}{OF}{}", remove_break_marks(text));
        }
        let arguments: Vec<String> = arguments.iter().map(|a| remove_break_marks(&a.text)).collect();
        format!("{head}<mo>\u{2061}</mo><mrow><mo>(</mo>{}<mo>)</mo></mrow>", arguments.join("<mo>,</mo>"))
    }

    fn format_quotient_of_products(
        &self,
        number: Option<PrintedNumber>,
        factors: &[PrintedFactor],
        divisors: &[PrintedFactor],
    ) -> String {
        let small = matches!(&number, Some(PrintedNumber::Fraction(_, q) | PrintedNumber::Root(_, q, _))
            if *q != 1)
            || matches!(&number, Some(PrintedNumber::Pi(_, q, power)) if *q != 1 || *power < 0);
        let number = number.map(|n| self.format_number(&n));
        if divisors.is_empty() {
            return number
                .into_iter()
                .chain(factors.iter().map(format_factor))
                .collect::<Vec<_>>()
                .join(TIMES);
        }
        // A fraction is not placed in the numerator of another one.
        let (before, above) = if small { (number, None) } else { (None, number) };
        let fraction = format_fraction(
            &format_fraction_side(above.into_iter(), factors),
            &format_fraction_side(std::iter::empty(), divisors),
        );
        before.map_or(fraction.clone(), |number| format!("{number}{TIMES}{fraction}"))
    }
}

/// Formats the numerator or denominator of a fraction.
fn format_fraction_side(first: impl Iterator<Item = String>, factors: &[PrintedFactor]) -> String {
    let first: Vec<String> = first.collect();
    match (first.as_slice(), factors) {
        ([], []) => "<mn>1</mn>".to_string(),
        ([], [PrintedFactor::Sum(text)]) => text.clone(),
        _ => first.into_iter().chain(factors.iter().map(format_factor)).collect::<Vec<_>>().join(TIMES),
    }
}

fn format_factor(factor: &PrintedFactor) -> String {
    match factor {
        PrintedFactor::Single(text) => text.clone(),
        PrintedFactor::Sum(text) => put_in_parentheses(text),
    }
}

/// Formats a name with dots above it, raised to a power.
pub fn format_name(name: &SymbolName, dots: u8, power: u8) -> String {
    let base = format_glyph(&name.base);
    let base = match dots {
        0 => base,
        1 => format!("<mover accent=\"true\">{base}<mo>˙</mo></mover>"),
        _ => format!("<mover accent=\"true\">{base}<mo>¨</mo></mover>"),
    };
    let indices: Vec<String> = name.indices.iter().map(format_glyph).collect();
    let indices = match indices.as_slice() {
        [] => return raised_to_power(&base, power),
        [one] => one.clone(),
        all => format!("<mrow>{}</mrow>", all.join("<mo>,</mo>")),
    };
    match power {
        1 => format!("<msub>{base}{indices}</msub>"),
        power => format!("<msubsup>{base}{indices}<mn>{power}</mn></msubsup>"),
    }
}

fn format_glyph(glyph: &NameFragment) -> String {
    match glyph {
        NameFragment::Letter(letter) | NameFragment::Greek(_, letter) => format!("<mi>{letter}</mi>"),
        NameFragment::Digits(digits) => format!("<mn>{digits}</mn>"),
        NameFragment::Word(word) => format!("<mi>{}</mi>", escape_xml(word)),
    }
}

/// Escapes the special characters of XML in a text.
fn escape_xml(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_sums_in_mathml_break_between_terms() {
        let term = "<mi>alpha</mi><mi>beta</mi>";
        let style = MathMl { name: &|_| (SymbolName::parse("x"), 0) };
        let sum = [term; 8].join(style.sign_before_term(false, false));
        let break_into_pieces = |text: &str| split_at_breaks(text, &BREAKS);
        assert_eq!(break_into_pieces(&sum).len(), 8);
        let product = format!("<mi>m</mi>{}", put_in_parentheses(&sum));
        assert_eq!(break_into_pieces(&product).len(), 8);
        assert!(break_into_pieces(&product)[0].starts_with("<mi>m</mi><mo stretchy=\"false\">(</mo>"));
        // Short parentheses remain in one piece, and so do fractions.
        let short = [term; 2].join(style.sign_before_term(false, true));
        assert_eq!(
            break_into_pieces(&format!("{}{}", put_in_parentheses(&short), format_fraction(&sum, &sum)))
                .len(),
            1
        );
        assert!(!format_equations_as_html(&[sum]).contains(BREAKS));
    }
}
