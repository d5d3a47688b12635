//! Table of batched functions of several states and functions of single states.
//!
//! `RUSTFLAGS="-C target-cpu=native" cargo run --release -p linkwork-benches --bin batches`, or without the
//! flag for the default target. The values are nanoseconds per state: the minimum over many rounds, in which
//! all functions take turns.
//!
//! A second table has states in arrays that exceed the caches near the processor, on one thread.
//! `runtime/python/benches/calls.py` measures the same from Python.

use linkwork::Mechanism;
use linkwork::nalgebra::SVector;
use linkwork::prelude::{Batch, Lanes, mechanism};
use linkwork_benches::random::Random;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Processor time spent on the measurement of each function.
const BUDGET: Duration = Duration::from_millis(400);

/// Number of states that the calls cycle through, which fit into the fastest cache.
const STATES: usize = 64;

/// Number of states in the arrays that batch functions process.
const ARRAYS: usize = 4096;

#[mechanism(urdf = "../models/urdf/ur5.urdf", batch)]
struct Ur5;

#[mechanism(urdf = "../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"], batch)]
struct Panda;

#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, batch)]
struct Solo12;

#[mechanism(urdf = "../models/urdf/simple_humanoid.urdf", base = free, batch)]
struct Humanoid;

fn main() {
    println!("| robot | function | one state, ns | four lanes, ns per state | eight lanes, ns per state |");
    println!("| --- | --- | ---: | ---: | ---: |");
    print_batch_times_of_robot("UR5", &Ur5);
    print_batch_times_of_robot("Panda", &Panda);
    print_batch_times_of_robot("Solo 12", &Solo12);
    print_batch_times_of_robot("humanoid", &Humanoid);
    println!();
    println!("| robot | function of {ARRAYS} states in arrays | eight lanes, ns per state |");
    println!("| --- | --- | ---: |");
    measure_batched_state_arrays("UR5", &Ur5);
    measure_batched_state_arrays("Panda", &Panda);
}

/// Packs states into SIMD lanes, `L` states in each vector.
fn pack_into_lanes<const L: usize, const N: usize>(
    states: &[SVector<f64, N>],
) -> Vec<SVector<Lanes<f64, L>, N>> {
    let pack_group_into_lanes =
        |group: &[SVector<f64, N>]| SVector::from_fn(|i, _| Lanes::from_fn(|k| group[k][i]));
    states.chunks_exact(L).map(pack_group_into_lanes).collect()
}

/// States as single vectors, and packed into SIMD vectors of 4 and 8 lanes.
type ScalarAndPackedStates<const N: usize> =
    (Vec<SVector<f64, N>>, Vec<SVector<Lanes<f64, 4>, N>>, Vec<SVector<Lanes<f64, 8>, N>>);

fn print_batch_times_of_robot<M, const NQ: usize, const NV: usize, const NU: usize>(name: &str, m: &M)
where
    M: Batch<NQ, NV, NU, Scalar = f64>,
{
    let mut random = Random::new(1);
    let mut random_vector = |bound: f64| SVector::<f64, NV>::from_fn(|_, _| random.uniform_within(bound));
    let q: Vec<_> = (0..STATES).map(|_| m.integrate(&m.neutral(), &random_vector(2.0))).collect();
    let v: Vec<_> = (0..STATES).map(|_| random_vector(2.0)).collect();
    let q: ScalarAndPackedStates<NQ> = (q.clone(), pack_into_lanes(&q), pack_into_lanes(&q));
    let v: ScalarAndPackedStates<NV> = (v.clone(), pack_into_lanes(&v), pack_into_lanes(&v));
    let (m4, m8) = (m.lanes::<4>(), m.lanes::<8>());
    let (t4, t8) = (Lanes([0.0; 4]), Lanes([0.0; 8]));
    macro_rules! row {
        ($text:literal, $function:ident($($x:ident),*)) => {
            let times = nanoseconds_per_state([
                &mut |k| { black_box(&Mechanism::$function(m, 0.0, $(black_box(&$x.0[k])),*)); },
                &mut |k| { black_box(&m4.$function(t4, $(black_box(&$x.1[k])),*)); },
                &mut |k| { black_box(&m8.$function(t8, $(black_box(&$x.2[k])),*)); },
            ]);
            let [one, four, eight] = times;
            let ratios = (one / four, one / eight);
            println!(
                "| {name} | {} | {one:.1} | {four:.1} ({:.1} ×) | {eight:.1} ({:.1} ×) |",
                $text, ratios.0, ratios.1
            );
        };
    }
    row!("mass matrix", mass_matrix(q));
    row!("bias forces", bias_forces(q, v));
    row!("inverse dynamics", inverse_dynamics(q, v, v));
    row!("forward dynamics", forward_dynamics(q, v, v));
}

/// Returns the times per state of calls for one, four and eight states, ns.
fn nanoseconds_per_state(calls: [&mut dyn FnMut(usize); 3]) -> [f64; 3] {
    let mut calls = calls.into_iter().zip([1, 4, 8]).collect::<Vec<_>>();
    let mut best = [Duration::MAX; 3];
    let start = Instant::now();
    while start.elapsed() < BUDGET {
        for ((call, lanes), best) in calls.iter_mut().zip(&mut best) {
            let start = Instant::now();
            (0..STATES / *lanes).for_each(&mut **call);
            *best = (*best).min(start.elapsed());
        }
    }
    best.map(|time| time.as_secs_f64() * 1e9 / STATES as f64)
}

/// Measures arrays of states of a robot whose `q` and `v` have equal length.
fn measure_batched_state_arrays<M, const N: usize, const NU: usize>(name: &str, m: &M)
where
    M: Batch<N, N, NU, Scalar = f64>,
{
    let mut random = Random::new(2);
    let mut random_numbers_for_arrays =
        || (0..N * ARRAYS).map(|_| random.uniform_within(2.0)).collect::<Vec<f64>>();
    let (q, v, a) = (random_numbers_for_arrays(), random_numbers_for_arrays(), random_numbers_for_arrays());
    let (mut matrices, mut vectors) = (vec![0.0; N * N * ARRAYS], vec![0.0; N * ARRAYS]);
    let m = m.lanes::<8>();
    let mut measure_and_print_row = |text: &str, call: &mut dyn FnMut(&mut [f64], &mut [f64])| {
        let mut best = Duration::MAX;
        let start = Instant::now();
        while start.elapsed() < BUDGET {
            let start = Instant::now();
            call(black_box(&mut matrices), black_box(&mut vectors));
            best = best.min(start.elapsed());
        }
        println!("| {name} | {text} | {:.1} |", best.as_secs_f64() * 1e9 / ARRAYS as f64);
    };
    let fits = "arrays have the lengths of the states";
    measure_and_print_row("mass matrix", &mut |mass, _| {
        m.mass_matrix_all(0.0, black_box(&q), mass).expect(fits)
    });
    measure_and_print_row("inverse dynamics", &mut |_, tau| {
        m.inverse_dynamics_all(0.0, black_box(&q), &v, &a, tau).expect(fits)
    });
    measure_and_print_row("forward dynamics", &mut |_, a_out| {
        m.forward_dynamics_all(0.0, black_box(&q), &v, &a, a_out).expect(fits);
    });
}
