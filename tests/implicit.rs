//! Implicit methods with generated derivatives: the motion equals that with finite differences, with fewer
//! evaluations of the dynamics.

use linkwork::contact::{self, Touch};
use linkwork::integrate::{DormandPrince8, Hooks, Method, Rodas, Rosenbrock};
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork::{ByMotion, ConstrainedDerivatives, Mechanism, at, constraint::stabilized};
use linkwork_models::{CarAxle, RollingDisk};
use support::counting::CountingMechanism;
use support::differences::derivative_columns;

/// Cart with a pendulum, on a stiff spring and dashpot.
#[mechanism(gravity = -9.81 * y, derivatives, batch)]
struct CartOnStiffSpring {
    #[body(mass = 1)]
    cart: Body,
    #[body(mass = 0.3, com = -0.5 * y)]
    bob: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> bob, about = z)]
    hinge: Pin,
    #[acts(on = rail, stiffness = 1e5)]
    buffer: Spring,
    #[acts(on = rail, damping = 2e3)]
    oil: Dashpot,
    #[acts(on = hinge)]
    motor: Torque,
}

/// Cart with a pendulum, on a stiff spring and dashpot, with a motor that has a lag.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct CartWithMotorLag {
    lag: f64,
    command: Input,
    #[state(rate = (command - torque) / lag)]
    torque: State,
    #[body(mass = 0.3, com = -0.5 * y)]
    bob: Body,
    #[joint(ground -> bob, about = z)]
    hinge: Pin,
    #[acts(on = hinge, value = torque)]
    motor: Torque,
}

/// Four-bar linkage with a stiff spring and a stiff dashpot at its crank.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct FourBar {
    #[body(mass = 1, com = x / 2)]
    crank: Body,
    #[body(mass = 2, com = x, inertia = rod(2, 2, x))]
    coupler: Body,
    #[body(mass = 1, com = 0.75 * x)]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(x) -> coupler, about = z)]
    left: Pin,
    #[joint(ground.at(2 * x) -> rocker, about = z)]
    pivot: Pin,
    #[joint(coupler.at(2 * x) -> rocker.at(1.5 * x), about = z)]
    right: Pin,
    #[acts(on = main, stiffness = 1e4)]
    buffer: Spring,
    #[acts(on = main, damping = 1e3)]
    oil: Dashpot,
    #[acts(on = pivot)]
    motor: Torque,
}

/// Trunk on a leg that stands on the ground.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct Hopper {
    #[body(mass = 5)]
    trunk: Body,
    #[joint(ground -> trunk, along = (x, y))]
    air: Stage,
    #[body(mass = 0.4, com = -0.2 * y, inertia = rod(0.4, 0.4, y))]
    leg: Body,
    #[joint(trunk -> leg, about = z)]
    hip: Pin,
    #[acts(on = hip)]
    motor: Torque,
    #[acts(on = hip, stiffness = 1e4)]
    buffer: Spring,
    #[acts(on = hip, damping = 1e3)]
    oil: Dashpot,
    #[contact(leg.at(-0.4 * y), ground.plane(y), friction = 0.9)]
    foot: Contact,
}

/// Particle that a constraint keeps on a circle, with an input force.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct ParticleOnCircle {
    #[particle(mass = 2)]
    bob: Particle,
    #[joint(ground -> bob, along = (x, y))]
    place: Stage,
    #[constraint(norm(r(bob / ground)) = 1)]
    rod: Holonomic,
    #[acts(on = place.x)]
    push: Force,
}

/// Returns the number of evaluations of the dynamics in a single step of RODAS.
fn count_step_evaluations<M, const NQ: usize, const NV: usize>(
    m: &M,
    q: SVector<f64, NQ>,
    v: SVector<f64, NV>,
) -> [usize; 2]
where
    M: Mechanism<NQ, NV, 1, Scalar = f64>,
{
    fn count_evaluations<M, const NQ: usize, const NV: usize, const KNOWN: bool>(
        m: &CountingMechanism<'_, M, KNOWN>,
        q: SVector<f64, NQ>,
        v: SVector<f64, NV>,
    ) -> usize
    where
        M: Mechanism<NQ, NV, 1, Scalar = f64>,
    {
        let method = Rodas::new().tolerance(1e-2, 1e-2).initial_step(1e-6).max_step(1e-6);
        simulate(m).from(q, v).method(method).duration(1e-6).finish().unwrap();
        m.evaluations.get()
    }
    [
        count_evaluations(&CountingMechanism::<_, true>::new(m), q, v),
        count_evaluations(&CountingMechanism::<_, false>::new(m), q, v),
    ]
}

/// Returns the ends of a run under feedback, with generated derivatives and with differences.
fn end_states_with_both_derivatives<M, S, const NQ: usize, const NV: usize>(
    m: &M,
    (q, v): (SVector<f64, NQ>, SVector<f64, NV>),
    method: S,
) -> [(SVector<f64, NQ>, SVector<f64, NV>); 2]
where
    M: Mechanism<NQ, NV, 1, Scalar = f64>,
    S: Method<f64> + Clone,
{
    fn end_state_under_feedback<M, S, const NQ: usize, const NV: usize, const KNOWN: bool>(
        m: &CountingMechanism<'_, M, KNOWN>,
        (q, v): (SVector<f64, NQ>, SVector<f64, NV>),
        method: S,
    ) -> (SVector<f64, NQ>, SVector<f64, NV>)
    where
        M: Mechanism<NQ, NV, 1, Scalar = f64>,
        S: Method<f64>,
    {
        let last = NV - 1;
        let run = simulate(m).from(q, v).method(method).duration(0.1);
        let run = run.inputs(move |t, q, v| [(3.0 * t).sin() - 2.0 * q[NQ - 1] - 0.5 * v[last]].into());
        let end = run.finish().unwrap();
        (end.q, end.v)
    }
    let known = end_state_under_feedback(&CountingMechanism::<_, true>::new(m), (q, v), method.clone());
    [known, end_state_under_feedback(&CountingMechanism::<_, false>::new(m), (q, v), method)]
}

#[track_caller]
fn check_runs_with_differences<M, const NQ: usize, const NV: usize>(
    m: &M,
    start: (SVector<f64, NQ>, SVector<f64, NV>),
) where
    M: Mechanism<NQ, NV, 1, Scalar = f64>,
{
    let [known, differences] =
        end_states_with_both_derivatives(m, start, Rodas::new().tolerance(1e-8, 1e-10));
    let largest_state_difference =
        |a: &(SVector<f64, NQ>, SVector<f64, NV>), b: &(SVector<f64, NQ>, SVector<f64, NV>)| {
            (a.0 - b.0).amax().max((a.1 - b.1).amax())
        };
    assert!(largest_state_difference(&known, &differences) < 1e-6, "{known:?} and {differences:?}");
    let [fixed, other] = end_states_with_both_derivatives(m, start, Rosenbrock::step(4e-5));
    assert!(largest_state_difference(&fixed, &other) < 1e-6, "{fixed:?} and {other:?}");
    // The methods have orders 2 and 4.
    assert!(largest_state_difference(&fixed, &known) < 1e-4, "{fixed:?} and {known:?}");
}

fn closed_linkage_state(m: &FourBar) -> (SVector<f64, 3>, SVector<f64, 3>) {
    let q = m.assemble(&[1.2, -0.8, 1.5].into(), &[0]).unwrap();
    (q, m.project_velocity(&q, &[0.5, 0.0, 0.0].into()).unwrap())
}

#[test]
fn generated_derivatives_yield_the_same_implicit_motion() {
    check_runs_with_differences(&CartOnStiffSpring {}, ([0.01, 0.4].into(), [0.0, 1.0].into()));
    check_runs_with_differences(
        &CartWithMotorLag { lag: 1e-3, torque: 0.0 }.extended(),
        ([0.4].into(), [1.0, 0.2].into()),
    );
    let bar = FourBar {};
    check_runs_with_differences(&bar, closed_linkage_state(&bar));
    let hopper = Hopper {};
    let stance = contact::hold(&hopper, [Touch::Sticks]).stabilized(20.0);
    check_runs_with_differences(&stance, ([0.0, 0.4, 0.0].into(), [0.4, 0.0, -1.0].into()));
    check_runs_with_differences(&stabilized(&bar, 20.0), closed_linkage_state(&bar));
}

#[test]
fn implicit_method_has_order_four() {
    let late = CartWithMotorLag { lag: 0.4, torque: 0.0 };
    let whole = late.extended();
    let end_with_method = |method: Rodas<f64>| {
        end_states_with_both_derivatives(&whole, ([0.4].into(), [1.0, 0.2].into()), method)[0]
    };
    let end_with_fixed_steps =
        |h: f64| end_with_method(Rodas::new().tolerance(1e6, 1e6).initial_step(h).max_step(h));
    let exact = end_with_method(Rodas::new().tolerance(1e-13, 1e-14));
    let error_with_step = |h: f64| (end_with_fixed_steps(h).1 - exact.1).norm();
    let order = (error_with_step(0.05) / error_with_step(0.025)).log2();
    assert!((order - 4.0).abs() < 0.4, "{order}: {:e}", error_with_step(0.05));
}

/// Under constraints the order of convergence is four, with generated derivatives and with differences.
#[test]
fn implicit_method_has_order_four_under_constraints() {
    let start = ([0.0, -1.0].into(), [2.5, 0.0].into());
    let precise = end_states_with_both_derivatives(
        &ParticleOnCircle {},
        start,
        DormandPrince8::new().tolerance(1e-13, 1e-13),
    )[0];
    let fixed_step_method = |h: f64| Rodas::new().tolerance(1e6, 1e6).initial_step(h).max_step(h);
    let errors_with_step = |h: f64| {
        end_states_with_both_derivatives(&ParticleOnCircle {}, start, fixed_step_method(h))
            .map(|end| (end.0 - precise.0).norm())
    };
    for (coarse, fine) in errors_with_step(0.05).into_iter().zip(errors_with_step(0.0125)) {
        let order = (coarse / fine).log2() / 2.0;
        assert!(order > 3.6, "{order}: {coarse:e}, {fine:e}");
    }
}

/// After weeks and years of simulated time, adjacent floating-point numbers of the clock are farther apart
/// than the differences in time that the method would take. Forces that depend on time then cost no more
/// steps. The motion changes only by the effect of the clock's rounding on the forces.
#[test]
fn large_clock_times_cost_no_extra_steps() {
    let cart = CartOnStiffSpring {};
    let end_state_from_start_time = |start: f64| {
        let counted = CountingMechanism::<_, true>::new(&cart);
        let run = simulate(&counted).from([0.01, 0.4], [0.0, 1.0]).start_at(start).duration(1.0);
        let run = run.inputs(|t, _, _| [5.0 * (3.0 * (t - start)).sin()].into());
        let end = run.clone().method(Rodas::new().tolerance(1e-9, 1e-9)).finish().unwrap();
        let count = counted.evaluations.get();
        let fixed = run.method(Rosenbrock::step(1e-3)).finish().unwrap();
        (count, end.q, fixed.q)
    };
    let (count, precise, fixed) = end_state_from_start_time(0.0);
    for power in [10, 20, 26] {
        let start = 2.0_f64.powi(power);
        let (found, adaptive, equal) = end_state_from_start_time(start);
        assert!(found * 10 <= count * 12, "{count} evaluations, {found} after {start} s");
        let tick = start * f64::EPSILON;
        for gap in [(adaptive - precise).amax(), (equal - fixed).amax()] {
            assert!(gap <= 1e-9 + 15.0 * tick, "{gap:e} after {start} s");
        }
    }
}

#[test]
fn generated_derivatives_save_two_evaluations_per_velocity() {
    let [known, differences] =
        count_step_evaluations(&CartOnStiffSpring {}, [0.01, 0.4].into(), [0.0, 1.0].into());
    assert_eq!((known, differences - known), (8, 4));
    let late = CartWithMotorLag { lag: 1e-3, torque: 0.0 };
    let [known, differences] = count_step_evaluations(&late.extended(), [0.4].into(), [1.0, 0.2].into());
    assert_eq!((known, differences - known), (8, 4));
    let bar = FourBar {};
    let (q, v) = closed_linkage_state(&bar);
    let [known, differences] = count_step_evaluations(&bar, q, v);
    assert_eq!((known, differences - known), (8, 6));
    let [known, differences] = count_step_evaluations(&stabilized(&bar, 20.0), q, v);
    assert_eq!((known, differences - known), (8, 6));
    let hopper = Hopper {};
    let stance = contact::hold(&hopper, [Touch::Sticks]);
    let [known, differences] =
        count_step_evaluations(&stance, [0.0, 0.4, 0.0].into(), [0.4, 0.0, -1.0].into());
    assert_eq!((known, differences - known), (8, 6));
}

#[test]
fn wrappers_forward_unchanged_derivatives() {
    let (cart, q, v, u) = (CartOnStiffSpring {}, [0.01, 0.4].into(), [0.0, 1.0].into(), [0.3].into());
    let known = Hooks::acceleration_derivatives(&cart, 0.0, &q, &v, &u);
    assert!(known.is_some());
    assert_eq!(known, Hooks::acceleration_derivatives(&&cart, 0.0, &q, &v, &u));
    assert_eq!(known, Hooks::acceleration_derivatives(&at(&cart, 0.0), 0.0, &q, &v, &u));
    let linear = cart.linear_motion(&q, &v, &u);
    assert_eq!(known, Some((linear.by_q, linear.by_v, linear.by_u)));
}

/// Returns `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂u)` by central differences of eighth order.
fn acceleration_derivatives_by_differences<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    t: f64,
    (q, v): (&SVector<f64, NQ>, &SVector<f64, NV>),
    u: &SVector<f64, NU>,
) -> ByMotion<f64, NV, NU>
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let forward_dynamics_with_input = |q: &SVector<f64, NQ>, v: &SVector<f64, NV>, u: &SVector<f64, NU>| {
        m.forward_dynamics(t, q, v, &m.generalized_forces(t, q, v, u))
    };
    (
        derivative_columns([5e-4; _], |dq| forward_dynamics_with_input(&m.integrate(q, &dq), v, u)),
        derivative_columns([5e-4; _], |dv| forward_dynamics_with_input(q, &(v + dv), u)),
        derivative_columns([5e-4; _], |du| forward_dynamics_with_input(q, v, &(u + du))),
    )
}

/// Checks that the derivatives of stabilized accelerations, which let constraint violations decay, equal
/// differences, also in states that violate the constraints.
#[track_caller]
fn check_stabilized_derivatives<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    t: f64,
    state: (SVector<f64, NQ>, SVector<f64, NV>),
) where
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = f64>,
{
    let u = SVector::repeat(0.7);
    let state_entry_offset = |k: usize| 0.01 * (1.0 + k as f64).sin();
    let beside = (
        m.integrate(&state.0, &SVector::from_fn(|k, _| state_entry_offset(k))),
        state.1 + SVector::from_fn(|k, _| state_entry_offset(k + NV)),
    );
    for (q, v) in [state, beside] {
        let steady = stabilized(m, 12.0);
        let expected = acceleration_derivatives_by_differences(&steady, t, (&q, &v), &u);
        let found = steady.acceleration_derivatives(t, &q, &v, &u).unwrap();
        let whole = at(&steady, t).linear_motion(&q, &v, &u);
        let by_hand = (whole.by_q, whole.by_v, whole.by_u);
        assert_eq!(found, by_hand);
        let tau = steady.generalized_forces(t, &q, &v, &u);
        assert!((whole.acceleration - steady.forward_dynamics(t, &q, &v, &tau)).amax() < 1e-9);
        let size = expected.0.amax().max(expected.1.amax());
        for gap in [found.0 - expected.0, found.1 - expected.1] {
            assert!(gap.amax() < 1e-8 * size, "{gap:e} of {size:e}");
        }
        // Accelerations are linear in the inputs: the error is only the rounding of accelerations.
        assert!((found.2 - expected.2).iter().all(|gap| gap.abs() < 1e-9 + 1e-12 * size));
        // Both views of the constrained mechanism give the same derivatives.
        assert_eq!(Some(found), at(m, t).stabilized_derivatives(0.0, (&q, &v), &u, 12.0));
    }
}

/// Stabilized derivatives exist for closed loops, a rod, a rolling wheel and a moving road.
#[test]
fn stabilized_constraints_have_derivatives() {
    check_stabilized_derivatives(&ParticleOnCircle {}, 0.0, ([0.6, -0.8].into(), [0.8, 0.6].into()));
    let bar = FourBar {};
    check_stabilized_derivatives(&bar, 0.0, closed_linkage_state(&bar));
    let disk = RollingDisk { g: 9.81, m: 0.5, radius: 0.2 };
    let q = [0.1, 0.2, 0.19, 0.4, 0.3, 0.2].into();
    check_stabilized_derivatives(
        &disk,
        0.0,
        (q, disk.project_velocity(&q, &[0.3, 0.2, 0.0, 0.5, 0.1, -2.0].into()).unwrap()),
    );
    check_stabilized_derivatives(
        &CarAxle {},
        0.3,
        ([0.0, 0.5, 1.0, 0.5].into(), [-0.5, 0.0, -0.5, 0.0].into()),
    );
}

/// Checks that each SIMD lane has the derivatives of its own state, and that an implicit method moves each
/// lane as it moves a single state.
#[test]
fn implicit_lanes_equal_single_states() {
    let cart = CartOnStiffSpring {};
    let lanes = cart.lanes::<4>();
    let splat = Lanes::<f64, 4>::splat;
    let lane_state =
        |k: usize| (SVector::from([0.01 * k as f64, 0.4]), SVector::from([0.0, 1.0 - 0.3 * k as f64]));
    let [q, v] = [0, 1].map(|part| {
        SVector::<Lanes<f64, 4>, 2>::from_fn(|i, _| {
            Lanes(std::array::from_fn(|k| if part == 0 { lane_state(k).0[i] } else { lane_state(k).1[i] }))
        })
    });
    let u = SVector::from([splat(0.3)]);
    let (by_q, by_v, by_u) = lanes.acceleration_derivatives(splat(0.0), &q, &v, &u).unwrap();
    let linear = at(&lanes, splat(0.0)).linear_motion(&q, &v, &u);
    assert_eq!((linear.by_q, linear.by_v, linear.by_u), (by_q, by_v, by_u));
    let end = simulate(&lanes).from(q, v).method(Rosenbrock::step(splat(1e-3))).duration(splat(0.1));
    let end = end.finish().unwrap();
    for k in 0..4 {
        let (q, v) = lane_state(k);
        let alone = Hooks::acceleration_derivatives(&cart, 0.0, &q, &v, &[0.3].into()).unwrap();
        let motion = cart.linear_motion(&q, &v, &[0.3].into());
        assert_eq!(motion.acceleration, linear.acceleration.map(|x| x.0[k]));
        assert_eq!(alone.0, by_q.map(|x| x.0[k]));
        assert_eq!(alone.1, by_v.map(|x| x.0[k]));
        assert_eq!(alone.2, by_u.map(|x| x.0[k]));
        let own = simulate(&cart).from(q, v).method(Rosenbrock::step(1e-3)).duration(0.1).finish().unwrap();
        assert!((own.q - end.q.map(|x| x.0[k])).amax() < 1e-12, "{own:?}");
    }
}
