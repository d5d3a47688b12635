//! Source text of the user's declaration, with the doc comments of its fields, for generated documentation.

use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};
use quote::ToTokens;
use syn::{Attribute, Expr, ExprLit, ItemStruct, Lit, Meta};

/// Returns the source text of a struct's fields with their braces. `None` outside of a compilation, and for
/// tokens assembled by a macro.
pub fn fields_source_text(item: &TokenStream) -> Option<String> {
    let braces = item.clone().into_iter().find_map(|token| match token {
        TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => Some(group.span()),
        _ => None,
    });
    braces.map(source_text_of_token).unwrap_or_else(|| Some(";".to_string()))
}

/// Returns the source text of a token, unless it is part of a macro definition.
fn source_text_of_token(span: Span) -> Option<String> {
    span.source_text().filter(|text| !text.contains('$'))
}

/// Returns the source text of the attribute and of the struct with its fields.
pub fn mechanism_declaration_text(item: &ItemStruct, fields: Option<String>) -> Option<String> {
    let attribute = source_text_of_token(Span::call_site()).filter(|text| text.starts_with("#["))?;
    let fields = fields?;
    let (visibility, name) = (item.vis.to_token_stream().to_string(), &item.ident);
    let generics = item.generics.params.to_token_stream().to_string();
    let generics = if generics.is_empty() { generics } else { format!("<{generics}>") };
    let bounds = item.generics.where_clause.to_token_stream().to_string();
    let head = [visibility, format!("struct {name}{generics}"), bounds];
    let head = head.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ");
    let space = if fields == ";" { "" } else { " " };
    Some(format!("{}\n{head}{space}{}", remove_indentation(&attribute), remove_indentation(&fields)))
}

/// Removes the indentation of the last line, the closing brace, from all lines.
fn remove_indentation(text: &str) -> String {
    let depth = text.lines().last().map_or(0, |last| last.len() - last.trim_start().len());
    let dedent_line = |line: &str| {
        let blank = line.len() - line.trim_start().len();
        line.get(depth.min(blank)..).unwrap_or_default().to_string()
    };
    let mut lines = text.lines();
    let first = lines.next().unwrap_or_default().to_string();
    [first].into_iter().chain(lines.map(dedent_line)).collect::<Vec<_>>().join("\n")
}

/// Returns the first paragraph of the doc comment of every field that has one.
pub fn field_doc_paragraphs(item: &ItemStruct) -> Vec<(String, String)> {
    let field_doc_paragraph = |field: &syn::Field| {
        let name = field.ident.as_ref()?.to_string();
        let paragraph = first_doc_paragraph(&field.attrs);
        (!paragraph.is_empty()).then(|| (name.trim_start_matches("r#").to_string(), paragraph))
    };
    item.fields.iter().filter_map(field_doc_paragraph).collect()
}

/// Returns the lines of documentation comments.
pub fn doc_lines(attributes: &[Attribute]) -> impl Iterator<Item = String> {
    attributes.iter().filter_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) => Some(text.value()),
            _ => None,
        },
        _ => None,
    })
}

fn first_doc_paragraph(attributes: &[Attribute]) -> String {
    let all = doc_lines(attributes).collect::<Vec<_>>().join("\n");
    let lines = all.lines().map(str::trim).skip_while(|line| line.is_empty());
    lines.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declarations_are_indented_from_their_last_line() {
        assert_eq!(
            remove_indentation("{\n        a: f64,\n\n            b\n    }"),
            "{\n    a: f64,\n\n        b\n}"
        );
        assert_eq!(remove_indentation("{ a: f64 }"), "{ a: f64 }");
    }

    #[test]
    fn field_note_is_the_first_doc_paragraph() {
        let item: ItemStruct = syn::parse_quote! {
            struct S {
                /// Length of the rod in the test struct.
                ///
                /// More.
                length: f64,
                mass: f64,
            }
        };
        assert_eq!(
            field_doc_paragraphs(&item),
            [("length".to_string(), "Length of the rod in the test struct.".to_string())]
        );
    }
}
