//! Accelerations in singular configurations, from the motion that passes through them.

use super::{
    DependentRowTreatment, DynamicsEquations, Structure, TriangularFactor, safe_distance_from_singularity,
    well_conditioned_threshold,
};
use crate::Real;
use crate::constraint::Constrained;
use crate::constraint::span::{ColumnSpan, MassFactorisation, norm, rounding_threshold};
use crate::private::{constant, epsilon};
use nalgebra::{SMatrix, SVector};

/// Maximum number of Newton steps for the projection of a point of a path.
const MOST_STEPS: usize = 12;

/// Acceleration and jerk, which describe a motion to third order about an instant.
type AccelerationAndJerk<T, const NV: usize> = (SVector<T, NV>, SVector<T, NV>);

/// Path along the branch of the constraints on which a state is.
struct ConstraintBranchPath<T, const NQ: usize, const NV: usize> {
    t: T,
    q: SVector<T, NQ>,
    v: SVector<T, NV>,
    /// Velocity along the path. If `moves` is true, it is the velocity of the state, and time advances along
    /// the path.
    heading: SVector<T, NV>,
    moves: bool,
}

/// Returns the largest magnitude of the entries of a vector.
pub(super) fn largest_magnitude<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    x.iter().fold(T::zero(), |most, x| most.max(x.abs()))
}

/// Returns the acceleration of the motion that passes through a state. The accelerations that the constraints
/// permit are interpolated from configurations shortly before and after.
///
/// Permitted accelerations are functions of the position on the branch and of the velocity, and change little
/// along the path. Masses and forces are those at the state, because contributions of heavy bodies at rest or
/// of stiff elements may change rapidly along the path. The path leads along the velocity of the state or, at
/// rest, along the acceleration `least`. Returns `None` if the neighbouring configurations are singular as
/// well, or if nothing moves.
pub(super) fn acceleration_past_singularity<
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
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    system: &DynamicsEquations<T, NV, NC>,
    least: &SVector<T, NV>,
) -> Option<SVector<T, NV>>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let (speed, rate) = (largest_magnitude(v), largest_magnitude(least));
    // Only velocities above rounding errors have a direction. If constraints depend on time, slow velocities
    // do not indicate the direction of motion.
    let driven = largest_magnitude(&mechanism.constraint_rates(t, q, &SVector::zeros())) > T::zero();
    let clear = speed > epsilon::<T>().cbrt();
    let moves =
        clear && (!driven || speed * speed > rate * safe_distance_from_singularity::<T>() * constant(0.03));
    let way = ConstraintBranchPath { t, q: *q, v: *v, heading: if moves { *v } else { *least }, moves };
    let (clear, within) = (
        safe_distance_from_singularity::<T>() * constant(0.4),
        well_conditioned_threshold::<T>() * constant(0.5),
    );
    let permitted_accelerations_from_path =
        |way: &ConstraintBranchPath<T, NQ, NV>, parts: &[f64], clear: T| {
            let pace = safe_distance_from_singularity::<T>() / largest_magnitude(&way.heading);
            let goes = pace > T::zero() && pace.is_finite();
            let steps = parts.iter().filter(|_| goes).map(|part| pace * constant(*part));
            steps.into_iter().find_map(|step| {
                way.points_on_path(step, clear).interpolated_accelerations_at_state(mechanism, structure)
            })
        };
    // Other paths and step lengths are tried if the interpolation fails on the first ones.
    permitted_accelerations_from_path(&way, &[1.0, 2.0], clear)
        .or_else(|| {
            permitted_accelerations_from_path(
                &way.path_of_slow_departure(mechanism, structure)?,
                &[1.0, 2.0, 4.0, 8.0, 0.5],
                clear,
            )
        })
        .or_else(|| {
            permitted_accelerations_from_path(
                &way.path_of_slow_departure(mechanism, structure)?.orthogonalised_path(&way),
                &[1.0, 2.0, 4.0, 8.0, 0.5],
                clear,
            )
        })
        .or_else(|| permitted_accelerations_from_path(&way, &[4.0, 16.0], clear))
        .or_else(|| permitted_accelerations_from_path(&way, &[1.0, 0.5, 0.25], within))?
        .acceleration_by_gauss_principle(structure, system)
}

impl<T: Real, const NQ: usize, const NV: usize> ConstraintBranchPath<T, NQ, NV> {
    fn points_on_path(&self, step: T, clear: T) -> PathPoints<'_, T, NQ, NV> {
        PathPoints { way: self, step, clear }
    }

    /// Returns another path along the branch of the constraints, for states with velocities that leave the
    /// singular configuration slowly in comparison with other coordinates. Its direction has components along
    /// all motions that are free shortly before and after.
    fn path_of_slow_departure<M, const NU: usize, const NH: usize, const NC: usize>(
        &self,
        mechanism: &M,
        structure: &Structure<'_, NC>,
    ) -> Option<Self>
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
    {
        let own = safe_distance_from_singularity::<T>() / largest_magnitude(&self.heading);
        let any = SVector::from_fn(|k, _| constant::<T>([1.0, -0.7, 0.9, 0.6, -0.8][k % 5]));
        let still = ConstraintBranchPath { v: SVector::zeros(), moves: false, ..*self };
        let heading = [0.1, 0.3, 1.0, 3.0, 10.0].into_iter().find_map(|part| {
            let points = still.points_on_path(own * constant(part), epsilon::<T>().cbrt());
            let course = (SVector::zeros(), SVector::zeros());
            let free_acceleration_at =
                |h: T| points.permitted_accelerations(mechanism, structure, h, &course);
            Some((free_acceleration_at(-points.step)?.free + free_acceleration_at(points.step)?.free) * any)
        })?;
        let size = largest_magnitude(&heading);
        (size > T::zero()).then(|| ConstraintBranchPath { heading: heading / size, moves: false, ..*self })
    }

    /// Returns the path with its component along another path removed from the direction.
    fn orthogonalised_path(&self, other: &Self) -> Self {
        let part = self.heading.dot(&other.heading) / other.heading.norm_squared();
        ConstraintBranchPath { heading: self.heading - other.heading * part, ..*self }
    }

    /// Returns time and state at distance `h` along the path, projected on the constraints. The projection
    /// uses the Euclidean metric of the coordinates, because heavy bodies would not move in the metric of the
    /// kinetic energy.
    fn projected_state_on_path<M, const NU: usize, const NH: usize, const NC: usize>(
        &self,
        mechanism: &M,
        structure: &Structure<'_, NC>,
        h: T,
        (a, jerk): &AccelerationAndJerk<T, NV>,
    ) -> Option<(T, SVector<T, NQ>, SVector<T, NV>)>
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
    {
        let (half, third) = (constant::<T>(0.5), constant::<T>(1.0 / 3.0));
        let t = if self.moves { self.t + h } else { self.t };
        let displacement = (self.heading + (a + jerk * (h * third)) * (h * half)) * h;
        let later = self.v + (a + jerk * (h * half)) * h;
        let mut q = mechanism.integrate(&self.q, &displacement);
        let mut last = None;
        for _ in 0..MOST_STEPS {
            let residuals = mechanism.constraint_residuals(t, &q);
            let gap = SVector::<T, NC>::from_fn(|k, _| residuals.get(k).copied().unwrap_or(T::zero()));
            let off = largest_magnitude(&gap);
            let room = EuclideanRows::new(
                structure,
                &mechanism.constraint_jacobian(t, &q),
                well_conditioned_threshold(),
            );
            q = mechanism.integrate(&q, &room.minimum_norm_correction(&gap));
            // The last correction is applied even if the residual before it is a rounding error.
            if off <= rounding_threshold() || last.is_some_and(|last| off * constant(2.0) > last) {
                break;
            }
            last = Some(off);
        }
        let room = EuclideanRows::new(
            structure,
            &mechanism.constraint_jacobian(t, &q),
            well_conditioned_threshold(),
        );
        let mut v = later;
        for _ in 0..2 {
            v += room.minimum_norm_correction(&mechanism.constraint_rates(t, &q, &v));
        }
        let left = largest_magnitude(&mechanism.constraint_residuals(t, &q)) <= epsilon::<T>().sqrt();
        (left && v.iter().all(|v| v.is_finite())).then_some((t, q, v))
    }
}

/// Equally spaced points on a path along a branch of the constraints, at multiples of `step`. Constraint rows
/// above the relative magnitude `clear` count as well-conditioned.
struct PathPoints<'a, T, const NQ: usize, const NV: usize> {
    way: &'a ConstraintBranchPath<T, NQ, NV>,
    step: T,
    clear: T,
}

impl<T: Real, const NQ: usize, const NV: usize> PathPoints<'_, T, NQ, NV> {
    /// Returns the accelerations that the constraints permit at distance `h` along the path.
    fn permitted_accelerations<M, const NU: usize, const NH: usize, const NC: usize>(
        &self,
        mechanism: &M,
        structure: &Structure<'_, NC>,
        h: T,
        course: &AccelerationAndJerk<T, NV>,
    ) -> Option<PermittedAccelerations<T, NV>>
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
    {
        let (t, q, v) = self.way.projected_state_on_path(mechanism, structure, h, course)?;
        let room = EuclideanRows::new(structure, &mechanism.constraint_jacobian(t, &q), self.clear);
        let bend = room.minimum_norm_correction(&mechanism.constraint_bias(t, &q, &v));
        let possible = PermittedAccelerations { free: room.null_space_projection(), bend };
        (room.regular && possible.bend.iter().all(|a| a.is_finite())).then_some(possible)
    }

    /// Returns the permitted accelerations at the state itself, interpolated by the polynomial of degree five
    /// through six points of the path.
    fn interpolated_accelerations_at_state<M, const NU: usize, const NH: usize, const NC: usize>(
        &self,
        mechanism: &M,
        structure: &Structure<'_, NC>,
    ) -> Option<PermittedAccelerations<T, NV>>
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
    {
        let (step, half) = (self.step, constant::<T>(0.5));
        let permitted_accelerations_at = |h: T, course: &AccelerationAndJerk<T, NV>| {
            self.permitted_accelerations(mechanism, structure, h, course)
        };
        let mut course = (SVector::zeros(), SVector::zeros());
        // The path has the smallest curvature that the branch permits.
        for _ in 0..if self.way.moves { 2 } else { 0 } {
            let (before, after) = (
                permitted_accelerations_at(-step, &course)?.bend,
                permitted_accelerations_at(step, &course)?.bend,
            );
            course = ((before + after) * half, (after - before) * (half / step));
        }
        let mut sum = PermittedAccelerations { free: SMatrix::zeros(), bend: SVector::zeros() };
        for (k, weight) in [(1.0, 0.75), (2.0, -0.3), (3.0, 0.05)] {
            for side in [-k, k] {
                let possible = permitted_accelerations_at(step * constant(side), &course)?;
                sum.free += possible.free * constant::<T>(weight);
                sum.bend += possible.bend * constant::<T>(weight);
            }
        }
        Some(sum)
    }
}

/// Rows of constraints in the Euclidean metric of the coordinates.
struct EuclideanRows<T, const NV: usize, const NC: usize> {
    span: ColumnSpan<T, NV, NC>,
    triangle: TriangularFactor<T, NC>,
    /// Whether the well-conditioned rows have the rank of regular configurations.
    regular: bool,
}

impl<T: Real, const NV: usize, const NC: usize> EuclideanRows<T, NV, NC> {
    /// Factorises the constraint rows above the relative magnitude `clear`, then the smaller ones down to
    /// rounding errors.
    fn new(structure: &Structure<'_, NC>, jacobian: &SMatrix<T, NC, NV>, clear: T) -> Self {
        let mut span = ColumnSpan::new(
            &MassFactorisation::new(&SMatrix::identity().data.0),
            jacobian,
            &structure.groups,
        );
        span.extend_basis(clear, structure.rank);
        let regular = span.rank >= structure.rank;
        span.extend_basis(rounding_threshold(), structure.rank);
        let triangle = TriangularFactor::new(&span);
        Self { span, triangle, regular }
    }

    /// Returns the `x` of minimum norm with `J x = −gap`, for the constraint Jacobian `J`.
    fn minimum_norm_correction(&self, gap: &SVector<T, NC>) -> SVector<T, NV> {
        let known = self.triangle.particular_solution(&self.span, &gap.data.0[0]);
        let mut x = [T::zero(); NV];
        x.iter_mut().zip(&known).take(self.span.rank).for_each(|(x, known)| *x = *known);
        SVector::from(self.span.undo_reflections(x))
    }

    /// Returns the projection `P` onto the null space of the constraint rows.
    fn null_space_projection(&self) -> SMatrix<T, NV, NV> {
        let mut free = SMatrix::<T, NV, NV>::identity();
        for column in &mut free.data.0 {
            let mut x = self.span.apply_reflections(column);
            x.iter_mut().take(self.span.rank).for_each(|x| *x = T::zero());
            *column = self.span.undo_reflections(x);
        }
        free
    }
}

/// Accelerations that the constraints permit: `P y + c` for any `y`, with the projection `P` onto the null
/// space of the constraints.
struct PermittedAccelerations<T, const NV: usize> {
    free: SMatrix<T, NV, NV>,
    bend: SVector<T, NV>,
}

impl<T: Real, const NV: usize> PermittedAccelerations<T, NV> {
    /// Returns the permitted acceleration that follows from masses and forces (Gauss's principle). Rows that
    /// span the complement of the permitted accelerations are treated as constraints.
    fn acceleration_by_gauss_principle<const NC: usize>(
        &self,
        structure: &Structure<'_, NC>,
        system: &DynamicsEquations<T, NV, NC>,
    ) -> Option<SVector<T, NV>> {
        let mut rest = (SMatrix::identity() - self.free).data.0;
        let (mut jacobian, mut bias) = (SMatrix::<T, NC, NV>::zeros(), [T::zero(); NC]);
        for row in 0..NC {
            if row >= structure.rank {
                break;
            }
            let mut best = ([T::zero(); NV], T::zero());
            for column in &rest {
                let length = norm(column);
                if length > best.1 {
                    best = (*column, length);
                }
            }
            let normal = best.0.map(|x| x / best.1);
            rest.iter_mut().for_each(|column| {
                for _ in 0..2 {
                    let part = super::dot(&normal, column);
                    column.iter_mut().zip(&normal).for_each(|(x, n)| *x -= part * *n);
                }
            });
            jacobian.data.0.iter_mut().zip(&normal).for_each(|(column, n)| column[row] = *n);
            bias[row] = -super::dot(&normal, &self.bend.data.0[0]);
        }
        let (mass, force) = system.augmented_mass_and_forces(structure);
        let groups = core::array::from_fn(|k| k);
        let open = Structure { groups, determining: &[], rank: structure.rank };
        let system = DynamicsEquations {
            mass: SMatrix::from_array_storage(nalgebra::ArrayStorage(mass)),
            jacobian,
            force,
            bias,
        };
        let ((a, _), regular) = system.solve_with_rows_above_magnitude(
            &open,
            rounding_threshold(),
            DependentRowTreatment::Dropped,
        );
        (regular && a.iter().all(|a| a.is_finite())).then_some(a)
    }
}
