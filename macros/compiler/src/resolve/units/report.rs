//! Errors for contradictory units: one error per cause, with the other uses in notes.

use super::infer::{
    DimensionEqualityReason, DimensionMismatch, EquationOrigin, Inference, UnitMeaningOfName,
};
use super::owner::{location_text_of_expression, solid_containing_argument};
use super::si::describe_dimension;
use crate::diag::{Diagnostic, Diagnostics};
use crate::language::Builtin;
use crate::language::dimension::{Dimension, UnknownDimensionIndex};
use crate::syntax::{BinaryOp, Description, Expr, ExprKind};

/// Maximum number of other uses of a parameter shown for an error.
const MAX_PLACES: usize = 2;

/// Reports the contradictions. Each parameter, and each solid with its arguments, is reported once, because
/// further contradictions most likely have the same cause.
pub fn report_unit_contradictions(d: &Description, inference: &mut Inference<'_>, cx: &mut Diagnostics) {
    let mut shown: Vec<UnknownDimensionIndex> = Vec::new();
    let mut solids: Vec<&Expr> = Vec::new();
    for mismatch in std::mem::take(&mut inference.mismatches) {
        let mut names = Vec::new();
        collect_names_of_equation(&mismatch.origin, inference, &mut names);
        if names.iter().any(|(v, _)| shown.contains(v)) {
            continue;
        }
        shown.extend(names.iter().map(|(v, _)| *v));
        let solid = solid_containing_argument(d, mismatch.origin.expression);
        if let Some((call, _)) = &solid {
            if solids.iter().any(|known| std::ptr::eq(*known, *call)) {
                continue;
            }
            solids.push(call);
        }
        let error = match names.as_slice() {
            [(v, e)] => parameter_dimension_error(d, &mismatch, *v, e, inference),
            _ => None,
        };
        let error = error.or_else(|| mismatch_error(d, &mismatch, &names, inference));
        if let Some(mut error) = error {
            if let Some((_, written)) = solid {
                error.add_help(format!("write `{written}`"));
            } else if error.has_no_help() {
                error.add_help(help_for_unclear_units(d, &names));
            }
            if !names.is_empty() && contains_product_with_number(mismatch.origin.expression) {
                error.add_help(NUMBER_WITH_UNIT);
            }
            cx.add_diagnostic(error);
        }
    }
}

/// Help on a number with a unit that multiplies a parameter.
const NUMBER_WITH_UNIT: &str = "a number next to a parameter is dimensionless; a number with a unit is a \
                                parameter or a definition: `#[define(9.81)] g: Scalar`";

/// Whether an expression contains a product or quotient with a number.
fn contains_product_with_number(e: &Expr) -> bool {
    e.all_subexpressions().into_iter().any(|part| match &part.kind {
        ExprKind::Binary(BinaryOp::Mul | BinaryOp::Div, a, b, _) => {
            has_no_names_but_pi(a) || has_no_names_but_pi(b)
        }
        _ => false,
    })
}

/// Whether an expression contains no name except pi.
fn has_no_names_but_pi(e: &Expr) -> bool {
    e.all_subexpressions().into_iter().all(|part| match &part.kind {
        ExprKind::Name(name) => Builtin::find_by_name(name) == Some(Builtin::Pi),
        ExprKind::Number(_) | ExprKind::Neg(_) | ExprKind::Binary(..) | ExprKind::Call(..) => true,
        ExprKind::Field(..)
        | ExprKind::Method(..)
        | ExprKind::Tuple(_)
        | ExprKind::Array(_)
        | ExprKind::Text(_) => false,
    })
}

/// Returns the help if it is unclear which quantity is wrong; mentions the definitions among them.
fn help_for_unclear_units(d: &Description, names: &[(UnknownDimensionIndex, &Expr)]) -> String {
    let is_definition_name =
        |name: &&str| d.definitions.iter().any(|definition| definition.name.text == **name);
    let defined: Vec<String> = names
        .iter()
        .map(|(_, e)| text_of_name(e))
        .filter(is_definition_name)
        .map(|name| format!("`{name}`"))
        .collect();
    let other_places = match defined.split_last() {
        None => String::new(),
        Some((last, [])) => format!(" here or in {last}"),
        Some((last, others)) => format!(" here or in {} or {last}", others.join(", ")),
    };
    format!(
        "a factor is missing{other_places}, or one parameter is used for two quantities: use another \
         parameter"
    )
}

/// Collects the names in the expressions of an equation; the compared expressions are first.
fn collect_names_of_equation<'a>(
    origin: &EquationOrigin<'a>,
    inference: &Inference<'_>,
    found: &mut Vec<(UnknownDimensionIndex, &'a Expr)>,
) {
    origin.compared_with.iter().for_each(|e| collect_parameters_and_definitions(e, inference, found));
    if let (ExprKind::Binary(_, left, right, _), DimensionEqualityReason::Sum(_)) =
        (&origin.expression.kind, origin.reason)
    {
        let before = match &left.kind {
            ExprKind::Binary(BinaryOp::Add | BinaryOp::Sub, _, before, _) => before,
            _ => left,
        };
        collect_parameters_and_definitions(before, inference, found);
        collect_parameters_and_definitions(right, inference, found);
    }
    collect_parameters_and_definitions(origin.expression, inference, found);
}

/// Collects the parameters and definitions in an expression, each at its first occurrence.
fn collect_parameters_and_definitions<'a>(
    e: &'a Expr,
    inference: &Inference<'_>,
    found: &mut Vec<(UnknownDimensionIndex, &'a Expr)>,
) {
    let mut collect_in_subexpression = |e: &'a Expr| collect_parameters_and_definitions(e, inference, found);
    match &e.kind {
        ExprKind::Number(_) | ExprKind::Text(_) => {}
        ExprKind::Name(name) => {
            if let Some(UnitMeaningOfName::Named(v, _)) = inference.names.get(name)
                && found.iter().all(|(known, _)| known != v)
            {
                found.push((*v, e));
            }
        }
        ExprKind::Field(base, _) | ExprKind::Neg(base) => collect_in_subexpression(base),
        ExprKind::Method(base, _, arguments) => {
            collect_in_subexpression(base);
            arguments.iter().for_each(collect_in_subexpression);
        }
        ExprKind::Call(_, arguments) | ExprKind::Tuple(arguments) | ExprKind::Array(arguments) => {
            arguments.iter().for_each(collect_in_subexpression);
        }
        ExprKind::Binary(_, a, b, _) => {
            collect_in_subexpression(a);
            collect_in_subexpression(b);
        }
    }
}

/// Returns the error for a parameter that would need two dimensions.
fn parameter_dimension_error(
    d: &Description,
    mismatch: &DimensionMismatch<'_>,
    v: UnknownDimensionIndex,
    here: &Expr,
    inference: &mut Inference<'_>,
) -> Option<Diagnostic> {
    let name = text_of_name(here);
    let is = inference.system.substitute_solved_unknowns(&Dimension::unknown_dimension(v))?;
    let (found, expected) = (
        inference.system.substitute_solved_unknowns(&mismatch.found)?,
        inference.system.substitute_solved_unknowns(&mismatch.expected)?,
    );
    // The expected dimension requires that of the parameter to change by this power of the quotient.
    let power = mismatch
        .found
        .exponent_of_unknown(v)
        .checked_sum(mismatch.expected.exponent_of_unknown(v).negative_ratio())?;
    let needed = is.times_power(&expected.dimension_of_quotient(&found)?, power.inverse()?)?;
    let first = inference.origins.get(&v).copied()?;
    if !is.is_known() || !needed.is_known() {
        return None;
    }
    let (is, needed) = (describe_dimension(&is), describe_dimension(&needed));
    if first.reason == DimensionEqualityReason::Unit {
        let message = format!("`{name}` is declared as {is}, but used as {needed}");
        let mut error = Diagnostic::new(first.expression.place.clone(), message);
        error.add_note(format!("it is {needed}{}", location_text_of_expression(d, here)));
        return Some(error);
    }
    let mut error =
        Diagnostic::new(here.place.clone(), format!("`{name}` is {needed} here, but {is} elsewhere"));
    add_unit_origin_note(d, here, v, &is, first, inference, &mut error);
    Some(error)
}

/// Returns the error for quantities of different units, at the operator between them, with the origin of each
/// unit.
fn mismatch_error(
    d: &Description,
    mismatch: &DimensionMismatch<'_>,
    names: &[(UnknownDimensionIndex, &Expr)],
    inference: &mut Inference<'_>,
) -> Option<Diagnostic> {
    let (found, expected) = (
        inference.system.substitute_solved_unknowns(&mismatch.found),
        inference.system.substitute_solved_unknowns(&mismatch.expected),
    );
    let (found, expected) = (found?, expected?);
    let place = match (&mismatch.origin.expression.kind, mismatch.origin.reason) {
        (ExprKind::Binary(.., operator), DimensionEqualityReason::Sum(_)) => operator,
        _ => &mismatch.origin.expression.place,
    };
    let mut diagnostic = Diagnostic::new(place.clone(), mismatch_message(mismatch, &found, &expected));
    if names.is_empty() {
        diagnostic.add_help(
            "multiply one of them by a factor, as in `2 * x`: a number that multiplies only coordinates, \
             rates or inputs takes the missing unit",
        );
    }
    for (v, e) in names.iter().take(MAX_PLACES) {
        let is = inference
            .system
            .substitute_solved_unknowns(&Dimension::unknown_dimension(*v))
            .filter(Dimension::is_known);
        if let (Some(is), Some(origin)) = (is, inference.origins.get(v).copied()) {
            add_unit_origin_note(d, e, *v, &describe_dimension(&is), origin, inference, &mut diagnostic);
        }
    }
    Some(diagnostic)
}

/// Adds a note on the use that determined the dimension of a parameter or a definition.
fn add_unit_origin_note(
    d: &Description,
    here: &Expr,
    v: UnknownDimensionIndex,
    is: &str,
    origin: EquationOrigin<'_>,
    inference: &Inference<'_>,
    diagnostic: &mut Diagnostic,
) {
    let mut names = Vec::new();
    collect_names_of_equation(&origin, inference, &mut names);
    let name = text_of_name(here);
    match names.iter().find(|(known, _)| *known == v) {
        Some((_, e)) => diagnostic.add_note(format!("`{name}` is {is}{}", location_text_of_expression(d, e))),
        None => diagnostic
            .add_note(format!("`{name}` becomes {is}{}", location_text_of_expression(d, origin.expression))),
    };
}

/// Returns the text of an expression that is a name; empty for other expressions.
fn text_of_name(e: &Expr) -> &str {
    if let ExprKind::Name(name) = &e.kind { name } else { "" }
}

fn mismatch_message(mismatch: &DimensionMismatch<'_>, found: &Dimension, expected: &Dimension) -> String {
    let reason = mismatch.origin.reason;
    if !found.is_known() || !expected.is_known() {
        let factor = found
            .dimension_of_quotient(expected)
            .filter(Dimension::is_known)
            .map_or(String::new(), |d| format!(": they differ by {}", super::si::unit_of_dimension(&d)));
        return match reason {
            DimensionEqualityReason::Sum(_) => format!("these terms cannot have one unit{factor}"),
            _ => format!("this cannot have the unit that is needed here{factor}"),
        };
    }
    let (found, expected) = (describe_dimension(found), describe_dimension(expected));
    match reason {
        DimensionEqualityReason::Sum(BinaryOp::Sub) => {
            format!("{found} cannot be subtracted from {expected}")
        }
        DimensionEqualityReason::Sum(_) => format!("{found} cannot be added to {expected}"),
        DimensionEqualityReason::Components => {
            format!("this component is {found}, but another is {expected}")
        }
        DimensionEqualityReason::Pieces => format!("this piece is {found}, but the other is {expected}"),
        DimensionEqualityReason::Compared(function) => {
            format!("`{function}` cannot compare {expected} with {found}")
        }
        DimensionEqualityReason::Argument => format!("expected a plain number or an angle, found {found}"),
        DimensionEqualityReason::Unit | DimensionEqualityReason::Place => {
            format!("expected {expected}, found {found}")
        }
    }
}
