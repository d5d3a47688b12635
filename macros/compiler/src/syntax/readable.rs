//! Parts of a mechanism that can be checked in spite of errors of grammar: everything that does not depend on
//! them. Their errors are independent of the corrections, so that all errors are reported at once.

use super::{Body, Description, Formulation, Name, RATE_OF_STATE};
use crate::diag::nearest_candidate;
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use std::collections::BTreeSet;
use syn::Field;

/// Options of `#[mechanism]` that the check of individual fields needs.
const GLOBAL_OPTIONS: [&str; 2] = ["urdf", "inertia"];

/// Identifiers that occur in the attributes of one field of a mechanism.
struct FieldIdentifiers {
    name: Name,
    words: BTreeSet<String>,
    /// Whether the field is a body placed by joints. The name of such a body is known even if its attribute
    /// has errors.
    body: bool,
    has_errors: bool,
}

/// Fields of a mechanism with the identifiers in their attributes, and which fields have syntax errors.
#[derive(Default)]
pub struct MechanismReadability {
    fields: Vec<FieldIdentifiers>,
    unreadable: bool,
}

impl MechanismReadability {
    /// Records a field with the identifiers in its attributes: it cannot be checked if one of these names a
    /// field with a syntax error.
    pub fn record_field_identifiers(&mut self, field: &Field) {
        let mut words = BTreeSet::new();
        for attribute in &field.attrs {
            collect_identifiers(attribute.to_token_stream(), &mut words);
        }
        let placed = ["at", "frame", "massive"].iter().any(|word| words.contains(*word));
        let body = field.ty.to_token_stream().to_string() == "Body" && !placed;
        let name = field.ident.as_ref().map(super::expression::name_from_identifier);
        self.fields.extend(name.map(|name| FieldIdentifiers { name, words, body, has_errors: false }));
    }

    /// Marks the whole mechanism as unreadable after a syntax error.
    pub fn mark_mechanism_unreadable(&mut self) {
        self.unreadable = true;
    }

    /// Marks the most recently recorded field as unreadable.
    pub fn mark_last_field_unreadable(&mut self) {
        if let Some(field) = self.fields.last_mut() {
            field.has_errors = true;
        }
    }

    /// Marks the fields with this name as unreadable, since the name is ambiguous.
    pub fn mark_ambiguous_fields(&mut self, name: &str) {
        for field in self.fields.iter_mut().filter(|field| field.name.text == name) {
            (field.has_errors, field.body) = (true, false);
        }
    }

    /// Marks the mechanism as unreadable if the arguments of the attribute, which could not be read, contain
    /// an option with which fields are checked.
    pub fn mark_if_options_unreadable(&mut self, arguments: TokenStream) {
        let mut words = BTreeSet::new();
        collect_identifiers(arguments, &mut words);
        self.unreadable |= words.iter().any(|word| {
            nearest_candidate(word, &GLOBAL_OPTIONS).is_some() || GLOBAL_OPTIONS.contains(&word.as_str())
        });
    }

    /// Returns the description without unreadable fields and without fields that depend on them; `None` if
    /// nothing remains.
    pub fn readable_description(&self, whole: &Description) -> Option<Description> {
        if self.unreadable {
            return None;
        }
        let (unreadable, bodies) = self.unreadable_field_names();
        let is_readable = |name: &Name| !unreadable.contains(name.text.as_str());
        let is_resolvable = |e: &super::Expr| {
            e.all_subexpressions().iter().all(|e| e.as_name().is_none_or(|n| !unreadable.contains(n)))
        };
        let mut d = whole.clone();
        d.partial = true;
        d.formulation = Formulation::default();
        d.gravity = d.gravity.filter(is_resolvable);
        d.friction_speed = d.friction_speed.filter(is_resolvable);
        d.bodies.retain(|b| is_readable(&b.name) && bodies.iter().all(|name| name.text != b.name.text));
        d.bodies.extend(bodies.into_iter().map(massless_body));
        d.particles.retain(|p| is_readable(&p.name));
        d.joints.retain(|j| is_readable(&j.name));
        d.actions.retain(|a| is_readable(&a.name));
        d.limits.retain(|l| is_readable(&l.name));
        d.equilibria.retain(|e| is_readable(&e.name));
        d.coordinates.retain(|c| is_readable(&c.name));
        d.inputs.retain(is_readable);
        d.frames.retain(|f| is_readable(&f.name));
        d.points.retain(|p| is_readable(&p.name));
        d.definitions.retain(|d| is_readable(&d.name));
        // Speeds replace velocities only all together.
        if d.speeds.iter().any(|name| !is_readable(name)) {
            d.speeds.clear();
        }
        // Rates of states are among the outputs.
        let is_unreadable_rate =
            |name: &str| name.strip_suffix(RATE_OF_STATE).is_some_and(|state| unreadable.contains(state));
        d.outputs.retain(|d| is_readable(&d.name) && !is_unreadable_rate(&d.name.text));
        d.states.retain(|(name, _)| is_readable(name));
        d.energies.retain(|(name, _)| is_readable(name));
        d.dissipations.retain(|(name, _)| is_readable(name));
        d.constraints.retain(|c| is_readable(&c.name));
        d.contacts.retain(|c| is_readable(&c.name));
        (!d.bodies.is_empty() || !d.particles.is_empty()).then_some(d)
    }

    /// Returns the names of unreadable fields and of all fields that depend on them; and bodies of which only
    /// the name is known.
    fn unreadable_field_names(&self) -> (BTreeSet<&str>, Vec<&Name>) {
        let mut unreadable = BTreeSet::new();
        let mut bodies: Vec<&Name> = Vec::new();
        let mut more = true;
        while more {
            more = false;
            for field in &self.fields {
                let name = field.name.text.as_str();
                let known = unreadable.contains(name) || bodies.iter().any(|body| body.text == name);
                if known
                    || !(field.has_errors
                        || field.words.iter().any(|word| unreadable.contains(word.as_str())))
                {
                    continue;
                }
                more = true;
                match field.body {
                    true => bodies.push(&field.name),
                    false => _ = unreadable.insert(name),
                }
            }
        }
        (unreadable, bodies)
    }
}

/// Returns a body without mass and inertia.
fn massless_body(name: &Name) -> Body {
    Body { name: name.clone(), mass: None, com: None, inertia: None, about: None, at: None, frame: None }
}

/// Collects all identifiers in a token stream, including nested groups.
fn collect_identifiers(tokens: TokenStream, words: &mut BTreeSet<String>) {
    for token in tokens {
        match token {
            TokenTree::Ident(word) => _ = words.insert(word.to_string()),
            TokenTree::Group(group) => collect_identifiers(group.stream(), words),
            _ => {}
        }
    }
}
