//! Numbers, grouping and lines.

use super::*;
use crate::expr::normal::Normal;
use crate::expr::{Function, Graph};

/// Parameters, coordinates, rates, inputs: `m k l`, `x y`, `x' y'`, `u`.
const NAMES: [&str; 8] = ["m", "k", "l", "x", "y", "x'", "y'", "u"];

fn rank(symbol: Symbol) -> super::super::polynomial::Rank {
    use super::super::polynomial::Rank;
    match symbol.0 {
        0..3 => Rank::Parameter,
        3..5 => Rank::Position,
        5..7 => Rank::Rate,
        _ => Rank::Input,
    }
}

fn text(build: impl for<'g> Fn(&'g Graph, [Expr<'g>; 8]) -> Expr<'g>) -> String {
    let graph = Graph::new();
    let symbols = std::array::from_fn(|k| graph.symbol(Symbol(k as u32)));
    let mut normal = Normal::new(&graph, rank);
    let p = normal.of(build(&graph, symbols)).unwrap();
    Writer::new(&normal.ring, &|s| NAMES[s.0 as usize].to_string()).polynomial(&p)
}

#[test]
fn numbers() {
    for (value, before, expected) in [
        (1.0 / 3.0, true, "1/3"),
        (0.5, true, "1/2"),
        (0.5, false, "0.5"),
        (2.0 / 3.0, false, "2/3"),
        (7.0, true, "7"),
        (0.4, true, "0.4"),
        (4.905, true, "4.905"),
        (1234567.8, true, "1234568"),
        (0.000_123_456_7, false, "0.000123457"),
        (1.5e-6, false, "1.5e-6"),
        (2.5e12, true, "2.5e12"),
    ] {
        assert_eq!(number(value, before), expected);
    }
}

#[test]
fn products() {
    assert_eq!(text(|g, _| g.zero()), "0");
    assert_eq!(text(|g, [m, _, l, x, ..]| m * l * l * x.cos() * g.num(-1.0 / 3.0)), "-1/3 m l² cos(x)");
    assert_eq!(text(|_, [m, k, ..]| m / k), "m/k");
    assert_eq!(text(|g, [m, k, l, ..]| g.one() / (m * k * l * l)), "1/(m k l²)");
    assert_eq!(text(|_, [m, k, l, x, ..]| m * x / (k + l)), "m x/(k + l)");
    assert_eq!(text(|_, [m, k, _, _, _, v, ..]| k * (v / m).call(Function::Tanh)), "k tanh(x'/m)");
    assert_eq!(text(|_, [m, .., u]| m * u), "m u");
}

#[test]
fn groups() {
    assert_eq!(text(|_, [m, k, _, _, _, v, w, _]| (m + k) * v + m * w), "(m + k) x' + m y'");
    assert_eq!(text(|_, [m, _, l, x, _, v, ..]| m * v * v * (l + x).square()), "m (l² + 2 l x + x²) x'²");
    assert_eq!(text(|_, [_, k, l, x, ..]| k * (x - l).square() * 0.5), "1/2 k (x - l)²");
    assert_eq!(text(|_, [_, k, _, x, y, ..]| -k * (x - y).square()), "-k (x - y)²");
    assert_eq!(text(|_, [_, k, l, x, ..]| k * x - k * l), "k (x - l)");
    assert_eq!(text(|_, [m, k, _, x, ..]| m * x.sin() - k * x.sin()), "(m - k) sin(x)");
    assert_eq!(text(|_, [m, k, _, _, _, v, ..]| -m * v - k * v), "-(m + k) x'");
    assert_eq!(text(|_, [m, k, l, _, _, v, ..]| k * v / m - l * v / m), "(k - l) x'/m");
}

#[test]
fn lines() {
    let line = wrapped("alpha + beta (gamma + delta) - epsilon = zeta", 20, "  ");
    assert_eq!(line, "alpha\n  + beta (gamma\n  + delta)\n  - epsilon = zeta");
    assert_eq!(wrapped("a + b", 20, "  "), "a + b");
    assert_eq!(wrapped("indivisible", 5, "  "), "indivisible");
    let wide = wrapped(&["theta²"; 60].join(" + "), 40, "    ");
    assert!(wide.lines().all(|line| line.chars().count() <= 40), "{wide}");
}
