//! What a mechanism looks like: solids, surfaces, joints and force elements, each fixed in named frames.

use crate::expr::{Expr, Mat3, Vec3};

/// A part of the drawing.
#[derive(Clone, Debug)]
pub struct Piece<'g> {
    /// Name of what it shows.
    pub name: String,
    /// What of the declaration it is.
    pub role: Role,
    /// What it looks like.
    pub kind: PieceKind,
    /// Indices of the frames that its first and its second vector are fixed in; the ground if none.
    pub frames: [Option<usize>; 2],
    /// Its numbers, in the axes of those frames: expressions of the parameters alone.
    pub numbers: Vec<Expr<'g>>,
}

/// What of a declaration a piece shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A body, by its mass properties.
    Body,
    /// What leads from one joint of a body to another.
    Link,
    /// A body, by the visual geometry of a file.
    Visual,
    /// A joint.
    Joint,
    /// A surface that touches others.
    Surface,
    /// A spring or a dashpot.
    Element,
    /// An input.
    Input,
    /// Gravity.
    Gravity,
}

/// Forms of pieces; the numbers of each begin with a place.
#[derive(Clone, Debug, PartialEq)]
pub enum PieceKind {
    /// Axis, length.
    Rod,
    /// Axis, radius.
    Ring,
    /// Axis, radius.
    Disk,
    /// Axis, radius, height.
    Cylinder,
    /// Axis, inner and outer radius, height.
    Tube,
    /// Axis, radius, height, about the centre of mass.
    Cone,
    /// Axis, radius, distance of the centres of its balls.
    Capsule,
    /// Radius.
    Sphere,
    /// Axes, edges.
    Cuboid,
    /// Axes, half axes.
    Ellipsoid,
    /// Mass, and inertia about the place: xx, yy, zz, xy, xz, yz.
    Inertia,
    /// Normal.
    Plane,
    /// Axis, half angle, from the apex.
    Funnel,
    /// Axis, radius; as long as one likes.
    Pipe,
    /// Axis, radius of the centre line, radius of the section.
    Torus,
    /// Radius; seen from inside.
    Bowl,
    /// Nothing more.
    Point,
    /// The other end.
    Bar,
    /// Axis.
    Hinge,
    /// Axis.
    Slide,
    /// Nothing more.
    Ball,
    /// The other end.
    Coil,
    /// Axis.
    Spiral,
    /// The other end.
    Damper,
    /// Axis.
    Brake,
    /// Direction; the number of the input.
    Force(usize),
    /// Direction; the number of the input.
    Torque(usize),
    /// Acceleration; at the origin.
    Gravity,
    /// Axes; the number of its height over x and y.
    Terrain(usize),
    /// Axes, scales; path of the file.
    Mesh(String),
}

/// The entries of vectors one after the other.
pub fn entries<'g>(vectors: &[Vec3<'g>]) -> Vec<Expr<'g>> {
    vectors.iter().flat_map(|v| v.0).collect()
}

/// The entries of a matrix row by row.
pub fn rows<'g>(m: &Mat3<'g>) -> Vec<Expr<'g>> {
    m.0.iter().flatten().copied().collect()
}
