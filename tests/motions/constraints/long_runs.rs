//! Constrained motions over many fixed steps: order of the methods, and energy without drift.

use linkwork::batch::{Rollout, unwatched};
use linkwork::integrate::Method;
use linkwork::prelude::*;
use linkwork_models::{BallInBowl, RollingDisk};

/// Four-bar linkage whose mass matrix and Coriolis forces depend on the configuration.
#[mechanism(gravity = -9.81 * y, batch)]
struct FourBar {
    #[body(mass = 1, com = 0.4 * x, inertia = rod(1, 0.8, x))]
    crank: Body,
    #[body(mass = 2, com = 0.95 * x, inertia = rod(2, 1.9, x))]
    coupler: Body,
    #[body(mass = 1, com = 0.4 * x, inertia = rod(1, 0.8, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    first: Pin,
    #[joint(crank.at(0.8 * x) -> coupler, about = z)]
    second: Pin,
    #[joint(ground.at(2 * x) -> rocker, about = z)]
    third: Pin,
    #[joint(rocker.at(0.8 * x) -> coupler.at(1.9 * x), about = z)]
    closing: Pin,
}

/// Pendulum in Cartesian coordinates of a plane, with the length of the rod as a constraint.
#[mechanism(gravity = -9.81 * y)]
struct CartesianPendulum {
    #[particle(mass = 1)]
    bob: Particle,
    #[joint(ground -> bob, along = (x, y))]
    place: Stage,
    #[constraint(norm(r(bob / ground)) = 1)]
    rod: Holonomic,
}

/// Body with quaternion coordinates that hangs on a rod, which is a distance constraint of one of its points.
#[mechanism(gravity = -9.81 * z)]
struct BodyHungOnRod {
    #[body(mass = 1, inertia = diagonal(0.1, 0.2, 0.25))]
    body: Body,
    #[joint(ground -> body)]
    free: Free,
    #[constraint(norm(r(body.at(0.3 * x + 0.1 * y) / ground)) = 1)]
    rod: Holonomic,
}

/// Disk with quaternion coordinates that rolls on a plane.
#[mechanism(gravity = -9.81 * z)]
struct FreeDiskRollingOnPlane {
    #[body(mass = 2, inertia = disk(2, 0.4, y))]
    disk: Body,
    #[joint(ground -> disk)]
    free: Free,
    #[constraint(rolls(disk.circle(0.4, y), ground.plane(z)))]
    contact: Rolling,
}

const DISK: RollingDisk = RollingDisk { g: 9.81, m: 2.0, radius: 0.4 };
const BOWL: BallInBowl = BallInBowl { g: 9.81, mass: 0.3, radius: 0.05, bowl: 0.45 };

/// Mechanism with the initial state of a long run.
struct MechanismWithStart<'m, M, const NQ: usize, const NV: usize> {
    m: &'m M,
    q: SVector<f64, NQ>,
    v: SVector<f64, NV>,
}

impl<'m, M, const NQ: usize, const NV: usize> MechanismWithStart<'m, M, NQ, NV> {
    fn assemble_near_guess<const NU: usize, const NH: usize, const NC: usize>(
        m: &'m M,
        q: [f64; NQ],
        v: [f64; NV],
    ) -> Self
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64>,
    {
        let q = m.assemble(0.0, &q.into(), &[]).expect("a configuration is near");
        let v = m.project_velocity(0.0, &q, &v.into()).expect("a velocity is near");
        Self { m, q, v }
    }

    /// Returns the observed order of convergence from the errors with steps of `h` and `h / 2`.
    fn observed_order<const NU: usize, S: Method<f64>>(&self, method: fn(f64) -> S, h: f64) -> f64
    where
        M: Mechanism<NQ, NV, NU, Scalar = f64>,
    {
        let simulate_start = || simulate(self.m).from(self.q, self.v).duration(0.5);
        let exact =
            simulate_start().method(DormandPrince::new().tolerance(1e-12, 1e-12)).finish().expect("it moves");
        let error_with_step = |h: f64| {
            let end = simulate_start().method(method(h)).finish().expect("it moves");
            self.m.difference(&exact.q, &end.q).norm() + (end.v - exact.v).norm()
        };
        (error_with_step(h) / error_with_step(h / 2.0)).log2()
    }

    /// Returns the maximum energy errors in the first and in the last quarter of a run, and the mean errors.
    fn energy_errors<const NU: usize, const NH: usize, const NC: usize, S: Method<f64>>(
        &self,
        method: S,
        h: f64,
        steps: usize,
    ) -> ([f64; 2], [f64; 2])
    where
        M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64> + Mechanism<NQ, NV, NU, Scalar = f64>,
    {
        let total_energy = |q: &_, v: &_| {
            Mechanism::kinetic_energy(self.m, 0.0, q, v) + Mechanism::potential_energy(self.m, 0.0, q)
        };
        let start = total_energy(&self.q, &self.v);
        let (mut worst, mut mean) = ([0.0_f64; 2], [0.0; 2]);
        let run = simulate(self.m).from(self.q, self.v).method(method).duration(h * steps as f64);
        for (k, sample) in run.enumerate() {
            let Sample { q, v, .. } = sample.expect("it moves");
            let quarter = 4 * k / steps;
            let off = total_energy(&q, &v) - start;
            if quarter == 0 || quarter == 3 {
                let late = usize::from(quarter == 3);
                worst[late] = worst[late].max(off.abs());
                mean[late] += off * 4.0 / steps as f64;
            }
            let off = self.m.constraint_residuals(0.0, &q).amax() / q.amax().max(1.0);
            let slip = self.m.constraint_rates(0.0, &q, &v).amax() / v.amax().max(1.0);
            assert!(off < 1e-13 && slip < 1e-13, "step {k}: {off:e}, {slip:e}");
        }
        (worst, mean)
    }
}

/// The methods have orders 1 and 2 for loops, quaternions and rolling.
#[test]
fn constrained_steps_have_orders_one_and_two() {
    macro_rules! check {
        ($($start:expr, $h:expr;)+) => {$({
            let start = $start;
            let orders = [
                start.observed_order(SemiImplicitEuler::step, $h),
                start.observed_order(ImplicitMidpoint::step, $h),
            ];
            assert!((orders[0] - 1.0).abs() < 0.1 && (orders[1] - 2.0).abs() < 0.05, "{orders:?}");
        })+};
    }
    check! {
        MechanismWithStart::assemble_near_guess(&CartesianPendulum {}, [0.6, -0.8], [0.4, 0.3]), 5e-3;
        MechanismWithStart::assemble_near_guess(&FourBar {}, [1.2, -1.0, 1.4], [2.0, 0.0, 0.0]), 5e-3;
        MechanismWithStart::assemble_near_guess(&BodyHungOnRod {},
            [0.0, 0.1, -1.0, 0.0, 0.1, 0.1, 0.98], [0.5, 0.2, 0.0, 1.0, 2.0, -1.0]), 5e-3;
        MechanismWithStart::assemble_near_guess(&DISK, [0.0, 0.0, 0.4, 0.5, 0.3, 0.7], [0.0, 0.0, 0.0, 0.5,
            0.3, 6.0]), 2.5e-3;
        MechanismWithStart::assemble_near_guess(&BOWL,
            [0.2, 0.1, -0.33, 0.5, 0.5, -0.5, 0.5], [0.5, 0.2, 0.0, 1.0, 2.0, -1.0]), 5e-3;
    }
}

/// The energy oscillates with an amplitude of the method's order and does not drift.
#[test]
fn constrained_energy_does_not_drift() {
    macro_rules! check {
        ($($start:expr, $euler:expr, $midpoint:expr;)+) => {$({
            let start = $start;
            let (worst, mean) = start.energy_errors(SemiImplicitEuler::step(2e-3), 2e-3, 8000);
            assert!(worst[0] < $euler && worst[1] < 1.2 * worst[0], "{worst:?}");
            assert!((mean[1] - mean[0]).abs() < 0.1 * worst[0], "{mean:?} of {worst:?}");
            let (worst, mean) = start.energy_errors(ImplicitMidpoint::step(2e-3), 2e-3, 8000);
            assert!(worst[0] < $midpoint && worst[1] < 1.2 * worst[0], "{worst:?}");
            assert!((mean[1] - mean[0]).abs() < 0.1 * worst[0], "{mean:?} of {worst:?}");
        })+};
    }
    check! {
        MechanismWithStart::assemble_near_guess(&CartesianPendulum {}, [0.6, -0.8], [0.4, 0.3]), 1e-2, 1e-4;
        MechanismWithStart::assemble_near_guess(&FourBar {}, [1.2, -1.0, 1.4], [2.0, 0.0, 0.0]), 0.3, 4e-2;
        MechanismWithStart::assemble_near_guess(&DISK, [0.0, 0.0, 0.4, 0.5, 0.3, 0.7], [0.0, 0.0, 0.0, 0.5,
            0.3, 6.0]), 0.1, 1e-2;
        MechanismWithStart::assemble_near_guess(&FreeDiskRollingOnPlane {},
            [0.0, 0.0, 0.39, 0.2, 0.0, 0.0, 0.98], [0.0, 0.0, 0.0, 0.3, 6.0, 0.5]), 0.1, 1e-2;
        MechanismWithStart::assemble_near_guess(&BOWL,
            [0.2, 0.1, -0.33, 0.5, 0.5, -0.5, 0.5], [0.5, 0.2, 0.0, 1.0, 2.0, -1.0]), 2e-3, 1e-4;
    }
}

/// A pendulum of 1 m released at 0.6 rad never moves faster than √(2 g (1 − cos 0.6)) = 1.85 m/s.
#[test]
fn constrained_pendulum_gains_no_energy() {
    let pendulum = CartesianPendulum {};
    let run = simulate(&pendulum).from([0.6_f64.sin(), -0.6_f64.cos()], [0.0, 0.0]).duration(100.0);
    for sample in run.method(SemiImplicitEuler::step(0.01)) {
        assert!(sample.expect("it swings").v.norm() < 1.9);
    }
}

/// A four-bar linkage with 26.8 J keeps its energy; regression test: it gained 0.19 J in 4 s and 45 J in 12
/// s.
#[test]
fn four_bar_linkage_conserves_energy() {
    let start = MechanismWithStart::assemble_near_guess(&FourBar {}, [1.2, -1.0, 1.4], [2.0, 0.0, 0.0]);
    let (worst, _) = start.energy_errors(ImplicitMidpoint::step(1e-3), 1e-3, 12_000);
    assert!(worst[1] < 1e-2, "{worst:?}");
}

/// The implicit midpoint rule is reversible: with the velocity reversed at the end, a motion returns to its
/// start, with loops, quaternions and rolling.
#[test]
fn midpoint_rule_is_reversible() {
    fn check_reversibility<M, const NQ: usize, const NV: usize, const NU: usize>(
        start: &MechanismWithStart<'_, M, NQ, NV>,
    ) where
        M: Mechanism<NQ, NV, NU, Scalar = f64>,
    {
        let method = ImplicitMidpoint::step(0.01);
        let there = simulate(start.m).from(start.q, start.v).method(method).duration(2.0).finish();
        let there = there.expect("it moves");
        let back = simulate(start.m).from(there.q, -there.v).method(method).duration(2.0).finish();
        let back = back.expect("it moves");
        let off = start.m.difference(&start.q, &back.q).amax().max((back.v + start.v).amax());
        assert!(off < 1e-9, "{off:e}");
    }
    check_reversibility(&MechanismWithStart::assemble_near_guess(
        &FourBar {},
        [1.2, -1.0, 1.4],
        [2.0, 0.0, 0.0],
    ));
    check_reversibility(&MechanismWithStart::assemble_near_guess(
        &BodyHungOnRod {},
        [0.0, 0.1, -1.0, 0.0, 0.1, 0.1, 0.98],
        [0.5, 0.2, 0.0, 1.0, 2.0, -1.0],
    ));
    check_reversibility(&MechanismWithStart::assemble_near_guess(
        &FreeDiskRollingOnPlane {},
        [0.0, 0.0, 0.39, 0.2, 0.0, 0.0, 0.98],
        [0.0, 0.0, 0.0, 0.3, 6.0, 0.5],
    ));
}

/// Steps that are too long for the curvature of the constraints return an error.
#[test]
fn overlong_constrained_steps_are_errors() {
    let pendulum = CartesianPendulum {};
    let simulate_pendulum = || simulate(&pendulum).from([1.0, 0.0], [0.0, 50.0]).duration(10.0);
    for end in [
        simulate_pendulum().method(ImplicitMidpoint::step(1.0)).finish(),
        simulate_pendulum().method(SemiImplicitEuler::step(1.0)).finish(),
    ] {
        assert!(matches!(end, Err(Error::NotConverged { .. })), "{end:?}");
    }
}

/// Checks that the midpoint rule, for constraints stabilized by feedback, converges to the motion of other
/// methods.
#[test]
fn midpoint_rule_integrates_constraint_feedback() {
    let pendulum = CartesianPendulum {};
    let steady = linkwork::constraint::stabilized(&pendulum, 20.0);
    let steady_linkage_run = || simulate(&steady).from([0.6, -0.8], [0.4, 0.3]).duration(1.0);
    let exact = steady_linkage_run()
        .method(DormandPrince::new().tolerance(1e-10, 1e-10))
        .finish()
        .expect("it swings");
    let end = steady_linkage_run().method(ImplicitMidpoint::step(1e-3)).finish().expect("it swings");
    assert!((end.q - exact.q).norm() < 1e-5 && (end.v - exact.v).norm() < 1e-4, "{end:?} for {exact:?}");
}

/// The motion of a state in a rollout is independent of the other states.
#[test]
fn constrained_rollout_states_are_independent() {
    let linkage = FourBar {};
    let states: Vec<_> = [1.2, 1.3, 1.5]
        .map(|crank| MechanismWithStart::assemble_near_guess(&linkage, [crank, -1.0, 1.4], [2.0, 0.0, 0.0]))
        .into();
    let entries_of_all_states =
        |entry: &dyn Fn(&MechanismWithStart<'_, FourBar, 3, 3>, usize) -> f64| -> Vec<f64> {
            (0..3).flat_map(|i| states.iter().map(move |s| entry(s, i))).collect()
        };
    let (mut q, mut v) = (entries_of_all_states(&|s, i| s.q[i]), entries_of_all_states(&|s, i| s.v[i]));
    let rollout = Rollout::new(SemiImplicitEuler::step(1e-3), 200);
    linkage
        .lanes::<4>()
        .roll_out(&rollout, &mut q, &mut v, |_, _, _, _| SVector::zeros(), unwatched)
        .expect("they move");
    for (k, state) in states.iter().enumerate() {
        let (mut own_q, mut own_v) = (state.q.as_slice().to_vec(), state.v.as_slice().to_vec());
        linkage
            .lanes::<1>()
            .roll_out(&rollout, &mut own_q, &mut own_v, |_, _, _, _| SVector::zeros(), unwatched)
            .expect("it moves");
        let run =
            simulate(&linkage).from(state.q, state.v).method(SemiImplicitEuler::step(1e-3)).duration(0.2);
        let end = run.finish().expect("it moves");
        for i in 0..3 {
            assert_eq!((q[3 * i + k], v[3 * i + k]), (own_q[i], own_v[i]));
            assert!((own_q[i] - end.q[i]).abs() < 1e-10 && (own_v[i] - end.v[i]).abs() < 1e-9);
        }
    }
}
