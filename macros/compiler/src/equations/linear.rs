//! Equations of motion to first order about a declared equilibrium, in the user's parameters. The unknowns
//! are deviations of plain coordinates; for ball and free joints, small rotations and displacements in body
//! axes, whose rates are the velocities. Constraints are additional equations, with deviations of their
//! multipliers, and so are the rates of first-order states.
//!
//! With the force balance `f(q, v, u, λ) = h − τ − Jᵀ λ` the equations are
//! `M ξ̈ + f_v ξ̇ + f_q ξ + f_u u = Jᵀ λ`, with all coefficients evaluated at rest. The contribution of the
//! multipliers to `f_q` is their geometric stiffness.

use super::{EquationSizeLimits, Simplifier, right_sides};
use crate::algebra::normal::NormalFormCache;
use crate::algebra::polynomial::{Atom, Monomial, Polynomial, Ring};
use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::expr::diff::DirectionalDerivative;
use crate::kinematics::Joint;
use crate::mechanics::crba::Matrix;
use crate::mechanics::derivatives::symbolic;
use crate::mechanics::{added_mass, constraints, rnea, velocity_symbols};
use crate::mechanism::{Equilibrium, Model, Quantity};

mod characteristic;
mod parts;
mod rest;
mod stability;
mod written;

use parts::{EquilibriumCoefficients, expressions_to_linearise, multiplier_symbol, rank_of_symbol};

pub use characteristic::CharacteristicPolynomial;
pub use parts::deviation_symbol;
pub use stability::{Stability, StabilityVerdict};
pub use written::format_linear_equations;

/// The linear equations about an equilibrium as polynomials of one ring.
pub struct LinearisedEquations {
    /// Ring of all polynomials.
    pub ring: Ring,
    /// Left sides of the linear equations, which contain the deviations: a row for each velocity, each
    /// constraint and each state.
    pub motion: Vec<Polynomial>,
    /// Right sides of the linear equations: contributions of inputs and multipliers.
    pub forces: Vec<Polynomial>,
    /// Coordinates, inputs, states and multipliers that are not zero at rest, with their values.
    pub values: Vec<(Quantity, Polynomial)>,
    /// The characteristic polynomial and its stability analysis, for mechanisms with few velocities.
    pub stability: Option<Stability>,
}

/// Derives the linear equations about an equilibrium. `None` with an error in `cx` if the state is not an
/// equilibrium or the equations cannot be printed.
pub fn derive_linear_equations<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    at: &Equilibrium<'g>,
    cx: &mut Diagnostics,
) -> Option<LinearisedEquations> {
    let balance = force_balance(model, joints);
    let mut normal = NormalFormCache::new(model.graph, rank_of_symbol);
    normal.ring.raise_term_limits();
    let rest = rest::check_equilibrium(model, at, &balance, &mut normal, cx)?;
    let all = linearised_equation_coefficients(model, mass, at, &balance, &rest);
    if let Some(what) = rest::reason_for_infinite_coefficients(&all) {
        cx.report_error(at.place.clone(), format!("the forces of `{}` have no derivatives at rest", at.name))
            .add_help(what);
        return None;
    }
    let found = polynomials_of_linear_rows(model, at, &all, &rest, normal);
    if found.is_none() {
        cx.report_error(
            at.place.clone(),
            format!("the linear equations of `{}` are too long to be written", at.name),
        )
        .add_help(
            "the generated function `linearize` has them in numbers; ask for the printed ones of a smaller \
             mechanism",
        );
    }
    let found = found?;
    if found.has_time_varying_coefficients() {
        cx.report_error(
            at.place.clone(),
            format!("`{}` does not stay at rest: its prescribed motion depends on time", at.name),
        )
        .add_help("linear equations with constant coefficients need forces that stay the same");
        return None;
    }
    Some(found.with_stability_conditions(model, &all))
}

/// Returns the force balance `h − τ − Jᵀ λ` for each velocity, with symbols for the multipliers.
fn force_balance<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let bias = rnea::inverse_dynamics(model, joints, &velocity_symbols(model), None);
    bias.into_iter().zip(right_sides(model, joints)).map(|(bias, right)| bias - right).collect()
}

fn linearised_equation_coefficients<'g>(
    model: &Model<'g>,
    mass: &Matrix<'g>,
    at: &Equilibrium<'g>,
    balance: &[Expr<'g>],
    rest: &rest::EquilibriumValues<'g>,
) -> EquilibriumCoefficients<'g> {
    let (g, nv) = (model.graph, model.nv());
    let rows = expressions_to_linearise(model, balance, at);
    let derivatives = symbolic::configuration_and_velocity_derivatives(model, &rows);
    let (mut by_deviation, mut by_rate) = (derivatives.by_q, derivatives.by_v);
    for (s, state) in at.states.iter().enumerate() {
        let mut by = DirectionalDerivative::with_respect_to(Quantity::Parameter(state.parameter).symbol(), g);
        for (k, row) in rows.iter().enumerate() {
            by_deviation[k].push(by.differentiate(*row));
            let own = k == nv + model.constraints.len() + s;
            by_rate[k].push(if own { g.one() } else { g.zero() });
        }
    }
    let mut acceleration_derivative_matrix = vec![vec![g.zero(); nv + at.states.len()]; rows.len()];
    for (row, own) in
        acceleration_derivative_matrix.iter_mut().zip(added_mass::effective_mass_matrix(model, mass))
    {
        row[..nv].copy_from_slice(&own);
    }
    let jacobian = constraints::jacobian(model);
    let zeros = vec![g.zero(); jacobian.len()];
    let multipliers: Matrix<'g> = (0..rows.len())
        .map(|k| if k < nv { jacobian.iter().map(|row| row[k]).collect() } else { zeros.clone() })
        .collect();
    let inputs = symbolic::input_derivatives_of_expressions(model, &rows);
    let evaluate_at_equilibrium =
        |m: Matrix<'g>| -> Matrix<'g> { m.iter().map(|row| rest.evaluate_at_equilibrium(row)).collect() };
    EquilibriumCoefficients {
        orders: [
            evaluate_at_equilibrium(by_deviation),
            evaluate_at_equilibrium(by_rate),
            evaluate_at_equilibrium(acceleration_derivative_matrix),
        ],
        inputs: evaluate_at_equilibrium(inputs),
        multipliers: evaluate_at_equilibrium(multipliers),
    }
}

/// Converts all rows of the linear equations to simplified polynomials. Returns `None` if they are too long.
fn polynomials_of_linear_rows<'g>(
    model: &Model<'g>,
    at: &Equilibrium<'g>,
    all: &EquilibriumCoefficients<'g>,
    rest: &rest::EquilibriumValues<'g>,
    mut normal: NormalFormCache<'g>,
) -> Option<LinearisedEquations> {
    let symbols: [fn(usize) -> Quantity; 3] = [deviation_symbol, Quantity::Velocity, Quantity::Acceleration];
    let (mut motion, mut forces) = (Vec::new(), Vec::new());
    for k in 0..all.inputs.len() {
        let mut left = Polynomial::default();
        // Highest derivatives first: atoms are printed in the order in which they are added.
        for (symbol, coefficients) in symbols.iter().zip(&all.orders).rev() {
            add_coefficients_times_symbols(&mut left, &coefficients[k], *symbol, 1.0, &mut normal)?;
        }
        let mut right = Polynomial::default();
        add_coefficients_times_symbols(&mut right, &all.inputs[k], Quantity::Input, -1.0, &mut normal)?;
        add_coefficients_times_symbols(&mut right, &all.multipliers[k], multiplier_symbol, 1.0, &mut normal)?;
        motion.push(left);
        forces.push(right);
    }
    let values = rest.nonzero_rest_values(model, at);
    let values: Vec<(Quantity, Polynomial)> =
        values.into_iter().map(|(what, e)| Some((what, normal.normal_form(e)?))).collect::<Option<_>>()?;
    let mut short = Simplifier::new(normal.ring, Vec::new(), &EquationSizeLimits::ASKED);
    let motion = motion.iter().map(|p| short.shorten_polynomial(p)).collect::<Option<_>>()?;
    let forces = forces.iter().map(|p| short.shorten_polynomial(p)).collect::<Option<_>>()?;
    let values: Option<Vec<_>> =
        values.iter().map(|(what, p)| Some((*what, short.shorten_polynomial(p)?))).collect();
    let values = values?.into_iter().filter(|(_, p)| !p.terms.is_empty()).collect();
    Some(LinearisedEquations { ring: short.ring, motion, forces, values, stability: None })
}

/// Adds products of coefficients and symbols to a sum.
fn add_coefficients_times_symbols<'g>(
    sum: &mut Polynomial,
    coefficients: &[Expr<'g>],
    symbol: fn(usize) -> Quantity,
    sign: f64,
    normal: &mut NormalFormCache<'g>,
) -> Option<()> {
    for (k, coefficient) in coefficients.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
        let coefficient = normal.normal_form(*coefficient)?;
        let atom = normal.ring.intern_atom_as_monomial(Atom::Symbol(symbol(k).symbol()))?;
        let product = normal.ring.multiply_and_reduce(&coefficient, &Polynomial::from_term(atom, sign))?;
        *sum = normal.ring.add_within_limits(sum, &product)?;
    }
    Some(())
}

impl LinearisedEquations {
    /// Returns whether a coefficient of the linear equations varies in time.
    fn has_time_varying_coefficients(&self) -> bool {
        let time = self.ring.mask_of_selected_atoms(|atom, _| *atom == Atom::Symbol(Quantity::Time.symbol()));
        let time = self.time_dependent_atoms(time);
        let values = self.values.iter().map(|(_, p)| p);
        let mut all = self.motion.iter().chain(&self.forces).chain(values);
        all.any(|p| p.terms.iter().any(|t| t.monomial.intersects_mask(time)))
    }

    /// Returns the mask of the atoms that depend on time, given the mask of time itself.
    fn time_dependent_atoms(&self, time: Monomial) -> Monomial {
        let mut found = time;
        for (k, atom) in self.ring.atoms.iter().enumerate() {
            let contains_found_atoms =
                |p: &Polynomial| p.terms.iter().any(|t| t.monomial.intersects_mask(found));
            let contains = match atom {
                Atom::Symbol(_) => false,
                Atom::Wave(wave) => {
                    let angles = self.ring.angles.iter().zip(wave.angle).filter(|(_, n)| *n != 0);
                    angles.into_iter().any(|(angle, _)| angle.monomial.intersects_mask(found))
                }
                Atom::Inverse(p) | Atom::Call(_, p) => contains_found_atoms(p),
                Atom::Atan2(p, q) | Atom::Power(p, q) | Atom::Extreme(_, p, q) => {
                    contains_found_atoms(p) || contains_found_atoms(q)
                }
                Atom::Table(.., arguments) => arguments.iter().any(contains_found_atoms),
            };
            if contains {
                found = found.union_of_bits(Monomial::power_mask_of_atom(k));
            }
        }
        found
    }

    fn with_stability_conditions<'g>(
        mut self,
        model: &Model<'g>,
        all: &EquilibriumCoefficients<'g>,
    ) -> LinearisedEquations {
        if let Some(characteristic) = characteristic::characteristic_polynomial(model, all) {
            self.stability = stability::analyse_stability(characteristic);
        }
        self
    }
}
