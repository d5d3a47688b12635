//! The whole output: struct, inherent functions, trait, frames.

use super::absent::{Absent, write_absent};
use super::constants::{write_constants, write_frame_index};
use super::constraints::{self, Constraints};
use super::dispatch::Bodies;
use super::docs::struct_docs;
use super::frames::{write_all_placements, write_frame_impl, write_steps};
use super::function::{Signature, write_function};
use super::manifold::write_manifold;
use super::prepared::{Content, write_prepared};
use super::scalar::ScalarSpelling;
use super::{lanes, reactions};
use crate::catalogue::{self, Argument, Facts, Row};
use crate::derive::{Constant, Function, Output};
use crate::expr::print::Written;
use crate::mechanism::Units;
use crate::syntax::{ScalarType, Shell};
use proc_macro2::TokenStream;
use quote::{ToTokens, quote};
use std::fmt::Write;

/// Names and types that the outside sees.
pub struct Interface<'a> {
    /// The struct.
    pub shell: &'a Shell,
    /// Its scalar type.
    pub scalar: ScalarType,
    /// Name of every entry of `q`.
    pub configuration: Vec<String>,
    /// Name of every entry of `v`.
    pub velocities: Vec<String>,
    /// Name of every entry of `u`.
    pub inputs: Vec<String>,
    /// Names of the frames.
    pub frames: Vec<String>,
    /// One line for each joint: what it joins.
    pub structure: Vec<String>,
    /// The constraints.
    pub constraints: Constraints,
    /// Names of the outputs.
    pub outputs: Vec<String>,
    /// Units of all of these and of the parameters.
    pub units: Units,
    /// A file whose change asks for another expansion.
    pub file: Option<String>,
    /// What signatures depend on.
    pub facts: Facts,
    /// Large functions choose their arithmetic at run time.
    pub detect: bool,
    /// Numbers of the file that were rounded.
    pub snapped: &'a [String],
    /// What the mechanism does not have, and why.
    pub absent: Vec<Absent>,
}

/// What stands before generated implementations.
pub const ALLOW: &str = "#[automatically_derived]\n#[allow(unused, non_snake_case, clippy::all, clippy::pedantic, clippy::nursery, reason = \"generated code\")]\n";

/// Emitted code: the struct as tokens, which keep their places in the user's source, and everything else as text, since
/// the compiler's own lexer is much faster than tokens made one by one.
#[derive(Debug, Default)]
pub struct Emitted {
    /// The struct.
    pub tokens: TokenStream,
    /// Implementations.
    pub text: String,
}

impl Emitted {
    /// All of it as tokens.
    pub fn into_tokens(self) -> Result<TokenStream, proc_macro2::LexError> {
        let mut tokens = self.tokens;
        tokens.extend(self.text.parse::<TokenStream>()?);
        Ok(tokens)
    }
}

/// Emits a mechanism that compiled.
pub fn emit_mechanism(interface: &Interface<'_>, output: &Output) -> Emitted {
    let spelling = spelling(interface);
    let s = signature(interface, &spelling);
    let mut methods = String::new();
    write_constants(&mut methods, interface, &output.equations, &output.constants);
    write_frame_index(&mut methods, false);
    let mut bodies = Bodies::new(interface.detect);
    for f in &output.functions {
        bodies.write_function(&mut methods, f, &s);
    }
    constraints::write_constants(&mut methods, &interface.constraints);
    if !interface.facts.kinematic {
        constraints::write_methods(&mut methods, &interface.constraints, &output.functions, &s);
        reactions::write_methods(&mut methods, interface, &output.functions, &s);
    } else {
        constraints::write_assembly(&mut methods, &interface.constraints, &s);
    }
    write_manifold(&mut methods, Some(&output.charts), &s);
    lanes::write_methods(&mut methods, &mut bodies, interface, &output.functions, Some(&output.charts), &s);
    // A parameter that drops out of the equations is not a field that nobody reads.
    let fields: Vec<String> =
        (0..interface.shell.parameters.len()).map(|k| format!("&self.{}", spelling.parameter(k))).collect();
    let _ =
        writeln!(methods, "#[doc(hidden)]\nfn __parameters(&self) {{ let _ = ({}); }}", fields.join(", "));
    write_frame_access(&mut methods, &s);
    let placements =
        format!("[::linkwork::nalgebra::IsometryMatrix3<{}>; {}]", spelling.name(), output.frames.len());
    let _ = writeln!(
        methods,
        "/// Placements of all frames in the ground, in the order of `FRAMES`.\n#[inline]\n#[must_use]\npub fn frame_placements({}) -> {placements} {{",
        s.parameters(&s.timed(&[Argument::Q]))
    );
    write_all_placements(&mut methods, &output.links, &output.frames, &s);
    methods.push_str("}\n");
    write_steps(&mut methods, &output.links, &output.frames, &s);
    let mut frames = Vec::new();
    for (k, frame) in output.frames.iter().enumerate() {
        let mut text = String::new();
        write_frame_impl(&mut text, k, frame, &output.links, &s);
        frames.push(text);
    }
    let mut emitted = assemble(interface, &s, &methods, &frames, &struct_docs(interface, output));
    bodies.write(&mut emitted.text, &interface.shell.ident.to_string(), &Head::new(interface, &s));
    write_absent(&mut emitted.text, interface, &s);
    if let Some(prepared) = &output.prepared {
        let content = Content { numbers: Some(&prepared.numbers), charts: Some(&output.charts) };
        write_prepared(&mut emitted.text, interface, &s, &prepared.functions, &content);
    }
    emitted.text = at_home(emitted.text, interface.shell);
    emitted
}

/// Emits the interface alone, so that a mistake in a mechanism is not reported again wherever it is used.
pub fn emit_failed(interface: &Interface<'_>, functions: &[Function], constants: &[Constant]) -> Emitted {
    let spelling = spelling(interface);
    let s = signature(interface, &spelling);
    let mut methods = String::new();
    write_constants(&mut methods, interface, &Written::default(), constants);
    write_frame_index(&mut methods, true);
    for f in functions {
        write_function(&mut methods, f, &s, true);
    }
    constraints::write_constants(&mut methods, &interface.constraints);
    if !interface.facts.kinematic {
        constraints::write_methods(&mut methods, &interface.constraints, functions, &s);
    } else {
        constraints::write_assembly(&mut methods, &interface.constraints, &s);
    }
    write_manifold(&mut methods, None, &s);
    lanes::write_methods(&mut methods, &mut Bodies::new(false), interface, functions, None, &s);
    let (q, v) = (s.vector(s.nq), s.vector(s.nv));
    let (scalar, nv) = (spelling.name(), s.nv);
    let placement = format!("::linkwork::nalgebra::IsometryMatrix3<{scalar}>");
    let t = if s.time { format!("t: {scalar}, ") } else { String::new() };
    let _ = writeln!(
        methods,
        "pub fn frame_placements(&self, {t}q: &{q}) -> [{placement}; {}] {{ loop {{}} }}
        pub fn frame_placement<F>(&self, frame: F, {t}q: &{q}) -> {placement} {{ loop {{}} }}
        pub fn frame_velocity<F>(&self, frame: F, {t}q: &{q}, v: &{v}) -> ::linkwork::nalgebra::SVector<{scalar}, 6> {{ loop {{}} }}
        pub fn frame_acceleration<F>(&self, frame: F, {t}q: &{q}, v: &{v}, a: &{v}) -> ::linkwork::nalgebra::SVector<{scalar}, 6> {{ loop {{}} }}
        pub fn frame_jacobian<F>(&self, frame: F, {t}q: &{q}) -> ::linkwork::nalgebra::SMatrix<{scalar}, 6, {nv}> {{ loop {{}} }}",
        interface.frames.len()
    );
    let mut emitted = assemble(interface, &s, &methods, &[], "");
    write_absent(&mut emitted.text, interface, &s);
    if interface.facts.requests.prepare {
        write_prepared(&mut emitted.text, interface, &s, functions, &Content::default());
    }
    emitted.text = at_home(emitted.text, interface.shell);
    emitted
}

fn spelling(interface: &Interface<'_>) -> ScalarSpelling {
    let fields = interface.shell.parameters.iter().filter_map(|f| f.ident.as_ref().map(ToString::to_string));
    ScalarSpelling::new(interface.scalar.clone(), fields.collect())
}

fn signature<'a>(interface: &Interface<'_>, scalar: &'a ScalarSpelling) -> Signature<'a> {
    Signature {
        scalar,
        nq: interface.configuration.len(),
        nv: interface.velocities.len(),
        nu: interface.inputs.len(),
        time: interface.facts.time,
    }
}

/// Access to one frame: `frame!(Robot, "tool")` names it, and the compiler checks the name.
fn write_frame_access(out: &mut String, s: &Signature<'_>) {
    let scalar = s.scalar.name();
    let bound = format!("where Self: ::linkwork::NamedFrame<I, {}, {}, Scalar = {scalar}>", s.nq, s.nv);
    let six = format!("::linkwork::nalgebra::SVector<{scalar}, 6>");
    let (q, v) = (s.vector(s.nq), s.vector(s.nv));
    // What is not driven in time has no use for it.
    let (t, at) = match s.time {
        true => (format!("t: {scalar}, "), "t".to_string()),
        false => (String::new(), format!("::linkwork::__private::constant::<{scalar}>(0.0)")),
    };
    let _ = writeln!(
        out,
        "/// Placement of a frame in the ground: its axes and its origin.
        #[inline]\n#[must_use]
        pub fn frame_placement<const I: usize>(&self, frame: ::linkwork::FrameIndex<I>, {t}q: &{q}) -> ::linkwork::nalgebra::IsometryMatrix3<{scalar}> {bound} {{
            ::linkwork::__private::placement(&::linkwork::NamedFrame::<I, {nq}, {nv}>::placement(self, {at}, q))
        }}
        /// Velocity of a frame: of its origin, then angular; relative to the ground, resolved in ground axes.
        #[inline]\n#[must_use]
        pub fn frame_velocity<const I: usize>(&self, frame: ::linkwork::FrameIndex<I>, {t}q: &{q}, v: &{v}) -> {six} {bound} {{
            ::linkwork::__private::six(::linkwork::NamedFrame::<I, {nq}, {nv}>::twist(self, {at}, q, v))
        }}
        /// Acceleration of a frame: of its origin, then angular; relative to the ground, resolved in ground axes; without gravity.
        #[inline]\n#[must_use]
        pub fn frame_acceleration<const I: usize>(&self, frame: ::linkwork::FrameIndex<I>, {t}q: &{q}, v: &{v}, a: &{v}) -> {six} {bound} {{
            ::linkwork::__private::six(::linkwork::NamedFrame::<I, {nq}, {nv}>::acceleration(self, {at}, q, v, a))
        }}
        /// Jacobian of a frame: `frame_velocity` is this times `v`.
        #[inline]\n#[must_use]
        pub fn frame_jacobian<const I: usize>(&self, frame: ::linkwork::FrameIndex<I>, {t}q: &{q}) -> ::linkwork::nalgebra::SMatrix<{scalar}, 6, {nv}> {bound} {{
            ::linkwork::NamedFrame::<I, {nq}, {nv}>::jacobian(self, {at}, q)
        }}",
        nq = s.nq,
        nv = s.nv,
    );
}

/// The arguments that the inherent function takes of those of the trait's.
pub(super) fn needed(row: &Row, i: &Interface<'_>) -> Vec<Argument> {
    (row.declare)(&i.facts).arguments
}

/// The trait's functions, in terms of the inherent ones, which take only what they need.
fn write_trait(out: &mut String, i: &Interface<'_>, s: &Signature<'_>) {
    let _ = writeln!(out, "type Scalar = {};", s.scalar.name());
    for (name, n) in [("CONFIGURATION", s.nq), ("VELOCITIES", s.nv), ("INPUTS", s.nu)] {
        let _ = writeln!(out, "const {name}: [&'static str; {n}] = Self::{name};");
    }
    let (q, v) = (s.vector(s.nq), s.vector(s.nv));
    for (row, arguments) in catalogue::of_trait() {
        let (name, result) = (row.name, s.shape((row.declare)(&i.facts).shape));
        let needed = needed(row, i);
        let names: Vec<&str> = s.timed(&needed).iter().map(|a| a.name()).collect();
        let _ = writeln!(
            out,
            "#[inline]\nfn {name}({}) -> {result} {{ Self::{name}(self, {}) }}",
            s.parameters(&s.timed(arguments)),
            names.join(", ")
        );
    }
    let _ = writeln!(
        out,
        "#[inline]\nfn neutral(&self) -> {q} {{ Self::neutral(self) }}
        #[inline]\nfn integrate(&self, q: &{q}, dv: &{v}) -> {q} {{ Self::integrate(self, q, dv) }}
        #[inline]\nfn difference(&self, from: &{q}, to: &{q}) -> {v} {{ Self::difference(self, from, to) }}
        #[inline]\nfn tangent_rate(&self, dv: &{v}, v: &{v}) -> {v} {{ Self::tangent_rate(self, dv, v) }}"
    );
    constraints::write_projection(out, &i.constraints, s);
}

/// Generics of the struct's implementations as text.
pub struct Head {
    /// `<T: …>`
    pub generics: String,
    /// `<T>`
    pub arguments: String,
    /// `where …`
    pub bounds: String,
}

impl Head {
    /// Those of the struct, with the scalar's own bound.
    pub fn new(i: &Interface<'_>, s: &Signature<'_>) -> Head {
        let (impl_generics, ty_generics, where_clause) = i.shell.generics.split_for_impl();
        let spell = |tokens: &dyn ToTokens| tokens.to_token_stream().to_string();
        let mut bounds = spell(&where_clause);
        if s.scalar.is_generic() {
            let start = if bounds.is_empty() { "where" } else { bounds.trim_end().trim_end_matches(',') };
            let comma = if bounds.is_empty() { "" } else { "," };
            bounds = format!("{start}{comma} {}: ::linkwork::Real", s.scalar.one());
        }
        Head { generics: spell(&impl_generics), arguments: spell(&ty_generics), bounds }
    }

    /// The inherent functions of a type of this name, and the trait's.
    pub fn write_impls(
        &self,
        out: &mut String,
        name: &str,
        methods: &str,
        i: &Interface<'_>,
        s: &Signature<'_>,
    ) {
        let Head { generics, arguments, bounds } = self;
        let _ = writeln!(out, "{ALLOW}impl{generics} {name}{arguments} {bounds} {{\n{methods}}}");
        if i.facts.kinematic {
            return;
        }
        let _ = writeln!(
            out,
            "{ALLOW}impl{generics} ::linkwork::{}<{}, {}, {}> for {name}{arguments} {bounds} {{",
            if s.time { "Rheonomic" } else { "Mechanism" },
            s.nq,
            s.nv,
            s.nu
        );
        write_trait(out, i, s);
        out.push_str("}\n");
        if i.facts.requests.batch {
            let _ = writeln!(
                out,
                "{ALLOW}impl{generics} ::linkwork::Batch<{}, {}, {}> for {name}{arguments} {bounds} {{",
                s.nq, s.nv, s.nu
            );
            lanes::write_trait(out, i, s);
            out.push_str("}\n");
        }
        if !i.constraints.names.is_empty() {
            let sizes = [s.nq, s.nv, s.nu, i.constraints.holonomic, i.constraints.names.len()];
            let sizes = sizes.map(|n| n.to_string()).join(", ");
            let _ = writeln!(
                out,
                "{ALLOW}impl{generics} ::linkwork::Constrained<{sizes}> for {name}{arguments} {bounds} {{"
            );
            constraints::write_trait(out, &i.constraints, s);
            out.push_str("}\n");
        }
    }
}

/// The name under which generated code finds the runtime, where the attribute says where it is.
fn alias_of(ident: &syn::Ident) -> String {
    format!("__linkwork_of_{}", ident.to_string().trim_start_matches("r#"))
}

/// The path of the runtime in tokens.
pub(super) fn runtime(shell: &Shell) -> TokenStream {
    match shell.home {
        None => quote!(::linkwork),
        Some(_) => quote::format_ident!("{}", alias_of(&shell.ident)).to_token_stream(),
    }
}

/// The text with the runtime where the attribute says that it is.
fn at_home(text: String, shell: &Shell) -> String {
    match shell.home {
        None => text,
        Some(_) => text.replace("::linkwork::", &format!("{}::", alias_of(&shell.ident))),
    }
}

/// Puts struct and implementations together.
fn assemble(i: &Interface<'_>, s: &Signature<'_>, methods: &str, frames: &[String], docs: &str) -> Emitted {
    let Shell { attributes, visibility, ident, parameters, elements, home, .. } = i.shell;
    let (.., struct_where) = i.shell.generics.split_for_impl();
    let struct_generics = &i.shell.generics.params;
    let struct_generics = if struct_generics.is_empty() { quote!() } else { quote!(<#struct_generics>) };
    let fields = if parameters.is_empty() {
        quote!(#struct_where;)
    } else {
        quote!(#struct_where { #(#parameters),* })
    };
    let docs = if docs.is_empty() { quote!() } else { quote!(#[doc = #docs]) };
    // The types of the elements, so that an editor explains them.
    let words = elements.iter().map(|(_, kind)| kind);
    // Under a name of its own, since the path may be one that can be written in the user's source alone.
    let alias = home.as_ref().map(|path| {
        let alias = quote::format_ident!("{}", alias_of(ident));
        quote!(#[doc(hidden)] #[allow(unused_imports, non_snake_case, reason = "generated code")] use #path as #alias;)
    });
    let runtime = runtime(i.shell);
    let known = if frames.is_empty() {
        quote!()
    } else {
        quote!(const _: () = { #(const _: ::core::option::Option<#runtime::elements::#words> = ::core::option::Option::None;)* };)
    };
    let file = i.file.as_ref().map(|path| {
        quote!(
            const _: &[u8] = ::core::include_bytes!(#path);
        )
    });
    let tokens = quote! {
        #(#attributes)*
        #docs
        #visibility struct #ident #struct_generics #fields
        #file
        #known
        #alias
    };
    let head = Head::new(i, s);
    let mut text = String::new();
    head.write_impls(&mut text, &i.shell.ident.to_string(), methods, i, s);
    for (k, body) in frames.iter().enumerate() {
        let _ = writeln!(
            text,
            "{ALLOW}#[doc(hidden)]\nimpl{} ::linkwork::NamedFrame<{k}, {}, {}> for {}{} {} {{\ntype Scalar = {};\n{body}}}",
            head.generics,
            s.nq,
            s.nv,
            i.shell.ident,
            head.arguments,
            head.bounds,
            s.scalar.name()
        );
    }
    Emitted { tokens, text }
}
