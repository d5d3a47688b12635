//! Common properties of parameters: scalar type and unit; and written types of fields.

use super::{Description, Name, ScalarType, element};
use crate::diag::{Diagnostics, Place};
use proc_macro2::Ident;
use quote::ToTokens;
use syn::spanned::Spanned;
use syn::{Attribute, Type};

pub fn unify_scalar_types(
    scalar: &mut Option<(ScalarType, Place)>,
    found: ScalarType,
    place: Place,
    cx: &mut Diagnostics,
) {
    match scalar {
        None => *scalar = Some((found, place)),
        Some((known, _)) if *known == found => {}
        Some((known, _)) => {
            cx.report_error(
                place,
                format!(
                    "this parameter is `{}`, but others are `{}`",
                    scalar_type_name(&found),
                    scalar_type_name(known)
                ),
            )
            .add_help("all parameters of a mechanism have one scalar type");
        }
    }
}

fn scalar_type_name(scalar: &ScalarType) -> &str {
    match scalar {
        ScalarType::F64 => "f64",
        ScalarType::F32 => "f32",
        ScalarType::Generic(name) => name,
    }
}

/// Returns the source range from the first to the last token of a type.
pub fn span_of_type(ty: &Type) -> Place {
    let mut tokens = ty.to_token_stream().into_iter();
    let Some(first) = tokens.next() else { return ty.span().into() };
    let last = tokens.last().map_or(first.span(), |last| last.span());
    Place::from(first.span()).extend_to_end_of(&last.into())
}

/// Returns the last segment of a plain path without arguments.
pub fn type_name(ty: &Type) -> Option<Ident> {
    match ty {
        Type::Path(p) if p.qself.is_none() => {
            let last = p.path.segments.last()?;
            last.arguments.is_empty().then(|| last.ident.clone())
        }
        // A fragment substituted by a macro.
        Type::Group(group) => type_name(&group.elem),
        Type::Paren(group) => type_name(&group.elem),
        _ => None,
    }
}

/// Reads the attribute `#[unit(…)]`, which applies to the parameter declared next.
pub fn read_units(attributes: &[Attribute], description: &mut Description, cx: &mut Diagnostics) {
    let mut units = attributes.iter().filter(|a| element::is_attribute_among(a, &["unit"]));
    if let Some(first) = units.next() {
        let unit = element::read_unit(first, cx);
        description.units.extend(unit.map(|unit| (description.parameters.len(), unit)));
    }
    for second in units {
        cx.report_error(second.path().span(), "a parameter has one `#[unit]`");
    }
}

pub fn check_parameter_attributes(field: &Name, attributes: &[Attribute], cx: &mut Diagnostics) {
    for attribute in attributes {
        if element::is_conditional_attribute(attribute) {
            cx.report_error(attribute.path().span(), "a parameter cannot be conditional")
                .add_help(element::CONDITION_HELP);
        }
        if let Some(word) = attribute.path().get_ident()
            && word != "unit"
            && element::ATTRIBUTES.contains(&word.to_string().as_str())
        {
            cx.report_error(
                word.span(),
                format!("`#[{word}]` is an attribute of elements, but `{}` is a parameter", field.text),
            )
            .add_help(match word.to_string().as_str() {
                "output" | "define" => "give the field the type of a result: `Scalar`, or `Vector`",
                "acts" => {
                    "give the field an element's type, such as `Spring`, `Dashpot`, `Force` or `Torque`"
                }
                _ => "give the field an element's type, such as `Body` or `Pin`",
            });
        }
    }
}
