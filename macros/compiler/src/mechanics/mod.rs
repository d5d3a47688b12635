//! The mechanism's equations as expressions, by the recursive algorithms of rigid-body dynamics run symbolically
//! (Featherstone, *Rigid Body Dynamics Algorithms*, 2008; linear part first here). Every algorithm works in link
//! axes, where motion subspaces are constant. Knows no tokens.

use crate::expr::{Expr, Vec3};
use crate::model::{Coordinate, Model, Motion, Quantity};

pub mod aba;
pub mod crba;
pub mod energy;
pub mod forces;
pub mod frames;
pub mod kinematics;
pub mod lagrange;
pub mod ldl;
pub mod momentum;
pub mod regularity;
pub mod rnea;

pub use kinematics::{Dof, Joint, joints};

/// Value of a coordinate as an expression of `q`.
pub fn position<'g>(model: &Model<'g>, c: &Coordinate) -> Expr<'g> {
    let g = model.graph;
    Quantity::Configuration(c.q).expr(g) * g.num(c.ratio) + g.num(c.offset)
}

/// Rate of a coordinate as an expression of `v`.
pub fn rate<'g>(model: &Model<'g>, c: &Coordinate) -> Expr<'g> {
    Quantity::Velocity(c.v).expr(model.graph) * model.graph.num(c.ratio)
}

/// All velocities as symbols.
pub fn velocities<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    (0..model.nv()).map(|k| Quantity::Velocity(k).expr(model.graph)).collect()
}

/// All accelerations as symbols.
pub fn accelerations<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    (0..model.nv()).map(|k| Quantity::Acceleration(k).expr(model.graph)).collect()
}

/// True if every velocity belongs to one joint coordinate, so that the articulated-body algorithm applies.
pub fn is_plain_tree(model: &Model<'_>) -> bool {
    model.links.iter().all(|link| match &link.motion {
        Motion::Turn { coordinate, .. }
        | Motion::Slide { coordinate, .. }
        | Motion::Helix { coordinate, .. } => coordinate.ratio == 1.0 && coordinate.offset == 0.0,
        Motion::Ball { .. } | Motion::Free { .. } => true,
    })
}

/// A spatial vector: linear part, angular part. A twist (velocity of the link's origin, angular velocity), or a wrench
/// (force, moment about the link's origin).
#[derive(Clone, Copy, Debug)]
pub struct Spatial<'g> {
    /// Velocity or force.
    pub linear: Vec3<'g>,
    /// Angular velocity or moment.
    pub angular: Vec3<'g>,
}

impl<'g> Spatial<'g> {
    /// Zero.
    pub fn zero(model: &Model<'g>) -> Spatial<'g> {
        Spatial { linear: Vec3::zero(model.graph), angular: Vec3::zero(model.graph) }
    }

    /// Twist dotted with wrench: a power.
    pub fn dot(&self, other: &Spatial<'g>) -> Expr<'g> {
        self.linear.dot(other.linear) + self.angular.dot(other.angular)
    }

    /// The sum.
    pub fn plus(&self, other: &Spatial<'g>) -> Spatial<'g> {
        Spatial { linear: self.linear + other.linear, angular: self.angular + other.angular }
    }

    /// All components multiplied.
    pub fn times(&self, s: Expr<'g>) -> Spatial<'g> {
        Spatial { linear: self.linear * s, angular: self.angular * s }
    }
}
