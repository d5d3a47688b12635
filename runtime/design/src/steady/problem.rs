//! Equations of a steady-state problem: unknowns, conditions and derivatives.

use super::Trim;
use crate::Error;
use crate::mechanism::acceleration_names;
use linkwork::{Constrained, Derivatives, Mechanism, OutputDerivatives};
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

/// Residuals of the constraints at a state, with their derivatives.
pub struct ConstraintResiduals {
    pub names: &'static [&'static str],
    /// Position residuals `φ` of the constraints, which belong to the first rows.
    pub residuals: DVector<f64>,
    /// Velocity residuals `J v + …` of the constraints, for all rows.
    pub rates: DVector<f64>,
    /// Constraint Jacobian `J`: one row per constraint, one column per velocity.
    pub jacobian: DMatrix<f64>,
    /// Derivatives of the constraint velocities `J v + …` with respect to the configuration.
    pub rates_by_q: DMatrix<f64>,
}

/// Outputs and their derivatives with respect to configuration, velocity, acceleration and inputs.
pub struct OutputSensitivities {
    pub names: Vec<&'static str>,
    pub values: DVector<f64>,
    pub by_q: DMatrix<f64>,
    pub by_v: DMatrix<f64>,
    pub by_a: DMatrix<f64>,
    pub by_u: DMatrix<f64>,
}

/// Step of central differences at which the sum of rounding error and truncation error is minimal.
const STEP: f64 = 6e-6;

pub fn dynamic_matrix<const R: usize, const C: usize>(m: &SMatrix<f64, R, C>) -> DMatrix<f64> {
    DMatrix::from_column_slice(R, C, m.as_slice())
}

fn to_dynamically_sized_vector<const N: usize>(x: &SVector<f64, N>) -> DVector<f64> {
    DVector::from_column_slice(x.as_slice())
}

pub fn unit_displacement<const N: usize>(k: usize, size: f64) -> SVector<f64, N> {
    SVector::from_fn(|i, _| if i == k { size } else { 0.0 })
}

/// Evaluates the constraints of a mechanism. The derivatives of their velocities with respect to the
/// configuration are not generated for each constraint. Central differences are accurate enough for Newton's
/// method.
pub fn constraint_residuals<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    t: f64,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
) -> ConstraintResiduals
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64>,
{
    let mut rates_by_q = DMatrix::zeros(NC, NV);
    for j in 0..NV {
        let constraint_rates_displaced =
            |h: f64| m.constraint_rates(t, &m.integrate(q, &unit_displacement(j, h)), v);
        rates_by_q.set_column(
            j,
            &to_dynamically_sized_vector(
                &((constraint_rates_displaced(STEP) - constraint_rates_displaced(-STEP)) / (2.0 * STEP)),
            ),
        );
    }
    ConstraintResiduals {
        names: &const { M::CONSTRAINTS },
        residuals: to_dynamically_sized_vector(&m.constraint_residuals(t, q)),
        rates: to_dynamically_sized_vector(&m.constraint_rates(t, q, v)),
        jacobian: dynamic_matrix(&m.constraint_jacobian(t, q)),
        rates_by_q,
    }
}

pub fn output_derivatives<M, const NQ: usize, const NV: usize, const NU: usize, const NY: usize>(
    m: &M,
    t: f64,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    a: &SVector<f64, NV>,
    u: &SVector<f64, NU>,
) -> OutputSensitivities
where
    M: OutputDerivatives<NQ, NV, NU, NY, Scalar = f64>,
{
    let by = m.output_derivatives(t, q, v, a, u);
    OutputSensitivities {
        names: M::OUTPUTS.to_vec(),
        values: to_dynamically_sized_vector(&m.outputs(t, q, v, a, u)),
        by_q: dynamic_matrix(&by.by_q),
        by_v: dynamic_matrix(&by.by_v),
        by_a: dynamic_matrix(&by.by_a),
        by_u: dynamic_matrix(&by.by_u),
    }
}

/// Scalar unknown of a steady-state problem, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnknownQuantity {
    Coordinate(usize),
    Speed(usize),
    Input(usize),
    /// Generalized force that keeps a held coordinate at its value.
    Holding(usize),
    Parameter(usize),
}

/// State of the iteration, with the generalized forces that lock held coordinates.
#[derive(Clone, Debug)]
pub struct TrimState<const NQ: usize, const NV: usize, const NU: usize> {
    pub q: SVector<f64, NQ>,
    pub v: SVector<f64, NV>,
    pub u: SVector<f64, NU>,
    pub holding: SVector<f64, NV>,
    pub parameters: Vec<f64>,
}

/// Accelerations at a state, and their derivatives. The derivatives with respect to `q` and `v` are taken at
/// constant inputs.
pub struct AccelerationDerivatives<const NV: usize, const NU: usize> {
    pub tau: SVector<f64, NV>,
    pub value: SVector<f64, NV>,
    pub by_q: SMatrix<f64, NV, NV>,
    pub by_v: SMatrix<f64, NV, NV>,
    pub by_force: SMatrix<f64, NV, NV>,
    pub by_u: SMatrix<f64, NV, NU>,
    /// Scale above which the derivative of an acceleration is significant; smaller ones are rounding errors.
    /// The scale follows from the accelerations that the constraints remove and from the largest derivative.
    scale: f64,
}

/// Residuals of all steady-state conditions at a state, with their derivatives.
pub struct ConditionResiduals {
    /// Residual of each steady-state condition.
    pub residuals: DVector<f64>,
    /// Derivative of the residuals with respect to the unknowns.
    pub jacobian: DMatrix<f64>,
    /// Minimum derivative of each condition that is distinguishable from rounding error.
    pub floors: Vec<f64>,
}

/// Fraction of the accelerations removed by constraints above which a change per radian is significant.
const TAKEN: f64 = 1e-3;

/// Fraction of the largest derivative above which another derivative is significant.
const BESIDE: f64 = 1e-6;

/// Steady-state problem: a trim whose names have been resolved to indices.
pub struct SteadyProblem<'a, 'm, M, const NQ: usize, const NV: usize, const NU: usize> {
    pub trim: &'a Trim<'m, M, NQ, NV, NU>,
    pub unknowns: Vec<UnknownQuantity>,
    pub held: Vec<usize>,
    /// Required acceleration of each entry; `None` for entries without a condition.
    targets: Vec<Option<f64>>,
    /// Indices of the outputs that the trim prescribes, with their required values.
    outputs: Vec<(usize, f64)>,
}

fn index_of_name(kind: &'static str, name: &str, known: &[&str]) -> Result<usize, Error> {
    known.iter().position(|k| *k == name).ok_or_else(|| Error::Unknown {
        kind,
        name: name.to_string(),
        known: known.iter().map(ToString::to_string).collect(),
    })
}

fn indices_of_names(kind: &'static str, names: &[String], known: &[&str]) -> Result<Vec<usize>, Error> {
    check_repeated_names(kind, names)?;
    names.iter().map(|name| index_of_name(kind, name, known)).collect()
}

/// Returns an error for a repeated name, which would duplicate an unknown or a condition.
fn check_repeated_names(kind: &'static str, names: &[String]) -> Result<(), Error> {
    let twice = names.iter().enumerate().find(|(k, name)| names[..*k].contains(name));
    twice.map_or(Ok(()), |(_, name)| Err(Error::Repeated { kind, name: name.clone() }))
}

fn names_of_pairs<T>(list: &[(String, T)]) -> Vec<String> {
    list.iter().map(|(name, _)| name.clone()).collect()
}

impl<'a, 'm, M, const NQ: usize, const NV: usize, const NU: usize> SteadyProblem<'a, 'm, M, NQ, NV, NU>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    pub fn new(trim: &'a Trim<'m, M, NQ, NV, NU>) -> Result<Self, Error> {
        check_repeated_names("parameter", &names_of_pairs(&trim.parameters))?;
        check_repeated_names("velocity", &names_of_pairs(&trim.accelerations))?;
        check_repeated_names("output", &names_of_pairs(&trim.conditions))?;
        let quantities: Vec<String> = trim.quantities.iter().map(|(name, ..)| name.clone()).collect();
        check_repeated_names("condition", &quantities)?;
        let held = indices_of_names("coordinate", &trim.held, &M::VELOCITIES)?;
        let fixed = indices_of_names("coordinate", &trim.fixed, &M::VELOCITIES)?;
        let among = match &trim.coordinates {
            Some(names) => indices_of_names("coordinate", names, &M::VELOCITIES)?,
            None => (0..NV).collect(),
        };
        let is_free_coordinate = |k: &usize| !held.contains(k) && !fixed.contains(k);
        let first_order = NV.saturating_sub(M::FIRST_ORDER)..NV;
        let places = 0..first_order.start;
        let mut unknowns: Vec<UnknownQuantity> = places
            .filter(|k| among.contains(k) && is_free_coordinate(k))
            .map(UnknownQuantity::Coordinate)
            .collect();
        let mut speeds = indices_of_names("speed", &trim.speeds, &M::VELOCITIES)?;
        let states = first_order.filter(|k| is_free_coordinate(k) && !speeds.contains(k)).collect::<Vec<_>>();
        speeds.extend(states);
        unknowns.extend(speeds.into_iter().map(UnknownQuantity::Speed));
        unknowns.extend(
            indices_of_names("input", &trim.inputs, &M::INPUTS)?.into_iter().map(UnknownQuantity::Input),
        );
        unknowns.extend(held.iter().copied().map(UnknownQuantity::Holding));
        unknowns.extend((0..trim.parameters.len()).map(UnknownQuantity::Parameter));
        let mut targets = vec![Some(0.0); NV];
        for (name, value) in &trim.accelerations {
            targets[index_of_name("velocity", name, &M::VELOCITIES)?] = *value;
        }
        let mut problem = Self { trim, unknowns, held, targets, outputs: Vec::new() };
        if let Some(outputs) = trim.outputs {
            let start = problem.initial_state();
            let zero = SVector::zeros();
            let seen = trim.call_with_mechanism(&start.parameters, |m| {
                outputs(m, trim.t, &start.q, &start.v, &zero, &start.u)
            });
            for (name, value) in &trim.conditions {
                problem.outputs.push((index_of_name("output", name, &seen.names)?, *value));
            }
        }
        Ok(problem)
    }

    pub fn initial_state(&self) -> TrimState<NQ, NV, NU> {
        let Trim { q, v, u, parameters, .. } = self.trim;
        let parameters = parameters.iter().map(|(_, guess)| *guess).collect();
        TrimState { q: *q, v: *v, u: *u, holding: SVector::zeros(), parameters }
    }

    /// Returns the state after changes of the unknowns.
    pub fn displace_state(&self, from: &TrimState<NQ, NV, NU>, by: &DVector<f64>) -> TrimState<NQ, NV, NU> {
        let (mut to, mut dq) = (from.clone(), SVector::zeros());
        for (unknown, by) in self.unknowns.iter().zip(by.iter()) {
            match *unknown {
                UnknownQuantity::Coordinate(k) => dq[k] = *by,
                UnknownQuantity::Speed(k) => to.v[k] += by,
                UnknownQuantity::Input(k) => to.u[k] += by,
                UnknownQuantity::Holding(k) => to.holding[k] += by,
                UnknownQuantity::Parameter(k) => to.parameters[k] += by,
            }
        }
        to.q = self.trim.call_with_mechanism(&to.parameters, |m| m.integrate(&from.q, &dq));
        to
    }

    /// Returns the magnitude to which changes of an unknown are compared: its absolute value, but at least
    /// one unless it is a parameter.
    pub fn magnitude_of_unknown(&self, place: &TrimState<NQ, NV, NU>, unknown: UnknownQuantity) -> f64 {
        match unknown {
            UnknownQuantity::Coordinate(_) => 1.0,
            UnknownQuantity::Speed(k) => place.v[k].abs().max(1.0),
            UnknownQuantity::Input(k) => place.u[k].abs().max(1.0),
            UnknownQuantity::Holding(k) => place.holding[k].abs().max(1.0),
            UnknownQuantity::Parameter(k) => place.parameters[k].abs().max(f64::MIN_POSITIVE),
        }
    }

    pub fn name_of_unknown(&self, unknown: UnknownQuantity) -> String {
        match unknown {
            UnknownQuantity::Coordinate(k) => M::VELOCITIES[k].to_string(),
            UnknownQuantity::Speed(k) => format!("{}'", M::VELOCITIES[k]),
            UnknownQuantity::Input(k) => M::INPUTS[k].to_string(),
            UnknownQuantity::Holding(k) => format!("the force that holds {}", M::VELOCITIES[k]),
            UnknownQuantity::Parameter(k) => self.trim.parameters[k].0.clone(),
        }
    }

    /// Returns the names of the conditions of the steady state, in the order of
    /// [`condition_residuals`](Self::condition_residuals).
    pub fn condition_names(&self, place: &TrimState<NQ, NV, NU>) -> Vec<String> {
        let all = acceleration_names::<M, NQ, NV, NU>();
        let wanted = all.into_iter().zip(&self.targets).filter(|(_, target)| target.is_some());
        let mut names: Vec<String> = wanted.map(|(name, _)| name).collect();
        if let Some(bounds) = self.constraint_residuals(place) {
            names.extend(bounds.names.iter().take(bounds.residuals.len()).map(ToString::to_string));
            names.extend(bounds.names.iter().map(|name| format!("{name}'")));
        }
        names.extend(self.trim.conditions.iter().map(|(name, _)| name.clone()));
        names.extend(self.trim.quantities.iter().map(|(name, ..)| name.clone()));
        names
    }

    pub fn constraint_residuals(&self, place: &TrimState<NQ, NV, NU>) -> Option<ConstraintResiduals> {
        let (bounds, _) = self.trim.constraints?;
        Some(self.trim.call_with_mechanism(&place.parameters, |m| bounds(m, self.trim.t, &place.q, &place.v)))
    }

    pub fn accelerations_at(
        &self,
        place: &TrimState<NQ, NV, NU>,
    ) -> Result<AccelerationDerivatives<NV, NU>, Error> {
        let (t, TrimState { q, v, u, holding, parameters }) = (self.trim.t, place);
        self.trim.call_with_mechanism(parameters, |m| {
            let tau = Mechanism::generalized_forces(m, t, q, v, u) + holding;
            let value = Mechanism::try_forward_dynamics(m, t, q, v, &tau)?;
            let (by_q, by_v, by_force) = Derivatives::forward_dynamics_derivatives(m, t, q, v, &tau);
            let (force_by_q, force_by_v, force_by_u) =
                Derivatives::generalized_forces_derivatives(m, t, q, v, u);
            let (by_q, by_v) = (by_q + by_force * force_by_q, by_v + by_force * force_by_v);
            let by_u = by_force * force_by_u;
            // Accelerations without constraints. Zero if the unconstrained mass matrix is not positive
            // definite.
            let push = to_dynamically_sized_vector(&(tau - Mechanism::bias_forces(m, t, q, v)));
            let free = dynamic_matrix(&Mechanism::mass_matrix(m, t, q))
                .cholesky()
                .map_or(0.0, |c| c.solve(&push).amax());
            let free = if M::CONSTRAINED && free.is_finite() { free } else { 0.0 };
            let scale = TAKEN * free + BESIDE * by_q.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            Ok(AccelerationDerivatives { tau, value, by_q, by_v, by_force, by_u, scale })
        })
    }

    /// Computes the residuals of the steady-state conditions and their derivatives with respect to the
    /// unknowns.
    pub fn condition_residuals(&self, place: &TrimState<NQ, NV, NU>) -> Result<ConditionResiduals, Error> {
        let mut equations = self.residuals_with_generated_derivatives(place)?;
        for (j, unknown) in self.unknowns.iter().enumerate() {
            let UnknownQuantity::Parameter(k) = *unknown else { continue };
            let step = STEP * if place.parameters[k] == 0.0 { 1.0 } else { place.parameters[k].abs() };
            let residuals_with_displaced_parameter = |h: f64| {
                let mut place = place.clone();
                place.parameters[k] += h;
                Ok::<_, Error>(self.residuals_with_generated_derivatives(&place)?.residuals)
            };
            equations.jacobian.set_column(
                j,
                &((residuals_with_displaced_parameter(step)? - residuals_with_displaced_parameter(-step)?)
                    / (2.0 * step)),
            );
        }
        Ok(equations)
    }

    /// Computes the residuals of all steady-state conditions, and their derivatives except those with respect
    /// to parameters.
    fn residuals_with_generated_derivatives(
        &self,
        place: &TrimState<NQ, NV, NU>,
    ) -> Result<ConditionResiduals, Error> {
        let motion = self.accelerations_at(place)?;
        let mut rows: Vec<ConditionRow> = Vec::new();
        for (i, target) in self.targets.iter().enumerate() {
            let Some(target) = target else { continue };
            let by = self.row_over_all_unknowns(|unknown| acceleration_derivative(&motion, i, unknown));
            rows.push(ConditionRow { residual: motion.value[i] - target, by, floor: motion.scale });
        }
        if let Some(bounds) = self.constraint_residuals(place) {
            self.push_constraint_rows(&bounds, &mut rows);
        }
        if let Some(outputs) = self.trim.outputs {
            let TrimState { q, v, u, parameters, .. } = place;
            let seen = self
                .trim
                .call_with_mechanism(parameters, |m| outputs(m, self.trim.t, q, v, &motion.value, u));
            self.add_output_condition_rows(&motion, &seen, &mut rows);
        }
        self.push_required_quantity_rows(place, &mut rows);
        let jacobian = DMatrix::from_fn(rows.len(), self.unknowns.len(), |i, j| rows[i].by[j]);
        let residuals = DVector::from_fn(rows.len(), |i, _| rows[i].residual);
        Ok(ConditionResiduals { residuals, jacobian, floors: rows.iter().map(|row| row.floor).collect() })
    }

    fn push_constraint_rows(&self, bounds: &ConstraintResiduals, rows: &mut Vec<ConditionRow>) {
        let derivative_floor = |i: usize| TAKEN * bounds.jacobian.row(i).norm();
        for (i, residual) in bounds.residuals.iter().enumerate() {
            let constraint_residual_derivative = |unknown| match unknown {
                UnknownQuantity::Coordinate(k) => bounds.jacobian[(i, k)],
                _ => 0.0,
            };
            rows.push(ConditionRow {
                residual: *residual,
                by: self.row_over_all_unknowns(constraint_residual_derivative),
                floor: derivative_floor(i),
            });
        }
        for (i, rate) in bounds.rates.iter().enumerate() {
            let constraint_rate_derivative = |unknown| match unknown {
                UnknownQuantity::Coordinate(k) => bounds.rates_by_q[(i, k)],
                UnknownQuantity::Speed(k) => bounds.jacobian[(i, k)],
                _ => 0.0,
            };
            rows.push(ConditionRow {
                residual: *rate,
                by: self.row_over_all_unknowns(constraint_rate_derivative),
                floor: derivative_floor(i),
            });
        }
    }

    fn add_output_condition_rows(
        &self,
        motion: &AccelerationDerivatives<NV, NU>,
        seen: &OutputSensitivities,
        rows: &mut Vec<ConditionRow>,
    ) {
        for (i, value) in &self.outputs {
            let output_derivative = |unknown| {
                let direct = match unknown {
                    UnknownQuantity::Coordinate(k) => seen.by_q[(*i, k)],
                    UnknownQuantity::Speed(k) => seen.by_v[(*i, k)],
                    UnknownQuantity::Input(k) => seen.by_u[(*i, k)],
                    UnknownQuantity::Holding(_) | UnknownQuantity::Parameter(_) => 0.0,
                };
                (0..NV).fold(direct, |sum, a| {
                    sum + seen.by_a[(*i, a)] * acceleration_derivative(motion, a, unknown)
                })
            };
            let all = [&seen.by_q, &seen.by_v, &seen.by_u].map(|derivative| derivative.row(*i).norm());
            let floor = BESIDE * all.into_iter().fold(0.0, f64::max);
            rows.push(ConditionRow {
                residual: seen.values[*i] - value,
                by: self.row_over_all_unknowns(output_derivative),
                floor,
            });
        }
    }

    fn push_required_quantity_rows(&self, place: &TrimState<NQ, NV, NU>, rows: &mut Vec<ConditionRow>) {
        for (_, wanted, quantity) in &self.trim.quantities {
            let value_of_quantity = |place: &TrimState<NQ, NV, NU>| {
                self.trim
                    .call_with_mechanism(&place.parameters, |m| quantity(m, &place.q, &place.v, &place.u))
            };
            let by: Vec<f64> = (0..self.unknowns.len())
                .map(|k| {
                    let unknown = self.unknowns[k];
                    if matches!(unknown, UnknownQuantity::Holding(_) | UnknownQuantity::Parameter(_)) {
                        return 0.0;
                    }
                    let step = STEP * self.magnitude_of_unknown(place, unknown);
                    let quantity_after_displacement = |h: f64| {
                        value_of_quantity(&self.displace_state(
                            place,
                            &DVector::from_fn(self.unknowns.len(), |i, _| if i == k { h } else { 0.0 }),
                        ))
                    };
                    (quantity_after_displacement(step) - quantity_after_displacement(-step)) / (2.0 * step)
                })
                .collect();
            // Differences of values leave this much rounding.
            let rounding = f64::EPSILON * (value_of_quantity(place).abs() + wanted.abs()) / STEP;
            let floor = BESIDE * by.iter().fold(0.0, |most: f64, x| most.max(x.abs())) + rounding;
            rows.push(ConditionRow { residual: value_of_quantity(place) - wanted, by, floor });
        }
    }

    fn row_over_all_unknowns(&self, by: impl Fn(UnknownQuantity) -> f64) -> Vec<f64> {
        self.unknowns.iter().map(|unknown| by(*unknown)).collect()
    }
}

/// One condition of a steady state: residual, derivatives, and rounding-error floor of the derivatives.
struct ConditionRow {
    residual: f64,
    /// Derivatives of the residual of a condition with respect to the unknowns.
    by: Vec<f64>,
    floor: f64,
}

/// Returns the derivative of acceleration `i` with respect to an unknown; zero for unknown parameters.
fn acceleration_derivative<const NV: usize, const NU: usize>(
    motion: &AccelerationDerivatives<NV, NU>,
    i: usize,
    unknown: UnknownQuantity,
) -> f64 {
    match unknown {
        UnknownQuantity::Coordinate(k) => motion.by_q[(i, k)],
        UnknownQuantity::Speed(k) => motion.by_v[(i, k)],
        UnknownQuantity::Input(k) => motion.by_u[(i, k)],
        UnknownQuantity::Holding(k) => motion.by_force[(i, k)],
        UnknownQuantity::Parameter(_) => 0.0,
    }
}
