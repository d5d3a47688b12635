//! Transfer functions of systems with one input and one output.

use crate::matrices::C;
use crate::polynomial::{format_factors, format_number};
use crate::{Error, Polynomial, StateSpace};
use nalgebra::DMatrix;
use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

/// Transfer function as a ratio of polynomials in `s`, or in `z` for a discrete system.
///
/// ```
/// use linkwork_design::TransferFunction;
///
/// let g = TransferFunction::new([1.0], [1.0, 2.0, 3.0, 4.0])?;
/// assert_eq!(g.to_string(), "1 / (s³ + 2 s² + 3 s + 4)");
/// let closed = g.feedback(&TransferFunction::constant(1.0))?;
/// assert_eq!(closed.denominator().coefficients(), [1.0, 2.0, 3.0, 5.0]);
/// # Ok::<(), linkwork_design::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    numerator: Polynomial,
    denominator: Polynomial,
    period: Option<f64>,
}

/// Transfer function given by its zeros, poles and gain: `k ∏(s − zᵢ) / ∏(s − pᵢ)`.
#[derive(Clone, Debug, PartialEq)]
pub struct ZerosPolesGain {
    /// Zeros of the transfer function, in conjugate pairs.
    pub zeros: Vec<C>,
    /// Poles of the transfer function, in conjugate pairs.
    pub poles: Vec<C>,
    /// Gain factor `k` of the transfer function: the ratio of the leading coefficients.
    pub gain: f64,
    /// Sampling period of a discrete system, s.
    pub period: Option<f64>,
}

impl TransferFunction {
    /// Creates a transfer function from the coefficients of numerator and denominator, highest power first.
    /// The leading coefficient of the denominator is normalised to one. Improper transfer functions, such as
    /// a differentiator, are accepted here; operations whose result would not exist reject them.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if the denominator is zero, [`Error::NotFinite`].
    pub fn new(
        numerator: impl IntoIterator<Item = f64>,
        denominator: impl IntoIterator<Item = f64>,
    ) -> Result<Self, Error> {
        Self::quotient(&Polynomial::new(numerator), &Polynomial::new(denominator))
    }

    /// Creates a transfer function from two polynomials.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] if the denominator is zero, [`Error::NotFinite`].
    pub fn quotient(numerator: &Polynomial, denominator: &Polynomial) -> Result<Self, Error> {
        if denominator.is_zero() {
            return Err(Error::Range { what: "a denominator", value: 0.0 });
        }
        for (what, p) in [("the numerator", numerator), ("the denominator", denominator)] {
            if !p.coefficients().iter().all(|c| c.is_finite()) {
                return Err(Error::NotFinite { what });
            }
        }
        let scale = 1.0 / denominator.leading();
        let monic = denominator.coefficients().iter().enumerate();
        let denominator = Polynomial::new(monic.map(|(k, c)| if k == 0 { 1.0 } else { c * scale }));
        Ok(Self { numerator: numerator.scaled(scale), denominator, period: None })
    }

    /// Creates a transfer function with a constant value.
    pub fn constant(value: f64) -> Self {
        Self { numerator: Polynomial::constant(value), denominator: Polynomial::constant(1.0), period: None }
    }

    /// Creates the transfer function `s`, a differentiator, from which others are composed: `&k / &s`.
    pub fn s() -> Self {
        let numerator = Polynomial::new([1.0, 0.0]);
        Self { numerator, denominator: Polynomial::constant(1.0), period: None }
    }

    /// Declares the transfer function to be discrete, with a period in s. Its polynomials, which do not
    /// change, are then in `z`: it is not discretised.
    ///
    /// # Errors
    ///
    /// [`Error::Period`] unless the period is positive and finite.
    pub fn with_period(mut self, period: f64) -> Result<Self, Error> {
        if !(period > 0.0 && period.is_finite()) {
            return Err(Error::Period { period });
        }
        self.period = Some(period);
        Ok(self)
    }

    /// Returns the numerator polynomial of the transfer function.
    pub fn numerator(&self) -> &Polynomial {
        &self.numerator
    }

    /// Returns the denominator polynomial of the transfer function, whose leading coefficient is one.
    pub fn denominator(&self) -> &Polynomial {
        &self.denominator
    }

    /// Returns the period of a discrete system, s.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// Whether the degree of the numerator of the transfer function is at most that of the denominator.
    pub fn is_proper(&self) -> bool {
        self.numerator.degree() <= self.denominator.degree()
    }

    /// Returns an error if the numerator of the transfer function has a higher degree than the denominator.
    pub(crate) fn check_proper(&self) -> Result<(), Error> {
        let (numerator, denominator) = (self.numerator.degree(), self.denominator.degree());
        if self.is_proper() { Ok(()) } else { Err(Error::Improper { numerator, denominator }) }
    }

    /// Returns the poles of the transfer function: the roots of the denominator.
    ///
    /// # Errors
    ///
    /// As for [`Polynomial::roots`].
    pub fn poles(&self) -> Result<Vec<C>, Error> {
        self.denominator.roots()
    }

    /// Returns the zeros of the transfer function: the roots of the numerator.
    ///
    /// # Errors
    ///
    /// As for [`Polynomial::roots`].
    pub fn zeros(&self) -> Result<Vec<C>, Error> {
        self.numerator.roots()
    }

    /// Returns the value of the transfer function at a complex frequency.
    pub fn at(&self, s: C) -> C {
        self.numerator.at(s) / self.denominator.at(s)
    }

    /// Returns the static gain of the transfer function, at `s = 0` or `z = 1`. Infinite for a pole there.
    pub fn gain_at_rest(&self) -> f64 {
        self.at(C::new(if self.period.is_some() { 1.0 } else { 0.0 }, 0.0)).re
    }

    /// Returns the zeros, poles and gain of the transfer function.
    ///
    /// # Errors
    ///
    /// As for [`Polynomial::roots`].
    pub fn factored(&self) -> Result<ZerosPolesGain, Error> {
        let (zeros, poles) = (self.zeros()?, self.poles()?);
        Ok(ZerosPolesGain { zeros, poles, gain: self.numerator.leading(), period: self.period })
    }

    /// Removes common factors of numerator and denominator: pairs of a zero and a pole whose distance is
    /// below `tolerance · (1 + |zero|)`.
    ///
    /// # Errors
    ///
    /// As for [`Polynomial::roots`].
    pub fn cancelled(&self, tolerance: f64) -> Result<Self, Error> {
        let mut all = self.factored()?;
        let mut kept = Vec::new();
        for zero in all.zeros {
            let cancels_zero = |p: &C| (p - zero).norm() <= tolerance * (1.0 + zero.norm());
            match all.poles.iter().position(cancels_zero) {
                Some(k) => drop(all.poles.remove(k)),
                None => kept.push(zero),
            }
        }
        let numerator = Polynomial::from_roots(&kept).scaled(all.gain);
        Ok(Self { numerator, denominator: Polynomial::from_roots(&all.poles), period: self.period })
    }

    /// Returns a state-space realisation in controller form, balanced. It is minimal if numerator and
    /// denominator have no common factor.
    ///
    /// # Errors
    ///
    /// [`Error::Improper`].
    pub fn state_space(&self) -> Result<StateSpace, Error> {
        self.check_proper()?;
        let n = self.denominator.degree();
        let direct = self.numerator.coefficient(n);
        let a = DMatrix::from_fn(n, n, |i, j| match i {
            0 => -self.denominator.coefficient(n - 1 - j),
            _ => f64::from(i == j + 1),
        });
        let b = DMatrix::from_fn(n, 1, |i, _| f64::from(i == 0));
        let c = DMatrix::from_fn(1, n, |_, j| {
            let k = n - 1 - j;
            self.numerator.coefficient(k) - direct * self.denominator.coefficient(k)
        });
        let (a, b, c, _) = crate::matrices::balance_system(&a, &b, &c);
        let system = StateSpace::new(a, b, c, DMatrix::from_element(1, 1, direct))?;
        self.period.map_or(Ok(system.clone()), |h| system.with_period(h))
    }

    /// Closes a negative feedback loop of the transfer function through `back`.
    ///
    /// # Errors
    ///
    /// [`Error::AlgebraicLoop`] if `1 + G H` is zero, [`Error::Time`].
    pub fn feedback(&self, back: &Self) -> Result<Self, Error> {
        let period = self.common_period(back)?;
        let numerator = &self.numerator * &back.denominator;
        let denominator = &(&self.denominator * &back.denominator) + &(&self.numerator * &back.numerator);
        if denominator.is_zero() {
            return Err(Error::AlgebraicLoop);
        }
        Ok(Self { period, ..Self::quotient(&numerator, &denominator)? })
    }

    fn common_period(&self, other: &Self) -> Result<Option<f64>, Error> {
        let is_static_gain =
            |g: &Self| g.period.is_none() && g.numerator.degree() + g.denominator.degree() == 0;
        let alike = self.period == other.period || is_static_gain(self) || is_static_gain(other);
        if alike {
            Ok(self.period.or(other.period))
        } else {
            Err(Error::Time { periods: [self.period, other.period] })
        }
    }

    /// Returns the sum of two transfer functions, which is the parallel connection.
    ///
    /// # Errors
    ///
    /// [`Error::Time`] for different periods.
    pub fn plus(&self, other: &Self) -> Result<Self, Error> {
        let period = self.common_period(other)?;
        let (one, two) = (&self.numerator * &other.denominator, &other.numerator * &self.denominator);
        Ok(Self { period, ..Self::quotient(&(&one + &two), &(&self.denominator * &other.denominator))? })
    }

    /// Returns the product of two transfer functions, which is the series connection.
    ///
    /// # Errors
    ///
    /// [`Error::Time`] for different periods.
    pub fn times(&self, other: &Self) -> Result<Self, Error> {
        let period = self.common_period(other)?;
        let numerator = &self.numerator * &other.numerator;
        Ok(Self { period, ..Self::quotient(&numerator, &(&self.denominator * &other.denominator))? })
    }

    /// Returns the quotient of two transfer functions.
    ///
    /// # Errors
    ///
    /// [`Error::Time`] for different periods, [`Error::Singular`] if the divisor is zero.
    pub fn divide(&self, other: &Self) -> Result<Self, Error> {
        let period = self.common_period(other)?;
        let numerator = &self.numerator * &other.denominator;
        Ok(Self { period, ..Self::quotient(&numerator, &(&self.denominator * &other.numerator))? })
    }

    fn variable_name(&self) -> &'static str {
        if self.period.is_some() { "z" } else { "s" }
    }
}

impl Neg for &TransferFunction {
    type Output = TransferFunction;
    fn neg(self) -> TransferFunction {
        TransferFunction { numerator: -&self.numerator, ..self.clone() }
    }
}

impl Add for &TransferFunction {
    type Output = Result<TransferFunction, Error>;
    fn add(self, other: &TransferFunction) -> Self::Output {
        self.plus(other)
    }
}

impl Sub for &TransferFunction {
    type Output = Result<TransferFunction, Error>;
    fn sub(self, other: &TransferFunction) -> Self::Output {
        self.plus(&-other)
    }
}

impl Mul for &TransferFunction {
    type Output = Result<TransferFunction, Error>;
    fn mul(self, other: &TransferFunction) -> Self::Output {
        self.times(other)
    }
}

fn format_fraction(above: &str, below: &str) -> String {
    let parenthesize_sum = |text: &str| {
        if text.contains(" + ") || text.contains(" - ") { format!("({text})") } else { text.to_owned() }
    };
    if below == "1" {
        above.to_owned()
    } else {
        format!("{} / {}", parenthesize_sum(above), parenthesize_sum(below))
    }
}

impl fmt::Display for TransferFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let variable = self.variable_name();
        f.write_str(&format_fraction(
            &self.numerator.written_in(variable),
            &self.denominator.written_in(variable),
        ))
    }
}

impl ZerosPolesGain {
    /// Returns the transfer function as a ratio of polynomials.
    pub fn transfer_function(&self) -> TransferFunction {
        TransferFunction {
            numerator: Polynomial::from_roots(&self.zeros).scaled(self.gain),
            denominator: Polynomial::from_roots(&self.poles),
            period: self.period,
        }
    }

    /// Returns the value of the transfer function at a complex frequency, from its zeros, poles and gain.
    pub fn at(&self, s: C) -> C {
        let mut value = C::new(self.gain, 0.0);
        let count = self.zeros.len().max(self.poles.len());
        for k in 0..count {
            value *= self.zeros.get(k).map_or(C::new(1.0, 0.0), |z| s - z);
            value /= self.poles.get(k).map_or(C::new(1.0, 0.0), |p| s - p);
        }
        value
    }
}

impl fmt::Display for ZerosPolesGain {
    /// Writes the factors, with second-order factors for conjugate pairs: `2 (s + 1) / (s² + s + 2)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let variable = if self.period.is_some() { "z" } else { "s" };
        let (above, below) = (format_factors(&self.zeros, variable), format_factors(&self.poles, variable));
        let gain = format_number(self.gain);
        match (above.as_str(), gain.as_str()) {
            ("", _) => f.write_str(&gain)?,
            (_, "1") => f.write_str(&above)?,
            _ => write!(f, "{gain} {above}")?,
        }
        match self.poles.iter().filter(|p| p.im >= 0.0).count() {
            0 => Ok(()),
            1 => write!(f, " / {below}"),
            _ => write!(f, " / [{below}]"),
        }
    }
}

impl StateSpace {
    /// Returns the zeros, poles and gain of one channel of the system. Uncontrollable and unobservable modes
    /// are removed.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the list of existing names; [`Error::NotConverged`].
    pub fn factored<'a>(
        &self,
        output: impl Into<crate::Port<'a>>,
        input: impl Into<crate::Port<'a>>,
    ) -> Result<ZerosPolesGain, Error> {
        self.channel(output, input)?.minimal(0.0)?.zeros_poles_gain()
    }

    /// Returns the zeros, poles and gain of a system with one input and one output.
    pub(crate) fn zeros_poles_gain(&self) -> Result<ZerosPolesGain, Error> {
        let (zeros, poles) = (self.zeros()?, self.poles()?);
        let direct = self.d[(0, 0)];
        let response = self.frequency_map()?;
        // The gain is evaluated at a point that is far from all zeros and poles: on the real axis, right
        // of all of them by the geometric mean of their magnitudes.
        let sizes: Vec<f64> = zeros.iter().chain(&poles).map(|x| x.norm()).filter(|x| *x > 0.0).collect();
        let typical = (sizes.iter().map(|x| x.ln()).sum::<f64>() / sizes.len().max(1) as f64).exp();
        let right = zeros.iter().chain(&poles).map(|x| x.re).fold(0.0, f64::max);
        let s = C::new(right + typical, 0.0);
        let mut gain = C::new(1.0, 0.0);
        for k in 0..zeros.len().max(poles.len()) {
            gain *= poles.get(k).map_or(C::new(1.0, 0.0), |p| s - p);
            gain /= zeros.get(k).map_or(C::new(1.0, 0.0), |z| s - z);
        }
        let gain = if zeros.len() == poles.len() { direct } else { (gain * response.at(s)?[(0, 0)]).re };
        Ok(ZerosPolesGain { zeros, poles, gain, period: self.period })
    }

    /// Returns one channel of the system as a ratio of polynomials, computed from its zeros, poles and gain.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the list of existing names; [`Error::NotConverged`].
    pub fn transfer_function<'a>(
        &self,
        output: impl Into<crate::Port<'a>>,
        input: impl Into<crate::Port<'a>>,
    ) -> Result<TransferFunction, Error> {
        Ok(self.factored(output, input)?.transfer_function())
    }
}
