//! Norm of the error, and estimate of the first step.

use super::stages::RungeKuttaRates;
use super::{Dynamics, State, Step};
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

/// Relative and absolute tolerance, and the numbers of coordinates and velocities in use.
pub(super) struct ErrorScale<T> {
    pub relative: T,
    pub absolute: T,
    pub dimensions: [usize; 2],
}

impl<T: Real> ErrorScale<T> {
    /// Returns the scale of every coordinate: its magnitude if configuration and tangent space have the same
    /// number of entries, otherwise 1.
    fn scales_of_coordinates<const NQ: usize, const NV: usize>(&self, q: &SVector<T, NQ>) -> SVector<T, NV> {
        let mut sizes: SVector<T, NV> = SVector::repeat(T::one());
        if self.dimensions[0] == self.dimensions[1] {
            sizes.iter_mut().zip(q.iter()).for_each(|(size, q)| *size = q.abs());
        }
        sizes
    }

    /// Returns `Σ (x / (absolute + relative · size))²`.
    fn sum_of_scaled_squares<const N: usize>(&self, x: &SVector<T, N>, size: &SVector<T, N>) -> T {
        x.iter().zip(size.iter()).fold(T::zero(), |sum, (x, size)| {
            let part = *x / (self.absolute + self.relative * *size);
            sum + part * part
        })
    }

    /// Returns the root mean square of displacement and velocity entries, each divided by its tolerance.
    fn scaled_norm<const N: usize>(&self, x: [&SVector<T, N>; 2], sizes: [&SVector<T, N>; 2]) -> T {
        let ([x, v], [x_size, v_size]) = (x, sizes);
        let sum = self.sum_of_scaled_squares(x, x_size) + self.sum_of_scaled_squares(v, v_size);
        (sum / constant((2 * self.dimensions[1].max(1)) as f64)).sqrt()
    }

    /// Returns the estimated error of a step relative to the tolerance: acceptable up to one; NaN if the step
    /// is NaN. `error` is the error estimate for displacement and velocity.
    pub fn relative_error<const NQ: usize, const NV: usize>(
        &self,
        step: &Step<T, NQ, NV>,
        displacement: &SVector<T, NV>,
        error: &RungeKuttaRates<T, NV>,
    ) -> T {
        let (start, end) = (&step.start, &step.end);
        let moved = displacement.abs();
        let size = elementwise_maximum(
            &elementwise_maximum(&self.scales_of_coordinates(&start.q), &self.scales_of_coordinates(&end.q)),
            &moved,
        );
        let speed = elementwise_maximum(&start.v.abs(), &end.v.abs());
        self.scaled_norm([&error.displacement, &error.velocity], [&size, &speed])
    }
}

/// Returns the elementwise maximum of two vectors.
fn elementwise_maximum<T: Real, const N: usize>(a: &SVector<T, N>, b: &SVector<T, N>) -> SVector<T, N> {
    a.zip_map(b, |a, b| a.max(b))
}

/// Returns a first step from the magnitudes of the state, its rate and the change of the rate: Hairer,
/// Nørsett and Wanner, II.4, "Starting step size".
pub(super) fn first_step_length<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    scale: &ErrorScale<T>,
    start: &State<T, NQ, NV>,
    acceleration: &SVector<T, NV>,
) -> T {
    let small = constant::<T>(1e-5);
    let size = scale.scales_of_coordinates(&start.q);
    let speed = start.v.abs();
    let scaled_state_norm =
        |x: &SVector<T, NV>, v: &SVector<T, NV>| scale.scaled_norm([x, v], [&size, &speed]);
    let (state, rate) = (scaled_state_norm(&size, &start.v), scaled_state_norm(&start.v, acceleration));
    let guess = if state < small || rate < small { constant(1e-6) } else { state / rate * constant(0.01) };
    let v = start.v + acceleration * guess;
    let q = system.integrate(&start.q, &(start.v * guess));
    let bend = system.acceleration(start.t + guess, &q, &v) - acceleration;
    let bend = scaled_state_norm(&(acceleration * guess), &bend) / guess;
    let sharpest = bend.max(rate);
    let step = if sharpest <= constant(1e-15) {
        (guess * constant(1e-3)).max(constant(1e-6))
    } else {
        (constant::<T>(0.01) / sharpest).powf(constant(0.2))
    };
    let step = step.min(guess * constant(100.0));
    if step.is_finite() && step > T::zero() { step } else { constant(1e-6) }
}
