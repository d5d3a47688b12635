//! Poses of bodies in the configuration in which the springs of all joints are relaxed. By default the
//! springs of tendons are relaxed in it, too.

use super::reader::MjcfReader;
use super::spatial::BodyPoses;
use crate::import::pose::{NumericPose, axis_rotation, matrix_product, vector_times_scalar};
use crate::import::robot::FileOrigin;
use crate::syntax::{GROUND, JointKind};

impl MjcfReader<'_> {
    /// Returns the pose of each body relative to the world with all joint springs relaxed. Ball and free
    /// joints are as in the configuration of the file.
    pub(super) fn poses_with_relaxed_springs(&self) -> BodyPoses {
        let mut poses = BodyPoses::from([(GROUND.to_string(), NumericPose::ZERO)]);
        // The joint of the parent precedes each joint.
        for joint in &self.robot.joints {
            let rest = self.rests.get(&joint.name.text).copied().unwrap_or(0.0);
            let axis = joint.axis.value;
            let motion = match joint.kind.single_axis_joint_is_rotational() {
                Some(true) => NumericPose { axes: axis_rotation(axis, rest), ..NumericPose::ZERO },
                Some(false) => NumericPose { at: vector_times_scalar(axis, rest), ..NumericPose::ZERO },
                None => NumericPose::ZERO,
            };
            let parent = poses.get(&joint.parent.text).copied().unwrap_or(NumericPose::ZERO);
            let back = NumericPose { at: vector_times_scalar(joint.anchor, -1.0), ..NumericPose::ZERO };
            let pose = if joint.kind == JointKind::Free {
                self.poses.get(&joint.child.text).copied().unwrap_or(NumericPose::ZERO)
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

fn pose_from_file_origin(origin: &FileOrigin) -> NumericPose {
    let [roll, pitch, yaw] = origin.rpy.value;
    let rotation_about_axis = |axis, angle| axis_rotation(axis, angle);
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let axes = matrix_product(
        &matrix_product(&rotation_about_axis(z, yaw), &rotation_about_axis(y, pitch)),
        &rotation_about_axis(x, roll),
    );
    NumericPose { at: origin.xyz.value, axes }
}
