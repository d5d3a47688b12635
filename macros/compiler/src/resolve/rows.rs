//! Rows of constraints that were declared, and the motions that they are made of.

use super::builder::Builder;
use crate::diag::Place;
use crate::expr::{Expr, Vec3};
use crate::kinematics::jet::{self, Moving, Relative};
use crate::kinematics::time_derivative;
use crate::mechanism::{Constraint, LinkId, Measure};

impl<'g> Builder<'_, 'g> {
    /// A row of a constraint that was declared, whose rate is known.
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

    /// Motion of a link relative to the nearest link that carries it and another.
    pub fn relative(&self, link: Option<LinkId>, other: Option<LinkId>) -> Relative<'g> {
        jet::relative(&self.model, &self.scope.kinematics.borrow().joints, link, other)
    }

    /// A point of a link.
    pub fn point(&self, on: &Relative<'g>, p: Vec3<'g>) -> Moving<'g> {
        jet::point(&self.scope.kinematics.borrow().joints, on, p)
    }

    /// A direction fixed in a link.
    pub fn direction(&self, on: &Relative<'g>, e: Vec3<'g>) -> Moving<'g> {
        jet::direction(&self.scope.kinematics.borrow().joints, on, e)
    }

    /// A vector of a link, in the axes of the ancestor.
    pub fn direction_out(&self, on: &Relative<'g>, v: Vec3<'g>) -> Vec3<'g> {
        jet::direction_out(&self.scope.kinematics.borrow().joints, on, v)
    }
}
