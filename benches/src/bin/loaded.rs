//! Table of functions of robots that are loaded at run time, next to the same functions compiled in.
//!
//! `cargo run --release -p linkwork-benches --bin loaded`, with `RUSTFLAGS="-C target-cpu=native"` for code
//! of the host, which loaded robots always have. The values are nanoseconds of processor time per call: the
//! minimum over many batches, in which both take turns, over the same states. The program fails unless
//! results agree to 10⁻⁹ of the largest entry.
//!
//! An argument chooses the robots whose name contains it.

use linkwork::Derivatives;
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork_benches::peers::clock::thread_seconds;
use linkwork_benches::random::Random;
use linkwork_benches::robots::{G1, Gen3, Kinova, Panda};
use linkwork_jit::{Error, Function, Loader, Robot};
use linkwork_models::{AnymalB, PandaArm, SimpleHumanoid, Solo12, Ur5};
use std::hint::black_box;

/// Number of states that the measured calls cycle through.
const STATES: usize = 64;
/// Processor time spent on the measurement of each function, s.
const BUDGET: f64 = 0.3;
/// Largest accepted difference between results, relative to the largest entry.
const TOLERANCE: f64 = 1e-9;

fn main() -> Result<(), Error> {
    println!("| robot | function | loaded, ns | compiled in, ns | loaded : compiled in |");
    println!("| --- | --- | ---: | ---: | ---: |");
    const LOCKED: &str = r#"lock = ["panda_finger_joint1", "panda_finger_joint2"]"#;
    print_robot_timing_rows("ur5", "ur5", "", &Ur5)?;
    print_robot_timing_rows("panda_arm", "panda", LOCKED, &PandaArm)?;
    print_robot_timing_rows("panda", "panda", "mimic = independent", &Panda)?;
    print_robot_timing_rows("kinova", "kinova", "", &Kinova)?;
    print_robot_timing_rows("gen3", "gen3", "", &Gen3)?;
    print_robot_timing_rows("solo12", "solo12", "base = free", &Solo12)?;
    print_robot_timing_rows("anymal_b", "anymal_b", "base = free, inertia = trust", &AnymalB)?;
    print_robot_timing_rows("simple_humanoid", "simple_humanoid", "base = free", &SimpleHumanoid)?;
    print_robot_timing_rows("g1", "g1", "base = free", &G1)
}

/// A sample state: configuration, velocity, and acceleration or force.
type SampleState<const NQ: usize, const NV: usize> = (SVector<f64, NQ>, SVector<f64, NV>, SVector<f64, NV>);

/// Prints the rows of a robot: each function loaded at run time and compiled in.
fn print_robot_timing_rows<M, const NQ: usize, const NV: usize, const NU: usize>(
    name: &str,
    file: &str,
    options: &str,
    own: &M,
) -> Result<(), Error>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    if std::env::args().nth(1).is_some_and(|chosen| !name.contains(&chosen)) {
        return Ok(());
    }
    let path = format!("{}/../models/urdf/{file}.urdf", env!("CARGO_MANIFEST_DIR"));
    let robot = Loader::file(path).options(options).options("derivatives").load()?;
    let mut random = Random::new(1);
    let mut random_vector = |bound: f64| SVector::<f64, NV>::from_fn(|_, _| random.uniform_within(bound));
    let mut random_sample_state =
        || (own.integrate(&own.neutral(), &random_vector(1.0)), random_vector(2.0), random_vector(2.0));
    let states: Vec<SampleState<NQ, NV>> = (0..STATES).map(|_| random_sample_state()).collect();
    let comparison = LoadedRobotComparison { name, robot: &robot, states: &states };
    comparison.measure_and_print_function_row(
        "inverse_dynamics",
        |(q, v, a)| own.inverse_dynamics(0.0, q, v, a),
        |x| vec![x.as_slice()],
    )?;
    comparison.measure_and_print_function_row(
        "mass_matrix",
        |(q, ..)| own.mass_matrix(0.0, q),
        |x| vec![x.as_slice()],
    )?;
    comparison.measure_and_print_function_row(
        "forward_dynamics",
        |(q, v, tau)| own.forward_dynamics(0.0, q, v, tau),
        |x| vec![x.as_slice()],
    )?;
    comparison.measure_and_print_function_row(
        "inverse_dynamics_derivatives",
        |(q, v, a)| own.inverse_dynamics_derivatives(0.0, q, v, a),
        |(by_q, by_v)| vec![by_q.as_slice(), by_v.as_slice()],
    )?;
    type DerivativeMatrices<const N: usize> = (SMatrix<f64, N, N>, SMatrix<f64, N, N>, SMatrix<f64, N, N>);
    comparison.measure_and_print_function_row(
        "forward_dynamics_derivatives",
        |(q, v, tau)| own.forward_dynamics_derivatives(0.0, q, v, tau),
        |(by_q, by_v, by_tau): &DerivativeMatrices<NV>| {
            vec![by_q.as_slice(), by_v.as_slice(), by_tau.as_slice()]
        },
    )
}

/// Robot that is loaded at run time, and the states at which its functions are called.
struct LoadedRobotComparison<'a, const NQ: usize, const NV: usize> {
    name: &'a str,
    robot: &'a Robot,
    states: &'a [SampleState<NQ, NV>],
}

impl<const NQ: usize, const NV: usize> LoadedRobotComparison<'_, NQ, NV> {
    /// Measures one function both loaded at run time and compiled into the program, and prints its row.
    fn measure_and_print_function_row<T>(
        &self,
        function: &str,
        own: impl Fn(&SampleState<NQ, NV>) -> T,
        lists: impl for<'t> Fn(&'t T) -> Vec<&'t [f64]>,
    ) -> Result<(), Error> {
        let f = self.robot.function(function)?;
        let (count, mut out) = (f.arguments().len(), vec![0.0; f.length()]);
        for state in self.states {
            self.call_loaded_function((&f, count), state, &mut out)?;
            self.assert_results_agree(function, &out, &lists(&own(state)).concat());
        }
        let (mut loaded, mut compiled) = (f64::INFINITY, f64::INFINITY);
        let start = thread_seconds();
        while thread_seconds() - start < BUDGET {
            let begin = thread_seconds();
            for state in self.states {
                self.call_loaded_function((&f, count), black_box(state), &mut out)?;
            }
            let between = thread_seconds();
            for state in self.states {
                black_box(own(black_box(state)));
            }
            loaded = loaded.min(between - begin);
            compiled = compiled.min(thread_seconds() - between);
        }
        let [loaded, compiled] = [loaded, compiled].map(|time| time * 1e9 / STATES as f64);
        let ratio = loaded / compiled;
        println!("| {} | {function} | {loaded:.1} | {compiled:.1} | {ratio:.2} |", self.name);
        Ok(())
    }

    fn call_loaded_function(
        &self,
        (f, count): (&Function, usize),
        (q, v, a): &SampleState<NQ, NV>,
        out: &mut [f64],
    ) -> Result<(), Error> {
        let all = [q.as_slice(), v.as_slice(), a.as_slice()];
        self.robot.evaluate_into(f, &all[..count], out)
    }

    /// Panics if the results of the loaded and the compiled function differ.
    fn assert_results_agree(&self, function: &str, loaded: &[f64], compiled: &[f64]) {
        let scale = compiled.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        let difference = loaded.iter().zip(compiled).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(
            loaded.len() == compiled.len() && difference <= TOLERANCE * scale,
            "{}, {function}: results differ by {difference:e}",
            self.name
        );
    }
}
