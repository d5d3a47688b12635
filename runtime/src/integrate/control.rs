//! How large an error is, and how long the first step may be.

use super::stages::Rates;
use super::{Dynamics, State, Step};
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

/// The tolerances.
pub(super) struct Scale<T> {
    pub relative: T,
    pub absolute: T,
}

/// The size of every coordinate: its magnitude where configuration and tangent space have the same entries, else 1.
fn sizes<T: Real, const NQ: usize, const NV: usize>(q: &SVector<T, NQ>) -> SVector<T, NV> {
    let mut sizes: SVector<T, NV> = SVector::repeat(T::one());
    if NQ == NV {
        sizes.iter_mut().zip(q.iter()).for_each(|(size, q)| *size = q.abs());
    }
    sizes
}

impl<T: Real> Scale<T> {
    /// `Σ (x / (absolute + relative · size))²`.
    fn squares<const N: usize>(&self, x: &SVector<T, N>, size: &SVector<T, N>) -> T {
        x.iter().zip(size.iter()).fold(T::zero(), |sum, (x, size)| {
            let part = *x / (self.absolute + self.relative * *size);
            sum + part * part
        })
    }

    /// Root mean square over displacement and velocity, each measured by its tolerance.
    fn norm<const N: usize>(&self, x: [&SVector<T, N>; 2], sizes: [&SVector<T, N>; 2]) -> T {
        let ([x, v], [x_size, v_size]) = (x, sizes);
        let sum = self.squares(x, x_size) + self.squares(v, v_size);
        (sum / constant((2 * N.max(1)) as f64)).sqrt()
    }

    /// The estimated error of a step, `error` its change; acceptable up to one, NaN where the step is.
    pub fn error<const NQ: usize, const NV: usize>(
        &self,
        step: &Step<T, NQ, NV>,
        displacement: &SVector<T, NV>,
        error: &Rates<T, NV>,
    ) -> T {
        let (start, end) = (&step.start, &step.end);
        let moved = displacement.abs();
        let size = larger(&larger(&sizes(&start.q), &sizes(&end.q)), &moved);
        let speed = larger(&start.v.abs(), &end.v.abs());
        self.norm([&error.displacement, &error.velocity], [&size, &speed])
    }
}

/// The larger of every pair of entries.
fn larger<T: Real, const N: usize>(a: &SVector<T, N>, b: &SVector<T, N>) -> SVector<T, N> {
    a.zip_map(b, |a, b| a.max(b))
}

/// A first step from the sizes of the state, its rate and the change of the rate: Hairer, Nørsett and Wanner, II.4,
/// "Starting step size".
pub(super) fn first_step<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    scale: &Scale<T>,
    start: &State<T, NQ, NV>,
    acceleration: &SVector<T, NV>,
) -> T {
    let small = constant::<T>(1e-5);
    let size = sizes(&start.q);
    let speed = start.v.abs();
    let norm = |x: &SVector<T, NV>, v: &SVector<T, NV>| scale.norm([x, v], [&size, &speed]);
    let (state, rate) = (norm(&size, &start.v), norm(&start.v, acceleration));
    let guess = if state < small || rate < small { constant(1e-6) } else { state / rate * constant(0.01) };
    let v = start.v + acceleration * guess;
    let q = system.integrate(&start.q, &(start.v * guess));
    let bend = system.acceleration(start.t + guess, &q, &v) - acceleration;
    let bend = norm(&(acceleration * guess), &bend) / guess;
    let sharpest = bend.max(rate);
    let step = if sharpest <= constant(1e-15) {
        (guess * constant(1e-3)).max(constant(1e-6))
    } else {
        (constant::<T>(0.01) / sharpest).powf(constant(0.2))
    };
    let step = step.min(guess * constant(100.0));
    if step.is_finite() && step > T::zero() { step } else { constant(1e-6) }
}
