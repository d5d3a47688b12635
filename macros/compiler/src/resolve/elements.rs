//! Queries of declared elements: coordinates and frames of joints, names of placed elements, and inputs.

use super::joint::full_name;
use super::range::FiniteParameterRange;
use super::scope::{NamedCoordinate, Scope};
use crate::diag::{Diagnostics, Place};
use crate::expr::replace::substitute_symbols_in_all;
use crate::expr::{self, Rotation, Vec3};
use crate::mechanism::{ConfigurationSpace, LinkId, Pose, Quantity, Rule};
use crate::syntax::{Endpoint, Expr, ExprKind, GROUND, Name};

impl<'g> Scope<'_, 'g> {
    /// Returns the coordinates of a joint that force elements can act on; `None` if the joint does not exist.
    pub fn joint_coordinates(&self, name: &str) -> Option<&[NamedCoordinate]> {
        let j = self.description.joints.iter().position(|j| j.name.text == name)?;
        Some(&self.kinematics.joint_coordinates[j].plain)
    }

    /// Whether an expression is the name of a coordinate that is an angle.
    pub fn is_angle(&self, e: &Expr) -> bool {
        let name = match &e.kind {
            ExprKind::Name(name) => name.clone(),
            ExprKind::Field(joint, member) => full_name(joint.as_name().unwrap_or_default(), &member.text),
            _ => return false,
        };
        self.kinematics.coordinates.iter().any(|(known, _, angle)| *known == name && *angle)
    }

    /// Returns the names of all joints.
    pub fn joint_names(&self) -> Vec<String> {
        self.description.joints.iter().map(|j| j.name.text.clone()).collect()
    }

    /// Returns the frame of a joint on the body of one of its ends.
    pub fn frame_of_endpoint(&self, end: &Endpoint, cx: &mut Diagnostics) -> Option<Pose<'g>> {
        let translation = match &end.at {
            Some(at) => self.resolve_own_axes_vector(at, cx).filter(|v| {
                let range = FiniteParameterRange::range_of_scalar_type(&self.description.scalar);
                let describe_joint_position = || format!("the position of a joint on `{}`", end.body.text);
                v.0.iter().for_each(|c| {
                    self.record_parameter_condition(Rule::Length, describe_joint_position, &[*c])
                });
                v.0.iter().all(|c| range.check_length(*c, &at.place, cx))
            }),
            None => Some(Vec3::zero(self.graph)),
        };
        let rotation = self.resolve_rotation(&end.rotated, cx);
        Some(Pose { rotation: rotation?, translation: translation? })
    }

    /// Returns a substitute pose for an element with an error. Its generic values avoid follow-up errors.
    pub fn placeholder_pose(&self, moves: bool) -> Pose<'g> {
        let g = self.graph;
        let mut translation = Vec3::vector_from_constants(g, [0.731, 0.417, 0.593]);
        if moves {
            translation += Vec3::coordinate_axis(g, 0) * Quantity::Time.expr(g);
        }
        Pose { rotation: Rotation::identity(g), translation }
    }

    /// Returns the placement of the parent of a joint: a body or a point.
    pub fn placement_of_joint_parent(
        &self,
        name: &Name,
        cx: &mut Diagnostics,
    ) -> Option<(Option<LinkId>, Pose<'g>)> {
        if name.text == GROUND {
            return Some((None, Pose::identity(self.graph)));
        }
        let place: Place = name.place.clone();
        let e = Expr { kind: ExprKind::Name(name.text.clone()), place };
        self.resolve_placement(&e, cx).map(|p| (p.link, p.pose))
    }

    /// Returns the names of all elements that have a position or axes.
    pub fn placeable_names(&self) -> impl Iterator<Item = &str> {
        let points = self.description.points.iter().map(|point| point.name.text.as_str());
        self.bodies.iter().map(String::as_str).chain(points)
    }

    /// Whether an element has a position or axes.
    pub fn is_placeable(&self, name: &str) -> bool {
        self.placeable_names().any(|known| known == name)
    }

    /// Whether an element is a body, or a particle without a position of its own, which can be the child of a
    /// joint.
    pub fn can_be_joint_child(&self, name: &str) -> bool {
        let d = self.description;
        let unplaced = d.particles.iter().filter(|p| p.at.is_none()).map(|p| &p.name);
        d.bodies.iter().map(|b| &b.name).chain(unplaced).any(|known| known.text == name)
    }

    /// Returns the configuration space, after all links are placed.
    pub fn configuration_space(&self) -> ConfigurationSpace<'_, 'g> {
        ConfigurationSpace { graph: self.graph, charts: &self.kinematics.charts, speeds: None }
    }

    /// Returns expressions with the coordinates of released joints, and their rates, set to zero.
    pub fn with_released_coordinates_zero(&self, e: &[expr::Expr<'g>]) -> Vec<expr::Expr<'g>> {
        let Some((q, v)) = self.kinematics.first_released else { return e.to_vec() };
        substitute_symbols_in_all(e, &|s| {
            let released = match Quantity::from_symbol(s) {
                Quantity::Configuration(k) => k >= q.0,
                Quantity::Velocity(k) | Quantity::Acceleration(k) => k >= v.0,
                _ => false,
            };
            released.then(|| self.graph.zero())
        })
    }

    /// Returns the index in `u` of a declared input.
    pub fn input_index(&self, name: &str) -> Option<usize> {
        let k = self.description.inputs.iter().position(|input| input.text == name)?;
        Some(self.driven + k)
    }
}
