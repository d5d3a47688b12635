//! Series, parallel and feedback connections of linear systems.

use crate::matrices::solve_linear_system;
use crate::{Error, Port, Signal, StateSpace};
use nalgebra::DMatrix;

/// Returns the block-diagonal matrix `[one 0; 0 other]`.
fn block_diagonal(one: &DMatrix<f64>, other: &DMatrix<f64>) -> DMatrix<f64> {
    let mut m = DMatrix::zeros(one.nrows() + other.nrows(), one.ncols() + other.ncols());
    m.view_mut((0, 0), one.shape()).copy_from(one);
    m.view_mut(one.shape(), other.shape()).copy_from(other);
    m
}

fn concatenate_signals(one: &[Signal], other: &[Signal]) -> Vec<Signal> {
    one.iter().chain(other).cloned().collect()
}

impl StateSpace {
    /// Returns the common period of two systems. A system without states and without a period is compatible
    /// with every period.
    fn common_period(&self, other: &Self) -> Result<Option<f64>, Error> {
        let is_static_gain = |s: &Self| s.order() == 0 && s.period.is_none();
        let alike = match (self.period, other.period) {
            (Some(one), Some(other)) => (one - other).abs() <= 1e-12 * one,
            (None, None) => true,
            _ => is_static_gain(self) || is_static_gain(other),
        };
        if !alike {
            return Err(Error::Time { periods: [self.period, other.period] });
        }
        Ok(self.period.or(other.period))
    }

    /// Combines two systems without connecting them: inputs and outputs of this system precede those of the
    /// other.
    ///
    /// # Errors
    ///
    /// [`Error::Time`] for different periods.
    pub fn append(&self, other: &Self) -> Result<Self, Error> {
        Ok(Self {
            a: block_diagonal(&self.a, &other.a),
            b: block_diagonal(&self.b, &other.b),
            c: block_diagonal(&self.c, &other.c),
            d: block_diagonal(&self.d, &other.d),
            states: concatenate_signals(&self.states, &other.states),
            inputs: concatenate_signals(&self.inputs, &other.inputs),
            outputs: concatenate_signals(&self.outputs, &other.outputs),
            period: self.common_period(other)?,
        })
    }

    /// Connects `next` behind this system: the outputs of this system are the inputs of `next`, in order.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] for different numbers of outputs and inputs, [`Error::Time`] for different periods.
    pub fn series(&self, next: &Self) -> Result<Self, Error> {
        let (found, expected) = (self.outputs.len(), next.inputs.len());
        if found != expected {
            return Err(Error::Count { what: "outputs for the next system", expected, found });
        }
        let mut a = block_diagonal(&self.a, &next.a);
        let (n, m) = (self.order(), next.order());
        a.view_mut((n, 0), (m, n)).copy_from(&(&next.b * &self.c));
        let mut b = DMatrix::zeros(n + m, self.inputs.len());
        b.view_mut((0, 0), self.b.shape()).copy_from(&self.b);
        b.view_mut((n, 0), (m, self.inputs.len())).copy_from(&(&next.b * &self.d));
        let mut c = DMatrix::zeros(next.outputs.len(), n + m);
        c.view_mut((0, 0), (next.outputs.len(), n)).copy_from(&(&next.d * &self.c));
        c.view_mut((0, n), next.c.shape()).copy_from(&next.c);
        Ok(Self {
            a,
            b,
            c,
            d: &next.d * &self.d,
            states: concatenate_signals(&self.states, &next.states),
            inputs: self.inputs.clone(),
            outputs: next.outputs.clone(),
            period: self.common_period(next)?,
        })
    }

    /// Connects two systems in parallel: both have the same inputs, and their outputs are added.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] for different numbers of inputs or outputs, [`Error::Time`] for different periods.
    pub fn parallel(&self, other: &Self) -> Result<Self, Error> {
        let counts = [("inputs", &self.inputs, &other.inputs), ("outputs", &self.outputs, &other.outputs)];
        for (what, one, two) in counts {
            if one.len() != two.len() {
                return Err(Error::Count { what, expected: one.len(), found: two.len() });
            }
        }
        let both = self.append(other)?;
        let (m, p) = (self.inputs.len(), self.outputs.len());
        let fan = DMatrix::from_fn(2 * m, m, |i, j| f64::from(i % m.max(1) == j));
        let sum = DMatrix::from_fn(p, 2 * p, |i, j| f64::from(j % p.max(1) == i));
        Ok(Self {
            b: &both.b * &fan,
            c: &sum * &both.c,
            d: &sum * &both.d * &fan,
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            ..both
        })
    }

    /// Closes a negative feedback loop through `back`: `u = r − back(y)`. Inputs and outputs remain those of
    /// this system.
    ///
    /// # Errors
    ///
    /// [`Error::AlgebraicLoop`] if `I + D₁ D₂` is singular, [`Error::Count`], [`Error::Time`].
    pub fn feedback(&self, back: &Self) -> Result<Self, Error> {
        for (what, one, two) in [
            ("inputs of the feedback", &self.outputs, &back.inputs),
            ("outputs of the feedback", &self.inputs, &back.outputs),
        ] {
            if one.len() != two.len() {
                return Err(Error::Count { what, expected: one.len(), found: two.len() });
            }
        }
        let period = self.common_period(back)?;
        let (n, m) = (self.order(), back.order());
        let (inputs, outputs) = (self.inputs.len(), self.outputs.len());
        // y = W (C₁ x₁ − D₁ C₂ x₂ + D₁ r) with W = (I + D₁ D₂)⁻¹.
        let w = DMatrix::identity(outputs, outputs) + &self.d * &back.d;
        if outputs > 0 && crate::matrices::rank(&w, 1e-14)? < outputs {
            return Err(Error::AlgebraicLoop);
        }
        let mut right = DMatrix::zeros(outputs, n + m + inputs);
        right.view_mut((0, 0), (outputs, n)).copy_from(&self.c);
        right.view_mut((0, n), (outputs, m)).copy_from(&-(&self.d * &back.c));
        right.view_mut((0, n + m), (outputs, inputs)).copy_from(&self.d);
        let y = solve_linear_system("I + D₁ D₂", &w, &right)?;
        // u = r − C₂ x₂ − D₂ y.
        let mut u = -(&back.d * &y);
        let mut shifted = u.view_mut((0, n), (inputs, m));
        shifted -= &back.c;
        let mut own = u.view_mut((0, n + m), (inputs, inputs));
        own += DMatrix::<f64>::identity(inputs, inputs);
        let mut x = DMatrix::zeros(n + m, n + m + inputs);
        x.view_mut((0, 0), (n, n + m + inputs)).copy_from(&(&self.b * &u));
        x.view_mut((n, 0), (m, n + m + inputs)).copy_from(&(&back.b * &y));
        let mut a = x.columns(0, n + m).into_owned();
        a += block_diagonal(&self.a, &back.a);
        Ok(Self {
            a,
            b: x.columns(n + m, inputs).into_owned(),
            c: y.columns(0, n + m).into_owned(),
            d: y.columns(n + m, inputs).into_owned(),
            states: concatenate_signals(&self.states, &back.states),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            period,
        })
    }

    /// Closes a feedback loop with a constant gain: `u = r − gain y`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a gain of another shape, [`Error::AlgebraicLoop`].
    pub fn feedback_gain(&self, gain: &DMatrix<f64>) -> Result<Self, Error> {
        crate::matrices::check_matrix("the gain", gain, self.inputs.len(), self.outputs.len())?;
        self.feedback(&Self::gain(gain.clone())?)
    }

    /// Applies state feedback `u = r − K x`; the state matrix becomes `A − B K`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a gain of another shape.
    pub fn state_feedback(&self, gain: &DMatrix<f64>) -> Result<Self, Error> {
        crate::matrices::check_matrix("the gain", gain, self.inputs.len(), self.order())?;
        let (a, c) = (&self.a - &self.b * gain, &self.c - &self.d * gain);
        Ok(Self { a, c, ..self.clone() })
    }

    /// Returns the system with only some of its inputs and outputs, selected by name or index.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the list of existing names.
    pub fn select<'a, I: Into<Port<'a>>, O: Into<Port<'a>>>(
        &self,
        outputs: impl IntoIterator<Item = O>,
        inputs: impl IntoIterator<Item = I>,
    ) -> Result<Self, Error> {
        let rows = outputs.into_iter().map(|o| self.output_index(o)).collect::<Result<Vec<_>, _>>()?;
        let columns = inputs.into_iter().map(|i| self.input_index(i)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self {
            b: self.b.select_columns(&columns),
            c: self.c.select_rows(&rows),
            d: self.d.select_rows(&rows).select_columns(&columns),
            inputs: columns.iter().filter_map(|k| self.inputs.get(*k).cloned()).collect(),
            outputs: rows.iter().filter_map(|k| self.outputs.get(*k).cloned()).collect(),
            ..self.clone()
        })
    }

    /// Returns the system from one input to one output.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the list of existing names.
    pub fn channel<'a>(
        &self,
        output: impl Into<Port<'a>>,
        input: impl Into<Port<'a>>,
    ) -> Result<Self, Error> {
        self.select([output.into()], [input.into()])
    }

    /// Returns the system with its states as outputs, instead of its own outputs.
    pub fn with_states_as_outputs(&self) -> Self {
        let n = self.order();
        Self {
            c: DMatrix::identity(n, n),
            d: DMatrix::zeros(n, self.inputs.len()),
            outputs: self.states.clone(),
            ..self.clone()
        }
    }

    /// Checks that a system has a single input and a single output; otherwise returns an error.
    pub(crate) fn check_single_input_and_output(&self) -> Result<(), Error> {
        for (what, signals) in [("input", &self.inputs), ("output", &self.outputs)] {
            if signals.len() != 1 {
                return Err(Error::Count { what, expected: 1, found: signals.len() });
            }
        }
        Ok(())
    }
}
