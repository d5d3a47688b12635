//! `<joint>` → [`FileJoint`]. A joint with two axes becomes two joints with a massless link between them.

use super::frames::Frames;
use super::scope::Scope;
use super::version::is_before_version;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, check_attributes_of_value_element, child_elements, child_for_each_name, element_source_position,
    nonblank_texts_and_own_elements, quoted_tag, read_name_attribute, read_numbers_content,
    read_trimmed_content, report_missing_or_misspelt_attributes, required_child,
};
use crate::import::imported::Located;
use crate::import::misplaced;
use crate::import::pose::{NumericPose, Vector, matrix_times_vector, vector_norm};
use crate::import::robot::{
    FileJoint, FileLimits, FileOrigin, IGNORE_LIMITS, Robot, has_axis, has_single_coordinate, massless_link,
    origin_from_pose,
};
use crate::syntax::{
    Expr, FileForceElement, FileForceLaw, FileForceTarget, FileOptions, JointKind, LimitOption,
    MimicRelation, Name,
};

/// SDF's names of the joint types, with the number of axes of each.
const TYPES: [(&str, JointKind, usize); 8] = [
    ("revolute", JointKind::Pin, 1),
    ("continuous", JointKind::Pin, 1),
    ("prismatic", JointKind::Sleeve, 1),
    ("screw", JointKind::Screw, 1),
    ("fixed", JointKind::Weld, 0),
    ("ball", JointKind::Ball, 0),
    ("universal", JointKind::Pin, 2),
    ("revolute2", JointKind::Pin, 2),
];

/// Bounds of at least this magnitude are treated as infinite.
const ENDLESS: f64 = 1e15;

const IGNORE_PASSIVE: &str =
    "to ignore springs, damping and friction, write `#[mechanism(…, passive = ignore)]`";

const JOINT_HELP: &str = "a joint has `<pose>`, `<parent>`, `<child>` and `<axis>`";

const AXIS_HELP: &str = "an axis has `<xyz>`, `<limit>` with `<lower>`, `<upper>`, `<velocity>` and \
                         `<effort>`, `<dynamics>` with `<damping>`, `<friction>`, `<spring_stiffness>` and \
                         `<spring_reference>`, and `<mimic>`";

/// First version in which an axis is expressed in the axes of its joint. Earlier versions express it in the
/// axes of the model.
const IN_JOINT: (u32, u32) = (1, 5);

/// First version of SDF that lacks `<use_parent_model_frame>`.
const EXPRESSED_IN: (u32, u32) = (1, 7);

/// Returns the full name of the frame at one end of a joint.
pub(super) fn frame_name_at_joint_end(
    node: Node<'_>,
    which: &str,
    scope: &Scope,
    cx: &Cx<'_>,
) -> Option<Name> {
    let found = child_elements(node).find(|child| child.tag_name().name() == which)?;
    let said = read_trimmed_content(found, cx)?;
    Some(Name { text: scope.full_name(&said.text), ..said })
}

/// Reads an SDF joint and adds it to the robot.
pub(super) fn read_joint(
    (node, joint, scope): (Node<'_>, &Name, &Scope),
    frames: &Frames,
    options: &FileOptions,
    robot: &mut Robot,
    cx: &mut Cx<'_>,
) -> Option<()> {
    report_missing_or_misspelt_attributes(node, &["name", "type"], &[], cx);
    let known = ["pose", "parent", "child", "axis", "axis2", "screw_thread_pitch", "thread_pitch"];
    let [_, parent, child, axis, axis2, lead, old] = child_for_each_name(node, known, cx);
    required_child(parent, node, "parent", &[], cx)?;
    required_child(child, node, "child", &[], cx)?;
    misplaced::report_misplaced_contents(node, &known, JOINT_HELP, cx);
    [parent, child].into_iter().flatten().for_each(|end| check_attributes_of_value_element(end, &[], cx));
    for empty in [parent, child]
        .into_iter()
        .flatten()
        .filter(|end| nonblank_texts_and_own_elements(*end).next().is_none())
    {
        let message = format!("{} without a name", quoted_tag(empty));
        cx.report_error(&element_source_position(empty, cx), message, |d| {
            d.add_help("expected the name of a link or a frame")
        });
    }
    let (parent, child) = (
        frame_name_at_joint_end(node, "parent", scope, cx)?,
        frame_name_at_joint_end(node, "child", scope, cx)?,
    );
    let (word, kind, axes) = read_joint_type(node, cx)?;
    let at = frames.resolve_world_pose(joint, cx)?;
    // The ends of a joint may be frames that are attached to links.
    let (parent, child) = (frames.link_of_frame(&parent, cx)?, frames.link_of_frame(&child, cx)?);
    let (outer, inner) = (frames.resolve_world_pose(&parent, cx)?, frames.resolve_world_pose(&child, cx)?);
    let anchor = inner.inverse_pose().compose_with(&at).at;
    let base = outer.inverse_pose().compose_with(&NumericPose { at: at.at, axes: inner.axes });
    let number = axes.max(1);
    for (axis, which) in [(axis, "axis"), (axis2, "second axis")].into_iter().skip(axes) {
        // Exporters write an axis into fixed joints.
        if axis.is_some() && kind != JointKind::Weld {
            robot.left_out.push(format!("the {which} of {}, which is `{word}`", joint.text));
        }
    }
    let mut carrier = parent;
    for k in 0..number {
        let last = k + 1 == number;
        let (axis, text) = match k {
            0 => (axis, joint.text.clone()),
            _ => (axis2, format!("{}_2", joint.text)),
        };
        let named = Name { text, place: joint.place.clone() };
        let carried = match last {
            true => child.clone(),
            false => Name { text: format!("{}_1", joint.text), place: joint.place.clone() },
        };
        let pose = if k == 0 { base } else { NumericPose { at: anchor, ..NumericPose::ZERO } };
        let said = AxisSource { node, named: &named, axis, word, kind };
        let mut found = said.read_axis_joint((&at, &inner), scope, frames, options, robot, cx)?;
        (found.parent, found.child) = (carrier, carried.clone());
        (found.origin, found.anchor) = (origin_from_pose(&pose, &joint.place), anchor);
        if kind == JointKind::Screw {
            found.lead = read_screw_lead(node, lead, old, cx);
        }
        robot.joints.push(found);
        if !last {
            robot.links.push(massless_link(carried.clone()));
        }
        carrier = carried;
    }
    Some(())
}

fn read_joint_type(node: Node<'_>, cx: &mut Cx<'_>) -> Option<(&'static str, JointKind, usize)> {
    let found = node.attribute_node("type")?;
    let known = TYPES.iter().find(|(word, ..)| *word == found.value());
    if known.is_none() {
        let at = cx.source_position(found.range_value().start);
        let (message, known) = match found.value() {
            "gearbox" => {
                ("joint type `gearbox` is not supported".to_string(), "couple two joints by `<mimic>`")
            }
            other => (format!("unknown joint type {}", quote_word(other)), ""),
        };
        cx.report_error(&at, message, |d| match known {
            "" => d.suggest_name(found.value(), TYPES.map(|(word, ..)| word)),
            help => d.add_help(help),
        });
    }
    known.copied()
}

/// Reads the lead of a screw: advance per revolution, m. The older element `<thread_pitch>`, in rad/m, is
/// positive for left-handed threads.
fn read_screw_lead(
    node: Node<'_>,
    lead: Option<Node<'_>>,
    old: Option<Node<'_>>,
    cx: &mut Cx<'_>,
) -> Option<Expr> {
    let Some(written) = lead.or(old) else {
        cx.report_error(&element_source_position(node, cx), "screw without `<screw_thread_pitch>`", |d| {
            d.add_help("it is the advance of the joint per turn, m")
        });
        return None;
    };
    let found = read_numbers_content::<1>(written, cx)?;
    let [value] = found.value;
    if lead.is_none() && value == 0.0 {
        cx.report_error(
            &found.place,
            "a screw with `<thread_pitch>` zero advances infinitely far in a turn",
            |d| d.add_help("write `<screw_thread_pitch>`: the advance of the joint per turn, m"),
        );
        return None;
    }
    let lead = if lead.is_some() { value } else { -std::f64::consts::TAU / value };
    Some(Expr::number_at(lead, &found.place))
}

/// Returns the SDF joint that fixes one link to another.
pub(super) fn fixed_joint_between_links(
    name: Name,
    parent: Name,
    child: Name,
    origin: FileOrigin,
) -> FileJoint {
    FileJoint::weld(name, "fixed", [parent, child], origin)
}

/// Data from which one axis of an SDF joint is read.
struct AxisSource<'n> {
    node: Node<'n>,
    named: &'n Name,
    axis: Option<Node<'n>>,
    word: &'static str,
    kind: JointKind,
}

impl AxisSource<'_> {
    /// Reads the joint of this axis. Parent, child and origin are placeholders, which the caller sets.
    fn read_axis_joint(
        &self,
        (at, inner): (&NumericPose, &NumericPose),
        scope: &Scope,
        frames: &Frames,
        options: &FileOptions,
        robot: &mut Robot,
        cx: &mut Cx<'_>,
    ) -> Option<FileJoint> {
        let AxisSource { node, named, word, kind, .. } = *self;
        let own = element_source_position(node, cx);
        let bare = fixed_joint_between_links(
            named.clone(),
            named.clone(),
            named.clone(),
            origin_from_pose(&NumericPose::ZERO, &own),
        );
        let mut joint = FileJoint { kind, word, ..bare };
        let Some(axis) = self.axis.filter(|_| has_axis(kind)) else {
            if has_axis(kind) {
                cx.report_error(&own, format!("a `{word}` joint without an axis"), |d| {
                    d.add_help("expected `<axis><xyz>…</xyz></axis>`")
                });
            }
            return Some(joint);
        };
        let parts = ["xyz", "limit", "dynamics", "mimic", "use_parent_model_frame", "initial_position"];
        let [xyz, limit, dynamics, mimic, old, _] = child_for_each_name(axis, parts, cx);
        [Some(axis), limit, dynamics]
            .into_iter()
            .flatten()
            .for_each(|node| check_attributes_of_value_element(node, &[], cx));
        misplaced::report_misplaced_contents(axis, &parts, AXIS_HELP, cx);
        let of_model =
            Name { text: scope.full_name_of_scope_frame(), place: element_source_position(axis, cx) };
        let usual = if is_expressed_in_model_axes(axis, old, cx) {
            frames.resolve_world_pose(&of_model, cx)?
        } else {
            *at
        };
        joint.axis = read_axis(xyz, axis, (&usual, inner), scope, frames, cx)?;
        if let Some(dynamics) = dynamics.filter(|_| options.honour_passive) {
            read_dynamics(dynamics, &mut joint, robot, cx);
        }
        if let Some(limit) = limit.filter(|_| options.limits != LimitOption::Ignore) {
            joint.limits = read_limits(limit, word == "continuous", cx);
        }
        if !has_single_coordinate(kind) && joint.limits.has_limits() {
            robot.left_out.push(format!("limits of {}, which is `{word}`", named.text));
            joint.limits = FileLimits::default();
        }
        if let Some(mimic) = mimic.filter(|_| options.follow_mimic) {
            joint.mimic = read_mimic(mimic, scope, cx);
        }
        Some(joint)
    }
}

/// Returns true if an axis is expressed in the axes of the model: by default in old versions, otherwise if
/// `<use_parent_model_frame>` is true.
fn is_expressed_in_model_axes(axis: Node<'_>, old: Option<Node<'_>>, cx: &mut Cx<'_>) -> bool {
    let Some(old) = old else { return is_before_version(axis, IN_JOINT) };
    let is_said = read_trimmed_content(old, cx)
        .is_some_and(|word| matches!(&*word.text.to_ascii_lowercase(), "true" | "1"));
    if is_said && !is_before_version(axis, EXPRESSED_IN) {
        let message = "`<use_parent_model_frame>` has another name since version 1.7 of SDF";
        cx.report_error(&element_source_position(old, cx), message, |d| {
            d.add_help("write `<xyz expressed_in=\"__model__\">`")
        });
    }
    is_said
}

/// Reads an axis and returns it in the axes of the child. The default is z. The axis is expressed in the axes
/// of `usual` unless `expressed_in` names another frame.
fn read_axis(
    xyz: Option<Node<'_>>,
    axis: Node<'_>,
    (usual, inner): (&NumericPose, &NumericPose),
    scope: &Scope,
    frames: &Frames,
    cx: &mut Cx<'_>,
) -> Option<Located<Vector>> {
    let found = match xyz {
        Some(xyz) => read_numbers_content::<3>(xyz, cx)?,
        None => Located { value: [0.0, 0.0, 1.0], place: element_source_position(axis, cx) },
    };
    if vector_norm(found.value) < 1e-14 {
        cx.report_error(&found.place, "axis of zero length has no direction", |d| d);
        return None;
    }
    xyz.into_iter().for_each(|xyz| report_missing_or_misspelt_attributes(xyz, &[], &["expressed_in"], cx));
    let said = xyz.and_then(|xyz| xyz.attribute_node("expressed_in"));
    let axes = match said.filter(|said| !said.value().trim().is_empty()) {
        Some(said) => {
            let text = scope.full_name(said.value().trim());
            frames
                .resolve_world_pose(&Name { text, place: cx.source_position(said.range_value().start) }, cx)?
        }
        None => *usual,
    };
    let value = matrix_times_vector(&inner.inverse_pose().compose_with(&axes).axes, found.value);
    Some(Located { value: value.map(|x| if x.abs() < 1e-15 { 0.0 } else { x }), place: found.place })
}

fn read_dynamics(node: Node<'_>, joint: &mut FileJoint, robot: &mut Robot, cx: &mut Cx<'_>) {
    let parts = ["damping", "friction", "spring_stiffness", "spring_reference"];
    let found = child_for_each_name(node, parts, cx);
    misplaced::report_misplaced_contents(node, &parts, AXIS_HELP, cx);
    let [damping, friction, stiffness, free] =
        found.map(|part| part.and_then(|part| read_numbers_content::<1>(part, cx)));
    let alone = has_single_coordinate(joint.kind);
    for (which, found) in [("damping", &damping), ("friction", &friction), ("spring_stiffness", &stiffness)] {
        let Some(found) = found.as_ref().filter(|found| found.value != [0.0]) else { continue };
        if found.value[0] < 0.0 {
            let message = format!("negative {which} `{}`", found.value[0]);
            cx.report_error(&found.place, message, |d| d.add_help(IGNORE_PASSIVE));
        } else if !alone {
            let message = format!("`{which}` of a `{}` joint is not supported", joint.word);
            cx.report_error(&found.place, message, |d| d.add_help(IGNORE_PASSIVE));
        }
    }
    let nonzero_expression = |found: Option<Located<[f64; 1]>>| {
        let found = found.filter(|found| found.value != [0.0])?;
        Some(Expr::number_at(found.value[0], &found.place))
    };
    (joint.damping, joint.friction) = (nonzero_expression(damping), nonzero_expression(friction));
    if let Some(stiffness) = stiffness.filter(|stiffness| stiffness.value != [0.0]) {
        let law = FileForceLaw::Spring {
            stiffness: stiffness.value[0],
            free: free.map_or(0.0, |free| free.value[0]),
        };
        robot.drives.push(FileForceElement {
            name: joint.name.clone(),
            on: FileForceTarget::Sum(vec![(joint.name.clone(), 1.0)]),
            law,
        });
    }
}

fn read_limits(node: Node<'_>, continuous: bool, cx: &mut Cx<'_>) -> FileLimits {
    let found = child_for_each_name(node, ["lower", "upper", "velocity", "effort"], cx);
    misplaced::report_misplaced_contents(
        node,
        &["lower", "upper", "velocity", "effort", "stiffness"],
        AXIS_HELP,
        cx,
    );
    let is_infinite_limit = |part: Node<'_>, cx: &Cx<'_>| {
        read_trimmed_content(part, cx)
            .is_some_and(|word| word.text.trim_start_matches(['-', '+']).starts_with("inf"))
    };
    let mut read_finite_limit = |part: Option<Node<'_>>| {
        let part = part.filter(|part| !is_infinite_limit(*part, cx))?;
        let found = read_numbers_content::<1>(part, cx)?;
        Some(Located { value: found.value[0], place: found.place })
            .filter(|found| found.value.abs() < ENDLESS)
    };
    let [lower, upper, velocity, effort] = found.map(&mut read_finite_limit);
    let limit_unless_continuous = |end: Option<Located<f64>>| end.filter(|_| !continuous);
    // Negative limits mean that there is no limit.
    let nonnegative_limit = |size: Option<Located<f64>>| size.filter(|size| size.value >= 0.0);
    let limits = FileLimits {
        lower: limit_unless_continuous(lower),
        upper: limit_unless_continuous(upper),
        velocity: nonnegative_limit(velocity),
        effort: nonnegative_limit(effort),
    };
    if let (Some(low), Some(high)) = (&limits.lower, &limits.upper)
        && low.value > high.value
    {
        let message = format!("`lower` is {}, above `upper`, which is {}", low.value, high.value);
        cx.report_error(&low.place, message, |d| d.add_help(IGNORE_LIMITS));
    }
    limits
}

/// Reads `<mimic>`: `q = multiplier (q_leader − reference) + offset`.
fn read_mimic(node: Node<'_>, scope: &Scope, cx: &mut Cx<'_>) -> Option<MimicRelation> {
    report_missing_or_misspelt_attributes(node, &["joint"], &["axis"], cx);
    let mut leader = read_name_attribute(node, "joint", cx)?;
    leader.text = match node.attribute("axis") {
        Some("axis2") => format!("{}_2", scope.full_name(&leader.text)),
        _ => scope.full_name(&leader.text),
    };
    let found = child_for_each_name(node, ["multiplier", "offset", "reference"], cx);
    misplaced::report_misplaced_contents(node, &["multiplier", "offset", "reference"], AXIS_HELP, cx);
    let [multiplier, offset, reference] =
        found.map(|part| part.and_then(|part| read_numbers_content::<1>(part, cx)));
    let value_or_default =
        |found: Option<Located<[f64; 1]>>, usual: f64| found.map_or(usual, |found| found.value[0]);
    let multiplier = value_or_default(multiplier, 1.0);
    Some(MimicRelation {
        joint: leader,
        multiplier,
        offset: value_or_default(offset, 0.0) - multiplier * value_or_default(reference, 0.0),
    })
}
