//! Checks that the implementations agree, then prints their times as a table.

use crate::robots::{RobotWithContenders, robot_constructors};
use linkwork_benches::peers::contender::{Contender, ContenderOwner, MeasuredFunction};
use linkwork_benches::peers::library::{self, StateRows};
use linkwork_benches::peers::turns::{
    ContenderMeasurement, TOLERANCE, measure_in_turns, remove_disagreeing_contenders,
};
use linkwork_benches::states::STATES;
use std::path::Path;

/// Variants of CasADi's generated C code, and of its compiler flags.
const CASADI: [&str; 2] = ["plain", "shared"];
const FLAGS: [&str; 2] = ["exact", "fast"];

/// Measures every function of every robot and prints a table. Implementations that disagree are omitted; a
/// disagreement of Linkwork's own code is an error.
pub fn measure_robots_and_print_table(folder: &Path, quick: bool) -> Result<(), String> {
    let budget = if quick { 0.05 } else { 0.2 };
    println!(
        "| robot | function | Linkwork, ns | with parameters | prepared | Pinocchio | CasADi C | dynibo | \
         Pinocchio : Linkwork | CasADi : Linkwork | dynibo : Linkwork | code, bytes |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    let mut wrong = Vec::new();
    for make in robot_constructors() {
        let mut robot = make();
        let numbers: &'static [f64] = std::mem::take(&mut robot.numbers).leak();
        for function in MeasuredFunction::ALL {
            let mut contenders = contenders_for_function(folder, &mut robot, numbers, function);
            let what = format!("{} {}", robot.name, function.title_in_table());
            wrong.extend(remove_disagreeing_contenders(
                &mut contenders,
                &what,
                (robot.nv, STATES),
                TOLERANCE,
            ));
            if contenders.iter().any(|contender| contender.owner() == ContenderOwner::Linkwork) {
                let measured = measure_in_turns(&mut contenders, STATES, budget);
                println!("{}", format_table_line(&robot, function, ContenderOwner::Linkwork, &measured));
                if measured.iter().any(|m| m.owner == ContenderOwner::Kept) {
                    println!("{}", format_table_line(&robot, function, ContenderOwner::Kept, &measured));
                }
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// Returns the implementations of a function in all libraries that have the function.
fn contenders_for_function(
    folder: &Path,
    robot: &mut RobotWithContenders,
    numbers: &'static [f64],
    function: MeasuredFunction,
) -> Vec<Box<dyn Contender>> {
    let rows = StateRows { nq: robot.nq, nv: robot.nv, numbers };
    let files = folder.join("robots").join(robot.name);
    let mut all = Vec::new();
    for (library, owner) in
        [("libpinocchio_peer.so", ContenderOwner::Pinocchio), ("libdynibo_peer.so", ContenderOwner::Dynibo)]
    {
        all.extend(library::peer_contenders_of_library(&folder.join(library), owner, &files, function, rows));
    }
    for form in CASADI {
        for flags in FLAGS {
            let path = files.join(format!("{}_{form}.{flags}.so", function.file_name()));
            all.extend(library::load_casadi_function(&path, function, rows));
        }
    }
    let generated = std::mem::take(&mut robot.functions);
    let (these, others) = generated.into_iter().partition(|(of, _)| *of == function);
    robot.functions = others;
    all.extend(Vec::from_iter(these).into_iter().map(|(_, contender)| contender));
    all
}

/// Returns a line of the table with the times of one of Linkwork's functions.
fn format_table_line(
    robot: &RobotWithContenders,
    function: MeasuredFunction,
    owner: ContenderOwner,
    measured: &[ContenderMeasurement],
) -> String {
    let fastest_of_owner =
        |owner| measured.iter().filter(|m| m.owner == owner).min_by(|a, b| a.time.total_cmp(&b.time));
    let own = fastest_of_owner(owner);
    let others =
        [ContenderOwner::Pinocchio, ContenderOwner::Casadi, ContenderOwner::Dynibo].map(fastest_of_owner);
    let format_optional_number =
        |value: Option<f64>, digits| value.map_or("–".to_string(), |x| format!("{x:.digits$}"));
    let format_time = |m: Option<&ContenderMeasurement>| {
        format_optional_number(m.map(|m| m.time), usize::from(m.is_some_and(|m| m.time < 100.0)))
    };
    let format_time_ratio = |m: Option<&ContenderMeasurement>| {
        format_optional_number(m.zip(own).map(|(m, own)| m.time / own.time), 1)
    };
    let kept = if owner == ContenderOwner::Kept { ", zeros kept" } else { "" };
    let mut cells =
        vec![format!("{} ({})", robot.name, robot.nv), format!("{}{kept}", function.title_in_table())];
    cells.extend(
        [own, fastest_of_owner(ContenderOwner::Parameters), fastest_of_owner(ContenderOwner::Prepared)]
            .map(format_time),
    );
    cells.extend(others.map(format_time));
    cells.extend(others.map(format_time_ratio));
    cells.push(format_optional_number(own.and_then(|m| m.bytes).map(|bytes| bytes as f64), 0));
    if let Some(casadi) = fastest_of_owner(ContenderOwner::Casadi) {
        eprintln!("{} {}: CasADi's best is {}", robot.name, function.title_in_table(), casadi.variant);
    }
    format!("| {} |", cells.join(" | "))
}
