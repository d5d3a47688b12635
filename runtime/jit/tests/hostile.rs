//! Checks that loading is safe within other programs: memory is returned, and no input crashes the process.
//!
//! `LINKWORK_LOADS` and `LINKWORK_INPUTS` choose the numbers of loads and of random inputs, `LINKWORK_SEED`
//! the first seed. Each input is in a file `input` in a folder of the temporary folder until the next one.

use linkwork_jit::{AnyTable, Error, Loader, Robot};
use random::Random;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

mod random;

/// Lock that prevents tests from running at the same time, so that each measures only its own memory.
static TURN: Mutex<()> = Mutex::new(());
/// Default number of loads in the memory test. The constant below is the number of random inputs.
const LOADS: u64 = 200;
const INPUTS: u64 = 120;
/// Maximum growth of memory during all loads, bytes: less than one retained page per load.
const GROWTH: u64 = 4096 * LOADS / 2;
/// Maximum time to load one mutated input in a debug build on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn number_from_environment(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

const PENDULUM: &str = "#[mechanism(gravity = -9.81 * y, derivatives)]
    struct Pendulum {
        length: f64,
        #[body(mass = 2, com = -length * y, inertia = rod(2, 2 * length, y))]
        rod: Body,
        #[joint(ground -> rod, about = z)]
        hinge: Pin,
        #[acts(on = hinge)]
        motor: Torque,
    }";

/// Returns the resident memory of the process, bytes.
fn resident_memory() -> Option<u64> {
    let text = fs::read_to_string("/proc/self/statm").ok()?;
    Some(4096 * text.split_whitespace().nth(1)?.parse::<u64>().ok()?)
}

fn load_and_call() -> Result<(), Error> {
    let robot = Loader::text(PENDULUM).load()?.with_parameters(&[("length", 0.5)])?;
    robot.forward_dynamics_derivatives(&[0.1], &[0.2], &[0.3])?;
    robot.linearize(&[0.1], &[0.0], &[0.3])?;
    robot.simulate().from(&[0.1], &[0.0]).duration(0.01).run()?;
    Ok(())
}

#[test]
fn loading_and_dropping_robots_returns_memory() -> Result<(), Error> {
    let _turn = TURN.lock();
    let loads = number_from_environment("LINKWORK_LOADS", LOADS);
    (0..loads / 4).try_for_each(|_| load_and_call())?;
    let Some(before) = resident_memory() else { return Ok(()) };
    (0..loads).try_for_each(|_| load_and_call())?;
    let growth = resident_memory().unwrap_or(before).saturating_sub(before);
    assert!(growth < GROWTH, "{growth} bytes more after {loads} loads");
    Ok(())
}

/// A robot whose table is replaced uses no more memory, and equal tables give equal forces.
#[test]
fn memory_of_replaced_tables_is_returned() -> Result<(), Box<dyn std::error::Error>> {
    const POINTS: usize = 100;
    const SETS: usize = 10_000;
    let _turn = TURN.lock();
    let mut robot = Loader::text(
        "#[mechanism] struct Slider {
            force: Table<1>,
            #[body(mass = 2)] block: Body,
            #[joint(ground -> block, along = x)] slide: Sleeve,
            #[acts(on = slide, value = -force(slide))] spring: Force,
        }",
    )
    .load()?;
    let axis: Vec<f64> = (0..POINTS).map(|k| k as f64).collect();
    let mut set_table_and_call = |stiffness: f64| -> Result<(), Box<dyn std::error::Error>> {
        let values: Vec<f64> = axis.iter().map(|x| stiffness * x).collect();
        robot.set_table("force", AnyTable::from_grid(&[&axis], &values)?)?;
        let found = robot.forward_dynamics(&[3.0], &[0.0], &[0.0])?[0];
        assert!((found + 1.5 * stiffness).abs() < 1e-12 * stiffness.max(1.0), "{found}");
        Ok(())
    };
    (0..SETS / 4).try_for_each(|k| set_table_and_call(k as f64))?;
    let Some(before) = resident_memory() else { return Ok(()) };
    (0..SETS).try_for_each(|k| set_table_and_call(k as f64))?;
    let growth = resident_memory().unwrap_or(before).saturating_sub(before);
    // The values alone are 8 MB.
    assert!(growth < 500_000, "{growth} bytes more after {SETS} tables");
    Ok(())
}

impl Random {
    fn choose_from_list<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.index_below(list.len())]
    }

    fn random_value(&mut self) -> f64 {
        match self.index_below(12) {
            0 => [f64::NAN, f64::INFINITY, -1e300, 1e-320, 0.0, 1e9][self.index_below(6)],
            _ => self.index_below(2001) as f64 / 1000.0 - 1.0,
        }
    }
}

/// Texts that mutations insert into files and declarations.
const WORDS: [&str; 40] = [
    "NaN",
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "0",
    "-1",
    "99999999999999999999",
    "",
    " ",
    "\0",
    "é",
    "\u{202e}",
    "&amp;",
    "&bomb;",
    "<",
    ">",
    "\"",
    "/>",
    "<!--",
    "<![CDATA[",
    "(",
    ")",
    "[",
    "{",
    "}",
    ",",
    "#[",
    "->",
    "ground",
    "self",
    "f64",
    "'a",
    "1.0.0",
    "0x1",
    "<mimic joint=\"j\" multiplier=\"1\"/>",
    "${x}",
    "r#\"",
];
const OPTIONS: [&str; 14] = [
    "",
    "",
    "derivatives",
    "derivatives",
    "base = free",
    "base = free, derivatives, regressor",
    "inertia = trust",
    "limits = stops",
    "inputs = none",
    "scalar = f32",
    "second_derivatives",
    "snap = 1e-3",
    "lock = [\"a\"]",
    "((,",
];

/// Returns the texts of small robots and mechanisms, with the extensions of their files.
fn fuzz_subjects() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folders = ["tests/data/urdf", "tests/data/mjcf", "tests/data/sdf", "models/src", "models/urdf"];
    let mut all = Vec::new();
    for folder in folders {
        let mut files: Vec<PathBuf> = fs::read_dir(root.join(folder))
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
            .collect();
        files.sort();
        for file in files.iter().filter(|file| file.is_file()) {
            let Ok(text) = fs::read_to_string(file) else { continue };
            let end = file.extension().unwrap_or_default().to_string_lossy().to_string();
            if text.len() < 12_000 && (end != "rs" || text.contains("mechanism")) {
                all.push((text, end));
            }
        }
    }
    assert!(all.len() > 60, "{} files", all.len());
    all
}

/// Applies random mutations to a text, which may insert parts of another text.
fn change_text(text: &mut String, other: &str, random: &mut Random) {
    let random_char_boundary = |text: &str, random: &mut Random| {
        let mut at = random.index_below(text.len() + 1);
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let (a, b) = (random_char_boundary(text, random), random_char_boundary(text, random));
    let (first, last) = (a.min(b), a.max(b));
    let near =
        text[first..].char_indices().nth(1 + random.index_below(30)).map_or(text.len(), |(k, _)| first + k);
    match random.index_below(10) {
        0 => text.insert_str(a, random.choose_from_list(&WORDS)),
        1 => drop(text.drain(first..near)),
        2 => text.replace_range(first..near, random.choose_from_list(&WORDS)),
        3 => {
            let part = text[first..near].to_string();
            text.insert_str(last, &part);
        }
        4 => text.truncate(last),
        5 => {
            let from = random_char_boundary(other, random);
            let part: String = other[from..].chars().take(random.index_below(400)).collect();
            text.insert_str(a, &part);
        }
        6 | 7 => {
            // A number becomes a hostile one.
            let is_number_character = |c: char| c.is_ascii_digit() || c == '.';
            if let Some(start) = text[a..].find(|c: char| c.is_ascii_digit()).map(|k| a + k) {
                let end = text[start..].find(|c| !is_number_character(c)).map_or(text.len(), |k| start + k);
                text.replace_range(start..end, random.choose_from_list(&WORDS[..10]));
            }
        }
        8 => {
            // A line is repeated, rarely very often.
            let start = text[..a].rfind('\n').map_or(0, |k| k + 1);
            let end = text[a..].find('\n').map_or(text.len(), |k| a + k + 1);
            let line = text[start..end].to_string();
            let count = if random.index_below(20) == 0 { 2000 } else { 1 + random.index_below(6) };
            text.insert_str(start, &line.repeat(count));
        }
        _ => {
            let (open, close) =
                [("(", ")"), ("[", "]"), ("<link name=\"l\">", "</link>"), ("-", "")][random.index_below(4)];
            let count = [3, 40, 5000][random.index_below(3)];
            text.replace_range(first..near, &format!("{}{}", open.repeat(count), close.repeat(count)));
        }
    }
}

/// Calls the functions of a robot with random values, including NaN, infinite and very large ones.
fn call_all_functions(mut robot: Robot, random: &mut Random) -> Result<(), Error> {
    let names: Vec<String> = robot.parameters().iter().map(|parameter| parameter.name.clone()).collect();
    for name in names {
        // Not finite values are rejected.
        let _ = robot.set_parameter(&name, random.random_value());
        if robot.parameter(&name)?.is_nan() {
            robot.set_parameter(&name, 0.7)?;
        }
    }
    let _ = (robot.validate(), robot.limits(), robot.neutral());
    let functions: Vec<_> = robot.functions().collect();
    for _ in 0..20 {
        let Some(f) = functions.get(random.index_below(functions.len())) else { return Ok(()) };
        let lists: Vec<Vec<f64>> =
            f.arguments().iter().map(|(_, n)| (0..*n).map(|_| random.random_value()).collect()).collect();
        let lists: Vec<&[f64]> = lists.iter().map(Vec::as_slice).collect();
        let _ = robot.evaluate(f, &lists);
        let _ = robot.evaluate(f, &lists[..lists.len().saturating_sub(1)]);
    }
    let (q, v) = (vec![0.1; robot.nq()], vec![0.1; robot.nv()]);
    if random.index_below(4) == 0 && robot.nv() < 8 {
        let _ = robot.assemble(&q, &[]);
        let _ = robot.simulate().from(&q, &v).duration(1e-3).run();
    }
    Ok(())
}

#[test]
fn no_input_crashes() -> Result<(), Box<dyn std::error::Error>> {
    let _turn = TURN.lock();
    let (subjects, first) = (fuzz_subjects(), number_from_environment("LINKWORK_SEED", 0));
    let folder = std::env::temp_dir().join(format!("linkwork_hostile_{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let (mut loaded, mut wrong) = (0, Vec::new());
    for seed in first..first + number_from_environment("LINKWORK_INPUTS", INPUTS) {
        let mut random = Random(seed);
        let (mut text, end) = subjects[random.index_below(subjects.len())].clone();
        let other = &subjects[random.index_below(subjects.len())].0;
        (0..1 + random.index_below(3)).for_each(|_| change_text(&mut text, other, &mut random));
        let options = random.choose_from_list(&OPTIONS);
        let path = folder.join(format!("input.{end}"));
        fs::write(&path, &text)?;
        let start = Instant::now();
        match Loader::file(&path).options(options).folder(&folder).load() {
            Ok(robot) => {
                loaded += 1;
                let run = std::panic::AssertUnwindSafe(|| call_all_functions(robot, &mut random));
                match std::panic::catch_unwind(run) {
                    Ok(Ok(())) => {}
                    Ok(Err(error)) => wrong.push(format!("seed {seed}: {error}")),
                    Err(_) => wrong.push(format!("seed {seed}: a call panicked")),
                }
            }
            Err(Error::Internal(message)) => wrong.push(format!("seed {seed}, {options}: {message}")),
            Err(_) => {}
        }
        if start.elapsed() > PATIENCE {
            wrong.push(format!("seed {seed}, {options}: {:?}", start.elapsed()));
        }
    }
    fs::remove_dir_all(&folder)?;
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(loaded > 0, "every input is wrong");
    Ok(())
}
