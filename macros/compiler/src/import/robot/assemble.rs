//! Assembly of the language's bodies and joints from the links and joints of a file, their order and their
//! motions.

use super::couplings;
use super::drives;
use super::joint::FileJoint;
use super::motion::JointMotion;
use super::names::unused_name;
use super::parts::Robot;
use super::tree::JointOrder;
use crate::import::context::{Cx, quote_word};
use crate::import::imported::ImportedMechanism;
use crate::syntax::{
    BaseAttachment, Body, Endpoint, Expr, FileInputSource, FileOptions, GROUND, Joint, JointKind,
    LimitOption, Name, ROOT_JOINT,
};

/// Assembles the mechanism. Each body is placed in the list like the joint whose child it is.
pub(in crate::import) fn assemble_mechanism(
    robot: Robot,
    order: &JointOrder,
    motions: Vec<JointMotion>,
    options: &FileOptions,
    cx: &mut Cx<'_>,
) -> ImportedMechanism {
    let is_ground = robot.links[order.root].name.text == GROUND;
    let collisions = robot
        .collisions
        .iter()
        .filter_map(|(link, part)| Some(part.collision_on_link(&robot.links.get(*link)?.name)));
    let collisions = collisions.collect();
    let visuals = robot
        .visuals
        .iter()
        .filter_map(|(link, part)| Some(part.visual_on_link(&robot.links.get(*link)?.name)));
    let visuals = visuals.collect();
    let root = root_joint(&robot, order.root, options.base);
    let mut links: Vec<Option<Body>> = robot.links.into_iter().map(Some).collect();
    let mut given: Vec<Option<(FileJoint, JointMotion)>> =
        robot.joints.into_iter().zip(motions).map(Some).collect();
    let mut bodies: Vec<Body> = links[order.root].take().into_iter().filter(|_| !is_ground).collect();
    let mut joints: Vec<Joint> = Some(root).into_iter().filter(|_| !is_ground).collect();
    let drives = drives::drives_of_moving_joints(robot.drives, &given);
    let constraints = couplings::constraints_on_moving_joints(robot.constraints, &given, cx);
    let (mut limits, stops) = (Vec::new(), options.limits == LimitOption::Stops);
    let mut left_out = robot.left_out;
    for (joint, child) in &order.joints {
        if let Some((joint, JointMotion::Frozen(_))) = &given[*joint]
            && joint.mimic.is_some()
            && options.lock.iter().any(|lock| lock.text == joint.name.text)
        {
            left_out.push(format!("the coupling of {}, which is locked", joint.name.text));
        }
        limits.extend(given[*joint].as_ref().and_then(|(joint, motion)| match motion {
            JointMotion::Frozen(_) => None,
            JointMotion::Own => joint.limits.convert_joint_limits(&joint.name, false, stops),
            JointMotion::Follows(_) => joint.limits.convert_joint_limits(&joint.name, true, stops),
        }));
        bodies.extend(links[*child].take());
        joints.extend(given[*joint].take().map(|(joint, motion)| build_joint(joint, motion, options, cx)));
    }
    let (fields, rates) = robot
        .states
        .into_iter()
        .map(|(field, rate)| {
            let name = field.ident.clone();
            (field, (name, rate))
        })
        .unzip();
    // The order has all of them.
    links.iter().flatten().for_each(|link| cx.report_internal_loss_of_element(&link.name));
    given.iter().flatten().for_each(|(joint, _)| cx.report_internal_loss_of_element(&joint.name));
    ImportedMechanism {
        bodies,
        joints,
        drives,
        dissipations: robot.dissipations,
        constraints,
        contacts: robot.contacts,
        gravity: robot.gravity,
        limits,
        fields,
        rates,
        is_ground,
        collisions,
        visuals,
        snapped: robot.snapped,
        left_out,
        files: Vec::new(),
    }
}

/// Returns the joint between ground and root, which URDF files do not contain.
fn root_joint(robot: &Robot, root: usize, base: BaseAttachment) -> Joint {
    let link = &robot.links[root].name;
    let names_in_robot =
        || robot.joints.iter().map(|j| &j.name.text).chain(robot.links.iter().map(|l| &l.name.text));
    let text = unused_name(ROOT_JOINT, |text| names_in_robot().any(|name| name == text));
    let name_with_link_span = |text: &str| Name { text: text.to_string(), place: link.place.clone() };
    let kind = match base {
        BaseAttachment::Fixed => JointKind::Weld,
        BaseAttachment::Free => JointKind::Free,
    };
    let mut ground = endpoint_at_origin(name_with_link_span(GROUND));
    if let Some(origin) = robot.root.as_ref().filter(|_| base == BaseAttachment::Fixed) {
        (ground.at, ground.rotated) = (origin.nonzero_position(), origin.nonzero_rotations());
    }
    let mut joint = plain_joint(name_with_link_span(&text), kind, ground, endpoint_at_origin(link.clone()));
    if let Some(origin) = robot.root.as_ref().filter(|_| base == BaseAttachment::Free) {
        joint.initial = origin.pose().free_joint_coordinates();
    }
    joint
}

/// Returns an endpoint at the origin of a body.
pub(in crate::import) fn endpoint_at_origin(body: Name) -> Endpoint {
    Endpoint { body, at: None, rotated: Vec::new() }
}

/// Returns the endpoint of a joint on its child link.
fn endpoint_of_child(anchor: [f64; 3], given: &FileJoint) -> Endpoint {
    let at = (anchor != [0.0; 3]).then(|| Expr::vector_at(anchor, &given.origin.xyz.place));
    Endpoint { at, ..endpoint_at_origin(given.child.clone()) }
}

pub(in crate::import) fn plain_joint(
    name: Name,
    kind: JointKind,
    parent: Endpoint,
    child: Endpoint,
) -> Joint {
    Joint {
        name,
        kind,
        parent,
        child,
        about: Vec::new(),
        along: Vec::new(),
        pitch: None,
        lead: None,
        normalise_axis: false,
        mimic: None,
        damping: None,
        friction: None,
        branch: None,
        driven: false,
        initial: Vec::new(),
    }
}

/// Returns the endpoint of a joint on its parent link.
fn endpoint_of_parent(given: &FileJoint) -> Endpoint {
    Endpoint {
        body: given.parent.clone(),
        at: given.origin.nonzero_position(),
        rotated: given.origin.nonzero_rotations(),
    }
}

fn build_joint(given: FileJoint, motion: JointMotion, options: &FileOptions, cx: &mut Cx<'_>) -> Joint {
    if let JointMotion::Frozen(coordinate) = motion {
        let mut parent = endpoint_of_parent(&given);
        move_parent_endpoint(&mut parent, &given, coordinate, cx);
        let child = endpoint_of_child(given.anchor, &given);
        return plain_joint(given.name, JointKind::Weld, parent, child);
    }
    let alone = given.has_single_coordinate();
    let mut joint = convert_file_joint(given);
    match motion {
        JointMotion::Follows(mimic) => joint.mimic = Some(mimic),
        _ => joint.driven = options.inputs == FileInputSource::Joints && alone,
    }
    joint
}

/// Converts a joint with its endpoints, axis, lead, damping and friction.
pub(in crate::import) fn convert_file_joint(given: FileJoint) -> Joint {
    let (parent, child) = (endpoint_of_parent(&given), endpoint_of_child(given.anchor, &given));
    let has_axis = given.has_axis();
    let mut joint = plain_joint(given.name, given.kind, parent, child);
    let axis = Expr::vector_at(given.axis.value, &given.axis.place);
    // A planar joint moves in the plane perpendicular to its axis.
    match given.kind.row().arguments {
        ["about", ..] if has_axis => joint.about.push(axis),
        ["along", ..] if has_axis => joint.along.push(axis),
        _ => {}
    }
    joint.normalise_axis = has_axis;
    joint.lead = given.lead;
    (joint.damping, joint.friction, joint.initial) = (given.damping, given.friction, given.initial);
    joint
}

/// Moves the parent's endpoint of a locked joint by the joint's displacement at `coordinate`.
fn move_parent_endpoint(end: &mut Endpoint, given: &FileJoint, coordinate: f64, cx: &mut Cx<'_>) {
    if coordinate == 0.0 {
        return;
    }
    let axis = unit_vector(given.axis.value);
    match given.kind.single_axis_joint_is_rotational() {
        Some(true) => end.rotated.push(rotation_about_axis(axis, coordinate, given)),
        Some(false) => {
            let shift = given.origin.rotate_vector(axis);
            let from = given.origin.xyz.value;
            let at = [0, 1, 2].map(|k| from[k] + coordinate * shift[k]);
            if !at.iter().all(|x| x.is_finite()) {
                let message = format!("joint {} has an infinite position", quote_word(&given.name.text));
                cx.report_error(&given.name.place, message, |d| d);
            }
            end.at = (at != [0.0; 3]).then(|| Expr::vector_at(at, &given.origin.xyz.place));
        }
        None => {}
    }
}

/// Returns a rotation about a unit axis. Rotations about coordinate axes use `x`, `y` or `z`, which keep
/// zeros and ones exact.
fn rotation_about_axis(axis: [f64; 3], angle: f64, given: &FileJoint) -> Expr {
    let place = &given.axis.place;
    let (word, sign) = match axis {
        [s, 0.0, 0.0] => ("x", s),
        [0.0, s, 0.0] => ("y", s),
        [0.0, 0.0, s] => ("z", s),
        _ => {
            let arguments = vec![Expr::vector_at(axis, place), Expr::number_at(angle, place)];
            return Expr::function_call_expression("eigenaxis", arguments, place);
        }
    };
    Expr::function_call_expression(word, vec![Expr::number_at(sign * angle, place)], place)
}

/// Normalises a vector. Scaling by the largest component first prevents overflow and underflow of the
/// squares.
pub(in crate::import) fn unit_vector(vector: [f64; 3]) -> [f64; 3] {
    let largest = vector.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let scaled = vector.map(|x| x / largest);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    scaled.map(|x| x / length)
}
