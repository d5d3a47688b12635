//! The implicit midpoint rule in momenta.

use super::{Dynamics, Error, Jump, Method, State, Step, equal_step, is_finite, largest, positive, settled};
use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::SVector;

/// Iterations allowed for one step; a step well inside the region of convergence takes about ten.
const MOST_ITERATIONS: usize = 100;

/// The implicit midpoint rule, order 2, with fixed steps.
///
/// With the velocity `v_m` and the configuration `q_m` of the midpoint unknown,
/// `q_m = q₀ ⊕ (h/2) v_m`, `M(q_m) v_m = p₀ + (h/2) ṗ(q_m, v_m)`, then `q₁ = q_m ⊕ (h/2) v_m` and
/// `p₁ = p₀ + h ṗ(q_m, v_m)`, where `p = M v` is the generalized momentum.
///
/// Symplectic in (q, p) for plain coordinates and time-reversible for all joints: over long runs without friction the
/// energy oscillates and does not drift. Momenta are kept from step to step; those of plain coordinates that the forces
/// leave alone are conserved to rounding, those of ball and free joints, which are given in turning axes, to second order.
/// Source: Hairer, Lubich and Wanner, *Geometric Numerical Integration* (2006), II.1, VI.3.
///
/// The equation is solved by fixed-point iteration to rounding, which converges while `h ω < 2` for the stiffest
/// frequency `ω` (in the same way `h c / m < 2` for damping).
/// [`Error::NotConverged`] means that the step is too long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImplicitMidpoint<T> {
    step: T,
}

/// What the midpoint rule hands to the next step.
#[derive(Clone, Copy, Debug)]
pub struct MidpointMemory<T, const NV: usize> {
    momentum: Option<SVector<T, NV>>,
    change: SVector<T, NV>,
}

/// A solved midpoint: configuration, velocity, rate of the momentum.
type Midpoint<T, const NQ: usize, const NV: usize> = (SVector<T, NQ>, SVector<T, NV>, SVector<T, NV>);

impl<T: Real> ImplicitMidpoint<T> {
    /// Steps of `step` seconds; a little shorter where they have to end on a sample time.
    pub fn step(step: T) -> Self {
        Self { step }
    }
}

/// Iterates from the estimate `v` of the midpoint's velocity.
fn solve<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    p: &SVector<T, NV>,
    half: T,
    mut v: SVector<T, NV>,
) -> Result<Midpoint<T, NQ, NV>, Error> {
    let t = to_f64(start.t);
    let mut last: Option<T> = None;
    for iterations in 0..MOST_ITERATIONS {
        let q = system.integrate(&start.q, &(v * half));
        let rate = system.momentum_rate(start.t + half, &q, &v);
        let next = system.velocity(start.t + half, &q, &(p + rate * half), &v);
        if !is_finite(&next) {
            let diverged = Error::NotConverged { t, iterations };
            return Err(if iterations == 0 { Error::NotFinite { t } } else { diverged });
        }
        let change = largest(&(next - v));
        let settled = last.is_some_and(|last| change >= last) && negligible(change, half, &q, &next);
        v = next;
        if change <= epsilon::<T>() * largest(&v) || settled {
            let q = system.integrate(&start.q, &(v * half));
            return Ok((q, v, system.momentum_rate(start.t + half, &q, &v)));
        }
        last = Some(change);
    }
    Err(Error::NotConverged { t, iterations: MOST_ITERATIONS })
}

/// Whether a change of the velocity that has ceased to shrink is rounding: small beside the velocity, or too small
/// to move anything. The second holds at rest, where the velocity itself is rounding.
fn negligible<T: Real, const NQ: usize, const NV: usize>(
    change: T,
    half: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
) -> bool {
    let moves = constant::<T>(64.0) * epsilon::<T>() * largest(q).max(T::one());
    change <= epsilon::<T>().sqrt() * largest(v) || change * half <= moves
}

impl<T: Real> Method<T> for ImplicitMidpoint<T> {
    type Memory<const NV: usize> = MidpointMemory<T, NV>;

    const FIXED: bool = true;

    fn check(&self) -> Result<(), Error> {
        positive("the step", self.step)
    }

    fn memory<const NV: usize>(&self) -> Self::Memory<NV> {
        MidpointMemory { momentum: None, change: SVector::zeros() }
    }

    fn disturb<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump) {
        if jump == Jump::State {
            *memory = self.memory();
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
        let (h, t) = equal_step(self.step, start.t, until)?;
        let half = h * constant(0.5);
        let p = memory.momentum.unwrap_or_else(|| system.momentum(start.t, &start.q, &start.v));
        let (q, v, rate) = solve(system, start, &p, half, start.v + memory.change)?;
        let change = v - start.v;
        let p = p + rate * h;
        let q = system.integrate(&q, &(v * half));
        let end = State { t, q, v: system.velocity(t, &q, &p, &(v + change)) };
        let end = settled(system, end, start.t)?;
        *memory = MidpointMemory { momentum: Some(p), change: end.v - v };
        let displacement = v * h;
        let step = Step::linear(*start, end, displacement);
        if !dense {
            return Ok(step);
        }
        let before = system.acceleration(start.t, &start.q, &start.v);
        let after = system.acceleration(end.t, &end.q, &end.v);
        Ok(step.cubic(system, &displacement, [before, after]))
    }
}
