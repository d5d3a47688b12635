//! Several states of a linkage in SIMD lanes pass singular configurations in the same way as single states.

use linkwork::batch::{Lockstep, Rollout, unwatched};
use linkwork::prelude::*;

/// Two cranks of equal length with a coupler as long as the distance of their pivots, in the horizontal
/// plane. The coupler moves without rotation, and the cranks keep their speed. With all links on the line
/// through both pivots, the constraints lose rank.
#[mechanism(batch)]
struct Parallelogram {
    #[body(mass = 1, com = x / 2, inertia = rod(1, 1, x))]
    left: Body,
    #[body(mass = 1, com = x / 2, inertia = rod(1, 1, x))]
    right: Body,
    #[body(mass = 2, com = x, inertia = rod(2, 2, x))]
    coupler: Body,
    #[joint(ground -> left, about = z)]
    a: Pin,
    #[joint(ground.at(2 * x) -> right, about = z)]
    b: Pin,
    #[joint(left.at(x) -> coupler, about = z)]
    c: Pin,
    #[joint(coupler.at(2 * x) -> right.at(x), about = z)]
    d: Pin,
}

/// Returns the largest error of a crank's angle after two and a half revolutions, over eight states.
fn largest_angle_error<S: Lockstep<f64>>(method: S, steps: usize, time: f64) -> f64 {
    const COUNT: usize = 8;
    let initial_crank_rate = |k: usize| 5.0 * core::f64::consts::PI / time + 0.01 * k as f64;
    let initial_angle = |k: usize| 0.3 + 0.05 * k as f64;
    let entries_grouped_by_coordinate = |f: &dyn Fn(usize) -> f64| {
        // The array is grouped by coordinate. Both cranks rotate by the same angle, and the coupler's
        // relative angle is its negative.
        [1.0, 1.0, -1.0].iter().flat_map(|sign| (0..COUNT).map(move |k| sign * f(k))).collect::<Vec<f64>>()
    };
    let (mut q, mut v) =
        (entries_grouped_by_coordinate(&initial_angle), entries_grouped_by_coordinate(&initial_crank_rate));
    let zero_inputs = |_, _, _: &_, _: &_| SVector::zeros();
    let rollout = Rollout::new(method, steps);
    Parallelogram {}
        .lanes::<4>()
        .roll_out(&rollout, &mut q, &mut v, zero_inputs, unwatched)
        .expect("no step fails");
    (0..COUNT).map(|k| (q[k] - initial_angle(k) - initial_crank_rate(k) * time).abs()).fold(0.0, f64::max)
}

#[test]
fn batched_states_pass_singular_configurations() {
    for steps in [400, 1500, 4000] {
        let step = 2.0 / steps as f64;
        let error = largest_angle_error(Rk4::step(step), steps, 2.0);
        assert!(error < 1e-6, "Rk4: {error} with {steps} steps");
        let error = largest_angle_error(SemiImplicitEuler::step(step), steps, 2.0);
        assert!(error < 1e-6, "SemiImplicitEuler: {error} with {steps} steps");
    }
}
