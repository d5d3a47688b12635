//! Replacement for a struct that cannot be generated as the user's code expects it, because derives have
//! processed its elements or its file cannot be read. The error is reported once.

use crate::syntax::GeneratedStruct;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

/// Returns a struct, and the name of the user's struct as an alias whose const argument is the error.
///
/// Code of derives that have processed the elements accesses them as fields, while the user's code omits
/// them, hence no struct suits both. If a robot's file is missing, no sizes suit the code that uses the
/// robot. For a type with an error in its arguments, however, rustc reports no further errors about fields
/// and methods.
pub fn struct_alias_with_error(shell: &GeneratedStruct, error: &TokenStream) -> TokenStream {
    let GeneratedStruct { attributes, visibility, ident, parameters, tables, generics, .. } = shell;
    let hidden = format_ident!("__{}Mistaken", ident.to_string().trim_start_matches("r#"));
    let (bounds, condition) = (generics.params.iter(), &generics.where_clause);
    let names = generics.type_params().map(|parameter| &parameter.ident);
    let (all, _, _) = generics.split_for_impl();
    // The name of a struct without parameters is also a value.
    let fields: Vec<_> = parameters.iter().chain(tables).collect();
    let value = fields.is_empty().then(|| {
        quote! {
            #[allow(non_upper_case_globals, reason = "the name of the struct")]
            #visibility const #ident: #ident = #hidden {};
        }
    });
    quote! {
        #(#attributes)*
        #visibility struct #hidden<#(#bounds,)* const MISTAKE: bool> #condition { #(#fields),* }
        #[allow(type_alias_bounds, reason = "the bounds of the struct")]
        #visibility type #ident #all = #hidden<#(#names,)* { #error }>;
        #value
    }
}
