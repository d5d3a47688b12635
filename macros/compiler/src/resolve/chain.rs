//! Links of joints, one link per elementary motion, and of placements that move.

use super::builder::Builder;
use super::closed_form::pose_across_solved_joint;
use super::elementary::ElementaryMotion;
use super::holders::is_fixed_in_frame;
use super::joint::{self, unscaled_coordinate};
use super::reaction::RELEASED;
use super::scope::{PlacedElement, PlacedElementKind, Scope};
use crate::diag::Diagnostics;
use crate::expr::Vec3;
use crate::mechanism::{CoulombFriction, Dashpot, Inertia, InputEffect, Link, LinkId, Motion, Pose, Rule};
use crate::syntax::Joint;

/// Resolves the arguments of a joint, only to report their errors.
pub fn report_joint_argument_errors(scope: &Scope<'_, '_>, joint: &Joint, cx: &mut Diagnostics) {
    let _ = scope.motions_of_joint(joint, cx);
    let _ = scope.frame_of_endpoint(&joint.parent, cx);
    let _ = scope.frame_of_endpoint(&joint.child, cx);
}

impl<'g> Builder<'_, 'g> {
    /// Places the child body of a joint.
    pub fn place_joint_child(&mut self, j: usize, child: usize, cx: &mut Diagnostics) {
        let joint = &self.scope.description.joints[j];
        let motions = self.scope.motions_of_joint(joint, cx);
        let (on_parent, on_child) =
            (self.scope.frame_of_endpoint(&joint.parent, cx), self.scope.frame_of_endpoint(&joint.child, cx));
        let start = self.scope.placement_of_joint_parent(&joint.parent.body, cx);
        // A joint with an error gets default motions, so that its dependents are checked as well.
        let motions = motions.unwrap_or_else(|| joint::placeholder_joint_motions(self.scope.graph, joint));
        let on_parent = on_parent.unwrap_or_else(|| self.scope.placeholder_pose(false));
        let on_child = on_child.unwrap_or_else(|| self.scope.placeholder_pose(false));
        if let Some((link, pose)) = start {
            let frame = pose.compose_with(&on_parent);
            self.record_joint_for_reactions(j, link, &frame.rotation);
            let (link, frame) = self.add_release_links(j, link, frame);
            let (link, pose) = match self.loop_that_solves_joint(j) {
                Some(solved) => {
                    let solved = pose_across_solved_joint(&self.scope, solved, j, cx)
                        .unwrap_or_else(|| self.scope.placeholder_pose(true));
                    self.add_link_if_moving(link, frame.compose_with(&solved))
                }
                None => self.add_links_of_motions(j, &motions, link, frame),
            };
            let pose = pose.compose_with(&on_child.inverse());
            let kind = if child < self.scope.description.bodies.len() {
                PlacedElementKind::Body
            } else {
                PlacedElementKind::Point
            };
            self.register_placement(&self.jointed[child].text, link, pose, kind);
        }
        self.add_joint_forces(j, joint, cx);
    }

    /// Adds one link for each motion. Returns the last link and the joint's child frame on it.
    fn add_links_of_motions(
        &mut self,
        j: usize,
        motions: &[ElementaryMotion<'g>],
        mut link: Option<LinkId>,
        mut pose: Pose<'g>,
    ) -> (Option<LinkId>, Pose<'g>) {
        let graph = self.scope.graph;
        for (k, motion) in motions.iter().enumerate() {
            let own = &self.scope.kinematics.joint_coordinates[j];
            let coordinate = own.plain.get(k).map_or(unscaled_coordinate(own.q, own.v), |(_, c, _)| *c);
            let (motion, aligned) = motion.motion_of_link(graph, coordinate, (own.q, own.v));
            let placement =
                Pose { rotation: pose.rotation.compose_with(&aligned), translation: pose.translation };
            link =
                Some(self.add_link(Link { parent: link, placement, motion, inertia: Inertia::zero(graph) }));
            pose = Pose { rotation: aligned.inverse(), translation: Vec3::zero(graph) };
        }
        (link, pose)
    }

    /// Adds damping, friction and the motor of a joint with one degree of freedom to the model.
    fn add_joint_forces(&mut self, j: usize, joint: &Joint, cx: &mut Diagnostics) {
        let [(name, coordinate, _)] = self.scope.kinematics.joint_coordinates[j].plain.as_slice() else {
            return;
        };
        let (name, coordinate) = (name.clone(), *coordinate);
        let damping = joint.damping.as_ref().and_then(|e| self.scope.resolve_scalar(e, cx));
        let friction = joint.friction.as_ref().and_then(|e| self.scope.resolve_scalar(e, cx));
        for (value, what) in [(damping, "damping"), (friction, "friction")] {
            let describe_quantity = || format!("the {what} of `{}`", joint.name.text);
            value.iter().for_each(|value| {
                self.scope.record_parameter_condition(Rule::NotNegative, describe_quantity, &[*value])
            });
        }
        self.model.dashpots.extend(damping.map(|damping| Dashpot { on: coordinate, damping }));
        self.model.frictions.extend(friction.map(|friction| CoulombFriction { on: coordinate, friction }));
        if joint.driven && joint.mimic.is_none() {
            self.model.inputs.push((name, InputEffect::Coordinate(coordinate)));
        }
    }

    /// Returns the link of a placed body or particle, with a new link if its placement moves. If the
    /// placement is released, returns the last of six further links.
    pub fn add_links_of_placed_element(
        &mut self,
        number: usize,
        carrier: Option<LinkId>,
        pose: Pose<'g>,
    ) -> (Option<LinkId>, Pose<'g>) {
        let (mut link, mut pose) = self.add_link_if_moving(carrier, pose);
        let mut holder = carrier;
        if link == carrier {
            let frame = carrier.filter(|link| {
                self.frame_links.contains(link) && is_fixed_in_frame(self.scope.description, number)
            });
            let Some(frame) = frame else { return (link, pose) };
            // The link that carries the frame is the holder; other bodies on the frame have connections of
            // their own.
            holder = self.model.links.get(frame.0).and_then(|frame| frame.parent);
            let (motion, inertia) = (Motion::Placed, Inertia::zero(self.scope.graph));
            link = Some(self.add_link(Link { parent: Some(frame), placement: pose, motion, inertia }));
            pose = Pose::identity(self.scope.graph);
        }
        self.moving_placements.push((number, holder));
        self.add_release_links(number, link, pose)
    }

    /// Returns the frame of a connection on its parent. If the connection is released, the frame is moved by
    /// the six coordinates of the release.
    fn add_release_links(
        &mut self,
        number: usize,
        mut link: Option<LinkId>,
        mut pose: Pose<'g>,
    ) -> (Option<LinkId>, Pose<'g>) {
        let Some((release, (q, v))) = self.release.as_mut().zip(self.scope.kinematics.first_released) else {
            return (link, pose);
        };
        let Some(index) = release.index_of_released_joint(number) else { return (link, pose) };
        release
            .frames
            .insert(number, PlacedElement { link, pose: pose.clone(), kind: PlacedElementKind::Body });
        let g = self.scope.graph;
        let (q, v) = (q + RELEASED * index, v + RELEASED * index);
        for k in 0..RELEASED {
            let (axis, coordinate) = (Vec3::coordinate_axis(g, k % 3), unscaled_coordinate(q + k, v + k));
            let motion = match k {
                0..3 => Motion::Slide { axis, coordinate },
                _ => Motion::Turn { axis, coordinate },
            };
            let inertia = Inertia::zero(g);
            link = Some(self.add_link(Link { parent: link, placement: pose, motion, inertia }));
            pose = Pose::identity(g);
        }
        (link, pose)
    }
}
