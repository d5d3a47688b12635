//! Functions of several states at once next to those of one, in one table.
//!
//! `RUSTFLAGS="-C target-cpu=native" cargo run --release -p linkwork-benches --bin batches`, or without the flag for the
//! default target. Nanoseconds per state: the least over many rounds, in which all take turns.

use linkwork::Rheonomic;
use linkwork::nalgebra::SVector;
use linkwork::prelude::{Batch, Lanes, mechanism};
use linkwork_benches::random::Random;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// How long each function is measured.
const BUDGET: Duration = Duration::from_millis(400);

/// Number of states that the calls go through: few enough for the fastest cache.
const STATES: usize = 64;

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
    robot("UR5", &Ur5);
    robot("Panda", &Panda);
    robot("Solo 12", &Solo12);
    robot("humanoid", &Humanoid);
}

/// `L` states in lanes each.
fn wide<const L: usize, const N: usize>(states: &[SVector<f64, N>]) -> Vec<SVector<Lanes<f64, L>, N>> {
    let group = |group: &[SVector<f64, N>]| SVector::from_fn(|i, _| Lanes::from_fn(|k| group[k][i]));
    states.chunks_exact(L).map(group).collect()
}

/// The states of one kind: one by one, and in lanes.
type States<const N: usize> =
    (Vec<SVector<f64, N>>, Vec<SVector<Lanes<f64, 4>, N>>, Vec<SVector<Lanes<f64, 8>, N>>);

fn robot<M, const NQ: usize, const NV: usize, const NU: usize>(name: &str, m: &M)
where
    M: Batch<NQ, NV, NU, Scalar = f64>,
{
    let mut random = Random::new(1);
    let mut vector = |bound: f64| SVector::<f64, NV>::from_fn(|_, _| random.within(bound));
    let q: Vec<_> = (0..STATES).map(|_| m.integrate(&m.neutral(), &vector(2.0))).collect();
    let v: Vec<_> = (0..STATES).map(|_| vector(2.0)).collect();
    let q: States<NQ> = (q.clone(), wide(&q), wide(&q));
    let v: States<NV> = (v.clone(), wide(&v), wide(&v));
    let (m4, m8) = (m.lanes::<4>(), m.lanes::<8>());
    let (t4, t8) = (Lanes([0.0; 4]), Lanes([0.0; 8]));
    macro_rules! row {
        ($text:literal, $function:ident($($x:ident),*)) => {
            let times = measure([
                &mut |k| { black_box(&Rheonomic::$function(m, 0.0, $(black_box(&$x.0[k])),*)); },
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

/// Nanoseconds per state of a call for one state, four and eight.
fn measure(calls: [&mut dyn FnMut(usize); 3]) -> [f64; 3] {
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
