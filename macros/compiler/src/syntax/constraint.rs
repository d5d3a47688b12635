//! Constraints: equations that stay fulfilled, surfaces that touch.

use super::arguments::Arguments;
use super::{Constraint, ConstraintKind, Description, Name, SlipFriction};
use crate::diag::Diagnostics;

/// An equation or an expression that stays zero, or a pair of surfaces.
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
    let (whose, example) = match kind {
        ConstraintKind::Holonomic => {
            ("a Holonomic constraint", "#[constraint(norm(r(tip / base)) = length)]")
        }
        ConstraintKind::Nonholonomic => {
            ("a Nonholonomic constraint", "#[constraint(dot(v(skate / ground / ground), sled.y) = 0)]")
        }
        ConstraintKind::Rolling => {
            ("a Rolling constraint", "#[constraint(rolls(disk.circle(radius, y), ground.plane(z)))]")
        }
        ConstraintKind::Slipping => (
            "a Slipping constraint",
            "#[constraint(slips(disk.circle(radius, y), ground.plane(z)), friction = mu)]",
        ),
    };
    if let (Some((value, None)), [second, ..]) = (&found, arguments.plain()) {
        let touches = matches!(kind, ConstraintKind::Rolling | ConstraintKind::Slipping);
        let (message, help) = match touches {
            true => (format!("expected a pair that {}", kind.verb()), format!("write `{example}`")),
            false => {
                let help = format!("write `{} = {}`", value.spelt(), second.spelt());
                ("expected one equation".to_string(), help)
            }
        };
        cx.error(value.place.to(&second.place), message).help(help);
        return;
    }
    let is_empty = arguments.is_empty();
    arguments.finish(whose, keys, cx);
    let Some((value, other)) = found else {
        if is_empty {
            cx.error(name.place.clone(), format!("`{}` says nothing", name.text))
                .help(format!("write `{example}`"));
        }
        return;
    };
    if let (ConstraintKind::Rolling | ConstraintKind::Slipping, Some(other)) = (kind, &other) {
        cx.error(other.place.clone(), "a pair of surfaces is no equation").help(format!("write `{example}`"));
        return;
    }
    description.constraints.push(Constraint { name, kind, value, other, friction });
}
