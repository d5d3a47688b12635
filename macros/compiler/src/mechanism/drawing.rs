//! Drawing of a mechanism: solids, surfaces, joints and force elements, each fixed in named frames.

use super::link::{LinkId, NamedFrame};
use super::pose::Pose;
use crate::expr::{Expr, Mat3, Vec3};

/// Piece of the drawing: a shape with its position, for one declared object.
#[derive(Clone, Debug)]
pub struct Piece<'g> {
    /// Name of the declared object that the piece shows.
    pub name: String,
    /// Kind of the declared object that the piece shows.
    pub role: ShownObjectKind,
    /// Geometric form of the piece.
    pub kind: PieceShape,
    /// Indices of the frames in which its first and its second vector are fixed; `None` for the ground.
    pub frames: [Option<usize>; 2],
    /// Geometric values in the axes of `frames`: expressions of the parameters only.
    pub numbers: Vec<Expr<'g>>,
}

/// Kind of declared object that a piece shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShownObjectKind {
    /// A body, drawn as a solid with its mass properties.
    Body,
    /// Connection from one joint of a body to another.
    Link,
    /// A body, drawn from the visual geometry of a file.
    Visual,
    /// A joint, drawn by its axes.
    Joint,
    /// A contact surface of a body.
    Surface,
    /// A force element between points, such as a spring or a dashpot.
    Element,
    /// An input force or torque.
    Input,
    /// Gravity, drawn as an arrow.
    Gravity,
}

/// Geometric forms of pieces. The values of a piece are its position, followed by the values that are listed
/// for its form.
#[derive(Clone, Debug, PartialEq)]
pub enum PieceShape {
    /// Straight rod, given by its axis and length.
    Rod,
    /// Ring or circle, given by axis and radius.
    Ring,
    /// Disk, given by axis and radius.
    Disk,
    /// Cylinder, given by axis, radius and height.
    Cylinder,
    /// Hollow cylinder, given by axis, inner and outer radius, and height.
    Tube,
    /// Cone about its centre of mass, given by axis, radius and height.
    Cone,
    /// Capsule, given by axis, radius and the distance between the centres of its hemispheres.
    Capsule,
    /// Sphere, given by its radius.
    Sphere,
    /// Cuboid, given by axes and edge lengths.
    Cuboid,
    /// Ellipsoid, given by axes and semi-axis lengths.
    Ellipsoid,
    /// Mass properties, given by mass and inertia about the position: xx, yy, zz, xy, xz, yz.
    Inertia,
    /// Plane, given by its normal.
    Plane,
    /// Conical surface from its apex, given by axis and half angle.
    Funnel,
    /// Cylindrical surface of unbounded length, given by axis and radius.
    Pipe,
    /// Torus, given by axis, radius of the centre line and radius of the section.
    Torus,
    /// Spherical surface seen from inside, given by its radius.
    Bowl,
    /// Point, given by its position only.
    Point,
    /// Straight bar, given by the position of its other end.
    Bar,
    /// Revolute joint, given by its axis.
    Hinge,
    /// Prismatic joint, given by its axis.
    Slide,
    /// Ball or universal joint, given by its position only.
    Ball,
    /// Helical spring, given by the position of its other end.
    Coil,
    /// Torsion spring, given by its axis.
    Spiral,
    /// Dashpot, given by the position of its other end.
    Damper,
    /// Rotary dashpot, given by its axis.
    Brake,
    /// Input force, given by its direction. The field is the index of the input.
    Force(usize),
    /// Input torque, given by its direction. The field is the index of the input.
    Torque(usize),
    /// Gravitational acceleration, drawn at the origin.
    Gravity,
    /// Terrain, given by its axes. The field is the index of its height function of x and y.
    Terrain(usize),
    /// Mesh, given by axes and scales. The field is the path of the file.
    Mesh(String),
}

/// A pose relative to a frame: the index of the frame (`None` for the ground), and the pose in it.
pub type PoseInFrame<'g> = (Option<usize>, Pose<'g>);

/// Returns a pose on a link, relative to a named frame of that link; `None` if the link has none.
pub fn pose_relative_to_named_frame<'g>(
    frames: &[NamedFrame<'g>],
    link: Option<LinkId>,
    pose: &Pose<'g>,
) -> Option<PoseInFrame<'g>> {
    if link.is_none() {
        return Some((None, pose.clone()));
    }
    let index = frames.iter().position(|frame| frame.link == link)?;
    Some((Some(index), frames[index].pose.inverse().compose_with(pose)))
}

/// Returns the entries of several vectors, concatenated.
pub fn entries_of_vectors<'g>(vectors: &[Vec3<'g>]) -> Vec<Expr<'g>> {
    vectors.iter().flat_map(|v| v.0).collect()
}

/// Returns the entries of a matrix row by row.
pub fn entries_by_row<'g>(m: &Mat3<'g>) -> Vec<Expr<'g>> {
    m.0.iter().flatten().copied().collect()
}
