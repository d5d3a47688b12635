//! The semi-implicit (symplectic) Euler method.

use super::{Dynamics, Error, Jump, Method, State, Step, equal_step, positive, settled};
use crate::Real;

/// The semi-implicit Euler method, order 1: velocity first, then configuration with the new velocity.
///
/// `v₁ = v₀ + h v̇(t₀, q₀, v₀)`, `q₁ = q₀ ⊕ h v₁`. One evaluation of the dynamics per step. Symplectic for constant
/// mass matrices and forces that depend on the configuration only; Coriolis and gyroscopic terms are explicit, so that
/// fast spins gain energy. Source: Hairer, Lubich and Wanner, *Geometric Numerical Integration* (2006), I.1.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SemiImplicitEuler<T> {
    step: T,
}

impl<T: Real> SemiImplicitEuler<T> {
    /// Steps of `step` seconds; a little shorter where they have to end on a sample time.
    pub fn step(step: T) -> Self {
        Self { step }
    }

    /// The step.
    pub(crate) fn length(&self) -> T {
        self.step
    }
}

impl<T: Real> Method<T> for SemiImplicitEuler<T> {
    type Memory<const NV: usize> = ();

    const FIXED: bool = true;

    fn check(&self) -> Result<(), Error> {
        positive("the step", self.step)
    }

    fn memory<const NV: usize>(&self) -> Self::Memory<NV> {}

    fn disturb<const NV: usize>(&self, (): &mut (), _jump: Jump) {}

    fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        (): &mut (),
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error> {
        let (h, t) = equal_step(self.step, start.t, until)?;
        let before = system.acceleration(start.t, &start.q, &start.v);
        let v = start.v + before * h;
        let displacement = v * h;
        let end = State { t, q: system.integrate(&start.q, &displacement), v };
        let end = settled(system, end, start.t)?;
        let step = Step::linear(*start, end, displacement);
        if !dense {
            return Ok(step);
        }
        let after = system.acceleration(end.t, &end.q, &end.v);
        Ok(step.cubic(system, &displacement, [before, after]))
    }
}
