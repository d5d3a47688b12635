//! Derivatives of arbitrary expressions of the state, by differentiation along the tangent directions of the
//! configurations.

use super::super::crba::Matrix;
use super::ForceDerivatives;
use crate::expr::Expr;
use crate::expr::diff::DirectionalDerivative;
use crate::kinematics::{configuration_rate, rotation_entries_with_rates};
use crate::mechanics::passive::passive_forces;
use crate::mechanism::{Model, Quantity};

/// Returns the derivatives of expressions with respect to configuration and velocity.
pub fn configuration_and_velocity_derivatives<'g>(model: &Model<'g>, e: &[Expr<'g>]) -> ForceDerivatives<'g> {
    ForceDerivatives { by_q: configuration_derivatives(model, e), by_v: velocity_derivatives(model, e) }
}

/// Returns the derivatives of springs, dashpots, friction, potentials and loads.
pub fn passive_force_state_derivatives<'g>(model: &Model<'g>) -> ForceDerivatives<'g> {
    configuration_and_velocity_derivatives(model, &passive_forces(model, true))
}

/// Adds the derivatives of springs, dashpots, friction, potentials and loads.
pub fn add_passive_force_derivatives<'g>(model: &Model<'g>, out: &mut ForceDerivatives<'g>) {
    let found = passive_force_state_derivatives(model);
    for (to, from) in [(&mut out.by_q, found.by_q), (&mut out.by_v, found.by_v)] {
        for (entry, change) in to.iter_mut().flatten().zip(from.into_iter().flatten()) {
            *entry += change;
        }
    }
}

/// Returns a column for each velocity: the time derivative of the expressions when that velocity is one and
/// all other velocities are zero.
pub fn configuration_derivatives<'g>(model: &Model<'g>, e: &[Expr<'g>]) -> Matrix<'g> {
    let rates: Vec<Expr<'g>> =
        (0..model.nq()).map(|k| configuration_rate(model.configuration_space(), k)).collect();
    let turning = rotation_entries_with_rates(model.configuration_space());
    let configuration_differentiation = |i: usize| {
        let mut by = DirectionalDerivative::with_respect_to(Quantity::Velocity(i).symbol(), model.graph);
        let rate_seed =
            |(k, rate): (usize, &Expr<'g>)| (Quantity::Configuration(k).symbol(), by.differentiate(*rate));
        let own =
            rates.iter().enumerate().map(rate_seed).filter(|(_, rate)| !rate.is_zero()).collect::<Vec<_>>();
        let given = model.passive.iter().flat_map(|passive| passive.force_symbol_position_derivatives(i));
        let known = turning.iter().map(|(entry, rate)| (*entry, by.differentiate(*rate))).collect::<Vec<_>>();
        DirectionalDerivative::differentiation_with_rates(own.into_iter().chain(given).collect(), model.graph)
            .with_preset_derivatives(known)
    };
    derivative_columns(e, (0..model.nv()).map(configuration_differentiation))
}

fn velocity_derivatives<'g>(model: &Model<'g>, e: &[Expr<'g>]) -> Matrix<'g> {
    let velocity_differentiation = |k: usize| {
        let given = model.passive.iter().flat_map(|passive| passive.velocity_derivatives_of_forces(k));
        let own = [(Quantity::Velocity(k).symbol(), model.graph.one())];
        DirectionalDerivative::differentiation_with_rates(own.into_iter().chain(given).collect(), model.graph)
    };
    derivative_columns(e, (0..model.nv()).map(velocity_differentiation))
}

/// Returns the derivatives of expressions with respect to the inputs.
pub fn input_derivatives_of_expressions<'g>(model: &Model<'g>, e: &[Expr<'g>]) -> Matrix<'g> {
    let input_differentiation =
        |k: usize| DirectionalDerivative::with_respect_to(Quantity::Input(k).symbol(), model.graph);
    derivative_columns(e, (0..model.nu()).map(input_differentiation))
}

/// Returns the derivatives of expressions with respect to the accelerations.
pub fn acceleration_derivative_matrix<'g>(model: &Model<'g>, e: &[Expr<'g>]) -> Matrix<'g> {
    let acceleration_derivative =
        |k: usize| DirectionalDerivative::with_respect_to(Quantity::Acceleration(k).symbol(), model.graph);
    derivative_columns(e, (0..model.nv()).map(acceleration_derivative))
}

fn derivative_columns<'g>(
    e: &[Expr<'g>],
    directions: impl Iterator<Item = DirectionalDerivative<'g>>,
) -> Matrix<'g> {
    let mut rows = vec![Vec::new(); e.len()];
    for mut d in directions {
        for (row, e) in rows.iter_mut().zip(e) {
            row.push(if e.constant_value().is_some() { e.zero() } else { d.differentiate(*e) });
        }
    }
    rows
}
