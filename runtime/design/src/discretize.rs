//! Discretisation of continuous linear systems, and its inverse.

use crate::matrices::{C, exponential, logarithm, solve_linear_system};
use crate::{Error, StateSpace, ZerosPolesGain};
use nalgebra::DMatrix;

/// Method by which a continuous system is discretised.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Hold {
    /// Zero-order hold: inputs are constant between sampling instants. Exact for a digital controller.
    Zero,
    /// First-order (triangle) hold: inputs are piecewise linear between sampling instants. Exact for measured
    /// inputs that vary linearly.
    First,
    /// Trapezoidal rule (Tustin's method), `s = 2 (z − 1) / (h (z + 1))`.
    Tustin,
    /// Tustin's rule, prewarped to be exact at this frequency, rad/s.
    Prewarped(f64),
}

fn check_period(period: f64) -> Result<(), Error> {
    if period > 0.0 && period.is_finite() { Ok(()) } else { Err(Error::Period { period }) }
}

/// Returns the factor `a` of the bilinear transformation `s = a (z − 1) / (z + 1)`.
fn bilinear_factor(hold: Hold, h: f64) -> Result<f64, Error> {
    match hold {
        Hold::Prewarped(w) if !(w > 0.0 && w * h < std::f64::consts::PI) => {
            Err(Error::Range { what: "a frequency for prewarping", value: w })
        }
        Hold::Prewarped(w) => Ok(w / (0.5 * w * h).tan()),
        _ => Ok(2.0 / h),
    }
}

impl StateSpace {
    fn expect_continuous(&self) -> Result<(), Error> {
        if self.period.is_some() { Err(Error::Time { periods: [self.period, None] }) } else { Ok(()) }
    }

    /// Returns the discrete system with the outputs at the sampling instants `0, h, 2 h, …` (Franklin, Powell
    /// and Workman, *Digital Control of Dynamic Systems*, ch. 4 and 6).
    ///
    /// ```
    /// use linkwork_design::{Hold, TransferFunction};
    ///
    /// // A lag of one second, sampled at 10 Hz.
    /// let lag = TransferFunction::new([1.0], [1.0, 1.0])?.state_space()?;
    /// assert!((lag.discretize(0.1, Hold::Zero)?.poles()?[0].re - (-0.1_f64).exp()).abs() < 1e-15);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Period`] unless the period is positive and finite, [`Error::Time`] for a discrete system,
    /// [`Error::Singular`] if Tustin's rule is applied to a pole at `2 / h`.
    pub fn discretize(&self, period: f64, hold: Hold) -> Result<Self, Error> {
        self.expect_continuous()?;
        check_period(period)?;
        let (n, m) = self.b.shape();
        let (a, b, c, d) = match hold {
            Hold::Zero => {
                let mut both = DMatrix::zeros(n + m, n + m);
                both.view_mut((0, 0), (n, n)).copy_from(&(&self.a * period));
                both.view_mut((0, n), (n, m)).copy_from(&(&self.b * period));
                let e = exponential(&both)?;
                let (a, b) = (e.view((0, 0), (n, n)).into_owned(), e.view((0, n), (n, m)).into_owned());
                (a, b, self.c.clone(), self.d.clone())
            }
            Hold::First => {
                let mut all = DMatrix::zeros(n + 2 * m, n + 2 * m);
                all.view_mut((0, 0), (n, n)).copy_from(&(&self.a * period));
                all.view_mut((0, n), (n, m)).copy_from(&(&self.b * period));
                all.view_mut((n, n + m), (m, m)).fill_with_identity();
                let e = exponential(&all)?;
                let a = e.view((0, 0), (n, n)).into_owned();
                let (one, two) =
                    (e.view((0, n), (n, m)).into_owned(), e.view((0, n + m), (n, m)).into_owned());
                let (b, d) = (&one + &a * &two - &two, &self.d + &self.c * &two);
                (a, b, self.c.clone(), d)
            }
            Hold::Tustin | Hold::Prewarped(_) => {
                let s = bilinear_factor(hold, period)?;
                let what = "I − A / s of Tustin's rule";
                let m = DMatrix::identity(n, n) - &self.a / s;
                let a = solve_linear_system(what, &m, &(DMatrix::identity(n, n) + &self.a / s))?;
                let b = solve_linear_system(what, &m, &(&self.b * (2.0 / s)))?;
                let c = solve_linear_system(what, &m.transpose(), &self.c.transpose())?.transpose();
                let d = &self.d + &self.c * &b * 0.5;
                (a, b, c, d)
            }
        };
        Self { a, b, c, d, ..self.clone() }.with_period(period)
    }

    /// Returns the continuous system whose discretisation with this hold is the given discrete system.
    ///
    /// # Errors
    ///
    /// [`Error::Time`] for a continuous system; [`Error::Range`] for a zero or negative real pole, which no
    /// discretisation with a hold has; [`Error::Singular`] if Tustin's rule is applied to a pole at −1.
    pub fn undiscretize(&self, hold: Hold) -> Result<Self, Error> {
        let Some(period) = self.period else { return Err(Error::Time { periods: [None, Some(0.0)] }) };
        let (n, m) = self.b.shape();
        let identity = DMatrix::<f64>::identity(n, n);
        let (a, b, c, d) = match hold {
            Hold::Zero => {
                let mut both = DMatrix::identity(n + m, n + m);
                both.view_mut((0, 0), (n, n)).copy_from(&self.a);
                both.view_mut((0, n), (n, m)).copy_from(&self.b);
                let log = logarithm(&both)? / period;
                let (a, b) = (log.view((0, 0), (n, n)).into_owned(), log.view((0, n), (n, m)).into_owned());
                (a, b, self.c.clone(), self.d.clone())
            }
            Hold::First => return self.undiscretize_first_order_hold(period),
            Hold::Tustin | Hold::Prewarped(_) => {
                let s = bilinear_factor(hold, period)?;
                let what = "A + I of Tustin's rule";
                let m = &self.a + &identity;
                let a = solve_linear_system(what, &m, &(&self.a - &identity))? * s;
                let b = solve_linear_system(what, &m, &self.b)? * s;
                let c = solve_linear_system(what, &m.transpose(), &self.c.transpose())?.transpose() * 2.0;
                let d = &self.d - &self.c * solve_linear_system(what, &m, &self.b)?;
                (a, b, c, d)
            }
        };
        Ok(Self { a, b, c, d, period: None, ..self.clone() })
    }

    fn undiscretize_first_order_hold(&self, period: f64) -> Result<Self, Error> {
        let n = self.order();
        let a = logarithm(&self.a)? / period;
        // Γ₁ = W₁ B and Γ₂ = W₂ B with the blocks of the exponential of [A h, h I, 0; 0, 0, I; 0, 0, 0].
        let mut all = DMatrix::zeros(3 * n, 3 * n);
        all.view_mut((0, 0), (n, n)).copy_from(&(&a * period));
        all.view_mut((0, n), (n, n)).copy_from(&(DMatrix::<f64>::identity(n, n) * period));
        all.view_mut((n, 2 * n), (n, n)).fill_with_identity();
        let e = exponential(&all)?;
        let (one, two) = (e.view((0, n), (n, n)).into_owned(), e.view((0, 2 * n), (n, n)).into_owned());
        let b = solve_linear_system("the triangle hold", &(&one + &self.a * &two - &two), &self.b)?;
        let d = &self.d - &self.c * &two * &b;
        Ok(Self { a, b, d, period: None, ..self.clone() })
    }
}

impl ZerosPolesGain {
    /// Discretises by matching poles and zeros, which become `e^{s h}`. Zeros at infinity become −1 except
    /// for one, which remains at infinity, and the gain at low frequencies is preserved. For poles or zeros
    /// at `s = 0`, the gain is the limit: `1 / s` becomes `h / (z − 1)`, and `1 / s²` becomes
    /// `h² (z + 1) / (2 (z − 1)²)`.
    ///
    /// # Errors
    ///
    /// [`Error::Period`], [`Error::Improper`], [`Error::Time`] for a discrete system, [`Error::Singular`] for
    /// a nonzero pole or zero whose frequency is a multiple of the sampling frequency, since its image is
    /// `z = 1`.
    pub fn matched(&self, period: f64) -> Result<Self, Error> {
        check_period(period)?;
        if self.period.is_some() {
            return Err(Error::Time { periods: [self.period, None] });
        }
        let (numerator, denominator) = (self.zeros.len(), self.poles.len());
        if numerator > denominator {
            return Err(Error::Improper { numerator, denominator });
        }
        let map_roots_to_z_plane = |roots: &[C]| roots.iter().map(|s| (s * period).exp()).collect::<Vec<_>>();
        let mut zeros = map_roots_to_z_plane(&self.zeros);
        let excess = (denominator - numerator).saturating_sub(1);
        zeros.extend(std::iter::repeat_n(C::new(-1.0, 0.0), excess));
        // A factor `s − r` has the value `−r` at `s = 0`; its image at `z = 1` has the value
        // `1 − e^{r h}`. Their ratio tends to `h` for small `r`.
        let static_gain_ratio_of_root = |root: &C| match root.norm() {
            0.0 => C::new(period, 0.0),
            _ => exponential_less_one(root * period) / root,
        };
        let zeros_and_poles = || self.zeros.iter().chain(&self.poles);
        if zeros_and_poles()
            .any(|root| exponential_less_one(root * period).norm() < 1e-12 * (root * period).norm())
        {
            return Err(Error::Singular { what: "the gain of the matched system at rest" });
        }
        let mut gain = C::new(self.gain * (-(excess as f64)).exp2(), 0.0);
        for k in 0..denominator {
            gain *= static_gain_ratio_of_root(&self.poles[k]);
            gain /= self.zeros.get(k).map_or(C::new(1.0, 0.0), static_gain_ratio_of_root);
        }
        Ok(Self { zeros, poles: map_roots_to_z_plane(&self.poles), gain: gain.re, period: Some(period) })
    }
}

/// Computes `e^x − 1` without cancellation near zero.
fn exponential_less_one(x: C) -> C {
    let half = (0.5 * x.im).sin();
    C::new(x.re.exp_m1() * x.im.cos() - 2.0 * half * half, x.re.exp() * x.im.sin())
}
