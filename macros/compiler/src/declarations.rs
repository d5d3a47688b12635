//! Mechanisms outside of an attribute: the structs of a text in Rust's syntax, and robot files.

use crate::syntax::FileFormat;
use proc_macro2::{Span, TokenStream};
use quote::ToTokens;
use std::path::Path;
use syn::spanned::Spanned;

/// Arguments of a `#[mechanism]` attribute and its struct.
pub struct DeclaredStruct {
    /// Name of the struct.
    pub name: String,
    /// Arguments of the attribute `#[mechanism]`.
    pub arguments: TokenStream,
    /// The struct without the attribute `#[mechanism]`.
    pub item: TokenStream,
    /// Position of the attribute, if a `#[derive(…)]` precedes it.
    pub derive_above_attribute_error: Option<Span>,
}

fn is_mechanism_attribute(attribute: &syn::Attribute) -> bool {
    attribute.path().segments.last().is_some_and(|segment| segment.ident == "mechanism")
}

fn is_derive_attribute(attribute: &syn::Attribute) -> bool {
    attribute.path().segments.last().is_some_and(|segment| segment.ident == "derive")
}

impl DeclaredStruct {
    /// Reads a struct; `None` if it has no `#[mechanism]` attribute.
    fn read_mechanism_struct(mut item: syn::ItemStruct) -> Option<DeclaredStruct> {
        let attribute = item.attrs.iter().position(is_mechanism_attribute)?;
        let derive = item.attrs.iter().position(is_derive_attribute).filter(|derive| *derive < attribute);
        let derive_above_attribute_error = derive.map(|_| item.attrs[attribute].span());
        let arguments = match &item.attrs[attribute].meta {
            syn::Meta::List(list) => list.tokens.clone(),
            _ => TokenStream::new(),
        };
        item.attrs.retain(|attribute| !is_mechanism_attribute(attribute));
        Some(DeclaredStruct {
            name: item.ident.to_string(),
            arguments,
            item: item.to_token_stream(),
            derive_above_attribute_error,
        })
    }

    /// Returns the declaration of a robot file as a struct without fields: its format follows from the ending
    /// of the path and from the text.
    pub fn declaration_of_robot_file(path: &Path, text: &str) -> DeclaredStruct {
        let name = type_name_from_path(path);
        let ident = syn::Ident::new(&name, Span::call_site());
        let written = path.to_string_lossy().into_owned();
        let format = syn::Ident::new(robot_file_format(path, text).import_option_name(), Span::call_site());
        DeclaredStruct {
            name,
            arguments: quote::quote!(#format = #written),
            item: quote::quote!(pub struct #ident;),
            derive_above_attribute_error: None,
        }
    }

    /// Appends arguments to those of the attribute `#[mechanism]`.
    pub fn append_attribute_arguments(&mut self, more: TokenStream) {
        if more.is_empty() {
            return;
        }
        let ends = self.arguments.clone().into_iter().last().is_none_or(|last| last.to_string() == ",");
        if !ends {
            self.arguments.extend(quote::quote!(,));
        }
        self.arguments.extend(more);
    }
}

/// Returns the mechanisms of a file in Rust's syntax, including those in its modules.
///
/// # Errors
///
/// The text is not a Rust file.
pub fn mechanism_declarations(text: &str) -> syn::Result<Vec<DeclaredStruct>> {
    let mut found = Vec::new();
    let mut todo = syn::parse_file(text)?.items;
    while !todo.is_empty() {
        for item in std::mem::take(&mut todo) {
            match item {
                syn::Item::Struct(item) => found.extend(DeclaredStruct::read_mechanism_struct(item)),
                syn::Item::Mod(module) => {
                    todo.extend(module.content.into_iter().flat_map(|(_, items)| items));
                }
                _ => {}
            }
        }
    }
    Ok(found)
}

/// Returns the format of a robot file: from the ending of its name if that is unambiguous, else from its
/// root element.
fn robot_file_format(path: &Path, text: &str) -> FileFormat {
    let has_extension = |end: &str| path.extension().is_some_and(|known| known.eq_ignore_ascii_case(end));
    match () {
        () if has_extension("urdf") => FileFormat::Urdf,
        () if has_extension("sdf") || has_extension("world") => FileFormat::Sdf,
        () if has_extension("mjcf") || text.contains("<mujoco") => FileFormat::Mjcf,
        () if text.contains("<sdf") => FileFormat::Sdf,
        () => FileFormat::Urdf,
    }
}

/// Returns the name of a type after that of a file: `simple_humanoid.urdf` is `SimpleHumanoid`.
fn type_name_from_path(path: &Path) -> String {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let words = stem.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let capitalise_word = |word: &str| {
        let (first, rest) = word.split_at(1);
        format!("{}{rest}", first.to_ascii_uppercase())
    };
    let name: String = words.map(capitalise_word).collect();
    match name.starts_with(|c: char| c.is_ascii_alphabetic()) && name != "Self" {
        true => name,
        false => format!("Robot{name}"),
    }
}
