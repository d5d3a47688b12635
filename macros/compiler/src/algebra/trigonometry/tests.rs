//! Tests of each rule alone, and of several rules in sequence.

use super::simplify_trigonometry;
use crate::algebra::normal::NormalFormCache;
use crate::algebra::polynomial::tests::rank_of_symbol;
use crate::equations::print::PolynomialWriter;
use crate::expr::{Expr, Graph, Symbol};

/// Returns the shortest form as text, with angles `a`, `b`, `c` and a parameter `m`.
fn shortest_form_text(build: impl for<'g> Fn(&'g Graph, [Expr<'g>; 3], Expr<'g>) -> Expr<'g>) -> String {
    let graph = Graph::new();
    let angles = [3, 4, 5].map(|k| graph.symbol(Symbol(k)));
    let mut normal = NormalFormCache::new(&graph, rank_of_symbol);
    for angle in angles {
        normal.normal_form(angle.sin()).unwrap();
    }
    let p = normal.normal_form(build(&graph, angles, graph.symbol(Symbol(0)))).unwrap();
    let p = simplify_trigonometry(&mut normal.ring, &p).unwrap();
    PolynomialWriter::new(&normal.ring, &|s| ["m", "k", "l", "a", "b", "c"][s.0 as usize].to_string())
        .format_polynomial(&p)
}

#[test]
fn squared_sine_plus_squared_cosine_is_one() {
    assert_eq!(shortest_form_text(|_, [a, ..], m| m * a.sin().square() + m * a.cos().square()), "m");
    assert_eq!(shortest_form_text(|g, [a, ..], m| m * (g.one() - a.cos().square())), "m sin²(a)");
    assert_eq!(shortest_form_text(|g, [a, ..], m| m * (g.one() - a.sin().square())), "m cos²(a)");
    assert_eq!(
        shortest_form_text(|_, [a, ..], m| m * a.sin().square() + a.cos().square() * 2.0),
        "m sin²(a) + 2 cos²(a)"
    );
    assert_eq!(shortest_form_text(|_, [a, ..], _| a.sin().square() * a.sin().square()), "sin⁴(a)");
    assert_eq!(shortest_form_text(|_, [a, b, _], _| (a + b).sin().square()), "sin²(a + b)");
}

#[test]
fn addition_theorems_combine_angles() {
    assert_eq!(shortest_form_text(|_, [a, b, _], _| a.cos() * b.cos() + a.sin() * b.sin()), "cos(a - b)");
    assert_eq!(shortest_form_text(|_, [a, b, _], _| a.cos() * b.cos() - a.sin() * b.sin()), "cos(a + b)");
    assert_eq!(shortest_form_text(|_, [a, b, _], _| a.sin() * b.cos() - a.cos() * b.sin()), "sin(a - b)");
    assert_eq!(shortest_form_text(|_, [a, b, _], _| a.cos() * b.sin() - a.sin() * b.cos()), "-sin(a - b)");
    assert_eq!(shortest_form_text(|_, [a, b, c], _| (a - b + c).sin()), "sin(a - b + c)");
    assert_eq!(shortest_form_text(|_, [a, b, c], _| (a - b).sin() * c.cos()), "sin(a - b) cos(c)");
    assert_eq!(shortest_form_text(|g, [a, ..], _| (a + g.num(0.3)).cos()), "cos(a + 0.3)");
}

#[test]
fn products_of_sines_keep_their_shortest_form() {
    assert_eq!(shortest_form_text(|_, [a, b, _], m| m * a.cos() * b.cos()), "m cos(a) cos(b)");
    assert_eq!(shortest_form_text(|_, [a, b, _], _| (a + b).cos() + (a - b).cos()), "2 cos(a) cos(b)");
    assert_eq!(shortest_form_text(|_, [a, ..], _| (a * 2.0).sin()), "2 sin(a) cos(a)");
    assert_eq!(shortest_form_text(|_, [a, ..], _| a.cos().square() - a.sin().square()), "cos(2 a)");
    assert_eq!(shortest_form_text(|_, [a, b, _], _| (a + b).sin() * (a + b).cos()), "sin(a + b) cos(a + b)");
}

/// Simplifies the squared length of a bent arm: the square of a sum of cosines.
#[test]
fn squared_length_of_a_bent_arm_simplifies() {
    let text = shortest_form_text(|_, [a, b, _], m| (m * a.cos() + (a + b).cos()).square());
    assert_eq!(text, "m² cos²(a) + 2 m cos(a) cos(a + b) + cos²(a + b)");
}
