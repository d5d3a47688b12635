//! Classical Runge–Kutta method of order 4 with fixed steps.

use super::{
    Dynamics, Error, Jump, Method, State, Step, check_positive, equal_step_length_and_end,
    project_end_of_step,
};
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

/// The classical Runge–Kutta method, order 4, with fixed steps.
///
/// Four evaluations of the dynamics per step, in the tangent space at the step's start. Source: Kutta (1901);
/// Munthe-Kaas, *High order Runge–Kutta methods on manifolds*, Appl. Numer. Math. 29 (1999).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rk4<T> {
    step: T,
}

impl<T: Real> Rk4<T> {
    /// Returns the Runge–Kutta method with steps of `step` seconds. Steps are slightly shorter where they
    /// must end on a sample time.
    pub const fn step(step: T) -> Self {
        Self { step }
    }

    /// Returns the nominal length of a step, s.
    pub(crate) fn nominal_step_length(&self) -> T {
        self.step
    }
}

/// Rates `φ̇` and `v̇` of displacement and velocity at one Runge–Kutta stage.
type StageRates<T, const NV: usize> = (SVector<T, NV>, SVector<T, NV>);

/// Returns the rates of the state at time `h` after `start`, reached with the mean rates `mean`.
fn rates_at_advanced_state<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    h: T,
    mean: &StageRates<T, NV>,
) -> StageRates<T, NV> {
    let displacement = mean.0 * h;
    let v = start.v + mean.1 * h;
    let q = system.integrate(&start.q, &displacement);
    (system.displacement_rate(&start.q, &displacement, &v), system.acceleration(start.t + h, &q, &v))
}

/// Returns the displacement and the change of the velocity in a step of `h` seconds, with the acceleration
/// `before` at its start. An additional acceleration `added` has a constant direction in space during the
/// step; it is returned in the axes at the end of the step.
pub(super) fn rk4_change<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    h: T,
    before: SVector<T, NV>,
    added: Option<&SVector<T, NV>>,
) -> (StageRates<T, NV>, Option<SVector<T, NV>>) {
    let half = h * constant(0.5);
    let transported_added_acceleration = |system: &D, displacement: &SVector<T, NV>| {
        added.map(|added| system.carry(start.t, &start.q, displacement, added))
    };
    let add_acceleration_to_rates = |(displacement, acceleration): StageRates<T, NV>,
                                     added: &Option<SVector<T, NV>>| {
        (displacement, added.map_or(acceleration, |added| acceleration + added))
    };
    let k1 = add_acceleration_to_rates((start.v, before), &added.copied());
    let k2 = add_acceleration_to_rates(
        rates_at_advanced_state(system, start, half, &k1),
        &transported_added_acceleration(system, &(k1.0 * half)),
    );
    let k3 = add_acceleration_to_rates(
        rates_at_advanced_state(system, start, half, &k2),
        &transported_added_acceleration(system, &(k2.0 * half)),
    );
    let at_end = transported_added_acceleration(system, &(k3.0 * h));
    let k4 = add_acceleration_to_rates(rates_at_advanced_state(system, start, h, &k3), &at_end);
    let (two, sixth) = (constant::<T>(2.0), h / constant(6.0));
    let mean = ((k1.0 + k4.0 + (k2.0 + k3.0) * two) * sixth, (k1.1 + k4.1 + (k2.1 + k3.1) * two) * sixth);
    (mean, at_end)
}

impl<T: Real> Method<T> for Rk4<T> {
    /// Acceleration at the end of the last step, if that step computed it.
    type Memory<const NV: usize> = Option<SVector<T, NV>>;

    const FIXED: bool = true;

    fn check(&self) -> Result<(), Error> {
        check_positive("the step", self.step)
    }

    fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV> {
        None
    }

    fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, _jump: Jump) {
        *memory = None;
    }

    fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        memory: &mut Self::Memory<NV>,
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error> {
        let (h, t) = equal_step_length_and_end(self.step, start.t, until)?;
        let known = memory.take();
        let before = known.unwrap_or_else(|| system.acceleration(start.t, &start.q, &start.v));
        let ((displacement, change), _) = rk4_change(system, start, h, before, None);
        let end = State { t, q: system.integrate(&start.q, &displacement), v: start.v + change };
        let end = project_end_of_step(system, end, start.t)?;
        let step = Step::linear(*start, end, displacement);
        if !dense {
            return Ok(step);
        }
        let after = system.acceleration(end.t, &end.q, &end.v);
        *memory = Some(after);
        Ok(step.cubic(system, &displacement, [before, after]))
    }
}
