//! Accelerations in singular positions, from the motion that passes through.

use super::{Structure, System, Weak, far, zone};
use crate::Real;
use crate::constraint::Constrained;
use crate::private::constant;
use nalgebra::SVector;

/// The motion to third order about an instant: acceleration and jerk.
type Course<T, const NV: usize> = (SVector<T, NV>, SVector<T, NV>);

/// The acceleration of the motion that passes through a state, from those a little before and after, which are
/// interpolated. The states there are predicted from the acceleration `least` and better ones that follow, and brought
/// onto the constraints. `None` where the position is singular there as well, or nothing moves.
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
    state: (&SVector<T, NQ>, &SVector<T, NV>),
    tau: &SVector<T, NV>,
    least: SVector<T, NV>,
) -> Option<SVector<T, NV>>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let size = |x: &SVector<T, NV>| x.iter().fold(T::zero(), |most, x| most.max(x.abs()));
    let (speed, rate, half) = (size(state.1), size(&least), constant::<T>(0.5));
    let far = far::<T>();
    let step = (far + far) / (speed + (speed * speed + constant::<T>(2.0) * rate * far).sqrt());
    let moves = step > T::zero() && step.is_finite();
    if !moves {
        return None;
    }
    let at = |h: T, course: &Course<T, NV>| {
        let (q, v) = moved(mechanism, t + h, state, h, course)?;
        let system = System::of(mechanism, t + h, (&q, &v), tau);
        let ((a, _), regular) = system.solve(structure, zone::<T>() * half, Weak::Taken);
        (regular && a.iter().all(|a| a.is_finite())).then_some(a)
    };
    let mut course = (least, SVector::zeros());
    for _ in 0..2 {
        let (before, after) = (at(-step, &course)?, at(step, &course)?);
        course = ((before + after) * half, (after - before) * (half / step));
    }
    // The polynomial of degree five through six points.
    let both = |k: f64| Some(at(step * constant(-k), &course)? + at(step * constant(k), &course)?);
    let [near, middle, beyond] = [both(1.0)?, both(2.0)?, both(3.0)?];
    Some(near * constant::<T>(0.75) - middle * constant::<T>(0.3) + beyond * constant::<T>(0.05))
}

/// The state a time `h` later.
fn moved<M, T: Real, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(
    mechanism: &M,
    t: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    h: T,
    (a, jerk): &Course<T, NV>,
) -> Option<(SVector<T, NQ>, SVector<T, NV>)>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let (half, third) = (constant::<T>(0.5), constant::<T>(1.0 / 3.0));
    let displacement = (v + (a + jerk * (h * third)) * (h * half)) * h;
    let later = v + (a + jerk * (h * half)) * h;
    let q = mechanism.project_configuration(t, &mechanism.integrate(q, &displacement)).ok()?;
    // What is left of the constraints decides here: once more, although it is rounding.
    let residuals = mechanism.constraint_residuals(t, &q);
    let gap = SVector::from_fn(|k, _| residuals.get(k).copied().unwrap_or(T::zero()));
    let q = mechanism.integrate(&q, &mechanism.constraint_correction(t, &q, &gap));
    let v = mechanism.project_velocity(t, &q, &later).ok()?;
    Some((q, v))
}
