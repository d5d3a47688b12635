//! Elements: the attributes of each type, and the arguments of each attribute.

use super::action::read_force_element;
use super::arguments::Arguments;
use super::constraint::{read_constraint, read_limit};
use super::contact::read_contact;
use super::expression::parse_expr;
use super::joint::read_joint;
use super::{
    Body, ConstraintKind, Definition, Description, Equilibrium, Expr, Frame, FreeCoordinate, Name, Particle,
    Point, Rank, words,
};
use crate::diag::{Diagnostics, Place, join_with_or, nearest_candidate, syn_error_with_help};
use crate::language::elements::indefinite_article;
use crate::language::{ElementKind, OtherKind};
use proc_macro2::{Span, TokenStream};
use syn::parse::{ParseStream, Parser};
use syn::spanned::Spanned;
use syn::{Attribute, Ident, LitStr, Meta, Token};

/// Names of all attributes of the language for fields.
pub const ATTRIBUTES: [&str; 17] = [
    "body",
    "particle",
    "frame",
    "point",
    "joint",
    "acts",
    "limit",
    "energy",
    "dissipation",
    "constraint",
    "contact",
    "equilibrium",
    "define",
    "speed",
    OUTPUT,
    "state",
    "unit",
];

/// Name of the attribute that marks outputs.
const OUTPUT: &str = "output";

/// Numeric types of Rust that parameters cannot have.
const RUST_NUMBERS: [&str; 12] =
    ["i8", "i16", "i32", "i64", "i128", "isize", "u8", "u16", "u32", "u64", "u128", "usize"];

/// Reports a field whose type is neither a parameter's nor an element's.
pub fn report_unknown_type(field: &Name, kind: &str, place: impl Into<Place>, cx: &mut Diagnostics) {
    if RUST_NUMBERS.contains(&kind) {
        cx.report_error(place, format!("the parameter `{}` cannot have the type `{kind}`", field.text))
            .add_help("parameters are real numbers: `f64`, `f32` or the struct's own type parameter");
    } else if matches!(kind, "" | "bool" | "char" | "str" | "String" | "Vec" | "Option") {
        cx.report_error(
            place,
            format!("field `{}` has a type that is not supported in a mechanism", field.text),
        )
        .add_help(
            "a field is a parameter (`f64`, `f32` or the struct's own type parameter) or an element \
                 (`Body`, `Pin`, …); a vector is three parameters, `[a, b, c]` in expressions",
        );
    } else {
        let types = element_type_names();
        let diagnostic = cx.report_error(place, format!("unknown element type `{kind}`"));
        let near = crate::diag::nearest_candidate(kind, &types);
        if near.is_some_and(|near| near.eq_ignore_ascii_case(kind))
            || !words::suggest_meant_element(diagnostic, kind, &types)
        {
            diagnostic.suggest_name(kind, types);
        }
        if let [letter] = kind.as_bytes()
            && letter.is_ascii_uppercase()
        {
            diagnostic
                .add_help(format!("or declare it as the type of all parameters: `struct Robot<{kind}>`"));
        }
        if diagnostic.has_no_help() {
            diagnostic
                .add_help("`linkwork::elements` lists them: `Body`, `Pin`, `Sleeve`, `Spring`, `Force`, …");
        }
    }
}

/// Whether a type is an element of the language or that of parameters.
pub fn is_element_or_parameter_type(kind: &str) -> bool {
    kind == "f64" || ElementKind::find_by_name(kind).is_some()
}

/// Returns all element types of the language, and that of parameters.
fn element_type_names() -> Vec<&'static str> {
    ["f64"].into_iter().chain(ElementKind::element_names()).collect()
}

/// Reads the element `name: kind` with its attributes into the description.
pub fn read_element(
    name: &Name,
    kind: &Ident,
    attributes: &[Attribute],
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let kind_name = kind.to_string();
    let Some(element) = ElementKind::find_by_name(&kind_name) else {
        report_unknown_type(name, &kind_name, kind.span(), cx);
        return;
    };
    let expected = element.element_attributes();
    let given = attributes.iter().find(|a| is_attribute_among(a, expected));
    let word = given.map(attribute_name).or(expected.first().map(ToString::to_string));
    let arguments = match &word {
        Some(word) => attribute_arguments(name, (&kind_name, element), word, attributes, cx),
        None => empty_arguments_without_attribute(name, &kind_name, attributes, cx),
    };
    let Some(arguments) = arguments else { return };
    let mut arguments = arguments.with_owner(name);
    match element {
        ElementKind::Body => {
            let body = read_body(name, &mut arguments, cx);
            description.bodies.push(body);
        }
        ElementKind::Particle => description.particles.extend(read_particle(name, &mut arguments, cx)),
        ElementKind::Joint(joint) => description.joints.extend(read_joint(name, joint, &mut arguments, cx)),
        ElementKind::Force(force) => {
            let action = read_force_element(name, force, &mut arguments, cx);
            description.inputs.extend(action.iter().filter(|action| action.is_input()).map(|_| name.clone()));
            description.actions.extend(action);
        }
        ElementKind::Other(other) => {
            read_auxiliary_element(name, other, word.as_deref(), &mut arguments, description, cx);
        }
    }
}

/// Reads the rate of a first-order state from its attributes.
pub fn read_state_rate(
    name: &Name,
    kind: &Ident,
    attributes: &[Attribute],
    cx: &mut Diagnostics,
) -> Option<Expr> {
    let kind = (&*kind.to_string(), ElementKind::Other(OtherKind::State));
    let arguments = attribute_arguments(name, kind, "state", attributes, cx)?;
    let mut arguments = arguments.with_owner(name);
    let keys = &OtherKind::State.argument_names();
    let rate = arguments.require_expression("rate", "(command - level) / lag", "state", keys, cx);
    arguments.report_remaining_arguments("a State", keys, cx);
    rate
}

/// Returns whether the name of an attribute is in a list.
pub fn is_attribute_among(attribute: &Attribute, words: &[&str]) -> bool {
    attribute.path().get_ident().is_some_and(|i| words.contains(&i.to_string().as_str()))
}

/// Help for conditional fields; their conditions are not visible to the attribute.
pub const CONDITION_HELP: &str =
    "put `#[cfg(…)]` on the whole struct, before `#[mechanism]`, and write one struct for each case";

/// Whether an attribute removes a parameter conditionally, or conditionally adds an attribute of the
/// language.
pub fn is_conditional_attribute(attribute: &Attribute) -> bool {
    let adds_conditional_or_language_attribute = |list: &syn::MetaList| {
        let parse = syn::punctuated::Punctuated::<Meta, syn::Token![,]>::parse_terminated;
        let parts = parse.parse2(list.tokens.clone()).unwrap_or_default();
        parts.iter().skip(1).any(|part| {
            let word = part.path().get_ident().map(ToString::to_string).unwrap_or_default();
            word.starts_with("cfg") || ATTRIBUTES.contains(&word.as_str())
        })
    };
    match &attribute.meta {
        meta if meta.path().is_ident("cfg") => true,
        Meta::List(list) if list.path.is_ident("cfg_attr") => adds_conditional_or_language_attribute(list),
        _ => false,
    }
}

/// Reads the unit in the attribute `#[unit(…)]` as an expression.
pub fn read_unit(attribute: &Attribute, cx: &mut Diagnostics) -> Option<Expr> {
    let tokens = match &attribute.meta {
        Meta::List(list) if !list.tokens.is_empty() => list.tokens.clone(),
        _ => {
            cx.report_error(attribute.path().span(), "missing unit")
                .add_help("write `#[unit(kg)]` or `#[unit(N * m / rad)]`");
            return None;
        }
    };
    let parse_whole_unit = |input: ParseStream<'_>| {
        if input.peek(LitStr) {
            let text: LitStr = input.parse()?;
            let help = format!("write it without quotes: `#[unit({})]`", text.value());
            return Err(syn_error_with_help(text.span(), "expected a unit, found a string", &help));
        }
        let unit = parse_expr(input)?;
        if input.is_empty() {
            return Ok(unit);
        }
        let help = match input.peek(Token![^]) {
            true => "write `m2` for a power of a unit",
            false => "units are products and quotients: `#[unit(N * m / rad)]`, `#[unit(kg * m2)]`",
        };
        Err(syn_error_with_help(input.span(), "expected `*` or `/`", help))
    };
    parse_whole_unit.parse2(tokens).map_err(|error| cx.report_syn_error(error)).ok()
}

/// Returns the arguments of the only attribute of an element of this kind.
fn attribute_arguments(
    name: &Name,
    (kind, element): (&str, ElementKind),
    expected: &str,
    attributes: &[Attribute],
    cx: &mut Diagnostics,
) -> Option<Arguments> {
    let mut found = None;
    for attribute in attributes {
        let path = attribute.path();
        let words: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        let word = words.join("::");
        let span = path.segments.first().map_or_else(Span::call_site, |s| s.ident.span());
        if word == expected {
            if found.is_some() {
                cx.report_error(span, format!("`{}` has a second `#[{expected}]`", name.text))
                    .add_help("write all arguments in one attribute");
            } else {
                found = Some(Arguments::parse_attribute_arguments(attribute, cx));
            }
        } else if ATTRIBUTES.contains(&word.as_str()) {
            cx.report_error(span, format!("a `{kind}` has no `#[{word}]`"))
                .add_help(format!("expected `#[{expected}(…)]`"));
            return None;
        } else if !check_foreign_attribute(&word, span, (kind, element.element_attributes()), cx) {
            return None;
        }
    }
    if found.is_none() {
        cx.report_error(name.place.clone(), format!("`{}` has no attribute that defines it", name.text))
            .add_help(format!("add `{}`", words::example_declaration(kind)));
    }
    found.flatten()
}

/// Checks an attribute, and reports it if it belongs neither to the language nor to Rust. Returns false after
/// an unknown attribute, because it is most likely the required one misspelt.
fn check_foreign_attribute(
    word: &str,
    span: Span,
    (kind, own): (&str, &[&str]),
    cx: &mut Diagnostics,
) -> bool {
    match word {
        "doc" | "allow" | "expect" | "warn" | "deny" | "forbid" | "deprecated" => return true,
        "cfg" | "cfg_attr" => {
            cx.report_error(span, "an element cannot be conditional").add_help(CONDITION_HELP);
            return true;
        }
        _ => {}
    }
    let diagnostic = cx.report_error(span, format!("unknown attribute `#[{word}]` on an element"));
    if own.is_empty() {
        diagnostic.add_help(format!("{} `{kind}` has no attribute", indefinite_article(kind)));
    } else if let Some(last) = word.rsplit("::").next().filter(|last| nearest_candidate(last, own).is_some())
    {
        diagnostic.suggest_name(last, own.iter().copied());
        return false;
    } else {
        let list: Vec<String> = own.iter().map(|word| format!("`#[{word}(…)]`")).collect();
        diagnostic.add_help(format!("expected {}", join_with_or(&list)));
    }
    diagnostic.add_help(
        "elements are removed from the struct; only parameters can have attributes of other crates",
    );
    false
}

fn read_body(name: &Name, arguments: &mut Arguments, cx: &mut Diagnostics) -> Body {
    let massive = arguments.take_flag_option("massive");
    let body = Body {
        name: name.clone(),
        mass: arguments.take_expression_of_key("mass", cx),
        com: arguments.take_expression_of_key("com", cx),
        inertia: arguments.take_expression_of_key("inertia", cx),
        about: arguments.take_expression_of_key("about", cx),
        at: arguments.take_expression_of_key("at", cx),
        frame: arguments.take_expression_of_key("frame", cx),
    };
    arguments.report_remaining_arguments("a Body", &["mass", "com", "inertia", "about", "at", "frame"], cx);
    if let (Some(about), None) = (&body.about, &body.inertia) {
        cx.report_error(
            about.place.clone(),
            "`about` is the reference point of the inertia, but there is no inertia",
        )
        .add_help("add `inertia = …`, or remove it");
    }
    if let Some(place) = massive {
        if body.at.is_none() && body.frame.is_none() {
            cx.report_error(place, "the motion of a massive body is prescribed").add_help(
                "place it by expressions of time: `#[body(massive, at = height * sin(speed * t) * z)]`",
            );
        } else if body.mass.is_some() || body.inertia.is_some() {
            cx.report_error(
                place,
                "the motion of a massive body is prescribed and does not depend on its mass",
            )
            .add_help("remove `mass` and `inertia`");
        }
    }
    body
}

fn read_particle(name: &Name, arguments: &mut Arguments, cx: &mut Diagnostics) -> Option<Particle> {
    let keys = ["mass", "at"];
    let mass = arguments.require_expression("mass", "m", "particle", &keys, cx);
    let at = arguments.take_expression_of_key("at", cx);
    arguments.report_remaining_arguments("a Particle", &keys, cx);
    Some(Particle { name: name.clone(), mass: mass?, at })
}

/// Returns the name of an attribute as text.
fn attribute_name(attribute: &Attribute) -> String {
    attribute.path().get_ident().map_or_else(String::new, Ident::to_string)
}

/// Returns empty arguments for an element without an attribute, and reports attributes of the language.
fn empty_arguments_without_attribute(
    name: &Name,
    kind: &str,
    attributes: &[Attribute],
    cx: &mut Diagnostics,
) -> Option<Arguments> {
    if let Some(attribute) = attributes.iter().find(|a| is_attribute_among(a, &ATTRIBUTES)) {
        let span = attribute.path().segments.first().map_or_else(Span::call_site, |s| s.ident.span());
        cx.report_error(
            span,
            format!("{} `{kind}` has no `#[{}]`", indefinite_article(kind), attribute_name(attribute)),
        )
        .add_help("the field alone declares it: remove the attribute");
        return None;
    }
    for attribute in attributes {
        let span = attribute.path().segments.first().map_or_else(Span::call_site, |s| s.ident.span());
        if !check_foreign_attribute(&attribute_name(attribute), span, (kind, &[]), cx) {
            return None;
        }
    }
    Arguments::parse(TokenStream::new(), name.place.span, cx)
}

/// Reads frames, points, coordinates, inputs, definitions, energies, limits, constraints and contacts.
fn read_auxiliary_element(
    name: &Name,
    kind: OtherKind,
    attribute: Option<&str>,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let name = name.clone();
    match kind {
        OtherKind::Coordinate => {
            let joints_before = description.joints.len();
            description.coordinates.push(FreeCoordinate { name, joints_before });
        }
        OtherKind::Input => description.inputs.push(name),
        OtherKind::Frame => {
            let mut plain = arguments.take_positional_arguments().into_iter();
            match plain.next() {
                Some(start) => {
                    description.frames.push(Frame { name, start, rotations: plain.collect() });
                }
                None if !arguments.is_empty() => {}
                None => {
                    cx.report_error(
                        name.place.clone(),
                        "a frame starts with the axes of a body or another frame",
                    )
                    .add_help("write `#[frame(ground, z(angle))]`");
                }
            }
            arguments.report_remaining_arguments("a Frame", &[], cx);
        }
        OtherKind::Point => {
            let (on, at) =
                (arguments.take_expression_of_key("on", cx), arguments.take_expression_of_key("at", cx));
            if let [body, place] = arguments.positional_arguments() {
                let help = format!(
                    "write `#[point(on = {}, at = {})]`",
                    body.short_source_text(),
                    place.short_source_text()
                );
                cx.report_error(body.place.extend_to_end_of(&place.place), "expected `name = value`")
                    .add_help(help);
                return;
            }
            if on.is_none() && at.is_none() && arguments.is_empty() {
                cx.report_error(name.place.clone(), "a point needs a position")
                    .add_help("write `#[point(on = body, at = length * x)]`");
            }
            arguments.report_remaining_arguments("a Point", &kind.argument_names(), cx);
            description.points.push(Point { name, on, at });
        }
        OtherKind::Limit => read_limit(name, arguments, description, cx),
        OtherKind::Equilibrium => {
            let values = arguments.take_equations();
            arguments.report_remaining_arguments("an Equilibrium", &[], cx);
            description.equilibria.push(Equilibrium { name, values });
        }
        OtherKind::Holonomic => read_constraint(name, ConstraintKind::Holonomic, arguments, description, cx),
        OtherKind::Nonholonomic => {
            read_constraint(name, ConstraintKind::Nonholonomic, arguments, description, cx)
        }
        OtherKind::Rolling => read_constraint(name, ConstraintKind::Rolling, arguments, description, cx),
        OtherKind::Contact => read_contact(name, arguments, description, cx),
        OtherKind::Slipping => read_constraint(name, ConstraintKind::Slipping, arguments, description, cx),
        // `read_state` reads these fields, because they are also parameters.
        OtherKind::State => {}
        OtherKind::Potential => {
            let value = read_single_expression_element(&name, kind, attribute, arguments, cx);
            description.energies.extend(value.map(|value| (name, value)));
        }
        OtherKind::Rayleigh => {
            let value = read_single_expression_element(&name, kind, attribute, arguments, cx);
            description.dissipations.extend(value.map(|value| (name, value)));
        }
        OtherKind::Speed => {
            let Some(value) = read_single_expression_element(&name, kind, attribute, arguments, cx) else {
                return;
            };
            description.speeds.push(name.clone());
            description.definitions.push(Definition { name, rank: Rank::Scalar, value, resolved_in: None });
        }
        OtherKind::Scalar => {
            read_definition(name, (kind, Rank::Scalar), attribute, arguments, description, cx)
        }
        OtherKind::Vector => {
            read_definition(name, (kind, Rank::Vector), attribute, arguments, description, cx)
        }
        OtherKind::Matrix => {
            read_definition(name, (kind, Rank::Matrix), attribute, arguments, description, cx)
        }
        OtherKind::FreeBody => {
            read_definition(name, (kind, Rank::FreeBody), attribute, arguments, description, cx);
        }
    }
}

/// Reads the declaration of a definition or an output.
fn read_definition(
    name: Name,
    (kind, rank): (OtherKind, Rank),
    attribute: Option<&str>,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let resolved_in = kind.row().own.first().and_then(|axes| arguments.take_expression_of_key(axes, cx));
    let Some(value) = read_single_expression_element(&name, kind, attribute, arguments, cx) else { return };
    let list = match attribute {
        Some(OUTPUT) => &mut description.outputs,
        _ => &mut description.definitions,
    };
    list.push(Definition { name, rank, value, resolved_in });
}

/// Reads the expression of an element that consists of one expression, and the arguments of its row.
fn read_single_expression_element(
    name: &Name,
    kind: OtherKind,
    attribute: Option<&str>,
    arguments: &mut Arguments,
    cx: &mut Diagnostics,
) -> Option<Expr> {
    let mut plain = arguments.take_positional_arguments();
    let value = plain.pop();
    let word = attribute.unwrap_or("define");
    if !plain.is_empty() {
        let last = value.as_ref().map_or(&name.place, |e| &e.place);
        cx.report_error(
            plain[0].place.extend_to_end_of(last),
            format!("`#[{word}(…)]` takes one expression, found {}", plain.len() + 1),
        )
        .add_help("declare a field for each");
        return None;
    }
    let is_empty = arguments.is_empty();
    arguments.report_remaining_arguments(
        &ElementKind::Other(kind).name_with_article(),
        &kind.argument_names(),
        cx,
    );
    if value.is_none() && is_empty {
        cx.report_error(name.place.clone(), format!("`{}` has no expression", name.text))
            .add_help(format!("write `#[{word}(expression)]`"));
    }
    value
}
