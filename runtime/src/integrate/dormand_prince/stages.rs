//! The seven stages of one step, its error estimate and its interpolating polynomial.

use crate::Real;
use crate::integrate::{Dynamics, State, Step};
use crate::private::constant;
use nalgebra::SVector;

/// `φ̇` and `v̇` at one stage.
#[derive(Clone, Copy)]
pub(super) struct Rates<T, const NV: usize> {
    pub(super) displacement: SVector<T, NV>,
    pub(super) velocity: SVector<T, NV>,
}

/// A step that the error estimate has still to accept.
pub(super) struct Trial<T, const NQ: usize, const NV: usize> {
    pub(super) step: Step<T, NQ, NV>,
    /// `φ` at the end.
    pub(super) displacement: SVector<T, NV>,
    /// Acceleration at the end.
    pub(super) acceleration: SVector<T, NV>,
    /// Difference of the results of order 5 and 4.
    pub(super) error: Rates<T, NV>,
}

/// `h Σ weight · rates`.
fn sum<T: Real, const NV: usize, const N: usize>(h: T, terms: [(f64, &Rates<T, NV>); N]) -> Rates<T, NV> {
    let mut total = Rates { displacement: SVector::zeros(), velocity: SVector::zeros() };
    for (weight, rates) in terms {
        let weight = h * constant(weight);
        total.displacement += rates.displacement * weight;
        total.velocity += rates.velocity * weight;
    }
    total
}

/// The rates at time `t`, after the change `change` from `start`; the state there.
fn stage<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    t: T,
    change: &Rates<T, NV>,
) -> (Rates<T, NV>, State<T, NQ, NV>) {
    let v = start.v + change.velocity;
    let q = system.integrate(&start.q, &change.displacement);
    let displacement = system.tangent_rate(&change.displacement, &v);
    let velocity = system.acceleration(t, &q, &v);
    (Rates { displacement, velocity }, State { t, q, v })
}

/// One step of length `h` that ends at `t`. Hairer, Nørsett and Wanner, II, table 5.2 and (6.12).
pub(super) fn stages<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    acceleration: &SVector<T, NV>,
    h: T,
    t: T,
) -> Trial<T, NQ, NV> {
    let after = |part: f64| start.t + h * constant(part);
    let k1 = &Rates { displacement: start.v, velocity: *acceleration };
    let change = sum(h, [(1.0 / 5.0, k1)]);
    let k2 = &stage(system, start, after(1.0 / 5.0), &change).0;
    let change = sum(h, [(3.0 / 40.0, k1), (9.0 / 40.0, k2)]);
    let k3 = &stage(system, start, after(3.0 / 10.0), &change).0;
    let change = sum(h, [(44.0 / 45.0, k1), (-56.0 / 15.0, k2), (32.0 / 9.0, k3)]);
    let k4 = &stage(system, start, after(4.0 / 5.0), &change).0;
    let change = sum(
        h,
        [(19372.0 / 6561.0, k1), (-25360.0 / 2187.0, k2), (64448.0 / 6561.0, k3), (-212.0 / 729.0, k4)],
    );
    let k5 = &stage(system, start, after(8.0 / 9.0), &change).0;
    let change = sum(
        h,
        [
            (9017.0 / 3168.0, k1),
            (-355.0 / 33.0, k2),
            (46732.0 / 5247.0, k3),
            (49.0 / 176.0, k4),
            (-5103.0 / 18656.0, k5),
        ],
    );
    let k6 = &stage(system, start, t, &change).0;
    let change = sum(
        h,
        [
            (35.0 / 384.0, k1),
            (500.0 / 1113.0, k3),
            (125.0 / 192.0, k4),
            (-2187.0 / 6784.0, k5),
            (11.0 / 84.0, k6),
        ],
    );
    let (k7, end) = stage(system, start, t, &change);
    let error = sum(
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
    let fourth = sum(
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
    Trial { step, displacement, acceleration: k7.velocity, error }
}
