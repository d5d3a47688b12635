//! Rank-revealing factorisation of constraint rows in the metric of the kinetic energy.
//!
//! With `M = L Lᵀ`, the columns of `W = L⁻¹ Jᵀ` are made triangular by Householder reflections with column
//! pivoting, `Qᵀ W = R`. The factorised matrix is `J`, never the squared matrix `J M⁻¹ Jᵀ`. Columns are
//! scaled by their length, and the largest entry of a column is exchanged to the diagonal, so that light and
//! heavy bodies do not reduce each other's accuracy (Powell and Reid, *On applying Householder
//! transformations to linear least squares problems*, IFIP 1968; Cox and Higham, *Stability of Householder QR
//! factorization for weighted least squares problems*, 1998). The remainder of a column is compared with
//! rounding errors entry by entry: each entry is stored with the largest number that it was computed from.

use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::SMatrix;

/// Rounding errors, in units of that of the largest number that an entry was computed from, above which an
/// entry is significant.
const ROUNDINGS: f64 = 64.0;

/// Returns an entry, or zero if the index is out of range. Bounds checks could panic.
pub(super) fn entry_or_zero<T: Real>(x: &[T], k: usize) -> T {
    x.get(k).copied().unwrap_or(T::zero())
}

pub(super) fn dot<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
}

pub(super) fn norm<T: Real, const N: usize>(a: &[T; N]) -> T {
    dot(a, a).sqrt()
}

/// Returns the relative magnitude below which a number is a rounding error.
pub(super) fn rounding_threshold<T: Real>() -> T {
    constant::<T>(ROUNDINGS) * epsilon()
}

/// Factorisation `M = L Lᵀ` of the mass matrix, stored as `L' D L'ᵀ`: the rows of `L'` below its unit
/// diagonal, and the square roots of `D⁻¹`.
pub(super) struct MassFactorisation<T, const N: usize> {
    lower: [[T; N]; N],
    root: [T; N],
}

impl<T: Real, const N: usize> MassFactorisation<T, N> {
    /// Factorises a mass matrix. Pivots that are zero or negative due to rounding are replaced by the
    /// magnitude of rounding errors.
    pub fn new(mass: &[[T; N]; N]) -> Self {
        let (mut lower, mut inverse) = ([[T::zero(); N]; N], [T::zero(); N]);
        for i in 0..N {
            let mut scaled = [T::zero(); N];
            for j in 0..i {
                scaled[j] = (0..j).fold(mass[i][j], |sum, k| sum - scaled[k] * lower[j][k]);
                lower[i][j] = scaled[j] * inverse[j];
            }
            let pivot = (0..i).fold(mass[i][i], |sum, k| sum - scaled[k] * lower[i][k]);
            let least = mass[i][i] * epsilon();
            inverse[i] = T::one() / if pivot < least { least } else { pivot };
        }
        Self { lower, root: inverse.map(|x| x.sqrt()) }
    }

    /// Returns `L⁻¹ x` for the factorisation `M = L Lᵀ` of the mass matrix.
    pub fn solve_half(&self, mut x: [T; N]) -> [T; N] {
        for i in 0..N {
            x[i] = (0..i).fold(x[i], |sum, k| sum - self.lower[i][k] * x[k]);
        }
        x.iter_mut().zip(&self.root).for_each(|(x, root)| *x *= *root);
        x
    }

    /// Returns the magnitudes of the numbers that `L⁻¹ x` is computed from, for given magnitudes of `x`.
    fn forward_solve_magnitudes(&self, mut x: [T; N]) -> [T; N] {
        for i in 0..N {
            x[i] = (0..i).fold(x[i], |most, k| most.max(self.lower[i][k].abs() * x[k]));
        }
        x.iter_mut().zip(&self.root).for_each(|(x, root)| *x *= *root);
        x
    }

    /// Returns `Lᵀ x` for the factorisation `M = L Lᵀ` of the mass matrix.
    pub fn multiply_upper(&self, x: &[T; N]) -> [T; N] {
        let mut out = *x;
        for i in 0..N {
            out[i] = (i + 1..N).fold(x[i], |sum, k| sum + self.lower[k][i] * x[k]) / self.root[i];
        }
        out
    }

    /// Returns `L⁻ᵀ x` for the factorisation `M = L Lᵀ` of the mass matrix.
    pub fn solve_transposed(&self, mut x: [T; N]) -> [T; N] {
        x.iter_mut().zip(&self.root).for_each(|(x, root)| *x *= *root);
        for i in (0..N).rev() {
            x[i] = (i + 1..N).fold(x[i], |sum, k| sum - self.lower[k][i] * x[k]);
        }
        x
    }
}

/// Column of the matrix `W = L⁻¹ Jᵀ` (one constraint, with `M = L Lᵀ`), scaled to unit length.
#[derive(Clone, Copy)]
pub(super) struct ScaledColumn<T, const N: usize> {
    /// Entries of the column after the Householder reflections that have been applied so far.
    pub x: [T; N],
    /// Largest number that each entry was computed from.
    size: [T; N],
    /// Length of the column before it is scaled to unit length; zero for a zero column.
    pub length: T,
    /// Step at which the column became part of the basis.
    pub step: Option<usize>,
}

impl<T: Real, const N: usize> ScaledColumn<T, N> {
    /// Returns the length of a column without its first `first` entries. Also returns the largest ratio of a
    /// remaining entry to the largest number that it was computed from.
    fn trailing_length_and_accuracy(&self, first: usize) -> (T, T) {
        let all = self.x.iter().zip(&self.size).skip(first);
        let (square, most) = all.fold((T::zero(), T::zero()), |(square, most), (x, size)| {
            let share = if *size > T::zero() { x.abs() / *size } else { T::zero() };
            (square + *x * *x, most.max(share))
        });
        (square.sqrt(), most)
    }

    fn apply_householder_reflection(&mut self, normal: &[T; N]) {
        let part = dot(normal, &self.x);
        let all = normal.iter().zip(&self.size);
        let largest = all.fold(T::zero(), |most, (n, size)| most.max(n.abs() * *size));
        for ((x, size), n) in self.x.iter_mut().zip(&mut self.size).zip(normal) {
            *x -= *n * part;
            *size = size.max(n.abs() * largest);
        }
    }
}

/// Space spanned by columns of constraints, represented by the Householder reflections that make the columns
/// triangular.
pub(super) struct ColumnSpan<T, const NV: usize, const NC: usize> {
    /// Columns of `W = L⁻¹ Jᵀ`, one per constraint, to which the reflections are applied.
    pub columns: [ScaledColumn<T, NV>; NC],
    /// Rank found so far: the number of constraint columns in the basis.
    pub rank: usize,
    /// Permutation of the entries of a column: for each position, the original index.
    order: [usize; NV],
    /// Normals of the Householder reflections, each of length √2.
    normals: [[T; NV]; NV],
}

impl<T: Real, const NV: usize, const NC: usize> ColumnSpan<T, NV, NC> {
    /// Prepares the rows of a Jacobian. The magnitude that an entry was computed from is estimated by the
    /// other components of the same vector, in the units of the entry. Entries below the corresponding
    /// rounding error become zero.
    pub fn new(
        metric: &MassFactorisation<T, NV>,
        jacobian: &SMatrix<T, NC, NV>,
        groups: &[usize; NC],
    ) -> Self {
        let rows: [[T; NV]; NC] =
            core::array::from_fn(|k| core::array::from_fn(|i| entry_or_zero(&jacobian.data.0[i], k)));
        let halves = rows.map(|row| metric.solve_half(row));
        let group_magnitude = |k: usize, each: &[[T; NV]; NC]| {
            let group = each.iter().zip(groups).filter(|(_, group)| Some(*group) == groups.get(k));
            group.flat_map(|(row, _)| row).fold(T::zero(), |most, x| most.max(x.abs()))
        };
        let largest_row_entry_of_group = |k: usize, i: usize| {
            let group = rows.iter().zip(groups).filter(|(_, group)| Some(*group) == groups.get(k));
            group.fold(T::zero(), |most, (row, _)| most.max(entry_or_zero(row, i).abs()))
        };
        let columns: [ScaledColumn<T, NV>; NC] = core::array::from_fn(|k| {
            let (entry, half) = (group_magnitude(k, &rows), group_magnitude(k, &halves));
            let bound = metric.root.map(|root| entry.min(half / root));
            let mut row = rows.get(k).copied().unwrap_or([T::zero(); NV]);
            let mut sizes = bound;
            for (i, ((x, size), bound)) in row.iter_mut().zip(&mut sizes).zip(&bound).enumerate() {
                // Zeros are exact, unless the corresponding entries of the other components are also
                // negligible.
                let most = largest_row_entry_of_group(k, i);
                let alike = most <= *bound * rounding_threshold() || most > *bound * epsilon::<T>().sqrt();
                if alike && x.abs() <= *bound * rounding_threshold() {
                    (*x, *size) = (T::zero(), T::zero());
                }
            }
            let half = metric.solve_half(row);
            let length = norm(&half);
            let unit = if length > T::zero() { T::one() / length } else { T::zero() };
            let size = metric.forward_solve_magnitudes(sizes).map(|x| x * unit);
            ScaledColumn { x: half.map(|x| x * unit), size, length, step: None }
        });
        let order = core::array::from_fn(|k| k);
        Self { columns, rank: 0, order, normals: [[T::zero(); NV]; NV] }
    }

    /// Returns the entries of `x` in the permuted order that the columns use.
    fn entries_in_column_order(&self, x: &[T; NV]) -> [T; NV] {
        self.order.map(|i| entry_or_zero(x, i))
    }

    /// Adds columns to the basis, the longest first. A column must have an entry of at least `least` relative
    /// to the number that it was computed from. The basis has at most `most` columns.
    pub fn extend_basis(&mut self, least: T, most: usize) {
        while self.rank < most.min(NV) {
            let mut best = (None, T::zero());
            for (k, column) in self.columns.iter().enumerate().filter(|(_, c)| c.step.is_none()) {
                let (length, share) = column.trailing_length_and_accuracy(self.rank);
                // Of columns with equal length up to rounding errors, the first is used, so that the choice
                // does not depend on rounding.
                if length > best.1 * constant(1.01) && share > least {
                    best = (Some(k), length);
                }
            }
            let Some(column) = best.0.and_then(|k| self.columns.get_mut(k)) else { break };
            column.step = Some(self.rank);
            let x = column.x;
            self.add_basis_direction(x);
        }
    }

    /// Adds a direction to the basis: the component of `x` outside the basis, in transformed coordinates.
    fn add_basis_direction(&mut self, mut x: [T; NV]) {
        let first = self.rank;
        let mut most = (first, T::zero());
        for (k, x) in x.iter().enumerate().skip(first) {
            if x.abs() > most.1 {
                most = (k, x.abs());
            }
        }
        self.exchange_rows_of_columns(first, most.0);
        exchange_entries(&mut x, first, most.0);
        x.iter_mut().take(first).for_each(|x| *x = T::zero());
        let (length, own) = (norm(&x), entry_or_zero(&x, first));
        let scale = T::one() / (length * (length + own.abs())).sqrt();
        let mut normal = x.map(|x| x * scale);
        if let Some(n) = normal.get_mut(first) {
            *n += if own < T::zero() { -length * scale } else { length * scale };
        }
        self.columns.iter_mut().for_each(|column| column.apply_householder_reflection(&normal));
        if let Some(slot) = self.normals.get_mut(first) {
            *slot = normal;
        }
        self.rank += 1;
    }

    /// Exchanges two rows of all columns and normals; both are rows that no basis vector occupies yet.
    fn exchange_rows_of_columns(&mut self, i: usize, j: usize) {
        exchange_entries(&mut self.order, i, j);
        self.normals.iter_mut().for_each(|normal| exchange_entries(normal, i, j));
        for column in &mut self.columns {
            exchange_entries(&mut column.x, i, j);
            exchange_entries(&mut column.size, i, j);
        }
    }

    /// Returns `Qᵀ x`: permutes the entries of a vector and applies the Householder reflections.
    pub fn apply_reflections(&self, x: &[T; NV]) -> [T; NV] {
        let mut x = self.entries_in_column_order(x);
        for normal in self.normals.iter().take(self.rank) {
            reflect_vector(&mut x, normal);
        }
        x
    }

    /// Returns `Q x`: applies the Householder reflections in reverse order and undoes the permutation of the
    /// entries.
    pub fn undo_reflections(&self, mut x: [T; NV]) -> [T; NV] {
        for normal in self.normals.iter().take(self.rank).rev() {
            reflect_vector(&mut x, normal);
        }
        let mut out = [T::zero(); NV];
        for (x, k) in x.iter().zip(&self.order) {
            if let Some(slot) = out.get_mut(*k) {
                *slot = *x;
            }
        }
        out
    }

    /// Returns the index of the column that joined the basis at a step, and the column.
    pub fn column_of_basis_step(&self, step: usize) -> Option<(usize, &ScaledColumn<T, NV>)> {
        self.columns.iter().enumerate().find(|(_, column)| column.step == Some(step))
    }
}

fn reflect_vector<T: Real, const N: usize>(x: &mut [T; N], normal: &[T; N]) {
    let part = dot(normal, x);
    x.iter_mut().zip(normal).for_each(|(x, n)| *x -= *n * part);
}

fn exchange_entries<T: Copy, const N: usize>(x: &mut [T; N], i: usize, j: usize) {
    if let (Some(a), Some(b)) = (x.get(i).copied(), x.get(j).copied()) {
        if let Some(slot) = x.get_mut(i) {
            *slot = b;
        }
        if let Some(slot) = x.get_mut(j) {
            *slot = a;
        }
    }
}

/// Orthonormalises the first vectors, in two passes to remove rounding errors. Returns the triangle `S` of `L
/// = U S`.
pub(super) fn orthonormalise_vectors<T: Real, const N: usize>(
    vectors: &mut [[T; N]; N],
    count: usize,
) -> [[T; N]; N] {
    let mut upper = [[T::zero(); N]; N];
    for j in 0..N {
        if j >= count {
            break;
        }
        let mut own = vectors[j];
        for _ in 0..2 {
            for (base, row) in vectors.iter().zip(&mut upper).take(j) {
                let part = dot(base, &own);
                row[j] += part;
                own.iter_mut().zip(base).for_each(|(x, base)| *x -= part * *base);
            }
        }
        let length = norm(&own);
        upper[j][j] = length;
        vectors[j] = own.map(|x| x / length);
    }
    upper
}
