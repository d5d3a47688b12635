//! Limits: bounds of a coordinate, its velocity and its force.

use super::arguments::Arguments;
use super::contact::take_restitution;
use super::{Description, Limit, Name};
use crate::diag::Diagnostics;

const KEYS: [&str; 6] = ["on", "from", "to", "max_speed", "max_effort", "restitution"];

/// Reads a limit.
pub fn read_limit(
    name: Name,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let on = arguments.need_expr("on", "joint", "limit", &KEYS, cx);
    let mut take = |key: &str| arguments.take_expr(key, cx);
    let (from, to) = (take("from"), take("to"));
    let (max_speed, max_effort) = (take("max_speed"), take("max_effort"));
    let restitution = take_restitution(arguments, cx);
    let is_empty = arguments.is_empty();
    arguments.finish("a Limit", &KEYS, cx);
    let Some(on) = on else { return };
    if [&from, &to, &max_speed, &max_effort].iter().all(|bound| bound.is_none()) {
        if is_empty {
            cx.error(name.place.clone(), format!("the limit `{}` bounds nothing", name.text))
                .help("write what it bounds: `from = …`, `to = …`, `max_speed = …`, `max_effort = …`");
        }
        return;
    }
    if let (Some(e), None, None) = (&restitution, &from, &to) {
        cx.error(e.value.place.clone(), "there is no bound to strike")
            .help("write where it is: `from = …`, `to = …`, or both");
        return;
    }
    description.limits.push(Limit { name, on, from, to, max_speed, max_effort, restitution });
}
