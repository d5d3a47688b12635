//! Interface of a mechanism with an error: the signatures of the functions that would have been generated, so
//! that one error is not reported again at every use of the mechanism. The outline depends only on the
//! description and checks nothing.

use super::carriers::expressions_that_may_contain_positions;
use super::joint::full_name;
use crate::diag::Diagnostics;
use crate::language::names::TIME;
use crate::language::{Callable, FunctionDependence, FunctionId};
use crate::mechanism::{FreeBodyDiagram, UsedQuantities};
use crate::syntax::{
    Action, Callee, ConstraintKind, Definition, Description, Expr, ExprKind, GROUND, Joint, JointKind, Key,
    Rank,
};
use std::collections::BTreeSet;

/// Interface of a mechanism with an error, as far as the description determines it.
pub struct Outline {
    /// Name of every entry of the configuration `q`.
    pub configuration: Vec<String>,
    /// Name of every entry of the velocity `v`.
    pub velocities: Vec<String>,
    /// Name of every entry of the input `u`.
    pub inputs: Vec<String>,
    /// Names of the mechanism's frames.
    pub frames: Vec<String>,
    /// Names of the bodies that are not welded to others.
    pub bodies: Vec<String>,
    /// Whether the first argument of functions is time.
    pub time: bool,
    /// Whether input forces depend on the velocity.
    pub velocity_inputs: bool,
    /// Whether joints close loops or constraints are declared.
    pub constrained: bool,
    /// Whether some of the constraints are slipping contacts.
    pub slipping: bool,
    /// Names of free-body diagrams, with their bodies; their actions are unknown.
    pub diagrams: Vec<(String, FreeBodyDiagram)>,
    /// All outputs other than free-body diagrams, in order.
    pub outputs: Vec<OutputInterface>,
}

/// Interface of an output of a mechanism with an error.
pub struct OutputInterface {
    /// Name of the outlined output.
    pub name: String,
    /// Number of components of the output.
    pub size: usize,
    /// Quantities on which the output depends.
    pub uses: UsedQuantities,
    /// Whether the output contains contact forces, which may be contradictory.
    pub has_contact_forces: bool,
}

/// Returns the outline of a description that may contain errors.
pub fn outline_of_description(d: &Description) -> Outline {
    let (configuration, velocities, inputs) = state_and_input_names(d);
    let names_in_expression = |e| names_with_definitions(d, e);
    let rotations = d.frames.iter().flat_map(|f| f.rotations.iter().chain([&f.start]));
    // Unused definitions are ignored.
    let used = expressions_that_may_contain_positions(d)
        .into_iter()
        .filter(|e| !d.definitions.iter().any(|d| std::ptr::eq(&d.value, *e)));
    Outline {
        time: used.chain(rotations).any(|e| names_in_expression(e).contains(TIME)),
        velocity_inputs: d.actions.iter().any(|action| {
            laws_of_action(action).any(|e| {
                let uses = used_quantities(d, e);
                uses.inputs && (uses.velocities || names_in_expression(e).contains("speed"))
            })
        }),
        constrained: !d.constraints.is_empty() || super::tree::loop_closing_flags(d).contains(&true),
        slipping: d.constraints.iter().any(|c| matches!(c.kind, ConstraintKind::Slipping)),
        diagrams: d.outputs.iter().filter_map(free_body_diagram_of_output).collect(),
        outputs: d.outputs.iter().filter_map(|output| outline_of_output(d, output)).collect(),
        frames: frame_names(d),
        bodies: unwelded_bodies(d),
        configuration,
        velocities,
        inputs,
    }
}

/// Returns the names of the entries of `q`, `v` and `u`.
fn state_and_input_names(d: &Description) -> (Vec<String>, Vec<String>, Vec<String>) {
    let (mut q, mut v, mut u): (Vec<String>, Vec<String>, Vec<String>) = Default::default();
    let closing = super::tree::loop_closing_flags(d);
    let solved = super::closed_form::find_closed_form_loops(d, &closing, &mut Diagnostics::new());
    for j in 0..=d.joints.len() {
        let free = d.coordinates.iter().filter(|c| c.joints_before == j).map(|c| c.name.text.clone());
        let free: Vec<String> = free.collect();
        q.extend(free.iter().cloned());
        v.extend(free);
        let own = closing.get(j) == Some(&false) && solved.iter().all(|e| !e.sides.contains(&j));
        let has_own_coordinates = |joint: &&Joint| joint.mimic.is_none() && own;
        let Some(joint) = d.joints.get(j).filter(has_own_coordinates) else { continue };
        let (names_q, names_v) = joint.kind.configuration_and_velocity_names(joint.along.len());
        q.extend(names_q.iter().map(|n| full_name(&joint.name.text, n)));
        v.extend(names_v.iter().map(|n| full_name(&joint.name.text, n)));
        u.extend(joint.driven.then(|| joint.name.text.clone()));
    }
    u.extend(super::drive::drives_that_are_inputs(d).map(|drive| drive.name.text.clone()));
    u.extend(d.inputs.iter().map(|i| i.text.clone()));
    (q, v, u)
}

/// Returns the names of all elements with a frame, in the order of the model.
fn frame_names(d: &Description) -> Vec<String> {
    let bodies = d.bodies.iter().map(|b| &b.name).chain(d.particles.iter().map(|p| &p.name));
    let names = bodies.chain(d.points.iter().map(|p| &p.name)).map(|name| name.text.clone());
    d.ground_frame.then(|| GROUND.to_string()).into_iter().chain(names).collect()
}

/// Returns the names of the bodies and particles that are not welded to others.
fn unwelded_bodies(d: &Description) -> Vec<String> {
    let particles = d.particles.iter().filter(|p| p.at.is_none()).map(|p| &p.name);
    let is_welded_child = |name: &str| {
        d.joints.iter().any(|joint| joint.kind == JointKind::Weld && joint.child.body.text == name)
    };
    let all = d.bodies.iter().map(|b| &b.name).chain(particles).map(|name| name.text.clone());
    all.filter(|name| !is_welded_child(name)).collect()
}

fn outline_of_output(d: &Description, output: &Definition) -> Option<OutputInterface> {
    let size = match output.rank {
        Rank::Scalar => 1,
        Rank::Vector => 3,
        Rank::Matrix => 9,
        Rank::FreeBody => return None,
    };
    let is_contact_force = |part: &&Expr| match &part.kind {
        ExprKind::Call(function, arguments) => {
            matches!(
                function.id,
                Some(Callable::Function(
                    FunctionId::ContactForce | FunctionId::ContactMoment | FunctionId::Power
                ))
            ) && arguments.iter().any(|argument| is_contact_name(d, argument))
        }
        _ => false,
    };
    let has_contact_forces = subexpressions_with_definitions(d, &output.value).iter().any(is_contact_force);
    Some(OutputInterface {
        name: output.name.text.clone(),
        size,
        uses: used_quantities(d, &output.value),
        has_contact_forces,
    })
}

fn free_body_diagram_of_output(output: &Definition) -> Option<(String, FreeBodyDiagram)> {
    let is_one = output.rank == Rank::FreeBody;
    let body = output.value.as_name().unwrap_or_default().to_string();
    is_one.then(|| {
        (output.name.text.clone(), FreeBodyDiagram { body, actions: Vec::new(), released: Vec::new() })
    })
}

/// Returns the value or the law of a force element.
fn laws_of_action(action: &Action) -> impl Iterator<Item = &Expr> {
    action.written_law().map(|(_, e)| e).into_iter().chain(action.expression_of_key(Key::Value))
}

/// Returns the quantities on which an expression depends, according to the table of functions.
fn used_quantities(d: &Description, e: &Expr) -> UsedQuantities {
    let has_inputs = || !state_and_input_names(d).2.is_empty();
    let mut uses = UsedQuantities::default();
    for part in subexpressions_with_definitions(d, e) {
        match &part.kind {
            ExprKind::Call(function, arguments) => match dependence_of_call(function) {
                FunctionDependence::Arguments => {}
                FunctionDependence::Motion => uses.velocities = true,
                FunctionDependence::Acceleration => uses.accelerations = true,
                FunctionDependence::Rate => {
                    uses.velocities = true;
                    uses.accelerations |=
                        arguments.iter().any(|argument| contains_velocity_function(d, argument));
                }
                FunctionDependence::Power => {
                    uses.velocities = true;
                    uses.inputs |=
                        arguments.iter().any(|argument| is_contact_name(d, argument)) && has_inputs();
                }
                FunctionDependence::Reaction => {
                    uses.velocities = true;
                    uses.inputs |= has_inputs();
                }
            },
            ExprKind::Name(name) => uses.inputs |= d.inputs.iter().any(|input| input.text == *name),
            _ => {}
        }
    }
    uses
}

/// Returns the quantities on which the value of a call depends, besides those of its arguments.
fn dependence_of_call(callee: &Callee) -> FunctionDependence {
    match callee.id {
        Some(Callable::Function(function)) => function.row().depends_on,
        _ => FunctionDependence::Arguments,
    }
}

/// Whether an expression is the name of a contact.
fn is_contact_name(d: &Description, e: &Expr) -> bool {
    d.contacts
        .iter()
        .any(|contact| !contact.is_compliant() && e.as_name() == Some(contact.name.text.as_str()))
}

/// Whether an expression contains a function of the language that depends on velocities.
fn contains_velocity_function(d: &Description, e: &Expr) -> bool {
    let is_motion_dependent_call = |part: &&Expr| match &part.kind {
        ExprKind::Call(function, _) => {
            matches!(dependence_of_call(function), FunctionDependence::Motion | FunctionDependence::Rate)
        }
        _ => false,
    };
    subexpressions_with_definitions(d, e).iter().any(is_motion_dependent_call)
}

/// Returns all names in an expression, including those in its definitions.
fn names_with_definitions<'a>(d: &'a Description, e: &'a Expr) -> BTreeSet<&'a str> {
    subexpressions_with_definitions(d, e).into_iter().filter_map(Expr::as_name).collect()
}

/// Returns the subexpressions of an expression and of the definitions that it uses.
fn subexpressions_with_definitions<'a>(d: &'a Description, e: &'a Expr) -> Vec<&'a Expr> {
    let mut parts = e.all_subexpressions();
    let mut open: Vec<&Definition> = d.definitions.iter().collect();
    let mut next = 0;
    while let Some(part) = parts.get(next) {
        next += 1;
        let Some(name) = part.as_name() else { continue };
        if let Some(k) = open.iter().position(|definition| definition.name.text == name) {
            parts.extend(open.swap_remove(k).value.all_subexpressions());
        }
    }
    parts
}
