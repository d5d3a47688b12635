//! Structure of a mechanism: bodies, particles, joints, frames, points, coordinates.

use super::{Expr, Name};
use crate::language::JointKind;

/// A generalized coordinate that belongs to no joint.
#[derive(Clone, Debug)]
pub struct FreeCoordinate {
    /// Name of the declared coordinate.
    pub name: Name,
    /// Number of joints declared before the coordinate, which determines its index.
    pub joints_before: usize,
}

/// Frame of the mechanism: axes without a position.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Name of the frame.
    pub name: Name,
    /// Body or frame whose axes are the starting point of the rotations.
    pub start: Expr,
    /// Successive rotations of the frame about rotated axes.
    pub rotations: Vec<Expr>,
}

/// Point that is fixed in a body.
#[derive(Clone, Debug)]
pub struct Point {
    /// Name of the declared point.
    pub name: Name,
    /// Body or point relative to which it is fixed; the ground if absent.
    pub on: Option<Expr>,
    /// Position of the point relative to that body or point.
    pub at: Option<Expr>,
}

/// Rigid body of the mechanism, as declared.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name of the body and of its frame.
    pub name: Name,
    /// Mass of the body, kg; zero if absent.
    pub mass: Option<Expr>,
    /// Centre of mass, in body axes relative to the body's origin; the origin if absent.
    pub com: Option<Expr>,
    /// Inertia of the body in body axes; zero if absent.
    pub inertia: Option<Expr>,
    /// Reference point of the inertia, in body axes relative to the body's origin; the centre of mass if
    /// absent.
    pub about: Option<Expr>,
    /// Position of the origin, for a body placed by expressions.
    pub at: Option<Expr>,
    /// Frame with the axes of the body, for a body placed by expressions.
    pub frame: Option<Expr>,
}

/// Particle of the mechanism: a mass at a point.
#[derive(Clone, Debug)]
pub struct Particle {
    /// Name of the particle and of its frame, whose axes are those of its carrier.
    pub name: Name,
    /// Mass of the particle.
    pub mass: Expr,
    /// Position `body.at(vector)`; absent for a particle that is the child of a joint.
    pub at: Option<Expr>,
}

/// Joint of the mechanism from a parent to a child body.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name of the joint, and of its coordinate if it has one degree of freedom.
    pub name: Name,
    /// Type of the joint.
    pub kind: JointKind,
    /// Parent body, with the joint's frame on it.
    pub parent: Endpoint,
    /// Child body, with the joint's frame on it.
    pub child: Endpoint,
    /// Rotation axes, in the joint's frame on the parent (a later axis in the rotated frame).
    pub about: Vec<Expr>,
    /// Translation axes, in the joint's frame on the parent.
    pub along: Vec<Expr>,
    /// Advance per radian of a screw joint, m/rad.
    pub pitch: Option<Expr>,
    /// Advance per revolution of a screw joint, m.
    pub lead: Option<Expr>,
    /// Whether the axis is normalised (URDF); only a zero axis is then an error.
    pub normalise_axis: bool,
    /// Assembly mode of a loop that is solved in closed form, for its closing joint.
    pub branch: Option<Expr>,
    /// Joint whose coordinate this joint follows.
    pub mimic: Option<MimicRelation>,
    /// Viscous damping on the coordinate (URDF).
    pub damping: Option<Expr>,
    /// Coulomb friction on the coordinate (URDF).
    pub friction: Option<Expr>,
    /// Whether the joint has an input of its own (URDF: the joint's motor).
    pub driven: bool,
    /// Coordinates in the pose of the robot file, in the order of `q`; empty if they are those of the neutral
    /// configuration.
    pub initial: Vec<f64>,
}

/// End of a joint on a body: `body.at(position).rotated(rotation, …)`.
#[derive(Clone, Debug)]
pub struct Endpoint {
    /// Body on which the end is fixed, or `ground`.
    pub body: Name,
    /// Position of the joint on the body, in body axes; the body's origin if absent.
    pub at: Option<Expr>,
    /// Rotations about rotated axes, from the body's axes to the joint's: `z(a)`, `eigenaxis(n, a)`, or a 3×3
    /// matrix whose columns are the joint's axes.
    pub rotated: Vec<Expr>,
}

/// Mimic relation of a joint: `coordinate = multiplier × other + offset`.
#[derive(Clone, Debug)]
pub struct MimicRelation {
    /// Joint whose coordinate the mimic joint follows.
    pub joint: Name,
    /// Factor of the followed coordinate.
    pub multiplier: f64,
    /// Offset that is added to the scaled coordinate.
    pub offset: f64,
}
