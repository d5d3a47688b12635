//! What a file says of one joint, before locks and followers are looked at.

use super::limit::FileLimits;
use super::origin::Origin;
use crate::import::imported::Placed;
use crate::syntax::{Expr, JointKind, Mimic, Name};

/// A joint as the file gives it.
pub(in crate::import) struct FileJoint {
    /// Its name.
    pub(in crate::import) name: Name,
    /// Which joint.
    pub(in crate::import) kind: JointKind,
    /// The format's word for it.
    pub(in crate::import) word: &'static str,
    /// The link that carries it.
    pub(in crate::import) parent: Name,
    /// The link that it carries.
    pub(in crate::import) child: Name,
    /// Its frame on the parent. While the coordinate is zero, the child's axes are its own.
    pub(in crate::import) origin: Origin,
    /// Its place on the child, in the child's axes.
    pub(in crate::import) anchor: [f64; 3],
    /// Its axis, of any length but zero; unused by welds and free joints.
    pub(in crate::import) axis: Placed<[f64; 3]>,
    /// Whom it follows, if the user wants to know.
    pub(in crate::import) mimic: Option<Mimic>,
    /// The coordinate at which it is held.
    pub(in crate::import) held: Option<f64>,
    /// What a screw advances in a turn.
    pub(in crate::import) lead: Option<Expr>,
    /// Its limits.
    pub(in crate::import) limits: FileLimits,
    /// Viscous damping, not zero.
    pub(in crate::import) damping: Option<Expr>,
    /// Coulomb friction, not zero.
    pub(in crate::import) friction: Option<Expr>,
}

impl FileJoint {
    /// True if one number says where the joint stands.
    pub(in crate::import) fn has_coordinate(&self) -> bool {
        has_coordinate(self.kind)
    }

    /// True if it moves about or along its axis.
    pub(in crate::import) fn has_axis(&self) -> bool {
        has_axis(self.kind)
    }
}

/// True if one number says where joints of the kind stand.
pub(in crate::import) fn has_coordinate(kind: JointKind) -> bool {
    matches!(kind, JointKind::Pin | JointKind::Sleeve)
}

/// True if joints of the kind move about or along an axis.
pub(in crate::import) fn has_axis(kind: JointKind) -> bool {
    !matches!(kind, JointKind::Weld | JointKind::Free | JointKind::Ball)
}
