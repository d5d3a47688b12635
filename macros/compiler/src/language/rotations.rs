//! Rotations: `z(angle)`, `eigenaxis(direction, angle)`, and axes determined by a vector or a curve.

use super::{Argument, ArgumentKind};

/// Row of the table of rotations.
#[derive(Debug)]
pub struct RotationRow {
    /// Name of the rotation.
    pub name: &'static str,
    /// Names of the rotation in other tools.
    pub synonyms: &'static str,
    /// Arguments of the rotation function.
    pub arguments: &'static [Argument],
    /// True for axes that a vector or a curve determines; such axes come first in a `Frame`.
    pub natural: bool,
}

const fn rotation_row(
    name: &'static str,
    synonyms: &'static str,
    arguments: &'static [Argument],
) -> RotationRow {
    RotationRow { name, synonyms, arguments, natural: false }
}

const fn natural_axes_row(name: &'static str, arguments: &'static [Argument]) -> RotationRow {
    RotationRow { name, synonyms: "", arguments, natural: true }
}

const ANGLE: Argument = Argument::new("angle", ArgumentKind::Angle);
const VECTOR: Argument = Argument::new("vector", ArgumentKind::Vector);

const fn number_argument(name: &'static str) -> Argument {
    Argument::new(name, ArgumentKind::Number)
}

table! {
    /// Rotation function of the language.
    Rotation: RotationRow {
        /// Rotation about the x axis.
        X = rotation_row("x", "rx rotx rotatex xrot", &[ANGLE]);
        /// Rotation about the y axis.
        Y = rotation_row("y", "ry roty rotatey yrot", &[ANGLE]);
        /// Rotation about the z axis.
        Z = rotation_row("z", "rz rotz rotatez zrot", &[ANGLE]);
        /// Rotation about a direction.
        Eigenaxis = rotation_row("eigenaxis", "axisangle angleaxis about axis",
            &[Argument::new("direction", ArgumentKind::Direction), ANGLE]);
        /// Rotation by a unit quaternion.
        Quaternion = rotation_row("quaternion", "quat q",
            &[number_argument("x"), number_argument("y"), number_argument("z"), number_argument("w")]);
        /// Axes of cylindrical coordinates of a vector.
        Cylindrical = natural_axes_row("cylindrical", &[VECTOR]);
        /// Axes of spherical coordinates of a vector.
        Spherical = natural_axes_row("spherical", &[VECTOR]);
        /// Tangent, normal and binormal of a curve (Frenet and Serret).
        Frenet = natural_axes_row("frenet",
            &[Argument::length_argument("curve"), Argument::new("coordinate", ArgumentKind::Coordinate)]);
    }
}

impl Rotation {
    /// Returns the index of the coordinate axis of the rotation.
    pub fn index_of_axis(self) -> Option<usize> {
        [Rotation::X, Rotation::Y, Rotation::Z].iter().position(|about| *about == self)
    }
}
