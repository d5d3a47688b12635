//! Limits: what a coordinate, its velocity and the force on it stay within.

use super::arguments::Arguments;
use super::{Description, Limit, Name};
use crate::diag::Diagnostics;

const KEYS: [&str; 5] = ["on", "from", "to", "max_speed", "max_effort"];

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
    description.limits.push(Limit { name, on, from, to, max_speed, max_effort });
}
