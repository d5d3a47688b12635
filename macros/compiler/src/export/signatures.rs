//! Signatures of the functions outside Rust: names, arguments, results and documentation.

use super::comments::{argument_description, c_function_comment, format_number_count, without_doc_links};
use super::mechanism::ExportedMechanism;
use super::names::replace_invalid_characters;
use crate::catalogue::{Argument, GeneratedId, REACTION, Shape};
use crate::derive::Function;

/// Array argument that a function reads or writes for one state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArrayArgument {
    /// Name of the argument.
    pub name: String,
    /// Number of rows of the matrix; for a vector its length.
    pub rows: usize,
    /// Number of columns of the matrix, which is stored column by column; 1 for a vector.
    pub columns: usize,
    /// Meaning and size of the array, as text for the documentation.
    pub about: String,
    /// Whether the function takes the value of the only entry instead of an array.
    pub is_value: bool,
}

impl ArrayArgument {
    /// Returns the description of an array argument for a vector.
    pub fn vector(name: &str, length: usize) -> ArrayArgument {
        ArrayArgument::matrix(name, length, 1)
    }

    /// Returns the description of an array argument for a matrix stored by columns.
    pub fn matrix(name: &str, rows: usize, columns: usize) -> ArrayArgument {
        let about = match columns {
            1 => format_number_count(rows),
            _ => format!("{rows} by {columns}, column by column"),
        };
        ArrayArgument { name: name.to_string(), rows, columns, about, is_value: false }
    }

    /// Returns the description of a scalar argument that is passed by value.
    pub fn scalar_value(name: &str, about: &str) -> ArrayArgument {
        ArrayArgument { about: about.to_string(), is_value: true, ..ArrayArgument::vector(name, 1) }
    }

    /// Returns the number of entries of the array.
    pub fn length(&self) -> usize {
        self.rows * self.columns
    }

    /// Returns the description of an argument of a derived function.
    pub fn from_argument(argument: Argument, i: &ExportedMechanism<'_>) -> ArrayArgument {
        let about = argument_description(argument);
        match argument {
            Argument::T => ArrayArgument::scalar_value("t", about),
            a => {
                let length = a.argument_length([i.nq(), i.nv(), i.nu()]);
                let about = format!("{about}, {}", format_number_count(length));
                ArrayArgument { about, ..ArrayArgument::vector(a.argument_name(), length) }
            }
        }
    }
}

/// ExportedSignature of a function that a program can call.
#[derive(Clone, Debug)]
pub struct ExportedSignature {
    /// Name of the function without the prefix.
    pub name: String,
    /// Arguments after the parameters and the index of the frame.
    pub arguments: Vec<ArrayArgument>,
    /// Result arrays, in the order of the arguments that receive them.
    pub results: Vec<ArrayArgument>,
    /// Whether the function has a single result and returns it by value.
    pub returns: bool,
    /// Whether the function takes the index of a named frame.
    pub of_frame: bool,
    /// Documentation of the function, one paragraph per entry.
    pub docs: Vec<String>,
}

impl ExportedSignature {
    /// Returns the signature of a derived function.
    pub fn from_function(f: &Function, i: &ExportedMechanism<'_>) -> ExportedSignature {
        let arguments: Vec<Argument> = f.arguments.iter().copied().filter(is_passed).collect();
        ExportedSignature::new(&public_name(f), &arguments, f.shape, function_documentation(f), i)
    }

    fn new(
        name: &str,
        arguments: &[Argument],
        shape: Shape,
        docs: Vec<String>,
        i: &ExportedMechanism<'_>,
    ) -> ExportedSignature {
        let results = shape.result_arrays();
        let results: Vec<ArrayArgument> = results
            .into_iter()
            .map(|(name, rows, columns)| ArrayArgument::matrix(name, rows, columns))
            .collect();
        let returns = results.is_empty();
        ExportedSignature {
            name: name.to_string(),
            arguments: arguments.iter().map(|a| ArrayArgument::from_argument(*a, i)).collect(),
            results: if returns { vec![ArrayArgument::vector("result", 1)] } else { results },
            returns,
            of_frame: false,
            docs,
        }
    }

    /// Returns the names of the arguments and of the arrays that receive results.
    pub fn array_names(&self) -> impl Iterator<Item = &str> {
        let results = self.results.iter().filter(|_| !self.returns);
        self.arguments.iter().chain(results).map(|array| array.name.as_str())
    }

    /// Returns the comment that documents the function: its arguments and these results with their sizes.
    pub fn function_comment(&self, results: &[ArrayArgument]) -> String {
        let arguments = self.arguments.iter().map(|a| (a.name.as_str(), a.about.clone()));
        let results = results.iter().map(|a| (a.name.as_str(), format!("out: {}", a.about)));
        c_function_comment(&self.docs, arguments.chain(results))
    }

    /// Returns the array element to which output `k` is written: the result arrays follow one another.
    pub fn element_of_output(&self, mut k: usize) -> Option<String> {
        for array in &self.results {
            if k < array.length() {
                return Some(format!("{}[{k}]", array.name));
            }
            k -= array.length();
        }
        None
    }
}

/// Returns a list of arrays with their lengths, in the syntax of Python.
pub fn python_array_list(arrays: &[ArrayArgument]) -> String {
    let entries: Vec<String> = arrays.iter().map(|a| format!("({:?}, {})", a.name, a.length())).collect();
    format!("[{}]", entries.join(", "))
}

/// Returns the name of the output that a reaction provides.
pub fn reaction_name(f: &Function) -> &str {
    f.name.strip_prefix(REACTION).unwrap_or_default()
}

/// Returns the signature of an output that is a reaction, in the motion that state and inputs determine.
pub fn reaction_signature(f: &Function, i: &ExportedMechanism<'_>) -> ExportedSignature {
    let name = replace_invalid_characters(reaction_name(f));
    let docs = format!(
        "The output `{name}` in the motion that state and inputs determine. A reaction is the force or \
         torque that the parent of a joint exerts on its child, at the origin of the joint's frame."
    );
    let time = i.model.time.then_some(Argument::T);
    let inputs = (i.nu() > 0).then_some(Argument::U);
    let arguments: Vec<Argument> = time.into_iter().chain([Argument::Q, Argument::V]).chain(inputs).collect();
    ExportedSignature::new(&name, &arguments, f.shape, vec![docs], i)
}

/// Returns false for arguments that do not occur in signatures.
fn is_passed(argument: &Argument) -> bool {
    !matches!(argument, Argument::Into(..) | Argument::Called(_))
}

/// Returns the identifier of a function without the underscore that marks internal functions.
pub fn public_identifier(name: &str) -> String {
    replace_invalid_characters(name.trim_start_matches('_'))
}

/// Returns the public name of a derived function.
fn public_name(f: &Function) -> String {
    match f.id {
        GeneratedId::InputDerivatives => "generalized_forces_derivatives".to_string(),
        _ => public_identifier(&f.name),
    }
}

/// Returns the documentation of a derived function outside Rust.
fn function_documentation(f: &Function) -> Vec<String> {
    let docs: &[&str] = match f.id {
        GeneratedId::InputDerivatives => {
            &["`(∂τ/∂q, ∂τ/∂v, ∂τ/∂u)` of the inputs' `generalized_forces`. Column `i` of \
                                   a derivative by `q` is along `q ⊕ ε eᵢ` (see `integrate`)."]
        }
        GeneratedId::ContactLaws => {
            &["Coefficients of friction, restitution and static friction of each contact, in \
                              the order of the gaps."]
        }
        GeneratedId::MotionDerivatives => &[
            "Derivatives of `M a + h − Jᵀ λ` and of the constraint accelerations `J a + b` by `q` and `v`, \
             at given accelerations `a` and multipliers `lambda`; derivatives of the constraint rates by `q`; \
             and the rotation of displacements in rotating axes, the derivative of their rates. Column `i` \
             of a derivative by `q` is along `q ⊕ ε eᵢ` (see `integrate`).",
            "The derivatives `dv̇` and `dλ` of a motion solve `M dv̇ − Jᵀ dλ = dτ − forces_by_x`, \
             `J dv̇ = −bias_by_x`.",
        ],
        _ => return f.docs.iter().map(|text| without_doc_links(text)).collect(),
    };
    docs.iter().map(ToString::to_string).collect()
}
