//! Constraints kept by feedback instead of projection.

use super::{Constrained, ConstraintError};
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

type V<M, const N: usize, const NQ: usize, const NV: usize, const NU: usize> =
    SVector<<M as Rheonomic<NQ, NV, NU>>::Scalar, N>;

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

impl<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    Rheonomic<NQ, NV, NU> for Stabilized<'_, M, M::Scalar, NH, NC>
where
    M: Constrained<NQ, NV, NU, NH, NC>,
{
    type Scalar = M::Scalar;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NV] = M::VELOCITIES;
    const INPUTS: [&'static str; NU] = M::INPUTS;
    const FEEDBACK: bool = true;

    fn neutral(&self) -> V<M, NQ, NQ, NV, NU> {
        self.mechanism.neutral()
    }

    fn integrate(&self, q: &V<M, NQ, NQ, NV, NU>, dv: &V<M, NV, NQ, NV, NU>) -> V<M, NQ, NQ, NV, NU> {
        self.mechanism.integrate(q, dv)
    }

    fn difference(&self, from: &V<M, NQ, NQ, NV, NU>, to: &V<M, NQ, NQ, NV, NU>) -> V<M, NV, NQ, NV, NU> {
        self.mechanism.difference(from, to)
    }

    fn tangent_rate(&self, dv: &V<M, NV, NQ, NV, NU>, v: &V<M, NV, NQ, NV, NU>) -> V<M, NV, NQ, NV, NU> {
        self.mechanism.tangent_rate(dv, v)
    }

    fn mass_matrix(&self, t: M::Scalar, q: &V<M, NQ, NQ, NV, NU>) -> SMatrix<M::Scalar, NV, NV> {
        self.mechanism.mass_matrix(t, q)
    }

    fn bias_forces(
        &self,
        t: M::Scalar,
        q: &V<M, NQ, NQ, NV, NU>,
        v: &V<M, NV, NQ, NV, NU>,
    ) -> V<M, NV, NQ, NV, NU> {
        self.mechanism.bias_forces(t, q, v)
    }

    fn inverse_dynamics(
        &self,
        t: M::Scalar,
        q: &V<M, NQ, NQ, NV, NU>,
        v: &V<M, NV, NQ, NV, NU>,
        a: &V<M, NV, NQ, NV, NU>,
    ) -> V<M, NV, NQ, NV, NU> {
        self.mechanism.inverse_dynamics(t, q, v, a)
    }

    fn forward_dynamics(
        &self,
        t: M::Scalar,
        q: &V<M, NQ, NQ, NV, NU>,
        v: &V<M, NV, NQ, NV, NU>,
        tau: &V<M, NV, NQ, NV, NU>,
    ) -> V<M, NV, NQ, NV, NU> {
        self.mechanism.forward_dynamics(t, q, v, tau) + self.correction(t, q, v)
    }

    fn try_forward_dynamics(
        &self,
        t: M::Scalar,
        q: &V<M, NQ, NQ, NV, NU>,
        v: &V<M, NV, NQ, NV, NU>,
        tau: &V<M, NV, NQ, NV, NU>,
    ) -> Result<V<M, NV, NQ, NV, NU>, ConstraintError> {
        Ok(self.mechanism.try_forward_dynamics(t, q, v, tau)? + self.correction(t, q, v))
    }

    fn generalized_forces(
        &self,
        t: M::Scalar,
        q: &V<M, NQ, NQ, NV, NU>,
        v: &V<M, NV, NQ, NV, NU>,
        u: &V<M, NU, NQ, NV, NU>,
    ) -> V<M, NV, NQ, NV, NU> {
        self.mechanism.generalized_forces(t, q, v, u)
    }

    fn kinetic_energy(&self, t: M::Scalar, q: &V<M, NQ, NQ, NV, NU>, v: &V<M, NV, NQ, NV, NU>) -> M::Scalar {
        self.mechanism.kinetic_energy(t, q, v)
    }

    fn potential_energy(&self, t: M::Scalar, q: &V<M, NQ, NQ, NV, NU>) -> M::Scalar {
        self.mechanism.potential_energy(t, q)
    }

    fn generalized_momentum(
        &self,
        t: M::Scalar,
        q: &V<M, NQ, NQ, NV, NU>,
        v: &V<M, NV, NQ, NV, NU>,
    ) -> V<M, NV, NQ, NV, NU> {
        self.mechanism.generalized_momentum(t, q, v)
    }

    fn momentum_rate(
        &self,
        t: M::Scalar,
        q: &V<M, NQ, NQ, NV, NU>,
        v: &V<M, NV, NQ, NV, NU>,
    ) -> V<M, NV, NQ, NV, NU> {
        self.mechanism.momentum_rate(t, q, v)
    }
}
