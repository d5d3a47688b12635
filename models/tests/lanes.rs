//! Checks that eight states at once in a build with debug assertions return the bits of single states, and
//! need no more stack than a small thread has.

use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use std::thread;

/// Quadruped Solo12 from its URDF file, with a free base.
#[mechanism(urdf = "urdf/solo12.urdf", base = free, batch, derivatives)]
struct Solo12;

/// Stack size of the test thread, bytes.
const STACK: usize = 128 << 10;

type QuadrupedConfiguration<T> = SVector<T, 19>;
type QuadrupedVelocity<T> = SVector<T, 18>;
type EightLanes = Lanes<f64, 8>;

/// Returns eight states of the quadruped in SIMD lanes, with configurations displaced from the neutral one.
fn eight_quadruped_states_in_lanes() -> (QuadrupedConfiguration<EightLanes>, QuadrupedVelocity<EightLanes>) {
    let v = QuadrupedVelocity::from_fn(|i, _| Lanes::from_fn(|k| ((i * i + 3 * k) as f64).sin()));
    let q = Solo12.neutral().map(Lanes::splat);
    (Solo12.integrate_lanes(&q, &v), v)
}

#[test]
fn eight_states_equal_single_states() {
    let (q, v) = eight_quadruped_states_in_lanes();
    let a = Solo12.forward_dynamics_lanes(&q, &v, &v);
    let mass = Solo12.mass_matrix_lanes(&q);
    let energy = Solo12.kinetic_energy_lanes(&q, &v);
    let (by_q, by_v, by_tau) = Solo12.forward_dynamics_derivatives_lanes(&q, &v, &v);
    for k in 0..8 {
        let (q, v) = (q.map(|x| x.0[k]), v.map(|x| x.0[k]));
        assert_eq!(a.map(|x| x.0[k]), Solo12.forward_dynamics(&q, &v, &v));
        assert_eq!(mass.map(|x| x.0[k]), Solo12.mass_matrix(&q));
        assert_eq!(energy.0[k], Solo12.kinetic_energy(&q, &v));
        let one = Solo12.forward_dynamics_derivatives(&q, &v, &v);
        assert_eq!(one, (by_q.map(|x| x.0[k]), by_v.map(|x| x.0[k]), by_tau.map(|x| x.0[k])));
    }
}

#[test]
fn eight_states_fit_in_a_small_stack() {
    let largest_lane_difference = || {
        let (q, v) = eight_quadruped_states_in_lanes();
        let a = Solo12.forward_dynamics(&q.map(|x| x.0[0]), &v.map(|x| x.0[0]), &QuadrupedVelocity::zeros());
        let eight = Solo12.forward_dynamics_lanes(&q, &v, &QuadrupedVelocity::zeros());
        (eight.map(|x| x.0[0]) - a).amax()
    };
    let thread = thread::Builder::new().stack_size(STACK).spawn(largest_lane_difference).expect("a thread");
    assert_eq!(thread.join().expect("it ends"), 0.0);
}
