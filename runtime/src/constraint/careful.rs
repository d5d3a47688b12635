//! Rank-revealing solution for accelerations and multipliers of constrained motion. It is used where
//! elimination with a fixed order of pivots would lose digits: with light and heavy bodies in one loop, and
//! in or near singular configurations.

mod passing;

use super::span::{
    ColumnSpan, MassFactorisation, dot, entry_or_zero, norm, orthonormalise_vectors, rounding_threshold,
};
use super::{Constrained, Solution};
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::{SMatrix, SVector};
use passing::largest_magnitude;

/// Structure of a mechanism's constraints, which does not depend on the state.
#[derive(Clone, Copy, Debug)]
pub struct Structure<'a, const NC: usize> {
    /// Group of each constraint. Constraints of one group are components of one vector equation.
    pub groups: [usize; NC],
    /// Indices of the constraints that determine coordinates without inertia.
    pub determining: &'a [usize],
    /// Number of linearly independent constraints in regular (nonsingular) configurations.
    pub rank: usize,
}

/// Returns `v̇` and the multipliers of minimum norm: `M v̇ + h = τ + Jᵀ λ`, `J v̇ = −b`, for any masses and
/// in any configuration.
///
/// In a singular configuration, fewer constraints are independent than in regular ones, and `J v̇ = −b` does
/// not determine accelerations that are determined shortly before and after. Close to it, accelerations
/// follow from differences of rounded numbers. There, the result is that of the motion that passes through,
/// whose accelerations are continuous. At rest, the branches cannot be distinguished; then the result is the
/// least deviation from free motion in the metric of the kinetic energy (Gauss's principle).
#[cold]
#[inline(never)]
pub fn rank_revealing_dynamics<
    M,
    T: Real,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    mechanism: &M,
    structure: &Structure<'_, NC>,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    tau: &SVector<T, NV>,
) -> Solution<T, NV, NC>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let system = DynamicsEquations::at_state(mechanism, t, (q, v), tau);
    let (least, regular) = system.solve_with_rows_above_magnitude(
        structure,
        well_conditioned_threshold(),
        DependentRowTreatment::Dropped,
    );
    if regular {
        return least;
    }
    if let Some(clear) = DynamicsEquations::<T, NV, NC>::reliable_row_magnitude_for_acceleration(v, &least.0)
    {
        let (taken, regular) =
            system.solve_with_rows_above_magnitude(structure, clear, DependentRowTreatment::Dropped);
        // The threshold depends on the accelerations that the constraints permit, not on those that they
        // prevent.
        let ratio = epsilon::<T>().sqrt() * largest_magnitude(&least.0) / largest_magnitude(&taken.0);
        let enough = DynamicsEquations::<T, NV, NC>::reliable_row_magnitude_for_acceleration(v, &taken.0)
            .map(|clear| clear.max(ratio))
            .filter(|clear| *clear < well_conditioned_threshold());
        if regular
            && enough.is_some_and(|enough| {
                enough <= clear
                    || system
                        .solve_with_rows_above_magnitude(structure, enough, DependentRowTreatment::Dropped)
                        .1
            })
        {
            return taken;
        }
    }
    let start = system
        .solve_with_rows_above_magnitude(
            structure,
            constant::<T>(4.0) * epsilon::<T>().sqrt(),
            DependentRowTreatment::Dropped,
        )
        .0
        .0;
    let passing = passing::acceleration_past_singularity(mechanism, structure, t, (q, v), &system, &start);
    system
        .solve_with_rows_above_magnitude(
            structure,
            well_conditioned_threshold(),
            passing.map_or(DependentRowTreatment::Taken, DependentRowTreatment::Known),
        )
        .0
}

/// Returns the relative magnitude above which constraint rows are well-conditioned; entries are relative to
/// the numbers that they were computed from. A configuration is regular if all independent rows are
/// well-conditioned.
fn well_conditioned_threshold<T: Real>() -> T {
    epsilon::<T>().cbrt().sqrt()
}

/// Returns accelerations and multipliers for forces and biases: `M x = f + Jᵀ λ`, `J x = −b`. Near a singular
/// configuration, a residual is removed only if it is larger than rounding errors of the configuration cause,
/// and larger than the configuration's distance from its branch. Removing smaller residuals would require
/// large changes of velocity.
#[cold]
#[inline(never)]
pub fn careful_response<
    M,
    T: Real,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    mechanism: &M,
    structure: &Structure<'_, NC>,
    t: T,
    q: &SVector<T, NQ>,
    force: &[T; NV],
    bias: &[T; NC],
) -> Solution<T, NV, NC>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let (mass, jacobian) = (mechanism.mass_matrix(t, q), mechanism.constraint_jacobian(t, q));
    let both = DynamicsEquations { mass, jacobian, force: *force, bias: *bias };
    let (found, regular) = both.solve_with_rows_above_magnitude(
        structure,
        well_conditioned_threshold(),
        DependentRowTreatment::Dropped,
    );
    if regular {
        return found;
    }
    let gap = bias.iter().fold(T::zero(), |most, b| most.max(b.abs()));
    let left = mechanism.constraint_residuals(t, q);
    // Whether the bias is the residual of the configuration, which is to be projected, and not that of a
    // rate.
    let apart = (0..NH).fold(T::zero(), |most, k| {
        most.max((entry_or_zero(&left.data.0[0], k) - entry_or_zero(bias, k)).abs())
    });
    let is_place = largest_magnitude(&left) > T::zero() && apart <= largest_magnitude(&left) * constant(0.5);
    // If positions have the error ε, a row of relative magnitude σ has a direction error of ε / σ².
    let reach = q.iter().fold(T::one(), |most, q| most.max(q.abs()));
    let (known, root) = (constant::<T>(16.0) * epsilon::<T>() * reach, epsilon::<T>().sqrt());
    let turned = if is_place && gap > root { T::zero() } else { minimum_reliable_row_magnitude(&left) };
    let rounded = if is_place || gap > root { T::zero() } else { known / gap };
    let least = root.max(rounded).max(turned);
    let weak = if least < well_conditioned_threshold() {
        DependentRowTreatment::Down(least)
    } else {
        DependentRowTreatment::Dropped
    };
    let correction = DynamicsEquations { force: [T::zero(); NV], ..both }
        .solve_with_rows_above_magnitude(structure, well_conditioned_threshold(), weak)
        .0;
    if force.iter().all(|f| *f == T::zero()) {
        return correction;
    }
    // All rows with a known direction contribute to the response to forces.
    let answer = DynamicsEquations { bias: [T::zero(); NC], ..both };
    let answer = answer
        .solve_with_rows_above_magnitude(
            structure,
            well_conditioned_threshold(),
            DependentRowTreatment::Down(known.sqrt().max(turned)),
        )
        .0;
    (answer.0 + correction.0, answer.1 + correction.1)
}

/// Returns the minimum relative magnitude of constraint rows whose directions are reliable near a singular
/// configuration, for the constraint residuals `left`. With a residual `r`, the configuration is off its
/// branch by `r` / σ. Directions rotate by one radian over the distance σ to the other branch, so their error
/// is `r` / σ².
pub(super) fn minimum_reliable_row_magnitude<T: Real, const NH: usize>(left: &SVector<T, NH>) -> T {
    (constant::<T>(64.0) * largest_magnitude(left).max(epsilon())).sqrt()
}

/// Returns whether a configuration is singular, or so close to a singular one that a step by `dv` changes the
/// constraint rows as much as they differ from linearly dependent ones.
#[cold]
#[inline(never)]
pub fn nearly_singular<
    M,
    T: Real,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    mechanism: &M,
    structure: &Structure<'_, NC>,
    t: T,
    q: &SVector<T, NQ>,
    dv: &SVector<T, NV>,
) -> bool
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let (mass, jacobian) = (mechanism.mass_matrix(t, q), mechanism.constraint_jacobian(t, q));
    let still = DynamicsEquations { mass, jacobian, force: [T::zero(); NV], bias: [T::zero(); NC] };
    let metric = MassFactorisation::new(&still.augmented_mass_and_forces(structure).0);
    let later = mechanism.constraint_jacobian(t, &mechanism.integrate(q, dv));
    let weighted_column_length = |j: &SMatrix<T, NC, NV>, k: usize| {
        norm(&metric.solve_half(core::array::from_fn(|i| entry_or_zero(&j.data.0[i], k))))
    };
    // A configuration is nearly singular if a few such steps would rotate the constraints more than they
    // differ from dependent ones. The rotation is bounded, because a step that rotates all constraints is
    // merely long.
    let (steps, most) = (constant::<T>(3.0), constant::<T>(0.2));
    let change = later - jacobian;
    let turn = (0..NC).fold(T::zero(), |most, k| {
        let own = weighted_column_length(&jacobian, k);
        if own > T::zero() { most.max(weighted_column_length(&change, k) / own) } else { most }
    });
    // In single precision, rows of this magnitude are dropped anyway.
    let least = safe_distance_from_singularity::<T>().min(constant(0.07));
    let clear = (turn * steps).min(most).max(least);
    let mut span = ColumnSpan::new(&metric, &jacobian, &structure.groups);
    span.extend_basis(clear, structure.rank);
    span.rank < structure.rank
}

/// Returns the distance from a singular configuration, m or rad, at which the errors of rounding and of
/// interpolation are about equal.
fn safe_distance_from_singularity<T: Real>() -> T {
    constant::<T>(6.0) * well_conditioned_threshold()
}

/// Returns the relative threshold for rows beyond the rank of regular configurations. States between the
/// steps of an integrator do not satisfy redundant constraints exactly, so these rows are not exactly
/// dependent.
fn redundant_row_threshold<T: Real>() -> T {
    if epsilon::<T>() < constant(1e-10) { constant(1e-4) } else { constant(1e-2) }
}

/// Treatment of nearly dependent constraint rows in the rank-revealing solution.
#[derive(Clone, Copy)]
enum DependentRowTreatment<T, const NV: usize> {
    /// Takes these accelerations along directions that the well-conditioned rows do not determine.
    Known(SVector<T, NV>),
    /// Uses all constraint rows above rounding errors.
    Taken,
    /// Uses the constraint rows above this relative magnitude only.
    Down(T),
    /// Drops nearly dependent constraint rows.
    Dropped,
}

/// Linear equations for the accelerations and multipliers of constrained motion.
#[derive(Clone, Copy)]
struct DynamicsEquations<T, const NV: usize, const NC: usize> {
    mass: SMatrix<T, NV, NV>,
    jacobian: SMatrix<T, NC, NV>,
    force: [T; NV],
    bias: [T; NC],
}

impl<T: Real, const NV: usize, const NC: usize> DynamicsEquations<T, NV, NC> {
    /// Returns the equations of a mechanism at a state.
    fn at_state<M, const NQ: usize, const NU: usize, const NH: usize>(
        mechanism: &M,
        t: T,
        (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
        tau: &SVector<T, NV>,
    ) -> Self
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
    {
        Self::equations_with_total_force(
            mechanism,
            t,
            (q, v),
            (tau - mechanism.bias_forces(t, q, v)).data.0[0],
        )
    }

    /// Returns the equations of a mechanism at a state with the total force `force`, which replaces the bias
    /// forces.
    fn equations_with_total_force<M, const NQ: usize, const NU: usize, const NH: usize>(
        mechanism: &M,
        t: T,
        (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
        force: [T; NV],
    ) -> Self
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
    {
        Self {
            mass: mechanism.mass_matrix(t, q),
            jacobian: mechanism.constraint_jacobian(t, q),
            force,
            bias: mechanism.constraint_bias(t, q, v).data.0[0],
        }
    }

    /// Returns the relative magnitude of rows that determine accelerations like `a` to half of the digits, if
    /// it is below the usual threshold. If constraints are satisfied up to a rounding error ε, rows of
    /// relative magnitude σ cause an acceleration error of ε v² / σ³.
    fn reliable_row_magnitude_for_acceleration(v: &SVector<T, NV>, a: &SVector<T, NV>) -> Option<T> {
        let speed = largest_magnitude(v);
        let clear =
            (constant::<T>(4.0) * epsilon::<T>().sqrt() * speed * speed / largest_magnitude(a)).cbrt();
        (clear < well_conditioned_threshold()).then_some(clear)
    }

    /// Returns accelerations and multipliers, and whether the constraint rows above the relative magnitude
    /// `clear` have the rank of regular configurations.
    fn solve_with_rows_above_magnitude(
        &self,
        structure: &Structure<'_, NC>,
        clear: T,
        weak: DependentRowTreatment<T, NV>,
    ) -> (Solution<T, NV, NC>, bool) {
        let (mass, force) = self.augmented_mass_and_forces(structure);
        let metric = MassFactorisation::new(&mass);
        let mut span = ColumnSpan::new(&metric, &self.jacobian, &structure.groups);
        span.extend_basis(clear, structure.rank);
        let regular = span.rank >= structure.rank;
        match weak {
            _ if regular => span.extend_basis(redundant_row_threshold(), NC),
            DependentRowTreatment::Taken => span.extend_basis(rounding_threshold(), structure.rank),
            DependentRowTreatment::Down(size) => span.extend_basis(size, structure.rank),
            DependentRowTreatment::Known(_) | DependentRowTreatment::Dropped => {}
        }
        let free = span.apply_reflections(&metric.solve_half(force));
        // Known accelerations satisfy nearly dependent rows as well; only their deviation from the
        // well-conditioned rows is solved for. (The biases include the nearly dependent component of each
        // row.)
        let (mut x, bias) = match weak {
            DependentRowTreatment::Known(a) if !regular => (
                span.apply_reflections(&metric.multiply_upper(&a.data.0[0])),
                (self.jacobian * a + SVector::from(self.bias)).data.0[0],
            ),
            _ => (free, self.bias),
        };
        let triangle = TriangularFactor::new(&span);
        let known = triangle.particular_solution(&span, &bias);
        let mut lacking = [T::zero(); NC];
        for (k, ((x, free), known)) in x.iter_mut().zip(&free).zip(&known).enumerate().take(span.rank) {
            *x = match weak {
                DependentRowTreatment::Known(_) if !regular => *x + *known,
                _ => *known,
            };
            if let Some(slot) = lacking.get_mut(k) {
                *slot = *x - *free;
            }
        }
        let a = metric.solve_transposed(span.undo_reflections(x));
        ((SVector::from(a), SVector::from(triangle.minimum_norm_multipliers(&span, &lacking))), regular)
    }

    /// Returns mass matrix and forces, extended for coordinates without inertia. With the rows `J` that
    /// determine these, `(M + w Jᵀ J) v̇ = f − w Jᵀ b + Jᵀ λ` has the same solution for any `w`.
    fn augmented_mass_and_forces(&self, structure: &Structure<'_, NC>) -> ([[T; NV]; NV], [T; NV]) {
        let (mut mass, mut force) = (self.mass.data.0, self.force);
        let weight = (0..NV).fold(T::zero(), |most, k| most.max(mass[k][k]));
        for (row, bias) in self.bias.iter().enumerate().filter(|(row, _)| structure.determining.contains(row))
        {
            for i in 0..NV {
                let heavy = entry_or_zero(&self.jacobian.data.0[i], row) * weight;
                force[i] -= heavy * *bias;
                for j in 0..NV {
                    mass[j][i] += heavy * entry_or_zero(&self.jacobian.data.0[j], row);
                }
            }
        }
        (mass, force)
    }
}

/// Triangular factor `R` of the columns, relative to their lengths; `Rᵀ = U S` if not all columns are in the
/// basis.
struct TriangularFactor<T, const NC: usize> {
    /// Whether all nonzero rows are in the basis.
    full: bool,
    base: [[T; NC]; NC],
    upper: [[T; NC]; NC],
}

impl<T: Real, const NC: usize> TriangularFactor<T, NC> {
    fn new<const NV: usize>(span: &ColumnSpan<T, NV, NC>) -> Self {
        let rank = span.rank;
        let full = span.columns.iter().all(|column| column.length == T::zero() || column.step.is_some());
        if full {
            return Self { full, base: [[T::zero(); NC]; NC], upper: [[T::zero(); NC]; NC] };
        }
        let mut base = core::array::from_fn(|j| span.columns.map(|c| entry_or_zero(&c.x, j) * c.length));
        let upper = orthonormalise_vectors(&mut base, rank);
        Self { full, base, upper }
    }

    /// Solves `Rᵀ z = −b`, in the least-squares sense for a rank-deficient `R`.
    fn particular_solution<const NV: usize>(&self, span: &ColumnSpan<T, NV, NC>, bias: &[T; NC]) -> [T; NC] {
        let rank = span.rank;
        let mut z = [T::zero(); NC];
        if !self.full {
            for j in (0..NC).rev() {
                if j >= rank {
                    continue;
                }
                let sum = -dot(&self.base[j], bias);
                z[j] = (j + 1..NC)
                    .filter(|i| *i < rank)
                    .fold(sum, |sum, i| sum - entry_or_zero(&self.upper[j], i) * entry_or_zero(&z, i))
                    / self.upper[j][j];
            }
            return z;
        }
        for step in 0..NC {
            let Some((k, pivot)) = span.column_of_basis_step(step) else { continue };
            let sum = pivot.x.iter().zip(&z).take(step);
            let rest = sum.fold(-entry_or_zero(bias, k) / pivot.length, |rest, (x, z)| rest - *x * *z);
            if let Some(slot) = z.get_mut(step) {
                *slot = rest / entry_or_zero(&pivot.x, step);
            }
        }
        z
    }

    /// Returns the `λ` of minimum norm with `R λ = d`.
    fn minimum_norm_multipliers<const NV: usize>(
        &self,
        span: &ColumnSpan<T, NV, NC>,
        lacking: &[T; NC],
    ) -> [T; NC] {
        let rank = span.rank;
        let mut lambda = [T::zero(); NC];
        let mut rest = *lacking;
        if !self.full {
            for j in 0..NC {
                if j >= rank {
                    break;
                }
                let part = self
                    .upper
                    .iter()
                    .zip(&rest)
                    .take(j)
                    .fold(rest[j], |sum, (row, rest)| sum - row[j] * *rest)
                    / self.upper[j][j];
                rest[j] = part;
                lambda.iter_mut().zip(&self.base[j]).for_each(|(sum, b)| *sum += part * *b);
            }
            return lambda;
        }
        for step in (0..NC).rev() {
            let Some((k, pivot)) = span.column_of_basis_step(step) else { continue };
            let share = entry_or_zero(&rest, step) / entry_or_zero(&pivot.x, step);
            rest.iter_mut().zip(&pivot.x).take(step).for_each(|(rest, x)| *rest -= share * *x);
            if let Some(slot) = lambda.get_mut(k) {
                *slot = share / pivot.length;
            }
        }
        lambda
    }
}

#[cfg(test)]
mod tests;
