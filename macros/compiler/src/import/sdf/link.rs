//! Conversion of an SDF `<link>` element to a [`Body`].

use super::frames::{Frames, pose_in_link, reference_frame_attribute};
use super::scope::Scope;
use super::version::is_before_version;
use crate::diag::Place;
use crate::import::context::Cx;
use crate::import::element::{
    Node, check_attributes_of_value_element, child_elements, child_for_each_name, element_source_position,
    read_numbers_content, read_trimmed_content, report_missing_or_misspelt_attributes,
    report_misspelt_element_name,
};
use crate::import::misplaced;
use crate::import::pose::{Matrix, NumericPose, rotated_tensor};
use crate::import::robot::massless_link;
use crate::syntax::{Body, Expr, ExprKind, FileOptions, InertiaOption, Name};

/// Entries of the SDF inertia matrix with their defaults, kg·m².
const INERTIA: [(&str, f64); 6] =
    [("ixx", 1.0), ("ixy", 0.0), ("ixz", 0.0), ("iyy", 1.0), ("iyz", 0.0), ("izz", 1.0)];

/// Child elements of an SDF link that this module reads.
const LINK: [&str; 3] = ["inertial", "pose", "velocity_decay"];

const PARTS_HELP: &str = "expected `<pose>`, `<mass>` and `<inertia>` with `<ixx>` and so on";

/// First version of SDF in which the pose of an `<inertial>` is always relative to its link.
const IN_LINK: (u32, u32) = (1, 7);

/// Reads a link. The defaults of the format apply to missing mass properties: mass 1 kg, and inertia 1 kg·m²
/// about every axis.
pub(super) fn read_link(
    node: Node<'_>,
    (name, scope): (&Name, &Scope),
    frames: &Frames,
    options: &FileOptions,
    cx: &mut Cx<'_>,
) -> Option<Body> {
    report_missing_or_misspelt_attributes(node, &["name"], &[], cx);
    frames.resolve_world_pose(name, cx)?;
    let mut body = massless_link(name.clone());
    report_unsupported_link_settings(node, options, cx);
    child_elements(node).for_each(|child| report_misspelt_element_name(child, &LINK, cx));
    misplaced::report_misplaced_contents(
        node,
        &LINK,
        "mass properties belong to `<inertial>`, and connections of links to `<joint>`",
        cx,
    );
    if options.inertias == InertiaOption::None {
        return Some(body);
    }
    let [inertial] = child_for_each_name(node, ["inertial"], cx);
    let at = element_source_position(inertial.unwrap_or(node), cx);
    let [pose, mass, inertia, water] = match inertial {
        Some(inertial) => {
            report_automatic_inertia(inertial, &at, cx);
            check_attributes_of_value_element(inertial, &["auto"], cx);
            misplaced::report_misplaced_contents(inertial, &["pose", "mass", "inertia"], PARTS_HELP, cx);
            child_for_each_name(inertial, ["pose", "mass", "inertia", "fluid_added_mass"], cx)
        }
        None => [None; 4],
    };
    if let Some(water) = water {
        cx.report_error(&element_source_position(water, cx), "`<fluid_added_mass>` is not supported", |d| {
            d.add_help("remove it")
        });
    }
    let mass = match mass {
        Some(mass) => read_numbers_content::<1>(mass, cx)?.value[0],
        None => 1.0,
    };
    let pose = match (pose, inertial) {
        (Some(pose), Some(inertial)) => {
            if let Some(said) =
                reference_frame_attribute(pose, cx).filter(|_| !is_before_version(pose, IN_LINK))
            {
                let at = cx.source_position(said.range_value().start);
                cx.report_error(&at, "the pose of an `<inertial>` is relative to its link", |d| {
                    d.add_help("remove `relative_to`")
                });
            }
            pose_in_link(inertial, (name, scope), frames, cx)?
        }
        _ => NumericPose::ZERO,
    };
    set_mass_properties(&mut body, mass, &pose, &rotated_tensor(&pose.axes, &read_inertia(inertia, cx)), &at);
    if !body
        .inertia
        .iter()
        .flat_map(Expr::all_subexpressions)
        .filter_map(Expr::literal_number)
        .all(f64::is_finite)
    {
        cx.report_error(&at, "an inertia that is too large for floating-point numbers", |d| d);
    }
    Some(body)
}

/// Reports settings of a link that affect its motion and are not supported.
fn report_unsupported_link_settings(node: Node<'_>, options: &FileOptions, cx: &mut Cx<'_>) {
    for child in child_elements(node) {
        let kind = child.tag_name().name();
        let off =
            read_trimmed_content(child, cx).is_some_and(|word| matches!(word.text.as_str(), "false" | "0"));
        if (kind == "gravity" && off) || (kind == "kinematic" && !off) {
            let message = format!("`<{kind}>` of a link is not supported");
            cx.report_error(&element_source_position(child, cx), message, |d| {
                d.add_help("remove it: gravity acts on all links, and forces move them")
            });
        }
        let decays = kind == "velocity_decay"
            && child_elements(child).any(|rate| {
                read_trimmed_content(rate, cx).is_none_or(|word| word.text.parse::<f64>() != Ok(0.0))
            });
        if decays && options.honour_passive {
            cx.report_error(
                &element_source_position(child, cx),
                "`<velocity_decay>` of a link is not supported",
                |d| d.add_help("to ignore it, write `#[mechanism(…, passive = ignore)]`"),
            );
        }
    }
}

fn report_automatic_inertia(inertial: Node<'_>, at: &Place, cx: &mut Cx<'_>) {
    report_missing_or_misspelt_attributes(inertial, &[], &["auto"], cx);
    if inertial.attribute("auto").is_some_and(|auto| matches!(auto, "true" | "1")) {
        let message = "mass properties by collision geometry are not supported";
        cx.report_error(at, message, |d| d.add_help("write `<mass>` and `<inertia>` instead of `auto`"));
    }
}

fn read_inertia(inertia: Option<Node<'_>>, cx: &mut Cx<'_>) -> Matrix {
    let mut entries = INERTIA.map(|(_, usual)| usual);
    if let Some(inertia) = inertia {
        check_attributes_of_value_element(inertia, &[], cx);
        misplaced::report_misplaced_contents(inertia, &INERTIA.map(|(entry, _)| entry), PARTS_HELP, cx);
        let found = child_for_each_name(inertia, INERTIA.map(|(entry, _)| entry), cx);
        for (to, from) in entries.iter_mut().zip(found) {
            if let Some(found) = from.and_then(|from| read_numbers_content::<1>(from, cx)) {
                *to = found.value[0];
            }
        }
    }
    let [xx, xy, xz, yy, yz, zz] = entries;
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

/// Sets the mass properties of a body from an SDF link.
fn set_mass_properties(body: &mut Body, mass: f64, pose: &NumericPose, inertia: &Matrix, at: &Place) {
    body.mass = Some(Expr::number_at(mass, at));
    body.com = (pose.at != [0.0; 3]).then(|| Expr::vector_at(pose.at, at));
    let entry =
        |i: usize, j: usize| inertia.get(i.min(j)).and_then(|row| row.get(i.max(j))).copied().unwrap_or(0.0);
    let rows = (0..3).map(|i| Expr::vector_at(std::array::from_fn(|j| entry(i, j)), at)).collect();
    let zero = inertia.iter().flatten().all(|entry| *entry == 0.0);
    body.inertia = (!zero).then(|| Expr { kind: ExprKind::Array(rows), place: at.clone() });
}
