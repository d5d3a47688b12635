//! Costs of the compiler, and of rustc on its output: time, memory and size, with their target values.
//!
//! `cargo run -p linkwork-benches --bin expansion`, in the dev profile, in which cargo builds procedural
//! macros. Each mechanism is expanded in its own process, so that its memory can be measured separately. The
//! last columns measure rustc on the expanded code in cargo's dev profile, up to the metadata of a library:
//! processor time, and peak memory. `expansion FIRST [LAST]` prints the lines of some mechanisms, by number.

use linkwork_benches::chains::{MechanismSourceText, chain_source};
use linkwork_benches::checked::{CompiledRuntime, measure_rustc_check};
use linkwork_benches::elements::{arm_with_springs_source, particle_chain_source};
use linkwork_benches::operations::CompiledMechanism;
use linkwork_compiler::expand;
use proc_macro2::TokenStream;
use std::error::Error;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

/// Number of repetitions, of which the fastest is reported, unless they take longer than `PATIENCE`.
const REPEATS: usize = 9;
const PATIENCE: Duration = Duration::from_secs(4);

const CART_POLE: &str = "pub struct CartPole {
    pub cart_mass: f64, pub pole_mass: f64, pub length: f64, pub g: f64,
    #[body(mass = cart_mass)] cart: Body,
    #[body(mass = pole_mass, com = length / 2 * y, inertia = rod(pole_mass, length, y))] pole: Body,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[joint(cart -> pole, about = z)] hinge: Pin,
    #[acts(on = rail)] motor: Force,
}";
const DOUBLE_PENDULUM: &str = "pub struct DoublePendulum {
    pub g: f64, pub m1: f64, pub m2: f64, pub l1: f64, pub l2: f64,
    #[body(mass = m1, com = -l1 / 2 * y, inertia = rod(m1, l1, y))] upper: Body,
    #[body(mass = m2, com = -l2 / 2 * y, inertia = rod(m2, l2, y))] lower: Body,
    #[joint(ground -> upper, about = z)] shoulder: Pin,
    #[joint(upper.at(-l1 * y) -> lower, about = z)] elbow: Pin,
}";

/// Name, options of the file, and target time of each robot.
const ROBOTS: [(&str, &str, &str); 4] = [
    ("ur5", "", ""),
    ("panda", ", mimic = independent", "150 ms"),
    ("solo12", ", base = free", ""),
    ("simple_humanoid", ", base = free", "1500 ms, 300 MB"),
];
const LENGTHS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];
const SPRINGS: [usize; 4] = [10, 100, 300, 1000];
const PLACED: [usize; 5] = [4, 8, 16, 32, 64];
const DIFFERENTIATED: [usize; 3] = [16, 32, 64];

/// Returns the name, the target time and the source text of every measured mechanism.
fn mechanism_sources() -> Vec<(String, &'static str, MechanismSourceText)> {
    let mechanism_entry_with_gravity = |name: &str, goal, item: &str| {
        let arguments = "gravity = -g * y".to_string();
        let item = item.to_string();
        (name.to_string(), goal, MechanismSourceText { arguments, item })
    };
    let mut list = vec![
        mechanism_entry_with_gravity("CartPole", "20 ms", CART_POLE),
        mechanism_entry_with_gravity("DoublePendulum", "", DOUBLE_PENDULUM),
    ];
    for (name, options, goal) in ROBOTS {
        let arguments = format!("urdf = \"../models/urdf/{name}.urdf\"{options}");
        let item = "pub struct Robot;".to_string();
        list.push((name.to_string(), goal, MechanismSourceText { arguments, item }));
    }
    for (symbolic, what) in [(false, "numbers"), (true, "parameters")] {
        list.extend(
            LENGTHS.map(|n| (format!("chain of {n}, {what}"), "", chain_source("Chain", n, symbolic))),
        );
    }
    list.extend(SPRINGS.map(|n| (format!("arm with {n} springs"), "", arm_with_springs_source(n))));
    list.extend(PLACED.map(|n| (format!("{n} particles, placed"), "", particle_chain_source(n))));
    for n in DIFFERENTIATED {
        let mut source = chain_source("Chain", n, false);
        source.arguments += ", derivatives";
        list.push((format!("chain of {n}, derivatives"), "", source));
    }
    list
}

/// Command of the child process that prints one line of the table, followed by the mechanism's number and the
/// library's path.
const LINE: &str = "line";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        [LINE, k, rlib] => k.parse().map_err(Into::into).and_then(|k| print_mechanism_line(k, rlib)),
        [] => print_mechanism_table(0, usize::MAX),
        [first] => first.parse().map_err(Into::into).and_then(|k| print_mechanism_table(k, k)),
        [first, last, ..] => {
            let range = first.parse().and_then(|first| Ok((first, last.parse()?)));
            range.map_err(Into::into).and_then(|(first, last)| print_mechanism_table(first, last))
        }
    };
    if let Err(error) = done {
        eprintln!("expansion: {error}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

/// Compiles mechanism `k` and prints its line of the table.
fn print_mechanism_line(k: usize, rlib: &str) -> Result<(), Box<dyn Error>> {
    let mechanisms = mechanism_sources();
    let (name, goal, source) = mechanisms.get(k).ok_or("there is no such mechanism")?;
    println!("{}", format_mechanism_line(name, goal, source, &CompiledRuntime { rlib: rlib.into() })?);
    Ok(())
}

/// Prints the lines of the mechanisms from `first` to `last`.
fn print_mechanism_table(first: usize, last: usize) -> Result<(), Box<dyn Error>> {
    let library = CompiledRuntime::build_runtime_crate()?;
    let profile = if cfg!(debug_assertions) {
        "dev: as cargo builds procedural macros"
    } else {
        "release: faster than cargo builds procedural macros"
    };
    println!("profile: {profile}; operations: mul + add + div\n");
    println!(
        "| mechanism | dof | expansion, ms | of that derivation | memory, MB | output, KB | nodes | mass \
         matrix | inverse | forward | rustc, s | rustc, MB | goal |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |");
    let program = std::env::current_exe()?;
    for k in first..=last.min(mechanism_sources().len() - 1) {
        let status = Command::new(&program).args([LINE, &k.to_string()]).arg(&library.rlib).status()?;
        if !status.success() {
            return Err(format!("mechanism {k} has no line").into());
        }
    }
    Ok(())
}

/// Returns the line of the table with the measured costs of a mechanism.
fn format_mechanism_line(
    name: &str,
    goal: &str,
    source: &MechanismSourceText,
    library: &CompiledRuntime,
) -> Result<String, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let arguments: TokenStream = source.arguments.parse()?;
    let item: TokenStream = source.item.parse()?;
    let emitted = expand(arguments.clone(), item.clone(), folder);
    let memory = peak_memory().map_or("–".to_string(), |kb| format!("{:.0}", kb / 1e3));
    let output = format!("{}\n{}", emitted.tokens, emitted.text);
    let rustc = measure_rustc_check(library, &output)?;

    let (mut whole, mut derivation) = (Duration::MAX, Duration::MAX);
    let start = Instant::now();
    for _ in 0..REPEATS {
        whole = whole.min(elapsed_time_of(|| expand(arguments.clone(), item.clone(), folder)));
        derivation = derivation
            .min(elapsed_time_of(|| CompiledMechanism::compile_mechanism(&source.arguments, &source.item)));
        if start.elapsed() > PATIENCE {
            break;
        }
    }
    let duration_in_milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
    let derived = CompiledMechanism::compile_mechanism(&source.arguments, &source.item);
    let operations_of_function = |name: &str| derived.operation_counts_of_function(name).operations;
    Ok(format!(
        "| {name} | {} | {:.1} | {:.1} | {memory} | {:.0} | {} | {} | {} | {} | {:.1} | {:.0} | {goal} |",
        derived.velocities,
        duration_in_milliseconds(whole),
        duration_in_milliseconds(derivation),
        output.len() as f64 / 1e3,
        derived.nodes,
        operations_of_function("mass_matrix"),
        operations_of_function("inverse_dynamics"),
        operations_of_function("forward_dynamics"),
        rustc.time.as_secs_f64(),
        rustc.memory / 1e6
    ))
}

fn elapsed_time_of<T>(f: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    std::hint::black_box(f());
    start.elapsed()
}

/// Returns the peak resident memory of this process so far, kB, if the system reports it.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}
