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
use crate::speeds;
use nalgebra::SVector;

/// Iterations allowed for one step; a step well inside the region of convergence takes about ten.
pub(super) const MOST_ITERATIONS: usize = 100;

/// The displacement from `q` to a midpoint after a time `half`: there the configuration moves with the velocity `v`.
pub(super) fn way<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    half: T,
) -> SVector<T, NV> {
    if system.has_speeds() {
        speeds::way(|way| system.displacement_rate(q, way, v), v, half)
    } else {
        v * half
    }
}

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

/// Iterations that steps take at most whose end is well in reach of the derivatives at their start, and those after which it
/// is not.
const FEW_ITERATIONS: usize = 8;
const MANY_ITERATIONS: usize = 24;

/// Beyond this share of the velocity, what many iterations have changed in half a step is another motion.
const LEAP: f64 = 0.5;

/// A solved midpoint.
pub(super) struct Middle<T, const NV: usize> {
    /// Its velocity.
    pub v: SVector<T, NV>,
    /// The displacement of the whole step.
    pub way: SVector<T, NV>,
    /// The momentum after the step, before the push at its end.
    pub p: SVector<T, NV>,
    iterations: usize,
}

/// Whether the place where a step has ended is singular, if that is known.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ended(Option<bool>);

/// Whether a step cannot be trusted to have `found` its end since it begins or ends in a singular position or, if that took many
/// iterations, led to another motion or failed, leads past one: it may begin well before and end well behind.
pub(super) fn is_crossing<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    start: &State<T, NQ, NV>,
    h: T,
    found: &Result<Middle<T, NV>, Error>,
    ended: &mut Ended,
) -> bool {
    let singular = |t: T, q: &SVector<T, NQ>| system.is_nearly_singular(t, q, &SVector::zeros());
    let near = |v: &SVector<T, NV>| largest(&(v - start.v)) <= largest(&start.v) * constant(LEAP);
    let quick = |found: &&Middle<T, NV>| {
        found.iterations <= if near(&found.v) { MANY_ITERATIONS } else { FEW_ITERATIONS }
    };
    if let Some(found) = found.as_ref().ok().filter(quick) {
        // Pushes in a singular end leave in the velocity what these constraints alone forbid.
        let before = ended.0.unwrap_or_else(|| singular(start.t, &start.q));
        let after = singular(start.t + h, &system.integrate(&start.q, &found.way));
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

/// How much of a change is made. Where constraints have turned at the end of a step by as much as they are away from a
/// singular position, iterations with the derivatives at its start creep, or overshoot again and again in one direction;
/// what two changes have in common tells by how much (Irons and Tuck, *A version of the Aitken accelerator for computer
/// iteration*, Int. J. Numer. Meth. Eng. 1, 1969).
struct Pace<T, const NV: usize> {
    last: SVector<T, NV>,
    share: T,
}

impl<T: Real, const NV: usize> Pace<T, NV> {
    /// The share of a change; all of it as long as changes become clearly smaller.
    fn next(&mut self, change: &SVector<T, NV>) -> T {
        let (now, before) = (largest(change), largest(&self.last));
        let slow = before > T::zero() && now > before * constant(0.3) && now < before * constant(1e3);
        // By their sizes, lest their squares overflow or vanish.
        let (own, last) = (change / before, self.last / before);
        let bend = own - last;
        let found = -self.share * last.dot(&bend) / bend.norm_squared();
        self.share = if slow && found > constant(0.05) && found < constant(8.0) { found } else { T::one() };
        self.last = *change;
        self.share
    }
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
    let (half, two) = (h * constant(0.5), constant::<T>(2.0));
    let t = start.t + half;
    let mut settling = Settling::new(half);
    let mut pace = Pace { last: SVector::zeros(), share: T::one() };
    for iterations in 0..MOST_ITERATIONS {
        let q = system.integrate(&start.q, &way(system, &start.q, &v, half));
        let gain = rate(system, t, &q, &v) * half;
        let own = system.momentum(t, &q, &v);
        let change = system.impulse(start.t, &start.q, &v, h, &(p + gain - own));
        v += change * pace.next(&change);
        if !is_finite(&v) {
            return Err(lost(start.t, iterations));
        }
        if settling.is_done(largest(&change), &q, &v) {
            let way = way(system, &start.q, &v, half);
            let q = system.integrate(&start.q, &way);
            let p = system.momentum(t, &q, &v) + rate(system, t, &q, &v) * half;
            return Ok(Middle { v, p, way: way * two, iterations });
        }
    }
    Err(Error::NotConverged { t: to_f64(start.t), iterations: MOST_ITERATIONS })
}

/// The end of a step near a singular position, and the displacement that leads there: with the velocity of the midpoint `v = v₀ + (h/2) v̇(q_m, v)` with
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
    let mut last: Option<T> = None;
    for iteration in 0..MOST_ITERATIONS {
        let way = way(system, &start.q, &v, half);
        let q = system.integrate(&start.q, &way);
        let (q, on) = system.project(middle, &q, &v).ok()?;
        let mut gain = system.acceleration(middle, &q, &on) * half;
        // Rounding of the place may lead round in a circle.
        let circles = iteration >= FEW_ITERATIONS;
        if circles {
            gain = (gain + v - start.v) * constant::<T>(0.5);
        }
        let change = largest(&(start.v + gain - v));
        v = start.v + gain;
        if !is_finite(&v) {
            return None;
        }
        // Accelerations are not known better there.
        let known = epsilon::<T>().cbrt();
        let stalls = last.is_some_and(|last| change >= last);
        let settles = change <= known * largest(&gain)
            || change <= epsilon::<T>() * largest(&v)
            || (circles && stalls && change <= known * largest(&v));
        if settles {
            let way = self::way(system, &start.q, &v, half) * constant::<T>(2.0);
            let q = system.integrate(&start.q, &way);
            return settled(system, State { t, q, v: v + gain }, start.t).ok().map(|end| (way, end));
        }
        last = Some(change);
    }
    None
}
