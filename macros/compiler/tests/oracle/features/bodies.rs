//! Comparison of generated Rust code with the programs it was generated from. Function bodies are interpreted
//! for one state, for one state in debug builds, and for several states. Constants are compared with the
//! functions that they describe.

use super::agreement::{SAME, largest_magnitude, sum_of_vectors};
use super::values::Values;
use crate::emitted::{InterpretationError, InterpreterState, Value};
use linkwork_compiler::catalogue::{Argument, Shape};
use linkwork_compiler::derive::{DerivationOutput, Function};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::{Chart, Model, SuppliedQuantity};
use linkwork_compiler::{compile, expand, parse_source_and_import};
use proc_macro2::TokenStream;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::{Block, Expr, FnArg, ImplItem, ImplItemFn, Item, ItemImpl, Pat, Stmt, Type};

/// Functions and constants of the mechanism's inherent implementations, and the bodies of `Evaluate`
/// implementations by number.
#[derive(Default)]
struct EmittedCode {
    functions: BTreeMap<String, ImplItemFn>,
    constants: BTreeMap<String, Expr>,
    bodies: BTreeMap<String, Vec<ImplItemFn>>,
}

/// Returns the code emitted for each struct (the mechanism, and the struct with prepared parameters), which
/// numbers its bodies apart from others.
fn parse_emitted_code(text: &str) -> Vec<EmittedCode> {
    let mut all: BTreeMap<String, EmittedCode> = BTreeMap::new();
    for item in syn::parse_file(text).expect("Rust").items {
        let Item::Impl(block) = item else { continue };
        let Type::Path(of) = &*block.self_ty else { continue };
        let of = of.path.segments.last().map(|last| last.ident.to_string()).unwrap_or_default();
        let code = all.entry(of).or_default();
        // Functions in blocks with bounds only report that they are absent.
        let (number, other) =
            (scalar_type_of_impl(&block), block.trait_.is_some() || block.generics.where_clause.is_some());
        for member in block.items {
            let function = match member {
                ImplItem::Fn(function) => function,
                ImplItem::Const(constant) if !other => {
                    code.constants.insert(constant.ident.to_string(), constant.expr);
                    continue;
                }
                _ => continue,
            };
            match &number {
                Some(number) => code.bodies.entry(number.clone()).or_default().push(function),
                None if !other => drop(code.functions.insert(function.sig.ident.to_string(), function)),
                None => {}
            }
        }
    }
    all.into_values().collect()
}

/// Returns the scalar type of a generated `impl`, which is the first type argument of its trait
/// `Evaluate<…>`.
fn scalar_type_of_impl(block: &ItemImpl) -> Option<String> {
    let of = block.trait_.as_ref()?.0.segments.last().filter(|last| last.ident == "Evaluate")?.clone();
    first_type_argument(&of.arguments)
}

fn first_type_argument(arguments: &syn::PathArguments) -> Option<String> {
    let syn::PathArguments::AngleBracketed(types) = arguments else { return None };
    types.args.first().map(|first| quote::quote!(#first).to_string())
}

/// Returns the bodies of a generated function, or of those that it dispatches to, with the patterns of their
/// arguments.
fn bodies_of_function<'w>(written: &'w EmittedCode, name: &str) -> Vec<(Vec<Pat>, &'w Block)> {
    let Some(function) = written.functions.get(name) else { return Vec::new() };
    let argument_patterns = |function: &ImplItemFn| -> Vec<Pat> {
        let typed = function.sig.inputs.iter().filter_map(|input| match input {
            FnArg::Typed(typed) => Some((*typed.pat).clone()),
            FnArg::Receiver(_) => None,
        });
        typed.collect()
    };
    if let [Stmt::Expr(Expr::Call(call), None)] = function.block.stmts.as_slice()
        && let Expr::Path(called) = &*call.func
        && let Some(last) = called.path.segments.last().filter(|last| last.ident == "dispatch")
    {
        let number = first_type_argument(&last.arguments).expect("a number");
        let all = written.bodies.get(&number).unwrap_or_else(|| panic!("{name} has no body {number}"));
        return all
            .iter()
            .map(|body| match argument_patterns(body).as_slice() {
                [Pat::Tuple(tuple)] => (tuple.elems.iter().cloned().collect(), &body.block),
                other => panic!("{} arguments of a body of {name}", other.len()),
            })
            .collect();
    }
    vec![(argument_patterns(function), &function.block)]
}

/// Combines the values of an argument for several states to lanes.
fn combine_to_lanes(all: &[Value]) -> Value {
    match &all[0] {
        Value::List(list) => {
            let lanes_of_entry = |k: usize| {
                let column: Vec<Value> = all
                    .iter()
                    .map(|value| if let Value::List(list) = value { list[k].clone() } else { value.clone() })
                    .collect();
                combine_to_lanes(&column)
            };
            Value::List((0..list.len()).map(lanes_of_entry).collect())
        }
        _ => Value::Lanes(all.iter().map(|value| value.numbers_of_lane(0).expect("a number")[0]).collect()),
    }
}

fn argument_value(a: Argument, values: &Values) -> Option<Value> {
    let vector_value = |list: &[f64]| Value::List(vec![Value::list_of_numbers(list)]);
    Some(match a {
        Argument::T => Value::Number(values.t),
        Argument::Q => vector_value(&values.q),
        Argument::V => vector_value(&values.v),
        Argument::A => vector_value(&values.a),
        Argument::Tau => vector_value(&values.tau),
        Argument::U => vector_value(&values.u),
        Argument::Standard(n) => vector_value(&values.supplied_values(SuppliedQuantity::Inertia)[..n]),
        Argument::Factors(n) => vector_value(&values.supplied_values(SuppliedQuantity::Factor)[..n]),
        Argument::Momenta(n) => vector_value(&values.given[..n]),
        Argument::Given(_, SuppliedQuantity::ContactForces, count) => {
            Value::list_of_numbers(values.contact_forces.get(..count)?)
        }
        Argument::Given(_, block, count) => {
            Value::list_of_numbers(values.supplied_values(block).get(..count)?)
        }
        Argument::Into(_, n) => Value::List(vec![Value::list_of_numbers(&vec![0.0; n]); n]),
        Argument::Called(_) => return None,
    })
}

/// Interprets and compares all generated function bodies that call no other functions. Returns their names
/// with the number of the body.
pub fn compare_interpreted_function_bodies(arguments: &str, item: &str, seed: u64) -> BTreeSet<String> {
    let parse_tokens = |text: &str| -> TokenStream { text.parse().expect("the source is Rust") };
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let source = parse_source_and_import(parse_tokens(arguments), parse_tokens(item), Path::new(""), &mut cx);
    let Some((model, output)) = source.as_ref().and_then(|source| compile(source, &graph, &mut cx)) else {
        return BTreeSet::new();
    };
    let emitted = expand(parse_tokens(arguments), parse_tokens(item), Path::new(""));
    let mut run = BTreeSet::new();
    for written in parse_emitted_code(&emitted.text) {
        let about = format!("seed {seed}\n#[mechanism({arguments})]\n{item}");
        check_index_constants(&model, &output, &written, seed, &about);
        for f in &output.functions {
            for (suffix, states) in [("", 1), ("_lanes", 2)] {
                let name = format!("{}{suffix}", f.name);
                for (k, body) in bodies_of_function(&written, &name).into_iter().enumerate() {
                    let name = format!("{name}, body {k}");
                    if check_emitted_body(
                        &model,
                        &output,
                        f,
                        &body,
                        (states, seed),
                        &format!("{name}, {about}"),
                    ) {
                        run.insert(name);
                    }
                }
            }
        }
    }
    run
}

/// Compares two constants with the functions: the entries of the generalized forces that equal inputs, and
/// the velocities of ball and free joints.
fn check_index_constants(
    model: &Model<'_>,
    output: &DerivationOutput,
    written: &EmittedCode,
    seed: u64,
    about: &str,
) {
    let optional_constant_entries =
        |name: &str| written.constants.get(name).map(numbers_in_option_expression);
    let forces = output.functions.iter().find(|f| f.name == "generalized_forces");
    let (Some(direct), Some(turned), Some(forces)) =
        (optional_constant_entries("__DIRECT_INPUTS"), optional_constant_entries("__TURNED"), forces)
    else {
        return;
    };
    let ends = model.charts.iter().filter_map(|chart| match *chart {
        Chart::Plain(..) => None,
        Chart::Ball(_, v) => Some([v.0, v.0 + 3]),
        Chart::Free(_, v) => Some([v.0, v.0 + 6]),
    });
    let ends: Vec<usize> = ends.flatten().collect();
    let range = [ends.iter().min(), ends.iter().max()].map(|end| end.copied().unwrap_or(0));
    assert_eq!(turned, model.speeds.is_none().then(|| range.to_vec()), "velocities that turn, {about}");

    // An entry equals an input if it changes by the same amount for random states, parameters and inputs.
    let all = [seed, seed + 1000].map(|seed| Values::random_values(model, seed));
    let u = all[0].u.clone();
    let unit_vector =
        |k: usize, n: usize| -> Vec<f64> { (0..n).map(|i| f64::from(u8::from(i == k))).collect() };
    let force_of_unit_input = |values: &Values, k: usize| -> Vec<f64> {
        let changed = Values { u: sum_of_vectors(&values.u, &unit_vector(k, u.len())), ..values.clone() };
        let (after, before) = (changed.run_function(output, forces), values.run_function(output, forces));
        after.iter().zip(before).map(|(a, b)| a - b).collect()
    };
    let are_nearly_equal = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME);
    let velocity_driven_by_input = |k: usize| {
        (0..model.nv()).find(|v| {
            all.iter()
                .all(|values| are_nearly_equal(&force_of_unit_input(values, k), &unit_vector(*v, model.nv())))
        })
    };
    let [here, there] = all.each_ref().map(|values| {
        let values = Values { u: u.clone(), t: all[0].t, ..values.clone() };
        Values { parameters: all[0].parameters.clone(), ..values }.run_function(output, forces)
    });
    let expected: Option<Vec<usize>> = (0..u.len()).map(velocity_driven_by_input).collect();
    assert_eq!(direct, expected.filter(|_| are_nearly_equal(&here, &there)), "places of inputs, {about}");
}

/// Returns the numbers in `Some([…])` or `Some((…))`; `None` for `None`.
fn numbers_in_option_expression(expr: &Expr) -> Option<Vec<usize>> {
    let Expr::Call(call) = expr else { return None };
    let list = match &call.args[0] {
        Expr::Array(array) => &array.elems,
        Expr::Tuple(tuple) => &tuple.elems,
        other => panic!("{}", quote::quote!(#other)),
    };
    let parse_number = |expr: &Expr| quote::quote!(#expr).to_string().parse().expect("a number");
    Some(list.iter().map(parse_number).collect())
}

/// Runs the emitted body of a function and compares its results with those of the function's program. Returns
/// false if the body calls other functions or an argument has no test value.
fn check_emitted_body(
    model: &Model<'_>,
    output: &DerivationOutput,
    f: &Function,
    (patterns, body): &(Vec<Pat>, &Block),
    (states, seed): (usize, u64),
    about: &str,
) -> bool {
    let all: Vec<Values> =
        (0..states as u64).map(|k| Values::random_values(model, seed + 1000 * k)).collect();
    let parameters = &all[0].parameters;
    // The states share their parameters.
    let all: Vec<Values> =
        all.iter().map(|values| Values { parameters: parameters.clone(), ..values.clone() }).collect();
    let named = model.parameters.iter().cloned().zip(parameters.iter().map(|x| Value::Number(*x)));
    let mut machine = InterpreterState { scopes: vec![BTreeMap::new()], parameters: named.collect(), states };
    assert_eq!(patterns.len(), f.arguments.len(), "arguments of {about}");
    for (pattern, a) in patterns.iter().zip(&f.arguments) {
        let found: Option<Vec<Value>> = all.iter().map(|values| argument_value(*a, values)).collect();
        let Some(found) = found else { return false };
        let value = if states > 1 { combine_to_lanes(&found) } else { found[0].clone() };
        machine.bind_pattern(pattern, value).unwrap_or_else(|stop| panic!("{stop:?}, {about}"));
    }
    let mut result = match machine.execute_function_body(body) {
        Ok(value) => vec![value],
        Err(InterpretationError::Foreign) => return false,
        Err(InterpretationError::Wrong(what)) => panic!("{what}, {about}"),
    };
    // The results of a function that writes to arguments are in these arguments.
    let into =
        f.arguments.iter().filter_map(|a| if let Argument::Into(name, _) = a { Some(*name) } else { None });
    result.extend(into.map(|name| machine.variable_value(name).expect("a matrix")));
    for (lane, values) in all.iter().enumerate() {
        let found: Vec<f64> = result
            .iter()
            .flat_map(|value| value.numbers_of_lane(lane).unwrap_or_else(|stop| panic!("{stop:?}, {about}")))
            .collect();
        // A packed symmetric matrix is compared with the entries on both sides of the diagonal.
        let whole = output.functions.iter().find(|f| f.name == "mass_matrix");
        let of = whole.filter(|_| matches!(f.shape, Shape::Symmetric(_))).unwrap_or(f);
        let expected = values.run_function(output, of);
        assert_eq!(found.len(), expected.len(), "results of {about}");
        let bound = SAME * (1.0 + largest_magnitude(&expected));
        for (k, (a, b)) in found.iter().zip(&expected).enumerate() {
            let both_none = !a.is_finite() && !b.is_finite();
            assert!(both_none || (a - b).abs() <= bound, "entry {k}: {a} and {b} within {bound}, {about}");
        }
    }
    true
}
