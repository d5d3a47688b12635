//! Example that measures the times of loading mechanisms and of calls of their functions.
//!
//! `cargo run --release -p linkwork-jit --example measure -- FILE [OPTIONS [NAME]]` prints how long loading
//! and the code of each function take, how long a call takes, and how far the results are from those of the
//! interpreter, relative to the largest one.

use linkwork_jit::{Error, Loader, Robot};
use std::time::Instant;

fn main() -> Result<(), Error> {
    let mut words = std::env::args().skip(1);
    let file = words.next().unwrap_or_else(|| "models/urdf/panda.urdf".to_string());
    let (options, name) = (words.next().unwrap_or_default(), words.next());
    let start = Instant::now();
    let robot = loader_of_file(&file, &options, name.as_deref()).load()?;
    let loaded = start.elapsed();
    let robot = fill_missing_parameters(robot)?;
    if let Ok(f) = robot.function("inverse_dynamics") {
        let (q, zero) = (robot.neutral()?, vec![0.0; robot.nv()]);
        let mut arguments: Vec<&[f64]> = vec![q.as_slice(), &zero, &zero];
        if robot.depends_on_time() {
            arguments.insert(0, &[0.0]);
        }
        robot.evaluate(&f, &arguments)?;
    }
    println!("{robot:?}");
    println!(
        "loaded in {:.2} ms, first inverse dynamics after {:.2} ms",
        duration_in_milliseconds(loaded),
        duration_in_milliseconds(start.elapsed())
    );
    let oracle = loader_of_file(&file, &options, name.as_deref()).interpreted().load()?;
    let oracle = fill_missing_parameters(oracle)?;
    let mut worst: f64 = 0.0;
    println!("{:42} {:>9} {:>9} {:>9}", "function", "code, ms", "call, ns", "deviation");
    let mut total = 0.0;
    for f in robot.functions() {
        let start = Instant::now();
        let compiled = f.compile();
        let code = duration_in_milliseconds(start.elapsed());
        total += code;
        let lists: Vec<Vec<f64>> = argument_values(&robot, &f.arguments());
        let lists: Vec<&[f64]> = lists.iter().map(Vec::as_slice).collect();
        let mut out = vec![0.0; f.length()];
        robot.evaluate_into(&f, &lists, &mut out)?;
        let expected = oracle.evaluate(&oracle.function(f.name())?, &lists)?;
        let scale = expected.iter().filter(|x| x.is_finite()).fold(1.0_f64, |most, x| most.max(x.abs()));
        let both_nan_or_equal = |a: f64, b: f64| a.is_nan() && b.is_nan() || a == b;
        let deviation = out
            .iter()
            .zip(&expected)
            .map(|(a, b)| if both_nan_or_equal(*a, *b) { 0.0 } else { (a - b).abs() / scale });
        let deviation =
            deviation.fold(0.0_f64, |most, x| if x.is_nan() { f64::INFINITY } else { most.max(x) });
        worst = worst.max(deviation);
        let mut best = f64::INFINITY;
        for _ in 0..20 {
            let start = Instant::now();
            for _ in 0..200 {
                robot.evaluate_into(&f, &lists, &mut out)?;
            }
            best = best.min(start.elapsed().as_secs_f64() / 200.0 * 1e9);
        }
        let note = if compiled { "" } else { "interpreted" };
        println!("{:42} {code:9.2} {best:9.1} {deviation:9.1e} {note}", f.name());
    }
    println!("code of all functions: {total:.1} ms; largest deviation {worst:.1e}");
    Ok(())
}

fn loader_of_file(file: &str, options: &str, name: Option<&str>) -> Loader {
    let loader = Loader::file(file).options(options);
    name.map_or(loader.clone(), |name| loader.name(name))
}

/// Returns the robot with a value for each parameter that had none.
fn fill_missing_parameters(mut robot: Robot) -> Result<Robot, Error> {
    let names: Vec<String> = robot.parameters().iter().map(|p| p.name.clone()).collect();
    for (k, name) in names.iter().enumerate() {
        if robot.parameter(name)?.is_nan() {
            robot.set_parameter(name, 0.5 + 0.1 * k as f64)?;
        }
    }
    Ok(robot)
}

/// Returns values for the arguments of a function; configurations have unit quaternions.
fn argument_values(robot: &Robot, list: &[(&str, usize)]) -> Vec<Vec<f64>> {
    let sample_values = |seed: usize, n: usize| -> Vec<f64> {
        (0..n).map(|k| 0.4 * ((7 * k + 3 * seed + 1) as f64).sin()).collect()
    };
    let sample_configuration = |seed| {
        let neutral = robot.neutral().unwrap_or_default();
        let q = robot.integrate(neutral.as_slice(), &sample_values(seed, robot.nv()));
        q.map_or(Vec::new(), |q| q.as_slice().to_vec())
    };
    let each = list.iter().enumerate().map(|(k, (name, n))| match *name {
        "q" | "from" | "to" => sample_configuration(k),
        _ => sample_values(k, *n),
    });
    each.collect()
}

fn duration_in_milliseconds(time: std::time::Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
