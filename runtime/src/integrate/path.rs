//! Interpolation of states within a step by polynomials.

use super::{Dynamics, State};
use crate::Real;
use nalgebra::SVector;

/// Interpolating polynomial of a vector within a step.
///
/// It has degree seven in `θ` over [0, 1], in the nested form of Hairer, Nørsett and Wanner, *Solving
/// Ordinary Differential Equations I* (1993), II.6: `y = r₁ + θ (r₂ + (1−θ) (r₃ + θ (r₄ + (1−θ) (r₅ + θ (r₆ +
/// …)))))`.
#[derive(Clone, Copy, Debug)]
pub struct Path<T, const N: usize> {
    start: SVector<T, N>,
    change: SVector<T, N>,
    square: SVector<T, N>,
    cube: SVector<T, N>,
    fourth: SVector<T, N>,
    /// Coefficients of the interpolating polynomial for degrees five to seven.
    higher: [SVector<T, N>; 3],
}

impl<T: Real, const N: usize> Path<T, N> {
    /// Returns the polynomial that interpolates linearly between the values at the start and the end of a
    /// step.
    pub fn linear(start: SVector<T, N>, end: SVector<T, N>) -> Self {
        let zero = SVector::zeros();
        Self { start, change: end - start, square: zero, cube: zero, fourth: zero, higher: [zero; 3] }
    }

    /// Returns the cubic with the values `start` and `end`, and the rates `before` and `after` at its ends,
    /// each multiplied by the step length: `h ẏ`.
    pub fn cubic(
        start: SVector<T, N>,
        end: SVector<T, N>,
        before: SVector<T, N>,
        after: SVector<T, N>,
    ) -> Self {
        let line = Self::linear(start, end);
        let square = before - line.change;
        Self { square, cube: line.change - after - square, ..line }
    }

    /// Returns the polynomial with the additional term `θ² (1−θ)² r₅`, which does not change values and rates
    /// at the ends of the step.
    pub fn with_fourth(self, fourth: SVector<T, N>) -> Self {
        Self { fourth, ..self }
    }

    /// Sets the coefficients of the interpolating polynomial from the third on (`r₃`) to `terms`; further
    /// coefficients become zero.
    pub(super) fn with_coefficients_from_third<const K: usize>(self, terms: [SVector<T, N>; K]) -> Self {
        let zero = SVector::zeros();
        let term_or_zero = |k: usize| terms.get(k).copied().unwrap_or(zero);
        Self {
            square: term_or_zero(0),
            cube: term_or_zero(1),
            fourth: term_or_zero(2),
            higher: [term_or_zero(3), term_or_zero(4), term_or_zero(5)],
            ..self
        }
    }

    /// Returns the value of the interpolating polynomial at `theta`: 0 at the start of the step, 1 at its
    /// end.
    pub fn at(&self, theta: T) -> SVector<T, N> {
        let rest = T::one() - theta;
        let [fifth, sixth, seventh] = &self.higher;
        let high = fifth + (sixth + seventh * theta) * rest;
        let inner = self.square + (self.cube + (self.fourth + high * theta) * rest) * theta;
        self.start + (self.change + inner * rest) * theta
    }
}

/// Accepted step: its ends and the interpolation in between.
#[derive(Clone, Copy, Debug)]
pub struct Step<T, const NQ: usize, const NV: usize> {
    /// State at the start of the step.
    pub start: State<T, NQ, NV>,
    /// State at the end of the step.
    pub end: State<T, NQ, NV>,
    /// Displacement `φ` with `q = q₀ ⊕ φ`.
    pub displacement: Path<T, NV>,
    /// Polynomial of the velocity `v` within the step.
    pub velocity: Path<T, NV>,
}

impl<T: Real, const NQ: usize, const NV: usize> Step<T, NQ, NV> {
    /// Returns a step with linear interpolation of `φ` and `v`.
    pub fn linear(start: State<T, NQ, NV>, end: State<T, NQ, NV>, displacement: SVector<T, NV>) -> Self {
        Self {
            start,
            end,
            displacement: Path::linear(SVector::zeros(), displacement),
            velocity: Path::linear(start.v, end.v),
        }
    }

    /// Replaces the interpolation of displacement `φ` and velocity `v` by cubic polynomials, from velocities
    /// and accelerations at both ends of the step.
    pub fn cubic<D: Dynamics<T, NQ, NV>>(
        self,
        system: &D,
        displacement: &SVector<T, NV>,
        accelerations: [SVector<T, NV>; 2],
    ) -> Self {
        let h = self.end.t - self.start.t;
        let [before, after] = accelerations;
        let rate = system.displacement_rate(&self.start.q, displacement, &self.end.v);
        Self {
            displacement: Path::cubic(SVector::zeros(), *displacement, self.start.v * h, rate * h),
            velocity: Path::cubic(self.start.v, self.end.v, before * h, after * h),
            ..self
        }
    }

    /// Returns the interpolated state at `theta`: 0 at the start of the step, 1 at its end.
    pub fn at<D: Dynamics<T, NQ, NV>>(&self, system: &D, theta: T) -> State<T, NQ, NV> {
        State {
            t: self.start.t + theta * (self.end.t - self.start.t),
            q: system.integrate(&self.start.q, &self.displacement.at(theta)),
            v: self.velocity.at(theta),
        }
    }
}
