//! Frequencies at which a response has a given gain or is real, computed as eigenvalues of matrix pencils.

use crate::matrices::{C, balance_system, eigenvalues, solve_linear_system};
use crate::{Error, StateSpace};
use nalgebra::DMatrix;

/// Matrix pencil `M − s E` that is singular at the frequencies sought; `s` is `z` for a discrete system.
struct MatrixPencil {
    m: DMatrix<f64>,
    e: DMatrix<f64>,
}

impl MatrixPencil {
    /// Returns the finite eigenvalues of the pencil `M − s E` as `σ + 1 / μ`, where `μ` are the eigenvalues
    /// of `(M − σ E)⁻¹ E`. Infinite eigenvalues may be returned as large ones. If the pencil is singular for
    /// all `s`, the list is empty.
    fn finite_eigenvalues(&self, shift: f64) -> Vec<C> {
        let inverse = solve_linear_system("the pencil", &(&self.m - &self.e * shift), &self.e);
        let found = inverse.and_then(|inverse| eigenvalues(&inverse)).unwrap_or_default();
        let finite = found.iter().filter(|mu| mu.norm() > 0.0);
        finite.map(|mu| mu.inv() + shift).filter(|s| s.re.is_finite() && s.im.is_finite()).collect()
    }
}

impl StateSpace {
    /// Returns the frequency of a pole or zero in the complex plane, rad/s: `|Im s|`, or `|arg z| / h` for a
    /// discrete system.
    pub(crate) fn frequency_of_root(&self, root: C) -> f64 {
        self.period.map_or(root.im.abs(), |h| root.arg().abs() / h)
    }

    /// Returns the upper end of the frequency axis, rad/s: infinity, or the Nyquist frequency.
    pub(crate) fn upper_frequency_limit(&self) -> f64 {
        self.period.map_or(f64::INFINITY, |h| std::f64::consts::PI / h)
    }

    /// Returns the damped and the natural frequencies of all poles and zeros, rad/s.
    pub(crate) fn pole_and_zero_frequencies(&self) -> Result<Vec<f64>, Error> {
        let mut all = Vec::new();
        for root in self.poles()?.into_iter().chain(self.zeros().unwrap_or_default()) {
            let exponent = self.period.map_or(root, |h| root.ln() / h);
            all.extend([self.frequency_of_root(root), exponent.norm()]);
        }
        all.retain(|w| *w > 0.0 && *w < self.upper_frequency_limit());
        Ok(all)
    }

    /// Returns candidates that include all frequencies at which a singular value of the response equals
    /// `level`, in ascending order.
    pub(crate) fn frequencies_at_gain_level(&self, level: f64) -> Result<Vec<f64>, Error> {
        let (a, b, c, _) = balance_system(&self.a, &self.b, &self.c);
        let ((n, m), p) = (b.shape(), c.nrows());
        // y = G u = γ w and Gᵀ(−s) w = γ u, or Gᵀ(1 / z) w = γ u, in the unknowns x, q, u, w.
        let size = 2 * n + m + p;
        let (mut left, mut right) = (DMatrix::zeros(size, size), DMatrix::zeros(size, size));
        let (u, w) = (2 * n, 2 * n + m);
        left.view_mut((0, 0), (n, n)).copy_from(&a);
        left.view_mut((0, u), (n, m)).copy_from(&b);
        right.view_mut((0, 0), (n, n)).fill_with_identity();
        if self.period.is_none() {
            left.view_mut((n, n), (n, n)).copy_from(&-a.transpose());
            left.view_mut((n, w), (n, p)).copy_from(&-c.transpose());
            right.view_mut((n, n), (n, n)).fill_with_identity();
        } else {
            left.view_mut((n, n), (n, n)).fill_with_identity();
            right.view_mut((n, n), (n, n)).copy_from(&a.transpose());
            right.view_mut((n, w), (n, p)).copy_from(&c.transpose());
        }
        left.view_mut((u, 0), (p, n)).copy_from(&c);
        left.view_mut((u, u), (p, m)).copy_from(&self.d);
        left.view_mut((u, w), (p, p)).fill_diagonal(-level);
        left.view_mut((u + p, n), (m, n)).copy_from(&b.transpose());
        left.view_mut((u + p, w), (m, p)).copy_from(&self.d.transpose());
        left.view_mut((u + p, u), (m, m)).fill_diagonal(-level);
        self.pencil_frequencies(&MatrixPencil { m: left, e: right })
    }

    /// Returns candidates that include all frequencies at which the response of a single channel is real, in
    /// ascending order. They are zeros of `G(s) − G(−s)`, or of `G(z) − G(1 / z)`.
    pub(crate) fn candidate_real_response_frequencies(&self) -> Result<Vec<f64>, Error> {
        let (a, b, c, _) = balance_system(&self.a, &self.b, &self.c);
        let n = a.nrows();
        let size = 2 * n + 1;
        let (mut left, mut right) = (DMatrix::zeros(size, size), DMatrix::zeros(size, size));
        left.view_mut((0, 0), (n, n)).copy_from(&a);
        left.view_mut((0, 2 * n), (n, 1)).copy_from(&b);
        right.view_mut((0, 0), (n, n)).fill_with_identity();
        if self.period.is_none() {
            left.view_mut((n, n), (n, n)).copy_from(&-&a);
            left.view_mut((n, 2 * n), (n, 1)).copy_from(&-&b);
            right.view_mut((n, n), (n, n)).fill_with_identity();
        } else {
            left.view_mut((n, n), (n, n)).fill_with_identity();
            right.view_mut((n, n), (n, n)).copy_from(&a);
            right.view_mut((n, 2 * n), (n, 1)).copy_from(&b);
        }
        left.view_mut((2 * n, 0), (1, n)).copy_from(&c);
        left.view_mut((2 * n, n), (1, n)).copy_from(&-&c);
        self.pencil_frequencies(&MatrixPencil { m: left, e: right })
    }

    /// Returns the frequencies of the eigenvalues of a matrix pencil, rad/s, computed with several shifts.
    /// Each shift is accurate for eigenvalues of about its own magnitude.
    fn pencil_frequencies(&self, pencil: &MatrixPencil) -> Result<Vec<f64>, Error> {
        let (a, b, c, _) = balance_system(&self.a, &self.b, &self.c);
        let mut scales = self.pole_and_zero_frequencies()?;
        let unit = self.period.map_or_else(|| a.norm().max(b.norm() * c.norm()), |h| 1.0 / h);
        scales.push(if unit > 0.0 { unit } else { 1.0 });
        scales.sort_by(f64::total_cmp);
        let mut last = 0.0;
        scales.retain(|scale| {
            let far = *scale > 100.0 * last;
            last = if far { *scale } else { last };
            far
        });
        let mut found = Vec::new();
        for scale in scales {
            let shift = self.period.map_or(1.13 * scale, |h| (1.13 * scale * h).min(1.0).exp());
            found.extend(pencil.finite_eigenvalues(shift).into_iter().map(|s| self.frequency_of_root(s)));
        }
        found.retain(|w| *w > 0.0 && *w < self.upper_frequency_limit());
        found.sort_by(f64::total_cmp);
        Ok(found)
    }
}
