//! Constraint rows of joints that close loops.

use super::builder::Builder;
use super::elementary::Elementary;
use super::scope::{Placed, PlacedKind};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Rotation, Vec3};
use crate::kinematics::jet::{Jet, Moving, Relative};
use crate::kinematics::{AXES, change_axes, normalised_or_zero, perpendicular_directions, time_derivative};
use crate::mechanism::{Constraint, Measure, Transmission};

/// Joint that closes a loop: its two ends with their motions.
struct ClosingJoint<'g> {
    j: usize,
    parent: Placed<'g>,
    child: Placed<'g>,
    on_parent: Relative<'g>,
    on_child: Relative<'g>,
}

impl<'g> Builder<'_, 'g> {
    /// Returns the elementary motions of a loop-closing joint, and its two ends.
    fn closing_joint(
        &self,
        j: usize,
        cx: &mut Diagnostics,
    ) -> Option<(Vec<Elementary<'g>>, ClosingJoint<'g>)> {
        let joint = &self.description.joints[j];
        let motions = self.scope.motions_of_joint(joint, cx);
        let [parent, child] = [&joint.parent, &joint.child].map(|end| {
            let on_body = self.frame_of_endpoint(end, cx)?;
            let (link, pose) = self.joint_parent(&end.body, cx)?;
            Some(Placed { link, pose: pose.compose_with(&on_body), kind: PlacedKind::Body })
        });
        let (parent, child) = (parent?, child?);
        let on_parent = self.relative_motion(parent.link, child.link);
        let on_child = self.relative_motion(child.link, parent.link);
        Some((motions?, ClosingJoint { j, parent, child, on_parent, on_child }))
    }

    /// Adds the rows of a loop that is solved in closed form. Its Pin keeps both ends together in the plane
    /// of the loop.
    pub fn close_in_plane(&mut self, j: usize, cx: &mut Diagnostics) {
        self.group += 1;
        if let Some((motions, ends)) = self.closing_joint(j, cx)
            && let [Elementary::Turn(axis)] = motions.as_slice()
        {
            self.translation_rows(&ends, &[Elementary::Slide(*axis)]);
        }
    }

    /// Adds the rows of a joint that closes a loop.
    pub fn close_loop(&mut self, j: usize, cx: &mut Diagnostics) {
        let joint = &self.description.joints[j];
        let Some((motions, ends)) = self.closing_joint(j, cx) else { return };
        let place = &joint.name.place;
        if matches!(motions.as_slice(), [Elementary::Free]) {
            cx.report_error(
                place.clone(),
                format!("`{}` closes a loop, but constrains no motion", joint.name.text),
            )
            .add_help("remove it: a Free joint allows all motions");
            return;
        }
        if ends.parent.link == ends.child.link {
            cx.report_error(place.clone(), "these two ends do not move relative to each other")
                .add_help("let the joint act between bodies that move relative to each other");
            return;
        }
        self.record_transmission(j, None, &Rotation::identity(self.scope.graph));
        self.translation_rows(&ends, &motions);
        self.group += 1;
        self.rotation_rows(&ends, &motions);
    }

    /// Adds rows that keep the origin of the child's joint frame in the directions in which the joint slides.
    fn translation_rows(&mut self, ends: &ClosingJoint<'g>, motions: &[Elementary<'g>]) {
        let g = self.scope.graph;
        let slides: Vec<Vec3<'g>> = motions.iter().filter_map(Elementary::translation_axis).collect();
        let ClosingJoint { parent, child, on_parent, on_child, .. } = ends;
        let origin = self.motion_of_point(on_parent, parent.pose.translation);
        let gap = self.motion_of_point(on_child, child.pose.translation).minus(&origin);
        if slides.is_empty() {
            for (k, word) in AXES.iter().enumerate() {
                self.push_row(ends, word, gap.component(k), (Measure::Length, Vec3::coordinate_axis(g, k)));
            }
            return;
        }
        let across: Vec<(&str, Vec3<'g>)> = match slides.as_slice() {
            [one] => perpendicular_directions(*one).to_vec(),
            [first, second] => vec![("normal", normalised_or_zero(first.cross(*second)))],
            _ => Vec::new(),
        };
        for (word, direction) in across {
            let e = self.motion_of_direction(on_parent, parent.pose.rotation.to_parent(direction));
            self.push_row(ends, word, gap.dot(&e), (Measure::Length, e.value));
        }
        for motion in motions {
            match motion {
                Elementary::Helix(axis, pitch) => self.advance_row(ends, (*axis, *pitch), gap.value),
                // The rows of the other motions are those of the slides and rotations.
                Elementary::Turn(_) | Elementary::Slide(_) | Elementary::Ball | Elementary::Free => {}
            }
        }
    }

    /// Adds the row of a screw joint that couples the child's advance along the axis to its rotation. `gap`
    /// leads from the parent's joint frame to the child's.
    fn advance_row(&mut self, ends: &ClosingJoint<'g>, (axis, pitch): (Vec3<'g>, Expr<'g>), gap: Vec3<'g>) {
        let ClosingJoint { parent, child, on_parent, on_child, .. } = ends;
        let n = self.motion_of_direction(on_parent, parent.pose.rotation.to_parent(axis)).value;
        let [(_, first), (_, second)] = perpendicular_directions(axis);
        let parent_direction =
            |v| self.motion_of_direction(on_parent, parent.pose.rotation.to_parent(v)).value;
        let rotated = self.motion_of_direction(on_child, child.pose.rotation.to_parent(first)).value;
        let (sine, cosine) = (parent_direction(second).dot(rotated), parent_direction(first).dot(rotated));
        let advance = gap.dot(n) / pitch;
        let value = pitch * (sine * advance.cos() - cosine * advance.sin());
        let rate = time_derivative(self.model.configuration_space(), value);
        let second = time_derivative(self.model.configuration_space(), rate);
        // The force pushes the child back along the axis; the torque rotates it by the pitch.
        self.push_row(ends, "advance", Jet { value, rate, second }, (Measure::Length, -n));
        let rotated = self.transmission_along(ends, true, n * pitch);
        self.model.constraints.last_mut().iter_mut().for_each(|c| c.transmits.push(rotated));
    }

    /// Adds rows that allow only the rotations of the joint between the axes of its two ends.
    fn rotation_rows(&mut self, ends: &ClosingJoint<'g>, motions: &[Elementary<'g>]) {
        if matches!(motions, [Elementary::Ball]) {
            return;
        }
        let turns: Vec<Vec3<'g>> = motions.iter().filter_map(Elementary::rotation_axis).collect();
        let ClosingJoint { parent, child, on_parent, on_child, .. } = ends;
        let parent_direction = |v| self.motion_of_direction(on_parent, parent.pose.rotation.to_parent(v));
        let child_direction = |v| self.motion_of_direction(on_child, child.pose.rotation.to_parent(v));
        let coordinate_axis = |k| Vec3::coordinate_axis(self.scope.graph, k);
        // Directions of the parent and of the child that remain orthogonal, or at a constant angle.
        let rows: Vec<(String, Moving<'g>, Moving<'g>, Expr<'g>)> = match turns.as_slice() {
            // Sines of the angles about three axes.
            [] => (0..3)
                .map(|k| {
                    let (l, m) = ((k + 1) % 3, (k + 2) % 3);
                    (
                        format!("w{}", AXES[k]),
                        parent_direction(coordinate_axis(m)),
                        child_direction(coordinate_axis(l)),
                        self.scope.graph.zero(),
                    )
                })
                .collect(),
            [coordinate_axis] => perpendicular_directions(*coordinate_axis)
                .into_iter()
                .map(|(word, e)| {
                    (
                        format!("tilt_{word}"),
                        parent_direction(e),
                        child_direction(*coordinate_axis),
                        self.scope.graph.zero(),
                    )
                })
                .collect(),
            [first, second, ..] => {
                vec![(
                    "axes".to_string(),
                    parent_direction(*first),
                    child_direction(*second),
                    first.dot(*second),
                )]
            }
        };
        for (word, e, carried, angle) in rows {
            let mut jet = e.dot(&carried);
            jet.value -= angle;
            self.push_row(ends, &word, jet, (Measure::Angle, carried.value.cross(e.value)));
        }
    }

    /// Adds a row of a joint. Its multiplier is a force (of a length) or a torque (of an angle) on the child
    /// along `direction`, in the axes of the link that carries both ends.
    fn push_row(
        &mut self,
        ends: &ClosingJoint<'g>,
        word: &str,
        jet: Jet<'g>,
        (measure, direction): (Measure, Vec3<'g>),
    ) {
        let joint = &self.description.joints[ends.j].name;
        let Jet { value, rate, second } = jet;
        let transmits = self.transmission_along(ends, measure == Measure::Angle, direction);
        self.model.constraints.push(Constraint {
            name: format!("{}.{word}", joint.text),
            place: joint.place.clone(),
            residual: Some(value),
            rate,
            bias: second,
            measure,
            transmits: vec![transmits],
            group: self.group,
            determines: false,
            friction: Vec::new(),
        });
    }

    fn transmission_along(
        &self,
        ends: &ClosingJoint<'g>,
        torque: bool,
        direction: Vec3<'g>,
    ) -> Transmission<'g> {
        let joints = &self.scope.kinematics.joints;
        let direction = change_axes(joints, direction, ends.on_child.ancestor, None);
        Transmission { joint: ends.j, torque, direction }
    }
}
