//! Semi-implicit (symplectic) Euler method.

use super::constrained::{
    MidpointSolution, PreviousEndSingularity, crosses_singular_configuration, solve_for_midpoint_velocity,
    step_past_singularity,
};
use super::{
    Dynamics, Error, Jump, Method, State, Step, check_positive, equal_step_length_and_end,
    project_end_of_step,
};
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

/// The semi-implicit Euler method, order 1: velocity first, then configuration with the new velocity.
///
/// `v₁ = v₀ + h v̇(t₀, q₀, v₀)`, `q₁ = q₀ ⊕ h v₁`. One evaluation of the dynamics per step. Symplectic for
/// constant mass matrices and forces that depend on the configuration only; Coriolis and gyroscopic terms are
/// explicit, so that fast rotations gain energy. Source: Hairer, Lubich and Wanner, *Geometric Numerical
/// Integration* (2006), I.1.2.
///
/// Under constraints, forces that do not depend on velocities, and inputs, act as an impulse at the start of
/// a step. One step of the constrained [`ImplicitMidpoint`](super::ImplicitMidpoint) under inertia, dashpots
/// and constraints alone follows. For plain coordinates and constant mass matrices this is SHAKE with
/// velocities that satisfy the constraints, and equally symplectic. The method is conjugate to a
/// time-reversible one by half an impulse: the energy of loops, ball joints and rolling bodies oscillates and
/// does not drift. A step takes about ten evaluations of momenta. Sources: Ryckaert, Ciccotti and Berendsen,
/// J. Comput. Phys. 23 (1977); Andersen, J. Comput. Phys. 52 (1983); Reich, SIAM J. Numer. Anal. 33 (1996);
/// McLachlan and Perlmutter, J. Nonlinear Sci. 16 (2006). [`Error::NotConverged`] means that the step is too
/// long. Where constraints nearly lose rank, a time-reversible step in accelerations replaces the midpoint
/// rule, with half an impulse added before it and subtracted after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SemiImplicitEuler<T> {
    step: T,
}

impl<T: Real> SemiImplicitEuler<T> {
    /// Returns the semi-implicit Euler method with steps of `step` seconds. Steps are slightly shorter where
    /// they must end on a sample time.
    pub const fn step(step: T) -> Self {
        Self { step }
    }

    /// Returns the nominal length of a step, s.
    pub(crate) fn nominal_step_length(&self) -> T {
        self.step
    }
}

/// Returns the generalized forces that do not depend on velocities, including inputs.
fn velocity_independent_forces<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    state: &State<T, NQ, NV>,
) -> SVector<T, NV> {
    let State { t, q, v } = state;
    system.momentum_rate(*t, q, v) - system.velocity_dependent_momentum_rate(*t, q, v)
}

/// Advances a semi-implicit Euler step near a singular configuration. As elsewhere, the method is equivalent
/// to a time-reversible method whose state is observed half an impulse earlier.
fn advance_past_singularity<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    t: T,
    h: T,
) -> Option<(SVector<T, NV>, State<T, NQ, NV>)> {
    let half = h * constant(0.5);
    let advance_velocity_by_forces = |system: &mut D, state: &State<T, NQ, NV>, h: T| {
        // Responses to forces, not to impulses: next to stiff springs, impulses of short steps would be lost
        // in rounding.
        let force = velocity_independent_forces(system, state);
        let v = state.v + system.response(state.t, &state.q, &state.v, &force) * h;
        project_end_of_step(system, State { v, ..*state }, state.t).ok()
    };
    let later = advance_velocity_by_forces(system, start, half)?;
    let (way, end) = step_past_singularity(system, &later, t, h)?;
    Some((way, advance_velocity_by_forces(system, &end, -half)?))
}

impl<T: Real> Method<T> for SemiImplicitEuler<T> {
    type Memory<const NV: usize> = PreviousEndSingularity;

    const FIXED: bool = true;

    fn check(&self) -> Result<(), Error> {
        check_positive("the step", self.step)
    }

    fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV> {
        PreviousEndSingularity::default()
    }

    fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump) {
        if jump == Jump::State {
            *memory = PreviousEndSingularity::default();
        }
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
        let constrained = system.is_constrained();
        let before = if dense || !constrained {
            system.acceleration(start.t, &start.q, &start.v)
        } else {
            SVector::zeros()
        };
        let (way, end) = if constrained {
            let p =
                system.momentum(start.t, &start.q, &start.v) + velocity_independent_forces(system, start) * h;
            let inertial_rate_of_state =
                |system: &mut D, t, q: &_, v: &_| system.velocity_dependent_momentum_rate(t, q, v);
            let found = solve_for_midpoint_velocity(system, inertial_rate_of_state, start, &p, h, start.v);
            let crossing = crosses_singular_configuration(system, start, h, &found, memory);
            let passed = if crossing { advance_past_singularity(system, start, t, h) } else { None };
            match passed {
                Some(passed) => passed,
                None => {
                    let MidpointSolution { v, p, way, .. } = found?;
                    let q = system.integrate(&start.q, &way);
                    (
                        way,
                        project_end_of_step(
                            system,
                            State { t, q, v: system.velocity(t, &q, &p, &v) },
                            start.t,
                        )?,
                    )
                }
            }
        } else {
            let v = start.v + before * h;
            let way = v * h;
            let q = system.integrate(&start.q, &way);
            (way, project_end_of_step(system, State { t, q, v }, start.t)?)
        };
        let step = Step::linear(*start, end, way);
        if !dense {
            return Ok(step);
        }
        let after = system.acceleration(end.t, &end.q, &end.v);
        Ok(step.cubic(system, &way, [before, after]))
    }
}
