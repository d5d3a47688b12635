//! Free-body diagrams: all forces on a body, for outputs of the type `FreeBody`. Each joint of the body is
//! released to six degrees of freedom. The wrench of a force element, a constraint or a contact on the body
//! is its generalized force on the joint of which the body is the child, minus those on the joints of which
//! the body is the parent. This is the principle of virtual work: the body moves alone while all others are
//! fixed. The wrenches of joints are their reactions, including the motors, springs and dashpots on their own
//! coordinates.

use super::element_forces::ElementForces;
use super::holders::{MovingPlacement, connections_of_body, name_of_connection};
use super::output::output_axes;
use super::power::power_of_input;
use super::reaction::{RELEASED, ReleasedJoints};
use super::scope::{AllowedQuantities, Context, PlacedElement, PlacedElementKind, Scope, VectorTerms};
use crate::diag::Diagnostics;
use crate::expr::eval::eval;
use crate::expr::sample::sample_of_symbol;
use crate::expr::{Expr, Function, Symbol, Vec3};
use crate::kinematics::{random_configuration, time_derivative, velocity_gradient};
use crate::mechanism::{ActionOrigin, FreeBodyDiagram, LinkId, Model, OutputExpression, Pose, Quantity};
use crate::syntax::{self, Definition, Endpoint, ExprKind, JointKind, Target};
use std::collections::BTreeMap;

/// Number of sampled states at which actions are tested for zero.
const SAMPLES: u64 = 3;
/// Magnitude, relative to that of the summands, below which a sum of forces counts as zero.
const ROUNDING: f64 = 1e-10;

/// Force and torque about the centre of mass of the body, in the axes of one link.
#[derive(Clone, Copy)]
struct ActionWrench<'g> {
    force: Vec3<'g>,
    torque: Vec3<'g>,
}

/// Body whose free-body diagram is derived.
struct FreedBody<'s, 'a, 'g> {
    scope: &'s Scope<'a, 'g>,
    model: &'s Model<'g>,
    release: &'s ReleasedJoints<'s, 'g>,
    name: String,
    link: Option<LinkId>,
    mass: Expr<'g>,
    center: PlacedElement<'g>,
    /// Released joints: index among the released joints, and whether the body is the child.
    joints: Vec<(usize, bool)>,
    /// Link and pose of the axes in which the diagram is resolved.
    axes: (Option<LinkId>, Pose<'g>),
}

/// An action: name, origin, point of action, and wrench.
type DiagramAction<'g> = (String, ActionOrigin, Option<VectorTerms<'g>>, ActionWrench<'g>);

/// Returns the generalized forces of an element on the coordinates of released joints.
pub fn forces_on_released_joints<'g>(
    scope: &Scope<'_, 'g>,
    m: &Model<'g>,
    (release, applied): (&ReleasedJoints<'_, 'g>, &ElementForces<'g>),
    name: &str,
) -> Vec<Expr<'g>> {
    let open = RELEASED * release.joints.len();
    let first = m.nv() - open;
    let mut forces = vec![m.graph.zero(); open];
    let mut add_generalized_force = |rate: Expr<'g>, force: Expr<'g>| {
        for (k, d) in velocity_gradient(rate).into_iter().filter(|(k, _)| *k >= first) {
            forces[k - first] += force * d;
        }
    };
    let acceleration_expression = |k: usize| Quantity::Acceleration(k).expr(m.graph);
    for load in &applied.loads {
        add_generalized_force(load.rate, load.force);
    }
    for energy in &applied.potentials {
        add_generalized_force(time_derivative(m.configuration_space(), *energy), -m.graph.one());
    }
    for function in &applied.dissipations {
        add_generalized_force(*function, -m.graph.one());
    }
    for element in &applied.inertances {
        let gradient = velocity_gradient(element.rate);
        let start = time_derivative(m.configuration_space(), element.rate);
        let change = gradient.into_iter().fold(start, |sum, (k, d)| sum + d * acceleration_expression(k));
        add_generalized_force(element.rate, -(element.inertance * change));
    }
    for force in &applied.acceleration_forces {
        let value = force
            .factors
            .iter()
            .fold(m.graph.zero(), |sum, (k, factor)| sum + *factor * acceleration_expression(*k));
        add_generalized_force(force.rate, value);
    }
    add_generalized_force(power_of_input(scope, m, name), m.graph.one());
    forces
}

/// Returns the free-body diagram of an output. The diagram has no actions until joints are released.
pub fn resolve_free_body_diagram<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    (release, placements): (Option<&ReleasedJoints<'_, 'g>>, &[MovingPlacement]),
    output: &Definition,
    cx: &mut Diagnostics,
) -> Option<OutputExpression<'g>> {
    let name = name_of_diagram_body(scope, placements, output, cx)?;
    let axes = output_axes(scope, output, cx)?;
    let holders = connections_of_body(scope, placements, &name);
    let released: Vec<usize> = holders.iter().map(|(number, _)| *number).collect();
    let empty = FreeBodyDiagram { body: name.clone(), actions: Vec::new(), released };
    let output_value =
        |values, diagram| OutputExpression { name: output.name.text.clone(), values, diagram: Some(diagram) };
    let Some(release) = release else { return Some(output_value(Vec::new(), empty)) };
    let joints: Vec<(usize, bool)> = holders
        .iter()
        .filter_map(|(number, holds)| Some((release.index_of_released_joint(*number)?, *holds)))
        .collect();
    let (link, mass, center) = rigid_group_mass_properties(scope, model, (&name, &joints), output, cx)?;
    let body = FreedBody { scope, model, release, name, link, mass, center, joints, axes };
    let mut all: Vec<DiagramAction<'g>> = body.gravity_action_on_body().into_iter().collect();
    all.extend(body.element_actions_on_body());
    all.extend(body.joint_reactions_on_body());
    all.extend(body.constraint_reactions_on_body());
    all.extend(body.contact_wrenches_on_body());
    let (mut values, mut actions) = (Vec::new(), Vec::new());
    let rotation = &body.axes.1.rotation;
    for (name, origin, place, wrench) in all {
        let zero = Vec3::zero(scope.graph);
        let point = place.map_or(zero, |terms| body.arm_from_center(&terms));
        values.extend(
            [point, wrench.force, wrench.torque].map(|v| rotation.vector_in_child_axes(v).0).concat(),
        );
        actions.push((name, origin));
    }
    Some(output_value(
        scope.with_released_coordinates_zero(&values),
        FreeBodyDiagram { body: body.name, actions, ..empty },
    ))
}

/// Returns the name of the body, if it can have a diagram.
fn name_of_diagram_body<'g>(
    scope: &Scope<'_, 'g>,
    placements: &[MovingPlacement],
    output: &Definition,
    cx: &mut Diagnostics,
) -> Option<String> {
    let ground = Some((None, Pose::identity(scope.graph)));
    let e = &output.value;
    scope.call_in_context(Context::new(AllowedQuantities::Reaction, ground), |scope| {
        scope.resolve_body_with_mass(e, cx)
    })?;
    let name = e.as_name()?;
    if connections_of_body(scope, placements, name).iter().all(|(_, holds)| !holds) {
        cx.report_error(e.place.clone(), format!("`{name}` has no joint that can be released")).add_help(
            "a free-body diagram is available for a body or a particle with a joint or with its own `at` \
             and `frame`; a body fixed to another one belongs to the diagram of that one",
        );
        return None;
    }
    Some(name.to_string())
}

/// Returns the link, the mass and the centre of mass of a body and all elements fixed to it. Reports
/// elements that move on it without a joint.
fn rigid_group_mass_properties<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    (name, joints): (&str, &[(usize, bool)]),
    output: &Definition,
    cx: &mut Diagnostics,
) -> Option<(Option<LinkId>, Expr<'g>, PlacedElement<'g>)> {
    let g = scope.graph;
    let kinematics = &scope.kinematics;
    let link = kinematics.places.get(name)?.link;
    let released: Vec<Option<LinkId>> =
        joints.iter().filter_map(|(at, holds)| (!holds).then_some(first_released_link(scope, *at))).collect();
    let (mut mass, mut sum) = (g.zero(), Vec3::zero(g));
    for (other, (m, com, _)) in &kinematics.masses {
        let Some(placed) = kinematics.places.get(other) else { continue };
        let path = std::iter::successors(placed.link, |l| model.links[l.0].parent);
        let path: Vec<LinkId> = path.collect();
        let freed = path.iter().any(|l| released.contains(&Some(*l)));
        if freed || !path.iter().any(|l| Some(*l) == link) {
            continue;
        }
        if placed.link != link {
            cx.report_error(
                output.value.place.clone(),
                format!(
                    "`{other}` moves relative to `{name}` without a joint, so `{name}` cannot be \
                     isolated"
                ),
            )
            .add_help("connect it by a joint, whose reaction acts on both");
            return None;
        }
        mass += *m;
        sum += placed.pose.transform_point(*com) * *m;
    }
    let at = &kinematics.places.get(name)?.pose;
    let translation = if mass.is_zero() { at.translation } else { sum.map(|c| c / mass) };
    let pose = Pose { translation, rotation: at.rotation.clone() };
    Some((link, mass, PlacedElement { link, pose, kind: PlacedElementKind::Point }))
}

/// Returns the first link of the motions of a released joint.
fn first_released_link(scope: &Scope<'_, '_>, index: usize) -> Option<LinkId> {
    let (_, v) = scope.kinematics.first_released?;
    let joints = &scope.kinematics.joints;
    joints
        .iter()
        .position(|joint| joint.dofs.iter().any(|dof| dof.index == v.0 + RELEASED * index))
        .map(LinkId)
}

impl<'g> FreedBody<'_, '_, 'g> {
    /// Returns a position relative to the centre of mass, in the axes of the result's link.
    fn arm_from_center(&self, place: &VectorTerms<'g>) -> Vec3<'g> {
        let kinematics = &self.scope.kinematics;
        let mut terms = place.clone();
        let center = kinematics.position_of_point(self.center.link, self.center.pose.translation);
        for (axes, v) in center {
            match terms.iter_mut().find(|(known, _)| *known == axes) {
                Some((_, total)) => *total -= v,
                None => terms.push((axes, -v)),
            }
        }
        terms.retain(|(_, v)| !v.is_zero());
        kinematics.components_in_link_axes(&terms, self.axes.0, Vec3::zero(self.scope.graph))
    }

    fn position_of_placed(&self, placed: &PlacedElement<'g>) -> VectorTerms<'g> {
        self.scope.kinematics.position_of_point(placed.link, placed.pose.translation)
    }

    fn gravity_action_on_body(&self) -> Option<DiagramAction<'g>> {
        let zero = Vec3::zero(self.scope.graph);
        let weight = self.model.gravity * self.mass;
        if weight.is_zero() {
            return None;
        }
        let force = self.scope.kinematics.components_in_link_axes(&vec![(None, weight)], self.axes.0, zero);
        Some(("gravity".to_string(), ActionOrigin::Gravity, None, ActionWrench { force, torque: zero }))
    }

    /// Returns the wrench on the body from generalized forces on the coordinates of released joints.
    fn wrench_on_body(&self, forces: &[Expr<'g>]) -> ActionWrench<'g> {
        let zero = Vec3::zero(self.scope.graph);
        let mut sum = ActionWrench { force: zero, torque: zero };
        for (index, holds) in &self.joints {
            let reaction_vector = |k: usize| Vec3([0, 1, 2].map(|i| forces[RELEASED * index + k + i]));
            let Some(w) =
                self.joint_wrench_about_center_of_mass(*index, reaction_vector(0), reaction_vector(3))
            else {
                continue;
            };
            let sign = self.scope.graph.num(if *holds { 1.0 } else { -1.0 });
            sum.force += w.force * sign;
            sum.torque += w.torque * sign;
        }
        sum
    }

    /// Returns the wrench about the centre of mass of a force and a torque at a released joint, given in the
    /// frame of the joint.
    fn joint_wrench_about_center_of_mass(
        &self,
        index: usize,
        force: Vec3<'g>,
        torque: Vec3<'g>,
    ) -> Option<ActionWrench<'g>> {
        let zero = Vec3::zero(self.scope.graph);
        if force.is_zero() && torque.is_zero() {
            return Some(ActionWrench { force: zero, torque: zero });
        }
        let frame = self.release.frames.get(self.release.joints.get(index)?)?;
        let components_in_result_axes = |v: Vec3<'g>| {
            let terms = vec![(frame.link, frame.pose.rotation.vector_in_parent_axes(v))];
            self.scope.kinematics.components_in_link_axes(&terms, self.axes.0, zero)
        };
        let (force, torque) = (components_in_result_axes(force), components_in_result_axes(torque));
        let arm = self.arm_from_center(&self.position_of_placed(frame));
        Some(ActionWrench { force, torque: torque + arm.cross(force) })
    }

    fn element_actions_on_body(&self) -> Vec<DiagramAction<'g>> {
        let mut all = Vec::new();
        for (name, forces) in &self.release.forces {
            let forces = self.scope.with_released_coordinates_zero(forces);
            let wrench = self.wrench_on_body(&forces);
            if !self.has_nonzero_force_sum(&wrench, &forces) {
                continue;
            }
            let is_input = self.model.inputs.iter().any(|(input, _)| input == name);
            let origin = if is_input { ActionOrigin::Input } else { ActionOrigin::Element };
            let place = self.action_point_of_element(name);
            let wrench = match &place {
                // A force through its point of action has no torque about that point.
                Some(_) => ActionWrench { torque: Vec3::zero(self.scope.graph), ..wrench },
                None => wrench,
            };
            all.push((name.clone(), origin, place, wrench));
        }
        all
    }

    /// Returns the point of the body at which an element acts, if it acts at a single point.
    fn action_point_of_element(&self, name: &str) -> Option<VectorTerms<'g>> {
        let action = self.scope.description.actions.iter().find(|action| action.name.text == name)?;
        let mut unread = Diagnostics::silent_diagnostics();
        let mut position_if_on_body = |e: &syntax::Expr| {
            let placed = self.scope.placement_of_moving_point(e, &mut unread)?;
            (placed.link == self.link).then(|| self.position_of_placed(&placed))
        };
        let row = action.kind.row();
        match &action.on {
            _ if !row.at_point => None,
            Target::Between(a, b) => position_if_on_body(a).or_else(|| position_if_on_body(b)),
            Target::On(e) if row.on_bodies => match &e.kind {
                ExprKind::Name(name) if self.scope.joint_coordinates(name).is_some() => None,
                ExprKind::Name(_) | ExprKind::Method(..) => position_if_on_body(e),
                _ => None,
            },
            Target::On(_) => None,
        }
    }

    /// Returns the reactions that act on the body in joints of the tree, and where `at` or `frame` places it.
    fn joint_reactions_on_body(&self) -> Vec<DiagramAction<'g>> {
        let g = self.scope.graph;
        let mut all = Vec::new();
        for (index, holds) in &self.joints {
            let Some(&j) = self.release.joints.get(*index) else { continue };
            let (name, origin) =
                match (self.scope.description.joints.get(j), name_of_connection(self.scope.description, j)) {
                    (Some(joint), _) if joint.kind == JointKind::Free => continue,
                    (Some(joint), _) => (joint.name.text.clone(), ActionOrigin::Joint),
                    (None, Some(name)) => (format!("{}.place", name.text), ActionOrigin::Constraint),
                    (None, None) => continue,
                };
            let Some(frame) = self.release.frames.get(&j) else { continue };
            let sign = g.num(if *holds { 1.0 } else { -1.0 });
            let reaction_vector_in_axes = |k: usize| {
                let v = Vec3([0, 1, 2].map(|i| Quantity::Reaction(RELEASED * j + k + i).expr(g) * sign));
                let terms = vec![(frame.link, frame.pose.rotation.vector_in_parent_axes(v))];
                self.scope.kinematics.components_in_link_axes(&terms, self.axes.0, Vec3::zero(g))
            };
            let wrench =
                ActionWrench { force: reaction_vector_in_axes(0), torque: reaction_vector_in_axes(3) };
            all.push((name, origin, Some(self.position_of_placed(frame)), wrench));
        }
        all
    }

    /// Returns the wrenches of constraints and of loop-closing joints on the body.
    fn constraint_reactions_on_body(&self) -> Vec<DiagramAction<'g>> {
        let g = self.scope.graph;
        let open = RELEASED * self.release.joints.len();
        let first = self.model.nv() - open;
        let mut by_name: Vec<(String, Vec<Expr<'g>>)> = Vec::new();
        let mut index: BTreeMap<String, usize> = BTreeMap::new();
        for (k, c) in self.model.constraints.iter().enumerate() {
            let multiplier = Quantity::Reaction(Quantity::MULTIPLIERS + k).expr(g);
            let size = multiplier.apply_function(Function::Abs);
            let name = c.name.split('.').next().unwrap_or(&c.name).to_string();
            let slot = *index.entry(name.clone()).or_insert(by_name.len());
            if slot == by_name.len() {
                by_name.push((name, vec![g.zero(); open]));
            }
            let normal = std::iter::once((c.rate, multiplier));
            let friction = c.friction.iter().map(|term| (term.rate, term.share * size));
            for (rate, force) in normal.chain(friction) {
                for (v, d) in velocity_gradient(rate).into_iter().filter(|(v, _)| *v >= first) {
                    by_name[slot].1[v - first] += force * d;
                }
            }
        }
        let diagram_action_of_element = |(name, forces): (String, Vec<Expr<'g>>)| {
            let forces = self.scope.with_released_coordinates_zero(&forces);
            let wrench = self.wrench_on_body(&forces);
            if !self.has_nonzero_force_sum(&wrench, &forces) {
                return None;
            }
            let joint = self.scope.description.joints.iter().find(|joint| joint.name.text == name);
            if let Some(joint) = joint {
                let place = self.joint_end_position([&joint.parent, &joint.child]);
                let wrench = self.move_wrench_to_point(place.as_ref(), wrench);
                return Some((name, ActionOrigin::Joint, place, wrench));
            }
            let place = self.release.contact_points.get(&name).cloned();
            let wrench = match &place {
                Some(_) => ActionWrench { torque: Vec3::zero(g), ..wrench },
                None => wrench,
            };
            Some((name, ActionOrigin::Constraint, place, wrench))
        };
        by_name.into_iter().filter_map(diagram_action_of_element).collect()
    }

    /// Returns the wrenches of unilateral contacts on the body.
    fn contact_wrenches_on_body(&self) -> Vec<DiagramAction<'g>> {
        let g = self.scope.graph;
        let open = RELEASED * self.release.joints.len();
        let first = self.model.nv() - open;
        let (mut all, mut number) = (Vec::new(), 0);
        for contact in &self.model.contacts {
            let mut forces = vec![g.zero(); open];
            for rate in &contact.rates {
                let force = Quantity::ContactForce(number).expr(g);
                number += 1;
                for (v, d) in velocity_gradient(*rate).into_iter().filter(|(v, _)| *v >= first) {
                    forces[v - first] += force * d;
                }
            }
            let forces = self.scope.with_released_coordinates_zero(&forces);
            let wrench = self.wrench_on_body(&forces);
            if self.has_nonzero_force_sum(&wrench, &forces) {
                let place = self.release.contact_points.get(&contact.name).cloned();
                let wrench = match &place {
                    Some(_) => ActionWrench { torque: Vec3::zero(g), ..wrench },
                    None => wrench,
                };
                all.push((contact.name.clone(), ActionOrigin::Contact, place, wrench));
            }
        }
        all
    }

    /// Returns the position of the end of a joint that belongs to the body.
    fn joint_end_position(&self, ends: [&Endpoint; 2]) -> Option<VectorTerms<'g>> {
        let mut unread = Diagnostics::silent_diagnostics();
        ends.into_iter().find_map(|end| {
            let (link, pose) = self.scope.placement_of_joint_parent(&end.body, &mut unread)?;
            let on_body = self.scope.frame_of_endpoint(end, &mut unread)?;
            let placed =
                PlacedElement { link, pose: pose.compose_with(&on_body), kind: PlacedElementKind::Point };
            (link == self.link).then(|| self.position_of_placed(&placed))
        })
    }

    /// Moves a wrench from the centre of mass of the body to a given point.
    fn move_wrench_to_point(&self, place: Option<&VectorTerms<'g>>, w: ActionWrench<'g>) -> ActionWrench<'g> {
        let Some(place) = place else { return w };
        let arm = self.arm_from_center(place);
        ActionWrench { torque: w.torque - arm.cross(w.force), ..w }
    }

    /// Whether a sum of forces on several joints is nonzero. Forces between two bodies that the same joint
    /// carries cancel up to rounding.
    fn has_nonzero_force_sum(&self, wrench: &ActionWrench<'g>, forces: &[Expr<'g>]) -> bool {
        let all = self.scope.with_released_coordinates_zero(&[wrench.force.0, wrench.torque.0].concat());
        if all.iter().all(|e| e.is_zero()) {
            return false;
        }
        (0..SAMPLES).any(|seed| {
            // Sampled quaternions have unit length, because terms may cancel only for rotations.
            let q = random_configuration(self.model, seed);
            let sample_value_of_symbol = |s: Symbol| match Quantity::from_symbol(s) {
                Quantity::Configuration(k) => q[k],
                _ => sample_of_symbol(s, seed),
            };
            let largest_magnitude = |e: &[Expr<'g>]| {
                eval(e, &sample_value_of_symbol).iter().fold(0.0_f64, |size, x| size.max(x.abs()))
            };
            let (residual, size) = (largest_magnitude(&all), largest_magnitude(forces));
            // Values that are not finite are inconclusive; they count as nonzero.
            !residual.is_finite() || residual > ROUNDING * size
        })
    }
}
