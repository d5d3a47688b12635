//! Unilateral contacts: two surfaces that may separate, collide, slide and stick.

use super::arguments::Arguments;
use super::{Compliance, Contact, Description, Expr, ExprKind, Name, Restitution};
use crate::diag::Diagnostics;
use crate::language::{Callable, Method, OtherKind};

const KEYS: [&str; 9] = [
    "friction",
    "stiction",
    "torsional",
    "rolling",
    "restitution",
    "stiffness",
    "hertz",
    "dissipation",
    "speed",
];

/// Syntax of a contact of a file's links.
pub const CONTACT_HELP: &str =
    "declare a field for it: `#[contact(collision(), ground.plane(z), friction = 0.8)] floor: Contact`";

/// Reads a contact.
pub fn read_contact(
    name: Name,
    arguments: &mut Arguments,
    description: &mut Description,
    cx: &mut Diagnostics,
) {
    let [friction, stiction, torsional, rolling] =
        ["friction", "stiction", "torsional", "rolling"].map(|key| arguments.take_expr(key, cx));
    let restitution = take_restitution(arguments, cx);
    let soft = read_compliance_options(&name, restitution.as_ref().map(|e| &e.value), arguments, cx);
    if let Some(e) = &stiction {
        if soft.is_some() {
            cx.error(
                e.place.clone(),
                "the friction of surfaces that yield is smooth in the slip: it has no stiction",
            )
            .help("leave out `stiffness` or `hertz`, or `stiction`");
        } else if friction.is_none() {
            cx.error(
                e.place.clone(),
                format!("`{}` has stiction, but no friction while it slides", name.text),
            )
            .help("add `friction = …`: the coefficient of sliding, at most that of stiction");
        }
    }
    let mut surfaces = arguments.take_plain().into_iter();
    let is_empty = arguments.is_empty();
    arguments.finish("a Contact", &KEYS, cx);
    let example = OtherKind::Contact.row().example;
    match (surfaces.next(), surfaces.next(), surfaces.next()) {
        (Some(first), Some(second), None) => {
            description.contacts.push(Contact {
                name,
                first,
                second,
                friction,
                stiction,
                torsional,
                rolling,
                restitution,
                soft,
                of_file: false,
            });
        }
        (Some(only), None, _) => {
            cx.error(only.place, "expected two surfaces, found one").help(format!("write `{example}`"));
        }
        (Some(_), Some(_), Some(more)) => {
            cx.error(more.place, "a contact is one of two surfaces").help("declare a field for each pair");
        }
        _ if is_empty => {
            cx.error(name.place.clone(), format!("`{}` does not say what touches", name.text))
                .help(format!("write `{example}`"));
        }
        _ => {}
    }
}

/// Takes `restitution = e`, or `restitution = poisson(e)`.
pub fn take_restitution(arguments: &mut Arguments, cx: &mut Diagnostics) -> Option<Restitution> {
    let value = arguments.take_expr("restitution", cx)?;
    match value.kind {
        ExprKind::Call(word, mut list) if word.id == Some(Callable::Poisson) => {
            match (list.pop(), list.is_empty()) {
                (Some(value), true) => Some(Restitution { value, of_impulses: true }),
                _ => {
                    cx.error(word.place, "`poisson` takes one coefficient")
                        .help("write `restitution = poisson(e)`");
                    None
                }
            }
        }
        _ => Some(Restitution { value, of_impulses: false }),
    }
}

/// Returns stiffness and dissipation of compliant surfaces; `None` for rigid ones.
fn read_compliance_options(
    name: &Name,
    restitution: Option<&Expr>,
    arguments: &mut Arguments,
    cx: &mut Diagnostics,
) -> Option<Compliance> {
    let [linear, hertz, dissipation, speed] =
        ["stiffness", "hertz", "dissipation", "speed"].map(|key| arguments.take_expr(key, cx));
    let (stiffness, hertz) = match (linear, hertz) {
        (Some(linear), None) => (linear, false),
        (None, Some(hertz)) => (hertz, true),
        (Some(_), Some(hertz)) => {
            cx.error(hertz.place, format!("`{}` has two stiffnesses", name.text))
                .help("`stiffness` is force by overlap, `hertz` force by its power of 3/2: write one");
            return None;
        }
        (None, None) => {
            if let Some(e) = dissipation.or(speed) {
                cx.error(e.place, format!("`{}` is rigid: nothing yields in it", name.text))
                    .help("add `stiffness = …`, N/m, where surfaces yield");
            }
            return None;
        }
    };
    if let Some(e) = restitution {
        cx.error(e.place.clone(), "surfaces that yield have no coefficient of restitution")
            .help("`dissipation`, s/m, takes energy from their impacts");
    }
    Some(Compliance { stiffness, hertz, dissipation, speed })
}

/// Returns the link of `link.collision()`, or `Some(None)` for `collision()`, which denotes all links of the
/// file. `link.collision(2)` is the third shape of a link.
pub fn collision(surface: &Expr) -> Option<Option<&Expr>> {
    match &surface.kind {
        ExprKind::Method(link, word, arguments)
            if word.id == Some(Method::Collision) && arguments.len() < 2 =>
        {
            Some(Some(link.as_ref()))
        }
        ExprKind::Call(word, arguments) if word.id == Some(Callable::Collision) && arguments.is_empty() => {
            Some(None)
        }
        _ => None,
    }
}

impl Contact {
    /// Whether the contact uses collision geometry of a file.
    pub fn names_collisions(&self) -> bool {
        [&self.first, &self.second].into_iter().any(|surface| collision(surface).is_some())
    }
}
