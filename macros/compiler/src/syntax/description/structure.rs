//! What a mechanism is built of: bodies, particles, joints, frames, points, coordinates.

use super::{Expr, Name};
use crate::language::JointKind;

/// A generalized coordinate that belongs to no joint.
#[derive(Clone, Debug)]
pub struct FreeCoordinate {
    /// Its name.
    pub name: Name,
    /// How many joints are declared before it.
    pub joints_before: usize,
}

/// A frame: axes without a place.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Its name.
    pub name: Name,
    /// The body or frame whose axes it starts with.
    pub start: Expr,
    /// Rotations about carried axes.
    pub rotations: Vec<Expr>,
}

/// A point.
#[derive(Clone, Debug)]
pub struct Point {
    /// Its name.
    pub name: Name,
    /// What it is fixed in or measured from: a body or another point; the ground if absent.
    pub on: Option<Expr>,
    /// Its place there.
    pub at: Option<Expr>,
}

/// A rigid body.
#[derive(Clone, Debug)]
pub struct Body {
    /// Its name, which also names its frame.
    pub name: Name,
    /// Mass; zero if absent.
    pub mass: Option<Expr>,
    /// Centre of mass, in body axes from the body's origin; the origin if absent.
    pub com: Option<Expr>,
    /// Inertia in body axes; zero if absent.
    pub inertia: Option<Expr>,
    /// The point that the inertia is about, in body axes from the body's origin; the centre of mass if
    /// absent.
    pub about: Option<Expr>,
    /// Where its origin is, for a body placed by expressions.
    pub at: Option<Expr>,
    /// The frame whose axes it has, for a body placed by expressions.
    pub frame: Option<Expr>,
}

/// A particle: mass at a point.
#[derive(Clone, Debug)]
pub struct Particle {
    /// Its name, which also names its frame (axes of the body that carries it).
    pub name: Name,
    /// Mass.
    pub mass: Expr,
    /// `body.at(vector)`; absent for a particle that is itself the end of a joint.
    pub at: Option<Expr>,
}

/// A joint from a parent to a child.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Its name; it names the coordinate of a joint with one degree of freedom.
    pub name: Name,
    /// Which joint.
    pub kind: JointKind,
    /// Parent body, with the joint's place on it.
    pub parent: Endpoint,
    /// Child body, with the joint's place on it.
    pub child: Endpoint,
    /// Rotation axes, in the joint's frame on the parent (a later one in the carried frame).
    pub about: Vec<Expr>,
    /// Translation axes, in the joint's frame on the parent.
    pub along: Vec<Expr>,
    /// Screw: advance per radian.
    pub pitch: Option<Expr>,
    /// Screw: advance per turn.
    pub lead: Option<Expr>,
    /// The axis need not be of unit length (URDF): it is normalised, and only zero is a mistake.
    pub normalise_axis: bool,
    /// A joint that closes a loop: which of the two solutions of a loop that is solved in closed form.
    pub branch: Option<Expr>,
    /// The coordinate follows another joint's.
    pub mimic: Option<Mimic>,
    /// Viscous damping on the coordinate (URDF).
    pub damping: Option<Expr>,
    /// Coulomb friction on the coordinate (URDF).
    pub friction: Option<Expr>,
    /// The joint's coordinate is an input of its own (URDF: the joint's motor).
    pub driven: bool,
}

/// One end of a joint: `body.at(position).rotated(rotation, …)`.
#[derive(Clone, Debug)]
pub struct Endpoint {
    /// The body (or `ground`).
    pub body: Name,
    /// The joint's place on it, in body axes; its origin if absent.
    pub at: Option<Expr>,
    /// Rotations about carried axes, from the body's axes to the joint's: `z(a)`, `eigenaxis(n, a)`, or a
    /// 3×3 matrix whose columns are the joint's axes.
    pub rotated: Vec<Expr>,
}

/// `coordinate = multiplier × other + offset`.
#[derive(Clone, Debug)]
pub struct Mimic {
    /// The joint that is followed.
    pub joint: Name,
    /// Factor.
    pub multiplier: f64,
    /// Offset.
    pub offset: f64,
}
