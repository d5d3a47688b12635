//! Velocities and accelerations of the links, computed after all bodies are placed.

use super::builder::Builder;
use crate::kinematics::{accelerations, twists};
use crate::mechanism::Quantity;

/// Proof that the motion of all links is known, so that expressions with velocities can be read. Created only
/// by [`Builder::compute_motion`].
#[derive(Clone, Copy)]
pub struct Moving(());

impl<'g> Builder<'_, 'g> {
    /// Computes twists and accelerations of the links, for expressions with velocities. Returns `None` if an
    /// element has not been placed.
    pub fn compute_motion(&mut self) -> Option<Moving> {
        if !self.is_placed() {
            return None;
        }
        let g = self.scope.graph;
        self.scope.kinematics.charts.clone_from(&self.model.charts);
        let v: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Velocity(k).expr(g)).collect();
        let a: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Acceleration(k).expr(g)).collect();
        let kinematics = &mut self.scope.kinematics;
        kinematics.twists = twists(&self.model, &kinematics.joints, &v);
        kinematics.accelerations = accelerations(&self.model, &kinematics.joints, &kinematics.twists, &v, &a);
        Some(Moving(()))
    }
}
