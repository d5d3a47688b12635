//! Builder of the checked model, with queries about elements resolved so far.

use super::joint::full_name;
use super::range::ValueRange;
use super::scope::{MassProperties, Placed, PlacedKind, Scope, Terms};
use crate::diag::{Diagnostics, Place};
use crate::expr::{self, Rotation, Vec3};
use crate::kinematics::{Partials, joint_of_link, symbols_in};
use crate::mechanism::{
    Constraint, Coordinate, InQ, InV, Inertia, Link, LinkId, Model, Motion, Pose, Quantity, Rule,
};
use crate::syntax::{Description, Endpoint, Expr, ExprKind, GROUND, Name};
use std::collections::BTreeMap;

/// Indices of the coordinates and velocities of a joint.
pub struct JointCoordinates {
    /// Index of the joint's first coordinate in `q`.
    pub q: InQ,
    /// Index of the joint's first velocity in `v`.
    pub v: InV,
    /// Coordinates that force elements can act on: name, coordinate, and whether it is an angle.
    pub plain: Vec<(String, Coordinate, bool)>,
}

/// A loop that is solved in closed form, with the joints that are solved for.
pub struct ClosedFormLoop {
    /// Index of the joint that closes the loop solved in closed form.
    pub closing: usize,
    /// Indices of the joints whose children are the parent and the child of the closing joint.
    pub sides: [usize; 2],
}

/// Index into the list of bodies and jointed particles.
pub type BodyIndex = usize;

/// Builder of the model, which resolves all elements of a description.
pub struct Builder<'a, 'g> {
    /// Scope in which names of expressions are resolved.
    pub scope: Scope<'a, 'g>,
    /// Model of the mechanism that has been built so far.
    pub model: Model<'g>,
    /// Description of the mechanism as the user wrote it.
    pub description: &'a Description,
    /// Bodies, and particles without a position of their own, which can be children of joints.
    pub jointed: Vec<&'a Name>,
    /// Link and pose of each body, once its placement is resolved.
    pub places: Vec<Option<(Option<LinkId>, Pose<'g>)>>,
    /// Names of all elements that have a position or axes.
    pub placeable: Vec<String>,
    /// Mass, centre of mass and central inertia of each body.
    pub masses: Vec<Option<MassProperties<'g>>>,
    /// Coordinates and velocities of each joint.
    pub coordinates: Vec<JointCoordinates>,
    /// Loops that are solved in closed form.
    pub solved_loops: Vec<ClosedFormLoop>,
    /// Joints to release, and the constraints that the mechanism with released joints keeps.
    pub releasing: Option<(&'a [usize], &'a [Constraint<'g>])>,
    /// Frame of each tree joint on its parent before the release, by index of the joint. Bodies placed by
    /// `at` and `frame` have their own frame in this map.
    pub joint_frames: BTreeMap<usize, Placed<'g>>,
    /// Name and generalized forces on the coordinates of released joints, for each force element, energy and
    /// dissipation.
    pub released_forces: Vec<(String, Vec<expr::Expr<'g>>)>,
    /// Bodies and particles placed by a moving `at` or `frame`: index among the releasable joints, and the
    /// link that carries them.
    pub moving_placements: Vec<(usize, Option<LinkId>)>,
    /// Links of frames that move relative to the link in which they are defined.
    pub frame_links: Vec<LinkId>,
    /// Contact point of each constraint of touching surfaces, by name, from the ground's origin.
    pub contact_points: BTreeMap<String, Terms<'g>>,
    /// Partial derivatives of the poses of the links so far.
    pub partials: Partials<'g>,
    /// Index of the group of constraints that is being added.
    pub group: usize,
    /// Errors that depend on the motion, which are reported together with errors of units.
    pub mobility: Diagnostics,
}

impl<'g> Builder<'_, 'g> {
    /// Returns the loop whose closed-form solution determines a joint's coordinate.
    pub fn solving_loop(&self, j: usize) -> Option<&ClosedFormLoop> {
        self.solved_loops.iter().find(|e| e.sides.contains(&j))
    }

    /// Returns the index of a body or jointed particle.
    pub fn jointed_index(&self, name: &str) -> Option<usize> {
        self.jointed.iter().position(|h| h.text == name)
    }

    /// Returns the coordinates of a joint that force elements can act on; `None` if the joint does not exist.
    pub fn joint_coordinates(&self, name: &str) -> Option<Vec<(String, Coordinate, bool)>> {
        let j = self.description.joints.iter().position(|j| j.name.text == name)?;
        Some(self.coordinates[j].plain.clone())
    }

    /// Whether an expression is the name of a coordinate that is an angle.
    pub fn is_angle(&self, e: &Expr) -> bool {
        let name = match &e.kind {
            ExprKind::Name(name) => name.clone(),
            ExprKind::Field(joint, member) => full_name(joint.as_name().unwrap_or_default(), &member.text),
            _ => return false,
        };
        let kinematics = &self.scope.kinematics;
        kinematics.coordinates.iter().any(|(known, _, angle)| *known == name && *angle)
    }

    /// Returns the names of all joints.
    pub fn joint_names(&self) -> Vec<String> {
        self.description.joints.iter().map(|j| j.name.text.clone()).collect()
    }

    /// Returns the frame of a joint on the body of one of its ends.
    pub fn frame_of_endpoint(&self, end: &Endpoint, cx: &mut Diagnostics) -> Option<Pose<'g>> {
        let translation = match &end.at {
            Some(at) => self.scope.own_vector(at, cx).filter(|v| {
                let range = ValueRange::of_scalar(&self.description.scalar);
                let describe_joint_position = || format!("the position of a joint on `{}`", end.body.text);
                v.0.iter().for_each(|c| {
                    self.scope.record_requirement(Rule::Length, describe_joint_position, &[*c])
                });
                v.0.iter().all(|c| range.check_length(*c, &at.place, cx))
            }),
            None => Some(Vec3::zero(self.scope.graph)),
        };
        let rotation = self.scope.resolve_rotation(&end.rotated, cx);
        Some(Pose { rotation: rotation?, translation: translation? })
    }

    /// Returns a substitute pose for an element with an error. Its generic values avoid follow-up errors.
    pub fn substitute_pose(&self, moves: bool) -> Pose<'g> {
        let g = self.scope.graph;
        let mut translation = Vec3::from_numbers(g, [0.731, 0.417, 0.593]);
        if moves {
            translation += Vec3::coordinate_axis(g, 0) * Quantity::Time.expr(g);
        }
        Pose { rotation: Rotation::identity(g), translation }
    }

    /// Adds a massless link for a placement that moves, and returns the link. A constant placement is
    /// returned unchanged.
    pub fn link_if_moving(&mut self, link: Option<LinkId>, pose: Pose<'g>) -> (Option<LinkId>, Pose<'g>) {
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
    pub fn register_placement(&mut self, name: &str, link: Option<LinkId>, pose: Pose<'g>, kind: PlacedKind) {
        self.scope.kinematics.places.insert(name.to_string(), Placed { link, pose, kind });
    }

    /// Returns the placement of the parent of a joint: a body or a point.
    pub fn joint_parent(&self, name: &Name, cx: &mut Diagnostics) -> Option<(Option<LinkId>, Pose<'g>)> {
        if name.text == GROUND {
            return Some((None, Pose::identity(self.scope.graph)));
        }
        let place: Place = name.place.clone();
        let e = Expr { kind: ExprKind::Name(name.text.clone()), place };
        self.scope.resolve_placement(&e, cx).map(|p| (p.link, p.pose))
    }
}
