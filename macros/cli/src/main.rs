#![doc = include_str!("../README.md")]

mod assemble;
mod check;
mod commands;
mod convert;
mod export;
mod fmu;
mod gallery;
mod grid;
mod input;
mod library;
mod live;
mod motion;
mod names;
mod new;
mod show;
mod simulate;
mod sources;
mod syntax;
mod table;
mod view;
mod written;
mod zip;

use std::process::ExitCode;

/// Reason why a subcommand stops early.
enum Stop {
    /// The mechanism has errors, which the command has printed.
    Errors,
    /// Syntax error of a Rust file, with its location.
    Syntax(Box<input::SourceError>),
    /// The command cannot be carried out, for the reason in the text.
    Failure(String),
}

impl<E: std::error::Error> From<E> for Stop {
    fn from(error: E) -> Stop {
        Stop::Failure(error.to_string())
    }
}

/// Prints a line to standard output.
macro_rules! say {
    ($($text:tt)*) => { $crate::print_or_exit(format_args!("{}\n", format_args!($($text)*))) };
}
use say;

/// Prints a line to standard error, and ignores write errors.
macro_rules! note {
    ($($text:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}
use note;

/// Prints a text to standard output. Exits silently if the reader has closed it, as `head` does.
fn print_or_exit(text: std::fmt::Arguments<'_>) {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_fmt(text).and_then(|()| out.flush()) {
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            std::process::exit(0);
        }
        note!("linkwork: cannot write: {error}");
        std::process::exit(2);
    }
}

fn main() -> ExitCode {
    let matches = commands::linkwork_command().get_matches();
    let done = match matches.subcommand() {
        Some(("check", given)) => check::run_check(given),
        Some(("show", given)) => show::run_show(given),
        Some(("simulate", given)) => simulate::run_simulate(given),
        Some(("view", given)) => view::run_view(given),
        Some(("gallery", given)) => gallery::write_gallery(given),
        Some(("convert", given)) => convert::run_convert(given),
        Some(("new", given)) => new::create_package(given),
        Some(("completions", given)) => print_completions(given),
        Some(("export", given)) => match given.subcommand() {
            Some(("c", given)) => export::export_c99_files(given),
            Some(("cuda", given)) => export::export_cuda_files(given),
            Some(("wgsl", given)) => export::export_wgsl_files(given),
            Some(("fmu", given)) => fmu::run_fmu_export(given),
            Some(("library", given)) => export::export_library_crate(given),
            Some(("rust", given)) => export::export_rust_code(given),
            _ => Err(Stop::Failure("expected `c`, `cuda`, `wgsl`, `fmu`, `library` or `rust`".to_string())),
        },
        _ => Err(Stop::Failure("expected a command".to_string())),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Stop::Errors) => ExitCode::from(1),
        Err(Stop::Syntax(error)) => {
            note!("{error}");
            ExitCode::from(1)
        }
        Err(Stop::Failure(why)) => {
            note!("linkwork: {why}");
            ExitCode::from(2)
        }
    }
}

/// Prints the completion script for a shell.
fn print_completions(matches: &clap::ArgMatches) -> Result<(), Stop> {
    let shell = matches.get_one::<clap_complete::Shell>("shell").copied();
    let shell = shell.ok_or_else(|| Stop::Failure("expected a shell".to_string()))?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut commands::linkwork_command(), "linkwork", &mut script);
    print_or_exit(format_args!("{}", String::from_utf8_lossy(&script)));
    Ok(())
}
