//! Numerical rank of matrices by orthogonal transformations.

use super::check_matrix;
use crate::Error;
use nalgebra::DMatrix;

/// Orthogonal transformation of a matrix `M` such that the first `rank` rows of `Qᵀ M` are significant; the
/// other rows are rounding errors.
pub(crate) struct RowCompression {
    /// Orthogonal square matrix `Q` of the transformation.
    pub q: DMatrix<f64>,
    /// Number of significant rows of the transformed matrix `Qᵀ M`.
    pub rank: usize,
}

impl RowCompression {
    /// Compresses the rows of a matrix by Householder reflections with column pivoting. Columns whose norm is
    /// at most `least` count as zero.
    pub fn compress_rows(m: &DMatrix<f64>, least: f64) -> Self {
        let (rows, columns) = m.shape();
        let (mut r, mut q) = (m.clone(), DMatrix::identity(rows, rows));
        let mut rank = 0;
        while rank < rows.min(columns) {
            let norm_of_remaining_column = |j: usize| r.view((rank, j), (rows - rank, 1)).norm();
            let Some((best, size)) =
                (rank..columns).map(|j| (j, norm_of_remaining_column(j))).max_by(|a, b| a.1.total_cmp(&b.1))
            else {
                break;
            };
            if size <= least {
                break;
            }
            r.swap_columns(rank, best);
            let mut v = r.view((rank, rank), (rows - rank, 1)).clone_owned();
            v[0] += size.copysign(v[0]);
            let length = v.norm();
            v /= length;
            let mut below = r.view_mut((rank, rank), (rows - rank, columns - rank));
            let product = v.transpose() * &below;
            below -= &v * product * 2.0;
            let mut right = q.view_mut((0, rank), (rows, rows - rank));
            let product = &right * &v;
            right -= product * v.transpose() * 2.0;
            rank += 1;
        }
        Self { q, rank }
    }
}

/// Returns the numerical rank of the matrix `m`: the number of singular values above `tolerance` times the
/// largest. A tolerance of zero selects the rounding error.
///
/// # Errors
///
/// [`Error::NotFinite`] for entries that are infinite or NaN, [`Error::NotConverged`] if the singular values
/// do not converge.
pub fn rank(m: &DMatrix<f64>, tolerance: f64) -> Result<usize, Error> {
    check_matrix("the matrix", m, m.nrows(), m.ncols())?;
    if m.is_empty() {
        return Ok(0);
    }
    let values = m.clone().svd_unordered(false, false).singular_values;
    let least = tolerance.max(f64::EPSILON * m.nrows().max(m.ncols()) as f64) * values.max();
    Ok(values.iter().filter(|value| **value > least).count())
}

/// Returns the smallest singular value of a complex matrix that does not have more rows than columns.
pub(crate) fn smallest_singular_value(m: &super::CMatrix) -> f64 {
    if m.is_empty() {
        return f64::INFINITY;
    }
    m.clone().svd_unordered(false, false).singular_values.min()
}
