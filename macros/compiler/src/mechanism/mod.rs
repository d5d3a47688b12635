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
mod link_block;
mod model;
mod motion;
mod passive;
mod polytope;
mod pose;
mod quantity;
mod requirement;
mod speeds;
mod units;

pub use constraint::{
    ClosedFormJoint, Constraint, ConstraintPivot, DegreeOfFreedomCounts, FrictionTerm, MeasuredQuantity,
    ReactionComponent,
};
pub use contact::{Contact, ContactVelocityDependence};
pub use drawing::{Piece, PieceShape, ShownObjectKind};
pub use element::{
    AccelerationForce, CoulombFriction, Dashpot, Inertance, InputEffect, Load, Spring, SumOfLinkVectors,
};
pub use equilibrium::{DRY_FRICTION, Equilibrium, FirstOrderStateAtEquilibrium};
pub use gradients::{DerivativeCache, VelocityGradient};
pub use index::{InQ, InV};
pub use inertia::Inertia;
pub use limit::CoordinateLimits;
pub use link::{ConfigurationSpace, Link, LinkId, NamedFrame};
pub use link_block::{BLOCK_LENGTH, LINK_QUANTITIES, LinkBlock, MASS_PROPERTIES};
pub use model::{ActionOrigin, FreeBodyDiagram, Model, OutputExpression, ReleasedMechanism, UsedQuantities};
pub use motion::{Chart, Coordinate, Motion};
pub use passive::PassiveForces;
pub use polytope::{
    CYLINDER_PAIR_FEATURES, CYLINDER_POINT_FEATURES, CYLINDER_POINTS, PAIR_FEATURES, PAIR_POSE,
    POINT_FEATURES, Polytope, PolytopeEdge, PolytopeFace, PolytopePair,
};
pub use pose::Pose;
pub use quantity::{Quantity, SuppliedQuantity};
pub use requirement::{Requirement, Rule};
pub use speeds::Speeds;
pub use units::Units;
