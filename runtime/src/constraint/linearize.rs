//! Linearised constrained motion: derivatives of the accelerations, and the linear system in independent
//! coordinates and speeds.

use super::ConstraintError;
use super::layout::MotionDerivatives;
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::{SMatrix, SVector};

/// Linear system of a constrained motion about a state, in independent coordinates and speeds.
///
/// With `NP` independent coordinates and `NS` independent speeds, `ẋ = A x + B δu`. The state `x` contains
/// the displacements of the coordinates (in body axes for ball and free joints), followed by the changes of
/// the speeds; `NX = NP + NS`.
///
/// All other coordinates and speeds follow from the constraints. With velocity constraints, there are more
/// independent coordinates than independent speeds: a rolling wheel can reach positions to which it cannot
/// slide (Neimark and Fufaev, *Dynamics of Nonholonomic Systems*, 1972).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearization<T, const NX: usize, const NU: usize, const NP: usize, const NS: usize> {
    /// System matrix `A` of the linearised motion `ẋ = A x + B δu`.
    pub a: SMatrix<T, NX, NX>,
    /// Input matrix `B` of the linearised motion `ẋ = A x + B δu`.
    pub b: SMatrix<T, NX, NU>,
    /// Independent coordinates, as indices of their rates in `v`.
    pub coordinates: [usize; NP],
    /// Independent generalized speeds of the linearised motion, as indices in `v`.
    pub speeds: [usize; NS],
}

/// Returns the derivatives of the accelerations with respect to `q`, `v` and `τ`. The function `solve`
/// returns the accelerations for given forces and constraint biases.
pub fn constrained_derivatives<T: Real, const NV: usize, const NC: usize>(
    parts: &MotionDerivatives<T, NV, NC>,
    solve: impl Fn(&[T; NV], &[T; NC]) -> SVector<T, NV>,
) -> (SMatrix<T, NV, NV>, SMatrix<T, NV, NV>, SMatrix<T, NV, NV>) {
    let acceleration_derivative_columns = |forces: &[[T; NV]; NV], bias: &[[T; NC]; NV]| {
        matrix_from_column_function(|j| solve(&forces[j].map(|f| -f), &bias[j]))
    };
    let by_force = matrix_from_column_function(|j| {
        solve(&core::array::from_fn(|i| if i == j { T::one() } else { T::zero() }), &[T::zero(); NC])
    });
    (
        acceleration_derivative_columns(&parts.forces_by_q, &parts.bias_by_q),
        acceleration_derivative_columns(&parts.forces_by_v, &parts.bias_by_v),
        by_force,
    )
}

fn matrix_from_column_function<T: Real, const R: usize, const C: usize>(
    column: impl Fn(usize) -> SVector<T, R>,
) -> SMatrix<T, R, C> {
    let mut m = SMatrix::zeros();
    for (j, out) in m.data.0.iter_mut().enumerate() {
        *out = column(j).data.0[0];
    }
    m
}

/// Returns an entry, or zero if the index is out of range. Bounds checks could panic.
fn entry_or_zero<T: Real, const R: usize, const C: usize>(m: &SMatrix<T, R, C>, i: usize, j: usize) -> T {
    m.get((i, j)).copied().unwrap_or(T::zero())
}

fn scale_row<T: Real, const R: usize, const C: usize>(m: &mut SMatrix<T, R, C>, row: usize, by: T) {
    for j in 0..C {
        if let Some(x) = m.get_mut((row, j)) {
            *x *= by;
        }
    }
}

/// Blocks of the linear system of a constrained motion: one row for each velocity, one column for each
/// independent coordinate or speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IndependentBlocks<T, const NV: usize, const NP: usize, const NS: usize> {
    /// Independent coordinates, as indices of their rates in `v`.
    pub coordinates: [usize; NP],
    /// Independent generalized speeds, as indices in `v`.
    pub speeds: [usize; NS],
    /// Derivatives of the displacements' rates with respect to the independent coordinates.
    pub drift: SMatrix<T, NV, NP>,
    /// Derivatives of the displacements' rates with respect to the independent speeds.
    pub gamma: SMatrix<T, NV, NS>,
    /// Derivatives of the accelerations with respect to the independent coordinates.
    pub by_position: SMatrix<T, NV, NP>,
    /// Derivatives of the accelerations with respect to the independent speeds.
    pub by_speed: SMatrix<T, NV, NS>,
}

/// Derivatives of a motion that generated code provides.
pub struct Motion<'a, T, const NV: usize, const NC: usize, const NU: usize> {
    /// Derivatives of the accelerations with respect to `q`.
    pub by_q: SMatrix<T, NV, NV>,
    /// Derivatives of the accelerations with respect to `v`.
    pub by_v: SMatrix<T, NV, NV>,
    /// Derivatives of the accelerations with respect to the inputs.
    pub by_u: SMatrix<T, NV, NU>,
    /// Jacobian `J` of the constraints, one row per constraint.
    pub jacobian: SMatrix<T, NC, NV>,
    /// Derivatives of the constraint rates with respect to `q`.
    pub rates_by_q: SMatrix<T, NC, NV>,
    /// Matrix `δq × v` of the rates of displacements of ball and free joints, whose axes rotate with the
    /// child; zero otherwise.
    pub turning: SMatrix<T, NV, NV>,
    /// Number of holonomic constraints, which come first among the rows of the constraints.
    pub holonomic: usize,
    /// Indices of the velocities that should be chosen as independent.
    pub preferred: &'a [usize],
}

impl<T: Real, const NV: usize, const NC: usize, const NU: usize> Motion<'_, T, NV, NC, NU> {
    /// Returns the linearised motion in independent coordinates and generalized speeds. Returns
    /// [`ConstraintError::Singular`] if the constraints lose rank, because more than `NP` coordinates and
    /// `NS` speeds are then independent.
    pub fn independent<const NX: usize, const NP: usize, const NS: usize>(
        &self,
    ) -> Result<Linearization<T, NX, NU, NP, NS>, ConstraintError> {
        let [positions, speeds] = self.dependent_entry_solutions();
        match positions.independent_count() == NP && speeds.independent_count() == NS {
            true => {
                Ok(self.assemble_linearization(&self.independent_blocks_from_solutions(&positions, &speeds)))
            }
            false => Err(ConstraintError::Singular),
        }
    }

    /// Returns the blocks of the linearised motion in independent coordinates and generalized speeds, whose
    /// numbers are known only at run time: columns behind the independent ones are zero, and indices behind
    /// them are [`usize::MAX`].
    pub fn independent_blocks(&self) -> IndependentBlocks<T, NV, NV, NV> {
        let [positions, speeds] = self.dependent_entry_solutions();
        self.independent_blocks_from_solutions(&positions, &speeds)
    }

    /// Returns the solutions of the constraints for the dependent coordinates and speeds.
    fn dependent_entry_solutions(&self) -> [DependentEntrySolution<T, NV, NC>; 2] {
        let mut on_configurations = self.jacobian;
        for k in self.holonomic..NC {
            scale_row(&mut on_configurations, k, T::zero());
        }
        [
            DependentEntrySolution::new(on_configurations, SMatrix::zeros(), self.preferred),
            DependentEntrySolution::new(self.jacobian, -self.rates_by_q, self.preferred),
        ]
    }

    fn independent_blocks_from_solutions<const NP: usize, const NS: usize>(
        &self,
        positions: &DependentEntrySolution<T, NV, NC>,
        speeds: &DependentEntrySolution<T, NV, NC>,
    ) -> IndependentBlocks<T, NV, NP, NS> {
        let (coordinates, shape) = positions.independent_entries_and_map::<NP>();
        let (free, gamma) = speeds.independent_entries_and_map::<NS>();
        let carried = speeds.particular_solution_matrix() * shape;
        IndependentBlocks {
            coordinates,
            speeds: free,
            drift: self.turning * shape + carried,
            gamma,
            by_position: self.by_q * shape + self.by_v * carried,
            by_speed: self.by_v * gamma,
        }
    }

    /// Returns the linear system whose rows are the independent ones of the blocks.
    fn assemble_linearization<const NX: usize, const NP: usize, const NS: usize>(
        &self,
        blocks: &IndependentBlocks<T, NV, NP, NS>,
    ) -> Linearization<T, NX, NU, NP, NS> {
        let IndependentBlocks { coordinates, speeds, drift, gamma, by_position, by_speed } = blocks;
        let mut a = SMatrix::<T, NX, NX>::zeros();
        let mut b = SMatrix::<T, NX, NU>::zeros();
        for (i, row) in coordinates.iter().chain(speeds).copied().enumerate() {
            for j in 0..NX {
                let value = match (i < NP, j < NP) {
                    (true, true) => entry_or_zero(drift, row, j),
                    (true, false) => entry_or_zero(gamma, row, j - NP),
                    (false, true) => entry_or_zero(by_position, row, j),
                    (false, false) => entry_or_zero(by_speed, row, j - NP),
                };
                if let Some(slot) = a.get_mut((i, j)) {
                    *slot = value;
                }
            }
            for j in (0..NU).filter(|_| i >= NP) {
                if let Some(slot) = b.get_mut((i, j)) {
                    *slot = entry_or_zero(&self.by_u, row, j);
                }
            }
        }
        Linearization { a, b, coordinates: *coordinates, speeds: *speeds }
    }
}

/// Solution of `J x = R y` for dependent entries of `x`, by Gauss–Jordan elimination with complete pivoting.
struct DependentEntrySolution<T, const NV: usize, const NC: usize> {
    left: SMatrix<T, NC, NV>,
    right: SMatrix<T, NC, NV>,
    /// Column of the pivot in each row of the elimination; `None` for a row without a pivot.
    pivots: [Option<usize>; NC],
}

impl<T: Real, const NV: usize, const NC: usize> DependentEntrySolution<T, NV, NC> {
    fn new(mut left: SMatrix<T, NC, NV>, mut right: SMatrix<T, NC, NV>, preferred: &[usize]) -> Self {
        let mut pivots = [None; NC];
        let small = constant::<T>(1e6) * epsilon() * left.amax();
        for _ in 0..NC {
            let largest_pivot = |spare: bool| {
                let mut best = (0, 0, T::zero());
                for j in (0..NV).filter(|j| !(spare && preferred.contains(j))) {
                    for i in (0..NC).filter(|i| pivots[*i].is_none()) {
                        let size = entry_or_zero(&left, i, j).abs();
                        if size > best.2 {
                            best = (i, j, size);
                        }
                    }
                }
                Some(best).filter(|best| best.2 > small)
            };
            let Some((row, column, _)) = largest_pivot(true).or_else(|| largest_pivot(false)) else { break };
            if let Some(pivot) = pivots.get_mut(row) {
                *pivot = Some(column);
            }
            let scale = T::one() / entry_or_zero(&left, row, column);
            scale_row(&mut left, row, scale);
            scale_row(&mut right, row, scale);
            for i in (0..NC).filter(|i| *i != row) {
                let factor = entry_or_zero(&left, i, column);
                for j in 0..NV {
                    let (l, r) = (entry_or_zero(&left, row, j), entry_or_zero(&right, row, j));
                    left[(i, j)] -= factor * l;
                    right[(i, j)] -= factor * r;
                }
            }
        }
        Self { left, right, pivots }
    }

    /// Returns the number of independent entries.
    fn independent_count(&self) -> usize {
        NV - self.pivots.iter().flatten().count()
    }

    /// Returns the indices of at most `N` independent entries, and the matrix that maps them to all entries.
    /// Columns of entries that do not exist are zero.
    fn independent_entries_and_map<const N: usize>(&self) -> ([usize; N], SMatrix<T, NV, N>) {
        let is_not_pivot = |j: &usize| !self.pivots.contains(&Some(*j));
        let mut indices = [usize::MAX; N];
        indices.iter_mut().zip((0..NV).filter(is_not_pivot)).for_each(|(slot, j)| *slot = j);
        let shape = SMatrix::from_fn(|i, j| {
            let index = indices.get(j).copied().unwrap_or(usize::MAX);
            match self.pivots.iter().position(|p| *p == Some(i)) {
                Some(row) => -entry_or_zero(&self.left, row, index),
                None if i == index => T::one(),
                None => T::zero(),
            }
        });
        (indices, shape)
    }

    /// Returns the matrix that maps `y` to the dependent entries, for independent entries of zero.
    fn particular_solution_matrix(&self) -> SMatrix<T, NV, NV> {
        SMatrix::from_fn(|i, j| {
            let row = self.pivots.iter().position(|p| *p == Some(i));
            row.map_or(T::zero(), |row| entry_or_zero(&self.right, row, j))
        })
    }
}
