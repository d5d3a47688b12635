//! Derivation of declared outputs: their functions, their Jacobians, and reactions.

use crate::catalogue::{
    self, BY_PARAMETERS, DERIVATIVES, DeclaredFunction, Facts, GeneratedId, JACOBIAN, REACTION, TOUCHED,
};
use crate::expr::Expr;
use crate::expr::diff::DirectionalDerivative;
use crate::kinematics::{symbols_in, time_derivative};
use crate::mechanics::derivatives::symbolic;
use crate::mechanics::reactions;
use crate::mechanism::{Model, OutputExpression, Quantity, UsedQuantities};

/// Returns the functions of all outputs, in order. Mechanisms without dynamics have no reactions.
pub fn declared_output_functions(model: &Model<'_>, facts: &Facts) -> Vec<DeclaredFunction> {
    let functions_of_output = |output: &OutputExpression<'_>| {
        let size = output.values.len();
        let depends_on_quantity = |f: fn(&Quantity) -> bool| {
            symbols_in(&output.values).into_iter().map(Quantity::from_symbol).any(|q| f(&q))
        };
        let touched =
            output.diagram.is_none() && depends_on_quantity(|q| matches!(q, Quantity::ContactForce(_)));
        let follows = touched || output.diagram.is_some() || reactions::contains_reactions(&output.values);
        match (follows, facts.kinematic) {
            (true, true) => Vec::new(),
            (true, false) if touched => {
                vec![catalogue::contact_force_output_function(&output.name, size, facts)]
            }
            (true, false) => {
                vec![catalogue::reaction_output_function(&output.name, size, output.diagram.is_some(), facts)]
            }
            (false, _) => {
                catalogue::output_functions(&output.name, size, quantities_used_by_output(output), facts)
            }
        }
    };
    model.outputs.iter().flat_map(functions_of_output).collect()
}

fn quantities_used_by_output(output: &OutputExpression<'_>) -> UsedQuantities {
    let symbols: Vec<Quantity> = symbols_in(&output.values).into_iter().map(Quantity::from_symbol).collect();
    let depends_on_quantity = |f: fn(&Quantity) -> bool| symbols.iter().any(f);
    UsedQuantities {
        velocities: depends_on_quantity(|q| matches!(q, Quantity::Velocity(_))),
        accelerations: depends_on_quantity(|q| matches!(q, Quantity::Acceleration(_))),
        inputs: depends_on_quantity(|q| matches!(q, Quantity::Input(_))),
    }
}

/// Returns the values of a declared output function.
pub fn output_function_expressions<'g>(model: &Model<'g>, declared: &DeclaredFunction) -> Vec<Expr<'g>> {
    let name = match declared.id {
        GeneratedId::Reaction => declared.name.strip_prefix(REACTION),
        GeneratedId::Touched => declared.name.strip_prefix(TOUCHED),
        GeneratedId::OutputJacobian => declared.name.strip_suffix(JACOBIAN),
        GeneratedId::OutputDerivatives => declared.name.strip_suffix(DERIVATIVES),
        GeneratedId::OutputByParameters => declared.name.strip_suffix(BY_PARAMETERS),
        _ => Some(declared.name.as_str()),
    };
    let Some(output) = model.outputs.iter().find(|output| Some(output.name.as_str()) == name) else {
        return Vec::new();
    };
    match declared.id {
        GeneratedId::Reaction => {
            reactions::replace_reactions(model, &output.values, output.diagram.is_some())
        }
        GeneratedId::OutputJacobian => output_jacobian(model, output),
        GeneratedId::OutputDerivatives => output_derivatives(model, &output.values),
        GeneratedId::OutputByParameters => parameter_derivatives(model, &output.values),
        _ => output.values.clone(),
    }
}

/// Returns the derivatives with respect to configuration, velocity, acceleration and input, each column by
/// column.
fn output_derivatives<'g>(model: &Model<'g>, values: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let by_state = symbolic::configuration_and_velocity_derivatives(model, values);
    let blocks = [
        (by_state.by_q, model.nv()),
        (by_state.by_v, model.nv()),
        (symbolic::acceleration_derivative_matrix(model, values), model.nv()),
        (symbolic::input_derivatives_of_expressions(model, values), model.nu()),
    ];
    let block_entries_by_column = |(rows, width): &(Vec<Vec<Expr<'g>>>, usize)| -> Vec<Expr<'g>> {
        (0..*width).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
    };
    blocks.iter().flat_map(block_entries_by_column).collect()
}

fn parameter_derivatives<'g>(model: &Model<'g>, values: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let parameter_derivative =
        |k| DirectionalDerivative::with_respect_to(Quantity::Parameter(k).symbol(), model.graph);
    let differentiate_output_values = |mut d: DirectionalDerivative<'g>| -> Vec<Expr<'g>> {
        values.iter().map(|e| d.differentiate(*e)).collect()
    };
    (0..model.parameters.len()).flat_map(|k| differentiate_output_values(parameter_derivative(k))).collect()
}

/// Returns the Jacobian column by column: the derivatives of the output with respect to the velocities, or of
/// its time derivative if the output depends only on configuration and time.
fn output_jacobian<'g>(model: &Model<'g>, output: &OutputExpression<'g>) -> Vec<Expr<'g>> {
    let rates: Vec<Expr<'g>> = match quantities_used_by_output(output).velocities {
        true => output.values.clone(),
        false => output.values.iter().map(|e| time_derivative(model.configuration_space(), *e)).collect(),
    };
    let mut entries = Vec::new();
    for k in 0..model.nv() {
        let mut d = DirectionalDerivative::with_respect_to(Quantity::Velocity(k).symbol(), model.graph);
        entries.extend(rates.iter().map(|e| d.differentiate(*e)));
    }
    entries
}
