//! The checked mechanism as data: a tree of links with elementary motions, bodies merged into their links,
//! force elements, and constraints as scalar rows. Values are expressions of the parameters. This module
//! computes nothing beyond sums of placements and of mass properties.

mod constraint;
mod contact;
pub mod drawing;
mod element;
mod equilibrium;
mod gradients;
mod index;
mod inertia;
mod limit;
mod link;
mod model;
mod motion;
mod passive;
mod polytope;
mod pose;
mod quantity;
mod requirement;
mod speeds;
mod units;

pub use constraint::{Constraint, Freedom, FrictionTerm, Measure, Pivot, SolvedSide, Transmission};
pub use contact::Contact;
pub use drawing::{Piece, PieceKind, Role};
pub use element::{AccelerationForce, CoulombFriction, Dashpot, Direction, Inertance, Input, Load, Spring};
pub use equilibrium::{DRY_FRICTION, Equilibrium, RestingState};
pub use gradients::{Gradient, Gradients};
pub use index::{InQ, InV};
pub use inertia::Inertia;
pub use limit::Limit;
pub use link::{Link, LinkId, NamedFrame, Space};
pub use model::{Diagram, Model, Origin, OutputValue, Released, Uses};
pub use motion::{Chart, Coordinate, Motion};
pub use passive::PassiveForces;
pub use polytope::{
    PAIR_FEATURES, PAIR_POSE, POINT_FEATURES, Polytope, PolytopeEdge, PolytopeFace, PolytopePair,
};
pub use pose::Pose;
pub use quantity::{Quantity, Supplied};
pub use requirement::{Requirement, Rule};
pub use speeds::Speeds;
pub use units::Units;
