//! Power of single force elements, for outputs with `power(spring)`.

use super::call::Call;
use super::element_forces::ElementForces;
use super::scope::{AllowedQuantities, ElementPower, Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Function, Vec3};
use crate::kinematics::{
    coordinate_as_expression, coordinate_velocity, symbols_in, time_derivative, velocity_gradient,
};
use crate::language::{Callable, FunctionId};
use crate::mechanism::{Constraint, InputEffect, LinkId, Model, Quantity, SumOfLinkVectors};
use crate::syntax::{self, Description, Name};

/// Whether an output or a definition contains the power of an element.
pub fn is_power_used(d: &Description, element: &Name) -> bool {
    let mentions_power_of_element = |e: &syntax::Expr| {
        e.all_subexpressions().iter().any(|part| match &part.kind {
            syntax::ExprKind::Call(function, arguments) => {
                function.id == Some(Callable::Function(FunctionId::Power))
                    && arguments.iter().any(|a| a.as_name() == Some(element.text.as_str()))
            }
            _ => false,
        })
    };
    d.outputs.iter().any(|output| mentions_power_of_element(&output.value))
        || d.definitions.iter().any(|d| mentions_power_of_element(&d.value))
}

/// Returns the power of slipping contacts, by their names: that of their friction, which follows from the
/// normal force.
pub fn slipping_powers<'g>(model: &Model<'g>) -> Vec<(String, ElementPower<'g>)> {
    let g = model.graph;
    let slipping =
        model.constraints.iter().enumerate().filter(|(_, constraint)| !constraint.friction.is_empty());
    let power_of_contact = |(k, constraint): (usize, &Constraint<'g>)| {
        let by_force = constraint.friction.iter().fold(g.zero(), |sum, term| sum + term.share * term.rate);
        let normal = Quantity::Reaction(Quantity::MULTIPLIERS + k).expr(g).apply_function(Function::Abs);
        let contact = constraint.name.split('.').next().unwrap_or(&constraint.name);
        (contact.to_string(), Ok(normal * by_force))
    };
    slipping.map(power_of_contact).collect()
}

/// Returns the power of the forces of an element: products of forces and rates, and the rate of decrease
/// of energies along the motion.
pub fn power_of_element<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    forces: &ElementForces<'g>,
    element: &str,
) -> ElementPower<'g> {
    let m = model;
    if !forces.inertances.is_empty() || !forces.acceleration_forces.is_empty() {
        return Err("its force depends on accelerations");
    }
    let mut power = m.graph.zero();
    for spring in &forces.springs {
        power += -(spring.stiffness
            * (coordinate_as_expression(m.graph, &spring.on) - spring.free)
            * coordinate_velocity(m, &spring.on));
    }
    for dashpot in &forces.dashpots {
        power += -(dashpot.damping * coordinate_velocity(m, &dashpot.on).square());
    }
    for dry in &forces.frictions {
        let speed = coordinate_velocity(m, &dry.on);
        power += -(dry.friction * (speed / m.friction_speed).apply_function(Function::Tanh) * speed);
    }
    for load in &forces.loads {
        power += load.force * load.rate;
    }
    let energies = &forces.potentials;
    if symbols_in(energies).into_iter().any(|s| Quantity::from_symbol(s) == Quantity::Time) {
        return Err("its energy depends on time");
    }
    for energy in energies {
        power += -time_derivative(m.configuration_space(), *energy);
    }
    for function in &forces.dissipations {
        for (k, d) in velocity_gradient(*function) {
            power += -(d * Quantity::Velocity(k).expr(m.graph));
        }
    }
    Ok(power + power_of_input(scope, model, element))
}

/// Returns the power of an input that acts on a coordinate or a body; zero for other names.
pub fn power_of_input<'g>(scope: &Scope<'_, 'g>, model: &Model<'g>, element: &str) -> Expr<'g> {
    let m = model;
    let Some(k) = m.inputs.iter().position(|(name, _)| name == element) else { return m.graph.zero() };
    let u = Quantity::Input(k).expr(m.graph);
    match &m.inputs[k].1 {
        InputEffect::Named => m.graph.zero(),
        InputEffect::Coordinate(c) => u * coordinate_velocity(m, c),
        InputEffect::Sum(all, _) => {
            all.iter().fold(m.graph.zero(), |sum, c| sum + u * coordinate_velocity(m, c))
        }
        InputEffect::Force { link, point, along } => {
            let (linear, angular) = twist_of_link(scope, *link);
            u * (linear + angular.cross(*point)).dot(direction_in_link_axes(scope, *link, along))
        }
        InputEffect::Torque { link, about } => {
            u * twist_of_link(scope, *link).1.dot(direction_in_link_axes(scope, *link, about))
        }
    }
}

/// Returns the velocity of a link's origin and its angular velocity, in the axes of the link.
fn twist_of_link<'g>(scope: &Scope<'_, 'g>, link: LinkId) -> (Vec3<'g>, Vec3<'g>) {
    let kinematics = &scope.kinematics;
    let twist = &kinematics.twists[link.0];
    (twist.linear, twist.angular)
}

fn direction_in_link_axes<'g>(
    scope: &Scope<'_, 'g>,
    link: LinkId,
    direction: &SumOfLinkVectors<'g>,
) -> Vec3<'g> {
    let zero = Vec3::zero(scope.graph);
    scope.kinematics.components_in_link_axes(direction, Some(link), zero)
}

impl<'g> Scope<'_, 'g> {
    /// Resolves `power(element)`: the power, in W, that a force element, an input or a contact supplies to
    /// the bodies. Negative power is dissipated or stored.
    pub fn resolve_power(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let element_names = || self.description.actions.iter().map(|action| action.name.text.as_str());
        let [e] = call.take_arguments(cx)?;
        let Some(name) = e.as_name() else {
            cx.report_error(e.place.clone(), "expected a force element").suggest_name("", element_names());
            return None;
        };
        if !self.check_allowed_quantity(
            AllowedQuantities::Reaction,
            "the power of an element",
            call.place,
            cx,
        ) {
            return None;
        }
        match self.kinematics.powers.get(name) {
            Some(Ok(power)) => Some(Value::Scalar(*power)),
            Some(Err(why)) => {
                cx.report_error(e.place.clone(), format!("the power of `{name}` is not available: {why}"))
                    .add_help("write it as a product of a force and a rate");
                None
            }
            None => {
                // An element with an error has no power; the error has been reported.
                if !element_names().any(|action| action == name) && self.record_first_report(name, cx) {
                    let error = cx.report_error(e.place.clone(), format!("unknown force element `{name}`"));
                    error.suggest_name(name, element_names());
                    if error.has_no_help() {
                        error.add_help(
                            "name a field such as a `Spring`, a `Dashpot`, a `Force` or a `Torque`",
                        );
                    }
                }
                None
            }
        }
    }
}
