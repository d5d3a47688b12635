//! Definition of the command line.

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use std::path::PathBuf;

/// Returns the definition of `linkwork` with its subcommands.
pub fn linkwork_command() -> Command {
    Command::new("linkwork")
        .version(env!("CARGO_PKG_VERSION"))
        .about("Checks, shows, simulates, draws and exports mechanisms")
        .after_help("Exit status: 0 success, 1 the file has errors, 2 the command failed.")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(
            add_input_file_arguments(
                Command::new("check").about("Lists every error with its position")).arg(json_switch(),
            ),
        )
        .subcommand(
            add_input_file_arguments(
                Command::new("show")
                    .about("Prints coordinates, units, structure, equations and operation counts"),
            )
            .arg(json_switch()),
        )
        .subcommand(
            add_motion_options(add_input_file_arguments(Command::new("simulate").about(
                "Simulates a motion and prints it as comma-separated values: t, q.…, v.…, u.… (with `--out \
                 NAME.mcap` as a log for robotics tools)",
            )))
            .arg(out_file_argument()),
        )
        .subcommand(view_command())
        .subcommand(
            Command::new("gallery")
                .about("Writes pages that simulate several mechanisms, and an index of them")
                .arg(
                    Arg::new("list")
                        .value_name("LIST")
                        .help("A file whose lines have a file and options of `linkwork view --live`; `#` begins a comment")
                        .required(true)
                        .value_parser(value_parser!(PathBuf)),
                )
                .arg(
                    text_argument("out", "FOLDER", "Output folder of the pages [default: gallery]")
                        .short('o')
                        .value_parser(value_parser!(PathBuf)),
                ),
        )
        .subcommand(
            add_input_file_arguments(
                Command::new("convert").about("Converts a robot file to a Rust struct"),
            )
            .arg(out_file_argument()),
        )
        .subcommand(
            Command::new("new")
                .about("Creates a project with a mechanism, a controller and a page")
                .arg(
                    Arg::new("folder")
                        .value_name("FOLDER")
                        .help("Folder of the project; its last part is the package's name")
                        .required(true)
                        .value_parser(value_parser!(PathBuf)),
                )
                .arg(
                    text_argument(
                        "linkwork",
                        "FOLDER",
                        "Sources of Linkwork for the build [default: those of this command, or its release]",
                    )
                    .value_parser(value_parser!(PathBuf)),
                ),
        )
        .subcommand(
            Command::new("completions")
                .about("Prints a completion script for a shell")
                .arg(Arg::new("shell").required(true).value_parser(value_parser!(clap_complete::Shell))),
        )
        .subcommand(export_command())
}

/// Returns the definition of the subcommand `linkwork view`.
pub fn view_command() -> Command {
    add_motion_options(add_input_file_arguments(
        Command::new("view").about("Writes a page of HTML that shows a motion and opens offline"),
    ))
    .arg(
        text_argument(
            "motion",
            "FILE",
            "Motion to show, instead of simulating one: comma-separated values with the columns t and q.…",
        )
        .value_parser(value_parser!(PathBuf))
        .conflicts_with_all([
            "duration",
            "every",
            "guess",
            "inputs",
            "method",
            "step",
            "tolerance",
            "without-contacts",
        ]),
    )
    .arg(
        text_argument("meshes", "FOLDER", "Folder of the meshes of a robot file [default: next to it]")
            .value_parser(value_parser!(PathBuf)),
    )
    .arg(
        switch_argument(
            "live",
            "Writes a page that simulates the mechanism, with sliders for parameters, state and inputs",
        )
        .conflicts_with_all(["motion", "duration", "every", "inputs", "method", "step", "tolerance"]),
    )
    .arg(switch_argument(
        "fragment",
        "Writes a part of a page, for the documentation of a crate and other documents",
    ))
    .arg(
        text_argument("out", "FILE", "Output file [default: the mechanism's name with .html]")
            .short('o')
            .value_parser(value_parser!(PathBuf)),
    )
}

fn export_command() -> Command {
    Command::new("export")
        .about("Writes a mechanism's functions")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(c_export_command())
        .subcommand(kernel_export_command(
            "cuda",
            "CUDA: kernels of all functions for many states, and their launchers",
        ))
        .subcommand(kernel_export_command("wgsl", "WGSL: compute shaders of the functions for many states"))
        .subcommand(fmu_export_command())
        .subcommand(library_export_command())
        .subcommand(
            add_input_file_arguments(Command::new("rust").about("The generated Rust code, for reading"))
                .arg(out_file_argument()),
        )
}

fn c_export_command() -> Command {
    let command = Command::new("c").about("C99: a source file and a header that need only libm");
    add_code_export_options(command, "Output folder of the two files")
        .arg(switch_argument(
            "casadi",
            "Writes a third file: the functions in the form that CasADi and acados call",
        ))
        .arg(
            text_argument("set", "NAME=VALUE", "Fixes a parameter in the functions for CasADi and acados")
                .action(ArgAction::Append)
                .requires("casadi"),
        )
}

fn kernel_export_command(name: &'static str, about: &'static str) -> Command {
    add_code_export_options(Command::new(name).about(about), "Output folder of the files")
}

/// Adds the options that all exports of source code share.
fn add_code_export_options(command: Command, folder: &'static str) -> Command {
    add_input_file_arguments(command)
        .arg(
            text_argument("out", "FOLDER", folder)
                .short('o')
                .default_value(".")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(text_argument("prefix", "NAME", "Prefix of names and files [default: the mechanism's name]"))
        .arg(
            text_argument("scalar", "TYPE", "Type of numbers [default: that of the struct]")
                .value_parser(["double", "float"]),
        )
        .arg(switch_argument("no-derivatives", "Leaves out the derivatives of the dynamics"))
}

fn fmu_export_command() -> Command {
    let command =
        Command::new("fmu").about("FMI 3.0: a model for simulation tools, with sources and a binary");
    add_start_options(add_table_options(add_input_file_arguments(command)))
        .arg(
            text_argument("out", "FILE", "Output file [default: the mechanism's name with .fmu]")
                .short('o')
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(text_argument("prefix", "NAME", "Identifier of the model [default: the mechanism's name]"))
        .arg(switch_argument("no-derivatives", "Leaves out directional and adjoint derivatives"))
        .arg(switch_argument("no-binary", "Writes sources only"))
        .arg(
            text_argument(
                "library",
                "FILE",
                "Run-time library for the binary, liblinkwork_c: an FMU for co-simulation with all contacts",
            )
            .value_parser(value_parser!(PathBuf))
            .conflicts_with_all(["no-binary", "no-derivatives"]),
        )
        .arg(
            text_argument("compiler", "NAME", "C compiler of the binary [default: cc]")
                .conflicts_with("no-binary"),
        )
}

fn library_export_command() -> Command {
    add_table_options(add_input_file_arguments(
        Command::new("library")
            .about("A crate and a header: all functions on plain arrays, as a shared and a static library"),
    ))
    .arg(
        text_argument("out", "FOLDER", "Output folder of the crate [default: the prefix]")
            .short('o')
            .value_parser(value_parser!(PathBuf)),
    )
    .arg(text_argument("prefix", "NAME", "Prefix of names [default: the mechanism's name]"))
    .arg(text_argument(
        "linkwork",
        "FOLDER",
        "Sources of Linkwork for the build [default: those of this command, or its release]",
    ))
    .arg(switch_argument(
        "expanded",
        "Writes the generated code instead of the attribute, for builds without the compiler",
    ))
}

fn add_input_file_arguments(command: Command) -> Command {
    command
        .arg(
            Arg::new("file")
                .value_name("FILE")
                .help(
                    "A robot file (URDF, MJCF or SDF), or a Rust file with structs that have `#[mechanism]`",
                )
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(text_argument("struct", "NAME", "Name of the struct, for Rust files with several"))
        .arg(text_argument(
            "with",
            "OPTIONS",
            "Further arguments of the attribute, as in `base = free, inertia = trust`",
        ))
}

fn add_table_options(command: Command) -> Command {
    command.arg(
        text_argument(
            "table",
            "NAME=FILE",
            "Values of a table: a line for each grid point with its variables, then its value, separated by \
             commas. `,smooth` after FILE interpolates by splines, `,extrapolated` continues the table \
             beyond its grid",
        )
        .action(ArgAction::Append),
    )
}

/// Adds the options for parameters and the initial state to a subcommand.
fn add_start_options(command: Command) -> Command {
    command
        .arg(
            text_argument(
                "set",
                "NAME=VALUE",
                "Value of a parameter, of an initial coordinate q.NAME or velocity v.NAME, or of an input \
                 u.NAME",
            )
            .action(ArgAction::Append),
        )
        .arg(
            text_argument(
                "guess",
                "q.NAME=VALUE",
                "Guess of an initial coordinate that constraints determine; selects the assembly mode of a \
                 loop",
            )
            .action(ArgAction::Append),
        )
}

fn add_motion_options(command: Command) -> Command {
    let command = add_start_options(add_table_options(command));
    let number_argument = |name, value, help| {
        text_argument(name, value, help).value_parser(value_parser!(f64)).allow_negative_numbers(true)
    };
    command
        .arg(
            text_argument(
                "inputs",
                "FILE",
                "Inputs over time: comma-separated values with the columns t and u.…",
            )
            .value_parser(value_parser!(PathBuf)),
        )
        .arg(number_argument("duration", "SECONDS", "Duration of the motion [default: 10]"))
        .arg(number_argument("every", "SECONDS", "Time between samples [default: 1/60]"))
        .arg(number_argument("tolerance", "NUMBER", "Relative and absolute error of a step [default: 1e-8]"))
        .arg(
            text_argument(
                "method",
                "NAME",
                "Method of integration [default: automatic: Dormand–Prince, from where it is stiff RODAS, \
                 with contacts time stepping]",
            )
            .value_parser(integration_method_parser()),
        )
        .arg(number_argument("step", "SECONDS", "Step of methods with fixed steps [default: 1e-3]"))
        .arg(switch_argument("without-contacts", "Ignores contacts: bodies pass through each other"))
}

/// Parser of the option for the integration method, with the names of the methods.
fn integration_method_parser() -> PossibleValuesParser {
    let names = linkwork_jit::Method::NAMES.iter();
    PossibleValuesParser::new(names.map(|(name, ..)| -> &'static str { name.replace('_', "-").leak() }))
}

fn text_argument(name: &'static str, value: &'static str, help: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(value).help(help)
}

fn switch_argument(name: &'static str, help: &'static str) -> Arg {
    Arg::new(name).long(name).help(help).action(ArgAction::SetTrue)
}

fn json_switch() -> Arg {
    switch_argument("json", "Prints JSON for other programs")
}

fn out_file_argument() -> Arg {
    text_argument("out", "FILE", "Output file [default: standard output]")
        .short('o')
        .value_parser(value_parser!(PathBuf))
}

/// Returns the value of an option that is a text, if the option is present.
pub fn text_option_value<'a>(matches: &'a ArgMatches, name: &str) -> Option<&'a str> {
    matches.get_one::<String>(name).map(String::as_str)
}
