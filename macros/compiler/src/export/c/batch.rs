//! Signatures of the functions, from which kernels for many states are made.

use super::docs::{self, without_links};
use super::function::{Outline, function_documentation, is_passed, public_name};
use crate::catalogue::{Argument, Shape};
use crate::derive::Function;

/// Array argument that a C function reads or writes for one state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Array {
    /// Name of the array argument in C.
    pub name: String,
    /// Number of entries of the array.
    pub length: usize,
    /// Meaning and size of the array, as text for the documentation.
    pub about: String,
    /// Whether the function takes the value of the only entry instead of an array.
    pub is_value: bool,
}

/// Signature of a C function that a program can call.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Name of the C function without the prefix.
    pub name: String,
    /// Arguments after the parameters and the index of the frame.
    pub arguments: Vec<Array>,
    /// Result arrays, in the order of the arguments that receive them.
    pub results: Vec<Array>,
    /// Whether the C function has a single result and returns it by value.
    pub returns: bool,
    /// Whether the function takes the index of a named frame.
    pub of_frame: bool,
    /// Documentation of the C function, one paragraph per entry.
    pub docs: Vec<String>,
}

impl Batch {
    /// Returns the C signature of a derived function.
    pub fn from_function(f: &Function, o: &Outline<'_>) -> Batch {
        Batch::new(&public_name(f), &f.arguments, f.shape, &function_documentation(f), o)
    }

    /// Returns the description of the signature of a C function with these arguments and a result of this
    /// shape.
    pub fn new(name: &str, arguments: &[Argument], shape: Shape, docs: &[String], o: &Outline<'_>) -> Batch {
        let mut results: Vec<Array> = shape
            .result_arrays()
            .into_iter()
            .map(|(name, rows, columns)| Array::matrix_array(name, rows, columns))
            .collect();
        let returns = results.is_empty();
        if returns {
            results.push(Array::new("result", 1));
        }
        let docs = docs.iter().map(|text| without_links(text)).collect();
        let mut batch = Batch { results, returns, docs, ..Batch::vector_signature(name, &[], &[]) };
        batch.arguments =
            arguments.iter().filter(|a| is_passed(a)).map(|a| Array::from_argument(*a, o)).collect();
        batch
    }

    /// Returns the signature of a handwritten function with vectors as results.
    pub fn handwritten_signature(
        name: &str,
        arguments: &[Argument],
        results: &[(&str, usize)],
        docs: &str,
        o: &Outline<'_>,
    ) -> Batch {
        let arguments = arguments.iter().map(|a| Array::from_argument(*a, o)).collect();
        Batch { arguments, docs: vec![docs.to_string()], ..Batch::vector_signature(name, &[], results) }
    }

    /// Returns the C signature of a function whose arguments are vectors.
    pub fn vector_signature(name: &str, arguments: &[(&str, usize)], results: &[(&str, usize)]) -> Batch {
        let arrays_from_names =
            |list: &[(&str, usize)]| list.iter().map(|(name, n)| Array::new(name, *n)).collect();
        Batch {
            name: name.to_string(),
            arguments: arrays_from_names(arguments),
            results: arrays_from_names(results),
            returns: false,
            of_frame: false,
            docs: Vec::new(),
        }
    }
}

impl Array {
    /// Returns the description of an array argument for a vector.
    pub fn new(name: &str, length: usize) -> Array {
        Array { name: name.to_string(), length, about: docs::count_in_words(length), is_value: false }
    }

    /// Returns the description of an array argument for a matrix stored by columns.
    pub fn matrix_array(name: &str, rows: usize, columns: usize) -> Array {
        let about = match columns {
            1 => docs::count_in_words(rows),
            _ => format!("{rows} by {columns}, column by column"),
        };
        Array { about, ..Array::new(name, rows * columns) }
    }

    /// Returns the description of a scalar argument that is passed by value.
    pub fn value_argument(name: &str, about: &str) -> Array {
        Array { about: about.to_string(), is_value: true, ..Array::new(name, 1) }
    }

    fn from_argument(argument: Argument, o: &Outline<'_>) -> Array {
        let about = docs::argument_description(argument);
        match argument {
            Argument::T => Array::value_argument("t", about),
            a => {
                let length = o.length(a);
                Array {
                    about: format!("{about}, {}", docs::count_in_words(length)),
                    ..Array::new(a.argument_name(), length)
                }
            }
        }
    }
}
