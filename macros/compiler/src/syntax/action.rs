//! Force elements: what they act on, and by which law.

use super::arguments::Arguments;
use super::{Action, ActionKind, Expr, ExprKind, ForceKind, Law, Name, Target};
use crate::diag::Diagnostics;

/// Reads a force element of the type `word`.
pub fn read_action(
    name: &Name,
    (word, kind): (&str, ForceKind),
    arguments: &mut Arguments,
    cx: &mut Diagnostics,
) -> Option<Action> {
    let keys = kind.arguments();
    let refused = arguments.place_of("between").is_some() && !keys.contains(&"between");
    let on = read_target(word, arguments, keys, cx);
    if refused {
        return None;
    }
    let action = match kind {
        ForceKind::Spring => read_spring(arguments, keys, cx),
        ForceKind::Dashpot => {
            one_law(arguments, &["force", "damping"], cx);
            let force = arguments.take_expr("force", cx).map(Law::Force);
            let law =
                force.or_else(|| arguments.need_expr("damping", "c", "acts", keys, cx).map(Law::Linear));
            law.map(|law| ActionKind::Dashpot { law })
        }
        ForceKind::Inerter => arguments
            .need_expr("inertance", "b", "acts", keys, cx)
            .map(|inertance| ActionKind::Inerter { inertance }),
        ForceKind::Friction => {
            arguments.need_expr("coulomb", "f", "acts", keys, cx).map(|coulomb| ActionKind::Friction {
                coulomb,
                stiction: arguments.take_expr("stiction", cx),
                stribeck_speed: arguments.take_expr("stribeck_speed", cx),
                viscous: arguments.take_expr("viscous", cx),
                speed: arguments.take_expr("speed", cx),
            })
        }
        ForceKind::Gravity => Some(ActionKind::Gravity {
            constant: arguments.take_expr("constant", cx),
            mu: arguments.take_expr("mu", cx),
        }),
        ForceKind::Attraction => arguments
            .need_expr("strength", "k", "acts", keys, cx)
            .map(|strength| ActionKind::Attraction { strength }),
        ForceKind::Force => Some(ActionKind::Force {
            along: arguments.take_expr("along", cx),
            value: arguments.take_expr("value", cx),
        }),
        ForceKind::Torque => Some(ActionKind::Torque {
            about: arguments.take_expr("about", cx),
            value: arguments.take_expr("value", cx),
        }),
    };
    arguments.finish(&format!("{} {word}", article(word)), keys, cx);
    Some(Action { name: name.clone(), kind: action?, on: on? })
}

/// The indefinite article of a word.
pub fn article(word: &str) -> &'static str {
    if word.starts_with(['A', 'I']) { "an" } else { "a" }
}

/// Reports ends that are written as those of a joint or without their keys. True if there are any.
fn unnamed_target(kind: &str, arguments: &mut Arguments, keys: &[&str], cx: &mut Diagnostics) -> bool {
    let spans = keys.contains(&"between");
    let between = |a: &Expr, b: &Expr| match spans {
        true => format!("write `between = ({}, {})`", a.spelt(), b.spelt()),
        false => "say what it acts on: `on = …`".to_string(),
    };
    if let Some((a, b)) = arguments.take_arrow() {
        cx.error(a.place.to(&b.place), format!("{} {kind} is no joint", article(kind))).help(between(&a, &b));
        return true;
    }
    if arguments.place_of("on").is_some() || arguments.place_of("between").is_some() {
        return false;
    }
    if let Some((place, a, b)) = arguments.take_ends() {
        cx.error(place, format!("{} {kind} has no such ends", article(kind))).help(between(&a, &b));
        return true;
    }
    let plain = arguments.plain();
    let (Some(first), Some(last)) = (plain.first(), plain.last()) else { return false };
    let help = match plain {
        [one] if keys.contains(&"on") => format!("write `on = {}`", one.spelt()),
        [a, b, ..] => between(a, b),
        _ => "write `between = (first, second)`".to_string(),
    };
    cx.error(first.place.to(&last.place), "expected `name = value`").help(help);
    arguments.take_plain();
    true
}

/// `on = …`, or `between = (…, …)` where the element can span two points.
fn read_target(kind: &str, arguments: &mut Arguments, keys: &[&str], cx: &mut Diagnostics) -> Option<Target> {
    if unnamed_target(kind, arguments, keys, cx) {
        return None;
    }
    let Some(place) = arguments.place_of("between") else {
        if !keys.contains(&"on") {
            return arguments.need_expr("between", "(first, second)", "acts", keys, cx).and(None);
        }
        let on = arguments.need_expr("on", "joint", "acts", keys, cx)?;
        let (ExprKind::Tuple(ends) | ExprKind::Array(ends)) = &on.kind else {
            return Some(Target::On(on));
        };
        let help = match ends.as_slice() {
            [a, b] if keys.contains(&"between") => {
                format!("write `between = ({}, {})`", a.spelt(), b.spelt())
            }
            _ => "declare a field for each thing that it acts on".to_string(),
        };
        cx.error(on.place, "`on` names one thing, found a list").help(help);
        return None;
    };
    if !keys.contains(&"between") {
        cx.error(place, format!("{} {kind} does not act between two points", article(kind)))
            .help("say what it acts on: `on = …`");
        arguments.forget_all();
        return None;
    }
    if let Some(on) = arguments.place_of("on") {
        cx.error(on, "an element has one of `on` and `between`")
            .help("`on` names a joint, `between` two points");
        arguments.forget("on");
    }
    match arguments.take_expr("between", cx)? {
        Expr { kind: ExprKind::Tuple(mut ends), .. } if ends.len() == 2 => {
            let second = ends.pop()?;
            Some(Target::Between(ends.pop()?, second))
        }
        other => {
            let second = arguments.take_second(&other);
            let help = match &other.kind {
                _ if second.is_some() => {
                    let second = second.map_or_else(String::new, |second| second.spelt());
                    format!("write `between = ({}, {second})`", other.spelt())
                }
                ExprKind::Array(ends) if ends.len() == 2 => {
                    format!("write `between = ({}, {})`", ends[0].spelt(), ends[1].spelt())
                }
                ExprKind::Name(name) if keys.contains(&"on") => {
                    format!("write `on = {name}`, or `between = (first, second)`")
                }
                _ => "write `between = (first, second)`".to_string(),
            };
            cx.error(other.place, "`between` names two points").help(help);
            None
        }
    }
}

/// Reports a second law of one element; the first of the keys counts.
fn one_law(arguments: &mut Arguments, keys: &[&str], cx: &mut Diagnostics) {
    let given: Vec<&&str> = keys.iter().filter(|key| arguments.place_of(key).is_some()).collect();
    for key in given.iter().skip(1) {
        if let Some(place) = arguments.place_of(key) {
            let list: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
            cx.error(place, format!("a second law: `{}` is given already", given[0]))
                .help(format!("give one of {}", crate::diag::one_of(&list)));
            arguments.forget(key);
        }
    }
}

fn read_spring(arguments: &mut Arguments, keys: &[&str], cx: &mut Diagnostics) -> Option<ActionKind> {
    one_law(arguments, &["force", "energy", "stiffness"], cx);
    let force = arguments.take_expr("force", cx).map(Law::Force);
    let energy = arguments.take_expr("energy", cx).map(Law::Energy);
    let law =
        force.or(energy).or_else(|| arguments.need_expr("stiffness", "k", "acts", keys, cx).map(Law::Linear));
    let place = arguments.place_of("free_angle");
    let length = arguments.take_expr("free_length", cx);
    let angle = arguments.take_expr("free_angle", cx);
    if let (Some(_), Some(_), Some(place)) = (&length, &angle, place) {
        cx.error(place, "a spring has one of `free_length` and `free_angle`")
            .help("`free_length` goes with what slides, `free_angle` with what turns");
    }
    let is_angle = angle.is_some();
    let free = length.or(angle).map(|free| (free, is_angle));
    Some(ActionKind::Spring { law: law?, free })
}
