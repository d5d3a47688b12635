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
    /// The mechanism has errors, which have been printed.
    Mistakes,
    /// A syntax error of a file, with its location.
    Syntax(Box<input::Mistake>),
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
    ($($text:tt)*) => { $crate::print(format_args!("{}\n", format_args!($($text)*))) };
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
fn print(text: std::fmt::Arguments<'_>) {
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
    let matches = commands::command().get_matches();
    let done = match matches.subcommand() {
        Some(("check", given)) => check::run(given),
        Some(("show", given)) => show::run(given),
        Some(("simulate", given)) => simulate::run(given),
        Some(("view", given)) => view::run(given),
        Some(("gallery", given)) => gallery::run(given),
        Some(("convert", given)) => convert::run(given),
        Some(("new", given)) => new::run(given),
        Some(("completions", given)) => completions(given),
        Some(("export", given)) => match given.subcommand() {
            Some(("c", given)) => export::c99(given),
            Some(("cuda", given)) => export::cuda(given),
            Some(("wgsl", given)) => export::wgsl(given),
            Some(("fmu", given)) => fmu::run(given),
            Some(("library", given)) => export::library(given),
            Some(("rust", given)) => export::rust(given),
            _ => Err(Stop::Failure("expected `c`, `cuda`, `wgsl`, `fmu`, `library` or `rust`".to_string())),
        },
        _ => Err(Stop::Failure("expected a command".to_string())),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Stop::Mistakes) => ExitCode::from(1),
        Err(Stop::Syntax(mistake)) => {
            note!("{mistake}");
            ExitCode::from(1)
        }
        Err(Stop::Failure(why)) => {
            note!("linkwork: {why}");
            ExitCode::from(2)
        }
    }
}

/// Prints the completion script for a shell.
fn completions(matches: &clap::ArgMatches) -> Result<(), Stop> {
    let shell = matches.get_one::<clap_complete::Shell>("shell").copied();
    let shell = shell.ok_or_else(|| Stop::Failure("expected a shell".to_string()))?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut commands::command(), "linkwork", &mut script);
    print(format_args!("{}", String::from_utf8_lossy(&script)));
    Ok(())
}
