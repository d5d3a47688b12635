//! Hashes over the bits of many results, and the time of each part: `linkwork-bits CALLS STEPS`. With the
//! feature `reproducible` the hashes are the same on every machine and with all compiler flags. The times
//! without the feature show what it costs.

use linkwork::prelude::*;
use mechanisms::{Arm, Crate, Engine, ElementaryFunctionOutputs, Quadruped};
use std::time::Instant;

/// The mechanisms, in the arithmetic of the feature.
mod mechanisms {
    use linkwork::prelude::*;
    include!(concat!(env!("OUT_DIR"), "/mechanisms.rs"));
}

/// Hash of the bits of numbers (FNV-1a over 64-bit words).
struct Hash(u64);

impl Hash {
    /// Adds numbers.
    fn add<'a>(&mut self, numbers: impl IntoIterator<Item = &'a f64>) {
        for x in numbers {
            self.0 = (self.0 ^ x.to_bits()).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29);
        }
    }
}

/// Pseudo-random numbers in [-2, 2).
struct PseudoRandomNumbers(u64);

impl PseudoRandomNumbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        4.0 * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64) - 2.0
    }

    fn pseudorandom_vector<const N: usize>(&mut self) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.next())
    }
}

/// Prints the hash of a part, and its time per call.
fn print_hash_and_time(name: &str, count: u64, part: impl FnOnce(&mut Hash, u64)) {
    let (mut hash, start) = (Hash(0xcbf2_9ce4_8422_2325), Instant::now());
    part(&mut hash, count);
    let time = start.elapsed().as_secs_f64() * 1e9 / count.max(1) as f64;
    println!("| {name} | {count} | `{:016x}` | {time:.0} |", hash.0);
}

/// Adds the dynamics of a mechanism at random states.
macro_rules! dynamics {
    ($mechanism:expr, $hash:ident, $count:ident) => {{
        let mut numbers = PseudoRandomNumbers(1);
        for _ in 0..$count {
            let q = $mechanism.integrate(&$mechanism.neutral(), &numbers.pseudorandom_vector());
            let (v, u) = (numbers.pseudorandom_vector(), numbers.pseudorandom_vector());
            let a = $mechanism.forward_dynamics(&q, &v, &u);
            $hash.add(&$mechanism.inverse_dynamics(&q, &v, &a));
            $hash.add(&a);
        }
    }};
}

/// Adds the derivatives of the dynamics of a mechanism at random states.
macro_rules! derivatives {
    ($mechanism:expr, $hash:ident, $count:ident) => {{
        let mut numbers = PseudoRandomNumbers(2);
        for _ in 0..$count {
            let q = $mechanism.integrate(&$mechanism.neutral(), &numbers.pseudorandom_vector());
            let (v, u) = (numbers.pseudorandom_vector(), numbers.pseudorandom_vector());
            let (by_q, by_v, inverse) = $mechanism.forward_dynamics_derivatives(&q, &v, &u);
            $hash.add(by_q.iter().chain(&by_v).chain(&inverse));
        }
    }};
}

/// Adds all elementary functions at random angles, some of them large.
fn hash_elementary_functions(hash: &mut Hash, count: u64) {
    let mut numbers = PseudoRandomNumbers(3);
    for k in 0..count {
        let x = numbers.next();
        let q = [if k % 64 == 0 { 1e6 * x } else { x }].into();
        hash.add(&[ElementaryFunctionOutputs {}.angles(&q)]);
        let q = [x].into();
        hash.add(&[ElementaryFunctionOutputs {}.inverse_functions(&q)]);
        hash.add(&[ElementaryFunctionOutputs {}.exponentials(&q)]);
        hash.add(&[ElementaryFunctionOutputs {}.powers(&q)]);
        hash.add(&[ElementaryFunctionOutputs {}.pieces(&q)]);
    }
}

/// Adds the motion of an engine with a closed loop.
fn hash_loop_motion(hash: &mut Hash, count: u64) {
    let engine = Engine { length: 0.13 };
    let q = engine.assemble(&[0.8, -1.0, 0.1].into(), &[0]).expect("the engine can be assembled");
    let v = engine.complete_velocity(&q, &[5.0, 0.0, 0.0].into(), &[0]).expect("the engine rotates");
    let run = simulate(&engine).from(q, v).inputs(|t, _, _| [if t % 0.2 < 0.1 { 1.0 } else { -1.0 }].into());
    for sample in run.method(Rk4::step(1e-4)).duration(count as f64 * 1e-4) {
        let sample = sample.expect("the loop stays closed");
        hash.add(sample.q.iter().chain(&sample.v));
    }
}

/// Adds the motion of a crate that is pushed to and fro.
fn hash_pushed_crate_motion(hash: &mut Hash, count: u64) {
    let crate_ = Crate { friction: 0.4 };
    let mut q = crate_.neutral();
    q[2] = 0.2;
    let push = |t: f64, _: &_, _: &_| [if t % 0.5 < 0.25 { 12.0 } else { -11.0 }].into();
    let run = simulate(&crate_).from(q, SVector::from([0.1, 0.2, 0.0, 0.3, 0.2, 0.1])).inputs(push);
    for sample in run.method(TimeStepping::step(1e-3)).duration(count as f64 * 1e-3) {
        let sample = sample.expect("the impulses are found");
        hash.add(sample.q.iter().chain(&sample.v));
    }
}

fn main() {
    let mut counts = std::env::args().skip(1).map(|text| text.parse().expect("a number of calls"));
    let (calls, steps) = (counts.next().unwrap_or(1_000_000), counts.next().unwrap_or(10_000));
    println!("| part | calls | hash | time, ns |\n| --- | --- | --- | --- |");
    print_hash_and_time("arm, dynamics", calls, |hash, count| dynamics!(Arm {}, hash, count));
    print_hash_and_time("arm, derivatives", calls / 10, |hash, count| derivatives!(Arm {}, hash, count));
    print_hash_and_time("quadruped, dynamics", calls / 10, |hash, count| {
        dynamics!(Quadruped {}, hash, count)
    });
    print_hash_and_time("quadruped, derivatives", calls / 50, |hash, count| {
        derivatives!(Quadruped {}, hash, count)
    });
    print_hash_and_time("elementary functions", calls / 10, hash_elementary_functions);
    print_hash_and_time("steps of a closed loop", steps, hash_loop_motion);
    print_hash_and_time("steps with contacts", steps, hash_pushed_crate_motion);
}
