//! Agreement first, then time, as a table.

use crate::clock;
use crate::contender::{Contender, Function, Owner};
use crate::library::{self, Rows};
use crate::robots::{Robot, robots};
use linkwork_benches::states::STATES;
use std::path::Path;

/// How far results may differ, relative to one plus the largest number of the column.
const TOLERANCE: f64 = 1e-9;
/// Seconds that are measured at a time, so that reading the clock costs nothing.
const BATCH: f64 = 1e-4;
/// The C that CasADi generates, and how it is compiled.
const CASADI: [&str; 2] = ["plain", "shared"];
const FLAGS: [&str; 2] = ["exact", "fast"];

/// What is known of a contender after it has been measured.
struct Measured {
    owner: Owner,
    variant: String,
    /// Nanoseconds of a call.
    time: f64,
    bytes: Option<u64>,
}

/// Measures every function of every robot and prints a table. Whatever disagrees is left out; it is an error if that is
/// generated code of our own.
pub fn measure(folder: &Path, quick: bool) -> Result<(), String> {
    let budget = if quick { 0.05 } else { 0.2 };
    println!(
        "| robot | function | Linkwork, ns | with parameters | prepared | Pinocchio | CasADi C | dynibo | Pinocchio : Linkwork | CasADi : Linkwork | dynibo : Linkwork | code, bytes |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    let mut wrong = Vec::new();
    for make in robots() {
        let mut robot = make();
        let numbers: &'static [f64] = std::mem::take(&mut robot.numbers).leak();
        for function in Function::ALL {
            let mut contenders = contenders(folder, &mut robot, numbers, function);
            wrong.extend(agree(&mut contenders, &format!("{} {}", robot.name, function.title()), robot.nv));
            if contenders.iter().any(|contender| contender.owner() == Owner::Linkwork) {
                println!("{}", line(&robot, function, &time(&mut contenders, budget)));
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// All implementations of a function.
fn contenders(
    folder: &Path,
    robot: &mut Robot,
    numbers: &'static [f64],
    function: Function,
) -> Vec<Box<dyn Contender>> {
    let rows = Rows { nq: robot.nq, nv: robot.nv, numbers };
    let files = folder.join("robots").join(robot.name);
    let mut all = Vec::new();
    for (library, owner) in [("libpinocchio_peer.so", Owner::Pinocchio), ("libdynibo_peer.so", Owner::Dynibo)]
    {
        all.extend(library::peers(&folder.join(library), owner, &files, function, rows));
    }
    for form in CASADI {
        for flags in FLAGS {
            let path = files.join(format!("{}_{form}.{flags}.so", function.file()));
            all.extend(library::casadi(&path, function, rows));
        }
    }
    let generated = std::mem::take(&mut robot.functions);
    let (these, others) = generated.into_iter().partition(|(of, _)| *of == function);
    robot.functions = others;
    all.extend(Vec::from_iter(these).into_iter().map(|(_, contender)| contender));
    all
}

/// Leaves out what differs from the first, Pinocchio if it is there; tells of those of our own.
fn agree(contenders: &mut Vec<Box<dyn Contender>>, what: &str, nv: usize) -> Vec<String> {
    let Some(first) = contenders.first_mut() else { return Vec::new() };
    let expected: Vec<Vec<f64>> = (0..STATES).map(|state| first.result(state)).collect();
    let mut wrong = Vec::new();
    contenders.retain_mut(|contender| {
        let errors = expected.iter().enumerate();
        let errors = errors.map(|(state, expected)| difference(&contender.result(state), expected, nv));
        let error = largest(errors);
        let good = error <= TOLERANCE;
        if !good {
            let message =
                format!("{what}: {:?} {} is off by {error:e}", contender.owner(), contender.variant());
            eprintln!("{message}");
            if matches!(contender.owner(), Owner::Linkwork | Owner::Parameters | Owner::Prepared) {
                wrong.push(message);
            }
        }
        good
    });
    wrong
}

/// How far a result is off, column by column.
fn difference(found: &[f64], expected: &[f64], nv: usize) -> f64 {
    assert_eq!(found.len(), expected.len(), "size of a result");
    let columns = found.chunks_exact(nv).zip(expected.chunks_exact(nv));
    largest(columns.map(|(found, expected)| {
        let error = largest(found.iter().zip(expected).map(|(x, y)| (x - y).abs()));
        error / (1.0 + largest(expected.iter().map(|y| y.abs())))
    }))
}

/// The largest of some numbers, or what is no number.
fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// Measures in turns, each for `budget` seconds; the least time counts.
fn time(contenders: &mut [Box<dyn Contender>], budget: f64) -> Vec<Measured> {
    let seconds = |contender: &mut Box<dyn Contender>, passes: usize| {
        let start = clock::seconds();
        for _ in 0..passes {
            contender.pass();
        }
        (clock::seconds() - start) / passes as f64
    };
    let once = |contender: &mut Box<dyn Contender>| (seconds(contender, 1), seconds(contender, 1)).1;
    let passes: Vec<usize> =
        contenders.iter_mut().map(|c| (BATCH / once(c)).ceil().max(1.0) as usize).collect();
    let mut least = vec![f64::INFINITY; contenders.len()];
    let end = clock::seconds() + budget * contenders.len() as f64;
    while clock::seconds() < end {
        for (k, contender) in contenders.iter_mut().enumerate() {
            least[k] = least[k].min(seconds(contender, passes[k]));
        }
    }
    let measured = contenders.iter().zip(least).map(|(contender, least)| Measured {
        owner: contender.owner(),
        variant: contender.variant(),
        time: least * 1e9 / STATES as f64,
        bytes: contender.bytes(),
    });
    measured.collect()
}

/// A line of the table.
fn line(robot: &Robot, function: Function, measured: &[Measured]) -> String {
    let best = |owner| measured.iter().filter(|m| m.owner == owner).min_by(|a, b| a.time.total_cmp(&b.time));
    let own = best(Owner::Linkwork);
    let others = [Owner::Pinocchio, Owner::Casadi, Owner::Dynibo].map(best);
    let number = |value: Option<f64>, digits| value.map_or("–".to_string(), |x| format!("{x:.digits$}"));
    let time =
        |m: Option<&Measured>| number(m.map(|m| m.time), usize::from(m.is_some_and(|m| m.time < 100.0)));
    let ratio = |m: Option<&Measured>| number(m.zip(own).map(|(m, own)| m.time / own.time), 1);
    let mut cells = vec![format!("{} ({})", robot.name, robot.nv), function.title().to_string()];
    cells.extend([own, best(Owner::Parameters), best(Owner::Prepared)].map(time));
    cells.extend(others.map(time));
    cells.extend(others.map(ratio));
    cells.push(number(own.and_then(|m| m.bytes).map(|bytes| bytes as f64), 0));
    if let Some(casadi) = best(Owner::Casadi) {
        eprintln!("{} {}: CasADi's best is {}", robot.name, function.title(), casadi.variant);
    }
    format!("| {} |", cells.join(" | "))
}
