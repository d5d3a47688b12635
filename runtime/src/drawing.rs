//! What a mechanism with the word `drawing` looks like, as data: pieces fixed in its frames, for programs that draw it. The crate
//! `linkwork-view` makes pages of it.

use crate::Frames;

/// A part of the drawing of a mechanism. Its numbers are those of [`Drawn::drawing_numbers`] from `first` on, as many as its
/// [`Kind`] says, in m and rad, in the axes of its frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Name of what it shows: a body, a joint, a contact, a force element, an input.
    pub name: &'static str,
    /// What of the declaration it is.
    pub role: Role,
    /// What it looks like.
    pub kind: Kind,
    /// The frames that its first vector and, if it has one in a frame of its own, its second one are fixed in, by number; the
    /// ground if none.
    pub frames: [Option<usize>; 2],
    /// Where its numbers begin.
    pub first: usize,
}

/// What of a declaration a piece shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A body, by its mass properties: the solids of its inertia, or mass and moments that determine an ellipsoid. A body that a file
    /// draws by meshes has these pieces as well, for programs that cannot read them.
    Body,
    /// Bars from the joint that holds a body to its other joints and its centre of mass, for the same bodies.
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
    /// Uniform gravity.
    Gravity,
}

/// The form of a piece. Its numbers are a place first; then what stands here, vectors with three numbers, axes as a rotation
/// matrix row by row, lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Axis, length; about its centre, as all solids.
    Rod,
    /// Axis, radius.
    Ring,
    /// Axis, radius.
    Disk,
    /// Axis, radius, height.
    Cylinder,
    /// Axis, inner radius, outer radius, height.
    Tube,
    /// Axis, radius, height; about its centre of mass, a quarter of the height above the base.
    Cone,
    /// Axis, radius, distance of the centres of its balls.
    Capsule,
    /// Radius.
    Sphere,
    /// Axes, edges.
    Cuboid,
    /// Axes, half axes.
    Ellipsoid,
    /// Mass, kg, and inertia about the place, kg·m²: xx, yy, zz, xy, xz, yz.
    Inertia,
    /// Normal.
    Plane,
    /// Axis, half angle, rad; a cone of any length from its apex.
    Funnel,
    /// Axis, radius; of any length.
    Pipe,
    /// Axis, radius of the centre line, radius of the section.
    Torus,
    /// Radius; a ball seen from inside.
    Bowl,
    /// Nothing more.
    Point,
    /// The other end, in the second frame.
    Bar,
    /// Axis.
    Hinge,
    /// Axis.
    Slide,
    /// Nothing more: a joint of all rotations.
    Ball,
    /// The other end, in the second frame: a spring that spans a length.
    Coil,
    /// Axis: a spring that turns.
    Spiral,
    /// The other end, in the second frame: a dashpot that spans a length.
    Damper,
    /// Axis: a dashpot that turns.
    Brake,
    /// Direction in the second frame; number of the input.
    Force(usize),
    /// Direction in the second frame; number of the input.
    Torque(usize),
    /// Acceleration, m/s², at the ground's origin.
    Gravity,
    /// Axes; ground whose height along the third of them is that number of [`Drawn::drawing_heights`] at the place along the others.
    Terrain(usize),
    /// Axes, scales along them; path of the file of triangles, as the robot's file writes it.
    Mesh(&'static str),
}

impl Kind {
    /// How many numbers it has.
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

/// A mechanism with the word `drawing`: what is declared, as pieces that move with its frames.
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
    message = "`{Self}` does not ask for `drawing`",
    label = "this needs the word `drawing`",
    note = "add the word to the attribute: `#[mechanism(…, drawing)]`"
)]
pub trait Drawn<const NQ: usize, const NV: usize>: Frames<NQ, NV> {
    /// The pieces.
    const DRAWING: &'static [Piece];

    /// Their numbers, for the parameters as they are.
    fn drawing_numbers(&self) -> impl AsRef<[Self::Scalar]>;

    /// The heights of the pieces [`Kind::Terrain`] at a place along the first two of the axes of each, m, by their numbers; of a
    /// table outside of its grid what the table says there.
    fn drawing_heights(&self, _place: &[Self::Scalar; 2]) -> impl AsRef<[Self::Scalar]> {
        let none: [Self::Scalar; 0] = [];
        none
    }
}
