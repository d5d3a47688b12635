//! Reaction forces and torques of joints in outputs: `reaction_force(joint)`, `reaction_torque(joint)`. A
//! joint of the tree is released: six degrees of freedom of the child in the joint's frame on the parent are
//! added, and the reaction is the load that holds them at zero (Lanczos, *The Variational Principles of
//! Mechanics*, 1970, § III.7). The reaction of a loop-closing joint follows from the multipliers of its
//! constraints.

use super::call::Call;
use super::scope::{AllowedQuantities, Axes, PlacedElement, Scope, Value, VectorTerms};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::kinematics::symbols_in;
use crate::mechanism::{Constraint, Model, Quantity};
use crate::syntax::ExprKind;
use std::collections::BTreeMap;

/// Number of coordinates of a released joint: three translations and three rotations.
pub const RELEASED: usize = 6;

/// Returns the joints to release: those whose reactions are outputs, and all releasable connections of bodies
/// with free-body diagrams. If there are any, joints that are solved for in closed form are added, because
/// their reactions determine those of the joints that close loops.
pub fn joints_to_release(model: &Model<'_>) -> Vec<usize> {
    let values: Vec<_> = model.outputs.iter().flat_map(|o| o.values.iter().copied()).collect();
    let mut joints: Vec<usize> = symbols_in(&values)
        .into_iter()
        .filter_map(|s| match Quantity::from_symbol(s) {
            Quantity::Reaction(k) if k < Quantity::MULTIPLIERS => Some(k / RELEASED),
            _ => None,
        })
        .collect();
    joints.extend(model.outputs.iter().filter_map(|o| o.diagram.as_ref()).flat_map(|d| d.released.clone()));
    if !joints.is_empty() {
        joints.extend(model.solved.iter().map(|side| side.joint));
    }
    joints.sort_unstable();
    joints.dedup();
    joints
}

/// Joints that are released to six degrees of freedom each, with the data for free-body diagrams.
pub struct ReleasedJoints<'a, 'g> {
    /// Indices of the released joints and placements.
    pub joints: &'a [usize],
    /// Constraints that the mechanism with released joints keeps.
    pub retained: &'a [Constraint<'g>],
    /// Frame of each released joint on its parent before the release, by index of the joint. Bodies placed by
    /// `at` and `frame` have their own frame in this map.
    pub frames: BTreeMap<usize, PlacedElement<'g>>,
    /// Name and generalized forces on the coordinates of released joints, for each force element, energy and
    /// dissipation.
    pub forces: Vec<(String, Vec<Expr<'g>>)>,
    /// Contact point of each constraint of touching surfaces, by name, from the ground's origin.
    pub contact_points: BTreeMap<String, VectorTerms<'g>>,
}

impl<'a, 'g> ReleasedJoints<'a, 'g> {
    /// Returns the release of joints, before any element is resolved.
    pub fn of_joints(joints: &'a [usize], retained: &'a [Constraint<'g>]) -> ReleasedJoints<'a, 'g> {
        let (frames, contact_points) = (BTreeMap::new(), BTreeMap::new());
        ReleasedJoints { joints, retained, frames, forces: Vec::new(), contact_points }
    }

    /// Returns the index of a joint among the released joints.
    pub fn index_of_released_joint(&self, joint: usize) -> Option<usize> {
        self.joints.iter().position(|released| *released == joint)
    }
}

impl<'g> Scope<'_, 'g> {
    /// Resolves `reaction_force(joint)` or `reaction_torque(joint)`, whose components begin at `offset`: the
    /// load of the parent on the child at the origin of the joint's frame.
    pub fn resolve_reaction(
        &self,
        call: &Call<'_>,
        offset: usize,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let kinematics = &self.kinematics;
        let joint_names = || kinematics.transmissions.keys().map(String::as_str);
        let name = match call.arguments {
            [e] => match &e.kind {
                ExprKind::Name(name) => name,
                _ => {
                    cx.report_error(e.place.clone(), "expected a joint").suggest_name("", joint_names());
                    return None;
                }
            },
            _ => return call.report_wrong_arguments(cx),
        };
        if !self.check_allowed_quantity(AllowedQuantities::Reaction, "a reaction", call.place, cx) {
            return None;
        }
        let Some((j, link, rotation)) = kinematics.transmissions.get(name) else {
            if self.record_first_report(name, cx) {
                let error =
                    cx.report_error(call.arguments[0].place.clone(), format!("unknown joint `{name}`"));
                error.suggest_name(name, joint_names());
                if error.has_no_help() {
                    error.add_help(format!("name the joint, as in `{}(hinge)`", call.function_name()));
                }
            }
            return None;
        };
        let first = RELEASED * j + offset;
        let components = Vec3([0, 1, 2].map(|k| Quantity::Reaction(first + k).expr(self.graph)));
        Some(Value::Vector(vec![(Axes::Link(*link), rotation.vector_in_parent_axes(components))]))
    }
}
