//! Stabilization of constraints by feedback instead of projection.

use super::differentiable::{
    column_or_zeros, matrix_from_column_function, multipliers_from_constraint_forces,
};
use super::{Constrained, ConstrainedDerivatives, ConstraintError, Projected};
use crate::derivatives::{ByMotion, Derivatives, convert_to_input_derivatives};
use crate::forward::{constants, each_function};
use crate::integrate::{Features, Hooks};
use crate::private::constant;
use crate::{Mechanism, Real};
use nalgebra::{SMatrix, SVector};

/// Mechanism whose constraint violations decay exponentially.
///
/// Uses Baumgarte's stabilization `φ̈ + 2 α φ̇ + α² φ = 0` (Baumgarte, *Stabilization of constraints and
/// integrals of motion in dynamical systems*, Comp. Meth. Appl. Mech. Eng. 1, 1972). Integrators do not
/// project the state, whether or not it satisfies the constraints, so the violation is small but not zero.
/// The option `derivatives` also provides the derivatives of this motion. Its linear system has the double
/// eigenvalue `−α` for each holonomic constraint, and the eigenvalue `−2 α` for each velocity constraint.
///
/// ```
/// # use linkwork::prelude::*;
/// # #[mechanism]
/// # struct Pendulum {
/// #     px: Coordinate,
/// #     py: Coordinate,
/// #     #[particle(mass = 1, at = px * x + py * y)]
/// #     bob: Particle,
/// #     #[constraint(norm(r(bob / ground)) = 1)]
/// #     rod: Holonomic,
/// # }
/// # fn main() -> Result<(), Error> {
/// # let pendulum = Pendulum {};
/// let steady = linkwork::constraint::stabilized(&pendulum, 20.0);
/// let end = simulate(&steady).from([1.001, 0.0], [0.0, 2.0]).duration(2.0).finish()?;
/// assert!((end.q.norm() - 1.0).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Stabilized<'m, M, T, const NH: usize, const NC: usize> {
    mechanism: &'m M,
    rate: T,
}

/// Returns the mechanism with constraint violations that decay at `rate`, 1/s. Use a few times the fastest
/// rate of the motion.
pub fn stabilized<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(
    mechanism: &M,
    rate: M::Scalar,
) -> Stabilized<'_, M, M::Scalar, NH, NC>
where
    M: Constrained<NQ, NV, NU, NH, NC>,
{
    Stabilized { mechanism, rate }
}

impl<M, T: Real, const NH: usize, const NC: usize> Stabilized<'_, M, T, NH, NC> {
    /// Returns the acceleration that stabilisation adds so that constraint violations decay.
    fn stabilization_acceleration<const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> SVector<T, NV>
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        self.mechanism.constraint_correction(t, q, &stabilization_terms(self.mechanism, self.rate, t, q, v))
    }
}

/// Returns the stabilisation term `2 α φ̇ + α² φ` of each constraint, with decay rate `α` and residual `φ`.
/// Velocity constraints have only the first term.
fn stabilization_terms<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    rate: M::Scalar,
    t: M::Scalar,
    q: &SVector<M::Scalar, NQ>,
    v: &SVector<M::Scalar, NV>,
) -> SVector<M::Scalar, NC>
where
    M: Constrained<NQ, NV, NU, NH, NC>,
{
    let residuals = m.constraint_residuals(t, q) * (rate * rate);
    let mut gap = m.constraint_rates(t, q, v) * (rate * constant(2.0));
    gap.iter_mut().zip(residuals.iter()).for_each(|(gap, residual)| *gap += *residual);
    gap
}

/// Returns the accelerations for the forces `tau` and violations that decay at `rate`, with their
/// derivatives. With these accelerations and multipliers, `M δv̇ − Jᵀ δλ = δτ − ∂(M a + h − Jᵀ λ)` and `J δv̇
/// = −∂(J a + b + 2 α φ̇ + α² φ)`.
fn stabilized_motion_derivatives<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    rate: M::Scalar,
    t: M::Scalar,
    (q, v): (&SVector<M::Scalar, NQ>, &SVector<M::Scalar, NV>),
    tau: &SVector<M::Scalar, NV>,
) -> (SVector<M::Scalar, NV>, ByMotion<M::Scalar, NV, NV>)
where
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC>,
{
    let correction = m.constraint_correction(t, q, &stabilization_terms(m, rate, t, q, v));
    let (a, lambda) = m.constrained_dynamics(t, q, v, tau);
    let (a, lambda) = (
        a + correction,
        lambda + multipliers_from_constraint_forces(m, t, q, &(m.mass_matrix(t, q) * correction)),
    );
    let parts = m.equation_derivatives(t, q, v, &a, &lambda);
    let gap_by_v = m.constraint_jacobian(t, q) * (rate * constant(2.0));
    let mut gap_by_q = parts.rates_by_q * (rate * constant(2.0));
    for (mut row, of_rate) in gap_by_q.row_iter_mut().zip(gap_by_v.row_iter()).take(NH) {
        row += of_rate * (rate * constant(0.5));
    }
    let constraint_response_columns =
        |forces: &SMatrix<M::Scalar, NV, NV>, gaps: &SMatrix<M::Scalar, NC, NV>| {
            matrix_from_column_function(|j| {
                m.constraint_response(t, q, &-column_or_zeros(forces, j), &column_or_zeros(gaps, j))
            })
        };
    let by_q = constraint_response_columns(&parts.forces_by_q, &(parts.accelerations_by_q + gap_by_q));
    let by_v = constraint_response_columns(&parts.forces_by_v, &(parts.accelerations_by_v + gap_by_v));
    (a, (by_q, by_v, constraint_response_columns(&-SMatrix::identity(), &SMatrix::zeros())))
}

/// Computes [`Constrained::stabilized_derivatives`] for mechanisms with derivatives.
pub fn stabilized_derivatives<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    t: M::Scalar,
    (q, v): (&SVector<M::Scalar, NQ>, &SVector<M::Scalar, NV>),
    u: &SVector<M::Scalar, NU>,
    rate: M::Scalar,
) -> Option<ByMotion<M::Scalar, NV, NU>>
where
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC>,
{
    let tau = m.generalized_forces(t, q, v, u);
    let (_, by_force) = stabilized_motion_derivatives(m, rate, t, (q, v), &tau);
    Some(convert_to_input_derivatives(by_force, &m.generalized_forces_derivatives(t, q, v, u)))
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    Mechanism<NQ, NV, NU> for Stabilized<'_, M, M::Scalar, NH, NC>
where
    M: Constrained<NQ, NV, NU, NH, NC>,
{
    type Scalar = M::Scalar;
    constants!(names, M);

    each_function!(space, plain Mechanism, self => self.mechanism);
    each_function!(dynamics, pass Mechanism, self => self.mechanism);

    fn forward_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        tau: &SVector<M::Scalar, NV>,
    ) -> SVector<M::Scalar, NV> {
        self.mechanism.forward_dynamics(t, q, v, tau) + self.stabilization_acceleration(t, q, v)
    }

    fn try_forward_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        tau: &SVector<M::Scalar, NV>,
    ) -> Result<SVector<M::Scalar, NV>, ConstraintError> {
        Ok(self.mechanism.try_forward_dynamics(t, q, v, tau)? + self.stabilization_acceleration(t, q, v))
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    Hooks<M::Scalar, NQ, NV, NU> for Stabilized<'_, M, M::Scalar, NH, NC>
where
    M: Constrained<NQ, NV, NU, NH, NC>,
{
    const FEEDBACK: bool = true;
    const CONTACTING: bool = M::CONTACTING;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = M::FIRST_ORDER;
    const SPEEDS: bool = M::SPEEDS;

    #[inline(always)]
    fn features(&self) -> Features {
        Features { constrained: false, slipping: false, feedback: true, ..self.mechanism.features() }
    }

    /// Returns the state unchanged, because it need not satisfy the constraints.
    fn project(
        &self,
        _t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
    ) -> Result<Projected<M::Scalar, NQ, NV>, ConstraintError> {
        Ok((*q, *v))
    }

    /// Returns the velocity change due to a generalized impulse. Only constraint rates are corrected, because
    /// violations of the configuration decay by themselves.
    fn velocity_change_by_impulse(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        _h: M::Scalar,
        p: &SVector<M::Scalar, NV>,
    ) -> SVector<M::Scalar, NV> {
        self.mechanism.velocity_change_by_impulse(t, q, v, constant(0.0), p)
    }

    fn acceleration_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        u: &SVector<M::Scalar, NU>,
    ) -> Option<ByMotion<M::Scalar, NV, NU>> {
        self.mechanism.stabilized_derivatives(t, (q, v), u, self.rate)
    }

    each_function!(contact_methods, [M::Scalar] pass Hooks, self => self.mechanism);

    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<M::Scalar, NQ, NV, NU>,
    {
        None
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    Derivatives<NQ, NV, NU> for Stabilized<'_, M, M::Scalar, NH, NC>
where
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC>,
{
    crate::forward::linear_motion!(NQ, NV, NU);
    constants!(derivatives, M);

    each_function!(tangent, plain Derivatives, self => self.mechanism);
    each_function!(given_derivatives, pass Derivatives, self => self.mechanism);

    fn forward_dynamics_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        tau: &SVector<M::Scalar, NV>,
    ) -> ByMotion<M::Scalar, NV, NV> {
        stabilized_motion_derivatives(self.mechanism, self.rate, t, (q, v), tau).1
    }

    fn forward_dynamics_derivatives_into(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        tau: &SVector<M::Scalar, NV>,
        by_q: &mut SMatrix<M::Scalar, NV, NV>,
        by_v: &mut SMatrix<M::Scalar, NV, NV>,
        by_tau: &mut SMatrix<M::Scalar, NV, NV>,
    ) -> SVector<M::Scalar, NV> {
        let (acceleration, found) = stabilized_motion_derivatives(self.mechanism, self.rate, t, (q, v), tau);
        (*by_q, *by_v, *by_tau) = found;
        acceleration
    }

    /// Returns `None`, because the accelerations include the constraints.
    fn visit_constraints<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: super::Visitor<M::Scalar, NQ, NV, NU>,
    {
        None
    }
}
