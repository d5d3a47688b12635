//! Arguments of solids, surfaces and rotations.

use super::dimension::{Dimension, INERTIA, LENGTH, MASS, PLAIN};

/// Argument of a solid, a surface or a rotation.
#[derive(Debug)]
pub struct Argument {
    /// Name of the argument, as messages print it.
    pub name: &'static str,
    /// Quantity that the argument expects.
    pub kind: ArgumentKind,
}

/// Quantity that an argument of a solid, surface or rotation expects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArgumentKind {
    /// The argument is a mass, kg.
    Mass,
    /// The argument is a length, m.
    Length,
    /// The argument is a moment of inertia, kg·m².
    Inertia,
    /// The argument is an angle, rad.
    Angle,
    /// The argument is the half angle of a cone, rad.
    HalfAngle,
    /// The argument is a dimensionless number.
    Number,
    /// The argument is a direction (unit vector).
    Direction,
    /// A vector or a curve that is not a length.
    Vector,
    /// The argument is the name of a coordinate.
    Coordinate,
    /// A height, m, as an expression of the horizontal coordinates `u`, `w`.
    Height,
    /// A list of points in body axes, m, or the path of a mesh.
    Points,
}

impl Argument {
    /// The argument `mass` of solids.
    pub const MASS: Argument = Argument { name: "mass", kind: ArgumentKind::Mass };
    /// The argument `axis`: the axis of a body of revolution.
    pub const AXIS: Argument = Argument { name: "axis", kind: ArgumentKind::Direction };

    /// Returns an argument with this name that is a length.
    pub const fn length_argument(name: &'static str) -> Argument {
        Argument { name, kind: ArgumentKind::Length }
    }

    /// Returns an argument of this name and kind.
    pub const fn new(name: &'static str, kind: ArgumentKind) -> Argument {
        Argument { name, kind }
    }

    /// Returns the names of arguments as text, separated by commas.
    pub fn list_argument_names(arguments: &[Argument]) -> String {
        arguments.iter().map(|argument| argument.name).collect::<Vec<_>>().join(", ")
    }
}

impl ArgumentKind {
    /// True for a vector in the axes of a body.
    pub fn is_direction(self) -> bool {
        self == ArgumentKind::Direction
    }

    /// Returns the dimension and the text of its unit; `None` if the dimension is unknown.
    pub fn dimension_and_unit(self) -> Option<(Dimension, &'static str)> {
        match self {
            ArgumentKind::Mass => Some((MASS, "kg")),
            ArgumentKind::Length | ArgumentKind::Height => Some((LENGTH, "m")),
            ArgumentKind::Inertia => Some((INERTIA, "kg·m²")),
            ArgumentKind::Angle | ArgumentKind::HalfAngle => Some((PLAIN, "rad")),
            ArgumentKind::Number | ArgumentKind::Direction => Some((PLAIN, "1")),
            ArgumentKind::Vector | ArgumentKind::Coordinate | ArgumentKind::Points => None,
        }
    }
}
