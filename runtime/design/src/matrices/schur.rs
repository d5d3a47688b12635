//! Complex Schur form of a matrix, and reordering of its eigenvalues.

use super::{C, CMatrix};
use crate::Error;

/// Maximum number of QR steps for one eigenvalue; three are usual.
const MAX_ITERATIONS: usize = 120;

/// Schur form `A = Q T Qᴴ` with `Q` unitary and `T` upper triangular, which has the eigenvalues of `A` on its
/// diagonal (Golub and Van Loan, *Matrix Computations*, ch. 7).
pub(crate) struct Schur {
    pub q: CMatrix,
    pub t: CMatrix,
}

/// Givens rotation `[c s; −s̄ c]` that maps `(x, y)` to `(r, 0)`.
#[derive(Clone, Copy)]
struct GivensRotation {
    c: f64,
    s: C,
}

impl GivensRotation {
    fn rotation_zeroing_second_entry(x: C, y: C) -> Self {
        let (a, b) = (x.norm(), y.norm());
        if b == 0.0 {
            return Self { c: 1.0, s: C::new(0.0, 0.0) };
        }
        if a == 0.0 {
            return Self { c: 0.0, s: y.conj() / b };
        }
        let r = a.hypot(b);
        Self { c: a / r, s: x / a * y.conj() / r }
    }

    fn rotate_rows(self, m: &mut CMatrix, k: usize, columns: std::ops::Range<usize>) {
        for j in columns {
            let (x, y) = (m[(k, j)], m[(k + 1, j)]);
            m[(k, j)] = x * self.c + self.s * y;
            m[(k + 1, j)] = y * self.c - self.s.conj() * x;
        }
    }

    fn rotate_columns(self, m: &mut CMatrix, k: usize, rows: std::ops::Range<usize>) {
        for i in rows {
            let (x, y) = (m[(i, k)], m[(i, k + 1)]);
            m[(i, k)] = x * self.c + self.s.conj() * y;
            m[(i, k + 1)] = y * self.c - self.s * x;
        }
    }
}

/// Returns the upper Hessenberg form of a matrix, by Householder reflections, and the transformation.
fn hessenberg_form(a: &CMatrix) -> (CMatrix, CMatrix) {
    let n = a.nrows();
    let (mut h, mut q) = (a.clone(), CMatrix::identity(n, n));
    for k in 0..n.saturating_sub(2) {
        let mut v = h.view((k + 1, k), (n - k - 1, 1)).clone_owned();
        let norm = v.norm();
        if norm == 0.0 {
            continue;
        }
        let first = v[0];
        let phase = if first.norm() == 0.0 { C::new(1.0, 0.0) } else { first / first.norm() };
        v[0] += phase * norm;
        let size = v.norm();
        v.unscale_mut(size);
        let two = C::new(2.0, 0.0);
        let mut below = h.view_mut((k + 1, 0), (n - k - 1, n));
        let product = v.adjoint() * &below;
        below -= &v * product * two;
        for m in [&mut h, &mut q] {
            let mut right = m.view_mut((0, k + 1), (n, n - k - 1));
            let product = &right * &v;
            right -= product * v.adjoint() * two;
        }
        for i in k + 2..n {
            h[(i, k)] = C::new(0.0, 0.0);
        }
    }
    (h, q)
}

impl Schur {
    /// Computes the Schur form of a matrix with finite entries, by QR steps with single shifts.
    pub fn new(a: &CMatrix) -> Result<Self, Error> {
        let n = a.nrows();
        let (mut t, mut q) = hessenberg_form(a);
        let size = t.norm();
        let mut high = n.saturating_sub(1);
        let mut steps = 0;
        while high > 0 {
            let low = isolate_active_block(&mut t, high, size);
            if low == high {
                (high, steps) = (high - 1, 0);
                continue;
            }
            steps += 1;
            if steps > MAX_ITERATIONS {
                return Err(Error::NotConverged { what: "the QR algorithm" });
            }
            let shift = wilkinson_shift(&t, high, steps);
            single_qr_step(&mut t, &mut q, low, high, shift);
        }
        for j in 0..n {
            for i in j + 1..n {
                t[(i, j)] = C::new(0.0, 0.0);
            }
        }
        Ok(Self { q, t })
    }

    /// Moves the selected eigenvalues of the Schur form to the top by swaps of neighbours, and returns their
    /// number (Bai and Demmel, *On swapping diagonal blocks in real Schur form*, 1993, for single entries).
    pub fn reorder(&mut self, selected: impl Fn(C) -> bool) -> usize {
        let n = self.t.nrows();
        let mut top = 0;
        for k in 0..n {
            if selected(self.t[(k, k)]) {
                self.raise_eigenvalue(k, top);
                top += 1;
            }
        }
        top
    }

    /// Moves the eigenvalue at the index `from` of the Schur form up to the index `to`.
    pub fn raise_eigenvalue(&mut self, from: usize, to: usize) {
        (to..from).rev().for_each(|j| self.swap_eigenvalues(j));
    }

    fn swap_eigenvalues(&mut self, k: usize) {
        let n = self.t.nrows();
        let (first, second) = (self.t[(k, k)], self.t[(k + 1, k + 1)]);
        let rotation = GivensRotation::rotation_zeroing_second_entry(self.t[(k, k + 1)], second - first);
        rotation.rotate_rows(&mut self.t, k, k..n);
        rotation.rotate_columns(&mut self.t, k, 0..k + 2);
        rotation.rotate_columns(&mut self.q, k, 0..n);
        self.t[(k, k)] = second;
        self.t[(k + 1, k + 1)] = first;
        self.t[(k + 1, k)] = C::new(0.0, 0.0);
    }

    /// Returns the unit right eigenvector of the eigenvalue in column `k`. Several eigenvectors of a
    /// defective matrix coincide.
    pub fn right_eigenvector(&self, k: usize) -> CMatrix {
        let n = self.t.nrows();
        let lambda = self.t[(k, k)];
        let least = f64::EPSILON * self.t.norm().max(f64::MIN_POSITIVE);
        let mut y = CMatrix::zeros(n, 1);
        y[k] = C::new(1.0, 0.0);
        for i in (0..k).rev() {
            let sum: C = (i + 1..=k).map(|j| self.t[(i, j)] * y[j]).sum();
            y[i] = -sum / nonzero_pivot(self.t[(i, i)] - lambda, least);
        }
        let v = &self.q * y;
        let norm = v.norm();
        v.unscale(norm)
    }

    /// Returns the unit left eigenvector `wᴴ A = λ wᴴ` of the eigenvalue in column `k`.
    pub fn left_eigenvector(&self, k: usize) -> CMatrix {
        let n = self.t.nrows();
        let lambda = self.t[(k, k)];
        let least = f64::EPSILON * self.t.norm().max(f64::MIN_POSITIVE);
        let mut y = CMatrix::zeros(n, 1);
        y[k] = C::new(1.0, 0.0);
        for i in k + 1..n {
            let sum: C = (k..i).map(|j| self.t[(j, i)] * y[j]).sum();
            y[i] = -sum / nonzero_pivot(self.t[(i, i)] - lambda, least);
        }
        let w = &self.q * y.map(|x| x.conj());
        let norm = w.norm();
        w.unscale(norm)
    }
}

fn nonzero_pivot(x: C, least: f64) -> C {
    if x.norm() < least { C::new(least, 0.0) } else { x }
}

/// Returns the first row of the active block that ends at row `high`. The subdiagonal entry above that block
/// is set to zero.
fn isolate_active_block(t: &mut CMatrix, high: usize, size: f64) -> usize {
    for k in (1..=high).rev() {
        let mut near = t[(k - 1, k - 1)].norm() + t[(k, k)].norm();
        if near == 0.0 {
            near = size;
        }
        if t[(k, k - 1)].norm() <= f64::EPSILON * near {
            t[(k, k - 1)] = C::new(0.0, 0.0);
            return k;
        }
    }
    0
}

/// Returns Wilkinson's shift, or an exceptional shift in every tenth step.
fn wilkinson_shift(t: &CMatrix, high: usize, steps: usize) -> C {
    let d = t[(high, high)];
    if steps.is_multiple_of(10) {
        return d + C::new(0.75 * t[(high, high - 1)].norm(), 0.0);
    }
    let (a, b, c) = (t[(high - 1, high - 1)], t[(high - 1, high)], t[(high, high - 1)]);
    let half = (a - d) * 0.5;
    let root = (half * half + b * c).sqrt();
    let (plus, minus) = (half + root, half - root);
    let larger = if plus.norm() > minus.norm() { plus } else { minus };
    if larger.norm() == 0.0 { d } else { d - b * c / larger }
}

fn single_qr_step(t: &mut CMatrix, q: &mut CMatrix, low: usize, high: usize, shift: C) {
    let n = t.nrows();
    let (mut x, mut y) = (t[(low, low)] - shift, t[(low + 1, low)]);
    for k in low..high {
        let rotation = GivensRotation::rotation_zeroing_second_entry(x, y);
        rotation.rotate_rows(t, k, k.saturating_sub(1).max(low)..n);
        rotation.rotate_columns(t, k, 0..(k + 3).min(high + 1));
        rotation.rotate_columns(q, k, 0..n);
        if k > low {
            t[(k + 1, k - 1)] = C::new(0.0, 0.0);
        }
        if k + 1 < high {
            (x, y) = (t[(k + 1, k)], t[(k + 2, k)]);
        }
    }
}
