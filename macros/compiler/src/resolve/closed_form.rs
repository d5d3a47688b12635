//! Loops that are solved in closed form: a Pin closes a planar loop between two bodies, each of which is the
//! child of a Pin or a Sleeve (at most one Sleeve). The coordinates of these two joints become expressions of
//! the other coordinates, by the intersection of two circles, or of a circle and a line (Bottema and Roth,
//! *Theoretical Kinematics*, 1979, ch. XI). The argument `branch` selects one of the two assembly modes.

use super::elementary::ElementaryMotion;
use super::scope::{PlacedElement, PlacedElementKind, Scope};
use crate::diag::Diagnostics;
use crate::expr::sample::always_equals_number;
use crate::expr::{Expr, Rotation, Vec3};
use crate::kinematics::{express_in_link_axes, perpendicular_directions};
use crate::mechanism::{ClosedFormJoint, LinkId, Pose};
use crate::syntax::{Description, Endpoint, GROUND, Joint, JointKind};

/// Side of a loop with its joint coordinate at zero, in the axes of the joint of the first side.
struct LoopSide<'g> {
    /// Origin of the joint, relative to that of the first joint.
    base: Vec3<'g>,
    /// Closing point of the loop, relative to the joint's origin.
    point: Vec3<'g>,
    /// Sliding direction of the loop-closing joint; `None` for a Pin.
    slide: Option<Vec3<'g>>,
}

/// A loop that is solved in closed form, with the joints that are solved for.
pub struct ClosedFormLoop {
    /// Index of the joint that closes the loop.
    pub closing: usize,
    /// Indices of the joints whose children are the parent and the child of the closing joint.
    pub sides: [usize; 2],
}

const CLOSED_FORM_HELP: &str = "a loop is solved in closed form if a Pin closes it between two bodies that \
                                are connected by Pins, or by a Pin and a Sleeve, in one plane; without \
                                `branch` it is enforced by multipliers";

/// Returns the loops whose closing joint has a `branch`, and reports joints for which that is not allowed.
pub fn find_closed_form_loops(
    d: &Description,
    closing: &[bool],
    cx: &mut Diagnostics,
) -> Vec<ClosedFormLoop> {
    let mut found: Vec<ClosedFormLoop> = Vec::new();
    for (j, joint) in d.joints.iter().enumerate() {
        let Some(branch) = &joint.branch else { continue };
        if !closing[j] {
            cx.report_error(branch.place.clone(), "this joint does not close a loop and has no branch")
                .add_help("a joint closes a loop if its child has an earlier joint");
            continue;
        }
        let tree_joint_of_child_body = |end: &Endpoint| {
            let is_tree_joint_of_end = |(k, other): &(usize, &Joint)| {
                !closing[*k] && other.child.body.text == end.body.text && end.body.text != GROUND
            };
            d.joints.iter().enumerate().find(is_tree_joint_of_end).map(|(k, _)| k)
        };
        let is_in_other_loop = |k: usize| found.iter().any(|e| e.sides.contains(&k));
        let is_solvable_joint = |k: &usize| {
            d.joints[*k].kind.single_axis_joint_is_rotational().is_some()
                && d.joints[*k].mimic.is_none()
                && !is_in_other_loop(*k)
        };
        let sides =
            [&joint.parent, &joint.child].map(|end| tree_joint_of_child_body(end).filter(is_solvable_joint));
        let pins = sides.iter().flatten().filter(|k| d.joints[**k].kind == JointKind::Pin).count();
        if let [Some(a), Some(b)] = sides
            && joint.kind == JointKind::Pin
            && a != b
            && pins > 0
        {
            found.push(ClosedFormLoop { closing: j, sides: [a, b] });
        } else {
            cx.report_error(branch.place.clone(), "this loop is not solved in closed form")
                .add_help(CLOSED_FORM_HELP);
        }
    }
    found
}

/// Returns the joints for which loops are solved in closed form, with their axes.
pub fn joints_solved_in_closed_form<'g>(
    scope: &Scope<'_, 'g>,
    loops: &[ClosedFormLoop],
    cx: &mut Diagnostics,
) -> Vec<ClosedFormJoint<'g>> {
    let closed_form_joint = |j: &usize| {
        let (_, axis) = joint_frame(scope, *j, cx)?;
        Some(ClosedFormJoint { joint: *j, turns: scope.description.joints[*j].kind == JointKind::Pin, axis })
    };
    loops.iter().flat_map(|e| e.sides.iter()).map_while(closed_form_joint).collect()
}

/// Returns the child's joint frame in the parent's joint frame, for the solved joint coordinate.
pub fn pose_across_solved_joint<'g>(
    scope: &Scope<'_, 'g>,
    solved: &ClosedFormLoop,
    j: usize,
    cx: &mut Diagnostics,
) -> Option<Pose<'g>> {
    let ClosedFormLoop { closing, sides } = solved;
    let joint = &scope.description.joints[*closing];
    let branch = scope.resolve_scalar(joint.branch.as_ref()?, cx)?;
    let place = joint.branch.as_ref().map_or(&joint.name.place, |b| &b.place);
    if !branch.constant_value().is_some_and(|b| b.abs() == 1.0) {
        cx.report_error(place.clone(), "unknown branch").add_help("write `branch = 1` or `branch = -1`");
        return None;
    }
    // The first side is a Pin; all following vectors are in the axes of its joint.
    let pin = usize::from(scope.description.joints[sides[0]].kind != JointKind::Pin);
    let (first, second) = (sides[pin], sides[1 - pin]);
    let (frame, axis) = joint_frame(scope, first, cx)?;
    let ends = [&joint.parent, &joint.child];
    let a = side_of_closed_form_loop(scope, first, ends[pin], &frame, cx)?;
    let b = side_of_closed_form_loop(scope, second, ends[1 - pin], &frame, cx)?;
    let (second_frame, second_axis) = joint_frame(scope, second, cx)?;
    let normal = vector_in_frame_axes(
        scope,
        &frame,
        second_frame.link,
        second_frame.pose.rotation.vector_in_parent_axes(second_axis),
    );
    let is_always_zero = |e: Expr<'g>| always_equals_number(e, 0.0);
    let in_plane = match b.slide {
        None => normal.cross(axis).0.iter().all(|e| is_always_zero(*e)),
        Some(slide) => is_always_zero(slide.dot(axis)),
    };
    if !in_plane || !is_always_zero((b.base + b.point - a.point).dot(axis)) {
        cx.report_error(place.clone(), "this loop does not lie in one plane").add_help(CLOSED_FORM_HELP);
        return None;
    }
    let [(_, e1), (_, e2)] = perpendicular_directions(axis);
    let in_plane_components = |v: Vec3<'g>| [v.dot(e1), v.dot(e2)];
    let closing_point = closing_point(&a, &b, branch, &in_plane_components);
    if j == first {
        let angle = angle_between(in_plane_components(a.point), closing_point);
        return Some(rotation_pose(scope, axis, angle));
    }
    let reached = e1 * closing_point[0] + e2 * closing_point[1] - b.base;
    Some(match b.slide {
        // Slide by the remaining distance, in the axes of the second joint.
        Some(slide) => {
            let length = (reached - b.point).dot(slide);
            Pose { rotation: Rotation::identity(scope.graph), translation: second_axis * length }
        }
        None => {
            let sense = normal.dot(axis);
            rotation_pose(
                scope,
                second_axis,
                angle_between(in_plane_components(b.point), in_plane_components(reached)) * sense,
            )
        }
    })
}

fn rotation_pose<'g>(scope: &Scope<'_, 'g>, axis: Vec3<'g>, angle: Expr<'g>) -> Pose<'g> {
    Pose { rotation: Rotation::rotation_about_axis(axis, angle), translation: Vec3::zero(scope.graph) }
}

/// Returns the frame of a joint on its parent, and its axis in that frame.
fn joint_frame<'g>(
    scope: &Scope<'_, 'g>,
    j: usize,
    cx: &mut Diagnostics,
) -> Option<(PlacedElement<'g>, Vec3<'g>)> {
    let joint = &scope.description.joints[j];
    let (link, pose) = scope.placement_of_joint_parent(&joint.parent.body, cx)?;
    let pose = pose.compose_with(&scope.frame_of_endpoint(&joint.parent, cx)?);
    let axis = match scope.motions_of_joint(joint, cx)?.first()? {
        ElementaryMotion::Turn(axis) | ElementaryMotion::Slide(axis) => *axis,
        _ => return None,
    };
    Some((PlacedElement { link, pose, kind: PlacedElementKind::Body }, axis))
}

fn side_of_closed_form_loop<'g>(
    scope: &Scope<'_, 'g>,
    j: usize,
    end: &Endpoint,
    frame: &PlacedElement<'g>,
    cx: &mut Diagnostics,
) -> Option<LoopSide<'g>> {
    let joint = &scope.description.joints[j];
    let (joint_frame, axis) = joint_frame(scope, j, cx)?;
    let on_child = scope.frame_of_endpoint(&joint.child, cx)?;
    let closing = scope.frame_of_endpoint(end, cx)?.translation;
    let point = on_child.inverse().transform_point(closing);
    let in_first_frame = |v| {
        vector_in_frame_axes(
            scope,
            frame,
            joint_frame.link,
            joint_frame.pose.rotation.vector_in_parent_axes(v),
        )
    };
    let terms = scope.kinematics.position_between(&joint_frame, frame);
    let zero = Vec3::zero(scope.graph);
    let base = terms.iter().fold(zero, |sum, (link, v)| sum + vector_in_frame_axes(scope, frame, *link, *v));
    let slide = (joint.kind == JointKind::Sleeve).then(|| in_first_frame(axis));
    Some(LoopSide { base, point: in_first_frame(point), slide })
}

/// Transforms a vector from the axes of a link to those of a frame. Released joints are treated as
/// closed: the solution is that of the original mechanism.
fn vector_in_frame_axes<'g>(
    scope: &Scope<'_, 'g>,
    frame: &PlacedElement<'g>,
    link: Option<LinkId>,
    v: Vec3<'g>,
) -> Vec3<'g> {
    let v = express_in_link_axes(&scope.kinematics.joints, v, link, frame.link);
    let v = frame.pose.rotation.vector_in_child_axes(v);
    scope.with_released_coordinates_zero(&v.0).try_into().map_or(v, Vec3)
}

/// Returns the point in the plane of the loop at which both sides meet, relative to the origin of the first
/// joint.
fn closing_point<'g>(
    a: &LoopSide<'g>,
    b: &LoopSide<'g>,
    branch: Expr<'g>,
    planar: &dyn Fn(Vec3<'g>) -> [Expr<'g>; 2],
) -> [Expr<'g>; 2] {
    let squared_norm = |v: [Expr<'g>; 2]| v[0].square() + v[1].square();
    let reach = squared_norm(planar(a.point));
    if let Some(slide) = b.slide {
        // The line w + s x, |w + s x| = |a|.
        let (w, s) = (planar(b.base + b.point), planar(slide));
        let along = w[0] * s[0] + w[1] * s[1];
        let x = branch * (along.square() - squared_norm(w) + reach).sqrt() - along;
        return [w[0] + s[0] * x, w[1] + s[1] * x];
    }
    // `part` is the fraction along the line between the origins, `height` the offset perpendicular to it.
    let d = planar(b.base);
    let distance = squared_norm(d);
    let part = (distance + reach - squared_norm(planar(b.point))) * 0.5 / distance;
    let height = branch * (reach / distance - part.square()).sqrt();
    [d[0] * part - d[1] * height, d[1] * part + d[0] * height]
}

/// Returns the angle from one direction to another.
fn angle_between<'g>(from: [Expr<'g>; 2], to: [Expr<'g>; 2]) -> Expr<'g> {
    (from[0] * to[1] - from[1] * to[0]).atan2(from[0] * to[0] + from[1] * to[1])
}
