//! Numbers that were meant to be round: right angles written with five digits, axes that lean by what an
//! exporter lost. They are rounded if the user asks for it, and each is reported, since this changes the
//! robot.

use super::assemble::unit;
use super::joint::FileJoint;
use std::f64::consts::FRAC_PI_2;

/// Rounds the frame and the axis of a joint: angles that lie within `tolerance` (rad) of a multiple of a
/// right one, positions within it (m) of zero, components of the unit axis within it of zero. Returns what it
/// was, by entry.
pub(in crate::import) fn snap(joint: &mut FileJoint, tolerance: f64) -> Vec<String> {
    let mut found = Vec::new();
    let mut report = |entry: &str, from: f64, to: f64| {
        if from != to {
            found.push(format!("`{}`: {entry} {from:?} → {to:?}", joint.name.text));
        }
    };
    for (angle, entry) in joint.origin.rpy.value.iter_mut().zip(["roll", "pitch", "yaw"]) {
        let right = (*angle / FRAC_PI_2).round() * FRAC_PI_2;
        if (*angle - right).abs() <= tolerance {
            report(entry, *angle, right);
            *angle = right;
        }
    }
    for (x, entry) in joint.origin.xyz.value.iter_mut().zip(["x", "y", "z"]) {
        if x.abs() <= tolerance {
            report(entry, *x, 0.0);
            *x = 0.0;
        }
    }
    if joint.has_axis() {
        let of_unit = unit(joint.axis.value).into_iter().zip(["axis x", "axis y", "axis z"]);
        for (c, (part, entry)) in joint.axis.value.iter_mut().zip(of_unit) {
            if part.abs() <= tolerance {
                report(entry, *c, 0.0);
                *c = 0.0;
            }
        }
    }
    found
}
