//! Linear systems in state-space form.

use crate::Error;
use crate::matrices::{C, check_matrix, checked_square_size, eigenvalues};
use nalgebra::DMatrix;
use std::fmt;

/// Name and unit of a state, input or output.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Signal {
    /// Name of the signal: a state, input or output.
    pub name: String,
    /// Unit of the signal; empty if unspecified.
    pub unit: String,
}

impl Signal {
    /// Creates a signal with a name and a unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

impl From<&str> for Signal {
    fn from(name: &str) -> Self {
        Self::new(name, "")
    }
}

impl From<String> for Signal {
    fn from(name: String) -> Self {
        Self::new(name, "")
    }
}

impl From<(&str, &str)> for Signal {
    fn from((name, unit): (&str, &str)) -> Self {
        Self::new(name, unit)
    }
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        if self.unit.is_empty() { Ok(()) } else { write!(f, ", {}", self.unit) }
    }
}

/// Reference to an input or output, by index or by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port<'a> {
    /// Reference to an input or output by its index, counted from zero.
    At(usize),
    /// Reference to an input or output by its name.
    Named(&'a str),
}

impl From<usize> for Port<'_> {
    fn from(at: usize) -> Self {
        Self::At(at)
    }
}

impl<'a> From<&'a str> for Port<'a> {
    fn from(name: &'a str) -> Self {
        Self::Named(name)
    }
}

/// Linear system `ẋ = A x + B u`, `y = C x + D u`, or `x⁺ = A x + B u` from one sampling instant to the next,
/// with the names and units of its states, inputs and outputs.
///
/// ```
/// use linkwork_design::StateSpace;
/// use nalgebra::dmatrix;
///
/// // A mass of 2 kg on a spring of 8 N/m.
/// let oscillator = StateSpace::new(dmatrix![0.0, 1.0; -4.0, 0.0], dmatrix![0.0; 0.5], dmatrix![1.0, 0.0], dmatrix![0.0])?
///     .with_states([("position", "m"), ("velocity", "m/s")])?
///     .with_inputs([("push", "N")])?
///     .with_outputs([("position", "m")])?;
/// assert!((oscillator.poles()?[0].norm() - 2.0).abs() < 1e-15);
/// assert!((oscillator.gain_at_rest()?[(0, 0)] - 1.0 / 8.0).abs() < 1e-15);
/// # Ok::<(), linkwork_design::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace {
    pub(crate) a: DMatrix<f64>,
    pub(crate) b: DMatrix<f64>,
    pub(crate) c: DMatrix<f64>,
    pub(crate) d: DMatrix<f64>,
    pub(crate) states: Vec<Signal>,
    pub(crate) inputs: Vec<Signal>,
    pub(crate) outputs: Vec<Signal>,
    pub(crate) period: Option<f64>,
}

fn numbered_signals(letter: char, n: usize) -> Vec<Signal> {
    (1..=n).map(|k| Signal::from(format!("{letter}{k}"))).collect()
}

impl StateSpace {
    /// Creates a continuous system from four matrices. Its signals are named x1, u1, y1 and so on.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] and [`Error::NotFinite`] with the name of the matrix.
    pub fn new(a: DMatrix<f64>, b: DMatrix<f64>, c: DMatrix<f64>, d: DMatrix<f64>) -> Result<Self, Error> {
        let n = checked_square_size("A", &a)?;
        check_matrix("B", &b, n, b.ncols())?;
        check_matrix("C", &c, c.nrows(), n)?;
        check_matrix("D", &d, c.nrows(), b.ncols())?;
        let (states, inputs, outputs) =
            (numbered_signals('x', n), numbered_signals('u', b.ncols()), numbered_signals('y', c.nrows()));
        Ok(Self { a, b, c, d, states, inputs, outputs, period: None })
    }

    /// Creates a linear system without states: `y = D u`.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`].
    pub fn gain(d: DMatrix<f64>) -> Result<Self, Error> {
        let (p, m) = d.shape();
        Self::new(DMatrix::zeros(0, 0), DMatrix::zeros(0, m), DMatrix::zeros(p, 0), d)
    }

    /// Makes the system discrete with a period in s: the matrix `A` maps the state at one sampling instant to
    /// the next.
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

    /// Sets the names and, optionally, units of the states of the system.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] if the number of names differs from the number of states.
    pub fn with_states<S: Into<Signal>>(mut self, names: impl IntoIterator<Item = S>) -> Result<Self, Error> {
        self.states = signals_of_expected_count("states", self.a.nrows(), names)?;
        Ok(self)
    }

    /// Sets the names and, optionally, units of the inputs of the system.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] if the number of names differs from the number of inputs.
    pub fn with_inputs<S: Into<Signal>>(mut self, names: impl IntoIterator<Item = S>) -> Result<Self, Error> {
        self.inputs = signals_of_expected_count("inputs", self.b.ncols(), names)?;
        Ok(self)
    }

    /// Sets the names and, optionally, units of the outputs of the system.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] if the number of names differs from the number of outputs.
    pub fn with_outputs<S: Into<Signal>>(
        mut self,
        names: impl IntoIterator<Item = S>,
    ) -> Result<Self, Error> {
        self.outputs = signals_of_expected_count("outputs", self.c.nrows(), names)?;
        Ok(self)
    }

    /// Returns the state matrix `A` of the system.
    pub fn a(&self) -> &DMatrix<f64> {
        &self.a
    }

    /// Returns the input matrix `B` of the system.
    pub fn b(&self) -> &DMatrix<f64> {
        &self.b
    }

    /// Returns the output matrix `C` of the system.
    pub fn c(&self) -> &DMatrix<f64> {
        &self.c
    }

    /// Returns the feedthrough matrix `D` of the system.
    pub fn d(&self) -> &DMatrix<f64> {
        &self.d
    }

    /// Returns the names and units of the states, in order.
    pub fn states(&self) -> &[Signal] {
        &self.states
    }

    /// Returns the names and units of the inputs, in order.
    pub fn inputs(&self) -> &[Signal] {
        &self.inputs
    }

    /// Returns the names and units of the outputs, in order.
    pub fn outputs(&self) -> &[Signal] {
        &self.outputs
    }

    /// Returns the period of a discrete system, s; `None` for a continuous system.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// Returns the order of the system: its number of states.
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// Returns the poles of the system: the eigenvalues of `A`, sorted by real part, in conjugate pairs.
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`] if the QR algorithm does not converge.
    pub fn poles(&self) -> Result<Vec<C>, Error> {
        eigenvalues(&self.a)
    }

    /// Whether all poles of the system are in the open left half-plane, or inside the unit circle for a
    /// discrete system.
    ///
    /// # Errors
    ///
    /// As for [`poles`](Self::poles).
    pub fn is_stable(&self) -> Result<bool, Error> {
        Ok(self.unstable_pole()?.is_none())
    }

    /// Returns the pole with the largest real part (largest magnitude for a discrete system), if the system
    /// is unstable.
    pub(crate) fn unstable_pole(&self) -> Result<Option<C>, Error> {
        let pole_excess_over_stability = |p: &C| if self.period.is_some() { p.norm() - 1.0 } else { p.re };
        let worst = self
            .poles()?
            .into_iter()
            .max_by(|a, b| pole_excess_over_stability(a).total_cmp(&pole_excess_over_stability(b)));
        Ok(worst.filter(|p| pole_excess_over_stability(p) >= 0.0))
    }

    /// Returns an error that names an unstable pole, if the system has one.
    pub(crate) fn check_stable(&self) -> Result<(), Error> {
        self.unstable_pole()?.map_or(Ok(()), |pole| Err(Error::Unstable { pole }))
    }

    /// Returns the subsystem of the named states, in this order, with all other states fixed at zero. The
    /// outputs are the states. An example is the longitudinal motion of an aircraft.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the list of existing names; [`Error::Repeated`] if a state is listed twice.
    pub fn of_states(&self, names: &[&str]) -> Result<Self, Error> {
        let kept = names.iter().map(|name| index_of_port("state", &self.states, Port::Named(name)));
        let kept = kept.collect::<Result<Vec<usize>, Error>>()?;
        let again = kept.iter().enumerate().find(|(i, k)| kept[..*i].contains(*k));
        if let Some((i, _)) = again {
            return Err(Error::Repeated { kind: "state", name: names[i].to_owned() });
        }
        let (a, b) = (self.a.select_rows(&kept).select_columns(&kept), self.b.select_rows(&kept));
        let n = kept.len();
        let d = DMatrix::zeros(n, b.ncols());
        let mut part = Self::new(a, b, DMatrix::identity(n, n), d)?;
        part.period = self.period;
        let states: Vec<Signal> = kept.iter().map(|k| self.states[*k].clone()).collect();
        Ok(part.with_states(states)?.with_inputs(self.inputs.clone())?.with_states_as_outputs())
    }

    /// Returns the static gain: the ratio of constant outputs to constant inputs, `D − C A⁻¹ B`, or
    /// `D + C (I − A)⁻¹ B` for a discrete system.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] for a pole at `s = 0`, or at `z = 1` for a discrete system.
    pub fn gain_at_rest(&self) -> Result<DMatrix<f64>, Error> {
        let n = self.order();
        let left = match self.period {
            Some(_) => DMatrix::identity(n, n) - &self.a,
            None => -&self.a,
        };
        let what = "A, with a pole at rest,";
        let x = crate::matrices::solve_linear_system(what, &left, &self.b)?;
        if crate::matrices::rank(&left, 0.0)? < n {
            return Err(Error::Singular { what });
        }
        Ok(&self.d + &self.c * x)
    }

    /// Returns the index of an input, selected by name or index.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the list of existing names.
    pub fn input_index<'a>(&self, input: impl Into<Port<'a>>) -> Result<usize, Error> {
        index_of_port("input", &self.inputs, input.into())
    }

    /// Returns the index of an output, selected by name or index.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the list of existing names.
    pub fn output_index<'a>(&self, output: impl Into<Port<'a>>) -> Result<usize, Error> {
        index_of_port("output", &self.outputs, output.into())
    }
}

fn signals_of_expected_count<S: Into<Signal>>(
    what: &'static str,
    expected: usize,
    names: impl IntoIterator<Item = S>,
) -> Result<Vec<Signal>, Error> {
    let signals: Vec<Signal> = names.into_iter().map(Into::into).collect();
    if signals.len() == expected {
        Ok(signals)
    } else {
        Err(Error::Count { what, expected, found: signals.len() })
    }
}

fn index_of_port(kind: &'static str, signals: &[Signal], port: Port<'_>) -> Result<usize, Error> {
    let (found, name) = match port {
        Port::At(k) => (Some(k).filter(|k| *k < signals.len()), k.to_string()),
        Port::Named(name) => (signals.iter().position(|s| s.name == name), name.to_owned()),
    };
    found.ok_or_else(|| {
        let known = signals.iter().map(|s| s.name.clone()).collect();
        Error::Unknown { kind, name, known }
    })
}

impl fmt::Display for StateSpace {
    /// Writes the equations of the system, the names of all signals and the matrices.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let join_signal_names =
            |signals: &[Signal]| signals.iter().map(|s| s.name.clone()).collect::<Vec<_>>().join(", ");
        match self.period {
            Some(period) => writeln!(f, "x⁺ = A x + B u, y = C x + D u, every {period} s")?,
            None => writeln!(f, "ẋ = A x + B u, y = C x + D u")?,
        }
        writeln!(
            f,
            "x: {}\nu: {}\ny: {}",
            join_signal_names(&self.states),
            join_signal_names(&self.inputs),
            join_signal_names(&self.outputs)
        )?;
        let matrices = [("A", &self.a), ("B", &self.b), ("C", &self.c), ("D", &self.d)];
        for (name, matrix) in matrices.into_iter().filter(|(_, m)| !m.is_empty()) {
            write!(f, "{name} ={matrix}")?;
        }
        Ok(())
    }
}
