//! Drawing of a mechanism with the option `drawing`, as data: pieces fixed in its frames, for programs that
//! draw it. The crate `linkwork-view` converts it to web pages.

use crate::Frames;

/// Element of the drawing of a mechanism. Its numbers start at index `first` of [`Drawn::drawing_numbers`],
/// and its [`Kind`] defines their count. They are in m and rad, in the axes of the piece's frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Name of the drawn body, joint, contact, force element or input.
    pub name: &'static str,
    /// Part of the declaration that the piece shows.
    pub role: Role,
    /// Shape of the piece, which also defines the count of its dimensions.
    pub kind: Kind,
    /// Indices of the frames in which the first vector and, if it has a frame of its own, the second vector
    /// are fixed; `None` is the ground.
    pub frames: [Option<usize>; 2],
    /// Index of the first number of the piece.
    pub first: usize,
}

/// Part of a declaration that a piece shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The piece shows a body by its mass properties: the solids of its inertia, or the mass and moments that
    /// determine an ellipsoid. A body that a file draws by meshes has these pieces as well, for programs that
    /// cannot read meshes.
    Body,
    /// The piece is a bar from the inboard joint of a body to its other joints or its centre of mass. The
    /// same bodies have pieces of the role [`Body`](Self::Body).
    Link,
    /// The piece shows a body by the visual geometry of a robot file.
    Visual,
    /// The piece shows a joint.
    Joint,
    /// The piece shows a contact surface.
    Surface,
    /// The piece shows a spring or a dashpot.
    Element,
    /// The piece shows the force or torque of an input.
    Input,
    /// The piece shows the vector of uniform gravity.
    Gravity,
}

/// Shape of a piece. Its numbers start with a position, followed by the numbers listed at each variant.
/// Vectors have three numbers; axes are a rotation matrix, row by row; lengths are in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Thin rod, with its centre at the position. Its numbers are axis and length.
    Rod,
    /// Thin ring. Its numbers are axis and radius.
    Ring,
    /// Thin disk. Its numbers are axis and radius.
    Disk,
    /// Solid cylinder. Its numbers are axis, radius and height.
    Cylinder,
    /// Hollow cylinder. Its numbers are axis, inner radius, outer radius and height.
    Tube,
    /// Solid cone, with its centre of mass, a quarter of the height above the base, at the position. Its
    /// numbers are axis, radius and height.
    Cone,
    /// Capsule. Its numbers are axis, radius, and distance between the centres of the end spheres.
    Capsule,
    /// Sphere. Its number is the radius.
    Sphere,
    /// Rectangular box. Its numbers are the axes and the edge lengths.
    Cuboid,
    /// Ellipsoid. Its numbers are the axes and the semi-axes.
    Ellipsoid,
    /// Body with given mass properties. Its numbers are the mass, kg, and the inertia about the position,
    /// kg·m²: xx, yy, zz, xy, xz, yz.
    Inertia,
    /// Unbounded plane. Its numbers are the normal.
    Plane,
    /// Funnel: surface of a cone of unbounded length from its apex. Its numbers are the axis and the half
    /// angle, rad.
    Funnel,
    /// Pipe: surface of a cylinder of unbounded length. Its numbers are axis and radius.
    Pipe,
    /// Torus. Its numbers are axis, radius of the centre line and radius of the cross section.
    Torus,
    /// Sphere that is seen from inside. Its number is the radius.
    Bowl,
    /// Point. It has no numbers other than its position.
    Point,
    /// Bar. Its numbers are the position of the other end, in the second frame.
    Bar,
    /// Revolute joint. Its numbers are the joint axis.
    Hinge,
    /// Prismatic joint. Its numbers are the joint axis.
    Slide,
    /// Ball joint. It has no numbers other than its position.
    Ball,
    /// Translational spring. Its numbers are the position of the other end, in the second frame.
    Coil,
    /// Torsional spring. Its numbers are the axis.
    Spiral,
    /// Translational dashpot. Its numbers are the position of the other end, in the second frame.
    Damper,
    /// Torsional dashpot. Its numbers are the axis.
    Brake,
    /// Force of the input with this index. Its numbers are the direction in the second frame.
    Force(usize),
    /// Torque of the input with this index. Its numbers are the direction in the second frame.
    Torque(usize),
    /// Gravity, drawn at the ground's origin. Its numbers are the acceleration, m/s².
    Gravity,
    /// Ground surface, as a height along the third axis that is a function of the coordinates along the first
    /// two. Its numbers are the axes; the heights are the entry of [`Drawn::drawing_heights`] with this
    /// index.
    Terrain(usize),
    /// Triangle mesh of the file with this path, as written in the robot file. Its numbers are the axes and
    /// the scale factors along them.
    Mesh(&'static str),
}

impl Kind {
    /// Returns the number of values that a piece of this shape has, including its position.
    pub const fn count(self) -> usize {
        match self {
            Kind::Point | Kind::Ball => 3,
            Kind::Sphere | Kind::Bowl => 4,
            Kind::Plane
            | Kind::Bar
            | Kind::Hinge
            | Kind::Slide
            | Kind::Coil
            | Kind::Spiral
            | Kind::Damper
            | Kind::Brake
            | Kind::Force(_)
            | Kind::Torque(_)
            | Kind::Gravity => 6,
            Kind::Rod | Kind::Ring | Kind::Disk | Kind::Funnel | Kind::Pipe => 7,
            Kind::Cylinder | Kind::Cone | Kind::Capsule | Kind::Torus => 8,
            Kind::Tube => 9,
            Kind::Inertia => 10,
            Kind::Terrain(_) => 12,
            Kind::Cuboid | Kind::Ellipsoid | Kind::Mesh(_) => 15,
        }
    }
}

/// Mechanism with the option `drawing`: its declarations as pieces that move with its frames.
///
/// ```
/// use linkwork::drawing::{Kind, Role};
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * y, drawing)]
/// struct Pendulum {
///     length: f64,
///     #[body(mass = 1, com = -length / 2 * y, inertia = rod(1, length, y))]
///     bob: Body,
///     #[joint(ground -> bob, about = z)]
///     hinge: Pin,
/// }
///
/// let pendulum = Pendulum { length: 0.8 };
/// let rod = Pendulum::DRAWING.iter().find(|piece| piece.role == Role::Body).unwrap();
/// assert_eq!((rod.name, rod.kind), ("bob", Kind::Rod));
/// // Centre, axis, length.
/// let numbers = pendulum.drawing_numbers();
/// assert_eq!(numbers[rod.first..rod.first + rod.kind.count()], [0.0, -0.4, 0.0, 0.0, 1.0, 0.0, 0.8]);
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is compiled without `drawing`",
    label = "this needs the option `drawing`",
    note = "add the option to the attribute: `#[mechanism(…, drawing)]`"
)]
pub trait Drawn<const NQ: usize, const NV: usize>: Frames<NQ, NV> {
    /// Pieces of the mechanism's drawing.
    const DRAWING: &'static [Piece];

    /// Returns the numbers of all pieces, for the current parameters.
    fn drawing_numbers(&self) -> impl AsRef<[Self::Scalar]>;

    /// Returns the heights, m, of the pieces [`Kind::Terrain`], ordered by their indices, at a position along
    /// the first two axes of each piece. Outside the grid of a table, the table's own extrapolation applies.
    fn drawing_heights(&self, _place: &[Self::Scalar; 2]) -> impl AsRef<[Self::Scalar]> {
        let none: [Self::Scalar; 0] = [];
        none
    }
}
