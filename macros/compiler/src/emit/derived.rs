//! What derives want that have seen a struct with its elements: a mistake that is told once.

use super::item::runtime;
use crate::syntax::Shell;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

/// The elements as fields of what the struct dereferences to, where derived code finds them.
pub fn with_elements(shell: &Shell) -> TokenStream {
    let name = &shell.ident;
    let elements = format_ident!("__ElementsOf{}", name.to_string().trim_start_matches("r#"));
    let runtime = runtime(shell);
    let fields = shell.elements.iter().map(|(name, kind)| quote!(pub #name: #runtime::elements::#kind));
    let (generics, arguments, bounds) = shell.generics.split_for_impl();
    quote! {
        #[doc(hidden)]
        pub struct #elements { #(#fields),* }
        #[automatically_derived]
        impl #generics ::core::ops::Deref for #name #arguments #bounds {
            type Target = #elements;
            fn deref(&self) -> &#elements { loop {} }
        }
    }
}
