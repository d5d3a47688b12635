//! Steps of constrained mechanisms: the constraints push at the start of a step, so that they hold at its end.
//!
//! Between two pushes the motion goes on as if it were free. The first push is such that the step ends on the
//! constraints; the second, at the end, takes away what is left of velocities that these forbid. Pushes at the ends of a
//! step join those of its neighbours, so that a free step which is symplectic, or the same backwards in time, makes a
//! constrained one which is that, too: Andersen, *Rattle: a velocity version of the Shake algorithm*, J. Comput. Phys. 52
//! (1983); Reich, *Symplectic integration of constrained Hamiltonian systems by composition methods*, SIAM J. Numer. Anal.
//! 33 (1996); Hairer, Lubich and Wanner, *Geometric Numerical Integration* (2006), VII.1. Constraints on velocities push in
//! the same way and have to hold half-way, where they read the same forwards and backwards: Cortés and Martínez,
//! *Non-holonomic integrators*, Nonlinearity 14 (2001); McLachlan and Perlmutter, *Integrators for nonholonomic mechanical
//! systems*, J. Nonlinear Sci. 16 (2006).
//!
//! The equations of a step are solved by Newton's method with the derivatives at its start, which generated code
//! holds as an elimination: each iteration gains a factor of about step · speed · curvature.

use super::{Dynamics, Error, State, is_finite, largest, settled};
use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::SVector;

/// Iterations allowed for one step; a step well inside the region of convergence takes about ten.
pub(super) const MOST_ITERATIONS: usize = 100;

/// Whether iterations of a velocity have come to their end: changes are rounding.
pub(super) struct Settling<T> {
    half: T,
    last: Option<T>,
}

impl<T: Real> Settling<T> {
    /// For steps of twice `half`.
    pub(super) fn new(half: T) -> Self {
        Self { half, last: None }
    }

    /// Whether the change that has led to the velocity `v` was the last that matters: rounding itself, or no longer
    /// shrinking and either small beside the velocity or too small to move anything. The latter holds at rest, where the
    /// velocity itself is rounding.
    pub(super) fn is_done<const NQ: usize, const NV: usize>(
        &mut self,
        change: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> bool {
        let moves = constant::<T>(64.0) * epsilon::<T>() * largest(q).max(T::one());
        let negligible = change <= epsilon::<T>().sqrt() * largest(v) || change * self.half <= moves;
        let stalls = self.last.is_some_and(|last| change >= last);
        self.last = Some(change);
        change <= epsilon::<T>() * largest(v) || (stalls && negligible)
    }
}

/// The error for an iteration that has lost all sense: at once, or on its way.
pub(super) fn lost<T: Real>(t: T, iterations: usize) -> Error {
    let t = to_f64(t);
    if iterations == 0 { Error::NotFinite { t } } else { Error::NotConverged { t, iterations } }
}

/// More iterations than steps take whose end is in reach of the derivatives at their start.
const MANY_ITERATIONS: usize = 24;

/// A solved midpoint.
pub(super) struct Middle<T, const NV: usize> {
    /// Its velocity.
    pub v: SVector<T, NV>,
    /// The momentum after the step, before the push at its end.
    pub p: SVector<T, NV>,
    iterations: usize,
}

/// Whether a step cannot be trusted to have `found` its end since it begins in a singular position or, if that took many
/// iterations, leads past one.
pub(super) fn is_crossing<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    start: &State<T, NQ, NV>,
    h: T,
    found: &Result<Middle<T, NV>, Error>,
) -> bool {
    let quick = found.as_ref().is_ok_and(|found| found.iterations <= MANY_ITERATIONS);
    let reach = if quick { T::zero() } else { h };
    system.is_nearly_singular(start.t, &start.q, &(start.v * reach))
}

/// The velocity of the midpoint, from an estimate, and the momentum after the step before the push at its end: with the
/// momentum `p` at the start and its `rate` `ṗ(t, q, v)`, `M(q_m) v = p + Jᵀ(q₀) λ + (h/2) ṗ(q_m, v)` where
/// `q_m = q₀ ⊕ (h/2) v`, and constraints that hold at `q₀ ⊕ h v`.
pub(super) fn midpoint<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    rate: impl Fn(&mut D, T, &SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NV>,
    start: &State<T, NQ, NV>,
    p: &SVector<T, NV>,
    h: T,
    mut v: SVector<T, NV>,
) -> Result<Middle<T, NV>, Error> {
    let half = h * constant(0.5);
    let t = start.t + half;
    let mut settling = Settling::new(half);
    for iterations in 0..MOST_ITERATIONS {
        let q = system.integrate(&start.q, &(v * half));
        let gain = rate(system, t, &q, &v) * half;
        let own = system.momentum(t, &q, &v);
        let change = system.impulse(start.t, &start.q, &v, h, &(p + gain - own));
        v += change;
        if !is_finite(&v) {
            return Err(lost(start.t, iterations));
        }
        if settling.is_done(largest(&change), &q, &v) {
            let q = system.integrate(&start.q, &(v * half));
            let p = system.momentum(t, &q, &v) + rate(system, t, &q, &v) * half;
            return Ok(Middle { v, p, iterations });
        }
    }
    Err(Error::NotConverged { t: to_f64(start.t), iterations: MOST_ITERATIONS })
}

/// The end of a step near a singular position, and the velocity of its midpoint: `v = v₀ + (h/2) v̇(q_m, v)` with
/// `q_m = q₀ ⊕ (h/2) v`, where the midpoint is brought onto the constraints before its acceleration is taken. That is the one
/// thing which is continuous there: pushes at the ends of a step are not, and their directions turn within it. Order 2.
/// `None` where the iteration does not settle.
pub(super) fn passing<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    t: T,
    h: T,
) -> Option<(SVector<T, NV>, State<T, NQ, NV>)> {
    let half = h * constant(0.5);
    let middle = start.t + half;
    let mut v = start.v;
    for _ in 0..MOST_ITERATIONS {
        let q = system.integrate(&start.q, &(v * half));
        let (q, on) = system.project(middle, &q, &v).ok()?;
        let gain = system.acceleration(middle, &q, &on) * half;
        let change = largest(&(start.v + gain - v));
        v = start.v + gain;
        if !is_finite(&v) {
            return None;
        }
        // Accelerations are not known better there.
        if change <= epsilon::<T>().cbrt() * largest(&gain) || change <= epsilon::<T>() * largest(&v) {
            let q = system.integrate(&start.q, &(v * h));
            return settled(system, State { t, q, v: v + gain }, start.t).ok().map(|end| (v, end));
        }
    }
    None
}
