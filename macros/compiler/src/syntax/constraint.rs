//! Constraints, equations and surfaces in contact, and limits of coordinates.

use super::arguments::Arguments;
use super::keys::{ElementArgumentKeys, check_argument_relations};
use super::{Constraint, ConstraintKind, Description, Limit, Name};
use crate::diag::Diagnostics;
use crate::language::{Key, OtherKind};

/// Reads an equation, an expression that remains zero, or a pair of surfaces.
pub fn read_constraint(
    name: Name,
    kind: ConstraintKind,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let element = kind.catalogue_row();
    let (row, names) = (element.row(), &element.argument_names());
    let (given, _) = ElementArgumentKeys::new(element, names).read_element_arguments(arguments, cx);
    let found = arguments.take_only_equation();
    let (whose, example) = (format!("a {} constraint", row.name), row.example);
    if let (Some((value, None)), [second, ..]) = (&found, arguments.positional_arguments()) {
        let (message, help) = match kind.surface_pair_function() {
            Some(pair) => {
                (format!("expected a pair that {}", pair.rolls_or_slips_name()), format!("write `{example}`"))
            }
            None => {
                let help = format!("write `{} = {}`", value.short_source_text(), second.short_source_text());
                ("expected one equation".to_string(), help)
            }
        };
        cx.report_error(value.place.extend_to_end_of(&second.place), message).add_help(help);
        return;
    }
    let is_empty = arguments.is_empty();
    arguments.report_remaining_arguments(&whose, names, cx);
    let Some((value, other)) = found else {
        if is_empty {
            cx.report_error(name.place.clone(), format!("`{}` has no expression", name.text))
                .add_help(format!("write `{example}`"));
        }
        return;
    };
    if let (Some(_), Some(other)) = (kind.surface_pair_function(), &other) {
        cx.report_error(other.place.clone(), "a pair of surfaces is not an equation")
            .add_help(format!("write `{example}`"));
        return;
    }
    description.constraints.push(Constraint { name, kind, value, other, arguments: given });
}

/// Reads the bounds of a coordinate, its velocity and its force.
pub fn read_limit(
    name: Name,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let (row, names) = (OtherKind::Limit.row(), &OtherKind::Limit.argument_names());
    let on = arguments.require_expression("on", "joint", "limit", names, cx);
    let (given, _) = ElementArgumentKeys::new(OtherKind::Limit, names).read_element_arguments(arguments, cx);
    let is_empty = arguments.is_empty();
    arguments.report_remaining_arguments("a Limit", names, cx);
    let Some(on) = on else { return };
    if given.keyed_expressions().all(|(key, _)| key == Key::Restitution) {
        if is_empty {
            cx.report_error(name.place.clone(), format!("the limit `{}` has no bound", name.text))
                .add_help("add a bound: `from = …`, `to = …`, `max_speed = …`, `max_effort = …`");
        }
    } else if check_argument_relations(row.relations, &given, &name, cx) {
        description.limits.push(Limit { name, on, arguments: given });
    }
}
