//! The motion about a steady state, in independent coordinates and speeds.

use super::problem::{Place, Problem, dynamic};
use super::{SteadyState, Trim};
use crate::mechanism::{effective_mass, named, state_names};
use crate::{Error, StateSpace};
use linkwork::{Rheonomic, RheonomicDerivatives};
use nalgebra::DMatrix;

/// Entries of a matrix of constraints below this part of the largest are rounding.
const ROUNDING: f64 = 1e-9;

/// The linear motion before it becomes a system.
pub struct Linear {
    /// Independent coordinates, and how all displacements follow from them.
    pub coordinates: Vec<usize>,
    pub shape: DMatrix<f64>,
    speeds: Vec<usize>,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    /// Changes of the accelerations by displacements.
    pub by_q: DMatrix<f64>,
    pub mass: DMatrix<f64>,
    /// Whether velocities alone are constrained.
    pub is_holonomic: bool,
}

/// `J x = R y` solved for dependent entries of `x`: Gauss–Jordan elimination with complete pivoting.
struct Dependence {
    left: DMatrix<f64>,
    right: DMatrix<f64>,
    /// Row and column of each pivot.
    pivots: Vec<(usize, usize)>,
}

impl Dependence {
    fn of(mut left: DMatrix<f64>, mut right: DMatrix<f64>) -> Self {
        let (rows, columns) = left.shape();
        let mut pivots: Vec<(usize, usize)> = Vec::new();
        let small = ROUNDING * left.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for _ in 0..rows {
            let free = |i: &usize| pivots.iter().all(|(row, _)| row != i);
            let places = (0..rows).filter(free).flat_map(|i| (0..columns).map(move |j| (i, j)));
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

    /// The independent entries, and how all entries follow from them.
    fn free(&self) -> (Vec<usize>, DMatrix<f64>) {
        let columns = self.left.ncols();
        let free: Vec<usize> = (0..columns).filter(|j| self.pivots.iter().all(|(_, c)| c != j)).collect();
        let mut shape = DMatrix::zeros(columns, free.len());
        for (k, j) in free.iter().enumerate() {
            shape[(*j, k)] = 1.0;
            self.pivots.iter().for_each(|(row, column)| shape[(*column, k)] = -self.left[(*row, *j)]);
        }
        (free, shape)
    }

    /// The dependent entries where the independent ones are zero, by `y`.
    fn particular(&self) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.left.ncols(), self.right.ncols());
        self.pivots.iter().for_each(|(row, column)| all.set_row(*column, &self.right.row(*row)));
        all
    }
}

/// Rows of the identity below a matrix.
fn with_rows(m: &DMatrix<f64>, columns: usize, held: &[usize]) -> DMatrix<f64> {
    let mut all = m.clone().resize(m.nrows() + held.len(), columns, 0.0);
    held.iter().enumerate().for_each(|(i, k)| all[(m.nrows() + i, *k)] = 1.0);
    all
}

pub fn linear<M, const NQ: usize, const NV: usize, const NU: usize>(
    trim: &Trim<'_, M, NQ, NV, NU>,
    found: &SteadyState<NQ, NV, NU>,
) -> Result<Linear, Error>
where
    M: RheonomicDerivatives<NQ, NV, NU> + Rheonomic<NQ, NV, NU, Scalar = f64>,
{
    let problem = Problem::new(trim)?;
    let mut place = Place { q: found.q, v: found.v, u: found.u, ..problem.start() };
    place.parameters.clone_from(&found.parameters);
    problem.held.iter().zip(&found.holding).for_each(|(k, (_, force))| place.holding[*k] = *force);
    let motion = problem.motion(&place)?;
    let (mass, turning) = trim.with(&place.parameters, |m| {
        let (turning, _) =
            RheonomicDerivatives::tangent_rate_derivatives(m, &nalgebra::SVector::zeros(), &place.v);
        // The tangent space moves along, so that the bracket counts twice.
        (effective_mass(m, trim.t, &place.q, &place.v), dynamic(&turning) * 2.0)
    });
    let held = &problem.held;
    let by_force = dynamic(&motion.by_force);
    let lock = locked(&by_force, held);
    let (by_q, by_v) = (&lock * dynamic(&motion.by_q), &lock * dynamic(&motion.by_v));
    let by_u = &lock * dynamic(&motion.by_u);
    let empty = DMatrix::zeros(0, NV);
    let bounds = problem.bounds(&place);
    let (jacobian, rates_by_q, holonomic) = bounds
        .as_ref()
        .map_or((&empty, &empty, 0), |bounds| (&bounds.jacobian, &bounds.rates_by_q, bounds.residuals.len()));
    // States of first order have no displacement.
    let placeless: Vec<usize> = held.iter().copied().chain(NV.saturating_sub(M::FIRST_ORDER)..NV).collect();
    let on_configurations = with_rows(&jacobian.rows(0, holonomic).clone_owned(), NV, &placeless);
    let rows = on_configurations.nrows();
    let positions = Dependence::of(on_configurations, DMatrix::zeros(rows, NV));
    let on_velocities = with_rows(jacobian, NV, held);
    let right = (-rates_by_q).resize(on_velocities.nrows(), NV, 0.0);
    let velocities = Dependence::of(on_velocities, right);
    let ((coordinates, shape), (speeds, gamma)) = (positions.free(), velocities.free());
    let carried = velocities.particular() * &shape;
    let drift = turning * &shape + &carried;
    let by_position = &by_q * &shape + &by_v * &carried;
    let by_speed = &by_v * &gamma;
    let (np, ns) = (coordinates.len(), speeds.len());
    let row = |i: usize| if i < np { coordinates[i] } else { speeds[i - np] };
    let a = DMatrix::from_fn(np + ns, np + ns, |i, j| match (i < np, j < np) {
        (true, true) => drift[(row(i), j)],
        (true, false) => gamma[(row(i), j - np)],
        (false, true) => by_position[(row(i), j)],
        (false, false) => by_speed[(row(i), j - np)],
    });
    let b = DMatrix::from_fn(np + ns, NU, |i, j| if i < np { 0.0 } else { by_u[(row(i), j)] });
    let is_holonomic = holonomic == jacobian.nrows();
    Ok(Linear { coordinates, shape, speeds, a, b, by_q, mass, is_holonomic })
}

/// What coordinates that are held fast leave of accelerations: `1 − P Lᵀ (L P Lᵀ)⁻¹ L`, with `P` the accelerations by forces.
fn locked(by_force: &DMatrix<f64>, held: &[usize]) -> DMatrix<f64> {
    let n = by_force.nrows();
    let (columns, small) = (by_force.select_columns(held), by_force.select_columns(held).select_rows(held));
    let selected = DMatrix::from_fn(held.len(), n, |i, j| if held[i] == j { 1.0 } else { 0.0 });
    let identity = DMatrix::identity(n, n);
    if held.is_empty() {
        return identity;
    }
    // Coordinates that the constraints hold anyway have no acceleration to take away.
    small
        .pseudo_inverse(1e-12 * by_force.amax())
        .map_or(identity.clone(), |inverse| identity - columns * inverse * selected)
}

impl<M, const NQ: usize, const NV: usize, const NU: usize> Trim<'_, M, NQ, NV, NU>
where
    M: RheonomicDerivatives<NQ, NV, NU> + Rheonomic<NQ, NV, NU, Scalar = f64>,
{
    /// The motion about a steady state as `ẋ = A x + B δu`, in independent coordinates and speeds, which are the outputs, too;
    /// coordinates that are held stay. Its [modes](StateSpace::modes) decide on stability to first order.
    ///
    /// Where velocities were left to [change](Trim::accelerating), `A` is that of an instant; its eigenvalues count all the same
    /// if no force depends on what moves, such as the place and heading of a wheel on a level road.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] where the mass matrix is singular.
    pub fn linear_system(&self, found: &SteadyState<NQ, NV, NU>) -> Result<StateSpace, Error> {
        let Linear { coordinates, speeds, a, b, .. } = linear(self, found)?;
        let names = |all: &[usize]| all.iter().map(|k| M::VELOCITIES[*k]).collect::<Vec<_>>();
        let n = a.nrows();
        let system = StateSpace::new(a, b, DMatrix::identity(n, n), DMatrix::zeros(n, NU))?;
        let first_order = speeds.iter().filter(|k| **k + M::FIRST_ORDER >= NV).count();
        let system = system.with_states(state_names(&names(&coordinates), &names(&speeds), first_order))?;
        Ok(system.with_inputs(named(&M::INPUTS))?.with_states_as_outputs())
    }
}
