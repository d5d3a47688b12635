//! Builder of the model: its state, its links and their motion.

use super::closed_form::ClosedFormLoop;
use super::contact::Surface;
use super::holders::MovingPlacement;
use super::reaction::ReleasedJoints;
use super::scope::{PlacedElement, PlacedElementKind, Scope};
use crate::diag::Diagnostics;
use crate::expr::Rotation;
use crate::kinematics::{CachedDerivatives, accelerations, joint_of_link, symbols_in, twists};
use crate::mechanism::{Inertia, Link, LinkId, Model, Motion, Pose, Quantity};
use crate::syntax::Name;

/// Builder of the model: places the elements of a description, and adds the parts that resolved elements
/// return.
pub struct Builder<'a, 'g> {
    /// Scope in which names of expressions are resolved.
    pub scope: Scope<'a, 'g>,
    /// Model of the mechanism that has been built so far.
    pub model: Model<'g>,
    /// Bodies, and particles without a position of their own, which can be children of joints.
    pub jointed: Vec<&'a Name>,
    /// Loops that are solved in closed form.
    pub solved_loops: Vec<ClosedFormLoop>,
    /// Joints that are released.
    pub release: Option<ReleasedJoints<'a, 'g>>,
    /// Bodies and particles placed by a moving `at` or `frame`.
    pub moving_placements: Vec<MovingPlacement>,
    /// Links of frames that move relative to the link in which they are defined.
    pub frame_links: Vec<LinkId>,
    /// Surfaces of contacts and of pairs that roll or slip, for the drawing, with the names of the contacts.
    pub surfaces: Vec<(String, Surface<'g>)>,
    /// Partial derivatives of the poses of the links so far.
    pub partials: CachedDerivatives<'g>,
    /// Index of the group of constraints that is being added.
    pub group: usize,
    /// Errors that depend on the motion, which are reported together with errors of units.
    pub mobility: Diagnostics,
}

/// Proof that the motion of all links is known, so that expressions with velocities can be read. Created only
/// by [`Builder::compute_link_motions`].
#[derive(Clone, Copy)]
pub struct ComputedMotionsProof(());

impl<'g> Builder<'_, 'g> {
    /// Returns the loop whose closed-form solution determines a joint's coordinate.
    pub fn loop_that_solves_joint(&self, j: usize) -> Option<&ClosedFormLoop> {
        self.solved_loops.iter().find(|e| e.sides.contains(&j))
    }

    /// Adds a massless link for a placement that moves, and returns the link. A constant placement is
    /// returned unchanged.
    pub fn add_link_if_moving(&mut self, link: Option<LinkId>, pose: Pose<'g>) -> (Option<LinkId>, Pose<'g>) {
        let moves = symbols_in(&pose.all_expressions())
            .into_iter()
            .any(|s| matches!(Quantity::from_symbol(s), Quantity::Configuration(_) | Quantity::Time));
        if !moves {
            return (link, pose);
        }
        let id = self.add_link(Link {
            parent: link,
            placement: pose,
            motion: Motion::Placed,
            inertia: Inertia::zero(self.scope.graph),
        });
        (Some(id), Pose::identity(self.scope.graph))
    }

    /// Adds a link and its kinematics to the model.
    pub fn add_link(&mut self, link: Link<'g>) -> LinkId {
        let kinematics = joint_of_link(self.model.configuration_space(), &link, &mut self.partials);
        self.scope.kinematics.joints.push(kinematics);
        self.model.links.push(link);
        LinkId(self.model.links.len() - 1)
    }

    /// Registers the placement of an element under its name.
    pub fn register_placement(
        &mut self,
        name: &str,
        link: Option<LinkId>,
        pose: Pose<'g>,
        kind: PlacedElementKind,
    ) {
        self.scope.kinematics.places.insert(name.to_string(), PlacedElement { link, pose, kind });
    }

    /// Records a joint whose reactions can be outputs. They are resolved in the axes of a frame on a link.
    pub fn record_joint_for_reactions(&mut self, j: usize, link: Option<LinkId>, rotation: &Rotation<'g>) {
        let name = self.scope.description.joints[j].name.text.clone();
        self.scope.kinematics.transmissions.insert(name, (j, link, rotation.clone()));
    }

    /// Computes twists and accelerations of the links, for expressions with velocities. Returns `None` if an
    /// element has not been placed.
    pub fn compute_link_motions(&mut self) -> Option<ComputedMotionsProof> {
        let places = &self.scope.kinematics.places;
        if !self.jointed.iter().all(|name| places.contains_key(&name.text)) {
            return None;
        }
        let g = self.scope.graph;
        self.scope.kinematics.charts.clone_from(&self.model.charts);
        let v: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Velocity(k).expr(g)).collect();
        let a: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Acceleration(k).expr(g)).collect();
        let kinematics = &mut self.scope.kinematics;
        kinematics.twists = twists(&self.model, &kinematics.joints, &v);
        kinematics.accelerations = accelerations(&self.model, &kinematics.joints, &kinematics.twists, &v, &a);
        Some(ComputedMotionsProof(()))
    }
}
