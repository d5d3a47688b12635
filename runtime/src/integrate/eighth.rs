//! The method of Dormand and Prince of order 8 with adaptive steps.

use super::adaptive::{
    AdaptiveMemory, AdaptiveSettings, StepControl, TrialStepArguments, TrialStepResult, adaptive,
};
use super::stages::{RungeKuttaRates, rates_at_stage, weighted_sum_over_stage_indices};
use super::{Dynamics, Error, Jump, Method, State, Step};
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

mod coefficients;

use coefficients::{FIFTH, STAGES, TERMS, THIRD, TIMES};

/// Constants of the step-size controller of DOP853.
pub(super) const CONTROL: StepControl = StepControl { exponent: 1.0 / 8.0, beta: 0.0, factors: [6.0, 3.0] };

/// Index of the stage at the end of the step.
const END: usize = 12;

/// The Dormand–Prince method of order 8 with error estimates of orders 5 and 3 and interpolation of order 7.
/// Suited to reference solutions and tight tolerances, for which its steps are many times longer than those
/// of [`DormandPrince`](super::DormandPrince).
///
/// Twelve evaluations of the dynamics per step, and three more for a step that contains samples or events.
/// The error norm is that of [`DormandPrince`](super::DormandPrince).
///
/// ```
/// # use linkwork::integrate::DormandPrince8;
/// let method = DormandPrince8::new().tolerance(1e-13, 1e-13);
/// # let _: DormandPrince8<f64> = method;
/// ```
///
/// Sources: Prince and Dormand, *High order embedded Runge–Kutta formulae*, J. Comp. Appl. Math. 7 (1981);
/// Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I* (1993), II.5, II.6, II.10 and the
/// program DOP853.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DormandPrince8<T> {
    settings: AdaptiveSettings<T>,
}

adaptive!(DormandPrince8, CONTROL, trial_step);

/// Returns a step, with its interpolating polynomial if `dense`.
pub(super) fn trial_step<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    attempt: &TrialStepArguments<'_, T, NQ, NV>,
    dense: bool,
) -> TrialStepResult<T, NQ, NV> {
    let TrialStepArguments { start, acceleration, scale, h, t } = *attempt;
    let mut k = [RungeKuttaRates { displacement: start.v, velocity: *acceleration }; 16];
    let mut evaluate_stages = |k: &mut [RungeKuttaRates<T, NV>; 16], stages: core::ops::Range<usize>| {
        let mut end = *start;
        let weights = STAGES.iter().skip(stages.start - 1);
        for ((index, weights), part) in stages.clone().zip(weights).zip(TIMES.iter().skip(stages.start)) {
            let time = if *part == 1.0 { t } else { start.t + h * constant(*part) };
            let (rates, state) =
                rates_at_stage(system, start, time, &weighted_sum_over_stage_indices(h, weights, k));
            if let Some(place) = k.get_mut(index) {
                *place = rates;
            }
            end = state;
        }
        end
    };
    evaluate_stages(&mut k, 1..END);
    let change = weighted_sum_over_stage_indices(h, STAGES[END - 1], &k);
    let end = evaluate_stages(&mut k, END..END + 1);
    let displacement = change.displacement;
    let mut step = Step::linear(*start, end, displacement);
    let fifth = scale.relative_error(&step, &displacement, &weighted_sum_over_stage_indices(h, FIFTH, &k));
    let third = scale.relative_error(&step, &displacement, &weighted_sum_over_stage_indices(h, THIRD, &k));
    let both = fifth * fifth + third * third * constant(0.01);
    let error = if both == T::zero() { both } else { fifth * fifth / both.sqrt() };
    let after = k[END];
    if dense && error <= T::one() {
        evaluate_stages(&mut k, END + 1..16);
        let [a, b, c, d] = TERMS.map(|weights| weighted_sum_over_stage_indices(h, weights, &k));
        let quadratic_and_cubic_path_terms =
            |before: &SVector<T, NV>, change: &SVector<T, NV>, after: &SVector<T, NV>| {
                (before * h - change, change * constant::<T>(2.0) - (before + after) * h)
            };
        let (square, cube) = quadratic_and_cubic_path_terms(&start.v, &displacement, &after.displacement);
        let terms = [square, cube, a.displacement, b.displacement, c.displacement, d.displacement];
        step.displacement = step.displacement.with_coefficients_from_third(terms);
        let (square, cube) =
            quadratic_and_cubic_path_terms(acceleration, &(end.v - start.v), &after.velocity);
        step.velocity = step
            .velocity
            .with_coefficients_from_third([square, cube, a.velocity, b.velocity, c.velocity, d.velocity]);
    }
    TrialStepResult { step, acceleration: Some(after.velocity), error }
}
