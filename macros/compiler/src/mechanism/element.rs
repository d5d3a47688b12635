//! Force elements and inputs of a mechanism.

use super::link::LinkId;
use super::motion::Coordinate;
use crate::diag::Place;
use crate::expr::{Expr, Vec3};

/// Linear spring on a coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Spring<'g> {
    /// Coordinate on which the linear spring acts.
    pub on: Coordinate,
    /// Stiffness, N/m or N·m/rad.
    pub stiffness: Expr<'g>,
    /// Value of the coordinate at which the spring is relaxed.
    pub free: Expr<'g>,
}

/// Linear dashpot on a coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Dashpot<'g> {
    /// Coordinate on which the dashpot acts.
    pub on: Coordinate,
    /// Damping coefficient, N·s/m or N·m·s/rad.
    pub damping: Expr<'g>,
}

/// Coulomb friction on a coordinate, regularised as `friction × tanh(rate / friction_speed)`.
#[derive(Clone, Copy, Debug)]
pub struct CoulombFriction<'g> {
    /// Coordinate on which the dry friction acts.
    pub on: Coordinate,
    /// Force or torque of friction at full slip, N or N·m.
    pub friction: Expr<'g>,
}

/// Effect of an entry of `u` on the mechanism.
#[derive(Clone, Debug)]
pub enum InputEffect<'g> {
    /// Input without an effect of its own: expressions contain it.
    Named,
    /// Input that is a force or torque on a coordinate.
    Coordinate(Coordinate),
    /// Force on a weighted sum of coordinates, such as that of a motor behind a gear or on a tendon, with the
    /// unit of the force.
    Sum(Vec<Coordinate>, &'static str),
    /// Input that is a force on a link.
    Force {
        /// Link on which the input force acts.
        link: LinkId,
        /// Point of application of the input force, in link axes.
        point: Vec3<'g>,
        /// Direction of the input force.
        along: SumOfLinkVectors<'g>,
    },
    /// Input that is a torque on a link.
    Torque {
        /// Link on which the input torque acts.
        link: LinkId,
        /// Direction of the input torque.
        about: SumOfLinkVectors<'g>,
    },
}

/// A sum of vectors, each in the axes of a link (`None`: of the ground).
pub type SumOfLinkVectors<'g> = Vec<(Option<LinkId>, Vec3<'g>)>;

/// A force and the velocity on which it does work. Its power is `force × rate`, and it contributes
/// `force × ∂rate/∂v` to the generalized forces.
#[derive(Clone, Copy, Debug)]
pub struct Load<'g> {
    /// Velocity along which the force acts, linear in the velocities of the mechanism.
    pub rate: Expr<'g>,
    /// Force as an expression of state, time and inputs.
    pub force: Expr<'g>,
    /// True for a force that dissipates energy like a dashpot; false for an applied force.
    pub dissipative: bool,
}

/// Load that is linear in the accelerations: the force `Σ factor v̇ₖ` on the velocity `rate`, where each pair
/// is `k` and its factor.
#[derive(Clone, Debug)]
pub struct AccelerationForce<'g> {
    /// Velocity along which the force acts, linear in the velocities of the mechanism.
    pub rate: Expr<'g>,
    /// Indices of velocities, and factors of their time derivatives: expressions of state and time.
    pub factors: Vec<(usize, Expr<'g>)>,
    /// Source position of the force element.
    pub place: Place,
}

/// An inertance on a velocity: kinetic energy `½ b rate²`.
#[derive(Clone, Copy, Debug)]
pub struct Inertance<'g> {
    /// Relative velocity on which the inerter acts, linear in the velocities of the mechanism.
    pub rate: Expr<'g>,
    /// Inertance `b` of the inerter, kg or kg·m².
    pub inertance: Expr<'g>,
}
