//! Mass properties of a body from its `<inertial>` or from its geometry.

use super::defaults::{Defaults, ElementWithDefaults};
use super::frame::read_pose;
use super::mesh::Meshes;
use super::settings::{MassSource, MjcfSettings};
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, element_source_position, quoted_tag, read_numbers_attribute, report_missing_or_misspelt_attributes,
};
use crate::import::pose::{
    IDENTITY, Matrix, NumericPose, Vector, dot, eigen_decomposition, rotated_tensor, rotation_from_z,
    vector_norm, vector_sum, vector_times_scalar,
};
use std::f64::consts::PI;

/// Numeric mass properties of a body: mass, centre of mass and inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BodyMassProperties {
    /// Mass of the body, kg.
    pub(super) mass: f64,
    /// Centre of mass in body axes, m.
    pub(super) com: Vector,
    /// Inertia about the centre of mass in body axes, kg·m².
    pub(super) inertia: Matrix,
}

/// Masses below this value (kg) are treated as zero.
const NOTHING: f64 = 1e-15;

const DENSITY: f64 = 1000.0;

/// MJCF shapes without volume.
const FLAT: [&str; 2] = ["plane", "hfield"];

impl BodyMassProperties {
    /// Transforms the mass properties from a frame to its reference frame. `pose` is the pose of the frame
    /// relative to the reference frame.
    pub(super) fn mass_properties_in_outer_frame(&self, pose: &NumericPose) -> BodyMassProperties {
        BodyMassProperties {
            com: vector_sum(pose.at, crate::import::pose::matrix_times_vector(&pose.axes, self.com)),
            inertia: rotated_tensor(&pose.axes, &self.inertia),
            ..*self
        }
    }
}

/// Returns the mass properties of the rigid union of several bodies; `None` for zero mass.
pub(super) fn rigid_union(parts: &[BodyMassProperties]) -> Option<BodyMassProperties> {
    if let [one] = parts {
        return Some(*one);
    }
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    if mass <= 0.0 {
        return None;
    }
    let com = vector_times_scalar(
        parts.iter().fold([0.0; 3], |sum, part| vector_sum(sum, vector_times_scalar(part.com, part.mass))),
        1.0 / mass,
    );
    let mut inertia = [[0.0; 3]; 3];
    for part in parts {
        let r = vector_sum(part.com, vector_times_scalar(com, -1.0));
        for (i, row) in inertia.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let unit = if i == j { dot(r, r) } else { 0.0 };
                *entry += part.inertia[i][j] + part.mass * (unit - r[i] * r[j]);
            }
        }
    }
    Some(BodyMassProperties { mass, com, inertia })
}

/// Returns the mass properties of a body from `<inertial>` or from its shapes. Each comes with the pose of
/// its surrounding `<frame>` elements relative to the body.
pub(super) fn mass_properties_of_body<'a>(
    inertial: &Option<(Node<'a>, NumericPose)>,
    shapes: &[(ElementWithDefaults<'a>, NumericPose)],
    defaults: &Defaults<'a>,
    meshes: &mut Meshes<'a>,
    (pose, settings): (&NumericPose, &MjcfSettings),
    cx: &mut Cx<'_>,
) -> Option<BodyMassProperties> {
    let said = inertial.as_ref().filter(|_| settings.source != MassSource::Geometry || shapes.is_empty());
    let found = match said {
        Some((node, outer)) => read_inertial(*node, defaults, settings, cx).map(|mass| {
            if *outer == NumericPose::ZERO { mass } else { mass.mass_properties_in_outer_frame(outer) }
        }),
        None if settings.source == MassSource::Inertial => None,
        None => {
            let parts: Vec<BodyMassProperties> = shapes
                .iter()
                .filter_map(|(shape, outer)| {
                    Some(
                        mass_properties_of_shape(shape, meshes, settings, cx)?
                            .mass_properties_in_outer_frame(outer),
                    )
                })
                .filter(|part| part.mass > NOTHING)
                .collect();
            rigid_union(&parts)
        }
    };
    mass_properties_raised_to_minimum(found, pose, settings)
}

/// Raises mass and principal moments to the minimum values of the file. With `balance`, principal moments
/// that violate the triangle inequality are replaced by their mean.
fn mass_properties_raised_to_minimum(
    found: Option<BodyMassProperties>,
    pose: &NumericPose,
    settings: &MjcfSettings,
) -> Option<BodyMassProperties> {
    if settings.least_mass == 0.0 && settings.least_inertia == 0.0 && !settings.balance {
        return found;
    }
    // For a body without mass, MuJoCo puts this mass at the body's position relative to its parent.
    let zero = BodyMassProperties { mass: 0.0, com: pose.at, inertia: [[0.0; 3]; 3] };
    let found = found.unwrap_or(zero);
    let (moments, axes) = eigen_decomposition(&found.inertia);
    let mut moments = moments.map(|moment| moment.max(settings.least_inertia));
    let [a, b, c] = moments;
    if settings.balance && (a + b < c || a + c < b || b + c < a) {
        moments = [(a + b + c) / 3.0; 3];
    }
    let bounded = BodyMassProperties { mass: found.mass.max(settings.least_mass), ..found };
    Some(match moments == [a, b, c] && moments == eigen_decomposition(&found.inertia).0 {
        true => bounded,
        false => BodyMassProperties { inertia: rotated_tensor(&axes, &diagonal_matrix(moments)), ..bounded },
    })
}

fn diagonal_matrix(moments: Vector) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { moments[i] } else { 0.0 }))
}

const INERTIAL: [&str; 9] =
    ["pos", "mass", "diaginertia", "fullinertia", "quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Reads the mass properties in the MJCF element `<inertial>`.
fn read_inertial(
    node: Node<'_>,
    defaults: &Defaults<'_>,
    settings: &MjcfSettings,
    cx: &mut Cx<'_>,
) -> Option<BodyMassProperties> {
    report_missing_or_misspelt_attributes(node, &["pos", "mass"], &INERTIAL, cx);
    let element = defaults.element_with_defaults(node, &[], 0, cx);
    let mass = element.read_finite_attribute("mass", cx)?.value;
    let NumericPose { at: com, axes } = read_pose(&element, settings, cx);
    if let Some(full) = read_numbers_attribute::<6>(node, "fullinertia", cx) {
        if node.has_attribute("diaginertia") {
            cx.report_error(&full.place, "`fullinertia` and `diaginertia` of one body", |d| {
                d.add_help("remove one of the two")
            });
        } else if axes != IDENTITY {
            let help = "MuJoCo takes the axes of `fullinertia` for those of the body";
            cx.report_error(&full.place, "`fullinertia` with an orientation", |d| d.add_help(help));
        }
        let [xx, yy, zz, xy, xz, yz] = full.value;
        return Some(BodyMassProperties { mass, com, inertia: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] });
    }
    let moments = read_numbers_attribute(node, "diaginertia", cx).map_or([0.0; 3], |found| found.value);
    Some(BodyMassProperties { mass, com, inertia: rotated_tensor(&axes, &diagonal_matrix(moments)) })
}

/// Returns the mass properties of a shape in body axes; `None` for a shape without mass.
fn mass_properties_of_shape<'a>(
    shape: &ElementWithDefaults<'a>,
    meshes: &mut Meshes<'a>,
    settings: &MjcfSettings,
    cx: &mut Cx<'_>,
) -> Option<BodyMassProperties> {
    let group = shape.read_finite_attribute("group", cx).map_or(0.0, |group| group.value);
    if group < settings.groups[0] || group > settings.groups[1] {
        return None;
    }
    let said = shape.read_finite_attribute("mass", cx).map(|mass| mass.value);
    let density = shape.read_finite_attribute("density", cx).map_or(DENSITY, |density| density.value);
    let kind = shape.trimmed_attribute_text("type").unwrap_or("sphere");
    if said == Some(0.0) || (said.is_none() && density == 0.0) || FLAT.contains(&kind) {
        return None;
    }
    if shape.read_boolean_attribute("shellinertia", cx) == Some(true) {
        return report_unsupported_shape(shape, "`shellinertia`", cx);
    }
    if kind == "mesh" {
        let found = meshes.mass_properties_of_mesh_shape(shape, cx)?;
        let found = found.scaled_to_mass(said.unwrap_or(density * found.mass));
        return Some(found.mass_properties_in_outer_frame(&read_pose(shape, settings, cx)));
    }
    if shape.node_with_attribute("mesh").is_some() || kind == "sdf" {
        return report_unsupported_shape(shape, "a shape that is fitted to a mesh", cx);
    }
    let (pose, size) = shape_pose_and_dimensions(kind, shape, settings, cx)?;
    let (volume, moments) = solid_volume_and_moments(kind, size);
    let mass = said.unwrap_or(density * volume);
    let inertia = diagonal_matrix(vector_times_scalar(moments, mass));
    Some(BodyMassProperties { mass, com: [0.0; 3], inertia }.mass_properties_in_outer_frame(&pose))
}

/// Returns pose and half lengths of a shape. The first entry is the radius of a round shape and the last
/// entry its half length; unused entries are ignored.
pub(super) fn shape_pose_and_dimensions(
    kind: &str,
    shape: &ElementWithDefaults<'_>,
    settings: &MjcfSettings,
    cx: &mut Cx<'_>,
) -> Option<(NumericPose, Vector)> {
    let (pose, half) = pose_and_half_length(shape, settings, cx)?;
    let size = shape.numbers_with_defaults("size", [0.0; 3], cx);
    let [x, y, z] = size.as_ref().map_or([0.0; 3], |size| size.value);
    // The cross section of a box between two points is a square.
    let y = if half.is_some() { x } else { y };
    let z = match kind {
        // The half length of a capsule or a cylinder is the second entry of `size`.
        "capsule" | "cylinder" => half.unwrap_or(y),
        _ => half.unwrap_or(z),
    };
    let used: &[f64] = match kind {
        "sphere" => &[x],
        "capsule" | "cylinder" => &[x, z],
        "box" | "ellipsoid" => &[x, y, z],
        _ => {
            let known = ["sphere", "capsule", "cylinder", "ellipsoid", "box", "mesh", "plane", "hfield"];
            let message = format!("unknown shape {}", quote_word(kind));
            cx.report_error(&shape.place_of_attribute_value("type", cx), message, |d| {
                d.suggest_name(kind, known)
            });
            return None;
        }
    };
    if used.iter().any(|length| *length <= 0.0) {
        let message = format!(
            "a `{kind}` of size `{}` has no volume",
            used.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
        );
        cx.report_error(&shape.place_of_attribute_value("size", cx), message, |d| {
            d.add_help("expected half lengths and radii above zero")
        });
        return None;
    }
    Some((pose, [x, y, z]))
}

/// Returns pose and half length of a shape. The half length is `None` unless `fromto` gives two end points.
pub(super) fn pose_and_half_length(
    shape: &ElementWithDefaults<'_>,
    settings: &MjcfSettings,
    cx: &mut Cx<'_>,
) -> Option<(NumericPose, Option<f64>)> {
    let Some(ends) = shape.read_exactly_n_numbers::<6>("fromto", cx) else {
        return Some((read_pose(shape, settings, cx), None));
    };
    if let Some(node) = shape.node_with_attribute("pos") {
        let message = format!("`fromto` and `pos` of one {}", quoted_tag(shape.node));
        let at = node.attribute_node("pos").map_or(node.range().start, |pos| pos.range_value().start);
        cx.report_error(&cx.source_position(at), message, |d| d.add_help("remove one of the two"));
    }
    let kind = shape.trimmed_attribute_text("type").unwrap_or("sphere");
    if !["capsule", "cylinder", "ellipsoid", "box"].contains(&kind) {
        let message = format!("`fromto` of a `{kind}`, which has no length");
        cx.report_error(&ends.place, message, |d| {
            d.add_help("expected `capsule`, `cylinder`, `ellipsoid` or `box`")
        });
    }
    let [a, b, c, d, e, f] = ends.value;
    let along = [a - d, b - e, c - f];
    let size = vector_norm(along);
    if size < 1e-14 {
        cx.report_error(&ends.place, "`fromto` from a point to itself", |d| {
            d.add_help("expected two points")
        });
        return None;
    }
    let at = vector_times_scalar(vector_sum([a, b, c], [d, e, f]), 0.5);
    Some((
        NumericPose { at, axes: rotation_from_z(vector_times_scalar(along, 1.0 / size)) },
        Some(size / 2.0),
    ))
}

/// Returns the volume and the moments of inertia per unit mass of a solid with these half lengths.
fn solid_volume_and_moments(kind: &str, [x, y, z]: Vector) -> (f64, Vector) {
    let axisymmetric_moments = |xx: f64, zz: f64| [xx, xx, zz];
    match kind {
        "sphere" => (4.0 / 3.0 * PI * x * x * x, [0.4 * x * x; 3]),
        "capsule" => {
            let height = 2.0 * z;
            let (ball, tube) = (4.0 / 3.0 * PI * x * x * x, PI * x * x * height);
            let volume = ball + tube;
            let (ball, tube) = (ball / volume, tube / volume);
            let across = tube * (3.0 * x * x + height * height) / 12.0;
            let caps = ball * (0.4 * x * x + height * (3.0 * x + 2.0 * height) / 8.0);
            (volume, axisymmetric_moments(across + caps, tube * x * x / 2.0 + ball * 0.4 * x * x))
        }
        "cylinder" => {
            let height = 2.0 * z;
            (PI * x * x * height, axisymmetric_moments((3.0 * x * x + height * height) / 12.0, x * x / 2.0))
        }
        "ellipsoid" => {
            let moments = [y * y + z * z, x * x + z * z, x * x + y * y];
            (4.0 / 3.0 * PI * x * y * z, vector_times_scalar(moments, 0.2))
        }
        _ => {
            let moments = [y * y + z * z, x * x + z * z, x * x + y * y];
            (8.0 * x * y * z, vector_times_scalar(moments, 1.0 / 3.0))
        }
    }
}

/// Reports a shape whose mass properties cannot be computed.
fn report_unsupported_shape(
    shape: &ElementWithDefaults<'_>,
    what: &str,
    cx: &mut Cx<'_>,
) -> Option<BodyMassProperties> {
    let message = format!("the mass properties of {what} are not computed");
    cx.report_error(&element_source_position(shape.node, cx), message, |d| d.add_help(NEEDS_INERTIAL));
    None
}

pub(super) const NEEDS_INERTIAL: &str = "give the body an `<inertial pos=\"…\" mass=\"…\" \
                                         diaginertia=\"…\"/>`, or the shape `mass=\"0\"`; MuJoCo's `compile` \
                                         writes a file that has them";
