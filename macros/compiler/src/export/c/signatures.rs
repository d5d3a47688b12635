//! Signatures of all functions in C, and the code that kernels for other processors are made from.

use super::batch::Batch;
use super::function::Outline;
use super::source::{
    LIMITS, Named, Options, Selection, Unfit, bodies, check, description, frame_names, parameter_types,
    reaction_arguments, reaction_docs, sizes,
};
use super::support::Support;
use super::{frames, manifold, names, steps};
use crate::catalogue::{Id, REACTION};
use crate::derive::Output;
use crate::mechanism::Model;

/// Code in C that kernels for other processors are made from.
pub struct CodeParts {
    /// Prefix of all names of the mechanism in C.
    pub prefix: String,
    /// Description of the mechanism: lines of a comment.
    pub about: String,
    /// Sizes, types of parameters and tables, indices of frames.
    pub types: String,
    /// Definitions of the helper functions, followed by those of all functions.
    pub definitions: String,
    /// Functions that a program can call.
    pub functions: Vec<Batch>,
    /// Members of the parameter struct.
    pub parameters: Vec<String>,
    /// Members of the parameter struct that are tables.
    pub tables: Vec<String>,
    /// Functions that exist in Rust only, with reasons.
    pub left_out: Vec<String>,
}

/// Returns the code of a mechanism in double precision, without definitions of fused products, sines and
/// cosines.
///
/// # Errors
/// The mechanism is not supported, for the reason in [`Unfit`].
pub fn parts(
    model: &Model<'_>,
    output: &Output,
    tables: &[String],
    options: &Options,
) -> Result<CodeParts, Unfit> {
    check(output)?;
    let named = Named::from_model(model, tables, &options.prefix);
    let o = &named.outline(model, output);
    let chosen = Selection::new(output);
    let mut support = Support::of_kernels();
    let steps = steps::Steps::new(model, output);
    let bodies = bodies(model, output, &chosen, &steps, o, &mut support)?;
    let functions = signatures(model, output, &chosen, &steps, o);
    let mut left_out = chosen.left_out.clone();
    left_out.extend(options.left_out.iter().cloned());
    let mut types = sizes(model, output, o);
    types.push_str(&parameter_types(model, o));
    types.push_str(&frames::indices(o, &frame_names(model)));
    Ok(CodeParts {
        prefix: o.prefix.clone(),
        about: description(model),
        types,
        definitions: format!("{}\n{}", support.text(model.nv(), &o.prefix), bodies.trim_end()),
        functions,
        parameters: named.parameters.clone(),
        tables: named.tables.clone(),
        left_out,
    })
}

/// Returns the signatures of all functions that a program can call.
fn signatures(
    model: &Model<'_>,
    output: &Output,
    chosen: &Selection<'_>,
    steps: &steps::Steps<'_>,
    o: &Outline<'_>,
) -> Vec<Batch> {
    let mut functions: Vec<Batch> = chosen.public.iter().map(|f| Batch::from_function(f, o)).collect();
    functions.extend(chosen.reactions.iter().map(|f| {
        let name = names::letters(f.name.strip_prefix(REACTION).unwrap_or_default());
        Batch::new(&name, &reaction_arguments(model), f.shape, &[reaction_docs(&name)], o)
    }));
    functions.extend(chosen.limits.map(|_| Batch::plain("limits", &[], &LIMITS.map(|name| (name, o.nv)))));
    functions.extend(manifold::batches(o));
    functions.extend(steps.batches(o));
    functions.extend(frames::batches(output, o));
    functions
}

/// Names and signatures of a mechanism in C.
pub struct Signatures {
    /// Prefix of all names of the mechanism in C.
    pub prefix: String,
    /// Functions that a program can call.
    pub functions: Vec<Batch>,
    /// Names of the functions for outputs.
    pub outputs: Vec<String>,
    /// Members of the parameter struct.
    pub parameters: Vec<String>,
    /// Members of the parameter struct that are tables.
    pub tables: Vec<String>,
}

impl Signatures {
    /// Returns the signatures of the functions that [`write`](super::write) writes.
    pub fn new(model: &Model<'_>, output: &Output, tables: &[String], prefix: &str) -> Signatures {
        let named = Named::from_model(model, tables, prefix);
        let o = &named.outline(model, output);
        let chosen = Selection::new(output);
        let functions = signatures(model, output, &chosen, &steps::Steps::new(model, output), o);
        let own = chosen.public.iter().filter(|f| f.id == Id::Output).map(|f| names::letters(&f.name));
        let reactions = chosen.reactions.iter().filter_map(|f| f.name.strip_prefix(REACTION));
        let outputs = own.chain(reactions.map(names::letters)).collect();
        let prefix = o.prefix.clone();
        Signatures { prefix, functions, outputs, parameters: named.parameters, tables: named.tables }
    }
}
