//! Fields that are states of first order: parameters that change.

use super::mechanism::GeneratedStruct;
use super::parameter::span_of_type;
use super::{Definition, Description, Name, RATE_OF_STATE, Rank, ScalarType, element};
use crate::diag::Diagnostics;
use proc_macro2::Span;
use syn::{Field, Ident};

/// Reads a first-order state. Declares it as a parameter of all functions, and declares a hidden output for
/// its time derivative.
pub fn read_state(
    field: Field,
    kind: Ident,
    name: &Name,
    description: &mut Description,
    shell: &mut GeneratedStruct,
    cx: &mut Diagnostics,
) {
    if let Some(conditional) = field.attrs.iter().find(|a| element::is_conditional_attribute(a)) {
        cx.report_error(span_of_attribute_path(conditional), "a state cannot be conditional")
            .add_help(element::CONDITION_HELP);
        return;
    }
    let rate = element::read_state_rate(name, &kind, &field.attrs, cx);
    let ident = field.ident.clone();
    if let Some(ident) =
        ident.filter(|ident| !shell.parameters.iter().any(|p| p.ident.as_ref() == Some(ident)))
    {
        shell.elements.push((ident, kind));
        let attrs = field
            .attrs
            .iter()
            .filter(|a| !element::is_attribute_among(a, &element::ATTRIBUTES))
            .cloned()
            .collect();
        shell.parameters.push(Field { attrs, ..field });
    }
    description.states.push((name.clone(), description.parameters.len()));
    description.parameters.push(name.clone());
    if let Some(value) = rate {
        let text = format!("{}{RATE_OF_STATE}", name.text);
        let name = Name { text, place: name.place.clone() };
        description.outputs.push(Definition { name, rank: Rank::Scalar, value, resolved_in: None });
    }
}

fn span_of_attribute_path(attribute: &syn::Attribute) -> Span {
    attribute.path().segments.first().map_or_else(Span::call_site, |s| s.ident.span())
}

/// Sets the types of the fields of states to the scalar type of the mechanism.
pub fn set_state_types(description: &Description, shell: &mut GeneratedStruct) {
    for field in &mut shell.parameters {
        let Some(ident) = &field.ident else { continue };
        let text = ident.to_string();
        let is_state = description.states.iter().any(|(name, _)| name.text == text.trim_start_matches("r#"));
        if is_state {
            let place = span_of_type(&field.ty).span;
            let scalar = match &description.scalar {
                ScalarType::F64 => "f64",
                ScalarType::F32 => "f32",
                ScalarType::Generic(name) => name,
            };
            let scalar = Ident::new(scalar, place);
            field.ty = syn::parse_quote!(#scalar);
        }
    }
}
