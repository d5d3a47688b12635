//! Constraints: equations, and surfaces in contact.

use super::arguments::Arguments;
use super::{Constraint, ConstraintKind, Description, Name, SlipFriction};
use crate::diag::Diagnostics;

/// Reads an equation, an expression that remains zero, or a pair of surfaces.
pub fn read_constraint(
    name: Name,
    kind: ConstraintKind,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let slips = kind == ConstraintKind::Slipping;
    let keys: &[&str] = if slips { &["friction", "speed"] } else { &[] };
    let speed = if slips { arguments.take_expr("speed", cx) } else { None };
    let coefficient =
        if slips { arguments.need_expr("friction", "mu", "constraint", keys, cx) } else { None };
    let friction = coefficient.map(|coefficient| SlipFriction { coefficient, speed });
    let found = arguments.take_equation();
    let element = kind.element();
    let (whose, example) = (format!("a {} constraint", element.name()), element.row().example);
    if let (Some((value, None)), [second, ..]) = (&found, arguments.plain()) {
        let (message, help) = match kind.pair() {
            Some(pair) => (format!("expected a pair that {}", pair.verb()), format!("write `{example}`")),
            None => {
                let help = format!("write `{} = {}`", value.to_source(), second.to_source());
                ("expected one equation".to_string(), help)
            }
        };
        cx.error(value.place.join(&second.place), message).help(help);
        return;
    }
    let is_empty = arguments.is_empty();
    arguments.finish(&whose, keys, cx);
    let Some((value, other)) = found else {
        if is_empty {
            cx.error(name.place.clone(), format!("`{}` says nothing", name.text))
                .help(format!("write `{example}`"));
        }
        return;
    };
    if let (Some(_), Some(other)) = (kind.pair(), &other) {
        cx.error(other.place.clone(), "a pair of surfaces is no equation").help(format!("write `{example}`"));
        return;
    }
    description.constraints.push(Constraint { name, kind, value, other, friction });
}
