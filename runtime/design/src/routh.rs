//! Routh's table of a polynomial, with its singular cases.

use crate::matrices::C;
use crate::{Error, Polynomial};

/// Kind of a row of Routh's table: regular or singular.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Special {
    /// Row of Routh's table without a singularity.
    Regular,
    /// Row of Routh's table that began with zeros but was not zero. The row, shifted to its first nonzero
    /// entry and multiplied by the sign of the shift, was added, which avoids the ε method (Benidir and
    /// Picinbono, *Extended table for eliminating the singularities in Routh's array*, 1990).
    LeadingZero,
    /// Row of Routh's table that was zero, since roots are symmetric about the origin. It was replaced by the
    /// derivative of the polynomial of the previous row.
    ZeroRow,
}

/// Routh's table of a polynomial, with the root counts that it gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Routh {
    /// Rows of Routh's table, after the replacement of singular rows.
    pub rows: Vec<Vec<f64>>,
    /// Kind of each row of Routh's table: regular, leading zero or zero row.
    pub special: Vec<Special>,
    /// Number of roots of the polynomial with positive real part, which is the number of sign changes in the
    /// first column of Routh's table.
    pub right: usize,
    /// Number of roots of the polynomial on the imaginary axis.
    pub imaginary: usize,
}

/// Relative threshold in Routh's table: entries below this, relative to the terms of their difference, count
/// as zero.
const ZERO: f64 = 1e-12;

impl Polynomial {
    /// Computes Routh's table of the polynomial.
    ///
    /// ```
    /// use linkwork_design::Polynomial;
    ///
    /// // s³ + 2 s² + 3 s + 4 + K with K = 2: two roots on the imaginary axis, at ±i√3.
    /// let table = Polynomial::new([1.0, 2.0, 3.0, 6.0]).routh()?;
    /// assert_eq!((table.right, table.imaginary), (0, 2));
    /// assert!(!table.is_stable());
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Range`] for the zero polynomial, [`Error::NotFinite`].
    pub fn routh(&self) -> Result<Routh, Error> {
        if self.is_zero() {
            return Err(Error::Range { what: "a table of the polynomial", value: 0.0 });
        }
        if !self.coefficients().iter().all(|c| c.is_finite()) {
            return Err(Error::NotFinite { what: "the polynomial" });
        }
        let n = self.degree();
        let c = self.coefficients();
        let mut rows: Vec<Vec<f64>> = vec![c.iter().step_by(2).copied().collect()];
        let mut special = vec![Special::Regular];
        let mut symmetric_from = None;
        for k in 1..=n {
            let length = (n - k) / 2 + 1;
            let above = rows[k - 1].clone();
            let (mut row, sizes) = match k {
                1 => {
                    let row: Vec<f64> = c.iter().skip(1).step_by(2).copied().collect();
                    let size = c.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                    (row, vec![size; length])
                }
                _ => cross_multiplied_row(&rows[k - 2], &above, length),
            };
            row.resize(length, 0.0);
            for (x, size) in row.iter_mut().zip(sizes) {
                if x.abs() <= ZERO * size && k > 1 {
                    *x = 0.0;
                }
            }
            let mut what = Special::Regular;
            if row.iter().all(|x| *x == 0.0) {
                // The row above is a polynomial of degree n − k + 1 in even or odd powers.
                what = Special::ZeroRow;
                symmetric_from.get_or_insert(k);
                let degree = n - k + 1;
                let derivative_coefficient = |(j, x): (usize, &f64)| x * degree.saturating_sub(2 * j) as f64;
                row = above.iter().enumerate().map(derivative_coefficient).take(length).collect();
            }
            if row[0] == 0.0 {
                what = if what == Special::Regular { Special::LeadingZero } else { what };
                let zeros = row.iter().take_while(|x| **x == 0.0).count();
                let sign = if zeros.is_multiple_of(2) { 1.0 } else { -1.0 };
                let shifted: Vec<f64> = row.iter().skip(zeros).map(|x| sign * x).collect();
                row.iter_mut().zip(shifted).for_each(|(x, s)| *x += s);
            }
            rows.push(row);
            special.push(what);
        }
        let count_sign_changes = |from: usize| {
            let first: Vec<f64> = rows.iter().skip(from).map(|r| r[0]).collect();
            first.windows(2).filter(|w| w[0] * w[1] < 0.0).count()
        };
        let right = count_sign_changes(0);
        // The factor with symmetric roots has equal numbers of roots in both half-planes; the others are on
        // the axis.
        let imaginary = symmetric_from.map_or(0, |k| (n + 1 - k) - 2 * count_sign_changes(k - 1));
        Ok(Routh { rows, special, right, imaginary })
    }
}

fn cross_multiplied_row(two: &[f64], one: &[f64], length: usize) -> (Vec<f64>, Vec<f64>) {
    let entry_or_zero = |row: &[f64], j: usize| row.get(j).copied().unwrap_or(0.0);
    let ratio = entry_or_zero(two, 0) / entry_or_zero(one, 0);
    let terms = (0..length).map(|j| (entry_or_zero(two, j + 1), ratio * entry_or_zero(one, j + 1)));
    terms.map(|(a, b)| (a - b, a.abs().max(b.abs()))).unzip()
}

impl Routh {
    /// Whether all roots of the polynomial have negative real parts.
    pub fn is_stable(&self) -> bool {
        self.right == 0 && self.imaginary == 0
    }
}

/// Open interval of feedback gains for which a loop is stable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainRange {
    /// Lower end of the gain interval; may be minus infinity.
    pub low: f64,
    /// Upper end of the gain interval; may be infinity.
    pub high: f64,
}

impl Polynomial {
    /// Computes the gains `k` for which all roots of `self + k · other` have negative real parts, as
    /// intervals.
    ///
    /// ```
    /// use linkwork_design::Polynomial;
    ///
    /// let ranges = Polynomial::new([1.0, 2.0, 3.0, 4.0]).stable_gains(&Polynomial::constant(1.0))?;
    /// assert!((ranges[0].low + 4.0).abs() < 1e-12 && (ranges[0].high - 2.0).abs() < 1e-12);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`].
    pub fn stable_gains(&self, other: &Self) -> Result<Vec<GainRange>, Error> {
        let mut critical = self.candidate_critical_gains(other)?;
        critical.sort_by(f64::total_cmp);
        critical.dedup_by(|a, b| (*a - *b).abs() <= 1e-12 * b.abs());
        let mut ends = vec![f64::NEG_INFINITY];
        ends.extend(critical);
        ends.push(f64::INFINITY);
        let is_stable_with_gain = |k: f64| -> Result<bool, Error> {
            let polynomial = self + &other.scaled(k);
            Ok(!polynomial.is_zero() && polynomial.routh()?.is_stable())
        };
        let mut ranges: Vec<GainRange> = Vec::new();
        for pair in ends.windows(2) {
            let (low, high) = (pair[0], pair[1]);
            let inside = match (low.is_finite(), high.is_finite()) {
                (true, true) => 0.5 * (low + high),
                (true, false) => low + 1.0 + low.abs(),
                (false, true) => high - 1.0 - high.abs(),
                (false, false) => 0.0,
            };
            if !is_stable_with_gain(inside)? {
                continue;
            }
            // A candidate that is not critical does not end a range.
            match ranges.last_mut() {
                Some(last) if last.high == low && is_stable_with_gain(low)? => last.high = high,
                _ => ranges.push(GainRange { low, high }),
            }
        }
        Ok(ranges)
    }

    /// Returns candidates that include all gains at which a root is on the imaginary axis or at infinity. The
    /// list may contain other gains as well.
    fn candidate_critical_gains(&self, other: &Self) -> Result<Vec<f64>, Error> {
        let mirrored_polynomial = |p: &Self| {
            let n = p.degree();
            let signs = p.coefficients().iter().enumerate();
            Self::new(signs.map(|(k, c)| if (n - k).is_multiple_of(2) { *c } else { -c }))
        };
        // A root at s = iω makes p(s) / q(s) real: a root of the odd part of p(s) q(−s).
        let odd = &(self * &mirrored_polynomial(other)) - &(&mirrored_polynomial(self) * other);
        let mut points = vec![0.0];
        points.extend(odd.roots()?.into_iter().map(|r| r.im).filter(|w| *w > 0.0));
        let mut found = Vec::new();
        for w in points {
            let s = C::new(0.0, w);
            // At a zero of q the gain is infinite.
            if other.at(s).norm() > other.rounding_bound_at(w) {
                found.push((-self.at(s) / other.at(s)).re);
            }
        }
        if other.degree() >= self.degree() && !other.is_zero() {
            found.push(-self.coefficient(other.degree()) / other.leading());
        }
        found.retain(|k| k.is_finite());
        Ok(found)
    }
}
