//! Equilibria and steady motions of mechanisms.
//!
//! A [`Trim`] lists what is unknown (coordinates, speeds, inputs, parameters) and what is to hold there
//! (accelerations, constraints, outputs), by name. [`equilibrium`] and [`constrained_equilibrium`] begin with
//! a mechanism at rest: all coordinates are unknown, and nothing accelerates.
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
//! // The moment of the weight is that of the spring, and the arm would swing about there.
//! assert!((6.0 * found.q[0] + 0.5 * 9.81 * 0.4 * found.q[0].cos()).abs() < 1e-12);
//! assert_eq!(rest.stiffness(&found)?.verdict(), Verdict::Stable);
//! assert!(rest.linear_system(&found)?.modes()?[0].damped_frequency() > 0.0);
//! # Ok::<(), linkwork_design::Error>(())
//! ```
//!
//! Names are those of `VELOCITIES`, also for coordinates, which move along `q ⊕ δq`: in body axes for ball
//! and free joints. The equations are solved by Levenberg–Marquardt steps on the tangent space (Moré, *The
//! Levenberg–Marquardt algorithm: implementation and theory*, 1978) with generated derivatives, in a bounded
//! number of iterations.

use crate::Error;
use linkwork::{Constrained, OutputDerivatives, Rheonomic, RheonomicDerivatives};
use nalgebra::SVector;
use problem::{Bounds, Measured};

mod linear;
mod problem;
mod solve;
mod stiffness;

pub use stiffness::{Stiffness, Verdict};

/// The mechanism that has given parameters.
type Family<'m, M> = dyn Fn(&[f64]) -> M + 'm;

/// A mechanism, or one for each set of parameters.
enum Source<'m, M> {
    Given(&'m M),
    Family(Box<Family<'m, M>>),
}

/// Constraints of a mechanism at a time, a configuration and a velocity.
type ConstraintsOf<M, const NQ: usize, const NV: usize> =
    fn(&M, f64, &SVector<f64, NQ>, &SVector<f64, NV>) -> Bounds;

/// Multipliers of the constraints under forces.
type MultipliersOf<M, const NQ: usize, const NV: usize> =
    fn(&M, f64, &SVector<f64, NQ>, &SVector<f64, NV>, &SVector<f64, NV>) -> Vec<(&'static str, f64)>;

/// Outputs of a mechanism at a time, of configuration, velocity, acceleration and inputs.
type OutputsOf<M, const NQ: usize, const NV: usize, const NU: usize> =
    fn(&M, f64, &SVector<f64, NQ>, &SVector<f64, NV>, &SVector<f64, NV>, &SVector<f64, NU>) -> Measured;

/// What is unknown of a state, and what is to hold there.
///
/// Before anything is said, all coordinates are unknown, speeds and inputs are given (as zero), and no
/// velocity changes. States of first order, of a mechanism with them among its velocities
/// ([`Extended`](linkwork::Extended)), are unknown unless they are [fixed](Trim::fix), and come to rest.
/// Constraints always hold.
pub struct Trim<'m, M, const NQ: usize, const NV: usize, const NU: usize> {
    source: Source<'m, M>,
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
    /// Accelerations that are given, or left open.
    accelerations: Vec<(String, Option<f64>)>,
    conditions: Vec<(String, f64)>,
    constraints: Option<(ConstraintsOf<M, NQ, NV>, MultipliersOf<M, NQ, NV>)>,
    outputs: Option<OutputsOf<M, NQ, NV, NU>>,
    nearest: bool,
    iterations: usize,
}

/// A state in which all conditions hold.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SteadyState<const NQ: usize, const NV: usize, const NU: usize> {
    /// Configuration.
    pub q: SVector<f64, NQ>,
    /// Velocity, m/s and rad/s.
    pub v: SVector<f64, NV>,
    /// Inputs.
    pub u: SVector<f64, NU>,
    /// `v̇`, m/s² and rad/s²: rounding but for entries that were given or left open.
    pub acceleration: SVector<f64, NV>,
    /// The parameters, in the order in which they were given.
    pub parameters: Vec<f64>,
    /// What holds coordinates: name, and generalized force, N or N·m.
    pub holding: Vec<(String, f64)>,
    /// Multipliers of the constraints: name, and force or torque (N, N·m) along what the constraint's rate
    /// counts. Where constraints are redundant, those of least norm.
    pub multipliers: Vec<(&'static str, f64)>,
    /// How many iterations were made.
    pub iterations: usize,
    /// What is left of the conditions, each divided by what it changes with unknowns: rad, m.
    pub residual: f64,
}

/// Equilibria of a mechanism without constraints: at rest, and nothing accelerates.
///
/// What is driven in time is looked at in an instant ([`Trim::at_time`]): of a pendulum on a hoop that turns
/// steadily these are the relative equilibria.
pub fn equilibrium<M, const NQ: usize, const NV: usize, const NU: usize>(m: &M) -> Trim<'_, M, NQ, NV, NU>
where
    M: RheonomicDerivatives<NQ, NV, NU> + Rheonomic<NQ, NV, NU, Scalar = f64>,
{
    const { assert!(!M::CONSTRAINED, "a mechanism with constraints: call `constrained_equilibrium`") };
    Trim::new(m)
}

/// Equilibria of a mechanism with constraints, rolling contacts among them.
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
/// // The wire is perpendicular to the sum of wind and weight, and holds it.
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
    M: RheonomicDerivatives<NQ, NV, NU> + Constrained<NQ, NV, NU, NH, NC, Scalar = f64>,
{
    let multipliers: MultipliersOf<M, NQ, NV> = |m, t, q, v, tau| {
        let (_, lambda) = m.constrained_dynamics(t, q, v, tau);
        M::CONSTRAINTS.into_iter().zip(lambda.iter().copied()).collect()
    };
    Trim { constraints: Some((problem::bounds::<M, NQ, NV, NU, NH, NC>, multipliers)), ..Trim::new(m) }
}

fn owned<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Vec<String> {
    names.into_iter().map(Into::into).collect()
}

impl<'m, M, const NQ: usize, const NV: usize, const NU: usize> Trim<'m, M, NQ, NV, NU>
where
    M: RheonomicDerivatives<NQ, NV, NU> + Rheonomic<NQ, NV, NU, Scalar = f64>,
{
    fn new(m: &'m M) -> Self {
        Self {
            source: Source::Given(m),
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
            constraints: None,
            outputs: None,
            nearest: false,
            iterations: 200,
        }
    }

    /// Begins at this configuration; coordinates that are not unknown keep it. The neutral one without this.
    /// Constraints need not hold there.
    pub fn from(mut self, q: SVector<f64, NQ>) -> Self {
        self.q = q;
        self
    }

    /// The velocity, m/s and rad/s; where speeds are unknown, the guess. Zero without this.
    pub fn moving(mut self, v: SVector<f64, NV>) -> Self {
        self.v = v;
        self
    }

    /// The inputs; where they are unknown, the guess. Zero without this.
    pub fn with_inputs(mut self, u: SVector<f64, NU>) -> Self {
        self.u = u;
        self
    }

    /// The instant, s, of a mechanism that is driven in time.
    pub fn at_time(mut self, t: f64) -> Self {
        self.t = t;
        self
    }

    /// Only these coordinates are unknown; the others keep what they are.
    pub fn coordinates<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.coordinates = Some(owned(names));
        self
    }

    /// These coordinates keep what they are, while the forces along them have to balance all the same: places
    /// on a level road, the heading of an aircraft.
    pub fn fix<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.fixed.extend(owned(names));
        self
    }

    /// These coordinates are held fast, by forces that are found ([`SteadyState::holding`]).
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
    /// // The upper arm is held level; the lower one hangs down.
    /// let found = equilibrium(&Arm {}).from([0.0, -1.0].into()).hold(["shoulder"]).find()?;
    /// assert!((found.q[1] + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    /// assert!((found.holding[0].1 - (2.0 * 0.5 + 1.0 * 1.0) * 9.81).abs() < 1e-12);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    pub fn hold<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.held.extend(owned(names));
        self
    }

    /// These speeds are unknown.
    pub fn speeds<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.speeds.extend(owned(names));
        self
    }

    /// These inputs are unknown.
    pub fn inputs<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.inputs.extend(owned(names));
        self
    }

    /// These velocities may change as they will: those of the place of a wheel that runs in a circle.
    pub fn accelerating<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.accelerations.extend(owned(names).into_iter().map(|name| (name, None)));
        self
    }

    /// The velocity of this name changes at a given rate, m/s² or rad/s², instead of none.
    pub fn acceleration(mut self, name: impl Into<String>, value: f64) -> Self {
        self.accelerations.push((name.into(), Some(value)));
        self
    }

    /// A condition: the output of this name has this value. Components of vectors are `name.x` and so on.
    pub fn output<const NY: usize>(mut self, name: impl Into<String>, value: f64) -> Self
    where
        M: OutputDerivatives<NQ, NV, NU, NY, Scalar = f64>,
    {
        self.outputs = Some(problem::measured::<M, NQ, NV, NU, NY>);
        self.conditions.push((name.into(), value));
        self
    }

    /// Parameters that are unknown, by names with guesses, and the mechanism that has them. Derivatives by
    /// them are central differences; all others are generated.
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
    /// // What lies on the pan when it has gone down by 2 cm?
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
        self.source = Source::Family(Box::new(family));
        self
    }

    /// What the conditions leave open stays near what it was, instead of being an error.
    pub fn nearest(mut self) -> Self {
        self.nearest = true;
        self
    }

    /// The most iterations, 200 without this.
    pub fn most_iterations(mut self, iterations: usize) -> Self {
        self.iterations = iterations;
        self
    }

    /// A state in which all conditions hold, near the guess.
    ///
    /// # Errors
    ///
    /// [`Error::NoSteadyState`] where there is none: with the condition that is violated most, and the place
    /// at which the violation is least. [`Error::Undetermined`] where conditions leave unknowns open.
    /// [`Error::Unknown`] for a name that is none. [`Error::NotFinite`] where accelerations at the guess are
    /// not, [`Error::Constraint`] where friction jams there.
    pub fn find(&self) -> Result<SteadyState<NQ, NV, NU>, Error> {
        solve::find(self)
    }

    /// The different states that are reached from several guesses of the configuration, in that order;
    /// guesses from which none is reached are passed over. Coordinates of joints that turn count their turns.
    ///
    /// # Errors
    ///
    /// The error of the last guess, if all of them have one; [`Error::Count`] for no guess.
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
                Ok(found) if all.iter().all(|other| self.differ(other, &found)) => all.push(found),
                Ok(_) => {}
                Err(e) => error = e,
            }
        }
        self.q = start;
        if all.is_empty() { Err(error) } else { Ok(all) }
    }

    /// Whether states are farther apart than a solution is known.
    fn differ(&self, one: &SteadyState<NQ, NV, NU>, other: &SteadyState<NQ, NV, NU>) -> bool {
        const APART: f64 = 1e-6;
        let far =
            |a: &[f64], b: &[f64]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > APART * a.abs().max(1.0));
        let way = self.with(&one.parameters, |m| m.difference(&one.q, &other.q));
        way.amax() > APART
            || far(one.v.as_slice(), other.v.as_slice())
            || far(one.u.as_slice(), other.u.as_slice())
            || far(&one.parameters, &other.parameters)
    }

    fn with<R>(&self, parameters: &[f64], f: impl FnOnce(&M) -> R) -> R {
        match &self.source {
            Source::Given(m) => f(m),
            Source::Family(family) => f(&family(parameters)),
        }
    }
}
