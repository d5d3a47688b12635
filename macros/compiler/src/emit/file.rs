//! Struct fields with inertial parameters and placements of an imported file, and the functions that get and
//! set them.

use super::interface::{ALLOW, ImplGenerics, Interface};
use super::item::runtime_path;
use super::scalar::ScalarSpelling;
use crate::catalogue::FunctionNeed;
use crate::syntax::RequestOption;
use crate::syntax::file_parameters::{FileField, FileFieldKind};
use proc_macro2::{Span, TokenStream};
use quote::{ToTokens, format_ident, quote};
use std::fmt::Write;
use syn::Ident;

/// Returns the fields of the struct for values of the file.
pub fn struct_fields_for_file_values(i: &Interface<'_>) -> Vec<TokenStream> {
    let runtime = runtime_path(i.shell);
    let scalar = file_field_scalar_type(i);
    let field_tokens = |field: &FileField| {
        let (name, about) = (Ident::new(&field.ident, Span::call_site()), &field.about);
        let kind = match field.kind {
            FileFieldKind::Inertial => quote!(#runtime::Inertial<#scalar>),
            FileFieldKind::Placement => quote!(#runtime::Placement<#scalar>),
            FileFieldKind::Number => quote!(#scalar),
        };
        quote!(#[doc = #about] pub #name: #kind)
    };
    i.shell.file_fields.iter().map(field_tokens).collect()
}

/// Returns the scalar type of the fields.
fn file_field_scalar_type(i: &Interface<'_>) -> Ident {
    let name = ScalarSpelling::new(i.scalar.clone(), Vec::new(), Vec::new());
    format_ident!("{}", name.single_lane_scalar_type())
}

/// Writes the constructors from the values of the file, and the functions that get and set the inertial
/// parameters of all links.
pub fn write_methods(out: &mut String, i: &Interface<'_>, s: &ScalarSpelling) {
    if !i.facts.meets_need(FunctionNeed::FileParameters) {
        return;
    }
    let own: Vec<String> =
        i.shell.parameters.iter().filter_map(|f| f.ident.as_ref().map(ToString::to_string)).collect();
    let values: Vec<String> = i
        .shell
        .file_fields
        .iter()
        .map(|field| format!("{}: {}", field.ident, field_value_expression(field, s)))
        .collect();
    let tables = i
        .shell
        .tables
        .iter()
        .map(|field| (field.ident.to_token_stream().to_string(), field.ty.to_token_stream()));
    let tables: Vec<(String, String)> = tables.map(|(name, kind)| (name, kind.to_string())).collect();
    let all = own
        .iter()
        .cloned()
        .chain(tables.iter().map(|(name, _)| name.clone()))
        .chain(values)
        .collect::<Vec<_>>()
        .join(", ");
    let arguments = own.iter().map(|name| format!("{name}: {}", s.single_lane_scalar_type()));
    let arguments: Vec<String> =
        arguments.chain(tables.iter().map(|(name, kind)| format!("{name}: {kind}"))).collect();
    let (constant, before) = match s.is_generic() {
        true => ("", "use ::linkwork::__private::constant;\n"),
        false => ("const ", ""),
    };
    if own.is_empty() && tables.is_empty() && !s.is_generic() {
        let _ = writeln!(
            out,
            "/// The mechanism with the values of the file.\npub const FILE: Self = Self {{ {all} }};"
        );
    }
    let _ = writeln!(
        out,
        "/// Returns the mechanism with the values of the file and the given values of the other parameters.
        #[inline]\n#[must_use]\npub {constant}fn from_file({}) -> Self {{\n{before}Self {{ {all} }}\n}}",
        arguments.join(", ")
    );
    if !i.facts.meets_need(FunctionNeed::FileInertials) {
        return;
    }
    let links = inertial_fields(i);
    let (n, names): (usize, Vec<&String>) = (links.len(), links.iter().map(|field| &field.of).collect());
    let get: Vec<String> = links.iter().map(|field| format!("self.{}", field.ident)).collect();
    let set: Vec<String> =
        links.iter().enumerate().map(|(k, field)| format!("self.{} = links[{k}];", field.ident)).collect();
    let kind = format!("[::linkwork::Inertial<{}>; {n}]", s.single_lane_scalar_type());
    let _ = writeln!(
        out,
        "/// Name of every link whose mass properties are parameters.\npub const LINKS: [&'static str; {n}] \
         = {names:?};
        /// Returns the mass properties of all links that have them as parameters, in the order of `LINKS`.
        #[inline]\n#[must_use]\npub fn inertials(&self) -> {kind} {{ [{}] }}
        /// Sets the mass properties of all links that have them as parameters, in the order of `LINKS`.
        #[inline]\npub fn set_inertials(&mut self, links: &{kind}) {{ {} }}",
        get.join(", "),
        set.join("\n")
    );
    if i.facts.meets_need(FunctionNeed::Asks(RequestOption::Regressor)) {
        let _ = writeln!(
            out,
            "/// Sets the mass properties of all `LINKS` to the physically consistent values that have these \
             base parameters and
            /// differ least from the current ones. See [`put_back`](::linkwork::identification::put_back).
            ///
            /// # Errors
            ///
            /// If no physically consistent mass properties have these base parameters, or the current mass
            /// properties are not physically consistent. The mechanism is then not changed.
            #[inline(never)]
            pub fn set_base_parameters(&mut self, base: &::linkwork::nalgebra::SVector<{}, {}>) -> \
                ::core::result::Result<(), ::linkwork::identification::PutBackError> {{
                ::linkwork::identification::put_back(self, base)
            }}",
            s.single_lane_scalar_type(),
            i.facts.base
        );
    }
}

/// Writes the trait `Identifiable`, which sets inertial parameters from base parameters.
pub fn write_identifiable_trait_impl(
    out: &mut String,
    head: &ImplGenerics,
    i: &Interface<'_>,
    s: &ScalarSpelling,
) {
    if ![FunctionNeed::FileInertials, FunctionNeed::Asks(RequestOption::Regressor)]
        .iter()
        .all(|need| i.facts.meets_need(*need))
    {
        return;
    }
    let ImplGenerics { generics, arguments, bounds } = head;
    let (n, base, one) = (inertial_fields(i).len(), i.facts.base, s.single_lane_scalar_type());
    let _ = writeln!(
        out,
        "{ALLOW}impl{generics} ::linkwork::identification::Identifiable<{n}, {base}> for {}{arguments} \
         {bounds} {{
            type Scalar = {one};
            fn inertials(&self) -> [::linkwork::Inertial<{one}>; {n}] {{ Self::inertials(self) }}
            fn set_inertials(&mut self, links: &[::linkwork::Inertial<{one}>; {n}]) {{ \
                Self::set_inertials(self, links) }}
            fn own_base_parameters(&self) -> ::linkwork::nalgebra::SVector<{one}, {base}> {{ \
                self.base_parameters(&self.standard_parameters()) }}
        }}",
        i.shell.ident
    );
}

/// Returns the fields that hold inertial parameters.
fn inertial_fields<'a>(i: &'a Interface<'_>) -> Vec<&'a FileField> {
    i.shell.file_fields.iter().filter(|field| field.kind == FileFieldKind::Inertial).collect()
}

/// Returns the expression of a field's value in the file.
fn field_value_expression(field: &FileField, s: &ScalarSpelling) -> String {
    let numbers: Vec<String> = field.values.iter().map(|x| s.constant_expression(*x)).collect();
    match (field.kind, numbers.as_slice()) {
        (FileFieldKind::Inertial, [mass, x, y, z, xx, xy, xz, yy, yz, zz]) => format!(
            "::linkwork::Inertial {{ mass: {mass}, com: [{x}, {y}, {z}], ixx: {xx}, ixy: {xy}, ixz: {xz}, \
             iyy: {yy}, iyz: {yz}, izz: {zz} }}"
        ),
        (FileFieldKind::Placement, [x, y, z, roll, pitch, yaw]) => {
            format!("::linkwork::Placement {{ xyz: [{x}, {y}, {z}], rpy: [{roll}, {pitch}, {yaw}] }}")
        }
        _ => numbers.join(", "),
    }
}
