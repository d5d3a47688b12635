//! Accelerations in singular positions, from the motion that passes through.

use super::{Structure, System, Weak, far, zone};
use crate::Real;
use crate::constraint::Constrained;
use crate::private::{constant, epsilon};
use nalgebra::SVector;

/// The motion to third order about an instant: acceleration and jerk.
type Course<T, const NV: usize> = (SVector<T, NV>, SVector<T, NV>);

/// A way along the branch that a state is on.
struct Way<T, const NQ: usize, const NV: usize> {
    t: T,
    q: SVector<T, NQ>,
    v: SVector<T, NV>,
    /// The velocity of the way, and whether it is that of the state, which time goes on with.
    heading: SVector<T, NV>,
    moves: bool,
}

/// The largest magnitude of the entries.
pub(super) fn size<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    x.iter().fold(T::zero(), |most, x| most.max(x.abs()))
}

/// The acceleration `A f + c` of the motion that passes through a state, interpolated from a little before and after.
///
/// How accelerations follow from forces, `A`, and what they are without, `c`, depend on where a branch is and how fast it is
/// passed, and change little over the way; forces of stiff elements change as much as they like, and are therefore those
/// at the state. The way leads along the velocity of the state or, at rest, along the acceleration `least`. `None` where
/// the position is singular around as well, or nothing moves.
pub(super) fn acceleration<
    M,
    T: Real,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    mechanism: &M,
    structure: &Structure<NC>,
    t: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    force: &[T; NV],
    least: &SVector<T, NV>,
) -> Option<SVector<T, NV>>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let (speed, rate) = (size(v), size(least));
    // Velocities have a direction beyond rounding. Where constraints move by themselves, slow ones tell little.
    let driven = size(&mechanism.constraint_rates(t, q, &SVector::zeros())) > T::zero();
    let clear = speed > epsilon::<T>().cbrt();
    let moves = clear && (!driven || speed * speed > rate * far::<T>() * constant(0.03));
    let way = Way { t, q: *q, v: *v, heading: if moves { *v } else { *least }, moves };
    let (clear, within) = (far::<T>() * constant(0.4), zone::<T>() * constant(0.5));
    let passed = |way: &Way<T, NQ, NV>, parts: &[f64], clear: T| {
        let pace = far::<T>() / size(&way.heading);
        let goes = pace > T::zero() && pace.is_finite();
        let steps = parts.iter().filter(|_| goes).map(|part| pace * constant(*part));
        steps.into_iter().find_map(|step| interpolated(mechanism, structure, &way.points(step, clear), force))
    };
    // Farther on, or nearer, other things happen.
    passed(&way, &[1.0, 2.0], clear)
        .or_else(|| passed(&aside(mechanism, structure, &way)?, &[1.0, 2.0, 4.0, 8.0, 0.5], clear))
        .or_else(|| passed(&way, &[4.0, 16.0], clear))
        .or_else(|| passed(&way, &[1.0, 0.5, 0.25], within))
}

/// Another way along the branch, for states whose velocity leads out slowly beside that of other coordinates: into a direction
/// with all of them, which a little before and after is known well enough.
fn aside<M, T: Real, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(
    mechanism: &M,
    structure: &Structure<NC>,
    way: &Way<T, NQ, NV>,
) -> Option<Way<T, NQ, NV>>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let own = far::<T>() / size(&way.heading);
    let any = SVector::from_fn(|k, _| constant::<T>([1.0, -0.7, 0.9, 0.6, -0.8][k % 5]));
    // Pushes as large as inertia move heavy bodies, and equal ones light bodies.
    let pushes = [(mechanism.mass_matrix(way.t, &way.q) * any).data.0[0], any.data.0[0]];
    let still = Way { v: SVector::zeros(), moves: false, ..*way };
    let heading = [0.1, 0.3, 1.0].into_iter().find_map(|part| {
        let points = still.points(own * constant(part), epsilon::<T>().cbrt());
        let course = (SVector::zeros(), SVector::zeros());
        let at = |h: T, force: &[T; NV]| points.at(mechanism, structure, h, &course, force);
        let along = |force: &[T; NV]| {
            let both = at(-points.step, force)? + at(points.step, force)?;
            Some(both / size(&both))
        };
        Some(along(&pushes[0])? + along(&pushes[1])? * constant::<T>(0.8))
    })?;
    Some(Way { heading, moves: false, ..*way })
}

/// Points of a way, a `step` apart, with rows of more than the size `clear`.
struct Points<'a, T, const NQ: usize, const NV: usize> {
    way: &'a Way<T, NQ, NV>,
    step: T,
    clear: T,
}

impl<T: Real, const NQ: usize, const NV: usize> Way<T, NQ, NV> {
    fn points(&self, step: T, clear: T) -> Points<'_, T, NQ, NV> {
        Points { way: self, step, clear }
    }
}

impl<T: Real, const NQ: usize, const NV: usize> Points<'_, T, NQ, NV> {
    /// The acceleration under a force, `h` along the way.
    fn at<M, const NU: usize, const NH: usize, const NC: usize>(
        &self,
        mechanism: &M,
        structure: &Structure<NC>,
        h: T,
        course: &Course<T, NV>,
        force: &[T; NV],
    ) -> Option<SVector<T, NV>>
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
    {
        let (t, q, v) = moved(mechanism, self.way, h, course)?;
        let system = System::under(mechanism, t, (&q, &v), *force);
        let ((a, _), regular) = system.solve(structure, self.clear, Weak::Taken);
        (regular && a.iter().all(|a| a.is_finite())).then_some(a)
    }
}

/// The polynomial of degree five through six points of a way.
fn interpolated<
    M,
    T: Real,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    mechanism: &M,
    structure: &Structure<NC>,
    points: &Points<'_, T, NQ, NV>,
    force: &[T; NV],
) -> Option<SVector<T, NV>>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let (step, half) = (points.step, constant::<T>(0.5));
    let at =
        |h: T, course: &Course<T, NV>, force: &[T; NV]| points.at(mechanism, structure, h, course, force);
    let mut course = (SVector::zeros(), SVector::zeros());
    // Free of forces, the way bends as little as the branch lets it.
    for _ in 0..if points.way.moves { 2 } else { 0 } {
        let none = [T::zero(); NV];
        let (before, after) = (at(-step, &course, &none)?, at(step, &course, &none)?);
        course = ((before + after) * half, (after - before) * (half / step));
    }
    let both =
        |k: f64| Some(at(step * constant(-k), &course, force)? + at(step * constant(k), &course, force)?);
    let [near, middle, beyond] = [both(1.0)?, both(2.0)?, both(3.0)?];
    Some(near * constant::<T>(0.75) - middle * constant::<T>(0.3) + beyond * constant::<T>(0.05))
}

/// Time and state `h` along a way, on the constraints.
fn moved<M, T: Real, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(
    mechanism: &M,
    way: &Way<T, NQ, NV>,
    h: T,
    (a, jerk): &Course<T, NV>,
) -> Option<(T, SVector<T, NQ>, SVector<T, NV>)>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let (half, third) = (constant::<T>(0.5), constant::<T>(1.0 / 3.0));
    let t = if way.moves { way.t + h } else { way.t };
    let displacement = (way.heading + (a + jerk * (h * third)) * (h * half)) * h;
    let later = way.v + (a + jerk * (h * half)) * h;
    let q = mechanism.project_configuration(t, &mechanism.integrate(&way.q, &displacement)).ok()?;
    // What is left of the constraints decides here: once more, although it is rounding.
    let residuals = mechanism.constraint_residuals(t, &q);
    let gap = SVector::from_fn(|k, _| residuals.get(k).copied().unwrap_or(T::zero()));
    let q = mechanism.integrate(&q, &mechanism.constraint_correction(t, &q, &gap));
    let v = mechanism.project_velocity(t, &q, &later).ok()?;
    Some((t, q, v))
}
