//! Unilateral contacts: two surfaces that may separate, collide, slide and stick.

use super::arguments::Arguments;
use super::keys::{ElementArgumentKeys, check_argument_relations};
use super::{CollisionShape, Contact, Description, Expr, ExprKind, GROUND, Name};
use crate::diag::Diagnostics;
use crate::language::{BodyOrInertiaMethod, Callable, OtherKind};

/// Help text with the syntax of a contact between links of a file.
pub const CONTACT_HELP: &str =
    "declare a field for it: `#[contact(collision(), ground.plane(z), friction = 0.8)] floor: Contact`";

/// Maximum number of contact points of a mechanism: the generated code grows with their number.
pub const MAX_CONTACT_POINTS: usize = 128;

/// Reads the declaration of a unilateral contact.
pub fn read_contact(
    name: Name,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let (row, names) = (OtherKind::Contact.row(), &OtherKind::Contact.argument_names());
    let (given, _) =
        ElementArgumentKeys::new(OtherKind::Contact, names).read_element_arguments(arguments, cx);
    check_argument_relations(row.relations, &given, &name, cx);
    let mut surfaces = arguments.take_positional_arguments().into_iter();
    let is_empty = arguments.is_empty();
    arguments.report_remaining_arguments("a Contact", names, cx);
    let example = row.example;
    match (surfaces.next(), surfaces.next(), surfaces.next()) {
        (Some(first), Some(second), None) => {
            description.contacts.push(Contact { name, first, second, arguments: given, of_file: None });
        }
        (Some(only), None, _) => {
            cx.report_error(only.place, "expected two surfaces, found one")
                .add_help(format!("write `{example}`"));
        }
        (Some(_), Some(_), Some(more)) => {
            cx.report_error(more.place, "a contact is between two surfaces")
                .add_help("declare a field for each pair");
        }
        _ if is_empty => {
            cx.report_error(name.place.clone(), format!("`{}` has no surfaces", name.text))
                .add_help(format!("write `{example}`"));
        }
        _ => {}
    }
}

/// Returns the link of `link.collision()`, or `Some(None)` for `collision()`, which denotes all links of the
/// file. `link.collision(2)` is the third shape of a link.
pub fn link_in_collision_expression(surface: &Expr) -> Option<Option<&Expr>> {
    match &surface.kind {
        ExprKind::Method(link, word, arguments)
            if word.id == Some(BodyOrInertiaMethod::Collision) && arguments.len() < 2 =>
        {
            Some(Some(link.as_ref()))
        }
        ExprKind::Call(word, arguments) if word.id == Some(Callable::Collision) && arguments.is_empty() => {
            Some(None)
        }
        _ => None,
    }
}

/// Returns the indices of the shapes that `link.collision()`, `link.collision(2)` or `collision()` denotes;
/// `None` for other surfaces.
pub fn collision_shape_indices(surface: &Expr, all: &[CollisionShape]) -> Option<Vec<usize>> {
    let link = link_in_collision_expression(surface)?.and_then(Expr::as_name);
    let is_shape_of_link =
        |part: &CollisionShape| link.map_or(part.on.body.text != GROUND, |name| part.on.body.text == name);
    let parts = (0..all.len()).filter(|k| is_shape_of_link(&all[*k]));
    let index = match &surface.kind {
        ExprKind::Method(_, _, arguments) => arguments.first().and_then(Expr::literal_number),
        _ => None,
    };
    Some(match index {
        Some(index) => parts.skip(index as usize).take(1).collect(),
        None => parts.collect(),
    })
}

impl Contact {
    /// Whether the contact uses collision geometry of a file.
    pub fn uses_file_collisions(&self) -> bool {
        [&self.first, &self.second].into_iter().any(|surface| link_in_collision_expression(surface).is_some())
    }
}
