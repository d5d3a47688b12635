//! Equilibria and steady motions of mechanisms.
//!
//! A [`Trim`] lists the unknowns (coordinates, velocities, inputs, parameters) and the conditions
//! (accelerations, constraints, outputs) by name. [`equilibrium`] and [`constrained_equilibrium`] start with
//! a mechanism at rest: all coordinates are unknown, and all accelerations are zero.
//!
//! ```
//! use linkwork::prelude::*;
//! use linkwork_design::steady::{Verdict, equilibrium};
//!
//! /// A lamp on an arm with a spring in its hinge.
//! #[mechanism(gravity = -9.81 * y, derivatives)]
//! struct Lamp {
//!     #[body(mass = 0.5, com = 0.4 * x, inertia = rod(0.5, 0.8, x))]
//!     arm: Body,
//!     #[joint(ground -> arm, about = z)]
//!     hinge: Pin,
//!     #[acts(on = hinge, stiffness = 6)]
//!     spring: Spring,
//! }
//!
//! let lamp = Lamp {};
//! let rest = equilibrium(&lamp);
//! let found = rest.find()?;
//! // The torque of the weight balances that of the spring; the arm oscillates about this equilibrium.
//! assert!((6.0 * found.q[0] + 0.5 * 9.81 * 0.4 * found.q[0].cos()).abs() < 1e-12);
//! assert_eq!(rest.stiffness(&found)?.verdict(), Verdict::Stable);
//! assert!(rest.linear_system(&found)?.modes()?[0].damped_frequency() > 0.0);
//! # Ok::<(), linkwork_design::Error>(())
//! ```
//!
//! Coordinates have the names of `VELOCITIES`, since they are changed along the tangent space, `q ⊕ δq`: for
//! ball and free joints in body axes. The equations are solved by Levenberg–Marquardt steps on the tangent
//! space (Moré, *The Levenberg–Marquardt algorithm: implementation and theory*, 1978) with generated
//! derivatives, in a bounded number of iterations.

use crate::Error;
use linkwork::{Constrained, Derivatives, OutputDerivatives};
use nalgebra::SVector;
use problem::{ConstraintResiduals, OutputSensitivities};

mod linear;
mod problem;
mod solve;
mod stiffness;

pub use stiffness::{Stiffness, Verdict};

/// Function that builds a mechanism from the values of its unknown parameters.
type MechanismBuilder<'m, M> = dyn Fn(&[f64]) -> M + 'm;

/// Mechanism of a trim: either fixed, or built for each set of parameters.
enum MechanismSource<'m, M> {
    Given(&'m M),
    Family(Box<MechanismBuilder<'m, M>>),
}

/// Function that evaluates the constraints of a mechanism at a time, a configuration and a velocity.
type ConstraintFunction<M, const NQ: usize, const NV: usize> =
    fn(&M, f64, &SVector<f64, NQ>, &SVector<f64, NV>) -> ConstraintResiduals;

/// Function that computes the constraint multipliers with their names, at a time, a configuration, a velocity
/// and generalized forces.
type MultiplierFunction<M, const NQ: usize, const NV: usize> =
    fn(&M, f64, &SVector<f64, NQ>, &SVector<f64, NV>, &SVector<f64, NV>) -> Vec<(&'static str, f64)>;

/// Function that evaluates the outputs of a mechanism and their derivatives at a time, a configuration, a
/// velocity, an acceleration and inputs.
type OutputFunction<M, const NQ: usize, const NV: usize, const NU: usize> = fn(
    &M,
    f64,
    &SVector<f64, NQ>,
    &SVector<f64, NV>,
    &SVector<f64, NV>,
    &SVector<f64, NU>,
) -> OutputSensitivities;

/// Scalar function of mechanism, configuration, velocity and inputs, whose value a steady state prescribes.
type ConditionFunction<'m, M, const NQ: usize, const NV: usize, const NU: usize> =
    Box<dyn Fn(&M, &SVector<f64, NQ>, &SVector<f64, NV>, &SVector<f64, NU>) -> f64 + 'm>;

/// Unknowns and conditions of a steady state.
///
/// All coordinates are unknown by default, velocities and inputs are fixed at zero, and all accelerations are
/// zero. States of first order, which are among the velocities of an [`Extended`](linkwork::Extended)
/// mechanism, are unknown unless they are [fixed](Trim::fix), and their rates are zero. Constraints are
/// always conditions.
pub struct Trim<'m, M, const NQ: usize, const NV: usize, const NU: usize> {
    source: MechanismSource<'m, M>,
    t: f64,
    q: SVector<f64, NQ>,
    v: SVector<f64, NV>,
    u: SVector<f64, NU>,
    parameters: Vec<(String, f64)>,
    coordinates: Option<Vec<String>>,
    fixed: Vec<String>,
    held: Vec<String>,
    speeds: Vec<String>,
    inputs: Vec<String>,
    /// Accelerations with their required values; `None` for accelerations without a condition.
    accelerations: Vec<(String, Option<f64>)>,
    conditions: Vec<(String, f64)>,
    /// Conditions on quantities that are not outputs: name, required value and function.
    quantities: Vec<(String, f64, ConditionFunction<'m, M, NQ, NV, NU>)>,
    constraints: Option<(ConstraintFunction<M, NQ, NV>, MultiplierFunction<M, NQ, NV>)>,
    outputs: Option<OutputFunction<M, NQ, NV, NU>>,
    nearest: bool,
}

/// State that satisfies all conditions of a [`Trim`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SteadyState<const NQ: usize, const NV: usize, const NU: usize> {
    /// Configuration of the steady state, m and rad.
    pub q: SVector<f64, NQ>,
    /// Velocity of the steady state, m/s and rad/s.
    pub v: SVector<f64, NV>,
    /// Inputs of the steady state, in their declared units.
    pub u: SVector<f64, NU>,
    /// Acceleration `v̇`, m/s² and rad/s². Zero up to rounding, except for entries whose value was specified
    /// or that were left without a condition.
    pub acceleration: SVector<f64, NV>,
    /// Values of the mechanism's parameters, in the order of their declaration.
    pub parameters: Vec<f64>,
    /// Forces that lock the [held](Trim::hold) coordinates, as names and generalized forces, N or N·m.
    pub holding: Vec<(String, f64)>,
    /// Multipliers of the constraints, as names and values: force or torque (N, N·m) along the constraint's
    /// velocity. For redundant constraints, the multipliers of minimum norm.
    pub multipliers: Vec<(&'static str, f64)>,
    /// Number of iterations until the steady state was found.
    pub iterations: usize,
    /// Largest residual of the conditions of the steady state, each divided by its sensitivity to the
    /// unknowns, so that it is a displacement: rad, m.
    pub residual: f64,
}

/// Returns the trim of an equilibrium of a mechanism without constraints: at rest, with zero acceleration.
///
/// A mechanism with prescribed motions is evaluated at one instant ([`Trim::at_time`]). For a pendulum on a
/// hoop that rotates at constant speed, the results are the relative equilibria.
pub fn equilibrium<M, const NQ: usize, const NV: usize, const NU: usize>(m: &M) -> Trim<'_, M, NQ, NV, NU>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    const { assert!(!M::CONSTRAINED, "a mechanism with constraints: call `constrained_equilibrium`") };
    Trim::new(m)
}

/// Returns the trim of an equilibrium of a mechanism with constraints, which include rolling contacts.
///
/// ```
/// use linkwork::prelude::*;
/// use linkwork_design::steady::constrained_equilibrium;
///
/// /// A bead on a parabolic wire in the wind.
/// #[mechanism(gravity = -9.81 * y, derivatives)]
/// struct Bead {
///     #[body(mass = 1)]
///     bead: Body,
///     #[joint(ground -> bead, along = (x, y))]
///     place: Stage,
///     #[constraint(place.y == place.x * place.x)]
///     wire: Holonomic,
///     #[acts(on = bead, along = x)]
///     wind: Force,
/// }
///
/// let found = constrained_equilibrium(&Bead {}).with_inputs([4.905].into()).find()?;
/// // The wire is perpendicular to the sum of wind force and weight, and its reaction balances them.
/// assert!((found.q[0] - 0.25).abs() < 1e-12 && (found.q[1] - 0.0625).abs() < 1e-12);
/// assert_eq!(found.multipliers[0].0, "wire");
/// assert!((found.multipliers[0].1.abs() - 9.81).abs() < 1e-12);
/// # Ok::<(), linkwork_design::Error>(())
/// ```
pub fn constrained_equilibrium<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
) -> Trim<'_, M, NQ, NV, NU>
where
    M: Derivatives<NQ, NV, NU> + Constrained<NQ, NV, NU, NH, NC, Scalar = f64>,
{
    let multipliers: MultiplierFunction<M, NQ, NV> = |m, t, q, v, tau| {
        let (_, lambda) = m.constrained_dynamics(t, q, v, tau);
        M::CONSTRAINTS.into_iter().zip(lambda.iter().copied()).collect()
    };
    Trim {
        constraints: Some((problem::constraint_residuals::<M, NQ, NV, NU, NH, NC>, multipliers)),
        ..Trim::new(m)
    }
}

fn owned_names<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Vec<String> {
    names.into_iter().map(Into::into).collect()
}

impl<'m, M, const NQ: usize, const NV: usize, const NU: usize> Trim<'m, M, NQ, NV, NU>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    fn new(m: &'m M) -> Self {
        Self {
            source: MechanismSource::Given(m),
            t: 0.0,
            q: m.neutral(),
            v: SVector::zeros(),
            u: SVector::zeros(),
            parameters: Vec::new(),
            coordinates: None,
            fixed: Vec::new(),
            held: Vec::new(),
            speeds: Vec::new(),
            inputs: Vec::new(),
            accelerations: Vec::new(),
            conditions: Vec::new(),
            quantities: Vec::new(),
            constraints: None,
            outputs: None,
            nearest: false,
        }
    }

    /// Sets the configuration from which the iteration for a steady state starts. Coordinates that are not
    /// unknown retain its values. The default is the neutral configuration. It need not satisfy the
    /// constraints.
    pub fn from(mut self, q: SVector<f64, NQ>) -> Self {
        self.q = q;
        self
    }

    /// Sets the velocity of the steady state, m/s and rad/s; for unknown velocities it is the initial guess.
    /// The default is zero.
    pub fn moving(mut self, v: SVector<f64, NV>) -> Self {
        self.v = v;
        self
    }

    /// Sets the inputs of the steady state; for unknown inputs they are the initial guess. The default is
    /// zero.
    pub fn with_inputs(mut self, u: SVector<f64, NU>) -> Self {
        self.u = u;
        self
    }

    /// Sets the time, s, at which a mechanism with prescribed motions is evaluated. The default is zero.
    pub fn at_time(mut self, t: f64) -> Self {
        self.t = t;
        self
    }

    /// Declares the named coordinates as the only unknown ones of the trim. All others keep their initial
    /// values.
    pub fn coordinates<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.coordinates = Some(owned_names(names));
        self
    }

    /// Fixes the named coordinates at their initial values, while the forces along them must still balance.
    /// Examples are positions on a level road and the heading of an aircraft.
    pub fn fix<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.fixed.extend(owned_names(names));
        self
    }

    /// Locks the named coordinates at their initial values by generalized forces, which are computed
    /// ([`SteadyState::holding`]).
    ///
    /// ```
    /// use linkwork::prelude::*;
    /// use linkwork_design::steady::equilibrium;
    ///
    /// #[mechanism(gravity = -9.81 * y, derivatives)]
    /// struct Arm {
    ///     #[body(mass = 2, com = 0.5 * x)]
    ///     upper: Body,
    ///     #[body(mass = 1, com = 0.5 * x)]
    ///     lower: Body,
    ///     #[joint(ground -> upper, about = z)]
    ///     shoulder: Pin,
    ///     #[joint(upper.at(x) -> lower, about = z)]
    ///     elbow: Pin,
    /// }
    ///
    /// // The upper arm is locked horizontally; the lower arm hangs down.
    /// let found = equilibrium(&Arm {}).from([0.0, -1.0].into()).hold(["shoulder"]).find()?;
    /// assert!((found.q[1] + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    /// assert!((found.holding[0].1 - (2.0 * 0.5 + 1.0 * 1.0) * 9.81).abs() < 1e-12);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    pub fn hold<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.held.extend(owned_names(names));
        self
    }

    /// Declares the named velocities as unknowns of the trim.
    pub fn speeds<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.speeds.extend(owned_names(names));
        self
    }

    /// Declares the named inputs as unknowns of the trim.
    pub fn inputs<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.inputs.extend(owned_names(names));
        self
    }

    /// Removes the conditions that the named accelerations are zero, for example for the position of a wheel
    /// that rolls in a circle.
    pub fn accelerating<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.accelerations.extend(owned_names(names).into_iter().map(|name| (name, None)));
        self
    }

    /// Prescribes the acceleration with this velocity name, m/s² or rad/s², instead of zero.
    pub fn acceleration(mut self, name: impl Into<String>, value: f64) -> Self {
        self.accelerations.push((name.into(), Some(value)));
        self
    }

    /// Prescribes the value of the output with this name. Components of vectors are named `name.x` and so on.
    pub fn output<const NY: usize>(mut self, name: impl Into<String>, value: f64) -> Self
    where
        M: OutputDerivatives<NQ, NV, NU, NY, Scalar = f64>,
    {
        self.outputs = Some(problem::output_derivatives::<M, NQ, NV, NU, NY>);
        self.conditions.push((name.into(), value));
        self
    }

    /// Adds a condition on a quantity that is not a declared output: a function of configuration, velocity
    /// and inputs has this value. Errors show `name`. The derivatives of the quantity are central
    /// differences.
    ///
    /// ```
    /// use linkwork::prelude::*;
    /// use linkwork_design::steady::equilibrium;
    ///
    /// /// A wing whose attitude is free to choose, without moments about its centre of mass.
    /// #[mechanism(gravity = 9.81 * z, derivatives)]
    /// struct Wing {
    ///     #[body(mass = 400, inertia = diagonal(900, 800, 1600))]
    ///     airframe: Body,
    ///     #[joint(ground -> airframe)]
    ///     flight: Free,
    ///     #[define(v(airframe / ground / ground))]
    ///     velocity: Vector,
    ///     #[define(angle_of_attack(airframe, velocity))]
    ///     alpha: Scalar,
    ///     #[define(6 * dot(velocity, velocity))]
    ///     load: Scalar,
    ///     #[acts(on = airframe, value = load * (0.4 + 5 * alpha) * (sin(alpha) * airframe.x - cos(alpha) * airframe.z))]
    ///     lift: Force,
    ///     #[acts(on = airframe, value = -0.03 * load * unit(velocity))]
    ///     drag: Force,
    ///     #[acts(on = airframe, along = airframe.x)]
    ///     thrust: Force,
    /// }
    ///
    /// // Level flight at 40 m/s: the axes of the ground are forward, right and down.
    /// let level = equilibrium(&Wing {})
    ///     .moving([40.0, 0.0, 0.0, 0.0, 0.0, 0.0].into())
    ///     .coordinates(["flight.wy"])
    ///     .speeds(["flight.vx", "flight.vz"])
    ///     .inputs(["thrust"])
    ///     .condition("sink", 0.0, |wing, q, v, _| wing.frame_velocity(frame!(Wing, "airframe"), q, v)[2])
    ///     .condition("speed", 40.0, |_, _, v, _| v.fixed_rows::<3>(0).norm())
    ///     .find()?;
    /// let alpha = level.v[2].atan2(level.v[0]);
    /// let drag = 0.03 * 6.0 * 40.0_f64.powi(2);
    /// assert!((level.u[0] * alpha.cos() - drag).abs() < 1e-9 * drag);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    pub fn condition(
        mut self,
        name: impl Into<String>,
        value: f64,
        quantity: impl Fn(&M, &SVector<f64, NQ>, &SVector<f64, NV>, &SVector<f64, NU>) -> f64 + 'm,
    ) -> Self {
        self.quantities.push((name.into(), value, Box::new(quantity)));
        self
    }

    /// Declares unknown parameters by names and initial guesses, with a function that builds the mechanism
    /// from their values. The derivatives with respect to parameters are central differences; all others are
    /// generated.
    ///
    /// ```
    /// use linkwork::prelude::*;
    /// use linkwork_design::steady::equilibrium;
    ///
    /// #[mechanism(gravity = -9.81 * y, derivatives)]
    /// struct Scale {
    ///     load: f64,
    ///     #[body(mass = load)]
    ///     pan: Body,
    ///     #[joint(ground -> pan, along = y)]
    ///     guide: Sleeve,
    ///     #[acts(on = guide, stiffness = 500)]
    ///     spring: Spring,
    /// }
    ///
    /// // Which load deflects the pan by 2 cm?
    /// let scale = Scale { load: 1.0 };
    /// let found = equilibrium(&scale)
    ///     .from([-0.02].into())
    ///     .fix(["guide"])
    ///     .parameters([("load", 1.0)], |p| Scale { load: p[0] })
    ///     .find()?;
    /// assert!((found.parameters[0] - 10.0 / 9.81).abs() < 1e-9);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    pub fn parameters<S: Into<String>>(
        mut self,
        guesses: impl IntoIterator<Item = (S, f64)>,
        family: impl Fn(&[f64]) -> M + 'm,
    ) -> Self {
        self.parameters = guesses.into_iter().map(|(name, guess)| (name.into(), guess)).collect();
        self.source = MechanismSource::Family(Box::new(family));
        self
    }

    /// Accepts conditions that do not determine all unknowns: the undetermined unknowns stay near their
    /// initial guess. The default is an error.
    pub fn nearest(mut self) -> Self {
        self.nearest = true;
        self
    }

    /// Computes a state near the guess that satisfies all conditions of the trim.
    ///
    /// # Errors
    ///
    /// [`Error::NoSteadyState`] if the iteration finds none, with the condition that is violated most and the
    /// state of minimum violation. [`Error::Undetermined`] if the conditions do not determine all unknowns.
    /// [`Error::Unknown`] for an unknown name. [`Error::NotFinite`] if accelerations at the guess are not
    /// finite, [`Error::Constraint`] if friction jams at the guess.
    pub fn find(&self) -> Result<SteadyState<NQ, NV, NU>, Error> {
        solve::find(self)
    }

    /// Computes the distinct steady states that are reached from several guesses of the configuration, in the
    /// order of the guesses. Guesses that lead to no state are skipped. Angles of revolute joints are not
    /// reduced modulo a revolution.
    ///
    /// # Errors
    ///
    /// The error of the last guess that failed, if all fail; [`Error::Count`] for an empty list of guesses.
    pub fn find_all(
        &mut self,
        guesses: impl IntoIterator<Item = SVector<f64, NQ>>,
    ) -> Result<Vec<SteadyState<NQ, NV, NU>>, Error> {
        let start = self.q;
        let mut all: Vec<SteadyState<NQ, NV, NU>> = Vec::new();
        let mut error = Error::Count { what: "guesses", expected: 1, found: 0 };
        for guess in guesses {
            self.q = guess;
            match self.find() {
                Ok(found) if all.iter().all(|other| self.has_significant_difference(other, &found)) => {
                    all.push(found)
                }
                Ok(_) => {}
                Err(e) => error = e,
            }
        }
        self.q = start;
        if all.is_empty() { Err(error) } else { Ok(all) }
    }

    /// Whether two steady states differ by more than the accuracy of a solution.
    fn has_significant_difference(
        &self,
        one: &SteadyState<NQ, NV, NU>,
        other: &SteadyState<NQ, NV, NU>,
    ) -> bool {
        const APART: f64 = 1e-6;
        let differs =
            |a: &[f64], b: &[f64]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > APART * a.abs().max(1.0));
        let way = self.call_with_mechanism(&one.parameters, |m| m.difference(&one.q, &other.q));
        way.amax() > APART
            || differs(one.v.as_slice(), other.v.as_slice())
            || differs(one.u.as_slice(), other.u.as_slice())
            || differs(&one.parameters, &other.parameters)
    }

    fn call_with_mechanism<R>(&self, parameters: &[f64], f: impl FnOnce(&M) -> R) -> R {
        match &self.source {
            MechanismSource::Given(m) => f(m),
            MechanismSource::Family(family) => f(&family(parameters)),
        }
    }
}
