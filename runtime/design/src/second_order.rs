//! Second-order systems: mass, damping, gyroscopic, stiffness and circulatory matrices.

use crate::matrices::{check_matrix, checked_square_size, solve_linear_system};
use crate::{Error, Signal, StateSpace};
use nalgebra::DMatrix;

/// Second-order form `M q̈ + (D + G) q̇ + (K + N) q = B u`, with the decomposition of Kelvin, Tait and
/// Chetaev. `D` and `K` are symmetric, `G` and `N` skew-symmetric (Merkin, *Introduction to the Theory of
/// Stability*, 1997, ch. 6).
#[derive(Clone, Debug, PartialEq)]
pub struct SecondOrderForm {
    /// Mass matrix `M`: kg between translations, kg·m² between rotations.
    pub mass: DMatrix<f64>,
    /// Damping matrix `D`, which dissipates energy if it is positive definite.
    pub damping: DMatrix<f64>,
    /// Gyroscopic matrix `G`, skew-symmetric, whose forces do no work.
    pub gyroscopic: DMatrix<f64>,
    /// Stiffness matrix `K`, which derives from a potential.
    pub stiffness: DMatrix<f64>,
    /// Circulatory matrix `N`, which has no potential: follower forces, internal damping of rotors.
    pub circulatory: DMatrix<f64>,
    /// Input matrix `B` of the second-order form.
    pub input: DMatrix<f64>,
    coordinates: Vec<Signal>,
    inputs: Vec<Signal>,
}

fn symmetric_and_skew_parts(m: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
    ((m + m.transpose()) * 0.5, (m - m.transpose()) * 0.5)
}

impl SecondOrderForm {
    /// Creates the second-order form from the matrices that multiply `q̈`, `q̇`, `q` and the inputs.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] and [`Error::NotFinite`] with the name of the matrix.
    pub fn new(
        mass: DMatrix<f64>,
        velocity: DMatrix<f64>,
        position: DMatrix<f64>,
        input: DMatrix<f64>,
    ) -> Result<Self, Error> {
        let n = checked_square_size("M", &mass)?;
        check_matrix("the matrix by velocities", &velocity, n, n)?;
        check_matrix("the matrix by positions", &position, n, n)?;
        check_matrix("B", &input, n, input.ncols())?;
        let ((damping, gyroscopic), (stiffness, circulatory)) =
            (symmetric_and_skew_parts(&velocity), symmetric_and_skew_parts(&position));
        let coordinates = (1..=n).map(|k| Signal::from(format!("q{k}"))).collect();
        let inputs = (1..=input.ncols()).map(|k| Signal::from(format!("u{k}"))).collect();
        Ok(Self { mass, damping, gyroscopic, stiffness, circulatory, input, coordinates, inputs })
    }

    /// Sets the names and, optionally, units of coordinates and inputs of the second-order form.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] for another number of names.
    pub fn with_names(mut self, coordinates: Vec<Signal>, inputs: Vec<Signal>) -> Result<Self, Error> {
        for (what, names, expected) in
            [("coordinates", &coordinates, self.mass.nrows()), ("inputs", &inputs, self.input.ncols())]
        {
            if names.len() != expected {
                return Err(Error::Count { what, expected, found: names.len() });
            }
        }
        (self.coordinates, self.inputs) = (coordinates, inputs);
        Ok(self)
    }

    /// Returns the second-order form as a first-order system with the states `(q, q̇)`, which are also the
    /// outputs.
    ///
    /// ```
    /// use linkwork_design::SecondOrderForm;
    /// use nalgebra::{DMatrix, dmatrix};
    ///
    /// // A rotor with internal damping: stable below its critical speed, unstable above.
    /// let rotor = |spin: f64| {
    ///     let (one, turn) = (DMatrix::<f64>::identity(2, 2), dmatrix![0.0, 1.0; -1.0, 0.0]);
    ///     let (inner, outer) = (0.1, 0.1);
    ///     let position = &one + turn * (inner * spin);
    ///     SecondOrderForm::new(one.clone(), &one * (inner + outer), position, DMatrix::zeros(2, 0))?.state_space()
    /// };
    /// // The rotor loses stability at spin / ω = 1 + outer / inner.
    /// assert!(rotor(1.99)?.is_stable()? && !rotor(2.01)?.is_stable()?);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] if `M` is singular.
    pub fn state_space(&self) -> Result<StateSpace, Error> {
        let (n, m) = self.input.shape();
        let mut right = DMatrix::zeros(n, 2 * n + m);
        right.view_mut((0, 0), (n, n)).copy_from(&-(&self.stiffness + &self.circulatory));
        right.view_mut((0, n), (n, n)).copy_from(&-(&self.damping + &self.gyroscopic));
        right.view_mut((0, 2 * n), (n, m)).copy_from(&self.input);
        let solved = solve_linear_system("M", &self.mass, &right)?;
        let mut a = DMatrix::zeros(2 * n, 2 * n);
        a.view_mut((0, n), (n, n)).fill_with_identity();
        a.view_mut((n, 0), (n, 2 * n)).copy_from(&solved.columns(0, 2 * n));
        let mut b = DMatrix::zeros(2 * n, m);
        b.view_mut((n, 0), (n, m)).copy_from(&solved.columns(2 * n, m));
        let primed = self.coordinates.iter().map(|s| {
            let unit = if s.unit.is_empty() { String::new() } else { format!("{}/s", s.unit) };
            Signal::new(format!("{}'", s.name), unit)
        });
        let states: Vec<Signal> = self.coordinates.iter().cloned().chain(primed).collect();
        let system = StateSpace::new(a, b, DMatrix::identity(2 * n, 2 * n), DMatrix::zeros(2 * n, m))?;
        Ok(system.with_states(states)?.with_inputs(self.inputs.clone())?.with_states_as_outputs())
    }
}
