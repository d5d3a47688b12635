//! Constrained mechanisms: time of one evaluation of the accelerations and multipliers, and of a thousand
//! steps of `Rk4`, each projected onto the constraints.
//!
//! `RUSTFLAGS="-C target-cpu=native" cargo run --release -p linkwork-benches --bin constraints` measures only
//! Linkwork; `benches/peers/run constraints` installs other libraries and compares them. The program's own
//! commands are `constraints write FOLDER` and `constraints measure FOLDER [--quick]`.

mod mechanisms;
mod table;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        [] => table::measure_mechanisms(None, false),
        ["write", folder] => {
            table::write_mechanism_files(Path::new(folder)).map_err(|error| error.to_string())
        }
        ["measure", folder] => table::measure_mechanisms(Some(Path::new(folder)), false),
        ["measure", folder, "--quick"] => table::measure_mechanisms(Some(Path::new(folder)), true),
        _ => Err("expected nothing, `write FOLDER` or `measure FOLDER [--quick]`".to_string()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("constraints: {message}");
            ExitCode::FAILURE
        }
    }
}
