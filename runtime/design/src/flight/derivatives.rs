//! Dimensional and dimensionless derivatives of the forces on an aircraft.

use super::states::check_begins_with_free_joint;
use crate::Error;
use crate::mechanism::effective_mass_at_state;
use linkwork::{Derivatives as Generated, Mechanism, Scleronomic};
use nalgebra::{DMatrix, DVector, SVector};

/// Names of the forces along, and moments about, the forward, right and down axes of an aircraft.
const FORCES: [&str; 6] = ["X", "Y", "Z", "L", "M", "N"];
/// Names of the linear and angular velocities of an aircraft along its forward, right and down axes.
const VELOCITIES: [&str; 6] = ["u", "v", "w", "p", "q", "r"];

/// Reference quantities that make aerodynamic derivatives dimensionless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Density of the air, kg/m³.
    pub density: f64,
    /// Wing area, m².
    pub area: f64,
    /// Mean chord of the wing, m.
    pub chord: f64,
    /// Wing span, m.
    pub span: f64,
}

/// Stability and control derivatives of an aircraft: derivatives of aerodynamic forces and thrust, without
/// gravity and inertia. Moments are about the origin of the airframe; components are in airframe axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivatives {
    /// Derivatives of forces and moments with respect to the velocities `u`, `v`, `w`, `p`, `q`, `r`: N·s/m,
    /// N·s, N·m·s. Rows are `X`, `Y`, `Z`, `L`, `M`, `N`.
    pub by_velocity: DMatrix<f64>,
    /// Derivatives of forces and moments with respect to the time derivatives of the velocities, such as
    /// `∂Z/∂ẇ`: kg, kg·m, kg·m².
    pub by_acceleration: DMatrix<f64>,
    /// Derivatives of forces and moments with respect to the inputs.
    pub by_input: DMatrix<f64>,
    /// Forces and moments on the aircraft at the reference state, N and N·m.
    pub forces: DVector<f64>,
    /// Linear and angular velocity of the aircraft at the reference state, m/s and rad/s.
    pub velocity: DVector<f64>,
    inputs: Vec<&'static str>,
}

/// Returns the wrench `w × (M v)` for twists `w` and `v` and the mass matrix `M` of a body, with the linear
/// part first.
fn twist_cross_momentum(mass: &DMatrix<f64>, w: &DVector<f64>, v: &DVector<f64>) -> DVector<f64> {
    let momentum = mass * v;
    let three_entries_from = |x: &DVector<f64>, from: usize| x.fixed_rows::<3>(from).into_owned();
    let (force, moment) = (three_entries_from(&momentum, 0), three_entries_from(&momentum, 3));
    let (linear, angular) = (three_entries_from(w, 0), three_entries_from(w, 3));
    let mut all = DVector::zeros(6);
    all.fixed_rows_mut::<3>(0).copy_from(&angular.cross(&force));
    all.fixed_rows_mut::<3>(3).copy_from(&(angular.cross(&moment) + linear.cross(&force)));
    all
}

impl Derivatives {
    /// Computes the derivatives at a state of a mechanism whose first six velocities are those of a free
    /// joint. Gyroscopic moments of rotors are included in the forces.
    ///
    /// ```text
    /// f = M v̇ + v × M v − weight,   ∂f/∂v, ∂f/∂v̇, ∂f/∂u
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] if the first joint is not free, [`Error::NotFinite`] if a derivative is not finite.
    pub fn at_state<M, const NQ: usize, const NV: usize, const NU: usize>(
        m: &M,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        u: &SVector<f64, NU>,
    ) -> Result<Self, Error>
    where
        M: Generated<NQ, NV, NU, Scalar = f64> + Scleronomic,
    {
        check_begins_with_free_joint(&M::VELOCITIES)?;
        let motion = m.linear_motion(q, v, u);
        let (_, by_v) = m.inverse_dynamics_derivatives(0.0, q, v, &motion.acceleration);
        let all = effective_mass_at_state(m, 0.0, q, v);
        let own = Mechanism::mass_matrix(m, 0.0, q);
        let mass = DMatrix::from_fn(6, 6, |i, j| own[(i, j)]);
        let velocity = DVector::from_fn(6, |i, _| v[i]);
        let acceleration = DVector::from_fn(6, |i, _| motion.acceleration[i]);
        let mut by_velocity = DMatrix::from_fn(6, 6, |i, j| -by_v[(i, j)]);
        for k in 0..6 {
            let unit = DVector::from_fn(6, |i, _| if i == k { 1.0 } else { 0.0 });
            let change =
                twist_cross_momentum(&mass, &unit, &velocity) + twist_cross_momentum(&mass, &velocity, &unit);
            by_velocity.column_mut(k).zip_apply(&change, |x, y| *x += y);
        }
        let by_acceleration = DMatrix::from_fn(6, 6, |i, j| mass[(i, j)] - all[(i, j)]);
        let by_u = DMatrix::from_fn(NV, NU, |i, j| motion.by_u[(i, j)]);
        let by_input = (all * by_u).rows(0, 6).into_owned();
        let forces = &mass * acceleration + twist_cross_momentum(&mass, &velocity, &velocity)
            - weight_on_free_joint(m, q);
        let parts =
            [by_velocity.as_slice(), by_acceleration.as_slice(), by_input.as_slice(), forces.as_slice()];
        if parts.iter().any(|part| part.iter().any(|x| !x.is_finite())) {
            return Err(Error::NotFinite { what: "a derivative" });
        }
        Ok(Self { by_velocity, by_acceleration, by_input, forces, velocity, inputs: M::INPUTS.to_vec() })
    }

    /// Transforms the derivatives to stability axes: rotated about the right axis so that the forward axis is
    /// along the velocity projected onto the plane of symmetry.
    pub fn in_stability_axes(&self) -> Self {
        let (s, c) = self.velocity[2].atan2(self.velocity[0]).sin_cos();
        let mut turn = DMatrix::identity(6, 6);
        for k in [0, 3] {
            (turn[(k, k)], turn[(k, k + 2)], turn[(k + 2, k)], turn[(k + 2, k + 2)]) = (c, s, -s, c);
        }
        let rotate_matrix_to_stability_axes = |m: &DMatrix<f64>| &turn * m * turn.transpose();
        Self {
            by_velocity: rotate_matrix_to_stability_axes(&self.by_velocity),
            by_acceleration: rotate_matrix_to_stability_axes(&self.by_acceleration),
            by_input: &turn * &self.by_input,
            forces: &turn * &self.forces,
            velocity: &turn * &self.velocity,
            inputs: self.inputs.clone(),
        }
    }

    /// Returns a derivative by the names of the force and of the variable: `of_force("M", "q")`,
    /// `("Z", "w'")`, `("M", "elevator")`.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the list of existing names.
    pub fn of_force(&self, force: &str, by: &str) -> Result<f64, Error> {
        let row = index_of_name_or_error("force", &FORCES, force)?;
        if let Some(velocity) = by.strip_suffix('\'') {
            return Ok(
                self.by_acceleration[(row, index_of_name_or_error("velocity", &VELOCITIES, velocity)?)]
            );
        }
        if let Some(column) = VELOCITIES.iter().position(|name| *name == by) {
            return Ok(self.by_velocity[(row, column)]);
        }
        let names: Vec<&str> = VELOCITIES.iter().copied().chain(self.inputs.iter().copied()).collect();
        Ok(self.by_input[(row, index_of_name_or_error("velocity or input", &names, by)?.saturating_sub(6))])
    }

    /// Returns a dimensionless aerodynamic derivative as defined by Etkin and Reid (*Dynamics of Flight*,
    /// 1996, table 4.1). Forces are divided by `½ ρ V² S`, and moments by that and chord or span. `u` is
    /// divided by the airspeed, at a coefficient that changes; `v` and `w` become the angles `β` and `α`.
    /// Angular velocities are divided by `2 V / b` (in pitch `2 V / c`), and rates of `v` and `w`
    /// accordingly.
    ///
    /// # Errors
    ///
    /// As for [`of_force`](Self::of_force); [`Error::Range`] at rest.
    pub fn coefficient(&self, force: &str, by: &str, reference: &Reference) -> Result<f64, Error> {
        let derivative = self.of_force(force, by)?;
        let Reference { density, area, chord, span } = *reference;
        let speed = self.velocity.fixed_rows::<3>(0).norm();
        let load = 0.5 * density * speed * speed * area;
        if !(load > 0.0 && load.is_finite()) {
            return Err(Error::Range { what: "a dynamic pressure times area", value: load });
        }
        let arm = match force {
            "M" => chord,
            "L" | "N" => span,
            _ => 1.0,
        };
        let own = if by == "u" {
            2.0 * self.forces[index_of_name_or_error("force", &FORCES, force)?] / speed
        } else {
            0.0
        };
        let unit = match by {
            "u" | "v" | "w" => 1.0 / speed,
            "q" => chord / (2.0 * speed),
            "p" | "r" => span / (2.0 * speed),
            "u'" | "w'" => chord / (2.0 * speed * speed),
            "v'" => span / (2.0 * speed * speed),
            "q'" => (chord / (2.0 * speed)).powi(2),
            "p'" | "r'" => (span / (2.0 * speed)).powi(2),
            _ => 1.0,
        };
        Ok((derivative - own) / (load * arm * unit))
    }

    /// Returns the static margin: the distance, in chords, of the neutral point behind the airframe's origin,
    /// which is its centre of mass. Computed as the derivative of the pitching moment with respect to the
    /// downward velocity, divided by that of the force along the downward axis. Positive for a stable
    /// aircraft.
    ///
    /// # Errors
    ///
    /// [`Error::Range`] for a chord that is not positive, [`Error::Singular`] if no force depends on the
    /// downward velocity.
    pub fn static_margin(&self, chord: f64) -> Result<f64, Error> {
        if !(chord > 0.0 && chord.is_finite()) {
            return Err(Error::Range { what: "a chord", value: chord });
        }
        let (force, moment) = (self.by_velocity[(2, 2)], self.by_velocity[(4, 2)]);
        if force == 0.0 {
            return Err(Error::Singular { what: "the slope of the lift" });
        }
        Ok(moment / (force * chord))
    }
}

/// Returns the generalized forces on the free joint that derive from the potential energy, by central
/// differences, which are exact for a uniform field.
fn weight_on_free_joint<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
) -> DVector<f64>
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    DVector::from_fn(6, |k, _| {
        let step = if k < 3 { 1.0 } else { 1e-3 };
        let by = SVector::from_fn(|i, _| if i == k { step } else { 0.0 });
        let (up, down) = (Mechanism::integrate(m, q, &by), Mechanism::integrate(m, q, &-by));
        (Mechanism::potential_energy(m, 0.0, &down) - Mechanism::potential_energy(m, 0.0, &up)) / (2.0 * step)
    })
}

fn index_of_name_or_error(kind: &'static str, names: &[&str], name: &str) -> Result<usize, Error> {
    names.iter().position(|known| *known == name).ok_or_else(|| Error::Unknown {
        kind,
        name: name.to_owned(),
        known: names.iter().map(|known| (*known).to_owned()).collect(),
    })
}
