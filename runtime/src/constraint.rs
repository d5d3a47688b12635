//! Constrained mechanisms: closed loops, rolling and other constraints ([guide](crate::guide::constraints)).
//!
//! The coordinates are those of the spanning tree and are not independent. A state `(q, v)` satisfies the
//! constraints if the residuals `φ(t, q)` and the rates `J(t, q) v + …` are zero. [`Constrained::assemble`]
//! finds a configuration near a guess, [`Constrained::complete_velocity`] the velocity with prescribed
//! entries, and [`Constrained::project_velocity`] the nearest velocity. [`simulate`](crate::simulate()) keeps
//! the state on the constraints by projection, or lets violations decay if the mechanism is [`stabilized`].

use crate::private::{constant, epsilon, to_f64};
use crate::{ByMotion, Mechanism, Real};
use nalgebra::{SMatrix, SVector};

mod assemble;
mod careful;
mod complete;
mod differentiable;
mod error;
mod graded;
mod layout;
mod linearize;
mod second;
mod slipping;
mod solve;
mod span;
mod stabilized;

#[doc(hidden)]
pub use assemble::{Loops, assemble, assembly_mode, least_violation};
pub use careful::{Structure, careful_response, nearly_singular, rank_revealing_dynamics};
pub use differentiable::{ConstrainedDerivatives, EquationDerivatives, MultiplierDerivatives, Visitor};
pub(crate) use differentiable::{
    FrozenTimeVisitor, column_or_zeros, matrix_from_column_function, multipliers_from_constraint_forces,
    set_column,
};
pub use error::ConstraintError;
pub(crate) use graded::velocity_change_and_impulses;
#[doc(hidden)]
pub use layout::{ConstraintCurvature, Elimination, InputDerivatives, MotionDerivatives, Responses};
pub use linearize::Linearization;
#[doc(hidden)]
pub use linearize::{Motion, constrained_derivatives};
pub use second::{ConstrainedSecondDerivatives, CurvatureVisitor, EquationSecondDerivatives};
pub(crate) use second::{FrozenTimeCurvatureVisitor, adjoint_variables, plus_matrix_and_transpose};
#[doc(hidden)]
pub use second::{constrained_second_derivatives, with_curvature};
#[doc(hidden)]
pub use slipping::{pressing_solution, slipping_response, slipping_solution};
#[doc(hidden)]
pub use solve::{least_solution, regular_solution, solution_with_predetermined_pivots};
#[doc(hidden)]
pub use stabilized::stabilized_derivatives;
pub use stabilized::{Stabilized, stabilized};

/// Relative change of velocity above which a projection may have switched to another branch.
const TURN: f64 = 0.01;

/// Maximum number of Newton steps when a state is projected onto the constraints; a state that has drifted
/// needs one or two.
const MOST_STEPS: usize = 20;

/// Configuration and velocity after projection onto the constraints.
pub type Projected<T, const NQ: usize, const NV: usize> = (SVector<T, NQ>, SVector<T, NV>);

/// Accelerations `v̇` and constraint multipliers `λ`.
pub type Solution<T, const NV: usize, const NC: usize> = (SVector<T, NV>, SVector<T, NC>);

/// Returns the holonomic constraints of a mechanism at an instant, as input of the assembly.
macro_rules! loops {
    ($mechanism:ident, $t:ident) => {
        Loops {
            names: Self::CONSTRAINTS,
            angles: $mechanism.angles(),
            turns: $mechanism.rotations(),
            sizes: [$mechanism.holonomic(), $mechanism.features().dimensions[1]],
            residuals: |q: &_| $mechanism.constraint_residuals($t, q),
            jacobian: |q: &_| $mechanism.constraint_jacobian($t, q),
            integrate: |q: &_, dv: &_| $mechanism.integrate(q, dv),
        }
    };
}

/// Functions of mechanisms with closed loops, rolling or other constraints, for generic code.
///
/// There are `NC` scalar constraints. The first `NH` restrict configurations (holonomic constraints), the
/// others restrict only velocities. `#[mechanism]` implements the trait if joints close loops or constraints
/// are declared. Time `t` is in seconds; mechanisms that do not depend on time accept any value.
///
/// The equations of motion are `M v̇ + h = τ + Jᵀ λ` and `J v̇ + b = 0`. `forward_dynamics` solves both. The
/// mass matrix, bias forces and inverse dynamics are those of the spanning tree.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no constraints",
    label = "expected a mechanism with constraints",
    note = "joints that close loops and `#[constraint(…)]` make one `Constrained`"
)]
pub trait Constrained<const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>:
    Mechanism<NQ, NV, NU>
{
    /// Names of the scalar constraints.
    const CONSTRAINTS: [&'static str; NC];

    /// Indices of the entries of `q` that are angles, rad: coordinates of pins and of other rotations.
    const ANGLES: &'static [usize] = &[];

    /// Returns the number of constraints that restrict configurations: `NH`, unless the mechanism is loaded
    /// at run time and further rows are padding.
    #[doc(hidden)]
    #[inline(always)]
    fn holonomic(&self) -> usize {
        NH
    }

    /// Returns the indices of angles in `q`: [`ANGLES`](Self::ANGLES), unless the mechanism is loaded at run
    /// time and has its own list.
    #[doc(hidden)]
    #[inline(always)]
    fn angles(&self) -> &[usize] {
        Self::ANGLES
    }

    /// Returns true for each velocity that is the rate of a rotation.
    #[doc(hidden)]
    #[inline(always)]
    fn rotations(&self) -> [bool; NV] {
        core::array::from_fn(|k| Self::VELOCITY_UNITS.get(k) == Some(&"rad/s"))
    }

    /// Returns the residuals `φ(t, q)`, m and rad, which are zero if the constraints are satisfied.
    fn constraint_residuals(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> SVector<Self::Scalar, NH>;

    /// Returns the constraint rates `J(t, q) v + …`, m/s and rad/s, which are zero if the constraints are
    /// satisfied. The first `NH` are the rates of the residuals.
    fn constraint_rates(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NC>;

    /// Returns the constraint Jacobian `J(t, q)`: the derivatives of the rates with respect to the
    /// velocities.
    fn constraint_jacobian(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> SMatrix<Self::Scalar, NC, NV>;

    /// Returns the bias `b(t, q, v)`, m/s² and rad/s², of the rates' time derivatives `J v̇ + b`.
    fn constraint_bias(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NC>;

    /// Returns `v̇` and the multipliers `λ` for the forces `tau`. Multipliers are in N for lengths and in N·m
    /// for angles. If constraints are redundant, the multipliers have minimum norm.
    fn constrained_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> Solution<Self::Scalar, NV, NC>;

    /// Returns the velocity change `x` with minimum kinetic energy that removes `gap`: `J x = −gap`.
    fn constraint_correction(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        gap: &SVector<Self::Scalar, NC>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the velocity change `x` due to the generalized impulse `p` (N·s and N·m·s) and to impulses of
    /// the constraints that remove `gap`: `M x = p + Jᵀ λ`, `J x = −gap`. Dry friction of sliding contacts is
    /// neglected.
    fn constraint_response(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        p: &SVector<Self::Scalar, NV>,
        gap: &SVector<Self::Scalar, NC>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns [`acceleration_derivatives`](crate::integrate::Hooks::acceleration_derivatives) of the
    /// mechanism [`stabilized`] with the decay rate `rate`, 1/s; `None` without [`ConstrainedDerivatives`].
    fn stabilized_derivatives(
        &self,
        _t: Self::Scalar,
        _state: (&SVector<Self::Scalar, NQ>, &SVector<Self::Scalar, NV>),
        _u: &SVector<Self::Scalar, NU>,
        _rate: Self::Scalar,
    ) -> Option<ByMotion<Self::Scalar, NV, NU>> {
        None
    }

    /// Returns [`velocity_change_by_impulse`](crate::integrate::Hooks::velocity_change_by_impulse) of a
    /// mechanism with constraints. Holonomic constraints are evaluated at the configuration that `v` reaches
    /// in `h` seconds, velocity constraints half-way to it (a discrete constraint that is symmetric in time:
    /// McLachlan and Perlmutter, *Integrators for nonholonomic mechanical systems*, J. Nonlinear Sci. 16,
    /// 2006).
    fn constrained_impulse(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        h: Self::Scalar,
        p: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        let half = h * constant(0.5);
        let way = crate::speeds::mechanism_displacement_given_final_velocity(self, q, v, half);
        let holonomic = self.holonomic();
        let within = if NC > holonomic { self.integrate(q, &way) } else { *q };
        let mut gap = if NC > holonomic || h == nalgebra::zero() {
            self.constraint_rates(t + half, &within, v)
        } else {
            SVector::zeros()
        };
        if h != nalgebra::zero() {
            let residuals =
                self.constraint_residuals(t + h, &self.integrate(q, &(way * constant::<Self::Scalar>(2.0))));
            gap.iter_mut()
                .zip(residuals.iter())
                .take(holonomic)
                .for_each(|(gap, residual)| *gap = *residual / h);
        }
        self.constraint_response(t, q, p, &gap)
    }

    /// Returns a configuration near `q` that satisfies the constraints. The method uses damped Newton steps
    /// of bounded length and number (Levenberg–Marquardt: Nocedal and Wright, *Numerical Optimization*, 2006,
    /// § 10.3), starting from `q` and, if that fails, from points around it. Coordinates whose velocities
    /// have the indices `held` do not change. Angles are within half a revolution of `q`, unless the
    /// constraints require larger rotations, as gears do.
    ///
    /// Most linkages have several assembly modes. The result is usually in the mode nearest to `q`:
    /// [`assembly_mode`](Self::assembly_mode) returns the mode, [`assemble_in_mode`](Self::assemble_in_mode)
    /// finds another one.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Configuration`] if no configuration is found, [`ConstraintError::Held`] for an
    /// index that is not less than `NV`.
    fn assemble(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        held: &[usize],
    ) -> Result<SVector<Self::Scalar, NQ>, ConstraintError> {
        assemble(&loops!(self, t), q, held, None)
    }

    /// Returns a configuration near `q` that satisfies the constraints and has the assembly mode `mode`, see
    /// [`assemble`](Self::assemble) and [`assembly_mode`](Self::assembly_mode).
    ///
    /// # Errors
    ///
    /// The errors of [`assemble`](Self::assemble), and [`ConstraintError::Mode`] if only configurations of
    /// other modes are found.
    fn assemble_in_mode(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        held: &[usize],
        mode: i8,
    ) -> Result<SVector<Self::Scalar, NQ>, ConstraintError> {
        assemble(&loops!(self, t), q, held, Some(mode))
    }

    /// Returns the assembly mode of the configuration `q`, 1 or −1: the sign of the determinant of the
    /// derivatives of the holonomic constraints with respect to the coordinates whose velocities are not
    /// `held`. The mode changes only in singular configurations, in which the coordinates `held` do not
    /// determine the others to first order. The two modes of a four-bar linkage with a fixed crank, open and
    /// crossed, have different signs. Linkages with several loops may have more than two modes, some of which
    /// share a sign.
    ///
    /// Returns `None` in a singular configuration, and if the number of coordinates that are not held differs
    /// from the number of holonomic constraints.
    fn assembly_mode(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>, held: &[usize]) -> Option<i8> {
        assembly_mode(&loops!(self, t), q, held)
    }

    /// Returns the configuration nearest to `q`, in the metric of the kinetic energy, that satisfies the
    /// constraints. This corrects numeric drift; [`assemble`](Self::assemble) converges from a larger
    /// distance.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Configuration`] if Newton's method does not converge.
    fn project_configuration(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> Result<SVector<Self::Scalar, NQ>, ConstraintError> {
        let mut q = *q;
        let mut last = None;
        for _ in 0..MOST_STEPS {
            let residuals = self.constraint_residuals(t, &q);
            let (worst, size) = largest_entry(&residuals)?;
            // The first check is strict: a configuration with uncorrected drift belongs to a slightly
            // different linkage, which may have no singular configuration near that of the mechanism.
            let enough = if last.is_none() { rounding_of_coordinates(&q) } else { acceptable_residual(&q) };
            if size <= enough {
                return Ok(q);
            }
            // Convergence ends at rounding errors.
            if last.is_some_and(|last| size * constant(2.0) > last) {
                return is_residual_acceptable(size, &q)
                    .then_some(q)
                    .ok_or_else(|| unsatisfied_configuration_error(Self::CONSTRAINTS, worst, size));
            }
            last = Some(size);
            let gap = SVector::from_fn(|k, _| residuals.get(k).copied().unwrap_or(nalgebra::zero()));
            q = self.integrate(&q, &self.constraint_correction(t, &q, &gap));
        }
        let (worst, size) = largest_entry(&self.constraint_residuals(t, &q))?;
        is_residual_acceptable(size, &q)
            .then_some(q)
            .ok_or_else(|| unsatisfied_configuration_error(Self::CONSTRAINTS, worst, size))
    }

    /// Returns the velocity nearest to `v`, in the metric of the kinetic energy, that satisfies the
    /// constraints.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Velocity`] if no velocity satisfies them.
    fn project_velocity(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        let mut v = *v;
        // The second correction removes the residual of the first one, which is large if constraints are
        // nearly dependent.
        for enough in [epsilon::<Self::Scalar>() * largest_magnitude_or_one(&v), acceptable_residual(&v)] {
            let rates = self.constraint_rates(t, q, &v);
            if largest_entry(&rates)?.1 <= enough {
                return Ok(v);
            }
            // Relative to the speed, so that rounding errors can be distinguished from velocities.
            let unit = largest_magnitude_or_one(&v);
            v += self.constraint_correction(t, q, &(rates / unit)) * unit;
        }
        let (worst, size) = largest_entry(&self.constraint_rates(t, q, &v))?;
        if is_residual_acceptable(size, &v) {
            return Ok(v);
        }
        // Off a branch, near a singular configuration, the constraints have other directions than on the
        // branch.
        let left = self.constraint_residuals(t, q);
        let farthest = largest_jacobian_entry_or_one(&self.constraint_jacobian(t, q));
        if is_residual_acceptable(largest_entry(&left)?.1, q)
            && size
                <= careful::minimum_reliable_row_magnitude(&left) * farthest * largest_magnitude_or_one(&v)
        {
            return Ok(v);
        }
        let constraint = Self::CONSTRAINTS.get(worst).copied().unwrap_or_default();
        Err(ConstraintError::Velocity { constraint, rate: to_f64(size) })
    }

    /// Returns the velocity with the entries `held` (indices) of `v`. The other entries follow from the
    /// constraints `J v + … = 0`, [`constraint_rates`](Self::constraint_rates), in m/s and rad/s. Entries
    /// that the constraints do not determine are those nearest to `v` in the metric of the kinetic energy.
    /// With no entries held, the result equals that of [`project_velocity`](Self::project_velocity).
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Velocity`] if the held entries contradict the constraints or require infinite
    /// velocities (a moving piston whose crank is in line with the rod), [`ConstraintError::Held`] for an
    /// index that is not less than `NV`.
    fn complete_velocity(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        held: &[usize],
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        complete::completed_velocity(self, t, q, v, held)
    }

    /// Returns the acceleration with the entries `held` (indices) of `a`. The other entries follow from the
    /// constraints `J a + b = 0`, in m/s² and rad/s². Entries that the constraints do not determine are those
    /// nearest to `a` in the metric of the kinetic energy.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Acceleration`] if the held entries contradict the constraints or require infinite
    /// accelerations, [`ConstraintError::Held`] for an index that is not less than `NV`.
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
    /// zero elsewhere, and the multipliers `λ` of the constraints, for a motion that satisfies the
    /// constraints: `M a + h = τ + Jᵀ λ` (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 8).
    /// Usually the number of driven velocities equals the number of degrees of freedom; it is zero if the
    /// constraints themselves drive the mechanism, whose forces are then part of `λ`. If constraints are
    /// redundant or more velocities are driven, the multipliers have minimum norm. Dry friction of sliding
    /// contacts is neglected.
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
        complete::driving_forces(self, t, (q, v), a, driven)
    }

    /// Returns the state projected onto the constraints: the configuration first, then the velocity.
    ///
    /// Near a crossing of two branches of the constraints, a state within rounding errors of the crossing
    /// keeps its velocity if it satisfies the rates of both branches. The velocity identifies the branch of
    /// the state when the configuration no longer does.
    ///
    /// # Errors
    ///
    /// The errors of [`project_configuration`](Self::project_configuration) and
    /// [`project_velocity`](Self::project_velocity).
    fn project_state(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Result<Projected<Self::Scalar, NQ, NV>, ConstraintError> {
        let q = self.project_configuration(t, q)?;
        let found = self.project_velocity(t, &q, v)?;
        let speed = largest_entry(v)?.1;
        if largest_entry(&(found - v))?.1 > speed * constant(TURN) {
            let rate = largest_entry(&self.constraint_rates(t, &q, v))?.1;
            if is_near_branch_crossing(rate, v) && self.is_nearly_singular(t, &q, &SVector::zeros()) {
                return Ok((q, *v));
            }
        }
        Ok((q, found))
    }
}

/// Returns the index and the magnitude of the largest entry of a vector.
fn largest_entry<T: Real, const N: usize>(x: &SVector<T, N>) -> Result<(usize, T), ConstraintError> {
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

/// Returns the largest magnitude of the entries of a vector, but at least one.
fn largest_magnitude_or_one<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    x.iter().fold(T::one(), |reach, x| reach.max(x.abs()))
}

/// Residual of satisfied constraints, in units of the rounding error of the coordinates.
const ROUNDINGS: f64 = 16.0;

/// Returns the residual of constraints that are satisfied as accurately as floating-point numbers permit.
fn acceptable_residual<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    constant::<T>(ROUNDINGS) * epsilon() * largest_magnitude_or_one(x)
}

/// Returns the residual that rounding of the coordinates alone causes. Angles of many revolutions have larger
/// rounding errors than other coordinates.
fn rounding_of_coordinates<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    epsilon::<T>() * largest_magnitude_or_one(x).max(constant(ROUNDINGS))
}

/// Returns whether a residual is acceptable: half of the digits, which is the accuracy where constraints lose
/// rank.
fn is_residual_acceptable<T: Real, const N: usize>(size: T, x: &SVector<T, N>) -> bool {
    size <= epsilon::<T>().sqrt() * largest_magnitude_or_one(x)
}

/// Returns whether a constraint rate is so small that the velocity may belong to either of two crossing
/// branches.
fn is_near_branch_crossing<T: Real, const N: usize>(rate: T, v: &SVector<T, N>) -> bool {
    rate <= epsilon::<T>().sqrt().sqrt() * v.iter().fold(T::zero(), |most, v| most.max(v.abs()))
}

/// Returns the largest magnitude of the entries of the Jacobian, but at least one.
fn largest_jacobian_entry_or_one<T: Real, const NC: usize, const NV: usize>(
    jacobian: &SMatrix<T, NC, NV>,
) -> T {
    jacobian
        .column_iter()
        .fold(T::one(), |most, column| column.iter().fold(most, |most, j| most.max(j.abs())))
}

fn unsatisfied_configuration_error<T: Real, const NC: usize>(
    names: [&'static str; NC],
    worst: usize,
    size: T,
) -> ConstraintError {
    let constraint = names.get(worst).copied().unwrap_or_default();
    ConstraintError::Configuration { constraint, residual: to_f64(size) }
}
