//! Linearisation about a steady state, in independent coordinates and velocities.

use super::problem::{SteadyProblem, TrimState, dynamic_matrix};
use super::solve::check_steady;
use super::{SteadyState, Trim};
use crate::mechanism::{
    displacement_signals, effective_mass_at_state, input_signals, signals_of_states, signals_with_units,
};
use crate::{Error, SecondOrderForm, StateSpace};
use linkwork::{Derivatives, OutputDerivatives};
use nalgebra::{DMatrix, SVector};

/// Relative threshold for entries of a constraint matrix: smaller entries are rounding errors.
const ROUNDING: f64 = 1e-9;

/// Linearised motion, before it becomes a state-space system.
pub struct LinearisedMotion {
    /// Indices of the independent coordinates. The matrix `shape` maps their displacements to the
    /// displacements of all coordinates.
    pub coordinates: Vec<usize>,
    pub shape: DMatrix<f64>,
    speeds: Vec<usize>,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    /// Derivative of the accelerations with respect to displacements.
    pub by_q: DMatrix<f64>,
    pub mass: DMatrix<f64>,
    motion: IndependentMotionMaps,
    /// Whether all constraints of the mechanism are holonomic.
    pub is_holonomic: bool,
}

/// Maps from independent coordinates, independent velocities and inputs to the displacements, velocities and
/// accelerations of all coordinates. Outputs are linearised with them.
struct IndependentMotionMaps {
    /// Derivatives of all velocities with respect to the independent coordinates and the independent
    /// velocities.
    velocities: [DMatrix<f64>; 2],
    /// Derivatives of all accelerations with respect to the independent coordinates, the independent
    /// velocities and the inputs.
    accelerations: [DMatrix<f64>; 3],
    acceleration: Vec<f64>,
    parameters: Vec<f64>,
}

/// Reduced form of the equations `J x = R y` for the dependent entries of `x`, by Gauss–Jordan elimination
/// with complete pivoting.
struct DependentEntryElimination {
    left: DMatrix<f64>,
    right: DMatrix<f64>,
    /// Row and column of each pivot of the elimination.
    pivots: Vec<(usize, usize)>,
}

impl DependentEntryElimination {
    fn eliminate_dependent_entries(mut left: DMatrix<f64>, mut right: DMatrix<f64>) -> Self {
        let (rows, columns) = left.shape();
        let mut pivots: Vec<(usize, usize)> = Vec::new();
        let small = ROUNDING * left.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for _ in 0..rows {
            let is_not_pivot_row = |i: &usize| pivots.iter().all(|(row, _)| row != i);
            let places = (0..rows).filter(is_not_pivot_row).flat_map(|i| (0..columns).map(move |j| (i, j)));
            let best = places.max_by(|a, b| left[*a].abs().total_cmp(&left[*b].abs()));
            let Some((row, column)) = best.filter(|place| left[*place].abs() > small) else { break };
            pivots.push((row, column));
            let pivot = left[(row, column)];
            left.row_mut(row).iter_mut().for_each(|x| *x /= pivot);
            right.row_mut(row).iter_mut().for_each(|x| *x /= pivot);
            let (own, own_right) = (left.row(row).clone_owned(), right.row(row).clone_owned());
            for i in (0..rows).filter(|i| *i != row) {
                let factor = left[(i, column)];
                left.row_mut(i).zip_apply(&own, |x, y| *x -= factor * y);
                right.row_mut(i).zip_apply(&own_right, |x, y| *x -= factor * y);
            }
        }
        Self { left, right, pivots }
    }

    /// Returns the indices of the independent entries, and the matrix that maps them to all entries.
    fn independent_entries_and_map(&self) -> (Vec<usize>, DMatrix<f64>) {
        let columns = self.left.ncols();
        let free: Vec<usize> = (0..columns).filter(|j| self.pivots.iter().all(|(_, c)| c != j)).collect();
        let mut shape = DMatrix::zeros(columns, free.len());
        for (k, j) in free.iter().enumerate() {
            shape[(*j, k)] = 1.0;
            self.pivots.iter().for_each(|(row, column)| shape[(*column, k)] = -self.left[(*row, *j)]);
        }
        (free, shape)
    }

    /// Returns the matrix that maps `y` to all entries of `x` for independent entries of zero.
    fn particular_solution_matrix(&self) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.left.ncols(), self.right.ncols());
        self.pivots.iter().for_each(|(row, column)| all.set_row(*column, &self.right.row(*row)));
        all
    }
}

/// Appends unit rows to a constraint matrix, one for each coordinate that is held constant.
fn append_fixed_coordinate_rows(m: &DMatrix<f64>, columns: usize, held: &[usize]) -> DMatrix<f64> {
    let mut all = m.clone().resize(m.nrows() + held.len(), columns, 0.0);
    held.iter().enumerate().for_each(|(i, k)| all[(m.nrows() + i, *k)] = 1.0);
    all
}

pub fn linearise_about_steady_state<M, const NQ: usize, const NV: usize, const NU: usize>(
    trim: &Trim<'_, M, NQ, NV, NU>,
    found: &SteadyState<NQ, NV, NU>,
) -> Result<LinearisedMotion, Error>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    let problem = SteadyProblem::new(trim)?;
    let mut place = TrimState { q: found.q, v: found.v, u: found.u, ..problem.initial_state() };
    place.parameters.clone_from(&found.parameters);
    problem.held.iter().zip(&found.holding).for_each(|(k, (_, force))| place.holding[*k] = *force);
    check_steady(&problem, &place)?;
    let motion = problem.accelerations_at(&place)?;
    let (mass, turning) = trim.call_with_mechanism(&place.parameters, |m| {
        let turning = Derivatives::turning(m, &place.q, &place.v);
        (effective_mass_at_state(m, trim.t, &place.q, &place.v), dynamic_matrix(&turning))
    });
    let held = &problem.held;
    let by_force = dynamic_matrix(&motion.by_force);
    let lock = locking_projector(&by_force, held);
    let (by_q, by_v) = (&lock * dynamic_matrix(&motion.by_q), &lock * dynamic_matrix(&motion.by_v));
    let by_u = &lock * dynamic_matrix(&motion.by_u);
    let empty = DMatrix::zeros(0, NV);
    let bounds = problem.constraint_residuals(&place);
    let (jacobian, rates_by_q, holonomic) = bounds
        .as_ref()
        .map_or((&empty, &empty, 0), |bounds| (&bounds.jacobian, &bounds.rates_by_q, bounds.residuals.len()));
    // States of first order have no displacement coordinate.
    let placeless: Vec<usize> = held.iter().copied().chain(NV.saturating_sub(M::FIRST_ORDER)..NV).collect();
    let on_configurations =
        append_fixed_coordinate_rows(&jacobian.rows(0, holonomic).clone_owned(), NV, &placeless);
    let rows = on_configurations.nrows();
    let positions =
        DependentEntryElimination::eliminate_dependent_entries(on_configurations, DMatrix::zeros(rows, NV));
    let on_velocities = append_fixed_coordinate_rows(jacobian, NV, held);
    let right = (-rates_by_q).resize(on_velocities.nrows(), NV, 0.0);
    let velocities = DependentEntryElimination::eliminate_dependent_entries(on_velocities, right);
    let ((coordinates, shape), (speeds, gamma)) =
        (positions.independent_entries_and_map(), velocities.independent_entries_and_map());
    let carried = velocities.particular_solution_matrix() * &shape;
    let drift = turning * &shape + &carried;
    let by_position = &by_q * &shape + &by_v * &carried;
    let by_speed = &by_v * &gamma;
    let (np, ns) = (coordinates.len(), speeds.len());
    let row_of_state = |i: usize| if i < np { coordinates[i] } else { speeds[i - np] };
    let a = DMatrix::from_fn(np + ns, np + ns, |i, j| match (i < np, j < np) {
        (true, true) => drift[(row_of_state(i), j)],
        (true, false) => gamma[(row_of_state(i), j - np)],
        (false, true) => by_position[(row_of_state(i), j)],
        (false, false) => by_speed[(row_of_state(i), j - np)],
    });
    let b = DMatrix::from_fn(np + ns, NU, |i, j| if i < np { 0.0 } else { by_u[(row_of_state(i), j)] });
    let is_holonomic = holonomic == jacobian.nrows();
    let motion = IndependentMotionMaps {
        velocities: [carried, gamma],
        accelerations: [by_position, by_speed, by_u],
        acceleration: (&lock * dynamic_matrix(&motion.value)).iter().copied().collect(),
        parameters: place.parameters,
    };
    Ok(LinearisedMotion { coordinates, shape, speeds, a, b, by_q, mass, motion, is_holonomic })
}

/// Returns the projector that locks the held coordinates' accelerations: `1 − P Lᵀ (L P Lᵀ)⁻¹ L`, where `P`
/// is the derivative of the accelerations with respect to forces and `L` selects the held coordinates.
fn locking_projector(by_force: &DMatrix<f64>, held: &[usize]) -> DMatrix<f64> {
    let n = by_force.nrows();
    let (columns, small) = (by_force.select_columns(held), by_force.select_columns(held).select_rows(held));
    let selected = DMatrix::from_fn(held.len(), n, |i, j| if held[i] == j { 1.0 } else { 0.0 });
    let identity = DMatrix::identity(n, n);
    if held.is_empty() {
        return identity;
    }
    // Coordinates that the constraints already fix have no acceleration to remove; hence the
    // pseudo-inverse.
    small
        .pseudo_inverse(1e-12 * by_force.amax())
        .map_or(identity.clone(), |inverse| identity - columns * inverse * selected)
}

impl<M, const NQ: usize, const NV: usize, const NU: usize> Trim<'_, M, NQ, NV, NU>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    /// Linearises the motion about a steady state as `ẋ = A x + B δu`, in independent coordinates and
    /// velocities. The outputs are the states. Held coordinates remain locked. The [modes](StateSpace::modes)
    /// of the system decide on stability to first order.
    ///
    /// If accelerations are [unconstrained](Trim::accelerating), `A` is valid at one instant. Its eigenvalues
    /// are meaningful nevertheless if no force depends on the quantities that change, such as the position
    /// and heading of a wheel on a level road.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] if the mass matrix is singular; [`Error::NotSteady`] if the state violates a
    /// condition of this trim, with the condition that is violated most and its residual.
    pub fn linear_system(&self, found: &SteadyState<NQ, NV, NU>) -> Result<StateSpace, Error> {
        let system = Self::system_of_linear_model(&linearise_about_steady_state(self, found)?)?;
        Ok(system.with_inputs(input_signals::<M, NQ, NV, NU>())?.with_states_as_outputs())
    }

    fn system_of_linear_model(
        LinearisedMotion { coordinates, speeds, a, b, .. }: &LinearisedMotion,
    ) -> Result<StateSpace, Error> {
        let n = a.nrows();
        let system = StateSpace::new(a.clone(), b.clone(), DMatrix::identity(n, n), DMatrix::zeros(n, NU))?;
        system.with_states(signals_of_states::<M, NQ, NV, NU>(
            coordinates.iter().copied(),
            speeds.iter().copied(),
        ))
    }

    /// Returns the linearised motion as [`linear_system`](Self::linear_system) does, with the declared
    /// outputs of the mechanism: `y = C x + D δu`. The derivatives of the outputs include the changes of
    /// dependent positions, velocities and accelerations that follow from constraints and held coordinates.
    ///
    /// ```
    /// use linkwork::prelude::*;
    /// use linkwork_design::steady::constrained_equilibrium;
    ///
    /// /// A bead on a parabola, pushed, with an accelerometer.
    /// #[mechanism(gravity = -9.81 * y, derivatives)]
    /// struct Bead {
    ///     #[body(mass = 2)]
    ///     bead: Body,
    ///     #[joint(ground -> bead, along = (x, y))]
    ///     place: Stage,
    ///     #[constraint(place.y == place.x * place.x)]
    ///     wire: Holonomic,
    ///     #[acts(on = place.x)]
    ///     push: Force,
    ///     #[output(dot(a(bead / ground / ground), x))]
    ///     accelerometer: Scalar,
    /// }
    /// let problem = constrained_equilibrium(&Bead {});
    /// let system = problem.measured_system(&problem.find()?)?;
    /// // At the lowest point: ẍ = F / m − 2 g x.
    /// assert_eq!(system.outputs()[0].name, "accelerometer");
    /// assert!((system.d()[(0, 0)] - 0.5).abs() < 1e-12 && (system.c()[(0, 0)] + 2.0 * 9.81).abs() < 1e-9);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`linear_system`](Self::linear_system).
    pub fn measured_system<const NY: usize>(
        &self,
        found: &SteadyState<NQ, NV, NU>,
    ) -> Result<StateSpace, Error>
    where
        M: OutputDerivatives<NQ, NV, NU, NY, Scalar = f64>,
    {
        let linear = linearise_about_steady_state(self, found)?;
        let IndependentMotionMaps {
            velocities: [carried, gamma],
            accelerations: [by_position, by_speed, by_u],
            ..
        } = &linear.motion;
        let a = SVector::from_iterator(linear.motion.acceleration.iter().copied());
        let seen = self.call_with_mechanism(&linear.motion.parameters, |m| {
            m.output_derivatives(self.t, &found.q, &found.v, &a, &found.u)
        });
        let [of_q, of_v, of_a] = [&seen.by_q, &seen.by_v, &seen.by_a].map(dynamic_matrix);
        let by_positions = &of_q * &linear.shape + &of_v * carried + &of_a * by_position;
        let by_speeds = &of_v * gamma + &of_a * by_speed;
        let np = by_positions.ncols();
        let c = DMatrix::from_fn(NY, np + by_speeds.ncols(), |i, j| {
            if j < np { by_positions[(i, j)] } else { by_speeds[(i, j - np)] }
        });
        let d = dynamic_matrix(&seen.by_u) + of_a * by_u;
        let names = Self::system_of_linear_model(&linear)?;
        let system = StateSpace::new(linear.a, linear.b, c, d)?.with_states(names.states().to_vec())?;
        let outputs = signals_with_units(&M::OUTPUTS, &M::OUTPUT_UNITS);
        system.with_inputs(input_signals::<M, NQ, NV, NU>())?.with_outputs(outputs)
    }

    /// Returns the second-order form of the motion about a steady state,
    /// `M δq̈ + (D + G) δq̇ + (K + N) δq = B δu`, in independent coordinates: `M = Γᵀ M₀ Γ`, where `M₀` is
    /// the mass matrix of all coordinates and `Γ` maps the independent velocities to all velocities. `K`
    /// includes the geometric stiffness of the constraint reactions in the steady state.
    ///
    /// With nonholonomic constraints, some coordinates have no independent velocity. They are not part of the
    /// form, and no force may depend on them. Examples are the position and heading of a wheel on a level
    /// road.
    ///
    /// ```
    /// use linkwork::prelude::*;
    /// use linkwork_design::steady::constrained_equilibrium;
    ///
    /// /// A particle on a rod of 0.5 m, whose hinge is in oil.
    /// #[mechanism(gravity = -9.81 * y, derivatives)]
    /// struct Pendulum {
    ///     #[particle(mass = 2)]
    ///     bob: Particle,
    ///     #[joint(ground -> bob, along = (x, y))]
    ///     place: Stage,
    ///     #[constraint(norm(r(bob / ground)) == 0.5)]
    ///     rod: Holonomic,
    ///     #[acts(on = place.x, damping = 3)]
    ///     oil: Dashpot,
    /// }
    /// let problem = constrained_equilibrium(&Pendulum {}).from([0.0, -0.5].into());
    /// let form = problem.second_order_form(&problem.find()?)?;
    /// assert!((form.mass[0] - 2.0).abs() < 1e-12 && (form.damping[0] - 3.0).abs() < 1e-12);
    /// assert!((form.stiffness[0] - 2.0 * 9.81 / 0.5).abs() < 1e-9);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`linear_system`](Self::linear_system); [`Error::NoSecondOrderForm`] if forces depend on a
    /// coordinate without an independent velocity; [`Error::Count`] for a mechanism with states of first
    /// order, which have no second-order form.
    pub fn second_order_form(&self, found: &SteadyState<NQ, NV, NU>) -> Result<SecondOrderForm, Error> {
        if M::FIRST_ORDER > 0 {
            let what = "states of first order";
            return Err(Error::Count { what, expected: 0, found: M::FIRST_ORDER });
        }
        let LinearisedMotion { coordinates, speeds, a, b, mass, motion, .. } =
            linearise_about_steady_state(self, found)?;
        let (np, ns) = (coordinates.len(), speeds.len());
        let speed_name = |k: usize| M::VELOCITIES.get(k).copied().unwrap_or_default().to_owned();
        // For each independent velocity, the position of its coordinate among the independent ones, if
        // any.
        let own: Vec<Option<usize>> =
            speeds.iter().map(|speed| coordinates.iter().position(|k| k == speed)).collect();
        let alone = (0..np).find(|i| {
            let row = a.rows(np, ns).column(*i).clone_owned();
            let size = ROUNDING * a.rows(np, ns).amax().max(1.0);
            !own.contains(&Some(*i)) && row.amax() > size
        });
        if let Some(i) = alone {
            return Err(Error::NoSecondOrderForm { coordinate: speed_name(coordinates[i]) });
        }
        let lost = speeds.iter().zip(&own).find(|(_, place)| place.is_none());
        if let Some((speed, _)) = lost {
            return Err(Error::NoSecondOrderForm { coordinate: speed_name(*speed) });
        }
        let own: Vec<usize> = own.into_iter().flatten().collect();
        let gamma = &motion.velocities[1];
        let mass = gamma.transpose() * mass * gamma;
        // With ẋ = D x + s and ṡ = P x + S s + B u: ẍ = (D + S) ẋ + (P − S D) x + B u.
        let drift = a.view((0, 0), (np, np)).select_rows(&own).select_columns(&own);
        let (by_position, by_speed) =
            (a.view((np, 0), (ns, np)).select_columns(&own), a.view((np, np), (ns, ns)).clone_owned());
        let velocity = -(&mass * (&drift + &by_speed));
        let position = -(&mass * (by_position - by_speed * drift));
        let input = &mass * b.rows(np, ns);
        let form = SecondOrderForm::new(mass, velocity, position, input)?;
        form.with_names(displacement_signals::<M, NQ, NV, NU>(speeds), input_signals::<M, NQ, NV, NU>())
    }
}
