//! Eigenvalues of real matrices, in exactly conjugate pairs.

use super::{C, balance_matrix, checked_square_size};
use crate::Error;
use nalgebra::DMatrix;

/// Maximum number of QR steps for one eigenvalue or pair; three are usual.
const MAX_ITERATIONS: usize = 120;

/// Computes the eigenvalues of a square matrix, after balancing, by Francis' double QR steps on its
/// Hessenberg form (Golub and Van Loan, *Matrix Computations*, § 7.5). Complex eigenvalues are in exactly
/// conjugate pairs. The eigenvalues are sorted by real part, then by imaginary part.
///
/// # Errors
///
/// [`Error::Shape`], [`Error::NotFinite`], and [`Error::NotConverged`] if the iteration does not converge.
pub fn eigenvalues(a: &DMatrix<f64>) -> Result<Vec<C>, Error> {
    let n = checked_square_size("A", a)?;
    let mut h = hessenberg_form(balance_matrix(a).0);
    let size = h.norm();
    let mut found = Vec::with_capacity(n);
    let (mut left, mut steps) = (n, 0);
    let mut moved = 0.0;
    while left > 0 {
        let high = left - 1;
        let low = first_row_of_active_block(&h, high, size);
        if low == high {
            found.push(C::new(h[(high, high)] + moved, 0.0));
            (left, steps) = (left - 1, 0);
        } else if low + 1 == high {
            found.extend(eigenvalue_pair(&h, low).map(|x| x + moved));
            (left, steps) = (left - 2, 0);
        } else {
            steps += 1;
            if steps > MAX_ITERATIONS {
                return Err(Error::NotConverged { what: "the QR algorithm" });
            }
            if steps.is_multiple_of(10) {
                // Wilkinson's exceptional shift, which is applied to the matrix itself.
                let by = h[(high, high)];
                moved += by;
                (0..left).for_each(|i| h[(i, i)] -= by);
                let s = h[(high, high - 1)].abs() + h[(high - 1, high - 2)].abs();
                double_qr_step(&mut h, low, high, [1.5 * s, s * s]);
            } else {
                let (x, y) = (h[(high, high)], h[(high - 1, high - 1)]);
                let product = x * y - h[(high, high - 1)] * h[(high - 1, high)];
                double_qr_step(&mut h, low, high, [x + y, product]);
            }
        }
    }
    found.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    Ok(found)
}

/// Returns the first row of the active block that ends at row `high`.
fn first_row_of_active_block(h: &DMatrix<f64>, high: usize, size: f64) -> usize {
    for k in (1..=high).rev() {
        let mut near = h[(k - 1, k - 1)].abs() + h[(k, k)].abs();
        if near == 0.0 {
            near = size;
        }
        if h[(k, k - 1)].abs() <= f64::EPSILON * near {
            return k;
        }
    }
    0
}

/// Returns the eigenvalues of the diagonal block of rows `k` and `k + 1`.
fn eigenvalue_pair(h: &DMatrix<f64>, k: usize) -> [C; 2] {
    let (a, b, c, d) = (h[(k, k)], h[(k, k + 1)], h[(k + 1, k)], h[(k + 1, k + 1)]);
    let half = 0.5 * (a - d);
    let square = half * half + b * c;
    if square < 0.0 {
        let (re, im) = (d + half, (-square).sqrt());
        return [C::new(re, im), C::new(re, -im)];
    }
    let z = half + square.sqrt().copysign(half);
    let (one, other) = (d + z, if z == 0.0 { d } else { d - b * c / z });
    [C::new(one, 0.0), C::new(other, 0.0)]
}

/// Performs a double QR step on a Hessenberg matrix, with the sum and the product of two shifts.
fn double_qr_step(h: &mut DMatrix<f64>, low: usize, high: usize, [sum, product]: [f64; 2]) {
    let first = h[(low, low)];
    let mut v = [
        first * first + h[(low, low + 1)] * h[(low + 1, low)] - sum * first + product,
        h[(low + 1, low)] * (first + h[(low + 1, low + 1)] - sum),
        h[(low + 1, low)] * h[(low + 2, low + 1)],
    ];
    for k in low..high {
        let length = if k + 1 < high { 3 } else { 2 };
        if k > low {
            v = [h[(k, k - 1)], h[(k + 1, k - 1)], if length == 3 { h[(k + 2, k - 1)] } else { 0.0 }];
        }
        let scale = v[..length].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if scale == 0.0 {
            continue;
        }
        let mut w = v.map(|x| x / scale);
        let norm = w[..length].iter().map(|x| x * x).sum::<f64>().sqrt().copysign(w[0]);
        w[0] += norm;
        let factor = 1.0 / (norm * w[0]);
        let columns = k.saturating_sub(1).max(low);
        for j in columns..=high {
            let dot = factor * (0..length).map(|i| w[i] * h[(k + i, j)]).sum::<f64>();
            (0..length).for_each(|i| h[(k + i, j)] -= dot * w[i]);
        }
        for i in low..=high.min(k + 3) {
            let dot = factor * (0..length).map(|j| w[j] * h[(i, k + j)]).sum::<f64>();
            (0..length).for_each(|j| h[(i, k + j)] -= dot * w[j]);
        }
        if k > low {
            (1..length).for_each(|i| h[(k + i, k - 1)] = 0.0);
        }
    }
}

fn hessenberg_form(mut h: DMatrix<f64>) -> DMatrix<f64> {
    let n = h.nrows();
    for k in 0..n.saturating_sub(2) {
        let mut v = h.view((k + 1, k), (n - k - 1, 1)).clone_owned();
        let norm = v.norm();
        if norm == 0.0 {
            continue;
        }
        v[0] += norm.copysign(v[0]);
        let size = v.norm();
        v /= size;
        let mut below = h.view_mut((k + 1, 0), (n - k - 1, n));
        let product = v.transpose() * &below;
        below -= &v * product * 2.0;
        let mut right = h.view_mut((0, k + 1), (n, n - k - 1));
        let product = &right * &v;
        right -= product * v.transpose() * 2.0;
        (k + 2..n).for_each(|i| h[(i, k)] = 0.0);
    }
    h
}
