//! Spatial vectors of expressions: twists and wrenches.

use crate::expr::{Expr, Vec3};
use crate::mechanism::Model;

/// A spatial vector with linear and angular component: a twist (velocity of the link's origin, angular
/// velocity), or a wrench (force, moment about the link's origin).
#[derive(Clone, Copy, Debug)]
pub struct SpatialVector<'g> {
    /// Linear part of a spatial vector: velocity of the origin, or force.
    pub linear: Vec3<'g>,
    /// Angular part of a spatial vector: angular velocity, or moment about the origin.
    pub angular: Vec3<'g>,
}

impl<'g> SpatialVector<'g> {
    /// Returns the spatial vector of zeros.
    pub fn zero(model: &Model<'g>) -> SpatialVector<'g> {
        SpatialVector { linear: Vec3::zero(model.graph), angular: Vec3::zero(model.graph) }
    }

    /// Returns the inner product; of a twist and a wrench it is the power.
    pub fn dot(&self, other: &SpatialVector<'g>) -> Expr<'g> {
        self.linear.dot(other.linear) + self.angular.dot(other.angular)
    }

    /// Returns the sum of two spatial vectors.
    pub fn plus(&self, other: &SpatialVector<'g>) -> SpatialVector<'g> {
        SpatialVector { linear: self.linear + other.linear, angular: self.angular + other.angular }
    }

    /// Returns the spatial vector multiplied by a scalar.
    pub fn times_scalar(&self, s: Expr<'g>) -> SpatialVector<'g> {
        SpatialVector { linear: self.linear * s, angular: self.angular * s }
    }
}

/// Applies a function to every component of a spatial vector.
pub fn map_spatial<'g>(s: &SpatialVector<'g>, mut f: impl FnMut(Expr<'g>) -> Expr<'g>) -> SpatialVector<'g> {
    SpatialVector { linear: s.linear.map(&mut f), angular: s.angular.map(&mut f) }
}
