//! The struct that the option `prepare` adds. It stores the values that depend only on parameters, and has
//! the functions of the mechanism, which compute the remainder.

use super::absent::write_items_absent_after_prepare;
use super::constants::write_sizes_and_names;
use super::dispatch::ArithmeticDispatchedBodies;
use super::docs::operation_count_table;
use super::function::write_function;
use super::implementations::write_impls;
use super::interface::{ALLOW, ImplGenerics, Interface};
use super::manifold::{write_manifold, write_velocity_transport_functions};
use super::signature::SignatureContext;
use super::{constraints, contacts, differentiable, lanes, measurements, reactions};
use crate::derive::Function;
use crate::lower::Program;
use crate::mechanism::Chart;
use quote::ToTokens;
use std::fmt::Write;

/// Program and charts from which the functions of a prepared mechanism are written; empty for a mechanism
/// that failed to compile.
#[derive(Default)]
pub struct PreparedProgram<'a> {
    /// Program of the precomputed values that the prepared struct stores.
    pub numbers: Option<&'a Program>,
    /// Coordinate charts of the configuration space.
    pub charts: Option<&'a [Chart]>,
}

/// Writes the prepared struct, its functions, and `prepare`.
pub fn write_prepared_struct_and_functions(
    out: &mut String,
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
    functions: &[Function],
    content: &PreparedProgram<'_>,
) {
    let (ident, head) = (&i.shell.ident, ImplGenerics::new(i, s));
    let name = format!("Prepared{}", ident.to_string().trim_start_matches("r#"));
    let count = content.numbers.map(|numbers| numbers.outputs.len()).unwrap_or_default();
    write_prepared_struct(out, i, s, &name, count, functions);
    let mut methods = String::new();
    write_sizes_and_names(&mut methods, i);
    let mut bodies = ArithmeticDispatchedBodies::new(i.detect);
    for f in functions {
        match content.numbers {
            Some(_) => bodies.write_function(&mut methods, f, s),
            None => write_function(&mut methods, f, s, true),
        }
    }
    constraints::write_constants(&mut methods, &i.constraints);
    contacts::write_constants(&mut methods, &i.contacts);
    i.polytopes.write_methods(&mut methods, i.facts.requests.batch, s);
    constraints::write_methods(&mut methods, &i.constraints, functions, s);
    match content.numbers {
        Some(_) => {
            reactions::write_methods(&mut methods, i, functions, s);
            reactions::write_contact_force_outputs(&mut methods, i, functions, s);
        }
        None => reactions::write_contact_output_stubs(&mut methods, i, functions, s),
    }
    write_manifold(&mut methods, content.charts, i.facts.speeds, s);
    if !i.contacts.is_empty() {
        write_velocity_transport_functions(&mut methods, content.charts, i.facts.speeds, s);
    }
    differentiable::write_configuration_and_input_derivatives(&mut methods, content.charts, functions, i, s);
    differentiable::write_forward_second_derivatives(&mut methods, content.charts, i, s);
    lanes::write_methods(&mut methods, &mut bodies, i, functions, content.charts, s);
    write_impls(&head, out, &name, &methods, i, s);
    bodies.write_function_bodies(out, &name, &head);
    write_items_absent_after_prepare(out, &name, i, s);
    measurements::write_impls(out, &name, functions, i, s);

    let ImplGenerics { generics, arguments, bounds } = &head;
    let tables: String =
        i.shell.table_names().iter().map(|table| format!(", {table}: self.{table}")).collect();
    let _ = writeln!(
        out,
        "{ALLOW}impl{generics} {ident}{arguments} {bounds} {{
        /// Returns this mechanism with all values precomputed that depend only on its parameters. It has the
        /// same functions. Later changes of the parameters have no effect on it.
        #[must_use]
        pub fn prepare(&self) -> {name}{arguments} {{ {name} {{ numbers: \
            self.__prepared_numbers(){tables} }} }}"
    );
    let program = content.numbers.cloned().unwrap_or_default();
    let numbers =
        Function::hidden_part_function("__prepared_numbers".to_string(), Vec::new(), count, program);
    write_function(out, &numbers, s, content.numbers.is_none());
    out.push_str("}\n");
}

/// Writes the definition of the prepared struct with its documentation.
fn write_prepared_struct(
    out: &mut String,
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
    name: &str,
    count: usize,
    functions: &[Function],
) {
    let (ident, generics) = (&i.shell.ident, &i.shell.generics);
    let spell_tokens = |tokens: &dyn ToTokens| tokens.to_token_stream().to_string();
    let docs = format!(
        "[`{ident}`] with precomputed values of everything that depends only on its parameters, created by \
         [`prepare`]({ident}::prepare). It has the same functions, except those of frames.\n{}",
        operation_count_table(functions)
    );
    let tables: String = i
        .shell
        .tables
        .iter()
        .map(|field| format!(", {}: {}", spell_tokens(&field.ident), spell_tokens(&field.ty)))
        .collect();
    let parameters = match generics.params.is_empty() {
        true => String::new(),
        false => format!("<{}>", spell_tokens(&generics.params)),
    };
    let _ = writeln!(
        out,
        "#[doc = {docs:?}]\n#[derive(Clone, Copy, Debug, PartialEq)]\n{} struct {name}{parameters} {} \
         {{ numbers: [{}; {count}]{tables} }}",
        spell_tokens(&i.shell.visibility),
        spell_tokens(&generics.where_clause),
        s.scalar.scalar_name()
    );
}
