//! Readable examples of the effect of each pass on a small program.

use super::{CHAIN, FACTOR, FUSE, NEGATIONS, Pass, REASSOCIATE, SCHEDULE, SHARE_SUBSUMS};
use crate::expr::{Expr, Graph, Symbol};
use crate::lower::{Program, lower};

const NAMES: [&str; 8] = ["a", "b", "c", "d", "e", "f", "x", "y"];

fn symbol_name(symbol: Symbol) -> String {
    NAMES[symbol.0 as usize].to_string()
}

/// Returns a program to which no pass has been applied, built from expressions one operation at a time.
fn select_without_passes(outputs: impl for<'g> Fn([Expr<'g>; 8]) -> Vec<Expr<'g>>) -> Program {
    let g = Graph::new();
    let symbols = std::array::from_fn(|k| g.symbol(Symbol(k as u32)));
    crate::lower::select_instructions(&outputs(symbols), &|_| false)
}

/// Returns the texts before and after a pass, and checks that both programs return the same values.
fn texts_around_pass(pass: &Pass, mut program: Program) -> [Vec<String>; 2] {
    program.counts = program.count_operations();
    let after = program.clone().run_passes(&[*pass]);
    let test_number_of_symbol = |s: Symbol| 0.7 + 0.3 * f64::from(s.0);
    for (a, b) in program
        .interpret_program(&test_number_of_symbol)
        .iter()
        .zip(after.interpret_program(&test_number_of_symbol))
    {
        assert!((a - b).abs() <= 1e-13 * a.abs().max(1.0), "{}: {a} and {b}", pass.name);
    }
    [program, after].map(|p| p.program_text(&symbol_name).lines().map(ToString::to_string).collect())
}

#[test]
fn factor_pass_extracts_common_factors() {
    let [before, after] =
        texts_around_pass(&FACTOR, select_without_passes(|[a, b, c, d, ..]| vec![a * b + c * a + a * d]));
    assert_eq!(before, ["t0 = a * b", "t1 = a * c", "t2 = t0 + t1", "t3 = a * d", "t4 = t2 + t3", "-> t4"]);
    assert_eq!(after, ["t0 = b + c", "t1 = t0 + d", "t2 = a * t1", "-> t2"]);
}

#[test]
fn negations_pass_reduces_negations() {
    let [before, after] =
        texts_around_pass(&NEGATIONS, select_without_passes(|[a, b, c, d, ..]| vec![-((a - b) * c) * d]));
    assert_eq!(before, ["t0 = a - b", "t1 = c * t0", "t2 = d * t1", "t3 = -t2", "-> t3"]);
    assert_eq!(after, ["t0 = b - a", "t1 = c * t0", "t2 = d * t1", "-> t2"]);
}

#[test]
fn chain_pass_begins_sums_with_products() {
    let [before, after] =
        texts_around_pass(&CHAIN, select_without_passes(|[a, b, c, d, e, ..]| vec![a + (b * c + d * e)]));
    assert_eq!(before, ["t0 = b * c", "t1 = d * e", "t2 = t0 + t1", "t3 = a + t2", "-> t3"]);
    assert_eq!(after, ["t0 = b * c", "t1 = a + t0", "t2 = d * e", "t3 = t1 + t2", "-> t3"]);
}

#[test]
fn share_subsums_pass_shares_common_terms() {
    let program = select_without_passes(|[a, b, c, d, e, ..]| vec![(a + c) + b, (a + d) + b, (b + e) + a]);
    let [before, after] = texts_around_pass(&SHARE_SUBSUMS, program);
    assert_eq!(before.len(), 7);
    assert_eq!(after, ["t0 = a + b", "t1 = c + t0", "t2 = d + t0", "t3 = e + t0", "-> t1, t2, t3"]);
}

#[test]
fn reassociate_pass_adds_late_terms_last() {
    let [before, after] =
        texts_around_pass(&REASSOCIATE, select_without_passes(|[a, b, c, d, e, ..]| vec![a / b + c + d + e]));
    assert_eq!(before, ["t0 = a / b", "t1 = c + t0", "t2 = d + t1", "t3 = e + t2", "-> t3"]);
    assert_eq!(after, ["t0 = c + d", "t1 = t0 + e", "t2 = a / b", "t3 = t1 + t2", "-> t3"]);
}

#[test]
fn fuse_pass_forms_multiply_add_instructions() {
    let [_, after] = texts_around_pass(
        &FUSE,
        select_without_passes(|[a, b, c, d, e, ..]| vec![a * b + c, a - d * e, (a * d) * (a * d) - b]),
    );
    assert_eq!(
        after,
        [
            "t0 = fused a * b + c",
            "t1 = fused a - d * e",
            "t2 = a * d",
            "t3 = fused t2 * t2 - b",
            "-> t0, t1, t3"
        ]
    );
}

#[test]
fn schedule_pass_reorders_instructions() {
    let [before, after] =
        texts_around_pass(&SCHEDULE, select_without_passes(|[a, b, c, d, ..]| vec![c + d, a / b / c / d]));
    assert_eq!(before, ["t0 = c + d", "t1 = a / b", "t2 = t1 / c", "t3 = t2 / d", "-> t0, t3"]);
    assert_eq!(after, ["t0 = a / b", "t1 = c + d", "t2 = t0 / c", "t3 = t2 / d", "-> t1, t3"]);
}

/// Applies all passes, in the order of the pipeline, to an equation of motion like a pendulum's.
#[test]
fn whole_pipeline_compiles_an_equation_of_motion() {
    let g = Graph::new();
    let [m, l, gravity, q, v, tau] = std::array::from_fn(|k| g.symbol(Symbol(k as u32)));
    let acceleration = (tau - m * gravity * l * q.sin() - v) / (m * l * l);
    let program = lower(&[acceleration]).run_passes(super::FINISH);
    let text = program.program_text(&symbol_name);
    let expected = [
        "t0 = a * c",
        "t1 = a * b",
        "t2 = f - e",
        "t3 = sin(d)",
        "t4 = b * t0",
        "t5 = b * t1",
        "t6 = fused t2 - t4 * t3",
        "t7 = t6 / t5",
        "-> t7",
    ];
    assert_eq!(text.lines().collect::<Vec<_>>(), expected);
}
