//! Constraint rows of joints that close loops.

use super::elementary::ElementaryMotion;
use super::rows::ConstraintRows;
use super::scope::{PlacedElement, PlacedElementKind, Scope};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::kinematics::jet::{self, Jet, MovingVector, RelativeLinkMotion};
use crate::kinematics::{
    AXES, express_in_link_axes, normalised_or_zero, perpendicular_directions, time_derivative,
};
use crate::mechanism::{Constraint, MeasuredQuantity, Model, ReactionComponent};

/// Returns the rows of a loop that is solved in closed form. Its Pin keeps both ends together in the plane of
/// the loop.
pub fn planar_loop_rows<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    j: usize,
    cx: &mut Diagnostics,
) -> Option<ConstraintRows<'g>> {
    let (motions, ends) = resolve_closing_joint(scope, model, j, cx)?;
    let [ElementaryMotion::Turn(axis)] = motions.as_slice() else { return None };
    let rows = ends.translation_rows(&[ElementaryMotion::Slide(*axis)]);
    Some(ConstraintRows { rows, ..ConstraintRows::default() })
}

/// Returns the rows of a joint that closes a loop; `None` after an error.
pub fn loop_closure_rows<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    j: usize,
    cx: &mut Diagnostics,
) -> Option<ConstraintRows<'g>> {
    let joint = &scope.description.joints[j];
    let (motions, ends) = resolve_closing_joint(scope, model, j, cx)?;
    let place = &joint.name.place;
    if matches!(motions.as_slice(), [ElementaryMotion::Free]) {
        cx.report_error(
            place.clone(),
            format!("`{}` closes a loop, but constrains no motion", joint.name.text),
        )
        .add_help("remove it: a Free joint allows all motions");
        return None;
    }
    if ends.parent.link == ends.child.link {
        cx.report_error(place.clone(), "these two ends do not move relative to each other")
            .add_help("let the joint act between bodies that move relative to each other");
        return None;
    }
    let mut rows = ends.translation_rows(&motions);
    rows.extend(ends.rotation_rows(&motions).into_iter().map(|row| Constraint { group: 1, ..row }));
    Some(ConstraintRows { rows, ..ConstraintRows::default() })
}

/// Returns the elementary motions of a loop-closing joint, and its two ends.
fn resolve_closing_joint<'s, 'a, 'g>(
    scope: &'s Scope<'a, 'g>,
    model: &Model<'g>,
    j: usize,
    cx: &mut Diagnostics,
) -> Option<(Vec<ElementaryMotion<'g>>, ClosingJoint<'s, 'a, 'g>)> {
    let joint = &scope.description.joints[j];
    let motions = scope.motions_of_joint(joint, cx);
    let [parent, child] = [&joint.parent, &joint.child].map(|end| {
        let on_body = scope.frame_of_endpoint(end, cx)?;
        let (link, pose) = scope.placement_of_joint_parent(&end.body, cx)?;
        Some(PlacedElement { link, pose: pose.compose_with(&on_body), kind: PlacedElementKind::Body })
    });
    let (parent, child) = (parent?, child?);
    let joints = &scope.kinematics.joints;
    let on_parent = jet::relative_motion(model, joints, parent.link, child.link);
    let on_child = jet::relative_motion(model, joints, child.link, parent.link);
    Some((motions?, ClosingJoint { scope, j, parent, child, on_parent, on_child }))
}

/// Joint that closes a loop: its two ends with their motions.
struct ClosingJoint<'s, 'a, 'g> {
    scope: &'s Scope<'a, 'g>,
    j: usize,
    parent: PlacedElement<'g>,
    child: PlacedElement<'g>,
    on_parent: RelativeLinkMotion<'g>,
    on_child: RelativeLinkMotion<'g>,
}

impl<'g> ClosingJoint<'_, '_, 'g> {
    /// Returns a direction that is fixed in the parent, with its derivatives, in the common axes.
    fn direction_fixed_in_parent(&self, v: Vec3<'g>) -> MovingVector<'g> {
        let joints = &self.scope.kinematics.joints;
        jet::motion_of_direction(joints, &self.on_parent, self.parent.pose.rotation.vector_in_parent_axes(v))
    }

    /// Returns a direction that is fixed in the child, with its derivatives, in the common axes.
    fn direction_fixed_in_child(&self, v: Vec3<'g>) -> MovingVector<'g> {
        let joints = &self.scope.kinematics.joints;
        jet::motion_of_direction(joints, &self.on_child, self.child.pose.rotation.vector_in_parent_axes(v))
    }

    /// Returns rows that keep the origin of the child's joint frame in the directions in which the joint
    /// slides.
    fn translation_rows(&self, motions: &[ElementaryMotion<'g>]) -> Vec<Constraint<'g>> {
        let (g, joints) = (self.scope.graph, &self.scope.kinematics.joints);
        let slides: Vec<Vec3<'g>> = motions.iter().filter_map(ElementaryMotion::translation_axis).collect();
        let origin = jet::motion_of_point(joints, &self.on_parent, self.parent.pose.translation);
        let gap = jet::motion_of_point(joints, &self.on_child, self.child.pose.translation).minus(&origin);
        if slides.is_empty() {
            let row_along_axis = |k| {
                self.joint_constraint_row(
                    AXES[k],
                    gap.component(k),
                    (MeasuredQuantity::Length, Vec3::coordinate_axis(g, k)),
                )
            };
            return (0..3).map(row_along_axis).collect();
        }
        let across: Vec<(&str, Vec3<'g>)> = match slides.as_slice() {
            [one] => perpendicular_directions(*one).to_vec(),
            [first, second] => vec![("normal", normalised_or_zero(first.cross(*second)))],
            _ => Vec::new(),
        };
        let mut rows = Vec::new();
        for (word, direction) in across {
            let e = self.direction_fixed_in_parent(direction);
            rows.push(self.joint_constraint_row(word, gap.dot(&e), (MeasuredQuantity::Length, e.value)));
        }
        for motion in motions {
            match motion {
                ElementaryMotion::Helix(axis, pitch) => rows.push(self.screw_row((*axis, *pitch), gap.value)),
                // The rows of the other motions are those of the slides and rotations.
                ElementaryMotion::Turn(_)
                | ElementaryMotion::Slide(_)
                | ElementaryMotion::Ball
                | ElementaryMotion::Free => {}
            }
        }
        rows
    }

    /// Returns the row of a screw joint that couples the child's advance along the axis to its rotation.
    /// `gap` leads from the parent's joint frame to the child's.
    fn screw_row(&self, (axis, pitch): (Vec3<'g>, Expr<'g>), gap: Vec3<'g>) -> Constraint<'g> {
        let n = self.direction_fixed_in_parent(axis).value;
        let [(_, first), (_, second)] = perpendicular_directions(axis);
        let parent_direction_in_common_axes = |v| self.direction_fixed_in_parent(v).value;
        let rotated = self.direction_fixed_in_child(first).value;
        let (sine, cosine) = (
            parent_direction_in_common_axes(second).dot(rotated),
            parent_direction_in_common_axes(first).dot(rotated),
        );
        let advance = gap.dot(n) / pitch;
        let value = pitch * (sine * advance.cos() - cosine * advance.sin());
        let rate = time_derivative(self.scope.configuration_space(), value);
        let second = time_derivative(self.scope.configuration_space(), rate);
        // The force pushes the child back along the axis; the torque rotates it by the pitch.
        let mut row =
            self.joint_constraint_row("advance", Jet { value, rate, second }, (MeasuredQuantity::Length, -n));
        row.transmits.push(self.reaction_component_along_direction(true, n * pitch));
        row
    }

    /// Returns rows that allow only the rotations of the joint between the axes of its two ends.
    fn rotation_rows(&self, motions: &[ElementaryMotion<'g>]) -> Vec<Constraint<'g>> {
        if matches!(motions, [ElementaryMotion::Ball]) {
            return Vec::new();
        }
        let turns: Vec<Vec3<'g>> = motions.iter().filter_map(ElementaryMotion::rotation_axis).collect();
        let coordinate_axis = |k| Vec3::coordinate_axis(self.scope.graph, k);
        // Directions of the parent and of the child that remain orthogonal, or at a constant angle.
        let rows: Vec<(String, MovingVector<'g>, MovingVector<'g>, Expr<'g>)> = match turns.as_slice() {
            // Sines of the angles about three axes.
            [] => (0..3)
                .map(|k| {
                    let (l, m) = ((k + 1) % 3, (k + 2) % 3);
                    (
                        format!("w{}", AXES[k]),
                        self.direction_fixed_in_parent(coordinate_axis(m)),
                        self.direction_fixed_in_child(coordinate_axis(l)),
                        self.scope.graph.zero(),
                    )
                })
                .collect(),
            [coordinate_axis] => perpendicular_directions(*coordinate_axis)
                .into_iter()
                .map(|(word, e)| {
                    (
                        format!("tilt_{word}"),
                        self.direction_fixed_in_parent(e),
                        self.direction_fixed_in_child(*coordinate_axis),
                        self.scope.graph.zero(),
                    )
                })
                .collect(),
            [first, second, ..] => {
                vec![(
                    "axes".to_string(),
                    self.direction_fixed_in_parent(*first),
                    self.direction_fixed_in_child(*second),
                    first.dot(*second),
                )]
            }
        };
        let direction_constraint_row =
            |(word, e, carried, angle): (String, MovingVector<'g>, MovingVector<'g>, Expr<'g>)| {
                let mut jet = e.dot(&carried);
                jet.value -= angle;
                self.joint_constraint_row(&word, jet, (MeasuredQuantity::Angle, carried.value.cross(e.value)))
            };
        rows.into_iter().map(direction_constraint_row).collect()
    }

    /// Returns a row of the joint. Its multiplier is a force (of a length) or a torque (of an angle) on the
    /// child along `direction`, in the axes of the link that carries both ends.
    fn joint_constraint_row(
        &self,
        word: &str,
        jet: Jet<'g>,
        (measure, direction): (MeasuredQuantity, Vec3<'g>),
    ) -> Constraint<'g> {
        let joint = &self.scope.description.joints[self.j].name;
        let Jet { value, rate, second } = jet;
        Constraint {
            name: format!("{}.{word}", joint.text),
            place: joint.place.clone(),
            residual: Some(value),
            rate,
            bias: second,
            measure,
            transmits: vec![
                self.reaction_component_along_direction(measure == MeasuredQuantity::Angle, direction),
            ],
            group: 0,
            determines: false,
            friction: Vec::new(),
        }
    }

    fn reaction_component_along_direction(&self, torque: bool, direction: Vec3<'g>) -> ReactionComponent<'g> {
        let joints = &self.scope.kinematics.joints;
        let direction = express_in_link_axes(joints, direction, self.on_child.ancestor, None);
        ReactionComponent { joint: self.j, torque, direction }
    }
}
