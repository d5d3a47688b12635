//! Reaction forces and torques of joints in outputs: `reaction_force(joint)`, `reaction_torque(joint)`. A
//! joint of the tree is released: six degrees of freedom of the child in the joint's frame on the parent are
//! added, and the reaction is the load that holds them at zero (Lanczos, *The Variational Principles of
//! Mechanics*, 1970, § III.7). The reaction of a loop-closing joint follows from the multipliers of its
//! constraints.

use super::builder::Builder;
use super::call::Call;
use super::joint::own_coordinate;
use super::scope::{Allowed, Axes, Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::{Rotation, Vec3};
use crate::kinematics::symbols_in;
use crate::mechanism::{InQ, InV, Inertia, Link, LinkId, Model, Motion, Pose, Quantity};
use crate::syntax::ExprKind;

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

impl<'g> Builder<'_, 'g> {
    /// Records a joint whose reactions can be outputs. They are resolved in the axes of a frame on a link.
    pub fn record_transmission(&mut self, j: usize, link: Option<LinkId>, rotation: &Rotation<'g>) {
        let name = self.description.joints[j].name.text.clone();
        self.scope.kinematics.transmissions.insert(name, (j, link, rotation.clone()));
    }

    /// Returns the joint's frame on the parent, moved by the coordinates of the released joint number `index`
    /// of `count`.
    pub fn released_joint_frame(
        &mut self,
        index: usize,
        count: usize,
        mut link: Option<LinkId>,
        mut pose: Pose<'g>,
    ) -> (Option<LinkId>, Pose<'g>) {
        let g = self.scope.graph;
        let following = RELEASED * (count - index);
        let (q, v) = (InQ(self.model.nq() - following), InV(self.model.nv() - following));
        for k in 0..RELEASED {
            let (axis, coordinate) = (Vec3::coordinate_axis(g, k % 3), own_coordinate(q + k, v + k));
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
            _ => return call.reject_arguments(cx),
        };
        if !self.check_allowed(Allowed::Reaction, "a reaction", call.place, cx) {
            return None;
        }
        let Some((j, link, rotation)) = kinematics.transmissions.get(name) else {
            if self.is_first_report(name, cx) {
                let error =
                    cx.report_error(call.arguments[0].place.clone(), format!("unknown joint `{name}`"));
                error.suggest_name(name, joint_names());
                if error.is_bare() {
                    error.add_help(format!("name the joint, as in `{}(hinge)`", call.function_name()));
                }
            }
            return None;
        };
        let first = RELEASED * j + offset;
        let components = Vec3([0, 1, 2].map(|k| Quantity::Reaction(first + k).expr(self.graph)));
        Some(Value::Vector(vec![(Axes::Link(*link), rotation.to_parent(components))]))
    }
}
