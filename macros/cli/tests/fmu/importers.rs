//! Importers of others: FMPy, and `fmi-sim`, which is written in Rust. Both read the descriptions and
//! simulate six mechanisms in both modes.

use super::{TOP, find_c_compiler, run_linkwork, set_option_arguments, states_from_simulate_command};
use linkwork::Table;
use linkwork_models::Fighter;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Mechanism with the arguments of the command.
struct FmuExportCase {
    name: &'static str,
    arguments: Vec<String>,
    /// Bound for the errors of Euler's method with steps of 10⁻⁴ s after half a second.
    euler: f64,
}

impl FmuExportCase {
    fn new(name: &'static str, file: &[&str], values: &'static [&'static str], euler: f64) -> FmuExportCase {
        let arguments =
            file.iter().copied().chain(set_option_arguments(values)).map(ToString::to_string).collect();
        FmuExportCase { name, arguments, euler }
    }

    fn arguments(&self) -> Vec<&str> {
        self.arguments.iter().map(String::as_str).collect()
    }

    /// Exports the mechanism and returns the path of the FMU.
    fn export_fmu_of_case(&self, folder: &Path) -> String {
        let path = folder.join(format!("{}.fmu", self.name)).to_str().expect("a path in UTF-8").to_string();
        let arguments = [&["export", "fmu", "--out", &path], &self.arguments()[..]].concat();
        run_linkwork(&arguments).unwrap_or_else(|error| panic!("{error}"));
        path
    }
}

/// Returns a table as lines of its grid points and values.
fn table_lines<const N: usize>(table: &Table<N>) -> String {
    let mut points = vec![String::new()];
    for axis in table.axes() {
        let extended =
            |point: &String| axis.iter().map(move |x| format!("{point}{x:?},")).collect::<Vec<_>>();
        points = points.iter().flat_map(extended).collect();
    }
    points.iter().zip(table.values()).map(|(point, value)| format!("{point}{value:?}\n")).collect()
}

/// Returns the F-16 near level flight, with its tables in files.
fn fighter_case(folder: &Path) -> FmuExportCase {
    let f = Fighter::F16;
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/src/fighter.rs");
    let flight = ["q.flight.z=-3000", "v.flight.vx=150", "v.flight.vz=5", "x.power=20", "u.throttle=0.3"];
    let mut case = FmuExportCase { name: "fighter", arguments: vec![file.to_string()], euler: 1e-2 };
    let mut add_set_option = |value: String| case.arguments.extend(["--set".to_string(), value]);
    flight.into_iter().for_each(|value| add_set_option(value.to_string()));
    let numbers = [
        ("g", f.g),
        ("mass", f.mass),
        ("ixx", f.ixx),
        ("iyy", f.iyy),
        ("izz", f.izz),
        ("product", f.product),
        ("spin", f.spin),
        ("area", f.area),
        ("span", f.span),
        ("chord", f.chord),
        ("place", f.place),
        ("reference", f.reference),
        ("sea_density", f.sea_density),
        ("sea_sound", f.sea_sound),
        ("depth", f.depth),
        ("second", f.second),
    ];
    numbers.iter().for_each(|(name, value)| add_set_option(format!("{name}={value:?}")));
    let ones = [
        ("cz", &f.cz),
        ("cx_q", &f.cx_q),
        ("cy_r", &f.cy_r),
        ("cy_p", &f.cy_p),
        ("cz_q", &f.cz_q),
        ("cl_r", &f.cl_r),
        ("cl_p", &f.cl_p),
        ("cm_q", &f.cm_q),
        ("cn_r", &f.cn_r),
        ("cn_p", &f.cn_p),
    ]
    .map(|(name, table)| (name, table_lines(table), table.is_extrapolated()));
    let twos = [
        ("cx", &f.cx),
        ("cl", &f.cl),
        ("cm", &f.cm),
        ("cn", &f.cn),
        ("cl_aileron", &f.cl_aileron),
        ("cl_rudder", &f.cl_rudder),
        ("cn_aileron", &f.cn_aileron),
        ("cn_rudder", &f.cn_rudder),
    ]
    .map(|(name, table)| (name, table_lines(table), table.is_extrapolated()));
    let three = [("thrust", table_lines(&f.thrust), f.thrust.is_extrapolated())];
    for (name, lines, is_extrapolated) in ones.into_iter().chain(twos).chain(three) {
        let path = folder.join(format!("{name}.csv"));
        fs::write(&path, lines).expect("a file of the tests");
        let end = if is_extrapolated { ",extrapolated" } else { "" };
        case.arguments.extend(["--table".to_string(), format!("{name}={}{end}", path.display())]);
    }
    case
}

/// Returns the six mechanisms; the files of tables are written to a folder.
fn fmu_importer_cases(folder: &Path) -> Vec<FmuExportCase> {
    fs::create_dir_all(folder).expect("a folder of the tests");
    vec![
        FmuExportCase::new(
            "cart_pole",
            &["../../models/src/cart_pole.rs"],
            &["cart_mass=1", "pole_mass=0.1", "pole_length=1", "rail_damping=0.1", "q.hinge=0.3"],
            1e-3,
        ),
        FmuExportCase::new(
            "four_bar",
            &["../../models/src/four_bar.rs"],
            &["g=9.81", "density=1", "a=0.3", "b=1", "c=0.8", "d=0.9", "q.input=1"],
            1e-2,
        ),
        FmuExportCase::new(
            "ball",
            &["tests/fmu/mechanisms.rs", "--struct", "BouncingBall"],
            &["bounce=0.7", "q.height=1.1"],
            1e-2,
        ),
        FmuExportCase::new("ur5", &["../../models/urdf/ur5.urdf"], &[], 1e-2),
        fighter_case(folder),
        FmuExportCase::new("top", &["../../models/src/heavy_top.rs"], TOP, 5e-2),
    ]
}

/// Returns the folder of a test.
fn test_folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("fmu").join(name)
}

/// FMPy validates FMUs with binaries, and simulates them in both modes. `LINKWORK_PYTHON` names a Python that
/// has it.
#[test]
fn fmpy_validates_and_simulates() {
    let python = std::env::var("LINKWORK_PYTHON").unwrap_or_else(|_| "python3".to_string());
    let has = Command::new(&python).args(["-c", "import fmpy"]).output().is_ok_and(|o| o.status.success());
    if !has || find_c_compiler().is_none() {
        println!("skipped: there is no FMPy (LINKWORK_PYTHON names a Python that has it)");
        return;
    }
    let folder = test_folder("fmpy");
    let paths: Vec<String> =
        fmu_importer_cases(&folder).iter().map(|case| case.export_fmu_of_case(&folder)).collect();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fmu/fmpy_check.py");
    let output = Command::new(&python).arg(script).args(&paths).output().expect("Python starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}{error}", String::from_utf8_lossy(&output.stdout));
}

/// Returns the checksum of an archive's file (CRC-32 of ISO 3309).
fn archive_crc32(bytes: &[u8]) -> u32 {
    let crc_bit_step = |sum: u32| (sum >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(sum & 1));
    let crc_with_byte = |sum: u32, byte: &u8| (0..8).fold(sum ^ u32::from(*byte), |sum, _| crc_bit_step(sum));
    !bytes.iter().fold(!0, crc_with_byte)
}

/// Replaces the units of variables by blanks in the description, the first file of an archive. The standard
/// has them, but the reader of fmi-sim 0.7 rejects the attribute.
fn blank_units(path: &str) {
    let mut archive = fs::read(path).expect("an archive");
    let little_endian_number_at = |at: usize, count: usize| {
        archive[at..at + count].iter().rev().fold(0, |n, b| n << 8 | usize::from(*b))
    };
    let (size, start) = (little_endian_number_at(18, 4), 30 + little_endian_number_at(26, 2));
    let text = String::from_utf8(archive[start..start + size].to_vec()).expect("a text");
    let mut blank = String::new();
    let mut rest = text.as_str();
    while let Some(at) = rest.find(" unit=\"") {
        let end = at + 7 + rest[at + 7..].find('"').expect("the end of the attribute") + 1;
        blank += &rest[..at];
        blank += &" ".repeat(end - at);
        rest = &rest[end..];
    }
    blank += rest;
    let sum = archive_crc32(blank.as_bytes()).to_le_bytes();
    archive[start..start + size].copy_from_slice(blank.as_bytes());
    archive[14..18].copy_from_slice(&sum);
    let directory = archive.windows(4).position(|bytes| bytes == b"PK\x01\x02").expect("a directory");
    archive[directory + 16..directory + 20].copy_from_slice(&sum);
    fs::write(path, archive).expect("a file of the tests");
}

/// Simulates an FMU by `fmi-sim` for half a second with steps of `interval`, and returns time and the `count`
/// states at the end.
fn fmi_sim_states(program: &str, path: &str, [mode, interval]: [&str; 2], count: usize) -> Vec<f64> {
    let out = format!("{path}.csv");
    let output = Command::new(program)
        .args(["--model", path, "--output-file", &out, mode, "-f", "0.5", "--tolerance", "1e-10"])
        .args(["--output-interval", interval])
        .output()
        .expect("fmi-sim starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{path}: {}{error}", String::from_utf8_lossy(&output.stdout));
    let text = fs::read_to_string(&out).expect("fmi-sim writes a file");
    let last = text.lines().last().expect("a line");
    last.split(',').take(1 + count).map(|x| x.parse().expect("a number")).collect()
}

/// `fmi-sim` (`cargo install fmi-sim`) reads the descriptions and simulates in both modes: with communication
/// steps of 10 ms, and in model exchange by Euler's method. `LINKWORK_FMI_SIM` names the program.
#[test]
fn fmi_sim_simulates() {
    let program = std::env::var("LINKWORK_FMI_SIM").unwrap_or_else(|_| "fmi-sim".to_string());
    let has = Command::new(&program).arg("--version").output().is_ok();
    if !has || find_c_compiler().is_none() {
        println!("skipped: there is no fmi-sim (cargo install fmi-sim, or LINKWORK_FMI_SIM names it)");
        return;
    }
    let folder = test_folder("fmi_sim");
    for case in fmu_importer_cases(&folder) {
        let path = case.export_fmu_of_case(&folder);
        blank_units(&path);
        let expected = match case.name {
            // After 0.45 s the ball falls from 1 m to the floor, and leaves it with 0.7 of its speed.
            "ball" => {
                let (g, speed) = (9.81_f64, (2.0 * 9.81_f64).sqrt());
                let (left, start) = (0.5 - speed / g, 0.7 * speed);
                vec![0.5, 0.1 + start * left - g * left * left / 2.0, start - g * left]
            }
            _ => states_from_simulate_command(&case.arguments(), 0.5, 1).pop().expect("rows"),
        };
        for (mode, bound) in [(["co-simulation", "0.01"], 1e-6), (["model-exchange", "0.0001"], case.euler)] {
            let found = fmi_sim_states(&program, &path, mode, expected.len() - 1);
            for (x, y) in found.iter().zip(&expected) {
                let difference = (x - y).abs() / (1.0 + y.abs());
                assert!(difference < bound, "{} {mode:?}: {found:?}, not {expected:?}", case.name);
            }
        }
    }
}
