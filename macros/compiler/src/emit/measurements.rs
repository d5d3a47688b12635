//! Implementations of the runtime's traits of outputs, which return all outputs of a mechanism in one vector.

use super::interface::{ALLOW, ImplGenerics, Interface};
use super::signature::SignatureContext;
use super::states;
use crate::catalogue::{Argument, BY_PARAMETERS, DERIVATIVES, GeneratedId, Shape};
use crate::derive::Function;
use std::fmt::Write;

/// Outputs of a mechanism that are functions of state, accelerations and inputs, with the type for which the
/// traits are implemented.
struct Measurements<'a> {
    /// Name of the mechanism's generated type.
    name: &'a str,
    /// Generated functions of the outputs.
    outputs: Vec<&'a Function>,
    /// Total number of entries of all outputs together.
    count: usize,
    /// Generic parameters of the implementations.
    head: ImplGenerics,
    /// Public interface of the mechanism.
    i: &'a Interface<'a>,
    /// Signature helper for the generated functions.
    s: &'a SignatureContext<'a>,
    /// Parameter list of the trait functions, as source text.
    parameters: String,
}

/// Writes the implementations for the type `name`, if it has outputs that are functions of state,
/// accelerations and inputs.
pub fn write_impls(
    out: &mut String,
    name: &str,
    functions: &[Function],
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
) {
    // Rates of states and matrices are not part of the vector of outputs.
    let is_rate_of_state =
        |f: &Function| i.states.iter().any(|(name, _)| f.name == states::rate_function_name(name));
    let outputs: Vec<&Function> = functions
        .iter()
        .filter(|f| {
            f.id == GeneratedId::Output && !is_rate_of_state(f) && !matches!(f.shape, Shape::Matrix(..))
        })
        .collect();
    let count: usize = outputs.iter().map(|f| entry_count(f)).sum();
    if count == 0 {
        return;
    }
    let parameters = s.parameter_list(&[Argument::T, Argument::Q, Argument::V, Argument::A, Argument::U]);
    let measurements = Measurements { name, outputs, count, head: ImplGenerics::new(i, s), i, s, parameters };
    measurements.write_output_trait(out);
    if !i.facts.requests.derivatives {
        return;
    }
    measurements.write_output_derivatives_trait(out);
    // Derivatives of the states themselves have the same requirement.
    if !i.states.is_empty() && i.facts.constraints.is_none() {
        measurements.write_state_derivative_trait(out);
    }
}

impl Measurements<'_> {
    /// Writes the head of the implementation of the trait `of` with these sizes.
    fn begin_trait_impl(&self, out: &mut String, of: &str, sizes: &[usize]) {
        let ImplGenerics { generics, arguments, bounds } = &self.head;
        let sizes = sizes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        let _ = writeln!(
            out,
            "{ALLOW}impl{generics} ::linkwork::{of}<{sizes}> for {}{arguments} {bounds} {{",
            self.name
        );
    }

    /// Returns the sizes of configuration, velocity, inputs and outputs.
    fn trait_sizes(&self) -> [usize; 4] {
        [self.s.nq, self.s.nv, self.s.nu, self.count]
    }

    /// Writes a statement for each output, given the index of its first entry; then the end of function and
    /// implementation.
    fn write_statement_per_output(&self, out: &mut String, statement: impl Fn(usize, &Function) -> String) {
        let mut first = 0;
        for f in &self.outputs {
            let _ = writeln!(out, "{}", statement(first, f));
            first += entry_count(f);
        }
        out.push_str("all\n}\n}\n");
    }

    /// Writes the trait of the values, with names and units.
    fn write_output_trait(&self, out: &mut String) {
        let (count, vector) = (self.count, self.s.vector_type(self.count));
        let names: Vec<String> =
            self.outputs.iter().flat_map(|f| entry_names(f)).map(|name| format!("{name:?}")).collect();
        let unit_of_output = |f: &Function| {
            let place = self.i.outputs.iter().position(|name| *name == f.name);
            place.and_then(|k| self.i.units.outputs.get(k)).map_or("", |unit| unit)
        };
        let units: Vec<&str> = self
            .outputs
            .iter()
            .flat_map(|f| std::iter::repeat_n(unit_of_output(f), entry_count(f)))
            .collect();
        self.begin_trait_impl(out, "Outputs", &self.trait_sizes());
        let _ = writeln!(
            out,
            "type Scalar = {};\nconst OUTPUTS: [&'static str; {count}] = [{}];
        const OUTPUT_UNITS: [&'static str; {count}] = {units:?};
        #[inline]\nfn outputs({}) -> {vector} {{\nlet mut all = <{vector}>::zeros();",
            self.s.scalar.scalar_name(),
            names.join(", "),
            self.parameters,
        );
        self.write_statement_per_output(out, |first, f| {
            let value = match f.shape {
                Shape::Scalar => format!("::linkwork::nalgebra::SVector::from([{}])", output_call(f, "")),
                _ => output_call(f, ""),
            };
            format!("::linkwork::__private::put_rows(&mut all, {first}, &{value});")
        });
    }

    /// Writes the implementation of the trait `OutputDerivatives`.
    fn write_output_derivatives_trait(&self, out: &mut String) {
        self.begin_trait_impl(out, "OutputDerivatives", &self.trait_sizes());
        let of = self.s.shape_type(Shape::Jacobians(self.count, self.s.nv, self.s.nu));
        let _ = writeln!(
            out,
            "#[inline]\nfn output_derivatives({}) -> {of} {{\nlet mut all = <{of}>::zeros();",
            self.parameters
        );
        self.write_statement_per_output(out, |first, f| {
            format!("all.put_rows({first}, &{});", output_call(f, DERIVATIVES))
        });
    }

    /// Writes the trait of the derivatives by states of first order.
    fn write_state_derivative_trait(&self, out: &mut String) {
        let [nq, nv, nu, count] = self.trait_sizes();
        let n = self.i.states.len();
        let of = self.s.shape_type(Shape::Matrix(count, n));
        let which: Vec<String> = self.i.states.iter().map(|(_, k)| k.to_string()).collect();
        self.begin_trait_impl(out, "OutputsByStates", &[nq, nv, nu, n, count]);
        let _ = writeln!(
            out,
            "        #[inline]\nfn outputs_by_states({}) -> {of} {{\nlet mut all = <{of}>::zeros();",
            self.parameters
        );
        self.write_statement_per_output(out, |first, f| {
            format!(
                "::linkwork::__private::put_rows(&mut all, {first}, &::linkwork::__private::columns(&{}, \
                 [{}]));",
                output_call(f, BY_PARAMETERS),
                which.join(", "),
            )
        });
    }
}

/// Returns the expression that calls an output, or its derivatives with this suffix.
fn output_call(f: &Function, suffix: &str) -> String {
    let names: Vec<&str> = f.arguments.iter().map(|a| a.argument_name()).collect();
    format!("Self::{}{suffix}(self, {})", f.name, names.join(", "))
}

/// Returns the number of entries of an output.
fn entry_count(f: &Function) -> usize {
    match f.shape {
        Shape::Vector(n) => n,
        _ => 1,
    }
}

/// Returns the names of an output's entries: its own name, or the names of its spatial components.
fn entry_names(f: &Function) -> Vec<String> {
    match f.shape {
        Shape::Vector(_) => ["x", "y", "z"].map(|axis| format!("{}.{axis}", f.name)).to_vec(),
        _ => vec![f.name.clone()],
    }
}
