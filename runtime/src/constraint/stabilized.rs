//! Constraints kept by feedback instead of projection.

use super::{Constrained, ConstraintError, Projected};
use crate::contact::Touched;
use crate::forward::each_function;
use crate::private::constant;
use crate::{Real, Rheonomic};
use nalgebra::{SMatrix, SVector};

/// A mechanism whose violated constraints decay by themselves.
///
/// Baumgarte's stabilization: `φ̈ + 2 α φ̇ + α² φ = 0` (Baumgarte, *Stabilization of
/// constraints and integrals of motion in dynamical systems*, Comp. Meth. Appl. Mech. Eng. 1, 1972). Integrators then
/// leave the state as it is, whether it fulfils the constraints or not; the violation is small, not zero.
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

/// The mechanism with violations of its constraints decaying at `rate`, 1/s: a few times the fastest rate of the motion.
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
    /// The acceleration that lets violations decay.
    fn correction<const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> SVector<T, NV>
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        let residuals = self.mechanism.constraint_residuals(t, q) * (self.rate * self.rate);
        let rates = self.mechanism.constraint_rates(t, q, v) * (self.rate * constant(2.0));
        let gap = SVector::from_fn(|k, _| residuals.get(k).map_or(rates[k], |r| rates[k] + *r));
        self.mechanism.constraint_correction(t, q, &gap)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    Rheonomic<NQ, NV, NU> for Stabilized<'_, M, M::Scalar, NH, NC>
where
    M: Constrained<NQ, NV, NU, NH, NC>,
{
    type Scalar = M::Scalar;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NV] = M::VELOCITIES;
    const INPUTS: [&'static str; NU] = M::INPUTS;
    const VELOCITY_UNITS: [&'static str; NV] = M::VELOCITY_UNITS;
    const INPUT_UNITS: [&'static str; NU] = M::INPUT_UNITS;
    const FEEDBACK: bool = true;
    const CONTACTING: bool = M::CONTACTING;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = M::FIRST_ORDER;
    const SPEEDS: bool = M::SPEEDS;

    each_function!(space, plain Rheonomic, self => self.mechanism);
    each_function!(dynamics, pass Rheonomic, self => self.mechanism);

    fn forward_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        tau: &SVector<M::Scalar, NV>,
    ) -> SVector<M::Scalar, NV> {
        self.mechanism.forward_dynamics(t, q, v, tau) + self.correction(t, q, v)
    }

    fn try_forward_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        tau: &SVector<M::Scalar, NV>,
    ) -> Result<SVector<M::Scalar, NV>, ConstraintError> {
        Ok(self.mechanism.try_forward_dynamics(t, q, v, tau)? + self.correction(t, q, v))
    }

    /// States need not fulfil the constraints: they stay as they are.
    fn project(
        &self,
        _t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
    ) -> Result<Projected<M::Scalar, NQ, NV>, ConstraintError> {
        Ok((*q, *v))
    }

    /// Where violations decay, constraints are looked at for their rates alone.
    fn impulse(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        _h: M::Scalar,
        p: &SVector<M::Scalar, NV>,
    ) -> SVector<M::Scalar, NV> {
        self.mechanism.impulse(t, q, v, constant(0.0), p)
    }

    fn is_nearly_singular(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NV>,
    ) -> bool {
        self.mechanism.is_nearly_singular(t, q, dv)
    }

    /// None: methods take differences.
    fn acceleration_derivatives(
        &self,
        _t: M::Scalar,
        _q: &SVector<M::Scalar, NQ>,
        _v: &SVector<M::Scalar, NV>,
        _u: &SVector<M::Scalar, NU>,
    ) -> Option<crate::ByMotion<M::Scalar, NV, NU>> {
        None
    }

    fn carry(
        &self,
        t: M::Scalar,
        dv: &SVector<M::Scalar, NV>,
        v: &SVector<M::Scalar, NV>,
    ) -> SVector<M::Scalar, NV> {
        self.mechanism.carry(t, dv, v)
    }

    fn contact_step(
        &self,
        t: M::Scalar,
        start: (&SVector<M::Scalar, NQ>, &SVector<M::Scalar, NV>),
        end: (&SVector<M::Scalar, NQ>, &SVector<M::Scalar, NV>),
        given: &SVector<M::Scalar, NV>,
        h: M::Scalar,
    ) -> Result<Touched<M::Scalar, NQ, NV>, ConstraintError> {
        self.mechanism.contact_step(t, start, end, given, h)
    }

    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<M::Scalar, NQ, NV, NU>,
    {
        None
    }
}
