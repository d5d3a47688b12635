//! What the compiler costs: time, memory and output of expanding mechanisms, next to the goals.
//!
//! `cargo run -p linkwork-benches --bin expansion`, in the dev profile: that is how cargo builds procedural macros.
//! Each mechanism is expanded in a process of its own, so that its memory can be told from the others'. What rustc does
//! with the text that comes out (reading it takes some 15 ms per megabyte) is not part of the figures.

use linkwork_benches::chains::{Source, chain};
use linkwork_benches::operations::Operations;
use linkwork_compiler::expand;
use proc_macro2::{LexError, TokenStream};
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

/// Repetitions of which the fastest is shown, unless that takes longer than `PATIENCE`.
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

/// Name, options of the file, goal.
const ROBOTS: [(&str, &str, &str); 4] = [
    ("ur5", "", ""),
    ("panda", ", mimic = independent", "150 ms"),
    ("solo12", ", base = free", ""),
    ("simple_humanoid", ", base = free", "1500 ms, 300 MB"),
];
const LENGTHS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Name, goal and text of every mechanism.
fn mechanisms() -> Vec<(String, &'static str, Source)> {
    let own = |name: &str, goal, item: &str| {
        let arguments = "gravity = -g * y".to_string();
        let item = item.to_string();
        (name.to_string(), goal, Source { arguments, item })
    };
    let mut list = vec![own("CartPole", "20 ms", CART_POLE), own("DoublePendulum", "", DOUBLE_PENDULUM)];
    for (name, options, goal) in ROBOTS {
        let arguments = format!("urdf = \"../models/urdf/{name}.urdf\"{options}");
        let item = "pub struct Robot;".to_string();
        list.push((name.to_string(), goal, Source { arguments, item }));
    }
    for (symbolic, what) in [(false, "numbers"), (true, "parameters")] {
        list.extend(LENGTHS.map(|n| (format!("chain of {n}, {what}"), "", chain("Chain", n, symbolic))));
    }
    list
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    match arguments.next().map(|word| word.parse()) {
        None => table(),
        Some(Ok(k)) => {
            let mechanisms = mechanisms();
            let Some((name, goal, source)) = mechanisms.get::<usize>(k) else {
                eprintln!("expansion: there are {} mechanisms", mechanisms.len());
                return ExitCode::FAILURE;
            };
            match line(name, goal, source) {
                Ok(line) => println!("{line}"),
                Err(error) => eprintln!("{name}: {error}"),
            }
            ExitCode::SUCCESS
        }
        Some(Err(_)) => {
            eprintln!("expansion: expected no argument, or the number of a mechanism");
            ExitCode::FAILURE
        }
    }
}

fn table() -> ExitCode {
    let profile = if cfg!(debug_assertions) {
        "dev: as cargo builds procedural macros"
    } else {
        "release: faster than cargo builds procedural macros"
    };
    println!("profile: {profile}; operations: mul + add + div\n");
    println!(
        "| mechanism | dof | expansion, ms | of that derivation | memory, MB | output, KB | nodes | mass matrix | inverse | forward | goal |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |");
    let Ok(program) = std::env::current_exe() else {
        return ExitCode::FAILURE;
    };
    for k in 0..mechanisms().len() {
        let Ok(status) = Command::new(&program).arg(k.to_string()).status() else {
            return ExitCode::FAILURE;
        };
        if !status.success() {
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

/// A line of the table.
fn line(name: &str, goal: &str, source: &Source) -> Result<String, LexError> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let arguments: TokenStream = source.arguments.parse()?;
    let item: TokenStream = source.item.parse()?;
    let emitted = expand(arguments.clone(), item.clone(), folder);
    let memory = peak_memory().map_or("–".to_string(), |kb| format!("{:.0}", kb / 1e3));
    let size = emitted.text.len() + emitted.tokens.to_string().len();

    let (mut whole, mut derivation) = (Duration::MAX, Duration::MAX);
    let start = Instant::now();
    for _ in 0..REPEATS {
        whole = whole.min(timed(|| expand(arguments.clone(), item.clone(), folder)));
        derivation = derivation.min(timed(|| Operations::of(&source.arguments, &source.item)));
        if start.elapsed() > PATIENCE {
            break;
        }
    }
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let derived = Operations::of(&source.arguments, &source.item);
    let operations = |name: &str| derived.function(name).operations;
    Ok(format!(
        "| {name} | {} | {:.1} | {:.1} | {memory} | {:.0} | {} | {} | {} | {} | {goal} |",
        derived.velocities,
        ms(whole),
        ms(derivation),
        size as f64 / 1e3,
        derived.nodes,
        operations("mass_matrix"),
        operations("inverse_dynamics"),
        operations("forward_dynamics")
    ))
}

fn timed<T>(f: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    std::hint::black_box(f());
    start.elapsed()
}

/// The largest resident size of this process so far, kB, where the system tells.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}
