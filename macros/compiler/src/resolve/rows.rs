//! Rows of declared constraints, and the motions used to form them.

use super::builder::Builder;
use super::scope::Terms;
use crate::diag::Place;
use crate::expr::{Expr, Vec3};
use crate::kinematics::jet::{self, Moving, Relative};
use crate::kinematics::time_derivative;
use crate::mechanism::{Constraint, LinkId, Measure};

/// Rows of a declared constraint, which the builder adds to those of the other constraints.
#[derive(Default)]
pub struct ConstraintRows<'g> {
    /// Scalar rows of the constraint; their groups count from zero.
    pub rows: Vec<Constraint<'g>>,
    /// Names of components of the constraint that vanish identically.
    pub redundant: Vec<String>,
    /// Contact point of the surfaces, relative to the ground's origin.
    pub contact_point: Option<Terms<'g>>,
}

impl<'g> Builder<'_, 'g> {
    /// Returns a row of a declared constraint with this rate.
    pub fn constraint_row(
        &self,
        (name, place): (String, &Place),
        measure: Measure,
        residual: Option<Expr<'g>>,
        rate: Expr<'g>,
    ) -> Constraint<'g> {
        Constraint {
            name,
            place: place.clone(),
            residual,
            rate,
            bias: time_derivative(self.model.configuration_space(), rate),
            measure,
            transmits: Vec::new(),
            group: 0,
            determines: false,
            friction: Vec::new(),
        }
    }

    /// Adds the rows of a declared constraint to the model.
    pub fn add_rows(&mut self, name: &str, rows: ConstraintRows<'g>) {
        let first = self.group + 1;
        self.group = first;
        for mut row in rows.rows {
            row.group += first;
            self.group = self.group.max(row.group);
            self.model.constraints.push(row);
        }
        self.model.redundant.extend(rows.redundant);
        self.contact_points.extend(rows.contact_point.map(|point| (name.to_string(), point)));
    }

    /// Returns the motion of a link relative to the nearest common ancestor of it and another link.
    pub fn relative_motion(&self, link: Option<LinkId>, other: Option<LinkId>) -> Relative<'g> {
        jet::relative_motion(&self.model, &self.scope.kinematics.joints, link, other)
    }

    /// Returns a point of a link with its first and second time derivatives.
    pub fn motion_of_point(&self, on: &Relative<'g>, p: Vec3<'g>) -> Moving<'g> {
        jet::motion_of_point(&self.scope.kinematics.joints, on, p)
    }

    /// Returns a direction that is fixed in a link, with its first and second time derivatives.
    pub fn motion_of_direction(&self, on: &Relative<'g>, e: Vec3<'g>) -> Moving<'g> {
        jet::motion_of_direction(&self.scope.kinematics.joints, on, e)
    }

    /// Returns a vector of a link in the axes of the ancestor.
    pub fn direction_out(&self, on: &Relative<'g>, v: Vec3<'g>) -> Vec3<'g> {
        jet::direction_out(&self.scope.kinematics.joints, on, v)
    }
}
