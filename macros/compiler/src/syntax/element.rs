//! The elements: which attribute goes with which type, and the arguments of each.

use super::expression::{parse_expr, parse_name};
use super::{
    Action, ActionKind, Body, Definition, Description, Endpoint, Expr, ExprKind, Frame, FreeCoordinate,
    Joint, JointKind, Law, Name, Particle, Point, Target,
};
use crate::diag::{Diagnostics, Place};
use proc_macro2::{Span, TokenStream};
use syn::parse::{ParseStream, Parser};
use syn::spanned::Spanned;
use syn::{Attribute, Ident, LitStr, Meta, Token, bracketed, token};

/// The attributes of the language.
pub const ATTRIBUTES: [&str; 12] = [
    "body",
    "particle",
    "frame",
    "point",
    "joint",
    "acts",
    "energy",
    "dissipation",
    "constraint",
    "define",
    "output",
    "unit",
];

/// The joints by their type's name.
const JOINTS: [(&str, JointKind); 11] = [
    ("Pin", JointKind::Pin),
    ("Sleeve", JointKind::Sleeve),
    ("Screw", JointKind::Screw),
    ("Collar", JointKind::Collar),
    ("Slot", JointKind::Slot),
    ("Universal", JointKind::Universal),
    ("Ball", JointKind::Ball),
    ("Planar", JointKind::Planar),
    ("Stage", JointKind::Stage),
    ("Free", JointKind::Free),
    ("Weld", JointKind::Weld),
];

/// Elements that act, by their type's name.
const ACTIONS: [&str; 8] =
    ["Spring", "Dashpot", "Inerter", "Friction", "Gravity", "Attraction", "Force", "Torque"];

/// Other elements with the attributes that belong to them.
const OTHERS: [(&str, &[&str]); 8] = [
    ("Coordinate", &[]),
    ("Input", &[]),
    ("Frame", &["frame"]),
    ("Point", &["point"]),
    ("Potential", &["energy"]),
    ("Rayleigh", &["dissipation"]),
    ("Scalar", &["define", "output"]),
    ("Vector", &["define", "output"]),
];

/// Elements of the language that are not yet compiled.
const LATER: [&str; 3] = ["Holonomic", "Nonholonomic", "Rolling"];

/// Words of other trades, and the element that they mean.
const SYNONYMS: [(&str, &str); 23] = [
    ("Link", "Body"),
    ("RigidBody", "Body"),
    ("PointMass", "Particle"),
    ("Mass", "Particle"),
    ("Revolute", "Pin"),
    ("Continuous", "Pin"),
    ("Hinge", "Pin"),
    ("Prismatic", "Sleeve"),
    ("Slider", "Sleeve"),
    ("Helical", "Screw"),
    ("Cylindrical", "Collar"),
    ("Cardan", "Universal"),
    ("Hooke", "Universal"),
    ("Spherical", "Ball"),
    ("Floating", "Free"),
    ("SixDof", "Free"),
    ("Fixed", "Weld"),
    ("Rigid", "Weld"),
    ("Damper", "Dashpot"),
    ("Motor", "Torque"),
    ("Actuator", "Torque"),
    ("Thruster", "Force"),
    ("f16", "f32"),
];

/// Types of Rust that are no parameter.
const NUMBERS: [&str; 12] =
    ["i8", "i16", "i32", "i64", "i128", "isize", "u8", "u16", "u32", "u64", "u128", "usize"];

/// Reports a field whose type is neither a parameter's nor an element's.
pub fn unknown_type(field: &Name, kind: &str, place: impl Into<Place>, cx: &mut Diagnostics) {
    if NUMBERS.contains(&kind) {
        cx.error(place, format!("the parameter `{}` cannot have the type `{kind}`", field.text))
            .help("parameters are real numbers: `f64`, `f32` or the struct's own type parameter");
    } else if matches!(kind, "" | "bool" | "char" | "str" | "String" | "Vec" | "Option") {
        cx.error(place, format!("field `{}` has a type that a mechanism cannot have", field.text))
            .help("a field is a parameter (`f64`, `f32` or the struct's own type parameter) or an element (`Body`, `Pin`, …)");
    } else if let Some((_, word)) = SYNONYMS.iter().find(|(synonym, _)| *synonym == kind) {
        cx.error(place, format!("unknown element type `{kind}`")).help(format!("did you mean `{word}`?"));
    } else {
        let types = element_types();
        let near = crate::diag::nearest(kind, &types).is_some();
        let diagnostic = cx.error(place, format!("unknown element type `{kind}`")).suggest(kind, types);
        if !near {
            diagnostic.help("`linkwork::elements` lists them: `Body`, `Pin`, `Sleeve`, `Spring`, `Force`, …");
        }
    }
}

/// Every element type of the language.
fn element_types() -> Vec<&'static str> {
    let mut all = vec!["Body", "Particle", "f64"];
    all.extend(JOINTS.iter().map(|(name, _)| *name));
    all.extend(ACTIONS);
    all.extend(OTHERS.iter().map(|(name, _)| *name));
    all.extend(LATER);
    all
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
    if LATER.contains(&kind_name.as_str()) {
        // The grammar of its attribute is checked all the same.
        for attribute in attributes.iter().filter(|a| is_one_of(a, &ATTRIBUTES)) {
            let _ = Arguments::of(attribute, cx);
        }
        cx.error(kind.span(), format!("`{kind_name}` is not yet supported"));
        return;
    }
    if let Some((_, expected)) = OTHERS.iter().find(|(other, _)| *other == kind_name) {
        let given = attributes.iter().find(|a| is_one_of(a, expected));
        let word = given.map(spelt).or(expected.first().map(ToString::to_string));
        let arguments = match &word {
            Some(word) => own_arguments(name, &kind_name, word, attributes, cx),
            None => no_arguments(name, &kind_name, attributes, cx),
        };
        if let Some(mut arguments) = arguments {
            read_other(name, &kind_name, word.as_deref(), &mut arguments, description, cx);
        }
        return;
    }
    let joint = JOINTS.iter().find(|(joint, _)| *joint == kind_name).map(|(_, joint)| *joint);
    let expected = match kind_name.as_str() {
        "Body" => "body",
        "Particle" => "particle",
        _ if joint.is_some() => "joint",
        k if ACTIONS.contains(&k) => "acts",
        _ => {
            unknown_type(name, &kind_name, kind.span(), cx);
            return;
        }
    };
    let Some(mut arguments) = own_arguments(name, &kind_name, expected, attributes, cx) else {
        return;
    };
    match (expected, joint) {
        ("body", _) => {
            let body = read_body(name, &mut arguments, cx);
            description.bodies.push(body);
        }
        ("particle", _) => description.particles.extend(read_particle(name, &mut arguments, cx)),
        (_, Some(joint)) => description.joints.extend(read_joint(name, joint, &mut arguments, cx)),
        _ => {
            let action = read_action(name, &kind_name, &mut arguments, cx);
            if let Some(action) = &action
                && matches!(
                    &action.kind,
                    ActionKind::Force { value: None, .. } | ActionKind::Torque { value: None, .. }
                )
            {
                description.inputs.push(name.clone());
            }
            description.actions.extend(action);
        }
    }
}

/// True for an attribute of one of these names.
pub fn is_one_of(attribute: &Attribute, words: &[&str]) -> bool {
    attribute.path().get_ident().is_some_and(|i| words.contains(&i.to_string().as_str()))
}

/// The unit in `#[unit(…)]`, as an expression.
pub fn read_unit(attribute: &Attribute, cx: &mut Diagnostics) -> Option<Expr> {
    let tokens = match &attribute.meta {
        Meta::List(list) if !list.tokens.is_empty() => list.tokens.clone(),
        _ => {
            cx.error(attribute.path().span(), "this says no unit")
                .help("write `#[unit(kg)]` or `#[unit(N * m / rad)]`");
            return None;
        }
    };
    let whole = |input: ParseStream<'_>| {
        let unit = parse_expr(input)?;
        if input.is_empty() { Ok(unit) } else { Err(super::expression::unexpected(input)) }
    };
    whole.parse2(tokens).map_err(|error| cx.syn(error)).ok()
}

/// The arguments of the one attribute that an element of this kind has.
fn own_arguments(
    name: &Name,
    kind: &str,
    expected: &str,
    attributes: &[Attribute],
    cx: &mut Diagnostics,
) -> Option<Arguments> {
    let mut found = None;
    for attribute in attributes {
        let path = attribute.path();
        let word = path.get_ident().map_or_else(|| "?".to_string(), Ident::to_string);
        let span = path.segments.first().map_or_else(Span::call_site, |s| s.ident.span());
        if word == expected {
            if found.is_some() {
                cx.error(span, format!("`{}` has a second `#[{expected}]`", name.text));
            } else {
                found = Some(Arguments::of(attribute, cx));
            }
        } else if ATTRIBUTES.contains(&word.as_str()) {
            cx.error(span, format!("a `{kind}` has no `#[{word}]`"))
                .help(format!("expected `#[{expected}(…)]`"));
            return None;
        } else if word == "cfg" || word == "cfg_attr" {
            cx.error(span, "an element cannot be conditional").help("put `#[cfg]` on the whole struct");
        } else if !matches!(
            word.as_str(),
            "doc" | "allow" | "expect" | "warn" | "deny" | "forbid" | "deprecated"
        ) {
            let diagnostic = cx.error(span, format!("unknown attribute `#[{word}]` on an element"));
            diagnostic.suggest(&word, ATTRIBUTES);
            if crate::diag::nearest(&word, &ATTRIBUTES).is_none() {
                diagnostic.help("an element does not stay in the struct; only parameters can have attributes of other crates");
            }
            return None;
        }
    }
    if found.is_none() {
        cx.error(name.place.clone(), format!("`{}` does not say how it is placed", name.text))
            .help(format!("add {}", example(expected)));
    }
    found.flatten()
}

fn example(attribute: &str) -> &'static str {
    match attribute {
        "body" => "`#[body(mass = m, com = l / 2 * y, inertia = rod(m, l, y))]`",
        "particle" => "`#[particle(mass = m, at = body.at(l * x))]`",
        "joint" => "`#[joint(parent -> child, about = z)]`",
        _ => "`#[acts(on = joint, …)]`",
    }
}

fn read_body(name: &Name, arguments: &mut Arguments, cx: &mut Diagnostics) -> Body {
    let massive = arguments.word_given("massive");
    let body = Body {
        name: name.clone(),
        mass: arguments.take_expr("mass", cx),
        com: arguments.take_expr("com", cx),
        inertia: arguments.take_expr("inertia", cx),
        trust_inertia: false,
        at: arguments.take_expr("at", cx),
        frame: arguments.take_expr("frame", cx),
    };
    arguments.finish("a Body", &["mass", "com", "inertia", "at", "frame"], cx);
    if let Some(place) = massive {
        if body.at.is_none() && body.frame.is_none() {
            cx.error(place, "the motion of a massive body is prescribed").help(
                "place it by expressions of time: `#[body(massive, at = height * sin(speed * t) * z)]`",
            );
        } else if body.mass.is_some() || body.inertia.is_some() {
            cx.error(place, "a massive body moves as it is told, whatever its mass")
                .help("remove `mass` and `inertia`");
        }
    }
    body
}

fn read_particle(name: &Name, arguments: &mut Arguments, cx: &mut Diagnostics) -> Option<Particle> {
    let keys = ["mass", "at"];
    let mass = arguments.need_expr("mass", "m", "particle", &keys, cx);
    let at = arguments.take_expr("at", cx);
    arguments.finish("a Particle", &keys, cx);
    Some(Particle { name: name.clone(), mass: mass?, at })
}

fn read_joint(
    name: &Name,
    kind: JointKind,
    arguments: &mut Arguments,
    cx: &mut Diagnostics,
) -> Option<Joint> {
    let ends = arguments.take_relation(cx);
    let about = arguments.take_list("about", cx);
    let along = arguments.take_list("along", cx);
    let pitch = arguments.take_expr("pitch", cx);
    let lead = arguments.take_expr("lead", cx);
    let allowed: &[&str] = match kind {
        JointKind::Pin | JointKind::Universal => &["about"],
        JointKind::Sleeve | JointKind::Stage => &["along"],
        JointKind::Screw => &["about", "along", "pitch", "lead"],
        JointKind::Collar | JointKind::Slot | JointKind::Planar => &["about", "along"],
        JointKind::Ball | JointKind::Free | JointKind::Weld => &[],
    };
    for key in ["about", "along", "pitch", "lead"] {
        if let Some(place) = arguments.seen(key)
            && !allowed.contains(&key)
        {
            let list: Vec<String> = allowed.iter().map(|k| format!("`{k}`")).collect();
            let help = if list.is_empty() {
                "it takes no axis".to_string()
            } else {
                format!("expected {}", crate::diag::one_of(&list))
            };
            cx.error(place, format!("a {} takes no `{key}`", kind_word(kind))).help(help);
        }
    }
    arguments.finish(&format!("a {}", kind_word(kind)), allowed, cx);
    let (parent, child) = ends?;
    Some(Joint {
        name: name.clone(),
        kind,
        parent: endpoint(parent, cx)?,
        child: endpoint(child, cx)?,
        about,
        along,
        pitch,
        lead,
        normalise_axis: false,
        mimic: None,
        damping: None,
        friction: None,
        driven: false,
    })
}

/// The word of the language for a joint.
pub fn kind_word(kind: JointKind) -> &'static str {
    JOINTS.iter().find(|(_, k)| *k == kind).map_or("joint", |(word, _)| word)
}

/// `body`, `body.at(v)`, `body.rotated(…)`, `body.at(v).rotated(…)`.
fn endpoint(e: Expr, cx: &mut Diagnostics) -> Option<Endpoint> {
    match e.kind {
        ExprKind::Name(text) => {
            Some(Endpoint { body: Name { text, place: e.place }, at: None, rotated: Vec::new() })
        }
        ExprKind::Method(inner, method, mut arguments) => {
            let mut end = endpoint(*inner, cx)?;
            match method.text.as_str() {
                "at" if arguments.len() == 1 && end.at.is_none() && end.rotated.is_empty() => {
                    end.at = arguments.pop();
                    Some(end)
                }
                "at" if arguments.len() == 1 => {
                    cx.error(method.place, "`.at(…)` stands once, before `.rotated(…)`");
                    None
                }
                "at" => {
                    cx.error(method.place, "expected one vector in `.at(…)`")
                        .help("write `body.at(length * x)`");
                    None
                }
                "rotated" if !arguments.is_empty() => {
                    end.rotated.extend(arguments);
                    Some(end)
                }
                "rotated" => {
                    cx.error(method.place, "`.rotated()` says no rotation")
                        .help("write `body.rotated(z(angle))`");
                    None
                }
                other => {
                    cx.error(method.place, format!("unknown method `.{other}(…)` of a body"))
                        .suggest(other, ["at", "rotated"]);
                    None
                }
            }
        }
        _ => {
            cx.error(e.place, "expected a body").help("write `ground -> cart`, `arm.at(length * x) -> hand`");
            None
        }
    }
}

fn read_action(name: &Name, kind: &str, arguments: &mut Arguments, cx: &mut Diagnostics) -> Option<Action> {
    let keys: &[&str] = match kind {
        "Spring" => &["on", "between", "stiffness", "force", "energy", "free_length", "free_angle"],
        "Dashpot" => &["on", "between", "damping", "force"],
        "Inerter" => &["on", "between", "inertance"],
        "Friction" => &["on", "coulomb", "stiction", "stribeck_speed", "viscous", "speed"],
        "Gravity" => &["on", "between", "constant", "mu"],
        "Attraction" => &["between", "strength"],
        "Force" => &["on", "along", "value"],
        _ => &["on", "about", "value"],
    };
    let refused = arguments.place_of("between").is_some() && !keys.contains(&"between");
    let on = read_target(kind, arguments, keys, cx);
    if refused {
        return None;
    }
    let action = match kind {
        "Spring" => read_spring(arguments, keys, cx),
        "Dashpot" => {
            one_law(arguments, &["force", "damping"], cx);
            let force = arguments.take_expr("force", cx).map(Law::Force);
            let law =
                force.or_else(|| arguments.need_expr("damping", "c", "acts", keys, cx).map(Law::Linear));
            law.map(|law| ActionKind::Dashpot { law })
        }
        "Inerter" => arguments
            .need_expr("inertance", "b", "acts", keys, cx)
            .map(|inertance| ActionKind::Inerter { inertance }),
        "Friction" => {
            arguments.need_expr("coulomb", "f", "acts", keys, cx).map(|coulomb| ActionKind::Friction {
                coulomb,
                stiction: arguments.take_expr("stiction", cx),
                stribeck_speed: arguments.take_expr("stribeck_speed", cx),
                viscous: arguments.take_expr("viscous", cx),
                speed: arguments.take_expr("speed", cx),
            })
        }
        "Gravity" => Some(ActionKind::Gravity {
            constant: arguments.take_expr("constant", cx),
            mu: arguments.take_expr("mu", cx),
        }),
        "Attraction" => arguments
            .need_expr("strength", "k", "acts", keys, cx)
            .map(|strength| ActionKind::Attraction { strength }),
        "Force" => Some(ActionKind::Force {
            along: arguments.take_expr("along", cx),
            value: arguments.take_expr("value", cx),
        }),
        _ => Some(ActionKind::Torque {
            about: arguments.take_expr("about", cx),
            value: arguments.take_expr("value", cx),
        }),
    };
    arguments.finish(&format!("{} {kind}", article(kind)), keys, cx);
    Some(Action { name: name.clone(), kind: action?, on: on? })
}

fn article(word: &str) -> &'static str {
    if word.starts_with(['A', 'I']) { "an" } else { "a" }
}

/// `on = …`, or `between = (…, …)` where the element can span two points.
fn read_target(kind: &str, arguments: &mut Arguments, keys: &[&str], cx: &mut Diagnostics) -> Option<Target> {
    let Some(place) = arguments.place_of("between") else {
        if !keys.contains(&"on") {
            return arguments.need_expr("between", "(first, second)", "acts", keys, cx).and(None);
        }
        return arguments.need_expr("on", "joint", "acts", keys, cx).map(Target::On);
    };
    if !keys.contains(&"between") {
        cx.error(place, format!("{} {kind} does not act between two points", article(kind)))
            .help("say what it acts on: `on = …`");
        arguments.forget_all();
        return None;
    }
    if let Some(on) = arguments.place_of("on") {
        cx.error(on, "an element has one of `on` and `between`");
        arguments.forget("on");
    }
    match arguments.take_expr("between", cx)? {
        Expr { kind: ExprKind::Tuple(mut ends), .. } if ends.len() == 2 => {
            let second = ends.pop()?;
            Some(Target::Between(ends.pop()?, second))
        }
        other => {
            cx.error(other.place, "`between` names two points").help("write `between = (first, second)`");
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

/// The first word of an attribute.
fn spelt(attribute: &Attribute) -> String {
    attribute.path().get_ident().map_or_else(String::new, Ident::to_string)
}

/// For elements without an attribute: none of the language's may stand there.
fn no_arguments(
    name: &Name,
    kind: &str,
    attributes: &[Attribute],
    cx: &mut Diagnostics,
) -> Option<Arguments> {
    if let Some(attribute) = attributes.iter().find(|a| is_one_of(a, &ATTRIBUTES)) {
        let span = attribute.path().segments.first().map_or_else(Span::call_site, |s| s.ident.span());
        cx.error(span, format!("{} `{kind}` has no `#[{}]`", article(kind), spelt(attribute)));
        return None;
    }
    Arguments::parse(TokenStream::new(), name.place.span, cx)
}

/// Frames, points, coordinates, inputs, definitions, energies.
fn read_other(
    name: &Name,
    kind: &str,
    attribute: Option<&str>,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let name = name.clone();
    match kind {
        "Coordinate" => {
            let joints_before = description.joints.len();
            description.coordinates.push(FreeCoordinate { name, joints_before });
        }
        "Input" => description.inputs.push(name),
        "Frame" => {
            let mut plain = arguments.take_plain().into_iter();
            match plain.next() {
                Some(start) => {
                    description.frames.push(Frame { name, start, rotations: plain.collect() });
                }
                None => {
                    cx.error(name.place.clone(), "a frame starts with the axes of a body or another frame")
                        .help("write `#[frame(ground, z(angle))]`");
                }
            }
            arguments.finish("a Frame", &[], cx);
        }
        "Point" => {
            let (on, at) = (arguments.take_expr("on", cx), arguments.take_expr("at", cx));
            if on.is_none() && at.is_none() {
                cx.error(name.place.clone(), "a point says where it is")
                    .help("write `#[point(on = body, at = length * x)]`");
            }
            arguments.finish("a Point", &["on", "at"], cx);
            description.points.push(Point { name, on, at });
        }
        _ => read_expression(name, kind, attribute, arguments, description, cx),
    }
}

/// Elements that are one expression.
fn read_expression(
    name: Name,
    kind: &str,
    attribute: Option<&str>,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let resolved_in = if kind == "Vector" { arguments.take_expr("resolved_in", cx) } else { None };
    let mut plain = arguments.take_plain();
    let value = plain.pop();
    let word = attribute.unwrap_or("define");
    if !plain.is_empty() {
        cx.error(
            name.place.clone(),
            format!("`#[{word}(…)]` holds one expression, found {}", plain.len() + 1),
        );
    }
    let keys: &[&str] = if kind == "Vector" { &["resolved_in"] } else { &[] };
    arguments.finish(&format!("{} {kind}", article(kind)), keys, cx);
    let Some(value) = value else {
        cx.error(name.place.clone(), format!("`{}` says nothing", name.text))
            .help(format!("write `#[{word}(expression)]`"));
        return;
    };
    match (kind, word) {
        ("Potential", _) => description.energies.push((name, value)),
        ("Rayleigh", _) => description.dissipations.push((name, value)),
        (_, "output") => {
            description.outputs.push(Definition { name, vector: kind == "Vector", value, resolved_in });
        }
        _ => description.definitions.push(Definition { name, vector: kind == "Vector", value, resolved_in }),
    }
}

/// The arguments of an attribute: at most one relation `a -> b`, and `key = value` in any order.
pub struct Arguments {
    relation: Option<(Expr, Expr)>,
    plain: Vec<Expr>,
    named: Vec<(Name, Value)>,
    seen: Vec<Name>,
    place: Place,
}

enum Value {
    Expr(Expr),
    Text(LitStr),
    Texts(Vec<LitStr>),
}

impl Arguments {
    /// The arguments of `#[word(…)]`.
    fn of(attribute: &Attribute, cx: &mut Diagnostics) -> Option<Arguments> {
        let span = attribute.path().segments.first().map_or_else(Span::call_site, |s| s.ident.span());
        match &attribute.meta {
            Meta::List(list) => Arguments::parse(list.tokens.clone(), span, cx),
            Meta::Path(_) => Arguments::parse(TokenStream::new(), span, cx),
            Meta::NameValue(_) => {
                cx.error(span, "expected arguments in parentheses");
                None
            }
        }
    }

    /// Parses the tokens between the parentheses.
    pub fn parse(tokens: TokenStream, span: Span, cx: &mut Diagnostics) -> Option<Arguments> {
        let parsed = (|input: ParseStream<'_>| parse_arguments(input, span)).parse2(tokens);
        let mut arguments = match parsed {
            Ok(arguments) => arguments,
            // The end of the input has no place of its own.
            Err(error) if error.to_string().starts_with("unexpected end") => {
                cx.error(span, "unexpected end of the arguments");
                return None;
            }
            Err(error) => {
                cx.syn(error);
                return None;
            }
        };
        let mut first: Vec<(Name, Value)> = Vec::new();
        for (key, value) in std::mem::take(&mut arguments.named) {
            if first.iter().any(|(other, _)| other.text == key.text) {
                cx.error(key.place, format!("`{}` is given twice", key.text));
            } else {
                first.push((key, value));
            }
        }
        arguments.named = first;
        Some(arguments)
    }

    fn take(&mut self, key: &str) -> Option<(Name, Value)> {
        let at = self.named.iter().position(|(name, _)| name.text == key)?;
        let (name, value) = self.named.remove(at);
        self.seen.push(name.clone());
        Some((name, value))
    }

    /// Where a key that was not yet taken stands.
    pub fn place_of(&self, key: &str) -> Option<Place> {
        self.named.iter().find(|(name, _)| name.text == key).map(|(name, _)| name.place.clone())
    }

    /// Drops a key.
    pub fn forget(&mut self, key: &str) {
        self.named.retain(|(name, _)| name.text != key);
    }

    fn forget_all(&mut self) {
        self.named.clear();
    }

    /// Where a key that was taken stood.
    fn seen(&self, key: &str) -> Option<Place> {
        self.seen.iter().find(|name| name.text == key).map(|name| name.place.clone())
    }

    /// The expressions without a key.
    fn take_plain(&mut self) -> Vec<Expr> {
        std::mem::take(&mut self.plain)
    }

    /// Where a word stands alone, without a value.
    pub fn word_given(&mut self, word: &str) -> Option<Place> {
        let is_word = |e: &Expr| matches!(&e.kind, ExprKind::Name(name) if name == word);
        let at = self.plain.iter().position(is_word)?;
        Some(self.plain.remove(at).place)
    }

    /// The expression of a key, if given.
    pub fn take_expr(&mut self, key: &str, cx: &mut Diagnostics) -> Option<Expr> {
        match self.take(key)? {
            (_, Value::Expr(e)) => Some(e),
            (_, Value::Text(text)) => {
                cx.error(text.span(), format!("expected an expression for `{key}`, found a text"))
                    .help("write it without quotes");
                None
            }
            (name, Value::Texts(_)) => {
                cx.error(name.place, format!("expected an expression for `{key}`, found texts"))
                    .help("write it without quotes");
                None
            }
        }
    }

    /// The expression of a key that must be there; `example` is what may stand for it.
    fn need_expr(
        &mut self,
        key: &str,
        example: &str,
        attribute: &str,
        known: &[&str],
        cx: &mut Diagnostics,
    ) -> Option<Expr> {
        // A key that is not known is reported as such: most likely it is the missing one.
        if self.place_of(key).is_none()
            && self.named.iter().all(|(name, _)| known.contains(&name.text.as_str()))
        {
            cx.error(self.place.clone(), format!("missing `{key}`"))
                .help(format!("write `#[{attribute}(…, {key} = {example})]`").replace("(…, on", "(on"));
        }
        self.take_expr(key, cx)
    }

    /// The expressions of a key: one, or several in parentheses.
    fn take_list(&mut self, key: &str, cx: &mut Diagnostics) -> Vec<Expr> {
        match self.take_expr(key, cx) {
            Some(Expr { kind: ExprKind::Tuple(items), .. }) => items,
            Some(e) => vec![e],
            None => Vec::new(),
        }
    }

    /// The word of a key, one of a few.
    pub fn take_word(&mut self, key: &str, words: &[&str], cx: &mut Diagnostics) -> Option<(String, Place)> {
        let (name, value) = self.take(key)?;
        match value {
            Value::Expr(Expr { kind: ExprKind::Name(word), place }) if words.contains(&word.as_str()) => {
                Some((word, place))
            }
            Value::Expr(Expr { kind: ExprKind::Name(word), place }) => {
                cx.error(place, format!("unknown choice `{word}` for `{key}`"))
                    .suggest(&word, words.iter().copied());
                None
            }
            _ => {
                cx.error(name.place, format!("expected a word for `{key}`"))
                    .suggest("", words.iter().copied());
                None
            }
        }
    }

    /// The string of a key.
    pub fn take_text(&mut self, key: &str, cx: &mut Diagnostics) -> Option<Name> {
        match self.take(key)? {
            (_, Value::Text(text)) => Some(Name { text: text.value(), place: text.span().into() }),
            (name, _) => {
                cx.error(name.place, format!("expected a string for `{key}`"))
                    .help(format!("write `{key} = \"…\"`"));
                None
            }
        }
    }

    /// The strings of a key, in brackets.
    pub fn take_texts(&mut self, key: &str, cx: &mut Diagnostics) -> Vec<Name> {
        let named = |text: &LitStr| Name { text: text.value(), place: text.span().into() };
        match self.take(key) {
            None => Vec::new(),
            Some((_, Value::Texts(texts))) => texts.iter().map(named).collect(),
            Some((_, Value::Expr(Expr { kind: ExprKind::Array(items), .. }))) if items.is_empty() => {
                Vec::new()
            }
            Some((name, _)) => {
                cx.error(name.place, format!("expected a list of strings for `{key}`"))
                    .help(format!("write `{key} = [\"…\", \"…\"]`"));
                Vec::new()
            }
        }
    }

    /// The relation `parent -> child`.
    fn take_relation(&mut self, cx: &mut Diagnostics) -> Option<(Expr, Expr)> {
        if self.relation.is_none() {
            let place = self.plain.first().map_or(&self.place, |e| &e.place).clone();
            self.plain.clear();
            cx.error(place, "a joint says which bodies it joins")
                .help("write `#[joint(parent -> child, …)]`, with `ground` for what does not move");
        }
        self.relation.take()
    }

    /// Reports what was not taken; `whose` is the element with its article.
    pub fn finish(&mut self, whose: &str, known: &[&str], cx: &mut Diagnostics) {
        for (name, _) in self.named.drain(..) {
            if name.text == "rotation" || name.text == "axes" {
                cx.error(name.place, format!("{whose} has no argument `{}`", name.text))
                    .help("rotate an end of the joint or an inertia: `body.rotated(z(angle))`, `rod(m, l, x).rotated(z(angle))`");
                continue;
            }
            cx.error(name.place, format!("{whose} has no argument `{}`", name.text))
                .suggest(&name.text, known.iter().copied());
        }
        for e in self.plain.drain(..) {
            cx.error(e.place, "expected `name = value`").suggest("", known.iter().copied());
        }
        if let Some((parent, child)) = self.relation.take() {
            cx.error(parent.place.to(&child.place), format!("{whose} joins nothing"))
                .help("`parent -> child` stands in a joint");
        }
    }
}

fn parse_arguments(input: ParseStream<'_>, span: Span) -> syn::Result<Arguments> {
    let mut arguments = Arguments {
        relation: None,
        plain: Vec::new(),
        named: Vec::new(),
        seen: Vec::new(),
        place: span.into(),
    };
    while !input.is_empty() {
        parse_argument(input, &mut arguments)?;
        if !input.is_empty() {
            if !input.peek(Token![,]) {
                return Err(super::expression::unexpected(input));
            }
            input.parse::<Token![,]>()?;
        }
    }
    Ok(arguments)
}

fn parse_argument(input: ParseStream<'_>, arguments: &mut Arguments) -> syn::Result<()> {
    use syn::ext::IdentExt;
    if input.peek(Ident::peek_any)
        && input.peek2(Token![=])
        && !input.peek2(Token![==])
        && !input.peek2(Token![=>])
    {
        let key = parse_name(input)?;
        input.parse::<Token![=]>()?;
        if input.is_empty() || input.peek(Token![,]) {
            return Err(syn::Error::new(key.place.span, format!("`{}` has no value", key.text)));
        }
        let value = parse_value(input)?;
        arguments.named.push((key, value));
        return Ok(());
    }
    let first = parse_expr(input)?;
    if input.peek(Token![->]) {
        let arrow: Token![->] = input.parse()?;
        if input.is_empty() || input.peek(Token![,]) {
            return Err(syn::Error::new(arrow.spans[1], "nothing stands behind this arrow"));
        }
        let second = parse_expr(input)?;
        if arguments.relation.is_some() {
            return Err(syn::Error::new(arrow.spans[0], "a second `parent -> child`"));
        }
        arguments.relation = Some((first, second));
    } else {
        arguments.plain.push(first);
    }
    Ok(())
}

fn parse_value(input: ParseStream<'_>) -> syn::Result<Value> {
    if input.peek(LitStr) {
        return input.parse().map(Value::Text);
    }
    if input.peek(token::Bracket) {
        let ahead = input.fork();
        let content;
        bracketed!(content in ahead);
        if content.peek(LitStr) {
            let content;
            bracketed!(content in input);
            let texts = content.parse_terminated(<LitStr as syn::parse::Parse>::parse, Token![,])?;
            return Ok(Value::Texts(texts.into_iter().collect()));
        }
    }
    parse_expr(input).map(Value::Expr)
}
