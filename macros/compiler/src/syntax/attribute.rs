//! Parsing of the struct and its attributes: fields are classified as parameters and elements.

use super::expression::name_from_identifier;
use super::field::{is_known_field_type, read_field, report_duplicate_fields};
use super::lists::ElementListLengths;
use super::mechanism::{GeneratedStruct, Mechanism};
use super::options::read_mechanism_options;
use super::parameter::type_name;
use super::readable::MechanismReadability;
use super::request::RequestedFunctions;
use super::separate::insert_missing_commas;
use super::state::set_state_types;
use super::table::table_variable_count;
use super::{Description, ScalarType, crate_path, declaration, guard};
use crate::diag::{Diagnostics, Place};
use proc_macro2::{Span, TokenStream};
use syn::spanned::Spanned;
use syn::{Fields, GenericParam, Ident, Item, ItemStruct};

/// Parses `#[mechanism(arguments)] item`. Returns `None` if the item is not a valid struct; all errors are in
/// `cx`.
pub fn parse_mechanism(arguments: TokenStream, item: TokenStream, cx: &mut Diagnostics) -> Option<Mechanism> {
    if !guard::check_argument_size(&arguments, cx) || !guard::check_item_size(&item, cx) {
        return None;
    }
    let fields = declaration::fields_source_text(&item);
    let mut item = parse_struct(item, cx)?;
    let before = cx.len();
    let mut lists = ElementListLengths::expand_lists(&mut item.fields, cx);
    let arguments = lists.rewrite_list_index(arguments, None, cx);
    let mut reading = MechanismReadability::default();
    if cx.len() > before {
        reading.mark_mechanism_unreadable();
    }
    let (arguments, runtime) = crate_path::take_crate_path(arguments, cx);
    let (generic, refused) = separate_scalar_type_parameter(&mut item, cx);
    let mut description = Description::empty_description(name_from_identifier(&item.ident));
    let mut shell = GeneratedStruct {
        attributes: item.attrs.clone(),
        visibility: item.vis.clone(),
        ident: item.ident.clone(),
        generics: item.generics.clone(),
        parameters: Vec::new(),
        tables: Vec::new(),
        file_fields: Vec::new(),
        elements: Vec::new(),
        notes: declaration::field_doc_paragraphs(&item),
        declaration: declaration::mechanism_declaration_text(&item, fields),
        runtime,
    };
    let mut scalar: Option<(ScalarType, Place)> = None;
    // An unknown type is reported once.
    let mut unknown_types: Vec<Ident> = Vec::new();
    for field in item.fields {
        reading.record_field_identifiers(&field);
        let kind = type_name(&field.ty).filter(|_| table_variable_count(&field.ty).is_none());
        if kind.as_ref().is_some_and(|kind| refused.contains(kind) || unknown_types.contains(kind)) {
            reading.mark_last_field_unreadable();
            continue;
        }
        unknown_types.extend(kind.filter(|kind| !is_known_field_type(kind, generic.as_deref())));
        let before = cx.len();
        read_field(field, generic.as_deref(), &mut description, &mut shell, &mut scalar, cx);
        if cx.len() > before {
            reading.mark_last_field_unreadable();
        }
    }
    let (mut requests, before) = (RequestedFunctions::default(), cx.len());
    let file = read_mechanism_options(arguments.clone(), &mut description, &mut scalar, &mut requests, cx);
    if cx.len() > before {
        reading.mark_if_options_unreadable(arguments);
    }
    if let Some((scalar, _)) = scalar {
        description.scalar = scalar;
    }
    // Fields for parameters of a file have the generic scalar type.
    if let (Some(generic), true, true) =
        (&generic, requests.file_parameters, description.parameters.is_empty())
    {
        description.scalar = ScalarType::Generic(generic.clone());
    }
    if let Some(generic) = generic
        && description.scalar != ScalarType::Generic(generic.clone())
    {
        let unused = std::mem::take(&mut shell.generics);
        let place = unused.type_params().next().map_or(unused.span(), |t| t.ident.span());
        // The type parameter is most likely meant by an unknown type.
        if unknown_types.is_empty() {
            let message = format!("no parameter of the mechanism has the type `{generic}`");
            cx.report_error(place, message).add_help(
                "remove the type parameter, or use it as the type of the parameters: all generated functions \
                 then use it",
            );
        }
    }
    set_state_types(&description, &mut shell);
    // Linear systems include the derivatives by states, which are parameters.
    requests.sensitivities |= requests.derivatives && !description.states.is_empty();
    report_duplicate_fields(&description, cx).iter().for_each(|name| reading.mark_ambiguous_fields(name));
    Some(Mechanism { description, shell, file, requests, reading })
}

fn parse_struct(tokens: TokenStream, cx: &mut Diagnostics) -> Option<ItemStruct> {
    let item = match syn::parse2::<Item>(tokens.clone()) {
        Ok(item) => item,
        Err(error) => {
            match insert_missing_commas(&tokens) {
                Some((_, slip)) => cx.report_syn_error(slip),
                None => {
                    _ = cx.report_error(error.span(), error.to_string()).add_help(invalid_rust_help(&error))
                }
            }
            return None;
        }
    };
    let (span, what) = match &item {
        Item::Struct(s) if !matches!(s.fields, Fields::Unnamed(_)) => match item {
            Item::Struct(s) => return Some(s),
            _ => return None,
        },
        Item::Struct(s) => (s.fields.span(), "a struct with unnamed fields"),
        Item::Enum(e) => (e.enum_token.span, "an enum"),
        Item::Union(u) => (u.union_token.span, "a union"),
        Item::Fn(f) => (f.sig.fn_token.span, "a function"),
        Item::Impl(i) => (i.impl_token.span, "an impl"),
        Item::Mod(m) => (m.mod_token.span, "a module"),
        Item::Trait(t) => (t.trait_token.span, "a trait"),
        _ => (Span::call_site(), "this item"),
    };
    cx.report_error(span, format!("`#[mechanism]` cannot be applied to {what}")).add_help(
        "a mechanism is a struct with named fields: parameters (`mass: f64`) and elements (`#[body(mass = \
         mass)] cart: Body`)",
    );
    None
}

/// Returns the help for an item that is not valid Rust.
fn invalid_rust_help(error: &syn::Error) -> &'static str {
    match error.to_string().contains("keyword") {
        true => "this is a keyword of Rust: choose another name for the field, and write it as `name: Type`",
        false => {
            "a mechanism is a struct, `pub struct Name { … }`; its fields are written `name: Type,`, with an \
             attribute before them as in `#[body(mass = 1)] cart: Body,`"
        }
    }
}

/// Returns the struct's type parameter, if one can be the scalar type, and the names of the other type
/// parameters. Parameters that cannot be the scalar type are removed, so that the Rust compiler does not
/// report them again.
fn separate_scalar_type_parameter(
    item: &mut ItemStruct,
    cx: &mut Diagnostics,
) -> (Option<String>, Vec<Ident>) {
    let (mut found, mut refused) = (None, Vec::new());
    let parameters = std::mem::take(&mut item.generics.params);
    let count = parameters.len();
    for parameter in parameters {
        match &parameter {
            GenericParam::Type(t) if found.is_none() => {
                found = Some(t.ident.to_string());
                item.generics.params.push(parameter);
            }
            GenericParam::Type(t) => {
                cx.report_error(t.ident.span(), format!("a second type parameter `{}`", t.ident))
                    .add_help("a mechanism has at most one scalar type");
                refused.push(t.ident.clone());
            }
            GenericParam::Const(c) => {
                cx.report_error(c.ident.span(), "a mechanism can be generic over its scalar type only")
                    .add_help("write `struct Robot<T>` with parameters of type `T`");
            }
            GenericParam::Lifetime(l) => {
                cx.report_error(l.lifetime.span(), "a mechanism can be generic over its scalar type only")
                    .add_help("write `struct Robot<T>` with parameters of type `T`");
            }
        }
    }
    if item.generics.params.len() < count {
        item.generics.where_clause = None;
    }
    (found, refused)
}
