//! Table of sines and cosines of joint angles: those of Linkwork, of the standard library and of `libm`.
//!
//! `RUSTFLAGS="-C target-cpu=native" cargo run --release -p linkwork-benches --bin sines`, or without the
//! flag for the default target, where generated functions select AVX2 and FMA at run time as this program
//! does. The values are nanoseconds for all angles of a call, which are within 10⁴ rad: the minimum over many
//! rounds, in which all take turns.

use linkwork::__private::{Arithmetic, Evaluate, dispatch};
use linkwork_benches::random::Random;
use std::array::from_fn;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Processor time spent on the measurement of each number of angles.
const BUDGET: Duration = Duration::from_millis(300);

/// Number of configurations that the measured calls cycle through.
const STATES: usize = 64;

/// Largest angle at which sines and cosines are compared, rad.
const BOUND: f64 = 1e4;

/// Sines and cosines of `N` angles.
type SineCosineArrays<const N: usize> = ([f64; N], [f64; N]);

/// First part of a generated function: sines and cosines of the angles.
struct SineCosineStage;

impl<const N: usize> Evaluate<0, &[f64; N]> for SineCosineStage {
    type Output = SineCosineArrays<N>;

    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, angles: &[f64; N]) -> SineCosineArrays<N> {
        A::sin_cos_all(*angles)
    }
}

/// Returns the implementations of Linkwork, of the standard library, and of `libm`.
fn sine_implementations<const N: usize>() -> [fn(&[f64; N]) -> SineCosineArrays<N>; 3] {
    [
        |x| dispatch::<0, f64, _, _>(&SineCosineStage, x),
        |x| sines_and_cosines_with_function(x, f64::sin_cos),
        |x| sines_and_cosines_with_function(x, libm::sincos),
    ]
}

fn sines_and_cosines_with_function<const N: usize>(
    x: &[f64; N],
    sin_cos: impl Fn(f64) -> (f64, f64),
) -> SineCosineArrays<N> {
    let (mut s, mut c) = ([0.0; N], [0.0; N]);
    for ((x, s), c) in x.iter().zip(&mut s).zip(&mut c) {
        (*s, *c) = sin_cos(*x);
    }
    (s, c)
}

fn main() {
    println!("| angles | Linkwork, ns | std, ns | libm, ns | std : Linkwork | libm : Linkwork |");
    println!("| ---: | ---: | ---: | ---: | ---: | ---: |");
    measure_sines::<1>();
    measure_sines::<6>();
    measure_sines::<8>();
    measure_sines::<12>();
    measure_sines::<16>();
    measure_sines::<32>();
}

fn measure_sines<const N: usize>() {
    let mut random = Random::new(1);
    let states: Vec<[f64; N]> = (0..STATES).map(|_| from_fn(|_| random.uniform_within(BOUND))).collect();
    let mut least = [f64::INFINITY; 3];
    let start = Instant::now();
    while start.elapsed() < BUDGET {
        for (least, way) in least.iter_mut().zip(sine_implementations::<N>()) {
            let begin = Instant::now();
            for _ in 0..16 {
                for x in &states {
                    black_box(way(black_box(x)));
                }
            }
            *least = least.min(begin.elapsed().as_secs_f64() * 1e9 / (16 * STATES) as f64);
        }
    }
    let [ours, std, libm] = least;
    println!("| {N} | {ours:.1} | {std:.1} | {libm:.1} | {:.1} | {:.1} |", std / ours, libm / ours);
}
