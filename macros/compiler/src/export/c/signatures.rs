//! Signatures of all functions in C, and the code that kernels for other processors are made from.

use super::batch::Batch;
use super::function::Outline;
use super::header::{frame_names, list_state_entries, parameter_types, reaction_docs, size_macros};
use super::source::{
    LIMITS, Named, Options, Selection, Unfit, function_definitions, reaction_arguments, reject_vector_lanes,
};
use super::support::Support;
use super::{frames, manifold, names, steps};
use crate::catalogue::{Id, REACTION};
use crate::derive::Output;
use crate::mechanism::Model;

/// Parts of the C code from which kernels for GPUs are made.
pub struct CodeParts {
    /// Prefix of all names of the mechanism in C.
    pub prefix: String,
    /// Lines of a comment that describe the mechanism.
    pub about: String,
    /// C declarations of sizes, of the types of parameters and tables, and of indices of frames.
    pub types: String,
    /// C definitions of the helper functions, followed by those of all exported functions.
    pub definitions: String,
    /// Signatures of the exported C functions.
    pub functions: Vec<Batch>,
    /// Members of the C parameter struct.
    pub parameters: Vec<String>,
    /// Members of the C parameter struct that are tables.
    pub tables: Vec<String>,
    /// Functions that exist in Rust only, with reasons.
    pub left_out: Vec<String>,
}

/// Returns the code of a mechanism in double precision, without definitions of fused products, sines and
/// cosines.
///
/// # Errors
/// The mechanism is not supported, for the reason in [`Unfit`].
pub fn code_parts(
    model: &Model<'_>,
    output: &Output,
    tables: &[String],
    options: &Options,
) -> Result<CodeParts, Unfit> {
    reject_vector_lanes(output)?;
    let named = Named::from_model(model, tables, &options.prefix);
    let o = &named.outline_of_mechanism(model, output);
    let chosen = Selection::new(output);
    let mut support = Support::of_kernels();
    let steps = steps::Steps::new(model, output);
    let bodies = function_definitions(model, output, &chosen, &steps, o, &mut support)?;
    let functions = function_signatures(model, output, &chosen, &steps, o);
    let mut left_out = chosen.left_out.clone();
    left_out.extend(options.left_out.iter().cloned());
    let mut types = size_macros(model, output, o);
    types.push_str(&parameter_types(model, o));
    types.push_str(&frames::frame_index_constants(o, &frame_names(model)));
    Ok(CodeParts {
        prefix: o.prefix.clone(),
        about: list_state_entries(model),
        types,
        definitions: format!("{}\n{}", support.support_definitions(model.nv(), &o.prefix), bodies.trim_end()),
        functions,
        parameters: named.parameters.clone(),
        tables: named.tables.clone(),
        left_out,
    })
}

/// Returns the signatures of all functions that a program can call.
fn function_signatures(
    model: &Model<'_>,
    output: &Output,
    chosen: &Selection<'_>,
    steps: &steps::Steps<'_>,
    o: &Outline<'_>,
) -> Vec<Batch> {
    let mut functions: Vec<Batch> = chosen.public.iter().map(|f| Batch::from_function(f, o)).collect();
    functions.extend(chosen.reactions.iter().map(|f| {
        let name = names::replace_invalid_characters(f.name.strip_prefix(REACTION).unwrap_or_default());
        Batch::new(&name, &reaction_arguments(model), f.shape, &[reaction_docs(&name)], o)
    }));
    functions.extend(
        chosen.limits.map(|_| Batch::vector_signature("limits", &[], &LIMITS.map(|name| (name, o.nv)))),
    );
    functions.extend(manifold::manifold_batches(o));
    functions.extend(steps.step_batches(o));
    functions.extend(frames::frame_batches(output, o));
    functions
}

/// Names and signatures of a mechanism's C functions.
pub struct Signatures {
    /// Prefix of all names of the mechanism in C.
    pub prefix: String,
    /// C functions that a program can call.
    pub functions: Vec<Batch>,
    /// Names of the C functions for outputs.
    pub outputs: Vec<String>,
    /// Members of the C parameter struct.
    pub parameters: Vec<String>,
    /// Members of the C parameter struct that are tables.
    pub tables: Vec<String>,
}

impl Signatures {
    /// Returns the signatures of the functions that [`write`](super::write) writes.
    pub fn new(model: &Model<'_>, output: &Output, tables: &[String], prefix: &str) -> Signatures {
        let named = Named::from_model(model, tables, prefix);
        let o = &named.outline_of_mechanism(model, output);
        let chosen = Selection::new(output);
        let functions = function_signatures(model, output, &chosen, &steps::Steps::new(model, output), o);
        let own = chosen
            .public
            .iter()
            .filter(|f| f.id == Id::Output)
            .map(|f| names::replace_invalid_characters(&f.name));
        let reactions = chosen.reactions.iter().filter_map(|f| f.name.strip_prefix(REACTION));
        let outputs = own.chain(reactions.map(names::replace_invalid_characters)).collect();
        let prefix = o.prefix.clone();
        Signatures { prefix, functions, outputs, parameters: named.parameters, tables: named.tables }
    }
}
