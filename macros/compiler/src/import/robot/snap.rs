//! Rounding of inexact values of a file: right angles written with five digits, and axes that deviate by an
//! exporter's rounding. Values are rounded only if the user requests it, and each is reported, because
//! rounding changes the robot.

use super::assemble::unit_vector;
use super::joint::FileJoint;
use std::f64::consts::FRAC_PI_2;

/// Rounds the frame and the axis of a joint. Angles within `tolerance` (rad) of a multiple of a right angle
/// are rounded to it. Positions (m) and components of the unit axis within `tolerance` of zero become zero.
/// Returns one line per changed value, with the value before and after.
pub(in crate::import) fn snap_joint_frame(joint: &mut FileJoint, tolerance: f64) -> Vec<String> {
    let mut found = Vec::new();
    let mut record_snapped_value = |entry: &str, from: f64, to: f64| {
        if from != to {
            found.push(format!("`{}`: {entry} {from:?} → {to:?}", joint.name.text));
        }
    };
    for (angle, entry) in joint.origin.rpy.value.iter_mut().zip(["roll", "pitch", "yaw"]) {
        let right = (*angle / FRAC_PI_2).round() * FRAC_PI_2;
        if (*angle - right).abs() <= tolerance {
            record_snapped_value(entry, *angle, right);
            *angle = right;
        }
    }
    for (x, entry) in joint.origin.xyz.value.iter_mut().zip(["x", "y", "z"]) {
        if x.abs() <= tolerance {
            record_snapped_value(entry, *x, 0.0);
            *x = 0.0;
        }
    }
    if joint.has_axis() {
        let of_unit = unit_vector(joint.axis.value).into_iter().zip(["axis x", "axis y", "axis z"]);
        for (c, (part, entry)) in joint.axis.value.iter_mut().zip(of_unit) {
            if part.abs() <= tolerance {
                record_snapped_value(entry, *c, 0.0);
                *c = 0.0;
            }
        }
    }
    found
}
