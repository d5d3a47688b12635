//! Velocities and accelerations of the links, once everything is placed.

use super::builder::Builder;
use crate::kinematics::{accelerations, twists};
use crate::mechanism::Quantity;

/// That it is known how the links move, so that what names velocities can be read. Comes of
/// [`Builder::know_motion`] alone.
#[derive(Clone, Copy)]
pub struct Moving(());

impl<'g> Builder<'_, 'g> {
    /// Twists and accelerations of the links, for the expressions that name velocities. `None` while
    /// something has no place.
    pub fn know_motion(&mut self) -> Option<Moving> {
        if !self.is_placed() {
            return None;
        }
        let g = self.scope.graph;
        self.scope.kinematics.borrow_mut().charts.clone_from(&self.model.charts);
        let v: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Velocity(k).expr(g)).collect();
        let a: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Acceleration(k).expr(g)).collect();
        let mut kinematics = self.scope.kinematics.borrow_mut();
        kinematics.twists = twists(&self.model, &kinematics.joints, &v);
        kinematics.accelerations = accelerations(&self.model, &kinematics.joints, &kinematics.twists, &v, &a);
        Some(Moving(()))
    }
}
