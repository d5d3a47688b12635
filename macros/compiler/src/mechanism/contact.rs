//! Unilateral contacts of a mechanism, as data of the model.

use super::model::Model;
use super::quantity::Quantity;
use crate::expr::Expr;
use crate::expr::replace::{substitute_symbols_in_all, symbols_in};

/// Unilateral contact of two surfaces, or of a coordinate with its stop: separation, impact, sliding and
/// sticking.
#[derive(Clone, Debug)]
pub struct Contact<'g> {
    /// Name of the contact, with the index of the point if a pair of surfaces has several points.
    pub name: String,
    /// Gap function, an expression of configuration and time: negative if the surfaces penetrate.
    pub gap: Expr<'g>,
    /// True if the gap is an angle, as for the stop of a pin.
    pub turns: bool,
    /// Index of the contact that supplies the normal force, if this entry is a friction moment of that
    /// contact. A friction moment has the gap of that contact, and only angular velocities.
    pub pressed_by: Option<usize>,
    /// Contact velocities, linear in the velocities: the normal (gap) velocity, followed by slip velocities
    /// along one or two tangents if there is friction.
    pub rates: Vec<Expr<'g>>,
    /// Coefficient of friction; for a friction moment, the maximum moment per unit of normal force.
    pub friction: Expr<'g>,
    /// Coefficient of friction at rest; that of sliding unless `stiction` is given.
    pub stiction: Expr<'g>,
    /// Coefficient of restitution of the contact.
    pub restitution: Expr<'g>,
    /// True if the coefficient of restitution is a ratio of impulses (Poisson), false if it is a ratio of
    /// velocities (Newton).
    pub of_impulses: bool,
}

/// Velocities on which the contact velocities of a contact depend.
#[derive(Clone, Copy, Debug)]
pub struct ContactVelocityDependence {
    /// Index of the first velocity that changes the contact velocities, and behind the last.
    pub columns: (usize, usize),
    /// True if the contact velocities may differ from zero at rest, because of prescribed motions.
    pub drifts: bool,
}

impl Model<'_> {
    /// Returns the velocities on which the contact velocities of each contact depend.
    pub fn contact_velocity_dependences(&self) -> Vec<ContactVelocityDependence> {
        let velocity_index = |symbol| match Quantity::from_symbol(symbol) {
            Quantity::Velocity(k) => Some(k),
            _ => None,
        };
        let rates = self.contact_rates();
        let at_rest = substitute_symbols_in_all(&rates, &|symbol| {
            velocity_index(symbol).is_some().then(|| self.graph.zero())
        });
        let mut at_rest = at_rest.as_slice();
        let dependence_of_contact = |contact: &Contact<'_>| {
            let used: Vec<usize> =
                symbols_in(&contact.rates).into_iter().filter_map(velocity_index).collect();
            let ends = used.iter().min().zip(used.iter().max());
            let (own_at_rest, others) = at_rest.split_at(contact.rates.len());
            at_rest = others;
            ContactVelocityDependence {
                columns: ends.map_or((0, 0), |(first, last)| (*first, last + 1)),
                drifts: own_at_rest.iter().any(|rate| *rate != self.graph.zero()),
            }
        };
        self.contacts.iter().map(dependence_of_contact).collect()
    }
}
