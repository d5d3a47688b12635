//! Positions and orientations of MJCF elements.

use super::defaults::ElementWithDefaults;
use super::settings::MjcfSettings;
use crate::diag::Place;
use crate::import::context::Cx;
use crate::import::element::report_likely_degrees;
use crate::import::imported::Located;
use crate::import::pose::{
    IDENTITY, Matrix, NumericPose, axis_rotation, cross, dot, matrix_product, rotation_from_z,
    rotation_of_quaternion, vector_norm, vector_sum, vector_times_scalar,
};

/// Attributes that specify an orientation. An element may have at most one of them.
pub(super) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Returns the pose of an MJCF element relative to its parent.
pub(super) fn read_pose(
    element: &ElementWithDefaults<'_>,
    settings: &MjcfSettings,
    cx: &mut Cx<'_>,
) -> NumericPose {
    let at = element.read_exactly_n_numbers("pos", cx).map_or([0.0; 3], |at| at.value);
    NumericPose { at, axes: read_orientation(element, settings, cx) }
}

/// Returns the orientation of an MJCF element as a rotation matrix.
pub(super) fn read_orientation(
    element: &ElementWithDefaults<'_>,
    settings: &MjcfSettings,
    cx: &mut Cx<'_>,
) -> Matrix {
    let Some(node) = element.node_with_any_attribute(&ORIENTATIONS) else { return IDENTITY };
    let said: Vec<&str> = ORIENTATIONS.into_iter().filter(|name| node.has_attribute(*name)).collect();
    let [one] = said.as_slice() else {
        let message = format!("an orientation is given once, but here are `{}`", said.join("` and `"));
        cx.report_error(
            &element.place_of_attribute_value(said.first().copied().unwrap_or_default(), cx),
            message,
            |d| d,
        );
        return IDENTITY;
    };
    read_one_orientation(one, element, settings, cx).unwrap_or(IDENTITY)
}

fn read_one_orientation(
    which: &str,
    element: &ElementWithDefaults<'_>,
    settings: &MjcfSettings,
    cx: &mut Cx<'_>,
) -> Option<Matrix> {
    match which {
        "quat" => {
            let quat = element.read_exactly_n_numbers::<4>("quat", cx)?;
            let size = quat.value.iter().map(|x| x * x).sum::<f64>().sqrt();
            report_zero_length_vector(size, "a quaternion", &quat, cx)?;
            Some(rotation_of_quaternion(quat.value.map(|x| x / size)))
        }
        "axisangle" => {
            let found = element.read_exactly_n_numbers::<4>("axisangle", cx)?;
            let [x, y, z, angle] = found.value;
            let size = vector_norm([x, y, z]);
            report_zero_length_vector(size, "an axis", &found, cx)?;
            report_angles_likely_in_degrees(&[angle], &found.place, settings, cx);
            Some(axis_rotation(vector_times_scalar([x, y, z], 1.0 / size), settings.angle_in_radians(angle)))
        }
        "euler" => {
            let found = element.read_exactly_n_numbers::<3>("euler", cx)?;
            report_angles_likely_in_degrees(&found.value, &found.place, settings, cx);
            Some(settings.euler.iter().zip(found.value).fold(IDENTITY, |whole, (axis, angle)| {
                let unit = match axis.to_ascii_lowercase() {
                    'x' => [1.0, 0.0, 0.0],
                    'y' => [0.0, 1.0, 0.0],
                    _ => [0.0, 0.0, 1.0],
                };
                let turn = axis_rotation(unit, settings.angle_in_radians(angle));
                // Rotations about moving axes are multiplied from the right, those about
                // fixed axes from the left.
                if axis.is_ascii_lowercase() {
                    matrix_product(&whole, &turn)
                } else {
                    matrix_product(&turn, &whole)
                }
            }))
        }
        "xyaxes" => {
            let found = element.read_exactly_n_numbers::<6>("xyaxes", cx)?;
            let [a, b, c, d, e, f] = found.value;
            let size = vector_norm([a, b, c]);
            report_zero_length_vector(size, "the x axis", &found, cx)?;
            let x = vector_times_scalar([a, b, c], 1.0 / size);
            let y = vector_sum([d, e, f], vector_times_scalar(x, -dot(x, [d, e, f])));
            let size = vector_norm(y);
            report_zero_length_vector(size, "the y axis, orthogonalised against x,", &found, cx)?;
            let y = vector_times_scalar(y, 1.0 / size);
            Some(crate::import::pose::transpose(&[x, y, cross(x, y)]))
        }
        _ => {
            let z = element.read_exactly_n_numbers::<3>("zaxis", cx)?;
            let size = vector_norm(z.value);
            report_zero_length_vector(size, "the z axis", &z, cx)?;
            Some(rotation_from_z(vector_times_scalar(z.value, 1.0 / size)))
        }
    }
}

/// Reports angles of an MJCF file in radians that are most likely meant in degrees.
fn report_angles_likely_in_degrees(angles: &[f64], place: &Place, settings: &MjcfSettings, cx: &mut Cx<'_>) {
    if !settings.degrees {
        report_likely_degrees(angles, place, RADIANS, cx);
    }
}

const RADIANS: &str = "`angle=\"radian\"` makes angles of the file radians: write the angle that is meant, \
                       or `angle=\"degree\"`";

/// Reports vectors whose length is zero or not finite.
fn report_zero_length_vector<const N: usize>(
    size: f64,
    what: &str,
    found: &Located<[f64; N]>,
    cx: &mut Cx<'_>,
) -> Option<()> {
    if size < 1e-14 || !size.is_finite() {
        cx.report_error(&found.place, format!("{what} of length {size} has no direction"), |d| d);
        return None;
    }
    Some(())
}
