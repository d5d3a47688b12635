//! Time responses to steps, impulses, initial states and arbitrary inputs.

use crate::{Error, Hold, Port, Signal, StateSpace};
use nalgebra::{DMatrix, DVector};

/// Time response of a linear system at equally spaced instants.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Instants of the response, s.
    pub times: Vec<f64>,
    /// Output signals: one row per output, one column per instant.
    pub outputs: DMatrix<f64>,
    /// State trajectory: one row per state, one column per instant.
    pub states: DMatrix<f64>,
    /// Names and units of the output signals.
    pub output_signals: Vec<Signal>,
    /// Names and units of the state variables.
    pub state_signals: Vec<Signal>,
}

impl Response {
    /// Returns one output of the response at all instants.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the list of existing names.
    pub fn output<'a>(&self, output: impl Into<Port<'a>>) -> Result<Vec<f64>, Error> {
        let port = output.into();
        let found = match port {
            Port::At(k) => Some(k).filter(|k| *k < self.outputs.nrows()),
            Port::Named(name) => self.output_signals.iter().position(|s| s.name == name),
        };
        let row = found.ok_or_else(|| Error::Unknown {
            kind: "output",
            name: format!("{port:?}"),
            known: self.output_signals.iter().map(|s| s.name.clone()).collect(),
        })?;
        Ok(self.outputs.row(row).iter().copied().collect())
    }
}

impl StateSpace {
    /// Returns `count` instants from zero to `end`, s; for a discrete system the sampling instants up to
    /// `end`.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] unless `end` is positive and finite.
    pub fn times(&self, end: f64, count: usize) -> Result<Vec<f64>, Error> {
        if !(end > 0.0 && end.is_finite()) {
            return Err(Error::Range { what: "an end", value: end });
        }
        let (step, count) = match self.period {
            Some(h) => (h, (end / h + 1e-9).floor() as usize + 1),
            None => (end / count.max(2).saturating_sub(1) as f64, count.max(2)),
        };
        Ok((0..count).map(|k| step * k as f64).collect())
    }

    /// Computes the response to a unit step of one input at time zero, from zero initial states. Exact at
    /// each instant.
    ///
    /// ```
    /// use linkwork_design::TransferFunction;
    ///
    /// let lag = TransferFunction::new([1.0], [1.0, 1.0])?.state_space()?;
    /// let response = lag.step_response(0, &lag.times(2.0, 101)?)?;
    /// assert!((response.outputs[(0, 50)] - (1.0 - (-1.0_f64).exp())).abs() < 1e-14);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`], [`Error::Range`] for instants that are not equally spaced from zero.
    pub fn step_response<'a>(&self, input: impl Into<Port<'a>>, times: &[f64]) -> Result<Response, Error> {
        let column = self.input_index(input)?;
        let inputs = DMatrix::from_fn(self.inputs.len(), times.len(), |i, _| f64::from(i == column));
        self.simulate_motion(times, &inputs, &DVector::zeros(self.order()), Hold::Zero)
    }

    /// Computes the response to a unit impulse of one input from zero initial states; for a discrete system,
    /// the impulse is the reciprocal of the period for one period. The infinite contribution of `D` to a
    /// continuous response is omitted.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`], [`Error::Range`] for instants that are not equally spaced from zero.
    pub fn impulse_response<'a>(&self, input: impl Into<Port<'a>>, times: &[f64]) -> Result<Response, Error> {
        let column = self.input_index(input)?;
        let mut inputs = DMatrix::zeros(self.inputs.len(), times.len());
        match self.period {
            Some(h) => {
                if !times.is_empty() {
                    inputs[(column, 0)] = 1.0 / h;
                }
                self.simulate_motion(times, &inputs, &DVector::zeros(self.order()), Hold::Zero)
            }
            None => self.simulate_motion(times, &inputs, &self.b.column(column).into_owned(), Hold::Zero),
        }
    }

    /// Computes the response of the system to an initial state without inputs.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] for another number of states, [`Error::Range`] for instants that are not equally
    /// spaced from zero.
    pub fn initial_response(&self, state: &[f64], times: &[f64]) -> Result<Response, Error> {
        let inputs = DMatrix::zeros(self.inputs.len(), times.len());
        self.simulate_motion(times, &inputs, &DVector::from_column_slice(state), Hold::Zero)
    }

    /// Computes the response to inputs (one row per input, one column per instant) from an initial state.
    /// Exact for inputs that are constant ([`Hold::Zero`]) or linear ([`Hold::First`]) between instants.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for the inputs, [`Error::Count`] for the states, [`Error::Range`] for instants that
    /// are not equally spaced from zero, [`Error::Period`] if their spacing is not the period of a discrete
    /// system.
    pub fn forced_response(
        &self,
        inputs: &DMatrix<f64>,
        state: &[f64],
        times: &[f64],
        hold: Hold,
    ) -> Result<Response, Error> {
        self.simulate_motion(times, inputs, &DVector::from_column_slice(state), hold)
    }

    fn simulate_motion(
        &self,
        times: &[f64],
        inputs: &DMatrix<f64>,
        state: &DVector<f64>,
        hold: Hold,
    ) -> Result<Response, Error> {
        let (n, count) = (self.order(), times.len());
        crate::matrices::check_matrix("the inputs", inputs, self.inputs.len(), count)?;
        if state.len() != n {
            return Err(Error::Count { what: "initial states", expected: n, found: state.len() });
        }
        if !state.iter().all(|x| x.is_finite()) {
            return Err(Error::NotFinite { what: "the initial state" });
        }
        let step = checked_time_spacing(times, self.period)?;
        // x⁺ = A x + B₀ u + B₁ u⁺.
        let (a, b, next) = match (self.period, hold) {
            (Some(_), _) => (self.a.clone(), self.b.clone(), None),
            (None, Hold::First) => {
                let held = Self {
                    c: DMatrix::identity(n, n),
                    d: DMatrix::zeros(n, self.inputs.len()),
                    outputs: self.states.clone(),
                    ..self.clone()
                };
                let held = held.discretize(step, Hold::First)?;
                // The states of the triangle hold are x − D u; its B combines the inputs at both ends.
                let before = &held.b - &held.a * &held.d;
                (held.a, before, Some(held.d))
            }
            (None, _) => {
                let held = self.discretize(step, Hold::Zero)?;
                (held.a, held.b, None)
            }
        };
        let mut states = DMatrix::zeros(n, count);
        let mut x = state.clone();
        for k in 0..count {
            states.set_column(k, &x);
            if k + 1 < count {
                x = &a * x + &b * inputs.column(k);
                if let Some(next) = &next {
                    x += next * inputs.column(k + 1);
                }
            }
        }
        let outputs = &self.c * &states + &self.d * inputs;
        Ok(Response {
            times: times.to_vec(),
            outputs,
            states,
            output_signals: self.outputs.clone(),
            state_signals: self.states.clone(),
        })
    }
}

/// Returns the spacing of the instants, s, or an error if they are not equally spaced or do not begin at
/// zero.
fn checked_time_spacing(times: &[f64], period: Option<f64>) -> Result<f64, Error> {
    let (Some(first), Some(last)) = (times.first(), times.last()) else {
        return Ok(period.unwrap_or(1.0));
    };
    if *first != 0.0 {
        return Err(Error::Range { what: "a first instant", value: *first });
    }
    if times.len() == 1 {
        return Ok(period.unwrap_or(1.0));
    }
    let step = last / (times.len() - 1) as f64;
    if !(step > 0.0 && step.is_finite()) {
        return Err(Error::Range { what: "a distance of instants", value: step });
    }
    for (k, t) in times.iter().enumerate() {
        let off = (t - step * k as f64).abs();
        if off.is_nan() || off > 1e-9 * last {
            return Err(Error::Range { what: "an unequally spaced instant", value: *t });
        }
    }
    match period {
        Some(h) if (h - step).abs() > 1e-9 * h => Err(Error::Period { period: step }),
        _ => Ok(step),
    }
}
