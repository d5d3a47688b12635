//! Contacts: two surfaces that may part, strike, slide and stick.

use super::arguments::Arguments;
use super::{Contact, Description, Expr, ExprKind, Name};
use crate::diag::Diagnostics;

const KEYS: [&str; 2] = ["friction", "restitution"];

/// How a contact is written.
pub const EXAMPLE: &str = "#[contact(ball.sphere(radius), ground.plane(z), friction = mu, restitution = e)]";

/// Reads a contact.
pub fn read_contact(
    name: Name,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let friction = arguments.take_expr("friction", cx);
    let restitution = arguments.take_expr("restitution", cx);
    let mut surfaces = arguments.take_plain().into_iter();
    let is_empty = arguments.is_empty();
    arguments.finish("a Contact", &KEYS, cx);
    match (surfaces.next(), surfaces.next(), surfaces.next()) {
        (Some(first), Some(second), None) => {
            description.contacts.push(Contact { name, first, second, friction, restitution });
        }
        (Some(only), None, _) => {
            cx.error(only.place, "expected two surfaces, found one").help(format!("write `{EXAMPLE}`"));
        }
        (Some(_), Some(_), Some(more)) => {
            cx.error(more.place, "a contact is one of two surfaces").help("declare a field for each pair");
        }
        _ if is_empty => {
            cx.error(name.place.clone(), format!("`{}` does not say what touches", name.text))
                .help(format!("write `{EXAMPLE}`"));
        }
        _ => {}
    }
}

/// The word for what a file says of a link's shape.
pub const COLLISION: &str = "collision";

/// `link.collision()` gives the link, `collision()` nothing: all links of the file.
pub fn collision(surface: &Expr) -> Option<Option<&Expr>> {
    match &surface.kind {
        ExprKind::Method(link, word, arguments) if word.text == COLLISION && arguments.is_empty() => {
            Some(Some(link.as_ref()))
        }
        ExprKind::Call(word, arguments) if word.text == COLLISION && arguments.is_empty() => Some(None),
        _ => None,
    }
}

impl Contact {
    /// True if collision geometry of a file is to be read.
    pub fn names_collisions(&self) -> bool {
        [&self.first, &self.second].into_iter().any(|surface| collision(surface).is_some())
    }
}
