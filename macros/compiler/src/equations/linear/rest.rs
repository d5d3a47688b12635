//! Checks that a declared state is an equilibrium: constraints are satisfied, states are constant, and with
//! suitable multipliers the forces balance. Residuals are proven to be zero as polynomials, or tested
//! numerically at random parameters.

use super::parts::{
    EquilibriumCoefficients, deviation_symbol, expressions_to_linearise as linear_rows, multiplier_symbol,
};
use crate::algebra::factor::remove_rounding_noise;
use crate::algebra::normal::NormalFormCache;
use crate::algebra::polynomial::{Polynomial, Ring};
use crate::algebra::trigonometry::simplify_trigonometry;
use crate::diag::Diagnostics;
use crate::equations::print::PolynomialWriter;
use crate::expr::diff::TINY;
use crate::expr::eval::{Tape, nodes_in_order};
use crate::expr::exact::substitute_with_exact_sines;
use crate::expr::sample::sample_of_symbol;
use crate::expr::{Expr, Extreme, Function, Node, Symbol};
use crate::mechanism::{Chart, DRY_FRICTION, Equilibrium, Model, Quantity, SuppliedQuantity};

/// Maximum number of random parameter sets that are tried in the numeric check.
const TRIALS: u64 = 400;
/// Required number of parameter sets for which all values are finite.
const ENOUGH: usize = 6;
/// Relative magnitude below which the sum of cancelling terms counts as rounding error.
const ROUNDING: f64 = 1e-10;

/// Maximum number of characters of a force in an error message. Longer texts are cut off.
const MAX_FORCE_CHARACTERS: usize = 100;

/// Values of coordinates, inputs, multipliers and states at a declared equilibrium.
pub struct EquilibriumValues<'g> {
    configuration: Vec<Expr<'g>>,
    inputs: Vec<Expr<'g>>,
    multipliers: Vec<Expr<'g>>,
    states: Vec<(usize, Expr<'g>)>,
}

impl<'g> EquilibriumValues<'g> {
    fn new(at: &Equilibrium<'g>) -> EquilibriumValues<'g> {
        EquilibriumValues {
            configuration: at.configuration.clone(),
            inputs: at.inputs.clone(),
            multipliers: Vec::new(),
            states: at.states.iter().map(|state| (state.parameter, state.value)).collect(),
        }
    }

    /// Evaluates expressions at the equilibrium.
    pub fn evaluate_at_equilibrium(&self, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let zero_in_graph_of = |e: &Expr<'g>| Some(e.zero());
        let first = e.first();
        let moved = substitute_with_exact_sines(e, &|s| match Quantity::from_symbol(s) {
            Quantity::Configuration(k) => self.configuration.get(k).copied(),
            Quantity::Input(k) => self.inputs.get(k).copied(),
            Quantity::Given(SuppliedQuantity::Multiplier, k) => self.multipliers.get(k).copied(),
            Quantity::Velocity(_) | Quantity::Acceleration(_) => first.and_then(zero_in_graph_of),
            _ => None,
        });
        substitute_with_exact_sines(&moved, &|s| match Quantity::from_symbol(s) {
            Quantity::Parameter(k) => self.states.iter().find(|(of, _)| *of == k).map(|(_, value)| *value),
            _ => None,
        })
    }

    /// Returns the coordinates, inputs, states and multipliers that may differ from zero, with their values
    /// at rest.
    pub fn nonzero_rest_values(&self, model: &Model<'g>, at: &Equilibrium<'g>) -> Vec<(Quantity, Expr<'g>)> {
        let nv = model.nv();
        // Identity orientations are not printed.
        let lasts: Vec<usize> = first_indices_of_quaternions(model).map(|first| first + 3).collect();
        let is_printed_coordinate =
            |k: &usize| !lasts.contains(k) || self.configuration[*k].constant_value() != Some(1.0);
        let all = (0..self.configuration.len()).filter(is_printed_coordinate);
        let configuration = all.map(|k| (Quantity::Configuration(k), self.configuration[k]));
        let inputs = (0..).map(Quantity::Input).zip(self.inputs.iter().copied());
        let states = at.states.iter().enumerate().map(|(k, state)| (deviation_symbol(nv + k), state.value));
        let multipliers = (0..).map(multiplier_symbol).zip(self.multipliers.iter().copied());
        let all: Vec<(Quantity, Expr<'g>)> =
            configuration.chain(inputs).chain(states).chain(multipliers).collect();
        let (what, values): (Vec<Quantity>, Vec<Expr<'g>>) = all.into_iter().unzip();
        what.into_iter().zip(self.evaluate_at_equilibrium(&values)).collect()
    }
}

/// Error text with advice on how to correct the error.
type ErrorTextWithHelp = (String, &'static str);

/// Checks an equilibrium and determines its multipliers. Returns `None` with an error in `cx` if forces do
/// not balance.
pub fn check_equilibrium<'g>(
    model: &Model<'g>,
    at: &Equilibrium<'g>,
    balance: &[Expr<'g>],
    normal: &mut NormalFormCache<'g>,
    cx: &mut Diagnostics,
) -> Option<EquilibriumValues<'g>> {
    match verified_equilibrium_values(model, at, balance, normal) {
        Ok(rest) => Some(rest),
        Err((what, help)) => {
            cx.report_error(at.place.clone(), what).add_help(help);
            None
        }
    }
}

fn verified_equilibrium_values<'g>(
    model: &Model<'g>,
    at: &Equilibrium<'g>,
    balance: &[Expr<'g>],
    normal: &mut NormalFormCache<'g>,
) -> Result<EquilibriumValues<'g>, ErrorTextWithHelp> {
    let mut rest = EquilibriumValues::new(at);
    let name = &at.name;
    if !model.frictions.is_empty() || model.constraints.iter().any(|c| !c.friction.is_empty()) {
        return Err((format!("dry friction cannot be linearised about `{name}`"), DRY_FRICTION));
    }
    if let Some(k) = index_of_non_unit_quaternion(model, &rest, normal) {
        return Err((
            format!("the quaternion of `{}` in `{name}` has not the length one", model.configuration[k]),
            "its components are those of a unit quaternion; what is not named is an orientation along the \
             axes",
        ));
    }
    let kept = linear_rows(model, balance, at).split_off(balance.len());
    let all: Vec<Expr<'g>> = balance.iter().chain(&kept).copied().collect();
    if let Some(what) = name_of_singular_function_at_rest(&all, &rest) {
        return Err((
            format!("a force has no derivative in `{name}`: `{what}` has a corner there"),
            "declare the equilibrium away from it, or round the corner off",
        ));
    }
    check_stationarity(model, at, &rest, &kept, normal)?;
    let mut left = rest.evaluate_at_equilibrium(balance);
    if !model.constraints.is_empty() {
        (rest.multipliers, left) = solve_for_multipliers(model, &rest, balance).ok_or_else(|| {
            (
                format!("the constraints depend on each other in `{name}`"),
                "their forces are not determined there: leave out those that follow from others",
            )
        })?;
    }
    for (k, force) in left.into_iter().enumerate() {
        check_zero(-force, normal, model).map_err(|left| {
            let velocity = &model.velocities[k].0;
            (
                format!("`{name}` is not an equilibrium: the residual force {left} acts on `{velocity}`"),
                "choose coordinates where it is zero, or hold an input at a value that balances it: \
                 `#[equilibrium(joint = angle, motor = value)]`",
            )
        })?;
    }
    Ok(rest)
}

/// Checks that the constraints are satisfied and remain so at rest, and that the states are constant.
fn check_stationarity<'g>(
    model: &Model<'g>,
    at: &Equilibrium<'g>,
    rest: &EquilibriumValues<'g>,
    kept: &[Expr<'g>],
    normal: &mut NormalFormCache<'g>,
) -> Result<(), ErrorTextWithHelp> {
    let name = &at.name;
    for (c, row) in model.constraints.iter().zip(rest.evaluate_at_equilibrium(kept)) {
        check_zero(row, normal, model).map_err(|left| {
            (
                format!("`{name}` does not satisfy the constraint `{}`: the residual is {left}", c.name),
                "give the coordinates values that fulfil it: `#[equilibrium(joint = value)]`, with \
                 expressions of the parameters",
            )
        })?;
    }
    let rates: Vec<Expr<'g>> = model.constraints.iter().flat_map(|c| [c.rate, c.bias]).collect();
    if rest.evaluate_at_equilibrium(&rates).into_iter().any(|rate| check_zero(rate, normal, model).is_err()) {
        return Err((
            format!("constraints that are driven in time leave `{name}` no rest"),
            "linear equations with constant coefficients need constraints that stay the same",
        ));
    }
    let states: Vec<Expr<'g>> = at.states.iter().map(|state| state.rate).collect();
    for (state, rate) in at.states.iter().zip(rest.evaluate_at_equilibrium(&states)) {
        check_zero(rate, normal, model).map_err(|left| {
            let state = &model.parameters[state.parameter];
            (
                format!("the state `{state}` changes in `{name}`: its rate is {left}"),
                "give it the value at which its rate is zero",
            )
        })?;
    }
    Ok(())
}

/// Returns the index of the first component of a quaternion whose length is not one, if any.
fn index_of_non_unit_quaternion<'g>(
    model: &Model<'g>,
    rest: &EquilibriumValues<'g>,
    normal: &mut NormalFormCache<'g>,
) -> Option<usize> {
    first_indices_of_quaternions(model).find(|q| {
        let components = &rest.configuration[*q..q + 4];
        let length = components.iter().fold(model.graph.zero(), |sum, c| sum + c.square());
        check_zero(length - model.graph.one(), normal, model).is_err()
    })
}

/// Returns the indices of the first components of all quaternions.
fn first_indices_of_quaternions(model: &Model<'_>) -> impl Iterator<Item = usize> {
    model.charts.iter().filter_map(Chart::first_quaternion_index).map(|first| first.0)
}

/// Checks that an expression of the parameters is always zero. The error is the nonzero remainder as text.
fn check_zero<'g>(e: Expr<'g>, normal: &mut NormalFormCache<'g>, model: &Model<'g>) -> Result<(), String> {
    let p = normal.normal_form(e).map(|p| remove_rounding_noise(&normal.ring, &p));
    let Some(p) = p.and_then(|p| simplify_trigonometry(&mut normal.ring, &p)) else {
        let tape = Tape::new(&[e]);
        let zero =
            values_at_random_parameters(|seed| Some(tape.evaluate_at(&|s| random_parameter(s, seed))[0]));
        let zero = zero.len() >= ENOUGH && zero.iter().all(|value| value.abs() < ROUNDING);
        return if zero { Ok(()) } else { Err("that".to_string()) };
    };
    if vanishes_identically(&normal.ring, &p) {
        return Ok(());
    }
    let symbol_name = |symbol| super::super::written::name_and_derivative_order(model, &[], symbol).0;
    let text = PolynomialWriter::new(&normal.ring, &symbol_name).format_polynomial(&p);
    Err(match text.chars().count() > MAX_FORCE_CHARACTERS {
        true => format!("`{} …`", text.chars().take(MAX_FORCE_CHARACTERS).collect::<String>().trim_end()),
        false => format!("`{text}`"),
    })
}

/// Whether a polynomial is zero for all parameters: it has no terms, or its terms cancel numerically.
pub fn vanishes_identically(ring: &Ring, p: &Polynomial) -> bool {
    let parts: Vec<Polynomial> = p.terms.iter().map(|t| Polynomial { terms: vec![*t] }).collect();
    let relative_residual = |seed: u64| {
        let values: Vec<f64> =
            parts.iter().map(|part| ring.evaluate_polynomial(part, &|s| random_parameter(s, seed))).collect();
        let size: f64 = values.iter().map(|value| value.abs()).sum();
        Some(values.iter().sum::<f64>() / size)
    };
    if parts.is_empty() {
        return true;
    }
    let found = values_at_random_parameters(relative_residual);
    found.len() >= ENOUGH && found.iter().all(|part| part.abs() < ROUNDING)
}

/// Returns the first [`ENOUGH`] finite values at random parameters, or fewer if not enough are finite.
pub fn values_at_random_parameters(value: impl Fn(u64) -> Option<f64>) -> Vec<f64> {
    (0..TRIALS).filter_map(value).filter(|value| value.is_finite()).take(ENOUGH).collect()
}

/// Returns a random positive value for a parameter. Values of later seeds deviate further from one.
pub fn random_parameter(s: Symbol, seed: u64) -> f64 {
    libm::pow(sample_of_symbol(s, seed), (1 + (seed / 20).min(6)) as f64)
}

/// Returns the name of a function whose argument at rest is at a kink, a jump, or a point with an infinite
/// derivative.
fn name_of_singular_function_at_rest<'g>(
    e: &[Expr<'g>],
    rest: &EquilibriumValues<'g>,
) -> Option<&'static str> {
    let graph = e.first()?.graph();
    let mut suspects: Vec<(&'static str, Expr<'g>)> = Vec::new();
    for id in nodes_in_order(graph, e) {
        let expression_of_id = |id| graph.expr(id);
        match graph.node(id) {
            Node::Call(f @ (Function::Abs | Function::Signum | Function::Sqrt), a) => {
                suspects.push((f.function_name(), expression_of_id(a)));
            }
            Node::Extreme(f, a, b) => {
                let name = if f == Extreme::Max { "max" } else { "min" };
                suspects.push((name, expression_of_id(a) - expression_of_id(b)));
            }
            _ => {}
        }
    }
    let depends_on_motion = |e: &Expr<'_>| {
        let symbols = crate::kinematics::symbols_in(&[*e]);
        symbols.into_iter().any(|s| {
            matches!(
                Quantity::from_symbol(s),
                Quantity::Configuration(_) | Quantity::Velocity(_) | Quantity::Input(_)
            )
        })
    };
    suspects.retain(|(_, argument)| depends_on_motion(argument));
    let arguments: Vec<Expr<'g>> = suspects.iter().map(|(_, argument)| *argument).collect();
    let values = rest.evaluate_at_equilibrium(&arguments);
    let vanishes_numerically = |value: &Expr<'g>| {
        let tape = Tape::new(&[*value]);
        let found =
            values_at_random_parameters(|seed| Some(tape.evaluate_at(&|s| random_parameter(s, seed))[0]));
        found.len() >= ENOUGH && found.iter().all(|value| value.abs() < ROUNDING)
    };
    suspects.iter().zip(&values).find(|(_, value)| vanishes_numerically(value)).map(|((name, _), _)| *name)
}

/// Returns the multipliers, and the residuals of the force balance with them. `None` if constraints are
/// linearly dependent.
fn solve_for_multipliers<'g>(
    model: &Model<'g>,
    rest: &EquilibriumValues<'g>,
    balance: &[Expr<'g>],
) -> Option<(Vec<Expr<'g>>, Vec<Expr<'g>>)> {
    let g = model.graph;
    let count = model.constraints.len();
    let without = EquilibriumValues {
        multipliers: vec![g.zero(); count],
        configuration: rest.configuration.clone(),
        inputs: rest.inputs.clone(),
        states: rest.states.clone(),
    };
    let right = without.evaluate_at_equilibrium(balance);
    let jacobian: Vec<Vec<Expr<'g>>> = crate::mechanics::constraints::jacobian(model)
        .iter()
        .map(|row| rest.evaluate_at_equilibrium(row))
        .collect();
    // Each row is an equation of Jᵀ λ = force to be balanced.
    let mut rows: Vec<Vec<Expr<'g>>> =
        (0..model.nv()).map(|k| jacobian.iter().map(|row| row[k]).chain([right[k]]).collect()).collect();
    let mut left: Vec<usize> = (0..rows.len()).collect();
    let mut pivots = Vec::new();
    for column in 0..count {
        let pivot_magnitude = |row: usize| minimum_sampled_magnitude(rows[row][column]);
        let best = left.iter().copied().max_by(|a, b| pivot_magnitude(*a).total_cmp(&pivot_magnitude(*b)))?;
        if pivot_magnitude(best) < ROUNDING {
            return None;
        }
        left.retain(|row| *row != best);
        let own: Vec<Expr<'g>> = rows[best].iter().map(|e| *e / rows[best][column]).collect();
        for (k, row) in rows.iter_mut().enumerate() {
            let factor = row[column];
            if k == best || factor.is_zero() {
                continue;
            }
            row.iter_mut().zip(&own).for_each(|(e, own)| *e -= factor * *own);
        }
        rows[best] = own;
        pivots.push(best);
    }
    let multipliers = pivots.iter().map(|row| rows[*row][count]).collect();
    Some((multipliers, left.iter().map(|row| rows[*row][count]).collect()))
}

/// Returns the minimum magnitude of an expression over several random values of the parameters.
fn minimum_sampled_magnitude(e: Expr<'_>) -> f64 {
    let tape = Tape::new(&[e]);
    values_at_random_parameters(|seed| Some(tape.evaluate_at(&|s| random_parameter(s, seed))[0]))
        .into_iter()
        .map(f64::abs)
        .fold(f64::MAX, f64::min)
}

/// Returns the reason why coefficients are not finite; `None` if they are finite.
pub fn reason_for_infinite_coefficients(all: &EquilibriumCoefficients<'_>) -> Option<&'static str> {
    /// Larger values result from a division by [`TINY`] alone.
    const HUGE: f64 = 1e-6 / TINY;
    let entries: Vec<Expr<'_>> =
        all.orders.iter().chain([&all.inputs, &all.multipliers]).flatten().flatten().copied().collect();
    let tape = Tape::new(&entries);
    let largest_magnitude = |seed: u64| {
        let values = tape.evaluate_at(&|s| random_parameter(s, seed));
        let largest = values.iter().map(|value| value.abs()).fold(0.0, f64::max);
        (values.iter().all(|value| value.is_finite()) && largest < HUGE).then_some(largest)
    };
    let finite = values_at_random_parameters(largest_magnitude).len() >= ENOUGH;
    (!finite).then_some(
        "a distance or an angle from which they are computed is singular there: declare the equilibrium \
         elsewhere, or write the force differently",
    )
}
