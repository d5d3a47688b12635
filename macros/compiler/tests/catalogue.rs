//! Comparison of the generated functions with the catalogue. A program whose size differs from its row is an
//! internal error.

mod generated;
mod mechanisms;

use linkwork_compiler::catalogue::{self, Facts};
use linkwork_compiler::derive::DerivationOutput;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Model;
use linkwork_compiler::{compile, expand, parse_source_and_import};
use mechanisms::MECHANISMS;
use proc_macro2::TokenStream;
use std::collections::BTreeSet;
use std::path::Path;

fn mechanism_tokens((attribute, name, fields): (&str, &str, &str)) -> (TokenStream, TokenStream) {
    (attribute.parse().unwrap(), format!("pub struct {name} {{ {fields} }}").parse().unwrap())
}

/// Compiles a mechanism of the test and calls `f` with its model, facts and generated functions.
fn call_with_compiled_mechanism<T>(
    mechanism: (&str, &str, &str),
    f: impl FnOnce(&Model<'_>, Facts, DerivationOutput) -> T,
) -> T {
    let (attribute, item) = mechanism_tokens(mechanism);
    let mut cx = Diagnostics::new();
    let source = parse_source_and_import(attribute, item, Path::new(""), &mut cx).unwrap();
    let graph = Graph::new();
    let Some((model, output)) = compile(&source, &graph, &mut cx) else {
        panic!("{}: {:?}", mechanism.1, cx.full_message_texts());
    };
    f(&model, Facts::from_model(&model, source.mechanism.requests), output)
}

/// Returns the public functions in the inherent implementations of a type, except functions that only report
/// that a feature is absent.
fn public_function_names(text: &str, name: &str) -> BTreeSet<String> {
    let file = syn::parse_file(text).unwrap();
    let mut found = BTreeSet::new();
    for item in generated::items_of_generated_code(file) {
        let syn::Item::Impl(item) = item else { continue };
        let own = matches!(&*item.self_ty, syn::Type::Path(path) if path.path.is_ident(name));
        let token_text = |tokens: &dyn quote::ToTokens| tokens.to_token_stream().to_string();
        if item.trait_.is_some() || !own || token_text(&item.generics.where_clause).contains("absent") {
            continue;
        }
        for member in item.items {
            if let syn::ImplItem::Fn(function) = member
                && matches!(function.vis, syn::Visibility::Public(_))
                && !function.sig.ident.to_string().starts_with("__")
            {
                assert!(
                    found.insert(function.sig.ident.to_string()),
                    "{name} has {} twice",
                    function.sig.ident
                );
            }
        }
    }
    found
}

/// Returns the functions that the catalogue declares for a mechanism with these facts, and the functions of
/// its outputs.
fn expected_function_names(facts: &Facts, outputs: &[String]) -> BTreeSet<String> {
    let rows = catalogue::function_catalogue_rows()
        .filter(|row| row.first_unmet_need(facts).is_none() && !row.is_hidden());
    let mut names: BTreeSet<String> = BTreeSet::new();
    for row in rows {
        names.insert(row.name.to_string());
        names.extend((facts.requests.batch && row.batched).then(|| format!("{}_lanes", row.name)));
    }
    for output in outputs {
        for (suffix, asked) in [
            ("", true),
            ("_jacobian", true),
            ("_derivatives", facts.requests.derivatives),
            ("_by_parameters", facts.requests.sensitivities),
        ] {
            names.extend(asked.then(|| format!("{output}{suffix}")));
            names.extend((asked && facts.requests.batch).then(|| format!("{output}{suffix}_lanes")));
        }
    }
    names
}

#[test]
fn catalogue_rows_and_functions_correspond() {
    let mut seen = BTreeSet::new();
    for mechanism in MECHANISMS {
        let (attribute, item) = mechanism_tokens(mechanism);
        let text = expand(attribute, item, Path::new("")).text;
        let (facts, outputs) = call_with_compiled_mechanism(mechanism, |model, facts, _| {
            (facts, model.outputs.iter().map(|output| output.name.clone()).collect::<Vec<_>>())
        });
        let names = public_function_names(&text, mechanism.1);
        assert_eq!(names, expected_function_names(&facts, &outputs), "{}", mechanism.1);
        seen.extend(names);
    }
    let never: Vec<&str> = catalogue::function_catalogue_rows()
        .filter(|row| !row.is_hidden() && !seen.contains(row.name))
        .map(|row| row.name)
        .collect();
    assert_eq!(never, Vec::<&str>::new(), "no mechanism here has these");
}

/// Checks that each function absent from a mechanism is listed once, with one reason.
#[test]
fn absent_functions_have_one_reason_each() {
    for mechanism in MECHANISMS {
        call_with_compiled_mechanism(mechanism, |_, facts, _| {
            let present: BTreeSet<&str> = catalogue::function_catalogue_rows()
                .filter(|row| row.first_unmet_need(&facts).is_none())
                .map(|row| row.name)
                .collect();
            let absent: Vec<&str> = catalogue::absent_functions(&facts)
                .into_iter()
                .flat_map(|(_, rows)| rows)
                .map(|row| row.name)
                .collect();
            let names: BTreeSet<&str> = absent.iter().copied().collect();
            assert_eq!(names.len(), absent.len(), "{}: {absent:?}", mechanism.1);
            assert!(present.is_disjoint(&names), "{}", mechanism.1);
            let all: BTreeSet<&str> = catalogue::function_catalogue_rows()
                .filter(|row| !row.is_hidden())
                .map(|row| row.name)
                .collect();
            let hidden: Vec<&&str> =
                all.iter().filter(|n| !present.contains(*n) && !names.contains(*n)).collect();
            assert_eq!(hidden, Vec::<&&str>::new(), "{}", mechanism.1);
        });
    }
}

/// A missing or additional value in the program of a function, a link or a frame is detected.
#[test]
fn programs_with_wrong_result_counts_are_detected() {
    let mut in_lanes = 0;
    let limb_declarations = |k: usize| {
        format!(
            "#[body(mass = 1, com = 0.2 * y, inertia = diagonal(0.03, 0.04, 0.02))] thigh{k}: Body,
            #[body(mass = 1, com = 0.2 * y, inertia = diagonal(0.03, 0.04, 0.02))] shank{k}: Body,
            #[joint(trunk.at({k} * x) -> thigh{k}, about = x)] hip{k}: Pin,
            #[joint(thigh{k}.at(y) -> shank{k}, about = z)] knee{k}: Pin,"
        )
    };
    let trunk =
        "#[body(mass = 5, inertia = sphere(5, 0.2))] trunk: Body, #[joint(ground -> trunk)] base: Free,";
    let limbs = trunk.to_string() + &(0..4).map(limb_declarations).collect::<String>();
    let alike = ("gravity = -9.81 * y", "Alike", limbs.as_str());
    for mechanism in MECHANISMS.into_iter().chain([alike]) {
        call_with_compiled_mechanism(mechanism, |_, _, mut output| {
            assert_eq!(output.function_with_mismatched_program(), None, "{}", mechanism.1);
            for k in 0..output.functions.len() {
                let Some(last) = output.functions[k].program.outputs.pop() else { continue };
                let name = output.functions[k].name.clone();
                assert_eq!(output.function_with_mismatched_program(), Some(name.as_str()), "{}", mechanism.1);
                output.functions[k].program.outputs.push(last);
                let Some(lanes) = &mut output.functions[k].program.simd else { continue };
                let last = lanes.outputs.pop().unwrap();
                assert_eq!(
                    output.function_with_mismatched_program(),
                    Some(name.as_str()),
                    "lanes of {}",
                    mechanism.1
                );
                output.functions[k].program.simd.as_mut().unwrap().outputs.push(last);
                in_lanes += 1;
            }
            let last = output.links[0].columns.outputs.pop().unwrap();
            assert!(output.function_with_mismatched_program().is_some(), "{}", mechanism.1);
            output.links[0].columns.outputs.push(last);
            output.frames[0].twist.outputs.pop();
            assert!(output.function_with_mismatched_program().is_some(), "{}", mechanism.1);
        });
    }
    assert!(in_lanes > 0, "programs in lanes are looked at: {in_lanes}");
}
