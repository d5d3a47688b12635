//! Parsing of the struct's fields: parameters, tables, states and elements.

use super::expression::name_from_identifier;
use super::mechanism::GeneratedStruct;
use super::parameter::{check_parameter_attributes, read_units, span_of_type, type_name, unify_scalar_types};
use super::state::read_state;
use super::table::{read_table, table_variable_count};
use super::{Description, Name, ScalarType, element};
use crate::diag::{Diagnostics, Place};
use syn::spanned::Spanned;
use syn::{Field, Ident};

/// Reads a field of the struct as a parameter, table, state or element.
pub fn read_field(
    mut field: Field,
    generic: Option<&str>,
    description: &mut Description,
    shell: &mut GeneratedStruct,
    scalar: &mut Option<(ScalarType, Place)>,
    cx: &mut Diagnostics,
) {
    let Some(ident) = field.ident.clone() else { return };
    let field_name = name_from_identifier(&ident);
    if ident == "_" {
        cx.report_error(ident.span(), "a field of a mechanism needs a name")
            .add_help("write a name, such as `_unused`");
        return;
    }
    if let Some(variables) = table_variable_count(&field.ty) {
        read_table(field, &field_name, variables, description, shell, cx);
        return;
    }
    let Some(kind) = type_name(&field.ty) else {
        element::report_unknown_type(&field_name, "", span_of_type(&field.ty), cx);
        return;
    };
    let found = match kind.to_string().as_str() {
        "f64" => ScalarType::F64,
        "f32" => ScalarType::F32,
        k if Some(k) == generic => ScalarType::Generic(k.to_string()),
        "State" => {
            read_state(field, kind, &field_name, description, shell, cx);
            return;
        }
        _ => {
            element::read_element(&field_name, &kind, &field.attrs, description, cx);
            shell.elements.push((ident, kind));
            return;
        }
    };
    check_parameter_attributes(&field_name, &field.attrs, cx);
    read_units(&field.attrs, description, cx);
    field.attrs.retain(|a| !element::is_attribute_among(a, &element::ATTRIBUTES));
    unify_scalar_types(scalar, found, field.ty.span().into(), cx);
    // The Rust compiler would also report a second field with the same name.
    if !shell.parameters.iter().any(|known| known.ident == field.ident) {
        shell.parameters.push(field);
    }
    description.parameters.push(field_name);
}

/// Whether a type is that of a parameter or an element.
pub fn is_known_field_type(kind: &Ident, generic: Option<&str>) -> bool {
    let kind = kind.to_string();
    matches!(kind.as_str(), "f64" | "f32")
        || Some(kind.as_str()) == generic
        || element::is_element_or_parameter_type(&kind)
}

/// Reports fields with equal names and returns these names. The Rust compiler also reports them, but later
/// and less clearly.
pub fn report_duplicate_fields(description: &Description, cx: &mut Diagnostics) -> Vec<String> {
    let mut names: Vec<&Name> = Vec::new();
    names.extend(&description.parameters);
    names.extend(description.tables.iter().map(|t| &t.name));
    names.extend(description.bodies.iter().map(|b| &b.name));
    names.extend(description.particles.iter().map(|p| &p.name));
    names.extend(description.joints.iter().map(|j| &j.name));
    names.extend(description.actions.iter().map(|a| &a.name));
    names.extend(description.limits.iter().map(|l| &l.name));
    names.extend(description.equilibria.iter().map(|e| &e.name));
    names.extend(description.contacts.iter().map(|c| &c.name));
    names.extend(description.coordinates.iter().map(|c| &c.name));
    names.extend(description.frames.iter().map(|f| &f.name));
    names.extend(description.points.iter().map(|p| &p.name));
    names.extend(description.definitions.iter().chain(&description.outputs).map(|d| &d.name));
    names.extend(description.energies.iter().chain(&description.dissipations).map(|(name, _)| name));
    report_duplicate_names(&names, cx)
}

/// Reports every duplicate name at its second occurrence, and returns the duplicates.
pub fn report_duplicate_names(names: &[&Name], cx: &mut Diagnostics) -> Vec<String> {
    let mut sorted: Vec<(usize, &&Name)> = names.iter().enumerate().collect();
    sorted.sort_by(|a, b| a.1.text.cmp(&b.1.text).then(a.0.cmp(&b.0)));
    let mut twice = Vec::new();
    for pair in sorted.windows(2) {
        let (first, second) = (pair[0].1, pair[1].1);
        if first.text == second.text {
            cx.report_error(second.place.clone(), format!("the name `{}` is used twice", second.text))
                .add_note("another field has this name as well")
                .add_help("rename one of the two");
            twice.push(second.text.clone());
        }
    }
    twice
}
