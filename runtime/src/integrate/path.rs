//! What happened between the ends of a step: the interpolating polynomial.

use super::{Dynamics, State};
use crate::Real;
use nalgebra::SVector;

/// How a state moves within a step.
///
/// A polynomial of degree seven in `θ` over [0, 1], in the nested form of Hairer, Nørsett and Wanner, *Solving
/// Ordinary Differential Equations I* (1993), II.6: `y = r₁ + θ (r₂ + (1−θ) (r₃ + θ (r₄ + (1−θ) (r₅ + θ (r₆ + …)))))`.
#[derive(Clone, Copy, Debug)]
pub struct Path<T, const N: usize> {
    start: SVector<T, N>,
    change: SVector<T, N>,
    square: SVector<T, N>,
    cube: SVector<T, N>,
    fourth: SVector<T, N>,
    /// Of degree five to seven.
    higher: [SVector<T, N>; 3],
}

impl<T: Real, const N: usize> Path<T, N> {
    /// The straight line between two values.
    pub fn linear(start: SVector<T, N>, end: SVector<T, N>) -> Self {
        let zero = SVector::zeros();
        Self { start, change: end - start, square: zero, cube: zero, fourth: zero, higher: [zero; 3] }
    }

    /// The cubic with values `start`, `end` and changes over the whole step `h ẏ` of `before`, `after` at its ends.
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

    /// Adds `θ² (1−θ)² r₅`, which keeps values and rates at both ends.
    pub fn with_fourth(self, fourth: SVector<T, N>) -> Self {
        Self { fourth, ..self }
    }

    /// From `r₃` on, those that are not given zero.
    pub(super) fn with_terms<const K: usize>(self, terms: [SVector<T, N>; K]) -> Self {
        let zero = SVector::zeros();
        let at = |k: usize| terms.get(k).copied().unwrap_or(zero);
        Self { square: at(0), cube: at(1), fourth: at(2), higher: [at(3), at(4), at(5)], ..self }
    }

    /// The value at `theta`, 0 at the start and 1 at the end.
    pub fn at(&self, theta: T) -> SVector<T, N> {
        let rest = T::one() - theta;
        let [fifth, sixth, seventh] = &self.higher;
        let high = fifth + (sixth + seventh * theta) * rest;
        let inner = self.square + (self.cube + (self.fourth + high * theta) * rest) * theta;
        self.start + (self.change + inner * rest) * theta
    }
}

/// One accepted step: its ends and all states in between.
#[derive(Clone, Copy, Debug)]
pub struct Step<T, const NQ: usize, const NV: usize> {
    /// State at the beginning.
    pub start: State<T, NQ, NV>,
    /// State at the end.
    pub end: State<T, NQ, NV>,
    /// `φ` with `q = q₀ ⊕ φ`.
    pub displacement: Path<T, NV>,
    /// `v`.
    pub velocity: Path<T, NV>,
}

impl<T: Real, const NQ: usize, const NV: usize> Step<T, NQ, NV> {
    /// A step through which `φ` and `v` go on straight lines.
    pub fn linear(start: State<T, NQ, NV>, end: State<T, NQ, NV>, displacement: SVector<T, NV>) -> Self {
        Self {
            start,
            end,
            displacement: Path::linear(SVector::zeros(), displacement),
            velocity: Path::linear(start.v, end.v),
        }
    }

    /// A step through which `φ` and `v` go on cubics, by the velocities and accelerations at its ends.
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

    /// The state at `theta`, 0 at the start and 1 at the end.
    pub fn at<D: Dynamics<T, NQ, NV>>(&self, system: &D, theta: T) -> State<T, NQ, NV> {
        State {
            t: self.start.t + theta * (self.end.t - self.start.t),
            q: system.integrate(&self.start.q, &self.displacement.at(theta)),
            v: self.velocity.at(theta),
        }
    }
}
