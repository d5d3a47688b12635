//! Implicit midpoint rule, formulated in generalized momenta.

use super::constrained::{
    MOST_ITERATIONS, MidpointSolution, PreviousEndSingularity, VelocityConvergenceTest,
    crosses_singular_configuration, divergence_error, solve_for_midpoint_velocity, step_past_singularity,
};
use super::{
    Dynamics, Error, Jump, Method, State, Step, check_positive, equal_step_length_and_end, is_finite,
    largest_magnitude, project_end_of_step,
};
use crate::Real;
use crate::private::{constant, to_f64};
use nalgebra::SVector;

/// The implicit midpoint rule, order 2, with fixed steps.
///
/// With the velocity `v_m` and the configuration `q_m` of the midpoint unknown, `q_m = q₀ ⊕ (h/2) v_m`,
/// `M(q_m) v_m = p₀ + (h/2) ṗ(q_m, v_m)`, then `q₁ = q_m ⊕ (h/2) v_m` and `p₁ = p₀ + h ṗ(q_m, v_m)`, where `p
/// = M v` is the generalized momentum.
///
/// Symplectic in (q, p) for plain coordinates and time-reversible for all joints: over long runs without
/// friction the energy oscillates and does not drift. Momenta are stored from step to step. Momenta of plain
/// coordinates without generalized forces are conserved to rounding. Momenta of ball and free joints,
/// expressed in rotating axes, are conserved to second order. So are momenta of declared generalized speeds;
/// their displacement to the midpoint is solved for together with the velocity of the midpoint. Source:
/// Hairer, Lubich and Wanner, *Geometric Numerical Integration* (2006), II.1, VI.3.
///
/// The equation is solved to rounding by fixed-point iteration, which converges while `h ω < 2` for the
/// highest frequency `ω` (and `h c / m < 2` for damping). [`Error::NotConverged`] means that the step is too
/// long.
///
/// Under constraints, the constraint impulses `Jᵀ(q₀) λ` and `Jᵀ(q₁) μ` are added to the momentum at both
/// ends of the step, so that the configuration `q₁` and the velocity there satisfy the constraints. The order
/// remains 2, and the method remains symplectic or reversible. Constraints on velocities alone (rolling) are
/// enforced at the midpoint and at the ends; the energy then oscillates by symmetry. Sources: Andersen, J.
/// Comput. Phys. 52 (1983); Reich, SIAM J. Numer. Anal. 33 (1996); Hairer, Lubich and Wanner (2006), VII.1;
/// McLachlan and Perlmutter, J. Nonlinear Sci. 16 (2006). Where constraints nearly lose rank, the midpoint is
/// solved in velocities and accelerations; such a step has order 2 but is not symplectic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImplicitMidpoint<T> {
    step: T,
}

/// Memory of the implicit midpoint rule: data that one step passes to the next.
#[derive(Clone, Copy, Debug)]
pub struct MidpointMemory<T, const NV: usize> {
    momentum: Option<SVector<T, NV>>,
    change: SVector<T, NV>,
    ended: PreviousEndSingularity,
}

/// Solution of the midpoint: configuration, then displacement to it, velocity, rate of the momentum.
type SolvedMidpoint<T, const NQ: usize, const NV: usize> = (SVector<T, NQ>, [SVector<T, NV>; 3]);

impl<T: Real> ImplicitMidpoint<T> {
    /// Returns the implicit midpoint rule with steps of `step` seconds. Steps are slightly shorter where they
    /// must end on a sample time.
    pub const fn step(step: T) -> Self {
        Self { step }
    }

    /// Returns the nominal length of a step, s.
    pub(crate) fn nominal_step_length(&self) -> T {
        self.step
    }
}

/// Returns an improved estimate of the displacement from `q` to the midpoint after a time `half`: the
/// displacement rate there times `half`.
fn improved_midpoint_displacement<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    q: &SVector<T, NQ>,
    way: &SVector<T, NV>,
    v: &SVector<T, NV>,
    half: T,
) -> SVector<T, NV> {
    if system.has_speeds() { system.displacement_rate(q, way, v) * half } else { v * half }
}

/// Solves the midpoint equations by iteration, starting with the estimate `v` of the midpoint's velocity.
fn solve_midpoint_equations_iteratively<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    p: &SVector<T, NV>,
    half: T,
    mut v: SVector<T, NV>,
) -> Result<SolvedMidpoint<T, NQ, NV>, Error> {
    let mut settling = VelocityConvergenceTest::new(half);
    let mut way = v * half;
    for iterations in 0..MOST_ITERATIONS {
        way = improved_midpoint_displacement(system, &start.q, &way, &v, half);
        let q = system.integrate(&start.q, &way);
        let rate = system.momentum_rate(start.t + half, &q, &v);
        let next = system.velocity(start.t + half, &q, &(p + rate * half), &v);
        if !is_finite(&next) {
            return Err(divergence_error(start.t, iterations));
        }
        let change = largest_magnitude(&(next - v));
        v = next;
        if settling.has_converged(change, &q, &v) {
            way = improved_midpoint_displacement(system, &start.q, &way, &v, half);
            let q = system.integrate(&start.q, &way);
            return Ok((q, [way, v, system.momentum_rate(start.t + half, &q, &v)]));
        }
    }
    Err(Error::NotConverged { t: to_f64(start.t), iterations: MOST_ITERATIONS })
}

impl<T: Real> Method<T> for ImplicitMidpoint<T> {
    type Memory<const NV: usize> = MidpointMemory<T, NV>;

    const FIXED: bool = true;

    fn check(&self) -> Result<(), Error> {
        check_positive("the step", self.step)
    }

    fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV> {
        MidpointMemory { momentum: None, change: SVector::zeros(), ended: PreviousEndSingularity::default() }
    }

    fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump) {
        if jump == Jump::State {
            *memory = self.initial_memory();
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
        let half = h * constant(0.5);
        let p = memory.momentum.unwrap_or_else(|| system.momentum(start.t, &start.q, &start.v));
        let guess = start.v + memory.change;
        let (displacement, v, end, momentum) = if system.is_constrained() {
            let found = solve_for_midpoint_velocity(system, D::momentum_rate, start, &p, h, guess);
            let crossing = crosses_singular_configuration(system, start, h, &found, &mut memory.ended);
            let passed = if crossing { step_past_singularity(system, start, t, h) } else { None };
            let (way, end) = match passed {
                Some(passed) => passed,
                None => {
                    let MidpointSolution { v, p, way, .. } = found?;
                    let q = system.integrate(&start.q, &way);
                    let v1 = system.velocity(t, &q, &p, &(v + v - start.v));
                    (way, project_end_of_step(system, State { t, q, v: v1 }, start.t)?)
                }
            };
            // The constraint impulse at the end changes the momentum.
            (way, way / h, end, None)
        } else {
            let (q, [way, v, rate]) = solve_midpoint_equations_iteratively(system, start, &p, half, guess)?;
            let p = p + rate * h;
            let (q, displacement) = match system.has_speeds() {
                true => (system.integrate(&start.q, &(way * constant::<T>(2.0))), way * constant::<T>(2.0)),
                false => (system.integrate(&q, &(v * half)), v * h),
            };
            let end = State { t, q, v: system.velocity(t, &q, &p, &(v + v - start.v)) };
            (displacement, v, project_end_of_step(system, end, start.t)?, Some(p))
        };
        *memory = MidpointMemory { momentum, change: end.v - v, ended: memory.ended };
        let step = Step::linear(*start, end, displacement);
        if !dense {
            return Ok(step);
        }
        let before = system.acceleration(start.t, &start.q, &start.v);
        let after = system.acceleration(end.t, &end.q, &end.v);
        Ok(step.cubic(system, &displacement, [before, after]))
    }
}
