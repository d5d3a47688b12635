//! What does not fit together: one error for each mistake, with the other places in notes.

use super::infer::{Inference, Meaning, Mismatch, Origin, Reason};
use super::owner::{place_of, solid_of};
use super::si::describe;
use crate::diag::{Diagnostic, Diagnostics};
use crate::language::Builtin;
use crate::language::dimension::{Dimension, Variable};
use crate::syntax::{BinaryOp, Description, Expr, ExprKind};

/// Most places of other uses that one mistake shows.
const MOST_PLACES: usize = 2;

/// Reports every contradiction. A parameter that was shown once is not shown again: most likely it is the
/// same mistake. So are arguments of one solid.
pub fn report(d: &Description, inference: &mut Inference<'_>, cx: &mut Diagnostics) {
    let mut shown: Vec<Variable> = Vec::new();
    let mut solids: Vec<&Expr> = Vec::new();
    for mismatch in std::mem::take(&mut inference.mismatches) {
        let mut names = Vec::new();
        names_of(&mismatch.origin, inference, &mut names);
        if names.iter().any(|(v, _)| shown.contains(v)) {
            continue;
        }
        shown.extend(names.iter().map(|(v, _)| *v));
        let solid = solid_of(d, mismatch.origin.at);
        if let Some((call, _)) = &solid {
            if solids.iter().any(|known| std::ptr::eq(*known, *call)) {
                continue;
            }
            solids.push(call);
        }
        let error = match names.as_slice() {
            [(v, e)] => one_parameter(d, &mismatch, *v, e, inference),
            _ => None,
        };
        let error = error.or_else(|| several(d, &mismatch, &names, inference));
        if let Some(mut error) = error {
            if let Some((_, written)) = solid {
                error.help(format!("write `{written}`"));
            } else if error.is_bare() {
                error.help(what_is_missing(d, &names));
            }
            if !names.is_empty() && has_number_as_factor(mismatch.origin.at) {
                error.help(NUMBER_WITH_UNIT);
            }
            cx.add(error);
        }
    }
}

/// Advice on giving a number that multiplies a parameter a unit.
const NUMBER_WITH_UNIT: &str = "a number beside a parameter is a plain factor; one with a unit is a parameter, or has a name: `#[define(9.81)] g: Scalar`";

/// True if a number multiplies or divides something in an expression.
fn has_number_as_factor(e: &Expr) -> bool {
    e.parts().into_iter().any(|part| match &part.kind {
        ExprKind::Binary(BinaryOp::Mul | BinaryOp::Div, a, b, _) => is_number(a) || is_number(b),
        _ => false,
    })
}

/// True for an expression that names nothing but pi.
fn is_number(e: &Expr) -> bool {
    e.parts().into_iter().all(|part| match &part.kind {
        ExprKind::Name(name) => Builtin::of_name(name) == Some(Builtin::Pi),
        ExprKind::Number(_) | ExprKind::Neg(_) | ExprKind::Binary(..) | ExprKind::Call(..) => true,
        ExprKind::Field(..) | ExprKind::Method(..) | ExprKind::Tuple(_) | ExprKind::Array(_) => false,
    })
}

/// What is wrong where nothing says which of the things is not what it should be: the definitions among them,
/// too.
fn what_is_missing(d: &Description, names: &[(Variable, &Expr)]) -> String {
    let is_defined = |name: &&str| d.definitions.iter().any(|definition| definition.name.text == **name);
    let defined: Vec<String> =
        names.iter().map(|(_, e)| text(e)).filter(is_defined).map(|name| format!("`{name}`")).collect();
    let or_there = match defined.split_last() {
        None => String::new(),
        Some((last, [])) => format!(" here or in {last}"),
        Some((last, others)) => format!(" here or in {} or {last}", others.join(", ")),
    };
    format!("a factor is missing{or_there}, or two things have one name: name another parameter")
}

/// The names in what an equation is about, those first that it compares.
fn names_of<'a>(origin: &Origin<'a>, inference: &Inference<'_>, found: &mut Vec<(Variable, &'a Expr)>) {
    origin.like.iter().for_each(|e| names_in(e, inference, found));
    if let (ExprKind::Binary(_, left, right, _), Reason::Sum(_)) = (&origin.at.kind, origin.reason) {
        let before = match &left.kind {
            ExprKind::Binary(BinaryOp::Add | BinaryOp::Sub, _, before, _) => before,
            _ => left,
        };
        names_in(before, inference, found);
        names_in(right, inference, found);
    }
    names_in(origin.at, inference, found);
}

/// The parameters and definitions in an expression, each once, where it first stands.
fn names_in<'a>(e: &'a Expr, inference: &Inference<'_>, found: &mut Vec<(Variable, &'a Expr)>) {
    let mut inner = |e: &'a Expr| names_in(e, inference, found);
    match &e.kind {
        ExprKind::Number(_) => {}
        ExprKind::Name(name) => {
            if let Some(Meaning::Named(v, _)) = inference.names.get(name)
                && found.iter().all(|(known, _)| known != v)
            {
                found.push((*v, e));
            }
        }
        ExprKind::Field(base, _) | ExprKind::Neg(base) => inner(base),
        ExprKind::Method(base, _, arguments) => {
            inner(base);
            arguments.iter().for_each(inner);
        }
        ExprKind::Call(_, arguments) | ExprKind::Tuple(arguments) | ExprKind::Array(arguments) => {
            arguments.iter().for_each(inner);
        }
        ExprKind::Binary(_, a, b, _) => {
            inner(a);
            inner(b);
        }
    }
}

/// One parameter that would have to be two things at once.
fn one_parameter(
    d: &Description,
    mismatch: &Mismatch<'_>,
    v: Variable,
    here: &Expr,
    inference: &mut Inference<'_>,
) -> Option<Diagnostic> {
    let name = text(here);
    let is = inference.system.resolve(&Dimension::variable(v))?;
    let (found, expected) =
        (inference.system.resolve(&mismatch.found)?, inference.system.resolve(&mismatch.expected)?);
    // To be what is expected, the parameter would have to be another thing by this power of the quotient.
    let power = mismatch.found.exponent(v).plus(mismatch.expected.exponent(v).negated())?;
    let needed = is.times_power(&expected.quotient(&found)?, power.inverse()?)?;
    let first = inference.origins.get(&v).copied()?;
    if !is.is_known() || !needed.is_known() {
        return None;
    }
    let (is, needed) = (describe(&is), describe(&needed));
    if first.reason == Reason::Unit {
        let message = format!("`{name}` is declared as {is}, but used as {needed}");
        let mut error = Diagnostic::new(first.at.place.clone(), message);
        error.note(format!("it is {needed}{}", place_of(d, here)));
        return Some(error);
    }
    let mut error =
        Diagnostic::new(here.place.clone(), format!("`{name}` is {needed} here, but {is} elsewhere"));
    show(d, here, v, &is, first, inference, &mut error);
    Some(error)
}

/// Returns the error for quantities of different units, at the operator between them, with the origin of each unit.
fn several(
    d: &Description,
    mismatch: &Mismatch<'_>,
    names: &[(Variable, &Expr)],
    inference: &mut Inference<'_>,
) -> Option<Diagnostic> {
    let (found, expected) =
        (inference.system.resolve(&mismatch.found), inference.system.resolve(&mismatch.expected));
    let (found, expected) = (found?, expected?);
    let place = match (&mismatch.origin.at.kind, mismatch.origin.reason) {
        (ExprKind::Binary(.., operator), Reason::Sum(_)) => operator,
        _ => &mismatch.origin.at.place,
    };
    let mut diagnostic = Diagnostic::new(place.clone(), message(mismatch, &found, &expected));
    if names.is_empty() {
        diagnostic.help("multiply one of them by a factor, as in `2 * x`: a number that multiplies coordinates, rates or inputs alone takes the unit that is missing");
    }
    for (v, e) in names.iter().take(MOST_PLACES) {
        let is = inference.system.resolve(&Dimension::variable(*v)).filter(Dimension::is_known);
        if let (Some(is), Some(origin)) = (is, inference.origins.get(v).copied()) {
            show(d, e, *v, &describe(&is), origin, inference, &mut diagnostic);
        }
    }
    Some(diagnostic)
}

/// Shows where a parameter or a definition has become what it is.
fn show(
    d: &Description,
    here: &Expr,
    v: Variable,
    is: &str,
    origin: Origin<'_>,
    inference: &Inference<'_>,
    diagnostic: &mut Diagnostic,
) {
    let mut names = Vec::new();
    names_of(&origin, inference, &mut names);
    let name = text(here);
    match names.iter().find(|(known, _)| *known == v) {
        Some((_, e)) => diagnostic.note(format!("`{name}` is {is}{}", place_of(d, e))),
        None => diagnostic.note(format!("`{name}` becomes {is}{}", place_of(d, origin.at))),
    };
}

/// The word of a name.
fn text(e: &Expr) -> &str {
    if let ExprKind::Name(name) = &e.kind { name } else { "" }
}

fn message(mismatch: &Mismatch<'_>, found: &Dimension, expected: &Dimension) -> String {
    let reason = mismatch.origin.reason;
    if !found.is_known() || !expected.is_known() {
        let factor = found
            .quotient(expected)
            .filter(Dimension::is_known)
            .map_or(String::new(), |d| format!(": they differ by {}", super::si::unit(&d)));
        return match reason {
            Reason::Sum(_) => format!("these terms cannot have one unit{factor}"),
            _ => format!("this cannot have the unit that is needed here{factor}"),
        };
    }
    let (found, expected) = (describe(found), describe(expected));
    match reason {
        Reason::Sum(BinaryOp::Sub) => format!("{found} cannot be subtracted from {expected}"),
        Reason::Sum(_) => format!("{found} cannot be added to {expected}"),
        Reason::Components => format!("this component is {found}, but another is {expected}"),
        Reason::Pieces => format!("this piece is {found}, but the other is {expected}"),
        Reason::Alike(function) => format!("`{function}` cannot compare {expected} with {found}"),
        Reason::Argument => format!("expected a plain number or an angle, found {found}"),
        Reason::Unit | Reason::Place => format!("expected {expected}, found {found}"),
    }
}
