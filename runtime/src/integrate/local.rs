//! System of equations of motion with time counted from the start of a step.

use super::event_driven::Section;
use super::{Dynamics, Error, State, Step};
use crate::Real;
use crate::constraint::{ConstraintError, Projected};
use crate::contact::{Assumed, Touched};
use nalgebra::{SMatrix, SVector};

/// System of equations of motion with time counted from `origin`, so that single precision resolves times
/// within a step at any time of the run.
pub(super) struct TimeShiftedSystem<'a, D, T> {
    pub(super) system: &'a mut D,
    pub(super) origin: T,
}

impl<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize> Dynamics<T, NQ, NV>
    for TimeShiftedSystem<'_, D, T>
{
    fn time(&self, t: T) -> T {
        self.origin + t
    }

    fn integrate(&self, q: &SVector<T, NQ>, dv: &SVector<T, NV>) -> SVector<T, NQ> {
        self.system.integrate(q, dv)
    }

    fn tangent_rate(&self, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.system.tangent_rate(dv, v)
    }

    fn displacement_rate(
        &self,
        q: &SVector<T, NQ>,
        dv: &SVector<T, NV>,
        v: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.system.displacement_rate(q, dv, v)
    }

    fn has_speeds(&self) -> bool {
        self.system.has_speeds()
    }

    fn dimensions(&self) -> [usize; 2] {
        self.system.dimensions()
    }

    fn acceleration(&mut self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.system.acceleration(self.origin + t, q, v)
    }

    fn is_constrained(&self) -> bool {
        self.system.is_constrained()
    }

    fn project(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> Result<Projected<T, NQ, NV>, ConstraintError> {
        self.system.project(self.origin + t, q, v)
    }

    fn carry(&self, t: T, q: &SVector<T, NQ>, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.system.carry(self.origin + t, q, dv, v)
    }

    fn carry_rate(&self, t: T, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.system.carry_rate(self.origin + t, dv, v)
    }

    fn translation(&self, t: T, dv: &SVector<T, NV>) -> SVector<T, NV> {
        self.system.translation(self.origin + t, dv)
    }

    fn contact_step(
        &self,
        t: T,
        start: (&SVector<T, NQ>, &SVector<T, NV>),
        end: (&SVector<T, NQ>, &SVector<T, NV>),
        given: Assumed<'_, T, NV>,
        h: T,
    ) -> Result<Touched<T, NQ, NV>, ConstraintError> {
        self.system.contact_step(self.origin + t, start, end, given, h)
    }

    fn follow(&mut self, section: Section<'_, T, NQ, NV>) -> Option<Result<Step<T, NQ, NV>, Error>> {
        self.system.follow(section.shift_time_origin(self.origin))
    }

    fn momentum(&self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.system.momentum(self.origin + t, q, v)
    }

    fn momentum_rate(&mut self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.system.momentum_rate(self.origin + t, q, v)
    }

    fn velocity_dependent_momentum_rate(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.system.velocity_dependent_momentum_rate(self.origin + t, q, v)
    }

    fn velocity(&self, t: T, q: &SVector<T, NQ>, p: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.system.velocity(self.origin + t, q, p, v)
    }

    fn velocity_change_by_impulse(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        h: T,
        p: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.system.velocity_change_by_impulse(self.origin + t, q, v, h, p)
    }

    fn response(
        &mut self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        p: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.system.response(self.origin + t, q, v, p)
    }

    fn is_nearly_singular(&self, t: T, q: &SVector<T, NQ>, dv: &SVector<T, NV>) -> bool {
        self.system.is_nearly_singular(self.origin + t, q, dv)
    }

    fn acceleration_derivatives(
        &mut self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> Option<(SMatrix<T, NV, NV>, SMatrix<T, NV, NV>)> {
        self.system.acceleration_derivatives(self.origin + t, q, v)
    }
}

impl<T: Real, const NQ: usize, const NV: usize> State<T, NQ, NV> {
    /// Returns the same state with the time `t`, counted from another origin.
    pub(crate) fn with_time_replaced(self, t: T) -> Self {
        Self { t, ..self }
    }
}
