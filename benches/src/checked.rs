//! Costs of compiling generated code with rustc: time and memory.

use std::error::Error;
use std::fs::{read_to_string, write};
use std::path::PathBuf;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::Duration;

/// Time between two readings of rustc's memory while it runs.
const PERIOD: Duration = Duration::from_millis(3);

/// Clock ticks per second in which Linux counts processor time.
const TICKS: f64 = 100.0;

/// Compiled runtime crate, to which generated code is linked.
pub struct CompiledRuntime {
    /// Path of the rlib that rustc links; its dependencies are in the folder `deps` next to it.
    pub rlib: PathBuf,
}

/// Cost of compiling a mechanism with rustc: time and memory.
#[derive(Clone, Copy, Debug, Default)]
pub struct CompilationCost {
    /// Processor time of the compilation.
    pub time: Duration,
    /// Peak resident memory of the compilation, bytes.
    pub memory: f64,
}

impl CompiledRuntime {
    /// Compiles the runtime crate in the dev profile.
    pub fn build_runtime_crate() -> Result<CompiledRuntime, Box<dyn Error>> {
        let cargo = std::env::var_os("CARGO").unwrap_or("cargo".into());
        let build =
            ["build", "--quiet", "--locked", "-p", "linkwork", "--message-format=json-render-diagnostics"];
        let output = Command::new(cargo).args(build).current_dir(env!("CARGO_MANIFEST_DIR")).output()?;
        let messages = String::from_utf8(output.stdout)?;
        let artifact =
            messages.lines().rfind(|line| line.contains("/liblinkwork-") && line.contains(".rlib\""));
        let file = artifact.and_then(|line| line.split('"').find(|word| word.ends_with(".rlib")));
        Ok(CompiledRuntime { rlib: file.ok_or("cargo reported no library")?.into() })
    }
}

/// Runs rustc on a library of this text, with the options of the dev profile, up to its metadata.
pub fn measure_rustc_check(library: &CompiledRuntime, text: &str) -> Result<CompilationCost, Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("linkwork-expansion-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let file = folder.join("expanded.rs");
    write(&file, text)?;
    let dependencies = library.rlib.with_file_name("deps");
    let rustc = std::env::var_os("RUSTC").unwrap_or("rustc".into());
    let mut child = Command::new(rustc)
        .args([
            "--edition=2024",
            "--crate-type=lib",
            "--emit=metadata",
            "-Cdebuginfo=2",
            "-Cdebug-assertions=on",
            "--cap-lints=allow",
        ])
        .arg("--extern")
        .arg(format!("linkwork={}", library.rlib.display()))
        .arg("-L")
        .arg(dependencies)
        .args([&"--out-dir".into(), &folder, &file])
        .spawn()?;
    let cost = wait_for_process(&mut child);
    std::fs::remove_dir_all(&folder)?;
    cost
}

/// Waits for a process, and returns its cost as far as the system reports it.
fn wait_for_process(child: &mut Child) -> Result<CompilationCost, Box<dyn Error>> {
    let mut cost = CompilationCost::default();
    loop {
        cost = time_and_memory_of_process(child.id()).unwrap_or(cost);
        if let Some(status) = child.try_wait()? {
            return if status.success() { Ok(cost) } else { Err("rustc refuses the output".into()) };
        }
        sleep(PERIOD);
    }
}

/// Returns processor time and peak memory of a process so far.
fn time_and_memory_of_process(process: u32) -> Option<CompilationCost> {
    let status = read_to_string(format!("/proc/{process}/status")).ok()?;
    let memory = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = memory.split_whitespace().next()?.parse().ok()?;
    // After the name in parentheses, the 12th and the 13th fields are the ticks in user and in system mode.
    let stat = read_to_string(format!("/proc/{process}/stat")).ok()?;
    let words = stat.rsplit(')').next()?.split_whitespace().skip(11).take(2);
    let ticks: f64 = words.filter_map(|word| word.parse::<f64>().ok()).sum();
    Some(CompilationCost { time: Duration::from_secs_f64(ticks / TICKS), memory: kilobytes * 1e3 })
}
