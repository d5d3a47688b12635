//! Comparison of constrained mechanisms with other libraries: accelerations, and a thousand steps.

use crate::mechanisms::{Mechanism, mechanism_constructors};
use linkwork_benches::peers::contender::{Contender, ContenderOwner, MeasuredFunction};
use linkwork_benches::peers::library::{self, StateRows};
use linkwork_benches::peers::turns::{
    ContenderMeasurement, TOLERANCE, largest_or_nan, largest_relative_difference, measure_in_turns,
    remove_disagreeing_contenders,
};
use linkwork_benches::states::STATES;
use std::fs;
use std::io;
use std::path::Path;

/// Tolerance for comparing motions: methods of one order, with and without projection, differ by more than
/// rounding.
const MOTIONS: f64 = 1e-3;

/// The peers with the files of their libraries; `*` is replaced by the folder of the mechanism.
const LIBRARIES: [(&str, ContenderOwner); 4] = [
    ("*/sympy.exact.so", ContenderOwner::Sympy),
    ("*/sympy.fast.so", ContenderOwner::Sympy),
    ("libpinocchio.so", ContenderOwner::Pinocchio),
    ("libmujoco.so", ContenderOwner::Mujoco),
];

/// Order in which the columns of the implementations appear in the table.
const COLUMNS: [ContenderOwner; 4] =
    [ContenderOwner::Linkwork, ContenderOwner::Sympy, ContenderOwner::Pinocchio, ContenderOwner::Mujoco];

/// Writes a file for every mechanism with a state and its accelerations in each line, and prints the names of
/// the folders.
pub fn write_mechanism_files(folder: &Path) -> io::Result<()> {
    for make in mechanism_constructors() {
        let m = make();
        let folder = folder.join(m.name);
        fs::create_dir_all(&folder)?;
        let format_state_line = |row: &[f64]| {
            let numbers: Vec<String> = row[..m.nq + 2 * m.nv].iter().map(|x| format!("{x:e}")).collect();
            numbers.join(" ") + "\n"
        };
        let lines: String = m.numbers.chunks_exact(m.nq + 3 * m.nv).map(format_state_line).collect();
        fs::write(folder.join("states"), lines)?;
        println!("{}", m.name);
    }
    Ok(())
}

/// Measured times of one mechanism, a line of the table.
struct MechanismTimes {
    mechanism: Mechanism,
    accelerations: Vec<ContenderMeasurement>,
    steps: Vec<ContenderMeasurement>,
    /// Nanoseconds of accelerations with lambdify and with PyDy, and milliseconds of a thousand steps.
    python: Option<[f64; 3]>,
    /// Largest difference between MuJoCo's accelerations and Linkwork's.
    soft: Option<f64>,
}

/// Measures all mechanisms and prints two tables; without a folder of peers, only Linkwork is measured.
pub fn measure_mechanisms(folder: Option<&Path>, quick: bool) -> Result<(), String> {
    let budget = if quick { 0.05 } else { 0.3 };
    let (mut lines, mut wrong) = (Vec::new(), Vec::new());
    for make in mechanism_constructors() {
        let mut mechanism = make();
        let numbers: &'static [f64] = std::mem::take(&mut mechanism.numbers).leak();
        let (mut soft, mut found) = (None, Vec::new());
        for function in [MeasuredFunction::Constrained, MeasuredFunction::Motion] {
            let (states, tolerance) =
                if function == MeasuredFunction::Motion { (1, MOTIONS) } else { (STATES, TOLERANCE) };
            let rows = StateRows {
                nq: mechanism.nq,
                nv: mechanism.nv,
                numbers: &numbers[..states * (mechanism.nq + 3 * mechanism.nv)],
            };
            let own = if function == MeasuredFunction::Motion {
                &mut mechanism.motion
            } else {
                &mut mechanism.accelerations
            };
            let own = std::mem::replace(own, Box::new(PlaceholderContender));
            let (mut exact, mut others) = (vec![own], Vec::new());
            for peer in folder
                .into_iter()
                .flat_map(|folder| contenders_of_peers(folder, mechanism.name, function, rows))
            {
                if peer.owner() == ContenderOwner::Mujoco { others.push(peer) } else { exact.push(peer) }
            }
            let what = format!("{} {}", mechanism.title, function.title_in_table());
            wrong.extend(remove_disagreeing_contenders(&mut exact, &what, (rows.nv, states), tolerance));
            if let (Some(other), MeasuredFunction::Constrained) = (others.first_mut(), function) {
                let errors = (0..states).map(|k| {
                    largest_relative_difference(
                        &other.result_at_state(k),
                        &exact[0].result_at_state(k),
                        rows.nv,
                    )
                });
                soft = Some(largest_or_nan(errors));
            }
            exact.extend(others);
            found.push(measure_in_turns(&mut exact, states, budget));
        }
        let steps = found.pop().unwrap_or_default();
        let accelerations = found.pop().unwrap_or_default();
        let python = folder.and_then(|folder| python_times(&folder.join(mechanism.name)));
        lines.push(MechanismTimes { mechanism, accelerations, steps, python, soft });
    }
    print_table(&lines);
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// Returns the implementations of this function by all peers that have the mechanism.
fn contenders_of_peers(
    folder: &Path,
    name: &str,
    function: MeasuredFunction,
    rows: StateRows<'_>,
) -> Vec<Box<dyn Contender>> {
    let own = folder.join(name);
    let libraries = LIBRARIES.iter().flat_map(|(path, owner)| {
        let path = folder.join(path.replace('*', name));
        library::peer_contenders_of_library(&path, *owner, &own, function, rows)
    });
    libraries.collect()
}

/// Reads the times that the Python script `derive.py` has measured.
fn python_times(folder: &Path) -> Option<[f64; 3]> {
    let text = fs::read_to_string(folder.join("python")).ok()?;
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|x| x.parse().ok()).collect();
    numbers.try_into().ok()
}

fn print_table(lines: &[MechanismTimes]) {
    let header =
        "| mechanism | v | λ | Linkwork, ns | SymPy, C | Pinocchio | MuJoCo | PyDy | SymPy, lambdify";
    let ratios =
        ["SymPy C", "Pinocchio", "MuJoCo", "PyDy", "lambdify"].map(|peer| format!("{peer} : Linkwork"));
    println!("{header} | {} | MuJoCo differs by |", ratios.join(" | "));
    println!("| --- | {}", "---: | ".repeat(14).trim_end());
    for line in lines {
        let [lambdify, pydy, _] = line.python.map_or([None; 3], |times| times.map(Some));
        let others = minimum_times_by_owner(&line.accelerations).into_iter().chain([pydy, lambdify]);
        let times: Vec<Option<f64>> = others.collect();
        let mut cells = vec![line.mechanism.title.to_string()];
        cells.extend([line.mechanism.nv, line.mechanism.nc].map(|n| n.to_string()));
        cells.extend(times.iter().map(|t| format_significant_digits(*t, 3)));
        cells.extend(
            times[1..].iter().map(|t| format_significant_digits(t.zip(times[0]).map(|(t, own)| t / own), 2)),
        );
        cells.push(line.soft.map_or("–".to_string(), |e| format!("{e:.0e}")));
        println!("| {} |", cells.join(" | "));
    }
    println!("\n| mechanism: a thousand steps, ms | Linkwork | SymPy, C | Pinocchio | MuJoCo | PyDy |");
    println!("| --- | {}", "---: | ".repeat(5).trim_end());
    for line in lines {
        let times = minimum_times_by_owner(&line.steps).map(|t| t.map(|t| t * 10.0 / 1e6));
        let mut cells = vec![line.mechanism.title.to_string()];
        cells.extend(
            times.into_iter().chain([line.python.map(|t| t[2])]).map(|t| format_significant_digits(t, 3)),
        );
        println!("| {} |", cells.join(" | "));
    }
}

/// Returns the minimum times of Linkwork and of the peers.
fn minimum_times_by_owner(measured: &[ContenderMeasurement]) -> [Option<f64>; 4] {
    COLUMNS.map(|owner| {
        let all = measured.iter().filter(|m| m.owner == owner);
        all.map(|m| m.time).min_by(f64::total_cmp)
    })
}

/// Formats a value with this number of significant digits, or a dash.
fn format_significant_digits(value: Option<f64>, digits: i32) -> String {
    let Some(x) = value.filter(|x| *x > 0.0) else { return "–".to_string() };
    let decimals = (digits - 1 - x.log10().floor() as i32).max(0) as usize;
    format!("{x:.decimals$}")
}

/// Placeholder in the list for a contender that has been moved out of the list.
struct PlaceholderContender;

impl Contender for PlaceholderContender {
    fn owner(&self) -> ContenderOwner {
        ContenderOwner::Linkwork
    }

    fn variant_name(&self) -> String {
        String::new()
    }

    fn evaluate_all_states(&mut self) {}

    fn result_at_state(&mut self, _state: usize) -> Vec<f64> {
        Vec::new()
    }
}
