//! Replacement of sines and cosines by exact values: of multiples of π/6 and π/4, of inverse trigonometric
//! functions, and of sums with one of these. Used for printing and proofs only: generated code evaluates the
//! original expressions.

use super::node::Function;
use super::replace::replace_symbols_and_calls;
use super::{Expr, Node, Symbol};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Relative tolerance with which an angle is recognised as a multiple of π/12.
const ROUNDING: f64 = 1e-14;

/// Substitutes `by(s)` for symbols `s` of expressions, and replaces sines, cosines and tangents of known
/// angles by exact values.
pub fn substitute_with_exact_sines<'g>(
    e: &[Expr<'g>],
    by: &dyn Fn(Symbol) -> Option<Expr<'g>>,
) -> Vec<Expr<'g>> {
    replace_symbols_and_calls(e, by, &|f, x| match f {
        Function::Sin => sine_and_cosine(x)[0],
        Function::Cos => sine_and_cosine(x)[1],
        Function::Tan => {
            let [sin, cos] = sine_and_cosine(x);
            let plain = sin == x.sin() || cos.is_zero();
            if plain { x.apply_function(f) } else { sin / cos }
        }
        _ => x.apply_function(f),
    })
}

/// Maximum nesting depth of sums that are replaced.
const DEPTH: usize = 16;

/// Returns sine and cosine of an expression, with exact values for special angles.
fn sine_and_cosine(x: Expr<'_>) -> [Expr<'_>; 2] {
    known_sine_cosine(x, DEPTH).unwrap_or_else(|| [x.sin(), x.cos()])
}

/// Returns sine and cosine of an expression if their values are known without evaluating the functions.
fn known_sine_cosine(x: Expr<'_>, depth: usize) -> Option<[Expr<'_>; 2]> {
    let depth = depth.checked_sub(1)?;
    let expression_of_id = |id| x.graph().expr(id);
    let one = x.num(1.0);
    match x.node() {
        Node::Const(value) => exact_sine_and_cosine(value).map(|point| point.map(|c| x.num(c))),
        Node::Neg(a) => known_sine_cosine(expression_of_id(a), depth).map(|[sin, cos]| [-sin, cos]),
        Node::Add(a, b) => sine_cosine_of_sum(expression_of_id(a), expression_of_id(b), one, depth),
        Node::Sub(a, b) => sine_cosine_of_sum(expression_of_id(a), expression_of_id(b), -one, depth),
        Node::Call(Function::Asin, a) => {
            Some([expression_of_id(a), (one - expression_of_id(a).square()).sqrt()])
        }
        Node::Call(Function::Acos, a) => {
            Some([(one - expression_of_id(a).square()).sqrt(), expression_of_id(a)])
        }
        Node::Call(Function::Atan, a) => {
            let length = (one + expression_of_id(a).square()).sqrt();
            Some([expression_of_id(a) / length, one / length])
        }
        Node::Atan2(y, x) => {
            let length = (expression_of_id(x).square() + expression_of_id(y).square()).sqrt();
            Some([expression_of_id(y) / length, expression_of_id(x) / length])
        }
        _ => None,
    }
}

/// Returns sine and cosine of `a ± b`, with the given sign, if the sines and cosines of `a` or `b` are known.
fn sine_cosine_of_sum<'g>(a: Expr<'g>, b: Expr<'g>, sign: Expr<'g>, depth: usize) -> Option<[Expr<'g>; 2]> {
    let (of_a, of_b) = (known_sine_cosine(a, depth), known_sine_cosine(b, depth));
    if of_a.is_none() && of_b.is_none() {
        return None;
    }
    let [sin_a, cos_a] = of_a.unwrap_or_else(|| [a.sin(), a.cos()]);
    let [sin_b, cos_b] = of_b.unwrap_or_else(|| [b.sin(), b.cos()]);
    let sin_b = sin_b * sign;
    Some([sin_a * cos_b + cos_a * sin_b, cos_a * cos_b - sin_a * sin_b])
}

/// Returns sine and cosine of a number that is a multiple of π/6 or π/4, correct to the last digit; multiples
/// of π/2 have exact values.
fn exact_sine_and_cosine(value: f64) -> Option<[f64; 2]> {
    let twelfths = value / (PI / 12.0);
    let whole = twelfths.round();
    if (twelfths - whole).abs() > ROUNDING * whole.abs().max(1.0) || whole.abs() > 1e6 {
        return None;
    }
    let root = 0.75_f64.sqrt();
    // Sines of 0°, 15°, … 90°. Those of 15° and 75° have no simple value.
    let first = [Some(0.0), None, Some(0.5), Some(FRAC_1_SQRT_2), Some(root), None, Some(1.0)];
    let sine_of_pi_twelfths = |k: i64| {
        let k = k.rem_euclid(24);
        let (k, sign) = if k > 12 { (k - 12, -1.0) } else { (k, 1.0) };
        first[if k > 6 { 12 - k } else { k } as usize].map(|s| sign * s)
    };
    let k = whole as i64;
    Some([sine_of_pi_twelfths(k)?, sine_of_pi_twelfths(k + 6)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Graph;

    #[test]
    fn special_angles_have_exact_sines() {
        for k in -30..30 {
            let x = f64::from(k) * PI / 12.0;
            let Some([sin, cos]) = exact_sine_and_cosine(x) else {
                assert!(k % 2 != 0 && k % 3 != 0, "{k}");
                continue;
            };
            assert!((sin - x.sin()).abs() < 1e-14 && (cos - x.cos()).abs() < 1e-14, "{k}");
            assert!(k % 6 != 0 || [sin, cos].iter().all(|c| c.fract() == 0.0), "{k}");
        }
        assert_eq!(exact_sine_and_cosine(0.3), None);
    }

    #[test]
    fn inverse_functions_cancel_functions() {
        let g = Graph::new();
        let (x, y) = (g.symbol(Symbol(0)), g.symbol(Symbol(1)));
        let fold_expression = |e| substitute_with_exact_sines(&[e], &|_| None)[0];
        assert_eq!(fold_expression(x.apply_function(Function::Acos).cos()), x);
        assert_eq!(fold_expression((-x.apply_function(Function::Asin)).sin()), -x);
        assert_eq!(fold_expression((y - y.num(PI)).sin()), -y.sin());
        let value_at_sample_point =
            |e| crate::expr::eval::eval_one(e, &|s| if s == Symbol(0) { 0.3 } else { 0.8 });
        for e in [
            (x.apply_function(Function::Acos) + y).sin(),
            y.atan2(x).cos(),
            (x.num(PI / 3.0) - x.apply_function(Function::Atan)).sin(),
            x.apply_function(Function::Asin).apply_function(Function::Tan),
            (x + y).cos(),
        ] {
            assert!(
                (value_at_sample_point(e) - value_at_sample_point(fold_expression(e))).abs() < 1e-15,
                "{e:?}"
            );
        }
    }
}
