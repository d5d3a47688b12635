//! A joint as its file describes it, before locks and `mimic` are resolved.

use super::limit::FileLimits;
use super::origin::Origin;
use crate::import::imported::Placed;
use crate::syntax::{Expr, JointKind, Mimic, Name};

/// Joint as the robot file describes it.
pub(in crate::import) struct FileJoint {
    /// Name of the joint in the robot file.
    pub(in crate::import) name: Name,
    /// Type of the joint in the language.
    pub(in crate::import) kind: JointKind,
    /// Name of the joint type in the file format.
    pub(in crate::import) word: &'static str,
    /// Name of the parent link.
    pub(in crate::import) parent: Name,
    /// Name of the child link.
    pub(in crate::import) child: Name,
    /// Frame of the joint relative to the parent. At coordinate zero, the child's axes coincide with the
    /// joint's.
    pub(in crate::import) origin: Origin,
    /// Position of the joint relative to the child's origin, in the child's axes.
    pub(in crate::import) anchor: [f64; 3],
    /// Joint axis, nonzero but not normalised; unused by welds and free joints.
    pub(in crate::import) axis: Placed<[f64; 3]>,
    /// Leader and coefficients of a joint that follows another joint; `None` if the user's options ignore
    /// `mimic`.
    pub(in crate::import) mimic: Option<Mimic>,
    /// Coordinate at which the file locks the joint.
    pub(in crate::import) held: Option<f64>,
    /// Lead of a screw joint: advance per revolution, m.
    pub(in crate::import) lead: Option<Expr>,
    /// Limits of the joint's coordinate, velocity and force.
    pub(in crate::import) limits: FileLimits,
    /// Coefficient of the joint's viscous damping; `None` for no damping.
    pub(in crate::import) damping: Option<Expr>,
    /// Coulomb friction force or torque of the joint; `None` for no friction.
    pub(in crate::import) friction: Option<Expr>,
}

impl FileJoint {
    /// Returns whether the joint has exactly one coordinate, to which limits and locks refer.
    pub(in crate::import) fn has_coordinate(&self) -> bool {
        has_coordinate(self.kind)
    }

    /// Returns whether the joint moves about or along an axis.
    pub(in crate::import) fn has_axis(&self) -> bool {
        has_axis(self.kind)
    }
}

/// Returns whether joints of this type have exactly one coordinate, to which limits and locks refer.
pub(in crate::import) fn has_coordinate(kind: JointKind) -> bool {
    kind.rotates_about_one_axis().is_some()
}

/// Returns true if joints of this type move about or along an axis.
pub(in crate::import) fn has_axis(kind: JointKind) -> bool {
    !matches!(kind, JointKind::Weld | JointKind::Free | JointKind::Ball)
}
