//! Completion of velocities and accelerations: some entries are prescribed, and the others follow from the
//! constraints. Also computes the drive forces for such a motion.

use super::{
    Constrained, ConstraintError, acceptable_residual, is_residual_acceptable, largest_entry,
    largest_jacobian_entry_or_one, largest_magnitude_or_one,
};
use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::{SMatrix, SVector};

/// Maximum number of corrections in a completion: the first one solves the equations, the others remove its
/// rounding errors.
const MAX_CORRECTIONS: usize = 3;

/// Returns an error for the first of the indices `held` that is not less than `NV`.
pub(super) fn check_held_velocity_indices<const NV: usize>(held: &[usize]) -> Result<(), ConstraintError> {
    let outside = held.iter().copied().find(|index| *index >= NV);
    outside.map_or(Ok(()), |index| Err(ConstraintError::Held { index, velocities: NV }))
}

/// Corrects the entries of `x` that are not `held` until the residual `gap` of the constraints is zero to
/// rounding, with the least change in the metric of the mass matrix. Returns `x`, and the index and magnitude
/// of the largest remaining residual.
fn correct_free_entries<T: Real, const NV: usize, const NC: usize>(
    mass: &SMatrix<T, NV, NV>,
    jacobian: &SMatrix<T, NC, NV>,
    held: &[usize],
    mut x: SVector<T, NV>,
    gap: impl Fn(&SVector<T, NV>) -> SVector<T, NC>,
    is_exact: impl Fn(T, &SVector<T, NV>) -> bool,
) -> Result<(SVector<T, NV>, (usize, T)), ConstraintError> {
    for _ in 0..MAX_CORRECTIONS {
        let found = gap(&x);
        let worst = largest_entry(&found)?;
        if is_exact(worst.1, &x) {
            return Ok((x, worst));
        }
        x += least_energy_correction(mass, jacobian, held, &found);
        largest_entry(&x)?;
    }
    let worst = largest_entry(&gap(&x))?;
    Ok((x, worst))
}

/// Returns the velocity that satisfies the constraints and has the entries `held` of `v`.
pub(super) fn completed_velocity<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    mechanism: &M,
    t: M::Scalar,
    q: &SVector<M::Scalar, NQ>,
    v: &SVector<M::Scalar, NV>,
    held: &[usize],
) -> Result<SVector<M::Scalar, NV>, ConstraintError>
where
    M: Constrained<NQ, NV, NU, NH, NC> + ?Sized,
{
    check_held_velocity_indices::<NV>(held)?;
    let (mass, jacobian) = (mechanism.mass_matrix(t, q), mechanism.constraint_jacobian(t, q));
    let constraint_rates_of_velocity = |v: &SVector<M::Scalar, NV>| mechanism.constraint_rates(t, q, v);
    let (v, (worst, size)) =
        correct_free_entries(&mass, &jacobian, held, *v, constraint_rates_of_velocity, |size, v| {
            size <= acceptable_residual(v)
        })?;
    if is_residual_acceptable(size, &v) {
        return Ok(v);
    }
    Err(ConstraintError::Velocity {
        constraint: constraint_name::<M, NQ, NV, NU, NH, NC>(worst),
        rate: to_f64(size),
    })
}

/// Returns the acceleration that satisfies the constraints and has the entries `held` of `a`.
pub(super) fn complete_acceleration<
    M,
    T: Real,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    mechanism: &M,
    t: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    a: &SVector<T, NV>,
    held: &[usize],
) -> Result<SVector<T, NV>, ConstraintError>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    check_held_velocity_indices::<NV>(held)?;
    let (mass, jacobian) = (mechanism.mass_matrix(t, q), mechanism.constraint_jacobian(t, q));
    let bias = mechanism.constraint_bias(t, q, v);
    // Magnitude of the terms of the gap, relative to which it is rounded.
    let magnitude_of_gap_terms = |a: &SVector<T, NV>| {
        largest_magnitude_or_one(&bias)
            .max(largest_magnitude_or_one(a) * largest_jacobian_entry_or_one(&jacobian))
    };
    let acceleration_residual = |a: &SVector<T, NV>| jacobian * a + bias;
    let is_gap_within_rounding =
        |size: T, a: &SVector<T, NV>| size <= epsilon::<T>() * magnitude_of_gap_terms(a);
    let (a, (worst, size)) =
        correct_free_entries(&mass, &jacobian, held, *a, acceleration_residual, is_gap_within_rounding)?;
    if size <= epsilon::<T>().sqrt() * magnitude_of_gap_terms(&a) {
        return Ok(a);
    }
    let constraint = constraint_name::<M, NQ, NV, NU, NH, NC>(worst);
    Err(ConstraintError::Acceleration { constraint, acceleration: to_f64(size) })
}

/// Returns the name of a constraint by its index.
fn constraint_name<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(
    index: usize,
) -> &'static str
where
    M: Constrained<NQ, NV, NU, NH, NC> + ?Sized,
{
    M::CONSTRAINTS.get(index).copied().unwrap_or_default()
}

/// Returns the generalized drive forces at the velocities `driven` and the multipliers `λ` with
/// `M a + h = τ + Jᵀ λ`. The equations of the other velocities determine the multipliers.
pub(super) fn driving_forces<
    M,
    T: Real,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    mechanism: &M,
    t: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    a: &SVector<T, NV>,
    driven: &[usize],
) -> Result<(SVector<T, NV>, SVector<T, NC>), ConstraintError>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    check_held_velocity_indices::<NV>(driven)?;
    let (worst, rate) = largest_entry(&mechanism.constraint_rates(t, q, v))?;
    let name = constraint_name::<M, NQ, NV, NU, NH, NC>;
    if !is_residual_acceptable(rate, v) {
        return Err(ConstraintError::Velocity { constraint: name(worst), rate: to_f64(rate) });
    }
    let (jacobian, bias) = (mechanism.constraint_jacobian(t, q), mechanism.constraint_bias(t, q, v));
    let (worst, left) = largest_entry(&(jacobian * a + bias))?;
    if left
        > epsilon::<T>().sqrt()
            * largest_magnitude_or_one(&bias)
                .max(largest_magnitude_or_one(a) * largest_jacobian_entry_or_one(&jacobian))
    {
        return Err(ConstraintError::Acceleration { constraint: name(worst), acceleration: to_f64(left) });
    }
    let forces = mechanism.inverse_dynamics(t, q, v, a);
    let is_driven = |i: usize| driven.contains(&i);
    let rows: [NumberArray<T, NC>; NV] = jacobian.data.0;
    let size = rows.map(|row| dot(&row, &row));
    let open = core::array::from_fn(|i| if is_driven(i) { [nalgebra::zero(); NC] } else { rows[i] });
    let mut lambda = [nalgebra::zero(); NC];
    let mut left = forces;
    // The second pass removes rounding errors of the first one.
    for _ in 0..2 {
        let (change, _) = minimum_norm_solution(&open, &size, &left.data.0[0]);
        add_row_multiple(&mut lambda, nalgebra::one(), &change);
        left = forces - jacobian.transpose() * SVector::from(lambda);
    }
    let (mut tau, mut worst) = (SVector::zeros(), None);
    let scale = forces.iter().zip(&rows).fold(T::one(), |scale, (force, row)| {
        let parts = row.iter().zip(&lambda).fold(force.abs(), |scale, (j, l)| scale.max((*j * *l).abs()));
        scale.max(parts)
    });
    for (i, force) in left.iter().enumerate() {
        if !force.is_finite() {
            return Err(ConstraintError::NotFinite);
        }
        if is_driven(i) {
            tau[i] = *force;
        } else if force.abs() > epsilon::<T>().sqrt() * scale {
            worst = worst.filter(|(_, most)| *most >= force.abs()).or(Some((i, force.abs())));
        }
    }
    match worst {
        Some((i, force)) => Err(ConstraintError::Undriven {
            velocity: M::VELOCITIES.get(i).copied().unwrap_or_default(),
            force: to_f64(force),
        }),
        None => Ok((tau, SVector::from(lambda))),
    }
}

type NumberArray<T, const N: usize> = [T; N];

fn dot<T: Real, const N: usize>(a: &NumberArray<T, N>, b: &NumberArray<T, N>) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
}

/// Adds a multiple of a row to another row, `a += factor · b`.
fn add_row_multiple<T: Real, const N: usize>(a: &mut NumberArray<T, N>, factor: T, b: &NumberArray<T, N>) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * *b);
}

/// Removes the component along a unit direction from rows. Two passes are sufficient for orthogonality
/// (Björck, *Numerical Methods for Least Squares Problems*, 1996, § 2.4.5).
fn remove_component<T: Real, const N: usize, const K: usize>(
    rows: &mut [NumberArray<T, N>; K],
    direction: &NumberArray<T, N>,
) {
    for row in rows {
        for _ in 0..2 {
            let along = dot(row, direction);
            add_row_multiple(row, -along, direction);
        }
    }
}

/// Returns the index of the row with the largest `size` among the rows that are not yet taken, and this size.
fn largest_remaining_row<T: Real, const K: usize>(
    taken: &[bool; K],
    size: impl Fn(usize) -> T,
) -> Option<(usize, T)> {
    let mut best = None;
    for k in (0..K).filter(|k| !taken[*k]) {
        let size = size(k);
        if best.is_none_or(|(_, most)| size > most) {
            best = Some((k, size));
        }
    }
    best
}

/// Returns the minimum of `xᵀ M x` over all `x` with `J x = −gap` that are zero for held velocities.
///
/// First finds a solution with [`minimum_norm_solution`], then minimises the energy over the space of all
/// remaining motions. Coordinates are scaled by their inertia.
fn least_energy_correction<T: Real, const NV: usize, const NC: usize>(
    mass: &SMatrix<T, NV, NV>,
    jacobian: &SMatrix<T, NC, NV>,
    held: &[usize],
    gap: &SVector<T, NC>,
) -> SVector<T, NV> {
    let mass = mass.data.0;
    let scale: NumberArray<T, NV> = core::array::from_fn(|i| {
        let own = mass[i][i];
        if own > T::zero() { T::one() / own.sqrt() } else { T::one() }
    });
    let rows: [NumberArray<T, NV>; NC] =
        core::array::from_fn(|k| core::array::from_fn(|i| jacobian.data.0[i][k] * scale[i]));
    // Squared lengths of the rows without held velocities.
    let reach: NumberArray<T, NC> = core::array::from_fn(|k| dot(&rows[k], &rows[k]));
    let rows = rows.map(|row| core::array::from_fn(|i| if held.contains(&i) { T::zero() } else { row[i] }));
    let mut axes: [NumberArray<T, NV>; NV] = core::array::from_fn(|i| {
        core::array::from_fn(|j| if i == j && !held.contains(&i) { T::one() } else { T::zero() })
    });
    let (mut y, directions) =
        minimum_norm_solution(&rows, &reach, &core::array::from_fn(|k| -gap.data.0[0][k]));
    for direction in directions.iter().flatten() {
        remove_component(&mut axes, direction);
    }
    let scaled_mass_row =
        |i: usize| -> NumberArray<T, NV> { core::array::from_fn(|j| mass[i][j] * scale[i] * scale[j]) };
    minimise_in_mass_metric(&core::array::from_fn(scaled_mass_row), axes, &mut y);
    SVector::from_fn(|i, _| y[i] * scale[i])
}

/// Returns the minimum-norm `y` with `rows · y = targets`, and the unit directions that span it.
///
/// Uses Gram–Schmidt orthogonalisation. In each step, the row with the largest independent component relative
/// to its length is selected. Dependent rows are dropped; their targets are satisfied automatically or not at
/// all.
fn minimum_norm_solution<T: Real, const N: usize, const K: usize>(
    rows: &[NumberArray<T, N>; K],
    sizes: &[T; K],
    targets: &[T; K],
) -> (NumberArray<T, N>, [Option<NumberArray<T, N>>; K]) {
    let (mut rest, mut taken, mut y) = (*rows, [false; K], [T::zero(); N]);
    let mut directions = [None; K];
    // Rows with a smaller independent component would require excessive velocities.
    let least = epsilon::<T>().powf(constant(4.0 / 3.0));
    for slot in &mut directions {
        let part =
            |k: usize| if sizes[k] > T::zero() { dot(&rest[k], &rest[k]) / sizes[k] } else { T::zero() };
        let Some((k, _)) = largest_remaining_row(&taken, part).filter(|(_, part)| *part > least) else {
            break;
        };
        taken[k] = true;
        let size = dot(&rest[k], &rest[k]).sqrt();
        let direction = rest[k].map(|x| x / size);
        let missing = (targets[k] - dot(&rows[k], &y)) / size;
        add_row_multiple(&mut y, missing, &direction);
        remove_component(&mut rest, &direction);
        *slot = Some(direction);
    }
    (y, directions)
}

/// Moves `y` within the space spanned by `axes` to the minimum of `yᵀ M y`.
fn minimise_in_mass_metric<T: Real, const N: usize>(
    mass: &[NumberArray<T, N>; N],
    mut axes: [NumberArray<T, N>; N],
    y: &mut NumberArray<T, N>,
) {
    // The longest remainder of an axis is at least as long as the mean.
    let some = constant::<T>(0.5 / N.max(1) as f64);
    let (mut basis, mut taken) = ([[T::zero(); N]; N], [false; N]);
    for slot in &mut basis {
        let squared_length = |k: usize| dot(&axes[k], &axes[k]);
        let Some((k, square)) =
            largest_remaining_row(&taken, squared_length).filter(|(_, square)| *square > some)
        else {
            break;
        };
        taken[k] = true;
        *slot = axes[k].map(|x| x / square.sqrt());
        remove_component(&mut axes, slot);
    }
    let heavy = basis.map(|b| core::array::from_fn(|i| dot(&mass[i], &b)));
    let mut rest: NumberArray<T, N> = core::array::from_fn(|i| -dot(&heavy[i], y));
    // A = L D Lᵀ. Motions without inertia keep their value.
    let (mut lower, mut pivots) = ([[T::zero(); N]; N], [T::zero(); N]);
    let quotient_or_zero = |x: T, pivot: T| if pivot > epsilon() { x / pivot } else { T::zero() };
    for i in 0..N {
        for j in 0..=i {
            let own = dot(&heavy[i], &basis[j]);
            let left = (0..j).fold(own, |sum, k| sum - lower[i][k] * lower[j][k] * pivots[k]);
            if i == j {
                pivots[i] = left;
            } else {
                lower[i][j] = quotient_or_zero(left, pivots[j]);
            }
        }
        rest[i] = (0..i).fold(rest[i], |sum, k| sum - lower[i][k] * rest[k]);
    }
    for i in (0..N).rev() {
        rest[i] = (i + 1..N).fold(quotient_or_zero(rest[i], pivots[i]), |sum, k| sum - lower[k][i] * rest[k]);
        add_row_multiple(y, rest[i], &basis[i]);
    }
}
