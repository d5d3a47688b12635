//! Steps of constrained mechanisms: constraint impulses at the start of a step enforce the constraints at its
//! end.
//!
//! Between the impulses at both ends the motion is unconstrained. The first impulse is such that the step
//! ends on the constraints; the second, at the end, removes the velocity components that violate the
//! constraints. The impulses at the ends of a step combine with those of the neighbouring steps. A symplectic
//! or time-reversible free step therefore yields a constrained step with the same property: Andersen,
//! *Rattle: a velocity version of the Shake algorithm*, J. Comput. Phys. 52 (1983); Reich, *Symplectic
//! integration of constrained Hamiltonian systems by composition methods*, SIAM J. Numer. Anal. 33 (1996);
//! Hairer, Lubich and Wanner, *Geometric Numerical Integration* (2006), VII.1. Constraints on velocities act
//! through the same impulses and are enforced at the midpoint, where they are symmetric in time: Cortés and
//! Martínez, *Non-holonomic integrators*, Nonlinearity 14 (2001); McLachlan and Perlmutter, *Integrators for
//! nonholonomic mechanical systems*, J. Nonlinear Sci. 16 (2006).
//!
//! The equations of a step are solved by a simplified Newton method with the derivatives at its start, which
//! generated code provides as an elimination: each iteration reduces the error by a factor of about step ·
//! velocity · curvature.

use super::{Dynamics, Error, State, is_finite, largest_magnitude, project_end_of_step};
use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use crate::speeds;
use nalgebra::SVector;

/// Maximum number of iterations for the midpoint of one step. A step well inside the region of convergence
/// takes about ten.
pub(super) const MOST_ITERATIONS: usize = 100;

/// Returns the displacement from `q` to a midpoint after a time `half`, at which the configuration moves with
/// the velocity `v`.
pub(super) fn displacement_to_midpoint<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    half: T,
) -> SVector<T, NV> {
    if system.has_speeds() {
        speeds::displacement_given_final_velocity(|way| system.displacement_rate(q, way, v), v, half)
    } else {
        v * half
    }
}

/// Convergence test for the iteration of a midpoint velocity: whether changes are at rounding level.
pub(super) struct VelocityConvergenceTest<T> {
    half: T,
    last: Option<T>,
}

impl<T: Real> VelocityConvergenceTest<T> {
    /// Returns the test for steps of length `2 half`.
    pub(super) fn new(half: T) -> Self {
        Self { half, last: None }
    }

    /// Whether the change that led to the velocity `v` was the last significant one: it is at rounding level,
    /// or it no longer decreases and is negligible. A change is negligible if it is small relative to the
    /// velocity, or too small to move any coordinate; the latter applies at rest, where the velocity itself
    /// is rounding.
    pub(super) fn has_converged<const NQ: usize, const NV: usize>(
        &mut self,
        change: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> bool {
        let moves = constant::<T>(64.0) * epsilon::<T>() * largest_magnitude(q).max(T::one());
        let negligible =
            change <= epsilon::<T>().sqrt() * largest_magnitude(v) || change * self.half <= moves;
        let stalls = self.last.is_some_and(|last| change >= last);
        self.last = Some(change);
        change <= epsilon::<T>() * largest_magnitude(v) || (stalls && negligible)
    }
}

/// Returns the error for a diverged iteration: [`Error::NotFinite`] at the first iteration, otherwise
/// [`Error::NotConverged`].
pub(super) fn divergence_error<T: Real>(t: T, iterations: usize) -> Error {
    let t = to_f64(t);
    if iterations == 0 { Error::NotFinite { t } } else { Error::NotConverged { t, iterations } }
}

/// Maximum number of iterations of a reliable step, if it changed the velocity much (`FEW_ITERATIONS`) or
/// little (`MANY_ITERATIONS`), see [`crosses_singular_configuration`].
const FEW_ITERATIONS: usize = 8;
const MANY_ITERATIONS: usize = 24;

/// Maximum relative change of the velocity over half a step. After many iterations a larger change indicates
/// another solution.
const LEAP: f64 = 0.5;

/// Solution of the constrained midpoint equations of one step.
pub(super) struct MidpointSolution<T, const NV: usize> {
    /// Velocity at the midpoint of the step.
    pub v: SVector<T, NV>,
    /// Displacement over the whole step.
    pub way: SVector<T, NV>,
    /// Momentum at the end of the step, before the constraint impulse there.
    pub p: SVector<T, NV>,
    iterations: usize,
}

/// Whether the configuration at the end of the previous step is singular; `None` if unknown.
#[derive(Clone, Copy, Debug, Default)]
pub struct PreviousEndSingularity(Option<bool>);

/// Whether the step passes a singular configuration, so that its solution `found` is not reliable. This is
/// tested at its start and end; if the iteration failed, took many iterations or changed the velocity much,
/// also in between.
pub(super) fn crosses_singular_configuration<
    T: Real,
    D: Dynamics<T, NQ, NV>,
    const NQ: usize,
    const NV: usize,
>(
    system: &D,
    start: &State<T, NQ, NV>,
    h: T,
    found: &Result<MidpointSolution<T, NV>, Error>,
    ended: &mut PreviousEndSingularity,
) -> bool {
    let is_singular_state = |t: T, q: &SVector<T, NQ>| system.is_nearly_singular(t, q, &SVector::zeros());
    let is_small_velocity_change = |v: &SVector<T, NV>| {
        largest_magnitude(&(v - start.v)) <= largest_magnitude(&start.v) * constant(LEAP)
    };
    let has_few_iterations = |found: &&MidpointSolution<T, NV>| {
        found.iterations <= if is_small_velocity_change(&found.v) { MANY_ITERATIONS } else { FEW_ITERATIONS }
    };
    if let Some(found) = found.as_ref().ok().filter(has_few_iterations) {
        // Constraint impulses at a singular end do not remove the velocities that only the constraints of
        // that configuration forbid.
        let before = ended.0.unwrap_or_else(|| is_singular_state(start.t, &start.q));
        let after = is_singular_state(start.t + h, &system.integrate(&start.q, &found.way));
        ended.0 = Some(after);
        return before || after;
    }
    ended.0 = None;
    let way = start.v * h;
    [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().any(|part| {
        let q = system.integrate(&start.q, &(way * constant::<T>(part)));
        system.is_nearly_singular(start.t + h * constant(part), &q, &way)
    })
}

/// Relaxation factor of an iteration. If the constraints rotate within a step by as much as their distance
/// from a singular configuration, iterations with the derivatives at the start converge slowly or overshoot
/// repeatedly in one direction. Two successive changes determine the factor (Irons and Tuck, *A version of
/// the Aitken accelerator for computer iteration*, Int. J. Numer. Meth. Eng. 1, 1969).
struct AitkenRelaxation<T, const NV: usize> {
    last: SVector<T, NV>,
    share: T,
}

impl<T: Real, const NV: usize> AitkenRelaxation<T, NV> {
    /// Returns the relaxation factor for the next change of an iteration: one while the changes decrease
    /// fast.
    fn next_relaxation_factor(&mut self, change: &SVector<T, NV>) -> T {
        let (now, before) = (largest_magnitude(change), largest_magnitude(&self.last));
        let slow = before > T::zero() && now > before * constant(0.3) && now < before * constant(1e3);
        // Scaled by their magnitudes, so that the squares neither overflow nor underflow.
        let (own, last) = (change / before, self.last / before);
        let bend = own - last;
        let found = -self.share * last.dot(&bend) / bend.norm_squared();
        self.share = if slow && found > constant(0.05) && found < constant(8.0) { found } else { T::one() };
        self.last = *change;
        self.share
    }
}

/// Returns the velocity of the midpoint, starting from an estimate, and the momentum after the step before
/// the impulse at its end. With the momentum `p` at the start and its `rate` `ṗ(t, q, v)`, the midpoint
/// satisfies `M(q_m) v = p + Jᵀ(q₀) λ + (h/2) ṗ(q_m, v)` where `q_m = q₀ ⊕ (h/2) v`, and the constraints are
/// satisfied at `q₀ ⊕ h v`.
pub(super) fn solve_for_midpoint_velocity<
    T: Real,
    D: Dynamics<T, NQ, NV>,
    const NQ: usize,
    const NV: usize,
>(
    system: &mut D,
    rate: impl Fn(&mut D, T, &SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NV>,
    start: &State<T, NQ, NV>,
    p: &SVector<T, NV>,
    h: T,
    mut v: SVector<T, NV>,
) -> Result<MidpointSolution<T, NV>, Error> {
    let (half, two) = (h * constant(0.5), constant::<T>(2.0));
    let t = start.t + half;
    let mut settling = VelocityConvergenceTest::new(half);
    let mut pace = AitkenRelaxation { last: SVector::zeros(), share: T::one() };
    for iterations in 0..MOST_ITERATIONS {
        let q = system.integrate(&start.q, &displacement_to_midpoint(system, &start.q, &v, half));
        let gain = rate(system, t, &q, &v) * half;
        let own = system.momentum(t, &q, &v);
        let change = system.velocity_change_by_impulse(start.t, &start.q, &v, h, &(p + gain - own));
        v += change * pace.next_relaxation_factor(&change);
        if !is_finite(&v) {
            return Err(divergence_error(start.t, iterations));
        }
        if settling.has_converged(largest_magnitude(&change), &q, &v) {
            let way = displacement_to_midpoint(system, &start.q, &v, half);
            let q = system.integrate(&start.q, &way);
            let p = system.momentum(t, &q, &v) + rate(system, t, &q, &v) * half;
            return Ok(MidpointSolution { v, p, way: way * two, iterations });
        }
    }
    Err(Error::NotConverged { t: to_f64(start.t), iterations: MOST_ITERATIONS })
}

/// Returns the end of a step near a singular configuration, and its displacement. The velocity of the
/// midpoint is `v = v₀ + (h/2) v̇(q_m, v)` with `q_m = q₀ ⊕ (h/2) v`; the midpoint is projected onto the
/// constraints before its acceleration is evaluated. This acceleration is continuous there; impulses at the
/// ends of a step are not, because their directions rotate within the step. Order 2. `None` if the iteration
/// does not converge.
pub(super) fn step_past_singularity<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    t: T,
    h: T,
) -> Option<(SVector<T, NV>, State<T, NQ, NV>)> {
    let half = h * constant(0.5);
    let middle = start.t + half;
    let mut v = start.v;
    let mut last: Option<T> = None;
    for iteration in 0..MOST_ITERATIONS {
        let way = displacement_to_midpoint(system, &start.q, &v, half);
        let q = system.integrate(&start.q, &way);
        let (q, on) = system.project(middle, &q, &v).ok()?;
        let mut gain = system.acceleration(middle, &q, &on) * half;
        // Rounding of the configuration can cause the iteration to cycle.
        let circles = iteration >= FEW_ITERATIONS;
        if circles {
            gain = (gain + v - start.v) * constant::<T>(0.5);
        }
        let change = largest_magnitude(&(start.v + gain - v));
        v = start.v + gain;
        if !is_finite(&v) {
            return None;
        }
        // Accelerations near singular configurations have this relative accuracy at best.
        let known = epsilon::<T>().cbrt();
        let stalls = last.is_some_and(|last| change >= last);
        let settles = change <= known * largest_magnitude(&gain)
            || change <= epsilon::<T>() * largest_magnitude(&v)
            || (circles && stalls && change <= known * largest_magnitude(&v));
        if settles {
            let way = self::displacement_to_midpoint(system, &start.q, &v, half) * constant::<T>(2.0);
            let q = system.integrate(&start.q, &way);
            return project_end_of_step(system, State { t, q, v: v + gain }, start.t)
                .ok()
                .map(|end| (way, end));
        }
        last = Some(change);
    }
    None
}
