//! Benchmark that prints the times of generated functions and of the generic implementation, with their
//! ratios.
//!
//! `RUSTFLAGS="-C target-cpu=native" cargo run --release -p linkwork-benches --bin ratios`, or without the
//! flag for the default target. The values are nanoseconds per call: the minimum over many batches, in which
//! both take turns.

use linkwork_benches::pairs::{ImplementationPair, compared_robots};
use linkwork_benches::states::STATES;
use std::time::{Duration, Instant};

/// Processor time spent on the measurement of each function.
const BUDGET: Duration = Duration::from_millis(700);

fn main() {
    let fused = cfg!(any(target_feature = "fma", target_arch = "aarch64"));
    #[cfg(target_arch = "x86_64")]
    let fused = fused || std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
    println!(
        "{}, fused multiply-add {}; operations: mul + add + div (instructions if fused) + sin, cos\n",
        std::env::consts::ARCH,
        if fused { "used" } else { "not used" }
    );
    println!("| robot | function | generated, ns | generic, ns | ratio | operations |");
    println!("| --- | --- | ---: | ---: | ---: | ---: |");
    for robot in compared_robots() {
        for mut pair in robot.pairs {
            let (generated, generic) = measure_pair(&mut pair);
            let size = pair.size;
            println!(
                "| {} | {} | {generated:.1} | {generic:.0} | {:.1} | {} ({}) + {} |",
                robot.name,
                pair.function,
                generic / generated,
                size.operations,
                size.fused,
                size.calls
            );
        }
    }
}

/// Returns the times of the generated and of the generic implementation, ns per call.
fn measure_pair(pair: &mut ImplementationPair) -> (f64, f64) {
    let (mut generated, mut generic) = (Duration::MAX, Duration::MAX);
    let start = Instant::now();
    while start.elapsed() < BUDGET {
        generated = generated.min(time_for_all_states(&mut pair.generated));
        generic = generic.min(time_for_all_states(&mut pair.generic));
    }
    let nanoseconds_per_state = |time: Duration| time.as_secs_f64() * 1e9 / STATES as f64;
    (nanoseconds_per_state(generated), nanoseconds_per_state(generic))
}

fn time_for_all_states(f: &mut dyn FnMut(usize)) -> Duration {
    let start = Instant::now();
    for k in 0..STATES {
        f(k);
    }
    start.elapsed()
}
