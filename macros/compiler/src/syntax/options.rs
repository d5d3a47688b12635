//! Options of `#[mechanism(…)]`: gravity, an imported file with its options, formulation, and optional
//! functions.

use super::arguments::Arguments;
use super::file_parameters::{self, FileParameters};
use super::mechanism::{ContactOption, FileFormat, FileInputSource, FileOptions, LimitOption, LoopOption};
use super::parameter::unify_scalar_types;
use super::request::{EquationsOption, REQUESTS, RequestedFunctions};
use super::{
    BaseAttachment, Description, Expr, ExprKind, Formulation, InertiaOption, Name, ScalarType, skipped, words,
};
use crate::diag::{Diagnostics, Place, join_with_or, nearest_candidate};
use proc_macro2::{Span, TokenStream};

/// Maximum tolerance of the option `snap`, rad and m.
const LARGEST_SNAP: f64 = 0.01;

/// Options of `#[mechanism(…)]` that take a value.
const OPTIONS: [&str; 23] = [
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
    "loops",
    "inertia",
    "inputs",
    "lock",
    "snap",
    "parameters",
    "processor",
    "arithmetic",
    "skip_passes",
    "equations",
];

/// Reads the arguments of `#[mechanism(…)]`. Returns the options of the imported robot file, if there is one.
pub fn read_mechanism_options(
    arguments: TokenStream,
    description: &mut Description,
    scalar: &mut Option<(ScalarType, Place)>,
    requests: &mut RequestedFunctions,
    cx: &mut Diagnostics,
) -> Option<FileOptions> {
    let mut arguments = Arguments::parse(arguments, Span::call_site(), cx)?;
    let rejected: Vec<&str> =
        REQUESTS.into_iter().filter(|word| arguments.report_option_value(word, cx)).collect();
    let requested = take_request_options(&mut arguments);
    *requests = read_requested_functions(&requested, &rejected, &mut arguments, description, cx);
    description.gravity = arguments.take_expression_of_key("gravity", cx);
    description.friction_speed = arguments.take_expression_of_key("friction_speed", cx);
    description.formulation = read_formulation(&mut arguments, cx);
    if let Some((word, place)) = arguments.take_choice("scalar", &["f64", "f32"], cx) {
        let found = if word == "f32" { ScalarType::F32 } else { ScalarType::F64 };
        unify_scalar_types(scalar, found, place, cx);
    }
    let file = read_path(&mut arguments, cx);
    let file_only =
        ["base", "passive", "mimic", "limits", "contacts", "loops", "inputs", "lock", "snap", "parameters"];
    if file.is_none() {
        for option in file_only {
            if let Some(place) = arguments.span_of_key(option) {
                let error = cx.report_error(place, format!("`{option}` is an option of imported files"));
                if option == "base" {
                    error.add_help("a free body has a separate joint: `#[joint(ground -> body)] pose: Free`");
                }
                error.add_help(
                    "add `urdf = \"path/to/robot.urdf\"` or `mjcf = \"path/to/robot.xml\"`, or remove the \
                     option",
                );
                arguments.remove_key(option);
            }
        }
    }
    let contacts = read_contact_option(&mut arguments, file.as_ref().map(|(format, _)| *format), cx);
    let loops = read_loop_option(&mut arguments, file.as_ref().map(|(format, _)| *format), cx);
    let limits = arguments.take_choice("limits", &["honour", "ignore", "stops"], cx);
    let limits = limits.map_or(LimitOption::Honour, |(word, _)| match word.as_str() {
        "ignore" => LimitOption::Ignore,
        "stops" => LimitOption::Stops,
        _ => LimitOption::Honour,
    });
    let mut is_second_word_chosen = |key: &str, words: [&str; 2]| {
        arguments.take_choice(key, &words, cx).map(|(word, _)| word == words[1])
    };
    let base = is_second_word_chosen("base", ["fixed", "free"]).unwrap_or(false);
    let ignore_passive = is_second_word_chosen("passive", ["honour", "ignore"]).unwrap_or(false);
    let independent = is_second_word_chosen("mimic", ["follow", "independent"]).unwrap_or(false);
    requests.target_only = is_second_word_chosen("processor", ["detect", "target"]).unwrap_or(false);
    requests.reproducible = is_second_word_chosen("arithmetic", ["fast", "reproducible"]).unwrap_or(false);
    description.inertias = read_inertia_option(&mut arguments, &requested, description, cx);
    requests.skipped = skipped::read_skipped_passes(&mut arguments, cx);
    let printed = arguments.take_choice("equations", &EquationsOption::WORDS.map(|(word, _)| word), cx);
    let printed = printed
        .and_then(|(requested, _)| EquationsOption::WORDS.into_iter().find(|(word, _)| *word == requested));
    requests.equations = printed.map_or(EquationsOption::Readable, |(_, printed)| printed);
    let inputs = read_input_source(&mut arguments, file.as_ref().map(|(format, _)| *format), cx);
    let lock = arguments.take_string_list("lock", cx);
    let snap = arguments.take_expression_of_key("snap", cx).and_then(|e| read_snap_tolerance(&e, cx));
    let parameters = read_file_parameters(&mut arguments, description.inertias, cx);
    requests.file_parameters = !parameters.is_empty();
    requests.file_inertials = parameters.iter().any(|figures| figures.word.text == file_parameters::INERTIAL);
    arguments.report_remaining_arguments("`#[mechanism]`", &OPTIONS, cx);
    let (format, path) = file?;
    Some(FileOptions {
        base: if base { BaseAttachment::Free } else { BaseAttachment::Fixed },
        honour_passive: !ignore_passive,
        follow_mimic: !independent,
        limits,
        inertias: description.inertias,
        inputs,
        lock,
        snap,
        parameters,
        contacts,
        loops,
        ..FileOptions::default_options_of_file(format, path)
    })
}

/// Reads `contacts = file | ground | ignore`: which contacts of the file are included, for a format that has
/// them.
fn read_contact_option(
    arguments: &mut Arguments,
    format: Option<FileFormat>,
    cx: &mut Diagnostics,
) -> ContactOption {
    let place = arguments.span_of_key("contacts");
    let contacts = match arguments.take_choice("contacts", &["file", "ground", "ignore"], cx) {
        Some((word, _)) if word == "file" => ContactOption::File,
        Some((word, _)) if word == "ground" => ContactOption::Ground,
        _ => ContactOption::Ignore,
    };
    let unsupported =
        format.filter(|format| contacts != ContactOption::Ignore && *format != FileFormat::Mjcf);
    let (Some(place), Some(unsupported)) = (place, unsupported) else { return contacts };
    cx.report_error(place, format!("{} does not declare contacts", unsupported.file_format_phrase()))
        .add_help(super::contact::CONTACT_HELP);
    ContactOption::Ignore
}

/// Reads `loops = refuse | close | ignore`, an option of URDF files. Other formats have joints or constraints
/// that close loops.
fn read_loop_option(
    arguments: &mut Arguments,
    format: Option<FileFormat>,
    cx: &mut Diagnostics,
) -> LoopOption {
    let place = arguments.span_of_key("loops");
    let loops = arguments.take_choice("loops", &["refuse", "close", "ignore"], cx);
    let loops = loops.map_or(LoopOption::Refuse, |(word, _)| match word.as_str() {
        "close" => LoopOption::Close,
        "ignore" => LoopOption::Ignore,
        _ => LoopOption::Refuse,
    });
    if let (Some(place), Some(other)) = (place, format.filter(|format| *format != FileFormat::Urdf)) {
        cx.report_error(place, "`loops` is an option of URDF files")
            .add_help(format!("remove it: the loops of {} are always closed", other.file_format_phrase()));
    }
    loops
}

/// Reads `urdf = "…"`, `mjcf = "…"` or `sdf = "…"`.
fn read_path(arguments: &mut Arguments, cx: &mut Diagnostics) -> Option<(FileFormat, Name)> {
    let mut found: Option<(FileFormat, Name)> = None;
    for format in FileFormat::ALL {
        let Some(path) = arguments.take_text(format.import_option_name(), cx) else { continue };
        if let Some((first, _)) = &found {
            cx.report_error(path.place.clone(), "a second file").add_help(format!(
                "a mechanism is read from one file: remove `{}` or this",
                first.import_option_name()
            ));
        } else {
            found = Some((format, path));
        }
    }
    found
}

/// Reads `inputs = joints | actuators | none`. The default for a format without motors is `joints`.
fn read_input_source(
    arguments: &mut Arguments,
    format: Option<FileFormat>,
    cx: &mut Diagnostics,
) -> FileInputSource {
    let words: &[&str] = match format {
        Some(FileFormat::Mjcf) => &["actuators", "joints", "none"],
        _ => &["joints", "none"],
    };
    let found = arguments
        .take_choice("inputs", words, cx)
        .map_or(words.first().copied(), |(word, _)| words.iter().copied().find(|known| *known == word));
    match found {
        Some("actuators") => FileInputSource::Actuators,
        Some("none") => FileInputSource::None,
        _ => FileInputSource::Joints,
    }
}

/// Reads `inertia = check | trust | none`. Without inertia there are no dynamics; options that need them are
/// reported.
fn read_inertia_option(
    arguments: &mut Arguments,
    requested: &[(&str, Place)],
    description: &Description,
    cx: &mut Diagnostics,
) -> InertiaOption {
    match arguments.take_choice("inertia", &["check", "trust", "none"], cx) {
        Some((word, _)) if word == "trust" => InertiaOption::Trust,
        Some((word, _)) if word == "none" => {
            for (word, place) in requested.iter().filter(|(word, _)| *word != "drawing") {
                cx.report_error(place.clone(), format!("`{word}` needs inertia")).add_help(format!(
                    "remove `{word}`, or `inertia = none`: without inertia there are no dynamics"
                ));
            }
            if let Formulation::Speeds(_, place) = &description.formulation {
                cx.report_error(place.clone(), "a formulation of the dynamics needs inertia")
                    .add_help("remove it, or `inertia = none`: without inertia there are no dynamics");
            }
            InertiaOption::None
        }
        _ => InertiaOption::Check,
    }
}

/// Reads the tolerance of `snap`: a positive number, small compared with intended angles.
fn read_snap_tolerance(e: &Expr, cx: &mut Diagnostics) -> Option<f64> {
    match e.kind {
        ExprKind::Number(tolerance) if tolerance > 0.0 && tolerance <= LARGEST_SNAP => Some(tolerance),
        _ => {
            cx.report_error(e.place.clone(), format!("expected a number above 0, at most {LARGEST_SNAP}"))
                .add_help("`snap = 1e-4` rounds values with a deviation of at most 0.0001 rad or 0.0001 m");
            None
        }
    }
}

/// Reads `parameters = inertial("trunk")`. Without inertia there are no mass properties.
fn read_file_parameters(
    arguments: &mut Arguments,
    inertias: InertiaOption,
    cx: &mut Diagnostics,
) -> Vec<FileParameters> {
    let mut found =
        file_parameters::validated_file_parameters(arguments.take_file_parameters("parameters"), cx);
    found.retain(|figures| {
        let good = inertias != InertiaOption::None || figures.word.text == file_parameters::PLACEMENT;
        if !good {
            let word = &figures.word;
            cx.report_error(word.place.clone(), format!("`{}` needs inertia", word.text))
                .add_help("remove it, or `inertia = none`: without inertia there are no dynamics");
        }
        good
    });
    found
}

/// Reads `formulation = multipliers | speeds`; a list of independent velocities implies the latter.
fn read_formulation(arguments: &mut Arguments, cx: &mut Diagnostics) -> Formulation {
    let place = arguments.span_of_key("independent");
    let independent = arguments.take_list("independent", cx);
    let chosen = arguments.take_choice("formulation", &["multipliers", "speeds"], cx);
    match (chosen, place) {
        (Some((word, word_place)), Some(_)) if word == "multipliers" => {
            cx.report_error(word_place, "multipliers need no independent speeds")
                .add_help("remove `independent`, or write `formulation = speeds`");
            Formulation::Multipliers
        }
        (_, Some(place)) => Formulation::Speeds(independent, place),
        (Some((word, place)), None) if word == "speeds" => Formulation::Speeds(Vec::new(), place),
        _ => Formulation::Multipliers,
    }
}

/// Takes the options that request functions ([`RequestedFunctions`]) from the arguments.
fn take_request_options(arguments: &mut Arguments) -> Vec<(&'static str, Place)> {
    REQUESTS.iter().filter_map(|word| Some((*word, arguments.take_flag_option(word)?))).collect()
}

/// Returns the requested functions, and reports unknown or meaningless options.
fn read_requested_functions(
    requested: &[(&str, Place)],
    rejected: &[&str],
    arguments: &mut Arguments,
    description: &Description,
    cx: &mut Diagnostics,
) -> RequestedFunctions {
    let is_requested_option = |word: &str| requested.iter().any(|(known, _)| *known == word);
    let requests = RequestedFunctions::from_options(is_requested_option);
    for (word, place) in requested {
        let without = ["sensitivities", "prepare"].contains(word) && !rejected.contains(word);
        if description.parameters.is_empty() && arguments.span_of_key("parameters").is_none() && without {
            cx.report_error(
                place.clone(),
                format!("`{word}` has no effect here: this mechanism has no parameters"),
            )
            .add_help(format!("remove `{word}`: all numbers are known at compile time"));
        }
    }
    for e in arguments.take_positional_arguments() {
        match e.as_name() {
            None => {
                let inside = match &e.kind {
                    ExprKind::Array(items) => items.first().and_then(Expr::as_name),
                    _ => None,
                };
                let help = match inside.filter(|word| REQUESTS.contains(word)) {
                    Some(word) => format!("write `{word}` without brackets"),
                    None => "write `gravity = -9.81 * y`".to_string(),
                };
                cx.report_error(e.place.clone(), "expected `name = value`").add_help(help)
            }
            Some(word) if REQUESTS.contains(&word) => cx
                .report_error(e.place.clone(), format!("`{word}` is given twice"))
                .add_help("remove one of the two"),
            Some(word) if OPTIONS.contains(&word) => {
                let value = match word {
                    "gravity" => "-9.81 * y",
                    "equations" => "lagrange",
                    "formulation" => "speeds",
                    "scalar" => "f32",
                    "inertia" => "trust",
                    _ => "…",
                };
                cx.report_error(e.place.clone(), format!("`{word}` has no value"))
                    .add_help(format!("write `{word} = {value}`"))
            }
            Some(word) => {
                let list: Vec<String> = REQUESTS.iter().map(|known| format!("`{known}`")).collect();
                let error = cx.report_error(e.place.clone(), format!("unknown option `{word}`"));
                if words::add_word_meaning_as_help(error, words::REQUESTS, word, &[]) {
                    continue;
                }
                if nearest_candidate(word, &REQUESTS).is_some() {
                    error.suggest_name(word, REQUESTS);
                }
                error.add_help(format!("options that request functions: {}", join_with_or(&list)))
            }
        };
    }
    requests
}
