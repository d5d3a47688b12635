//! Cache for the generalized forces of energies and for derivatives with respect to the velocities, since
//! every variant of a model and every function needs them for the same elements.

use super::motion::Chart;
use crate::expr::{Expr, Id};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Derivatives with respect to the velocities that an expression depends on, each with the velocity's index.
pub type VelocityGradient<'g> = Vec<(usize, Expr<'g>)>;

/// Cached derivatives of the expressions of a model, shared by copies of the model.
#[derive(Clone, Debug, Default)]
pub struct DerivativeCache(Rc<RefCell<GradientCache>>);

/// Indices of velocities and derivatives with respect to them, for each expression.
type GradientsByExpression = BTreeMap<Id, Vec<(usize, Id)>>;

#[derive(Debug, Default)]
struct GradientCache {
    energy_forces: GradientsByExpression,
    velocity_derivatives: GradientsByExpression,
    /// Configuration space for which the forces of energies were computed.
    charts: Vec<Chart>,
}

impl DerivativeCache {
    /// Returns the cached gradient of an energy in a configuration space, or computes it with `find`.
    pub fn cached_energy_gradient<'g>(
        &self,
        charts: &[Chart],
        energy: Expr<'g>,
        find: impl FnOnce() -> VelocityGradient<'g>,
    ) -> VelocityGradient<'g> {
        let mut found = self.0.borrow_mut();
        if found.charts != charts {
            found.energy_forces.clear();
            found.charts = charts.to_vec();
        }
        cached_or_computed(&mut found.energy_forces, energy, find)
    }

    /// Returns the cached derivatives of an expression with respect to the velocities, or computes them with
    /// `find`.
    pub fn cached_velocity_derivatives<'g>(
        &self,
        e: Expr<'g>,
        find: impl FnOnce() -> VelocityGradient<'g>,
    ) -> VelocityGradient<'g> {
        cached_or_computed(&mut self.0.borrow_mut().velocity_derivatives, e, find)
    }
}

fn cached_or_computed<'g>(
    known: &mut GradientsByExpression,
    e: Expr<'g>,
    find: impl FnOnce() -> VelocityGradient<'g>,
) -> VelocityGradient<'g> {
    if let Some(list) = known.get(&e.id()) {
        return list.iter().map(|(k, d)| (*k, e.graph().expr(*d))).collect();
    }
    let list = find();
    known.insert(e.id(), list.iter().map(|(k, d)| (*k, d.id())).collect());
    list
}
