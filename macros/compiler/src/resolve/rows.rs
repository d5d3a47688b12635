//! Rows of declared constraints, and the motions used to form them.

use super::builder::Builder;
use crate::diag::Place;
use crate::expr::{Expr, Vec3};
use crate::kinematics::jet::{self, Moving, Relative};
use crate::kinematics::time_derivative;
use crate::mechanism::{Constraint, LinkId, Measure};

impl<'g> Builder<'_, 'g> {
    /// Adds a row of a declared constraint with this rate.
    pub fn push_rate(
        &mut self,
        (name, place): (String, &Place),
        measure: Measure,
        residual: Option<Expr<'g>>,
        rate: Expr<'g>,
    ) {
        let bias = time_derivative(self.model.space(), rate);
        self.model.constraints.push(Constraint {
            name,
            place: place.clone(),
            residual,
            rate,
            bias,
            measure,
            transmits: Vec::new(),
            group: self.group,
            determines: false,
            friction: Vec::new(),
        });
    }

    /// Returns the motion of a link relative to the nearest common ancestor of it and another link.
    pub fn relative(&self, link: Option<LinkId>, other: Option<LinkId>) -> Relative<'g> {
        jet::relative(&self.model, &self.scope.kinematics.joints, link, other)
    }

    /// Returns a point of a link, with its rates.
    pub fn point(&self, on: &Relative<'g>, p: Vec3<'g>) -> Moving<'g> {
        jet::point(&self.scope.kinematics.joints, on, p)
    }

    /// Returns a direction fixed in a link, with its rates.
    pub fn direction(&self, on: &Relative<'g>, e: Vec3<'g>) -> Moving<'g> {
        jet::direction(&self.scope.kinematics.joints, on, e)
    }

    /// Returns a vector of a link in the axes of the ancestor.
    pub fn direction_out(&self, on: &Relative<'g>, v: Vec3<'g>) -> Vec3<'g> {
        jet::direction_out(&self.scope.kinematics.joints, on, v)
    }
}
