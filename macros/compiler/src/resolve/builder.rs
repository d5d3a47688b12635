//! The mechanism while it is put together, and what its parts ask of it.

use super::figures::Range;
use super::joint::full_name;
use super::scope::{MassProperties, Placed, PlacedKind, Scope, Terms};
use crate::diag::{Diagnostics, Place};
use crate::expr::{self, Rotation, Vec3};
use crate::kinematics::{Partials, joint, symbols_in};
use crate::mechanism::{
    Constraint, Coordinate, InQ, InV, Inertia, Link, LinkId, Model, Motion, Pose, Quantity, Rule,
};
use crate::syntax::{Description, Endpoint, Expr, ExprKind, GROUND, Name};
use std::collections::BTreeMap;

/// What is known of a joint once its coordinates are numbered.
pub struct JointCoordinates {
    /// First index in `q`.
    pub q: InQ,
    /// First index in `v`.
    pub v: InV,
    /// The coordinates that force elements can act on: name, coordinate, whether an angle.
    pub plain: Vec<(String, Coordinate, bool)>,
}

/// A loop with the joints that are solved for.
pub struct ClosedFormLoop {
    /// The joint that closes it.
    pub closing: usize,
    /// The joints that hold the parent and the child of it.
    pub sides: [usize; 2],
}

/// What a joint can hold: a body, or a particle without a place of its own.
pub struct JointedBody<'a> {
    /// Its name.
    pub name: &'a Name,
}

/// Index into bodies and jointed particles together.
pub type BodyIndex = usize;

/// The model under construction.
pub struct Builder<'a, 'g> {
    /// Where names are looked up.
    pub scope: Scope<'a, 'g>,
    /// What is built.
    pub model: Model<'g>,
    /// What the user wrote.
    pub description: &'a Description,
    /// Bodies and jointed particles.
    pub jointed: Vec<JointedBody<'a>>,
    /// Their placement, once known.
    pub places: Vec<Option<(Option<LinkId>, Pose<'g>)>>,
    /// Names of everything that has a place or axes.
    pub placeable: Vec<String>,
    /// By body: mass, centre of mass, central inertia.
    pub masses: Vec<Option<MassProperties<'g>>>,
    /// By joint.
    pub coordinates: Vec<JointCoordinates>,
    /// Loops that are solved in closed form.
    pub solved_loops: Vec<ClosedFormLoop>,
    /// Joints to be released, and the names of the constraints that a mechanism with released joints keeps.
    pub releasing: Option<(&'a [usize], &'a [Constraint<'g>])>,
    /// By joint of the tree its frame on the parent, and by body that is placed its own, before they are
    /// released.
    pub joint_frames: BTreeMap<usize, Placed<'g>>,
    /// By force element, energy and dissipation: its generalized forces on the coordinates of released
    /// joints.
    pub applied: Vec<(String, Vec<expr::Expr<'g>>)>,
    /// Bodies and particles that move by what `at` and `frame` say: number among what can be released, and
    /// what carries them.
    pub moved_by_place: Vec<(usize, Option<LinkId>)>,
    /// Links of frames that move with respect to what they start from.
    pub frame_links: Vec<LinkId>,
    /// By constraint of surfaces that touch at a point: where, from the ground's origin.
    pub touching: BTreeMap<String, Terms<'g>>,
    /// Derivatives of the places of the links so far.
    pub partials: Partials<'g>,
    /// Number of the group of constraints that is being added.
    pub group: usize,
    /// Mistakes that only the motion shows: they are told together with those of units.
    pub mobility: Diagnostics,
}

impl<'g> Builder<'_, 'g> {
    /// The loop that solves for a joint.
    pub fn solving_loop(&self, j: usize) -> Option<&ClosedFormLoop> {
        self.solved_loops.iter().find(|e| e.sides.contains(&j))
    }

    /// Index of a body or jointed particle.
    pub fn jointed_index(&self, name: &str) -> Option<usize> {
        self.jointed.iter().position(|h| h.name.text == name)
    }

    /// The coordinates of a joint that force elements can act on; `None` if there is no such joint.
    pub fn joint_coordinates(&self, name: &str) -> Option<Vec<(String, Coordinate, bool)>> {
        let j = self.description.joints.iter().position(|j| j.name.text == name)?;
        Some(self.coordinates[j].plain.clone())
    }

    /// True for the name of a coordinate that is an angle.
    pub fn is_angle(&self, e: &Expr) -> bool {
        let name = match &e.kind {
            ExprKind::Name(name) => name.clone(),
            ExprKind::Field(joint, member) => full_name(joint.name().unwrap_or_default(), &member.text),
            _ => return false,
        };
        let kinematics = self.scope.kinematics.borrow();
        kinematics.coordinates.iter().any(|(known, _, angle)| *known == name && *angle)
    }

    /// Names of all joints.
    pub fn joint_names(&self) -> Vec<String> {
        self.description.joints.iter().map(|j| j.name.text.clone()).collect()
    }

    /// The joint's frame on the body of one of its ends.
    pub fn endpoint(&self, end: &Endpoint, cx: &mut Diagnostics) -> Option<Pose<'g>> {
        let translation = match &end.at {
            Some(at) => self.scope.own_vector(at, cx).filter(|v| {
                let range = Range::of(&self.description.scalar);
                let place = || format!("the place of a joint on `{}`", end.body.text);
                v.0.iter().for_each(|c| self.scope.require(Rule::Length, place, &[*c]));
                v.0.iter().all(|c| range.check_length(*c, &at.place, cx))
            }),
            None => Some(Vec3::zero(self.scope.graph)),
        };
        let rotation = self.scope.rotation(&end.rotated, cx);
        Some(Pose { rotation: rotation?, translation: translation? })
    }

    /// A place for what has a mistake, with figures that nothing else has: where it should have been does not
    /// matter.
    pub fn somewhere(&self, moves: bool) -> Pose<'g> {
        let g = self.scope.graph;
        let mut translation = Vec3::numbers(g, [0.731, 0.417, 0.593]);
        if moves {
            translation += Vec3::axis(g, 0) * Quantity::Time.expr(g);
        }
        Pose { rotation: Rotation::identity(g), translation }
    }

    /// A placement that moves becomes a link without mass; one that is fixed stays as it is.
    pub fn link_if_moving(&mut self, link: Option<LinkId>, pose: Pose<'g>) -> (Option<LinkId>, Pose<'g>) {
        let moves = symbols_in(&pose.entries())
            .into_iter()
            .any(|s| matches!(Quantity::of(s), Quantity::Configuration(_) | Quantity::Time));
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

    /// Adds a link and its kinematics.
    pub fn add_link(&mut self, link: Link<'g>) -> LinkId {
        let kinematics = joint(self.model.space(), &link, &mut self.partials);
        self.scope.kinematics.borrow_mut().joints.push(kinematics);
        self.model.links.push(link);
        LinkId(self.model.links.len() - 1)
    }

    /// Makes a place known by its name.
    pub fn register(&self, name: &str, link: Option<LinkId>, pose: Pose<'g>, kind: PlacedKind) {
        self.scope.kinematics.borrow_mut().places.insert(name.to_string(), Placed { link, pose, kind });
    }

    /// The parent of a joint: a body, or a point.
    pub fn joint_parent(&self, name: &Name, cx: &mut Diagnostics) -> Option<(Option<LinkId>, Pose<'g>)> {
        if name.text == GROUND {
            return Some((None, Pose::identity(self.scope.graph)));
        }
        let place: Place = name.place.clone();
        let e = Expr { kind: ExprKind::Name(name.text.clone()), place };
        self.scope.place(&e, cx).map(|p| (p.link, p.pose))
    }
}
