//! Models that are built from generated sources, and numbers for the symbols in their expressions.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::sample::sample_of_symbol;
use linkwork_compiler::expr::{Graph, Symbol};
use linkwork_compiler::kinematics::random_configuration;
use linkwork_compiler::mechanism::{Model, Quantity};
use linkwork_compiler::parse_source_and_import;
use linkwork_compiler::resolve::build_model;
use linkwork_compiler::syntax::Description;
use std::path::Path;

/// Source of a mechanism: the arguments of the attribute, and the struct to which it applies.
pub type Source = (String, String);

/// Calls `check` with the description and the model of a source. Returns the error messages if the source has
/// no model.
pub fn check_model_or_return_errors(
    (arguments, item): &Source,
    check: impl FnOnce(&Description, &Model<'_>),
) -> Result<(), Vec<String>> {
    let parse_tokens = |text: &str| text.parse().expect("the generated source is Rust");
    let mut cx = Diagnostics::new();
    let source = parse_source_and_import(parse_tokens(arguments), parse_tokens(item), Path::new(""), &mut cx);
    let graph = Graph::new();
    let description = source.map(|source| source.mechanism.description);
    let model = description.as_ref().and_then(|d| build_model(d, &graph, &mut cx));
    match (&description, &model) {
        (Some(description), Some(model)) => check(description, model),
        _ => return Err(cx.full_message_texts()),
    }
    Ok(())
}

/// Calls `check` with the description and the model of a source, and panics if it has none.
pub fn check_model_or_panic(source: &Source, check: impl FnOnce(&Description, &Model<'_>)) {
    if let Err(messages) = check_model_or_return_errors(source, check) {
        panic!("{}\n{}", messages.join("\n"), source.1);
    }
}

/// Returns a function that assigns numbers to all symbols of a model at a random state: parameters near one,
/// variables near zero.
pub fn random_symbol_values(model: &Model<'_>, seed: u64) -> impl Fn(Symbol) -> f64 {
    let q = random_configuration(model, seed);
    move |s| match Quantity::from_symbol(s) {
        Quantity::Configuration(k) => q[k],
        Quantity::Parameter(_) => sample_of_symbol(s, seed),
        _ => 4.0 * (sample_of_symbol(s, seed) - 1.0),
    }
}
