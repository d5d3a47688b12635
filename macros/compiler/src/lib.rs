#![doc = include_str!("../README.md")]

pub mod algebra;
pub mod catalogue;
pub mod derive;
pub mod diag;
pub mod emit;
pub mod equations;
pub mod export;
pub mod expr;
pub mod import;
pub mod kinematics;
pub mod lower;
mod machine;
pub mod mechanics;
pub mod mechanism;
pub mod passes;
pub mod resolve;
pub mod syntax;
pub mod vectorise;

use catalogue::{BY_PARAMETERS, ConstraintFacts, DERIVATIVES, Facts, JACOBIAN};
use diag::{Diagnostic, Diagnostics};
use emit::{Constraints, Emitted, Interface, emit_failed, emit_mechanism};
use expr::Graph;
use proc_macro2::TokenStream;
use std::path::{Path, PathBuf};
use syntax::{Description, Mechanism};

pub use derive::{derive, derive_with, equations, equations_latex};

/// The whole compiler: `#[mechanism(arguments)] item` → the generated code, with one `compile_error!` for each mistake.
/// Files are looked up in `folder`.
pub fn expand(arguments: TokenStream, item: TokenStream, folder: &Path) -> Emitted {
    let mut cx = Diagnostics::new();
    // What rustc has said of the struct's commas is not said again.
    let item = syntax::separate(&item).map_or(item, |(separated, _)| separated);
    let Some(source) = read(arguments, item, folder, &mut cx) else {
        return Emitted { tokens: cx.into_tokens(), text: String::new() };
    };
    let graph = Graph::new();
    let output = compile(&source, &graph, &mut cx);
    if let Some((model, output)) = &output {
        return emit_mechanism(&source.interface(model, output), output);
    }
    // Of a robot whose file cannot be read even the sizes are unknown: whatever is said of them would be a second mistake.
    if !source.imported {
        return a_type_of_mistakes(&source, cx.distinct().map(Diagnostic::tokens));
    }
    let mut emitted = source.emit_failed();
    emitted.tokens.extend(cx.into_tokens());
    emitted
}

/// The mistakes, the first of them in place of the struct, so that rustc says nothing of whatever uses it.
fn a_type_of_mistakes(source: &Source, mut mistakes: impl Iterator<Item = TokenStream>) -> Emitted {
    let first = mistakes.next().unwrap_or_default();
    let mut tokens = emit::a_mistake_in_a_type(&source.mechanism.shell, &first);
    tokens.extend(mistakes);
    Emitted { tokens, text: String::new() }
}

/// Of a struct whose derives come before the attribute and have seen its elements: one `compile_error!` for that, in place of
/// the struct, and those of its grammar.
pub fn expand_below_a_derive(arguments: TokenStream, item: TokenStream, folder: &Path) -> Emitted {
    let mut cx = Diagnostics::new();
    let Some(source) = read(arguments, item, folder, &mut cx) else {
        return Emitted { tokens: cx.into_tokens(), text: String::new() };
    };
    let mut mistake =
        Diagnostic::new(proc_macro2::Span::call_site(), "`#[derive(…)]` stands above `#[mechanism]`");
    mistake.help("write it below: there it sees the struct without its elements, which do not stay");
    a_type_of_mistakes(&source, [mistake.tokens(), cx.into_tokens()].into_iter())
}

/// A mechanism as C99: the text of a source file and of its header. `None` with the reasons in `cx`.
pub fn export_c(
    source: &Source,
    options: &export::c::Options,
    cx: &mut Diagnostics,
) -> Option<export::c::Files> {
    let graph = Graph::new();
    let passes = passes::Passes { lanes: false, ..passes::Passes::default() };
    let (model, output) = compile_with(source, &graph, passes, cx)?;
    let tables = source.mechanism.shell.table_names();
    export::c::write(&model, &output, &tables, options)
        .map_err(|unfit| {
            let (what, help) = match unfit {
                export::c::Unfit::NoParameter(name) => (
                    format!("there is no parameter `{name}` to be fixed"),
                    match model.parameters.is_empty() {
                        true => "the mechanism has no parameters".to_string(),
                        false => format!("there are {}", model.parameters.join(", ")),
                    },
                ),
                export::c::Unfit::SingleCasadi => (
                    "CasADi has no functions of single precision".to_string(),
                    "export them in double precision".to_string(),
                ),
                export::c::Unfit::Speeds => (
                    "C sources have no declared speeds yet".to_string(),
                    "leave `#[speed(…)]` out, or call the mechanism from a library in Rust".to_string(),
                ),
                export::c::Unfit::Lanes(of) => (
                    format!("Linkwork made a mistake: `{of}` was derived with lanes"),
                    "this is no mistake of yours: please report it with the declaration of the mechanism"
                        .to_string(),
                ),
            };
            cx.error(model.place.clone(), what).help(help);
        })
        .ok()
}

/// The messages of the mistakes in a mechanism; empty if there is none.
pub fn check(arguments: TokenStream, item: TokenStream, folder: &Path) -> Vec<String> {
    let mut cx = Diagnostics::new();
    if let Some(source) = read(arguments, item, folder, &mut cx) {
        compile(&source, &Graph::new(), &mut cx);
    }
    cx.messages()
}

/// A mechanism as read, with its file.
pub struct Source {
    /// What the struct and the file say.
    pub mechanism: Mechanism,
    /// Where the files are that were read.
    files: Vec<PathBuf>,
    /// The file, if one is named, could be read.
    imported: bool,
}

/// Syntax and import: what the user wrote, from tokens and file. `None` if there is nothing to go on.
pub fn read(
    arguments: TokenStream,
    item: TokenStream,
    folder: &Path,
    cx: &mut Diagnostics,
) -> Option<Source> {
    let mut mechanism = syntax::parse_mechanism(arguments, item, cx)?;
    let (mut files, before) = (Vec::new(), cx.len());
    mechanism.description.drawing = mechanism.requests.drawing;
    if let Some(options) = &mut mechanism.file {
        options.collisions =
            options.contacts || mechanism.description.contacts.iter().any(syntax::Contact::names_collisions);
        options.visuals = mechanism.requests.drawing;
        let path = folder.join(&options.path.text);
        let text = import::read_file(&path, options, cx);
        files.extend(text.is_some().then_some(path));
        if let Some(imported) = text.and_then(|text| import::import(&text, folder, options, cx)) {
            files.extend(imported.files.iter().cloned());
            merge(&mut mechanism, imported, cx);
        }
    }
    Some(Source { mechanism, files, imported: cx.len() == before })
}

/// Puts the contents of a file before those of the struct.
fn merge(mechanism: &mut Mechanism, imported: import::Imported, cx: &mut Diagnostics) {
    let Mechanism { description, shell, .. } = mechanism;
    for field in &imported.fields {
        if let Some(own) = description.parameters.iter().find(|own| own.text == field.ident) {
            cx.error(own.place.clone(), format!("the name `{}` is used twice", own.text)).help(format!(
                "the field that holds figures of `{}` has this name: choose another",
                field.of
            ));
        }
    }
    for field in &imported.fields {
        let place = description.name.place.clone();
        let name = |text| syntax::Name { text, place: place.clone() };
        description.parameters.extend(field.members().into_iter().map(name));
        description.file_units.extend(&field.units);
    }
    shell.file_fields = imported.fields;
    let own_bodies = std::mem::replace(&mut description.bodies, imported.bodies);
    let own_joints = std::mem::replace(&mut description.joints, imported.joints);
    for own in &own_bodies {
        if description.bodies.iter().any(|b| b.name.text == own.name.text) {
            cx.error(own.name.place.clone(), format!("the file has a link `{}` already", own.name.text))
                .help("choose another name, or use the link by its name without declaring it");
        }
    }
    for own in &own_joints {
        if description.joints.iter().any(|b| b.name.text == own.name.text) {
            cx.error(own.name.place.clone(), format!("the file has a joint `{}` already", own.name.text))
                .help("choose another name, or use the joint by its name without declaring it");
        }
    }
    description.bodies.extend(own_bodies);
    description.joints.extend(own_joints);
    // Those of the file come first.
    description.limits.splice(0..0, imported.limits);
    description.collisions = imported.collisions;
    description.contacts.splice(0..0, imported.contacts);
    description.visuals = imported.visuals;
    description.drives = imported.drives;
    description.dissipations.splice(0..0, imported.dissipations);
    description.constraints.splice(0..0, imported.constraints);
    description.snapped = imported.snapped;
    description.left_out = imported.left_out;
    description.ground_frame = imported.is_ground;
    if description.gravity.is_none() {
        let place = description.name.place.clone();
        let usual = || syntax::Expr::vector([0.0, 0.0, -9.81], &place);
        description.gravity = Some(imported.gravity.unwrap_or_else(usual));
    }
}

/// Model and mechanics: the checked mechanism and everything that is generated from it.
pub fn compile<'g>(
    source: &Source,
    graph: &'g Graph,
    cx: &mut Diagnostics,
) -> Option<(mechanism::Model<'g>, derive::Output)> {
    compile_with(source, graph, passes::Passes::default(), cx)
}

/// The same with a choice of passes.
pub fn compile_with<'g>(
    source: &Source,
    graph: &'g Graph,
    passes: passes::Passes,
    cx: &mut Diagnostics,
) -> Option<(mechanism::Model<'g>, derive::Output)> {
    if !cx.is_empty() {
        check_rest(source, graph, cx);
        return None;
    }
    let model = resolve::build_model(&source.mechanism.description, graph, cx)?;
    let requests = source.mechanism.requests;
    let mut output = derive_with(&model, requests, passes, cx)?;
    describe(&mut output, &source.mechanism);
    let description = &source.mechanism.description;
    let good = check_rates(description, &output.functions, cx);
    let good = check_outputs(description, &output.functions, &Facts::of(&model, requests), cx) && good;
    good.then_some((model, output))
}

/// Reports what is wrong with those parts of a mechanism that mistakes of its grammar do not touch: what has to do with them
/// would only lead to further complaints.
pub fn check_rest(source: &Source, graph: &Graph, cx: &mut Diagnostics) {
    let Mechanism { reading, description, .. } = &source.mechanism;
    if let Some(rest) = reading.rest(description).filter(|_| source.imported) {
        resolve::build_model(&rest, graph, cx);
    }
}

/// Puts what the user says of an output before the documentation of its function.
fn describe(output: &mut derive::Output, mechanism: &Mechanism) {
    let outputs = &mechanism.description.outputs;
    let notes = mechanism.shell.notes.iter().filter(|(name, _)| outputs.iter().any(|o| o.name.text == *name));
    let prepared = output.prepared.iter_mut().flat_map(|prepared| &mut prepared.functions);
    let mut functions: Vec<&mut derive::Function> = output.functions.iter_mut().chain(prepared).collect();
    for (name, note) in notes {
        for f in functions.iter_mut().filter(|f| f.name == *name && !f.docs.is_empty()) {
            f.docs.insert(0, note.clone());
        }
    }
}

/// True for names that neither Rust nor what is generated needs.
fn can_be_a_function(name: &str) -> bool {
    syn::parse_str::<syn::Ident>(name).is_ok() && !catalogue::is_constant(name) && !name.starts_with("__")
}

/// Reports rates of states that depend on accelerations, which would depend on them in turn.
fn check_rates(description: &Description, functions: &[derive::Function], cx: &mut Diagnostics) -> bool {
    let before = cx.len();
    for (state, _) in &description.states {
        let name = format!("{}{}", state.text, syntax::RATE_OF_STATE);
        let written = description.outputs.iter().find(|output| output.name.text == name);
        let rate = functions.iter().find(|f| f.id == catalogue::Id::Output && f.name == name);
        if let Some(written) = written
            && rate.is_none_or(|f| f.arguments.contains(&catalogue::Argument::A))
        {
            cx.error(
                written.value.place.clone(),
                "the rate of a state cannot depend on accelerations or reactions",
            )
            .help("accelerations follow from the state: write the force that causes them instead");
        }
    }
    cx.len() == before
}

/// Reports outputs that would be functions of the same name as others, or of none that a function can have.
fn check_outputs(
    description: &Description,
    functions: &[derive::Function],
    facts: &Facts,
    cx: &mut Diagnostics,
) -> bool {
    let outputs = &description.outputs;
    let suffixes = [
        (JACOBIAN, "is the Jacobian", true),
        (DERIVATIVES, "gives the derivatives", facts.requests.derivatives),
        (BY_PARAMETERS, "gives the derivatives by parameters", facts.requests.sensitivities),
    ];
    let derived = |name: &str| {
        let asked = suffixes.iter().filter(|(.., asked)| *asked);
        let names: Vec<String> = asked.map(|(suffix, ..)| format!("{name}{suffix}")).collect();
        names.into_iter()
    };
    let origin = |name: &str| {
        let asked = suffixes.iter().filter(|(.., asked)| *asked);
        asked
            .flat_map(|suffix| outputs.iter().map(move |output| (suffix, &output.name.text)))
            .find(|((suffix, ..), other)| name.strip_suffix(suffix) == Some(other.as_str()))
    };
    let is_taken = |name: &str| {
        let other = outputs.iter().map(|output| output.name.text.as_str());
        let mut in_lanes = other.filter(|_| facts.requests.batch).map(|other| format!("{other}_lanes"));
        catalogue::has(name, facts) || in_lanes.any(|other| other == name)
    };
    for name in outputs.iter().map(|output| &output.name) {
        let text = &name.text;
        if let Some(((suffix, what, _), other)) = origin(text) {
            cx.error(name.place.clone(), format!("`{text}` {what} of the output `{other}`"))
                .help(format!("each output has a function of its name and one of its name with `{suffix}`"));
        } else if description.inertias == syntax::Inertias::None && functions.iter().all(|f| f.name != *text)
        {
            cx.error(
                name.place.clone(),
                format!("the output `{text}` names a reaction, which needs inertia"),
            )
            .help("remove it, or `inertia = none`: without inertia there are no dynamics");
        } else if !can_be_a_function(text) {
            cx.error(name.place.clone(), format!("a function of a mechanism cannot be called `{text}`"))
                .help(
                    "keywords, names of its constants and names with two underscores before them are taken",
                );
        } else if is_taken(text) {
            cx.error(
                name.place.clone(),
                format!("the name `{text}` is taken: every mechanism has this function"),
            )
            .help("choose another name for the output");
        } else if let Some(other) = derived(text).find(|other| is_taken(other)) {
            cx.error(
                name.place.clone(),
                format!("the name `{text}` is taken: every mechanism has `{other}`"),
            )
            .help("choose another name for the output");
        }
    }
    cx.is_empty()
}

impl Source {
    /// The fields that are tables, with the numbers of their variables.
    pub fn tables(&self) -> Vec<(String, usize)> {
        let tables = &self.mechanism.description.tables;
        tables.iter().map(|table| (table.name.text.clone(), table.variables)).collect()
    }

    /// What every joint joins, in a line each.
    pub fn structure(&self) -> Vec<String> {
        self.mechanism.description.joints.iter().map(structure_line).collect()
    }

    /// What the outside sees of the mechanism.
    fn interface(&self, m: &mechanism::Model<'_>, output: &derive::Output) -> Interface<'_> {
        let bare = self.bare_interface();
        let base = output.constants.iter().find(|constant| constant.name == "BASE_PARAMETERS");
        let base = base.map_or(0, |constant| constant.list.len());
        let facts = Facts { base, ..Facts::of(m, self.mechanism.requests) };
        Interface {
            configuration: m.configuration.clone(),
            velocities: m.velocities.iter().map(|(name, _)| name.clone()).collect(),
            inputs: m.inputs.iter().map(|(name, _)| name.clone()).collect(),
            frames: m.frames.iter().map(|f| f.name.clone()).collect(),
            diagrams: m
                .outputs
                .iter()
                .filter_map(|output| Some((output.name.clone(), output.diagram.clone()?)))
                .collect(),
            units: m.units.clone(),
            constraints: Constraints::of(m),
            contacts: emit::Touching::of(m),
            limits: emit::Limited::of(m),
            figures: emit::Figure::of(m),
            absent: emit::absent(&facts, &output.functions, &bare.outputs),
            facts,
            ..bare
        }
    }

    /// The part of it that needs no model.
    fn bare_interface(&self) -> Interface<'_> {
        let d = &self.mechanism.description;
        Interface {
            shell: &self.mechanism.shell,
            scalar: d.scalar.clone(),
            configuration: Vec::new(),
            velocities: Vec::new(),
            inputs: Vec::new(),
            frames: Vec::new(),
            structure: self.structure(),
            constraints: Constraints::default(),
            contacts: Vec::new(),
            limits: Vec::new(),
            figures: Vec::new(),
            states: d.states.iter().map(|(name, k)| (name.text.clone(), *k)).collect(),
            outputs: d.outputs.iter().map(|output| output.name.text.clone()).collect(),
            diagrams: Vec::new(),
            units: mechanism::Units::default(),
            facts: Facts::default(),
            detect: !self.mechanism.requests.target_only,
            snapped: &d.snapped,
            left_out: &d.left_out,
            absent: Vec::new(),
            files: self.files.iter().map(|f| f.to_string_lossy().into_owned()).collect(),
        }
    }

    /// The interface of a mechanism that failed to compile, as far as it can be guessed.
    fn emit_failed(&self) -> Emitted {
        let outline = resolve::outline(&self.mechanism.description);
        let facts = self.guess(&outline);
        let mut functions = catalogue::before_outputs(&facts);
        for output in outline.outputs.iter().filter(|output| can_be_a_function(&output.name)) {
            for f in catalogue::output(&output.name, output.size, output.uses, &facts) {
                // An output may have the wrong name.
                if !catalogue::has(&f.name, &facts) && functions.iter().all(|known| known.name != f.name) {
                    functions.push(f);
                }
            }
        }
        functions.extend(catalogue::after_outputs(&facts));
        let functions: Vec<derive::Function> = functions.into_iter().map(derive::Function::stub).collect();
        let mut constants = Vec::new();
        if facts.requests.regressor {
            constants.extend(derive::Constant::regressor(&outline.bodies, &vec![String::new(); facts.base]));
        }
        if facts.requests.sensitivities {
            let parameters: Vec<String> =
                self.mechanism.description.parameters.iter().map(|p| p.text.clone()).collect();
            constants.push(derive::Constant::parameters(&parameters));
        }
        if facts.requests.conserved {
            constants.push(derive::Constant::conserved(&vec![String::new(); facts.conserved]));
        }
        if facts.requests.routh {
            constants.push(derive::Constant::cyclic(&[]));
        }
        let equilibria = self.mechanism.description.equilibria.iter();
        let unknown: Vec<_> = equilibria.map(|e| (e.name.text.clone(), Default::default())).collect();
        constants.extend(derive::Constant::linear_equations(&unknown));
        if facts.requests.drawing {
            constants.push(derive::Constant::drawing(&[]));
        }
        if facts.requests.packed {
            constants.push(derive::Constant::entries(&facts.entries));
        }
        let bare = self.bare_interface();
        let interface = Interface {
            absent: emit::absent(&facts, &functions, &bare.outputs),
            configuration: outline.configuration,
            velocities: outline.velocities,
            inputs: outline.inputs,
            frames: outline.frames,
            diagrams: outline.diagrams.into_iter().filter(|(name, _)| can_be_a_function(name)).collect(),
            constraints: if outline.constrained {
                Constraints::unknown(outline.slipping)
            } else {
                Constraints::default()
            },
            contacts: if facts.contacts[0] > 0 { vec![emit::Touching::unknown()] } else { Vec::new() },
            facts,
            ..bare
        };
        emit_failed(&interface, &functions, &constants)
    }

    /// What signatures of a mechanism that failed to compile depend on, as far as it can be guessed.
    fn guess(&self, outline: &resolve::Outline) -> Facts {
        let (description, requests) = (&self.mechanism.description, self.mechanism.requests);
        let kinematic = description.inertias == syntax::Inertias::None;
        let nv = outline.velocities.len();
        let constraints = outline.constrained.then(|| ConstraintFacts {
            all: 1,
            holonomic: 1,
            slipping: usize::from(outline.slipping),
            ..ConstraintFacts::default()
        });
        Facts {
            nq: outline.configuration.len(),
            nv,
            nu: outline.inputs.len(),
            time: outline.time,
            velocity_inputs: outline.velocity_inputs,
            kinematic,
            speeds: !description.speeds.is_empty(),
            requests: match kinematic {
                true => {
                    let (batch, drawing) = (requests.batch, requests.drawing);
                    syntax::Requests { batch, drawing, ..syntax::Requests::default() }
                }
                false => requests,
            },
            constraints,
            contacts: if description.contacts.iter().all(|c| c.soft.is_some()) { [0; 2] } else { [1; 2] },
            bodies: outline.bodies.len(),
            // How many base parameters there are, only the equations could tell.
            base: 7 * nv,
            parameters: description.parameters.len(),
            equilibria: description.equilibria.len(),
            entries: vec![(0, 0); nv * (nv + 1) / 2],
            ..Facts::default()
        }
    }
}

/// What a joint joins, in a line of the documentation.
fn structure_line(joint: &syntax::Joint) -> String {
    let kind = syntax::joint_kind::kind_word(joint.kind);
    let (parent, child) = (&joint.parent.body.text, &joint.child.body.text);
    format!("`{}`: {kind}, `{parent}` → `{child}`", joint.name.text)
}
