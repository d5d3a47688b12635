//! Constrained mechanisms: closed loops, rolling and other constraints ([guide](crate::guide::constraints)).
//!
//! The coordinates are those of the spanning tree and are not independent: a state `(q, v)` fulfils the
//! residuals `φ(t, q) = 0` and the rates `J(t, q) v + … = 0`. [`Constrained::assemble`] finds such a
//! configuration near a given one, [`Constrained::complete_velocity`] the velocity with given entries,
//! [`Constrained::project_velocity`] the nearest, and [`simulate`](crate::simulate()) keeps both, or lets
//! violations decay where a mechanism is [`stabilized`].

use crate::private::{constant, epsilon, to_f64};
use crate::{ByMotion, Real, Rheonomic};
use core::fmt;
use nalgebra::{SMatrix, SVector};

mod assemble;
mod careful;
mod complete;
mod differentiable;
mod graded;
mod layout;
mod linearize;
mod second;
mod slipping;
mod solve;
mod span;
mod stabilized;

#[doc(hidden)]
pub use assemble::{Loops, assemble, assembly_mode};
pub use careful::{Structure, careful_dynamics, careful_response, nearly_singular};
pub use differentiable::{ConstrainedDerivatives, EquationDerivatives, MultiplierDerivatives, Visitor};
pub(crate) use differentiable::{Frozen, column, each_column, multipliers, set_column};
pub(crate) use graded::change_rates;
#[doc(hidden)]
pub use layout::{ConstraintCurvature, Elimination, InputDerivatives, MotionDerivatives, Responses};
pub use linearize::Linearization;
#[doc(hidden)]
pub use linearize::{Motion, constrained_derivatives};
pub use second::{ConstrainedSecondDerivatives, CurvatureVisitor, EquationSecondDerivatives};
pub(crate) use second::{FrozenCurvature, adjoint, with_transpose};
#[doc(hidden)]
pub use second::{constrained_second_derivatives, with_curvature};
#[doc(hidden)]
pub use slipping::{pressing_solution, slipping_response, slipping_solution};
#[doc(hidden)]
pub use solve::{independent_solution, least_solution, regular_solution};
#[doc(hidden)]
pub use stabilized::stabilized_derivatives;
pub use stabilized::{Stabilized, stabilized};

/// A share of the velocity by which a projection changes it where it leads to another branch.
const TURN: f64 = 0.01;

/// Newton steps of a projection; a state that has drifted needs one or two.
const MOST_STEPS: usize = 20;

/// Why a state could not be brought onto the constraints.
#[derive(Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ConstraintError {
    /// No configuration near the given one fulfils the constraints.
    Configuration {
        /// The constraint that is violated most.
        constraint: &'static str,
        /// What is left of it, m or rad.
        residual: f64,
    },
    /// No velocity fulfils the constraints: what is driven in time contradicts them, or the configuration is
    /// singular.
    Velocity {
        /// The constraint that is violated most.
        constraint: &'static str,
        /// What is left of its rate, m/s or rad/s.
        rate: f64,
    },
    /// No acceleration fulfils the constraints: entries that are given contradict them, or the configuration
    /// is singular.
    Acceleration {
        /// The constraint that is violated most.
        constraint: &'static str,
        /// The remainder of its second rate, m/s² or rad/s².
        acceleration: f64,
    },
    /// No configuration of the assembly mode that was asked for was found around the guess
    /// ([`Constrained::assemble_in_mode`]).
    Mode {
        /// The assembly mode.
        mode: i8,
    },
    /// Forces at the velocities that are driven cannot give the motion: another velocity has to be driven as
    /// well ([`Constrained::constrained_inverse_dynamics`]).
    Undriven {
        /// The velocity whose equation is violated most.
        velocity: &'static str,
        /// The force that is missing there, N or N·m.
        force: f64,
    },
    /// Constraints depend on each other here that are independent elsewhere: the motion is not determined to
    /// first order.
    Singular,
    /// Friction jams: a normal force that friction depends on does not follow from the motion (Painlevé's
    /// paradox), or is shared by contacts in more than one way.
    Jammed {
        /// The contact.
        constraint: &'static str,
    },
    /// No impulses are found that fulfil the laws of contact: constraints, or what is driven in time, hold
    /// surfaces that approach each other.
    Contact {
        /// The contact whose law is fulfilled least.
        constraint: &'static str,
    },
    /// A coefficient of friction is negative or not finite, or one of restitution not between zero and one.
    Coefficient {
        /// The contact.
        constraint: &'static str,
        /// What the parameters make of it.
        value: f64,
    },
    /// Surfaces overlap that were to be apart.
    Overlap {
        /// The contact whose surfaces overlap most.
        constraint: &'static str,
        /// By how much, m or rad.
        depth: f64,
    },
    /// An index of a velocity to be held is none: `held` counts the velocities from zero.
    Held {
        /// The index.
        index: usize,
        /// How many velocities there are.
        velocities: usize,
    },
    /// Residuals or rates are infinite or NaN there.
    NotFinite,
}

/// The text of `Display`, which `main` prints of an error that it returns.
impl fmt::Debug for ConstraintError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl fmt::Display for ConstraintError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Configuration { constraint, residual } => {
                write!(f, "the constraint `{constraint}` is off by {residual}")
            }
            Self::Velocity { constraint, rate } => {
                write!(f, "the constraint `{constraint}` is left at a rate of {rate}")
            }
            Self::Acceleration { constraint, acceleration } => {
                write!(f, "the constraint `{constraint}` is left at an acceleration of {acceleration}")
            }
            Self::Mode { mode } => {
                write!(
                    f,
                    "no configuration of the assembly mode {mode} was found: give a guess that is nearer to one"
                )
            }
            Self::Undriven { velocity, force } => {
                write!(
                    f,
                    "the driven velocities leave a force of {force} at `{velocity}`, which is not driven"
                )
            }
            Self::Singular => write!(f, "the constraints lose rank in this configuration"),
            Self::Jammed { constraint } => write!(f, "friction jams at the contact `{constraint}`"),
            Self::Contact { constraint } => {
                write!(f, "no impulses at the contact `{constraint}` keep its surfaces apart")
            }
            Self::Coefficient { constraint, value } => write!(
                f,
                "a coefficient of the contact `{constraint}` is {value}: friction is zero or more, restitution between 0 and 1"
            ),
            Self::Overlap { constraint, depth } => {
                write!(f, "the surfaces of the contact `{constraint}` overlap by {depth}")
            }
            Self::Held { index, velocities } => {
                write!(f, "the velocity {index} cannot be held: expected an index below {velocities}")
            }
            Self::NotFinite => write!(f, "the constraints are not finite"),
        }
    }
}

impl core::error::Error for ConstraintError {}

/// Configuration and velocity that fulfil constraints.
pub type Projected<T, const NQ: usize, const NV: usize> = (SVector<T, NQ>, SVector<T, NV>);

/// Accelerations `v̇` and multipliers `λ`.
pub type Solution<T, const NV: usize, const NC: usize> = (SVector<T, NV>, SVector<T, NC>);

/// The constraints on configurations of a mechanism at a time, for assembly.
macro_rules! loops {
    ($mechanism:ident, $t:ident) => {
        Loops {
            names: Self::CONSTRAINTS,
            angles: Self::ANGLES,
            turns: core::array::from_fn(|k| Self::VELOCITY_UNITS.get(k) == Some(&"rad/s")),
            residuals: |q: &_| $mechanism.constraint_residuals($t, q),
            jacobian: |q: &_| $mechanism.constraint_jacobian($t, q),
            integrate: |q: &_, dv: &_| $mechanism.integrate(q, dv),
        }
    };
}

/// What mechanisms with closed loops, rolling or other constraints offer, for generic code.
///
/// There are `NC` scalar constraints, of which the first `NH` restrict configurations (holonomic) and the
/// others velocities alone. `#[mechanism]` implements the trait where joints close loops or constraints are
/// declared. Time `t` is in seconds; mechanisms that do not contain it take any.
///
/// The equations of motion are `M v̇ + h = τ + Jᵀ λ` with `J v̇ + b = 0`: `forward_dynamics` solves both,
/// while the mass matrix, bias forces and inverse dynamics are those of the spanning tree.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no constraints",
    label = "expected a mechanism with constraints",
    note = "joints that close loops and `#[constraint(…)]` make one `Constrained`"
)]
pub trait Constrained<const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>:
    Rheonomic<NQ, NV, NU>
{
    /// Name of every constraint.
    const CONSTRAINTS: [&'static str; NC];

    /// Indices of the entries of `q` that are angles, rad: those of pins and of other coordinates that rotate
    /// something.
    const ANGLES: &'static [usize] = &[];

    /// `φ(t, q)`, m and rad: zero where the constraints hold.
    fn constraint_residuals(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> SVector<Self::Scalar, NH>;

    /// `J(t, q) v + …`, m/s and rad/s: zero where the constraints hold. The first `NH` are the rates of the
    /// residuals.
    fn constraint_rates(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NC>;

    /// `J(t, q)`: how the rates change with the velocities.
    fn constraint_jacobian(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> SMatrix<Self::Scalar, NC, NV>;

    /// `b(t, q, v)`, m/s² and rad/s²: the rates change by `J v̇ + b`.
    fn constraint_bias(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NC>;

    /// `v̇` and the multipliers `λ` under the forces `tau`: N for lengths, N·m for angles. Where constraints
    /// are redundant, the multipliers of least norm.
    fn constrained_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> Solution<Self::Scalar, NV, NC>;

    /// The change of velocity `x` of least kinetic energy that takes `gap` away: `J x = −gap`.
    fn constraint_correction(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        gap: &SVector<Self::Scalar, NC>,
    ) -> SVector<Self::Scalar, NV>;

    /// The change of velocity `x` by the generalized impulse `p`, N·s and N·m·s, and by impulses of the
    /// constraints that take `gap` away: `M x = p + Jᵀ λ`, `J x = −gap`. Dry friction of contacts that slip
    /// is left out.
    fn constraint_response(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        p: &SVector<Self::Scalar, NV>,
        gap: &SVector<Self::Scalar, NC>,
    ) -> SVector<Self::Scalar, NV>;

    /// [`Mechanism::acceleration_derivatives`](crate::Mechanism::acceleration_derivatives) of the mechanism
    /// [`stabilized`], with violations that decay at `rate`, 1/s; `None` without [`ConstrainedDerivatives`].
    fn stabilized_derivatives(
        &self,
        _t: Self::Scalar,
        _state: (&SVector<Self::Scalar, NQ>, &SVector<Self::Scalar, NV>),
        _u: &SVector<Self::Scalar, NU>,
        _rate: Self::Scalar,
    ) -> Option<ByMotion<Self::Scalar, NV, NU>> {
        None
    }

    /// [`Mechanism::impulse`](crate::Mechanism::impulse) of a mechanism with constraints. Those on
    /// configurations are looked at where `v` leads in `h` seconds, those on velocities half-way there (a
    /// discrete constraint that reads the same forwards and backwards: McLachlan and Perlmutter, *Integrators
    /// for nonholonomic mechanical systems*, J. Nonlinear Sci. 16, 2006).
    fn constrained_impulse(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        h: Self::Scalar,
        p: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        let half = h * constant(0.5);
        let way = crate::speeds::way_of(self, q, v, half);
        let within = if NC > NH { self.integrate(q, &way) } else { *q };
        let mut gap = if NC > NH || h == nalgebra::zero() {
            self.constraint_rates(t + half, &within, v)
        } else {
            SVector::zeros()
        };
        if h != nalgebra::zero() {
            let residuals =
                self.constraint_residuals(t + h, &self.integrate(q, &(way * constant::<Self::Scalar>(2.0))));
            gap.iter_mut().zip(residuals.iter()).for_each(|(gap, residual)| *gap = *residual / h);
        }
        self.constraint_response(t, q, p, &gap)
    }

    /// Returns a configuration near `q` in which the constraints hold, by damped Newton steps of bounded
    /// length and number (Levenberg–Marquardt: Nocedal and Wright, *Numerical Optimization*, 2006, § 10.3),
    /// starting from `q` and, if that fails, from points around it. The coordinates whose velocities have the
    /// indices `held` keep their values. Angles are found within half a turn of `q`, unless the constraints
    /// rotate them farther, as gears do.
    ///
    /// Most linkages can be assembled in several ways. The result is usually in the mode next to `q`:
    /// [`assembly_mode`](Self::assembly_mode) returns the mode, [`assemble_in_mode`](Self::assemble_in_mode)
    /// finds another one.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Configuration`] where none is found, [`ConstraintError::Held`] for an index that is
    /// none.
    fn assemble(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        held: &[usize],
    ) -> Result<SVector<Self::Scalar, NQ>, ConstraintError> {
        assemble(&loops!(self, t), q, held, None)
    }

    /// A configuration around `q` in which the constraints hold, as [`assemble`](Self::assemble) finds it, of
    /// the given [`assembly_mode`](Self::assembly_mode).
    ///
    /// # Errors
    ///
    /// Those of [`assemble`](Self::assemble), and [`ConstraintError::Mode`] where only others are found.
    fn assemble_in_mode(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        held: &[usize],
        mode: i8,
    ) -> Result<SVector<Self::Scalar, NQ>, ConstraintError> {
        assemble(&loops!(self, t), q, held, Some(mode))
    }

    /// The assembly mode of the configuration `q`, 1 or −1: the sign of the determinant of the derivatives of
    /// the constraints on configurations by the coordinates whose velocities are not `held`. It changes only
    /// in singular positions, where the coordinates that are held no longer determine the others to first
    /// order. The two modes of a four-bar with a given crank, open and crossed, have different signs;
    /// linkages of several loops may have more modes than two, of which some share a sign.
    ///
    /// `None` in a singular position, and where the coordinates that are not held are more or fewer than the
    /// constraints on configurations.
    fn assembly_mode(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>, held: &[usize]) -> Option<i8> {
        assembly_mode(&loops!(self, t), q, held)
    }

    /// The configuration nearest to `q` that fulfils the constraints, in the metric of the kinetic energy.
    /// For what has drifted; [`assemble`](Self::assemble) comes from farther away.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Configuration`] where Newton's method does not converge.
    fn project_configuration(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> Result<SVector<Self::Scalar, NQ>, ConstraintError> {
        let mut q = *q;
        let mut last = None;
        for _ in 0..MOST_STEPS {
            let residuals = self.constraint_residuals(t, &q);
            let (worst, size) = largest(&residuals)?;
            // A drift that is let be is another linkage, which may have no singular position where this one
            // has it.
            let enough = if last.is_none() { known(&q) } else { rounding(&q) };
            if size <= enough {
                return Ok(q);
            }
            // Rounding ends the convergence.
            if last.is_some_and(|last| size * constant(2.0) > last) {
                return near(size, &q).then_some(q).ok_or_else(|| off(Self::CONSTRAINTS, worst, size));
            }
            last = Some(size);
            let gap = SVector::from_fn(|k, _| residuals.get(k).copied().unwrap_or(nalgebra::zero()));
            q = self.integrate(&q, &self.constraint_correction(t, &q, &gap));
        }
        let (worst, size) = largest(&self.constraint_residuals(t, &q))?;
        near(size, &q).then_some(q).ok_or_else(|| off(Self::CONSTRAINTS, worst, size))
    }

    /// The velocity nearest to `v` that fulfils the constraints, in the metric of the kinetic energy.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Velocity`] where none does.
    fn project_velocity(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        let mut v = *v;
        // The second correction takes away what the first one may leave where constraints nearly depend on
        // each other.
        for enough in [epsilon::<Self::Scalar>() * reach(&v), rounding(&v)] {
            let rates = self.constraint_rates(t, q, &v);
            if largest(&rates)?.1 <= enough {
                return Ok(v);
            }
            // Beside the speed, so that what counts as rounding is told from what does not.
            let unit = reach(&v);
            v += self.constraint_correction(t, q, &(rates / unit)) * unit;
        }
        let (worst, size) = largest(&self.constraint_rates(t, q, &v))?;
        if near(size, &v) {
            return Ok(v);
        }
        // Beside a branch, near a singular position, the constraints have other directions than on it.
        let left = self.constraint_residuals(t, q);
        let farthest = farthest(&self.constraint_jacobian(t, q));
        if near(largest(&left)?.1, q) && size <= careful::turned(&left) * farthest * reach(&v) {
            return Ok(v);
        }
        let constraint = Self::CONSTRAINTS.get(worst).copied().unwrap_or_default();
        Err(ConstraintError::Velocity { constraint, rate: to_f64(size) })
    }

    /// The velocity whose entries `held` (indices) are those of `v`, while the others follow from the
    /// constraints: `J v + … = 0`, [`constraint_rates`](Self::constraint_rates). m/s and rad/s. What the
    /// constraints leave open is nearest to `v` in the metric of the kinetic energy; with nothing held the
    /// whole is, as by [`project_velocity`](Self::project_velocity).
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Velocity`] where the held entries contradict the constraints or nothing finite
    /// follows from them (a piston that is to move while its crank is in line with the rod),
    /// [`ConstraintError::Held`] for an index that is none.
    fn complete_velocity(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        held: &[usize],
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        complete::complete(self, t, q, v, held)
    }

    /// The acceleration whose entries `held` (indices) are those of `a`, while the others follow from the
    /// constraints: `J a + b = 0`, m/s² and rad/s². What the constraints leave open is nearest to `a` in the
    /// metric of the kinetic energy.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Acceleration`] if the held entries contradict the constraints or nothing finite
    /// follows from them, [`ConstraintError::Held`] for an index that is not less than `NV`.
    fn complete_acceleration(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        held: &[usize],
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        complete::complete_acceleration(self, t, (q, v), a, held)
    }

    /// Returns the generalized forces `τ` (N and N·m) of drives at the velocities with the indices `driven`,
    /// zero elsewhere, and the multipliers `λ` of the constraints, for a motion that fulfils the constraints:
    /// `M a + h = τ + Jᵀ λ` (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 8). Usually as many
    /// velocities are driven as there are degrees of freedom, and none if the constraints drive the mechanism
    /// themselves: the drives are then in `λ`. If constraints are redundant or more velocities are driven,
    /// the multipliers have the least norm. Dry friction of slipping contacts is left out.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Velocity`] and [`ConstraintError::Acceleration`] for a motion that violates the
    /// constraints, [`ConstraintError::Undriven`] if forces at other velocities would be needed,
    /// [`ConstraintError::Held`] for an index that is not less than `NV`.
    fn constrained_inverse_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        driven: &[usize],
    ) -> Result<Solution<Self::Scalar, NV, NC>, ConstraintError> {
        complete::drive(self, t, (q, v), a, driven)
    }

    /// Both: configuration first.
    ///
    /// Where constraints have two branches that cross, a state within rounding of the crossing, which fulfils
    /// the rates of both alike, keeps its velocity: it tells the branch that the state is on, when the
    /// configuration no longer does.
    ///
    /// # Errors
    ///
    /// Those of the two.
    fn project_state(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Result<Projected<Self::Scalar, NQ, NV>, ConstraintError> {
        let q = self.project_configuration(t, q)?;
        let found = self.project_velocity(t, &q, v)?;
        let speed = largest(v)?.1;
        if largest(&(found - v))?.1 > speed * constant(TURN) {
            let rate = largest(&self.constraint_rates(t, &q, v))?.1;
            if open(rate, v) && self.is_nearly_singular(t, &q, &SVector::zeros()) {
                return Ok((q, *v));
            }
        }
        Ok((q, found))
    }
}

/// Index and magnitude of the largest entry.
fn largest<T: Real, const N: usize>(x: &SVector<T, N>) -> Result<(usize, T), ConstraintError> {
    let mut found = (0, T::zero());
    for (k, x) in x.iter().enumerate() {
        if !x.is_finite() {
            return Err(ConstraintError::NotFinite);
        }
        if x.abs() > found.1 {
            found = (k, x.abs());
        }
    }
    Ok(found)
}

/// The largest magnitude, at least one.
fn reach<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    x.iter().fold(T::one(), |reach, x| reach.max(x.abs()))
}

/// Roundings of a number that are left of constraints which are fulfilled.
const ROUNDINGS: f64 = 16.0;

/// What is left of constraints that are fulfilled as well as the numbers allow.
fn rounding<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    constant::<T>(ROUNDINGS) * epsilon() * reach(x)
}

/// What rounding of the numbers alone makes of constraints: angles of many turns are known less well than the
/// rest.
fn known<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    epsilon::<T>() * reach(x).max(constant(ROUNDINGS))
}

/// Whether what is left of constraints can be borne: half of the digits where they lose rank.
fn near<T: Real, const N: usize>(size: T, x: &SVector<T, N>) -> bool {
    size <= epsilon::<T>().sqrt() * reach(x)
}

/// Whether the rate of a constraint is so small that its direction may be that of either of two branches
/// which cross.
fn open<T: Real, const N: usize>(rate: T, v: &SVector<T, N>) -> bool {
    rate <= epsilon::<T>().sqrt().sqrt() * v.iter().fold(T::zero(), |most, v| most.max(v.abs()))
}

/// The farthest that a velocity of one moves what a constraint holds, at least one.
fn farthest<T: Real, const NC: usize, const NV: usize>(jacobian: &SMatrix<T, NC, NV>) -> T {
    jacobian
        .column_iter()
        .fold(T::one(), |most, column| column.iter().fold(most, |most, j| most.max(j.abs())))
}

fn off<T: Real, const NC: usize>(names: [&'static str; NC], worst: usize, size: T) -> ConstraintError {
    let constraint = names.get(worst).copied().unwrap_or_default();
    ConstraintError::Configuration { constraint, residual: to_f64(size) }
}
