//! Stages of Runge–Kutta methods: rates of a stage, weighted sums of rates, and the state reached by such a
//! sum.

use super::{Dynamics, State};
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

/// Rates `φ̇` and `v̇` of displacement and velocity at one Runge–Kutta stage.
#[derive(Clone, Copy)]
pub(super) struct RungeKuttaRates<T, const NV: usize> {
    pub displacement: SVector<T, NV>,
    pub velocity: SVector<T, NV>,
}

/// Returns the weighted sum `h Σ weight · rates` of the rates of several stages.
pub(super) fn weighted_sum_of_rates<T: Real, const NV: usize, const N: usize>(
    h: T,
    terms: [(f64, &RungeKuttaRates<T, NV>); N],
) -> RungeKuttaRates<T, NV> {
    let mut total = RungeKuttaRates { displacement: SVector::zeros(), velocity: SVector::zeros() };
    for (weight, rates) in terms {
        let weight = h * constant(weight);
        total.displacement += rates.displacement * weight;
        total.velocity += rates.velocity * weight;
    }
    total
}

/// Returns the rates at time `t` after the change `change` from `start`, and the state there.
pub(super) fn rates_at_stage<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    t: T,
    change: &RungeKuttaRates<T, NV>,
) -> (RungeKuttaRates<T, NV>, State<T, NQ, NV>) {
    let v = start.v + change.velocity;
    let q = system.integrate(&start.q, &change.displacement);
    let displacement = system.displacement_rate(&start.q, &change.displacement, &v);
    let velocity = system.acceleration(t, &q, &v);
    (RungeKuttaRates { displacement, velocity }, State { t, q, v })
}

/// Returns `h Σ weight · rates` over the stages with the given indices.
pub(super) fn weighted_sum_over_stage_indices<T: Real, const NV: usize, const K: usize>(
    h: T,
    weights: &[(usize, f64)],
    stages: &[RungeKuttaRates<T, NV>; K],
) -> RungeKuttaRates<T, NV> {
    let mut total = RungeKuttaRates { displacement: SVector::zeros(), velocity: SVector::zeros() };
    for (rates, weight) in weights.iter().filter_map(|(k, weight)| Some((stages.get(*k)?, weight))) {
        let weight = h * constant(*weight);
        total.displacement += rates.displacement * weight;
        total.velocity += rates.velocity * weight;
    }
    total
}
