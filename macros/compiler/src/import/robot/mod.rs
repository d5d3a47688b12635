//! Conversion of a robot file, independent of its format, to bodies and joints in coordinate order.
//!
//! The importers read a file into a [`Robot`]. This module checks names and topology, resolves locks and
//! `mimic`, and determines the order of coordinates. It knows no XML.

mod assemble;
mod closing;
mod collision;
mod couplings;
mod drives;
mod figures;
mod joint;
mod limit;
mod motion;
mod names;
mod origin;
mod parts;
mod snap;
mod tree;
mod visual;

pub(super) use assemble::{assemble_mechanism, plain_joint};
pub(super) use closing::{refuse_declared_loops, remove_loop_closing_joints, separate_loop_closing_joints};
pub(super) use collision::FileCollisionShape;
pub(super) use figures::{identifier_of_names, make_value_fields};
pub(super) use joint::{FileJoint, has_axis, has_single_coordinate};
pub(super) use limit::{FileLimits, IGNORE_LIMITS};
pub(super) use motion::resolve_motions;
pub(super) use names::{
    check_locked_names, check_unique_names, declare_world_link, rename_link_named_ground,
    report_repeated_names, report_unknown_links, report_wrong_joint_ends, unused_name,
};
pub(super) use origin::{FileOrigin, origin_from_pose};
pub(super) use parts::{MAX_ELEMENTS, Robot, massless_link};
pub(super) use snap::snap_joint_frame;
pub(super) use tree::{JointOrder, order_joints_along_tree};
pub(super) use visual::FileVisual;
