//! Parsing of joint declarations: ends, axes and pitch.

use super::arguments::Arguments;
use super::{Endpoint, Expr, ExprKind, Joint, Name, words};
use crate::diag::Diagnostics;
use crate::language::{BodyOrInertiaMethod, JointKind};

/// Reads the declaration of a joint from its attribute.
pub fn read_joint(
    name: &Name,
    kind: JointKind,
    arguments: &mut Arguments,
    cx: &mut Diagnostics,
) -> Option<Joint> {
    let ends = arguments.require_joint_relation(&["about", "along", "pitch", "lead", "branch"], cx);
    let about = read_axes("about", arguments, cx);
    let along = read_axes("along", arguments, cx);
    let pitch = arguments.take_expression_of_key("pitch", cx);
    let lead = arguments.take_expression_of_key("lead", cx);
    let branch = arguments.take_expression_of_key("branch", cx);
    let allowed = kind.row().arguments;
    for key in ["about", "along", "pitch", "lead"] {
        if let Some(place) = arguments.span_of_taken_key(key)
            && !allowed.contains(&key)
        {
            let list: Vec<String> = allowed.iter().map(|k| format!("`{k}`")).collect();
            let help = if list.is_empty() {
                "it has no axis".to_string()
            } else {
                format!("expected {}", crate::diag::join_with_or(&list))
            };
            cx.report_error(place, format!("{} has no argument `{key}`", kind.name_with_article()))
                .add_help(help);
        }
    }
    arguments.report_remaining_arguments(&kind.name_with_article(), allowed, cx);
    let (parent, child) = ends?;
    let (about, along) = (about?, along?);
    Some(Joint {
        name: name.clone(),
        kind,
        parent: read_joint_endpoint(parent, cx)?,
        child: read_joint_endpoint(child, cx)?,
        about,
        along,
        pitch,
        lead,
        normalise_axis: false,
        mimic: None,
        damping: None,
        friction: None,
        branch,
        driven: false,
        initial: Vec::new(),
    })
}

/// Reads one or several axes. Three numbers in parentheses are an error: a vector has brackets.
fn read_axes(key: &str, arguments: &mut Arguments, cx: &mut Diagnostics) -> Option<Vec<Expr>> {
    let axes = arguments.take_list(key, cx);
    let numbers: Option<Vec<f64>> = axes.iter().map(Expr::literal_number).collect();
    let Some([a, b, c]) = numbers.as_deref() else { return Some(axes) };
    let axis = match [*a, *b, *c] {
        [1.0, 0.0, 0.0] => "x".to_string(),
        [0.0, 1.0, 0.0] => "y".to_string(),
        [0.0, 0.0, 1.0] => "z".to_string(),
        [-1.0, 0.0, 0.0] => "-x".to_string(),
        [0.0, -1.0, 0.0] => "-y".to_string(),
        [0.0, 0.0, -1.0] => "-z".to_string(),
        _ => format!("[{a}, {b}, {c}]"),
    };
    let place = axes[0].place.extend_to_end_of(&axes[2].place);
    cx.report_error(place, "expected a direction, found three numbers")
        .add_help(format!("write `{key} = {axis}`"));
    None
}

/// Reads an end of a joint: `body`, `body.at(v)`, `body.rotated(…)`, `body.at(v).rotated(…)`.
fn read_joint_endpoint(e: Expr, cx: &mut Diagnostics) -> Option<Endpoint> {
    match e.kind {
        ExprKind::Name(text) => {
            Some(Endpoint { body: Name { text, place: e.place }, at: None, rotated: Vec::new() })
        }
        ExprKind::Method(inner, method, mut arguments) => {
            let mut end = read_joint_endpoint(*inner, cx)?;
            match method.id {
                Some(BodyOrInertiaMethod::At)
                    if arguments.len() == 1 && end.at.is_none() && end.rotated.is_empty() =>
                {
                    end.at = arguments.pop();
                    Some(end)
                }
                Some(BodyOrInertiaMethod::At) if arguments.len() == 1 => {
                    cx.report_error(method.place, "`.at(…)` is allowed once, before `.rotated(…)`")
                        .add_help("write `body.at(a + b).rotated(z(angle))`");
                    None
                }
                Some(BodyOrInertiaMethod::At) => {
                    let help = match arguments.as_slice() {
                        [a, b, c] => {
                            format!(
                                "write `.at([{}, {}, {}])`",
                                a.short_source_text(),
                                b.short_source_text(),
                                c.short_source_text()
                            )
                        }
                        _ => "write `body.at(length * x)`".to_string(),
                    };
                    cx.report_error(method.place, "expected one vector in `.at(…)`").add_help(help);
                    None
                }
                Some(BodyOrInertiaMethod::Rotated) if !arguments.is_empty() => {
                    end.rotated.extend(arguments);
                    Some(end)
                }
                Some(BodyOrInertiaMethod::Rotated) => {
                    cx.report_error(method.place, "`.rotated()` has no rotation")
                        .add_help("write `body.rotated(z(angle))`");
                    None
                }
                Some(BodyOrInertiaMethod::Collision | BodyOrInertiaMethod::Surface(_)) | None => {
                    let other = method.text.as_str();
                    let error =
                        cx.report_error(method.place, format!("unknown method `.{other}(…)` of a body"));
                    words::suggest_meaning_or_known_word(error, words::METHODS, other, &["at", "rotated"]);
                    None
                }
            }
        }
        kind => {
            let help = match kind {
                ExprKind::Field(base, _) | ExprKind::Binary(_, base, ..) if base.as_name().is_some() => {
                    format!("a point of a body is written `{}.at(vector)`", base.short_source_text())
                }
                _ => "write `ground -> cart`, `arm.at(length * x) -> hand`".to_string(),
            };
            cx.report_error(e.place, "expected a body").add_help(help);
            None
        }
    }
}
