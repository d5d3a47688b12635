//! Parsing of force elements with their targets and laws.

use super::arguments::Arguments;
use super::keys::{ElementArgumentKeys, check_argument_relations};
use super::{Action, Expr, ExprKind, Name, Target};
use crate::diag::Diagnostics;
use crate::language::{ForceKind, Key};

/// Reads a force element according to its row in the table.
pub fn read_force_element(
    name: &Name,
    kind: ForceKind,
    arguments: &mut Arguments,
    cx: &mut Diagnostics,
) -> Option<Action> {
    let (row, names) = (kind.row(), &kind.argument_names());
    let refused = arguments.span_of_key("between").is_some() && !row.between;
    let on = read_target(kind, arguments, names, cx);
    if refused {
        return None;
    }
    reject_second_law(arguments, row.laws, cx);
    let keys = ElementArgumentKeys {
        all: row.arguments,
        laws: row.laws,
        required: row.required,
        attribute: "acts",
        names,
    };
    let (given, is_complete) = keys.read_element_arguments(arguments, cx);
    check_argument_relations(row.relations, &given, name, cx);
    arguments.report_remaining_arguments(&kind.name_with_article(), names, cx);
    is_complete.then_some(())?;
    Some(Action { name: name.clone(), kind, on: on?, arguments: given })
}

/// Reports ends with the syntax of a joint, or without keys. Returns true if there are any.
fn report_unnamed_target(kind: ForceKind, arguments: &mut Arguments, cx: &mut Diagnostics) -> bool {
    let (on, spans) = (kind.row().on, kind.row().between);
    let between_help = |a: &Expr, b: &Expr| match spans {
        true => format!("write `between = ({}, {})`", a.short_source_text(), b.short_source_text()),
        false => "say what it acts on: `on = …`".to_string(),
    };
    if let Some((a, b)) = arguments.take_arrow_relation() {
        cx.report_error(
            a.place.extend_to_end_of(&b.place),
            format!("{} is not a joint", kind.name_with_article()),
        )
        .add_help(between_help(&a, &b));
        return true;
    }
    if arguments.span_of_key("on").is_some() || arguments.span_of_key("between").is_some() {
        return false;
    }
    if let Some((place, a, b)) = arguments.take_ends_with_own_keys() {
        cx.report_error(place, format!("{} has no such ends", kind.name_with_article()))
            .add_help(between_help(&a, &b));
        return true;
    }
    let plain = arguments.positional_arguments();
    let (Some(first), Some(last)) = (plain.first(), plain.last()) else { return false };
    let help = match plain {
        [one] if on => format!("write `on = {}`", one.short_source_text()),
        [a, b, ..] => between_help(a, b),
        _ => "write `between = (first, second)`".to_string(),
    };
    cx.report_error(first.place.extend_to_end_of(&last.place), "expected `name = value`").add_help(help);
    arguments.take_positional_arguments();
    true
}

/// Reads `on = …`, or `between = (…, …)` if the element can act between two points.
fn read_target(
    kind: ForceKind,
    arguments: &mut Arguments,
    keys: &[&str],
    cx: &mut Diagnostics,
) -> Option<Target> {
    let row = kind.row();
    if report_unnamed_target(kind, arguments, cx) {
        return None;
    }
    let Some(place) = arguments.span_of_key("between") else {
        if !row.on {
            return arguments.require_expression("between", "(first, second)", "acts", keys, cx).and(None);
        }
        let on = arguments.require_expression("on", "joint", "acts", keys, cx)?;
        let (ExprKind::Tuple(ends) | ExprKind::Array(ends)) = &on.kind else {
            return Some(Target::On(on));
        };
        let help = match ends.as_slice() {
            [a, b] if row.between => {
                format!("write `between = ({}, {})`", a.short_source_text(), b.short_source_text())
            }
            _ => "declare a field for each thing that it acts on".to_string(),
        };
        cx.report_error(on.place, "`on` names one thing, found a list").add_help(help);
        return None;
    };
    if !row.between {
        cx.report_error(place, format!("{} does not act between two points", kind.name_with_article()))
            .add_help("say what it acts on: `on = …`");
        arguments.remove_all_keys();
        return None;
    }
    if let Some(on) = arguments.span_of_key("on") {
        cx.report_error(on, "an element has either `on` or `between`")
            .add_help("`on` names a joint, `between` two points");
        arguments.remove_key("on");
    }
    match arguments.take_expression_of_key("between", cx)? {
        Expr { kind: ExprKind::Tuple(mut ends), .. } if ends.len() == 2 => {
            let second = ends.pop()?;
            Some(Target::Between(ends.pop()?, second))
        }
        other => {
            let second = arguments.take_end_of_bare_pair(&other);
            let help = match &other.kind {
                _ if second.is_some() => {
                    let second = second.map_or_else(String::new, |second| second.short_source_text());
                    format!("write `between = ({}, {second})`", other.short_source_text())
                }
                ExprKind::Array(ends) if ends.len() == 2 => {
                    format!(
                        "write `between = ({}, {})`",
                        ends[0].short_source_text(),
                        ends[1].short_source_text()
                    )
                }
                ExprKind::Name(name) if row.on => {
                    format!("write `on = {name}`, or `between = (first, second)`")
                }
                _ => "write `between = (first, second)`".to_string(),
            };
            cx.report_error(other.place, "`between` names two points").add_help(help);
            None
        }
    }
}

/// Reports a second law of an element; the first key is kept.
fn reject_second_law(arguments: &mut Arguments, keys: &[Key], cx: &mut Diagnostics) {
    let given: Vec<&str> =
        keys.iter().map(|key| key.name()).filter(|key| arguments.span_of_key(key).is_some()).collect();
    for key in given.iter().skip(1) {
        if let Some(place) = arguments.span_of_key(key) {
            let list: Vec<String> = keys.iter().map(|key| format!("`{}`", key.name())).collect();
            cx.report_error(place, format!("a second force law: `{}` is already given", given[0]))
                .add_help(format!("give one of {}", crate::diag::join_with_or(&list)));
            arguments.remove_key(key);
        }
    }
}
