//! Forces of a single force element, before they are added to the model.

use crate::expr::Expr;
use crate::mechanism::{
    AccelerationForce, CoulombFriction, Dashpot, Inertance, InputEffect, Load, Model, Spring,
};

/// Forces of a force element, which the builder adds to those of the other elements.
#[derive(Default)]
pub struct ElementForces<'g> {
    /// Springs of constant stiffness that act on one coordinate each.
    pub springs: Vec<Spring<'g>>,
    /// Linear dashpots that act on coordinates.
    pub dashpots: Vec<Dashpot<'g>>,
    /// Coulomb friction forces that act on coordinates.
    pub frictions: Vec<CoulombFriction<'g>>,
    /// Other forces, each with the velocity on which it acts.
    pub loads: Vec<Load<'g>>,
    /// Potential energies of the elements, J.
    pub potentials: Vec<Expr<'g>>,
    /// Rayleigh dissipation functions of the elements, W.
    pub dissipations: Vec<Expr<'g>>,
    /// Inertances, each with the velocity whose rate they resist.
    pub inertances: Vec<Inertance<'g>>,
    /// Force laws that are linear in accelerations.
    pub acceleration_forces: Vec<AccelerationForce<'g>>,
    /// Effect of the entry of `u` that belongs to the element.
    pub input: Option<InputEffect<'g>>,
}

impl<'g> ElementForces<'g> {
    /// Returns the forces that derive from potential energies.
    pub fn forces_of_potentials(energies: impl IntoIterator<Item = Expr<'g>>) -> ElementForces<'g> {
        ElementForces { potentials: energies.into_iter().collect(), ..ElementForces::default() }
    }

    /// Returns a force that opposes a rate and dissipates energy.
    pub fn resisting_force(rate: Expr<'g>, force: Expr<'g>) -> ElementForces<'g> {
        ElementForces {
            loads: vec![Load { rate, force: -force, dissipative: true }],
            ..ElementForces::default()
        }
    }

    /// Whether there are no forces and no inputs.
    pub fn is_empty(&self) -> bool {
        let linear = self.springs.len() + self.dashpots.len() + self.frictions.len();
        let functions = self.potentials.len() + self.dissipations.len();
        let forces = self.loads.len() + self.inertances.len() + self.acceleration_forces.len();
        linear + functions + forces == 0 && self.input.is_none()
    }

    /// Adds the forces of the element to those of a model.
    pub fn add_forces_to_model(self, model: &mut Model<'g>) {
        model.springs.extend(self.springs);
        model.dashpots.extend(self.dashpots);
        model.frictions.extend(self.frictions);
        model.loads.extend(self.loads);
        model.potentials.extend(self.potentials);
        model.dissipations.extend(self.dissipations);
        model.inertances.extend(self.inertances);
        model.acceleration_forces.extend(self.acceleration_forces);
    }
}
