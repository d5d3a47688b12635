//! Pose of a frame: a position and roll, pitch and yaw.

use crate::diag::Place;
use crate::import::imported::Located;
use crate::import::pose::{NumericPose, axis_rotation, matrix_product, roll_pitch_yaw};
use crate::syntax::Expr;

/// Pose of a frame as a robot file specifies it: position and rotation.
pub(in crate::import) struct FileOrigin {
    /// Position of the frame's origin relative to its reference frame, m.
    pub(in crate::import) xyz: Located<[f64; 3]>,
    /// Roll, pitch and yaw, rad: rotations about the fixed x, y and z axes, in this order.
    pub(in crate::import) rpy: Located<[f64; 3]>,
}

impl FileOrigin {
    /// Returns the position of the frame, or `None` if it is zero.
    pub(in crate::import) fn nonzero_position(&self) -> Option<Expr> {
        (self.xyz.value != [0.0; 3]).then(|| Expr::vector_at(self.xyz.value, &self.xyz.place))
    }

    /// Returns the nonzero rotations about successive (moving) axes. Rotations about fixed axes equal
    /// rotations about moving axes in the opposite order: `R = R_z(yaw) R_y(pitch) R_x(roll)`.
    pub(in crate::import) fn nonzero_rotations(&self) -> Vec<Expr> {
        let [roll, pitch, yaw] = self.rpy.value;
        let turns = [("z", yaw), ("y", pitch), ("x", roll)].into_iter().filter(|(_, angle)| *angle != 0.0);
        turns.map(|(axis, angle)| rotation_expression(axis, angle, self)).collect()
    }

    /// Returns the pose as position and axes, exact at multiples of a right angle.
    pub(in crate::import) fn pose(&self) -> NumericPose {
        let [roll, pitch, yaw] = self.rpy.value;
        let tilted =
            matrix_product(&axis_rotation([0.0, 1.0, 0.0], pitch), &axis_rotation([1.0, 0.0, 0.0], roll));
        NumericPose {
            at: self.xyz.value,
            axes: matrix_product(&axis_rotation([0.0, 0.0, 1.0], yaw), &tilted),
        }
    }

    /// Rotates a vector from the axes of this frame to those of its reference frame.
    pub(in crate::import) fn rotate_vector(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [(sr, cr), (sp, cp), (sy, cy)] = self.rpy.value.map(libm::sincos);
        let (y, z) = (cr * y - sr * z, sr * y + cr * z);
        let (x, z) = (cp * x + sp * z, cp * z - sp * x);
        [cy * x - sy * y, sy * x + cy * y, z]
    }
}

/// Converts a pose to a [`FileOrigin`].
pub(in crate::import) fn origin_from_pose(pose: &NumericPose, place: &Place) -> FileOrigin {
    let value_with_source_place = |value| Located { value, place: place.clone() };
    FileOrigin {
        xyz: value_with_source_place(pose.at.map(|x| x + 0.0)),
        rpy: value_with_source_place(roll_pitch_yaw(&pose.axes)),
    }
}

fn rotation_expression(axis: &str, angle: f64, origin: &FileOrigin) -> Expr {
    let place = &origin.rpy.place;
    Expr::function_call_expression(axis, vec![Expr::number_at(angle, place)], place)
}
