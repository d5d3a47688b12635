//! Tests of exported FMUs: a small importer simulates them in both modes, and the motions are compared with
//! `linkwork simulate` and with closed forms.

#[path = "fmu/derivatives.rs"]
mod derivatives;
#[path = "fmu/importers.rs"]
mod importers;
#[path = "fmu/library.rs"]
mod library;
#[path = "fmu/wrong.rs"]
mod wrong;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Returns the C compiler of the system, if there is one.
fn find_c_compiler() -> Option<&'static str> {
    let found = Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        println!("skipped: there is no C compiler");
    }
    found.then_some("cc")
}

/// Runs the command, and returns its standard output or its standard error.
fn run_linkwork(arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(env!("CARGO_BIN_EXE_linkwork"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .output()
        .expect("the command starts");
    let decode_utf8 = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.success() { Ok(decode_utf8(&output.stdout)) } else { Err(decode_utf8(&output.stderr)) }
}

/// Returns the paths and contents of an archive whose files are stored without compression.
fn unpack_archive(archive: &[u8]) -> Vec<(String, Vec<u8>)> {
    let little_endian_number = |at: usize, length: usize| {
        archive[at..at + length].iter().rev().fold(0, |sum, byte| (sum << 8) | usize::from(*byte))
    };
    let (mut files, mut at) = (Vec::new(), 0);
    while archive[at..].starts_with(b"PK\x03\x04") {
        let (size, name) = (little_endian_number(at + 18, 4), little_endian_number(at + 26, 2));
        let start = at + 30 + name;
        let path = String::from_utf8_lossy(&archive[at + 30..start]).into_owned();
        files.push((path, archive[start..start + size].to_vec()));
        at = start + size;
    }
    files
}

/// Exported FMU whose C sources are linked with a small importer program.
struct Fmu {
    /// Text of `modelDescription.xml`.
    description: String,
    program: PathBuf,
}

impl Fmu {
    /// Exports a mechanism, and compiles it without warnings. Returns `None` without a C compiler.
    fn new(name: &str, arguments: &[&str]) -> Option<Fmu> {
        Fmu::export_and_compile_with_importer(name, arguments, "importer.c", &[])
    }

    /// Exports a mechanism, and compiles it with an importer and with more options of the compiler.
    fn export_and_compile_with_importer(
        name: &str,
        arguments: &[&str],
        importer: &str,
        more: &[&str],
    ) -> Option<Fmu> {
        let compiler = find_c_compiler()?;
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fmu").join(name);
        fs::create_dir_all(folder.join("sources")).expect("a folder of the tests");
        let archive = folder.join("model.fmu");
        let out = ["--out", archive.to_str().expect("a path in UTF-8"), "--no-binary", "--prefix", name];
        run_linkwork(&[&["export", "fmu"], arguments, &out].concat())
            .unwrap_or_else(|error| panic!("{error}"));
        let files = unpack_archive(&fs::read(&archive).expect("the archive is written"));
        for (path, bytes) in &files {
            fs::write(folder.join(path), bytes).expect("a file of the tests");
        }
        let (_, description) = files.iter().find(|(path, _)| path == "modelDescription.xml")?;
        let program = folder.join("importer");
        let importer = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fmu").join(importer);
        let output = Command::new(compiler)
            .current_dir(folder.join("sources"))
            .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O1", "-I."])
            .args(more)
            .arg("-o")
            .arg(&program)
            .arg(importer)
            .args([&format!("{name}.c"), "lw_fmi3.c", "-lm"])
            .output()
            .expect("the compiler starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(Fmu { description: String::from_utf8_lossy(description).into_owned(), program })
    }

    /// Runs the compiled importer, and returns the lines that it prints.
    fn output_lines_of_importer(&self, kind: &str, numbers: [f64; 3]) -> Vec<String> {
        let numbers = numbers.map(|x| x.to_string());
        let [a, b, c] = numbers.each_ref().map(String::as_str);
        self.output_lines_of_program(&[kind, self.read_instantiation_token(), a, b, c])
    }

    /// Runs the compiled importer that calls functions at random, and returns the lines that it prints.
    fn random_call_output_lines(&self, variables: usize, rounds: usize) -> Vec<String> {
        self.output_lines_of_program(&[
            self.read_instantiation_token(),
            &variables.to_string(),
            &rounds.to_string(),
        ])
    }

    /// Returns the instantiation token of the model.
    fn read_instantiation_token(&self) -> &str {
        let (_, rest) = self.description.split_once("instantiationToken=\"").expect("a token");
        rest.split('"').next().unwrap_or_default()
    }

    fn output_lines_of_program(&self, arguments: &[&str]) -> Vec<String> {
        let output = Command::new(&self.program).args(arguments).output().expect("the program starts");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
        text.lines().map(ToString::to_string).collect()
    }

    /// Runs the importer program and returns the rows of numbers that it prints.
    fn importer_rows(&self, kind: &str, numbers: [f64; 3]) -> Vec<Vec<f64>> {
        let parse_number = |word: &str| word.parse().unwrap_or_else(|_| panic!("expected a number: {word}"));
        let parse_numbers_of_line = |line: &String| line.split_whitespace().map(parse_number).collect();
        self.output_lines_of_importer(kind, numbers).iter().map(parse_numbers_of_line).collect()
    }
}

/// Returns the states of a motion of `linkwork simulate`, without the columns of inputs.
fn states_from_simulate_command(arguments: &[&str], stop: f64, samples: usize) -> Vec<Vec<f64>> {
    let (duration, every) = (stop.to_string(), (stop / samples as f64).to_string());
    let options =
        ["--duration", &duration, "--every", &every, "--tolerance", "1e-11", "--method", "dormand-prince"];
    let text = run_linkwork(&[&["simulate"], arguments, &options].concat())
        .unwrap_or_else(|error| panic!("{error}"));
    let mut lines = text.lines();
    let head = lines.next().expect("a line of names");
    let count = head.split(',').filter(|name| !name.starts_with("u.")).count();
    lines.map(|line| line.split(',').take(count).map(|x| x.parse().expect("a number")).collect()).collect()
}

/// Compares the states of two motions row by row.
fn compare_states(name: &str, found: &[Vec<f64>], expected: &[Vec<f64>], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{name}");
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.len(), expected.len(), "{name}");
        for (x, y) in found.iter().zip(expected) {
            assert!((x - y).abs() <= tolerance * (1.0 + y.abs()), "{name}: {x} and {y} at {}", expected[0]);
        }
    }
}

/// Simulates a mechanism in both modes, and compares the motions with that of the library.
fn check_both_fmi_modes(name: &str, arguments: &[&str], stop: f64, steps: f64) -> Option<Fmu> {
    let fmu = Fmu::new(name, arguments)?;
    let expected = states_from_simulate_command(arguments, stop, 10);
    compare_states(name, &fmu.importer_rows("co-simulation", [stop, 10.0, 0.0]), &expected, 1e-8);
    compare_states(name, &fmu.importer_rows("exchange", [stop, 10.0, steps]), &expected, 1e-6);
    Some(fmu)
}

/// Values of the four-bar linkage.
const FOUR_BAR: &[&str] =
    &["g=9.81", "density=1", "a=0.3", "b=1", "c=0.8", "d=0.9", "q.input=1", "v.input=2", "u.motor=0.3"];

/// Values of the heavy top.
const TOP: &[&str] =
    &["g=9.81", "mass=1", "height=0.2", "axial=0.02", "transverse=0.03", "q.tip.qx=0.2", "v.tip.wz=20"];

/// Joins names and values to options of the command.
fn set_option_arguments(values: &'static [&'static str]) -> Vec<&'static str> {
    values.iter().flat_map(|value| ["--set", value]).collect()
}

#[test]
fn cart_pole_fmu_agrees_with_rust_including_derivatives() {
    let values = [
        "cart_mass=1",
        "pole_mass=0.1",
        "pole_length=1",
        "rail_damping=0.1",
        "q.hinge=0.3",
        "v.rail=0.2",
        "u.push=0.5",
    ];
    let values: Vec<&str> = values.iter().flat_map(|value| ["--set", value]).collect();
    let arguments = [&["../../models/src/cart_pole.rs"], &values[..]].concat();
    let Some(fmu) = check_both_fmi_modes("cart_pole", &arguments, 2.0, 100.0) else { return };
    // Rates of four states and two energies, by four states, one input and four parameters.
    derivatives::check_derivatives(&fmu, [1.0, 4.0, 2.0], 6 * 9);
    let begin = r#"name="v.hinge" valueReference="4" causality="output" variability="continuous""#;
    let variable = format!(r#"{begin} initial="exact" start="0.0" unit="rad/s""#);
    assert!(fmu.description.contains(&variable), "{}", fmu.description);
    assert!(fmu.description.contains("<Unit name=\"rad/s\"><BaseUnit s=\"-1\" rad=\"1\"/></Unit>"));
    let restored = fmu.output_lines_of_importer("states", [0.0; 3]);
    assert_eq!((&restored[0], &restored[0]), (&restored[1], &restored[2]), "after restoring the state");
    assert_eq!(restored[3..], ["3 fmi3DeserializeFMUState: the bytes are no state of this model", "3"]);
}

#[test]
fn arm_and_top_fmus_agree_with_rust() {
    check_both_fmi_modes("ur5", &["../../models/urdf/ur5.urdf", "--set", "q.elbow_joint=0.4"], 0.5, 200.0);
    let values = set_option_arguments(TOP);
    let top =
        check_both_fmi_modes("top", &[&["../../models/src/heavy_top.rs"], &values[..]].concat(), 1.0, 400.0);
    // A ball joint: four entries of a quaternion, three velocities, five parameters, two energies.
    top.iter().for_each(|fmu| derivatives::check_derivatives(fmu, [0.0, 5.0, 2.0], 9 * 12));
}

/// The boat of the guide has a state of first order; a table has its values in the sources.
#[test]
fn fmu_sources_contain_first_order_states_and_tables() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fmu").join("drag.csv");
    fs::create_dir_all(folder.parent().expect("a folder")).expect("a folder of the tests");
    // Linear: 2 N s/m.
    fs::write(&folder, "-5,-10\n0,0\n5,10\n").expect("a file of the tests");
    let table = format!("drag={},extrapolated", folder.display());
    let values = set_option_arguments(&["mass=4", "lag=0.5", "x.thrust=1", "u.throttle=3"]);
    let arguments =
        [&["tests/fmu/mechanisms.rs", "--struct", "Boat", "--table", &table], &values[..]].concat();
    let Some(fmu) = check_both_fmi_modes("boat", &arguments, 1.0, 50.0) else { return };
    derivatives::check_derivatives(&fmu, [1.0, 2.0, 3.0], 6 * 6);
    // m v' = f - 2 v and f' = (3 - f) / lag, whose rates -1/2 and -2 differ.
    let last = fmu.importer_rows("co-simulation", [1.0, 10.0, 0.0]).pop().expect("rows");
    let speed = 1.5 + (1.0 / 3.0) * (-2.0_f64).exp() - (1.5 + 1.0 / 3.0) * (-0.5_f64).exp();
    assert!(
        (last[2] - speed).abs() < 1e-8 && (last[3] - (3.0 - 2.0 * (-2.0_f64).exp())).abs() < 1e-8,
        "{last:?}"
    );
}

#[test]
fn four_bar_fmu_keeps_its_loop_closed() {
    let values = set_option_arguments(FOUR_BAR);
    check_both_fmi_modes("four_bar", &[&["../../models/src/four_bar.rs"], &values[..]].concat(), 1.0, 100.0);
}

/// A ball that falls from 1 m bounces with 0.7 of its speed, and comes to rest.
#[test]
fn ball_fmu_bounces_by_its_closed_form() {
    let values = set_option_arguments(&["bounce=0.7", "q.height=1.1"]);
    let arguments = [&["tests/fmu/mechanisms.rs", "--struct", "BouncingBall"], &values[..]].concat();
    let Some(fmu) = Fmu::new("ball", &arguments) else { return };
    let height_of_bouncing_ball = |t: f64| {
        let g = 9.81;
        let mut speed = (2.0 * g * 1.0_f64).sqrt();
        let mut at = speed / g;
        if t < at {
            return 1.1 - g * t * t / 2.0;
        }
        while speed > 1e-6 {
            speed *= 0.7;
            if t < at + 2.0 * speed / g {
                return 0.1 + speed * (t - at) - g * (t - at) * (t - at) / 2.0;
            }
            at += 2.0 * speed / g;
        }
        0.1
    };
    for (kind, steps) in [("co-simulation", 0.0), ("exchange", 10.0)] {
        let rows = fmu.importer_rows(kind, [4.0, 40.0, steps]);
        assert_eq!(rows.len(), 41);
        for row in &rows {
            assert!(
                (row[1] - height_of_bouncing_ball(row[0])).abs() < 1e-8,
                "{kind}: {row:?}, not {}",
                height_of_bouncing_ball(row[0])
            );
        }
        assert!(rows[40][2].abs() < 1e-12, "{kind}: at rest");
    }
}

/// Checks a door that rests against its stop until the force `-cos(2 t)` opens it at π/4, and equal balls
/// that exchange their velocities.
#[test]
fn stop_and_ball_contacts_of_fmus_have_closed_forms() {
    let values = set_option_arguments(&["strength=1", "q.rail=-1", "v.rail=0.7"]);
    let arguments = [&["tests/fmu/mechanisms.rs", "--struct", "Door"], &values[..]].concat();
    let Some(fmu) = Fmu::new("door", &arguments) else { return };
    let start = std::f64::consts::FRAC_PI_4;
    for (kind, steps) in [("co-simulation", 0.0), ("exchange", 50.0)] {
        for row in fmu.importer_rows(kind, [2.0, 10.0, steps]) {
            let t = row[0];
            let opened = if t > start { (t - start) / 2.0 + (2.0 * t).cos() / 4.0 } else { 0.0 };
            // The surfaces meet after 0.8 m.
            let [left, right] = [0.0_f64.min(0.7 * t - 0.8) - 0.2, 0.0_f64.max(0.7 * t - 0.8)];
            let expected = [t, opened, left, right];
            for (x, y) in row.iter().zip(expected) {
                assert!((x - y).abs() < 1e-8, "{kind}: {row:?}, not {expected:?}");
            }
        }
    }
}

/// Checks that names that C cannot have are those of the declaration in the description.
#[test]
fn names_need_not_be_identifiers_of_c() {
    let values =
        set_option_arguments(&["double=1", "int=2", "θ=0.5", "struct=1", "q=0.5", "m=0", "q.register=0.3"]);
    let arguments = [&["tests/fmu/mechanisms.rs", "--struct", "Kernel"], &values[..]].concat();
    let Some(fmu) = check_both_fmi_modes("kernel", &arguments, 0.5, 100.0) else { return };
    for name in ["double", "θ", "struct", "q.register", "der(v.register)", "u.switch", "main"] {
        assert!(fmu.description.contains(&format!("name=\"{name}\"")), "{name}");
    }
}

#[test]
fn export_rejects_mechanisms_without_fmu_support() {
    let file = "tests/fmu/mechanisms.rs";
    for (arguments, message) in [
        (
            vec![file, "--struct", "Crate"],
            "the contact `floor.0` has friction: the sources of FMUs have contacts without friction",
        ),
        (vec![file, "--struct", "Stack", "--set", "bounce=0.5"], "has restitution by Poisson's law"),
        (vec![file, "--struct", "Crate"], "`--library FILE` puts the run-time library into the FMU"),
        (vec![file, "--struct", "Crate", "--library", "no-such-file"], "cannot read no-such-file"),
        (vec![file, "--struct", "Skeleton"], "`Skeleton` cannot be an FMU: it has no masses"),
        (vec![file, "--struct", "BouncingBall"], "parameters without a value: --set bounce=…"),
        (
            vec![file, "--struct", "BouncingBall", "--set", "bounce=1", "--prefix", "2 balls"],
            "`--prefix 2 balls` is not a free identifier of FMI; use `--prefix x2_balls`",
        ),
        (
            vec![file, "--struct", "BouncingBall", "--set", "bounce=1", "--compiler", "no-such-compiler"],
            "cannot run the compiler `no-such-compiler`",
        ),
    ] {
        let error = run_linkwork(&[&["export", "fmu"], &arguments[..]].concat()).expect_err("it is rejected");
        assert!(error.contains(message), "{error}");
    }
}
