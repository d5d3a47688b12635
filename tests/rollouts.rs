//! Arrays of states and rollouts of many states give the results of single states, for any number of states,
//! lanes and threads.

use linkwork::batch::{Error, Lockstep, Progress, Rollout, unwatched};
use linkwork::integrate::{self, ContinuousInputs, State, System};
use linkwork::nalgebra::SVector;
use linkwork::prelude::{Batch, Lanes, Rk4, SemiImplicitEuler, mechanism};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use support::random::Random;

#[mechanism(urdf = "../models/urdf/ur5.urdf", batch)]
struct Ur5;

#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, passive = ignore, batch)]
struct Solo12;

/// Pole on a cart that a magnet attracts: at the magnet itself the force is not finite.
#[mechanism(gravity = -9.81 * y, batch)]
struct CartPoleWithMagnet {
    #[body(mass = 1)]
    cart: Body,
    #[body(mass = 0.2, com = 0.3 * y, inertia = rod(0.2, 0.6, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,
    #[acts(on = rail, energy = -1 / (stretch * stretch))]
    magnet: Spring,
}

/// Random states of several mechanisms as a structure of arrays.
struct States {
    q: Vec<f64>,
    v: Vec<f64>,
}

impl States {
    fn new<M, const NQ: usize, const NV: usize, const NU: usize>(m: &M, count: usize) -> States
    where
        M: Batch<NQ, NV, NU, Scalar = f64>,
    {
        let mut random = Random::new(41);
        let mut states = States { q: vec![0.0; NQ * count], v: vec![0.0; NV * count] };
        for k in 0..count {
            let (dv, v): (SVector<f64, NV>, SVector<f64, NV>) =
                (random.random_vector(1.0), random.random_vector(0.5));
            let q = m.integrate(&m.neutral(), &dv);
            (0..NQ).for_each(|i| states.q[i * count + k] = q[i]);
            (0..NV).for_each(|i| states.v[i * count + k] = v[i]);
        }
        states
    }
}

/// Returns state `k` from a structure of arrays with `count` states.
fn state_column<const N: usize>(numbers: &[f64], count: usize, k: usize) -> SVector<f64, N> {
    SVector::from_fn(|i, _| numbers[i * count + k])
}

fn bits_of_numbers(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

/// Returns the inputs of a proportional-derivative law whose set point depends on the index of the state.
fn proportional_derivative_law<const L: usize, const N: usize>(
    first: usize,
    t: Lanes<f64, L>,
    q: &SVector<Lanes<f64, L>, N>,
    v: &SVector<Lanes<f64, L>, N>,
) -> SVector<Lanes<f64, L>, N> {
    let rest = Lanes::from_fn(|k| 0.01 * (first + k) as f64);
    SVector::from_fn(|i, _| (rest - q[i]) * 20.0 - v[i] * 3.0 + t)
}

fn command_of_state<const N: usize>(
    k: usize,
    t: f64,
    q: &SVector<f64, N>,
    v: &SVector<f64, N>,
) -> SVector<f64, N> {
    proportional_derivative_law::<1, N>(k, Lanes([t]), &q.map(|x| Lanes([x])), &v.map(|x| Lanes([x])))
        .map(|x| x.0[0])
}

/// Integrates the states one after another with the integrators for single states, as a reference.
fn integrate_one_by_one<S: Lockstep<f64>>(method: S, steps: usize, states: &mut States, count: usize) {
    for k in 0..count {
        let (q, v) = (state_column::<6>(&states.q, count, k), state_column::<6>(&states.v, count, k));
        let mut state = State { t: 0.5, q, v };
        let mut memory = method.initial_memory();
        let inputs =
            ContinuousInputs(move |t, q: &SVector<f64, 6>, v: &SVector<f64, 6>| command_of_state(k, t, q, v));
        let mut system: System<'_, _, _, 6> = System::new(&Ur5, inputs);
        for _ in 0..steps {
            state = method.advance(&mut memory, &mut system, &state, None, false).expect("finite").end;
        }
        for i in 0..6 {
            states.q[i * count + k] = state.q[i];
            states.v[i * count + k] = state.v[i];
        }
    }
}

#[test]
fn rollout_equals_integrator_runs_of_each_state() {
    fn check_lockstep_equals_sequential<S: Lockstep<f64> + Copy>(method: S) {
        for count in [1, 5, 8, 19] {
            let mut expected = States::new(&Ur5, count);
            integrate_one_by_one(method, 50, &mut expected, count);
            let rollout = Rollout::new(method, 50).from_time(0.5);
            let assert_bitwise_equal_states = |found: &States, what: &str| {
                assert_eq!(bits_of_numbers(&found.q), bits_of_numbers(&expected.q), "{what}, {count} states");
                assert_eq!(bits_of_numbers(&found.v), bits_of_numbers(&expected.v), "{what}, {count} states");
            };
            let mut four = States::new(&Ur5, count);
            Ur5.lanes::<4>()
                .roll_out(&rollout, &mut four.q, &mut four.v, proportional_derivative_law, unwatched)
                .expect("finite");
            assert_bitwise_equal_states(&four, "four lanes");
            let mut eight = States::new(&Ur5, count);
            Ur5.lanes::<8>()
                .roll_out(&rollout, &mut eight.q, &mut eight.v, proportional_derivative_law, unwatched)
                .expect("finite");
            assert_bitwise_equal_states(&eight, "eight lanes");
        }
    }
    check_lockstep_equals_sequential(Rk4::step(2e-3));
    check_lockstep_equals_sequential(SemiImplicitEuler::step(1e-3));
}

#[test]
fn thread_count_does_not_change_rollouts() {
    let (count, rollout) = (203, Rollout::new(Rk4::step(2e-3), 20));
    let mut expected = States::new(&Ur5, count);
    Ur5.lanes::<8>()
        .roll_out(&rollout, &mut expected.q, &mut expected.v, proportional_derivative_law, unwatched)
        .expect("finite");
    for threads in 1..5 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut states = States::new(&Ur5, count);
        let seen = AtomicUsize::new(0);
        let record_progress = |progress: Progress| {
            assert_eq!(progress.count, count);
            seen.fetch_max(progress.done, Ordering::Relaxed);
            ControlFlow::Continue(())
        };
        let lanes = Ur5.lanes::<4>();
        pool.install(|| {
            lanes.roll_out_in_parallel(
                &rollout,
                &mut states.q,
                &mut states.v,
                proportional_derivative_law,
                record_progress,
            )
        })
        .expect("finite");
        assert_eq!(bits_of_numbers(&states.q), bits_of_numbers(&expected.q), "{threads} threads");
        assert_eq!(bits_of_numbers(&states.v), bits_of_numbers(&expected.v), "{threads} threads");
        assert_eq!(seen.into_inner(), count);
    }
}

#[test]
fn free_rollout_conserves_energy() {
    let count = 20;
    let lanes = Solo12.lanes::<8>();
    let mut states = States::new(&Solo12, count);
    let energies_of_states = |states: &States| {
        let (mut kinetic, mut potential) = (vec![0.0; count], vec![0.0; count]);
        lanes.kinetic_energy_all(0.0, &states.q, &states.v, &mut kinetic).expect("lengths");
        lanes.potential_energy_all(0.0, &states.q, &mut potential).expect("lengths");
        kinetic.iter().zip(&potential).map(|(t, u)| t + u).collect::<Vec<f64>>()
    };
    let before = energies_of_states(&states);
    let rollout = Rollout::new(Rk4::step(1e-3), 250);
    let zero_inputs = |_, _, _: &_, _: &_| SVector::zeros();
    lanes.roll_out(&rollout, &mut states.q, &mut states.v, zero_inputs, unwatched).expect("finite");
    for (k, (before, after)) in before.iter().zip(energies_of_states(&states)).enumerate() {
        assert!(
            (after - before).abs() < 1e-9 * (1.0 + before.abs()),
            "state {k}: {before} J, then {after} J"
        );
    }
    for k in 0..count {
        let quaternion: SVector<f64, 4> = state_column::<19>(&states.q, count, k).fixed_rows::<4>(3).into();
        assert!((quaternion.norm() - 1.0).abs() < 1e-15);
    }
}

#[test]
fn state_arrays_are_evaluated_state_by_state() {
    for count in [1, 3, 8, 21] {
        let states = States::new(&Solo12, count);
        let a: Vec<f64> = Random::new(43).random_vector::<{ 18 * 21 }>(3.0).as_slice()[..18 * count].to_vec();
        let (mut tau, mut back, mut mass) = (a.clone(), a.clone(), vec![0.0; 18 * 18 * count]);
        let lanes = Solo12.lanes::<8>();
        lanes.inverse_dynamics_all(0.0, &states.q, &states.v, &a, &mut tau).expect("lengths");
        lanes.forward_dynamics_all(0.0, &states.q, &states.v, &tau, &mut back).expect("lengths");
        lanes.mass_matrix_all(0.0, &states.q, &mut mass).expect("lengths");
        // The reference uses one lane, since the function of a single state evaluates identical limbs in
        // lanes.
        let to_single_lane = |x: SVector<f64, 18>| x.map(|x| Lanes([x]));
        for k in 0..count {
            let (q, v) = (
                &state_column::<19>(&states.q, count, k).map(|q| Lanes([q])),
                &to_single_lane(state_column(&states.v, count, k)),
            );
            let expected = Solo12.inverse_dynamics_lanes(q, v, &to_single_lane(state_column(&a, count, k)));
            assert_eq!(to_single_lane(state_column(&tau, count, k)), expected);
            assert_eq!(
                to_single_lane(state_column(&back, count, k)),
                Solo12.forward_dynamics_lanes(q, v, &expected)
            );
            let m = Solo12.mass_matrix_lanes::<1>(q).map(|m| m[0]);
            assert_eq!(state_column::<324>(&mass, count, k).as_slice(), m.as_slice());
        }
    }
}

#[test]
fn failing_state_does_not_affect_other_states() {
    let count = 11;
    let rollout = Rollout::new(Rk4::step(1e-2), 60);
    let zero_inputs = |_, _, _: &_, _: &_| SVector::zeros();
    let mut q: Vec<f64> = (0..2 * count).map(|k| if k < count { 5.0 + k as f64 } else { 0.1 }).collect();
    let (start, mut v) = (q.clone(), vec![0.0; 2 * count]);
    let lanes = CartPoleWithMagnet.lanes::<4>();
    let (mut good, mut good_v) = (q.clone(), v.clone());
    lanes.roll_out(&rollout, &mut good, &mut good_v, zero_inputs, unwatched).expect("far from the magnet");
    // These two states start at the magnet.
    for k in [2, 9] {
        q[k] = 0.0;
    }
    let error = lanes.roll_out(&rollout, &mut q, &mut v, zero_inputs, unwatched);
    let source = integrate::Error::NotFinite { t: 0.0 };
    assert_eq!(error, Err(Error::Motion { state: 2, count: 2, source }));
    for k in 0..count {
        let expected = if k == 2 || k == 9 {
            SVector::from([0.0, start[count + k]])
        } else {
            state_column(&good, count, k)
        };
        assert_eq!(state_column::<2>(&q, count, k), expected, "state {k}");
    }
    let mut all_lost = vec![0.0; 2 * count];
    let error = lanes.roll_out(&rollout, &mut all_lost, &mut vec![0.0; 2 * count], zero_inputs, unwatched);
    assert_eq!(error, Err(Error::Motion { state: 0, count, source }));
}

#[test]
fn mismatched_array_sizes_are_errors() {
    let lanes = Ur5.lanes::<8>();
    let [q, v] = [vec![0.0; 6 * 5], vec![0.0; 6 * 4]];
    let mut tau = vec![0.0; 6 * 5];
    let error = lanes.bias_forces_all(0.0, &q, &v, &mut tau);
    assert_eq!(error, Err(Error::Length { name: "v", expected: 30, found: 24 }));
    let error = lanes.bias_forces_all(0.0, &q, &q, &mut [0.0; 31]);
    assert_eq!(error, Err(Error::Length { name: "h", expected: 30, found: 31 }));
    let error = lanes.potential_energy_all(0.0, &q[1..], &mut [0.0; 4]);
    assert_eq!(error, Err(Error::Length { name: "q", expected: 24, found: 29 }));
    assert_eq!(lanes.bias_forces_all(0.0, &[], &[], &mut []), Ok(()));

    let (mut q, mut v) = (q.clone(), q.clone());
    let rollout = Rollout::new(Rk4::step(-1.0), 3);
    let error = lanes
        .roll_out(&rollout, &mut q, &mut v, proportional_derivative_law, unwatched)
        .expect_err("a negative step");
    assert_eq!(error.to_string(), "the step must be finite and positive, found -1");
    let error = lanes.roll_out(
        &Rollout::new(Rk4::step(1e-3), 3),
        &mut q,
        &mut v[1..],
        proportional_derivative_law,
        unwatched,
    );
    assert_eq!(error.expect_err("too short").to_string(), "`v` must hold 30 numbers, found 29");
}

#[test]
fn rollout_can_be_cancelled() {
    let (count, rollout) = (40, Rollout::new(Rk4::step(2e-3), 5));
    let (start, mut all) = (States::new(&Ur5, count), States::new(&Ur5, count));
    let lanes = Ur5.lanes::<8>();
    lanes.roll_out(&rollout, &mut all.q, &mut all.v, proportional_derivative_law, unwatched).expect("finite");
    let cancel_after_sixteen =
        |p: Progress| if p.done < 16 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    let mut states = States::new(&Ur5, count);
    let error = lanes.roll_out(
        &rollout,
        &mut states.q,
        &mut states.v,
        proportional_derivative_law,
        cancel_after_sixteen,
    );
    assert_eq!(error, Err(Error::Cancelled { done: 16 }));
    for k in 0..count {
        let expected = if k < 16 { &all.q } else { &start.q };
        assert_eq!(
            state_column::<6>(&states.q, count, k),
            state_column::<6>(expected, count, k),
            "state {k}"
        );
    }
    let mut states = States::new(&Ur5, count);
    let error = lanes.roll_out_in_parallel(
        &rollout,
        &mut states.q,
        &mut states.v,
        proportional_derivative_law,
        cancel_after_sixteen,
    );
    let Err(Error::Cancelled { done }) = error else { panic!("{error:?}") };
    let has_same_configuration =
        |k: usize, of: &States| state_column::<6>(&states.q, count, k) == state_column::<6>(&of.q, count, k);
    assert_eq!((0..count).filter(|k| has_same_configuration(*k, &all)).count(), done);
    assert!((0..count).all(|k| has_same_configuration(k, &all) || has_same_configuration(k, &start)));
}
