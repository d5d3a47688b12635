//! Poses of bodies in the configuration in which the springs of all joints are relaxed. By default the
//! springs of tendons are relaxed in it, too.

use super::reader::MjcfReader;
use super::spatial::Poses;
use crate::import::pose::{FilePose, axis_rotation, matrix_product, vector_times_scalar};
use crate::import::robot::FileOrigin;
use crate::syntax::{GROUND, JointKind};

impl MjcfReader<'_> {
    /// Returns the pose of each body relative to the world with all joint springs relaxed. Ball and free
    /// joints are as in the configuration of the file.
    pub(super) fn poses_with_relaxed_springs(&self) -> Poses {
        let mut poses = Poses::from([(GROUND.to_string(), FilePose::ZERO)]);
        // The joint of the parent precedes each joint.
        for joint in &self.robot.joints {
            let rest = self.rests.get(&joint.name.text).copied().unwrap_or(0.0);
            let axis = joint.axis.value;
            let motion = match joint.kind.rotates_about_one_axis() {
                Some(true) => FilePose { axes: axis_rotation(axis, rest), ..FilePose::ZERO },
                Some(false) => FilePose { at: vector_times_scalar(axis, rest), ..FilePose::ZERO },
                None => FilePose::ZERO,
            };
            let parent = poses.get(&joint.parent.text).copied().unwrap_or(FilePose::ZERO);
            let back = FilePose { at: vector_times_scalar(joint.anchor, -1.0), ..FilePose::ZERO };
            let pose = if joint.kind == JointKind::Free {
                self.poses.get(&joint.child.text).copied().unwrap_or(FilePose::ZERO)
            } else {
                parent
                    .compose_with(&pose_from_file_origin(&joint.origin))
                    .compose_with(&motion)
                    .compose_with(&back)
            };
            poses.insert(joint.child.text.clone(), pose);
        }
        poses
    }
}

fn pose_from_file_origin(origin: &FileOrigin) -> FilePose {
    let [roll, pitch, yaw] = origin.rpy.value;
    let rotation_about_axis = |axis, angle| axis_rotation(axis, angle);
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let axes = matrix_product(
        &matrix_product(&rotation_about_axis(z, yaw), &rotation_about_axis(y, pitch)),
        &rotation_about_axis(x, roll),
    );
    FilePose { at: origin.xyz.value, axes }
}
