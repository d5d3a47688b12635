//! Conversion of joints to chains of links, one link per elementary motion.

use super::builder::Builder;
use super::elementary::Elementary;
use super::joint::{self, own_coordinate};
use super::scope::{Placed, PlacedKind};
use crate::diag::Diagnostics;
use crate::expr::Vec3;
use crate::mechanism::{CoulombFriction, Dashpot, Inertia, Input, Link, LinkId, Pose, Rule};
use crate::syntax::Joint;

impl<'g> Builder<'_, 'g> {
    /// Resolves the arguments of all joints although the tree is broken, to report all errors at once.
    pub fn check_joints(&self, cx: &mut Diagnostics) {
        for joint in &self.description.joints {
            self.check_joint(joint, cx);
        }
    }

    /// Resolves the arguments of a joint, only to report their errors.
    pub fn check_joint(&self, joint: &Joint, cx: &mut Diagnostics) {
        let _ = self.scope.motions_of_joint(joint, cx);
        let _ = self.frame_of_endpoint(&joint.parent, cx);
        let _ = self.frame_of_endpoint(&joint.child, cx);
    }

    /// Places the child body of a joint relative to its parent.
    pub fn place_joint(&mut self, j: usize, child: usize, cx: &mut Diagnostics) {
        let joint = &self.description.joints[j];
        let motions = self.scope.motions_of_joint(joint, cx);
        let (on_parent, on_child) =
            (self.frame_of_endpoint(&joint.parent, cx), self.frame_of_endpoint(&joint.child, cx));
        let start = self.joint_parent(&joint.parent.body, cx);
        // A joint with an error gets default motions, so that its dependents are checked as well.
        let motions = motions.unwrap_or_else(|| joint::default_motions(self.scope.graph, joint));
        let on_parent = on_parent.unwrap_or_else(|| self.substitute_pose(false));
        let on_child = on_child.unwrap_or_else(|| self.substitute_pose(false));
        if let Some((link, pose)) = start {
            let frame = pose.compose_with(&on_parent);
            self.record_transmission(j, link, &frame.rotation);
            let placed = Placed { link, pose: frame.clone(), kind: PlacedKind::Body };
            self.joint_frames.insert(j, placed);
            let (joints, _) = self.releasing.unwrap_or_default();
            let (link, frame) = match joints.iter().position(|open| *open == j) {
                Some(index) => self.released_joint_frame(index, joints.len(), link, frame),
                None => (link, frame),
            };
            let (link, pose) = match self.solving_loop(j) {
                Some(_) => {
                    let solved = self.solved_pose(j, cx).unwrap_or_else(|| self.substitute_pose(true));
                    self.link_if_moving(link, frame.compose_with(&solved))
                }
                None => self.add_chain(j, &motions, link, frame),
            };
            let pose = pose.compose_with(&on_child.inverse());
            let kind =
                if child < self.description.bodies.len() { PlacedKind::Body } else { PlacedKind::Point };
            self.register_placement(&self.jointed[child].text, link, pose.clone(), kind);
            self.places[child] = Some((link, pose));
        }
        self.add_passive(j, joint, cx);
    }

    /// Adds one link for each motion. Returns the last link and the joint's child frame on it.
    fn add_chain(
        &mut self,
        j: usize,
        motions: &[Elementary<'g>],
        mut link: Option<LinkId>,
        mut pose: Pose<'g>,
    ) -> (Option<LinkId>, Pose<'g>) {
        let graph = self.scope.graph;
        for (k, motion) in motions.iter().enumerate() {
            let own = &self.coordinates[j];
            let coordinate = own.plain.get(k).map_or(own_coordinate(own.q, own.v), |(_, c, _)| *c);
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
    fn add_passive(&mut self, j: usize, joint: &Joint, cx: &mut Diagnostics) {
        let [(name, coordinate, _)] = self.coordinates[j].plain.as_slice() else {
            return;
        };
        let (name, coordinate) = (name.clone(), *coordinate);
        let damping = joint.damping.as_ref().and_then(|e| self.scope.resolve_scalar(e, cx));
        let friction = joint.friction.as_ref().and_then(|e| self.scope.resolve_scalar(e, cx));
        for (value, what) in [(damping, "damping"), (friction, "friction")] {
            let describe_quantity = || format!("the {what} of `{}`", joint.name.text);
            value.iter().for_each(|value| {
                self.scope.record_requirement(Rule::NotNegative, describe_quantity, &[*value])
            });
        }
        self.model.dashpots.extend(damping.map(|damping| Dashpot { on: coordinate, damping }));
        self.model.frictions.extend(friction.map(|friction| CoulombFriction { on: coordinate, friction }));
        if joint.driven && joint.mimic.is_none() {
            self.model.inputs.push((name, Input::Coordinate(coordinate)));
        }
    }

    /// Returns whether every body has been placed.
    pub fn is_placed(&self) -> bool {
        self.places.iter().all(Option::is_some)
    }
}
