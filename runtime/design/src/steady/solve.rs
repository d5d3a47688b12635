//! Solution of the equations of a steady state by Levenberg–Marquardt steps on the tangent space.

use super::problem::{ConditionResiduals, SteadyProblem, TrimState, UnknownQuantity};
use super::{SteadyState, Trim};
use crate::Error;
use linkwork::Derivatives;
use nalgebra::{DMatrix, DVector};

/// Relative step of the unknowns below which a step is rounding error and the iteration ends.
const ENOUGH: f64 = 1e-14;

/// Maximum residual of the conditions in a solution, relative to their sensitivity to the unknowns.
const LEFT: f64 = 1e-9;

/// Maximum relative residual of a state that is accepted for linearisation. Larger than [`LEFT`], because the
/// conditions are less sensitive at a double root than during the iteration towards it.
const STEADY: f64 = 1e-5;

/// Threshold of singular values, for a matrix whose rows and columns have norm one; smaller singular values
/// count as zero. At a double root, half of the digits of the solution are accurate.
const SINGULAR: f64 = 1e-7;

/// Unknowns whose scaled column norm is below this fraction of the largest have no influence beyond rounding
/// error.
const WITHOUT_INFLUENCE: f64 = 1e-8;

/// Maximum step of a coordinate, rad or m: a larger step would leave the neighbourhood of the guess.
const LONGEST: f64 = 1.0;

/// Maximum number of iterations.
const MOST_ITERATIONS: usize = 200;

/// Damping of Levenberg–Marquardt steps at which steps vanish and the iteration ends.
const DAMPED: f64 = 1e20;

/// Scales of conditions and unknowns of a steady state: the largest norms of rows and columns of the Jacobian
/// during the iteration.
struct EquationScales {
    rows: Vec<f64>,
    columns: Vec<f64>,
}

impl EquationScales {
    fn update_scales(&mut self, equations: &ConditionResiduals, sizes: &[f64]) {
        let ConditionResiduals { jacobian, floors, .. } = equations;
        for ((scale, row), floor) in self.rows.iter_mut().zip(jacobian.row_iter()).zip(floors) {
            let norm = row.iter().zip(sizes).map(|(x, size)| (x * size).powi(2)).sum::<f64>().sqrt();
            *scale = scale.max(norm).max(*floor);
        }
        let weights: Vec<f64> = (0..self.rows.len()).map(|k| self.weight_of_condition(k)).collect();
        for (scale, column) in self.columns.iter_mut().zip(jacobian.column_iter()) {
            let norm = column.iter().zip(&weights).map(|(x, w)| (x * w).powi(2)).sum::<f64>().sqrt();
            *scale = scale.max(norm);
        }
        let most = self.columns.iter().zip(sizes).map(|(norm, size)| norm * size).fold(0.0, f64::max);
        for (scale, size) in self.columns.iter_mut().zip(sizes) {
            *scale = scale.max(WITHOUT_INFLUENCE * most / size);
        }
    }

    /// Returns the weight by which the residual of a condition is multiplied.
    fn weight_of_condition(&self, row: usize) -> f64 {
        if self.rows[row] > 0.0 { 1.0 / self.rows[row] } else { 1.0 }
    }

    fn weighted_residuals(&self, residuals: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(residuals.len(), |i, _| residuals[i] * self.weight_of_condition(i))
    }

    /// Scales the Jacobian: rows by the weights of the conditions, columns by the scales of the unknowns.
    fn scaled_jacobian(&self, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| {
            jacobian[(i, j)] * self.weight_of_condition(i) / self.scale_of_unknown(j)
        })
    }

    fn scale_of_unknown(&self, j: usize) -> f64 {
        if self.columns[j] > 0.0 { self.columns[j] } else { 1.0 }
    }
}

/// Solves the damped least-squares problem `min |A x + r|² + μ |x|²`.
fn damped_least_squares(a: &DMatrix<f64>, r: &DVector<f64>, mu: f64) -> Option<DVector<f64>> {
    let (rows, columns) = a.shape();
    let mut stacked = DMatrix::zeros(rows + columns, columns);
    stacked.view_mut((0, 0), (rows, columns)).copy_from(a);
    stacked.view_mut((rows, 0), (columns, columns)).fill_diagonal(mu.sqrt());
    let mut right = DVector::zeros(rows + columns);
    right.rows_mut(0, rows).copy_from(&-r);
    let qr = stacked.qr();
    qr.r().solve_upper_triangular(&(qr.q().transpose() * right)).filter(|x| x.iter().all(|x| x.is_finite()))
}

/// State, equations and iteration count at the end of the search for a steady state.
struct SteadyStateSearchResult<const NQ: usize, const NV: usize, const NU: usize> {
    place: TrimState<NQ, NV, NU>,
    scales: EquationScales,
    equations: ConditionResiduals,
    iterations: usize,
}

pub fn find<M, const NQ: usize, const NV: usize, const NU: usize>(
    trim: &Trim<'_, M, NQ, NV, NU>,
) -> Result<SteadyState<NQ, NV, NU>, Error>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    let problem = SteadyProblem::new(trim)?;
    let ended = descend_to_solution(&problem)?;
    let SteadyStateSearchResult { place, scales, equations, iterations } = &ended;
    let ConditionResiduals { residuals, jacobian, .. } = equations;
    let left = scales.weighted_residuals(residuals);
    let worst = left.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    if let Some((row, _)) = worst.filter(|(_, left)| left.abs() > LEFT) {
        return Err(Error::NoSteadyState {
            condition: problem.condition_names(place).swap_remove(row),
            residual: residuals[row],
            conditions: residuals.len(),
            unknowns: problem.unknowns.len(),
            place: unknown_names_and_values(&problem, place),
        });
    }
    let open = undetermined_unknowns(&problem, &scales.scaled_jacobian(jacobian));
    if !trim.nearest && !open.is_empty() {
        return Err(Error::Undetermined { unknowns: open, place: unknown_names_and_values(&problem, place) });
    }
    let motion = problem.accelerations_at(place)?;
    let multipliers = trim.constraints.map_or(Vec::new(), |(_, multipliers)| {
        trim.call_with_mechanism(&place.parameters, |m| {
            multipliers(m, trim.t, &place.q, &place.v, &motion.tau)
        })
    });
    let TrimState { q, v, u, holding, parameters } = ended.place.clone();
    let holding = problem.held.iter().map(|k| (M::VELOCITIES[*k].to_string(), holding[*k])).collect();
    let (acceleration, iterations) = (motion.value, *iterations);
    let residual = left.amax();
    Ok(SteadyState { q, v, u, acceleration, parameters, holding, multipliers, iterations, residual })
}

fn unknown_names_and_values<M, const NQ: usize, const NV: usize, const NU: usize>(
    problem: &SteadyProblem<'_, '_, M, NQ, NV, NU>,
    place: &TrimState<NQ, NV, NU>,
) -> Vec<(String, f64)>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    let mut all: Vec<(String, f64)> =
        M::CONFIGURATION.iter().zip(place.q.iter()).map(|(name, x)| (name.to_string(), *x)).collect();
    for unknown in &problem.unknowns {
        let value = match *unknown {
            UnknownQuantity::Coordinate(_) => continue,
            UnknownQuantity::Speed(k) => place.v[k],
            UnknownQuantity::Input(k) => place.u[k],
            UnknownQuantity::Holding(k) => place.holding[k],
            UnknownQuantity::Parameter(k) => place.parameters[k],
        };
        all.push((problem.name_of_unknown(*unknown), value));
    }
    all
}

fn descend_to_solution<M, const NQ: usize, const NV: usize, const NU: usize>(
    problem: &SteadyProblem<'_, '_, M, NQ, NV, NU>,
) -> Result<SteadyStateSearchResult<NQ, NV, NU>, Error>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    let mut place = problem.initial_state();
    let mut equations = problem.condition_residuals(&place)?;
    let is_finite = equations.residuals.iter().chain(equations.jacobian.iter()).all(|x| x.is_finite());
    if !is_finite {
        return Err(Error::NotFinite { what: "the motion at the guess" });
    }
    let (rows, columns) = equations.jacobian.shape();
    let mut scales = EquationScales { rows: vec![0.0; rows], columns: vec![0.0; columns] };
    let (mut mu, mut iterations) = (1e-4, 0);
    while iterations < MOST_ITERATIONS && mu < DAMPED {
        iterations += 1;
        let sizes: Vec<f64> =
            problem.unknowns.iter().map(|u| problem.magnitude_of_unknown(&place, *u)).collect();
        scales.update_scales(&equations, &sizes);
        let (a, r) =
            (scales.scaled_jacobian(&equations.jacobian), scales.weighted_residuals(&equations.residuals));
        let Some(step) = damped_least_squares(&a, &r, mu) else { break };
        let mut change = DVector::from_fn(step.len(), |j, _| step[j] / scales.scale_of_unknown(j));
        let is_rounding = change.iter().zip(&sizes).all(|(x, size)| x.abs() <= ENOUGH * size);
        if is_rounding {
            break;
        }
        let longest = problem.unknowns.iter().zip(change.iter());
        let longest = longest.filter(|(u, _)| matches!(u, UnknownQuantity::Coordinate(_)));
        let longest = longest.map(|(_, x)| x.abs()).fold(0.0, f64::max);
        let part = if longest > LONGEST { LONGEST / longest } else { 1.0 };
        change *= part;
        let next = problem.displace_state(&place, &change);
        // If friction jams or a value is not finite, the step was too long.
        let trial = problem.condition_residuals(&next).ok();
        let weighted_squared_residual =
            |trial: &ConditionResiduals| scales.weighted_residuals(&trial.residuals).norm_squared();
        let better = trial
            .map(|trial| (r.norm_squared() - weighted_squared_residual(&trial), trial))
            .filter(|(gained, _)| *gained > 0.0);
        let Some((gained, trial)) = better else {
            mu = (mu * 10.0).max(1e-12);
            continue;
        };
        let foreseen = r.norm_squared() - (&a * &step * part + &r).norm_squared();
        (place, equations) = (next, trial);
        if gained > 0.75 * foreseen {
            mu = (mu * 0.1).max(f64::MIN_POSITIVE);
        } else if gained < 0.25 * foreseen {
            mu *= 4.0;
        }
    }
    let sizes: Vec<f64> = problem.unknowns.iter().map(|u| problem.magnitude_of_unknown(&place, *u)).collect();
    scales.update_scales(&equations, &sizes);
    Ok(SteadyStateSearchResult { place, scales, equations, iterations })
}

/// Returns an error for a state that violates a condition, with the name of the condition that is violated
/// most.
pub fn check_steady<M, const NQ: usize, const NV: usize, const NU: usize>(
    problem: &SteadyProblem<'_, '_, M, NQ, NV, NU>,
    place: &TrimState<NQ, NV, NU>,
) -> Result<(), Error>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    let equations = problem.condition_residuals(place)?;
    let (rows, columns) = equations.jacobian.shape();
    let mut scales = EquationScales { rows: vec![0.0; rows], columns: vec![0.0; columns] };
    let sizes: Vec<f64> =
        problem.unknowns.iter().map(|unknown| problem.magnitude_of_unknown(place, *unknown)).collect();
    scales.update_scales(&equations, &sizes);
    let left = scales.weighted_residuals(&equations.residuals);
    let worst = left.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    match worst.filter(|(_, left)| left.abs() > STEADY || left.is_nan()) {
        None => Ok(()),
        Some((row, _)) => Err(Error::NotSteady {
            what: problem.condition_names(place).swap_remove(row),
            rate: equations.residuals[row],
        }),
    }
}

/// Returns the names of the unknowns that can change together while all conditions remain satisfied.
fn undetermined_unknowns<M, const NQ: usize, const NV: usize, const NU: usize>(
    problem: &SteadyProblem<'_, '_, M, NQ, NV, NU>,
    scaled: &DMatrix<f64>,
) -> Vec<String>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    /// Fraction of a unit direction above which its component along an unknown is significant.
    const PART: f64 = 0.1;
    let (rows, columns) = scaled.shape();
    // Without unknowns, no direction is undetermined.
    if columns == 0 {
        return Vec::new();
    }
    // Rows of zeros are appended to a wide matrix, so that the decomposition has every direction.
    let square = scaled.clone().resize_vertically(rows.max(columns), 0.0);
    let svd = square.svd(false, true);
    let Some(directions) = svd.v_t else { return Vec::new() };
    let has_negligible_singular_value = |k: &usize| svd.singular_values[*k] <= SINGULAR;
    let takes_part_in_null_direction = |j: &usize| {
        (0..columns).filter(has_negligible_singular_value).any(|k| directions[(k, *j)].abs() > PART)
    };
    (0..columns)
        .filter(takes_part_in_null_direction)
        .map(|j| problem.name_of_unknown(problem.unknowns[j]))
        .collect()
}
