//! Parsing of fields that are interpolation tables.

use super::mechanism::GeneratedStruct;
use super::parameter::{check_parameter_attributes, span_of_type};
use super::{Description, Name, Table, element};
use crate::diag::Diagnostics;
use syn::spanned::Spanned;
use syn::{ExprLit, Field, GenericArgument, Lit, PathArguments, Type};

/// Maximum number of interpolation tables of a mechanism.
const MAX_TABLES: usize = 256;

/// Returns the number of variables of a table, the only argument of its type; `Some(None)` if it is missing.
/// `None` for a type that is not a table.
pub fn table_variable_count(ty: &Type) -> Option<Option<usize>> {
    let path = match ty {
        Type::Path(path) => path,
        // A fragment substituted by a macro.
        Type::Group(group) => return table_variable_count(&group.elem),
        Type::Paren(group) => return table_variable_count(&group.elem),
        _ => return None,
    };
    let last = path.path.segments.last().filter(|last| last.ident == "Table")?;
    let PathArguments::AngleBracketed(list) = &last.arguments else { return Some(None) };
    Some(match list.args.first() {
        Some(GenericArgument::Const(syn::Expr::Lit(ExprLit { lit: Lit::Int(n), .. })))
            if list.args.len() == 1 =>
        {
            n.base10_parse().ok()
        }
        _ => None,
    })
}

/// Reads the declaration of an interpolation table.
pub fn read_table(
    mut field: Field,
    name: &Name,
    variables: Option<usize>,
    description: &mut Description,
    shell: &mut GeneratedStruct,
    cx: &mut Diagnostics,
) {
    check_parameter_attributes(name, &field.attrs, cx);
    for unit in field.attrs.iter().filter(|a| element::is_attribute_among(a, &["unit"])) {
        cx.report_error(unit.path().span(), "a table has no `#[unit]`")
            .add_help("the units of its values and axes are inferred from its calls");
    }
    field.attrs.retain(|a| !element::is_attribute_among(a, &element::ATTRIBUTES));
    match variables {
        Some(variables @ 1..=3) if description.tables.len() < MAX_TABLES => {
            description.tables.push(Table { name: name.clone(), variables });
        }
        Some(1..=3) => {
            let maximum = MAX_TABLES;
            cx.report_error(span_of_type(&field.ty), format!("a mechanism has at most {maximum} tables"))
                .add_help("remove some");
        }
        Some(other) => {
            cx.report_error(
                span_of_type(&field.ty),
                format!("a table has one to three variables, found {other}"),
            )
            .add_help("write `Table<1>`, `Table<2>` or `Table<3>`");
        }
        None => {
            cx.report_error(span_of_type(&field.ty), "a table needs its number of variables")
                .add_help("write `Table<1>`, `Table<2>` or `Table<3>`");
        }
    }
    if !shell.tables.iter().any(|known| known.ident == field.ident) {
        shell.tables.push(field);
    }
}
