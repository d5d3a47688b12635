//! Force elements and inputs.

use super::link::LinkId;
use super::motion::Coordinate;
use crate::diag::Place;
use crate::expr::{Expr, Vec3};

/// A linear spring on a coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Spring<'g> {
    /// What it acts on.
    pub on: Coordinate,
    /// Stiffness.
    pub stiffness: Expr<'g>,
    /// Coordinate without force.
    pub free: Expr<'g>,
}

/// A dashpot on a coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Dashpot<'g> {
    /// What it acts on.
    pub on: Coordinate,
    /// Damping coefficient.
    pub damping: Expr<'g>,
}

/// Coulomb friction on a coordinate, regularised as `friction × tanh(rate / friction_speed)`.
#[derive(Clone, Copy, Debug)]
pub struct CoulombFriction<'g> {
    /// What it acts on.
    pub on: Coordinate,
    /// Force or torque of full friction.
    pub friction: Expr<'g>,
}

/// What an entry of `u` does.
#[derive(Clone, Debug)]
pub enum Input<'g> {
    /// Nothing by itself: expressions name it.
    Named,
    /// A force or torque on a coordinate.
    Coordinate(Coordinate),
    /// A force on the sum of coordinates with their ratios: what a motor does behind a gear or on a tendon. Its unit.
    Sum(Vec<Coordinate>, &'static str),
    /// A force on a link.
    Force {
        /// The link.
        link: LinkId,
        /// Point of application, in link axes.
        point: Vec3<'g>,
        /// Direction.
        along: Direction<'g>,
    },
    /// A torque on a link.
    Torque {
        /// The link.
        link: LinkId,
        /// Direction.
        about: Direction<'g>,
    },
}

/// A sum of vectors, each in the axes of a link (of the ground if none).
pub type Direction<'g> = Vec<(Option<LinkId>, Vec3<'g>)>;

/// A force with the rate that it does work on: its power is `force × rate`, and it contributes `force × ∂rate/∂v` to the
/// generalized forces.
#[derive(Clone, Copy, Debug)]
pub struct Load<'g> {
    /// Linear in the velocities.
    pub rate: Expr<'g>,
    /// An expression of state, time and inputs.
    pub force: Expr<'g>,
    /// It takes energy out, as a dashpot does; otherwise it is applied from outside.
    pub dissipative: bool,
}

/// What a load adds that is linear in the accelerations: the force `Σ factor v̇ₖ` on a rate, with `k` and its factor in each pair.
#[derive(Clone, Debug)]
pub struct AccelerationForce<'g> {
    /// Linear in the velocities.
    pub rate: Expr<'g>,
    /// Velocities with the factors of their derivatives: expressions of state and time.
    pub factors: Vec<(usize, Expr<'g>)>,
    /// Where the force is written.
    pub place: Place,
}

/// An inertance on a rate: kinetic energy `½ b rate²`.
#[derive(Clone, Copy, Debug)]
pub struct Inertance<'g> {
    /// Linear in the velocities.
    pub rate: Expr<'g>,
    /// Inertance `b`.
    pub inertance: Expr<'g>,
}
