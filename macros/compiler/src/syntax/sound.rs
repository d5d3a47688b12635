//! Parts of a mechanism that can be checked in spite of errors of grammar: everything that does not depend on
//! them. Their errors are independent of the corrections, so that all errors are reported at once.

use super::{Body, Description, Formulation, Name, RATE_OF_STATE};
use crate::diag::nearest;
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use std::collections::BTreeSet;
use syn::Field;

/// Options of `#[mechanism]` with which fields are checked.
const FAR: [&str; 2] = ["urdf", "inertia"];

/// Words in the attributes of one field.
struct Words {
    name: Name,
    words: BTreeSet<String>,
    /// Whether it is a body placed by joints; its name is then known in spite of errors in its attribute.
    body: bool,
    broken: bool,
}

/// Words of the attribute and of every field, and which of them could be read.
#[derive(Default)]
pub struct Reading {
    fields: Vec<Words>,
    lost: bool,
}

impl Reading {
    /// Records a field.
    pub fn field(&mut self, field: &Field) {
        let mut words = BTreeSet::new();
        for attribute in &field.attrs {
            collect(attribute.to_token_stream(), &mut words);
        }
        let placed = ["at", "frame", "massive"].iter().any(|word| words.contains(*word));
        let body = field.ty.to_token_stream().to_string() == "Body" && !placed;
        let name = field.ident.as_ref().map(super::expression::name);
        self.fields.extend(name.map(|name| Words { name, words, body, broken: false }));
    }

    /// Marks the whole mechanism as unreadable.
    pub fn lose(&mut self) {
        self.lost = true;
    }

    /// Marks the last field as unreadable.
    pub fn blame_last(&mut self) {
        if let Some(field) = self.fields.last_mut() {
            field.broken = true;
        }
    }

    /// Marks fields with an ambiguous name as unreadable.
    pub fn blame(&mut self, name: &str) {
        for field in self.fields.iter_mut().filter(|field| field.name.text == name) {
            (field.broken, field.body) = (true, false);
        }
    }

    /// Marks the mechanism as unreadable if the arguments of the attribute, which could not be read, contain
    /// an option with which fields are checked.
    pub fn blame_arguments(&mut self, arguments: TokenStream) {
        let mut words = BTreeSet::new();
        collect(arguments, &mut words);
        self.lost |= words.iter().any(|word| nearest(word, &FAR).is_some() || FAR.contains(&word.as_str()));
    }

    /// Returns the description without unreadable fields and without those that depend on them. `None` if
    /// nothing remains.
    pub fn rest(&self, whole: &Description) -> Option<Description> {
        if self.lost {
            return None;
        }
        let (lost, bodies) = self.lost_names();
        let kept = |name: &Name| !lost.contains(name.text.as_str());
        let reads = |e: &super::Expr| e.parts().iter().all(|e| e.name().is_none_or(|n| !lost.contains(n)));
        let mut d = whole.clone();
        d.partial = true;
        d.formulation = Formulation::default();
        d.gravity = d.gravity.filter(reads);
        d.friction_speed = d.friction_speed.filter(reads);
        d.bodies.retain(|b| kept(&b.name) && bodies.iter().all(|name| name.text != b.name.text));
        d.bodies.extend(bodies.into_iter().map(massless));
        d.particles.retain(|p| kept(&p.name));
        d.joints.retain(|j| kept(&j.name));
        d.actions.retain(|a| kept(&a.name));
        d.limits.retain(|l| kept(&l.name));
        d.equilibria.retain(|e| kept(&e.name));
        d.coordinates.retain(|c| kept(&c.name));
        d.inputs.retain(kept);
        d.frames.retain(|f| kept(&f.name));
        d.points.retain(|p| kept(&p.name));
        d.definitions.retain(|d| kept(&d.name));
        // Speeds replace velocities only all together.
        if d.speeds.iter().any(|name| !kept(name)) {
            d.speeds.clear();
        }
        // Rates of states are among the outputs.
        let is_lost_rate =
            |name: &str| name.strip_suffix(RATE_OF_STATE).is_some_and(|state| lost.contains(state));
        d.outputs.retain(|d| kept(&d.name) && !is_lost_rate(&d.name.text));
        d.states.retain(|(name, _)| kept(name));
        d.energies.retain(|(name, _)| kept(name));
        d.dissipations.retain(|(name, _)| kept(name));
        d.constraints.retain(|c| kept(&c.name));
        d.contacts.retain(|c| kept(&c.name));
        (!d.bodies.is_empty() || !d.particles.is_empty()).then_some(d)
    }

    /// Returns the names of unreadable fields and of all fields that depend on them; and bodies of which only
    /// the name is known.
    fn lost_names(&self) -> (BTreeSet<&str>, Vec<&Name>) {
        let mut lost = BTreeSet::new();
        let mut bodies: Vec<&Name> = Vec::new();
        let mut more = true;
        while more {
            more = false;
            for field in &self.fields {
                let name = field.name.text.as_str();
                let known = lost.contains(name) || bodies.iter().any(|body| body.text == name);
                if known || !(field.broken || field.words.iter().any(|word| lost.contains(word.as_str()))) {
                    continue;
                }
                more = true;
                match field.body {
                    true => bodies.push(&field.name),
                    false => _ = lost.insert(name),
                }
            }
        }
        (lost, bodies)
    }
}

/// Returns a body without mass and inertia.
fn massless(name: &Name) -> Body {
    Body { name: name.clone(), mass: None, com: None, inertia: None, about: None, at: None, frame: None }
}

/// Collects all identifiers among tokens.
fn collect(tokens: TokenStream, words: &mut BTreeSet<String>) {
    for token in tokens {
        match token {
            TokenTree::Ident(word) => _ = words.insert(word.to_string()),
            TokenTree::Group(group) => collect(group.stream(), words),
            _ => {}
        }
    }
}
