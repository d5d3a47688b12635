//! Tests of the printing of numbers, of grouping and of line breaks.

use super::*;
use crate::algebra::normal::NormalFormCache;
use crate::expr::{Expr, Function, Graph};

/// Names of parameters, coordinates, rates and an input: `m k l`, `x y`, `x' y'`, `u`.
const NAMES: [&str; 8] = ["m", "k", "l", "x", "y", "x'", "y'", "u"];

fn rank_of_symbol(symbol: Symbol) -> crate::algebra::polynomial::AtomRank {
    use crate::algebra::polynomial::AtomRank;
    match symbol.0 {
        0..3 => AtomRank::Parameter,
        3..5 => AtomRank::Position,
        5..7 => AtomRank::Rate,
        _ => AtomRank::Input,
    }
}

fn formatted_text(build: impl for<'g> Fn(&'g Graph, [Expr<'g>; 8]) -> Expr<'g>) -> String {
    let graph = Graph::new();
    let symbols = std::array::from_fn(|k| graph.symbol(Symbol(k as u32)));
    let mut normal = NormalFormCache::new(&graph, rank_of_symbol);
    let p = normal.normal_form(build(&graph, symbols)).unwrap();
    PolynomialWriter::new(&normal.ring, &|s| NAMES[s.0 as usize].to_string()).format_polynomial(&p)
}

#[test]
fn numbers_are_printed_as_integers_fractions_or_decimals() {
    for (value, expected) in [
        (1.0 / 3.0, "1/3"),
        (0.5, "1/2"),
        (1.5, "3/2"),
        (2.0 / 3.0, "2/3"),
        (7.0, "7"),
        (0.4, "0.4"),
        (4.905, "4.905"),
        (1234567.8, "1234568"),
        (0.000_123_456_7, "0.000123457"),
        (1.5e-6, "1.5e-6"),
        (2.5e12, "2.5e12"),
    ] {
        assert_eq!(PrintedNumber::classify_number(value).to_string(), expected);
    }
}

/// Sines of 45° and 60° and their multiples are exact. Numbers close to them are printed as decimals.
#[test]
fn exact_sines_are_printed_as_square_roots() {
    let (two, three) = (2.0_f64.sqrt(), 3.0_f64.sqrt());
    for (value, expected) in [
        (two, "sqrt(2)"),
        (0.5 * two, "sqrt(2)/2"),
        (std::f64::consts::FRAC_PI_4.sin(), "sqrt(2)/2"),
        (1.5 * three, "3/2 sqrt(3)"),
        (three / 6.0, "sqrt(3)/6"),
        (5.0 * three, "5 sqrt(3)"),
        (0.7072, "0.7072"),
        (1.7322, "1.7322"),
    ] {
        assert_eq!(PrintedNumber::classify_number(value).to_string(), expected);
    }
    assert_eq!(formatted_latex(|g, [m, ..]| m * g.num(0.5 * two)), r"\tfrac{\sqrt{2}}{2}\,m");
    assert_eq!(formatted_latex(|g, [m, ..]| m * g.num(3.0 * three)), r"3\sqrt{3}\,m");
}

/// Multiples of powers of π are printed without decimals. Numbers close to them are printed as decimals.
#[test]
fn multiples_of_pi_are_printed_symbolically() {
    use std::f64::consts::PI;
    for (value, expected) in [
        (PI, "pi"),
        (PI / 2.0, "pi/2"),
        (3.0 * PI / 2.0, "3/2 pi"),
        (2.0 * PI, "2 pi"),
        (4.0 * PI * PI, "4 pi²"),
        (0.5 * (PI / 2.0) * (PI / 2.0), "pi²/8"),
        (1.0 / (2.0 * PI), "1/(2 pi)"),
        (1.0 / PI, "1/pi"),
        (0.25 / (PI * PI), "1/(4 pi²)"),
        (10.0_f64.to_radians(), "pi/18"),
        (135.0_f64.to_radians(), "3/4 pi"),
        (36.0_f64.to_radians(), "pi/5"),
        (PI + 1e-3, "3.14259"),
        (PI / 2.0 - 1e-5, "1.57079"),
        (1.0001 * PI, "3.14191"),
    ] {
        assert_eq!(PrintedNumber::classify_number(value).to_string(), expected);
    }
    assert_eq!(formatted_text(|g, [_, k, _, x, ..]| k * (x - g.num(PI / 2.0))), "k (x - pi/2)");
    assert_eq!(formatted_text(|g, [m, k, ..]| m * k * g.num(0.5 / PI)), "1/(2 pi) m k");
    assert_eq!(
        formatted_text(|g, [_, _, _, x, ..]| (x - g.num(PI / 3.0)).sin()),
        "cos(pi/3) sin(x) - sin(pi/3) cos(x)"
    );
    assert_eq!(formatted_latex(|g, [m, ..]| m * g.num(PI)), r"\pi\,m");
    assert_eq!(formatted_latex(|g, [m, ..]| m * g.num(1.5 * PI)), r"\tfrac{3\pi}{2}\,m");
    assert_eq!(formatted_latex(|g, [m, k, ..]| m / k * g.num(0.5 / PI)), r"\tfrac{1}{2\pi}\,\frac{m}{k}");
}

#[test]
fn products_are_printed_with_quotients_and_powers() {
    assert_eq!(formatted_text(|g, _| g.zero()), "0");
    assert_eq!(
        formatted_text(|g, [m, _, l, x, ..]| m * l * l * x.cos() * g.num(-1.0 / 3.0)),
        "-1/3 m l² cos(x)"
    );
    assert_eq!(formatted_text(|_, [m, k, ..]| m / k), "m/k");
    assert_eq!(formatted_text(|g, [m, k, l, ..]| g.one() / (m * k * l * l)), "1/(m k l²)");
    assert_eq!(formatted_text(|_, [m, k, l, x, ..]| m * x / (k + l)), "m x/(k + l)");
    assert_eq!(
        formatted_text(|_, [m, k, _, _, _, v, ..]| k * (v / m).apply_function(Function::Tanh)),
        "k tanh(x'/m)"
    );
    assert_eq!(formatted_text(|_, [m, .., u]| m * u), "m u");
}

#[test]
fn parentheses_are_printed_where_precedence_requires() {
    assert_eq!(formatted_text(|_, [m, k, _, _, _, v, w, _]| (m + k) * v + m * w), "(m + k) x' + m y'");
    assert_eq!(
        formatted_text(|_, [m, _, l, x, _, v, ..]| m * v * v * (l + x).square()),
        "m (l² + 2 l x + x²) x'²"
    );
    assert_eq!(formatted_text(|_, [_, k, l, x, ..]| k * (x - l).square() * 0.5), "1/2 k (x - l)²");
    assert_eq!(formatted_text(|_, [_, k, _, x, y, ..]| -k * (x - y).square()), "-k (x - y)²");
    assert_eq!(formatted_text(|_, [_, k, l, x, ..]| k * x - k * l), "k (x - l)");
    assert_eq!(formatted_text(|_, [m, k, _, x, ..]| m * x.sin() - k * x.sin()), "(m - k) sin(x)");
    assert_eq!(formatted_text(|_, [m, k, _, _, _, v, ..]| -m * v - k * v), "-(m + k) x'");
    assert_eq!(formatted_text(|_, [m, k, l, _, _, v, ..]| k * v / m - l * v / m), "(k - l) x'/m");
}

#[test]
fn long_equations_are_split_into_lines() {
    let line = wrap_text("alpha + beta (gamma + delta) - epsilon = zeta", 20, "  ");
    assert_eq!(line, "alpha\n  + beta (gamma\n  + delta)\n  - epsilon = zeta");
    assert_eq!(wrap_text("a + b", 20, "  "), "a + b");
    assert_eq!(wrap_text("indivisible", 5, "  "), "indivisible");
    let wide = wrap_text(&["theta²"; 60].join(" + "), 40, "    ");
    assert!(wide.lines().all(|line| line.chars().count() <= 40), "{wide}");
}

fn formatted_latex(build: impl for<'g> Fn(&'g Graph, [Expr<'g>; 8]) -> Expr<'g>) -> String {
    let graph = Graph::new();
    let symbols = std::array::from_fn(|k| graph.symbol(Symbol(k as u32)));
    let mut normal = NormalFormCache::new(&graph, rank_of_symbol);
    let p = normal.normal_form(build(&graph, symbols)).unwrap();
    let name_and_primes = |s: Symbol| {
        let name = NAMES[s.0 as usize].trim_end_matches('\'');
        (SymbolName::parse(name), u8::from(NAMES[s.0 as usize].ends_with('\'')))
    };
    PolynomialWriter::new_with_style(&normal.ring, Latex { name: &name_and_primes }).format_polynomial(&p)
}

#[test]
fn latex_products_use_fractions_and_powers() {
    assert_eq!(formatted_latex(|g, _| g.zero()), "0");
    assert_eq!(
        formatted_latex(|g, [m, _, l, x, ..]| m * l * l * x.cos() * g.num(-1.0 / 3.0)),
        r"-\tfrac{1}{3}\,m\,l^{2}\,\cos x"
    );
    assert_eq!(formatted_latex(|_, [m, k, ..]| m / k), r"\frac{m}{k}");
    assert_eq!(formatted_latex(|g, [m, k, ..]| g.num(0.5) * m / k), r"\tfrac{1}{2}\,\frac{m}{k}");
    assert_eq!(formatted_latex(|g, [m, k, ..]| g.num(3.0) * m / k), r"\frac{3\,m}{k}");
    assert_eq!(formatted_latex(|g, [m, k, l, ..]| g.one() / (m * k * l * l)), r"\frac{1}{m\,k\,l^{2}}");
    assert_eq!(formatted_latex(|_, [m, k, l, x, ..]| m * x / (k + l)), r"\frac{m\,x}{k + l}");
    assert_eq!(
        formatted_latex(|_, [m, k, l, _, _, v, ..]| k * v / m - l * v / m),
        r"\frac{(k - l)\,\dot{x}}{m}"
    );
    assert_eq!(
        formatted_latex(|_, [_, k, l, x, ..]| k * (x - l).square() * 0.5),
        r"\tfrac{1}{2}\,k\,(x - l)^{2}"
    );
    assert_eq!(formatted_latex(|g, [m, ..]| m * g.num(1.5e-6)), r"1.5\times 10^{-6}\,m");
}

#[test]
fn latex_functions_are_typeset_upright() {
    assert_eq!(formatted_latex(|_, [_, _, _, x, ..]| x.cos() * x.cos()), r"\cos^{2}x");
    assert_eq!(
        formatted_latex(|_, [m, k, _, _, _, v, ..]| k * (v / m).apply_function(Function::Tanh)),
        r"k\,\tanh\!\left(\frac{\dot{x}}{m}\right)"
    );
    assert_eq!(formatted_latex(|_, [_, _, _, x, ..]| x.apply_function(Function::Sqrt)), r"\sqrt{x}");
    assert_eq!(
        formatted_latex(|_, [_, _, _, _, _, v, ..]| v.apply_function(Function::Abs)),
        r"\left|\dot{x}\right|"
    );
    assert_eq!(
        formatted_latex(|_, [_, _, _, _, _, v, ..]| v.apply_function(Function::Signum)),
        r"\operatorname{sgn}\dot{x}"
    );
    assert_eq!(formatted_latex(|_, [_, _, _, x, ..]| x.apply_function(Function::Atan)), r"\arctan x");
}

#[test]
fn latex_names_have_subscripts() {
    for (text, expected) in [
        ("m", "m"),
        ("m1", "m_{1}"),
        ("theta", r"\theta"),
        ("theta2", r"\theta_{2}"),
        ("θ", r"\theta"),
        ("pi", r"\mathrm{pi}"),
        ("Omega_z", r"\Omega_{z}"),
        ("alpha_10", r"\alpha_{10}"),
        ("k_spring", r"k_{\mathrm{spring}}"),
        ("k1_front_left", r"k_{1,\mathrm{front\_left}}"),
        ("cart_mass", r"\mathrm{cart\_mass}"),
        ("link2", r"\mathrm{link}_{2}"),
        ("link_2", r"\mathrm{link}_{2}"),
        ("m1a", r"\mathrm{m1a}"),
        ("_spare", r"\mathrm{\_spare}"),
        ("tip.wx", r"\omega_{\mathrm{tip},x}"),
        ("tip.qw", r"q_{\mathrm{tip},w}"),
        ("table.x", r"x_{\mathrm{table}}"),
        ("hip1.second", r"\mathrm{second}_{\mathrm{hip1}}"),
    ] {
        assert_eq!(super::latex::format_name(&SymbolName::parse(text), 0), expected);
    }
    assert_eq!(super::latex::format_name(&SymbolName::parse("theta2"), 1), r"\dot{\theta}_{2}");
    assert_eq!(super::latex::format_name(&SymbolName::parse("x"), 2), r"\ddot{x}");
}

/// Names that would be indistinguishable in print are not split.
#[test]
fn ambiguous_names_are_not_split_in_print() {
    let names = names::TypesetNames::new(["m1", "m_1", "table.x", "x_table", "m2"].into_iter());
    let spell_in_latex = |text| super::latex::format_name(&names.typeset_name(text), 0);
    assert_eq!(spell_in_latex("m1"), r"\mathrm{m1}");
    assert_eq!(spell_in_latex("m_1"), r"\mathrm{m\_1}");
    assert_eq!(spell_in_latex("table.x"), r"\mathrm{table.x}");
    assert_eq!(spell_in_latex("x_table"), r"\mathrm{x\_table}");
    assert_eq!(spell_in_latex("m2"), "m_{2}");
}
