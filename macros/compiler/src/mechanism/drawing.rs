//! Drawing of a mechanism: solids, surfaces, joints and force elements, each fixed in named frames.

use crate::expr::{Expr, Mat3, Vec3};

/// Piece of the drawing.
#[derive(Clone, Debug)]
pub struct Piece<'g> {
    /// Name of the declared object that it shows.
    pub name: String,
    /// Kind of declared object that it shows.
    pub role: Role,
    /// Geometric form.
    pub kind: PieceKind,
    /// Indices of the frames in which its first and its second vector are fixed; `None` for the ground.
    pub frames: [Option<usize>; 2],
    /// Geometric values in the axes of these frames: expressions of the parameters only.
    pub numbers: Vec<Expr<'g>>,
}

/// Kind of declared object that a piece shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A body, drawn from its mass properties.
    Body,
    /// Connection from one joint of a body to another.
    Link,
    /// A body, drawn from the visual geometry of a file.
    Visual,
    /// A joint.
    Joint,
    /// A contact surface.
    Surface,
    /// A spring or a dashpot.
    Element,
    /// An input.
    Input,
    /// Gravity.
    Gravity,
}

/// Geometric forms of pieces. The values of each form begin with a position, then follow those listed for it.
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
    /// Axis, radius; unbounded length.
    Pipe,
    /// Axis, radius of the centre line, radius of the section.
    Torus,
    /// Radius; seen from inside.
    Bowl,
    /// No further values.
    Point,
    /// Other end.
    Bar,
    /// Axis.
    Hinge,
    /// Axis.
    Slide,
    /// No further values.
    Ball,
    /// Other end.
    Coil,
    /// Axis.
    Spiral,
    /// Other end.
    Damper,
    /// Axis.
    Brake,
    /// Direction. The field is the index of the input.
    Force(usize),
    /// Direction. The field is the index of the input.
    Torque(usize),
    /// Acceleration; drawn at the origin.
    Gravity,
    /// Axes. The field is the index of the terrain's height as a function of x and y.
    Terrain(usize),
    /// Axes, scales. The field is the path of the file.
    Mesh(String),
}

/// Returns the entries of vectors one after the other.
pub fn entries<'g>(vectors: &[Vec3<'g>]) -> Vec<Expr<'g>> {
    vectors.iter().flat_map(|v| v.0).collect()
}

/// Returns the entries of a matrix row by row.
pub fn rows<'g>(m: &Mat3<'g>) -> Vec<Expr<'g>> {
    m.0.iter().flatten().copied().collect()
}
