//! The struct and its attributes: which fields are parameters, which are elements, and what their attributes say.

use super::arguments::Arguments;
use super::expression::name;
use super::figures::{self, FileFigures};
use super::lists::Lists;
use super::mechanism::{
    FileFormat, FileOptions, InputOption, LimitOption, Mechanism, Printed, REQUESTS, Requests, Shell, Skipped,
};
use super::sound::Reading;
use super::state::{give_type, read_state};
use super::table::{read_table, table_variables};
use super::{
    Base, Description, Expr, ExprKind, Formulation, Inertias, Name, ScalarType, declaration, element, guard,
    home, skipped, words,
};
use crate::diag::{Diagnostics, Place, nearest, one_of};
use proc_macro2::{Span, TokenStream};
use quote::ToTokens;
use syn::spanned::Spanned;
use syn::{Attribute, Field, Fields, GenericParam, Ident, Item, ItemStruct, Type};

/// Most that `snap` may change a frame by, rad and m.
const LARGEST_SNAP: f64 = 0.01;

/// The options that have a value.
const OPTIONS: [&str; 21] = [
    "gravity",
    "friction_speed",
    "formulation",
    "independent",
    "scalar",
    "urdf",
    "mjcf",
    "sdf",
    "base",
    "passive",
    "mimic",
    "limits",
    "contacts",
    "inertia",
    "inputs",
    "lock",
    "snap",
    "parameters",
    "processor",
    "skip_passes",
    "equations",
];

/// Parses `#[mechanism(arguments)] item`. `None` if there is no struct to speak of; all mistakes are in `cx`.
pub fn parse_mechanism(arguments: TokenStream, item: TokenStream, cx: &mut Diagnostics) -> Option<Mechanism> {
    if !guard::check_tokens(&arguments, cx) || !guard::check_tokens(&item, cx) {
        return None;
    }
    let fields = declaration::fields(&item);
    let mut item = parse_struct(item, cx)?;
    let before = cx.len();
    let mut lists = Lists::write_out(&mut item.fields, cx);
    let arguments = lists.rewrite(arguments, None, cx);
    let mut reading = Reading::default();
    if cx.len() > before {
        reading.lose();
    }
    let (arguments, home) = home::take_path(arguments, cx);
    let (generic, refused) = check_generics(&mut item, cx);
    let mut description = empty_description(&item);
    let mut shell = Shell {
        attributes: item.attrs.clone(),
        visibility: item.vis.clone(),
        ident: item.ident.clone(),
        generics: item.generics.clone(),
        parameters: Vec::new(),
        tables: Vec::new(),
        file_fields: Vec::new(),
        elements: Vec::new(),
        notes: declaration::notes(&item),
        declaration: declaration::text(&item, fields),
        home,
    };
    let mut scalar: Option<(ScalarType, Place)> = None;
    // A type that is not known is told once.
    let mut strangers: Vec<Ident> = Vec::new();
    for field in item.fields {
        reading.field(&field);
        let kind = type_name(&field.ty).filter(|_| table_variables(&field.ty).is_none());
        if kind.as_ref().is_some_and(|kind| refused.contains(kind) || strangers.contains(kind)) {
            reading.blame_last();
            continue;
        }
        strangers.extend(kind.filter(|kind| !is_known(kind, generic.as_deref())));
        let before = cx.len();
        read_field(field, generic.as_deref(), &mut description, &mut shell, &mut scalar, cx);
        if cx.len() > before {
            reading.blame_last();
        }
    }
    let (mut requests, before) = (Requests::default(), cx.len());
    let file = read_options(arguments.clone(), &mut description, &mut scalar, &mut requests, cx);
    if cx.len() > before {
        reading.blame_arguments(arguments);
    }
    if let Some((scalar, _)) = scalar {
        description.scalar = scalar;
    }
    // The fields that hold figures of a file have its type.
    if let (Some(generic), true, true) =
        (&generic, requests.file_parameters, description.parameters.is_empty())
    {
        description.scalar = ScalarType::Generic(generic.clone());
    }
    if let Some(generic) = generic
        && description.scalar != ScalarType::Generic(generic.clone())
    {
        let unused = std::mem::take(&mut shell.generics);
        let place = unused.type_params().next().map_or(unused.span(), |t| t.ident.span());
        // It is most likely meant by a type that is not known.
        if strangers.is_empty() {
            cx.error(place, format!("no parameter of the mechanism has the type `{generic}`")).help(
                "remove the type parameter, or give it to a parameter: then all generated functions use it",
            );
        }
    }
    give_type(&description, &mut shell);
    // Linear systems have the derivatives by states, which are parameters.
    requests.sensitivities |= requests.derivatives && !description.states.is_empty();
    check_duplicates(&description, cx).iter().for_each(|name| reading.blame(name));
    Some(Mechanism { description, shell, file, requests, reading })
}

fn parse_struct(item: TokenStream, cx: &mut Diagnostics) -> Option<ItemStruct> {
    let item = match syn::parse2::<Item>(item) {
        Ok(item) => item,
        Err(error) => {
            cx.syn(error);
            return None;
        }
    };
    let (span, what) = match &item {
        Item::Struct(s) if !matches!(s.fields, Fields::Unnamed(_)) => match item {
            Item::Struct(s) => return Some(s),
            _ => return None,
        },
        Item::Struct(s) => (s.fields.span(), "a struct with unnamed fields"),
        Item::Enum(e) => (e.enum_token.span, "an enum"),
        Item::Union(u) => (u.union_token.span, "a union"),
        Item::Fn(f) => (f.sig.fn_token.span, "a function"),
        Item::Impl(i) => (i.impl_token.span, "an impl"),
        Item::Mod(m) => (m.mod_token.span, "a module"),
        Item::Trait(t) => (t.trait_token.span, "a trait"),
        _ => (Span::call_site(), "this item"),
    };
    cx.error(span, format!("`#[mechanism]` cannot be put on {what}")).help(
        "a mechanism is a struct with named fields: parameters (`mass: f64`) and elements (`#[body(mass = mass)] cart: Body`)",
    );
    None
}

/// The struct's type parameter, if it has one that can be the scalar type. Those that cannot be are taken away, so that
/// Rust does not complain of them once more, and the names of the types among them are returned.
fn check_generics(item: &mut ItemStruct, cx: &mut Diagnostics) -> (Option<String>, Vec<Ident>) {
    let (mut found, mut refused) = (None, Vec::new());
    let parameters = std::mem::take(&mut item.generics.params);
    let count = parameters.len();
    for parameter in parameters {
        match &parameter {
            GenericParam::Type(t) if found.is_none() => {
                found = Some(t.ident.to_string());
                item.generics.params.push(parameter);
            }
            GenericParam::Type(t) => {
                cx.error(t.ident.span(), format!("a second type parameter `{}`", t.ident))
                    .help("a mechanism has one scalar type at most");
                refused.push(t.ident.clone());
            }
            GenericParam::Const(c) => {
                cx.error(c.ident.span(), "a mechanism can be generic over its scalar type only")
                    .help("write `struct Robot<T>` with parameters of type `T`");
            }
            GenericParam::Lifetime(l) => {
                cx.error(l.lifetime.span(), "a mechanism can be generic over its scalar type only")
                    .help("write `struct Robot<T>` with parameters of type `T`");
            }
        }
    }
    if item.generics.params.len() < count {
        item.generics.where_clause = None;
    }
    (found, refused)
}

fn empty_description(item: &ItemStruct) -> Description {
    Description {
        name: name(&item.ident),
        gravity: None,
        friction_speed: None,
        scalar: ScalarType::F64,
        parameters: Vec::new(),
        tables: Vec::new(),
        states: Vec::new(),
        units: Vec::new(),
        file_units: Vec::new(),
        bodies: Vec::new(),
        particles: Vec::new(),
        joints: Vec::new(),
        actions: Vec::new(),
        drives: Vec::new(),
        limits: Vec::new(),
        equilibria: Vec::new(),
        contacts: Vec::new(),
        collisions: Vec::new(),
        drawing: false,
        visuals: Vec::new(),
        coordinates: Vec::new(),
        inputs: Vec::new(),
        frames: Vec::new(),
        points: Vec::new(),
        definitions: Vec::new(),
        speeds: Vec::new(),
        outputs: Vec::new(),
        energies: Vec::new(),
        dissipations: Vec::new(),
        constraints: Vec::new(),
        formulation: Formulation::default(),
        snapped: Vec::new(),
        left_out: Vec::new(),
        inertias: Inertias::Check,
        ground_frame: false,
        partial: false,
    }
}

fn read_field(
    mut field: Field,
    generic: Option<&str>,
    description: &mut Description,
    shell: &mut Shell,
    scalar: &mut Option<(ScalarType, Place)>,
    cx: &mut Diagnostics,
) {
    let Some(ident) = field.ident.clone() else { return };
    let field_name = name(&ident);
    if ident == "_" {
        cx.error(ident.span(), "a field of a mechanism needs a name").help("write a name, such as `_unused`");
        return;
    }
    if let Some(variables) = table_variables(&field.ty) {
        read_table(field, &field_name, variables, description, shell, cx);
        return;
    }
    let Some(kind) = type_name(&field.ty) else {
        element::unknown_type(&field_name, "", span_of(&field.ty), cx);
        return;
    };
    let found = match kind.to_string().as_str() {
        "f64" => ScalarType::F64,
        "f32" => ScalarType::F32,
        k if Some(k) == generic => ScalarType::Generic(k.to_string()),
        "State" => {
            read_state(field, kind, &field_name, description, shell, cx);
            return;
        }
        _ => {
            element::read_element(&field_name, &kind, &field.attrs, description, cx);
            shell.elements.push((ident, kind));
            return;
        }
    };
    check_parameter_attributes(&field_name, &field.attrs, cx);
    read_units(&field.attrs, description, cx);
    field.attrs.retain(|a| !element::is_one_of(a, &element::ATTRIBUTES));
    unify_scalar(scalar, found, field.ty.span().into(), cx);
    // Rust would complain of a second field with the same name as well.
    if !shell.parameters.iter().any(|known| known.ident == field.ident) {
        shell.parameters.push(field);
    }
    description.parameters.push(field_name);
}

/// True for the types of parameters and elements.
fn is_known(kind: &Ident, generic: Option<&str>) -> bool {
    let kind = kind.to_string();
    matches!(kind.as_str(), "f64" | "f32") || Some(kind.as_str()) == generic || element::is_element(&kind)
}

fn unify_scalar(
    scalar: &mut Option<(ScalarType, Place)>,
    found: ScalarType,
    place: Place,
    cx: &mut Diagnostics,
) {
    match scalar {
        None => *scalar = Some((found, place)),
        Some((known, _)) if *known == found => {}
        Some((known, _)) => {
            cx.error(
                place,
                format!("this parameter is `{}`, but others are `{}`", spell(&found), spell(known)),
            )
            .help("all parameters of a mechanism have one scalar type");
        }
    }
}

fn spell(scalar: &ScalarType) -> &str {
    match scalar {
        ScalarType::F64 => "f64",
        ScalarType::F32 => "f32",
        ScalarType::Generic(name) => name,
    }
}

/// From the first to the last token of a type.
pub(super) fn span_of(ty: &Type) -> Place {
    let mut tokens = ty.to_token_stream().into_iter();
    let Some(first) = tokens.next() else { return ty.span().into() };
    let last = tokens.last().map_or(first.span(), |last| last.span());
    Place::from(first.span()).to(&last.into())
}

/// The last word of a plain path without arguments.
fn type_name(ty: &Type) -> Option<Ident> {
    match ty {
        Type::Path(p) if p.qself.is_none() => {
            let last = p.path.segments.last()?;
            last.arguments.is_empty().then(|| last.ident.clone())
        }
        // What a macro has put in the place of a fragment.
        Type::Group(group) => type_name(&group.elem),
        Type::Paren(group) => type_name(&group.elem),
        _ => None,
    }
}

/// The `#[unit(…)]` of the parameter that comes next.
fn read_units(attributes: &[Attribute], description: &mut Description, cx: &mut Diagnostics) {
    let mut units = attributes.iter().filter(|a| element::is_one_of(a, &["unit"]));
    if let Some(first) = units.next() {
        let unit = element::read_unit(first, cx);
        description.units.extend(unit.map(|unit| (description.parameters.len(), unit)));
    }
    for second in units {
        cx.error(second.path().span(), "a parameter has one `#[unit]`");
    }
}

pub(super) fn check_parameter_attributes(field: &Name, attributes: &[Attribute], cx: &mut Diagnostics) {
    for attribute in attributes {
        if element::is_conditional(attribute) {
            cx.error(attribute.path().span(), "a parameter cannot be conditional").help(element::CONDITIONS);
        }
        if let Some(word) = attribute.path().get_ident()
            && word != "unit"
            && element::ATTRIBUTES.contains(&word.to_string().as_str())
        {
            cx.error(
                word.span(),
                format!("`#[{word}]` says how an element is placed, but `{}` is a parameter", field.text),
            )
            .help("give the field an element's type, such as `Body` or `Pin`");
        }
    }
}

fn read_options(
    arguments: TokenStream,
    description: &mut Description,
    scalar: &mut Option<(ScalarType, Place)>,
    requests: &mut Requests,
    cx: &mut Diagnostics,
) -> Option<FileOptions> {
    let mut arguments = Arguments::parse(arguments, Span::call_site(), cx)?;
    let mistaken: Vec<&str> = REQUESTS.into_iter().filter(|word| arguments.check_word(word, cx)).collect();
    let asked = words_given(&mut arguments);
    *requests = read_requests(&asked, &mistaken, &mut arguments, description, cx);
    description.gravity = arguments.take_expr("gravity", cx);
    description.friction_speed = arguments.take_expr("friction_speed", cx);
    description.formulation = read_formulation(&mut arguments, cx);
    if let Some((word, place)) = arguments.take_word("scalar", &["f64", "f32"], cx) {
        let found = if word == "f32" { ScalarType::F32 } else { ScalarType::F64 };
        unify_scalar(scalar, found, place, cx);
    }
    let file = read_path(&mut arguments, cx);
    let file_only =
        ["base", "passive", "mimic", "limits", "contacts", "inputs", "lock", "snap", "parameters"];
    if file.is_none() {
        for option in file_only {
            if let Some(place) = arguments.place_of(option) {
                let error = cx.error(place, format!("`{option}` is an option of a file"));
                if option == "base" {
                    error.help(
                        "what moves freely has a field of its own: `#[joint(ground -> body)] pose: Free`",
                    );
                }
                error.help("add `urdf = \"path/to/robot.urdf\"` or `mjcf = \"path/to/robot.xml\"`, or remove the option");
                arguments.forget(option);
            }
        }
    }
    let contacts = read_contacts(&mut arguments, file.as_ref().map(|(format, _)| *format), cx);
    let limits = arguments.take_word("limits", &["honour", "ignore", "stops"], cx);
    let limits = limits.map_or(LimitOption::Honour, |(word, _)| match word.as_str() {
        "ignore" => LimitOption::Ignore,
        "stops" => LimitOption::Stops,
        _ => LimitOption::Honour,
    });
    let mut choice =
        |key: &str, words: [&str; 2]| arguments.take_word(key, &words, cx).map(|(word, _)| word == words[1]);
    let base = choice("base", ["fixed", "free"]).unwrap_or(false);
    let ignore_passive = choice("passive", ["honour", "ignore"]).unwrap_or(false);
    let independent = choice("mimic", ["follow", "independent"]).unwrap_or(false);
    requests.target_only = choice("processor", ["detect", "target"]).unwrap_or(false);
    description.inertias = read_inertias(&mut arguments, &asked, description, cx);
    requests.skipped = skipped::read(&mut arguments, cx);
    let printed = arguments.take_word("equations", &Printed::WORDS.map(|(word, _)| word), cx);
    let printed = printed.and_then(|(asked, _)| Printed::WORDS.into_iter().find(|(word, _)| *word == asked));
    requests.equations = printed.map_or(Printed::Readable, |(_, printed)| printed);
    let inputs = read_inputs(&mut arguments, file.as_ref().map(|(format, _)| *format), cx);
    let lock = arguments.take_texts("lock", cx);
    let snap = arguments.take_expr("snap", cx).and_then(|e| read_tolerance(&e, cx));
    let parameters = read_figures(&mut arguments, description.inertias, cx);
    requests.file_parameters = !parameters.is_empty();
    requests.file_inertials = parameters.iter().any(|figures| figures.word.text == figures::INERTIAL);
    arguments.finish("`#[mechanism]`", &OPTIONS, cx);
    let (format, path) = file?;
    Some(FileOptions {
        format,
        path,
        base: if base { Base::Free } else { Base::Fixed },
        honour_passive: !ignore_passive,
        follow_mimic: !independent,
        limits,
        inertias: description.inertias,
        inputs,
        lock,
        snap,
        parameters,
        contacts,
        collisions: false,
        visuals: false,
    })
}

/// `contacts = file | ignore`: what touches what, of a format that says it.
fn read_contacts(arguments: &mut Arguments, format: Option<FileFormat>, cx: &mut Diagnostics) -> bool {
    let place = arguments.place_of("contacts");
    let asked =
        arguments.take_word("contacts", &["file", "ignore"], cx).is_some_and(|(word, _)| word == "file");
    let other = format.filter(|format| asked && *format != FileFormat::Mjcf);
    if let (Some(place), Some(other)) = (place, other) {
        cx.error(place, format!("{} does not say what touches what", other.article()))
            .help(super::contact::TOUCHES);
    }
    asked && other.is_none()
}

/// `urdf = "…"` or `mjcf = "…"`.
fn read_path(arguments: &mut Arguments, cx: &mut Diagnostics) -> Option<(FileFormat, Name)> {
    let mut found: Option<(FileFormat, Name)> = None;
    for format in FileFormat::ALL {
        let Some(path) = arguments.take_text(format.word(), cx) else { continue };
        if let Some((first, _)) = &found {
            cx.error(path.place.clone(), "a second file")
                .help(format!("a mechanism is read from one file: remove `{}` or this", first.word()));
        } else {
            found = Some((format, path));
        }
    }
    found
}

/// `inputs = joints | actuators | none`: joints are the motors of a format that declares none.
fn read_inputs(arguments: &mut Arguments, format: Option<FileFormat>, cx: &mut Diagnostics) -> InputOption {
    let words: &[&str] = match format {
        Some(FileFormat::Mjcf) => &["actuators", "joints", "none"],
        _ => &["joints", "none"],
    };
    let found = arguments
        .take_word("inputs", words, cx)
        .map_or(words.first().copied(), |(word, _)| words.iter().copied().find(|known| *known == word));
    match found {
        Some("actuators") => InputOption::Actuators,
        Some("none") => InputOption::None,
        _ => InputOption::Joints,
    }
}

/// `inertia = check | trust | none`. Without inertia there are no dynamics, so nothing can ask for more of them.
fn read_inertias(
    arguments: &mut Arguments,
    asked: &[(&str, Place)],
    description: &Description,
    cx: &mut Diagnostics,
) -> Inertias {
    match arguments.take_word("inertia", &["check", "trust", "none"], cx) {
        Some((word, _)) if word == "trust" => Inertias::Trust,
        Some((word, _)) if word == "none" => {
            for (word, place) in asked.iter().filter(|(word, _)| *word != "drawing") {
                cx.error(place.clone(), format!("`{word}` needs inertia")).help(format!(
                    "remove `{word}`, or `inertia = none`: without inertia there are no dynamics"
                ));
            }
            if let Formulation::Speeds(_, place) = &description.formulation {
                cx.error(place.clone(), "a formulation of the dynamics needs inertia")
                    .help("remove it, or `inertia = none`: without inertia there are no dynamics");
            }
            Inertias::None
        }
        _ => Inertias::Check,
    }
}

/// The tolerance of `snap`: a positive number, small beside an angle that is meant.
fn read_tolerance(e: &Expr, cx: &mut Diagnostics) -> Option<f64> {
    match e.kind {
        ExprKind::Number(tolerance) if tolerance > 0.0 && tolerance <= LARGEST_SNAP => Some(tolerance),
        _ => {
            cx.error(e.place.clone(), format!("expected a number above 0, at most {LARGEST_SNAP}"))
                .help("`snap = 1e-4` rounds what is 0.0001 rad or 0.0001 m off at most");
            None
        }
    }
}

/// `parameters = inertial("trunk")`. Without inertia there are no mass properties.
fn read_figures(arguments: &mut Arguments, inertias: Inertias, cx: &mut Diagnostics) -> Vec<FileFigures> {
    let mut found = figures::check(arguments.take_figures("parameters"), cx);
    found.retain(|figures| {
        let good = inertias != Inertias::None || figures.word.text == figures::PLACEMENT;
        if !good {
            let word = &figures.word;
            cx.error(word.place.clone(), format!("`{}` needs inertia", word.text))
                .help("remove it, or `inertia = none`: without inertia there are no dynamics");
        }
        good
    });
    found
}

/// `formulation = multipliers | speeds`; independent speeds that are named ask for the second.
fn read_formulation(arguments: &mut Arguments, cx: &mut Diagnostics) -> Formulation {
    let place = arguments.place_of("independent");
    let independent = arguments.take_list("independent", cx);
    let chosen = arguments.take_word("formulation", &["multipliers", "speeds"], cx);
    match (chosen, place) {
        (Some((word, at)), Some(_)) if word == "multipliers" => {
            cx.error(at, "multipliers need no independent speeds")
                .help("remove `independent`, or write `formulation = speeds`");
            Formulation::Multipliers
        }
        (_, Some(place)) => Formulation::Speeds(independent, place),
        (Some((word, place)), None) if word == "speeds" => Formulation::Speeds(Vec::new(), place),
        _ => Formulation::Multipliers,
    }
}

/// The words of [`Requests`] among the arguments.
fn words_given(arguments: &mut Arguments) -> Vec<(&'static str, Place)> {
    REQUESTS.iter().filter_map(|word| Some((*word, arguments.word_given(word)?))).collect()
}

/// What the words among the arguments ask for.
fn read_requests(
    asked: &[(&str, Place)],
    mistaken: &[&str],
    arguments: &mut Arguments,
    description: &Description,
    cx: &mut Diagnostics,
) -> Requests {
    let is_asked = |word| asked.iter().any(|(known, _)| *known == word);
    let requests = Requests {
        derivatives: ["derivatives", "second_derivatives", "momentum_derivatives"].into_iter().any(is_asked),
        second_derivatives: is_asked("second_derivatives"),
        momentum_derivatives: is_asked("momentum_derivatives"),
        centroidal: is_asked("centroidal"),
        hamilton: is_asked("hamilton"),
        routh: is_asked("routh"),
        conserved: is_asked("conserved"),
        regressor: is_asked("regressor"),
        sensitivities: is_asked("sensitivities"),
        packed: is_asked("packed"),
        prepare: is_asked("prepare"),
        batch: is_asked("batch"),
        drawing: is_asked("drawing"),
        file_parameters: false,
        file_inertials: false,
        target_only: false,
        skipped: Skipped::default(),
        equations: Printed::default(),
    };
    for (word, place) in asked {
        let without = ["sensitivities", "prepare"].contains(word) && !mistaken.contains(word);
        if description.parameters.is_empty() && arguments.place_of("parameters").is_none() && without {
            cx.error(
                place.clone(),
                format!("`{word}` has no meaning here: this mechanism has no parameters"),
            )
            .help(format!("remove `{word}`: all numbers are known at compile time"));
        }
    }
    for e in arguments.take_plain() {
        match e.name() {
            None => cx.error(e.place.clone(), "expected `name = value`").help("write `gravity = -9.81 * y`"),
            Some(word) if REQUESTS.contains(&word) => {
                cx.error(e.place.clone(), format!("`{word}` stands here twice")).help("remove one of the two")
            }
            Some(word) if OPTIONS.contains(&word) => {
                let value = if word == "gravity" { "-9.81 * y" } else { "…" };
                cx.error(e.place.clone(), format!("`{word}` says nothing"))
                    .help(format!("write `{word} = {value}`"))
            }
            Some(word) => {
                let list: Vec<String> = REQUESTS.iter().map(|known| format!("`{known}`")).collect();
                let error = cx.error(e.place.clone(), format!("unknown word `{word}`"));
                if words::explain(error, words::REQUESTS, word, &[]) {
                    continue;
                }
                if nearest(word, &REQUESTS).is_some() {
                    error.suggest(word, REQUESTS);
                }
                error.help(format!("a word asks for more: {}", one_of(&list)))
            }
        };
    }
    requests
}

/// Fields of a struct have distinct names by Rust's own rules, but Rust says so later and less clearly.
fn check_duplicates(description: &Description, cx: &mut Diagnostics) -> Vec<String> {
    let mut names: Vec<&Name> = Vec::new();
    names.extend(&description.parameters);
    names.extend(description.tables.iter().map(|t| &t.name));
    names.extend(description.bodies.iter().map(|b| &b.name));
    names.extend(description.particles.iter().map(|p| &p.name));
    names.extend(description.joints.iter().map(|j| &j.name));
    names.extend(description.actions.iter().map(|a| &a.name));
    names.extend(description.limits.iter().map(|l| &l.name));
    names.extend(description.equilibria.iter().map(|e| &e.name));
    names.extend(description.contacts.iter().map(|c| &c.name));
    names.extend(description.coordinates.iter().map(|c| &c.name));
    names.extend(description.frames.iter().map(|f| &f.name));
    names.extend(description.points.iter().map(|p| &p.name));
    names.extend(description.definitions.iter().chain(&description.outputs).map(|d| &d.name));
    names.extend(description.energies.iter().chain(&description.dissipations).map(|(name, _)| name));
    check_distinct(&names, cx)
}

/// Reports every name that stands twice, at its second place, and returns it.
pub fn check_distinct(names: &[&Name], cx: &mut Diagnostics) -> Vec<String> {
    let mut sorted: Vec<(usize, &&Name)> = names.iter().enumerate().collect();
    sorted.sort_by(|a, b| a.1.text.cmp(&b.1.text).then(a.0.cmp(&b.0)));
    let mut twice = Vec::new();
    for pair in sorted.windows(2) {
        let (first, second) = (pair[0].1, pair[1].1);
        if first.text == second.text {
            cx.error(second.place.clone(), format!("the name `{}` is used twice", second.text))
                .note("another field has this name as well")
                .help("name one of the two otherwise");
            twice.push(second.text.clone());
        }
    }
    twice
}
