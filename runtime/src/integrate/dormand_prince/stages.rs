//! Stages of one Dormand–Prince step of order 5, with error estimate and interpolating polynomial.

use crate::Real;
use crate::integrate::adaptive::{TrialStepArguments, TrialStepResult};
use crate::integrate::stages::{RungeKuttaRates, rates_at_stage, weighted_sum_of_rates};
use crate::integrate::{Dynamics, Step};
use crate::private::constant;

/// Returns one Dormand–Prince step of length `h` that ends at `t`, computed by seven stages (Hairer, Nørsett
/// and Wanner, II, table 5.2 and (6.12)).
pub(super) fn dormand_prince_step<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    attempt: &TrialStepArguments<'_, T, NQ, NV>,
) -> TrialStepResult<T, NQ, NV> {
    let TrialStepArguments { start, acceleration, scale, h, t } = *attempt;
    let time_at_fraction = |part: f64| start.t + h * constant(part);
    let k1 = &RungeKuttaRates { displacement: start.v, velocity: *acceleration };
    let change = weighted_sum_of_rates(h, [(1.0 / 5.0, k1)]);
    let k2 = &rates_at_stage(system, start, time_at_fraction(1.0 / 5.0), &change).0;
    let change = weighted_sum_of_rates(h, [(3.0 / 40.0, k1), (9.0 / 40.0, k2)]);
    let k3 = &rates_at_stage(system, start, time_at_fraction(3.0 / 10.0), &change).0;
    let change = weighted_sum_of_rates(h, [(44.0 / 45.0, k1), (-56.0 / 15.0, k2), (32.0 / 9.0, k3)]);
    let k4 = &rates_at_stage(system, start, time_at_fraction(4.0 / 5.0), &change).0;
    let change = weighted_sum_of_rates(
        h,
        [(19372.0 / 6561.0, k1), (-25360.0 / 2187.0, k2), (64448.0 / 6561.0, k3), (-212.0 / 729.0, k4)],
    );
    let k5 = &rates_at_stage(system, start, time_at_fraction(8.0 / 9.0), &change).0;
    let change = weighted_sum_of_rates(
        h,
        [
            (9017.0 / 3168.0, k1),
            (-355.0 / 33.0, k2),
            (46732.0 / 5247.0, k3),
            (49.0 / 176.0, k4),
            (-5103.0 / 18656.0, k5),
        ],
    );
    let k6 = &rates_at_stage(system, start, t, &change).0;
    let change = weighted_sum_of_rates(
        h,
        [
            (35.0 / 384.0, k1),
            (500.0 / 1113.0, k3),
            (125.0 / 192.0, k4),
            (-2187.0 / 6784.0, k5),
            (11.0 / 84.0, k6),
        ],
    );
    let (k7, end) = rates_at_stage(system, start, t, &change);
    let error = weighted_sum_of_rates(
        h,
        [
            (71.0 / 57600.0, k1),
            (-71.0 / 16695.0, k3),
            (71.0 / 1920.0, k4),
            (-17253.0 / 339200.0, k5),
            (22.0 / 525.0, k6),
            (-1.0 / 40.0, &k7),
        ],
    );
    let fourth = weighted_sum_of_rates(
        h,
        [
            (-12715105075.0 / 11282082432.0, k1),
            (87487479700.0 / 32700410799.0, k3),
            (-10690763975.0 / 1880347072.0, k4),
            (701980252875.0 / 199316789632.0, k5),
            (-1453857185.0 / 822651844.0, k6),
            (69997945.0 / 29380423.0, &k7),
        ],
    );
    let displacement = change.displacement;
    let step =
        Step::linear(*start, end, displacement).cubic(system, &displacement, [*acceleration, k7.velocity]);
    let step = Step {
        displacement: step.displacement.with_fourth(fourth.displacement),
        velocity: step.velocity.with_fourth(fourth.velocity),
        ..step
    };
    let error = scale.relative_error(&step, &displacement, &error);
    TrialStepResult { step, acceleration: Some(k7.velocity), error }
}
