//! A joint as its file describes it, before locks and `mimic` are resolved.

use super::limit::FileLimits;
use super::origin::FileOrigin;
use crate::import::imported::Located;
use crate::syntax::{Expr, JointKind, MimicRelation, Name};

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
    pub(in crate::import) origin: FileOrigin,
    /// Position of the joint relative to the child's origin, in the child's axes.
    pub(in crate::import) anchor: [f64; 3],
    /// Joint axis, nonzero but not normalised; unused by welds and free joints.
    pub(in crate::import) axis: Located<[f64; 3]>,
    /// Leader and coefficients of a joint that follows another joint; `None` if the user's options ignore
    /// `mimic`.
    pub(in crate::import) mimic: Option<MimicRelation>,
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
    /// Coordinates in the pose of the file, in the order of `q`; empty if they are those of the neutral
    /// configuration.
    pub(in crate::import) initial: Vec<f64>,
}

impl FileJoint {
    /// Returns the joint of a parent and a child link, without limits, passive forces and relations to other
    /// joints. The child's origin is on the joint.
    pub(in crate::import) fn joint_between_links(
        name: Name,
        (kind, word): (JointKind, &'static str),
        [parent, child]: [Name; 2],
        origin: FileOrigin,
        axis: Located<[f64; 3]>,
    ) -> FileJoint {
        FileJoint {
            name,
            kind,
            word,
            parent,
            child,
            origin,
            anchor: [0.0; 3],
            axis,
            mimic: None,
            held: None,
            lead: None,
            limits: FileLimits::default(),
            damping: None,
            friction: None,
            initial: Vec::new(),
        }
    }

    /// Returns the joint that fixes one link to another, with the name of this joint type in the file format.
    pub(in crate::import) fn weld(
        name: Name,
        word: &'static str,
        links: [Name; 2],
        origin: FileOrigin,
    ) -> FileJoint {
        let axis = Located { value: [0.0, 0.0, 1.0], place: name.place.clone() };
        FileJoint::joint_between_links(name, (JointKind::Weld, word), links, origin, axis)
    }

    /// Returns whether the joint has exactly one coordinate, to which limits and locks refer.
    pub(in crate::import) fn has_single_coordinate(&self) -> bool {
        has_single_coordinate(self.kind)
    }

    /// Returns whether the joint moves about or along an axis.
    pub(in crate::import) fn has_axis(&self) -> bool {
        has_axis(self.kind)
    }
}

/// Returns whether joints of this type have exactly one coordinate, to which limits and locks refer.
pub(in crate::import) fn has_single_coordinate(kind: JointKind) -> bool {
    kind.single_axis_joint_is_rotational().is_some()
}

/// Returns true if joints of this type move about or along an axis.
pub(in crate::import) fn has_axis(kind: JointKind) -> bool {
    !matches!(kind, JointKind::Weld | JointKind::Free | JointKind::Ball)
}
