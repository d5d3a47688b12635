//! The complete generated code: struct, inherent functions, trait implementations and frames.

use super::absent::write_missing_item_declarations;
use super::constants::{write_constants, write_frame_index_function};
use super::differentiable;
use super::dispatch::ArithmeticDispatchedBodies;
use super::docs::{DocumentationPart, struct_docs};
use super::frames::{write_frames, write_trait as write_frames_by_number};
use super::function::write_function;
use super::implementations::write_impls;
use super::interface::{ALLOW, ImplGenerics, Interface};
use super::manifold::{write_manifold, write_velocity_transport_functions};
use super::prepared::{PreparedProgram, write_prepared_struct_and_functions};
use super::scalar::ScalarSpelling;
use super::signature::SignatureContext;
use super::{constraints, contacts};
use super::{file, lanes, measurements, reactions, sensitivities, states, validate};
use crate::derive::{AssociatedConstant, DerivationOutput, Function};
use crate::equations::PrintedEquations;
use crate::syntax::GeneratedStruct;
use proc_macro2::TokenStream;
use quote::{ToTokens, quote};
use std::fmt::Write;

/// Generated code. The struct is stored as tokens, which keep their spans in the user's source. Everything
/// else is text, because the lexer of the Rust compiler is much faster than tokens that are made
/// individually.
#[derive(Debug, Default)]
pub struct GeneratedCode {
    /// Tokens of the struct, with its documentation and its dependencies on imported files.
    pub tokens: TokenStream,
    /// Implementations of the struct's functions and of the runtime's traits.
    pub text: String,
}

impl GeneratedCode {
    /// Returns the struct and the implementations as tokens.
    pub fn into_tokens(self) -> Result<TokenStream, proc_macro2::LexError> {
        let mut tokens = self.tokens;
        tokens.extend(self.text.parse::<TokenStream>()?);
        Ok(tokens)
    }
}

/// Code that does not compile if the runtime's arithmetic depends on the processor.
const REPRODUCIBLE: &str = "const _: () = {
    const fn require<T: ::linkwork::__private::absent::HasReproducibleArithmetic>() {}
    require::<()>()
};
";

/// Returns the generated code of a mechanism without errors.
pub fn emit_mechanism(interface: &Interface<'_>, output: &DerivationOutput) -> GeneratedCode {
    let spelling = scalar_spelling(interface);
    let s = common_function_signature(interface, &spelling);
    let mut methods = String::new();
    write_constants(&mut methods, interface, &output.equations, &output.constants);
    write_frame_index_function(&mut methods, false);
    let mut bodies = ArithmeticDispatchedBodies::new(interface.detect);
    for f in &output.functions {
        bodies.write_function(&mut methods, f, &s);
    }
    constraints::write_constants(&mut methods, &interface.constraints);
    contacts::write_constants(&mut methods, &interface.contacts);
    interface.polytopes.write_methods(&mut methods, interface.facts.requests.batch, &s);
    if !interface.facts.kinematic {
        constraints::write_methods(&mut methods, &interface.constraints, &output.functions, &s);
        reactions::write_methods(&mut methods, interface, &output.functions, &s);
        reactions::write_contact_force_outputs(&mut methods, interface, &output.functions, &s);
    } else {
        constraints::write_kinematic_assembly(&mut methods, &interface.constraints, &s);
    }
    write_manifold(&mut methods, Some(&output.charts), interface.facts.speeds, &s);
    if !interface.contacts.is_empty() {
        write_velocity_transport_functions(&mut methods, Some(&output.charts), interface.facts.speeds, &s);
    }
    differentiable::write_configuration_and_input_derivatives(
        &mut methods,
        Some(&output.charts),
        &output.functions,
        interface,
        &s,
    );
    differentiable::write_forward_second_derivatives(&mut methods, Some(&output.charts), interface, &s);
    lanes::write_methods(&mut methods, &mut bodies, interface, &output.functions, Some(&output.charts), &s);
    // A parameter that drops out of the equations must not cause a warning about an unused field.
    let fields: Vec<String> = (0..interface.shell.parameter_access_paths().len())
        .map(|k| format!("&self.{}", spelling.parameter_field_name(k)))
        .collect();
    let fields: Vec<String> = fields
        .into_iter()
        .chain(interface.shell.table_names().iter().map(|name| format!("&self.{name}")))
        .collect();
    let _ =
        writeln!(methods, "#[doc(hidden)]\nfn __parameters(&self) {{ let _ = ({}); }}", fields.join(", "));
    validate::write_validate_method(&mut methods, interface, false);
    file::write_methods(&mut methods, interface, &spelling);
    write_frame_selection_functions(&mut methods, &s);
    let mut emitted = assemble_generated_code(
        interface,
        &s,
        &methods,
        output.frames.len(),
        &struct_docs(interface, output),
    );
    write_frames(
        &mut emitted.text,
        &interface.shell.ident.to_string(),
        &ImplGenerics::new(interface, &s),
        (&output.links, &output.frames),
        interface.facts.speeds,
        &s,
    );
    bodies.write_function_bodies(
        &mut emitted.text,
        &interface.shell.ident.to_string(),
        &ImplGenerics::new(interface, &s),
    );
    write_missing_item_declarations(&mut emitted.text, interface, &s);
    if interface.facts.requests.reproducible {
        emitted.text.push_str(REPRODUCIBLE);
    }
    measurements::write_impls(
        &mut emitted.text,
        &interface.shell.ident.to_string(),
        &output.functions,
        interface,
        &s,
    );
    sensitivities::write_sensitivities_impl(
        &mut emitted.text,
        &interface.shell.ident.to_string(),
        interface,
        &s,
    );
    states::write_impls(&mut emitted.text, &output.functions, interface, &s);
    if let Some(prepared) = &output.prepared {
        let content = PreparedProgram { numbers: Some(&prepared.numbers), charts: Some(&output.charts) };
        write_prepared_struct_and_functions(&mut emitted.text, interface, &s, &prepared.functions, &content);
    }
    emitted.text = replace_runtime_path(emitted.text, interface.shell);
    emitted
}

/// Returns stubs for the interface of a mechanism with an error, so that the error is not reported again at
/// every use of the mechanism.
pub fn emit_error_stubs(
    interface: &Interface<'_>,
    functions: &[Function],
    constants: &[AssociatedConstant],
) -> GeneratedCode {
    let spelling = scalar_spelling(interface);
    let s = common_function_signature(interface, &spelling);
    let mut methods = String::new();
    write_constants(&mut methods, interface, &PrintedEquations::default(), constants);
    write_frame_index_function(&mut methods, true);
    for f in functions {
        write_function(&mut methods, f, &s, true);
    }
    reactions::write_contact_output_stubs(&mut methods, interface, functions, &s);
    constraints::write_constants(&mut methods, &interface.constraints);
    contacts::write_constants(&mut methods, &interface.contacts);
    if !interface.facts.kinematic {
        constraints::write_methods(&mut methods, &interface.constraints, functions, &s);
    } else {
        constraints::write_kinematic_assembly(&mut methods, &interface.constraints, &s);
    }
    write_manifold(&mut methods, None, interface.facts.speeds, &s);
    if !interface.contacts.is_empty() {
        write_velocity_transport_functions(&mut methods, None, interface.facts.speeds, &s);
    }
    differentiable::write_configuration_and_input_derivatives(&mut methods, None, functions, interface, &s);
    differentiable::write_forward_second_derivatives(&mut methods, None, interface, &s);
    lanes::write_methods(
        &mut methods,
        &mut ArithmeticDispatchedBodies::new(false),
        interface,
        functions,
        None,
        &s,
    );
    validate::write_validate_method(&mut methods, interface, true);
    file::write_methods(&mut methods, interface, &spelling);
    let (q, v) = (s.vector_type(s.nq), s.vector_type(s.nv));
    let (scalar, nv) = (spelling.scalar_name(), s.nv);
    let placement = format!("::linkwork::nalgebra::IsometryMatrix3<{scalar}>");
    let t = if s.time { format!("t: {scalar}, ") } else { String::new() };
    let _ = writeln!(
        methods,
        "pub fn frame_placements(&self, {t}q: &{q}) -> [{placement}; {}] {{ loop {{}} }}
        pub fn frame_placement<F>(&self, frame: F, {t}q: &{q}) -> {placement} {{ loop {{}} }}
        pub fn frame_velocity<F>(&self, frame: F, {t}q: &{q}, v: &{v}) -> \
            ::linkwork::nalgebra::SVector<{scalar}, 6> {{ loop {{}} }}
        pub fn frame_acceleration<F>(&self, frame: F, {t}q: &{q}, v: &{v}, a: &{v}) -> \
            ::linkwork::nalgebra::SVector<{scalar}, 6> {{ loop {{}} }}
        pub fn frame_jacobian<F>(&self, frame: F, {t}q: &{q}) -> ::linkwork::nalgebra::SMatrix<{scalar}, 6, \
            {nv}> {{ loop {{}} }}",
        interface.frames.len()
    );
    let mut emitted = assemble_generated_code(interface, &s, &methods, 0, &[]);
    write_missing_item_declarations(&mut emitted.text, interface, &s);
    measurements::write_impls(
        &mut emitted.text,
        &interface.shell.ident.to_string(),
        functions,
        interface,
        &s,
    );
    sensitivities::write_sensitivities_impl(
        &mut emitted.text,
        &interface.shell.ident.to_string(),
        interface,
        &s,
    );
    states::write_impls(&mut emitted.text, functions, interface, &s);
    if interface.facts.requests.prepare {
        write_prepared_struct_and_functions(
            &mut emitted.text,
            interface,
            &s,
            functions,
            &PreparedProgram::default(),
        );
    }
    emitted.text = replace_runtime_path(emitted.text, interface.shell);
    emitted
}

fn scalar_spelling(interface: &Interface<'_>) -> ScalarSpelling {
    ScalarSpelling::new(
        interface.scalar.clone(),
        interface.shell.parameter_access_paths(),
        interface.shell.table_names(),
    )
}

fn common_function_signature<'a>(
    interface: &Interface<'_>,
    scalar: &'a ScalarSpelling,
) -> SignatureContext<'a> {
    SignatureContext {
        scalar,
        nq: interface.configuration.len(),
        nv: interface.velocities.len(),
        nu: interface.inputs.len(),
        time: interface.facts.time,
    }
}

/// Writes the functions for one frame, which `frame!(Robot, "tool")` selects by name; the compiler checks the
/// name.
fn write_frame_selection_functions(out: &mut String, s: &SignatureContext<'_>) {
    let scalar = s.scalar.scalar_name();
    let frame = format!("impl ::linkwork::FrameName<Self, {}, {}, Scalar = {scalar}>", s.nq, s.nv);
    let six = format!("::linkwork::nalgebra::SVector<{scalar}, 6>");
    let (q, v) = (s.vector_type(s.nq), s.vector_type(s.nv));
    // A mechanism that does not depend on time takes zero.
    let (t, at) = match s.time {
        true => (format!("t: {scalar}, "), "t".to_string()),
        false => (String::new(), format!("::linkwork::__private::constant::<{scalar}>(0.0)")),
    };
    let _ = writeln!(
        out,
        "/// Placement of a frame in the ground: its axes and its origin.
        #[inline]\n#[must_use]
        pub fn frame_placement(&self, frame: {frame}, {t}q: &{q}) -> \
            ::linkwork::nalgebra::IsometryMatrix3<{scalar}> {{
            ::linkwork::FrameName::placement(frame, self, {at}, q)
        }}
        /// Velocity of a frame relative to the ground, in ground axes: velocity of its origin, then angular
        /// velocity.
        #[inline]\n#[must_use]
        pub fn frame_velocity(&self, frame: {frame}, {t}q: &{q}, v: &{v}) -> {six} {{
            ::linkwork::FrameName::velocity(frame, self, {at}, q, v)
        }}
        /// Acceleration of a frame relative to the ground, in ground axes: acceleration of its origin, then
        /// angular acceleration; without gravity.
        #[inline]\n#[must_use]
        pub fn frame_acceleration(&self, frame: {frame}, {t}q: &{q}, v: &{v}, a: &{v}) -> {six} {{
            ::linkwork::FrameName::acceleration(frame, self, {at}, q, v, a)
        }}
        /// Jacobian of a frame: `frame_velocity` is this times `v`.
        #[inline]\n#[must_use]
        pub fn frame_jacobian(&self, frame: {frame}, {t}q: &{q}) -> ::linkwork::nalgebra::SMatrix<{scalar}, \
            6, {nv}> {{
            ::linkwork::FrameName::jacobian(frame, self, {at}, q)
        }}",
        nv = s.nv,
    );
}

/// Returns the alias of the runtime in generated code, for an attribute that contains the path of the
/// runtime.
fn runtime_alias_name(ident: &syn::Ident) -> String {
    format!("__linkwork_of_{}", ident.to_string().trim_start_matches("r#"))
}

/// Returns the path of the runtime as tokens.
pub(super) fn runtime_path(shell: &GeneratedStruct) -> TokenStream {
    match shell.runtime {
        None => quote!(::linkwork),
        Some(_) => quote::format_ident!("{}", runtime_alias_name(&shell.ident)).to_token_stream(),
    }
}

/// Returns the text with the path of the runtime replaced by its alias, if the attribute contains a path.
fn replace_runtime_path(text: String, shell: &GeneratedStruct) -> String {
    match shell.runtime {
        None => text,
        Some(_) => text.replace("::linkwork::", &format!("{}::", runtime_alias_name(&shell.ident))),
    }
}

/// Returns the code of the struct with its implementations, without frames.
fn assemble_generated_code(
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
    methods: &str,
    frames: usize,
    docs: &[DocumentationPart],
) -> GeneratedCode {
    let GeneratedStruct {
        attributes, visibility, ident, parameters, tables, elements, runtime: path, ..
    } = i.shell;
    let (.., struct_where) = i.shell.generics.split_for_impl();
    let struct_generics = &i.shell.generics.params;
    let struct_generics = if struct_generics.is_empty() { quote!() } else { quote!(<#struct_generics>) };
    let of_file = file::struct_fields_for_file_values(i);
    let fields = if parameters.is_empty() && tables.is_empty() && of_file.is_empty() {
        quote!(#struct_where;)
    } else {
        let own = parameters.iter().chain(tables);
        let all = own.map(ToTokens::to_token_stream).chain(of_file);
        quote!(#struct_where { #(#all),* })
    };
    let docs = docs.iter().map(|part| match part {
        DocumentationPart::Everywhere(text) => quote!(#[doc = #text]),
        DocumentationPart::Pages(text) => quote!(#[cfg_attr(doc, doc = #text)]),
        DocumentationPart::Editors(text) => quote!(#[cfg_attr(not(doc), doc = #text)]),
    });
    // Types of the elements: an editor shows their documentation at the user's keywords.
    let words = elements.iter().map(|(_, kind)| kind);
    // The alias is needed because the path may be valid only in the user's source.
    let alias = path.as_ref().map(|path| {
        let alias = quote::format_ident!("{}", runtime_alias_name(ident));
        quote!(#[doc(hidden)] #[allow(unused_imports, non_snake_case, reason = "generated code")] use #path as #alias;)
    });
    let runtime = runtime_path(i.shell);
    let known = if frames == 0 {
        quote!()
    } else {
        quote!(const _: () = { #(const _: ::core::option::Option<#runtime::elements::#words> = ::core::option::Option::None;)* };)
    };
    let files = i.files.iter().map(|path| {
        quote!(
            const _: &[u8] = ::core::include_bytes!(#path);
        )
    });
    let tokens = quote! {
        #(#attributes)*
        #(#docs)*
        #visibility struct #ident #struct_generics #fields
        #(#files)*
        #known
        #alias
    };
    let head = ImplGenerics::new(i, s);
    let mut text = String::new();
    write_impls(&head, &mut text, &i.shell.ident.to_string(), methods, i, s);
    file::write_identifiable_trait_impl(&mut text, &head, i, s.scalar);
    let _ = writeln!(
        text,
        "{ALLOW}impl{} ::linkwork::Frames<{}, {}> for {}{} {} {{",
        head.generics, s.nq, s.nv, i.shell.ident, head.arguments, head.bounds
    );
    write_frames_by_number(&mut text, frames, s);
    text.push_str("}\n");
    if i.facts.requests.drawing {
        let scalar = s.scalar.scalar_name();
        let heights = match i.facts.heights {
            0 => String::new(),
            _ => format!(
                "fn drawing_heights(&self, place: &[{scalar}; 2]) -> impl ::core::convert::AsRef<[{scalar}]> \
                 {{ Self::__drawing_heights(self, place) }}\n"
            ),
        };
        let _ = writeln!(
            text,
            "{ALLOW}impl{} ::linkwork::Drawn<{}, {}> for {}{} {} {{
            const DRAWING: &'static [::linkwork::drawing::Piece] = &Self::DRAWING;
            fn drawing_numbers(&self) -> impl ::core::convert::AsRef<[{scalar}]> {{ \
                Self::drawing_numbers(self) }}\n{heights}}}",
            head.generics, s.nq, s.nv, i.shell.ident, head.arguments, head.bounds
        );
    }
    GeneratedCode { tokens, text }
}
