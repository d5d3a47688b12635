//! Functions of a mechanism, read from its generated Rust code.

use linkwork_compiler::export::without_doc_links;
use quote::ToTokens;
use std::fmt::Write;
use syn::{FnArg, GenericArgument, ImplItem, Item, PathArguments, ReturnType, Type};

/// Kind of an argument of a library function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FunctionArgumentKind {
    /// Number passed by value.
    Number,
    /// Matrix with these numbers of rows and columns.
    Matrix(usize, usize),
    /// Selection of velocities: nonzero entries are selected.
    Marks,
    /// Frame, passed by its index.
    Frame,
}

/// Function of the exported library, with an interface of plain arrays.
#[derive(Clone, Debug)]
pub struct Function {
    /// Name of the library function.
    pub name: String,
    /// Paragraphs of the library function's documentation.
    pub docs: Vec<String>,
    /// Names and kinds of the library function's arguments.
    pub arguments: Vec<(String, FunctionArgumentKind)>,
    /// Names and shapes of the results: an empty shape for a number, otherwise the lengths of its dimensions.
    pub results: Vec<(String, Vec<usize>)>,
    /// Call expression of `m` that reads the arguments from `g`.
    pub call: String,
    /// Expression that calls the function for several states in SIMD lanes, if such a function exists.
    pub lanes: Option<String>,
}

impl Function {
    /// Returns the number of array entries of an argument.
    pub fn argument_length(kind: &FunctionArgumentKind, nv: usize) -> usize {
        match kind {
            FunctionArgumentKind::Number | FunctionArgumentKind::Frame => 1,
            FunctionArgumentKind::Matrix(rows, columns) => rows * columns,
            FunctionArgumentKind::Marks => nv,
        }
    }
}

/// Returns all functions of the struct that can be called with plain arrays, and the names of the functions
/// that cannot.
pub fn read_struct_functions(items: &[Item], mechanism: &str) -> (Vec<Function>, Vec<String>) {
    let (mut found, mut left_out, mut names) = (Vec::new(), Vec::new(), Vec::new());
    for item in items {
        let Item::Impl(block) = item else { continue };
        let is_own = matches!(&*block.self_ty, Type::Path(path) if path.path.segments.last().is_some_and(|s| s.ident == mechanism));
        if block.trait_.is_some()
            || !is_own
            || is_block_of_absent_functions(block.generics.where_clause.as_ref())
        {
            continue;
        }
        for inner in &block.items {
            let ImplItem::Fn(function) = inner else { continue };
            let name = function.sig.ident.to_string();
            let is_public = matches!(function.vis, syn::Visibility::Public(_));
            let of_state =
                matches!(function.sig.inputs.first(), Some(FnArg::Receiver(own)) if own.mutability.is_none());
            if !is_public || !of_state || name.starts_with("__") || name == "validate" {
                continue;
            }
            let in_lanes = name.strip_suffix("_lanes").filter(|_| is_batched_over_states(function));
            if let Some(one) = in_lanes {
                names.push(one.to_string());
            } else if let Some(function) = function_from_impl_item(&name, function) {
                found.push(function);
            } else if !is_exported_under_other_name(&name) {
                left_out.push(name);
            }
        }
    }
    for function in found.iter_mut().filter(|f| names.contains(&f.name)) {
        let own = format!("{}(", function.name);
        function.lanes = Some(function.call.replacen(&own, &format!("{}_lanes(", function.name), 1));
    }
    (found, left_out)
}

/// Returns whether a block contains placeholder functions that only explain why a function does not exist.
fn is_block_of_absent_functions(bounds: Option<&syn::WhereClause>) -> bool {
    bounds.is_some_and(|bounds| bounds.to_token_stream().to_string().contains("absent"))
}

/// Returns whether a function evaluates several states at once: its number of states is a const parameter.
fn is_batched_over_states(function: &syn::ImplItemFn) -> bool {
    function.sig.generics.const_params().next().is_some()
}

/// Returns whether a generated function is exported under another name.
fn is_exported_under_other_name(name: &str) -> bool {
    name.ends_with("_into") || name.starts_with("frame_")
}

fn function_from_impl_item(name: &str, function: &syn::ImplItemFn) -> Option<Function> {
    if !function.sig.generics.params.is_empty() {
        return None;
    }
    let mut arguments = Vec::new();
    for input in function.sig.inputs.iter().skip(1) {
        let FnArg::Typed(typed) = input else { return None };
        let kind = match &*typed.ty {
            Type::Reference(reference) if reference.mutability.is_none() => {
                kind_of_referenced_argument(&reference.elem)?
            }
            plain => (is_number_type(plain)).then_some(FunctionArgumentKind::Number)?,
        };
        arguments.push((typed.pat.to_token_stream().to_string(), kind));
    }
    let ReturnType::Type(_, kind) = &function.sig.output else { return None };
    let is_mode = is_optional_sign_type(kind);
    let shapes = if is_mode { vec![Vec::new()] } else { shapes_of_results(kind)? };
    let results = result_names(name, shapes.len()).into_iter().zip(shapes).collect();
    let list: Vec<String> = arguments
        .iter()
        .enumerate()
        .map(|(k, (_, kind))| match kind {
            FunctionArgumentKind::Number => format!("given(g, {k})"),
            FunctionArgumentKind::Marks => format!("&g.marked({k})"),
            _ => format!("&given(g, {k})"),
        })
        .collect();
    let call = format!("m.{name}({}){}", list.join(", "), if is_mode { ".unwrap_or(0)" } else { "" });
    let mut docs = doc_paragraphs(&function.attrs);
    if is_mode {
        docs.iter_mut().for_each(|text| *text = text.replace("`None`", "zero"));
    }
    Some(Function { name: name.to_string(), docs, arguments, results, call, lanes: None })
}

/// Returns the text of documentation comments as paragraphs.
pub fn doc_paragraphs(attributes: &[syn::Attribute]) -> Vec<String> {
    let lines = attributes.iter().filter_map(|attribute| match &attribute.meta {
        syn::Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            syn::Expr::Lit(literal) => match &literal.lit {
                syn::Lit::Str(text) => Some(text.value()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    });
    let text: Vec<String> = lines.map(|line| line.trim().to_string()).collect();
    let text = text.join("\n");
    // List items remain on separate lines.
    let join_paragraph_lines =
        |text: &str| text.trim().replace("\n- ", "\0- ").replace('\n', " ").replace('\0', "\n");
    let paragraphs = text.split("\n\n").map(join_paragraph_lines);
    paragraphs.filter(|paragraph| !paragraph.is_empty()).collect()
}

/// Converts documentation for readers without Rust: returns the paragraphs, and the description of errors.
pub fn docs_without_rust_notation(docs: &[String]) -> (Vec<String>, String) {
    let plain: Vec<String> =
        docs.iter().map(|paragraph| without_doc_links(&remove_trait_reference(paragraph))).collect();
    let begin = plain.iter().position(|paragraph| paragraph.starts_with(ERRORS)).unwrap_or(plain.len());
    let (about, errors) = plain.split_at(begin);
    (about.to_vec(), error_condition_without_variants(errors.join(" ").trim_start_matches(ERRORS).trim()))
}

const ERRORS: &str = "# Errors";

/// Removes the reference to a trait from a paragraph.
fn remove_trait_reference(paragraph: &str) -> String {
    let end = " of the trait.";
    match (paragraph.find(" See ["), paragraph.find(end)) {
        (Some(from), Some(to)) if from < to => {
            format!("{}{}", &paragraph[..from], &paragraph[to + end.len()..])
        }
        _ => paragraph.to_string(),
    }
}

/// Returns the condition of an error without the names of its variants in Rust: `` `Held` for an index ``
/// becomes "for an index".
fn error_condition_without_variants(text: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    let is_followed_by_condition = |k: usize| {
        parts.get(k + 1).is_some_and(|next| [" if ", " for "].iter().any(|word| next.starts_with(word)))
    };
    let mut out = String::new();
    for (k, part) in parts.iter().enumerate() {
        match k % 2 {
            0 if k > 0 && is_followed_by_condition(k - 1) => out.push_str(part.trim_start()),
            1 if !is_followed_by_condition(k) => {
                let _ = write!(out, "`{part}`");
            }
            0 => out.push_str(part),
            _ => {}
        }
    }
    out
}

/// Names of types that are never the scalar type of the mechanism.
const OTHERS: [&str; 5] = ["Self", "bool", "str", "u64", "usize"];

fn is_number_type(kind: &Type) -> bool {
    matches!(kind, Type::Path(path) if path.path.get_ident().is_some_and(|name| !OTHERS.iter().any(|other| name == other)))
}

/// Returns whether a type is `Option<i8>`, a sign that may be undetermined. Plain arrays contain zero for
/// `None`.
fn is_optional_sign_type(kind: &Type) -> bool {
    type_name_with_arguments(kind).is_some_and(|(name, types, _)| {
        name == "Option" && types.iter().all(|inner| inner.to_token_stream().to_string() == "i8")
    })
}

fn kind_of_referenced_argument(kind: &Type) -> Option<FunctionArgumentKind> {
    if let Type::Slice(slice) = kind {
        return (slice.elem.to_token_stream().to_string() == "usize").then_some(FunctionArgumentKind::Marks);
    }
    match dimensions_of_type(kind)?.as_slice() {
        [n] => Some(FunctionArgumentKind::Matrix(*n, 1)),
        [rows, columns] => Some(FunctionArgumentKind::Matrix(*rows, *columns)),
        _ => None,
    }
}

/// Returns the last identifier of a type's path, with its type arguments and integer arguments.
fn type_name_with_arguments(kind: &Type) -> Option<(String, Vec<Type>, Vec<usize>)> {
    let Type::Path(path) = kind else { return None };
    let last = path.path.segments.last()?;
    let (mut types, mut sizes) = (Vec::new(), Vec::new());
    if let PathArguments::AngleBracketed(list) = &last.arguments {
        for argument in &list.args {
            match argument {
                GenericArgument::Type(kind) => types.push(kind.clone()),
                GenericArgument::Const(syn::Expr::Lit(literal)) => match &literal.lit {
                    syn::Lit::Int(number) => sizes.push(number.base10_parse().ok()?),
                    _ => return None,
                },
                _ => return None,
            }
        }
    }
    Some((last.ident.to_string(), types, sizes))
}

/// Returns the array dimensions of a type that is a number, a vector or a matrix.
fn dimensions_of_type(kind: &Type) -> Option<Vec<usize>> {
    if is_number_type(kind) {
        return Some(Vec::new());
    }
    let (name, _, sizes) = type_name_with_arguments(kind)?;
    match (name.as_str(), sizes.as_slice()) {
        ("SVector", [n]) => Some(vec![*n]),
        ("SMatrix", [rows, columns]) => Some(vec![*rows, *columns]),
        _ => None,
    }
}

/// Returns the shapes of all results of a function with this return type.
fn shapes_of_results(kind: &Type) -> Option<Vec<Vec<usize>>> {
    if let Type::Tuple(tuple) = kind {
        if tuple.elems.is_empty() || tuple.elems.len() > 6 {
            return None;
        }
        return tuple.elems.iter().map(dimensions_of_type).collect();
    }
    if let Type::Array(array) = kind {
        let (name, ..) = type_name_with_arguments(&array.elem)?;
        let length = array.len.to_token_stream().to_string().parse().ok()?;
        return (name == "IsometryMatrix3").then_some(vec![vec![length, 4, 4]]);
    }
    if let Some(shape) = dimensions_of_type(kind) {
        return Some(vec![shape]);
    }
    let (name, types, sizes) = type_name_with_arguments(kind)?;
    match (name.as_str(), sizes.as_slice()) {
        ("Result", []) => shapes_of_results(types.first()?),
        ("OutputJacobians", [rows, n, m]) => {
            Some(vec![vec![*rows, *n], vec![*rows, *n], vec![*rows, *n], vec![*rows, *m]])
        }
        ("Linearization", [nx, nu, np, ns]) => {
            Some(vec![vec![*nx, *nx], vec![*nx, *nu], vec![*np], vec![*ns]])
        }
        _ => None,
    }
}

/// Returns the names of results; derivatives are named by the variables of differentiation.
fn result_names(function: &str, count: usize) -> Vec<String> {
    let names: &[&str] = match (function, count) {
        (_, 1) => &["result"],
        ("linearize", 2) => &["a", "b"],
        ("linearize", _) => &["a", "b", "coordinates", "speeds"],
        ("constrained_dynamics" | "try_constrained_dynamics", _) => &["acceleration", "multipliers"],
        ("inverse_dynamics_second_derivatives", _) => &["by_qq", "by_qv", "by_vv", "by_qa"],
        ("forward_dynamics_second_derivatives", _) => &["by_qq", "by_qv", "by_vv", "by_qtau"],
        (_, 6) => &["by_qq", "by_qv", "by_vv", "by_qu", "by_vu", "by_uu"],
        ("generalized_forces_derivatives", 3) => &["by_q", "by_v", "by_u"],
        ("integrate_derivatives", _) => &["by_q", "by_dv"],
        ("tangent_rate_derivatives", _) => &["by_dv", "by_v"],
        (_, 2) => &["by_q", "by_v"],
        (_, 3) => &["by_q", "by_v", "by_tau"],
        _ => &["by_q", "by_v", "by_a", "by_u"],
    };
    names.iter().map(ToString::to_string).collect()
}
