//! What stands for a struct that cannot be had as the user's code expects it, because its derives have seen its elements or
//! its file cannot be read: a mistake that is told once.

use crate::syntax::Shell;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

/// The struct's name for a type that the mistake is an argument of. Code of derives that have seen the elements names them as
/// fields, the user's code leaves them out, and no struct suits both; nor do any sizes suit code that uses a robot whose file is
/// not there. But of a type with a mistake in its arguments rustc says nothing more, whatever fields and methods it is asked for.
pub fn a_mistake_in_a_type(shell: &Shell, mistake: &TokenStream) -> TokenStream {
    let Shell { attributes, visibility, ident, parameters, tables, generics, .. } = shell;
    let hidden = format_ident!("__{}Mistaken", ident.to_string().trim_start_matches("r#"));
    let (bounds, condition) = (generics.params.iter(), &generics.where_clause);
    let names = generics.type_params().map(|parameter| &parameter.ident);
    let (all, _, _) = generics.split_for_impl();
    // A struct without parameters is a value of its name.
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
        #visibility type #ident #all = #hidden<#(#names,)* { #mistake }>;
        #value
    }
}
