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

/// Quantity that an argument expects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArgumentKind {
    /// A mass, kg.
    Mass,
    /// A length, m.
    Length,
    /// A moment of inertia, kg·m².
    Inertia,
    /// An angle, rad.
    Angle,
    /// A half angle of a cone, rad.
    HalfAngle,
    /// A plain number.
    Number,
    /// A direction.
    Direction,
    /// A vector or a curve that is not a length.
    Vector,
    /// A coordinate, by its name.
    Coordinate,
    /// A height, m, as an expression of the horizontal coordinates `u`, `w`.
    Height,
    /// A list of points in body axes, m, or the path of a mesh.
    Points,
}

impl Argument {
    /// A mass.
    pub const MASS: Argument = Argument { name: "mass", kind: ArgumentKind::Mass };
    /// The axis of a body of revolution.
    pub const AXIS: Argument = Argument { name: "axis", kind: ArgumentKind::Direction };

    /// Returns a length of this name.
    pub const fn length(name: &'static str) -> Argument {
        Argument { name, kind: ArgumentKind::Length }
    }

    /// Returns an argument of this name and kind.
    pub const fn new(name: &'static str, kind: ArgumentKind) -> Argument {
        Argument { name, kind }
    }

    /// Returns the names of arguments, separated by commas.
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
