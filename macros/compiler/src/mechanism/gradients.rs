//! The forces of energies, and derivatives by the velocities, found once: every form of a model and every function asks for
//! those of the same elements.

use super::motion::Chart;
use crate::expr::{Expr, Id};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Derivatives by the velocities that an expression depends on, each with its velocity's number.
pub type Gradient<'g> = Vec<(usize, Expr<'g>)>;

/// What was found for the expressions of a model; copies of the model share it.
#[derive(Clone, Debug, Default)]
pub struct Gradients(Rc<RefCell<Found>>);

/// By expression: numbers of velocities and derivatives.
type Known = BTreeMap<Id, Vec<(usize, Id)>>;

#[derive(Debug, Default)]
struct Found {
    of_energies: Known,
    by_velocities: Known,
    /// Those in which the forces of energies were found.
    charts: Vec<Chart>,
}

impl Gradients {
    /// What is known of an energy in a configuration space, or else what `find` finds.
    pub fn of_energy<'g>(
        &self,
        charts: &[Chart],
        energy: Expr<'g>,
        find: impl FnOnce() -> Gradient<'g>,
    ) -> Gradient<'g> {
        let mut found = self.0.borrow_mut();
        if found.charts != charts {
            found.of_energies.clear();
            found.charts = charts.to_vec();
        }
        known_or(&mut found.of_energies, energy, find)
    }

    /// What is known of an expression's derivatives by the velocities, or else what `find` finds.
    pub fn by_velocity<'g>(&self, e: Expr<'g>, find: impl FnOnce() -> Gradient<'g>) -> Gradient<'g> {
        known_or(&mut self.0.borrow_mut().by_velocities, e, find)
    }
}

fn known_or<'g>(known: &mut Known, e: Expr<'g>, find: impl FnOnce() -> Gradient<'g>) -> Gradient<'g> {
    if let Some(list) = known.get(&e.id()) {
        return list.iter().map(|(k, d)| (*k, e.graph().expr(*d))).collect();
    }
    let list = find();
    known.insert(e.id(), list.iter().map(|(k, d)| (*k, d.id())).collect());
    list
}
