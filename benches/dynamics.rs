//! Every generated function and the generic implementation, on 256 random states in turn.

use criterion::{Criterion, criterion_group, criterion_main};
use linkwork_benches::pairs::compared_robots;

fn benchmark_dynamics(criterion: &mut Criterion) {
    for robot in compared_robots() {
        let mut group = criterion.benchmark_group(robot.name);
        for mut pair in robot.pairs {
            for (which, run) in [("generated", &mut pair.generated), ("generic", &mut pair.generic)] {
                let mut state = 0;
                group.bench_function(format!("{}/{which}", pair.function), |bencher| {
                    bencher.iter(|| {
                        state += 1;
                        run(state);
                    });
                });
            }
        }
        group.finish();
    }
}

criterion_group!(benches, benchmark_dynamics);
criterion_main!(benches);
