//! What the compiler makes of a mechanism.
//!
//! `cargo run -p linkwork-compiler --example expand -- FILE [options]`
//!
//! `FILE` is a Rust file with a `#[mechanism(…)]` struct (the first, or the one named by `--struct NAME`), or a URDF
//! file. Options: `--rust` (default: the generated code), `--counts` (operations of every function), `--time`
//! (milliseconds of every stage); for a URDF file also `--base free`, `--inertia trust`, `--mimic independent`,
//! `--passive ignore`.
//!
//! `cargo run -p linkwork-compiler --example expand -- --every FILE…` writes the code of every mechanism in the Rust files
//! as it is emitted, then once more with all that can be asked for by a word: what `.ci/compare-output` compares.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::{Expr, Graph};
use linkwork_compiler::lower::{Counts, Op, Program, lower};
use linkwork_compiler::mechanics::{
    self, aba, crba, energy, forces, frames, ldl, momentum, regularity, rnea,
};
use linkwork_compiler::model::{Model, Quantity, build_model};
use linkwork_compiler::{compile, derive, expand, read};
use proc_macro2::TokenStream;
use quote::ToTokens;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Repetitions of which the fastest is shown.
const REPEATS: usize = 5;

type Failure = Box<dyn std::error::Error>;

/// What `#[mechanism]` is given.
struct Input {
    arguments: TokenStream,
    item: TokenStream,
    folder: PathBuf,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("expand: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failure> {
    let (mut file, mut mode, mut name, mut options) = (None, "--rust", None, Vec::new());
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some(("--every", files)) = arguments.split_first().map(|(first, files)| (first.as_str(), files)) {
        return every(files);
    }
    let mut words = arguments.iter();
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("`{word}` needs a value"));
        match word.as_str() {
            "--rust" | "--counts" | "--time" => mode = word,
            "--struct" => name = Some(value()?.as_str()),
            "--base" | "--inertia" | "--mimic" | "--passive" => options.push((&word[2..], value()?.as_str())),
            _ if !word.starts_with('-') && file.is_none() => file = Some(Path::new(word)),
            _ => return Err(format!("what is `{word}`?").into()),
        }
    }
    let file = file.ok_or("expected a Rust file with a `#[mechanism]` struct, or a URDF file")?;
    let input = match file.extension().and_then(|e| e.to_str()) {
        Some("rs") => from_rust(file, name)?,
        _ => from_urdf(file, &options)?,
    };
    match mode {
        "--counts" => counts(&input),
        "--time" => time(&input),
        _ => rust(&input),
    }
}

/// The struct of a Rust file; paths in it are relative to the package.
fn from_rust(path: &Path, name: Option<&str>) -> Result<Input, Failure> {
    let all = structs(path)?;
    let mut named = all.into_iter().filter(|item| name.is_none_or(|name| item.ident == name));
    input(path, named.next().ok_or("the file has no such struct with `#[mechanism]`")?)
}

fn is_mechanism(attribute: &syn::Attribute) -> bool {
    attribute.path().segments.last().is_some_and(|segment| segment.ident == "mechanism")
}

/// The mechanisms of a Rust file, those in modules within it included.
fn structs(path: &Path) -> Result<Vec<syn::ItemStruct>, Failure> {
    let mut todo = syn::parse_file(&std::fs::read_to_string(path)?)?.items;
    let mut found = Vec::new();
    while !todo.is_empty() {
        for item in std::mem::take(&mut todo) {
            match item {
                syn::Item::Struct(item) if item.attrs.iter().any(is_mechanism) => found.push(item),
                syn::Item::Mod(module) => {
                    todo.extend(module.content.into_iter().flat_map(|(_, items)| items))
                }
                _ => {}
            }
        }
    }
    Ok(found)
}

/// A struct with its attribute taken off.
fn input(path: &Path, mut item: syn::ItemStruct) -> Result<Input, Failure> {
    let mut arguments = TokenStream::new();
    item.attrs.retain(|attribute| {
        if is_mechanism(attribute)
            && let syn::Meta::List(list) = &attribute.meta
        {
            arguments = list.tokens.clone();
        }
        !is_mechanism(attribute)
    });
    let path = path.canonicalize()?;
    let package = path.ancestors().find(|folder| folder.join("Cargo.toml").is_file());
    let folder = package.or(path.parent()).unwrap_or(&path).to_path_buf();
    let item = item.to_token_stream();
    Ok(Input { arguments, item, folder })
}

/// A struct without fields of its own.
fn from_urdf(path: &Path, options: &[(&str, &str)]) -> Result<Input, Failure> {
    let path = path.canonicalize()?;
    let mut arguments = format!("urdf = {:?}", path.to_string_lossy());
    for (key, value) in options {
        arguments += &format!(", {key} = {value}");
    }
    Ok(Input { arguments: arguments.parse()?, item: "pub struct Robot;".parse()?, folder: PathBuf::new() })
}

impl Input {
    fn expand(&self) -> linkwork_compiler::emit::Emitted {
        expand(self.arguments.clone(), self.item.clone(), &self.folder)
    }
}

/// What every mechanism of these files becomes, a line of text for a line.
fn every(files: &[String]) -> Result<(), Failure> {
    const WORDS: [&str; 7] =
        ["derivatives", "centroidal", "regressor", "sensitivities", "packed", "prepare", "batch"];
    for file in files {
        for item in structs(Path::new(file))? {
            println!("===== {file}: {}", item.ident);
            let mut input = input(Path::new(file), item)?;
            let plain = input.expand();
            println!("{}\n{}", plain.tokens, plain.text);
            let given: Vec<String> = input.arguments.clone().into_iter().map(|t| t.to_string()).collect();
            let more: Vec<&str> = WORDS.into_iter().filter(|word| !given.iter().any(|g| g == word)).collect();
            let separator = if given.last().is_none_or(|last| last == ",") { "" } else { "," };
            input.arguments.extend(format!("{separator}{}", more.join(",")).parse::<TokenStream>()?);
            println!("----- with all words");
            let whole = input.expand();
            println!("{}\n{}", whole.tokens, whole.text);
        }
    }
    Ok(())
}

fn rust(input: &Input) -> Result<(), Failure> {
    println!("{}", prettyplease::unparse(&syn::parse2(input.expand().into_tokens()?)?));
    Ok(())
}

/// Reports the mistakes of a mechanism that does not compile.
fn checked<T>(found: Option<T>, cx: &Diagnostics) -> Result<T, Failure> {
    found.ok_or_else(|| cx.messages().join("\n").into())
}

fn counts(input: &Input) -> Result<(), Failure> {
    let cx = &mut Diagnostics::new();
    let source = read(input.arguments.clone(), input.item.clone(), &input.folder, cx);
    let source = checked(source, cx)?;
    let graph = Graph::new();
    let output = compile(&source, &graph, cx);
    let (model, output) = checked(output, cx)?;
    println!(
        "{}: {} configuration numbers, {} velocities, {} inputs, {} links, {} frames; {} nodes in the graph\n",
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
        row(&f.name, [&f.program]);
        if let Some(program) = &f.program.in_lanes {
            row("  in lanes", [&**program]);
        }
    }
    let links = &output.links;
    row("links: placement", links.iter().map(|l| &l.placement));
    row("links: twist", links.iter().map(|l| &l.twist));
    row("links: acceleration", links.iter().map(|l| &l.acceleration));
    row("links: columns", links.iter().map(|l| &l.columns));
    let frames = &output.frames;
    row("frames: placement", frames.iter().map(|f| &f.placement));
    row("frames: twist", frames.iter().map(|f| &f.twist));
    row("frames: acceleration", frames.iter().map(|f| &f.acceleration));
    println!("\ntotal = mul + add + div; fused: the same with a product and its sum as one instruction");
    Ok(())
}

fn row<'a>(name: &str, programs: impl IntoIterator<Item = &'a Program>) {
    let (mut sum, mut instructions) = (Counts::default(), 0);
    for program in programs {
        let c = program.counts;
        sum = Counts {
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
        sum.total(),
        sum.mul,
        sum.add,
        sum.div,
        instructions - sum.calls,
        sum.calls
    );
}

/// The milliseconds of every stage, each the least of several runs.
struct Stopwatch {
    stages: Vec<(String, Duration)>,
    next: usize,
}

impl Stopwatch {
    fn measure<T>(&mut self, stage: &str, f: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = f();
        let elapsed = start.elapsed();
        match self.stages.get_mut(self.next) {
            Some((_, least)) => *least = elapsed.min(*least),
            None => self.stages.push((stage.to_string(), elapsed)),
        }
        self.next += 1;
        result
    }
}

fn time(input: &Input) -> Result<(), Failure> {
    let mut watch = Stopwatch { stages: Vec::new(), next: 0 };
    for _ in 0..REPEATS {
        watch.next = 0;
        one_run(input, &mut watch)?;
    }
    let find = |stage: &str| {
        let found = watch.stages.iter().find(|(name, _)| name == stage);
        found.map_or(Duration::ZERO, |(_, time)| *time)
    };
    let emit = find("whole expansion").saturating_sub(find("read") + find("model") + find("derive, all"));
    println!("{:32}{:>10}", "stage", "ms");
    for (stage, time) in watch.stages.iter().chain([&("emit (the rest)".to_string(), emit)]) {
        println!("{stage:32}{:>10.2}", time.as_secs_f64() * 1e3);
    }
    Ok(())
}

fn one_run(input: &Input, watch: &mut Stopwatch) -> Result<(), Failure> {
    let cx = &mut Diagnostics::new();
    watch.measure("whole expansion", || input.expand());
    let source =
        watch.measure("read", || read(input.arguments.clone(), input.item.clone(), &input.folder, cx));
    let source = checked(source, cx)?;
    let description = &source.mechanism.description;
    let graph = Graph::new();
    let model = watch.measure("model", || build_model(description, &graph, cx));
    let model = checked(model, cx)?;
    let output = watch.measure("derive, all", || derive(&model, cx));
    checked(output, cx)?;
    // The same once more, function by function, in a graph of its own.
    let graph = Graph::new();
    let model = checked(build_model(description, &graph, cx), cx)?;
    functions(&model, watch);
    Ok(())
}

/// Mechanics and lowering of each function.
fn functions<'g>(model: &Model<'g>, watch: &mut Stopwatch) {
    let joints = watch.measure("  joints", || mechanics::joints(model));
    let mass = watch.measure("  composite bodies", || crba::mass_matrix(model, &joints));
    watch.measure("  regularity", || regularity::singular_velocities(model, &joints, &mass));
    let (v, a) = (mechanics::velocities(model), mechanics::accelerations(model));
    let lowered = |watch: &mut Stopwatch, name: &str, f: &mut dyn FnMut() -> Vec<Expr<'g>>| {
        let outputs = watch.measure(&format!("  {name}"), f);
        watch.measure(&format!("  {name}: lower"), || lower(&outputs).fused());
        outputs
    };
    lowered(watch, "mass matrix", &mut || mass.iter().flatten().copied().collect());
    let bias = lowered(watch, "bias forces", &mut || rnea::inverse_dynamics(model, &joints, &v, None));
    lowered(watch, "inverse dynamics", &mut || rnea::inverse_dynamics(model, &joints, &v, Some(&a)));
    let force = |k| Quantity::Force(k).expr(model.graph);
    let r: Vec<Expr<'g>> = bias.iter().enumerate().map(|(k, h)| force(k) - *h).collect();
    lowered(watch, "articulated bodies", &mut || aba::accelerations(model, &joints, &r).unwrap_or_default());
    lowered(watch, "factorisation", &mut || ldl::solve(mass.clone(), r.clone(), &joints));
    lowered(watch, "generalized forces", &mut || forces::generalized_forces(model, &joints));
    lowered(watch, "kinetic energy", &mut || vec![energy::kinetic_energy(model, &joints, &v)]);
    lowered(watch, "potential energy", &mut || vec![energy::potential_energy(model, &joints)]);
    lowered(watch, "momentum and its rate", &mut || {
        let mut all = momentum::generalized_momentum(model, &joints, &v);
        all.extend(momentum::momentum_rate(model, &joints, &v));
        all.extend(frames::flat(&momentum::centroidal_momentum(model, &joints, &v)));
        all
    });
    for (name, f) in [
        ("placements", (|m, j, _| frames::link_placement(m, j).flat()) as Step),
        ("twists", |m, j, v| frames::flat(&frames::link_twist(m, j, v))),
        ("columns", |m, j, _| frames::jacobian_columns(m, j).iter().flat_map(frames::flat).collect()),
    ] {
        watch.measure(&format!("  links: {name}, lowered"), || {
            for joint in &joints {
                lower(&f(model, joint, &v)).fused();
            }
        });
    }
}

type Step = for<'a, 'g> fn(&'a Model<'g>, &'a mechanics::Joint<'g>, &'a [Expr<'g>]) -> Vec<Expr<'g>>;
