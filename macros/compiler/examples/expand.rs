//! Prints the code that the compiler generates for a mechanism, its operation counts or compile times.
//!
//! `cargo run -p linkwork-compiler --example expand -- FILE [options]`
//!
//! `FILE` is a Rust file with a `#[mechanism(…)]` struct (the first, or the one named by `--struct NAME`), or
//! a URDF file. Options: `--rust` (default: the generated code), `--counts` (operations of every function),
//! `--time` (milliseconds of every stage and pass), `--after PASS` with `--function NAME` (the function's
//! programs after a pass, including those of all candidates; `--after all`: after every pass); for a URDF
//! file also `--base free`, `--inertia trust`, `--mimic independent`, `--passive ignore`.
//!
//! `cargo run -p linkwork-compiler --example expand -- --every FILE…` prints the unformatted generated code
//! of every mechanism in the Rust files, then again with all options that are single words.
//! `.ci/compare-output` compares this text.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::{Graph, Symbol};
use linkwork_compiler::lower::{Op, OperationCounts, Program, pipeline};
use linkwork_compiler::mechanism::Quantity;
use linkwork_compiler::passes::PassSelection;
use linkwork_compiler::resolve::build_model;
use linkwork_compiler::{compile, derive_with_options, expand, parse_source_and_import};
use proc_macro2::TokenStream;
use quote::ToTokens;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::rc::Rc;
use std::time::{Duration, Instant};

/// Number of repetitions of each measurement; the shortest time is printed.
const REPEATS: usize = 5;

type Failure = Box<dyn std::error::Error>;

/// Mechanism to expand: the arguments of its attribute, and the struct.
struct MechanismInput {
    arguments: TokenStream,
    item: TokenStream,
    folder: PathBuf,
}

fn main() -> ExitCode {
    match run_expansion() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("expand: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn run_expansion() -> Result<(), Failure> {
    let (mut file, mut mode, mut name, mut options) = (None, "--rust", None, Vec::new());
    let (mut pass, mut function) = (None, None);
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some(("--every", files)) = arguments.split_first().map(|(first, files)| (first.as_str(), files)) {
        return print_generated_code(files);
    }
    let mut words = arguments.iter();
    while let Some(word) = words.next() {
        let mut value_of_option = || words.next().ok_or_else(|| format!("`{word}` needs a value"));
        match word.as_str() {
            "--rust" | "--counts" | "--time" => mode = word,
            "--struct" => name = Some(value_of_option()?.as_str()),
            "--after" => pass = Some(value_of_option()?.as_str()),
            "--function" => function = Some(value_of_option()?.as_str()),
            "--base" | "--inertia" | "--mimic" | "--passive" => {
                options.push((&word[2..], value_of_option()?.as_str()))
            }
            _ if !word.starts_with('-') && file.is_none() => file = Some(Path::new(word)),
            _ => return Err(format!("what is `{word}`?").into()),
        }
    }
    let file = file.ok_or("expected a Rust file with a `#[mechanism]` struct, or a URDF file")?;
    let input = match file.extension().and_then(|e| e.to_str()) {
        Some("rs") => struct_of_rust_file(file, name)?,
        _ => struct_of_urdf(file, &options)?,
    };
    if let Some(pass) = pass {
        let known = [pipeline::DRAFT, pipeline::FINISH].concat();
        let names: Vec<&str> =
            [pipeline::SELECT].into_iter().chain(known.iter().map(|pass| pass.name)).collect();
        if pass != "all" && !names.contains(&pass) {
            return Err(format!("there is no pass `{pass}`: {}", names.join(", ")).into());
        }
        return print_after_pass(&input, pass, function.ok_or("`--after` needs `--function NAME`")?);
    }
    match mode {
        "--counts" => print_operation_counts(&input),
        "--time" => print_stage_times(&input),
        _ => print_formatted_rust(&input),
    }
}

/// Returns the struct of a Rust file; paths in it are relative to the package.
fn struct_of_rust_file(path: &Path, name: Option<&str>) -> Result<MechanismInput, Failure> {
    let all = mechanism_structs(path)?;
    let mut named = all.into_iter().filter(|item| name.is_none_or(|name| item.ident == name));
    split_attribute(path, named.next().ok_or("the file has no such struct with `#[mechanism]`")?)
}

fn is_mechanism_attribute(attribute: &syn::Attribute) -> bool {
    attribute.path().segments.last().is_some_and(|segment| segment.ident == "mechanism")
}

/// Returns the mechanisms of a Rust file, including those in its inline modules.
fn mechanism_structs(path: &Path) -> Result<Vec<syn::ItemStruct>, Failure> {
    let mut todo = syn::parse_file(&std::fs::read_to_string(path)?)?.items;
    let mut found = Vec::new();
    while !todo.is_empty() {
        for item in std::mem::take(&mut todo) {
            match item {
                syn::Item::Struct(item) if item.attrs.iter().any(is_mechanism_attribute) => found.push(item),
                syn::Item::Mod(module) => {
                    todo.extend(module.content.into_iter().flat_map(|(_, items)| items))
                }
                _ => {}
            }
        }
    }
    Ok(found)
}

/// Returns a struct without its attribute, together with the attribute's arguments.
fn split_attribute(path: &Path, mut item: syn::ItemStruct) -> Result<MechanismInput, Failure> {
    let mut arguments = TokenStream::new();
    item.attrs.retain(|attribute| {
        if is_mechanism_attribute(attribute)
            && let syn::Meta::List(list) = &attribute.meta
        {
            arguments = list.tokens.clone();
        }
        !is_mechanism_attribute(attribute)
    });
    let path = path.canonicalize()?;
    let package = path.ancestors().find(|folder| folder.join("Cargo.toml").is_file());
    let folder = package.or(path.parent()).unwrap_or(&path).to_path_buf();
    let item = item.to_token_stream();
    Ok(MechanismInput { arguments, item, folder })
}

/// Returns a struct without fields for a URDF file.
fn struct_of_urdf(path: &Path, options: &[(&str, &str)]) -> Result<MechanismInput, Failure> {
    let path = path.canonicalize()?;
    let mut arguments = format!("urdf = {:?}", path.to_string_lossy());
    for (key, value) in options {
        arguments += &format!(", {key} = {value}");
    }
    Ok(MechanismInput {
        arguments: arguments.parse()?,
        item: "pub struct Robot;".parse()?,
        folder: PathBuf::new(),
    })
}

impl MechanismInput {
    fn expand_input(&self) -> linkwork_compiler::emit::GeneratedCode {
        expand(self.arguments.clone(), self.item.clone(), &self.folder)
    }
}

/// Prints the unformatted generated code of every mechanism of these files, without and with all options.
fn print_generated_code(files: &[String]) -> Result<(), Failure> {
    const WORDS: [&str; 7] =
        ["derivatives", "centroidal", "regressor", "sensitivities", "packed", "prepare", "batch"];
    for file in files {
        for item in mechanism_structs(Path::new(file))? {
            println!("===== {file}: {}", item.ident);
            let mut input = split_attribute(Path::new(file), item)?;
            let plain = input.expand_input();
            println!("{}\n{}", plain.tokens, plain.text);
            let given: Vec<String> = input.arguments.clone().into_iter().map(|t| t.to_string()).collect();
            let more: Vec<&str> = WORDS.into_iter().filter(|word| !given.iter().any(|g| g == word)).collect();
            let separator = if given.last().is_none_or(|last| last == ",") { "" } else { "," };
            input.arguments.extend(format!("{separator}{}", more.join(",")).parse::<TokenStream>()?);
            println!("----- with all words");
            let whole = input.expand_input();
            println!("{}\n{}", whole.tokens, whole.text);
        }
    }
    Ok(())
}

fn print_formatted_rust(input: &MechanismInput) -> Result<(), Failure> {
    println!("{}", prettyplease::unparse(&syn::parse2(input.expand_input().into_tokens()?)?));
    Ok(())
}

/// Reports the errors of a mechanism that does not compile.
fn result_or_errors<T>(found: Option<T>, cx: &Diagnostics) -> Result<T, Failure> {
    found.ok_or_else(|| cx.full_message_texts().join("\n").into())
}

fn print_operation_counts(input: &MechanismInput) -> Result<(), Failure> {
    let cx = &mut Diagnostics::new();
    let source = parse_source_and_import(input.arguments.clone(), input.item.clone(), &input.folder, cx);
    let source = result_or_errors(source, cx)?;
    let graph = Graph::new();
    let output = compile(&source, &graph, cx);
    let (model, output) = result_or_errors(output, cx)?;
    println!(
        "{}: {} configuration numbers, {} velocities, {} inputs, {} links, {} frames; {} nodes in the \
         graph\n",
        model.name,
        model.nq(),
        model.nv(),
        model.nu(),
        model.links.len(),
        model.frames.len(),
        graph.len()
    );
    println!(
        "{:24}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}",
        "function", "total", "mul", "add", "div", "fused", "calls"
    );
    for f in &output.functions {
        print_operation_count_row(&f.name, [&f.program]);
        if let Some(program) = &f.program.simd {
            print_operation_count_row("  in lanes", [&**program]);
        }
    }
    let links = &output.links;
    print_operation_count_row("links: placement", links.iter().map(|l| &l.placement));
    print_operation_count_row("links: twist", links.iter().map(|l| &l.twist));
    print_operation_count_row("links: acceleration", links.iter().map(|l| &l.acceleration));
    print_operation_count_row("links: columns", links.iter().map(|l| &l.columns));
    let frames = &output.frames;
    print_operation_count_row("frames: placement", frames.iter().map(|f| &f.placement));
    print_operation_count_row("frames: twist", frames.iter().map(|f| &f.twist));
    print_operation_count_row("frames: acceleration", frames.iter().map(|f| &f.acceleration));
    println!("\ntotal = mul + add + div; fused: the same with a product and its sum as one instruction");
    Ok(())
}

fn print_operation_count_row<'a>(name: &str, programs: impl IntoIterator<Item = &'a Program>) {
    let (mut sum, mut instructions) = (OperationCounts::default(), 0);
    for program in programs {
        let c = program.counts;
        sum = OperationCounts {
            mul: sum.mul + c.mul,
            add: sum.add + c.add,
            div: sum.div + c.div,
            calls: sum.calls + c.calls,
        };
        instructions +=
            program.instructions.iter().filter(|op| !matches!(op, Op::Lane(..) | Op::Join(..))).count();
    }
    println!(
        "{name:24}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}",
        sum.total_operations(),
        sum.mul,
        sum.add,
        sum.div,
        instructions - sum.calls,
        sum.calls
    );
}

/// Prints the programs of one function after a pass, or after every pass.
fn print_after_pass(input: &MechanismInput, pass: &str, function: &str) -> Result<(), Failure> {
    let (wanted, of) = (pass.to_string(), function.to_string());
    let print_program_if_selected = move |function: &str, pass: &str, program: &Program, _: Duration| {
        if function == of && (pass == wanted || wanted == "all") {
            let c = program.counts;
            println!(
                "{function}, {pass}: {} instructions, {} operations",
                program.instructions.len(),
                c.total_operations()
            );
            println!("{}", program.program_text(&symbol_name));
        }
    };
    let cx = &mut Diagnostics::new();
    let source = parse_source_and_import(input.arguments.clone(), input.item.clone(), &input.folder, cx);
    let source = result_or_errors(source, cx)?;
    let graph = Graph::new();
    let output = pipeline::run_with_pass_observer(Box::new(print_program_if_selected), || {
        compile(&source, &graph, cx)
    });
    result_or_errors(output, cx).map(|_| ())
}

/// Returns the name of a symbol: `q0`, `v1`, `p2` for a parameter, …
fn symbol_name(symbol: Symbol) -> String {
    match Quantity::from_symbol(symbol) {
        Quantity::Time => "t".to_string(),
        Quantity::Parameter(k) => format!("p{k}"),
        Quantity::Configuration(k) => format!("q{k}"),
        Quantity::Velocity(k) => format!("v{k}"),
        Quantity::Acceleration(k) => format!("a{k}"),
        Quantity::Force(k) => format!("tau{k}"),
        Quantity::Input(k) => format!("u{k}"),
        Quantity::Given(block, k) => format!("{block:?}{k}"),
        other => format!("{other:?}"),
    }
}

/// Measured durations of compiler stages by name, each the minimum of several runs.
#[derive(Default)]
struct StageDurations {
    stages: Vec<(String, Duration)>,
}

impl StageDurations {
    /// Records the duration of a compiler stage in one run; the minimum over all runs is stored.
    fn record_least_duration(&mut self, stage: &str, elapsed: Duration) {
        match self.stages.iter_mut().find(|(name, _)| name == stage) {
            Some((_, least)) => *least = elapsed.min(*least),
            None => self.stages.push((stage.to_string(), elapsed)),
        }
    }

    fn measure_stage<T>(&mut self, stage: &str, f: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = f();
        self.record_least_duration(stage, start.elapsed());
        result
    }

    fn duration_of_stage(&self, stage: &str) -> Duration {
        let found = self.stages.iter().find(|(name, _)| name == stage);
        found.map_or(Duration::ZERO, |(_, time)| *time)
    }
}

/// Prints the time of every stage, and within `derive` that of every pass of lowering, over all functions and
/// all their candidate programs.
fn print_stage_times(input: &MechanismInput) -> Result<(), Failure> {
    let (mut watch, mut passes) = (StageDurations::default(), StageDurations::default());
    for _ in 0..REPEATS {
        expand_once_with_timing(input, &mut watch, &mut passes)?;
    }
    let lowered: Duration = passes.stages.iter().map(|(_, time)| *time).sum();
    let known = ["read", "model", "derive"].map(|stage| watch.duration_of_stage(stage)).into_iter().sum();
    let whole = watch.duration_of_stage("whole expansion");
    let print_stage_time =
        |stage: &str, time: Duration| println!("{stage:32}{:>10.2}", time.as_secs_f64() * 1e3);
    println!("{:32}{:>10}", "stage", "ms");
    print_stage_time("read", watch.duration_of_stage("read"));
    print_stage_time("model", watch.duration_of_stage("model"));
    print_stage_time("derive", watch.duration_of_stage("derive"));
    print_stage_time("  expressions (the rest)", watch.duration_of_stage("derive").saturating_sub(lowered));
    for (pass, time) in &passes.stages {
        print_stage_time(&format!("  {pass}"), *time);
    }
    print_stage_time("emit (the rest)", whole.saturating_sub(known));
    print_stage_time("whole expansion", whole);
    Ok(())
}

fn expand_once_with_timing(
    input: &MechanismInput,
    watch: &mut StageDurations,
    passes: &mut StageDurations,
) -> Result<(), Failure> {
    let cx = &mut Diagnostics::new();
    watch.measure_stage("whole expansion", || input.expand_input());
    let source = watch.measure_stage("read", || {
        parse_source_and_import(input.arguments.clone(), input.item.clone(), &input.folder, cx)
    });
    let source = result_or_errors(source, cx)?;
    let graph = Graph::new();
    let model = watch.measure_stage("model", || build_model(&source.mechanism.description, &graph, cx));
    let model = result_or_errors(model, cx)?;
    let sums = Rc::new(RefCell::new(Vec::<(String, Duration)>::new()));
    let noted = Rc::clone(&sums);
    let record_pass_time = move |_: &str, pass: &str, _: &Program, time: Duration| {
        let mut sums = noted.borrow_mut();
        match sums.iter_mut().find(|(name, _)| name == pass) {
            Some((_, sum)) => *sum += time,
            None => sums.push((pass.to_string(), time)),
        }
    };
    let output = pipeline::run_with_pass_observer(Box::new(record_pass_time), || {
        let derive_all_functions =
            || derive_with_options(&model, source.mechanism.requests, PassSelection::default(), cx);
        watch.measure_stage("derive", derive_all_functions)
    });
    result_or_errors(output, cx)?;
    for (pass, time) in sums.borrow().iter() {
        passes.record_least_duration(pass, *time);
    }
    Ok(())
}
