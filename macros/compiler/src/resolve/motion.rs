//! Velocities and accelerations of the links, once everything is placed.

use super::builder::Builder;
use crate::kinematics::{accelerations, twists};
use crate::mechanism::Quantity;
use crate::syntax::{Action, ActionKind, ExprKind, Law, Target};

/// That it is known how the links move, so that what names velocities can be read. Comes of [`Builder::know_motion`] alone.
#[derive(Clone, Copy)]
pub struct Moving(());

impl<'g> Builder<'_, 'g> {
    /// Twists and accelerations of the links, for the expressions that name velocities. `None` while something has no place.
    pub fn know_motion(&mut self) -> Option<Moving> {
        if !self.is_placed() {
            return None;
        }
        let g = self.scope.graph;
        self.scope.kinematics.borrow_mut().charts.clone_from(&self.model.charts);
        let v: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Velocity(k).expr(g)).collect();
        let a: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Acceleration(k).expr(g)).collect();
        // Robots are large, and few of them name a velocity.
        let d = self.description;
        let plain = d.actions.iter().all(|a| !needs_motion(a))
            && d.outputs.is_empty()
            && d.constraints.is_empty()
            && d.dissipations.is_empty()
            && d.definitions.is_empty();
        if plain {
            return Some(Moving(()));
        }
        let mut kinematics = self.scope.kinematics.borrow_mut();
        kinematics.twists = twists(&self.model, &kinematics.joints, &v);
        kinematics.accelerations = accelerations(&self.model, &kinematics.joints, &kinematics.twists, &v, &a);
        Some(Moving(()))
    }
}

/// True for force elements that are not on a coordinate or a body as a whole, or have a law or a value.
pub fn needs_motion(action: &Action) -> bool {
    let own = match &action.kind {
        ActionKind::Force { value, .. } | ActionKind::Torque { value, .. } => value.is_some(),
        ActionKind::Gravity { .. } | ActionKind::Attraction { .. } => true,
        ActionKind::Dashpot { law } => !matches!(law, Law::Linear(_)),
        _ => false,
    };
    // A point that a vector says may move on its body.
    own || matches!(&action.on, Target::Between(..))
        || matches!(&action.on, Target::On(e) if matches!(e.kind, ExprKind::Method(..)))
}
