//! Pole placement by state feedback.

use crate::matrices::{eigenvalues, is_uncontrollable_mode, solve_linear_system, sylvester};
use crate::{Error, StateSpace};
use nalgebra::{Complex, DMatrix};

/// Returns a real matrix with the given eigenvalues and one eigenvector per distinct eigenvalue. A conjugate
/// pair of eigenvalues is a block of two rows.
fn real_matrix_with_poles(poles: &[Complex<f64>]) -> Result<DMatrix<f64>, Error> {
    let n = poles.len();
    let mut upper: Vec<_> = poles.iter().filter(|pole| pole.im >= 0.0).copied().collect();
    let has_matching_conjugate = |pole: &Complex<f64>| {
        let count_equal_poles = |wanted: Complex<f64>| poles.iter().filter(|other| **other == wanted).count();
        count_equal_poles(*pole) == count_equal_poles(pole.conj())
    };
    if let Some(pole) = poles.iter().find(|pole| !pole.is_finite() || !has_matching_conjugate(pole)) {
        return Err(Error::Unpaired { pole: *pole });
    }
    upper.sort_by(|x, y| x.re.total_cmp(&y.re).then(x.im.total_cmp(&y.im)));
    let mut all = DMatrix::zeros(n, n);
    let (mut k, mut before) = (0, None);
    for pole in upper {
        let size = if pole.im > 0.0 { 2 } else { 1 };
        for i in 0..size {
            all[(k + i, k + i)] = pole.re;
            if before == Some(pole) {
                all[(k + i - size, k + i)] = pole.norm().max(1e-3);
            }
        }
        if size == 2 {
            all[(k, k + 1)] = pole.im;
            all[(k + 1, k)] = -pole.im;
        }
        (k, before) = (k + size, Some(pole));
    }
    Ok(all)
}

/// Returns deterministic pseudorandom numbers between −1 and 1.
fn pseudorandom_matrix(rows: usize, columns: usize, attempt: usize) -> DMatrix<f64> {
    let mut state = 0x9e37_79b9_u32.wrapping_mul(2 * u32::try_from(attempt).unwrap_or(0) + 1);
    DMatrix::from_fn(rows, columns, |_, _| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        f64::from(state) / f64::from(u32::MAX) * 2.0 - 1.0
    })
}

/// Returns the largest distance between a required pole and its nearest computed pole, as a fraction of the
/// tolerance. The tolerance grows with the multiplicity of the pole.
fn pole_error_over_tolerance(wanted: &[Complex<f64>], mut found: Vec<Complex<f64>>) -> f64 {
    let size = wanted.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let mut worst: f64 = 0.0;
    for pole in wanted {
        let distance_to_pole = |i: &usize| found.get(*i).map_or(f64::INFINITY, |other| (other - pole).norm());
        let Some(best) = (0..found.len()).min_by(|i, j| distance_to_pole(i).total_cmp(&distance_to_pole(j)))
        else {
            return f64::INFINITY;
        };
        let times = wanted.iter().filter(|other| *other == pole).count();
        let excused = 1e-10_f64.powf(1.0 / times as f64) * size.max(f64::MIN_POSITIVE);
        worst = worst.max(distance_to_pole(&best) / excused);
        found.swap_remove(best);
    }
    worst
}

/// Number of random attempts at pole placement with several inputs, where many gains give the same poles. The
/// best attempt is returned.
const ATTEMPTS: usize = 16;

impl StateSpace {
    /// Computes the gain of the regulator `u = −K x` for which `A − B K` has the eigenvalues `poles`. With
    /// several inputs, the gain is the one with the best conditioned eigenvectors among several candidates.
    /// For the dual system, the transpose of the result is the gain of an observer.
    ///
    /// ```
    /// use linkwork_design::StateSpace;
    /// use nalgebra::{Complex, dmatrix};
    ///
    /// // A mass under a force: s² + k₂ s + k₁ with the poles −1 ± 2i.
    /// let mass = StateSpace::new(dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0])?;
    /// let gain = mass.place(&[Complex::new(-1.0, 2.0), Complex::new(-1.0, -2.0)])?;
    /// assert!((gain - dmatrix![5.0, 2.0]).norm() < 1e-12);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// Source: Bhattacharyya and de Souza, *Pole assignment via Sylvester's equation*, Systems & Control
    /// Letters 1 (1982).
    ///
    /// # Errors
    ///
    /// [`Error::Count`] if the number of poles differs from the number of states, [`Error::Unpaired`] for a
    /// complex pole without its conjugate, [`Error::Unstabilizable`] with a mode that no input controls,
    /// [`Error::Singular`] if rounding errors displace the poles.
    pub fn place(&self, poles: &[Complex<f64>]) -> Result<DMatrix<f64>, Error> {
        let (n, m) = self.b.shape();
        if poles.len() != n {
            return Err(Error::Count { what: "poles", expected: n, found: poles.len() });
        }
        if n == 0 {
            return Ok(DMatrix::zeros(m, 0));
        }
        let wanted = real_matrix_with_poles(poles)?;
        let modes = eigenvalues(&self.a)?;
        if let Some(mode) = modes.into_iter().find(|mode| is_uncontrollable_mode(&self.a, &self.b, *mode)) {
            return Err(Error::Unstabilizable { mode });
        }
        let size = self.a.norm().max(wanted.norm()) / self.b.norm().max(f64::MIN_POSITIVE);
        let mut best: Option<(f64, DMatrix<f64>)> = None;
        for attempt in 0..ATTEMPTS {
            // Except in the first attempt, a random gain displaces poles that are already present.
            let away = pseudorandom_matrix(m, n, attempt) * (if attempt == 0 { 0.0 } else { size });
            let moved = &self.a - &self.b * &away;
            let Ok(x) =
                sylvester(&moved, &-&wanted, &(&self.b * pseudorandom_matrix(m, n, ATTEMPTS + attempt)))
            else {
                continue;
            };
            let what = "the matrix of the eigenvectors";
            let transposed = pseudorandom_matrix(m, n, ATTEMPTS + attempt).transpose();
            let Ok(gain) = solve_linear_system(what, &x.transpose(), &transposed) else { continue };
            let gain = away + gain.transpose();
            let found = pole_error_over_tolerance(poles, eigenvalues(&(&self.a - &self.b * &gain))?);
            let singular = x.singular_values();
            let measure = singular.max() / singular.min();
            if found <= 1.0 && best.as_ref().is_none_or(|(least, _)| measure < *least) {
                best = Some((measure, gain));
            }
        }
        best.map(|(_, gain)| gain)
            .ok_or(Error::Singular { what: "the matrix of the closed loop's eigenvectors" })
    }
}
