//! Constrained mechanisms: time of one evaluation of the accelerations and multipliers, and of a simulated second.
//!
//! `RUSTFLAGS="-C target-cpu=native" cargo run --release -p linkwork-benches --bin constraints`. The least over many rounds
//! through 64 states of a motion; a second is a thousand steps of `Rk4`, each projected onto the constraints.

use linkwork::nalgebra::SVector;
use linkwork::prelude::{Constrained, Error, Rk4, simulate};
use linkwork_models::{
    AndrewsSqueezer, Bicycle, BricardLinkage, ChaplyginSleigh, FourBar, RollingDisk, SliderCrank, TwoWindows,
};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// How long each mechanism is measured.
const BUDGET: Duration = Duration::from_millis(400);
/// States that the evaluations go through.
const STATES: usize = 64;
/// Seconds between them.
const INTERVAL: f64 = 2e-4;

fn main() -> Result<(), Error> {
    println!("| mechanism | coordinates | constraints | accelerations, ns | a simulated second, ms |");
    println!("| --- | ---: | ---: | ---: | ---: |");
    let bar = FourBar { g: 9.81, density: 0.8, a: 0.3, b: 0.9, c: 0.7, d: 0.8 };
    row("four-bar linkage", &bar, [0.3, 0.6, 1.8], &[0], [2.0, 0.0, 0.0])?;
    let slider = SliderCrank { g: 9.81, r: 0.04, l: 0.13, m_crank: 0.9, m_rod: 0.5, m_piston: 0.35 };
    row("slider-crank", &slider, [0.3, -0.4, 0.16], &[0], [20.0, 0.0, 0.0])?;
    row("Andrews' squeezer", &AndrewsSqueezer {}, AndrewsSqueezer::START, &[0], [0.0; 7])?;
    let windows = TwoWindows { g: 9.81, mass: 1.0, length: 1.0 };
    row("two windows", &windows, [0.0; 5], &[0], [-1.0, 1.0, -1.0, 1.0, -1.0])?;
    let bricard = BricardLinkage { g: 9.81, mass: 1.0, length: 1.0 };
    row("Bricard's linkage", &bricard, [0.0; 5], &[], [0.0; 5])?;
    let sleigh = ChaplyginSleigh { m: 1.0, j: 0.5, a: 0.3 };
    row("Chaplygin's sleigh", &sleigh, [0.0; 3], &[], [1.0, 0.0, 2.0])?;
    let disk = RollingDisk { g: 9.81, m: 2.0, radius: 0.4 };
    row("rolling disk", &disk, [0.0, 0.0, 0.4, 0.0, 0.1, 0.0], &[4], [1.2, 0.0, 0.0, 0.0, 0.0, 3.0])?;
    let q = Bicycle::BENCHMARK.neutral();
    row("bicycle", &Bicycle::BENCHMARK, q, &[], [4.6, 0.0, 0.0, 0.1, 0.0, 0.0, -15.3, 0.0, -13.1])
}

/// Measures a mechanism from a configuration and a velocity that are brought onto its constraints.
fn row<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(
    name: &str,
    m: &M,
    q: impl Into<SVector<f64, NQ>>,
    held: &[usize],
    v: impl Into<SVector<f64, NV>>,
) -> Result<(), Error>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64>,
{
    let at_start = |reason| Error::Constraint { t: 0.0, reason };
    let q = m.assemble(0.0, &q.into(), held).map_err(at_start)?;
    let v = m.project_velocity(0.0, &q, &v.into()).map_err(at_start)?;
    let run = || simulate(m).from(q, v).method(Rk4::step(1e-3));
    let samples = run().method(Rk4::step(INTERVAL)).sample_every(INTERVAL).duration(INTERVAL * STATES as f64);
    let states: Vec<_> = samples.collect::<Result<_, _>>()?;
    let tau = SVector::zeros();
    let (mut evaluation, mut second) = (Duration::MAX, Duration::MAX);
    let start = Instant::now();
    while start.elapsed() < BUDGET {
        let clock = Instant::now();
        for s in &states {
            black_box(m.constrained_dynamics(black_box(s.t), black_box(&s.q), black_box(&s.v), &tau));
        }
        evaluation = evaluation.min(clock.elapsed());
        let clock = Instant::now();
        // A tenth is enough: a bicycle without rider falls.
        black_box(run().duration(0.1).finish()?);
        second = second.min(clock.elapsed() * 10);
    }
    println!(
        "| {name} | {NV} | {NC} | {:.0} | {:.2} |",
        evaluation.as_secs_f64() * 1e9 / states.len() as f64,
        second.as_secs_f64() * 1e3
    );
    Ok(())
}
