//! Comparison of generated functions with other libraries, in one process, interleaved, on the same states.
//!
//! `benches/peers/run` installs and builds the peers, and calls this program, first to write the robots for
//! them, then to measure. The program's own commands are `peers write FOLDER` and
//! `peers measure FOLDER [--quick]`. A peer that is not in the folder is omitted.

mod robots;
mod table;
mod write;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        ["write", folder] => write::write_robot_folders(Path::new(folder)).map_err(|error| error.to_string()),
        ["measure", folder] => table::measure_robots_and_print_table(Path::new(folder), false),
        ["measure", folder, "--quick"] => table::measure_robots_and_print_table(Path::new(folder), true),
        _ => Err("expected `write FOLDER` or `measure FOLDER [--quick]`".to_string()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("peers: {message}");
            ExitCode::FAILURE
        }
    }
}
